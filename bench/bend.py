#!/usr/bin/env python3
"""How long the deflections and commands of a long path take: stiffarm, and Pinocchio with NumPy.

    python3 bench/bend.py            # 100,000 points, a few minutes
    python3 bench/bend.py --quick    # 2,000 points, nothing kept

Both compute the exact equilibrium of the loaded arm at each point, the command that makes up for
it, and the equilibrium from that command as a check. Pinocchio gives poses and Jacobians, NumPy the
rest, one process per core. The numbers of both must agree before a time counts.
"""

import argparse
import datetime
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import peers

BENCH = Path(__file__).resolve().parent
ROOT = BENCH.parent
# The stiffness of cells/comau.toml (Table 2 of the paper) and its TCP.
CELL_FILE = ROOT / "cells/comau.toml"
# Largest difference of a shift [m] or an angle [rad] between the two programs.
SAME = 1e-11


def setup():
    """The arm of the default cell as a Pinocchio model with one frame at the TCP."""
    import tomllib

    import numpy as np
    from peer.cell import reference_cell
    from peer.index_pinocchio import build_model

    cell = reference_cell()
    text = tomllib.loads(CELL_FILE.read_text(encoding="utf-8"))
    stiffness = np.array(text["stiffness"]["prior_nm_per_rad"], dtype=float)
    model, frames = build_model(cell)
    return cell, model, frames[1], stiffness


def bend(rows):
    """Shift, turn and command of each row of angles, force and moment; and the seconds it took."""
    import numpy as np
    import pinocchio as pin

    cell, model, tip, stiffness = setup()
    data = model.createData()
    offset = cell.rows[:, 3]
    inverse_coupling = np.linalg.inv(cell.coupling)
    aligned = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED

    def torque(theta, wrench):
        jacobian = pin.computeFrameJacobian(model, data, theta, tip, aligned)
        return jacobian.T @ wrench

    def equilibrium(start, wrench):
        deflection = np.zeros(len(start))
        for _ in range(200):
            after = torque(start + deflection, wrench) / stiffness
            change = np.abs(after - deflection).max()
            deflection = after
            if change < 1e-15 + 4 * np.finfo(float).eps * np.abs(deflection).max():
                break
        pin.framesForwardKinematics(model, data, start + deflection)
        return data.oMf[tip].copy()

    def motion(before, after):
        turn = pin.log3(after.rotation @ before.rotation.T)
        return np.concatenate([after.translation - before.translation, turn])

    out = np.empty((len(rows), 12))
    begin = time.perf_counter()
    split = [0.0, 0.0]
    for task in (0, 1):
        begin = time.perf_counter()
        for i, row in enumerate(rows):
            theta, wrench = offset + cell.coupling @ row[:6], row[6:12]
            pin.framesForwardKinematics(model, data, theta)
            nominal = data.oMf[tip].copy()
            loaded = equilibrium(theta, wrench)
            if task == 0:
                out[i, :6] = motion(nominal, loaded)
                continue
            command = theta - torque(theta, wrench) / stiffness
            out[i, 6:] = inverse_coupling @ (command - offset)
            left = motion(nominal, equilibrium(command, wrench))
            if np.abs(left).max() > 1e-12:
                raise ValueError(f"the command of row {i} leaves {left}")
        split[task] = time.perf_counter() - begin
    return out, split


def main():
    """Runs both and writes the record."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--points", type=int, default=100_000, help="points of the path (100000)")
    parser.add_argument("--quick", action="store_true", help="2,000 points, and no record")
    parser.add_argument("--out", type=Path, default=BENCH / "runs", help="folder of the record")
    options = parser.parse_args()
    if options.quick:
        options.points = 2000
    if options.points < 10:
        parser.error("--points must be at least 10")
    peers.inside_environment(__file__)
    import numpy as np
    from peer.machine import describe

    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
    machine = describe(cores)
    command = ["cargo", "run", "--release", "--quiet", "-p", "stiffarm", "--example", "bend", "--"]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bend.bin"
        words = ["--points", str(options.points), "--threads", str(len(cores))]
        run = subprocess.run(
            [*command, *words, "--numbers", str(file)],
            cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True,
        )
        rows = np.fromfile(file, dtype="<f8").reshape(-1, 24)
    ours = json.loads(run.stdout)
    parts = np.array_split(rows[:, :12], len(cores))
    with multiprocessing.get_context("spawn").Pool(len(cores)) as pool:
        done = pool.map(bend, parts)
    theirs = np.vstack([out for out, _ in done])
    times = [max(split[task] for _, split in done) for task in (0, 1)]
    gap = np.abs(theirs - rows[:, 12:]).max()
    if gap > SAME:
        peers.fail(f"the two programs differ by {gap:.1e}; no times are given.")
    page = record(machine, ours, times, gap)
    print(page)
    if not options.quick:
        name = f"{datetime.date.today()}-{machine['kind']}-bend.md"
        (options.out / name).write_text(page, encoding="utf-8")
        print(f"wrote {options.out / name}", file=sys.stderr)


def record(machine, ours, times, gap):
    """The page of the record."""
    import importlib.metadata

    def row(what, mine, other):
        per = 1e6 * mine / ours["points"]
        return f"| {what} | {mine:.3f} | {per:.2f} | {other:.1f} | {other / mine:.0f} |"

    versions = ", ".join(f"{p} {importlib.metadata.version(p)}" for p in ("pin", "numpy"))
    lines = [
        f"# Deflections and commands of {ours['points']:,} path points",
        "",
        f"`python3 bench/bend.py` on {datetime.date.today()}: {machine['processor']}, "
        f"{machine['cores_used']} cores, {machine['system']}; load at the start "
        f"{machine['load_at_start']:.1f}. Python {sys.version.split()[0]}, {versions}.",
        "",
        "Exact equilibrium of the default cell's arm at each point under a force of 450 N and a moment that "
        "change from point to point; the command that makes up for it, checked by the equilibrium from it. "
        "stiffarm: median of five; Pinocchio and NumPy: one process per core, the slower one, without start-up.",
        "",
        "| | stiffarm [s] | per point [µs] | Pinocchio + NumPy [s] | ratio |",
        "|:--|--:|--:|--:|--:|",
        row("predict", ours["predict_s"], times[0]),
        row("compensate", ours["compensate_s"], times[1]),
        "",
        f"Largest difference of a shift [m], turn or angle [rad] between the two: {gap:.1e}. Largest distance of "
        f"the loaded tip from its nominal place with the command: {ours['residual_max_m']:.1e} m.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
