"""Every function gives what its command gives: the same JSON for inputs in memory as for the same inputs in files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

import stiffarm
from stiffarm import commands

#: Each command once: names of inputs, in their order, and options; an option that is the name of an input has its value.
CASES: dict[str, tuple[list[str], dict[str, Any]]] = {
    "capsules": (["meshes"], {"unit": "mm"}),
    "check": (["cell"], {"postures": "postures", "posture": "2", "figure": "figure.svg", "force": True}),
    "compensate": (["cell", "stiffness", "path"], {"axes": "base", "load_uncertainty_percent": 5.5}),
    "coverage": (["cell", "postures"], {"runs": 60, "terms": ["tilt1"]}),
    "evaluate": (["cell", "postures"], {}),
    "export": (["cell", "postures"], {"language": "pdl2", "name": "plan", "output_dir": "program", "force": True}),
    "identify": (["cell", "readings"], {"registration": "registration", "bootstrap": 200, "exclude": ["3"]}),
    "init": ([], {"robot": "fanuc-m20ia", "output_dir": "start", "force": True}),
    "map": (["cell", "stiffness"], {"plane": "z=800", "steps": 3, "force_n": [200.0, -300.5, 100.0]}),
    "measure": (["cell", "postures", "measurements"], {"once": True, "no_search": True}),
    "pose": (["cell", "postures"], {"convention": "kuka"}),
    "predict": (["cell", "stiffness", "path"], {"matrix": True, "free_turn": 4}),
    "register": (["pairs"], {"std_mm": 0.03, "exclude": ["B"]}),
    "report": (["results"], {"output": "page.html", "force": True}),
    "robots": ([], {}),
    "route": (["cell", "postures"], {"keep_order": True}),
    "schema": ([], {"what": "result-select"}),
    "select": (["cell"], {"given": "postures", "add": 2, "rounds": 1, "no_certificate": True, "seed": 7}),
    "simulate": (["cell", "postures"], {"runs": 3, "levels": [1.0, 2.25], "force_percent": 0.5}),
    "study": (["cell"], {"initial": "postures", "runs": 2, "starts": 1, "output_dir": "study", "force": True}),
    "validate": (["cell", "measurements"], {"folds": 4, "estimator": "ordinary"}),
    "zones": (["cell"], {"steps": 4}),
}  # fmt: skip
#: Commands whose text on a terminal is the telling of their result; the others have tables of their own.
TOLD = {"coverage", "identify"}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, str], Path]:
    """Inputs in memory and, in a folder, as files."""
    folder = tmp_path_factory.mktemp("inputs")
    cell = stiffarm.Cell.built_in("comau").with_changes({"name": "in memory"})
    plan = stiffarm.select(cell, space_filling=True, postures=8, seed=3)
    measured = stiffarm.simulate_measurements(cell, plan, seed=5)
    memory: dict[str, Any] = {
        "cell": cell,
        "postures": {"plan": plan.postures.angles},
        "measurements": measured.to_frame("polars"),
        "readings": stiffarm.simulate_measurements(cell, plan, seed=7, readings=True).to_frame("pandas"),
        "registration": stiffarm.register("builtin:example-pairs"),
        "stiffness": stiffarm.identify(cell, measured),
        "results": stiffarm.evaluate(cell, plan),
        "pairs": "builtin:example-pairs",
        "path": "builtin:contour",
        "meshes": str(folder / "mesh.obj"),
    }
    text = "v 0 0 0\nv 90 0 0\nv 0 100 0\nv 0 0 300\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    Path(memory["meshes"]).write_text(text, encoding="utf-8")
    files = {key: value for key, value in memory.items() if isinstance(value, str)}
    for key, value in memory.items():
        if key not in files:
            ending = "toml" if key == "cell" else "json" if isinstance(value, stiffarm.Result) else "csv"
            files[key] = str(folder / f"{'plan' if key == 'postures' else key}.{ending}")
            own = plan.postures if key == "postures" else value
            own.save(files[key]) if hasattr(own, "save") else Path(files[key]).write_text(stiffarm.Table.of(own).to_csv())
    return memory, files, folder


def words_of(options: Mapping[str, Any]) -> list[str]:
    """Options as the command line has them."""
    words = []
    for name, value in options.items():
        option = f"--{name.rstrip('_').replace('_', '-')}"
        text = ",".join(map(str, value)) if isinstance(value, list) else value
        words.append(option if value is True else f"{option}={text}")
    return words


def call(name: str, memory: Mapping[str, Any]) -> Any:
    """The function with what is in memory."""
    given, options = CASES[name]
    one = name in ("check", "measure", "pose", "route", "export", "select", "coverage", "study")
    values = {**memory, "postures": memory["postures"]["plan"] if one else memory["postures"]}
    known = {key: values.get(value, value) if isinstance(value, str) else value for key, value in options.items()}
    if name == "validate":
        return stiffarm.validate(values["cell"], measurements=values["measurements"], **known)
    return getattr(stiffarm, name)(*[values[key] for key in given], **known)


def words(name: str, files: Mapping[str, str]) -> list[str]:
    """The command with the same as files."""
    given, options = CASES[name]
    known = {key: files.get(value, value) if isinstance(value, str) else value for key, value in options.items()}
    places = [known.pop("what")] if name == "schema" else []
    return [name, *[files[key] for key in given], *places, *words_of(known)]


def compared(document: dict[str, Any]) -> dict[str, Any]:
    """What does not depend on how inputs are named."""
    return {key: value for key, value in document.items() if key not in ("arguments", "seal")}


@pytest.mark.parametrize("name", commands.names())
def test_json(command: Any, inputs: Any, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    memory, files, folder = inputs
    monkeypatch.chdir(folder)
    done = command([*words(name, files), "--json", "--quiet"])
    assert done.returncode in (0, 1), done.stdout
    found = call(name, memory)
    document = found if name == "schema" else json.loads(found.to_json())
    assert compared(document) == compared(json.loads(done.stdout))


@pytest.mark.parametrize("name", sorted(TOLD))
def test_words(command: Any, inputs: Any, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    memory, files, folder = inputs
    monkeypatch.chdir(folder)
    shown = command([*words(name, files), "--quiet"]).stdout
    assert shown.startswith(str(call(name, memory)))


def test_long_work_stops_with_the_best_so_far() -> None:
    cell = stiffarm.Cell.built_in("comau-reference")
    plan = stiffarm.select(cell, postures=6, rounds=1_000_000, time_limit=1, no_certificate=True)
    assert plan.termination == "time_limit" and len(plan.postures) == 6 and not plan.interrupted


PROGRAM = """
import hashlib, sys, stiffarm
cell, plan, measured = stiffarm.Cell(sys.argv[1]), sys.argv[2], sys.argv[3]
group = stiffarm.Postures.read(plan, cell).angles
found = [
    stiffarm.select(cell, postures=3, rounds=2, seed=3), stiffarm.simulate(cell, plan, runs=20),
    stiffarm.identify(cell, measured, bootstrap=200), stiffarm.map(cell, "prior", plane="z=800", steps=4),
    stiffarm.coverage(cell, plan, runs=50), stiffarm.Table(stiffarm.indices(cell, [group] * 50)).to_csv(),
    repr(stiffarm.certificate(cell, plan, samples=8).to_dict()),
]
for one in found:
    print(hashlib.sha256((one if isinstance(one, str) else one.to_json()).encode()).hexdigest())
"""


def test_threads_change_no_byte(inputs: Any) -> None:
    files = inputs[1]
    program = [sys.executable, "-c", PROGRAM, files["cell"], files["postures"], files["measurements"]]
    printed = [
        subprocess.run(program, env={**os.environ, "RAYON_NUM_THREADS": threads}, stdout=subprocess.PIPE, check=True).stdout
        for threads in ("1", "3")
    ]
    assert printed[0] == printed[1] and len(printed[0].splitlines()) == 7
