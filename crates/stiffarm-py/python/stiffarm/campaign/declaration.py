"""What a campaign is: a grid of named axes, a task and its fixed options.

A declaration is plain data. It is read from TOML or a dict, checked key by key, and has one canonical form, whose hash
(with those of the files it names and the version of the package) says whether two campaigns are the same.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .._errors import StiffarmError
from . import kinds
from .errors import CampaignError, load
from .task import COLUMNS, Task
from .tasks import task_of
from .values import Value, canonical, digest, plain

#: Version of the form of campaign files.
FORMAT = 1
#: Most items of one campaign.
MOST_ITEMS = 1_000_000
_KEYS = ("format", "name", "task", "axes", "options", "cells", "tools", "loads")
_NAME = re.compile(r"[a-z][a-z0-9_]*\Z")


@dataclass(frozen=True)
class Declaration:
    """A checked declaration.

    Attributes:
        name: Name of the campaign.
        task: Name of the task: ``select``, ``simulate``, ``coverage``, ``identify`` or ``module:function``.
        axes: Values of each axis; the last axis varies fastest.
        options: Fixed options of the task.
        cells: Cells by name: a ``base`` and what is changed in it, or a whole cell.
        tools: Tools by name, each as ``[tool]`` of a cell file.
        loads: Loads by name, each as ``[load]`` of a cell file.
        folder: Folder that relative file names start from.
    """

    name: str
    task: str
    axes: Mapping[str, tuple[Value, ...]]
    options: Mapping[str, Any] = field(default_factory=dict)
    cells: Mapping[str, Any] = field(default_factory=dict)
    tools: Mapping[str, Any] = field(default_factory=dict)
    loads: Mapping[str, Any] = field(default_factory=dict)
    folder: Path = field(default_factory=Path, compare=False)

    def __len__(self) -> int:
        return math.prod(len(values) for values in self.axes.values())

    def to_dict(self) -> dict[str, Any]:
        """The declaration as plain data; ``read_dict`` takes it back."""
        result: dict[str, Any] = {"format": FORMAT, "name": self.name, "task": self.task}
        result["axes"] = {
            name: [list(v) if isinstance(v, tuple) else v for v in values] for name, values in self.axes.items()
        }
        for key in ("options", "cells", "tools", "loads"):
            if getattr(self, key):
                result[key] = dict(getattr(self, key))
        return result

    def text(self) -> str:
        """The canonical text. The order of the axes is part of it, since items follow it."""
        data = self.to_dict()
        data["axes"] = list(data["axes"].items())
        return canonical(data)


def fingerprint(declaration: Declaration, files: Mapping[str, str], version: str) -> str:
    """Hash of a campaign: declaration, hashes of its files by the names used, package version.

    Returns:
        64 hexadecimal digits.
    """
    return digest(canonical([declaration.text(), dict(files), version]))


def read_toml(path: Path) -> Declaration:
    """A declaration from a TOML file.

    Raises:
        CampaignError: The file cannot be read, is no TOML, or declares no campaign.
    """
    place = {"file": str(path)}
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CampaignError(f"{reason}.", "file-read", place) from error
    toml = toml_reader()
    try:
        data = toml.loads(text)
    except toml.TOMLDecodeError as error:
        raise CampaignError(f"This is no TOML: {error}.", "toml-syntax", place) from error
    return read_dict(data, folder=path.parent, place=place)


def toml_reader() -> Any:
    """``tomllib``, or ``tomli`` on Python 3.10."""
    try:
        return load("tomllib", "Reading TOML")
    except CampaignError:
        return load("tomli", "Reading TOML before Python 3.11")


def read_dict(
    data: Mapping[str, Any], folder: Path | None = None, place: Mapping[str, Any] | None = None
) -> Declaration:
    """A declaration from the same keys as in TOML.

    Args:
        data: The keys.
        folder: Folder that relative file names start from; the current one by default.
        place: Place of the whole, for messages.

    Raises:
        CampaignError: Unknown keys, wrong types, axes that do not fit the task.
    """
    here = dict(place or {})
    try:
        keys = plain(data)
    except TypeError as error:
        raise CampaignError(str(error), "wrong-type", here) from error
    except ValueError as error:
        raise CampaignError("All numbers must be finite.", "not-finite", here) from error
    try:
        return _read(kinds.table(keys, "campaign"), Path() if folder is None else folder)
    except StiffarmError as error:
        raise CampaignError(error.message, error.code, {**here, **error.place}, error.hint) from error


def _read(data: dict[str, Any], folder: Path) -> Declaration:
    kinds.check_keys(data, _KEYS)
    if data.get("format", FORMAT) != FORMAT:
        message = f"This file has format {data['format']!r}; this version reads format {FORMAT}."
        raise CampaignError(message, "unsupported", {"key": "format"})
    for key in ("name", "task", "axes"):
        if not data.get(key):
            hint = 'For example [axes] with cell = ["builtin:comau"] and seed = [1, 2, 3].' if key == "axes" else None
            raise CampaignError(f"The key {key} is missing or empty.", "missing-key", {"key": key}, hint)
    task = task_of(kinds.text(data["task"], "task"))
    tables = {key: kinds.table(data.get(key, {}), key) for key in ("axes", "options", "cells", "tools", "loads")}
    for key in ("cells", "tools", "loads"):
        for name, written in tables[key].items():
            kinds.table(written, f"{key}.{name}")
    tables["axes"] = {name: _axis(name, written, task, tables) for name, written in tables["axes"].items()}
    if task.options is not None:
        kinds.check_options(tables["options"], task.options)
    declaration = Declaration(kinds.text(data["name"], "name"), task.name, **tables, folder=folder)
    if len(declaration) > MOST_ITEMS:
        message = f"This grid has {len(declaration)} items; a campaign has at most {MOST_ITEMS}."
        raise CampaignError(message, "invalid-value", {"key": "axes"}, "Split it into several campaigns.")
    task.check(declaration.axes, declaration.options)
    return declaration


def _axis(name: str, written: Any, task: Task, tables: Mapping[str, Any]) -> tuple[Value, ...]:
    if task.axes is not None:
        kinds.check_keys([name], task.axes, "axes.")
    if not _NAME.match(name) or name in COLUMNS:
        message = f"{name!r} cannot be the name of an axis."
        hint = "Names have small letters, digits and _, and no column of the table has them."
        raise CampaignError(message, "invalid-value", {"key": f"axes.{name}"}, hint)
    return kinds.read_axis(name, written, kinds.scalar if task.axes is None else kinds.AXES[name], tables)
