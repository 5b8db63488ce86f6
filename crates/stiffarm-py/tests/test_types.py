"""The package's types, read by mypy, its stubtest and basedpyright."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import stiffarm

ROOT = Path(__file__).parents[1]


def run(words: list[str]) -> None:
    """Runs a checker on the package that tests import."""
    package = Path(stiffarm.__file__).parents[1]
    environment = {**os.environ, "PYTHONPATH": str(package), "MYPYPATH": ""}
    done = subprocess.run(
        words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout


def test_mypy() -> None:
    pytest.importorskip("mypy", reason="mypy is not installed")
    pytest.importorskip("matplotlib", reason="stiffarm.plot is checked with matplotlib installed")
    run([sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", "-p", "stiffarm"])


def test_stubs_agree_with_the_module() -> None:
    pytest.importorskip("mypy", reason="mypy is not installed")
    pytest.importorskip("matplotlib", reason="stiffarm.plot is checked with matplotlib installed")
    words = ["--mypy-config-file", "pyproject.toml", "--allowlist", "stubtest.txt"]
    run([sys.executable, "-m", "mypy.stubtest", "stiffarm", *words])


def test_basedpyright() -> None:
    beside = Path(sys.executable).with_name("basedpyright")
    program = str(beside) if beside.exists() else shutil.which("basedpyright")
    if program is None:
        pytest.skip("basedpyright is not installed")
    run([program, "--pythonpath", sys.executable])
