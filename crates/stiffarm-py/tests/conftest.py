"""What several tests use: the command of the same state, and files of a day's work."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

Command = Callable[[Sequence[str]], "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def command() -> Command:
    """Runs the command ``stiffarm`` that ``STIFFARM_COMMAND`` names."""
    named = os.environ.get("STIFFARM_COMMAND")
    if not named:
        pytest.skip("STIFFARM_COMMAND does not name the command stiffarm of the same state")
    found = shutil.which(named)
    assert found, f"STIFFARM_COMMAND names {named}, which is no program"
    program = str(Path(found).resolve())

    def run(words: Sequence[str]) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", timeout=300
        )

    return run
