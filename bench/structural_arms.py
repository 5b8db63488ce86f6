#!/usr/bin/env python3
"""How well does `stiffarm identify` know an arm from a structural code, and how far does it see beyond the load it was measured under?

Arms with elastic links, bearings and base come as seven 6 x 6 compliances each, which hold a finite-element model
exactly (`--arms FILE`, see below). Each is measured here, by NumPy and nothing of stiffarm's, under the rope of the default cell at
random postures (or those of a plan), and predicted at 200 others:

- same: RMS vector error of the measuring points under the same rope;
- other: the same of the first point under forces of 200 to 1000 N on it in all directions;
- bands: share of the components of `other` inside their 95 % bands, and the mean half width;
- k: share of the joints whose interval holds the stiffness with which joint axes alone best reproduce the arm over
  20,000 random postures of the cell under its rope (docs/identifying.md); worst joint behind it;
- factor: true factor of compensation at new postures under the same load, and what `validate --folds all` promises over it
  (with --validate);
- outlying: share of the experiments in which a sound posture is called outlying.

    python3 bench/structural_arms.py --arms arms.json --stiffarm target/release/stiffarm

By default the cell assumes 1 % of force and 0.1 minutes of lost motion to be unknown, and the arms have neither. `--errors none`
states that there is none, `--errors force` draws the 1 % of force in each experiment and states it, and no other.

FILE holds {"arms": {name: {"springs_beyond_axes": 7 symmetric 6 x 6 at the base and the frames of the six modified
Denavit-Hartenberg rows, shift [m] and turn [rad] per force [N] and moment [N m]; "joint_stiffness_nm_per_rad": 6}}}.
"""

import argparse
import concurrent.futures
import functools
import json
import math
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

import elastic_truths as truths
from elastic_truths import CELL, FORCE, cell_of, JOINTS, NOISE, POINTS, ask, bent, frames, linear, postures, reproduced, unloaded

AT_ORIGINS = np.ones(JOINTS)
WORK = 200


def springs_of(arm):
    springs = np.array(arm["springs_beyond_axes"], dtype=float)
    for j, k in enumerate(arm["joint_stiffness_nm_per_rad"]):
        springs[j + 1, 5, 5] += 1 / k
    return springs


@functools.cache
def compliance_of(springs):
    """That of joint axes which alone best reproduce the arm with these springs (bytes)."""
    return reproduced(np.frombuffer(springs).reshape(JOINTS + 1, 6, 6), AT_ORIGINS)


def table(path, heads, rows):
    path.write_text("\n".join([",".join(heads), *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def experiment(folder, args, springs, count, seed):
    rng = np.random.default_rng([seed, count])
    q, work = postures(rng, count), postures(rng, WORK)
    errors = {"force": 0.01} if args.errors == "force" else {}
    cell = CELL if args.errors is None else cell_of(folder, errors, True)
    pull = FORCE * (1 + errors.get("force", 0.0) * np.random.default_rng([seed, count, 1]).standard_normal())
    measured = bent(q, (springs, np.zeros(JOINTS), AT_ORIGINS), pull) - unloaded(q, POINTS)
    measured = (measured + NOISE * rng.standard_normal(measured.shape)) * 1e3
    direction = rng.standard_normal((WORK, 3))
    force = direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(200, 1000, (WORK, 1))
    angles = [f"q{j + 1}_deg" for j in range(JOINTS)]
    rows = ((p + 1, point + 1, *(f"{v:.12f}" for v in measured[p, point]), *q[p]) for p in range(count) for point in range(4))
    readings = table(Path(folder, "readings.csv"), ["posture", "point", "dx_mm", "dy_mm", "dz_mm", *angles], rows)
    stiffness = Path(folder, "stiffness.json")

    run = functools.partial(ask, args.stiffarm)
    found = run("identify", cell, readings, *args.options.split(), "--output", stiffness, "--force")

    # Each posture with its own force on the first point, in base axes.
    heads = [*angles, "fx_n", "fy_n", "fz_n", "posture"]
    at_work = table(Path(folder, "work.csv"), heads, ((*q, *f, f"w{p}") for p, (q, f) in enumerate(zip(work, force))))
    other = run("predict", cell, stiffness, at_work, "--axes", "base")
    tip = truths.at(frames(work, np.zeros((WORK, JOINTS + 1, 6)), AT_ORIGINS)[1], POINTS[:1])[:, 0]
    true = linear(work, (springs, AT_ORIGINS), force, tip, POINTS[:1])[0][:, 0]
    points = other["points"]
    off = np.array([p["shift_m"] for p in points]) - true
    bands = np.array([p["band"]["total_m"] for p in points])

    truth = bent(work, (springs, np.zeros(JOINTS), AT_ORIGINS), FORCE) - unloaded(work, POINTS)
    rows = ((p + 1, point + 1, *(f"{v:.12f}" for v in 1e3 * truth[p, point]), *work[p]) for p in range(WORK) for point in range(4))
    held = table(Path(folder, "held.csv"), ["posture", "point", "dx_mm", "dy_mm", "dz_mm", *angles], rows)
    same = run("validate", cell, stiffness, held)
    promised = run("validate", cell, readings, "--folds", "all") if args.validate else {}
    # These displacements are without noise.
    factor = same["displacement_rms_m"] / same["deviation_rms_m"]
    k = 1 / compliance_of(springs.tobytes())
    holds = []
    for value, joint in zip(k, found["joints"]):
        low, high = joint["interval"] or (None, None)
        holds.append(low is not None and low <= value and (high is None or value <= high))
    findings = (found.get("diagnosis") or {}).get("findings", [])
    return {
        "same": 3 * same["component_rms_m"] ** 2,
        "other": float(np.mean(np.sum(off**2, axis=1))),
        "bands": float(np.mean(np.abs(off) <= bands)),
        "band": float(np.mean(bands)),
        "k": holds,
        "off": [j["stiffness"] / value - 1 if j["stiffness"] else math.nan for j, value in zip(found["joints"], k)],
        "width": [math.nan if j["half_width"] is None else j["half_width"] for j in found["joints"]],
        "promise": (promised.get("compensation_factor") or math.nan) / factor,
        "factor": factor,
        "outlying": any(f["code"] == "outlying-posture" for f in findings),
    }


def one(args, arm, count, seed):
    with tempfile.TemporaryDirectory() as folder:
        return experiment(folder, args, springs_of(arm), count, seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stiffarm", default="stiffarm", help="the command")
    parser.add_argument("--arms", type=Path, required=True, metavar="FILE")
    parser.add_argument("--postures", type=int, nargs="+", default=[6, 12, 30])
    parser.add_argument("--experiments", type=int, default=300, help="in each row, spread over the arms")
    parser.add_argument("--options", default="", help="further options of `identify`, in one word")
    parser.add_argument("--errors", choices=["none", "force"], help="what the experiments have and the cell states (see above)")
    parser.add_argument("--validate", action="store_true", help="also what `validate --folds all` promises")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    args = parser.parse_args()
    arms = json.loads(args.arms.read_text())["arms"]
    heads = ["postures", "same [mm]", "other [mm]", "worst arm [mm]", "bands hold [%]", "band [mm]", "k holds [%]", "each", "k off [%]"]
    heads += ["± k, median [%]", "factor", "promised / true", "outlying [%]"]
    print("| " + " | ".join(heads) + " |\n|" + "--|" * len(heads), flush=True)
    with concurrent.futures.ProcessPoolExecutor(args.processes) as pool:
        for count in args.postures:
            jobs = []
            for i in range(args.experiments):
                name = list(arms)[i % len(arms)]
                jobs.append((name, pool.submit(one, args, arms[name], count, 1000 * args.seed + i)))
            found = [(name, job.result()) for name, job in jobs]
            print("| " + " | ".join([str(count), *row(found)]) + " |", flush=True)
    return 0


def row(found):
    rows = [f for _, f in found]
    n = math.sqrt(len(rows))
    mean = lambda key: np.mean([f[key] for f in rows])
    rms = lambda key, of=rows: 1e3 * math.sqrt(np.mean([f[key] for f in of]))
    by_arm = {name: rms("other", [f for own, f in found if own == name]) for name, _ in found}
    worst = max(by_arm, key=by_arm.get)
    k = np.array([f["k"] for f in rows])
    share = lambda values: f"{100 * np.mean(values):.1f} ± {100 * np.std(values) / n:.1f}"
    return [
        f"{rms('same'):.4f}",
        f"{rms('other'):.4f}",
        f"{by_arm[worst]:.4f} ({worst})",
        share([f["bands"] for f in rows]),
        f"{1e3 * mean('band'):.4f}",
        share(k.mean(axis=1)),
        " ".join(f"{100 * v:.0f}" for v in k.mean(axis=0)),
        f"{100 * math.sqrt(np.nanmean(np.square([f['off'] for f in rows]))):.1f}",
        f"{100 * np.nanmedian([f['width'] for f in rows]):.1f}",
        f"{np.median([f['factor'] for f in rows]):.0f}",
        f"{np.nanmedian([f['promise'] for f in rows]):.2f}",
        share([f["outlying"] for f in rows]),
    ]


if __name__ == "__main__":
    sys.exit(main())
