"""Figures of plans by size, of paths, and of maps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _stiffarm
from .._errors import StiffarmError
from .._result import draws
from ..results import Compensated, Curve, Predicted, StiffnessMap
from . import _look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Heading and factor of the values of indices.
VALUES = {
    name: (name.replace("_", " ") + (f" [{unit}]" if unit else ""), factor)
    for name, _, _, unit, factor in _stiffarm.index_names()
}

#: Heading and factor of the values at the nodes of a map.
NODES = {
    "stiffness_n_per_m": ("stiffness along {direction} [N/mm]", 1e-3),
    "softest_n_per_m": ("stiffness in the softest direction [N/mm]", 1e-3),
    "deflection_m": ("deflection under {force} N [mm]", 1e3),
    "half_width_m": ("uncertainty of the deflection, ± [mm]", 1e3),
    "deflection_per_newton_m": ("deflection per newton [µm/N]", 1e6),
    "k_jn": ("k(J_N), Eq. (21) [–]", 1.0),
}


@draws(Curve)
def number_of_postures(result: Curve, *, ax: Axes | None = None, width_in: float = 3.5) -> Axes:
    """The best value found for each number of postures, and the bound below which no plan of as many can go.

    Args:
        result: What :func:`stiffarm.select` with ``curve`` found.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: Something else.
    """
    _look.check(result, Curve, "what select found with curve=True")
    data = result.to_dict()
    heading, factor = VALUES[data["index"]]
    sizes = [size for size in data["sizes"] if size.get("value") is not None]
    with _look.axes(ax, width_in, 2.4) as into:
        _look.light_grid(into)
        x = [size["postures"] for size in sizes]
        (line,) = into.plot(x, [factor * size["value"] for size in sizes], "o-", color=_look.colour(0))
        entries: list[tuple[Any, str]] = [(line, "best found")]
        bounds = [(size["postures"], factor * size["bound"]) for size in sizes if size.get("bound") is not None]
        if bounds:
            (below,) = into.plot(*zip(*bounds, strict=True), "v", color=_look.colour(1), linestyle=(0, (3, 2)))
            entries.append((below, "bound: no plan is below"))
        _look.plain_log(into)
        from matplotlib.ticker import MaxNLocator

        into.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=12 if width_in > 3 else 6))
        into.set_xlabel("number of postures [–]")
        into.set_ylabel(heading, parse_math=False)
        _look.legend_above(into, entries, own=ax is None)
    return into


@draws(Predicted, Compensated)
def deflection(result: Predicted | Compensated, *, ax: Axes | None = None, width_in: float = 3.5) -> Axes:
    """How far the loaded tool bends away along a path, with the band of its uncertainty.

    Of a compensation: the deflection without it, and how much of the band may be left with it.

    Args:
        result: What :func:`stiffarm.predict` or :func:`stiffarm.compensate` found.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: Something else.
    """
    _look.check(result, (Predicted, Compensated), "what predict or compensate found")
    data = result.to_dict()
    points: list[dict[str, Any]] = data["points"]
    key = "deflection_m" if isinstance(result, Predicted) else "uncompensated_m"
    size = 1e3 * _look.floats([point[key] for point in points])
    half = 1e3 * _look.floats([(point.get("band") or {}).get("size_m", [None] * 4)[3] for point in points])
    tips = np.array([point.get("tip_m") or [np.nan] * 3 for point in points], dtype=float)
    steps = 1e3 * np.linalg.norm(np.diff(tips, axis=0), axis=1)
    has_way = len(points) > 1 and bool(np.isfinite(steps).all()) and steps.sum() > 0
    x = np.concatenate([[0.0], np.cumsum(steps)]) if has_way else np.arange(1, len(points) + 1)
    # There is none where the stiffness came without its uncertainty, and no band either.
    confidence = f"{100 * (data['confidence'] or 0):g} %"
    with _look.axes(ax, width_in, 2.4) as into:
        _look.light_grid(into)
        look: dict[str, Any] = {"color": _look.colour(0), "marker": "." if len(points) <= 40 else None, "markersize": 4}
        (line,) = into.plot(x, size, **look)
        entries: list[tuple[Any, str]] = [(line, "predicted" if isinstance(result, Predicted) else "without compensation")]
        if np.isfinite(half).any():
            band = into.fill_between(
                x, np.maximum(size - half, 0), size + half, color=_look.colour(0), alpha=0.25, linewidth=0
            )
            entries.append((band, f"{confidence} band"))
            if isinstance(result, Compensated):
                (left,) = into.plot(x, half, color=_look.colour(1), linestyle=(0, (5, 2)))
                entries.append((left, f"left after compensation, {confidence}"))
        into.set_ylim(bottom=0)
        into.set_xlabel("way along the path [mm]" if has_way else "point of the path [–]")
        into.set_ylabel("deflection [mm]")
        _look.legend_above(into, entries, own=ax is None)
    return into


@draws(StiffnessMap)
def stiffness_map(
    result: StiffnessMap,
    quantity: str = "stiffness_n_per_m",
    *,
    at: tuple[str, float] | None = None,
    ax: Axes | None = None,
    width_in: float = 3.5,
) -> Axes:
    """A slice of a map, with the best and the worst node of the whole map where they lie in it.

    Args:
        result: What :func:`stiffarm.map` found.
        quantity: ``stiffness_n_per_m``, ``softest_n_per_m``, ``deflection_m``, ``half_width_m``,
            ``deflection_per_newton_m`` or ``k_jn``.
        at: Axis and place of the slice, for example ``("z", 800.0)`` [mm]; the nearest nodes are taken. Unless given,
            the plane of the map, or the middle of its z.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: An unknown quantity or axis; a map that is a line.
    """
    _look.check(result, StiffnessMap, "what map found")
    if quantity not in NODES:
        raise StiffarmError(
            f'A map has no "{quantity}".', "unknown-name", {"key": "quantity"}, hint=", ".join(NODES)
        )
    data = result.to_dict()
    grid = [1e3 * np.array(data[f"{axis}_m"]) for axis in "xyz"]
    across, place = _slice(grid, at)
    # Axes shown; z upwards where it is one of them.
    right, up = [axis for axis in range(3) if axis != across]
    if len(grid[right]) < 2 or len(grid[up]) < 2:
        raise StiffarmError("This map is a line, not a plane.", "unsupported")
    values = np.full((len(grid[up]), len(grid[right])), np.nan)
    status = np.full(values.shape, "", dtype=object)
    heading, factor = NODES[quantity]
    inside: dict[int, tuple[float, float]] = {}
    for number, node in enumerate(data["nodes"]):
        at_mm = 1e3 * np.array(node["position_m"])
        if abs(at_mm[across] - grid[across][place]) > 1e-6:
            continue
        row, column = (int(np.argmin(abs(grid[axis] - at_mm[axis]))) for axis in (up, right))
        status[row, column] = node["status"]
        found = _node_value(node, quantity)
        values[row, column] = np.nan if found is None else factor * found
        inside[number] = (at_mm[right], at_mm[up])
    with _look.axes(ax, width_in, width_in * 0.85, "compressed") as into:
        from matplotlib.patches import Patch

        into.set_facecolor("white")
        mesh = into.pcolormesh(grid[right], grid[up], np.ma.masked_invalid(values), cmap="cividis", shading="nearest")
        entries: list[tuple[Any, str]] = []
        for name, hatch in (("forbidden", "////"), ("outside_joint_limits", "...."), ("unreachable", "")):
            cells = status == name
            if cells.any():
                grey = "#e2e2e2" if hatch else "#ffffff"
                _cells(into, grid[right], grid[up], cells, facecolor=grey, hatch=hatch)
                entries.append(
                    (Patch(facecolor=grey, edgecolor="#888888", hatch=hatch, linewidth=0.4), name.replace("_", " "))
                )
        extremes = data.get("extremes") or {}
        for which, mark in (("best", "^"), ("worst", "v")):
            extreme = extremes.get(which)
            if quantity in ("stiffness_n_per_m", "deflection_per_newton_m", "deflection_m") and extreme in inside:
                (point,) = into.plot(
                    *inside[extreme], mark, color="white", markeredgecolor="black", markersize=6, linestyle="none"
                )
                entries.append((point, f"{which} node"))
        if np.isfinite(values).any():
            bar = into.figure.colorbar(mesh, ax=into, pad=0.02, fraction=0.06)
            force = float(np.linalg.norm(data["force_n"])) if data.get("force_n") else float("nan")
            bar.set_label(heading.format(direction=_vector(data["direction"]), force=f"{force:g}"))
        into.set_aspect("equal")
        into.set_xlabel(f"{'xyz'[right]} [mm], at {'xyz'[across]} = {grid[across][place]:g} mm")
        into.set_ylabel(f"{'xyz'[up]} [mm]")
        wide, high = np.ptp(grid[right]), np.ptp(grid[up])
        into.locator_params(axis="x", nbins=5 if wide > 0.8 * high else 3)
        into.locator_params(axis="y", nbins=5 if high > 0.5 * wide else 3)
        _look.legend_above(into, entries, own=ax is None)
    return into


def _slice(grid: list[np.ndarray], at: tuple[str, float] | None) -> tuple[int, int]:
    """Which axis a slice is across, and which of its nodes."""
    if at is not None:
        if at[0] not in ("x", "y", "z"):
            raise StiffarmError(f'There is no axis "{at[0]}".', "unknown-name", {"key": "at"}, hint="x, y or z")
        axis = "xyz".index(at[0])
        low, high = grid[axis].min(), grid[axis].max()
        if not low - 0.5 <= at[1] <= high + 0.5:
            message = f"{at[0]} = {at[1]:g} mm lies outside the map."
            raise StiffarmError(message, "invalid-value", {"key": "at"}, hint=f"{low:g} to {high:g} mm")
        return axis, int(np.argmin(abs(grid[axis] - at[1])))
    single = [axis for axis in range(3) if len(grid[axis]) == 1]
    axis = single[0] if single else 2
    return axis, len(grid[axis]) // 2


def _node_value(node: dict[str, Any], quantity: str) -> float | None:
    values = node.get("values")
    if not values:
        return None
    if quantity == "softest_n_per_m":
        softest: dict[str, float] = values.get("softest") or {}
        return softest.get("stiffness_n_per_m")
    found: float | None = values.get(quantity)
    return found


def _cells(ax: Axes, x: np.ndarray, y: np.ndarray, which: np.ndarray, **look: Any) -> None:
    """Fills the cells of nodes without a value."""
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle

    wide, high = x[1] - x[0], y[1] - y[0]
    boxes = [Rectangle((x[c] - wide / 2, y[r] - high / 2), wide, high) for r, c in np.argwhere(which)]
    ax.add_collection(PatchCollection(boxes, edgecolor="#999999", linewidth=0, **look))


def _vector(value: list[float]) -> str:
    """A direction in few characters: "z" for (0, 0, 1)."""
    v = np.round(np.array(value, dtype=float), 3)
    for axis, name in enumerate("xyz"):
        if abs(abs(v[axis]) - 1) < 1e-3:
            return name if v[axis] > 0 else f"−{name}"
    return "(" + ", ".join(f"{c:g}".replace("-", "−") for c in v) + ")"


__all__ = ["deflection", "number_of_postures", "stiffness_map"]
