"""Cells as drawings."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _checks, _stiffarm
from .._errors import StiffarmError
from ..cell import Cell
from ..postures import Postures
from . import _look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .._inputs import PosturesLike

#: Views of a drawing.
VIEWS = ("side", "above", "perspective")
#: Markers by tone; items have one each.
MARKERS = {"Skeleton": "o", "Fixed": "X", "Pull": "D", "Ray": "^", "Target": "o"}
ITEMS = ("o", "s", "^", "D", "v", "P", "*")


def cell(
    cell: Cell,
    postures: PosturesLike | None = None,
    *,
    full: int = 0,
    view: str = "perspective",
    degrees: bool = False,
    ax: Axes | None = None,
    width_in: float = 3.5,
) -> Figure:
    """The cell with the arm at one posture in full and at the others as lines: the drawing of its page, in one view.

    Args:
        cell: The cell.
        postures: The postures, or a plan; one within the limits unless given.
        full: Which posture is drawn in full, from 0.
        view: ``"perspective"``, or to scale from the ``"side"`` or from ``"above"``.
        degrees: An array of postures is in degrees.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: No such posture or view, postures of another robot, or matplotlib is not installed.
    """
    if view not in VIEWS:
        raise StiffarmError(f"There is no view {_checks.shown(view)}.", "unknown-name", {"key": "view"}, hint=", ".join(VIEWS))
    names, angles = _named(cell, postures, degrees=degrees)
    count = max(1, len(names))
    if not -count <= full < count:
        raise StiffarmError(f"There are {count} postures, no number {full}.", "invalid-value", {"key": "full"})
    drawing = json.loads(_stiffarm.drawing(cell._native, names, angles, full % count))
    shown = next(one for one in drawing["views"] if view in one["title"])
    if ax is not None:
        _look.check_axes(ax)
        _look.legend_above(ax, _draw(ax, drawing, shown))
        return _look.figure_of(ax)
    plt = _look.pyplot()
    (left, right), (bottom, top) = shown["extent"]
    with _look.settings():
        height = width_in * min(max((top - bottom) / (right - left), 0.4), 1.6) + (0.4 if shown["axes"] else 0.0)
        made: Figure = plt.figure(figsize=(width_in, height), layout="constrained")
        ax = made.add_subplot()
        _look.fix_ticks(ax)
        _look.legend_over(made, _draw(ax, drawing, shown))
    return made


def _named(cell: Cell, postures: PosturesLike | None, *, degrees: bool) -> tuple[list[str], np.ndarray]:
    import os

    if postures is None:
        return [], np.zeros((0, cell.joint_count))
    if isinstance(postures, (str, os.PathLike)):
        own = Postures.read(postures, cell)
    else:
        own = Postures.of(postures, degrees=degrees)
    if len(own) == 0 or own.angles.shape[1] != cell.joint_count:
        raise StiffarmError(f"The robot has {cell.joint_count} joints.", "dimension", {"key": "postures"})
    return own.names, np.ascontiguousarray(own.angles)


def _draw(ax: Axes, drawing: dict[str, Any], view: dict[str, Any]) -> list[tuple[Any, str]]:
    """Draws a view and gives the entries of the key that it has."""
    inks = {(json.dumps(ink["tone"]), ink["caution"]): ink for ink in drawing["inks"]}
    ax.set_xlim(*view["extent"][0])
    ax.set_ylim(*view["extent"][1])
    ax.set_aspect("equal", adjustable="box")
    if view["axes"]:
        _look.light_grid(ax)
        across, up = (f"{axis['label']} [{axis['unit']}]" for axis in view["axes"])
        ax.set(xlabel=across, ylabel=up)
    else:
        ax.set_axis_off()
    there = set()
    for order, mark in enumerate(view["marks"]):
        tone = json.dumps(mark["tone"])
        ink = inks[tone, mark["caution"]]
        ((kind, places),) = mark["shape"].items()
        there.add((kind, tone, mark["caution"]))
        _mark(ax, kind, np.array(places, dtype=float), mark["tone"], ink, order)
    for label in view["labels"]:
        shade = "#c8102e" if label["caution"] else "black"
        ax.annotate(
            _look.short(label["text"], 24), label["at"], (3, 3), textcoords="offset points", color=shade, parse_math=False,
            zorder=len(view["marks"]) + 3, annotation_clip=True, clip_on=True,
        )  # fmt: skip
    entries = []
    for entry in drawing["key"]:
        tone = json.dumps(entry["tone"])
        kind = {"LineAndPoint": "Line"}.get(entry["sample"], entry["sample"])
        if (kind, tone, entry["caution"]) in there:
            entries.append((_sample(entry["sample"], entry["tone"], inks[tone, entry["caution"]]), entry["label"]))
    return entries


def _mark(ax: Axes, kind: str, places: np.ndarray, tone: Any, ink: dict[str, Any], order: int) -> None:
    """One shape, above those before it."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Polygon

    line = _line(ink["line"])
    if kind == "Area":
        fill, opacity = ink["area"]
        edge = _line(ink["edge"])
        face = "none" if fill == "none" else to_rgba(fill, opacity)
        ax.add_patch(
            Polygon(places, facecolor=face, edgecolor=edge["color"], linewidth=edge["linewidth"], zorder=order + 2)
        )
    elif kind == "Line":
        ax.plot(*places.T, zorder=order + 2, solid_capstyle="round", **line)
    elif kind == "Arrow":
        arrow = {"arrowstyle": "-|>", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7, **line}
        ax.annotate("", places[1], places[0], arrowprops=arrow, zorder=order + 2)
    else:
        ax.plot(*places[:, np.newaxis], zorder=order + 2, linestyle="none", **_marker(tone, ink))


def _line(look: list[Any]) -> dict[str, Any]:
    colour, width, dash = look
    return {"color": colour, "linewidth": 0.6 * width, "linestyle": _look.dashes(dash, width)}


def _marker(tone: Any, ink: dict[str, Any]) -> dict[str, Any]:
    number = tone.get("Item", 0) if isinstance(tone, dict) else None
    marker = MARKERS.get(str(tone), "o") if number is None else ITEMS[(number % 6 + number // 6) % len(ITEMS)]
    hollow = tone in ("Skeleton", "Target") and not ink["caution"]
    return {
        "marker": marker, "color": ink["marker"], "markersize": 3.2, "markerfacecolor": "white" if hollow else ink["marker"],
        "markeredgewidth": 0.8 if hollow else 0,
    }  # fmt: skip


def _sample(sample: str, tone: Any, ink: dict[str, Any]) -> Any:
    """What a legend shows of a kind of thing."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if sample == "Area":
        fill, opacity = ink["area"]
        edge = _line(ink["edge"])
        return Patch(facecolor=fill, alpha=opacity or None, edgecolor=edge["color"], linewidth=edge["linewidth"])
    if sample == "Point":
        return Line2D([], [], linestyle="none", **_marker(tone, ink))
    line = _line(ink["line"])
    if sample == "LineAndPoint":
        return Line2D([], [], **{**_marker(tone, ink), **line})
    return Line2D([], [], marker=">" if sample == "Arrow" else None, markevery=[-1], **line)


__all__ = ["cell"]
