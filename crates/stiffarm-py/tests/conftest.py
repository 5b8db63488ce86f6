"""What several tests use: the command of the same state, and grids and workers of campaigns.

One file for all folders: pytest reads the package's doctests in the same run, and two modules of one name are one too many.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

Command = Callable[[Sequence[str]], "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def command() -> Command:
    """Runs the command ``stiffarm`` that ``STIFFARM_COMMAND`` names."""
    named = os.environ.get("STIFFARM_COMMAND")
    if not named:
        pytest.skip("STIFFARM_COMMAND does not name the command stiffarm of the same state")
    program_path = shutil.which(named)
    assert program_path, f"STIFFARM_COMMAND names {named}, which is no program"
    program = str(Path(program_path).resolve())

    def run(words: Sequence[str]) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", timeout=300
        )

    return run


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves what takes long to the night, whose ``STIFFARM_TEST_RUNS`` is above 1 as in Rust's tests."""
    if float(os.environ.get("STIFFARM_TEST_RUNS", "1")) > 1:
        return
    left = [item for item in items if item.get_closest_marker("every_night")]
    config.hook.pytest_deselected(items=left)
    items[:] = [item for item in items if item not in left]


# Matrices of a few rows are not worth threads of numpy and scipy, which wait by spinning: an optimiser of scipy takes
# several times the processor time with them. Read when numpy is loaded, here and in the processes of the tests.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# What the tests of campaigns share.
HERE = Path(__file__).parent / "campaign"
sys.path.insert(0, str(HERE))
# Workers import the tasks of the tests, wherever they run.
os.environ["PYTHONPATH"] = os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])


@pytest.fixture
def grid() -> dict[str, Any]:
    """A campaign of 24 quick items."""
    return {
        "name": "quick",
        "task": "campaign_tasks:smooth",
        "axes": {
            "n": [3, 4, 6],
            "index": ["novel", "expected_error"],
            "seed": {"first": 1, "last": 4},
        },
        "options": {"scale": 2.0},
    }


@pytest.fixture(scope="session")
def wild(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a campaign whose items go wrong in every way, run by two workers."""
    from campaign_helpers import LIMIT_S, WILD

    from stiffarm.campaign import Campaign

    folder = tmp_path_factory.mktemp("wild")
    outcome = Campaign.from_dict(WILD).run(folder, workers=2, progress=False, time_limit_s=LIMIT_S)
    assert (outcome.done, outcome.failed) == (14, 12)
    return folder


@pytest.fixture(scope="session")
def ray_here() -> Any:
    """Ray on this machine with two processors, for all tests that may share it."""
    ray = pytest.importorskip("ray", reason="Ray is not installed")
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    ray.init(
        address="local",
        num_cpus=2,
        include_dashboard=False,
        log_to_driver=False,
        logging_level="ERROR",
        object_store_memory=100_000_000,
    )
    yield ray
    ray.shutdown()
