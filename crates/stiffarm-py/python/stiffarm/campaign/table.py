"""The table of results: one row for each item that is done, in the order of the items.

Columns: ``item``, ``id``, ``name``, the axes, ``status`` (``ok`` or ``failed``), ``error_code``,
``error_message``, then the figures in the order in which they first appear. It holds no times,
hosts or workers: those are in ``timings.parquet``. So equal items give equal bytes, whatever ran
them.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from .errors import CampaignError, load
from .items import Items
from .journal import Journal
from .values import Value

#: Rows that are held at a time while a table is written.
ROWS = 16_384
#: Names of the parts of a triple.
_PARTS = ("x", "y", "z")


def axis_columns(axis: str, values: Iterable[Value]) -> tuple[str, ...]:
    """Columns of an axis: its name, or ``anchor_x_mm``, ``anchor_y_mm``, ``anchor_z_mm``."""
    if any(isinstance(value, tuple) for value in values):
        stem, _, unit = axis.rpartition("_")
        return tuple(f"{stem}_{part}_{unit}" for part in _PARTS)
    return (axis,)


def all_axis_columns(axes: Mapping[str, tuple[Value, ...]]) -> tuple[str, ...]:
    """Columns of all axes."""
    return tuple(column for axis, values in axes.items() for column in axis_columns(axis, values))


class _Kind:
    """Type of a column, from the values that it has to hold."""

    def __init__(self) -> None:
        self.seen: set[type] = set()
        self.inner: _Kind | None = None

    def note(self, value: Any) -> None:
        if isinstance(value, (list, tuple)):
            self.inner = self.inner or _Kind()
            for part in value:
                self.inner.note(part)
        elif value is not None:
            self.seen.add(type(value))

    def arrow(self, pa: Any) -> Any:
        if self.inner is not None:
            return pa.string() if self.seen else pa.list_(self.inner.arrow(pa))
        if self.seen == {bool}:
            return pa.bool_()
        if self.seen == {int}:
            return pa.int64()
        if self.seen and self.seen <= {int, float}:
            return pa.float64()
        # Of nothing but nulls, and of figures that change their type from item to item.
        return pa.string() if self.seen else pa.null()

    def fit(self, value: Any) -> Any:
        if value is None:
            return None
        if self.inner is not None and not self.seen:
            return [self.inner.fit(part) for part in value]
        if self.inner is None and self.seen == {bool}:
            return value
        if self.inner is None and self.seen == {int}:
            return value
        if self.inner is None and self.seen <= {int, float}:
            return float(value)
        return value if isinstance(value, str) else repr(value)


def write_results(
    folder: Path,
    items: Items,
    axes: Mapping[str, tuple[Value, ...]],
    journal: Journal,
    metadata: Mapping[str, str],
) -> Path:
    """Writes ``results.parquet`` by another name first, so that it is there whole or not at all.

    Args:
        folder: Folder of the campaign.
        items: Its items.
        axes: Its axes.
        journal: Its journal.
        metadata: Text that goes into the file's own metadata.

    Raises:
        CampaignError: ``missing-package`` without pyarrow.
    """
    figures: dict[str, _Kind] = {}
    for record in journal.records():
        for name, value in record.get("figures", {}).items():
            figures.setdefault(name, _Kind()).note(value)
    pa = load("pyarrow", "The table of results")
    mixed = {axis: _mixed(values) for axis, values in axes.items()}
    # Once, not for every row: an axis may have as many values as there are rows.
    columns = {axis: axis_columns(axis, values) for axis, values in axes.items()}
    fields: list[tuple[str, Any]] = [("item", pa.int64()), ("id", pa.string()), ("name", pa.string())]
    for axis, values in axes.items():
        kind = _Kind()
        for value in values:
            kind.note(list(value) if isinstance(value, tuple) else value)
        arrow = pa.float64() if kind.inner is not None else kind.arrow(pa)
        fields += [(column, arrow) for column in columns[axis]]
    fields += [(name, pa.string()) for name in ("status", "error_code", "error_message")]
    fields += [(name, kind.arrow(pa)) for name, kind in figures.items()]

    def rows() -> Iterator[dict[str, Any]]:
        for record in journal.records():
            item = items[record["number"]]
            row: dict[str, Any] = {"item": item.number, "id": item.id, "name": item.name}
            for axis, value in item.values.items():
                parts = value if isinstance(value, tuple) else (mixed[axis].fit(value),)
                row.update(zip(columns[axis], parts))
            row["status"] = "failed" if "code" in record else "ok"
            row["error_code"] = record.get("code")
            row["error_message"] = record.get("message")
            for name, value in record.get("figures", {}).items():
                row[name] = figures[name].fit(value)
            yield row

    path = folder / "results.parquet"
    _write(path, pa.schema(fields, metadata=dict(metadata)), rows())
    return path


def _mixed(values: Iterable[Value]) -> _Kind:
    kind = _Kind()
    for value in values:
        kind.note(value)
    return kind


def write_timings(folder: Path, journal: Journal) -> Path:
    """Writes ``timings.parquet``: ``item``, ``own_s``, ``cpu_s``, ``peak_mb``, ``tries``, ``worker``.

    ``own_s`` is the time of the item in its worker [s], ``cpu_s`` that of the processor [s],
    ``peak_mb`` the most memory of the worker process up to then [MB].
    """
    pa = load("pyarrow", "The table of times")
    fields = [
        ("item", pa.int64()), ("own_s", pa.float64()), ("cpu_s", pa.float64()),
        ("peak_mb", pa.float64()), ("tries", pa.int64()), ("worker", pa.int64()),
    ]  # fmt: skip
    rows = (
        {"item": record["number"], **{name: record.get(name) for name, _ in fields[1:]}}
        for record in journal.records()
    )
    path = folder / "timings.parquet"
    _write(path, pa.schema(fields), rows)
    return path


def _write(path: Path, schema: Any, rows: Iterator[dict[str, Any]]) -> None:
    pa = load("pyarrow", "A table")
    parquet = load("pyarrow.parquet", "A table")
    temporary = path.with_name(path.name + ".part")
    with parquet.ParquetWriter(str(temporary), schema, compression="zstd") as writer:
        while True:
            block = list(itertools.islice(rows, ROWS))
            if block:
                columns = [[row.get(name) for row in block] for name in schema.names]
                arrays = [pa.array(c, type=f.type) for c, f in zip(columns, schema)]
                writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
            if len(block) < ROWS:
                break
    with open(temporary, "rb") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)


def read(path: Path) -> Any:
    """A table that was written here, as a ``pyarrow.Table``.

    Raises:
        CampaignError: ``no-table`` where there is none.
    """
    parquet = load("pyarrow.parquet", "A table")
    if not path.is_file():
        raise CampaignError(
            "no-table",
            "There is no such table.",
            place={"file": str(path)},
            hint="Run the campaign first; a stopped one is completed by running it again.",
        )
    # Through a file of Python's own, without the folder being taken for a data set.
    with open(path, "rb") as file:
        # Threads that pyarrow leaves behind can end a short process by an abort when it exits.
        with parquet.ParquetFile(file, pre_buffer=False) as reader:
            return reader.read(use_threads=False)
