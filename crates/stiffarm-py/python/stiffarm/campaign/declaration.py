"""What a campaign is: a grid of named axes, a task and its fixed options.

A declaration is plain data. It is read from TOML or a dict, checked key by key, and has one
canonical form, whose hash (with those of the files it names and the version of the package)
says whether two campaigns are the same.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import kinds
from .errors import CampaignError, at, load, unknown_key
from .task import COLUMNS, Task
from .tasks import task_of
from .values import Value, canonical, digest, plain

#: Version of the form of campaign files.
FORMAT = 1
#: Most items of one campaign.
MOST_ITEMS = 10_000_000
_KEYS = ("format", "name", "task", "axes", "options", "cells", "tools", "loads")
_NAME = re.compile(r"[a-z][a-z0-9_]*\Z")


@dataclass(frozen=True)
class Declaration:
    """A checked declaration.

    Attributes:
        name: Name of the campaign.
        task: Name of the task: ``select``, ``simulate``, ``coverage``, ``identify`` or
            ``module:function``.
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
            name: [list(v) if isinstance(v, tuple) else v for v in values]
            for name, values in self.axes.items()
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
    if not isinstance(data, Mapping):
        raise CampaignError("A campaign is a table of keys.", "wrong-type", here)
    try:
        data = plain(data)
    except (TypeError, ValueError) as error:
        raise CampaignError(f"A value {error}.", "wrong-type", here) from error
    for key in data:
        if key not in _KEYS:
            raise unknown_key(key, _KEYS, here)
    if data.get("format", FORMAT) != FORMAT:
        message = f"This file has format {data['format']!r}; this version reads format {FORMAT}."
        raise CampaignError(message, "unsupported", at(here, "format"))
    task = task_of(_text(data, "task", here), here)
    tables = {key: _tables(data, key, here) for key in ("cells", "tools", "loads")}
    axes = _axes(data, task, tables, here)
    options = _table(data, "options", here)
    if task.options is not None:
        options = kinds.read_options(options, task.options, here)
    declaration = Declaration(
        _text(data, "name", here), task.name, axes, options, **tables, folder=Path() if folder is None else folder
    )
    if len(declaration) > MOST_ITEMS:
        message = f"This grid has {len(declaration)} items; a campaign has at most {MOST_ITEMS}."
        raise CampaignError(message, "invalid-value", at(here, "axes"), "Split it into several campaigns.")
    task.check(axes, options, here)
    return declaration


def _text(data: Mapping[str, Any], key: str, place: Mapping[str, Any]) -> str:
    value = data.get(key)
    if value is None:
        raise CampaignError(f"The key {key} is missing.", "missing-key", at(place, key))
    if not isinstance(value, str) or not value.strip():
        raise CampaignError(f"{value!r} is no text.", "wrong-type", at(place, key))
    return value


def _table(data: Mapping[str, Any], key: str, place: Mapping[str, Any]) -> dict[str, Any]:
    value = data.get(key, {})
    if not isinstance(value, dict):
        raise CampaignError(f"{value!r} is no table.", "wrong-type", at(place, key))
    return value


def _tables(data: Mapping[str, Any], key: str, place: Mapping[str, Any]) -> dict[str, Any]:
    tables = _table(data, key, place)
    for name, table in tables.items():
        if not isinstance(table, dict):
            hint = f"Write [{key}.{name}] and the keys below it."
            raise CampaignError(f"{table!r} is no table.", "wrong-type", at(place, f"{key}.{name}"), hint)
    return tables


def _axes(
    data: Mapping[str, Any], task: Task, tables: Mapping[str, Any], place: Mapping[str, Any]
) -> dict[str, tuple[Value, ...]]:
    written = _table(data, "axes", place)
    if not written:
        hint = 'For example [axes] with cell = ["builtin:comau"] and seed = [1, 2, 3].'
        raise CampaignError("The table [axes] is missing or empty.", "missing-key", at(place, "axes"), hint)
    result: dict[str, tuple[Value, ...]] = {}
    for name, values in written.items():
        if task.axes is not None and name not in task.axes:
            raise unknown_key(name, task.axes, place, "axes")
        if not _NAME.match(name) or name in COLUMNS:
            message = f"{name!r} cannot be the name of an axis."
            hint = "Names have small letters, digits and _, and no column of the table has them."
            raise CampaignError(message, "invalid-value", at(place, f"axes.{name}"), hint)
        kind = kinds.AXES[name] if task.axes is not None else kinds.ANY_AXIS
        result[name] = kinds.read_axis(name, values, kind, tables.get(kind.names_of or "", {}), place)
    return result
