"""What the tests of campaigns share."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
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
