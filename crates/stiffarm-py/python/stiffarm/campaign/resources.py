"""What the items of a campaign share: cells, files and named tools, read once by the driver.

Workers get the data, not the names of files: on a cluster the files are on one machine only.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..cell import Cell
from .declaration import Declaration
from .errors import CampaignError
from .tasks import task_of
from .values import digest


def read_resources(declaration: Declaration) -> tuple[dict[str, str], dict[str, Any]]:
    """Hashes of all that a declaration names, by the name used there, and what the task gets of it.

    Raises:
        StiffarmError: A file cannot be read, or a cell is none.
    """
    task = task_of(declaration.task)
    if task.axes is None:
        return {task.name: task.source} if task.source else {}, {}
    cells = {str(name): _cell(declaration, str(name)) for name in declaration.axes["cell"]}
    hashes = {
        name if part == "cell" else f"{name}: {part}": found
        for name, cell in cells.items()
        for part, found in cell.inputs.items()
    }
    files: dict[str, Any] = {}
    for key, name in _named(declaration):
        path = (declaration.folder / name).resolve()
        try:
            files[name] = {"path": str(path), "data": path.read_bytes()}
        except OSError as error:
            place, hint = {"file": str(path), "key": key}, "File names start from the folder of the campaign's file."
            raise CampaignError(f"{error.strerror}.", "file-read", place, hint) from error
        hashes[name] = digest(files[name]["data"])
    shared = {"cells": cells, "tools": dict(declaration.tools), "loads": dict(declaration.loads), "files": files}
    return dict(sorted(hashes.items())), shared


def _named(declaration: Declaration) -> Iterator[tuple[str, str]]:
    """Key and name of each file of a declaration that is neither a cell nor built in."""
    named = [("axes.measurements", str(name)) for name in declaration.axes.get("measurements", ())]
    for option in ("measurements", "postures_file"):
        if option in declaration.options:
            named.append((f"options.{option}", str(declaration.options[option])))
    return (pair for pair in named if not pair[1].startswith("builtin:"))


def _cell(declaration: Declaration, name: str) -> Cell:
    own = declaration.cells.get(name, {"base": name})
    if "base" not in own:
        return Cell.from_dict(own, folder=declaration.folder)
    base = str(own["base"])
    cell = Cell(base if base.startswith("builtin:") else str(declaration.folder / base))
    changes = {key: value for key, value in own.items() if key != "base"}
    return cell.with_changes(changes) if changes else cell
