"""The table of results: one row for each item that is done, in the order of the items.

Columns: ``item``, ``id``, ``name``, the axes, ``status`` (``ok`` or ``failed``), ``error_code``,
``error_message``, then the figures in the order in which they first appear. It holds no times, hosts or workers: those
are in ``timings.parquet``. So equal items give equal bytes, whatever ran them.
"""

from __future__ import annotations

import os
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .errors import CampaignError, load
from .items import Items
from .journal import Journal
from .values import Value


def axis_columns(axis: str, values: Iterable[Value]) -> tuple[str, ...]:
    """Columns of an axis: its name, or ``anchor_x_mm``, ``anchor_y_mm``, ``anchor_z_mm``."""
    if any(isinstance(value, tuple) for value in values):
        stem, _, unit = axis.rpartition("_")
        return tuple(f"{stem}_{part}_{unit}" for part in "xyz")
    return (axis,)


def all_axis_columns(axes: Mapping[str, tuple[Value, ...]]) -> tuple[str, ...]:
    """Columns of all axes."""
    return tuple(column for axis, values in axes.items() for column in axis_columns(axis, values))


def _array(pa: Any, values: Sequence[Any], type: Any = None) -> Any:
    """A column; a figure that changes its type from item to item is text."""
    try:
        return pa.array(values, type=type)
    except (pa.ArrowInvalid, pa.ArrowTypeError):
        return pa.array([value if value is None or isinstance(value, str) else repr(value) for value in values])


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
    pa = load("pyarrow", "The table of results")
    records = list(journal.records())
    done = [items[record["number"]] for record in records]
    text = pa.string()
    columns: dict[str, Any] = {
        "item": pa.array([item.number for item in done], pa.int64()),
        "id": pa.array([item.id for item in done], text),
        "name": pa.array([item.name for item in done], text),
    }
    for axis, values in axes.items():
        names = axis_columns(axis, values)
        for place, name in enumerate(names):
            # Of the type that all its values need, also while some of their items are not done.
            parts = [value[place] if isinstance(value, tuple) else value for value in values]
            types = _array(pa, parts).type
            found = [
                value[place] if isinstance(value, tuple) else value for value in (one.values[axis] for one in done)
            ]
            columns[name] = _array(pa, found, types)
    columns["status"] = pa.array(["failed" if "code" in record else "ok" for record in records], text)
    for column, key in (("error_code", "code"), ("error_message", "message")):
        columns[column] = pa.array([record.get(key) for record in records], text)
    figures = dict.fromkeys(name for record in records for name in record.get("figures", ()))
    for name in figures:
        columns[name] = _array(pa, [record.get("figures", {}).get(name) for record in records])
    _write(folder / "results.parquet", pa.table(columns).replace_schema_metadata(dict(metadata)))


def write_timings(folder: Path, journal: Journal) -> None:
    """Writes ``timings.parquet``: ``item``, ``own_s``, ``cpu_s``, ``tries``, ``worker``.

    ``own_s`` is the time of the item in its worker [s], ``cpu_s`` that of the processor [s], ``worker`` machine and
    process.
    """
    pa = load("pyarrow", "The table of times")
    types = {"own_s": pa.float64(), "cpu_s": pa.float64(), "tries": pa.int64(), "worker": pa.string()}
    records = list(journal.records())
    columns = {"item": pa.array([record["number"] for record in records], pa.int64())}
    columns |= {name: pa.array([record.get(name) for record in records], type) for name, type in types.items()}
    _write(folder / "timings.parquet", pa.table(columns))


def _write(path: Path, found: Any) -> None:
    with whole(path) as temporary:
        load("pyarrow.parquet", "A table").write_table(found, str(temporary), compression="zstd")


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
    # Through a file of Python's own, without the folder being taken for a data set. Threads that pyarrow leaves behind
    # can end a short process by an abort when it exits.
    with open(path, "rb") as file, parquet.ParquetFile(file, pre_buffer=False) as reader:
        return reader.read(use_threads=False)
