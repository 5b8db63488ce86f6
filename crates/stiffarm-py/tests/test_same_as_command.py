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
    "coverage": (["cell", "postures"], {"runs": 60, "extra": ["tilt1"]}),
    "evaluate": (["cell", "groups"], {}),
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
    "simulate": (["cell", "groups"], {"runs": 3, "levels": [1.0, 2.25], "force_error_percent": 0.5}),
    "study": (["cell"], {"initial": "few", "runs": 2, "initial_groups": 1, "output_dir": "study", "force": True}),
    "validate": (["cell", "nothing", "measurements"], {"folds": 4, "estimator": "ordinary"}),
    "zones": (["cell"], {"steps": 4}),
}
#: Commands whose text on a terminal is the telling of their result; the others have tables of their own.
TOLD = {
    "check",
    "compensate",
    "coverage",
    "evaluate",
    "identify",
    "map",
    "predict",
    "register",
    "route",
    "select",
    "simulate",
    "validate",
    "zones",
}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, str], Path]:
    """Inputs in memory and, in a folder, as files."""
    folder = tmp_path_factory.mktemp("inputs")
    cell = stiffarm.Cell.built_in("comau").with_changes({"name": "in memory"})
    plan = stiffarm.select(cell, space_filling=True, count=8, seed=3)
    measured = stiffarm.simulate_measurements(cell, plan, seed=5)
    memory: dict[str, Any] = {
        "cell": cell,
        "postures": plan.postures.angles,
        "few": plan.postures[:4].angles,
        "groups": {"plan": plan.postures.angles},
        "nothing": None,
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
    files |= {"postures": str(plan.postures.save(folder / "plan.csv")), "groups": str(folder / "plan.csv")}
    files["few"] = str(plan.postures[:4].save(folder / "few.csv"))
    for key, value in memory.items():
        if isinstance(value, (stiffarm.Cell, stiffarm.Result)):
            files[key] = str(value.save(folder / f"{key}.{'toml' if key == 'cell' else 'json'}"))
        elif key not in files and value is not None:
            files[key] = str(folder / f"{key}.csv")
            Path(files[key]).write_text(stiffarm.Table.of(value).to_csv(), encoding="utf-8")
    return memory, files, folder


def call(name: str, memory: Mapping[str, Any]) -> Any:
    """The function with what is in memory."""
    names, options = CASES[name]
    keywords = {key: memory.get(value, value) if isinstance(value, str) else value for key, value in options.items()}
    return getattr(stiffarm, name)(*[memory[key] for key in names], **keywords)


def words(name: str, files: Mapping[str, str]) -> list[str]:
    """The command with the same as files."""
    names, options = CASES[name]
    line = [name, *[files[key] for key in names if key in files]]
    for key, value in options.items():
        text = ",".join(map(str, value)) if isinstance(value, list) else files.get(value, value)
        option = f"--{key.replace('_', '-')}"
        line.append(text if key == "what" else option if value is True else f"{option}={text}")
    return line


def compared(document: dict[str, Any]) -> dict[str, Any]:
    """What does not depend on how inputs are named."""
    return {key: value for key, value in document.items() if key not in ("arguments", "seal")}


@pytest.mark.parametrize("name", commands.names())
def test_json_and_words(command: Any, inputs: Any, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    memory, files, folder = inputs
    monkeypatch.chdir(folder)
    done = command([*words(name, files), "--json", "--quiet"])
    assert done.returncode in (0, 1), done.stdout
    answer = call(name, memory)
    document = answer if name == "schema" else json.loads(answer.to_json())
    assert compared(document) == compared(json.loads(done.stdout))
    if name in TOLD:
        assert command([*words(name, files), "--quiet"]).stdout.startswith(str(answer))


def test_long_work_stops_with_the_best_so_far() -> None:
    plan = stiffarm.select("builtin:comau-reference", count=6, rounds=1_000_000, time_limit=0.5, no_certificate=True)
    assert plan.termination == "time_limit" and len(plan.postures) == 6 and not plan.interrupted


PROGRAM = """
import hashlib, sys, stiffarm
cell, plan, measured = stiffarm.Cell(sys.argv[1]), sys.argv[2], sys.argv[3]
group = stiffarm.Postures.read(plan, cell).angles
answers = [
    stiffarm.select(cell, count=3, rounds=1, seed=3, no_certificate=True), stiffarm.identify(cell, measured, bootstrap=200),
    stiffarm.map(cell, "prior", plane="z=800", steps=4), stiffarm.coverage(cell, plan, runs=50),
    stiffarm.Table(stiffarm.indices(cell, [group] * 50)).to_csv(), repr(stiffarm.certificate(cell, plan, samples=8).to_dict()),
]
for one in answers:
    print(hashlib.sha256((one if isinstance(one, str) else one.to_json()).encode()).hexdigest())
"""


def test_threads_change_no_byte(inputs: Any) -> None:
    files = inputs[1]
    program = [sys.executable, "-c", PROGRAM, files["cell"], files["postures"], files["measurements"]]
    printed = [
        subprocess.run(program, env={**os.environ, "RAYON_NUM_THREADS": threads}, stdout=subprocess.PIPE, check=True).stdout
        for threads in ("1", "3")
    ]
    assert printed[0] == printed[1] and len(printed[0].splitlines()) == 6
