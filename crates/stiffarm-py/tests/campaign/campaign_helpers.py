"""Running the command as people do, and looking at what it left."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet
import pytest

from stiffarm.campaign import Campaign

HERE = Path(__file__).parent

needs_ray = pytest.mark.skipif(
    importlib.util.find_spec("ray") is None,
    reason="Ray is not installed",
)
#: Starts a Ray of its own or waits for one that was killed: a minute of processor time in all.
every_night = pytest.mark.every_night
needs_library = pytest.mark.skipif(
    importlib.util.find_spec("stiffarm._stiffarm") is None,
    reason="the compiled library is not installed",
)

#: Every way in which an item can go wrong, and two in which it does not.
WAYS = ["raises", "refuses", "exits", "dies", "hangs", "swallows", "asks", "prints", "no_dict",
        "takes_a_column", "an_object", "not_a_number", "infinite", "fine"]  # fmt: skip
WILD = {"name": "wild", "task": "campaign_tasks:wild", "axes": {"way": WAYS, "seed": [2]}}
LIMIT_S = 1.0


def rows(folder: Path) -> list[dict[str, Any]]:
    """Rows of the table of results."""
    return parquet.read_table(folder / "results.parquet").to_pylist()  # type: ignore[no-any-return]


def sha(folder: Path) -> str:
    """Hash of the table of results."""
    return hashlib.sha256((folder / "results.parquet").read_bytes()).hexdigest()


def toml(path: Path, data: dict[str, Any]) -> Path:
    """Writes a declaration of plain lists, numbers and names as TOML."""
    lines = []
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    lines += [f"{key} = {json.dumps(value)}" for key, value in data.items() if key not in tables]
    for table, values in tables.items():
        lines.append(f"[{table}]")
        for key, value in values.items():
            if isinstance(value, dict):
                inner = ", ".join(f"{k} = {json.dumps(v)}" for k, v in value.items())
                lines.append(f"{key} = {{ {inner} }}")
            else:
                lines.append(f"{key} = {json.dumps(value)}")
    path.write_text("\n".join(lines) + "\n")
    return path


def slow(path: Path, count: int, time_s: float, begun: Path | str = "") -> Path:
    """A campaign of items that take their time, as a file; in ``begun`` they leave lines."""
    data = {
        "name": "slow",
        "task": "campaign_tasks:slow",
        "axes": {"seed": {"first": 1, "last": count}},
        "options": {"time_s": time_s, "begun": str(begun)},
    }
    return toml(path, data)


def serially(campaign: Path, folder: Path) -> str:
    """Hash of the table of an undisturbed run with one worker, which need not take its time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CAMPAIGN_TEST_HURRY", "1")
        Campaign.read(campaign).run(folder, progress=False)
    return sha(folder)


def command(*arguments: object) -> subprocess.Popen[str]:
    """Starts the command."""
    return _start(["-m", "stiffarm.campaign", *map(str, arguments)])


def cluster_driver(campaign: Path, *folders: Path) -> tuple[str, str]:
    """Output and error output of runs on a cluster of as many nodes, of which one goes in each."""
    driver = _start([str(HERE / "campaign_cluster_driver.py"), str(campaign), *map(str, folders)])
    try:
        return driver.communicate(timeout=180)
    finally:
        # It has a session of its own.
        with contextlib.suppress(OSError):
            os.killpg(driver.pid, signal.SIGKILL)


def _start(arguments: list[str]) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Ctrl-C in these tests is for the command alone, and it hears it where the tests do not.
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def finish(*arguments: object) -> tuple[int, str, str]:
    """Runs the command: exit code, standard output, standard error."""
    process = command(*arguments)
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


def wait_until(what: Callable[[], bool], limit_s: float = 60.0) -> None:
    """Waits for something to become true."""
    end = time.monotonic() + limit_s
    while not what():
        assert time.monotonic() < end, "it never happened"
        time.sleep(0.01)


def lines(path: Path) -> int:
    """Whole lines of a file, 0 where there is none."""
    return path.read_bytes().count(b"\n") if path.exists() else 0


def journal_numbers(folder: Path) -> list[int]:
    """Numbers of the items in a journal, as they were written."""
    text = (folder / "journal.jsonl").read_bytes()
    return [json.loads(line)["number"] for line in text.splitlines(keepends=True) if line.endswith(b"\n")]


def alive(pid: int) -> bool:
    """Whether a process is there and no zombie."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False


def begun_items(path: Path) -> Iterator[tuple[int, int]]:
    """Seed and process of each time an item was begun."""
    for line in path.read_text().splitlines():
        seed, pid = map(int, line.split())
        yield seed, pid


def kill(pid: int) -> None:
    """SIGKILL."""
    os.kill(pid, signal.SIGKILL)
