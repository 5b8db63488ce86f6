#!/usr/bin/env python3
"""Could joint stiffness be identified from an arm's own weight, without any load?

Where link masses are known, gravity turns joint j by tau_j/k_j, which changes from posture to posture. The unloaded
readings of a tracker hold that beside everything else that they do not know: where the tracker stands, where the
reflector sits on the tool, and the arm's geometry. All of it is fitted at once, to first order: a turn and a shift of
the base, a shift of the reflector, a small turn and shift behind every joint with a stated standard deviation, and the
compliance of the joints that gravity turns. NumPy alone, nothing of stiffarm's.

    python3 bench/own_weight.py                 what 100 random postures would tell
    python3 bench/own_weight.py --ur5 FOLDER    what those of a real UR5 tell

FOLDER is a clone of github.com/pauljac7700/serial_robots_datasets (MIT): 1,020 postures of a UR5, a GTS3800 tracker and
one reflector, P. Jacobi, Tsinghua University 2025. Masses are those that Universal Robots publishes. --only takes every
second row of three parts of the grid, which is what docs/measured.md reports.
"""

import argparse
from pathlib import Path

import elastic_truths as comau
import numpy as np

G = 9.80665
# a [m], alpha [rad], d [m], offset [rad] of each joint (Denavit-Hartenberg, distal), mass [kg] of each link and its
# centre of mass [m] in the frame behind it.
UR5 = (
    np.array([[0, 90, 0.089159, 0], [-0.425, 0, 0, 0], [-0.39225, 0, 0, 0], [0, 90, 0.10915, 0], [0, -90, 0.09465, 0], [0, 0, 0.0823, 0]]),
    np.array([3.7, 8.393, 2.33, 1.219, 1.219, 0.1879]),
    np.array([[0, -0.02561, 0.00193], [0.2125, 0, 0.11336], [0.15, 0, 0.0265], [0, -0.0018, 0.01634], [0, 0.0018, 0.01634], [0, 0, -0.001159]]),
)
# The COMAU NJ 165-3.0 of cells/comau.toml in the same convention. Its links' masses are assumed: 960 kg of an arm of
# 1,250 kg move, and a tool of 60 kg, in the last link.
COMAU = (
    np.array([[0.4, -90, 0.83, 0], [1.175, 0, 0, -90], [0.25, -90, 0, -90], [0, 90, 1.444, 0], [0, -90, 0, 0], [0, 0, 0.23, 180]]),
    np.array([330, 200, 320, 60, 30, 80]),
    np.array([[-0.2, 0.1, 0], [-0.6, 0, 0], [-0.1, 0, 0.2], [0, -0.7, 0], [0, 0, 0.05], [0, 0, 0.15]]),
)
TOOL = {"UR5": [0, 0, 0.031], "COMAU NJ 165-3.0": comau.LOADING_POINT}
RANGE = {
    "UR5": [[-180, 180], [-120, -30], [30, 140], [-120, 30], [40, 140], [-180, 180]],
    "COMAU NJ 165-3.0": comau.BOUNDS,
}


def frames(rows, q):
    """Homogeneous frames (n + 1, 4, 4) of base and links at joint angles in rad."""
    found = [np.eye(4)]
    for (a, alpha, d, offset), angle in zip(rows, q):
        c, s = np.cos(angle + np.radians(offset)), np.sin(angle + np.radians(offset))
        ca, sa = np.cos(np.radians(alpha)), np.sin(np.radians(alpha))
        step = np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
        found.append(found[-1] @ step)
    return np.array(found)


def torques(found, masses, centres):
    """What the links' weight turns each joint with, N m."""
    weights = np.outer(masses, [0, 0, -G])
    places = np.array([(frame @ np.append(centre, 1))[:3] for frame, centre in zip(found[1:], centres)])
    axes, origins = found[:-1, :3, 2], found[:-1, :3, 3]
    moments = [[np.cross(p - o, w) @ z if link >= j else 0 for link, (p, w) in enumerate(zip(places, weights))] for j, (z, o) in enumerate(zip(axes, origins))]
    return np.sum(moments, axis=1)


def columns(arm, q, tool, size_m, size_rad):
    """Of one posture: the reflector, the columns (3, 9 + 6 n) of geometry in units of their standard deviation, those
    (3, n) of the compliances, and the torques."""
    rows, masses, centres = arm
    found = frames(rows, q)
    tip = (found[-1] @ np.append(tool, 1))[:3]

    def twist(frame, metres, radians):
        turn, place = frame[:3, :3], frame[:3, 3]
        return np.hstack([turn * metres, np.cross(turn.T, tip - place).T * radians])

    geometry = [twist(found[0], 1.0, 1.0), found[-1][:3, :3] * 0.1]
    geometry += [twist(frame, size_m, size_rad) for frame in found[1:]]
    torque = torques(found, masses, centres)
    sag = np.array([np.cross(frame[:3, 2], tip - frame[:3, 3]) * t for frame, t in zip(found, torque)]).T
    return tip, np.hstack(geometry), sag, torque


def stacked(arm, postures, tool, size_m, size_rad):
    """The same of all postures, rows posture by posture."""
    parts = [columns(arm, q, tool, size_m, size_rad) for q in postures]
    tips, geometry, sag, torque = zip(*parts)
    return np.array(tips), np.concatenate(geometry), np.concatenate(sag), np.array(torque)


def estimate(y, geometry, sag, noise):
    """Geometry in standard deviations and compliances without a prior, and their covariance."""
    known = geometry.shape[1]
    scale = np.concatenate([np.ones(known), 1 / np.maximum(np.linalg.norm(sag, axis=0), 1e-300)])
    a = np.vstack([np.hstack([geometry, sag]) * scale / noise, np.eye(known, known + sag.shape[1])])
    b = np.concatenate([y / noise, np.zeros(known)])
    inverse = np.linalg.inv(a.T @ a)
    return scale * (inverse @ (a.T @ b)), scale[:, None] * inverse * scale


def rms(residuals):
    """RMS of the distance, mm."""
    return 1e3 * np.sqrt((residuals.reshape(-1, 3) ** 2).sum(axis=1).mean())


def forecast():
    """± at 95 % of the stiffness of each joint that gravity turns, from 100 postures."""
    rng = np.random.default_rng(1)
    stiffness = {"UR5": np.array([30e3] * 3 + [10e3] * 3), "COMAU NJ 165-3.0": comau.STIFFNESS}
    for name, arm in {"UR5": UR5, "COMAU NJ 165-3.0": COMAU}.items():
        low, high = np.radians(RANGE[name]).T
        postures = rng.uniform(low, high, (100, 6))
        compliance = 1 / stiffness[name]
        _, geometry, sag, torque = stacked(arm, postures, TOOL[name], 1e-3, 1e-3)
        turned = np.flatnonzero(np.sqrt((torque**2).mean(axis=0)) > 1.0)

        def told(what, deviation, name=name, turned=turned):
            said = [f"joint {j + 1} ± {196 * d:.1f} %" for j, d in zip(turned, deviation)]
            print(f"{name}, {what}: {', '.join(said)}")

        for noise in (0.03, 0.1):
            _, covariance = estimate(np.zeros(len(sag)), geometry, sag[:, turned], noise * 1e-3)
            deviation = np.sqrt(np.diag(covariance)[geometry.shape[1] :])
            told(f"readings off by {noise} mm", deviation / compliance[turned])
        # Masses that are off make readings that the model takes for stiffness, without any noise.
        errors = []
        for _ in range(400):
            masses = arm[1] * (1 + 0.05 * rng.standard_normal(len(arm[1])))
            true = stacked((arm[0], masses, arm[2]), postures, TOOL[name], 1e-3, 1e-3)[2]
            found, _ = estimate(true @ compliance, geometry, sag[:, turned], 3e-5)
            errors.append(found[geometry.shape[1] :] / compliance[turned] - 1)
        told("masses off by 5 %", np.sqrt(np.mean(np.square(errors), axis=0)))


def is_reported(number):
    """Whether a row of the grid is one of those behind docs/measured.md."""
    return number % 2 == 0 and any(low <= number <= high for low, high in ((0, 68), (416, 482), (898, 966))) or number == 415


def trial(folder, only):
    """The same of readings of a UR5: compliances, and how well postures that took no part are predicted."""
    files = ["3D_UR5_uncalibrated_grid_cleaned.csv", "3D_UR5_uncalibrated_random_cleaned.csv"]
    grid, other = (np.loadtxt(folder / name, delimiter=",", skiprows=1, ndmin=2) for name in files)
    rows = np.concatenate([[row for row in grid if not only or is_reported(int(row[0]))], other])
    # Reached is target plus difference: the other way round joint 2 would have a negative compliance.
    postures, place = np.radians(rows[:, 7:13]), (rows[:, 1:4] + rows[:, 4:7]) * 1e-3
    tips, geometry, sag, torque = stacked(UR5, postures, TOOL["UR5"], 1e-3, 2e-3)
    turned = np.flatnonzero(np.sqrt((torque**2).mean(axis=0)) > 1.0)
    y = (place - tips).reshape(-1)
    print(f"{len(rows)} postures, torque of the own weight {np.sqrt((torque**2).mean(axis=0)).round(1)} N m RMS")
    folds = np.repeat(np.arange(len(rows)) % 10, 3)
    for name, used in (("geometry alone", turned[:0]), ("and the joints that gravity turns", turned)):
        columns_ = np.hstack([geometry, sag[:, used]])
        found, covariance = estimate(y, geometry, sag[:, used], 1e-4)
        missed = np.zeros_like(y)
        for fold in range(10):
            others = folds != fold
            one, _ = estimate(y[others], geometry[others], sag[others][:, used], 1e-4)
            missed[~others] = (y - columns_ @ one)[~others]
        print(f"{name}: {rms(y - columns_ @ found):.3f} mm, postures left out in turn {rms(missed):.3f} mm")
        for j, c, d in zip(used, found[geometry.shape[1] :], np.sqrt(np.diag(covariance)[geometry.shape[1] :])):
            print(f"  joint {j + 1}: compliance {c:.2e} ± {1.96 * d:.1e} rad/(N m)")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ur5", type=Path, metavar="FOLDER", help="readings of a UR5")
    parser.add_argument("--only", action="store_true", help="only the rows behind docs/measured.md")
    given = parser.parse_args()
    trial(given.ur5, given.only) if given.ur5 else forecast()
