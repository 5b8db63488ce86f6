"""Figures of simulated and measured identifications."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .._errors import StiffarmError
from .._result import draws
from ..results import Evaluated, Identified, Plan, Simulation, Validated
from . import _look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Half width of the band that holds 95 of 100 components of normal noise.
BAND = 1.96
#: Measuring points that a legend still names one by one.
MOST_NAMED = 12


@draws(Simulation)
def simulation(result: Simulation, *, figure: Figure | None = None, width_in: float = 3.5) -> Figure:
    """Deviation of each k against the size of the noise, a panel per joint: Section IV.A and Fig. 8 of the paper.

    Marks are means of the simulated runs with their standard errors, lines what is expected without simulating. Where
    single runs dominate the mean (a relative standard error above 10 %) the mark is open and is the median.

    Args:
        result: What :func:`stiffarm.simulate` found.
        figure: An empty figure to draw into; a new one unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: A simulation of an arm that gives way beyond its axes, which has no deviations by joint.
    """
    plt = _look.pyplot()
    _look.check(result, Simulation, "what simulate found")
    data = result.to_dict()
    joints: list[str] = data["joints"]
    groups: list[dict[str, Any]] = data["groups"]
    if any("mean_deviation" not in level for group in groups for level in group["levels"]):
        raise StiffarmError("A simulation with elastic= has no deviations by joint.", "unsupported")
    own = figure is None
    with _look.settings(own):
        width_in = width_in if figure is None else figure.get_figwidth()
        columns = 2 if width_in < 5 else min(3, len(joints))
        rows = -(-len(joints) // columns)
        size = (width_in, 1.35 * rows + 0.75)
        drawn: Figure = plt.figure(figsize=size, layout="constrained") if figure is None else figure
        if drawn.get_layout_engine() is None:
            drawn.set_layout_engine("constrained")
        panels = drawn.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        lows, highs = [], []
        for j, (joint, ax) in enumerate(zip(joints, panels.flat, strict=False)):
            if own:
                _look.fix_ticks(ax)
            _look.light_grid(ax)
            ax.set_title(_look.short(joint), loc="left", parse_math=False, pad=3)
            for g, group in enumerate(groups):
                levels = group["levels"]
                x = np.array([level["variance_factor"] for level in levels])
                open_marks = np.array([level["beyond_first_order"][j] for level in levels], dtype=bool)
                mean = 100 * _look.floats([level["mean_deviation"][j] for level in levels])
                median = 100 * _look.floats([level["median_deviation"][j] for level in levels])
                error = 100 * _look.floats([level["standard_error"][j] for level in levels])
                expected_now = 100 * _look.floats([level["expected_deviation"][j] for level in levels])
                ax.plot(x, expected_now, color=_look.colour(g), linestyle=_look.dashes(g), zorder=2)
                for which, y, e, face in (
                    (~open_marks, mean, error, _look.colour(g)),
                    (open_marks, median, None, "white"),
                ):
                    if which.any():
                        bars = None if e is None else np.minimum(e[which], 0.9 * y[which])
                        ax.errorbar(
                            x[which], y[which], bars, fmt=_look.marker(g), color=_look.colour(g),
                            markerfacecolor=face, markeredgewidth=0.8, elinewidth=0.8, zorder=3,
                        )  # fmt: skip
                lows.append(np.nanmin([np.where(open_marks, median, mean), expected_now]))
                highs.append(np.nanmax([np.where(open_marks, median, mean), expected_now]))
        for ax in panels.flat[len(joints) :]:
            ax.set_axis_off()
        if np.min(lows) > 0:
            panels.flat[0].set_ylim(0.7 * np.min(lows), 1.4 * np.max(highs))
            _look.plain_log(panels.flat[0])
        # The lowest panel of each column has the numbers, also where the last row is not full.
        for ax in panels.flat[max(0, len(joints) - columns) : len(joints)]:
            ax.tick_params(labelbottom=True)
        drawn.supxlabel("variance of the noise [× the cell's]", fontsize=plt.rcParams["axes.labelsize"])
        drawn.supylabel("deviation |k̂ − k| / k [%]", fontsize=plt.rcParams["axes.labelsize"])
        _look.legend(drawn, _simulation_entries(groups), width_in - 0.1, loc="outside upper left")
    return drawn


def _simulation_entries(groups: list[dict[str, Any]]) -> list[tuple[Any, str]]:
    from matplotlib.lines import Line2D

    entries = []
    for g, group in enumerate(groups):
        look: dict[str, Any] = {"color": _look.colour(g), "linestyle": _look.dashes(g), "marker": _look.marker(g)}
        entries.append((Line2D([], [], **look), group["name"]))
    entries.append((Line2D([], [], color=_look.GREY, marker="o", linestyle="none"), "simulated"))
    entries.append((Line2D([], [], color=_look.GREY), "expected"))
    if any(any(level["beyond_first_order"]) for group in groups for level in group["levels"]):
        hollow = Line2D([], [], color=_look.GREY, marker="o", markerfacecolor="white", linestyle="none")
        entries.append((hollow, "median, error > 10 %"))
    return entries


@draws(Evaluated, Plan)
def expected(
    value: Evaluated | Plan | Mapping[str, Plan], *, ax: Axes | None = None, width_in: float = 3.5
) -> Axes:
    """Relative standard error of each k that a group of postures leads to one to expect, joint by joint.

    Args:
        value: What :func:`stiffarm.evaluate` found, a plan of :func:`stiffarm.select`, or several by name.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: Something else; a group that leaves joints undetermined has no marks at them.
    """
    rows: list[tuple[str, dict[str, Any]]]
    if isinstance(value, Evaluated):
        data = value.to_dict()
        groups = [group.get("evaluation", group) for group in data["groups"]]
        rows = [(group["name"], {**group, "joints": data["joints"]}) for group in groups]
    else:
        plans = _look.by_name(value, Plan, "what evaluate or select found")
        dicts = {name: plan.to_dict() for name, plan in plans.items()}
        rows = [(name, {**plan["evaluation"], "joints": plan["joints"]}) for name, plan in dicts.items()]
    # The load of a cell may leave joints out.
    longest_first = sorted((row["joints"] for _, row in rows), key=len, reverse=True)
    joints = list(dict.fromkeys(joint for own in longest_first for joint in own))
    with _look.axes(ax, width_in, 2.5) as into:
        _look.light_grid(into, "y")
        entries = []
        for g, (name, row) in enumerate(rows):
            y = 100 * _look.floats(row.get("relative_standard_error") or [None] * len(row["joints"]))
            x = np.array([joints.index(joint) for joint in row["joints"]]) + _side(g, len(rows))
            (line,) = into.plot(x, y, _look.marker(g), color=_look.colour(g), markersize=5)
            entries.append((line, name))
        _look.plain_log(into)
        _look.names_below(into, joints)
        into.set_ylabel("relative standard error of k [%]")
        if len(entries) > 1 or entries[0][1]:
            _look.legend_above(into, entries, own=ax is None)
    return into


@draws(Validated)
def validation(
    value: Validated | Mapping[str, Validated], *, ax: Axes | None = None, width_in: float = 3.5
) -> Axes:
    """Deviation between calculated and measured displacement at each measuring point: Eq. (22) and Fig. 10 of the paper.

    Args:
        value: What :func:`stiffarm.validate` found, or several by name, for example of several groups.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: Something else.
    """
    results = {name: one.to_dict() for name, one in _look.by_name(value, Validated, "what validate found").items()}
    one = len({point["point"] for data in results.values() for point in data["points"]}) == 1
    named = {name: _labels(data["points"], one=one) for name, data in results.items()}
    labels = {label: i for i, label in enumerate(dict.fromkeys(sum(named.values(), [])))}
    with _look.axes(ax, width_in, 2.6) as into:
        _look.light_grid(into, "y")
        entries: list[tuple[Any, str]] = []
        noise = []
        for g, (name, data) in enumerate(results.items()):
            x = np.array([labels[label] for label in named[name]])
            y = 1e3 * _look.floats([point["deviation_m"] for point in data["points"]])
            order = np.argsort(x, kind="stable")
            (line,) = into.plot(
                x[order], y[order], _look.marker(g), color=_look.colour(g), linestyle=_look.dashes(g),
                linewidth=0.6, markerfacecolor=None if g == 0 else "none", markersize=4 + 0.8 * g,
            )  # fmt: skip
            entries.append((line, name or "deviation"))
            if data.get("noise_expectation_m"):
                noise.append(1e3 * data["noise_expectation_m"])
            if data.get("tolerance_m"):
                limit = into.axhline(1e3 * data["tolerance_m"], color="black", linestyle=(0, (6, 2)), linewidth=0.9)
                entries.append((limit, "tolerance"))
        if noise:
            level = into.axhline(float(np.mean(noise)), color=_look.GREY, linestyle=(0, (1, 1)), linewidth=1.2)
            entries.append((level, "noise alone"))
        into.set_ylim(bottom=0)
        _look.names_below(into, list(labels))
        into.set_xlabel("posture" if one else "posture – measuring point")
        into.set_ylabel("deviation δb [mm]")
        _look.legend_above(into, entries, own=ax is None)
    return into


def _labels(points: list[dict[str, Any]], *, one: bool) -> list[str]:
    """Names of points of a validation: posture, point where there are several, load state where it is a further one."""
    out = []
    for point in points:
        name = str(point["posture"]) if one else f"{point['posture']}-{point['point']}"
        state = str(point.get("state") or "loaded")
        out.append(name if state == "loaded" else f"{name} {state}")
    return out


def residuals(result: Identified, *, ax: Axes | None = None, width_in: float = 3.5) -> Axes:
    """What the fit leaves of each displacement component, by posture and measuring point, with the expected scatter.

    A posture outside the band, or one whose points lie together away from zero, has an error of its own, or shows
    that the model lacks something.

    Args:
        result: What :func:`stiffarm.identify` found.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: An identification with the flange fixed, whose residuals are angles.
    """
    _look.check(result, Identified, "what identify found")
    data = result._estimates()
    rows: list[dict[str, Any]] = data.get("postures") or []
    if not rows or not all("residuals" in row for row in rows):
        raise StiffarmError("This result has no residuals of displacements.", "unsupported")
    names = list(dict.fromkeys(row["posture"] for row in rows))
    points = list(dict.fromkeys(one["point"] for row in rows for one in row["residuals"]))
    with _look.axes(ax, width_in, 2.5) as into:
        _look.light_grid(into, "y")
        entries: list[tuple[Any, str]] = []
        for number, point in enumerate(points):
            x, y = [], []
            for row in rows:
                for one in row["residuals"]:
                    if one["point"] == point:
                        x += [names.index(row["posture"]) + _side(number, len(points))] * 3
                        y += [1e3 * component for component in one["residual_m"]]
            (line,) = into.plot(
                x, y, _look.marker(number), color=_look.colour(number), markersize=3.5 if len(names) <= 30 else 2,
                markerfacecolor="none", markeredgewidth=0.8, linestyle="none",
            )  # fmt: skip
            entries.append((line, f"point {point}"))
        if data.get("expected_std_m"):
            half = BAND * 1e3 * data["expected_std_m"]
            band = into.axhspan(-half, half, color="#000000", alpha=0.10, linewidth=0, zorder=0)
            entries.append((band, "95 % of the noise"))
        into.axhline(0, color="black", linewidth=0.6)
        _look.names_below(into, names)
        into.set_xlabel("posture")
        into.set_ylabel("residual component [mm]")
        _look.legend_above(into, entries if len(points) <= MOST_NAMED else entries[-1:], own=ax is None)
    return into


@draws(Identified)
def stiffness(
    value: Identified | Mapping[str, Identified], *, ax: Axes | None = None, width_in: float = 3.5
) -> Axes:
    """Stiffness of each joint with its interval (all errors where they are known), and the cell's prior.

    An arrow is an interval without upper end; a joint that is not determined has no mark, and says so.

    Args:
        value: What :func:`stiffarm.identify` found, or several by name.
        ax: Axes to draw into; new ones unless given.
        width_in: Width of a new figure [in].

    Raises:
        StiffarmError: Something else.
    """
    results = {n: one._estimates() for n, one in _look.by_name(value, Identified, "what identify found").items()}
    springs = list(dict.fromkeys(joint["name"] for data in results.values() for joint in data["joints"]))
    with _look.axes(ax, width_in, 2.5) as into:
        _look.light_grid(into, "y")
        entries: list[tuple[Any, str]] = []
        missing: list[int] = []
        for g, (name, data) in enumerate(results.items()):
            shown = None
            for joint in data["joints"]:
                at = springs.index(joint["name"])
                x, k = at + _side(g, len(results)), joint["stiffness"]
                k = None if k is None else k / 1e3
                low, high = (None if end is None else end / 1e3 for end in joint.get("interval") or (None, None))
                look: dict[str, Any] = {"color": _look.colour(g)}
                if low is not None and high is not None:
                    into.vlines(x, low, high, linewidth=1.2, **look)
                    into.plot([x, x], [low, high], "_", markersize=5, **look)
                elif low is not None:
                    into.plot([x], [low], "_", markersize=5, **look)
                    top = max(1.6 * low, 1.4 * (k or 0.0))
                    arrow = {"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0, **look}
                    into.annotate("", (x, top), (x, low), arrowprops=arrow)
                    into.plot([x], [top], alpha=0)
                if k is None or k <= 0:
                    missing.append(at)
                else:
                    (shown,) = into.plot([x], [k], _look.marker(g), markersize=4.5, **look)
            if shown is not None:
                interval = f"{100 * data['confidence']:g} %" if data.get("confidence") else "interval"
                alone = all(joint.get("interval_holds") == "readings" for joint in data["joints"])
                of = " of the readings" if alone else ""
                entries.append((shown, f"{name}, {interval}{of}" if name else f"identified, {interval} interval{of}"))
        prior = next((data.get("prior_stiffness") for data in results.values() if data.get("prior_stiffness")), None)
        if prior is not None and len(prior) == len(springs):
            line = into.hlines(
                1e-3 * np.array(prior), np.arange(len(prior)) - 0.38, np.arange(len(prior)) + 0.38,
                color="black", linestyle=(0, (1, 1)), linewidth=1.3, zorder=1,
            )  # fmt: skip
            entries.append((line, "prior"))
        _look.plain_log(into)
        for at in sorted(set(missing)):
            into.text(at, 0.04, "not determined", rotation=90, ha="center", transform=into.get_xaxis_transform())
        _look.names_below(into, springs)
        into.set_ylabel("joint stiffness k [kN·m/rad]")
        _look.legend_above(into, entries, own=ax is None)
    return into


def _side(number: int, of: int) -> float:
    """Series of one place stand side by side."""
    return 0.7 * ((number + 0.5) / of - 0.5)


__all__ = ["expected", "residuals", "simulation", "stiffness", "validation"]
