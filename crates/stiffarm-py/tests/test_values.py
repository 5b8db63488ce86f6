"""Postures, tables, results, cells and robots as values: attributes, pickles, equality, pages in notebooks."""

from __future__ import annotations

import copy
import json
import os
import pickle
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import stiffarm

HOSTILE = '<script>alert("1")</script>&amp;<b>'


@pytest.fixture(scope="module")
def cell() -> stiffarm.Cell:
    return stiffarm.Cell.built_in("comau-reference")


@pytest.fixture(scope="module")
def group(cell: stiffarm.Cell) -> stiffarm.Postures:
    return stiffarm.Postures.read("builtin:comau-group1", cell)


@pytest.fixture(scope="module")
def fit(cell: stiffarm.Cell, group: stiffarm.Postures) -> stiffarm.results.Identified:
    return stiffarm.identify(cell, stiffarm.simulate_measurements(cell, group))


def test_postures(group: stiffarm.Postures) -> None:
    assert (len(group), group.angles.shape, group.name) == (6, (6, 6), "builtin:comau-group1")
    assert group.names == ["1", "2", "3", "4", "5", "6"]
    assert group[1].names == ["2"] and np.array_equal(group[1].angles, group.angles[1:2])
    assert group[-1].names == ["6"]
    assert group[[0, 2]].names == ["1", "3"]
    assert group[1:3].names == ["2", "3"]
    assert group[np.array([True, False] * 3)].names == ["1", "3", "5"]
    assert [row.shape for row in group] == [(6,)] * 6
    assert np.array_equal(np.asarray(group), group.angles)
    assert np.asarray(group, dtype=np.float32).dtype == np.float32
    assert group == stiffarm.Postures(group.angles, group.names)
    assert group != stiffarm.Postures(group.angles, ["x", *group.names[1:]])
    assert group != stiffarm.Postures(group.angles + 1e-16, group.names) or np.array_equal(group.angles, group.angles + 1e-16)
    assert group != "postures"
    assert "6 postures of 6 joints" in repr(group)
    frame = group.to_frame("pandas")
    assert list(frame.columns) == ["posture", *(f"q{j}_deg" for j in range(1, 7))]
    assert frame["posture"].tolist() == group.names


def test_degrees_and_radians_round_trip(cell: stiffarm.Cell, tmp_path: Path) -> None:
    """Angles in degrees come back as they were typed; what was read once does not change any more."""
    random_numbers = np.random.default_rng(1)
    radians = random_numbers.uniform(-1, 0, (500, 6)) * np.array([1.5, 0.5, 0.6, 3.0, 1.5, 3.0]) - [0, 0, 1, 0, 0, 0]
    postures = stiffarm.Postures(radians)
    assert np.array_equal(postures.angles, radians)
    # Some angles lie between those that numbers of degrees reach: these are off by the last bit, once and for all.
    again = stiffarm.Postures(postures.degrees, degrees=True)
    assert np.abs(again.angles - radians).max() <= np.spacing(3.0)
    assert np.array_equal(again.degrees, postures.degrees)
    assert stiffarm.Postures(again.degrees, degrees=True) == again
    postures.save(tmp_path / "own.csv")
    assert stiffarm.Postures.read(tmp_path / "own.csv", cell) == again
    degrees = np.round(random_numbers.uniform(-179, 179, (500, 6)), 2)
    assert np.array_equal(stiffarm.Postures(degrees, degrees=True).degrees, degrees)


def test_arrays_are_read_only_and_ones_own(group: stiffarm.Postures) -> None:
    with pytest.raises(ValueError, match="read-only"):
        group.angles[0, 0] = 1.0
    mine = np.zeros((2, 6))
    postures = stiffarm.Postures(mine)
    mine[0, 0] = 5.0
    assert postures.angles[0, 0] == 0.0
    assert not pickle.loads(pickle.dumps(group)).angles.flags.writeable


def test_tables() -> None:
    table = stiffarm.Table({"name": ["a", "b"], "x_mm": [1.5, None], "n": [1, 2], "good": [True, False]})
    assert list(table) == ["name", "x_mm", "n", "good"] and len(table) == 4 and table.row_count == 2
    assert np.isnan(table["x_mm"][1]) and table["n"].dtype.kind == "i" and table["good"].dtype == bool
    assert table.to_csv() == "name,x_mm,n,good\na,1.5,1,true\nb,,2,false\n"
    assert stiffarm.Table.from_csv(table.to_csv()).to_csv() == table.to_csv()
    with pytest.raises(KeyError):
        table["y"]
    for frame in (table.to_frame("pandas"), table.to_frame("polars"), pyarrow.table(table), polars.DataFrame(table)):
        again = stiffarm.Table.of(frame)
        assert again.to_csv() == table.to_csv(), type(frame)
    assert pyarrow.table(table)["x_mm"].null_count == 1 == table.to_frame("polars")["x_mm"].null_count()
    assert isinstance(table.to_frame(), pandas.DataFrame)
    assert pickle.loads(pickle.dumps(table)) == table == copy.deepcopy(table)
    assert stiffarm.Table({}).to_csv() == "\n" and stiffarm.Table({}).row_count == 0
    numbers = [1e-7, 1e300, 0.1, -0.0, 123456789.123, 5e-324, 1e22]
    again = stiffarm.Table.from_csv(stiffarm.Table({"x_m": numbers}).to_csv())
    assert again["x_m"].tobytes() == np.array(numbers).tobytes()
    quoted = stiffarm.Table({"name": ['a,"b"', "c\nd", "", " e "], "x_mm": [1.0, 2.0, 3.0, 4.0]})
    assert stiffarm.Table.from_csv(quoted.to_csv())["name"] == quoted["name"]
    assert stiffarm.Table.of(pyarrow.table(quoted))["name"] == quoted["name"]


def test_results(
    fit: stiffarm.results.Identified, cell: stiffarm.Cell, group: stiffarm.Postures, tmp_path: Path
) -> None:
    document = json.loads(fit.to_json())
    assert fit.to_dict() == document["result"]
    assert set(fit) == set(document["result"]) and len(fit) == len(document["result"])
    assert fit.command == "identify" and fit.seed == 1 and fit.version == stiffarm.__version__
    assert set(fit.inputs) == {"cell", "measurements"}
    assert fit.command_line == "stiffarm identify builtin:comau-reference '{measurements}'"
    assert fit.options.to_dict() == document["options"]
    joint = fit.joints[0]
    assert isinstance(joint, stiffarm.Record) and joint.stiffness == fit["joints"][0]["stiffness"] == fit.stiffness[0]
    assert joint.interval.shape == (2,) and isinstance(joint.interval, np.ndarray)
    with pytest.raises(AttributeError, match="there are: .*joints"):
        fit.nothing  # noqa: B018
    with pytest.raises(KeyError):
        fit["nothing"]
    assert "joints" in dir(fit)
    changed = fit.to_dict()
    changed["joints"].clear()
    assert fit.joints
    frame = fit.to_frame("pandas")
    assert len(frame) == 6 and list(frame.columns)[:6] == [
        "joint", "stiffness_nm_per_rad", "relative_half_width", "standard_error_nm_per_rad", "interval_low_nm_per_rad",
        "interval_high_nm_per_rad",
    ]  # fmt: skip
    # The intervals of a frame are those of the page, readings and systematic errors together.
    totals = [joint_total["interval_nm_per_rad"] for joint_total in document["result"]["systematic_errors"]["uncertainty"]]
    low, high = (frame[f"interval_{end}_nm_per_rad"] for end in ("low", "high"))
    assert [list(ends) for ends in zip(low, high, strict=True)] == totals
    assert set(frame["interval_holds"]) == {"all_errors"}
    assert (frame["readings_interval_low_nm_per_rad"] > low).all()
    brief = stiffarm.identify(cell, stiffarm.simulate_measurements(cell, group), brief=True)
    assert set(brief.to_frame("pandas")["interval_holds"]) == {"readings"}
    parts = document["result"]["diagnosis"], document["result"]["systematic_errors"]
    assert [f.sentence for f in fit.findings] == [f["sentence"] for part in parts for f in part["findings"]]
    # The verdict of the command with all that it warns of.
    said = " ".join(repr(fit).split())
    assert said.startswith("<Identified: The stiffness is known to ± ")
    assert [f.sentence in said for f in fit.findings] == [f.severity != "note" for f in fit.findings]
    with pytest.raises(stiffarm.StiffarmError, match="exists"):
        fit.save(fit.save(tmp_path / "found.json"))
    assert fit.save(tmp_path / "found.json", overwrite=True).read_text(encoding="utf-8") == fit.to_json()
    assert (tmp_path / "found.json").stat().st_mode & 0o044 == 0o044 & ~umask()


def test_every_result_tells_itself(
    cell: stiffarm.Cell, group: stiffarm.Postures, fit: stiffarm.results.Identified, tmp_path: Path
) -> None:
    """Each is of its class, has its table, is told in words, makes a page, and lives on in a file and in a pickle."""
    full = stiffarm.Cell.built_in("comau")
    measured = stiffarm.simulate_measurements(cell, group)
    quick: dict[str, Any] = {"rounds": 1, "no_certificate": True}
    kinds = stiffarm.results
    results: list[tuple[type[stiffarm.Result], stiffarm.Result]] = [
        (kinds.Checked, stiffarm.check(full)),
        (kinds.Chosen, stiffarm.select(cell, count=4, candidates=group)),
        (kinds.Compensated, stiffarm.compensate(full, "prior", "builtin:contour")),
        (kinds.Coverage, stiffarm.coverage(cell, group, runs=50)),
        (kinds.Curve, stiffarm.select(cell, curve=True, count=4, **quick)),
        (kinds.Dropped, stiffarm.select(cell, given=group, drop=1)),
        (kinds.Evaluated, stiffarm.evaluate(full, group)),
        (kinds.Identified, fit),
        (kinds.Identified, stiffarm.identify(cell, measured, elastic="mixed", bootstrap=200)),
        (kinds.Placement, stiffarm.map(full, "prior", place="builtin:contour", steps=2)),
        (kinds.Plan, stiffarm.select(cell, count=3, sensitivity=True, **quick)),
        (kinds.Plan, stiffarm.select(full, count=3, prices=True, largest_load_n=700, **quick)),
        (kinds.Predicted, stiffarm.predict(full, fit.stiffness, "builtin:contour", matrix=True)),
        (kinds.Registered, stiffarm.register("builtin:example-pairs")),
        (kinds.Simulation, stiffarm.simulate(cell, group, runs=3)),
        (kinds.Simulation, stiffarm.simulate(cell, group, runs=2, elastic="mixed")),
        (kinds.SpaceFilling, stiffarm.select(full, space_filling=True, count=3)),
        (kinds.StiffnessMap, stiffarm.map(full, "prior", plane="z=1200", steps=4)),
        (kinds.Validated, stiffarm.validate(cell, fit, measured)),
        (kinds.Validated, stiffarm.validate(cell, None, measured, folds=3)),
    ]
    for kind, one in results:
        assert type(one) is kind and repr(one).startswith(f"<{kind.__name__}: ")
        frame = one.to_frame("pandas")
        assert len(frame) > 0 and not any(frame[name].isna().all() for name in frame)
        if one.figures():
            assert one.plot() is not None
        shown = one._repr_html_()
        assert shown.startswith("<p><b>") and one.page()._repr_html_().startswith("<iframe srcdoc=")
        assert repr(one.page()).startswith("<Page of ")
        assert str(one) == one.summary().rstrip("\n") and len(one.summary(details=True)) >= len(one.summary()) > 80
        page = one.report(tmp_path / "page.html", overwrite=True).read_text(encoding="utf-8")
        assert page.lower().startswith("<!doctype html>")
        again = kind.load(one.save(tmp_path / "result.json", overwrite=True))
        assert again == one == pickle.loads(pickle.dumps(one)) and again.to_dict() == one.to_dict()
        if one.command != "check":
            with pytest.raises(stiffarm.StiffarmError, match=f"its class is {kind.__name__}, not Checked"):
                kinds.Checked.load(tmp_path / "result.json")


def umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_null_is_nan(cell: stiffarm.Cell) -> None:
    """What a result leaves out is NaN in arrays and numbers, None elsewhere."""
    assert np.isnan(stiffarm.Record({"x": [1.0, None]}).x[1])
    assert stiffarm.Record({"x": [1, 2]}).x.dtype.kind == "i"
    assert stiffarm.Record({"x": [[1, 2], [3, None]]}).x.shape == (2, 2)
    assert stiffarm.Record({"x": [[1], [2, 3]]}).x[1].tolist() == [2, 3]
    assert stiffarm.Record({"x": None}).x is None
    assert stiffarm.Record({"x": ["a", None]}).x == ["a", None]
    few = stiffarm.Postures(np.zeros((1, 6)) - [0, 0, 1.5, 0, 0, 0])
    values = stiffarm.indices(cell, few.angles)
    assert np.isnan(values["expected_error"])
    assert stiffarm.evaluate(cell, few).table()["expected_error"].tolist() == [pytest.approx(np.nan, nan_ok=True)]


def test_the_measured_robot_is_built_in() -> None:
    readings = "builtin:fanuc-r2000ic-readings"
    validated = stiffarm.validate("builtin:fanuc-r2000ic", None, readings, folds="all")
    assert validated.folds == 43 and validated.component_rms_m == pytest.approx(1.340e-4, abs=5e-8)


def test_cells(cell: stiffarm.Cell, tmp_path: Path) -> None:
    assert cell.joint_count == 6 and len(cell.joint_names) == 6 and cell.spring_names == cell.joint_names
    assert cell.limits.shape == cell.bounds.shape == (6, 2)
    assert np.array_equal(np.degrees(cell.bounds[1]).round(12), [-60, 40])
    assert cell.prior_stiffness is not None and cell.prior_stiffness.tolist() == [95e4, 3e6, 9e5, 25e4, 2e5, 15e4]
    assert cell.noise_std == pytest.approx(np.sqrt(9.23e-11), rel=1e-12)
    assert cell.characteristic_length == 0.773
    assert cell.loading_point.tolist() == [0.2, 0.0, 0.25]
    assert {name: at.tolist() for name, at in cell.measuring_points.items()}["2"] == [0.0, 0.15, 0.2]
    assert stiffarm.Cell.built_in("fanuc-r2000ic").prior_stiffness is None
    assert cell.file == "builtin:comau-reference" and repr(cell).startswith("<Cell ")

    more = cell.with_changes({"load": {"magnitude_n": 600}, "name": "more"})
    assert more.name == "more" and more.to_dict()["load"] == {**cell.to_dict()["load"], "magnitude_n": 600}
    assert cell.to_dict()["load"]["magnitude_n"] == 500
    assert more.with_changes({"load": {"magnitude_n": 500}, "name": cell.name}).to_dict() == cell.to_dict()
    hung = cell.with_changes({"load": stiffarm.cell.weight(mass_kg=30)})
    assert hung.to_dict()["load"] == {"kind": "weight", "mass_kg": 30.0}
    assert "stiffness" not in cell.with_changes({"stiffness": None}).to_dict()

    again = stiffarm.Cell.from_dict(cell.to_dict())
    assert again.to_dict() == cell.to_dict()
    evaluated = stiffarm.evaluate(again, "builtin:comau-group1").to_dict()
    assert evaluated == stiffarm.evaluate(cell, "builtin:comau-group1").to_dict()
    saved = stiffarm.Cell(cell.save(tmp_path / "cell.toml"))
    assert saved == cell and hash(saved) == hash(cell) and saved != more
    assert stiffarm.Cell.from_toml("\ufeff" + cell.to_toml()).to_toml() == cell.to_toml()
    assert len({cell, saved, more}) == 2


def test_robots(cell: stiffarm.Cell) -> None:
    robot = cell.robot
    assert robot.name.startswith("COMAU") and robot.joint_count == 6 and robot.limits.shape == (6, 2)
    rows = [[0, 0, 400, 0], [-90, 150, 0, -90], [0, 700, 0, 0]]
    three = stiffarm.Robot.dh(rows, limits_deg=[[-180, 180]] * 3, name="three")
    assert three == pickle.loads(pickle.dumps(three)) and three != robot and three.name == "three"
    q = np.array([0.3, -0.4, 0.9])
    step = 1e-6
    for j in range(3):
        moved = (three.pose(q + step * np.eye(3)[j]) - three.pose(q - step * np.eye(3)[j]))[:3, 3] / (2 * step)
        assert np.allclose(three.jacobian(q)[:3, j], moved, atol=1e-8)
    at = robot.pose(np.radians([10, -20, -100, 30, 40, 50]))
    branches = robot.inverse(at)
    assert any(np.allclose(branch.angles, np.radians([10, -20, -100, 30, 40, 50])) for branch in branches)
    for branch in branches:
        assert np.allclose(robot.pose(branch.angles), at, atol=1e-9)
    assert np.allclose(robot.pose(robot.nearest(at, np.zeros(6))), at, atol=1e-9)


VALUES = """
import pickle, sys, stiffarm
values = pickle.load(open(sys.argv[1], "rb"))
pickle.dump(values, open(sys.argv[2], "wb"))
cell = values[0]
print(stiffarm.select(cell, count=3, rounds=1, no_certificate=True).to_json(), end="")
"""


def test_pickles(fit: stiffarm.results.Identified, group: stiffarm.Postures, tmp_path: Path) -> None:
    """Cells with their meshes, robots, results and errors live on in another process."""
    shapes = stiffarm.Cell.built_in("comau-shapes")
    # An obstacle of a mesh beside the cell file, which is gone when the cell comes back.
    mesh = tmp_path / "table.obj"
    mesh.write_text("v 2 0 0\nv 3 0 0\nv 2 1 0\nv 2 0 0.5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", encoding="utf-8")
    obstacle = {"name": "table", "kind": "mesh", "file": "table.obj", "unit": "m"}
    with_mesh = stiffarm.Cell.from_dict({**shapes.to_dict(), "obstacle": [obstacle]}, folder=tmp_path)
    assert list(with_mesh.inputs) == ["cell", "cell mesh table.obj"]
    mesh.unlink()
    objective = stiffarm.Objective(shapes, "d", postures=3, given=group)
    values: list[Any] = [shapes, with_mesh, with_mesh.robot, group, fit, fit.joints[0], group.table(), objective]
    values.append(stiffarm.StiffarmError("No.", "usage", {"key": "x"}, "yes"))
    with (tmp_path / "in").open("wb") as file:
        pickle.dump(values, file)
    words = [sys.executable, "-c", VALUES, str(tmp_path / "in"), str(tmp_path / "out")]
    printed = subprocess.run(words, stdout=subprocess.PIPE, check=True, encoding="utf-8").stdout
    assert printed == stiffarm.select(shapes, count=3, rounds=1, no_certificate=True).to_json()
    with (tmp_path / "out").open("rb") as file:
        again = pickle.load(file)
    for before, after in zip(values[:5], again[:5], strict=True):
        assert after == before and type(after) is type(before)
    assert again[1].inputs == with_mesh.inputs and again[5].to_dict() == values[5].to_dict() and again[6] == values[6]
    q = group.angles[:3]
    assert again[7](q) == objective(q)
    assert str(again[8]) == str(values[8])


def tags(page: str) -> set[str]:
    """Kinds of elements of a page; an attribute anywhere counts as one."""
    tags: set[str] = set()

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            tags.update([tag, *(f"{tag} {name}" for name, _ in attrs)])

    Reader().feed(page)
    return tags


def test_pages(cell: stiffarm.Cell, fit: stiffarm.results.Identified) -> None:
    """What notebooks show: names are text, whatever they are."""
    named = stiffarm.Postures(np.zeros((2, 6)) - [0, 0, 1.5, 0, 0, 0], [HOSTILE, "2"])
    shown = [named._repr_html_(), stiffarm.Table({HOSTILE: [1.0], "x": [HOSTILE]})._repr_html_()]
    measured = stiffarm.simulate_measurements(cell, "builtin:comau-group1").to_frame("pandas")
    measured["posture"] = HOSTILE + measured["posture"].astype(str)
    shown.append(stiffarm.identify(cell, measured)._repr_html_())
    shown.append(stiffarm.evaluate(cell, {HOSTILE: named})._repr_html_())
    for page in shown:
        elements = {tag for tag in tags(page) if " " not in tag}
        attributes = {tag.split()[1] for tag in tags(page) - elements}
        assert elements <= {"p", "b", "table", "thead", "tbody", "tr", "th", "td", "ul", "li", "span", "code", "div", "strong"}, page
        plain = ("class", "scope", "role", "tabindex")
        assert all(name in plain or name.startswith(("aria-", "data-")) for name in attributes), page
    assert "&lt;script&gt;" in shown[0]
    for page in (fit._repr_html_(), stiffarm.select(cell, count=3, rounds=1)._repr_html_()):
        assert page.count("<table") == page.count("</table>") == 1
    many = stiffarm.Table({"x": list(range(100))})._repr_html_()
    assert "80 further rows" in many and many.count("<tr>") == 21


def test_degrees_that_are_taken_for_radians_are_refused() -> None:
    cell = stiffarm.Cell.built_in("comau")
    degrees = stiffarm.select(cell, space_filling=True, count=4).postures.degrees
    calls = [
        lambda: stiffarm.Postures(degrees),
        lambda: stiffarm.indices(cell, degrees),
        lambda: stiffarm.indices(cell, [degrees]),
        lambda: stiffarm.observation_matrix(cell, degrees),
        lambda: stiffarm.simulate(cell, degrees, runs=10),
        lambda: stiffarm.certificate(cell, degrees),
    ]
    for call in calls:
        with pytest.raises(stiffarm.StiffarmError) as error:
            call()
        assert error.value.hint is not None and "degrees=True" in error.value.hint
    assert stiffarm.indices(cell, degrees, degrees=True)["condition"] > 1


def test_degrees_that_a_robot_takes_for_radians_are_refused() -> None:
    cell = stiffarm.Cell.built_in("comau")
    robot, degrees = cell.robot, [0, 0, -90, 0, 45, 0]
    objective = stiffarm.Objective(cell, postures=6)
    calls = [
        lambda: robot.pose(degrees),
        lambda: robot.jacobian(degrees),
        lambda: robot.nearest(robot.pose(np.radians(degrees)), degrees),
        lambda: objective([degrees] * 6),
        lambda: objective.log_and_gradient([degrees] * 6),
        lambda: objective.smoothed([degrees] * 6, 10.0),
    ]
    for call in calls:
        with pytest.raises(stiffarm.StiffarmError, match="An angle is -90 rad, which is -5157°") as error:
            call()
        assert error.value.hint is not None and "degrees=True" in error.value.hint
    at, turned = robot.pose(degrees, degrees=True), stiffarm.Postures([degrees], degrees=True)
    assert np.array_equal(at, robot.pose(turned)) and np.array_equal(at, robot.pose(turned, degrees=True))
    assert np.array_equal(robot.jacobian(degrees, degrees=True), robot.jacobian(turned))
    assert np.allclose(robot.nearest(at, degrees, degrees=True), turned.angles[0])


def test_a_changed_built_in_cell_is_the_one_that_is_used(tmp_path: Path) -> None:
    cell = stiffarm.Cell.built_in("comau")
    heavier, lighter = (cell.with_changes({"load": {"magnitude_n": force}}) for force in (900, 300))
    assert heavier.file == "<cell>" and stiffarm.check(heavier).inputs == heavier.inputs != cell.inputs
    assert stiffarm.check(heavier).command_line == "stiffarm check '{cell}'"
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    errors = [stiffarm.indices(one, group, ["expected_error"])["expected_error"] for one in (cell, heavier)]
    evaluated = [stiffarm.evaluate(one, group) for one in (cell, heavier, lighter)]
    assert [one.table()["expected_error"][0] for one in evaluated[:2]] == pytest.approx(errors, rel=1e-9)
    assert errors[0] > errors[1]
    # Two cells of one name at once.
    page = stiffarm.report(evaluated[1:], cell=[heavier, lighter], output=str(tmp_path / "page.html"))
    assert page.inputs["cell"] in (heavier.inputs["cell"], lighter.inputs["cell"])


def test_groups_have_their_names(
    cell: stiffarm.Cell, group: stiffarm.Postures, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever it is: a folder, an option, markup."""
    for name in ("a/b", "-x", "plan.2", "Group 1", "100 %", HOSTILE, "größer"):
        assert stiffarm.evaluate(cell, {name: group, "other": group[:5]}).table()["group"] == [name, "other"]
    named = stiffarm.Postures(group.angles, name="mine")
    assert stiffarm.evaluate(cell, [named, group.angles]).table()["group"] == ["mine", "group 2"]
    assert stiffarm.evaluate(cell, named.angles).table()["group"] == ["postures"]
    # Two groups of one name, and one of the name of a file.
    group[:4].save(tmp_path / "mine.csv")
    monkeypatch.chdir(tmp_path)
    table = stiffarm.evaluate(cell, [named, named[:5], "mine.csv"]).table()
    assert table["group"] == ["mine", "mine (2)", "mine (3)"] and table["postures"].tolist() == [6, 5, 4]
    for form in (group, "builtin:comau-group1"):
        assert stiffarm.evaluate(cell, form).table()["group"] == ["comau-group1"]


def test_a_wrong_keyword_is_said_with_the_function_and_the_name_that_was_meant() -> None:
    cell = stiffarm.Cell.built_in("comau")
    wrong: dict[str, Any] = {"indx": "d"}
    with pytest.raises(TypeError, match=r"^select\(\) got an unexpected keyword argument 'indx'\. Did you mean 'index'\?$"):
        stiffarm.select(cell, **wrong)
    with pytest.raises(TypeError, match=r"^select\(\) got an unexpected keyword argument 'zzz'$"):
        stiffarm.select(cell, **{"zzz": 1})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^identify\(\) missing a required argument: 'measurements'$"):
        stiffarm.identify(cell)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"^select\(\) got too many positional arguments$"):
        stiffarm.select(cell, 6, 7)  # type: ignore[misc]


def test_a_frame_of_postures_is_in_the_unit_that_its_headings_say() -> None:
    cell = stiffarm.Cell.built_in("comau")
    postures = stiffarm.select(cell, space_filling=True, count=4).postures
    frame = postures.to_frame()
    assert stiffarm.Postures.of(frame) == postures
    assert stiffarm.Postures.of(frame.drop(columns="posture")) == postures
    indices = stiffarm.indices(cell, postures.angles, ["d"])
    assert stiffarm.indices(cell, frame, ["d"]) == stiffarm.indices(cell, postures, ["d"]) == indices
    assert np.array_equal(stiffarm.observation_matrix(cell, frame), stiffarm.observation_matrix(cell, postures.angles))
    with pytest.raises(stiffarm.StiffarmError, match="not those of postures"):
        stiffarm.Postures.of(frame.rename(columns={"q2_deg": "q2"}))
    # The frame of a path has what its points are beside their postures.
    bend = stiffarm.predict(cell, "prior", postures, cell_load=True)
    assert stiffarm.Postures.of(bend.to_frame()) == postures
    # A table of readings has each of its postures many times.
    with pytest.raises(stiffarm.StiffarmError, match="not those of postures: state, dx_mm"):
        stiffarm.Postures.of(stiffarm.simulate_measurements(cell, postures))


def test_arrays_of_a_result_cannot_be_written_to(fit: stiffarm.results.Identified) -> None:
    for array in (fit.joints[0].interval, fit.covariance):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_serious_findings_of_readings_are_counted() -> None:
    cell = stiffarm.Cell.built_in("comau")
    plan = stiffarm.select(cell, space_filling=True, count=8)
    table = stiffarm.simulate_measurements(cell, plan, readings=True)
    sound = stiffarm.identify(cell, table, brief=True)
    assert "SERIOUS" not in repr(sound) and "Not usable" not in sound._repr_html_()
    frame = table.to_frame()
    exchanged = (frame.posture == "3") & frame.point.isin(["1", "2"])
    frame.loc[exchanged, "point"] = frame.loc[exchanged, "point"].map({"1": "2", "2": "1"})
    wrong = stiffarm.identify(cell, frame, brief=True)
    assert [finding.code for finding in wrong.findings if finding.severity == "serious"] == ["exchanged-points"]
    assert repr(wrong).count("SERIOUS: ") == 1 and "Not usable as it is." in wrong._repr_html_()


def test_plates_leave_joint_1_out_everywhere(cell: stiffarm.Cell, group: stiffarm.Postures) -> None:
    hung = cell.with_changes({"load": stiffarm.cell.weight(mass_kg=50), "task": None})
    evaluated = stiffarm.evaluate(hung, group)
    assert evaluated.to_dict()["joints"] == [f"joint {j}" for j in range(2, 7)]
    assert [finding.subject for finding in evaluated.findings if finding.code == "joint-left-out"] == ["joint 1"]
    of_arrays = stiffarm.indices(hung, group.angles, ["expected_error", "d"])
    for name, value in of_arrays.items():
        assert value == pytest.approx(evaluated.to_dict()["groups"][0]["indices"][name], rel=1e-9)
    ticks = evaluated.plot("expected-deviation").axes[0].get_xticklabels()
    assert [tick.get_text() for tick in ticks] == [f"joint {j}" for j in range(2, 7)]


def test_dropped_postures_are_no_longer_there() -> None:
    cell = stiffarm.Cell.built_in("comau")
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    fewer = stiffarm.select(cell, index="expected_error", given=group, drop=2)
    staying = [name for name, stays in zip(fewer.table()["posture"], fewer.table()["kept"]) if stays]
    assert fewer.postures.names == staying and len(staying) == 4
    value = stiffarm.evaluate(cell, fewer).table()["expected_error"][0]
    assert value == pytest.approx(fewer.to_dict()["value"], rel=1e-12)


def test_what_is_no_cell_and_no_stiffness_is_named() -> None:
    cell = stiffarm.Cell.built_in("comau")
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    with pytest.raises(stiffarm.StiffarmError) as error:
        stiffarm.evaluate(None, group)  # type: ignore[arg-type]
    assert (error.value.place, error.value.message) == ({"key": "cell"}, "A Cell is needed, got None.")
    with pytest.raises(stiffarm.StiffarmError) as error:
        stiffarm.predict(cell, group, "builtin:contour", force_n=[0, 0, 100], axes="base")
    assert error.value.place == {"key": "stiffness"} and "holds no stiffness" in error.value.message
