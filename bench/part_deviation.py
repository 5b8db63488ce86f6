#!/usr/bin/env python3
"""Does a CLSF come out as stiffarm says, and does the CLSF that it writes bring the loaded tool back?

A part with two operations is written as a CLSF here and read here again; the arm is that of elastic_truths.py, which
knows nothing of stiffarm: kinematics from the Denavit-Hartenberg rows, the exact equilibrium under a force at the tip.
Held against them: the tip and the tool axis at the postures that `predict` finds, the shift of the tip, the deviation of
each feature across and along the feed, and where the loaded tip is at the postures and in the file of `compensate`.

    python3 bench/part_deviation.py --stiffarm target/debug/stiffarm
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import elastic_truths as arm
import numpy as np

WORKPIECE = np.array([1.7, -0.2, 0.8])
FORCE = np.array([80.0, -200.0, 300.0])
# Only the joint axes give way, as in the cell's prior.
SPRINGS = np.zeros((arm.JOINTS + 1, 6, 6))
SPRINGS[1:, 5, 5] = 1 / arm.STIFFNESS
ARM = (SPRINGS, np.zeros(arm.JOINTS), np.ones(arm.JOINTS))


def part():
    """The CLSF of a freeform surface and a slot: names, and points (n, 6) in mm with the tool axis."""
    turn = np.linspace(0, 2 * np.pi, 33)[:-1]
    tilt = np.stack([0.2 * np.cos(turn), 0.2 * np.sin(turn), np.ones_like(turn)], axis=1)
    surface = np.column_stack([60 * np.cos(turn), 40 * np.sin(turn), 5 * np.cos(2 * turn), tilt])
    slot = np.array([[x, 10.0, -3.0, 0, 0, 1] for x in np.linspace(-45, 45, 10)])
    points = {"SURFACE": surface, "SLOT": slot}
    for rows in points.values():
        rows[:, 3:] /= np.linalg.norm(rows[:, 3:], axis=1)[:, None]
    lines = ["UNITS/MM"]
    for name, rows in points.items():
        lines += [f"TOOL PATH/{name},TOOL,T1", "RAPID", goto(rows[0] + [0, 0, 40, 0, 0, 0])]
        lines += [goto(row) for row in rows]
        lines += ["END-OF-PATH"]
    return "\n".join(lines) + "\n"


def goto(row):
    """A point with its tool axis."""
    return "GOTO/" + ",".join(f"{value:.6f}" for value in row[:3]) + "," + ",".join(f"{value:.9f}" for value in row[3:])


def read(text):
    """Points (n, 6) of a CLSF, and the name of each one's operation; none for a rapid move."""
    points, names, name, is_rapid = [], [], "", False
    for line in text.splitlines():
        if line.startswith("TOOL PATH/"):
            name = line.split("/")[1].split(",")[0]
        if line.startswith("GOTO/"):
            points.append([float(value) for value in line[5:].split(",")])
            names.append("" if is_rapid else name)
            is_rapid = False
        is_rapid |= line == "RAPID"
    return np.array(points), np.array(names)


def run(command, folder, *words):
    """What the command prints as JSON."""
    line = [command, *words, "--axes", "base", "--force-n", ",".join(map(str, FORCE)), "--json"]
    ran = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=True)
    return json.loads(ran.stdout)["result"]


def tip(q_deg):
    """Position of the unloaded tip and direction of the flange's z."""
    _, flange = arm.frames(q_deg, np.zeros((len(q_deg), arm.JOINTS + 1, 6)), np.ones(arm.JOINTS))
    return arm.at(flange, arm.POINTS[:1])[:, 0], flange[0][:, :, 2]


def loaded(q_deg):
    """Position of the loaded tip."""
    return arm.bent(q_deg, ARM, FORCE)[:, 0]


def parts(shift, points):
    """Size of the shift across the feed, and along it: the feed is that from the point before to the one behind."""
    position = points[:, :3]
    ahead, behind = np.roll(position, -1, axis=0), np.roll(position, 1, axis=0)
    ahead[-1], behind[0] = position[-1], position[0]
    feed = ahead - behind
    feed -= points[:, 3:] * np.einsum("ij,ij->i", feed, points[:, 3:])[:, None]
    feed /= np.linalg.norm(feed, axis=1)[:, None]
    along = np.einsum("ij,ij->i", shift, feed)
    return np.linalg.norm(shift - along[:, None] * feed, axis=1), np.abs(along)


def with_those_between(points, names, tips):
    """The points of the CLSF with those that stiffarm puts near corners, each where the straight move to the next
    point passes its tip: (n, 6) in mm with the tool axis, names, and which the CLSF has."""
    rows, of, own, begun = [], [], [], 0
    for tip_mm in tips:
        own.append(np.abs(tip_mm - points[begun, :3]).max() < 1e-6)
        if own[-1]:
            rows.append(points[begun])
            of.append(names[begun])
            begun += 1
        else:
            start, end = points[begun - 1], points[begun]
            way = end[:3] - start[:3]
            share = (tip_mm - start[:3]) @ way / (way @ way)
            angle = np.arccos(np.clip(start[3:] @ end[3:], -1, 1))
            turned = end[3:] if angle < 1e-9 else (
                np.sin((1 - share) * angle) * start[3:] + np.sin(share * angle) * end[3:]
            ) / np.sin(angle)
            rows.append(np.concatenate([start[:3] + share * way, turned]))
            of.append(names[begun])
    assert begun == len(points)
    return np.array(rows), np.array(of), np.array(own)


def main():
    """Prints the largest differences."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stiffarm", default="target/debug/stiffarm")
    command = str(Path(parser.parse_args().stiffarm).resolve())
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "part.cls").write_text(part(), encoding="utf-8")
        predicted = run(command, folder, "predict", "builtin:comau", "prior", "part.cls")
        words = ["compensate", "builtin:comau", "prior", "part.cls", "--output", "out.cls", "--beyond-data"]
        compensated = run(command, folder, *words)
        written, _ = read(Path(folder, "out.cls").read_text(encoding="utf-8"))
    points, names = read(part())
    q = np.array([point["q_deg"] for point in predicted["points"]])
    position, axis = tip(q)
    points, names, own = with_those_between(points, names, 1e3 * (position - WORKPIECE))
    wanted = WORKPIECE + 1e-3 * points[:, :3]
    cuts = names != ""
    shift = (loaded(q) - position) * cuts[:, None]
    across, along = parts(shift, points)
    found = {feature["name"]: feature for feature in predicted["features"]}
    worst = [
        (found[name][key], of[names == name].max())
        for name in found
        for key, of in (("across_max_m", across), ("feed_max_m", along))
    ]
    commanded = np.array([point["command_q_deg"] for point in compensated["points"]])
    corrected, corrected_axis = tip(commanded)
    print(f"{own.sum()} points and {(~own).sum()} near corners, {len(found)} features, deflection up to {1e3 * np.linalg.norm(shift, axis=1).max():.3f} mm")
    for what, value, unit in (
        ("tip at the postures found, off the CLSF", np.abs(position - wanted).max(), "m"),
        ("tool axis there", np.abs(axis + points[:, 3:]).max(), "rad"),
        ("shift of the tip", np.abs(shift - [point["shift_m"] for point in predicted["points"]]).max(), "m"),
        ("deviation of the features across and along the feed", max(abs(a - b) for a, b in worst), "m"),
        ("loaded tip at the commanded postures, off the CLSF", np.abs(loaded(commanded) - wanted)[cuts].max(), "m"),
        ("written CLSF, off the commanded postures", np.abs(WORKPIECE + 1e-3 * written[:, :3] - corrected[own]).max(), "m"),
        ("its tool axis", np.abs(corrected_axis[own] + written[:, 3:]).max(), "rad"),
    ):
        print(f"{what:55} {value:.1e} {unit}")


if __name__ == "__main__":
    main()
