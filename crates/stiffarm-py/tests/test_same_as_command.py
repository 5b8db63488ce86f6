"""Every result is what the command prints with ``--json`` for the same inputs and options, to the last bit.

A table names each function with the options it takes and their values; a seeded generator draws from it. What is drawn
is given to the function as keywords and to the command as words; the two texts must be the same but for ``arguments``,
which are the words of a command line, or the call.
"""

from __future__ import annotations

import inspect
import json
import os
import random
import re
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import stiffarm

#: Draws of each line of the table.
DRAWS = 4

#: Words of options whose name in Python is another one than in the command.
WORDS = {"flange_fixed": "clamped", "start": "from", "largest": "postures", "count": "drop"}

ARGUMENTS = re.compile(r'\n  "arguments": \[(?:[^\]"]|"(?:[^"\\]|\\.)*")*\],')


def without_arguments(text: str) -> str:
    """The text of a result without the words of the command line, and without the seal that holds them too."""
    found, count = ARGUMENTS.subn("", text)
    assert count == 1, text[:500]
    head, seal = found.rsplit('"seal": ', 1)
    assert '"file"' in seal
    return head


def words_of(options: Mapping[str, Any]) -> list[str]:
    """Options as the command line has them."""
    words: list[str] = []
    for name, value in options.items():
        flag = f"--{WORDS.get(name, name).replace('_', '-')}"
        if name == "certificate":
            words += [] if value else ["--no-certificate"]
        elif value is True:
            words.append(flag)
        elif value is False or value is None:
            continue
        elif name == "plane":
            words.append(f"{flag}={value[0]}={value[1]}")
        elif isinstance(value, (list, tuple)):
            words.append(f"{flag}={','.join(str(one) for one in value)}")
        else:
            words.append(f"{flag}={value}")
    return words


def contents(folder: Path) -> dict[str, dict[str, str]]:
    """Files for each cell: postures, readings, a stiffness, paths; all made by the package."""
    comau = stiffarm.Cell.built_in("comau")
    written = stiffarm.Cell.of(
        stiffarm.Robot.catalogue("kuka-kr210-r2700-2"),
        stiffarm.tool([120, 30, 260], {"tip": [150, 0, 300], "left": [-90, 140, 250], "right": [-80, -150, 240]}),
        stiffarm.wrench([150, -320, -480], [20, -35, 12]),
        stiffness_nm_per_rad=[1.9e6, 2.6e6, 1.7e6, 3.1e5, 2.4e5, 1.6e5],
        noise={"variance_mm2": 1.3e-4, "readings_per_displacement": 2, "posture_common_mm": 0.004},
        bounds={"q_deg": [[-80, 80], [-120, -30], [20, 140], [-150, 150], [-100, 100], [-170, 170]]},
        task=[{"name": "drill, left", "q_deg": [-20, -80, 95, 10, 40, 5], "force_n": [80, -40, -200]}],
        name="KUKA, wrench",
    )
    written.save(folder / "written.toml")
    # The wrench of this cell comes with its readings: those of the same cell under a known force stand in for them.
    fanuc = stiffarm.Cell.built_in("fanuc-r2000ic")
    stand_in = fanuc.with_changes(
        {
            "load": stiffarm.wrench([250.0, -200.0, -400.0]),
            "stiffness": {"prior_nm_per_rad": [1.5e6, 2.2e6, 1.4e6, 3.0e5, 2.5e5, 1.8e5]},
        }
    )
    cells = {"builtin:comau": comau, str(folder / "written.toml"): written, "builtin:fanuc-r2000ic": fanuc}
    cells |= {f"builtin:{name}": stiffarm.Cell.built_in(name) for name in ("comau-reference", "comau-shapes")}
    found: dict[str, dict[str, str]] = {}
    for number, (name, cell) in enumerate(cells.items()):
        own = folder / f"cell {number}"
        own.mkdir()
        truth = stand_in if cell is fanuc else cell
        planned = stiffarm.select(truth, space_filling=True, postures=8, seed=number + 3).postures
        planned.save(own / "plan.csv")
        planned[:5].save(own / "few.csv")
        stiffarm.select(truth, space_filling=True, postures=6, seed=number + 40).postures.save(own / "other.csv")
        candidates = stiffarm.select(truth, space_filling=True, postures=20, seed=number + 80).postures
        candidates.save(own / "candidates.csv")
        for seed, what in ((5, "measured"), (6, "second")):
            table = dict(stiffarm.simulate_measurements(truth, planned, seed=seed))
            if cell is fanuc:
                rows = len(table["posture"])
                table |= {"fx_n": [250.0] * rows, "fy_n": [-200.0] * rows, "fz_n": [-400.0] * rows}
            text = stiffarm.Table(table).to_csv()
            (own / f"{what}.csv").write_text(text, encoding="utf-8")
        rows = (own / "measured.csv").read_text(encoding="utf-8").splitlines()
        half = 1 + (len(rows) - 1) // 2
        (own / "first half.csv").write_text("\n".join(rows[:half]) + "\n", encoding="utf-8")
        (own / "second half.csv").write_text("\n".join([rows[0], *rows[half:]]) + "\n", encoding="utf-8")
        no_angles = [key for key in stiffarm.Table.from_csv("\n".join(rows)) if not key.startswith("q")]
        table = stiffarm.Table.from_csv("\n".join(rows))
        bare = stiffarm.Table({key: table[key] for key in no_angles})
        (own / "no angles.csv").write_text(bare.to_csv(), encoding="utf-8")
        if cell is not fanuc:
            raw = stiffarm.simulate_measurements(cell, planned, seed=7, readings=True)
            (own / "readings.csv").write_text(raw.to_csv(), encoding="utf-8")
        stiffarm.identify(cell, own / "measured.csv", brief=True).save(own / "brief.json")
        stiffarm.identify(cell, own / "measured.csv").save(own / "stiffness.json")
        mixed = readable(cell, truth, planned, own / "measured.csv")
        mixed.save(own / "mixed.json")
        (own / "list.json").write_text('{"stiffness_nm_per_rad": [1e6, 2e6, 1e6, 3e5, 2e5, 1.5e5]}', encoding="utf-8")
        stiffarm.register("builtin:example-pairs").save(own / "registration.json")
        # A path of joint angles, from one posture a little way to the next.
        steps = np.linspace(0, 0.2, 6)[:, None]
        start = planned.angles[0]
        path = start + steps * (planned.angles[1] - start)
        stiffarm.Postures(path, name="path").save(own / "path.csv")
        (own / "clamped.csv").write_text(clamped(truth, planned), encoding="utf-8")
        found[name] = {file.name: str(file) for file in own.iterdir()}
    return found


def readable(
    cell: stiffarm.Cell, truth: stiffarm.Cell, postures: stiffarm.Postures, file: Path
) -> stiffarm.results.Identified:
    """What the mixed model finds in simulated readings."""
    forces = [key for key in stiffarm.Table.from_csv(file.read_text(encoding="utf-8")) if key.endswith("_n")]
    known = stiffarm.Table.from_csv(file.read_text(encoding="utf-8"))
    table = dict(stiffarm.simulate_measurements(truth, postures, seed=100))
    return stiffarm.identify(cell, {**table, **{key: known[key] for key in forces}}, elastic="mixed")


def clamped(cell: stiffarm.Cell, postures: stiffarm.Postures) -> str:
    """Differences of angles under wrenches on the fixed flange, with a stiffness of about 10⁶ N·m/rad and noise."""
    random_numbers = np.random.default_rng(11)
    rows: dict[str, list[Any]] = {}
    for name, angles, degrees in zip(postures.names, postures.angles, postures.degrees, strict=True):
        wrench = random_numbers.normal(size=6) * np.array([800.0, 800.0, 800.0, 300.0, 300.0, 300.0])
        torque = cell.robot.jacobian(angles, cell.loading_point).T @ wrench
        turned = -torque / np.array([1e6, 2e6, 1e6, 3e5, 2e5, 1.5e5]) * (1 + 0.01 * random_numbers.normal(size=6))
        row = {"posture": name, "state": "up-1"}
        row |= dict(zip(["fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"], wrench.tolist(), strict=True))
        row |= {f"q{j + 1}_deg": float(q) for j, q in enumerate(degrees)}
        row |= {f"dq{j + 1}_deg": float(q) for j, q in enumerate(np.degrees(turned))}
        for key, value in row.items():
            rows.setdefault(key, []).append(value)
    return stiffarm.Table(rows).to_csv()


@dataclass(frozen=True)
class Line:
    """A way to call a function: what is drawn for it, and how the command is called for the same."""

    name: str
    function: Callable[..., stiffarm.Result]
    #: Word of the command.
    verb: str
    #: Files of the cell as positional arguments, each drawn from a list; ``*`` before a file of several.
    inputs: Sequence[Sequence[Any]] = ()
    #: Options that are always given, with the values to draw from.
    always: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    #: Options that may be left out.
    maybe: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    #: Options whose values are files of the cell.
    files: Mapping[str, Sequence[str]] = field(default_factory=dict)
    #: Words that the command needs beside them, for example ``--curve``.
    words: Sequence[str] = ()
    #: Cells by the end of their name; all unless given.
    cells: Sequence[str] = ("comau", "comau-reference", "comau-shapes", "written.toml")
    has_cell: bool = True


PLAN = ["plan.csv", "few.csv", "other.csv"]
MEASURED = ["measured.csv", "second.csv"]
STIFFNESS = ["stiffness.json", "mixed.json", "brief.json", "list.json", "prior"]
INDEX = ["expected_error", "novel", "d", "task", "worst_joint", "drop_one", "classical", "o1", "scaled"]
ALL = ("comau", "comau-reference", "comau-shapes", "written.toml", "fanuc-r2000ic")
FIT: dict[str, Sequence[Any]] = {
    "estimator": ["two-variance", "ordinary", "weighted", "huber", "non-negative", "prior"],
    "weights": ["readings", "tracker"],
    "noise": ["estimated", "known"],
    "confidence": [0.9, 0.99],
}
ALONG: dict[str, Sequence[Any]] = {
    "load_uncertainty_percent": [5.0, 12.5],
    "force_n": [[-300.0, 100.0, 0.0], [10.5, -20.25, 80.0]],
}
REGION: dict[str, Sequence[Any]] = {"plane": [("z", 800.0), ("x", 1800.0)], "steps": [4, 6]}
QUICK = {"rounds": [1], "certificate": [False, False, True], "seed": [1, 7, 123456789]}

LINES = [
    Line("check", stiffarm.check, "check"),
    Line("evaluate", stiffarm.evaluate, "evaluate", [[["plan.csv"], ["other.csv", "few.csv"], ["plan.csv"] * 2]]),
    Line(
        "select, global",
        stiffarm.select,
        "select",
        always={"postures": [3, 4], "index": INDEX, **QUICK},
        maybe={"angle_step_deg": [0.0, 0.5]},
    ),
    Line(
        "select, from an initial group",
        stiffarm.select,
        "select",
        always={"index": INDEX, "max_iterations": [3, 20]},
        maybe={"angle_step_deg": [0.1]},
        files={"start": PLAN},
    ),
    Line(
        "select, beside given ones",
        stiffarm.select,
        "select",
        always={"index": INDEX, **QUICK},
        maybe={"add": [1, 2]},
        files={"given": PLAN},
    ),
    Line(
        "select, of candidates",
        stiffarm.select,
        "select",
        always={"postures": [3, 5], "index": ["expected_error", "d", "novel"], "certificate": [False]},
        maybe={"seed": [2]},
        files={"candidates": ["candidates.csv", "measured.csv"]},
        cells=ALL,
    ),
    Line(
        "select, with its load",
        stiffarm.select,
        "select",
        always={"postures": [3], "rounds": [1], "certificate": [False], "largest_load_n": [600.0, 800.0]},
        maybe={"anchor_box_mm": [[1600.0, -200.0, 0.0, 2000.0, 200.0, 0.0]]},
        cells=("comau", "comau-reference"),
    ),
    Line(
        "select, sensitivity",
        stiffarm.select,
        "select",
        always={"postures": [3], "rounds": [1], "certificate": [False], "sensitivity": [True], "seed": [1, 5]},
        cells=("comau-reference",),
    ),
    Line(
        "select, prices",
        stiffarm.select,
        "select",
        always={"postures": [3], "rounds": [1], "certificate": [False], "prices": [True], "seed": [1, 5]},
        cells=("comau",),
    ),
    Line(
        "space_filling",
        stiffarm.space_filling,
        "select",
        always={"postures": [2, 6, 9]},
        maybe={"seed": [1, 9], "angle_step_deg": [0.0, 1.0]},
        words=["--space-filling"],
    ),
    Line(
        "drop",
        stiffarm.drop,
        "select",
        always={"count": [1, 2], "index": ["expected_error", "d", "task", "worst_joint"]},
        files={"given": ["plan.csv", "other.csv"]},
    ),
    Line(
        "curve",
        stiffarm.curve,
        "select",
        always={"largest": [3, 4], "rounds": [1], "certificate": [False, True]},
        maybe={"seed": [4], "index": ["d", "expected_error"]},
        words=["--curve"],
        cells=("comau-reference", "written.toml"),
    ),
    Line(
        "simulate",
        stiffarm.simulate,
        "simulate",
        [[["plan.csv"], ["plan.csv", "other.csv"]]],
        always={"runs": [3, 20]},
        maybe={
            "levels": [[1.0], [0.5, 2.25]],
            "seed": [1, 99],
            "force_scale_percent": [1.5],
            "force_percent": [0.5],
            "joint_angle_deg": [0.01],
            "loading_point_mm": [0.3],
            "anchor_mm": [2.0],
        },
    ),
    Line(
        "simulate, elastic",
        stiffarm.simulate,
        "simulate",
        [[["plan.csv"]]],
        always={"runs": [2], "elastic": ["mixed", "auto"]},
        maybe={"seed": [3], "levels": [[1.0]]},
    ),
    Line(
        "identify",
        stiffarm.identify,
        "identify",
        [MEASURED],
        maybe={**FIT, "prior_std_percent": [20.0], "exclude": [["2"], ["1", "4"]], "terms": [["tilt1"], ["base"]]},
        cells=ALL,
    ),
    Line("identify, several tables", stiffarm.identify, "identify", [[["first half.csv", "second half.csv"]]], cells=ALL),
    Line(
        "identify, postures of their own",
        stiffarm.identify,
        "identify",
        [["no angles.csv"]],
        always={"brief": [True]},
        files={"postures": ["plan.csv"]},
        cells=ALL,
    ),
    Line("identify, brief", stiffarm.identify, "identify", [MEASURED], always={"brief": [True]}, maybe=FIT, cells=ALL),
    Line(
        "identify, resampled",
        stiffarm.identify,
        "identify",
        [MEASURED],
        always={"bootstrap": [200, 250], "brief": [True, False]},
        maybe={"seed": [8]},
    ),
    Line(
        "identify, elastic",
        stiffarm.identify,
        "identify",
        [MEASURED],
        always={"elastic": ["mixed", "auto"]},
        maybe={"brief": [True], "confidence": [0.9]},
        cells=ALL,
    ),
    Line(
        "identify, readings",
        stiffarm.identify,
        "identify",
        [["readings.csv"]],
        maybe={"noise": ["repeats"], "brief": [True]},
    ),
    Line(
        "identify, readings and registration",
        stiffarm.identify,
        "identify",
        [["readings.csv"]],
        always={"brief": [True, False]},
        files={"registration": ["registration.json"]},
    ),
    Line(
        "identify, the flange fixed",
        stiffarm.identify,
        "identify",
        [["clamped.csv"]],
        always={"flange_fixed": [True]},
        maybe={"confidence": [0.9], "exclude": [["3"]]},
        cells=("comau", "comau-reference"),
    ),
    Line(
        "validate",
        stiffarm.validate,
        "validate",
        [["stiffness.json", "mixed.json", "list.json"], MEASURED],
        maybe={"model": ["linear", "equilibrium"], "tolerance_mm": [0.001, 5.0], "only": [["1"], ["2", "3"]]},
        cells=ALL,
    ),
    Line(
        "validate, fold by fold",
        stiffarm.validate,
        "validate",
        [[None], MEASURED],
        always={"folds": [2, 4, "all"]},
        maybe={"estimator": ["ordinary", "huber"], "elastic": ["mixed"], "tolerance_mm": [0.05], "confidence": [0.9]},
        cells=ALL,
    ),
    Line(
        "validate, readings",
        stiffarm.validate,
        "validate",
        [["stiffness.json"], ["readings.csv"]],
        files={"registration": ["registration.json"]},
    ),
    Line(
        "validate, fold by fold, how it is fitted",
        stiffarm.validate,
        "validate",
        [[None], ["no angles.csv"]],
        always={"folds": [3], "terms": [["tilt1"], ["base"]], "estimator": ["prior"], "prior_std_percent": [20.0]},
        maybe={"weights": ["readings"], "noise": ["known"]},
        files={"postures": ["plan.csv"]},
    ),
    Line(
        "register",
        stiffarm.register,
        "register",
        [["builtin:example-pairs"]],
        maybe={"std_mm": [0.03, 0.2], "exclude": [["B"], ["A"]]},
        has_cell=False,
    ),
    Line(
        "predict, the tasks",
        stiffarm.predict,
        "predict",
        [STIFFNESS],
        maybe={"matrix": [True], "model": ["linear", "equilibrium"], "load_uncertainty_percent": [10.0]},
        cells=("comau", "written.toml"),
    ),
    Line(
        "predict, a path",
        stiffarm.predict,
        "predict",
        [STIFFNESS, ["builtin:contour"]],
        always={"axes": ["base", "tool", "path"]},
        maybe={**ALONG, "matrix": [True], "model": ["linear"], "free_turn": [4], "max_step_deg": [20.0]},
        cells=("comau",),
    ),
    Line(
        "predict, angles",
        stiffarm.predict,
        "predict",
        [["stiffness.json", "mixed.json"], ["path.csv"]],
        always={"force_n": [[-300.0, 100.0, 0.0]], "axes": ["base", "tool"]},
        maybe={"moment_nm": [[1.5, 0.0, -2.0]], "matrix": [True]},
        cells=ALL,
    ),
    Line(
        "predict, the cell's load",
        stiffarm.predict,
        "predict",
        [STIFFNESS, ["plan.csv"]],
        always={"cell_load": [True]},
        maybe={"model": ["linear"], "matrix": [True]},
    ),
    Line(
        "compensate",
        stiffarm.compensate,
        "compensate",
        [STIFFNESS, ["builtin:contour"]],
        always={"axes": ["base", "path"]},
        maybe={**ALONG, "free_turn": [3], "max_step_deg": [25.0]},
        cells=("comau",),
    ),
    Line(
        "compensate, angles",
        stiffarm.compensate,
        "compensate",
        [["stiffness.json"], ["path.csv"]],
        always={"force_n": [[-300.0, 100.0, 0.0]], "axes": ["base", "tool"]},
        maybe={"moment_nm": [[0.5, 2.0, -2.0]]},
        cells=ALL,
    ),
    Line(
        "map",
        stiffarm.map,
        "map",
        [["stiffness.json", "prior"]],
        always=REGION,
        maybe={"free_turn": [3], "force_n": [[200.0, -300.0, 100.0]], "rpy_deg": [[170.0, 5.0, 30.0]]},
        cells=("comau", "comau-reference", "comau-shapes", "written.toml"),
    ),
    Line(
        "map, a box",
        stiffarm.map,
        "map",
        [["mixed.json"]],
        always={"from_mm": [[1300.0, -300.0, 600.0]], "to_mm": [[1800.0, 300.0, 1000.0]], "steps": [[3, 3, 2], [4, 2, 2]]},
        maybe={"direction": [[1.0, 0.0, 0.5]], "force_n": [[0.0, 0.0, -90.5]]},
    ),
    Line(
        "map, a moment",
        stiffarm.map,
        "map",
        [["stiffness.json"]],
        always={**REGION, "force_n": [[200.0, -300.0, 100.0]], "moment_nm": [[3.0, 0.0, -8.0]]},
    ),
    Line(
        "place",
        stiffarm.place,
        "map",
        [["stiffness.json", "prior"], ["builtin:contour"]],
        always={"steps": [3], "refine": [0, 1]},
        maybe={"yaw_deg": [[0.0, 45.0]], "free_turn": [2], "plane": [("z", 700.0)]},
        cells=("comau",),
    ),
    Line(
        "place, a box",
        stiffarm.place,
        "map",
        [["stiffness.json"], ["builtin:contour"]],
        always={
            "from_mm": [[1300.0, -300.0, 600.0]],
            "to_mm": [[1800.0, 300.0, 1000.0]],
            "steps": [[2, 2, 1], 2],
            "refine": [0],
            "axes": ["base", "path"],
        },
        cells=("comau",),
    ),
]

#: Functions whose results no command prints.
WITHOUT_COMMAND = {"certificate", "coverage"}


@dataclass(frozen=True)
class Drawn:
    """One call."""

    line: Line
    cell: str
    inputs: list[Any]
    options: dict[str, Any]

    def call(self, files: Mapping[str, str], cell: stiffarm.Cell | None) -> stiffarm.Result:
        """The function's result."""
        inputs = [self._path(one, files) for one in self.inputs]
        options = {k: self._path(v, files) if k in self.line.files else v for k, v in self.options.items()}
        return self.line.function(*([] if cell is None else [cell]), *inputs, **options)

    def words(self, files: Mapping[str, str]) -> list[str]:
        """The command's words."""
        words = [self.line.verb, *([self.cell] if self.line.has_cell else [])]
        words += ["--place=" + self.inputs[1]] if self.line.function is stiffarm.place else []
        for one in self.inputs[:1] if self.line.function is stiffarm.place else self.inputs:
            path = self._path(one, files)
            words += path if isinstance(path, list) else [] if path is None else [path]
        options = {k: self._path(v, files) if k in self.line.files else v for k, v in self.options.items()}
        return [*words, *words_of(options), *self.line.words, "--json", "--quiet"]

    @staticmethod
    def _path(one: Any, files: Mapping[str, str]) -> Any:
        if isinstance(one, list):
            return [files.get(name, name) for name in one]
        return files.get(one, one)


def draw(line: Line, number: int, cells: Sequence[str]) -> Drawn:
    """The draw of this number, the same each time."""
    of = random.Random(f"{line.name} {number}")
    known = [cell for cell in cells if Path(cell.removeprefix("builtin:")).name in line.cells]
    cell = known[(number + of.randrange(2)) % len(known)]
    options = {key: of.choice(list(values)) for key, values in {**line.always, **line.files}.items()}
    for key, values in line.maybe.items():
        if of.random() < 0.4:
            options[key] = of.choice(list(values))
    return Drawn(line, cell, [of.choice(list(values)) for values in line.inputs], options)


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, str]]:
    """Files by cell."""
    return contents(tmp_path_factory.mktemp("work"))


def equal(command: Any, drawn: Drawn, files: Mapping[str, str]) -> str | None:
    """Compares one call with the command; the message where both refuse it, for the same reason."""
    done = command(drawn.words(files))
    printed = json.loads(done.stdout)
    cell = stiffarm.Cell(drawn.cell) if drawn.line.has_cell else None
    if "error" in printed:
        said = printed["error"]
        try:
            drawn.call(files, cell)
        except stiffarm.StiffarmError as error:
            # What is wrong with a combination of options is "usage" to a command line.
            assert said["code"] in ("usage", error.code), f"{drawn}\n{error}\n{done.stdout}"
            return f"{error.code}: {error.message}"
        pytest.fail(f"Only the command refuses {drawn.words(files)}: {said}")
    assert done.returncode in (0, 1), done.stderr
    found = drawn.call(files, cell)
    assert without_arguments(found.to_json()) == without_arguments(done.stdout), drawn
    return None


@pytest.mark.parametrize("line", LINES, ids=lambda line: line.name)
def test_json(command: Any, work: dict[str, dict[str, str]], line: Line) -> None:
    drawn = [draw(line, number, list(work)) for number in range(DRAWS)]
    refused = [equal(command, one, work[one.cell]) for one in drawn]
    # Drawn options may exclude each other; most must not.
    assert refused.count(None) >= DRAWS - 1, refused


@pytest.mark.parametrize("line", LINES, ids=lambda line: line.name)
def test_options_and_calls_make_results_again(work: dict[str, dict[str, str]], line: Line) -> None:
    for number in range(DRAWS):
        drawn = draw(line, number, list(work))
        files = work[drawn.cell]
        cells = [stiffarm.Cell(drawn.cell)] if line.has_cell else []
        try:
            found = drawn.call(files, cells[0] if cells else None)
        except stiffarm.StiffarmError:
            continue
        inputs = [drawn._path(one, files) for one in drawn.inputs]
        named = {key: drawn._path(value, files) for key, value in drawn.options.items() if key in line.files}
        assert line.function(*cells, *inputs, **named, **found.options) == found
        given = inspect.signature(line.function).bind_partial(*cells, *inputs, **named).arguments
        assert eval(found.call, {"stiffarm": stiffarm, **given}) == found
        return
    pytest.fail("No draw gives a result.")


def test_every_function_that_returns_a_result_is_in_the_table() -> None:
    tested = {line.function for line in LINES}
    for name in stiffarm.__all__:
        function = getattr(stiffarm, name)
        if not inspect.isfunction(function):
            continue
        returned = {word.strip() for word in str(inspect.signature(function).return_annotation).split("|")}
        classes = {getattr(stiffarm.results, word, None) for word in returned}
        if any(isinstance(one, type) and issubclass(one, stiffarm.Result) for one in classes):
            assert function in tested or name in WITHOUT_COMMAND, f"{name} is in no line of the table"


def test_every_option_is_drawn() -> None:
    """Options of the functions that no line of the table draws, with the reason."""
    known = {
        "progress": "tells how far the work is",
        "degrees": "of arrays only",
        "accept": "no command has it: test_accept.py",
        "time_limit_s": "depends on the machine",
        "loading_point_box_mm": "as anchor_box_mm",
        "start_deg": "in test_options_of_paths",
        "load_case": "in test_options_of_paths",
        "angle_noise_deg": "in test_options_of_paths",
        "groups": "positional",
        "path": "positional",
        "measurements": "positional",
        "stiffness": "positional",
        "pairs": "positional",
        "cell": "positional",
    }
    for function in {line.function for line in LINES}:
        lines = [line for line in LINES if line.function is function]
        drawn = {key for line in lines for key in [*line.always, *line.maybe, *line.files]}
        left = set(inspect.signature(function).parameters) - drawn - set(known)
        assert not left, f"{function.__name__}: no line draws {sorted(left)}"


def same(command: Any, words: Sequence[str], found: stiffarm.Result) -> None:
    """Holds one result against one call of the command."""
    done = command([*words, "--json", "--quiet"])
    assert done.returncode in (0, 1), done.stdout
    assert without_arguments(found.to_json()) == without_arguments(done.stdout)


def test_options_of_paths(command: Any, work: dict[str, dict[str, str]], tmp_path: Path) -> None:
    name = "builtin:comau"
    cell, files = stiffarm.Cell(name), work[name]
    start = stiffarm.Postures.read(files["plan.csv"], cell).degrees[0].tolist()
    words = ",".join(str(q) for q in start)
    for function in (stiffarm.predict, stiffarm.compensate):
        found = function(cell, files["stiffness.json"], files["path.csv"], start_deg=start, max_step_deg=25.5)
        inputs = [name, files["stiffness.json"], files["path.csv"]]
        same(command, [function.__name__, *inputs, f"--start-deg={words}", "--max-step-deg=25.5"], found)

    found = stiffarm.identify(cell, files["clamped.csv"], clamped=True, noise="known", angle_noise_deg=0.002)
    options = ["--clamped", "--noise=known", "--angle-noise-deg=0.002"]
    same(command, ["identify", name, files["clamped.csv"], *options], found)

    loads = stiffarm.cases(pulled=stiffarm.rope([1800, 0, 0], 500), hung=stiffarm.weight(mass_kg=40))
    several = cell.with_changes({"load": loads})
    file = str(several.save(tmp_path / "cases.toml"))
    several = stiffarm.Cell(file)
    found = stiffarm.predict(several, "prior", files["plan.csv"], cell_load=True, load_case="hung")
    options = ["--cell-load", "--load-case=hung"]
    same(command, ["predict", file, "prior", files["plan.csv"], *options], found)


def test_arrays_frames_and_files(work: dict[str, dict[str, str]]) -> None:
    """One group of postures in every form gives one result, with one hash."""
    cell = stiffarm.Cell("builtin:comau")
    file = work["builtin:comau"]["plan.csv"]
    own = stiffarm.Postures.read(file, cell)
    expected = stiffarm.evaluate(cell, file).to_json()
    table = own.table()
    forms: dict[str, Any] = {
        "postures": own,
        "table": table,
        "mapping": dict(table),
        "pandas": own.to_frame("pandas"),
        "polars": own.to_frame("polars"),
        "pyarrow": pyarrow.table(table),
        "pandas.read_csv": pandas.read_csv(file, dtype={"posture": str}),
        "polars.read_csv": polars.read_csv(file),
        "pandas with names as numbers": pandas.read_csv(file),
    }
    for form, value in forms.items():
        assert stiffarm.evaluate(cell, {"plan": value}).to_json() == expected, form
    # An array has no names of its own: these are "1", "2", ..., as here.
    assert own.names == [str(i + 1) for i in range(len(own))]
    assert stiffarm.evaluate(cell, {"plan": own.angles}).to_json() == expected
    in_degrees = stiffarm.evaluate(cell, {"plan": own.degrees}, degrees=True).to_json()
    assert without_arguments(in_degrees) == without_arguments(expected)
    assert stiffarm.evaluate(cell, {"plan": np.asfortranarray(own.angles)}).to_json() == expected
    assert stiffarm.evaluate(cell, {"plan": own.angles.tolist()}).to_json() == expected
    assert Path(file).read_text(encoding="utf-8") == own.to_csv() == table.to_csv()


def test_measurements_in_every_form(work: dict[str, dict[str, str]]) -> None:
    cell = stiffarm.Cell("builtin:comau")
    for name in ("measured.csv", "readings.csv"):
        file = work["builtin:comau"][name]
        expected = stiffarm.identify(cell, file).to_json()
        table = stiffarm.Table.from_csv(Path(file).read_text(encoding="utf-8"))
        exact = polars.read_csv(file, infer_schema_length=None)
        forms = {
            "table": table,
            "pandas": table.to_frame("pandas"),
            "polars": table.to_frame("polars"),
            "pyarrow": pyarrow.table(table),
            "polars.read_csv": exact,
            "pandas of pyarrow": pandas.read_csv(file, dtype_backend="pyarrow", engine="pyarrow"),
        }
        for form, value in forms.items():
            assert stiffarm.identify(cell, value).to_json() == expected, f"{name}: {form}"


def test_results_in_memory_and_as_files(work: dict[str, dict[str, str]], tmp_path: Path) -> None:
    cell = stiffarm.Cell("builtin:comau")
    files = work["builtin:comau"]
    plan = stiffarm.select(cell, postures=4, rounds=1, no_certificate=True)
    plan.postures.save(tmp_path / "plan.csv")
    by_file = stiffarm.evaluate(cell, tmp_path / "plan.csv")
    assert by_file.inputs == stiffarm.evaluate(cell, plan).inputs
    assert by_file.groups[0].to_dict()["indices"] == stiffarm.evaluate(cell, plan).groups[0].to_dict()["indices"]
    readings = stiffarm.simulate_measurements(cell, plan)
    assert readings == stiffarm.simulate_measurements(cell, tmp_path / "plan.csv")

    found = stiffarm.identify(cell, files["measured.csv"])
    saved = found.save(tmp_path / "stiffness.json")
    for function, rest in (
        (stiffarm.predict, ["builtin:contour"]),
        (stiffarm.compensate, ["builtin:contour"]),
        (stiffarm.validate, [files["second.csv"]]),
    ):
        assert function(cell, found, *rest).to_json() == function(cell, saved, *rest).to_json()
    pairs = stiffarm.register("builtin:example-pairs")
    saved = pairs.save(tmp_path / "registration.json")
    assert (
        stiffarm.identify(cell, files["readings.csv"], registration=pairs).to_json()
        == stiffarm.identify(cell, files["readings.csv"], registration=saved).to_json()
    )


def test_save_and_load(command: Any, work: dict[str, dict[str, str]], tmp_path: Path) -> None:
    """``save`` writes what ``--output`` of the command writes, and ``load`` reads both."""
    cell, measured = stiffarm.Cell("builtin:comau"), work["builtin:comau"]["measured.csv"]
    found = stiffarm.identify(cell, measured)
    saved = found.save(tmp_path / "own.json")
    command(["identify", "builtin:comau", measured, "--quiet", f"--output={tmp_path / 'command.json'}"])
    own, theirs = saved.read_bytes().decode(), (tmp_path / "command.json").read_bytes().decode()
    assert without_arguments(own) == without_arguments(theirs)
    assert type(found).load(saved) == found
    assert type(found).load(saved).to_dict() == type(found).load(tmp_path / "command.json").to_dict()
    with pytest.raises(stiffarm.StiffarmError, match="not of predict"):
        stiffarm.results.Predicted.load(saved)

    plan = stiffarm.select(cell, postures=3, rounds=1, no_certificate=True)
    plan.postures.save(tmp_path / "own.csv")
    words = ["select", "builtin:comau", "-n", "3", "--rounds", "1", "--no-certificate", "--quiet"]
    command([*words, f"--output={tmp_path / 'command.csv'}"])
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "command.csv").read_bytes()
    for option, readings in (("--measurements", False), ("--readings", True)):
        file = tmp_path / f"{option}.csv"
        command(["simulate", "builtin:comau", str(tmp_path / "own.csv"), "--runs=1", "--quiet", f"{option}={file}"])
        table = stiffarm.simulate_measurements(cell, plan, readings=readings)
        assert table.to_csv() == file.read_text(encoding="utf-8")


def test_threads_change_no_byte(tmp_path: Path, work: dict[str, dict[str, str]]) -> None:
    program = """
import hashlib, sys, stiffarm
cell = stiffarm.Cell("builtin:comau")
plan, measured = sys.argv[1:]
found = [
    stiffarm.select(cell, postures=4, rounds=2, seed=3),
    stiffarm.simulate(cell, plan, runs=20),
    stiffarm.identify(cell, measured, bootstrap=200),
    stiffarm.map(cell, "prior", plane="z=800", steps=5),
    stiffarm.coverage(cell, plan, runs=50),
    stiffarm.certificate(cell, plan, samples=32),
    stiffarm.Table({k: v for k, v in stiffarm.indices(cell, [stiffarm.Postures.read(plan, cell).angles] * 50).items()}).to_csv(),
]
for one in found:
    text = one if isinstance(one, str) else one.to_json()
    print(hashlib.sha256(text.encode()).hexdigest())
"""
    files = work["builtin:comau"]
    printed = []
    for threads in ("1", "2", "3"):
        run = subprocess.run(
            [sys.executable, "-c", program, files["plan.csv"], files["measured.csv"]],
            env={**os.environ, "RAYON_NUM_THREADS": threads},
            stdout=subprocess.PIPE,
            check=True,
            text=True,
        )
        printed.append(run.stdout)
    assert printed[0] == printed[1] == printed[2]
    assert len(printed[0].splitlines()) == 7


def test_mixed_is_read_again() -> None:
    """Whatever is identified can be used: 6 simulated experiments with the mixed model."""
    cell = stiffarm.Cell.built_in("comau-shapes")
    postures = stiffarm.select(cell, space_filling=True, postures=8, seed=5)
    refused = []
    for seed in range(6):
        found = stiffarm.identify(cell, stiffarm.simulate_measurements(cell, postures, seed=seed), elastic="mixed")
        try:
            stiffarm.predict(cell, found, postures, cell_load=True)
        except stiffarm.StiffarmError as error:
            refused.append(str(error))
    assert not refused, refused
