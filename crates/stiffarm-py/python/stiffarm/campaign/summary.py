"""What came out, in short: counts, failures and figures by the values of each axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import table
from .declaration import Declaration
from .errors import CampaignError, load
from .task import COLUMNS
from .values import show

#: Statistics of a figure; ``p05`` is the 5 % quantile.
STATISTICS = ("mean", "std", "p05", "p25", "median", "p75", "p95")
_COUNTS = ("items", "failed", "values")


@dataclass(frozen=True)
class Summary:
    """A summary of the results in a folder.

    Attributes:
        name: Name of the campaign.
        folder: Its folder.
        total: Items of the campaign.
        done: Items in the table.
        failures: One entry for each kind of error: ``error_code``, ``count``, and the first item with it (``item``,
            ``name``, ``error_message``), most frequent first.
        axes: Axes that have several values, without the seed where there are others.
        figures: Names of the figures that are single numbers, those of the task's headline first.
        headline: How many of them belong to the headline.
        rows: Columns of the table of results, by name.
    """

    name: str
    folder: Path
    total: int
    done: int
    failures: tuple[Mapping[str, Any], ...]
    axes: tuple[str, ...]
    figures: tuple[str, ...]
    headline: int
    rows: Mapping[str, Sequence[Any]]

    @property
    def failed(self) -> int:
        """Items that failed."""
        return sum(int(failure["count"]) for failure in self.failures)

    def by(self, *axes: str, figures: Iterable[str] | None = None) -> Any:
        """Aggregates by the values of axes, tidy: a row for each group and figure.

        Args:
            axes: Names of axes, for example ``by("cell", "index")``; none for all items together.
            figures: Names of figures; all single numbers by default.

        Returns:
            A ``pyarrow.Table`` with the axes, ``figure``, ``items`` (done), ``failed``, ``values`` (items that have the
            figure), ``mean``, ``std`` (of a sample) and quantiles with linear interpolation.

        Raises:
            CampaignError: ``unknown-name``.
        """
        chosen = tuple(figures) if figures is not None else self.figures
        for figure in chosen:
            if figure not in self.figures:
                hint = f"Known: {', '.join(self.figures)}."
                raise CampaignError(f"There is no figure {figure!r} of single numbers.", "unknown-name", hint=hint)
        columns = self._columns(axes)
        groups: dict[tuple[Any, ...], list[int]] = {}
        for place in range(self.done):
            groups.setdefault(tuple(self.rows[column][place] for column in columns), []).append(place)
        result = []
        for key, places in groups.items():
            counts = {"items": len(places), "failed": sum(self.rows["status"][place] == "failed" for place in places)}
            for figure in chosen:
                found = statistics_of([self.rows[figure][place] for place in places])
                result.append({**dict(zip(columns, key)), "figure": figure, **counts, **found})
        names = [*columns, "figure", *_COUNTS, *STATISTICS]
        return load("pyarrow", "A summary").table({name: [row[name] for row in result] for name in names})

    def _columns(self, axes: Sequence[str]) -> list[str]:
        columns = []
        for axis in axes:
            # The columns of an axis of coordinates.
            parts = table.axis_columns(axis, [()])
            if axis in self.rows and axis not in COLUMNS and axis not in self.figures:
                columns.append(axis)
            elif parts[0] in self.rows:
                columns += parts
            else:
                hint = f"With several values: {', '.join(self.axes)}."
                raise CampaignError(f"There is no axis {axis!r}.", "unknown-name", hint=hint)
        return columns

    def text(self) -> str:
        """The summary as lines for a terminal."""
        lines = [f"{self.name}: {self.done} of {self.total} items, {self.failed} failed"]
        for failure in self.failures:
            lines.append(
                f"  {failure['count']} × {failure['error_code']}, first item {failure['item']} "
                f"({failure['name']}): {failure['error_message']}"
            )
        for figure in self.figures[: max(self.headline, 1)]:
            for axis in self.axes or ("",):
                lines += ["", f"{figure} by {axis}" if axis else figure]
                lines += _text_table(self.by(*[axis] if axis else [], figures=[figure]).to_pylist(), axis)
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.text()


def summarise(folder: Path, declaration: Declaration, total: int, headline: Sequence[str]) -> Summary:
    """The summary of the results in a folder.

    Raises:
        CampaignError: ``no-table`` where nothing was run there.
    """
    results = table.read(folder / "results.parquet")
    rows = {name: results.column(name).to_pylist() for name in results.column_names}
    several = [axis for axis, values in declaration.axes.items() if len(values) > 1]
    # Seeds are repetitions; nobody asks how a figure depends on them.
    axes = tuple(axis for axis in several if axis != "seed") or tuple(several)
    own = {*COLUMNS, *table.all_axis_columns(declaration.axes)}
    numbers = [field.name for field in results.schema if str(field.type) in ("double", "int64")]
    figures = [name for name in numbers if name not in own]
    first = [name for name in headline if name in figures]
    figures = first + [name for name in figures if name not in first]
    return Summary(
        name=declaration.name,
        folder=folder,
        total=total,
        done=results.num_rows,
        failures=tuple(_failures(rows)),
        axes=axes,
        figures=tuple(figures),
        headline=len(first) or min(2, len(figures)),
        rows=rows,
    )


def statistics_of(values: Sequence[float | None]) -> dict[str, Any]:
    """Number, mean, standard deviation and quantiles of the values that there are."""
    numbers = [float(value) for value in values if value is not None]
    if not numbers:
        return {"values": 0, **dict.fromkeys(STATISTICS)}
    spread = float(np.std(numbers, ddof=1)) if len(numbers) > 1 else None
    quantiles = np.quantile(numbers, (0.05, 0.25, 0.5, 0.75, 0.95)).tolist()
    return {"values": len(numbers), **dict(zip(STATISTICS, (float(np.mean(numbers)), spread, *quantiles)))}


def _failures(rows: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    kinds: dict[str, dict[str, Any]] = {}
    for place, code in enumerate(rows["error_code"]):
        if code is not None:
            first = {name: rows[name][place] for name in ("item", "name", "error_message")}
            kinds.setdefault(code, {"error_code": code, "count": 0, **first})["count"] += 1
    return sorted(kinds.values(), key=lambda kind: (-kind["count"], kind["error_code"]))


def _text_table(rows: Sequence[Mapping[str, Any]], axis: str) -> list[str]:
    shown = ("mean", "p05", "median", "p95")
    body = [[axis or "all items", *_COUNTS, *shown]]
    for row in rows:
        key = ", ".join(show(value) for name, value in row.items() if name not in ("figure", *_COUNTS, *STATISTICS))
        numbers = ["–" if row[name] is None else f"{row[name]:.4g}" for name in shown]
        body.append([key, *(str(row[name]) for name in _COUNTS), *numbers])
    widths = [max(map(len, column)) for column in zip(*body)]
    return [
        "  " + line[0].ljust(widths[0]) + "".join(f"  {cell:>{width}}" for cell, width in zip(line[1:], widths[1:]))
        for line in body
    ]
