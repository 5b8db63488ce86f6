"""Paths of the tool tip: programs of CAM systems and robots, and tables, as tables and back."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from . import _checks, _native_cell, _stiffarm
from ._errors import StiffarmWarning
from ._inputs import TableLike
from ._files import write_file
from ._record import Record
from ._table import Table
from .cell import Cell


class PathTable(Table):
    """The points of a path as a table, and what is to be known about them."""

    #: What the file says and is not followed, or was assumed: each with ``code``, ``severity``, ``subject``,
    #: ``sentence``. Cautions and worse are warnings, too.
    findings: list[Record]


def read_path(
    cell: Cell | str | os.PathLike[str], path: str | os.PathLike[str], *, language: str | None = None
) -> PathTable:
    """The points of a path: of CL data, G-code, a robot's program, or a table.

    The table has what ``predict`` and ``compensate`` take as a path: the pose of the tip in the workpiece frame
    (``x_mm``, ..., with ``roll_deg``, ... or the tool axis ``axis_x``, ...), and where the file says them ``feature``,
    ``feed_mm_per_min`` and the loads (zero at rapid moves).

    Args:
        cell: The cell, or the name of its file; poses count from its workpiece frame.
        path: The file; the ending of its name, or its text, says what it is.
        language: What it is, where these do not: ``"g-code"``, ``"cl-data"``, ``"krl"``, ``"table"``, ...

    Raises:
        StiffarmError: It cannot be read, with file, line and column.
    """
    text, said = _stiffarm.path_text(_native_cell.of(cell), _checks.path(path), _language(language))
    table = PathTable.from_csv(text)
    table.findings = _findings(said)
    return table


def write_path(
    cell: Cell | str | os.PathLike[str],
    path: str | os.PathLike[str],
    points: TableLike,
    output: str | os.PathLike[str],
    *,
    language: str | None = None,
    overwrite: bool = False,
) -> Path:
    """A program with its points moved: the same text with other numbers, as ``compensate`` writes it.

    >>> import stiffarm
    >>> points = dict(stiffarm.read_path(cell, "part.nc"))                            # doctest: +SKIP
    >>> points["z_mm"] = points["z_mm"] + 0.1                                         # doctest: +SKIP
    >>> stiffarm.write_path(cell, "part.nc", points, "higher.nc")                     # doctest: +SKIP

    Args:
        cell: The cell, or the name of its file; poses count from its workpiece frame.
        path: The program as it was read.
        points: Where its points go: as many as :func:`read_path` gave, in their order.
        language: What it is written in, as for :func:`read_path`.
        output: The new file; KRL's ``.dat`` is written beside it.
        overwrite: Whether files that are there are replaced.

    Raises:
        StiffarmError: Other points than the program has, a program that steps, a file that is there.
    """
    name, to = _checks.path(path), Path(_checks.path(output, "output"))
    overwrite = _checks.truth(overwrite, "overwrite")
    moved = read_path(cell, points) if isinstance(points, (str, os.PathLike)) else Table.of(points)
    files, said = _stiffarm.path_program(_native_cell.of(cell), name, moved.to_csv(), _language(language))
    _findings(said)
    for number, contents in enumerate(files):
        write_file(to.with_suffix(".dat") if number else to, contents, overwrite=overwrite)
    return to


def _language(name: str | None) -> str | None:
    """The name of a language, where one is stated."""
    return None if name is None else _checks.text(name, "language")


def _findings(said: str) -> list[Record]:
    """What is to be known; what is more than a note is warned of."""
    findings = [Record(finding) for finding in json.loads(said)]
    for finding in findings:
        if finding["severity"] != "note":
            warnings.warn(finding["sentence"], StiffarmWarning, stacklevel=3)
    return findings
