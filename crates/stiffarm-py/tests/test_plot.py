"""Figures: drawn from the page's own figures, every number of them, with units at the axes, and names as text."""

from __future__ import annotations

import builtins
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
def identified(cell: stiffarm.Cell, plan: Any) -> stiffarm.results.Identified:
    return stiffarm.identify(cell, stiffarm.simulate_measurements(cell, plan))


@pytest.fixture(scope="module")
def results(cell: stiffarm.Cell, group: Any, plan: Any, identified: Any) -> dict[str, Any]:
    """A result of every command whose page has figures."""
    groups = {"Group 1": group, "plan": plan}
    return {
        "select": plan,
        "curve": stiffarm.select(cell, curve=True, count=3, rounds=1, index="expected-error"),
        "evaluate": stiffarm.evaluate(cell, groups),
        "simulate": stiffarm.simulate(cell, groups, runs=20, levels=[0.5, 1.0, 16.0]),
        "elastic": stiffarm.simulate(cell, group, runs=2, elastic="mixed"),
        "identify": identified,
        "validate": stiffarm.validate(cell, identified, stiffarm.simulate_measurements(cell, group, seed=3), tolerance_mm=0.1),
        "predict": stiffarm.predict(cell, identified, "builtin:contour"),
        "compensate": stiffarm.compensate(cell, identified, "builtin:contour"),
        "map": stiffarm.map(cell, "prior", steps=4),
        "plane": stiffarm.map(cell, "prior", steps=5, from_mm=[900, -900, 1000], to_mm=[2500, 900, 1000]),
    }


NAMES = ["select", "curve", "evaluate", "simulate", "elastic", "identify", "validate", "predict", "compensate", "map", "plane"]


def texts(figure: Any) -> list[str]:
    """Draws a figure and gives every text in it that is seen."""
    figure.canvas.draw()
    return [text.get_text().replace("\n", " ") for text in figure.findobj(Text) if text.get_visible() and text.get_text()]


def heading(axis: dict[str, Any]) -> str:
    return " ".join(part for part in (axis["label"], f"[{axis['unit']}]" if axis["unit"] else "") if part)


def numbers(panel: dict[str, Any], ax: Any, style: tuple[str, ...]) -> None:
    """The values of series with these styles are those of the lines of the axes."""
    drawn = [np.asarray(line.get_ydata(), dtype=float) for line in ax.lines]
    for series in panel["series"]:
        if series["style"] in style and series["y"]:
            wanted = np.array([np.nan if y is None else y for y in series["y"]], dtype=float)
            assert any(len(y) == len(wanted) and np.allclose(y, wanted, equal_nan=True) for y in drawn), series["label"]


@pytest.mark.parametrize("name", NAMES)
def test_every_figure_of_a_page_is_drawn_with_its_values(results: dict[str, Any], name: str) -> None:
    result = results[name]
    figures = result.figures()
    assert figures and result.plot().axes
    for figure_name, data in figures.items():
        for width in (3.5, 7.0):
            figure = result.plot(figure_name, width_in=width)
            said = texts(figure)
            # A colour bar is an axes of its own.
            panels = [ax for ax in figure.axes if ax.axison and ax.get_label() != "<colorbar>"]
            assert len(panels) == len(data["panels"]), figure_name
            for panel, ax in zip(data["panels"], panels, strict=True):
                numbers(panel, ax, ("Line", "Curve", "Dashed", "Points", "Hollow", "Outline", "Path"))
                bars = [series for series in panel["series"] if series["style"] == "Bars"]
                if bars and panel["y"]["scale"] == "Linear":
                    heights = np.concatenate([[bar.get_height() for bar in group] for group in ax.containers])
                    wanted = np.concatenate([[0.0 if y is None else y for y in series["y"]] for series in bars])
                    np.testing.assert_allclose(np.nan_to_num(heights), wanted)
                for axis in ("x", "y"):
                    assert heading(panel[axis]) in {*said, ""}, (figure_name, heading(panel[axis]))
            labels = {series["label"] for panel in data["panels"] for series in panel["series"] if series["style"] != "Map"}
            assert {" ".join(label.split()) for label in labels} - {""} <= set(said), figure_name
            # Sizes of a journal; exponents are smaller.
            sizes = [text.get_fontsize() for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
            assert min(sizes) >= 8 and figure.get_figwidth() == width


def test_looks_and_ends_of_axes_are_those_of_the_page(identified: Any) -> None:
    data = identified.figures()["joint-stiffness"]
    page = identified.page()
    ax = identified.plot("joint-stiffness").axes[0]
    for (colour, _, _), series in zip(data["shown"][0]["series"], data["panels"][0]["series"], strict=True):
        assert colour in page
        same = [line for line in ax.lines if len(line.get_ydata()) == len(series["y"]) and np.allclose(line.get_ydata(), series["y"])]
        assert colour in [line.get_color() for line in same]
    np.testing.assert_allclose(ax.get_ylim(), data["shown"][0]["y"])
    assert len(ax.collections) >= 6  # an interval each


def test_the_cells_of_a_map_are_its_nodes(results: dict[str, Any]) -> None:
    data = results["plane"].figures()["map"]
    figure = results["plane"].plot("map")
    mesh = next(c for c in figure.axes[0].collections if c.get_array() is not None)
    values = [v for v in data["panels"][0]["series"][0]["colour"]["values"] if v is not None]
    np.testing.assert_allclose(np.sort(np.ma.compressed(mesh.get_array())), np.sort(values))
    assert figure.axes[-1].get_ylabel().endswith("]")


def test_an_interval_that_is_open_above_is_an_arrow(identified: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = identified.figures()
    figures["joint-stiffness"]["panels"][0]["series"][0]["interval"][1][1] = None
    monkeypatch.setattr(type(identified), "figures", lambda _: figures)
    ax = identified.plot("joint-stiffness", panel=0).axes[0]
    assert len([child for child in ax.get_children() if getattr(child, "arrow_patch", None) is not None]) == 1


def test_several_results_have_the_same_axes(identified: Any) -> None:
    figure = plot.figure({"first": identified, "second": identified}, "joint-stiffness", width_in=7)
    assert [ax.get_title(loc="left") for ax in figure.axes[::2]] == ["first: stiffness", "second: stiffness"]
    assert figure.axes[0].get_ylim() == figure.axes[2].get_ylim()


def test_axes_of_ones_own_keep_their_sizes(identified: Any) -> None:
    with plt.rc_context({"font.size": 13, "xtick.labelsize": 13}):
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3))
        before = plt.get_fignums()
        assert identified.plot(ax=left) is figure
        assert identified.plot("residuals", panel=1, ax=right) is figure
        assert plt.get_fignums() == before
        figure.canvas.draw()
        assert left.get_xticklabels()[0].get_fontsize() == 13
    assert plt.rcParams["font.size"] == plt.rcParamsDefault["font.size"]


def test_names_are_text(cell: Any, group: Any, plan: Any) -> None:
    groups = dict.fromkeys(HOSTILE, group)
    shown = {name.replace("\n", "\\n") for name in HOSTILE}
    assert shown <= set(texts(stiffarm.evaluate(cell, groups).plot()))
    named = stiffarm.Postures(plan.postures.angles[:5], [*HOSTILE[:3], "a b", HOSTILE[4]])
    figure = stiffarm.identify(cell, stiffarm.simulate_measurements(cell, named)).plot("residuals")
    assert {*HOSTILE[:3], "a b", HOSTILE[4]} <= {label.get_text() for label in figure.axes[0].get_xticklabels()}
    assert not any(text.get_parse_math() for text in figure.axes[0].get_xticklabels())


@pytest.mark.parametrize("view", ["side", "above", "perspective"])
def test_a_cell_is_the_drawing_of_its_page(plan: Any, view: str) -> None:
    cell = stiffarm.Cell.built_in("comau-shapes")
    figure = plot.cell(cell, plan, full=2, view=view)
    said = set(texts(figure))
    assert {"arm", "tool", "measuring point", "loading point", "posture 1"} <= said and "posture 3" not in said
    (ax,) = figure.axes
    assert ax.get_aspect() == 1.0 and len(ax.patches) > 10
    if view != "perspective":
        assert {"x [mm]"} <= said
        # The loading point of the posture in full is where kinematics says.
        pose = cell.robot.pose(plan.postures.angles[2])
        place = 1e3 * (pose[:3, :3] @ cell.loading_point + pose[:3, 3])
        flat = place[[0, 2 if view == "side" else 1]]
        (mark,) = [line for line in ax.lines if line.get_marker() == "D" and len(line.get_xdata()) == 1 and line.get_color() == "#8a4b08"]
        np.testing.assert_allclose([mark.get_xdata()[0], mark.get_ydata()[0]], flat, atol=0.02)
    assert plot.cell(cell).axes


@pytest.mark.parametrize(
    ("call", "code", "key"),
    [
        (lambda r: r["identify"].plot("colour"), "unknown-name", "name"),
        (lambda r: r["identify"].plot(panel=7), "invalid-value", "panel"),
        (lambda r: r["identify"].plot(ax=3), "wrong-type", "ax"),
        (lambda r: plot.figure({}), "wrong-type", "result"),
        (lambda r: plot.figure({"a": 3}), "wrong-type", "result"),
        (lambda r: plot.cell(stiffarm.Cell.built_in("comau"), r["select"], full=6), "invalid-value", "full"),
        (lambda r: plot.cell(stiffarm.Cell.built_in("comau"), r["select"], view="below"), "unknown-name", "view"),
        (lambda r: plot.cell(stiffarm.Cell.built_in("comau"), np.zeros((2, 5))), "dimension", "postures"),
        (lambda r: plot.cell(stiffarm.Cell.built_in("comau"), ax=3), "wrong-type", "ax"),
    ],
)
def test_what_cannot_be_drawn_is_refused(results: dict[str, Any], call: Any, code: str, key: str) -> None:
    with pytest.raises(stiffarm.StiffarmError) as error:
        call(results)
    assert (error.value.code, error.value.place["key"]) == (code, key)


def test_nothing_is_shown(cell: Any, plan: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plt, "show", lambda *_, **__: pytest.fail("shown"))
    plot.cell(cell, plan)
    plan.plot()


def test_without_matplotlib_the_message_says_what_to_install(identified: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **keys: Any) -> Any:
        if name.split(".")[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *rest, **keys)

    for module in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(stiffarm.StiffarmError) as error:
        identified.plot()
    assert error.value.code == "unsupported"
    assert error.value.hint == "pip install stiffarm[plot]"
