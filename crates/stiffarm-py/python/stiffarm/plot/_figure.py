"""Figures of results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .._errors import StiffarmError
from .._result import Result
from . import _look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Markers and hatches by the number of a series' second sign.
MARKERS = ("o", "s", "^", "D", "v", "P", "*")
HATCHES = ("", "//", "\\\\", "xx", "--", "||", "++")
#: Fills and hatches of cells of a map without a value, one map after the other.
MISSING = (("#e2e2e2", "///"), ("#f1f1f1", ""), ("#cdcdcd", "xxx"), ("#f6f6f6", "\\\\\\"))
#: Heights of a panel by its width, and its limits [in].
SHAPE, LOW, HIGH = 0.66, 1.3, 2.4
#: Least width of a panel that shares its axes with the others, and of any other [in].
NARROW, WIDE = 1.65, 3.0
#: Styles that fill an area.
AREAS = ("Bars", "Box")


def figure(
    result: Result | Mapping[str, Result],
    name: str | None = None,
    *,
    panel: int | None = None,
    ax: Axes | None = None,
    width_in: float = 3.5,
) -> Figure:
    """A figure of a result's page, or the same of several results side by side.

    Args:
        result: A result, or several by name; their panels have the same axes where they show the same.
        name: Which figure, one of :meth:`stiffarm.results.Result.figures`; the first unless given.
        panel: Only this panel of it, from 0, of each result.
        ax: Axes to draw that panel into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: A result without figures, no such figure or panel, or matplotlib is not installed.
    """
    panels, columns = _panels(result, name, 0 if panel is None and ax is not None else panel)
    if ax is not None:
        _look.check_axes(ax)
        entries = _panel(ax, *panels[0])
        _look.legend_above(ax, entries)
        return _look.figure_of(ax)
    with _look.settings():
        return _new(panels, columns, width_in)


def _panels(result: Any, name: str | None, panel: int | None) -> tuple[list[tuple[dict[str, Any], dict[str, Any]]], int]:
    """Panels with what the page decides of them, and how many stand side by side at most."""
    # Results are mappings themselves.
    results = dict(result) if isinstance(result, Mapping) and not isinstance(result, Result) else {"": result}
    if not results or not all(isinstance(one, Result) for one in results.values()):
        raise StiffarmError("A figure is drawn of a result, or of several by name.", "wrong-type", {"key": "result"})
    panels: list[tuple[dict[str, Any], dict[str, Any]]] = []
    columns = len(results)
    for title, one in results.items():
        every = one.figures()
        if not every:
            raise StiffarmError(f"A {type(one).__name__} has no figure.", "unsupported", hint="page() has what can be seen of it")
        chosen = next(iter(every)) if name is None else name
        if chosen not in every:
            message = f"A {type(one).__name__} has no such figure."
            raise StiffarmError(message, "unknown-name", {"key": "name"}, hint=", ".join(every))
        data = every[chosen]
        columns = max(columns, data["columns"])
        every_panel = list(zip(data["panels"], data["shown"], strict=True))
        if panel is not None:
            if not -len(every_panel) <= panel < len(every_panel):
                message = f"This figure has {len(every_panel)} panels, no number {panel}."
                raise StiffarmError(message, "invalid-value", {"key": "panel"})
            every_panel = [every_panel[panel]]
        for own, shown in every_panel:
            if len(results) > 1:
                own = {**own, "title": f"{title}: {own['title']}" if own["title"] else title}
            panels.append((own, shown))
    _share(panels)
    return panels, columns


def _share(panels: list[tuple[dict[str, Any], dict[str, Any]]]) -> None:
    """The same ends for axes that show the same quantity in all panels."""
    for axis in "xy":
        if len(panels) > 1 and all(own[axis] == panels[0][0][axis] and not own["equal_aspect"] for own, _ in panels):
            ends = [shown[axis] for _, shown in panels]
            both = [min(low for low, _ in ends), max(high for _, high in ends)]
            for _, shown in panels:
                shown[axis] = both


def _new(panels: list[tuple[dict[str, Any], dict[str, Any]]], most_columns: int, width_in: float) -> Figure:
    """A figure of its own, with one legend above its panels."""
    plt = _look.pyplot()
    share = len(panels) > 1 and all(own[axis] == panels[0][0][axis] for own, _ in panels for axis in "xy")
    is_plain = not any(own["equal_aspect"] or own["x"]["categories"] for own, _ in panels)
    least = NARROW if share and is_plain else WIDE
    columns = max(1, min(len(panels), most_columns, int(width_in / least)))
    rows = -(-len(panels) // columns)
    heights = [_height(own, shown, width_in / columns) for own, shown in panels]
    heights_of_rows = [max(heights[row * columns : (row + 1) * columns]) for row in range(rows)]
    drawn: Figure = plt.figure(figsize=(width_in, sum(heights_of_rows)), layout="constrained")
    every = list(drawn.subplots(rows, columns, squeeze=False, height_ratios=heights_of_rows).flat)
    entries: dict[str, Any] = {}
    for (own, shown), ax in zip(panels, every, strict=False):
        _look.fix_ticks(ax)
        for handle, label in _panel(ax, own, shown):
            entries.setdefault(label, handle)
        if share:
            # Headings of axes that all panels share are said once.
            ax.set_xlabel("")
            ax.set_ylabel("")
    for ax in every[len(panels) :]:
        ax.set_axis_off()
    if share:
        for axis, say in (("x", drawn.supxlabel), ("y", drawn.supylabel)):
            say(_heading(panels[0][0][axis]), fontsize=_look.SIZES["axes.labelsize"]).set_parse_math(False)
    _look.legend_over(drawn, [(handle, label) for label, handle in entries.items()])
    return drawn


def _height(own: dict[str, Any], shown: dict[str, Any], wide: float) -> float:
    """Height of a panel [in]."""
    if not own["equal_aspect"]:
        # Room for names that are turned.
        turned = 0.3 if own["x"]["categories"] else 0.0
        return min(max(SHAPE * wide, LOW), HIGH) + turned
    (left, right), (bottom, top) = shown["x"], shown["y"]
    return 0.72 * wide * min(max(float(top - bottom) / float(right - left), 0.3), 2.0) + 0.6


def _panel(ax: Axes, own: dict[str, Any], shown: dict[str, Any]) -> list[tuple[Any, str]]:
    """Draws a panel and gives the entries of its legend."""
    from matplotlib.ticker import MaxNLocator

    for axis, set_scale in (("x", ax.set_xscale), ("y", ax.set_yscale)):
        if own[axis]["scale"] == "Log":
            set_scale("log", nonpositive="clip")
    ax.set_xlim(*shown["x"])
    ax.set_ylim(*shown["y"])
    if own["title"]:
        ax.set_title(_look.wrapped(ax, own["title"]), loc="left", parse_math=False, pad=3)
    if own["equal_aspect"]:
        ax.set_aspect("equal")
    _look.light_grid(ax, "y" if own["x"]["categories"] else "both")
    entries: list[tuple[Any, str]] = []
    slots = [s["label"] for s in own["series"] if s["style"] in AREAS]
    maps = 0
    for series, (colour, dash, variant) in zip(own["series"], shown["series"], strict=True):
        count = min(len(series["x"]), len(series["y"]))
        x, y = (_look.floats(series[axis][:count]) for axis in "xy")
        look = {"color": colour, "linewidth": 1.1}
        if series["style"] in AREAS:
            step = 0.8 / len(slots) * (1.0 if own["x"]["categories"] else _spacing(x))
            aside = x + (slots.index(series["label"]) - 0.5 * (len(slots) - 1)) * step
            handle = _area(ax, series, x, aside, y, step, colour, variant, own["y"]["scale"] == "Log")
        elif series["style"] == "Map":
            handle = _map(ax, series, x, y, shown, maps)
            maps += handle is not None
        else:
            handle = _marks(ax, series, x, y, look, dash, variant)
        if series["label"] and handle is not None and series["label"] not in [label for _, label in entries]:
            entries.append((handle, series["label"]))
    for axis, names_of, set_label in (("x", _look.names_below, ax.set_xlabel), ("y", _look.names_beside, ax.set_ylabel)):
        heading = _heading(own[axis])
        if heading:
            set_label(heading, parse_math=False)
        if own[axis]["categories"]:
            names_of(ax, own[axis]["categories"])
        elif own[axis]["scale"] == "Log":
            _look.plain_log(ax, axis)
        else:
            whole = all(value == round(value) for one in own["series"] for value in one[axis] if value is not None)
            most = _look.tick_count(ax) if axis == "x" else 6
            ticks = MaxNLocator(nbins=most, steps=[1, 2, 2.5, 5, 10], integer=whole and not own[axis]["unit"])
            getattr(ax, f"{axis}axis").set_major_locator(ticks)
    if shown["lost"]:
        ax.text(0.98, 0.96, f"{shown['lost']} not drawn", ha="right", va="top", transform=ax.transAxes)
    return entries


def _heading(axis: dict[str, Any]) -> str:
    """Label and unit."""
    unit = f"[{axis['unit']}]" if axis["unit"] else ""
    return " ".join(part for part in (axis["label"], unit) if part)


def _spacing(x: np.ndarray) -> float:
    """Smallest distance between places."""
    steps = np.diff(np.unique(x[np.isfinite(x)]))
    return float(steps.min()) if len(steps) else 1.0


def _bars(series: dict[str, Any], y: np.ndarray) -> Iterator[tuple[int, float, float]]:
    """Ends of error bars with their points; infinite where a bar is open above."""
    for i, centre in enumerate(y):
        if series.get("interval"):
            low, high = series["interval"][i]
            if low is not None:
                yield i, low, np.inf if high is None else high
        elif series["error"] and series["error"][i]:
            yield i, centre - series["error"][i], centre + series["error"][i]


def _error_bars(ax: Axes, series: dict[str, Any], x: np.ndarray, y: np.ndarray, colour: str) -> None:
    for i, low, high in _bars(series, y):
        top = ax.get_ylim()[1]
        if np.isfinite(high):
            ax.vlines(x[i], low, high, color=colour, linewidth=0.9)
            ax.plot([x[i], x[i]], [low, high], "_", color=colour, markersize=4)
        else:
            arrow = {"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0, "color": colour}
            ax.annotate("", (x[i], top), (x[i], low), arrowprops=arrow)
            ax.plot([x[i]], [low], "_", color=colour, markersize=4)


def _marks(
    ax: Axes, series: dict[str, Any], x: np.ndarray, y: np.ndarray, look: dict[str, Any], dash: str, variant: int
) -> Any:
    """Everything that is neither an area nor a map."""
    style, colour, marker = series["style"], look["color"], MARKERS[variant % len(MARKERS)]
    line = _look.dashes(dash, look["linewidth"])
    if style == "Band":
        error = _look.floats(series["error"][: len(y)])
        return ax.fill_between(x, y - error, y + error, color=colour, alpha=0.22, linewidth=0)
    if style == "Strokes":
        pieces = [np.column_stack([x[i : i + 2], y[i : i + 2]]).T for i in range(0, len(x) - 1, 2)]
        handle = None
        for width, shade in ((2.4, "white"), (1.0, "black")):
            for across, up in pieces:
                (handle,) = ax.plot(across, up, color=shade, linewidth=width)
        return handle
    if style in ("Curve", "Dashed", "Outline"):
        (handle,) = ax.plot(x, y, linestyle=line, **look)
        return handle
    if style == "Landmark":
        (handle,) = ax.plot(x, y, "s", color=colour, markerfacecolor="white", markersize=6)
        ax.plot(x, y, "x", color=colour, markersize=5)
        return handle
    _error_bars(ax, series, x, y, colour)
    hollow = {"markerfacecolor": "white", "markeredgewidth": 0.9} if style == "Hollow" else {"markeredgewidth": 0}
    joined = {"Line": line, "Path": "-"}.get(style, "none")
    size = 4.0 if style != "Path" else 5.0
    many = max(1, len(x) // 60) if style == "Line" else 1
    width = 2.2 if style == "Path" else look["linewidth"]
    (handle,) = ax.plot(
        x, y, marker=marker, markersize=size, markevery=many, linestyle=joined, color=colour, linewidth=width, **hollow
    )
    return handle


def _area(
    ax: Axes, series: dict[str, Any], x: np.ndarray, aside: np.ndarray, y: np.ndarray, step: float, colour: str,
    variant: int, log: bool,
) -> Any:  # fmt: skip
    """Bars, or squares where the axis has no zero to stand on; boxes over the samples that share a place."""
    handle: Any
    hatch = HATCHES[variant % len(HATCHES)]
    if series["style"] == "Bars":
        if log:
            (handle,) = ax.plot(aside, y, "s", color=colour, markersize=5, markeredgecolor="white", markeredgewidth=0.4)
        else:
            handle = ax.bar(aside, y, 0.88 * step, color=colour, hatch=hatch, edgecolor="white", linewidth=0.3)
            ax.axhline(0, color="black", linewidth=0.7)
        _error_bars(ax, series, aside, y, "black")
        return handle
    places = np.unique(x[np.isfinite(x)])
    for place in places:
        samples = y[(x == place) & np.isfinite(y)]
        at = float(aside[x == place][0])
        ax.plot(np.full(len(samples), at), samples, ".", color=colour, alpha=0.25, markersize=2)
        ax.boxplot(
            samples, positions=[at], widths=0.8 * step, whis=(5, 95), showfliers=False, manage_ticks=False,
            boxprops={"color": colour}, whiskerprops={"color": colour}, capprops={"color": colour},
            medianprops={"color": "black"},
        )  # fmt: skip
    from matplotlib.patches import Patch

    return Patch(facecolor="white", edgecolor=colour)


def _map(ax: Axes, series: dict[str, Any], x: np.ndarray, y: np.ndarray, shown: dict[str, Any], number: int) -> Any:
    """Cells around the points of a grid, with their colour bar; hatched where there is no value."""
    from matplotlib.collections import PatchCollection
    from matplotlib.colors import LogNorm, Normalize
    from matplotlib.patches import Patch, Rectangle

    colour = series.get("colour")
    values = np.full(len(x), np.nan) if colour is None else _look.floats(colour["values"][: len(x)])
    is_seen = np.isfinite(values)
    wide, high = _spacing(x), _spacing(y)
    if colour is not None and is_seen.any():
        across, up = np.unique(x), np.unique(y)
        grid = np.full((len(up), len(across)), np.nan)
        grid[np.searchsorted(up, y), np.searchsorted(across, x)] = values
        # Ends of the cells, half-way between their centres.
        edges = [np.concatenate([[c[0] - step / 2], (c[1:] + c[:-1]) / 2, [c[-1] + step / 2]]) for c, step in ((across, wide), (up, high))]
        scale = LogNorm if colour["axis"]["scale"] == "Log" else Normalize
        names = "viridis_r" if colour.get("small_is_bright") else "viridis"
        mesh = ax.pcolormesh(*edges, np.ma.masked_invalid(grid), cmap=names, norm=scale(*shown["colour"]))
        bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02, fraction=0.06)
        if colour["axis"]["scale"] == "Log":
            _look.plain_log(bar.ax)
        bar.set_label(_heading(colour["axis"]))
    ax.grid(False)
    if is_seen.all():
        return None
    fill, hatch = MISSING[number % len(MISSING)]
    missing = zip(x[~is_seen], y[~is_seen], strict=True)
    boxes = [Rectangle((a - wide / 2, b - high / 2), wide, high) for a, b in missing]
    ax.add_collection(PatchCollection(boxes, facecolor=fill, edgecolor="#a0a0a0", hatch=hatch, linewidth=0))
    return Patch(facecolor=fill, edgecolor="#a0a0a0", hatch=hatch, linewidth=0.4)


Result._draw = staticmethod(figure)

__all__ = ["figure"]
