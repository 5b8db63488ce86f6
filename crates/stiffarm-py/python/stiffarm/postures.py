"""Postures: controller angles under names."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _checks, _native_cell, _stiffarm
from ._errors import StiffarmError
from ._files import write_file
from ._record import Record
from ._table import Table, has_columns


class Postures:
    """Postures of an arm, in the order they are measured.

    >>> import stiffarm
    >>> group = stiffarm.Postures([[0, 0, -90, 0, 45, 0], [30, 10, -120, 0, 20, 60]], degrees=True)
    >>> group.angles.shape, group.degrees[1].tolist()
    ((2, 6), [30.0, 10.0, -120.0, 0.0, 20.0, 60.0])
    >>> print(group.to_csv(), end="")
    posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
    1,0,0,-90,0,45,0
    2,30,10,-120,0,20,60

    Attributes:
        angles: Controller angles, one row per posture, one column per joint [rad]; not to be written to.
        names: A name for each posture.
        name: Name of the group in results.
    """

    def __init__(
        self,
        angles: ArrayLike,
        names: Sequence[str] | None = None,
        *,
        degrees: bool = False,
        name: str = "",
    ) -> None:
        """Postures of an array of angles [rad], or [deg] with ``degrees=True``; without names they are "1", "2", ...

        Raises:
            StiffarmError: Angles that are no numbers, not finite, or not in rows; names of another number.
        """
        array = _checks.floats(angles, 2, "Postures")
        if not np.isfinite(array).all():
            row, joint = np.argwhere(~np.isfinite(array))[0]
            raise StiffarmError(
                f"The angle of joint {joint + 1} of posture {row + 1} is not a finite number.", "not-finite"
            )
        array = np.array(_stiffarm.radians(array, degrees))
        array.flags.writeable = False
        own = [str(i) for i in range(1, len(array) + 1)] if names is None else _checks.texts(names, "names")
        if len(own) != len(array):
            raise StiffarmError(f"There are {len(array)} postures and {len(own)} names.", "dimension")
        self.angles: NDArray[np.float64] = array
        self.names = own
        self.name = name

    @classmethod
    def of(cls, value: Any, *, degrees: bool = False) -> Postures:
        """Postures of an array, of a result that has postures, of a frame with ``q1_deg``, ``q2_deg``, ... and the names in
        ``posture`` or ``point``, or of postures.

        Raises:
            StiffarmError: It has none.
        """
        if isinstance(value, Postures):
            return value
        if isinstance(value, Record):
            data = value.to_dict()
            if "postures_deg" not in data or "posture_names" not in data:
                raise StiffarmError(f"A {type(value).__name__} has no postures.", "wrong-type")
            found = cls(data["postures_deg"], data["posture_names"], degrees=True)
            # Of postures that were weighed against each other, those that stay.
            return found[list(data["kept"])] if "kept" in data else found
        if has_columns(value):
            return cls._of_table(Table.of(value))
        return cls(value, degrees=degrees)

    @classmethod
    def _of_table(cls, table: Table) -> Postures:
        """Postures of columns ``q1_deg``, ``q2_deg``, ... and their names in ``posture`` or ``point``, among others."""
        columns = [f"q{j}_deg" for j in range(1, len(table) + 1)]
        columns = columns[: [*(name in table for name in columns), False].index(False)]
        # A joint that is written otherwise would be lost.
        others = [name for name in table if name not in columns and (not columns or re.match(r"q_?\d", name))]
        # Readings, several of a posture.
        others += [name for name in ("state", "dx_mm", "x_mm") if name in table and "point" in table]
        if others or not columns:
            raise StiffarmError(
                f"These columns are not those of postures: {', '.join(others) or 'there are none'}.",
                "table-heading",
                {"key": others[0]} if others else {},
                hint="posture, q1_deg, q2_deg, ...; angles without names as an array, in radians or with degrees=True",
            )
        called = next((name for name in ("posture", "point") if name in table), None)
        names = None if called is None else [str(name) for name in table[called]]
        return cls(np.column_stack([table[name] for name in columns]), names, degrees=True)

    @classmethod
    def read(cls, path: str | os.PathLike[str], cell: Any) -> Postures:
        """Reads a posture table (``.csv``, ``.xlsx``, ``builtin:NAME``) for the robot of a cell.

        Raises:
            StiffarmError: It cannot be read, or anything in it is wrong, with file, line and column.
        """
        names, angles = _stiffarm.read_postures(_native_cell.of(cell), _checks.path(path))
        return cls(angles, names, name=Path(os.fspath(path)).stem)

    @property
    def degrees(self) -> NDArray[np.float64]:
        """The angles [deg], in the fewest digits that are read back as the same."""
        return _stiffarm.degrees(self.angles)

    def table(self) -> Table:
        """Columns ``posture``, ``q1_deg``, ... as in a posture file."""
        degrees = self.degrees
        return Table({"posture": self.names, **{f"q{j + 1}_deg": degrees[:, j] for j in range(degrees.shape[1])}})

    def to_frame(self, library: str | None = None) -> Any:
        """:meth:`table` as a frame of ``"pandas"`` or ``"polars"``."""
        return self.table().to_frame(library)

    def to_csv(self) -> str:
        """The text of a posture file."""
        return _stiffarm.posture_text(self.names, self.angles)

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes :meth:`to_csv` to a file.

        Raises:
            StiffarmError: The file exists and ``overwrite`` is not set, or it cannot be written.
        """
        return write_file(path, self.to_csv(), overwrite=overwrite)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.angles, dtype=dtype) if copy or dtype else self.angles

    def __len__(self) -> int:
        return len(self.angles)

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        return iter(self.angles)

    def __getitem__(self, which: int | slice | Sequence[int]) -> Postures:
        chosen = [int(which)] if isinstance(which, (int, np.integer)) else which
        names = np.array(self.names, dtype=object)[chosen]
        return Postures(self.angles[chosen], list(names), name=self.name)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Postures):
            return NotImplemented
        return self.names == other.names and np.array_equal(self.angles, other.angles)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (np.array(self.angles), self.names, self.name)

    def __repr__(self) -> str:
        return f"<{len(self)} postures of {self.angles.shape[1]} joints: {', '.join(self.names[:8])}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def _again(angles: Any, names: list[str], name: str) -> Postures:
    return Postures(angles, names, name=name)


def angles_of(values: Any, degrees: bool, dimensions: int = 2, what: str = "Postures") -> NDArray[np.float64]:
    """Angles of postures [rad]: of an array, or of what has postures under names."""
    if isinstance(values, Postures) or has_columns(values):
        return Postures.of(values).angles
    of_array: Any = values
    return _stiffarm.radians(_checks.floats(of_array, dimensions, what), degrees)
