"""One worker process and its limits: time and memory of an item, and tries when it dies."""

from __future__ import annotations

import contextlib
import importlib
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from .errors import CampaignError
from .frames import receive, send
from .items import Item

#: Tries of an item whose worker dies without a limit of ours having ended it.
TRIES = 3
#: Time between two looks at the memory of a running item [s].
_LOOK_S = 0.02
#: Time that a worker process may take to start [s].
_START_S = 120.0
#: Size at which what tasks print is thrown away [bytes].
_PRINTED = 1 << 20
_ONE_THREAD = (
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS", "RAYON_NUM_THREADS",
)  # fmt: skip


@dataclass(frozen=True)
class Setup:
    """What a worker is told once.

    Attributes:
        task: Name of the task.
        options: Its options.
        shared: Pickled data that all items use.
        axis_columns: Names of columns that no figure may have.
        time_limit_s: Longest time of an item [s], or None.
        memory_limit_mb: Most memory of the worker process [MB], or None.
        path: Folders to import from.
    """

    task: str
    options: Mapping[str, Any]
    shared: bytes
    axis_columns: tuple[str, ...]
    time_limit_s: float | None = None
    memory_limit_mb: float | None = None
    path: tuple[str, ...] = ()


@dataclass
class Result:
    """What became of one item.

    Attributes:
        number: Number of the item.
        figures: Its figures, or None where it failed.
        code: Code of the error, or None.
        message: Sentence of the error, or None.
        detail: Place, hint, traceback; not part of the table.
        own_s: Time of the item itself in the worker, waiting included [s].
        cpu_s: Time of its processor [s].
        peak_mb: Most memory of the worker process so far [MB].
        tries: How often it was begun.
        worker: Which worker it was.
    """

    number: int
    figures: dict[str, Any] | None = None
    code: str | None = None
    message: str | None = None
    detail: Any = None
    own_s: float | None = None
    cpu_s: float | None = None
    peak_mb: float | None = None
    tries: int = 1
    worker: int = 0

    def to_dict(self) -> dict[str, Any]:
        """The result as a line of the journal."""
        return {key: value for key, value in vars(self).items() if value is not None}


@dataclass
class _Process:
    """A running child and the thread that reads its answers."""

    popen: subprocess.Popen[bytes]
    answers: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)

    def read(self) -> None:
        """Moves answers into the queue; None stands for the end."""
        assert self.popen.stdout is not None
        try:
            while True:
                self.answers.put(receive(self.popen.stdout))
        except Exception:  # noqa: BLE001 — half a frame of a killed child
            self.answers.put(None)
        finally:
            self.popen.stdout.close()


class Worker:
    """Runs items in a child process that is replaced when it had to be ended or died."""

    def __init__(self, setup: Setup, number: int = 0) -> None:
        self._setup = setup
        self._number = number
        self._aborted = False
        self._process: _Process | None = None
        handle, name = tempfile.mkstemp(prefix="stiffarm-campaign-")
        os.close(handle)
        # Opened to append: what is thrown away in between leaves no hole.
        self._printed: IO[bytes] = open(name, "a+b")  # noqa: SIM115
        with contextlib.suppress(OSError):
            os.unlink(name)

    @property
    def pid(self) -> int | None:
        """Process id of the child, or None while there is none."""
        return self._process.popen.pid if self._process else None

    def run(self, item: Item, tries: int = 0) -> Result:
        """Runs one item within its limits.

        Args:
            item: The item.
            tries: How often it was begun before.

        Raises:
            CampaignError: ``worker-start`` where no worker process can be started at all,
                ``interrupted`` after :meth:`abort`.
        """
        while True:
            tries += 1
            result = self._try(item)
            if self._aborted:
                raise CampaignError("interrupted", "The run was interrupted.")
            if result is not None or tries >= TRIES:
                break
        result = result or died(item.number, tries)
        result.tries = tries
        result.worker = self._number
        return result

    def close(self) -> None:
        """Ends the child."""
        self._end()
        self._printed.close()

    def abort(self) -> None:
        """Ends the child from another thread; the item that runs has no result."""
        self._aborted = True
        process = self._process
        if process is not None:
            with contextlib.suppress(OSError):
                process.popen.kill()

    def _try(self, item: Item) -> Result | None:
        process = self._started()
        assert process.popen.stdin is not None
        begun = time.monotonic()
        try:
            send(process.popen.stdin, dict(item.values))
        except OSError:
            # It died while it waited for work.
            self._end()
            return None
        code, answer = self._answer(process, begun)
        if code is None and answer is None:
            code = "out-of-memory" if self._ran_out() else None
            self._end()
            if code is None:
                return None
        if answer is not None and answer.get("code") == "out-of-memory":
            code = "out-of-memory"
        if code is not None:
            self._end()
            message = self._limit_message(code)
            took = time.monotonic() - begun
            return Result(item.number, code=code, message=message, own_s=took)
        self._tidy(process)
        found: Any = answer
        return Result(item.number, **found)

    def _answer(self, process: _Process, begun: float) -> tuple[str | None, Any]:
        """The limit that was passed and the answer; neither where the child died."""
        setup = self._setup
        while True:
            waits: list[float] = []
            if setup.time_limit_s is not None:
                left = begun + setup.time_limit_s - time.monotonic()
                if left <= 0:
                    return "time-limit", None
                waits.append(left)
            if setup.memory_limit_mb is not None:
                waits.append(_LOOK_S)
            try:
                return None, process.answers.get(timeout=min(waits) if waits else None)
            except queue.Empty:
                used = resident_mb(process.popen.pid) if setup.memory_limit_mb else None
                if used is not None and used > (setup.memory_limit_mb or 0):
                    return "out-of-memory", None

    def _limit_message(self, code: str) -> str:
        if code == "time-limit":
            return f"It took longer than its limit of {self._setup.time_limit_s:g} s."
        if self._setup.memory_limit_mb is None:
            return "There was not enough memory."
        return f"It needed more than its limit of {self._setup.memory_limit_mb:g} MB of memory."

    def _ran_out(self) -> bool:
        """Whether a child that ended said that it could not have memory it asked for."""
        if self._setup.memory_limit_mb is None:
            return False
        size = self._printed.seek(0, os.SEEK_END)
        self._printed.seek(max(0, size - 4096))
        # Rust's words when an allocation fails, which ends the process.
        return b"memory allocation of " in self._printed.read()

    def _tidy(self, process: _Process) -> None:
        limit = self._setup.memory_limit_mb
        # What an item left behind must not count against the next one.
        if limit is not None and (resident_mb(process.popen.pid) or 0) > limit / 2:
            self._end()
        with contextlib.suppress(OSError):
            if os.fstat(self._printed.fileno()).st_size > _PRINTED:
                self._printed.truncate(0)

    def _started(self) -> _Process:
        if self._process is not None and self._process.popen.poll() is None:
            return self._process
        if self._aborted:
            raise CampaignError("interrupted", "The run was interrupted.")
        self._end()
        self._printed.truncate(0)
        self._process = process = _Process(self._spawn())
        threading.Thread(target=process.read, daemon=True, name="answers").start()
        assert process.popen.stdin is not None
        with contextlib.suppress(OSError):
            send(process.popen.stdin, vars(self._setup))
        try:
            answer = process.answers.get(timeout=_START_S)
        except queue.Empty:
            answer = None
        if answer is None or "ready" not in answer:
            failed = (answer or {}).get("failed") or {"message": self._last_words()}
            self._end()
            raise CampaignError(
                "worker-start", f"A worker process could not be started: {failed['message']}"
            )
        return process

    def _spawn(self) -> subprocess.Popen[bytes]:
        environment = dict(os.environ)
        environment.update(dict.fromkeys(_ONE_THREAD, "1"))
        environment["PYTHONPATH"] = os.pathsep.join(p for p in sys.path if p)
        return subprocess.Popen(
            [sys.executable, "-m", "stiffarm.campaign.child"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._printed,
            env=environment,
            # Ctrl-C is for the driver, which then ends the workers.
            start_new_session=True,
        )

    def _last_words(self) -> str:
        size = self._printed.seek(0, os.SEEK_END)
        self._printed.seek(max(0, size - 2000))
        words = self._printed.read().decode(errors="replace").strip().splitlines()
        return words[-1] if words else "it ended without a word."

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        with contextlib.suppress(OSError):
            process.popen.kill()
        process.popen.wait()
        with contextlib.suppress(OSError):
            if process.popen.stdin is not None:
                process.popen.stdin.close()


def died(number: int, tries: int) -> Result:
    """The result of an item whose worker died at every try."""
    times = f"{tries} times" if tries > 1 else "once"
    message = f"The worker died {times} while it ran this item."
    return Result(number, code="worker-died", message=message, tries=tries)


def resident_mb(pid: int) -> float | None:
    """Memory in use by a process [MB]; None where it cannot be told or the process is gone."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
    except (OSError, ValueError, IndexError, AttributeError):
        pass
    try:
        psutil = importlib.import_module("psutil")
        return float(psutil.Process(pid).memory_info().rss) / 1e6
    except Exception:  # noqa: BLE001 — not installed, or the process is gone
        return None

