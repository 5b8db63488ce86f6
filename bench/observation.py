#!/usr/bin/env python3
"""Observation matrices of many postures in one call: stiffarm, and Numba on the same cores.

    pip install ./crates/stiffarm-py numpy==2.4.6 numba==0.68.1
    python bench/observation.py                  # some 20 seconds; prints a table

Numba's function is what one writes by hand for this arm: joint frames, torques by the rope, columns at each measuring
point, compiled for this processor, postures on all cores. Both matrices must agree before a time counts. Calls are
taken in turn; the table has medians.
"""

import argparse
import math
import statistics
import time

import numba
import numpy as np
from peer.cell import BenchError, reference_cell

import stiffarm

# Largest difference, of the largest entry.
SAME = 1e-13


@numba.njit
def moved(turn, at, point):
    """A point in flange axes, in the base frame."""
    x = turn[0, 0] * point[0] + turn[0, 1] * point[1] + turn[0, 2] * point[2] + at[0]
    y = turn[1, 0] * point[0] + turn[1, 1] * point[1] + turn[1, 2] * point[2] + at[1]
    z = turn[2, 0] * point[0] + turn[2, 1] * point[1] + turn[2, 2] * point[2] + at[2]
    return x, y, z


@numba.njit
def lever(axis, origin, point):
    """What a turn about the axis moves the point by."""
    x, y, z = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    return axis[1] * z - axis[2] * y, axis[2] * x - axis[0] * z, axis[0] * y - axis[1] * x


@numba.njit(parallel=True)
def observation(q, rows, coupling, loading, points, anchor, magnitude):
    """Psi of Eq. (9), (postures * points * 3) x joints."""
    joints, count = len(rows), len(points)
    psi = np.empty((len(q) * count * 3, joints))
    for p in numba.prange(len(q)):
        turn = np.eye(3)
        at = np.zeros(3)
        axes = np.empty((joints, 3))
        origins = np.empty((joints, 3))
        for j in range(joints):
            alpha, a, d, theta = rows[j]
            for k in range(joints):
                theta += coupling[j, k] * q[p, k]
            sin_alpha, cos_alpha = math.sin(alpha), math.cos(alpha)
            sin, cos = math.sin(theta), math.cos(theta)
            for i in range(3):
                x, y, z = turn[i]
                along = cos_alpha * z - sin_alpha * y
                across = cos_alpha * y + sin_alpha * z
                at[i] += a * x + d * along
                turn[i, 0] = cos * x + sin * across
                turn[i, 1] = cos * across - sin * x
                turn[i, 2] = along
                axes[j, i] = along
                origins[j, i] = at[i]
        hook = moved(turn, at, loading)
        x, y, z = anchor[0] - hook[0], anchor[1] - hook[1], anchor[2] - hook[2]
        pull = magnitude / math.sqrt(x * x + y * y + z * z)
        torque = np.empty(joints)
        for j in range(joints):
            column = lever(axes[j], origins[j], hook)
            torque[j] = pull * (column[0] * x + column[1] * y + column[2] * z)
        for m in range(count):
            point = moved(turn, at, points[m])
            row = 3 * (p * count + m)
            for j in range(joints):
                x, y, z = lever(axes[j], origins[j], point)
                psi[row, j] = x * torque[j]
                psi[row + 1, j] = y * torque[j]
                psi[row + 2, j] = z * torque[j]
    return psi


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--postures", type=int, default=100_000)
    parser.add_argument("--pairs", type=int, default=41)
    options = parser.parse_args()
    peer = reference_cell()
    cell = stiffarm.Cell.built_in("comau-reference")
    q = np.random.default_rng(1).uniform(*peer.bounds.T, (options.postures, peer.joints))
    calls = {
        "stiffarm": lambda: stiffarm.observation_matrix(cell, q),
        "numba": lambda: observation(
            q, peer.rows, peer.coupling, peer.loading_point, peer.measuring_points, peer.anchor, peer.magnitude
        ),
    }
    ours, theirs = (call() for call in calls.values())
    difference = np.abs(ours - theirs).max() / np.abs(theirs).max()
    if not difference < SAME:
        raise BenchError(f"The matrices differ by {difference:.1e} of their largest entry; nothing was timed.")
    del ours, theirs
    wall = {name: [] for name in calls}
    processor = {name: [] for name in calls}
    for _ in range(options.pairs):
        for name, call in calls.items():
            begin, used = time.perf_counter(), time.process_time()
            call()
            wall[name].append(time.perf_counter() - begin)
            processor[name].append(time.process_time() - used)
    print(f"{options.postures} postures, {len(peer.measuring_points)} points; largest difference {difference:.1e}\n")
    print("| | wall [s] | processor [s] |\n|:--|--:|--:|")
    for name in calls:
        print(f"| {name} | {statistics.median(wall[name]):.4f} | {statistics.median(processor[name]):.4f} |")
    ratio = statistics.median(wall["stiffarm"]) / statistics.median(wall["numba"])
    print(f"\nstiffarm takes {ratio:.2f} times as long as Numba.")


if __name__ == "__main__":
    main()
