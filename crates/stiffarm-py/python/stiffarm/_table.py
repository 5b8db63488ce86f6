"""Tables: columns with their names, to and from CSV, pandas, polars and whatever speaks Arrow."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from . import _checks, _html, _stiffarm
from ._errors import StiffarmError


#: Endings of columns of numbers.
UNITS = ("_deg", "_mm", "_n", "_nm", "_m", "_rad", "_s", "_kg", "_percent", "_um", "_min", "axis_x", "axis_y", "axis_z")


_T = TypeVar("_T", bound="Table")


class Table(Mapping[str, Any]):
    """Columns of one length by name; units stand in the names, as in the files.

    It is a mapping from names to columns (NumPy arrays of numbers, lists of text), has the Arrow C interface
    (``__arrow_c_stream__``), and so becomes a frame of any library: ``pyarrow.table(table)``, ``table.to_frame()``.
    """

    def __init__(self, columns: Mapping[str, Sequence[Any] | np.ndarray]) -> None:
        given = _checks.mapping(columns, "columns")
        self._columns = {name: _column(values, name) for name, values in given.items()}
        lengths = {len(column) for column in self._columns.values()}
        if len(lengths) > 1:
            raise StiffarmError("The columns of a table must be of one length.", "dimension")
        self._length = lengths.pop() if lengths else 0

    @classmethod
    def of(cls, value: Any) -> Table:
        """A table of a frame, of anything with the Arrow C interface, or of a mapping of columns.

        Raises:
            StiffarmError: It has no columns.
        """
        if isinstance(value, Table):
            return value
        if isinstance(value, Mapping):
            return cls(value)
        # A frame of pandas without pyarrow has no Arrow stream to give.
        if hasattr(value, "columns") and hasattr(value, "iloc"):
            for name in value.columns[value.columns.duplicated()]:
                raise StiffarmError(f'The column "{name}" is there twice.', "duplicate", {"key": str(name)})
            return cls({str(name): value[name].tolist() for name in value.columns})
        if hasattr(value, "__arrow_c_stream__"):
            return cls.from_csv(_stiffarm.csv_of_stream(value))
        raise StiffarmError(
            f"A table is needed, got {type(value).__name__}.",
            "wrong-type",
            hint="give the name of a file, a frame of pandas or polars, or a mapping of columns",
        )

    @classmethod
    def from_csv(cls: type[_T], text: str) -> _T:
        """A table of the text of one of our CSV files; columns with a unit in their heading are numbers."""
        rows = [row for row in csv.reader(io.StringIO(_checks.text(text, "text"))) if row]
        if not rows:
            return cls({})
        columns: dict[str, Any] = {}
        for number, row in enumerate(rows, 1):
            if len(row) != len(rows[0]):
                message = f"This row has {len(row)} fields, the heading {len(rows[0])}."
                raise StiffarmError(message, "table-row", {"line": number})
        for i, name in enumerate(rows[0]):
            column = [row[i] for row in rows[1:]]
            # A name "1" is no number: those have their unit in the heading.
            columns[name] = _numbers(column) if name.endswith(UNITS) else column
        return cls(columns)

    def to_csv(self) -> str:
        """The text of a CSV file; numbers are read back to the last bit."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self._columns)
        columns = [[_field(value) for value in column] for column in self._columns.values()]
        writer.writerows(zip(*columns, strict=True))
        return out.getvalue()

    def to_frame(self, library: str | None = None) -> Any:
        """A frame of ``"pandas"`` or ``"polars"``; without a name the first of them that is installed.

        Raises:
            StiffarmError: Neither is installed, or not the one that is named.
        """
        for name in [library] if library else ["pandas", "polars"]:
            if name not in ("pandas", "polars"):
                raise StiffarmError(
                    f'There is no frame of "{name}".', "unknown-name", hint="pandas or polars"
                )
            try:
                module = __import__(name)
            except ImportError:
                continue
            return module.DataFrame(dict(self._columns) if name == "pandas" else _Stream(self))
        raise StiffarmError(
            f"{library or 'Neither pandas nor polars'} is not installed."
            if library
            else "Neither pandas nor polars is installed.",
            "unsupported",
            hint="pip install pandas",
        )

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        columns = [
            column.tolist() if isinstance(column, np.ndarray) else list(column)
            for column in self._columns.values()
        ]
        return _stiffarm.stream_of_columns(list(self._columns), columns, requested_schema)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return self._length

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self.to_csv() == other.to_csv()

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Table of {self._length} rows: {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        return _html.table(self, self._length)


def has_columns(value: object) -> bool:
    """True for what :meth:`Table.of` makes a table of."""
    return isinstance(value, Mapping) or hasattr(value, "__arrow_c_stream__") or hasattr(value, "columns")


class _Stream:
    """The Arrow interface alone: polars takes a mapping column by column, and has no nulls then."""

    def __init__(self, table: Table) -> None:
        self.__arrow_c_stream__ = table.__arrow_c_stream__


def _numbers(texts: list[str]) -> list[Any]:
    """Numbers where all are, so that whoever reads the table can say which is none."""
    try:
        return [float(text) if text else None for text in texts]
    except ValueError:
        return texts


def _column(values: Any, name: str) -> Any:
    """An array of numbers where all are, else a list."""
    if isinstance(values, np.ndarray) and values.dtype.kind in "fiub":
        return values
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise StiffarmError("A column must be a list of values.", "wrong-type", {"key": name})
    values = [value.item() if isinstance(value, np.generic) else value for value in values]
    if not values:
        return values
    if all(isinstance(value, bool) for value in values):
        return np.array(values)
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values)
    if all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else float(value) for value in values])
    return values


def _field(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        # As the command writes numbers, so that equal tables have equal hashes.
        return "" if np.isnan(value) else np.format_float_positional(float(value), trim="-")
    return str(value)
