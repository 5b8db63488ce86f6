#!/usr/bin/env python3
"""Processor time, time and memory of whole commands: of one binary, or of two in turn.

    python3 bench/commands.py --binary NEW [--before OLD]      # some ten minutes
    python3 bench/commands.py --binary NEW --rows predict-100k stop
    python3 bench/commands.py --list

Each pair of runs writes its results first, and they are compared: "same" is the same bytes but for what a
result says of the program that made it, else the largest relative difference of a number, or where a text differs.
Times are medians of pairs. Needs Linux (peak memory from wait4) and Python 3.10 or later, nothing else.
"""

import argparse
import datetime
import json
import os
import platform
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import growth

# What a file says of the program that wrote it, not of the arm.
ABOUT = {"seal", "seconds", "stiffarm", "arguments", "version"}
FORCE = ["--force-n", "0,0,-300", "--axes", "tool"]


def select(*words, cell="builtin:comau"):
    return ["select", cell, *words, "--json"]


def follow(command, points):
    return [command, "builtin:comau", "prior", f"path{points}.csv", *FORCE, "--force", "--output", "OUT"]


IDENTIFY = ["identify", "builtin:comau", "m2000.csv", "--elastic", "mixed", "--json"]
ROWS = {
    "select-prediction": select("--index", "prediction"),
    "select-expected-error": select("--index", "expected-error"),
    "select-drop-one": select("--index", "drop-one"),
    "select-novel": select("--index", "novel"),
    "select-50": select("--index", "expected-error", "-n", "50", "--rounds", "1"),
    "select-100": select("--index", "expected-error", "-n", "100", "--rounds", "1"),
    "select-shapes": select("--index", "expected-error", cell="builtin:comau-shapes"),
    "predict-100k": follow("predict", 100_000),
    "compensate-100k": follow("compensate", 100_000),
    "predict-1M": follow("predict", 1_000_000),
    "compensate-1M": follow("compensate", 1_000_000),
    "identify-mixed-2000": IDENTIFY,
}
# Rows that are run once: they take long, and their size says enough.
ONCE = {"predict-1M", "compensate-1M", "identify-mixed-2000"}
# Rows with a time on one core beside that on all.
ON_ONE = {"predict-100k", "predict-1M"}
STOPPED = ["select-expected-error", "select-100", "select-shapes", "predict-1M", "compensate-1M", "identify-mixed-2000"]


def inputs(binary, rows):
    """The files that the rows read, into the folder at hand."""
    for points in (100_000, 1_000_000):
        if any(f"path{points}.csv" in ROWS[row] for row in rows):
            growth.path_of(f"path{points}.csv", points)
    if "identify-mixed-2000" in rows:
        growth.postures("p2000.csv", 2000)
        words = ["--runs", "2", "--levels", "1", "--measurements", "m2000.csv", "--force", "-q"]
        growth.run(binary, "simulate", "builtin:comau", "p2000.csv", *words)


def measured(binary, row, out, threads=None):
    """Time, processor time [s] and peak memory [MB]; what it writes goes to `out`."""
    words = [out if word == "OUT" else word for word in ROWS[row]]
    environment = dict(os.environ, **({"RAYON_NUM_THREADS": str(threads)} if threads else {}))
    with open(os.devnull if "OUT" in ROWS[row] else out, "w") as screen:
        *used, code = growth.measured([binary, *words, "-q"], screen, environment)
    if code not in (0, 1):
        sys.exit(f"exit code {code}: {binary} {' '.join(words)}")
    return used


def difference(one, other, path=""):
    """The largest relative difference of two JSON values, or the place where their kinds or texts differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        keys = (one.keys() | other.keys()) - ABOUT
        pairs = [(one.get(key), other.get(key), f"{path}.{key}") for key in sorted(keys)]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = [(a, b, f"{path}[{i}]") for i, (a, b) in enumerate(zip(one, other, strict=True))]
    elif isinstance(one, float | int) and isinstance(other, float | int):
        size = max(abs(one), abs(other))
        return abs(one - other) / size if one != other else 0.0
    else:
        return 0.0 if one == other else path
    worst = 0.0
    for pair in pairs:
        gap = difference(*pair)
        if isinstance(gap, str):
            return gap
        worst = max(worst, gap)
    return worst


def agreement(one, other):
    """How two files agree, in words."""
    if Path(one).read_bytes() == Path(other).read_bytes():
        return "same"
    try:
        gap = difference(*(json.loads(Path(name).read_text()) for name in (one, other)))
    except json.JSONDecodeError:
        return "**differ**"
    if isinstance(gap, str):
        return f"**{gap.lstrip('.')} differs**"
    return "same" if gap == 0.0 else f"to {gap:.0e}"


def stopped(binary, row, whole):
    """Seconds from Ctrl-C to the end, at tenths of the time that the whole takes; the largest."""
    waits = []
    for tenth in range(1, 10):
        words = ["/dev/null" if word == "OUT" else word for word in ROWS[row]]
        child = subprocess.Popen([binary, *words, "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(whole * tenth / 10)
        if child.poll() is not None:
            continue
        begin = time.monotonic()
        child.send_signal(signal.SIGINT)
        code = child.wait()
        waits.append(time.monotonic() - begin)
        if code not in (0, 1, 130):
            sys.exit(f"exit code {code} after Ctrl-C: {row}")
    return max(waits, default=0.0)


def cells(times):
    wall, cpu, peak = (statistics.median(column) for column in zip(*times, strict=True))
    return [f"{wall:.2f}", f"{cpu:.2f}", f"{peak:.0f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", help="the program")
    parser.add_argument("--before", help="another state of it, run in turn")
    parser.add_argument("--pairs", type=int, default=3, help="runs of each row (3); long ones once")
    parser.add_argument("--rows", nargs="+", metavar="ROW", help="these alone; `stop` times Ctrl-C")
    parser.add_argument("--list", action="store_true", help="names of the rows")
    parser.add_argument("--out", type=Path, help="file of the page")
    args = parser.parse_args()
    if args.list:
        print("\n".join([*ROWS, "stop"]))
        return
    if not args.binary:
        parser.error("--binary is missing")
    wanted = args.rows or [*ROWS, "stop"]
    if unknown := [row for row in wanted if row not in ROWS and row != "stop"]:
        parser.error(f"there is no row {unknown[0]}; --list names them")
    binary = str(Path(args.binary).resolve())
    before = str(Path(args.before).resolve()) if args.before else None
    out = args.out.resolve() if args.out else None
    cpu = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    page = [
        f"# Whole commands, {datetime.date.today()}\n",
        f"`python3 bench/commands.py`, {os.cpu_count()} × {cpu.group(1) if cpu else platform.machine()}, load at the start "
        f"{os.getloadavg()[0]:.1f}. Medians of {args.pairs} runs in turn, of the long ones one.\n",
        "| row | time [s] | processor time [s] | peak memory [MB] | on one core [s] |"
        + (" before: time | processor time | peak memory | times less | results |" if before else ""),
        "|:--|--:|--:|--:|--:|" + ("--:|--:|--:|--:|:--|" if before else ""),
    ]
    rows, walls = [row for row in wanted if row in ROWS], {}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        inputs(binary, rows + (STOPPED if "stop" in wanted else []))
        for row in rows:
            new, old = [], []
            for _ in range(1 if row in ONCE else args.pairs):
                if before:
                    old.append(measured(before, row, "before.out"))
                new.append(measured(binary, row, "after.out"))
            walls[row] = min(wall for wall, _, _ in new)
            one = [f"{measured(binary, row, 'one.out', threads=1)[0]:.2f}"] if row in ON_ONE else ["–"]
            if row in ON_ONE and agreement("one.out", "after.out") != "same":
                sys.exit(f"{row}: one thread gives other results than all")
            line = [f"`{row}`", *cells(new), *one]
            if before:
                ratio = statistics.median(a[1] / b[1] for a, b in zip(old, new, strict=True))
                line += [*cells(old), f"{ratio:.1f}", agreement("before.out", "after.out")]
            page.append(f"| {' | '.join(line)} |")
            print(page[-1], file=sys.stderr)
        if "stop" in wanted:
            page += ["\n## Ctrl-C\n", "Longest wait of nine, at tenths of the time that the whole takes.\n"]
            page += ["| row | to the end [s] |", "|:--|--:|"]
            for row in STOPPED:
                whole = walls.get(row) or measured(binary, row, "after.out")[0]
                page.append(f"| `{row}` | {stopped(binary, row, whole):.2f} |")
                print(page[-1], file=sys.stderr)
        os.chdir("/")
    text = "\n".join(page) + "\n"
    print(text)
    if out:
        out.write_text(text)


if __name__ == "__main__":
    main()
