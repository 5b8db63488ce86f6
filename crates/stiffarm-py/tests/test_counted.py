"""The plugin that `cargo xtask test` counts these tests with (`xtask/python/counted.py`)."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

PLUGIN = Path(__file__).resolve().parents[3] / "xtask" / "python"

SAMPLE = '''
import pytest

def test_right(): print("no end of line", end="")
def test_wrong(): assert 1 == 2, "one is\\ntwo"
def test_raises(): raise ValueError("a: b")
@pytest.fixture
def broken(): raise RuntimeError("no fixture")
def test_without_fixture(broken): pass
@pytest.mark.xfail
def test_expected(): assert False
@pytest.mark.xfail(strict=True)
def test_unexpected(): pass
@pytest.mark.skip(reason="no data")
def test_left_out(): pass
@pytest.mark.parametrize("n", [1, 2])
def test_each(n): pass
'''

EXPECTED = """\
FAILED test_broken.py: E ModuleNotFoundError: No module named 'no_such_module'
SKIPPED test_whole.py: could not import 'no_such_module': No module named 'no_such_module'
ok test_sample.py::test_right
FAILED test_sample.py::test_wrong: AssertionError: one is
FAILED test_sample.py::test_raises: ValueError: a: b
FAILED test_sample.py::test_without_fixture (setup): RuntimeError: no fixture
ok test_sample.py::test_expected
FAILED test_sample.py::test_unexpected: [XPASS(strict)]
SKIPPED test_sample.py::test_left_out: no data
ok test_sample.py::test_each[1]
ok test_sample.py::test_each[2]
pytest: 4 passed, 5 failed, 2 skipped
"""


def test_every_test_is_one_line_and_the_last_counts_them(tmp_path: Path) -> None:
    (tmp_path / "test_sample.py").write_text(SAMPLE, encoding="utf-8")
    (tmp_path / "test_broken.py").write_text("import no_such_module\n", encoding="utf-8")
    (tmp_path / "test_whole.py").write_text("import pytest\npytest.importorskip('no_such_module')\n", encoding="utf-8")
    words = ["-p", "counted", "-p", "no:cacheprovider", "--quiet", "-rN", "-o", "console_output_style=classic"]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *words, "--continue-on-collection-errors"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(PLUGIN), "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    )
    marks = ("ok ", "FAILED ", "SKIPPED ", "pytest: ")
    lines = [line for line in run.stdout.splitlines() if line.startswith(marks)]
    assert sorted(lines[:2]) == EXPECTED.splitlines()[:2]
    assert lines[2:] == EXPECTED.splitlines()[2:], run.stdout
