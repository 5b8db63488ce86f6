"""The cell in three dimensions."""

from __future__ import annotations

import importlib
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._errors import StiffarmError
from ..cell import Cell
from ..postures import Postures
from . import _chain, _look, _solids

if TYPE_CHECKING:
    from .._inputs import PosturesLike

#: Length of a load's arrow, as a share of the arm's reach.
ARROW = 0.22
#: Thickness of the first and the last link of the arm in front [pt].
THICK = (6.5, 3.0)


def scene(
    cell: Cell,
    postures: PosturesLike | None = None,
    *,
    front: int = 0,
    limits: bool = True,
    degrees: bool = False,
    ax: Any = None,
    width_in: float = 3.5,
    elevation_deg: float = 22.0,
    azimuth_deg: float = -58.0,
) -> Any:
    """The arm in each posture, with loading point, load, measuring points and what stands around it, to scale [mm].

    One posture is drawn as an arm with the tool's shapes, the others as lines. Links run along the joints' axes and the
    perpendiculars between them; castings and the capsules around links are not drawn. Meshes, walls, floors and what a
    measurement alone knows (its wrench) are left out.

    It returns the axes, an ``Axes3D`` of matplotlib.

    Args:
        cell: The cell.
        postures: The postures, or a plan; the arm at zero angles, or the nearest within its limits, unless given.
        front: Which posture is drawn as an arm, from 0.
        limits: Also the box for the tool and the cylinder that the cell file keeps free.
        degrees: An array of postures is in degrees.
        ax: Three-dimensional axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].
        elevation_deg: Height of the view [deg].
        azimuth_deg: Its direction about z [deg].

    Raises:
        StiffarmError: Axes that are not three-dimensional; no such posture; postures of another robot.
    """
    if ax is not None and getattr(ax, "name", "") != "3d":
        raise StiffarmError(
            "The cell needs three-dimensional axes.", "wrong-type", {"key": "ax"},
            hint='figure.add_subplot(projection="3d")',
        )  # fmt: skip
    own = _postures(cell, postures, degrees=degrees)
    if not -len(own) <= front < len(own):
        raise StiffarmError(f"There are {len(own)} postures, no number {front}.", "invalid-value", {"key": "front"})
    front %= len(own)
    keys = cell.to_dict()
    with _axes(ax, width_in) as into:
        extent: list[NDArray[np.float64]] = [np.zeros((1, 3))]
        entries: list[tuple[Any, str]] = []
        arms = [1e3 * _chain.links(cell.robot, angles) for angles in own.angles]
        reach = max(float(np.linalg.norm(np.diff(arm, axis=0), axis=1).sum()) for arm in arms)
        for number, arm in enumerate(arms):
            if number != front:
                (thin,) = into.plot(*arm.T, color="#7a7a7a", linewidth=0.8, zorder=2, gid="posture")
                if len(entries) < 1:
                    entries.append((thin, "other postures"))
            extent.append(arm)
        _arm(into, arms[front])
        robot = cell.robot
        poses = [robot.pose(angles) for angles in own.angles]
        extent += _tool(into, cell, keys["tool"], poses, front, entries)
        extent += _loads(into, cell, keys.get("load", {}), poses, reach, front, entries)
        extent += _around(into, keys, limits, entries)
        _frame(into, np.concatenate(extent))
        into.view_init(elev=elevation_deg, azim=azimuth_deg)
        if ax is None:
            _fit(into, 0.65 if width_in < 5 else 0.35)
            _look.legend(into.figure, entries, width_in, loc="upper left")
        else:
            _look.legend(into, entries, 3.0, loc="upper left")
    return into


@contextmanager
def _axes(ax: Any, width_in: float) -> Generator[Any, None, None]:
    """The given axes, or new ones below the room for a legend; layouts of matplotlib do not know the labels of such axes."""
    plt = _look.pyplot()
    if ax is not None:
        yield ax
        return
    above = 0.65 if width_in < 5 else 0.35
    height = 0.74 * width_in + above
    with _look.settings(True):
        figure = plt.figure(figsize=(width_in, height))
        made = figure.add_axes((0.0, 0.05, 1.0, 0.95 - above / height), projection="3d")
        _look.fix_ticks(made)
        yield made


def _postures(cell: Cell, postures: PosturesLike | None, *, degrees: bool) -> Postures:
    import os

    if postures is None:
        low, high = cell.limits.T
        return Postures(np.clip(np.zeros(cell.joint_count), low, high)[np.newaxis])
    if isinstance(postures, (str, os.PathLike)):
        return Postures.read(postures, cell)
    own = Postures.of(postures, degrees=degrees)
    if len(own) == 0 or own.angles.shape[1] != cell.joint_count:
        raise StiffarmError(f"The robot has {cell.joint_count} joints.", "dimension", {"key": "postures"})
    return own


def _arm(ax: Any, arm: NDArray[np.float64]) -> None:
    """Links as thick lines with round ends, thinner towards the flange, and a mark where each bends."""
    count = len(arm) - 1
    for i in range(count):
        thick = THICK[0] + (THICK[1] - THICK[0]) * i / max(1, count - 1)
        for width, shade in ((thick + 1.4, "#3f4f63"), (thick, "#a9bdd6")):
            ax.plot(*arm[i : i + 2].T, color=shade, linewidth=width, solid_capstyle="round", zorder=3 + i, gid="link")
    ax.plot(*arm[:1].T, "s", color="black", markersize=4, zorder=2)


def _tool(
    ax: Any,
    cell: Cell,
    tool: dict[str, Any],
    poses: list[NDArray[np.float64]],
    front: int,
    entries: list[tuple[Any, str]],
) -> list[NDArray[np.float64]]:
    """Measuring points of every posture; the tool's shapes, or struts to the points, of the one in front."""
    points = np.array(list(cell.measuring_points.values()))
    placed = [1e3 * (points @ pose[:3, :3].T + pose[:3, 3]) for pose in poses]
    turn, at_mm = poses[front][:3, :3], 1e3 * poses[front][:3, 3]
    shapes = [line for shape in tool.get("shape", []) for line in _solids.edges(shape)]
    for line in shapes:
        ax.plot(*(line @ turn.T + at_mm).T, color="#3f4f63", linewidth=0.6, zorder=9, gid="tool")
    for at in placed[front] if not shapes else []:
        ax.plot(*np.array([at_mm, at]).T, color="#3f4f63", linewidth=0.7, zorder=9)
    every = np.concatenate(placed)
    (mark,) = ax.plot(*every.T, "o", color=_look.colour(0), markersize=2.6, linestyle="none", zorder=10)
    entries.append((mark, "measuring points"))
    return placed


def _loads(
    ax: Any,
    cell: Cell,
    load: dict[str, Any],
    poses: list[NDArray[np.float64]],
    reach: float,
    front: int,
    entries: list[tuple[Any, str]],
) -> list[NDArray[np.float64]]:
    """Loading point and direction of the load in every posture; ropes to their anchors."""
    red = _look.colour(1)
    at = [1e3 * (pose[:3, :3] @ cell.loading_point + pose[:3, 3]) for pose in poses]
    (mark,) = ax.plot(*np.array(at).T, "D", color=red, markersize=3, linestyle="none", zorder=10)
    entries.append((mark, "loading point"))
    seen: list[NDArray[np.float64]] = [np.array(at)]
    arrow = None
    for number, (point, pose) in enumerate(zip(at, poses, strict=True)):
        for one in load.get("case", [load]):
            for direction in _directions(one, load, point, pose):
                length = ARROW * reach
                if "anchor_mm" in one:
                    length = min(length, float(np.linalg.norm(np.array(one["anchor_mm"], dtype=float) - point)))
                tip = point + length * direction
                arrow = ax.quiver(
                    *point, *(tip - point), color=red, linewidth=1.4 if number == front else 0.8,
                    arrow_length_ratio=0.2, zorder=9,
                )  # fmt: skip
                seen.append(tip[np.newaxis])
    anchors = [one["anchor_mm"] for one in load.get("case", [load]) if "anchor_mm" in one]
    if arrow is not None:
        from matplotlib.lines import Line2D

        entries.append((Line2D([], [], color=red, linewidth=1.2, marker=">", markevery=[1]), "load"))
    end: Any = None
    for anchor in anchors:
        place = np.array(anchor, dtype=float)
        ax.plot(*np.array([at[front], place]).T, color=red, linewidth=0.8, linestyle=(0, (3, 2)), zorder=8)
        (end,) = ax.plot(*place[:, np.newaxis], "X", color=red, markersize=5, linestyle="none", zorder=8)
        seen.append(place[np.newaxis])
    if end is not None:
        entries.append((end, "anchor"))
    return seen


def _directions(
    load: dict[str, Any], whole: dict[str, Any], point: NDArray[np.float64], pose: NDArray[np.float64]
) -> Iterator[NDArray[np.float64]]:
    """Unit vector of a load's force; none where only a measurement knows it."""
    kind = load.get("kind")
    force = np.zeros(3)
    if "anchor_mm" in load:
        force = np.array(load["anchor_mm"], dtype=float) - point
        force = -force if load.get("pushes") else force
    elif kind == "weight":
        force = np.array(load.get("gravity", whole.get("gravity", [0.0, 0.0, -1.0])), dtype=float)
    elif kind == "wrench":
        force = np.array(load.get("force_n", [0.0, 0.0, 0.0]), dtype=float)
        force = pose[:3, :3] @ force if load.get("axes") == "tool" else force
    elif "direction" in load:
        force = np.array(load["direction"], dtype=float)
    size = float(np.linalg.norm(force))
    if size > 0:
        yield force / size


def _around(
    ax: Any, keys: dict[str, Any], limits: bool, entries: list[tuple[Any, str]]
) -> list[NDArray[np.float64]]:
    """Obstacles, tracker stations, and the limits that the cell file gives."""
    seen: list[NDArray[np.float64]] = []
    last = None
    for shape in keys.get("obstacle", []):
        for line in _solids.edges(shape):
            (last,) = ax.plot(*line.T, color=_look.colour(2), linewidth=0.9, zorder=1, gid="obstacle")
            seen.append(line)
    if last is not None:
        entries.append((last, "obstacles"))
    stations = [station["position_mm"] for station in keys.get("tracker", {}).get("station", [])]
    if stations:
        (mark,) = ax.plot(*np.array(stations, dtype=float).T, "P", color="black", markersize=5, linestyle="none")
        entries.append((mark, "tracker"))
        seen.append(np.array(stations, dtype=float))
    own = keys.get("limits", {})
    if limits and "box_min_mm" in own and "box_max_mm" in own:
        for line in _solids.box_edges(own["box_min_mm"], own["box_max_mm"]):
            (last,) = ax.plot(*line.T, color="#999999", linewidth=0.6, linestyle=(0, (4, 3)), zorder=0)
            seen.append(line)
        entries.append((last, "box for the tool"))
    if limits and "keep_out_radius_mm" in own:
        angle = np.linspace(0, 2 * np.pi, 49)
        ring = float(own["keep_out_radius_mm"]) * np.array([np.cos(angle), np.sin(angle), 0 * angle])
        (last,) = ax.plot(*ring, color="#999999", linewidth=0.6, linestyle=(0, (1, 1)), zorder=0)
        entries.append((last, "kept free"))
        seen.append(ring.T)
    return seen


def _frame(ax: Any, seen: NDArray[np.float64]) -> None:
    """Equal axes around all of it, few ticks, light panes."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    most = float((high - low).max())
    # A flat arm still has room for the labels of its shortest side.
    half = np.maximum((high - low) / 2 + 0.03 * most, 0.25 * most)
    middle = (low + high) / 2
    low, high = middle - half, middle + half
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_zlim(low[2], high[2])
    ax.set_box_aspect(tuple(high - low))
    step = _step(float((high - low).max()), 4 if ax.figure.get_figwidth() < 5 else 7)
    for i, (axis, name) in enumerate(((ax.xaxis, "x"), (ax.yaxis, "y"), (ax.zaxis, "z"))):
        axis.set_label_text(f"{name} [mm]")
        # Ticks at the very ends would meet those of the next axis.
        ends = (0.07 if i < 2 else 0.01) * (high[i] - low[i])
        axis.set_ticks(np.arange(np.ceil((low[i] + ends) / step) * step, high[i] - ends, step))
        axis.pane.set_facecolor("white")
        axis.pane.set_edgecolor("#cccccc")
        axis._axinfo["grid"].update(color="#e4e4e4", linewidth=0.5)
        axis.labelpad = 1
    ax.tick_params(pad=-1)
    ax.tick_params(axis="z", pad=2)


def _fit(ax: Any, above_in: float) -> None:
    """As large as fits with all labels: how large axes come out depends on the view and on the shape of the cell."""
    figure: Any = ax.figure
    for artist in (*ax.lines, *ax.collections):
        artist.set_clip_on(False)
    low, high = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()]).T
    right, top = figure.get_figwidth(), figure.get_figheight() - above_in
    zoom = 1.0
    start, end = np.zeros(2), np.zeros(2)
    # Labels do not grow with the zoom, hence several steps.
    for _ in range(4):
        ax.set_box_aspect(tuple(high - low), zoom=zoom)
        # They get their places when they are drawn.
        figure.draw_without_rendering()
        start, end = _drawn(ax, low, high) / figure.dpi
        wide, tall = end - start
        zoom *= min((right - 0.15) / wide, (top - 0.12) / tall)
    place = ax.get_position()
    left = place.x0 + (right / 2 - (start[0] + end[0]) / 2) / figure.get_figwidth()
    bottom = place.y0 + (top / 2 - (start[1] + end[1]) / 2) / figure.get_figheight()
    ax.set_position((left, bottom, place.width, place.height))


def _drawn(ax: Any, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lowest and highest corner of what is drawn, the labels of the axes included [dots]."""
    proj3d: Any = importlib.import_module("mpl_toolkits.mplot3d.proj3d")

    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8)
    x, y, _ = proj3d.proj_transform(*corners, ax.get_proj())
    ends = [ax.transData.transform(np.column_stack([x, y]))]
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        for box in (axis.label.get_window_extent(), axis.get_tightbbox()):
            if box is not None:
                ends.append(np.array([box.min, box.max]))
    every = np.concatenate(ends)
    return np.array([every.min(axis=0), every.max(axis=0)])


def _step(span: float, most: int) -> float:
    """A round distance of ticks, at most so many over a span."""
    power = 10 ** np.floor(np.log10(max(span, 1e-9) / most))
    return float(next(power * k for k in (1, 2, 5, 10) if span / (power * k) <= most))


__all__ = ["scene"]
