#!/usr/bin/env python3
"""Time and memory of whole commands against the size of their input.

    python3 bench/growth.py --binary target/release/stiffarm           # some minutes
    python3 bench/growth.py --binary target/release/stiffarm --quick   # small sizes only

Needs Linux (peak memory from wait4) and Python 3.10 or later, nothing else. Prints a page in
Markdown; `--out FILE` keeps it.
"""

import argparse
import datetime
import math
import os
import platform
import random
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CELL = (ROOT / "cells/comau.toml").read_text()
LIMITS = [(-170, 170), (-45, 35), (-150, -20), (-180, 180), (-120, 120), (-180, 180)]


def postures(path, count, limits=LIMITS):
    dice = random.Random(count)
    with open(path, "w") as out:
        out.write("posture," + ",".join(f"q{j + 1}_deg" for j in range(len(limits))) + "\n")
        for i in range(count):
            out.write(f"{i + 1}," + ",".join(f"{dice.uniform(*l):.3f}" for l in limits) + "\n")


def cell_of_points(path, count):
    """The default cell with `count` measuring points."""
    dice = random.Random(count)
    spread = lambda: f"[{dice.uniform(-200, 200):.1f}, {dice.uniform(-200, 200):.1f}, {dice.uniform(100, 300):.1f}]"
    points = "".join(
        f'[[tool.measuring_point]]\nname = "P{i}"\nposition_mm = {spread()}\n\n' for i in range(count)
    )
    start, end = CELL.index("[[tool.measuring_point]]"), CELL.index("[load]")
    path.write_text(CELL[:start] + points + CELL[end:])


def cell_of_joints(path, count):
    """An arm of `count` joints, links of 0.4 m, axes in turn along and across."""
    rows = ",\n".join(
        f"    [{[0, 90, -90][j % 3]}, {0 if j == 0 else 200}, {300 if j % 2 == 0 else 0}, 0]" for j in range(count)
    )
    limits = ",\n".join("    [-150, 150]" for _ in range(count))
    prior = ", ".join(f"{2e6 / (1 + j):.4g}" for j in range(count))
    path.write_text(
        f"""format = 1
name = "arm of {count} joints"

[robot]
dh_modified = [
{rows}
]
limits_deg = [
{limits}
]

[bounds]
q_deg = [
{limits}
]

[tool]
loading_point_mm = [50, 20, 200]

[[tool.measuring_point]]
name = "1"
position_mm = [150, 0, 200]

[[tool.measuring_point]]
name = "2"
position_mm = [0, 150, 200]

[[tool.measuring_point]]
name = "3"
position_mm = [-150, 0, 250]

[load]
kind = "rope"
magnitude_n = 300
anchor_mm = [4000, 1500, -500]

[noise]
variance_mm2 = 9.23e-5

[stiffness]
prior_nm_per_rad = [{prior}]
"""
    )


def path_of(path, count):
    """A spiral of `count` points in the workpiece frame of the default cell."""
    turns = max(1, count // 1000)
    with open(path, "w") as out:
        out.write("point,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n")
        for i in range(count):
            turn = 2 * math.pi * i / count * turns
            radius = 100 + 50 * i / count
            x, y = 200 + radius * math.cos(turn), 120 + radius * math.sin(turn)
            out.write(f"{i + 1},{x:.4f},{y:.4f},{-10 * i / count:.5f},180,0,0\n")


def clsf_of(path, count):
    """A freeform surface of `count` points, the tool axis across it, as CLSF."""
    width = 500
    with open(path, "w") as out:
        out.write("UNITS/MM\nTOOL PATH/FREEFORM,TOOL,BALL\nFEDRAT/MMPM,1200\n")
        for i in range(count):
            row, column = divmod(i, width)
            column = width - 1 - column if row % 2 else column
            x, y = 200 * column / (width - 1) - 100, 200 * row * width / count - 100
            z = 5 * math.cos(x / 40) * math.cos(y / 50)
            axis = [0.1 * math.sin(x / 40), 0.1 * math.sin(y / 50), 1]
            length = math.hypot(*axis)
            words = [f"{value:.4f}" for value in (x, y, z)] + [f"{value / length:.7f}" for value in axis]
            out.write(f"GOTO/{','.join(words)}\n")
        out.write("END-OF-PATH\n")


def run(*command):
    """A command that must end; a finding is an end."""
    code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
    if code not in (0, 1):
        sys.exit(f"exit code {code}: {' '.join(command)}")


# Where the FANUC of the catalogue works on it.
WORK = """
[work]
tip_mm = [0, 0, 300]
workpiece_mm = [1700, 0, 500]

[work.milling]
teeth = 2
diameter_mm = 16
axial_depth_mm = 3
radial_depth_mm = 8
spindle_rpm = 6000
direction = "down"
k_tc_n_per_mm2 = 800
k_rc_n_per_mm2 = 200
k_ac_n_per_mm2 = 100
k_te_n_per_mm = 20
k_re_n_per_mm = 20
k_ae_n_per_mm = 0
"""


def measured(command, screen=subprocess.DEVNULL, environment=None):
    """Wall and processor seconds, peak memory [MB] and exit code of a command whose standard output goes to `screen`."""
    begin = time.monotonic()
    child = subprocess.Popen(command, stdout=screen, stderr=subprocess.PIPE, env=environment)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.monotonic() - begin
    code = os.waitstatus_to_exitcode(status)
    if code not in (0, 1):
        print(child.stderr.read().decode(), file=sys.stderr)
    child.stderr.close()
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, code


def table(title, what, rows):
    out = [f"## {title}\n", f"| {what} | time [s] | processor time [s] | peak memory [MB] |", "|:--|--:|--:|--:|"]
    for name, (wall, cpu, peak, code) in rows:
        note = "" if code in (0, 1) else f" (exit code {code})"
        out.append(f"| {name}{note} | {wall:.2f} | {cpu:.2f} | {peak:.0f} |")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out")
    args = parser.parse_args()
    binary = str(Path(args.binary).resolve())
    out = Path(args.out).resolve() if args.out else None
    version = subprocess.run([binary, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    cpu = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    parts = [
        f"# Time and memory against size, {datetime.date.today()}\n",
        f"`python3 bench/growth.py`, {version}, {os.cpu_count()} × {cpu.group(1) if cpu else platform.machine()}, "
        f"{platform.system()}. One run each; data simulated, so their numbers mean nothing.\n",
    ]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        simulate = lambda cell, plan, what, out: run(
            binary, "simulate", cell, plan, "--runs", "2", "--levels", "1", what, out, "--force", "-q"
        )
        sizes = [10, 50, 500] + ([] if args.quick else [5000])
        rows, raw = [], []
        for n in sizes:
            postures(f"p{n}.csv", n)
            simulate("builtin:comau", f"p{n}.csv", "--measurements", "m.csv")
            rows.append((f"{n} postures", measured([binary, "identify", "builtin:comau", "m.csv", "-q"])))
            simulate("builtin:comau", f"p{n}.csv", "--readings", "r.csv")
            raw.append((f"{n} postures", measured([binary, "identify", "builtin:comau", "r.csv", "-q"])))
        parts.append(table("`identify`, four measuring points, displacements", "postures", rows))
        parts.append(table("`identify`, four measuring points, raw readings up and down the loads", "postures", raw))

        rows = []
        for points in [4, 20, 100]:
            cell = Path(f"points{points}.toml")
            cell_of_points(cell, points)
            simulate(str(cell), "p50.csv", "--measurements", "m.csv")
            rows.append((f"{points} points, displacements", measured([binary, "identify", str(cell), "m.csv", "-q"])))
            simulate(str(cell), "p50.csv", "--readings", "r.csv")
            rows.append((f"{points} points, raw readings", measured([binary, "identify", str(cell), "r.csv", "-q"])))
        parts.append(table("`identify`, 50 postures", "measuring points", rows))

        rows = []
        for joints in [1, 3, 6, 7, 9, 12]:
            cell = Path(f"joints{joints}.toml")
            cell_of_joints(cell, joints)
            postures("j.csv", 50, [(-140, 140)] * joints)
            simulate(str(cell), "j.csv", "--measurements", "m.csv")
            rows.append((f"{joints} joint{'s' if joints > 1 else ''}", measured([binary, "identify", str(cell), "m.csv", "-q"])))
        parts.append(table("`identify`, 50 postures, three points", "joints", rows))

        rows = []
        for n in sizes:
            postures(f"p{n}.csv", n)
            simulate("builtin:comau", f"p{n}.csv", "--measurements", "m.csv")
            command = [binary, "validate", "builtin:comau", "m.csv", "--folds", "all", "-q"]
            rows.append((f"{n} postures", measured(command)))
        parts.append(table("`validate --folds all`", "postures", rows))

        rows = []
        force = ["--force-n", "0,0,-300", "--axes", "tool", "-q", "--force"]
        for n in [1000, 10_000, 100_000] + ([] if args.quick else [1_000_000]):
            path_of("path.csv", n)
            for command in ("predict", "compensate"):
                line = [binary, command, "builtin:comau", "prior", "path.csv", *force, "--output", "out.csv"]
                rows.append((f"{n:,} points, `{command}`", measured(line)))
        parts.append(table("A path with its table written", "points", rows))

        rows = []
        lines = 20_000 if args.quick else 500_000
        run(binary, "init", "--robot", "fanuc-r2000ic165f", "--output-dir", ".", "--force")
        with open("cell.toml", "a") as cell:
            cell.write(WORK)
        clsf_of("path.cls", lines)
        for elastic in ("axes", "mixed"):
            readings = ["builtin:fanuc-r2000ic", "builtin:fanuc-r2000ic-readings"]
            run(binary, "identify", *readings, "--elastic", elastic, "--output", "k.json", "--force", "-q")
            for command, written in (("predict", "out.csv"), ("compensate", "out.cls")):
                line = [binary, command, "cell.toml", "k.json", "path.cls", "--output", written, "-q", "--force"]
                rows.append((f"{lines:,} lines, `{command}`, `--elastic {elastic}`", measured(line)))
        parts.append(table("A CLSF read, its free turn chosen, and table or CLSF written", "lines", rows))
        os.chdir("/")
    page = "\n".join(parts)
    print(page)
    if out:
        out.write_text(page)


if __name__ == "__main__":
    main()
