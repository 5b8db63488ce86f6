#!/usr/bin/env python3
"""Do the intervals of `stiffarm identify` hold on arms whose joints and base give way in all directions?

The arm is simulated here, by NumPy and nothing of stiffarm's: the default cell's robot from its Denavit-Hartenberg
rows, a 6 x 6 spring behind every joint and at the base, and the exact equilibrium under the rope. The command then
reads each experiment as a table of displacements, and what it says is held against what was put in:

- k: the total +- of each joint's stiffness against the one with which joint axes alone best reproduce the arm over 20,000
  postures of the cell (docs/identifying.md); `alone` against that of the axis by itself; `axes' model` for
  the intervals of a fit in which nothing but the axes gives way;
- bands: the 95 % bands of deflections at postures that took no part, against the exact ones;
- error: RMS of these predictions.

    python3 bench/elastic_truths.py --stiffarm target/release/stiffarm --experiments 1000
"""

import argparse
import concurrent.futures
import functools
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CELL = Path(__file__).parent.parent / "cells/comau.toml"

# The robot of cells/comau.toml: alpha [deg], a [mm], d [mm], offset [deg] of each joint, as its source prints them.
ROWS = np.array(
    [
        [0, 0, 830, 0],
        [-90, 400, 0, -90],
        [0, 1175, 0, -90],
        [-90, 250, 1444, 0],
        [90, 0, 0, 0],
        [-90, 0, 230, 180],
    ],
    dtype=float,
)
COUPLING = np.array(
    [
        [-1, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, -1, -1, 0, 0, 0],
        [0, 0, 0, -1, 0, 0],
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, -1],
    ],
    dtype=float,
)
BOUNDS = np.array([[-90, 90], [-60, 40], [-180, -40], [-180, 180], [-90, 90], [-180, 180]], dtype=float)
BOX = np.array([[0.9, -1.9, 0.3], [3.0, 1.9, 3.0]])
LOADING_POINT = np.array([0.2, 0, 0.25])
POINTS = np.array([[0.15, 0, 0.2], [0, 0.15, 0.2], [-0.15, 0, 0.2], [0, -0.15, 0.2]])
ANCHOR, FORCE = np.array([1.8, 0, 0]), 500.0
AT_WORK = np.array([250, 150, -400])
NOISE = math.sqrt(9.23e-5) * 1e-3
STIFFNESS = np.array([950e3, 3000e3, 900e3, 250e3, 200e3, 150e3])
JOINTS = len(STIFFNESS)
ARCMINUTE = math.radians(1 / 60)

# Springs beyond the axes as found on the 43 measured postures of a FANUC R-2000iC/165F, over what the joints'
# compliance c and the arm's length L make of their units: shifts c L^2, turns c, coupling c L.
FANUC = np.array([0.009, 0.10, 0.020])
LENGTH, MEAN_COMPLIANCE = 3.8, math.exp(-np.log(STIFFNESS).mean())
SIZES = FANUC * MEAN_COMPLIANCE * np.array([LENGTH**2, 1, LENGTH])


def turns(vectors):
    """Rotation matrices of rotation vectors, (..., 3) to (..., 3, 3)."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
    return np.eye(3) + first * skew + second * (skew @ skew)


def rigid(alpha, a, d, theta):
    """Modified Denavit-Hartenberg transform: rotations (n, 3, 3) and shifts (n, 3) for many `theta`."""
    ca, sa, ct, st = math.cos(alpha), math.sin(alpha), np.cos(theta), np.sin(theta)
    zero = np.zeros_like(theta)
    rotation = np.stack([ct, -st, zero, st * ca, ct * ca, zero - sa, st * sa, ct * sa, zero + ca], axis=-1)
    shift = np.broadcast_to([a, -sa * d, ca * d], (len(theta), 3))
    return rotation.reshape(-1, 3, 3), shift


def frames(q_deg, twists, bearings):
    """Frame of each spring, base first, and of the flange, for postures (n, 6) and twists (n, 7, 6). `bearings` (6,)
    say where along its axis each joint's spring is: 0 near the joint before, 1 near the joint behind."""
    theta = np.radians(q_deg) @ COUPLING.T + np.radians(ROWS[:, 3])
    rotation = np.broadcast_to(np.eye(3), (len(q_deg), 3, 3))
    origin = np.zeros((len(q_deg), 3))
    of_springs = []
    for place in range(JOINTS + 1):
        if place > 0:
            alpha, a, d, _ = ROWS[place - 1] * [math.pi / 180, 1e-3, 1e-3, 1]
            bearing = bearings[place - 1]
            own, shift = rigid(alpha, a, d * bearing, theta[:, place - 1])
            origin = origin + np.einsum("nij,nj->ni", rotation, shift)
            rotation = rotation @ own
        of_springs.append((rotation, origin))
        origin = origin + np.einsum("nij,nj->ni", rotation, twists[:, place, :3])
        rotation = rotation @ turns(twists[:, place, 3:])
        if place > 0:
            origin = origin + rotation[:, :, 2] * (d * (1 - bearing))
    return of_springs, (rotation, origin)


def at(flange, points):
    """Points of the flange frame (k, 3) in base axes (n, k, 3)."""
    rotation, origin = flange
    return origin[:, None] + np.einsum("nij,kj->nki", rotation, points)


def unloaded(q_deg, points):
    """Points of the flange frame (k, 3) in base axes (n, k, 3), nothing giving way."""
    return at(frames(q_deg, np.zeros((len(q_deg), JOINTS + 1, 6)), np.ones(JOINTS))[1], points)


def bent(q_deg, arm, force, side=None):
    """Positions (n, 4, 3) of the measuring points in equilibrium of an arm: springs (7, 6, 6) in
    each joint's axes, gaps (6,) by which a joint gives way towards its torque [rad], bearings (6,). `force` is that
    of the rope, or acts on the first point along the base axes [N]. With `side` (n, 6) the joints stand on these sides
    of their gaps, 1 or -1, and the torque takes each from there to its own."""
    springs, gaps, bearings = arm
    side = np.zeros((len(q_deg), JOINTS)) if side is None else side
    twists = np.zeros((len(q_deg), JOINTS + 1, 6))
    for _ in range(50):
        of_springs, flange = frames(q_deg, twists, bearings)
        is_rope = np.ndim(force) == 0
        loaded = at(flange, LOADING_POINT[None] if is_rope else POINTS[:1])[:, 0]
        rope = ANCHOR - loaded
        pull = force * rope / np.linalg.norm(rope, axis=1)[:, None] if is_rope else np.tile(force, (len(q_deg), 1))
        found = np.empty_like(twists)
        for place, (rotation, origin) in enumerate(of_springs):
            moment = np.cross(loaded - origin, pull)
            wrench = np.concatenate([np.einsum("nji,nj->ni", rotation, v) for v in (pull, moment)], axis=1)
            found[:, place] = wrench @ springs[place].T
            if place > 0:
                found[:, place, 5] += gaps[place - 1] * (np.sign(wrench[:, 5]) - side[:, place - 1])
        moved = np.abs(found - twists).max()
        twists = found
        if moved < 1e-14:
            break
    return at(frames(q_deg, twists, bearings)[1], POINTS)


def rope(q, bearings):
    """Force of the rope at postures where nothing gives way (n, 3), and where it acts."""
    loaded = at(frames(q, np.zeros((len(q), JOINTS + 1, 6)), bearings)[1], LOADING_POINT[None])[:, 0]
    way = ANCHOR - loaded
    return FORCE * way / np.linalg.norm(way, axis=1)[:, None], loaded


def linear(q, arm, force, loaded, points):
    """Displacements (n, k, 3) of points of an arm, springs and bearings, to first order under forces at places (n, 3), and
    those by each joint's axis alone per unit of compliance (6, n, k, 3)."""
    springs, bearings = arm
    of_springs, flange = frames(q, np.zeros((len(q), JOINTS + 1, 6)), bearings)
    p = at(flange, points)
    total, by_axis = np.zeros_like(p), []
    for place, (rotation, origin) in enumerate(of_springs):
        moment = np.cross(loaded - origin, force)
        wrench = np.concatenate([np.einsum("nji,nj->ni", rotation, v) for v in (force, moment)], axis=1)
        twist = wrench @ springs[place].T
        shift, turn = (np.einsum("nij,nj->ni", rotation, v) for v in (twist[:, :3], twist[:, 3:]))
        total += shift[:, None] + np.cross(turn[:, None], p - origin[:, None])
        if place > 0:
            axis = rotation[:, :, 2] * wrench[:, 5:]
            by_axis.append(np.cross(axis[:, None], p - origin[:, None]))
    return total, np.array(by_axis)


def reproduced(springs, bearings):
    """Compliance of joint axes that alone best reproduce the arm over the cell under its rope. A thousand random postures
    give it to 1 % only, and the limits of the cell matter by as much."""
    q = of_cell(20_000)
    total, by_axis = linear(q, (springs, bearings), *rope(q, bearings), POINTS)
    return np.linalg.lstsq(by_axis.reshape(JOINTS, -1).T, total.reshape(-1), rcond=None)[0]


def zero_mean(rng, size):
    """Entries around zero, as the mixed model has them."""
    scale = np.empty((6, 6))
    scale[:3, :3], scale[3:, 3:] = SIZES[0], SIZES[1]
    scale[:3, 3:] = scale[3:, :3] = SIZES[2]
    drawn = rng.standard_normal((JOINTS + 1, 6, 6))
    return size * scale * (drawn + np.swapaxes(drawn, 1, 2)) / 2


def positive_diagonal(rng, size):
    """The same with a diagonal that is positive."""
    drawn = zero_mean(rng, size)
    for i in range(6):
        drawn[:, i, i] = np.abs(drawn[:, i, i])
    return drawn


def semidefinite(rng, size):
    """Wishart matrices of six degrees of freedom, whose mean diagonal is the size of the class."""
    root = np.sqrt(size * np.repeat(SIZES[:2], 3))
    drawn = rng.standard_normal((JOINTS + 1, 6, 6))
    return root[:, None] * (drawn @ np.swapaxes(drawn, 1, 2) / 6) * root


def nothing(_rng, _size):
    return np.zeros((JOINTS + 1, 6, 6))


# Springs, their size, and what else happens: offsets [deg], force scale, gaps [arc minutes], shift of all points [mm].
TRUTHS = {
    "noise only": (nothing, 0.0, {}),
    "offsets and force": (nothing, 0.0, {"offset": 0.02, "force": 0.01}),
    "lost motion": (nothing, 0.0, {"gap": 0.1}),
    "gaps, offsets, force, t3": (nothing, 0.0, {"gap": 0.1, "offset": 0.02, "force": 0.01, "tails": True}),
    "zero-mean springs": (zero_mean, 1.0, {}),
    "springs, positive diagonal": (positive_diagonal, 1.0, {}),
    "semidefinite springs": (semidefinite, 1.0, {}),
    "semidefinite, a tenth": (semidefinite, 0.1, {}),
    "semidefinite, and all else": (semidefinite, 1.0, {"gap": 0.1, "offset": 0.02, "force": 0.01, "tails": True}),
    # The joints stand where the last move left them; "lost motion" has them in the middle of their gaps.
    "lost motion, sides by chance": (nothing, 0.0, {"gap": 0.1, "sides": "chance"}),
    "lost motion, sides of the load": (nothing, 0.0, {"gap": 0.1, "sides": "load"}),
    "lost motion of 0.5, sides by chance": (nothing, 0.0, {"gap": 0.5, "sides": "chance"}),
    "lost motion of 0.5, sides of the load": (nothing, 0.0, {"gap": 0.5, "sides": "load"}),
}


@functools.cache
def of_cell(count):
    """Random postures within bounds and all limits of the cell."""
    rng, found = np.random.default_rng(12345), np.empty((0, JOINTS))
    while len(found) < count:
        q = rng.uniform(BOUNDS[:, 0], BOUNDS[:, 1], (count, JOINTS))
        of_springs, flange = frames(q, np.zeros((count, JOINTS + 1, 6)), np.ones(JOINTS))
        wrist, tool = of_springs[4][1], at(flange, np.vstack([POINTS, LOADING_POINT, np.zeros(3)]))
        inside = ((tool > BOX[0]) & (tool < BOX[1])).all(axis=(1, 2)) & (wrist[:, 2] > 0.3)
        from_axis = np.linalg.norm(np.concatenate([tool, wrist[:, None]], axis=1)[:, :, :2], axis=2)
        rope = np.linalg.norm(tool[:, 4] - ANCHOR, axis=1)
        found = np.vstack([found, q[inside & (from_axis > 0.9).all(axis=1) & (rope > 0.8) & (rope < 3.4)]])
    return found[:count]


def postures(rng, count):
    """Random postures within the bounds, measuring points inside the cell's box."""
    found = []
    while len(found) < count:
        q = np.round(rng.uniform(BOUNDS[:, 0], BOUNDS[:, 1], (64, JOINTS)), 3)
        points = unloaded(q, np.vstack([POINTS, LOADING_POINT]))
        inside = ((points > BOX[0]) & (points < BOX[1])).all(axis=(1, 2))
        clear = np.linalg.norm(points[:, 4] - ANCHOR, axis=1) > 0.8
        found.extend(q[inside & clear])
    return np.array(found[:count])


def planned(command, index, count):
    """Postures [deg] that the command selects for the default cell."""
    words = ["select", "builtin:comau", "--index", index, "-n", str(count), "--json"]
    done = subprocess.run([command, *words], capture_output=True, text=True, check=True)
    return np.round(json.loads(done.stdout)["result"]["postures_deg"], 3)


def cell_of(folder, errors, declared):
    """The cell as an experiment with these errors is described: with its approach, and where wanted with the common errors
    as its `[uncertainty]`, of which those that there are none of are 0."""
    sizes = {"force_scale_percent": 100 * errors.get("force", 0.0), "lost_motion_arcmin": errors.get("gap", 0.0)}
    sizes |= {"anchor_mm": 0, "loading_point_mm": 0, "registration_mrad": 0, "base_tilt_stiffness_nm_per_rad": 1e14}
    cell = Path(folder, "cell.toml")
    text = CELL.read_text()
    if declared:
        text += "\n[uncertainty]\n" + "".join(f"{key} = {size}\n" for key, size in sizes.items())
    if errors.get("sides") == "load":
        text += "\n[route]\nstart_deg = [0, -20, -90, 0, 60, 0]\napproach_deg = 0.5\n"
    cell.write_text(text)
    return cell


def ask(command, *words):
    """What the command says to these words, read from its JSON."""
    done = subprocess.run([command, *map(str, words), "--json"], capture_output=True, text=True)
    if done.returncode not in (0, 1) or not done.stdout:
        raise RuntimeError(f"{words}: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)["result"]


def experiment(folder, args, truth, count, plan, seed):
    """One arm, one experiment: what holds."""
    springs_of, size, errors = TRUTHS[truth]
    rng = np.random.default_rng([seed, count, list(TRUTHS).index(truth)])
    springs = springs_of(rng, size)
    for j in range(JOINTS):
        # The model's own axis is no random entry where springs scatter around zero.
        springs[j + 1, 5, 5] = springs[j + 1, 5, 5] * (springs_of is semidefinite) + 1 / STIFFNESS[j]
    alone = np.array([springs[j + 1, 5, 5] for j in range(JOINTS)])
    # Towards the torque, drawn joint by joint.
    gaps = np.abs(rng.standard_normal(JOINTS)) * errors.get("gap", 0.0) * ARCMINUTE
    bearings = rng.uniform(size=JOINTS)
    whole = reproduced(springs, bearings)
    offsets = rng.standard_normal(JOINTS) * errors.get("offset", 0.0)
    force = FORCE * (1 + rng.standard_normal() * errors.get("force", 0.0))
    q, work = postures(rng, count), postures(rng, 10)
    q = q if plan is None else plan
    side = rng.choice([-1.0, 1.0], q.shape) if errors.get("sides") == "chance" else None
    # Where the load finds them on its side, it takes no joint through its gap.
    crossed = gaps * (errors.get("sides") != "load")
    measured = bent(q + offsets, (springs, crossed, bearings), force, side) - unloaded(q + offsets, POINTS)
    drawn = rng.standard_normal(measured.shape)
    if errors.get("tails"):
        drawn = rng.standard_t(3, measured.shape) / math.sqrt(3)
    measured = (measured + NOISE * drawn) * 1e3
    at_work = bent(work, (springs, gaps, bearings), AT_WORK) - unloaded(work, POINTS)

    angles = [f"q{j + 1}_deg" for j in range(JOINTS)]
    table = Path(folder, "readings.csv")
    with table.open("w") as file:
        file.write(",".join(["posture", "point", "dx_mm", "dy_mm", "dz_mm", *angles]) + "\n")
        for p, posture in enumerate(q):
            for point, (x, y, z) in enumerate(measured[p]):
                file.write(f"{p + 1},{point + 1},{x:.12f},{y:.12f},{z:.12f}," + ",".join(map(str, posture)) + "\n")
    places = Path(folder, "work.csv")
    rows = [",".join(["posture", *angles])] + [f"w{p}," + ",".join(map(str, row)) for p, row in enumerate(work)]
    places.write_text("\n".join(rows) + "\n")
    stiffness = Path(folder, "stiffness.json")
    cell = cell_of(folder, errors, args.declared)

    run = functools.partial(ask, args.stiffarm)
    identified = run("identify", cell, table, *args.options.split(), "--output", stiffness, "--force")
    joints = identified["joints"]
    elastic = identified.get("elastic") or {}
    by_axes = elastic.get("axes") or joints

    def holds(compliance, joints=joints):
        out = []
        for h, joint in zip(compliance, joints):
            low, high = joint["interval"] or (None, None)
            k = 1 / h if h > 0 else math.inf
            out.append(low is not None and low <= k and (high is None or k <= high))
        return out

    at_tip = ",".join(map(str, AT_WORK))
    predicted = run("predict", cell, stiffness, places, "--force-n", at_tip, "--axes", "base")
    bands, errors_m = [], []
    for point, true in zip(predicted["points"], at_work[:, 0]):
        error = np.array(point["shift_m"]) - true
        errors_m.append(error)
        if point.get("band"):
            bands.extend(np.abs(error) <= np.array(point["band"]["total_m"]))
    return {
        "whole": holds(whole),
        "alone": holds(alone),
        "axes": holds(whole, by_axes),
        "open": [joint["interval"] is None or joint["interval"][1] is None for joint in joints],
        "width": [joint["half_width"] for joint in joints],
        "bands": float(np.mean(bands)) if bands else None,
        "band_mm": float(np.mean([p["band"]["total_m"] for p in predicted["points"] if p.get("band")])) * 1e3,
        "square": float(np.mean(np.square(errors_m))),
        "mixed": elastic.get("model") == "mixed",
    }


def batch(args, truth, count, plan, seeds):
    with tempfile.TemporaryDirectory() as folder:
        return [experiment(folder, args, truth, count, plan, seed) for seed in seeds]


def row(found):
    """A line of the table, with standard errors over experiments."""

    def share(values):
        values = np.asarray(values, dtype=float)
        each = values.reshape(len(values), -1).mean(axis=1)
        return f"{100 * each.mean():.1f} ± {100 * each.std() / math.sqrt(len(each)):.1f}"

    whole = np.array([f["whole"] for f in found])
    widths = np.array([[math.nan if w is None else w for w in f["width"]] for f in found], dtype=float)
    worst = whole.mean(axis=0)
    bands = [f["bands"] for f in found if f["bands"] is not None]
    return [
        share(whole),
        f"{100 * worst.min():.1f} (joint {worst.argmin() + 1})",
        " ".join(f"{100 * w:.0f}" for w in worst),
        share([f["alone"] for f in found]),
        share([f["axes"] for f in found]),
        f"{100 * np.nanmedian(widths):.1f} %",
        f"{100 * np.mean([f['open'] for f in found]):.0f} %",
        share(bands) if bands else "–",
        f"{np.mean([f['band_mm'] for f in found]):.4f}",
        f"{1e3 * math.sqrt(np.mean([f['square'] for f in found])):.4f}",
        f"{100 * np.mean([f['mixed'] for f in found]):.0f} %",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stiffarm", default="stiffarm", help="the command")
    parser.add_argument("--experiments", type=int, default=1000)
    parser.add_argument("--postures", type=int, nargs="+", default=[6, 8, 12, 40])
    parser.add_argument("--truths", nargs="+", default=list(TRUTHS), choices=list(TRUTHS), metavar="TRUTH")
    parser.add_argument("--options", default="", help="further options of `identify`, in one word")
    parser.add_argument("--plan", metavar="INDEX", help="postures selected under this index instead of random ones")
    parser.add_argument("--declared", action="store_true", help="the cell states how large the common errors are")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    args = parser.parse_args()
    heads = ["truth", "postures", "k holds [%]", "worst joint [%]", "each", "alone [%]", "axes' model [%]", "± k, median", "open"]
    heads += ["bands hold [%]", "band [mm]", "error [mm]", "mixed"]
    print("| " + " | ".join(heads) + " |\n|" + "--|" * len(heads), flush=True)
    seeds = range(args.seed * 1_000_000, args.seed * 1_000_000 + args.experiments)
    plans = {count: planned(args.stiffarm, args.plan, count) if args.plan else None for count in args.postures}
    with concurrent.futures.ProcessPoolExecutor(args.processes) as pool:
        for truth in args.truths:
            for count in args.postures:
                parts = [seeds[i :: 4 * args.processes] for i in range(4 * args.processes)]
                jobs = [pool.submit(batch, args, truth, count, plans[count], part) for part in parts]
                found = [f for job in jobs for f in job.result()]
                print("| " + " | ".join([truth, str(count), *row(found)]) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
