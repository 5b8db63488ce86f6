"""The driving order of random plans against an optimum of LKH, and what it costs: `stiffarm route` of the paper's cell, which has nothing to touch.

    pip install numpy==2.* elkai==2.0.1
    python3 bench/driving_order.py target/release/stiffarm [another binary ...]

Moves are joint moves: one costs its largest turn of a joint, as no joint speeds are known. LKH closes the path by a stop
that is everywhere; its costs are whole numbers, a millionth of a radian each.
"""

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import elkai
import numpy as np

COUNTS, SEEDS, UNIT = (20, 50, 100, 200), (1, 2, 3), 1e-6
LOW, HIGH = [-60, -20, -140, -90, -80, -90], [60, 60, -60, 90, 80, 90]


def routed(binary, plan):
    """Order of `stiffarm route`, and its processor time [s]."""
    line = [binary, "route", "builtin:comau-reference", plan, "--angle-step-deg", "0", "--json"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run(line, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ran.returncode not in (0, 1):
        raise SystemExit(ran.stderr or ran.stdout)
    return json.loads(ran.stdout)["result"]["order"], after.ru_utime - before.ru_utime


def length(cost, order):
    return sum(cost[a, b] for a, b in zip(order, order[1:]))


def main(binaries):
    print("postures | LKH [rad] | " + " | ".join(f"{Path(b).name}: longer [%], [s]" for b in binaries))
    with tempfile.TemporaryDirectory() as folder:
        for count in COUNTS:
            best, longer, seconds = [], {b: [] for b in binaries}, {b: [] for b in binaries}
            for seed in SEEDS:
                q = np.random.default_rng(seed).uniform(LOW, HIGH, (count, 6))
                plan = Path(folder) / "plan.csv"
                rows = [f"{i}," + ",".join(map(repr, map(float, row))) for i, row in enumerate(q)]
                plan.write_text("posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n" + "\n".join(rows) + "\n")
                cost = np.radians(np.abs(q[:, None] - q[None]).max(axis=2))
                whole = np.zeros((count + 1, count + 1), dtype=int)
                whole[1:, 1:] = np.rint(cost / UNIT)
                tour = elkai.DistanceMatrix(whole.tolist()).solve_tsp(runs=10)[1:-1]
                best.append(length(cost, [stop - 1 for stop in tour]))
                for binary in binaries:
                    order, took = routed(binary, str(plan))
                    assert sorted(order) == list(range(count)), order
                    longer[binary].append(100 * (length(cost, order) / best[-1] - 1))
                    seconds[binary].append(took)
            told = (f"{np.mean(longer[b]):+.2f} (worst {max(longer[b]):+.2f}), {np.median(seconds[b]):.2f}" for b in binaries)
            print(f"{count} | {np.mean(best):.2f} | " + " | ".join(told), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or ["target/release/stiffarm"])
