"""Whatever is wrong raises StiffarmError with a code, a place and a hint; nothing else, and never a panic."""

from __future__ import annotations

import inspect
import math
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pytest

import stiffarm
from stiffarm import StiffarmError


@pytest.fixture(scope="module")
def cell() -> stiffarm.Cell:
    return stiffarm.Cell.built_in("comau-reference")


@pytest.fixture(scope="module")
def calls(cell: stiffarm.Cell, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """Keywords of every function with which it works, quickly."""
    full = stiffarm.Cell.built_in("comau")
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    measured = stiffarm.simulate_measurements(cell, group)
    angles = group.angles
    prior = {"cell": full, "stiffness": "prior"}
    quick = {"cell": cell, "rounds": 1, "no_certificate": True}
    mesh = str(tmp_path_factory.mktemp("mesh") / "mesh.obj")
    Path(mesh).write_text("v 0 0 0\nv 90 0 0\nv 0 100 0\nv 0 0 300\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", encoding="utf-8")
    part = Path(mesh).with_name("part.nc")
    part.write_text("G90 G0 X0 Y0 Z5\nG1 Z0\nX40\n", encoding="utf-8")
    program = {"cell": full, "path": str(part), "points": stiffarm.read_path(full, part)}
    calls: dict[str, dict[str, Any]] = {
        "capsules": {"meshes": mesh, "unit": "mm"},
        "certificate": {"cell": cell, "postures": group, "samples": 4},
        "check": {"cell": cell},
        "compensate": {**prior, "path": "builtin:contour"},
        "coverage": {"cell": cell, "postures": group, "runs": 2},
        "evaluate": {"cell": cell, "postures": group},
        "export": {"cell": cell, "plan": group, "language": "csv", "output_dir": ".", "force": True},
        "identify": {"cell": cell, "measurements": measured, "brief": True},
        "indices": {"cell": cell, "postures": angles},
        "init": {"output_dir": ".", "force": True},
        "map": {**prior, "plane": "z=800", "steps": 2},
        "measure": {"cell": cell, "plan": group, "readings": measured, "once": True, "no_search": True},
        "observation_matrix": {"cell": cell, "postures": angles},
        "pose": {"cell": cell, "postures": group},
        "predict": {**prior, "path": "builtin:contour"},
        "read_path": {"cell": full, "path": "builtin:contour"},
        "register": {"pairs": "builtin:example-pairs"},
        "report": {"results": stiffarm.evaluate(cell, group), "force": True},
        "robots": {"name": "fanuc-m20ia"},
        "route": {"cell": cell, "plan": group},
        "schema": {"what": "cell"},
        "select": {**quick, "count": 3},
        "select, candidates": {"cell": cell, "count": 3, "candidates": group},
        "select, curve": {**quick, "count": 3, "curve": True},
        "select, drop": {"cell": cell, "given": group, "drop": 1},
        "select, space_filling": {"cell": cell, "count": 3, "space_filling": True},
        "simulate": {"cell": cell, "postures": group, "runs": 2},
        "simulate_measurements": {"cell": cell, "postures": group},
        # Every call is refused, for one reason or another: a study takes its time.
        "study": {"cell": cell, "report": "no page"},
        "validate": {"cell": cell, "stiffness": [1e6] * 6, "measurements": measured},
        "write_path": {**program, "output": "moved.nc", "overwrite": True},
        "zones": {"cell": cell, "steps": 3},
    }
    return calls


class Hostile:
    """An object whose every use fails."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("this object cannot be an array")


#: Values that are wrong nearly everywhere.
JUNK: dict[str, Any] = {
    "None": None,
    "text": "junk",
    "empty text": "",
    "zero byte": "a\0b",
    "bytes": b"junk",
    "minus one": -1,
    "zero": 0,
    "too large": 10**30,
    "NaN": math.nan,
    "infinite": math.inf,
    "negative": -0.5,
    "true": True,
    "complex": 1j,
    "empty list": [],
    "nested": [[], [1.0]],
    "texts": ["a", "b"],
    "numbers": [1.0, 2.0],
    "NaNs": [math.nan] * 6,
    "empty array": np.zeros((0, 6)),
    "array of NaN": np.full((3, 6), np.nan),
    "wrong width": np.zeros((3, 5)),
    "no joints": np.zeros((3, 0)),
    "one row": np.zeros(6),
    "four dimensions": np.zeros((1, 1, 1, 6)),
    "objects": np.array([object()]),
    "mapping": {},
    "mapping of text": {"a": "b"},
    "columns": {"a": [1.0], "b": ["x"]},
    "columns of two lengths": {"posture": ["1", "2"], "q1_deg": [1.0]},
    "frame": pandas.DataFrame({"a": [1.0]}),
    "empty frame": pandas.DataFrame(),
    "polars": polars.DataFrame({"a": [1.0]}),
    "polars of lists": polars.DataFrame({"posture": [["a"]], "q1_deg": [{"b": 1}]}),
    "object": object(),
    "a folder": ".",
    "no file": "missing.csv",
    "no built-in": "builtin:missing",
}

#: Functions that take nothing of these.
OTHERS = {"index_names", "set_threads"}

#: Values that are not wrong, and with which a function works for long, or for ever.
SLOW = {
    "certificate": [("samples", "None")],
    "coverage": [("runs", "None")],
    "measure": [("once", "None")],
    "study": [("report", "None")],
    "select": [("rounds", "None"), ("postures", "None"), ("no_certificate", "None")],
    "select, curve": [("rounds", "None"), ("postures", "None"), ("no_certificate", "None")],
}


def readable(error: StiffarmError) -> None:
    """A sentence of its own, a code of the list, a place that can be shown."""
    assert re.fullmatch(r"[a-z]+(-[a-z]+)*", error.code), error.code
    assert error.code != "internal", error
    assert error.message and error.message[0] not in "aeiou " and error.message.rstrip().endswith((".", "?")), error
    assert set(error.place) <= {"file", "line", "column", "key"}, error.place
    assert error.hint is None or error.hint.strip()
    assert "panicked" not in str(error) and "Traceback" not in str(error) and "_stiffarm." not in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.code, again.place, again.hint) == (str(error), error.code, error.place, error.hint)


#: Functions, and those ways to call them that take other options.
NAMES = sorted(n for n in [*stiffarm.__all__, "map"] if inspect.isfunction(getattr(stiffarm, n)) and n not in OTHERS)
MODES = ["select, candidates", "select, curve", "select, drop", "select, space_filling"]


@pytest.mark.parametrize("name", [*NAMES, *MODES])
def test_junk(calls: dict[str, dict[str, Any]], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each argument of each function in turn takes each value of the list."""
    monkeypatch.chdir(tmp_path)
    assert name in calls, f"{name} is tested nowhere"
    function, working = getattr(stiffarm, name.partition(",")[0]), calls[name]
    if name != "study":
        function(**working)
    # Where a mode is tested, what it takes itself is; the others are tested with the function.
    signature = inspect.signature(function).parameters
    parameters = [key for key in signature if name not in MODES or key in (*working, "seed", "index", "angle_step_deg")]
    faults = []
    for key in parameters:
        count = 0
        for kind, value in JUNK.items():
            # None where it is the default is the call that has worked already.
            default = value is None and key not in working and signature[key].default is None
            if default or (key, kind) in SLOW.get(name, []):
                continue
            try:
                function(**{**working, key: value})
            except StiffarmError as error:
                count += 1
                try:
                    readable(error)
                except AssertionError as wrong:
                    faults.append(f"{key} = {kind}: {wrong}".splitlines()[0])
            except BaseException as error:  # noqa: BLE001
                faults.append(f"{key} = {kind}: {type(error).__name__}: {error}"[:300])
        if count < 5:
            faults.append(f"{key}: only {count} of {len(JUNK)} values are refused")
    assert not faults, "\n".join(faults)


def refused(call: Callable[[], Any], code: str, *, key: str | None = None, said: str = "") -> StiffarmError:
    """The error that a call ends with."""
    with pytest.raises(StiffarmError) as raised:
        call()
    readable(raised.value)
    assert raised.value.code == code, raised.value
    assert raised.value.place.get("key") == key or key is None, raised.value
    assert said in str(raised.value)
    return raised.value


def test_what_python_alone_refuses(cell: stiffarm.Cell) -> None:
    """Where a command line has no such words: all else is in test_refusals.py."""
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    measured = stiffarm.simulate_measurements(cell, group)
    refused(lambda: stiffarm.validate(cell, [1e6] * 6, measured, folds=3), "usage", key="stiffness")
    refused(lambda: stiffarm.identify(cell, [measured, measured], clamped=True), "usage", key="clamped")
    refused(lambda: stiffarm.map(cell, "prior", plane=("z", 800)), "wrong-type", key="plane")
    refused(lambda: stiffarm.select(cell, output=[1, 2]), "wrong-type", key="output")
    refused(lambda: stiffarm.cell.weight(), "usage", key="mass_kg")
    with pytest.raises(StiffarmError, match=r"seed=int\(generator.integers\(2\*\*32\)\) draws one"):
        stiffarm.select(cell, 6, seed=np.random.default_rng(1))  # type: ignore[call-overload]
    refused(lambda: stiffarm.indices(cell, group.angles, ["d", "e"]), "unknown-name")
    refused(lambda: stiffarm.Cell.built_in("comauu"), "unknown-name", said="comau-reference")
    refused(lambda: stiffarm.Robot.catalogue("x"), "unknown-name", key="robot.catalogue")
    refused(lambda: stiffarm.Robot.dh([[0, 0, 0, 0]], convention="mine"), "unknown-name")
    refused(lambda: group.to_frame("excel"), "unknown-name")


def test_files(cell: stiffarm.Cell, tmp_path: Path) -> None:
    """What reads and writes files without a command."""
    missing = tmp_path / "missing.csv"
    # Of a file whose name begins as an option does, too.
    refused(lambda: stiffarm.evaluate(cell, "-missing.csv"), "file-read")
    for call in (
        lambda: stiffarm.Cell(missing),
        lambda: stiffarm.Postures.read(missing, cell),
        lambda: stiffarm.Result.load(missing),
        lambda: stiffarm.Robot.urdf(missing),
    ):
        assert refused(call, "file-read").place["file"] == str(missing)

    def written(text: str | bytes) -> Path:
        file = tmp_path / "broken"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    error = refused(lambda: stiffarm.Cell(written("a = [\n")), "toml-syntax")
    assert (error.place["line"], Path(error.place["file"]).name) == (1, "broken")
    refused(lambda: stiffarm.Result.load(written("[]")), "result-file")
    refused(lambda: stiffarm.Result.load(written(b"\xff")), "result-file")
    refused(lambda: stiffarm.Robot.urdf(written("<robot>")), "urdf")

    there = written("")
    refused(lambda: cell.save(there), "file-exists")
    refused(lambda: stiffarm.Postures([[0.0]]).save(tmp_path / "no" / "folder.csv"), "file-write")
    assert there.read_bytes() == b""
    assert sorted(file.name for file in tmp_path.iterdir()) == ["broken"]


def test_frames(cell: stiffarm.Cell) -> None:
    """A frame without the columns, or with wrong values: row and column as for a file."""
    group = stiffarm.Postures.read("builtin:comau-group1", cell)
    for library in ("pandas", "polars"):
        frame = group.to_frame(library)
        less = frame.drop(columns=["q3_deg"]) if library == "pandas" else frame.drop("q3_deg")
        refused(lambda less=less: stiffarm.evaluate(cell, less), "table-heading", said="q3")
    frame = group.to_frame("pandas")
    frame.loc[2, "q3_deg"] = np.nan
    error = refused(lambda: stiffarm.evaluate(cell, frame), "table-row", key="q3_deg")
    assert (error.place["line"], error.place["key"]) == (4, "q3_deg")
    measured = stiffarm.simulate_measurements(cell, group).to_frame("pandas")
    measured["posture"] = "one"
    measured["point"] = "1"
    refused(lambda: stiffarm.identify(cell, measured), "conflict")


def test_arrays(cell: stiffarm.Cell) -> None:
    refused(lambda: stiffarm.evaluate(cell, np.zeros((2, 5))), "table-heading", said="q6_deg")
    refused(lambda: stiffarm.evaluate(cell, np.zeros((0, 6))), "too-few-data")
    refused(lambda: stiffarm.evaluate(cell, []), "dimension")
    refused(lambda: stiffarm.indices(cell, np.zeros((2, 0, 6))), "too-few-data")
    assert stiffarm.indices(cell, np.zeros((0, 6, 6)))["d"].shape == (0,)
    refused(lambda: stiffarm.indices(cell, np.zeros(6)), "dimension")
    refused(lambda: stiffarm.observation_matrix(cell, np.full((1, 6), np.nan)), "not-finite")
    error = refused(lambda: stiffarm.Postures([[0.0, 1.0], [np.inf, 0.0]]), "not-finite")
    assert "joint 1 of posture 2" in error.message
    refused(lambda: stiffarm.Postures([[0.0]], ["a", "b"]), "dimension")
    refused(lambda: stiffarm.Postures([[0.0, 1.0], [2.0]]), "wrong-type")
    refused(lambda: stiffarm.Table({"a": [1], "b": [1, 2]}), "dimension")
    refused(lambda: stiffarm.Table({"a": 1}), "wrong-type", key="a")
    refused(lambda: stiffarm.Table.from_csv("a,b\n1\n"), "table-row")


def test_cells(cell: stiffarm.Cell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells, robots, loads and tools: every wrong value in every place is an error of the package."""
    built = {
        "Cell": lambda x: stiffarm.Cell(x),
        "built_in": lambda x: stiffarm.Cell.built_in(x),
        "from_toml": lambda x: stiffarm.Cell.from_toml(x),
        "from_dict": lambda x: stiffarm.Cell.from_dict(x),
        "from_dict, a value": lambda x: stiffarm.Cell.from_dict({"robot": x}),
        "with_changes, a load": lambda x: cell.with_changes({"load": {"magnitude_n": x}}),
        "of, the robot": lambda x: stiffarm.Cell.of(x, stiffarm.cell.tool([0] * 3, {"1": [0] * 3}), stiffarm.cell.measured()),
        "of, the tool": lambda x: stiffarm.Cell.of("fanuc-m20ia", x, stiffarm.cell.measured()),
        "of, the load": lambda x: stiffarm.Cell.of("fanuc-m20ia", stiffarm.cell.tool([0] * 3, {"1": [0] * 3}), x),
        "rope": lambda x: stiffarm.cell.rope(x, 500),
        "weight": lambda x: stiffarm.cell.weight(mass_kg=x),
        "wrench": lambda x: stiffarm.cell.wrench(x),
        "cases": lambda x: stiffarm.cell.cases(a=x),
        "tool": lambda x: stiffarm.cell.tool(x, {"1": [0] * 3}),
        "tool, a point": lambda x: stiffarm.cell.tool([0] * 3, {"1": x}),
        "save": lambda x: cell.save(x),
        "Robot": lambda x: stiffarm.Robot(x),
        "catalogue": lambda x: stiffarm.Robot.catalogue(x),
        "dh": lambda x: stiffarm.Robot.dh(x),
        "dh, limits": lambda x: stiffarm.Robot.dh([[0, 0, 0, 0]], limits_deg=x),
        "urdf": lambda x: stiffarm.Robot.urdf(x),
        "of_axes, points": lambda x: stiffarm.Robot.of_axes(x, [[0, 0, 1.0]], np.eye(4)),
        "of_axes, flange": lambda x: stiffarm.Robot.of_axes([[0, 0, 0.0]], [[0, 0, 1.0]], x),
        "pose": lambda x: cell.robot.pose(x),
        "jacobian": lambda x: cell.robot.jacobian(np.zeros(6), x),
        "inverse": lambda x: cell.robot.inverse(x),
        "nearest": lambda x: cell.robot.nearest(np.eye(4), x),
        "Postures": lambda x: stiffarm.Postures(x),
        "Postures, names": lambda x: stiffarm.Postures([[0.0]], x),
        "read": lambda x: stiffarm.Postures.read(x, cell),
        "load": lambda x: stiffarm.Result.load(x),
        "Objective": lambda x: stiffarm.Objective(x),
        "Objective, index": lambda x: stiffarm.Objective(cell, x),
        "Objective, angles": lambda x: stiffarm.Objective(cell, postures=3)(x),
        "Objective, postures": lambda x: stiffarm.Objective(cell, postures=x),
    }
    monkeypatch.chdir(tmp_path)
    faults = []
    for name, call in built.items():
        count = 0
        for kind, value in JUNK.items():
            try:
                call(value)
            except StiffarmError as error:
                count += 1
                try:
                    readable(error)
                except AssertionError as wrong:
                    faults.append(f"{name} = {kind}: {wrong}"[:250])
            except BaseException as error:  # noqa: BLE001
                faults.append(f"{name} = {kind}: {type(error).__name__}: {error}"[:250])
        if count < 20:
            faults.append(f"{name}: only {count} of {len(JUNK)} values are refused")
    assert not faults, "\n".join(faults)
