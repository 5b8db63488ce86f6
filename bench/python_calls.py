"""What a call from Python costs beside the work itself, and whether many groups use all cores.

    pip install ./crates/stiffarm-py
    python bench/python_calls.py              # some 20 seconds; prints a page for bench/runs

The index of a group of postures is evaluated by one call each, and as many times inside one call; the difference is
what the call costs (medians of blocks, taken in turn). The array's own cost is that of `numpy.ascontiguousarray` and of
making the array that comes back.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np

import stiffarm

BLOCKS = 41


def per_call(function: Callable[[], object], calls: int) -> float:
    """Seconds of one of so many calls."""
    begin = time.perf_counter()
    for _ in range(calls):
        function()
    return (time.perf_counter() - begin) / calls


def many() -> None:
    """Groups per second of one call about 10,000 groups; run in processes of their own for each number of threads."""
    cell = stiffarm.Cell.built_in("comau")
    rng = np.random.default_rng(1)
    groups = rng.uniform(*cell.bounds.T, (10_000, 6, cell.joint_count))
    names = ["condition", "expected_error", "d", "o1"]
    stiffarm.indices(cell, groups[:64], names)
    wall, cpu = [], []
    for _ in range(5):
        begin, used = time.perf_counter(), time.process_time()
        stiffarm.indices(cell, groups, names)
        wall.append(time.perf_counter() - begin)
        cpu.append(time.process_time() - used)
    print(json.dumps({"wall": statistics.median(wall), "cpu": statistics.median(cpu)}))


def main() -> None:
    """Prints the page."""
    cell = stiffarm.Cell.built_in("comau")
    q = np.random.default_rng(2).uniform(*cell.bounds.T, (6, cell.joint_count))
    flat = q.ravel()
    objective = stiffarm.Objective(cell, "expected_error", postures=6)
    native = objective._native
    matrix = stiffarm.observation_matrix(cell, q)
    found: dict[str, list[float]] = {name: [] for name in ("inside", "call", "gradient", "matrix", "copy", "empty")}
    for _ in range(BLOCKS):
        found["inside"].append(per_call(lambda: native._repeated(flat, 1000), 1) / 1000)
        found["call"].append(per_call(lambda: objective(q), 1000))
        found["gradient"].append(per_call(lambda: objective.log_and_gradient(q), 300))
        found["matrix"].append(per_call(lambda: stiffarm.observation_matrix(cell, q), 1000))
        found["copy"].append(per_call(lambda: np.ascontiguousarray(q, dtype=np.float64).reshape(-1), 1000))
        found["empty"].append(per_call(lambda: np.empty(matrix.shape), 1000))
    micro = {name: 1e6 * statistics.median(values) for name, values in found.items()}
    cost = [1e6 * (call - inside) for call, inside in zip(found["call"], found["inside"], strict=True)]
    print(f"# A call from Python, {platform.system()} {platform.machine()}, {os.cpu_count()} cores\n")
    print(f"stiffarm {stiffarm.__version__}, Python {platform.python_version()}, NumPy {np.__version__};", end=" ")
    print(f"`python bench/python_calls.py`, medians of {BLOCKS} blocks.\n")
    print("| | µs |\n|:--|--:|")
    print(f"| index `expected_error` of six postures, inside the library | {micro['inside']:.2f} |")
    print(f"| the same by a call, `Objective(...)(q)` | {micro['call']:.2f} |")
    print(f"| **what the call costs** (median of the differences block by block) | **{statistics.median(cost):.2f}** |")
    print(f"| of that the array's own cost | {micro['copy']:.2f} |")
    print(f"| value and gradient, `log_and_gradient(q)` | {micro['gradient']:.2f} |")
    print(f"| `observation_matrix(cell, q)`, {matrix.shape[0]} × {matrix.shape[1]} | {micro['matrix']:.2f} |")
    print(f"| of that an array of this size | {micro['empty']:.2f} |\n")
    print("`indices` of 10,000 groups of six postures in one call:\n")
    print("| threads | wall [s] | processor [s] | groups per second |\n|--:|--:|--:|--:|")
    walls = {}
    for threads in (1, os.cpu_count() or 1):
        environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
        out = subprocess.run(
            [sys.executable, __file__, "--many"], env=environment, check=True, capture_output=True, text=True
        )
        times = json.loads(out.stdout)
        walls[threads] = times["wall"]
        print(f"| {threads} | {times['wall']:.3f} | {times['cpu']:.3f} | {10_000 / times['wall']:.0f} |")
    first, *_, last = walls
    print(f"\n{walls[first] / walls[last]:.2f} times as fast on {last} threads.")


if __name__ == "__main__":
    many() if "--many" in sys.argv else main()
