"""What the items of a campaign share: cells, files and named tools, read once by the driver.

Workers get the data, not the names of files: on a cluster the files are on one machine only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..cell import Cell
from .declaration import Declaration, toml_reader
from .errors import CampaignError
from .tasks import task_of
from .values import digest


def file_hashes(declaration: Declaration) -> dict[str, str]:
    """SHA-256 of each file that a declaration names, by the name used there, and of what they name in turn.

    Raises:
        CampaignError: ``file-read`` with the key that names the file.
    """
    task = task_of(declaration.task)
    if task.axes is None:
        return {task.name: task.source} if task.source else {}
    hashes: dict[str, str] = {}
    for key, name in _named(declaration):
        path = declaration.folder / name
        data = _bytes(path, key)
        hashes[name] = digest(data)
        for inner in _inner_files(data, path.parent) if name.endswith(".toml") else ():
            hashes[f"{name}: {inner}"] = digest(_bytes(path.parent / inner, key))
    return dict(sorted(hashes.items()))


def shared_data(declaration: Declaration) -> dict[str, Any]:
    """What the task gets beside values and options.

    Raises:
        StiffarmError: A file cannot be read, or a cell is none.
    """
    if task_of(declaration.task).axes is None:
        return {}
    return {
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
        place, hint = {"key": key, "file": str(path)}, "File names start from the folder of the campaign's file."
        raise CampaignError(f"{error.strerror}.", "file-read", place, hint) from error


def _inner_files(data: bytes, folder: Path) -> Iterator[str]:
    """Files beside a cell that it names: meshes, robot descriptions, tables."""
    toml = toml_reader()
    try:
        cell = toml.loads(data.decode())
    except (UnicodeDecodeError, toml.TOMLDecodeError):
        return  # The library says what is wrong, with its place.
    for text in sorted(set(_texts(cell))):
        if "." in text and len(text) < 1000 and "\n" not in text and (folder / text).is_file():
            yield text


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (Mapping, list)):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(part)


def _cell(declaration: Declaration, name: str) -> dict[str, Any]:
    """A cell as the tasks use it: the object, and what axes multiply."""
    own = declaration.cells.get(name, {"base": name})
    if "base" in own:
        base = str(own["base"])
        builtin = base.startswith("builtin:")
        cell = Cell.built_in(base.removeprefix("builtin:")) if builtin else Cell(str(declaration.folder / base))
        changes = {key: value for key, value in own.items() if key != "base"}
        cell = cell.with_changes(changes) if changes else cell
    else:
        cell = Cell.from_dict(own, folder=declaration.folder)
    prior = cell.prior_stiffness
    return {"cell": cell, "keys": cell.to_dict(), "prior_nm_per_rad": None if prior is None else prior.tolist()}
