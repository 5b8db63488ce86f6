#!/usr/bin/env python3
"""How fast the paper's novel index is minimised by stiffarm, and by what one would take instead.

    python3 bench/peers.py            # the whole record, about 25 minutes
    python3 bench/peers.py --quick    # a smoke run of a few seconds per peer

Sets up its own virtual environment in target/bench-venv, checks every peer against the golden
numbers of the reference cell, runs stiffarm's example `race` and the peers on the same cores, and
writes a table, the raw numbers and a figure to bench/runs. bench/README.md says what is measured.
"""

import argparse
import datetime
import hashlib
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent
ROOT = BENCH.parent
ENVIRONMENT = ROOT / "target" / "bench-venv"
REQUIREMENTS = BENCH / "requirements.txt"

# Larger ones leave the cache and are slower.
BATCHES = [8, 32, 128, 512]


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seconds", type=float, help="budget of each race (default: 100)")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="smoke run: 4 s per race, results in target/bench-quick",
    )
    parser.add_argument("--cores", type=int, help="number of cores (default: all)")
    parser.add_argument(
        "--seed",
        type=int,
        nargs="+",
        default=[1],
        metavar="K",
        help="seed of the random groups; several seeds repeat every race (default: 1)",
    )
    parser.add_argument(
        "--peers", nargs="+", metavar="NAME", help="race only these peers (default: all)"
    )
    parser.add_argument(
        "--stiffarm-json",
        type=Path,
        metavar="FILE",
        help="take stiffarm's side from this file instead of running its example",
    )
    parser.add_argument("--no-stiffarm", action="store_true", help="leave stiffarm's side out")
    parser.add_argument("--host-kind", help="name of the machine in the record's file name")
    parser.add_argument("--out", type=Path, help="folder of the record (default: bench/runs)")
    options = parser.parse_args()
    if options.seconds is None:
        options.seconds = 4.0 if options.quick else 100.0
    if not 0 < options.seconds < 1e6:
        parser.error("--seconds must be a positive number of seconds")
    if options.cores is not None and options.cores < 1:
        parser.error("--cores must be at least 1")
    if options.out is None:
        options.out = ROOT / "target/bench-quick" if options.quick else BENCH / "runs"
    return options


def fail(text):
    """Ends with a sentence and the exit status of bad input or setup."""
    print(f"error: {text}", file=sys.stderr)
    sys.exit(2)


def inside_environment(script=__file__):
    """True in the virtual environment with the pinned packages; makes it where it is missing."""
    python = ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp = ENVIRONMENT / "requirements.sha256"
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()
    if not (python.exists() and stamp.exists() and stamp.read_text() == wanted):
        print("Setting up target/bench-venv ...", flush=True)
        install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        for command, trouble in (
            (
                [sys.executable, "-m", "venv", ENVIRONMENT],
                "Python's venv module failed; install it (Debian and Ubuntu: python3-venv)",
            ),
            (
                [python, *install, "-r", REQUIREMENTS],
                "pip could not install bench/requirements.txt; it needs access to PyPI and "
                "Python 3.11 to 3.13 on Linux or macOS",
            ),
        ):
            if subprocess.run(command, check=False).returncode != 0:
                fail(f"{trouble}.")
        stamp.write_text(wanted)
    if Path(sys.prefix).resolve() == ENVIRONMENT.resolve():
        return True
    command = [str(python), str(Path(script).resolve()), *sys.argv[1:]]
    if os.name == "nt":
        sys.exit(subprocess.run(command, check=False).returncode)
    os.execv(command[0], command)


def use_cores(wanted):
    """Restricts this process, and so all it starts, to the first `wanted` cores; returns them."""
    if not hasattr(os, "sched_setaffinity"):
        count = os.cpu_count() or 1
        if wanted not in (None, count):
            print(f"warning: this system cannot restrict a process to {wanted} cores.", flush=True)
        return list(range(min(wanted or count, count)))
    available = sorted(os.sched_getaffinity(0))
    if wanted and wanted > len(available):
        fail(f"--cores {wanted}: only {len(available)} are available.")
    cores = available[: wanted or len(available)]
    os.sched_setaffinity(0, cores)
    return cores


def portable(argument):
    """A command-line argument without this machine's folders."""
    path = Path(argument)
    if not path.is_absolute():
        return argument
    return str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else path.name


def one_entry_a_line(record):
    """JSON with a line per entry of the lists, so that differences of two records can be read."""
    lines = []
    for key, value in record.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            entries = ",\n  ".join(json.dumps(entry) for entry in value)
            lines.append(f"{json.dumps(key)}: [\n  {entries}\n ]")
        else:
            lines.append(f"{json.dumps(key)}: {json.dumps(value)}")
    return "{\n " + ",\n ".join(lines) + "\n}\n"


class Benchmark:
    """The record as it grows; `record` is what the JSON file holds."""

    def __init__(self, options, cores):
        from peer import machine

        self.options, self.cores = options, cores
        self.record = {
            "command": shlex.join(["python3", "bench/peers.py", *map(portable, sys.argv[1:])]),
            "started": datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
            "machine": machine.describe(cores),
            "versions": machine.versions(),
            "seconds": options.seconds,
            "seeds": options.seed,
            "checks": {},
            "stiffarm": [],
            "rates": [],
            "races": [],
            "problems": [],
        }

    def problem(self, text):
        """Says and notes what did not work."""
        print(f"warning: {text}", flush=True)
        self.record["problems"].append(text)

    def check(self):
        """Every library against the golden numbers; raises before anything is timed."""
        from peer.processes import run_workers

        for library in ("numpy", "pinocchio", "jax"):
            print(f"checking {library} against the golden numbers", flush=True)
            job = {"task": "check", "peer": library, "cores": self.cores[:1]}
            self.record["checks"][library] = run_workers([job], 0)[0]["largest_relative_difference"]

    def stiffarm(self):
        """stiffarm's own side, once per seed."""
        from peer.cell import BenchError
        from peer.processes import check_stiffarm, run_stiffarm
        from peer.verify import recompute

        options = self.options
        if options.no_stiffarm:
            return
        for seed in options.seed:
            print(f"stiffarm, seed {seed}", flush=True)
            try:
                if options.stiffarm_json:
                    data = check_stiffarm(json.loads(options.stiffarm_json.read_text()))
                    self.problem("stiffarm's side was read from a file, it was not run here.")
                else:
                    data = run_stiffarm(options.seconds, seed, len(self.cores))
                data = {"seed": seed, **data}
                self.record["stiffarm"].append(data)
                if data.get("best_group_deg") and data["trace"]:
                    claimed = data["trace"][-1]["value"]
                    data["recomputed"], trouble = recompute(data["best_group_deg"], claimed)
                    if trouble:
                        self.problem(f"stiffarm, seed {seed}: {trouble}")
            except (BenchError, OSError, ValueError) as error:
                self.problem(f"stiffarm's side is missing: {error}")
                return

    def rates(self):
        """Evaluations per second of each library: one core, all cores."""
        from peer.cell import BenchError
        from peer.processes import run_workers

        window = min(3.0, max(0.2, self.options.seconds / 20))
        sizes = [32, 512] if self.options.quick else BATCHES
        count = len(self.cores)
        ways = [("1 process, 1 core", [self.cores[:1]])]
        if count > 1:
            each = [[core] for core in self.cores]
            ways.append((f"{count} processes, {count} cores", each))
            ways.append((f"1 process, {count} cores", [self.cores]))
        for library in ("numpy", "pinocchio", "jax"):
            for way, groups in ways:
                if count > 1 and groups == [self.cores] and library != "jax":
                    continue  # only XLA spreads one call over cores
                print(f"rates of {library}, {way}", flush=True)
                jobs = [
                    {
                        "task": "rates",
                        "peer": library,
                        "seconds": window,
                        "sizes": sizes,
                        "cores": c,
                    }
                    for c in groups
                ]
                try:
                    results = run_workers(jobs, window * (2 + 2 * len(sizes)))
                except BenchError as error:
                    self.problem(f"Rates of {library}, {way}: {error}")
                    continue
                for entries in zip(*(r["rates"] for r in results), strict=True):
                    self.record["rates"].append(
                        {
                            "library": library,
                            "what": entries[0]["what"],
                            "batch": entries[0]["batch"],
                            "way": way,
                            "processes": len(groups),
                            "cores": sum(len(c) for c in groups),
                            "per_second": sum(e["per_second"] for e in entries),
                        }
                    )

    def races(self):
        """Best index against time of each peer, one process per core, once per seed."""
        from peer.cell import BenchError
        from peer.names import PEERS
        from peer.processes import Interrupted, run_workers

        for seed in self.options.seed:
            for peer in self.options.peers or PEERS:
                print(f"race of {peer}, seed {seed}, {self.options.seconds:g} s", flush=True)
                jobs = [
                    {
                        "task": "race",
                        "peer": peer,
                        "seconds": self.options.seconds,
                        "seed": seed,
                        "process": i,
                        "cores": [core],
                    }
                    for i, core in enumerate(self.cores)
                ]
                try:
                    self.add_race(peer, seed, run_workers(jobs, self.options.seconds))
                except Interrupted as interrupted:
                    if interrupted.results:
                        self.add_race(peer, seed, interrupted.results, interrupted=True)
                    raise
                except BenchError as error:
                    self.problem(f"Race of {peer}, seed {seed}: {error}")

    def add_race(self, peer, seed, results, interrupted=False):
        """Merges the processes of a race, and recomputes its best index independently."""
        from peer.verify import merged_trace, recompute

        trace = merged_trace([r["trace"] for r in results])
        found = [r for r in results if r["best"] is not None]
        entry = {
            "peer": peer,
            "seed": seed,
            "processes": len(results),
            "seconds": max(r["seconds"] for r in results),
            "setup_seconds": max(r["setup_seconds"] for r in results),
            "values": sum(r["values"] for r in results),
            "gradients": sum(r["gradients"] for r in results),
            "starts": sum(r["starts"] for r in results),
            "objective": results[0].get("objective"),
            "trace": trace,
            "interrupted": interrupted,
        }
        if found:
            best = min(found, key=lambda r: r["best"])
            entry["best"], entry["best_group_deg"] = best["best"], best["best_group_deg"]
            entry["recomputed"], trouble = recompute(best["best_group_deg"], best["best"])
            if trouble:
                self.problem(f"Race of {peer}, seed {seed}: {trouble}")
            print(f"  best {best['best']:.4g} after {trace[-1]['seconds']:.1f} s", flush=True)
        else:
            self.problem(f"Race of {peer}, seed {seed}: no group with an index was found.")
        self.record["races"].append(entry)

    def write(self):
        """Table, raw numbers and figure."""
        from peer import figure, report

        folder = self.options.out
        folder.mkdir(parents=True, exist_ok=True)
        kind = self.options.host_kind or self.record["machine"]["kind"]
        stem = f"{self.record['started'][:10]}-{kind}"
        (folder / f"{stem}.json").write_text(one_entry_a_line(self.record), encoding="utf-8")
        drawn = figure.draw(self.record, folder / f"{stem}.svg")
        text = report.markdown(self.record, f"{stem}.svg" if drawn else None, f"{stem}.json")
        (folder / f"{stem}.md").write_text(text, encoding="utf-8")
        shown = folder / f"{stem}.md"
        print(f"\nwrote {shown.relative_to(ROOT) if shown.is_relative_to(ROOT) else shown}")


def main():
    """Runs it all; exit status 0 done, 1 a part is missing, 2 bad setup, 130 interrupted."""
    options = arguments()
    if sys.version_info < (3, 11):
        fail("Python 3.11 or newer is needed, this is " + sys.version.split()[0] + ".")
    inside_environment()
    cores = use_cores(options.cores)
    from peer.cell import BenchError
    from peer.names import PEERS
    from peer.processes import Interrupted

    unknown = [p for p in options.peers or [] if p not in PEERS]
    if unknown:
        fail(f"no peer {', '.join(unknown)}; there are {', '.join(PEERS)}.")
    benchmark = Benchmark(options, cores)
    status = 0
    try:
        benchmark.check()
        for step in (benchmark.stiffarm, benchmark.rates, benchmark.races):
            step()
    except BenchError as error:
        fail(error)
    except (KeyboardInterrupt, Interrupted):
        benchmark.problem("The run was interrupted; what it had is kept.")
        status = 130
    record = benchmark.record
    if record["stiffarm"] or record["rates"] or record["races"]:
        benchmark.write()
    return status or (1 if record["problems"] else 0)


if __name__ == "__main__":
    sys.exit(main())
