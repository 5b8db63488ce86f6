"""One input in every form that Python has for it, in memory and as a file, gives one result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import stiffarm

CELL = stiffarm.Cell.built_in("comau")


@pytest.fixture(scope="module")
def plan() -> stiffarm.Postures:
    return stiffarm.select(CELL, space_filling=True, count=8, seed=3).postures


@pytest.fixture(scope="module")
def measured(plan: stiffarm.Postures) -> stiffarm.Table:
    return stiffarm.simulate_measurements(CELL, plan, seed=5)


def unsigned(result: stiffarm.Result) -> dict[str, Any]:
    """All of a result but the words of the command line, in which inputs have names."""
    document: dict[str, Any] = json.loads(result.to_json())
    return {key: value for key, value in document.items() if key not in ("arguments", "seal")}


def test_postures(plan: stiffarm.Postures, tmp_path: Path) -> None:
    file = plan.save(tmp_path / "plan.csv")
    table = plan.table()
    forms: dict[str, Any] = {
        "file": file,
        "name of a file": str(file),
        "postures": plan,
        "table": table,
        "mapping": dict(table),
        "pandas": plan.to_frame("pandas"),
        "polars": plan.to_frame("polars"),
        "pyarrow": pyarrow.table(table),
        "pandas.read_csv": pandas.read_csv(file, dtype={"posture": str}),
        "polars.read_csv": polars.read_csv(file),
        "pandas with names as numbers": pandas.read_csv(file),
        # An array has no names of its own: these are "1", "2", ..., as here.
        "array": plan.angles,
        "array by columns": np.asfortranarray(plan.angles),
        "lists": plan.angles.tolist(),
    }
    expected = unsigned(stiffarm.evaluate(CELL, file))
    for form, value in forms.items():
        assert unsigned(stiffarm.evaluate(CELL, {"plan": value})) == expected, form
        assert stiffarm.simulate_measurements(CELL, value) == stiffarm.simulate_measurements(CELL, plan), form
    assert unsigned(stiffarm.evaluate(CELL, {"plan": plan.degrees}, degrees=True)) == expected
    assert file.read_text(encoding="utf-8") == plan.to_csv() == table.to_csv()
    bounds = [stiffarm.certificate(CELL, one, samples=2).to_dict() for one in (plan, str(file), plan.angles)]
    assert bounds[0] == bounds[1] == bounds[2]
    beside = [stiffarm.certificate(CELL, plan[:4], given=one, samples=2).to_dict() for one in (plan[4:], plan[4:].table())]
    assert beside[0] == beside[1]
    built_in = [stiffarm.Postures.read("builtin:comau-group1", CELL), "builtin:comau-group1"]
    assert stiffarm.simulate_measurements(CELL, built_in[0]) == stiffarm.simulate_measurements(CELL, built_in[1])


@pytest.mark.parametrize("readings", [False, True])
def test_measurements(plan: stiffarm.Postures, readings: bool, tmp_path: Path) -> None:
    table = stiffarm.simulate_measurements(CELL, plan, seed=7, readings=readings)
    file = tmp_path / "measured.csv"
    file.write_text(table.to_csv(), encoding="utf-8")
    expected = unsigned(stiffarm.identify(CELL, file, brief=True))
    forms: dict[str, Any] = {
        "table": table,
        "pandas": table.to_frame("pandas"),
        "polars": table.to_frame("polars"),
        "pyarrow": pyarrow.table(table),
        "polars.read_csv": polars.read_csv(file, infer_schema_length=None),
        "pandas of pyarrow": pandas.read_csv(file, dtype_backend="pyarrow", engine="pyarrow"),
    }
    for form, value in forms.items():
        assert unsigned(stiffarm.identify(CELL, value, brief=True)) == expected, form
    half = len(table["posture"]) // 2
    parts = [stiffarm.Table({key: column[at] for key, column in table.items()}) for at in (slice(half), slice(half, None))]
    both = stiffarm.identify(CELL, parts, brief=True)
    assert both.stiffness.tolist() == stiffarm.identify(CELL, table, brief=True).stiffness.tolist()


def test_results(plan: stiffarm.Postures, measured: stiffarm.Table, tmp_path: Path) -> None:
    selected = stiffarm.select(CELL, count=4, rounds=1, no_certificate=True)
    selected.postures.save(tmp_path / "selected.csv")
    by_file = stiffarm.evaluate(CELL, tmp_path / "selected.csv")
    assert unsigned(by_file) == unsigned(stiffarm.evaluate(CELL, {"selected": selected}))
    fit = stiffarm.identify(CELL, measured)
    saved = fit.save(tmp_path / "stiffness.json")
    values = fit.stiffness.tolist()
    bare = [values, fit.stiffness, {"stiffness_nm_per_rad": values}, {"stiffness_nm_per_rad": fit.stiffness}]
    for function, rest in (
        (stiffarm.predict, ["builtin:contour"]),
        (stiffarm.compensate, ["builtin:contour"]),
        (stiffarm.validate, [measured]),
    ):
        # A dictionary may be the whole result as json reads it.
        same = [unsigned(function(CELL, one, *rest)) for one in (saved, fit, json.loads(fit.to_json()))]
        assert same[0] == same[1] and same[0]["result"] == same[2]["result"]
        lists = [function(CELL, one, *rest).to_dict() for one in bare]
        assert all(one == lists[0] for one in lists)
    changed = json.loads(fit.to_json())
    changed["result"]["confidence"] = 0.5
    with pytest.raises(stiffarm.StiffarmError, match="changed after it was written"):
        stiffarm.predict(CELL, changed, "builtin:contour")
    changed["result"]["sealed"]["values"][0] *= 2
    with pytest.raises(stiffarm.StiffarmError, match="What is calculated with was changed"):
        stiffarm.predict(CELL, changed, "builtin:contour")
    other = CELL.with_changes({"load": {"magnitude_n": 500}})
    with pytest.warns(stiffarm.StiffarmWarning, match="another version of this cell"):
        stiffarm.predict(other, fit, "builtin:contour")
    pairs = stiffarm.register("builtin:example-pairs")
    readings = stiffarm.simulate_measurements(CELL, plan, readings=True)
    by_either = [
        unsigned(stiffarm.identify(CELL, readings, registration=one, brief=True))
        for one in (pairs, pairs.save(tmp_path / "registration.json"))
    ]
    assert by_either[0] == by_either[1]


def test_files_are_those_of_the_command(command: Any, measured: stiffarm.Table, tmp_path: Path) -> None:
    file = tmp_path / "measured.csv"
    file.write_text(measured.to_csv(), encoding="utf-8")
    fit = stiffarm.identify(CELL, file)
    saved = fit.save(tmp_path / "own.json")
    command(["identify", "builtin:comau", str(file), "--quiet", f"--output={tmp_path / 'command.json'}"])
    theirs = type(fit).load(tmp_path / "command.json")
    assert type(fit).load(saved) == fit and unsigned(theirs) == unsigned(fit)
    with pytest.raises(stiffarm.StiffarmError, match="its class is Identified, not Predicted"):
        stiffarm.results.Predicted.load(saved)
    plan = stiffarm.select(CELL, count=3, rounds=1, no_certificate=True, output=str(tmp_path / "option.csv"))
    plan.postures.save(tmp_path / "own.csv")
    words = ["select", "builtin:comau", "-n", "3", "--rounds", "1", "--no-certificate", "--quiet"]
    command([*words, f"--output={tmp_path / 'command.csv'}"])
    texts = [(tmp_path / name).read_bytes() for name in ("own.csv", "option.csv", "command.csv")]
    assert texts[0] == texts[1] == texts[2]
    for option, readings in (("--measurements", False), ("--readings", True)):
        file = tmp_path / f"{option}.csv"
        command(["simulate", "builtin:comau", str(tmp_path / "own.csv"), "--runs=1", "--quiet", f"{option}={file}"])
        table = stiffarm.simulate_measurements(CELL, plan, readings=readings)
        assert table.to_csv() == file.read_text(encoding="utf-8")


def test_whatever_is_identified_can_be_used() -> None:
    """The mixed model in simulated experiments."""
    cell = stiffarm.Cell.built_in("comau-shapes")
    postures = stiffarm.select(cell, space_filling=True, count=8, seed=5)
    for seed in range(2):
        fit = stiffarm.identify(cell, stiffarm.simulate_measurements(cell, postures, seed=seed))
        stiffarm.predict(cell, fit, postures, cell_load=True)
