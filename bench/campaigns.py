"""What a campaign costs beyond its items: time, memory, disk, and what bounds it.

    python bench/campaigns.py                  # 2,000 items of select and of simulate, about ten minutes
    python bench/campaigns.py --items 200      # a smoke run

Needs the package with its extra: pip install "stiffarm[campaign]" psutil. Prints the tables of
docs/campaigns.md and writes the raw numbers as JSON.

Own time is the time of an item in its worker as the wall clock has it, so on a machine that others
use too it is longer for the item and for what is compared with it. Processor time is that of all
processes of the run together: driver, workers, and Ray's own.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import shutil
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import psutil
import pyarrow.parquet as parquet

from stiffarm.campaign import Campaign

ANCHORS = [[1800, 0, 0], [1600, 600, 0], [1600, -600, 0], [2000, 300, 200], [1500, 0, 400]]
SELECT = {
    "name": "select",
    "task": "select",
    "axes": {
        "cell": ["builtin:comau"],
        "anchor_mm": ANCHORS,
        "postures": [4, 6],
        "index": ["expected_error", "d"],
        "seed": {"first": 1, "last": 100},
    },
    "options": {"rounds": 2},
}
SIMULATE = {
    "name": "simulate",
    "task": "simulate",
    "axes": {
        "cell": ["builtin:comau"],
        "anchor_mm": ANCHORS,
        "load_n": [250, 500],
        "noise_factor": [1.0, 2.0],
        "seed": {"first": 1, "last": 100},
    },
    "options": {"runs": 50_000, "postures_file": "builtin:comau-group1"},
}
#: Items that do nothing: what is left is the engine.
NOTHING = {
    "name": "nothing",
    "task": "campaign_bench_task:nothing",
    "axes": {"seed": {"first": 1, "last": 20_000}},
}
#: Items that wait, so that many workers fit on few cores: what more workers cost the driver.
WAITING = {
    "name": "waiting",
    "task": "campaign_bench_task:waiting",
    "axes": {"seed": {"first": 1, "last": 20_000}},
}
TASK = '''
import time

POSTURES = [[0.01 * j * i for j in range(6)] for i in range(6)]

def nothing(seed):
    figures = {f"figure_{k}": seed * 0.1 + k for k in range(30)}
    return {**figures, "postures_deg": POSTURES}

def waiting(seed):
    time.sleep(0.5)
    return nothing(seed)
'''


class Tree:
    """Processor time and memory of this process and all below it, looked at while they run."""

    def __init__(self) -> None:
        self.cpu: dict[tuple[int, float], tuple[str, float]] = {}
        self.memory: dict[str, float] = {}
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._own = time.process_time()
        self._looking_s = 0.0

    def __enter__(self) -> Tree:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        # Without the looking itself.
        self.driver_s = time.process_time() - self._own - self._looking_s

    def _watch(self) -> None:
        me = psutil.Process()
        while not self._stop.wait(1.0):
            for process in me.children(recursive=True):
                try:
                    kind = kind_of(process.cmdline())
                    times = process.cpu_times()
                    key = (process.pid, process.create_time())
                    self.cpu[key] = (kind, times.user + times.system)
                    used = process.memory_info().rss / 1e6
                    self.memory[kind] = max(self.memory.get(kind, 0.0), used)
                except psutil.Error:
                    continue
            self._looking_s = time.thread_time()

    def seconds(self) -> dict[str, float]:
        """Processor time by kind of process [s]."""
        total: dict[str, float] = {"driver": self.driver_s}
        for kind, seconds in self.cpu.values():
            total[kind] = total.get(kind, 0.0) + seconds
        return {kind: round(seconds, 3) for kind, seconds in sorted(total.items())}


def kind_of(words: list[str]) -> str:
    """What a process is, by its command line."""
    line = " ".join(words)
    return "items" if "multiprocessing.spawn" in line or line.startswith("ray::") else "Ray's own"


def thinned(data: dict[str, Any], items: int) -> dict[str, Any]:
    """The grid with as many seeds as make about so many items."""
    others = 1
    for axis, values in data["axes"].items():
        others *= 1 if axis == "seed" else len(values)
    last = max(1, items // others)
    return {**data, "axes": {**data["axes"], "seed": {"first": 1, "last": last}}}


def measure(data: dict[str, Any], on_ray: bool, workers: int, folder: Path) -> dict[str, Any]:
    """One run: times, memory, sizes."""
    campaign = Campaign.from_dict(data)
    stamps: list[tuple[float, int]] = []
    begun = time.monotonic()
    with Tree() as tree:
        outcome = campaign.run(
            folder,
            workers=workers,
            address="local" if on_ray else None,
            progress=lambda p: stamps.append((time.monotonic(), p.done)),
        )
    wall = time.monotonic() - begun
    timings = parquet.read_table(outcome.timings)
    own = sum(timings["own_s"].to_pylist())
    cpu = sum(timings["cpu_s"].to_pylist())
    # From the first item that was told to the last: without starting and ending the engine.
    (first, before), (last, after) = stamps[0], stamps[-1]
    steady = (last - first) / (after - before) * outcome.done if after > before else wall
    size = outcome.results.stat().st_size
    return {
        "campaign": data["name"],
        "on_ray": on_ray,
        "workers": workers,
        "items": outcome.done,
        "failed": outcome.failed,
        "wall_s": wall,
        "own_s": own,
        "own_cpu_s": cpu,
        "overhead_percent": 100 * (wall * workers / own - 1),
        "overhead_without_start_percent": 100 * (steady * workers / own - 1),
        "start_and_end_s": wall - steady,
        "cpu_s": tree.seconds(),
        "memory_mb": {kind: round(mb, 1) for kind, mb in tree.memory.items()},
        "driver_memory_mb": psutil.Process().memory_info().rss / 1e6,
        "table_bytes": size,
        "journal_bytes": (folder / "journal.jsonl").stat().st_size,
        "sha256": hashlib.sha256(outcome.results.read_bytes()).hexdigest(),
    }


def row(record: dict[str, Any]) -> str:
    """A run as a line of the table."""
    n = record["items"]
    cpu = record["cpu_s"]
    beside = sum(seconds for kind, seconds in cpu.items() if kind != "items")
    # The last look at a process misses what it did after.
    beside += max(0.0, cpu.get("items", 0.0) - record["own_cpu_s"])
    cells = [
        record["campaign"],
        f"{'Ray' if record['on_ray'] else 'here'}, {record['workers']}",
        f"{n}",
        f"{record['own_s'] / n * 1e3:.1f} ms",
        f"{record['own_s']:.1f} s",
        f"{record['wall_s']:.1f} s",
        "–" if record["campaign"] == "nothing" else f"{record['overhead_percent']:.1f} %",
        "–" if record["campaign"] == "nothing" else f"{record['overhead_without_start_percent']:.1f} %",
        f"{beside / n * 1e3:.2f} ms",
    ]
    return "| " + " | ".join(cells) + " |"


HEAD = """\
| campaign | where, workers | items | own time of one | of all | wall | overhead | without start and end | processor time beside the items, each |
|:--|:--|--:|--:|--:|--:|--:|--:|--:|"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--items", type=int, default=2000, help="items of select and of simulate")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--ways", nargs="*", choices=["ray", "here", "one"], default=["ray", "here", "one"])
    parser.add_argument("--only", nargs="*", choices=["select", "simulate", "nothing", "waiting"])
    parser.add_argument("--crowds", nargs="*", type=int, default=[2, 8, 32], help="workers of waiting")
    parser.add_argument("--out", type=Path, default=Path("target/bench-campaigns.json"))
    arguments = parser.parse_args()
    records = []
    with tempfile.TemporaryDirectory() as name:
        base = Path(name)
        (base / "campaign_bench_task.py").write_text(TASK)
        sys.path.insert(0, str(base))
        os.environ["PYTHONPATH"] = os.pathsep.join([str(base), os.environ.get("PYTHONPATH", "")])
        print(HEAD, flush=True)
        for data in (SELECT, SIMULATE, NOTHING):
            if arguments.only and data["name"] not in arguments.only:
                continue
            grid = thinned(data, arguments.items if data is not NOTHING else arguments.items * 10)
            hashes = set()
            ways = {"ray": (True, arguments.workers), "here": (False, arguments.workers), "one": (False, 1)}
            for way in arguments.ways:
                folder = base / f"{data['name']}-{way}"
                records.append(measure(grid, *ways[way], folder))
                hashes.add(records[-1]["sha256"])
                print(row(records[-1]), flush=True)
                shutil.rmtree(folder)
            if len(hashes) != 1:
                print("The tables differ.", file=sys.stderr)
                return 1
        for crowd in arguments.crowds:
            if arguments.only and "waiting" not in arguments.only:
                continue
            # As many items for each worker.
            grid = thinned(WAITING, crowd * 80)
            records.append(measure(grid, False, crowd, base / f"waiting-{crowd}"))
            print(row(records[-1]), flush=True)
    machine = {"cores": os.cpu_count(), "python": platform.python_version(), "system": platform.platform()}
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(json.dumps({"machine": machine, "runs": records}, indent=1) + "\n")
    print(f"\n{arguments.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
