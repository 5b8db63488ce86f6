"""Every kind of page, and the commands that make it: small runs, which show all that a large one would."""

import csv
import dataclasses
import hashlib
import itertools
import json
import pathlib
import re
import struct
import subprocess

from checks import Expected

# What a name may hold: the end of a script, an element that runs, quotes, an ampersand, writing from right to left.
HOSTILE = "</script><img src=x onerror=alert(1)>\"'&amp; \u05d0\u05d1"
# What only a result that somebody has edited holds, because the readers refuse it: an escape, and a mark that turns
# the direction of what follows.
EDITED = "</title><img src=x onerror=alert(2)>\x1b[31mred\u202e"

OBSTACLES = """
[[obstacle]]
name = "floor"
kind = "floor"
z_mm = 0

[[obstacle]]
name = "fence"
kind = "wall"
point_mm = [0, 2600, 0]
normal = [0, -1, 0]

[[obstacle]]
name = "table"
kind = "box"
center_mm = [2000, -700, 150]
size_mm = [600, 500, 300]
rpy_deg = [0, 0, 20]

[[obstacle]]
name = "column"
kind = "cylinder"
from_mm = [1200, 1700, 0]
to_mm = [1200, 1700, 2200]
radius_mm = 150

[[tool.shape]]
name = "spindle"
kind = "cylinder"
from_mm = [0, 0, 0]
to_mm = [0, 0, 200]
radius_mm = 70

[[tracker.station]]
name = "front"
position_mm = [4500, 800, 1400]
"""

CELLS = pathlib.Path(__file__).resolve().parents[2] / "cells"
COMAU, GROUP = "builtin:comau", "builtin:comau-group1"


@dataclasses.dataclass
class Kind:
    """A page: what is run before, the command whose result it shows, and what must be on it.

    The last command prints its result as JSON and leaves its page by `--report`; with `results`, files of others, the
    page is made by `report` alone. `cell` is what `report` is told by `--cell`.
    """

    name: str
    before: list
    command: list | None
    expected: Expected
    cell: str | None = None
    results: list = dataclasses.field(default_factory=list)
    may_be_refused: bool = False


def kind(name, before, command, cell=COMAU, commands=None, results=(), may_be_refused=False, **expected):
    wanted = Expected(commands=commands or [command[0]], **expected)
    return Kind(name, before, command, wanted, cell, list(results), may_be_refused)


# Readings and the stiffness that others start from.
READINGS = [
    [
        *("simulate", COMAU, GROUP, "--runs", "5", "--levels", "1"),
        *("--readings", "readings.csv", "--measurements", "measured.csv"),
    ],
    ["identify", COMAU, "readings.csv", "--output", "stiffness.json"],
]

KINDS = [
    kind("study", [], ["study", "--runs", "20", "--initial-groups", "4", "--output-dir", "study"], groups=2, megabytes=6),
    kind(
        "select-shapes", [], ["select", "builtin:comau-shapes", "-n", "3", "--rounds", "1", "--no-certificate", "--output", "plan.csv"],
        cell="builtin:comau-shapes",
    ),
    kind("select-curve", [], ["select", COMAU, "--curve", "-n", "4", "--rounds", "1"], scene=False, slider=False),
    kind(
        "simulate", [["select", COMAU, "-n", "6", "--rounds", "1", "--output", "plan.csv"]],
        ["simulate", COMAU, GROUP, "plan.csv", "--runs", "20"], groups=2,
    ),
    kind("identify", READINGS[:1], ["identify", COMAU, "readings.csv", "--output", "stiffness.json"]),
    kind("validate", READINGS, ["validate", COMAU, "stiffness.json", "measured.csv"]),
    kind("validate-folds", READINGS, ["validate", COMAU, "readings.csv", "--folds", "all"]),
    kind("predict", READINGS, ["predict", COMAU, "stiffness.json", "builtin:contour"]),
    kind("compensate", READINGS, ["compensate", COMAU, "stiffness.json", "builtin:contour", "--output", "commanded.csv"]),
    kind("map", READINGS, ["map", COMAU, "stiffness.json", "--plane", "z=800", "--steps", "15"], slider=False),
    kind("evaluate", [], ["evaluate", COMAU, GROUP]),
    kind(
        "comparison",
        [
            *READINGS,
            ["identify", COMAU, "readings.csv", "--json", "> one.json"],
            ["identify", COMAU, "readings.csv", "--estimator", "huber", "--json", "> two.json"],
        ],
        None, commands=["identify", "identify"], results=["one.json", "two.json"], numbers=20, groups=1,
    ),
    kind(
        "fanuc", [], ["identify", "builtin:fanuc-r2000ic", "builtin:fanuc-r2000ic-readings"], cell="builtin:fanuc-r2000ic",
    ),
    kind(
        "kr210-obstacles", [["init", "--robot", "kuka-kr210-r2700-2", "--output-dir", "kr210"], ["+prior", "kr210/cell.toml", "6"], ["+obstacles", "kr210/cell.toml"]],
        ["select", "kr210/cell.toml", "-n", "6", "--rounds", "1", "--output", "plan.csv"], cell="kr210/cell.toml",
    ),
    kind(
        "seven-axes", [["init", "--robot", "panda", "--output-dir", "panda"], ["+prior", "panda/cell.toml", "7"]],
        ["select", "panda/cell.toml", "-n", "7", "--rounds", "1", "--output", "plan.csv"], cell="panda/cell.toml",
    ),
    kind(
        "hostile",
        [
            ["+hostile", "cell.toml", "postures.csv"],
            ["simulate", "cell.toml", "postures.csv", "--runs", "5", "--levels", "1", "--readings", "readings.csv"],
        ],
        ["identify", "cell.toml", "readings.csv"], cell="cell.toml", names=[HOSTILE],
    ),
    kind(
        "hostile-plan", [["+hostile", "cell.toml", "postures.csv"]],
        ["select", "cell.toml", "-n", "2", "--rounds", "1", "--no-certificate", "--output", "plan.csv"], cell="cell.toml",
    ),
    kind(
        "hostile-result",
        [
            *READINGS[:1],
            ["identify", COMAU, "readings.csv", "--exclude", "2", "--json", "> plain.json"],
            ["+edit", "plain.json", "edited.json"],
        ],
        None, cell=None, commands=["identify"], results=["edited.json"], scene=False, slider=False, may_be_refused=True,
    ),
    kind(
        "largest",
        [
            # Two halves of a group take a sixth of the time of the whole, and five halves make ten groups.
            *(["select", COMAU, "--space-filling", "-n", "25", "--seed", str(i), "--output", f"half{i}.csv"] for i in range(5)),
            *(["+join", f"g{i}.csv", f"half{a}.csv", f"half{b}.csv"] for i, (a, b) in enumerate(itertools.combinations(range(5), 2), 1)),
        ],
        ["evaluate", COMAU, *(f"g{i}.csv" for i in range(1, 11))], groups=10, frame_ms=50,
    ),
]


# What docs/report.md shows.
GALLERY = ["kr210-obstacles", "identify", "predict", "comparison"]
# The posture that the picture of a cell shows, where it is not the first.
GALLERY_POSTURES = {"kr210-obstacles": 4}


class NotMade(Exception):
    """A command that did not do what the kind needs of it."""

    def __init__(self, why, code=None):
        super().__init__(why)
        self.code = code


class Maker:
    """Runs the commands of a kind in a folder of its own."""

    def __init__(self, stiffarm, folder):
        self.stiffarm, self.folder = stiffarm.resolve(), folder.resolve()

    def has_report(self):
        done = subprocess.run([self.stiffarm, "report", "--help"], capture_output=True)
        return done.returncode == 0

    def make(self, kind):
        """The pages of one kind, that of the command first, and the files of their results."""
        folder = self.folder / kind.name
        folder.mkdir()
        for words in kind.before:
            self.run(words, folder)
        results, pages = kind.results, []
        if kind.command:
            self.run([*kind.command, "--report", "page.html", "--json", "> result.json"], folder)
            results, pages = ["result.json"], ["page.html"]
            if kind.command[0] == "study" and not (folder / "study" / "report.html").is_file():
                raise NotMade("study leaves no report.html in its folder")
        cell = ["--cell", kind.cell] if kind.cell else []
        self.run(["report", *results, *cell, "--output", "report.html"], folder)
        pages.append("report.html")
        return [folder / page for page in pages], [folder / result for result in results]

    def run(self, words, folder):
        """One command; `> FILE` as its last word keeps what it prints. Findings (exit code 1) are no failure here."""
        if words[0].startswith("+"):
            return PREPARED[words[0]](folder, *words[1:])
        target = None
        if words[-1].startswith("> "):
            *words, last = words
            target = folder / last[2:]
        done = subprocess.run([self.stiffarm, *words, "--quiet"], cwd=folder, capture_output=True)
        if done.returncode not in (0, 1):
            # With --json an error goes to standard output.
            complaint = (done.stderr or done.stdout).decode("utf-8", "replace").strip()
            raise NotMade(f"`stiffarm {' '.join(words)}` ended with {done.returncode}: {complaint}", done.returncode)
        if target:
            target.write_bytes(done.stdout)
        return done


def add_obstacles(folder, cell):
    with open(folder / cell, "a", encoding="utf-8") as file:
        file.write(OBSTACLES)


def add_prior(folder, cell, joints):
    """A guess for each joint, smaller towards the wrist: without it nothing is planned."""
    text = (folder / cell).read_text(encoding="utf-8")
    prior = [round(2e6 / 1.6**i) for i in range(int(joints))]
    assert text.count("\n[stiffness]\n") == 1
    text = text.replace("\n[stiffness]\n", f"\n[stiffness]\nprior_nm_per_rad = {prior}\n")
    (folder / cell).write_text(text, encoding="utf-8")


def write_hostile(folder, cell, postures):
    """The cell with shapes and the initial group, each name of them hostile."""
    text = (CELLS / "comau-shapes.toml").read_text(encoding="utf-8")
    text = re.sub(r'(?m)^name = "(.*)"$', lambda m: f"name = {json.dumps(m[1] + HOSTILE)}", text)
    (folder / cell).write_text(text, encoding="utf-8")
    with open(CELLS / "comau-group1.csv", newline="", encoding="utf-8") as file:
        heading, *rows = csv.reader(line for line in file if not line.startswith("#"))
    with open(folder / postures, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([heading, *([name + HOSTILE, *angles] for name, *angles in rows)])


def edit(folder, plain, edited):
    """A result in which every name of a posture, point or shape is what no reader lets in."""
    def renamed(value, key=None):
        if isinstance(value, dict):
            return {k: renamed(v, k) for k, v in value.items()}
        if isinstance(value, list):
            return [renamed(v, key) for v in value]
        named = isinstance(value, str) and key in ("name", "names", "posture", "point", "cell")
        return value + EDITED if named else value

    result = renamed(json.loads((folder / plain).read_text(encoding="utf-8")))
    sealed = result["result"]["sealed"]
    del result["seal"]
    whole = {key: value for key, value in result.items() if key != "arguments"}
    result["seal"] = {"file": sha256(spelled(whole)), "sealed": sha256(spelled(sealed))}
    (folder / edited).write_text(json.dumps(result), encoding="utf-8")


def join(folder, joined, *parts):
    """The postures of several groups as one, numbered anew."""
    rows = []
    for part in parts:
        heading, *more = (folder / part).read_text(encoding="utf-8").splitlines()
        rows += [row.partition(",")[2] for row in more]
    lines = [heading, *(f"{number},{row}" for number, row in enumerate(rows, 1))]
    (folder / joined).write_text("\n".join(lines) + "\n", encoding="utf-8")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def spelled(value):
    """A value in the spelling whose hash is its seal, as crates/stiffarm-files/src/seal.rs has it."""
    if value is None or isinstance(value, bool):
        return {None: b"n", True: b"t", False: b"f"}[value]
    if isinstance(value, str):
        return b"s" + struct.pack(">Q", len(value.encode())) + value.encode()
    if isinstance(value, list):
        return b"[" + sha256(b"".join(map(spelled, value))).encode()
    if isinstance(value, dict):
        entries = (spelled(key) + spelled(value[key]) for key in sorted(value))
        return b"{" + sha256(b"".join(entries)).encode()
    return b"d" + struct.pack(">d", float(value) + 0.0)


PREPARED = {"+obstacles": add_obstacles, "+prior": add_prior, "+hostile": write_hostile, "+edit": edit, "+join": join}
