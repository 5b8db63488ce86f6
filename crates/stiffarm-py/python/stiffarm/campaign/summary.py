"""What came out, in short: counts, failures and figures by the values of each axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import table
from .declaration import Declaration
from .errors import CampaignError, load
from .spread import STATISTICS, is_number, statistics_of
from .tasks import COLUMNS
from .values import show

@dataclass(frozen=True)
class Summary:
    """A summary of the results in a folder.

    Attributes:
        name: Name of the campaign.
        folder: Its folder.
        total: Items of the campaign.
        done: Items in the table.
        failures: One entry for each kind of error: ``error_code``, ``count``, and the first item
            with it (``item``, ``name``, ``error_message``), most frequent first.
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
            A ``pyarrow.Table`` with the axes, ``figure``, ``items`` (done), ``failed``, ``values``
            (items that have the figure), ``mean``, ``std`` (of a sample) and quantiles with linear
            interpolation.

        Raises:
            CampaignError: ``unknown-name`` or ``unknown-name``.
        """
        pa = load("pyarrow", "A summary")
        rows = self.aggregate(axes, figures)
        names = [*self._columns(axes), "figure", "items", "failed", "values", *STATISTICS]
        return pa.table({name: [row[name] for row in rows] for name in names})

    def aggregate(
        self, axes: Sequence[str], figures: Iterable[str] | None = None
    ) -> list[dict[str, Any]]:
        """As :meth:`by`, as a list of dicts."""
        chosen = tuple(figures) if figures is not None else self.figures
        for figure in chosen:
            if figure not in self.figures:
                raise CampaignError(
                    "unknown-name",
                    f"There is no figure {figure!r} of single numbers.",
                    hint=f"Known: {', '.join(self.figures)}.",
                )
        columns = self._columns(axes)
        groups: dict[tuple[Any, ...], list[int]] = {}
        for place in range(self.done):
            key = tuple(self.rows[column][place] for column in columns)
            groups.setdefault(key, []).append(place)
        result = []
        for key, places in groups.items():
            failed = sum(self.rows["status"][place] == "failed" for place in places)
            for figure in chosen:
                column = self.rows[figure]
                values = [column[place] for place in places]
                row = {**dict(zip(columns, key)), "figure": figure, "items": len(places)}
                result.append({**row, "failed": failed, **statistics_of(values)})
        return result

    def _columns(self, axes: Sequence[str]) -> list[str]:
        columns = []
        for axis in axes:
            stem, _, unit = axis.rpartition("_")
            parts = [f"{stem}_{part}_{unit}" for part in ("x", "y", "z")]
            if axis in self.rows and axis not in COLUMNS and axis not in self.figures:
                columns.append(axis)
            elif parts[0] in self.rows:
                columns += parts
            else:
                raise CampaignError(
                    "unknown-name",
                    f"There is no axis {axis!r}.",
                    hint=f"With several values: {', '.join(self.axes)}.",
                )
        return columns

    def group(self, axis: str, figure: str) -> dict[Any, list[float]]:
        """Values of a figure by value of an axis, in the order of the axis, without the missing."""
        columns = self._columns((axis,))
        result: dict[Any, list[float]] = {}
        for place in range(self.done):
            key: Any = tuple(self.rows[column][place] for column in columns)
            key = key[0] if len(key) == 1 else key
            value = self.rows[figure][place]
            result.setdefault(key, [])
            if is_number(value):
                result[key].append(float(value))
        return result

    def draw(self, folder: Path | None = None) -> list[Path]:
        """Draws the figures as PNG and SVG.

        Args:
            folder: Where to; ``figures`` in the folder of the campaign by default.

        Returns:
            The files.

        Raises:
            CampaignError: ``missing-package`` without matplotlib.
        """
        from .figures import draw

        return draw(self, folder or self.folder / "figures")

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
                lines += _text_table(self.aggregate((axis,) if axis else (), (figure,)), axis)
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self.text())}</pre>"


def summarise(
    folder: Path, declaration: Declaration, total: int, headline: Sequence[str]
) -> Summary:
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
    figures = [name for name in rows if name not in own and _all_numbers(rows[name])]
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


def _failures(rows: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    kinds: dict[str, dict[str, Any]] = {}
    for place, code in enumerate(rows["error_code"]):
        if code is None:
            continue
        if code not in kinds:
            kinds[code] = {"error_code": code, "count": 0}
            for name in ("item", "name", "error_message"):
                kinds[code][name] = rows[name][place]
        kinds[code]["count"] += 1
    return sorted(kinds.values(), key=lambda kind: (-kind["count"], kind["error_code"]))


def _all_numbers(values: Sequence[Any]) -> bool:
    present = [value for value in values if value is not None]
    return any(map(is_number, present)) and all(type(value) in (int, float) for value in present)


def _text_table(rows: Sequence[Mapping[str, Any]], axis: str) -> list[str]:
    shown = ("mean", "p05", "median", "p95")
    keys = [name for name in (rows[0] if rows else {}) if name not in (*STATISTICS, "figure")]
    keys = [name for name in keys if name not in ("items", "failed", "values")]
    head = [axis or "all items", "items", "failed", "values", *shown]
    body = [
        [
            ", ".join(show(row[key]) for key in keys) or "",
            *(str(row[name]) for name in ("items", "failed", "values")),
            *("–" if row[name] is None else f"{row[name]:.4g}" for name in shown),
        ]
        for row in rows
    ]
    widths = [max(len(line[place]) for line in [head, *body]) for place in range(len(head))]
    return [
        "  " + line[0].ljust(widths[0]) + "".join(f"  {cell:>{w}}" for cell, w in zip(line[1:], widths[1:]))
        for line in [head, *body]
    ]
