"""The table of results: one row for each item that is done, in the order of the items.

Columns: ``item``, ``id``, ``name``, the axes, ``status`` (``ok`` or ``failed``), ``error_code``,
``error_message``, then the figures in the order in which they first appear. It holds no times,
hosts or workers: those are in ``timings.parquet``. So equal items give equal bytes, whatever ran
them.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .errors import CampaignError, load
from .items import Items
from .journal import Journal
from .values import Value

#: Rows that are held at a time while a table is written.
ROWS = 16_384


def axis_columns(axis: str, values: Iterable[Value]) -> tuple[str, ...]:
    """Columns of an axis: its name, or ``anchor_x_mm``, ``anchor_y_mm``, ``anchor_z_mm``."""
    if any(isinstance(value, tuple) for value in values):
        stem, _, unit = axis.rpartition("_")
        return tuple(f"{stem}_{part}_{unit}" for part in "xyz")
    return (axis,)


def all_axis_columns(axes: Mapping[str, tuple[Value, ...]]) -> tuple[str, ...]:
    """Columns of all axes."""
    return tuple(column for axis, values in axes.items() for column in axis_columns(axis, values))


class _Kind:
    """Type of a column, from the values that it has to hold."""

    def __init__(self, values: Iterable[Any] = ()) -> None:
        self.seen: set[type] = set()
        self.inner: _Kind | None = None
        for value in values:
            self.note(value)

    def note(self, value: Any) -> None:
        if isinstance(value, (list, tuple)):
            self.inner = self.inner or _Kind()
            for part in value:
                self.inner.note(part)
        elif value is not None:
            self.seen.add(type(value))

    @property
    def _name(self) -> str:
        if self.inner is not None:
            return "string" if self.seen else "list_"
        # Figures that change their type from item to item are text; of nothing but None there is no type.
        names: list[tuple[set[type], str]] = [(set(), "null"), ({bool}, "bool_"), ({int}, "int64")]
        names += [({float}, "float64"), ({int, float}, "float64")]
        return next((name for types, name in names if self.seen == types), "string")

    def arrow(self, pa: Any) -> Any:
        if self._name == "list_" and self.inner is not None:
            return pa.list_(self.inner.arrow(pa))
        return getattr(pa, self._name)()

    def fit(self, value: Any) -> Any:
        if value is None:
            return None
        if self._name == "list_" and self.inner is not None:
            return [self.inner.fit(part) for part in value]
        if self._name == "string":
            return value if isinstance(value, str) else repr(value)
        return float(value) if self._name == "float64" else value


def write_results(
    folder: Path, items: Items, axes: Mapping[str, tuple[Value, ...]], journal: Journal, metadata: Mapping[str, str]
) -> None:
    """Writes ``results.parquet``.

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
    # Once, not for every row: an axis may have as many values as there are rows.
    columns = {axis: axis_columns(axis, values) for axis, values in axes.items()}
    kinds = {axis: _Kind(values) for axis, values in axes.items()}
    fields: list[tuple[str, Any]] = [("item", pa.int64()), ("id", pa.string()), ("name", pa.string())]
    for axis, kind in kinds.items():
        fields += [(column, (kind.inner or kind).arrow(pa)) for column in columns[axis]]
    fields += [(name, pa.string()) for name in ("status", "error_code", "error_message")]
    fields += [(name, kind.arrow(pa)) for name, kind in figures.items()]

    def rows() -> Iterator[dict[str, Any]]:
        for record in journal.records():
            item = items[record["number"]]
            row: dict[str, Any] = {"item": item.number, "id": item.id, "name": item.name}
            for axis, value in item.values.items():
                row.update(zip(columns[axis], value if isinstance(value, tuple) else (kinds[axis].fit(value),)))
            row["status"] = "failed" if "code" in record else "ok"
            row["error_code"], row["error_message"] = record.get("code"), record.get("message")
            for name, value in record.get("figures", {}).items():
                row[name] = figures[name].fit(value)
            yield row

    _write(folder / "results.parquet", pa.schema(fields, metadata=dict(metadata)), rows())


def write_timings(folder: Path, journal: Journal) -> None:
    """Writes ``timings.parquet``: ``item``, ``own_s``, ``cpu_s``, ``tries``, ``worker``.

    ``own_s`` is the time of the item in its worker [s], ``cpu_s`` that of the processor [s], ``worker`` machine and
    process.
    """
    pa = load("pyarrow", "The table of times")
    fields = [
        ("item", pa.int64()), ("own_s", pa.float64()), ("cpu_s", pa.float64()), ("tries", pa.int64()),
        ("worker", pa.string()),
    ]  # fmt: skip
    rows = ({**record, "item": record["number"]} for record in journal.records())
    _write(folder / "timings.parquet", pa.schema(fields), rows)


def _write(path: Path, schema: Any, rows: Iterator[dict[str, Any]]) -> None:
    pa, parquet = load("pyarrow", "A table"), load("pyarrow.parquet", "A table")
    with whole(path) as temporary, parquet.ParquetWriter(str(temporary), schema, compression="zstd") as writer:
        while True:
            block = list(itertools.islice(rows, ROWS))
            if block:
                arrays = [pa.array([row.get(field.name) for row in block], type=field.type) for field in schema]
                writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
            if len(block) < ROWS:
                break


@contextmanager
def whole(path: Path) -> Generator[Path, None, None]:
    """Another name to write a file by first, so that it is there whole or not at all."""
    temporary = path.with_name(path.name + ".part")
    yield temporary
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
        hint = "Run the campaign first; a stopped one is completed by running it again."
        raise CampaignError("There is no such table.", "no-table", {"file": str(path)}, hint)
    # Through a file of Python's own, without the folder being taken for a data set.
    # Threads that pyarrow leaves behind can end a short process by an abort when it exits.
    with open(path, "rb") as file, parquet.ParquetFile(file, pre_buffer=False) as reader:
        return reader.read(use_threads=False)
