"""Starting, timing and stopping the processes of the benchmark."""

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

from .cell import ROOT, BenchError

BENCH = Path(__file__).resolve().parents[1]
# One thread per process where a process has one core: idle BLAS threads only get in the way.
ONE_THREAD = {
    name: "1"
    for name in (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    )
}
# Importing and compiling on a slow machine.
SETUP_SECONDS = 300
# What a measurement may take beyond twice its time.
GRACE_SECONDS = 60


class Interrupted(Exception):
    """Ctrl-C; `results` holds what the stopped processes had found."""

    def __init__(self, results=()):
        super().__init__("interrupted")
        self.results = list(results)


def run_workers(jobs, seconds):
    """Runs one worker per job side by side from a common start; returns their results.

    `seconds` is how long the measurement itself takes. A failing worker raises BenchError with
    its message, Ctrl-C raises Interrupted with the results so far.
    """
    workers = []
    try:
        for job in jobs:
            environment = {**os.environ, "JAX_PLATFORMS": "cpu"}
            if len(job.get("cores") or []) == 1:
                environment.update(ONE_THREAD)
            workers.append(
                subprocess.Popen(
                    [sys.executable, "-m", "peer.worker", json.dumps(job)],
                    cwd=BENCH,
                    env=environment,
                    text=True,
                    start_new_session=True,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                )
            )
        started = False
        try:
            for worker in workers:
                # XLA has been seen to hang for good in its own threads.
                if not select.select([worker.stdout], [], [], SETUP_SECONDS)[0]:
                    raise BenchError(
                        f"A worker was not ready within {SETUP_SECONDS} s; it was ended."
                    )
                answer_of(worker, worker.stdout.readline())
            started = True
            for worker in workers:
                with contextlib.suppress(BrokenPipeError):
                    # One that has died meanwhile is reported below.
                    worker.stdin.write("go\n")
                    worker.stdin.flush()
            return [collect(worker, 2 * seconds + GRACE_SECONDS) for worker in workers]
        except KeyboardInterrupt:
            if not started:
                raise Interrupted from None
            for worker in workers:
                worker.send_signal(signal.SIGTERM)
            results = []
            for worker in workers:
                try:
                    results.append(collect(worker, 10))
                except BenchError:
                    # A rate measurement has nothing to show for half its time.
                    continue
            raise Interrupted(results) from None
    finally:
        for worker in workers:
            if worker.poll() is None:
                worker.kill()
            worker.communicate()


def collect(worker, timeout):
    """The result of a worker that has been started."""
    try:
        output, errors = worker.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        worker.kill()
        raise BenchError(f"A worker gave no result within {timeout:.0f} s; it was ended.") from None
    worker.error_text = errors
    return answer_of(worker, output)


def answer_of(worker, line):
    """A worker's line as a value; its error as BenchError."""
    line = line.strip()
    if line:
        answer = json.loads(line)
        if "error" in answer:
            raise BenchError(answer["error"])
        return answer
    errors = getattr(worker, "error_text", None)
    if errors is None:
        worker.kill()
        errors = worker.communicate()[1]
    last = errors.strip().splitlines()[-1:] or ["no message"]
    raise BenchError(f"A worker failed: {without_paths(last[0])}")


def without_paths(text):
    """The text without this machine's folders."""
    return text.replace(str(ROOT), ".").replace(str(Path.home()), "~")


def run_stiffarm(seconds, seed, threads):
    """The JSON object of stiffarm's own race example."""
    cargo = ["cargo", "build", "--release", "--locked", "-p", "stiffarm", "--example", "race"]
    try:
        # Built beforehand, so that no compiler runs beside the measurement.
        built = subprocess.run(cargo, cwd=ROOT, capture_output=True, text=True, check=False)
    except OSError:
        raise BenchError(
            "cargo was not found; install Rust (rust-version in Cargo.toml) or pass --no-stiffarm."
        ) from None
    if built.returncode != 0:
        raise BenchError(f"`{' '.join(cargo)}` failed: {first_error(built.stderr)}")
    command = ["cargo", "run", *cargo[2:], "--"]
    command += ["--seconds", f"{seconds:g}", "--seed", str(seed), "--threads", str(threads)]
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        text=True,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    began = time.monotonic()
    try:
        # Rates and the cost against n come on top of the race.
        output, errors = process.communicate(timeout=3 * seconds + SETUP_SECONDS)
    except (KeyboardInterrupt, subprocess.TimeoutExpired) as cause:
        stop_session(process)
        if isinstance(cause, KeyboardInterrupt):
            raise Interrupted from None
        raise BenchError(
            f"`{' '.join(command)}` gave no result in {time.monotonic() - began:.0f} s; "
            "it was ended."
        ) from None
    if process.returncode != 0:
        raise BenchError(
            f"`{' '.join(command)}` ended with status {process.returncode}: {first_error(errors)}"
        )
    try:
        return check_stiffarm(json.loads(output))
    except ValueError:
        raise BenchError(f"`{' '.join(command)}` did not print one JSON object.") from None


def stop_session(process):
    """Ends cargo together with the example that it started."""
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGTERM)
    else:
        process.terminate()
    try:
        process.communicate(timeout=10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()


def check_stiffarm(data):
    """Refuses a JSON object of stiffarm that lacks what the report needs."""
    try:
        float(data["threads"]), str(data["version"])
        for entry in data["rates"]:
            str(entry["what"]), int(entry["threads"]), float(entry["per_second"])
        for entry in data["trace"]:
            float(entry["seconds"]), float(entry["value"])
    except (KeyError, TypeError, ValueError) as error:
        raise BenchError(
            f"stiffarm's JSON has no usable {error}; it needs version, threads, "
            "rates [what, threads, per_second] and trace [seconds, evaluations, value]."
        ) from None
    return data


def first_error(text):
    """The first line of a compiler's output that says error, or its last line."""
    lines = [line for line in text.strip().splitlines() if line.strip()] or ["no message"]
    errors = [line for line in lines if line.lstrip().startswith("error")]
    return without_paths((errors or lines[-1:])[0].strip())
