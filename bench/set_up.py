#!/usr/bin/env python3
"""Do the readings tell what is wrong with a set-up?

Raw readings of a day (unloaded, half and full load; tracker axes) are simulated here, by the kinematics and the exact
equilibrium of `elastic_truths.py` and nothing of stiffarm's, for an arm with and without springs beyond its axes; then one
thing is wrong: in the cell that the command is given, or with the readings. What `stiffarm identify` says is held against it:

- named: the first serious finding, or the doubt where there is none, has the quantity; `other`: it has another one;
- known, outside: share of the joints that are known to 10 % without a serious finding, and are not within their ±;
- k, bands: total intervals that hold, of all experiments, and 95 % bands of deflections at ten postures that took no part;
- told or held: experiments with a serious finding, or whose every interval of k holds.

    python3 bench/set_up.py --stiffarm target/release/stiffarm --experiments 300
"""

import argparse
import concurrent.futures
import functools
import math
import os
import sys
import tempfile
from pathlib import Path

import elastic_truths as et
import numpy as np

GRAVITY = 9.80665
# A tracker that stands somewhere: turn vector [rad] and place [m] of its axes in the base's.
TRACKER = np.array([0.02, -0.03, 2.4]), np.array([4.2, -1.8, 0.9])
SHARES = {"half": 0.5, "full": 1.0}
KNOWN = 0.1
SENSOR_NOISE = 0.3
DOWN = np.array([0.0, 0.0, -1.0])


def direction(rng):
    drawn = rng.standard_normal(3)
    return drawn / np.linalg.norm(drawn)


def vector(values):
    return "[" + ", ".join(f"{v:.6f}" for v in values) + "]"


class Day:
    """What the cell states and what is true; a slip changes one of them."""

    def __init__(self, rng):
        self.rng = rng
        self.anchor = et.ANCHOR.copy()
        self.loading_point = et.LOADING_POINT.copy()
        self.points = et.POINTS.copy()
        self.load, self.down, self.sensor = "rope", DOWN, None
        self.beside = np.zeros(3)
        self.shift = np.zeros(3)
        self.offset = 0.0
        self.scale = 1.0
        self.table_turn = None

    def cell(self, folder):
        text = et.CELL.read_text()

        def put(old, new):
            nonlocal text
            if old not in text:
                raise RuntimeError(f"{et.CELL} has no {old}")
            text = text.replace(old, new)

        put("loading_point_mm = [200, 0, 250]", f"loading_point_mm = {vector(self.loading_point * 1e3)}")
        for stated, own in zip(et.POINTS, self.points):
            put(f"position_mm = [{', '.join(f'{v * 1e3:.0f}' for v in stated)}]", f"position_mm = {vector(own * 1e3)}")
        if self.load == "weight":
            head, tail = text.split("[load]", 1)
            rest = tail[tail.index("\n[") :]
            text = f'{head}[load]\nkind = "weight"\nmagnitude_n = {et.FORCE:.0f}\n{rest}'
            put("rope_length_mm = [800, 3400]\n", "")
        else:
            put("anchor_mm = [1800, 0, 0]", f"anchor_mm = {vector(self.anchor * 1e3)}")
        if self.sensor is not None:
            put("has_sensor = false\n", "")
            text += '\n[sensor]\nmount = "flange"\nreports = "on_robot"\n'
            text += f"xyz_mm = [0, 0, 80]\nrpy_deg = [0, 0, {self.sensor}]\n"
        path = Path(folder, "cell.toml")
        path.write_text(text)
        return path


def anchor(day, far=0.3):
    day.anchor += far * direction(day.rng)


def loading_point(day, far=0.1):
    day.loading_point += far * direction(day.rng)


def gravity(day, degrees=10.0):
    day.load = "weight"
    across = math.radians(degrees)
    heading = day.rng.uniform(0, 2 * math.pi)
    day.down = np.array([math.sin(across) * math.cos(heading), math.sin(across) * math.sin(heading), -math.cos(across)])


def weight(day):
    day.load = "weight"


def sensor(day, degrees=0.0):
    day.sensor = degrees


def beside(day, mass):
    day.beside = mass * GRAVITY * DOWN


def common(day, far):
    day.shift = far * direction(day.rng)


def offset(day, newtons=50.0):
    day.offset = newtons


def scale(day, error=0.01):
    day.scale = 1 + error * day.rng.standard_normal()


def points_shifted(day, far=0.02):
    day.points = day.points + far * direction(day.rng)


def points_turned(day, degrees=2.0):
    day.points = day.points @ et.turns(math.radians(degrees) * direction(day.rng)[None])[0].T


def table(day, degrees=0.0):
    day.table_turn = math.radians(degrees) * direction(day.rng)


# What is wrong, and how findings call it: the quantity of `set-up`, or another code.
ROWS = {
    "sound, rope": (lambda day: None, ()),
    "sound, weight": (weight, ()),
    "sound, sensor": (sensor, ()),
    "sound, displacements": (table, ()),
    "force scale, 1 % (standard deviation)": (scale, ()),
    "anchor off by 300 mm": (anchor, ("anchor",)),
    "loading point off by 100 mm": (loading_point, ("loading-point",)),
    "base tilted by 10° under a weight": (gravity, ("gravity",)),
    "sensor turned by 30°": (functools.partial(sensor, degrees=30.0), ("sensor-axes", "force-direction")),
    "force 50 N too large in all states": (offset, ("force-offset",)),
    "hook of 1 kg": (functools.partial(beside, mass=1.0), ("force-beside",)),
    "hook of 3 kg": (functools.partial(beside, mass=3.0), ("force-beside",)),
    "all loaded 0.02 mm off": (functools.partial(common, far=2e-5), ("common-shift",)),
    "all loaded 0.05 mm off": (functools.partial(common, far=5e-5), ("common-shift",)),
    "all loaded 0.4 mm off": (functools.partial(common, far=4e-4), ("common-shift",)),
    "measuring points moved by 20 mm": (points_shifted, ("tool-place", "measuring-points", "joint-offset")),
    "measuring points turned by 2°": (points_turned, ("tool-place", "measuring-points", "joint-offset")),
    "displacements in a base turned by 2°": (functools.partial(table, degrees=2.0), ("registration",)),
    "displacements in a base turned by 10°": (functools.partial(table, degrees=10.0), ("registration",)),
}


def load_at(day, flange, share):
    """Force (n, 3) in base axes on the true loading point, and that point."""
    at = et.at(flange, et.LOADING_POINT[None])[:, 0]
    if day.load == "weight":
        return np.tile(day.down * et.FORCE * share, (len(at), 1)), at
    way = et.ANCHOR - at
    return et.FORCE * share * way / np.linalg.norm(way, axis=1)[:, None], at


def loaded(q, springs, bearings, day, share):
    """Positions (n, 4, 3) of the points in equilibrium, the frames of the flange, and the force there."""
    twists = np.zeros((len(q), et.JOINTS + 1, 6))
    for _ in range(50):
        frames, flange = et.frames(q, twists, bearings)
        force, at = load_at(day, flange, share)
        force = force + day.beside * (share > 0)
        found = np.empty_like(twists)
        for place, (rotation, origin) in enumerate(frames):
            moment = np.cross(at - origin, force)
            wrench = np.concatenate([np.einsum("nji,nj->ni", rotation, v) for v in (force, moment)], axis=1)
            found[:, place] = wrench @ springs[place].T
        moved = np.abs(found - twists).max()
        twists = found
        if moved < 1e-14:
            break
    flange = et.frames(q, twists, bearings)[1]
    return et.at(flange, et.POINTS), flange, force


def write(path, day, q, springs, bearings):
    """The day's readings; where the table's axes are asked for, displacements of the full load in base axes."""
    rng = day.rng
    noise = et.NOISE / math.sqrt(2)
    angles = [f"q{j + 1}_deg" for j in range(et.JOINTS)]
    free = et.unloaded(q, et.POINTS)
    if day.table_turn is not None:
        moved = loaded(q, springs, bearings, day, 1.0)[0] - free
        moved = moved + et.NOISE * rng.standard_normal(moved.shape)
        moved = moved @ et.turns(day.table_turn[None])[0].T
        rows = [",".join(["posture", "point", "dx_mm", "dy_mm", "dz_mm", *angles])]
        for p, posture in enumerate(q):
            for a in range(len(et.POINTS)):
                rows.append(",".join(map(str, [p + 1, a + 1, *(moved[p, a] * 1e3), *posture])))
        path.write_text("\n".join(rows) + "\n")
        return
    turn, place = et.turns(TRACKER[0][None])[0], TRACKER[1]
    forces = ["fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"] if day.sensor is not None else ["load_n"]
    rows = [",".join(["posture", "state", "point", "x_mm", "y_mm", "z_mm", *forces, *angles])]
    states = {"unloaded": (free, None, None)} | {n: loaded(q, springs, bearings, day, s) for n, s in SHARES.items()}
    for p, posture in enumerate(q):
        for name, (positions, flange, force) in states.items():
            share = SHARES.get(name, 0.0)
            own = positions[p] + day.shift * (share > 0)
            own = (own - place) @ turn + noise * rng.standard_normal(own.shape)
            stated = [et.FORCE * share * day.scale + day.offset * (share > 0)]
            if day.sensor is not None:
                stated = np.zeros(6)
                if share > 0:
                    rotation = flange[0][p]
                    lever = et.LOADING_POINT - np.array([0, 0, 0.08])
                    pull = rotation.T @ force[p]
                    stated = np.concatenate([pull, np.cross(lever, pull)])
                stated = stated + np.repeat([SENSOR_NOISE, SENSOR_NOISE / 6], 3) * rng.standard_normal(6)
            for a, point in enumerate(own):
                rows.append(",".join(map(str, [p + 1, name, a + 1, *(point * 1e3), *stated, *posture])))
    path.write_text("\n".join(rows) + "\n")


def first_said(identified):
    """What the first serious finding is about: the quantity of the set-up, or its code; and what is doubted where there is
    none."""
    diagnosis = identified["diagnosis"] or {}
    screening = (identified.get("readings") or {}).get("screening") or {}
    reduction = (identified.get("readings") or {}).get("reduction") or {}
    found = (diagnosis.get("findings") or []) + (screening.get("findings") or []) + (reduction.get("findings") or [])
    serious = [f for f in found if f["severity"] == "serious"]
    doubts = [f for f in found if f["code"] == "set-up-doubtful"]
    names = [own["name"] for own in (diagnosis.get("set_up") or {}).get("freed", [])[:1]]
    said = [names[0] if f["code"].startswith("set-up") else f["code"] for f in (serious or doubts)[:1]]
    return (said[0] if serious else None), (said[0] if said else None)


def experiment(folder, args, name, count, size, seed):
    slip, names = ROWS[name]
    rng = np.random.default_rng([seed, count, list(ROWS).index(name), int(100 * size)])
    springs = et.semidefinite(rng, size) if size else np.zeros((et.JOINTS + 1, 6, 6))
    for j in range(et.JOINTS):
        springs[j + 1, 5, 5] += 1 / et.STIFFNESS[j]
    bearings = rng.uniform(size=et.JOINTS)
    day = Day(rng)
    slip(day)
    q, work = et.postures(rng, count), et.postures(rng, 10)
    # Over the cell under its load.
    over = et.postures(np.random.default_rng(12345), 1000)
    at_rest = et.frames(over, np.zeros((len(over), et.JOINTS + 1, 6)), bearings)[1]
    total, by_axis = et.linear(over, (springs, bearings), *load_at(day, at_rest, 1.0), et.POINTS)
    whole = np.linalg.lstsq(by_axis.reshape(et.JOINTS, -1).T, total.reshape(-1), rcond=None)[0]
    readings, stiffness, places = (Path(folder, n) for n in ("readings.csv", "stiffness.json", "work.csv"))
    write(readings, day, q, springs, bearings)
    cell = day.cell(folder)
    identified = et.ask(args.stiffarm, "identify", cell, readings, "--output", stiffness, "--force")
    holds, known = [], []
    for h, joint in zip(whole, identified["joints"]):
        if not joint["determined"]:
            continue
        low, high = joint["interval"] or (None, None)
        holds.append(low is not None and low <= 1 / h and (high is None or 1 / h <= high))
        known.append(joint["half_width"] is not None and joint["half_width"] <= KNOWN)
    angles = [f"q{j + 1}_deg" for j in range(et.JOINTS)]
    rows = [",".join(["posture", *angles])] + [f"w{p}," + ",".join(map(str, row)) for p, row in enumerate(work)]
    places.write_text("\n".join(rows) + "\n")
    at_work = et.bent(work, (springs, np.zeros(et.JOINTS), bearings), et.AT_WORK) - et.unloaded(work, et.POINTS)
    tip = ",".join(map(str, et.AT_WORK))
    bands = []
    # The tip is the first measuring point: where the cell has it elsewhere, other bands are asked for.
    try:
        predicted = et.ask(args.stiffarm, "predict", cell, stiffness, places, "--force-n", tip, "--axes", "base")
    except (RuntimeError, KeyError):
        # A joint that no load of this day turns.
        predicted = {"points": []}
    for point, true in zip(predicted["points"], at_work[:, 0]):
        if point.get("band"):
            bands.extend(np.abs(np.array(point["shift_m"]) - true) <= np.array(point["band"]["total_m"]))
    serious, said = first_said(identified)
    return {
        "named": said in names,
        "other": said is not None and said not in names,
        "said": said,
        "outside": float(np.mean([k and not h for k, h in zip(known, holds)])) if serious is None else 0.0,
        "k": float(np.mean(holds)),
        "bands": float(np.mean(bands)) if bands else None,
        "told": serious is not None or all(holds),
    }


def batch(args, name, count, size, seeds):
    with tempfile.TemporaryDirectory() as folder:
        return [experiment(folder, args, name, count, size, seed) for seed in seeds]


def share(values):
    values = np.array([v for v in values if v is not None], dtype=float)
    if not len(values):
        return "–"
    return f"{100 * values.mean():.0f} ± {100 * values.std() / math.sqrt(len(values)):.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stiffarm", default="stiffarm", help="the command")
    parser.add_argument("--experiments", type=int, default=300)
    parser.add_argument("--postures", type=int, nargs="+", default=[8, 12])
    parser.add_argument("--springs", type=float, nargs="+", default=[0.0, 0.1], help="size of the springs beyond the axes")
    parser.add_argument("--rows", nargs="+", default=list(ROWS), choices=list(ROWS), metavar="ROW")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    args = parser.parse_args()
    heads = ["what is wrong", "postures", "springs", "named", "other", "known, outside", "k", "bands", "told or held"]
    print("| " + " | ".join(heads) + " | others |\n|" + "--|" * (len(heads) + 1), flush=True)
    seeds = range(args.seed * 1_000_000, args.seed * 1_000_000 + args.experiments)
    with concurrent.futures.ProcessPoolExecutor(args.processes) as pool:
        for name in args.rows:
            for size in args.springs:
                for count in args.postures:
                    parts = [seeds[i :: args.processes] for i in range(args.processes)]
                    jobs = [pool.submit(batch, args, name, count, size, part) for part in parts]
                    found = [f for job in jobs for f in job.result()]
                    keys = ["named", "other", "outside", "k", "bands", "told"]
                    others = sorted({f["said"] for f in found if f["other"]})
                    cells = [name, str(count), str(size), *(share([f[key] for f in found]) for key in keys)]
                    print("| " + " | ".join([*cells, ", ".join(others)]) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
