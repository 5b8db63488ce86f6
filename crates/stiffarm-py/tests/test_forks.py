"""Processes that were forked after the library had worked: their parent's threads are not there."""

import multiprocessing
import sys

import pytest

import stiffarm

CELL = stiffarm.Cell.built_in("comau")


def job(seed: int) -> tuple[str, float]:
    plan = stiffarm.select(CELL, space_filling=True, postures=4, seed=1)
    simulated = stiffarm.simulate(CELL, plan, runs=50, levels=[1.0], seed=seed).to_json()
    return simulated, float(stiffarm.indices(CELL, [plan.postures.angles] * 50, ["d"])["d"][7])


@pytest.mark.skipif(sys.platform == "win32", reason="Windows does not fork")
def test_a_forked_process_works_and_gives_the_same() -> None:
    own = [job(seed) for seed in (1, 2, 3)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        # A process that waits for threads that are not there would wait for ever.
        assert pool.map_async(job, [1, 2, 3]).get(timeout=120) == own
