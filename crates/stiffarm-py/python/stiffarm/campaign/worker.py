"""What a worker does: it runs items, each to its figures or to what went wrong.

A worker is a process of its own, of ``concurrent.futures`` or of Ray, with one thread for its items.
"""

from __future__ import annotations

import faulthandler
import math
import multiprocessing
import os
import pickle
import platform
import re
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from .._errors import StiffarmError
from .._stiffarm import set_threads
from .task import BadResult
from .tasks import task_of

#: What became of an item: ``figures``, or ``code``, ``message`` and ``detail``; ``own_s``, ``cpu_s`` [s] and
#: ``worker``.
Answer = dict[str, Any]
Run = Callable[[Mapping[str, Any]], Mapping[str, Any]]
_ADDRESS = re.compile(r"0x[0-9a-fA-F]+")


@dataclass(frozen=True)
class Setup:
    """What a worker is told once.

    Attributes:
        key: Names this run among others that the same process of Ray may have served.
        task: Name of the task.
        options: Its options.
        shared: Pickled data that all items use.
        columns: Names of columns that no figure may have.
        time_limit_s: Longest time of an item [s], or None.
        path: Folders to import from.
    """

    key: str
    task: str
    options: Mapping[str, Any]
    shared: bytes
    columns: tuple[str, ...]
    time_limit_s: float | None
    path: tuple[str, ...]


#: The run that this process is prepared for.
_prepared: tuple[Setup, Run] | None = None


def prepare(setup: Setup) -> None:
    """Makes this process ready for the items of a run."""
    global _prepared
    # A process of Ray may have chosen before.
    with suppress(StiffarmError):
        set_threads(1)
    sys.path += [folder for folder in setup.path if folder not in sys.path]
    task, shared = task_of(setup.task), pickle.loads(setup.shared)
    _prepared = setup, lambda values: task.run(values, setup.options, shared)


def serve(setup: Setup) -> None:
    """Makes a process of ``concurrent.futures`` ready: the driver ends it, and Ctrl-C is for the driver."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_driver, daemon=True).start()
    prepare(setup)


def _end_with_driver() -> None:
    """Ends this process when the driver is gone, also one that was killed; an item may be running."""
    driver = multiprocessing.parent_process()
    if driver is not None:
        driver.join()
        os._exit(1)


def run_on_ray(setup: Setup, values: Mapping[str, Any]) -> Answer:
    """Runs one item in a process of Ray, which may not know the run yet."""
    if _prepared is None or _prepared[0].key != setup.key:
        prepare(setup)
    return run_item(values)


def run_item(values: Mapping[str, Any]) -> Answer:
    """Runs one item; whatever it raises becomes part of the answer."""
    assert _prepared is not None
    setup, run = _prepared
    begun, used = time.perf_counter(), time.process_time()
    try:
        figures = _within(setup.time_limit_s, lambda: run(values))
        answer: Answer = {"figures": _checked(figures, setup.columns)}
    except TimeLimit:
        answer = {"code": "time-limit", "message": f"It took longer than its limit of {setup.time_limit_s:g} s."}
    except MemoryError:
        answer = {"code": "out-of-memory", "message": "There was not enough memory."}
    except BaseException as error:  # noqa: BLE001 — a panic or SystemExit is an item's error too
        answer = _failure(error)
    answer["own_s"] = time.perf_counter() - begun
    answer["cpu_s"] = time.process_time() - used
    answer["worker"] = f"{platform.node()}:{os.getpid()}"
    return answer


class TimeLimit(BaseException):
    """An item took longer than it may; no task catches it by mistake."""


def _within(limit_s: float | None, run: Callable[[], Mapping[str, Any]]) -> Mapping[str, Any]:
    """What ``run`` returns.

    Raises:
        TimeLimit: The limit passed; where the system has no alarms the process ends instead.
    """
    if limit_s is None:
        return run()
    rang: list[int] = []

    def ring(number: int, frame: object) -> None:
        rang.append(number)
        raise TimeLimit

    alarms = hasattr(signal, "setitimer")
    # Code that hears no alarm, in C for example, ends with its process.
    faulthandler.dump_traceback_later(2 * limit_s + 10 if alarms else limit_s, exit=True, file=2)
    if alarms:
        signal.signal(signal.SIGALRM, ring)
        signal.setitimer(signal.ITIMER_REAL, limit_s)
    try:
        return run()
    finally:
        if alarms:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        faulthandler.cancel_dump_traceback_later()
        if rang:
            # The library takes an alarm for Ctrl-C and returns its best so far, which depends on the clock.
            raise TimeLimit


def _failure(error: BaseException) -> Answer:
    code = getattr(error, "code", None)
    own = isinstance(code, str) and code != ""
    text = getattr(error, "message", None) if own else None
    message = text if isinstance(text, str) else str(error)
    if not own:
        code = "task-error"
        message = f"{type(error).__name__}: {message}" if message else type(error).__name__
    place, hint = getattr(error, "place", None), getattr(error, "hint", None)
    detail = {
        "place": {str(k): str(v) for k, v in place.items()} if isinstance(place, dict) else None,
        "hint": hint if isinstance(hint, str) else None,
        "traceback": traceback.format_exc(limit=-6),
    }
    # Addresses differ from process to process; the table must not.
    return {"code": code, "message": _ADDRESS.sub("0x…", message), "detail": detail}


def _checked(figures: Mapping[str, Any], taken: tuple[str, ...]) -> dict[str, Any]:
    for name in figures:
        if not isinstance(name, str) or not name:
            raise BadResult(f"A figure has the name {name!r}, which is no text.")
        if name in taken:
            raise BadResult(f"A figure has the name {name}, which is a column already.")
    return {name: _plain(name, value) for name, value in figures.items()}


def _plain(name: str, value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if value is None or type(value) in (str, bool, int, float):
        if type(value) is int and not -(2**63) <= value < 2**63:
            raise BadResult(f"The figure {name} is too large for 64 bits.")
        if type(value) is float and not math.isfinite(value):
            raise BadResult(f"The figure {name} is {value}; a number is finite, and None where there is none.")
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(name, part) for part in value]
    kind = type(value).__name__
    raise BadResult(f"The figure {name} is of type {kind}; text, numbers and lists of them can be kept.")
