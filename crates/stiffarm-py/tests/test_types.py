"""The package's types, read by mypy; `cargo xtask python` has stubtest and basedpyright read them (`checks.rs`).

``generate.py`` writes those of commands and results into a wheel; in a checkout they are there once it was run.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import stiffarm
from stiffarm import commands

ROOT = Path(__file__).parents[1]
PACKAGE = Path(stiffarm.__file__).parent

if not (PACKAGE / "commands.pyi").exists():
    pytest.skip("the types of the commands were not written: see generate.py", allow_module_level=True)

#: Every function as people call it, and what they read from its result.
USED = '''\
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import stiffarm
from stiffarm import results

cell = stiffarm.Cell.built_in("comau")
folder = Path("somewhere")
checked: results.Checked = stiffarm.check(cell, figure=folder / "arm.svg", posture="all")
sampled: int = checked.postures_sampled
plan: results.Plan = stiffarm.select(cell, count=6, index="expected_error", rounds=2, accept=lambda q: bool(q[0] > 0), time_limit=5)
value: float = plan.value
curve: results.Curve = stiffarm.select("cell.toml", curve=True, count=8)
chosen: results.Chosen = stiffarm.select(cell, candidates=plan, count=4)
filling: results.SpaceFilling = stiffarm.select(cell, 8, space_filling=True)
stiffarm.select(cell, initial=plan, angle_step_deg=0.5)
dropped: results.Dropped = stiffarm.select(cell, given=plan.postures, drop=True)
measured = stiffarm.simulate_measurements(cell, plan)
evaluated: results.Evaluated = stiffarm.evaluate(cell, {"mine": np.zeros((3, 6))}, degrees=True)
evaluated = stiffarm.evaluate(cell, [plan, "plan.csv", folder / "other.csv"])
simulated: results.Simulation = stiffarm.simulate(cell, plan, levels=[1.0, 2.0], elastic="mixed")
covered: results.Coverage = stiffarm.coverage(cell, plan, runs=100, progress=lambda what, done, of: None)
fit: results.Identified = stiffarm.identify(cell, measured, exclude=["3"], registration=stiffarm.register("pairs.csv"))
stiffness: NDArray[np.float64] = fit.stiffness
error: float | None = fit.joints[0].standard_error
validated: results.Validated = stiffarm.validate(cell, fit, measured, tolerance_mm=0.1)
validated = stiffarm.validate(cell, measurements=measured, folds="all")
validated = stiffarm.validate(cell, measurements=measured, folds=4)
predicted: results.Predicted = stiffarm.predict(cell, fit, "path.csv", force_n=[0, 0, -100.0], free_turn=4)
predicted = stiffarm.predict(cell, [1e6] * 6, near_deg=[0.0] * 6, free_turn=True)
deflection: float = predicted.deflection_max_m
compensated: results.Compensated = stiffarm.compensate(cell, "prior", "path.csv", output=folder / "commands.csv")
mapped: results.StiffnessMap = stiffarm.map(cell, fit, plane="z=800", steps=5, direction=(1.0, 0.0, 0.0))
placed: results.Placement = stiffarm.map(cell, fit, place="path.csv", steps=[3, 3, 2], yaw_deg=[0.0, 45.0])
registered: results.Registered = stiffarm.register(measured, std_mm=0.03)
others: list[stiffarm.Result] = [
    stiffarm.capsules(["a.stl", folder / "b.stl"], unit="mm"),
    stiffarm.export(cell, plan, language="krl", output_dir=folder, states=["up", "down"]),
    stiffarm.init(robot="fanuc-m20ia", output_dir=folder),
    stiffarm.measure(cell, plan, measured, once=True, until="2%"),
    stiffarm.pose(cell, plan, convention="kuka"),
    stiffarm.pose(cell, poses="poses.csv"),
    stiffarm.report([fit, "saved.json"], cell=[cell], output="page.html"),
    stiffarm.robots(),
    stiffarm.route(cell, plan, keep_order=True),
    stiffarm.study(cell, runs=10, indices=["novel", "d"]),
    stiffarm.zones(cell, steps=5),
]
keys: dict[str, object] = stiffarm.schema("cell")
words: str = fit.summary(details=True) + fit.command_line
'''


def run(words: list[str]) -> None:
    """Runs a checker on the package that tests import."""
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "MYPYPATH": ""}
    done = subprocess.run(
        words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout


def mypy(module: str, *words: str) -> None:
    pytest.importorskip("mypy", reason="mypy is not installed")
    pytest.importorskip("matplotlib", reason="stiffarm.plot is checked with matplotlib installed")
    run([sys.executable, "-m", module, *words])


def test_mypy() -> None:
    mypy("mypy", "--config-file", "pyproject.toml", "-p", "stiffarm")


def test_mypy_of_a_script_that_uses_every_function(tmp_path: Path) -> None:
    script = tmp_path / "used.py"
    script.write_text(USED, encoding="utf-8")
    assert [name for name in commands.names() if f"stiffarm.{name}(" not in USED] == []
    mypy("mypy", "--config-file", "pyproject.toml", "--strict", str(script))


def test_pyright_of_the_same_script(tmp_path: Path) -> None:
    pytest.importorskip("basedpyright", reason="basedpyright is not installed")
    (tmp_path / "used.py").write_text(USED, encoding="utf-8")
    settings = {"typeCheckingMode": "strict", "extraPaths": [str(PACKAGE.parent)], "include": ["used.py"]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    run([sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, "--project", str(tmp_path)])
