"""Work that runs: progress, Ctrl-C, callbacks, threads, other processes, and a constraint of one's own."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import types
from typing import Any

import numpy as np
import pytest

import stiffarm


@pytest.fixture(scope="module")
def cell() -> stiffarm.Cell:
    return stiffarm.Cell.built_in("comau-reference")


def test_progress(cell: stiffarm.Cell) -> None:
    steps: list[tuple[str, int, int]] = []
    main = threading.get_ident()

    def tell(what: str, done: int, of: int) -> None:
        assert threading.get_ident() == main
        steps.append((what, done, of))

    stiffarm.select(cell, count=6, rounds=60, no_certificate=True, progress=tell)
    assert steps and all(isinstance(what, str) and 0 <= done <= max(of, done) for what, done, of in steps)
    assert [done for _, done, _ in steps] == sorted(done for _, done, _ in steps)


def test_an_exception_of_the_callback_ends_the_work(cell: stiffarm.Cell) -> None:
    class Enough(Exception):
        pass

    def tell(*_: Any) -> None:
        raise Enough

    began = time.monotonic()
    with pytest.raises(Enough):
        stiffarm.select(cell, count=6, rounds=100_000, progress=tell)
    assert time.monotonic() - began < 20

    def wrong(what: str) -> None:
        """Takes too few arguments."""

    with pytest.raises(TypeError, match="positional"):
        stiffarm.select(cell, count=6, rounds=100_000, progress=wrong)


def test_a_bar_of_tqdm(cell: stiffarm.Cell, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    stiffarm.select(cell, count=6, rounds=60, no_certificate=True, progress=True)
    assert "%" in capsys.readouterr().err
    # Without tqdm there is no bar, and no error.
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    stiffarm.simulate(cell, "builtin:comau-group1", runs=5_000, progress=True)


def test_the_interpreter_goes_on(cell: stiffarm.Cell) -> None:
    """Another thread counts on while a search runs."""
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    stiffarm.select(cell, count=6, rounds=100, no_certificate=True)
    took = time.monotonic() - began
    stop.set()
    thread.join()
    assert took > 0.05 and counted > 50 * took, (counted, took)


INTERRUPTED = """
import stiffarm, warnings
cell = stiffarm.Cell.built_in("comau-reference")
steps = []
def tell(what, done, of):
    if not steps:
        print("working", flush=True)
    steps.append(what)
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    plan = stiffarm.select(cell, count=6, rounds=1_000_000, progress=tell)
assert plan.interrupted and len(plan.postures) == 6 and plan.value > 0, plan
assert [w.category for w in caught] == [stiffarm.StiffarmWarning], caught
assert caught[0].filename == "<string>", caught[0].filename
import pickle
assert pickle.loads(pickle.dumps(plan)).interrupted
print("done", plan.value, flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="SIGINT of another process")
def test_control_c_returns_the_best_so_far() -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "working\n"
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0 and out.startswith("done "), err


NOTHING_YET = """
import stiffarm
cell = stiffarm.Cell.built_in("comau-reference")
try:
    stiffarm.coverage(cell, "builtin:comau-group1", runs=1_000_000, progress=lambda *_: print("working", flush=True))
    print("ended", flush=True)
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="SIGINT of another process")
def test_control_c_without_a_result_is_keyboard_interrupt() -> None:
    process = subprocess.Popen([sys.executable, "-c", NOTHING_YET], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "working\n"
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and out.endswith("stopped\n")


def job(task: tuple[stiffarm.Cell, int]) -> tuple[str, float]:
    cell, seed = task
    plan = stiffarm.select(cell, space_filling=True, count=4, seed=1)
    simulated = stiffarm.simulate(cell, plan, runs=50, levels=[1.0], seed=seed).to_json()
    return simulated, float(stiffarm.indices(cell, [plan.postures.angles] * 50, ["d"])["d"][7])


@pytest.fixture(scope="module")
def jobs() -> tuple[list[tuple[stiffarm.Cell, int]], list[tuple[str, float]]]:
    """Jobs, and what they give in this process."""
    tasks = [(stiffarm.Cell.built_in(name), seed) for name, seed in (("comau-shapes", 1), ("comau", 2))]
    return tasks, [job(one) for one in tasks]


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_another_process_works_and_gives_the_same(method: str, jobs: Any) -> None:
    """Also one that was forked after the library had worked: its parent's threads are not there."""
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"{sys.platform} has no {method}")
    tasks, answers = jobs
    with multiprocessing.get_context(method).Pool(2) as pool:
        # A process that waits for threads that are not there would wait for ever.
        assert pool.map_async(job, tasks).get(timeout=120) == answers


def away(q: np.ndarray) -> bool:
    """The wrist turned away from a cabinet, which no limit of a cell can say."""
    return float(np.sin(q[3] + q[5])) > 0.25


def test_every_posture_of_the_plan_is_accepted_as_it_is_written() -> None:
    cell = stiffarm.Cell.built_in("comau")
    shapes = []

    def accept(q: np.ndarray) -> bool:
        shapes.append(q.shape)
        return away(q)

    plan = stiffarm.select(cell, index="expected_error", count=6, rounds=2, no_certificate=True, accept=accept)
    free = stiffarm.select(cell, index="expected_error", count=6, rounds=2, no_certificate=True)
    assert all(away(q) for q in plan.postures.angles)
    assert not all(away(q) for q in free.postures.angles)
    assert plan.value > free.value
    assert shapes and set(shapes) == {(6,)}
    again = stiffarm.select(cell, index="expected_error", count=6, rounds=2, no_certificate=True, accept=away)
    assert again.to_json() == plan.to_json()


def test_what_the_constraint_raises_is_raised_and_ends_the_search() -> None:
    cell = stiffarm.Cell.built_in("comau")

    def accept(q: np.ndarray) -> bool:
        raise LookupError("the planner does not answer")

    with pytest.raises(LookupError, match="does not answer"):
        stiffarm.select(cell, count=4, accept=accept)


def test_a_constraint_that_accepts_nothing_is_named() -> None:
    cell = stiffarm.Cell.built_in("comau")
    with pytest.raises(stiffarm.StiffarmError, match="None of") as error:
        stiffarm.select(cell, count=4, accept=lambda q: False)
    assert error.value.place["key"] == "accept"
    with pytest.raises(stiffarm.StiffarmError, match="not taken beside"):
        stiffarm.select(cell, initial="builtin:comau-group1", accept=away)
