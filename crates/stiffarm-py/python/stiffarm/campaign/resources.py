"""What the items of a campaign share: cells, files and named tools, read once by the driver.

Workers get the data, not the names of files: on a cluster the files are on one machine only.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .declaration import Declaration, toml_reader
from .errors import CampaignError, load
from .tasks import task_of
from .values import digest


@dataclass(frozen=True)
class Resources:
    """Shared data of a campaign.

    Attributes:
        files: SHA-256 of each file the declaration names, by the name used there, and of what
            they name in turn.
        shared: What the task gets.
    """

    files: Mapping[str, str]
    shared: Mapping[str, Any]


def version() -> str:
    """Version of the package, part of a campaign's hash."""
    import stiffarm

    return str(getattr(stiffarm, "__version__", "unknown"))


def read_files(declaration: Declaration) -> dict[str, str]:
    """Hashes of all files that the declaration names.

    Raises:
        CampaignError: ``file-read`` with the key that names the file.
    """
    task = task_of(declaration.task)
    files = task.sources()
    if not task.needs_cells:
        return files
    for key, name in _named(declaration):
        data = _bytes(declaration.folder / name, key)
        files[name] = digest(data)
        if name.endswith(".toml"):
            folder = (declaration.folder / name).parent
            for inner in _inner_files(data, folder):
                files[f"{name}: {inner}"] = digest(_bytes(folder / inner, key))
    return dict(sorted(files.items()))


def read_resources(declaration: Declaration) -> Resources:
    """Everything that the items need.

    Raises:
        StiffarmError: A file cannot be read, or a cell is none.
    """
    files = read_files(declaration)
    shared: dict[str, Any] = {}
    if task_of(declaration.task).needs_cells:
        shared = {
            "cells": {str(name): _cell(declaration, str(name)) for name in declaration.axes["cell"]},
            "tools": dict(declaration.tools),
            "loads": dict(declaration.loads),
            "files": {
                name: {
                    "path": str((declaration.folder / name).resolve()),
                    "data": _bytes(declaration.folder / name, key),
                }
                for key, name in _named(declaration)
                if not key.startswith(("axes.cell", "cells."))
            },
        }
    return Resources(files, shared)


def _named(declaration: Declaration) -> Iterator[tuple[str, str]]:
    """Key and name of each file of a declaration."""
    for name in declaration.axes.get("cell", ()):
        reference, key = str(name), "axes.cell"
        if reference in declaration.cells:
            key = f"cells.{reference}.base"
            reference = str(declaration.cells[reference].get("base", ""))
        if reference and ":" not in reference:
            yield key, reference
    for name in declaration.axes.get("measurements", ()):
        yield "axes.measurements", str(name)
    for option in ("measurements", "postures_file"):
        file = declaration.options.get(option)
        if isinstance(file, str) and not file.startswith("builtin:"):
            yield f"options.{option}", file


def _bytes(path: Path, key: str) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise CampaignError(
            "file-read",
            f"{error.strerror}.",
            place={"key": key, "file": str(path)},
            hint="File names start from the folder of the campaign's file.",
        ) from error


def _inner_files(data: bytes, folder: Path) -> Iterator[str]:
    """Files beside a cell that it names: meshes, robot descriptions, tables."""
    toml = toml_reader()
    try:
        cell = toml.loads(data.decode())
    except (UnicodeDecodeError, toml.TOMLDecodeError):
        return  # The library says what is wrong, with its place.

    def texts(value: Any) -> Iterator[str]:
        if isinstance(value, str):
            yield value
        elif isinstance(value, Mapping):
            for part in value.values():
                yield from texts(part)
        elif isinstance(value, list):
            for part in value:
                yield from texts(part)

    for text in sorted(set(texts(cell))):
        if "." in text and len(text) < 1000 and "\n" not in text and (folder / text).is_file():
            yield text


def _cell(declaration: Declaration, name: str) -> dict[str, Any]:
    """A cell as the tasks use it: the object, and what axes multiply."""
    own = declaration.cells.get(name)
    if own is None:
        cell = _referred(declaration, name)
    elif "base" in own:
        changes = {k: v for k, v in own.items() if k != "base"}
        cell = _referred(declaration, str(own["base"])).with_changes(changes)
    else:
        cell = _cells().from_dict(own, folder=declaration.folder)
    prior = cell.prior_stiffness
    return {
        "cell": cell,
        "keys": cell.to_dict(),
        "prior_nm_per_rad": None if prior is None else prior.tolist(),
    }


def _referred(declaration: Declaration, reference: str) -> Any:
    if reference.startswith("builtin:"):
        return _cells().built_in(reference.removeprefix("builtin:"))
    return _cells()(str(declaration.folder / reference))


def _cells() -> Any:
    return load("stiffarm", "A built-in task").Cell


def pickled(shared: Mapping[str, Any]) -> bytes:
    """Shared data as bytes for the workers."""
    return pickle.dumps(dict(shared), protocol=pickle.HIGHEST_PROTOCOL)
