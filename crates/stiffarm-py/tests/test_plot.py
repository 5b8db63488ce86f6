"""Figures: each from a real small result, with as many marks as the data has, units at the axes, and names as text."""

from __future__ import annotations

import builtins
import json
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import stiffarm

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.text import Text  # noqa: E402

from stiffarm import plot  # noqa: E402
from stiffarm.plot import _chain  # noqa: E402

HOSTILE = ["$x$", "</script>", "_hidden", "a\nb", "100 %_{2"]


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    """Warnings are errors, and figures are closed."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield
    plt.close("all")


@pytest.fixture(scope="module")
def cell() -> stiffarm.Cell:
    return stiffarm.Cell.built_in("comau")


@pytest.fixture(scope="module")
def group(cell: stiffarm.Cell) -> stiffarm.Postures:
    return stiffarm.Postures.read("builtin:comau-group1", cell)


@pytest.fixture(scope="module")
def plan(cell: stiffarm.Cell) -> stiffarm.results.Plan:
    return stiffarm.select(cell, count=6, rounds=1, seed=1, no_certificate=True)


@pytest.fixture(scope="module")
def fit(cell: stiffarm.Cell, plan: Any) -> stiffarm.results.Identified:
    return stiffarm.identify(cell, stiffarm.simulate_measurements(cell, plan))


def drawn(figure: Any, path: Any = None) -> list[str]:
    """Draws a figure and gives every text in it that is seen."""
    figure.canvas.draw()
    return [text.get_text() for text in figure.findobj(Text) if text.get_visible() and text.get_text()]


def labels_have_units(ax: Any, *, x: bool = True) -> None:
    assert "[" in ax.get_ylabel() and ax.get_ylabel().endswith("]")
    if x:
        assert ax.get_xlabel()


def sizes(figure: Any) -> list[float]:
    return [t.get_fontsize() for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]


def test_simulation_has_a_mark_for_every_joint_group_and_level(cell: Any, group: Any, plan: Any) -> None:
    levels = [0.5, 1.0, 3.0]
    result = stiffarm.simulate(cell, {"Group 1": group, "plan": plan}, runs=20, levels=levels)
    figure = plot.simulation(result)
    panels = [ax for ax in figure.axes if ax.axison]
    assert len(panels) == 6
    for j, ax in enumerate(panels):
        assert ax.get_title(loc="left") == cell.joint_names[j]
        marks = [line for line in ax.lines if line.get_linestyle() == "None"]
        assert sum(len(line.get_xdata()) for line in marks if line.get_marker() in "os") == 2 * len(levels)
        expected = [line for line in ax.lines if line.get_linestyle() != "None"]
        for line, data in zip(expected, result.to_dict()["groups"], strict=True):
            wanted = [100 * level["expected_deviation"][j] for level in data["levels"]]
            np.testing.assert_allclose(line.get_ydata(), wanted)
    texts = drawn(figure)
    assert "variance of the noise [× the cell's]" in texts
    assert any("[%]" in text for text in texts)
    assert {"Group 1", "plan", "simulated", "expected"} <= set(texts)
    assert min(sizes(figure)) >= 8


def test_simulation_draws_medians_open_where_single_runs_dominate(cell: Any, group: Any) -> None:
    result = stiffarm.simulate(cell, group, runs=20, levels=[1.0, 16.0])
    beyond = np.array([level["beyond_first_order"] for level in result.to_dict()["groups"][0]["levels"]])
    assert beyond.any() and not beyond.all()
    figure = plot.simulation(result)
    hollow = sum(
        len(line.get_xdata()) for ax in figure.axes for line in ax.lines if line.get_markerfacecolor() == "white"
    )
    assert hollow == beyond.sum()
    assert any("median" in text for text in drawn(figure))


def test_simulation_of_an_elastic_arm_is_refused(cell: Any, group: Any) -> None:
    result = stiffarm.simulate(cell, group, runs=2, elastic="mixed")
    with pytest.raises(stiffarm.StiffarmError) as error:
        plot.simulation(result)
    assert error.value.code == "unsupported"


def test_expected_errors_are_those_of_the_groups(cell: Any, group: Any, plan: Any) -> None:
    ax = plot.expected(stiffarm.evaluate(cell, {"Group 1": group, "plan": plan}))
    assert len(ax.lines) == 2 and all(len(line.get_xdata()) == 6 for line in ax.lines)
    np.testing.assert_allclose(ax.lines[1].get_ydata(), 100 * plan.evaluation.relative_standard_error)
    labels_have_units(ax)
    alone = plot.expected(plan)
    np.testing.assert_allclose(alone.lines[0].get_ydata(), ax.lines[1].get_ydata())


def test_validation_has_a_mark_for_every_point(cell: Any, fit: Any, group: Any) -> None:
    readings = stiffarm.simulate_measurements(cell, group, seed=3)
    one = stiffarm.validate(cell, fit, readings, tolerance_mm=0.1)
    ax = plot.validation({"plan": one, "nominal": stiffarm.validate(cell, [1e6] * 6, readings)})
    marks = [line for line in ax.lines if line.get_marker() in ("o", "s")]
    assert [len(line.get_xdata()) for line in marks] == [24, 24]
    np.testing.assert_allclose(marks[0].get_ydata(), [1e3 * p["deviation_m"] for p in one.to_dict()["points"]])
    labels_have_units(ax)
    assert {"tolerance", "noise alone", "plan", "nominal"} <= set(drawn(ax.figure))


def test_residuals_are_all_there_with_their_band(fit: Any) -> None:
    ax = plot.residuals(fit)
    marks = [line for line in ax.lines if line.get_marker() not in ("None", None, "")]
    assert len(marks) == 4
    values = np.sort(np.concatenate([line.get_ydata() for line in marks]))
    wanted = [1e3 * c for p in fit.to_dict()["postures"] for r in p["residuals"] for c in r["residual_m"]]
    np.testing.assert_allclose(values, np.sort(wanted))
    (band,) = ax.patches
    ends = band.get_patch_transform().transform_path(band.get_path()).vertices[:, 1]
    assert np.ptp(ends) == pytest.approx(2 * 1.96e3 * fit.expected_std_m)
    labels_have_units(ax)


def test_stiffness_with_intervals_and_prior(fit: Any) -> None:
    ax = plot.stiffness(fit)
    dots = [line for line in ax.lines if line.get_marker() == "o"]
    np.testing.assert_allclose([line.get_ydata()[0] for line in dots], fit.stiffness / 1e3)
    ends = [line.get_ydata() for line in ax.lines if line.get_marker() == "_"]
    wanted = [np.array(j["interval"]) / 1e3 for j in fit.to_dict()["joints"]]
    np.testing.assert_allclose(ends, wanted)
    labels_have_units(ax)
    assert "prior" in drawn(ax.figure)


def test_a_joint_without_stiffness_or_upper_end_says_so(fit: Any) -> None:
    document = json.loads(fit.to_json())
    document["result"]["joints"][0].update(stiffness=None, interval=None)
    document["result"]["joints"][1].update(interval=[2.9e6, None])
    ax = plot.stiffness(stiffarm.results.Identified(json.dumps(document)))
    assert "not determined" in drawn(ax.figure)
    assert sum(line.get_marker() == "o" for line in ax.lines) == 5
    arrows = [child for child in ax.get_children() if getattr(child, "arrow_patch", None) is not None]
    assert len(arrows) == 1


def test_deflection_has_every_point_and_its_band(cell: Any, fit: Any) -> None:
    result = stiffarm.predict(cell, fit, "builtin:contour")
    ax = plot.deflection(result)
    points = result.to_dict()["points"]
    np.testing.assert_allclose(ax.lines[0].get_ydata(), [1e3 * p["deflection_m"] for p in points])
    way = ax.lines[0].get_xdata()
    assert way[0] == 0 and np.all(np.diff(way) > 0)
    highest = ax.collections[0].get_paths()[0].vertices[:, 1].max()
    assert highest == pytest.approx(max(1e3 * (p["deflection_m"] + p["band"]["size_m"][3]) for p in points))
    assert ax.get_xlabel() == "way along the path [mm]"
    labels_have_units(ax)
    both = plot.deflection(stiffarm.compensate(cell, fit, "builtin:contour"))
    assert len(both.lines) == 2 and both.lines[1].get_ydata().max() < ax.lines[0].get_ydata().min()
    with pytest.raises(stiffarm.StiffarmError):
        plot.deflection(fit)


def test_curve_with_its_bound(cell: Any) -> None:
    result = stiffarm.select(cell, curve=True, count=3, rounds=1, index="expected-error")
    ax = plot.number_of_postures(result)
    best, bound = ax.lines
    assert list(best.get_xdata()) == [1, 2, 3]
    assert np.all(bound.get_ydata() <= best.get_ydata())
    labels_have_units(ax)
    classical = plot.number_of_postures(stiffarm.select(cell, curve=True, count=2, rounds=1, index="condition", no_certificate=True))
    assert len(classical.lines) == 1 and "condition" in classical.get_ylabel()


def test_map_has_a_cell_for_every_node(cell: Any) -> None:
    result = stiffarm.map(cell, "prior", steps=4)
    nodes = result.to_dict()["nodes"]
    for at in (None, ("y", 0.0), ("x", 1500.0)):
        ax = plot.stiffness_map(result, at=at)
        mesh = ax.collections[0]
        axis, place = ("z", 1000.0) if at is None else at
        grid = 1e3 * np.array(result.to_dict()[f"{axis}_m"])
        number = len(grid) // 2 if at is None else int(np.argmin(abs(grid - place)))
        slice_ = [n for n in nodes if abs(1e3 * n["position_m"]["xyz".index(axis)] - grid[number]) < 1e-6]
        values = sorted(1e-3 * n["values"]["stiffness_n_per_m"] for n in slice_ if n["values"])
        shown = np.ma.compressed(mesh.get_array())
        np.testing.assert_allclose(np.sort(shown), values)
        assert mesh.get_array().size == len(slice_)
        assert f"[mm], at {axis} = {grid[number]:g} mm" in ax.get_xlabel() and ax.get_ylabel().endswith("[mm]")
        assert "[N/mm]" in ax.figure.axes[-1].get_ylabel()
        ax.figure.canvas.draw()
    with pytest.raises(stiffarm.StiffarmError) as error:
        plot.stiffness_map(result, "colour")
    assert error.value.code == "unknown-name"
    with pytest.raises(stiffarm.StiffarmError):
        plot.stiffness_map(result, at=("w", 0.0))
    with pytest.raises(stiffarm.StiffarmError) as error:
        plot.stiffness_map(result, at=("z", -9999.0))
    assert "outside the map" in error.value.message


def test_cell_has_every_posture_point_and_load(cell: Any, plan: Any) -> None:
    ax = plot.scene(cell, plan, front=2)
    assert sum(line.get_gid() == "posture" for line in ax.lines) == 5
    assert sum(line.get_gid() == "link" for line in ax.lines) >= 10
    reflectors = [line for line in ax.lines if line.get_marker() == "o"]
    assert len(reflectors[0].get_data_3d()[0]) == 6 * 4
    (loading,) = [line for line in ax.lines if line.get_marker() == "D"]
    pose = cell.robot.pose(plan.postures.angles[0])
    at = 1e3 * (pose[:3, :3] @ cell.loading_point + pose[:3, 3])
    np.testing.assert_allclose([axis[0] for axis in loading.get_data_3d()], at)
    assert len(ax.collections) == 6  # one arrow each
    texts = drawn(ax.figure)
    assert {"x [mm]", "y [mm]", "z [mm]"} <= set(texts)
    spans = [np.ptp(limits) for limits in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())]
    np.testing.assert_allclose(ax._box_aspect / ax._box_aspect[0], np.array(spans) / spans[0], rtol=1e-9)
    assert min(sizes(ax.figure)) >= 8
    with pytest.raises(stiffarm.StiffarmError):
        plot.scene(cell, plan, front=6)
    with pytest.raises(stiffarm.StiffarmError):
        plot.scene(cell, plan, ax=plt.figure().add_subplot())
    with pytest.raises(stiffarm.StiffarmError):
        plot.scene(cell, np.zeros((2, 5)))


def test_cell_shows_what_stands_around(plan: Any) -> None:
    ax = plot.scene(stiffarm.Cell.built_in("comau-shapes"), plan)
    assert sum(line.get_gid() == "obstacle" for line in ax.lines) == 3 * 12
    assert any(line.get_gid() == "tool" for line in ax.lines)
    assert "tracker" in drawn(ax.figure)


def test_every_kind_of_load_has_its_direction(cell: Any) -> None:
    q = np.array([[0.1, 0.2, -1.6, 0.3, 0.7, 0.2]])
    turn = cell.robot.pose(q[0])[:3, :3]
    cases: dict[str, tuple[dict[str, Any], np.ndarray]] = {
        "weight": (stiffarm.cell.weight(mass_kg=50), np.array([0.0, 0, -1])),
        "base": (stiffarm.cell.wrench([0, 300, 0]), np.array([0.0, 1, 0])),
        "tool": (stiffarm.cell.wrench([0, 300, 0], axes="tool"), turn[:, 1]),
    }
    for load, direction in cases.values():
        changed = stiffarm.Cell.from_dict({**cell.to_dict(), "load": load, "limits": {}})
        ax = plot.scene(changed, q)
        (arrow,) = ax.collections
        (loading,) = [line for line in ax.lines if line.get_marker() == "D"]
        start = np.array([axis[0] for axis in loading.get_data_3d()])
        tip = max(arrow._segments3d[0], key=lambda end: float(np.linalg.norm(end - start)))
        np.testing.assert_allclose((tip - start) / np.linalg.norm(tip - start), direction, atol=1e-9)
    measured = plot.scene(stiffarm.Cell.built_in("fanuc-r2000ic"))
    assert not measured.collections


@pytest.mark.parametrize("name", ["comau-nj165-3.0", "fanuc-r2000ic165f", "abb-irb4400l-30-243", "kuka-kr210-r2700-2"])
def test_links_turn_with_their_joints(name: str) -> None:
    """Between two bends the arm is rigid: lengths do not change, and it ends at the flange."""
    robot = stiffarm.Robot.catalogue(name)
    rng = np.random.default_rng(7)
    lengths = []
    for _ in range(8):
        q = rng.uniform(-1, 1, robot.joint_count)
        arm = _chain.links(robot, q)
        np.testing.assert_allclose(arm[-1], robot.pose(q)[:3, 3], atol=1e-12)
        lengths.append(np.linalg.norm(np.diff(arm, axis=0), axis=1))
        lines = _chain.axes(robot, q)
        # An axis is where its own angle does not move it.
        for i, (point, direction) in enumerate(lines):
            q2 = q.copy()
            q2[i] += 0.9
            point2, direction2 = _chain.axes(robot, q2)[i]
            np.testing.assert_allclose(direction2, direction, atol=1e-9)
            np.testing.assert_allclose(np.cross(direction, point2 - point), 0, atol=1e-9)
    for one in lengths[1:]:
        np.testing.assert_allclose(one, lengths[0], atol=1e-9)


def test_names_are_text(cell: Any, group: Any, plan: Any) -> None:
    groups = dict.fromkeys(HOSTILE, group)
    shown = {" ".join(name.split()) for name in HOSTILE}
    figure = plot.simulation(stiffarm.simulate(cell, groups, runs=3, levels=[1, 2]))
    assert shown <= set(drawn(figure))
    assert shown <= set(drawn(plot.expected(stiffarm.evaluate(cell, groups)).figure))
    named = stiffarm.Postures(plan.postures.angles[:5], HOSTILE[:3] + ["a b", HOSTILE[4]])
    fit = stiffarm.identify(cell, stiffarm.simulate_measurements(cell, named))
    residuals = plot.residuals(fit)
    assert shown <= {label.get_text() for label in residuals.get_xticklabels()}
    drawn(residuals.figure)
    assert {f"{name}, 95 %" for name in shown} <= set(drawn(plot.stiffness(dict.fromkeys(HOSTILE, fit)).figure))
    assert not any(t.get_parse_math() for t in residuals.get_xticklabels())
    points = stiffarm.Cell.from_dict(
        cell.to_dict() | {"tool": stiffarm.cell.tool([200, 0, 250], {"$x$": [150, 0, 200], "</script>": [0, 150, 200]})}
    )
    fit = stiffarm.identify(points, stiffarm.simulate_measurements(points, plan))
    assert {"point $x$", "point </script>"} <= set(drawn(plot.residuals(fit).figure))
    checked = stiffarm.validate(points, fit, stiffarm.simulate_measurements(points, group, seed=2))
    assert "1-$x$" in drawn(plot.validation(checked).figure)


def test_given_axes_are_drawn_into_and_keep_their_sizes(cell: Any, fit: Any) -> None:
    with plt.rc_context({"font.size": 13, "xtick.labelsize": 13}):
        figure, panels = plt.subplots(1, 2, figsize=(9, 3))
        before = plt.get_fignums()
        assert plot.stiffness(fit, ax=panels[0]) is panels[0]
        assert plot.residuals(fit, ax=panels[1]) is panels[1]
        assert plt.get_fignums() == before
        figure.canvas.draw()
        assert panels[0].get_xticklabels()[0].get_fontsize() == 13
    whole = plt.figure()
    result = stiffarm.simulate(cell, "builtin:comau-group1", runs=3)
    assert plot.simulation(result, figure=whole) is whole
    assert plt.rcParams["font.size"] == plt.rcParamsDefault["font.size"]


def test_texts_are_large_enough_in_a_column(cell: Any, fit: Any, plan: Any) -> None:
    for ax in (plot.stiffness(fit), plot.residuals(fit), plot.scene(cell, plan), plot.expected(plan)):
        drawn(ax.figure)
        assert ax.figure.get_figwidth() == 3.5
        assert min(sizes(ax.figure)) >= 8


def test_nothing_is_shown(cell: Any, plan: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plt, "show", lambda *_, **__: pytest.fail("shown"))
    plot.scene(cell, plan)


def test_without_matplotlib_the_message_says_what_to_install(fit: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **keys: Any) -> Any:
        if name.split(".")[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *rest, **keys)

    for module in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(stiffarm.StiffarmError) as error:
        plot.stiffness(fit)
    assert error.value.code == "unsupported"
    assert error.value.hint == "pip install stiffarm[plot]"


def test_wrong_results_are_refused(fit: Any, plan: Any) -> None:
    for call in (plot.validation, plot.stiffness, plot.expected):
        with pytest.raises(stiffarm.StiffarmError):
            call({"a": 3})  # type: ignore[arg-type]
        with pytest.raises(stiffarm.StiffarmError):
            call({})  # type: ignore[arg-type]
    for one in (plot.simulation, plot.residuals, plot.deflection, plot.number_of_postures, plot.stiffness_map):
        with pytest.raises(stiffarm.StiffarmError, match="is drawn of what"):
            one(plan)  # type: ignore[operator]
    with pytest.raises(stiffarm.StiffarmError, match="axes of matplotlib, got 3"):
        fit.plot(ax=3)
