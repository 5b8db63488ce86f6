"""One process of the benchmark: prepares a peer, waits for the start, measures, prints JSON.

Started by peers.py with a job (JSON) as its only argument. Standard output carries two lines,
`{"ready": ...}` and the result; a line on standard input starts the clock, so that setting up,
importing and compiling are not timed and several processes start together. SIGTERM ends a race
early; what was found until then is still printed.
"""

import json
import os
import signal
import sys
import time

job = json.loads(sys.argv[1])
# Before any import of a library that counts cores.
if job.get("cores") and hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, job["cores"])

import numpy as np
from scipy import optimize

from . import search
from .cell import BenchError, check_golden, reference_cell
from .index_numpy import NumpyIndex

# Groups that a rate goes through, so that no branch is learnt by heart.
SAMPLES = 64
# Compilation happens at the first call; a population of 15 groups per unknown is SciPy's default.
POPULATION = 15 * 36


def make_index(kind, cell):
    """The index function of a library, checked against the golden numbers."""
    if kind == "numpy":
        index = NumpyIndex(cell)
    elif kind == "pinocchio":
        from .index_pinocchio import PinocchioIndex

        index = PinocchioIndex(cell)
    else:
        from .index_jax import JaxIndex

        index = JaxIndex(cell)
    return index, check_golden(kind, index.evaluate)


def check_gradient(kind, index, cell):
    """Holds gradients and batches against central differences of the same function."""
    x = cell.random_group(np.random.default_rng(1))
    step = 1e-5
    moves = step * np.eye(len(x))
    central = np.array([index.value(x + m) - index.value(x - m) for m in moves]) / (2 * step)
    gradients = {}
    if kind == "numpy":
        gradients["batched differences"] = index.value_and_differences(x)[1]
    if kind == "jax":
        gradients["gradient"] = index.value_and_gradient(x)[1]
        gradients["batched gradient"] = index.values_and_gradients(np.stack([x, x]))[1][1]
        jacobian = index.components(x)
        worst = int(np.argmax(jacobian[0][1:]))
        gradients["Jacobian of the components"] = jacobian[1][0] + jacobian[1][1 + worst]
    for what, gradient in gradients.items():
        off = float(np.max(np.abs(gradient - central)) / np.max(np.abs(central)))
        # Forward differences with their step of 1e-7 set the tolerance.
        if not off < 1e-4:
            raise BenchError(
                f"{kind}: the {what} differs from central differences by {off:.1e} of its "
                "largest entry; nothing was timed."
            )


def rate(call, seconds, per_call=1):
    """Evaluations per second over a window; at least three calls."""
    calls, start = 0, time.perf_counter()
    while True:
        call(calls)
        calls += 1
        elapsed = time.perf_counter() - start
        if elapsed >= seconds and calls >= 3:
            return calls * per_call / elapsed


def rates(kind, cell, seconds, sizes):
    """Prepares the rate measurements of a library; returns what runs them."""
    index, _ = make_index(kind, cell)
    generator = np.random.default_rng(0)
    groups = [cell.random_group(generator) for _ in range(SAMPLES)]
    at = lambda i: groups[i % SAMPLES]
    calls = {("value", 1): lambda i: index.value(at(i))}
    if kind == "jax":
        calls["value+gradient", 1] = lambda i: index.value_and_gradient(at(i))
        for size in sizes:
            batch = np.stack([cell.random_group(generator) for _ in range(size)])
            calls["values, batched", size] = lambda i, b=batch: index.values(b)
            calls["values+gradients, batched", size] = lambda i, b=batch: (
                index.values_and_gradients(b)
            )
    else:
        # 37 evaluations: the value and 36 forward differences, as SciPy's optimisers take them.
        calls["value+gradient", 1] = lambda i: optimize.approx_fprime(
            at(i), index.value, search.STEP
        )
    if kind == "numpy":
        calls["value+gradient, batched differences", 1] = lambda i: index.value_and_differences(
            at(i), search.STEP
        )
        batch = np.stack([cell.random_group(generator) for _ in range(POPULATION)])
        calls["values, batched", POPULATION] = lambda i: index.values(batch)
    for call in calls.values():
        call(0)  # compile

    def measure():
        return {
            "rates": [
                {"what": what, "batch": size, "per_second": rate(call, seconds, size)}
                for (what, size), call in calls.items()
            ]
        }

    return measure


def fastest(candidates):
    """Name and function of the fastest of several functions, given as (function, argument)."""
    seconds = {}
    for name, (function, argument) in candidates.items():
        function(argument)
        seconds[name] = 1 / rate(lambda i: function(argument), 0.2)
    name = min(seconds, key=seconds.get)
    return name, candidates[name][0]


def race(peer, cell, seed, process):
    """Prepares a race, compiling what it needs; returns a function of the recorder that runs
    until the time is up, and remarks."""
    # Each process of a race has its own stream of random groups.
    generator = np.random.default_rng([seed, process])
    x = cell.random_group(np.random.default_rng(0))
    library = peer.split("-")[0]
    index, _ = make_index(library if library in ("numpy", "pinocchio") else "jax", cell)
    remarks = {}

    def compiled(function, *more):
        function(x, *more)
        return function

    if peer in ("numpy-slsqp", "pinocchio-slsqp"):
        run, functions = search.slsqp_differences, [index.value]
    elif peer == "numpy-slsqp-batched":
        run, functions = (
            search.slsqp_batched_differences,
            [index.value, index.value_and_differences],
        )
    elif peer == "jax-lbfgsb":
        run, functions = search.lbfgsb, [compiled(index.value_and_gradient)]
    elif peer == "jax-lbfgsb-smoothed":
        run, functions = search.lbfgsb_smoothed, [compiled(index.smoothed, 10.0)]
    elif peer == "jax-slsqp-epigraph":
        run, functions = search.epigraph, [compiled(index.components)]
    elif peer == "differential-evolution":
        population = np.stack([cell.random_group(generator) for _ in range(POPULATION)])
        name, values = fastest(
            {"JAX": (index.values, population), "NumPy": (NumpyIndex(cell).values, population)}
        )
        remarks["objective"] = name
        run, functions = search.differential_evolution, [values, compiled(index.smoothed, 10.0)]
    elif peer == "dual-annealing":
        name, value = fastest({"JAX": (index.value, x), "NumPy": (NumpyIndex(cell).value, x)})
        remarks["objective"] = name
        run, functions = search.dual_annealing, [value, compiled(index.value_and_gradient)]
    else:
        raise BenchError(f"There is no peer {peer!r}.")
    return lambda recorder: run(cell, recorder, generator, *functions), remarks


def say(value):
    """One line of the protocol."""
    print(json.dumps(value), flush=True)


def wait_for_start():
    """Waits for the parent's line; gives up when the parent is gone."""
    if not sys.stdin.readline():
        sys.exit(0)
    return time.monotonic()


def main():
    """Does the job."""
    began = time.monotonic()
    cell = reference_cell()
    if job["task"] == "check":
        index, difference = make_index(job["peer"], cell)
        check_gradient(job["peer"], index, cell)
        say({"ready": True})
        wait_for_start()
        return say({"largest_relative_difference": difference})
    if job["task"] == "rates":
        measure = rates(job["peer"], cell, job["seconds"], job["sizes"])
        say({"ready": True})
        wait_for_start()
        return say(measure())
    run, remarks = race(job["peer"], cell, job["seed"], job["process"])
    say({"ready": True})
    setup = time.monotonic() - began
    # Numerical warnings of a search that strays near a singularity say nothing new.
    np.seterr(all="ignore")
    recorder = search.Recorder(cell, wait_for_start(), job["seconds"])

    def stop(*_):
        recorder.interrupted = True

    signal.signal(signal.SIGTERM, stop)
    try:
        run(recorder)
    except search.TimeUp:
        pass
    return say({**recorder.result(), **remarks, "setup_seconds": setup})


if __name__ == "__main__":
    try:
        main()
    except BenchError as error:
        say({"error": str(error)})
        sys.exit(1)
