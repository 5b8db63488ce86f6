#!/usr/bin/env python3
"""Is G-code read as a control drives it, and does a control drive what is written?

The control is LinuxCNC's interpreter, `rs274` of Debian's package linuxcnc-uspace, which is installed where it is missing
(as root). Random valid programs (planes, I J K and R, helices, full circles and several turns, G90 and G91, G90.1 and
G91.1, inches, offsets, cycles, G93, and words that a reader may overlook) are driven by it and read by `stiffarm.read_path`.
A program is read the same, refused, said (another path, with a caution or worse) or different, which must not be. What is
read the same is written with all its points moved (`stiffarm.write_path`), and that is driven again.

    pip install ./crates/stiffarm-py && python3 bench/gcode.py
    python3 bench/gcode.py --words crates/stiffarm/tests/golden/rs274.txt      # what rs274 does at each word, for the tests
"""

from __future__ import annotations

import argparse
import math
import random
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

TOLERANCE = 0.016  # mm: chords are 0.01 mm from an arc at most, and rs274 prints four decimals, also of an inch
HEAD = "G21 G90 G17 G40 G49 G54 G94\nG0 X1 Y2 Z5\nF100\n"
CELL = """format = 1
robot.catalogue = 'kuka-kr500-r2800-2'
tool = { loading_point_mm = [200, 0, 250], measuring_point = [{ name = '1', position_mm = [0, 0, 300] }] }
load = { kind = 'measured' }
[work]
tip_mm = [0, 0, 300]
workpiece_mm = [1500, 0, 600]
"""
AXES = {"XY": (0, 1, 2), "YZ": (1, 2, 0), "XZ": (2, 0, 1)}  # of a plane: first, second, across

# One line each: what follows HEAD, blocks between slashes.
WORDS = """
M2 / G1 X9
M30 / G1 X9
G1 X5 M30 / G1 X9
% / G1 X9
M99 / G1 X9
G41.1 D1 / G1 X5 Y5 / X9
G42.1 D1 / G1 X5 Y5 / X9
G41.2 D1 / G1 X5
G42.2 D1 / G1 X5
G33 Z-5 K1
G33.1 Z-5 K1
G38.2 X9
G38.3 X9
G38.4 X9
G38.5 X9
G31 X9
G43.1 Z1 / G1 X4
G43.2 H1 / G1 X4
G13 I5
G22 X9
G25 X9
G58 X9
G0 G58 X9
G7 / G1 X10
G8 / G1 X10
G55 / G1 X4
G54.1 P2 X4
G154 P1 / G1 X4
G505 X3
G28
G28 / G1 X4
G28 X9 / G1 Y4
G30 / G1 X4
G53 G0 Z0 / G1 X4
#1=7 G1 Y3
#<way>=[1+2] G1 Y3
G1 Y3 #1=7
#1=7 G1 Y#1
G43.5 H1 / G1 X4
G4 X1.5
G04 X1.5 / G1 X4
G4 P.1 / G1 X4
G4 P.1 X30
G0 X30 G4 P.1
G1 X30 G4 P.1
L100
G1 X5 L2
G1 X5 P2
G1 X5 R1
G1 X5 I1
G1 X5 E3
G1X5E3
G92 X0 / G1 X5
G92 E0 / G1 X5
G52 X1 / G1 X5
G10 L2 P1 X5 / G1 X1
G5 X5 Y5 I1 J1 P1 Q1
G5.1 X5 Y5 I1 J1
G17.1 / G1 X3
G80 X5
G80 / X5
G80 G1 X7
G0 X7 G80
M98 P1
G65 P1
M72 / G1 X3
o100 sub / o100 endsub / G1 X3
G3 X3 Y2 R1 P2
G2 X1 Y2 I3 J0
G2 X1 Y2 I3 J0 P3
G2 X1 Y2 R3
G18 G2 X3 Z5 R1
G19 G2 Y3 Z5 R-1
G3 X3 Y2 I1 J0 Z9
G90.1 G2 X3 Y2 I2 J2
G91 G2 X2 I1
G93 G1 X5 F2 / X6 F3
G93 G1 X5 F2 / X6
G20 / G1 X1
G1 X5 X6
G1 G2 X5
/ G1 X5
M0 G1 X5
G1 X5 M0
G61 G1 X5
G64 P.1 G1 X5
G1 X[1+2]
G777 / G1 X5
G777 X5
G81 X10 Y10 Z-5 R2 / X20 / G80 / G1 Y3
G98 G81 X10 Y10 Z-5 R2 / X20 / G80 / G1 Y3
G99 G81 X10 Z-5 R2 / G98 X20 / G99 X30
G98 G81 Z-3 R7 / X3
G99 G81 X2 Z-3 R2 L3 / X4 L2
G91 G99 G81 X1 Z-3 R-2 / X1 / X1 L2 / R-1 X1 / Z-2 X1
G91 G98 G81 X1 Z-3 R-2 / X1 / G90 X9
G99 G81 X2 Z-3 R2 / G91 / X1 / X1
G81 X2 Z-3 R2 L0
G81 X1 Z-3
G81 X1 Z4 R2
G99 G81 X2 Z-3 R2 / G1 X9 / X10
G99 G82 X1 Z-3 R2 P.1
G99 G83 X1 Z-3 R2 Q2
G98 G83 X1 Z-3 R2 Q2 / X4 Q3
G83 X1 Z-3 R2
G99 G85 X1 Z-3 R2
G98 G85 X1 Z-3 R2
G99 G89 X1 Z-3 R2 P.1
G98 G89 X1 Z-3 R2 P.1
G99 G73 X1 Z-3 R2 Q2 / G80 / G1 X9
G84 X1 Z-3 R2
G86 X1 Z-3 R2 P.1
G93 G81 X2 Z-3 R2 F1
G81 X2 Z-3 R2 A5
G18 G99 G81 X1 Y1 Z5 R3
"""


def interpreter() -> str:
    """Installs rs274 where it is missing, and says its version."""
    if not shutil.which("rs274"):
        print("installing linuxcnc-uspace", file=sys.stderr)
        subprocess.run(["apt-get", "update", "-qq"], check=True)
        subprocess.run(["apt-get", "install", "-y", "-qq", "linuxcnc-uspace"], check=True, stdout=subprocess.DEVNULL)
    shown = subprocess.run(["dpkg-query", "-W", "linuxcnc-uspace"], check=True, capture_output=True, text=True)
    return shown.stdout.split()[1]


def driven(text: str) -> tuple[list[tuple[tuple[float, ...], bool]] | None, str]:
    """Where rs274 drives, from the first point of HEAD on: points in mm, and whether the way to each is rapid. Or why not."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "tools.tbl").write_text("T1 P1 Z0 D10\n")
        (Path(folder) / "part.ngc").write_text(text)
        call = ["rs274", "-g", "-t", "tools.tbl", "part.ngc"]
        out = subprocess.run(call, cwd=folder, capture_output=True, text=True, timeout=60)
    points, unit, plane = [], 1.0, "XY"
    for line in out.stdout.splitlines():
        call = re.match(r"\s*\d+ N\S*\s+(\w+)\((.*)\)\s*$", line)
        if not call:
            continue
        name, rest = call.groups()
        if name == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in rest else 1.0
        elif name == "SELECT_PLANE":
            plane = rest[-2:]
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "STRAIGHT_PROBE"):
            at = tuple(unit * float(value) for value in rest.split(",")[:3])
            points.append((at, name == "STRAIGHT_TRAVERSE"))
        elif name == "ARC_FEED":
            values = [float(value) for value in rest.split(",")]
            points += [(at, False) for at in arc(points[-1][0], values, unit, plane)]
        elif name.startswith("NURB") or name in ("RIGID_TAP", "SPINDLE_SYNC_MOTION"):
            return None, f"drives {name}"
    errors = [line for line in out.stderr.splitlines() if line and line != "executing"]
    if errors and not errors[0].startswith("File ended with no percent sign"):
        return None, errors[0].strip()
    return points, ""


def arc(start: tuple[float, ...], values: list[float], unit: float, plane: str) -> list[tuple[float, ...]]:
    """Points on an arc as ARC_FEED states it: end and centre in the plane, turns, end across it."""
    first, second, across = AXES[plane]
    end, centre, turns, rise = [unit * v for v in values[:2]], [unit * v for v in values[2:4]], values[4], unit * values[5]
    begin = math.atan2(start[second] - centre[1], start[first] - centre[0])
    sweep = math.atan2(end[1] - centre[1], end[0] - centre[0]) - begin
    side = math.copysign(1, turns)
    sweep = side * ((side * sweep) % math.tau)
    if abs(sweep) < 1e-9 or math.tau - abs(sweep) < 1e-4 * unit and math.hypot(end[0] - start[first], end[1] - start[second]) < 2e-4 * unit:
        sweep = side * math.tau
    sweep += side * math.tau * (abs(turns) - 1)
    radius = math.hypot(start[first] - centre[0], start[second] - centre[1])
    count = max(8, math.ceil(abs(sweep) / math.acos(max(0.0, 1 - 0.002 / max(radius, 0.002))) / 2))
    points = []
    for k in range(1, count + 1):
        point, angle = [0.0, 0.0, 0.0], begin + sweep * k / count
        point[first] = end[0] if k == count else centre[0] + radius * math.cos(angle)
        point[second] = end[1] if k == count else centre[1] + radius * math.sin(angle)
        point[across] = start[across] + (rise - start[across]) * k / count
        points.append(tuple(point))
    return points


def words(file: str) -> int:
    """The table for the tests."""
    lines = [
        f"# What rs274 of linuxcnc-uspace {interpreter()} does, made by `bench/gcode.py --words`. A program is HEAD, then the blocks",
        "# between slashes. Behind it the points in mm that it drives to, r rapid and f at feed, arcs as chords; or ! and why not.",
        "# HEAD: " + " / ".join(HEAD.split("\n")[:-1]),
    ]
    for program in WORDS.strip().splitlines():
        # rs274 knows % as the end only where it stands at the beginning, too.
        mark = "%\n" if "%" in program else ""
        points, why = driven(mark + HEAD + "\n".join(split(program)) + "\n")
        lines.append(program)
        if points is None:
            lines.append(f"  ! {why}")
        else:
            shown = (("r" if rapid else "f") + " " + " ".join(f"{value:.4f}" for value in at) for at, rapid in points[1:])
            lines.append("  " + " | ".join(shown))
    Path(file).write_text("\n".join(lines) + "\n")
    return 0


def split(program: str) -> list[str]:
    """Blocks between slashes; a slash at the beginning is one of the block."""
    begin = "/" if program.startswith("/") else ""
    blocks = program.removeprefix("/").split(" / ")
    return [begin + blocks[0].strip(), *blocks[1:]]



class Program:
    """A random program that is valid for rs274: it knows where the tool is."""

    def __init__(self, rng: random.Random) -> None:
        self.rng, self.unit = rng, rng.choice([1.0, 1.0, 25.4])
        self.at = [0.0, 0.0, 20.0 / self.unit]
        self.steps, self.centres, self.plane, self.inverse, self.number = False, False, "XY", False, 0
        offset = rng.choice(["", "G54", "G54", "G55"])
        self.lines = [f"({rng.randrange(1000)})", f"{'G21' if self.unit == 1 else 'G20'} G90 G91.1 G17 G40 G49 G94 G80 {offset}"]
        self.lines += [f"G0 X0 Y0 Z{self.at[2]:.4f}", "F200"]

    def length(self, low: float, high: float) -> float:
        """A length in units of the program, as it will stand there."""
        return round(self.rng.uniform(low, high) / self.unit, 4)

    def words(self, target: list[float], axes: list[int]) -> str:
        """Words that lead to the target along some axes; the tool is there then, as rounded."""
        shown = []
        for axis in axes:
            value = round(target[axis] - (self.at[axis] if self.steps else 0.0), 4)
            form = self.rng.choice(["{:.4f}", "{:+.4f}", "{:.5f}"])
            shown.append("XYZ"[axis] + form.format(value))
            self.at[axis] = value + (self.at[axis] if self.steps else 0.0)
        self.rng.shuffle(shown)
        return " ".join(shown)

    def block(self, text: str) -> None:
        """Adds a block, with a number, a comment or a slash now and then, in capitals or not."""
        self.number += 10
        text = f"N{self.number} {text}" if self.rng.random() < 0.3 else text
        text = text.lower() if self.rng.random() < 0.1 else text
        text = text.replace(" ", "") if self.rng.random() < 0.1 and "(" not in text else text
        text += " (note)" if self.rng.random() < 0.1 else ""
        self.lines.append("/" + text if self.rng.random() < 0.05 else text)

    def feed(self) -> str:
        return f" F{self.rng.uniform(1, 60):.2f}" if self.inverse else ""

    def line(self) -> None:
        axes = sorted(self.rng.sample(range(3), self.rng.choice([1, 1, 2, 3])))
        target = [self.at[axis] + self.length(-30, 30) for axis in range(3)]
        word = self.rng.choice(["G0", "G1", "G1"])
        self.block(f"{word} {self.words(target, axes)}" + (self.feed() if word == "G1" else ""))

    def arc(self) -> None:
        first, second, across = AXES[self.plane]
        radius, begin = self.length(2, 25), self.rng.uniform(0, math.tau)
        is_left, is_full = self.rng.random() < 0.5, self.rng.random() < 0.2
        sweep = self.rng.uniform(0.2, 6.0)
        # Centre and end as they stand in the program, so that they are on one circle to its digits.
        offset = [round(-radius * math.cos(begin), 4), round(-radius * math.sin(begin), 4)]
        radius = math.hypot(*offset)
        begin = math.atan2(-offset[1], -offset[0])
        end = begin + (sweep if is_left else -sweep)
        centre = [self.at[first] + offset[0], self.at[second] + offset[1]]
        target = list(self.at)
        if not is_full:
            target[first] = round(centre[0] + radius * math.cos(end), 4)
            target[second] = round(centre[1] + radius * math.sin(end), 4)
        is_helix = self.rng.random() < 0.3
        target[across] += self.length(-4, 4) if is_helix else 0.0
        with_radius = not is_full and not self.centres and 0.3 < sweep < 5.9 and abs(sweep - math.pi) > 0.2 and self.rng.random() < 0.4
        axes = ([] if is_full else [first, second]) + ([across] if is_helix else [])
        from_centre = centre if self.centres else offset
        moved = self.words(target, axes)
        letters = "IJK"[first], "IJK"[second]
        how = (
            f"R{'-' if sweep > math.pi else ''}{radius:.5f}"
            if with_radius
            else " ".join(f"{letter}{value:.4f}" for letter, value in zip(letters, from_centre))
        )
        turns = f" P{self.rng.choice([1, 2, 3])}" if self.rng.random() < 0.15 else ""
        self.block(f"G{3 if is_left else 2} {moved} {how}{turns}".replace("  ", " ") + self.feed())

    def cycle(self) -> None:
        if self.inverse or self.plane != "XY":
            return
        word, back = self.rng.choice([81, 81, 82, 83, 85, 89]), self.rng.choice([98, 99])
        z = self.at[2]
        r, bottom = (self.length(-6, 2), -self.length(1, 12)) if self.steps else (round(z + self.length(-6, 2), 4), 0.0)
        bottom = bottom if self.steps else round(r - self.length(1, 12), 4)
        rest = {82: " P0.2", 89: " P0.1", 83: f" Q{self.length(1, 5)}"}.get(word, "")
        x, y = self.length(-30, 30), self.length(-30, 30)
        self.block(f"G{back} G{word} X{x} Y{y} Z{bottom} R{r}{rest}")
        for _ in range(self.rng.randrange(3)):
            repeats = f" L{self.rng.choice([2, 3])}" if self.rng.random() < 0.3 else ""
            self.block(f"{self.rng.choice('XY')}{self.length(-30, 30)}{repeats}")
        self.block("G80")
        # Where it stands now is the interpreter's affair: all axes are stated again.
        was, self.steps = self.steps, False
        self.at = [self.length(-30, 30), self.length(-30, 30), self.length(5, 30)]
        place = " ".join(f"{letter}{value:.4f}" for letter, value in zip("XYZ", self.at))
        self.block(f"G90 G0 {place}")
        if was:
            self.steps = True
            self.block("G91")

    def mode(self) -> None:
        choice = self.rng.randrange(5)
        if choice == 0:
            self.steps = not self.steps
            self.block("G91" if self.steps else "G90")
        elif choice == 1:
            self.centres = not self.centres
            self.block("G90.1" if self.centres else "G91.1")
        elif choice == 2:
            self.plane = self.rng.choice(list(AXES))
            self.block({"XY": "G17", "XZ": "G18", "YZ": "G19"}[self.plane])
        elif choice == 3:
            self.inverse = not self.inverse
            self.block("G93" if self.inverse else "G94 F200")
        else:
            self.block(self.rng.choice(["G4 P0.1", "M8", "M0", "S1000 M3", "G61", "G64 P0.02", "(a note)", "#1=7", "T1 M6"]))

    def odd(self) -> None:
        """A word that a reader may overlook; rs274 drives it."""
        words = [
            "G7", "G28", "G28 Z0", "G30", "G53 G0 Z0", "G55", "G59.3", "G92 X3", "G92.1", "G52 X1", "G10 L2 P1 X5", "G43.1 Z2",
            "G41.1 D3", "G42.1 D2", "G38.2 Z-90", "#2=3 G0 X9", "G0 X9 #3=1", "G4 P0.1 X7", "G5.1 X5 Y5 I1 J1", "G99 G73 X3 Y3 Z-50 R2 Q9",
            "G20", "G21", "M2", "M30", "%", "M99", "G17.1", "G43 H1", "G49", "G8", "G96 D200 S100 M3", "G97 S100", "G91.1", "M70", "G80",
        ]  # fmt: skip
        self.block(self.rng.choice(words))

    def text(self) -> str:
        for _ in range(self.rng.randrange(5, 25)):
            self.rng.choices([self.line, self.arc, self.cycle, self.mode, self.odd], [6, 5, 2, 3, 0.4])[0]()
        return "\n".join([*self.lines, "M2"]) + "\n"


def moves(stops: list, start: tuple[float, ...]) -> list:
    """Without moves that lead nowhere."""
    kept, at = [], start
    for end, rapid in stops:
        if math.dist(end, at) > 1e-4:
            kept.append((end, rapid))
            at = end
    return kept


def covers(start: tuple[float, ...], way: list, ends: list) -> bool:
    """Whether each end lies on the way, one after the other."""
    part, least = 0, 0.0
    for end, rapid in ends:
        for k in range(part, len(way)):
            begin = way[k - 1][0] if k else start
            along = [b - a for a, b in zip(begin, way[k][0])]
            share = sum(c * (e - b) for c, e, b in zip(along, end, begin)) / max(sum(c * c for c in along), 1e-18)
            share = min(max(share, 0.0), 1.0)
            near = math.dist(end, [b + share * c for b, c in zip(begin, along)]) < TOLERANCE
            if near and way[k][1] == rapid and (k > part or share > least - 0.05):
                part, least = k, share
                break
        else:
            return False
    return True


def is_same(ours: list, theirs: list) -> bool:
    """Whether two ways are the same, drive by drive."""
    if not ours or not theirs:
        return not ours and not theirs
    start = ours[0][0]
    if math.dist(start, theirs[0][0]) > TOLERANCE:
        return False
    ours, theirs = moves(ours[1:], start), moves(theirs[1:], start)
    lengths = [sum(math.dist(a, b) for a, b in zip([start, *(p for p, _ in way)], (p for p, _ in way))) for way in (ours, theirs)]
    return covers(start, ours, theirs) and covers(start, theirs, ours) and abs(lengths[0] - lengths[1]) < 0.05 + 2e-3 * lengths[1]


def stops(table) -> list:
    """The points of a table of read_path: in mm, and whether the way there is rapid."""
    places = zip(table["x_mm"], table["y_mm"], table["z_mm"])
    rapid = table["fx_n"] == 0 if "fx_n" in table else [False] * table.row_count
    return [(tuple(map(float, place)), bool(fast)) for place, fast in zip(places, rapid)]


def compared(count: int, seed: int, show: bool) -> int:
    """Random programs, read and driven."""
    import numpy as np
    import stiffarm

    version = interpreter()
    warnings.simplefilter("ignore", stiffarm.StiffarmWarning)
    counts = {"same": 0, "refused": 0, "said": 0, "different": 0, "written": 0, "written otherwise": 0}
    refusals: dict[str, int] = {}
    drawn = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "cell.toml").write_text(CELL)
        cell = stiffarm.Cell(folder / "cell.toml")
        while sum(list(counts.values())[:4]) < count:
            drawn += 1
            text = Program(random.Random(f"{seed} {drawn}")).text()
            theirs, why = driven(text)
            if theirs is None:
                continue
            file = folder / "part.ngc"
            file.write_text(text)
            try:
                table = stiffarm.read_path(cell, file)
            except stiffarm.StiffarmError as error:
                counts["refused"] += 1
                refusals[str(error).split("\n")[0]] = refusals.get(str(error).split("\n")[0], 0) + 1
                continue
            if not is_same(stops(table), theirs):
                loud = [finding.code for finding in table.findings if finding.severity != "note" or finding.code == "machine-place"]
                counts["said" if loud else "different"] += 1
                if not loud or show:
                    print(f"--- {'said ' + str(loud) if loud else 'DIFFERENT'} (program {drawn})\n{text}")
                continue
            counts["same"] += 1
            # Moves at feed go 0.3 mm up and sway a little, as a correction would.
            rapid = np.array([fast for _, fast in stops(table)])
            moved = dict(table)
            moved["z_mm"] = table["z_mm"] + np.where(rapid, 0.0, 0.3)
            moved["x_mm"] = table["x_mm"] + np.where(rapid, 0.0, 0.1 * np.sin(table["y_mm"] / 40))
            out = folder / "moved.ngc"
            try:
                stiffarm.write_path(cell, file, moved, out, overwrite=True)
            except stiffarm.StiffarmError:
                continue
            theirs, why = driven(out.read_text())
            asked = [(tuple(map(float, place)), fast) for place, fast in zip(zip(moved["x_mm"], moved["y_mm"], moved["z_mm"]), rapid)]
            at_feed = [end for end, fast in asked if not fast]
            reached = theirs is not None and all(near(end, theirs) for end in at_feed)
            counts["written" if reached else "written otherwise"] += 1
            if not reached:
                print(f"--- WRITTEN OTHERWISE (program {drawn}): {why}\n{text}\n--- as\n{out.read_text()}")
    print(f"rs274 {version}, {count} valid programs of {drawn} drawn (seed {seed})")
    print(", ".join(f"{number} {name}" for name, number in counts.items()))
    for why, number in sorted(refusals.items(), key=lambda pair: -pair[1]):
        print(f"  {number:4} {why}")
    return 1 if counts["different"] or counts["written otherwise"] else 0


def near(end: tuple[float, ...], way: list) -> bool:
    """Whether the way passes a point at feed; between stated points a correction is kept to 0.01 mm."""
    for k in range(1, len(way)):
        begin, (stop, rapid) = way[k - 1][0], way[k]
        along = [b - a for a, b in zip(begin, stop)]
        share = sum(c * (e - b) for c, e, b in zip(along, end, begin)) / max(sum(c * c for c in along), 1e-18)
        share = min(max(share, 0.0), 1.0)
        if not rapid and math.dist(end, [b + share * c for b, c in zip(begin, along)]) < 2 * TOLERANCE:
            return True
    return False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=int, default=300, help="how many valid ones")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true", help="also those of which a finding says so")
    parser.add_argument("--words", metavar="FILE", help="write what rs274 does at each word")
    asked = parser.parse_args()
    return words(asked.words) if asked.words else compared(asked.programs, asked.seed, asked.show)


if __name__ == "__main__":
    sys.exit(main())
