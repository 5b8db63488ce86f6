"""The process that runs items, one after the other, and nothing else.

Started as ``python -m stiffarm.campaign.child``. Frames of pickled data come on standard input:
first the setup, then one item each; answers go out on what was standard output. A process of its
own for the items means that one that hangs, dies or eats memory takes nothing else with it, and
that items see the same surroundings under every engine.
"""

from __future__ import annotations

import contextlib
import math
import os
import pickle
import queue
import re
import sys
import threading
import time
import traceback
from collections.abc import Mapping
from typing import IO, Any

from .built_in import BadResult
from .frames import receive, send
from .tasks import Task, task_of

_ADDRESS = re.compile(r"0x[0-9a-fA-F]+")
#: Address space beyond the memory limit, for stacks and heaps of threads [MB].
_SPARE_MB = 256


def limit_address_space(limit_mb: float) -> None:
    """Lets this process ask for ``limit_mb`` and some spare more than it has now [MB].

    The parent watches the memory in use; this stops a request too large and too fast to be seen.
    """
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        with open("/proc/self/statm", encoding="ascii") as file:
            now = int(file.read().split()[0]) * resource.getpagesize()
        most = now + int((limit_mb + _SPARE_MB) * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


def peak_mb() -> float | None:
    """Most memory this process has used so far [MB], or None where it cannot be told."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        with open("/proc/self/status", encoding="ascii", errors="replace") as file:
            for line in file:
                if line.startswith("VmHWM:"):
                    return int(line.split()[1]) * 1024 / 1e6
    # The kernel's other count begins with the memory of the parent, before this program was
    # started in its place; good enough where there is nothing else.
    with contextlib.suppress(ImportError):
        import resource

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6
    return None


def run_item(task: Task, setup: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Runs one item; whatever it raises becomes part of the answer.

    Returns:
        ``figures``, or ``code``, ``message`` and ``detail``; ``own_s`` and ``cpu_s`` [s];
        ``peak_mb`` [MB].
    """
    begun, used = time.perf_counter(), time.process_time()
    answer: dict[str, Any]
    try:
        figures = task.run(values, setup["options"], setup["shared"])
        answer = {"figures": _figures(figures, setup["axis_columns"])}
    except MemoryError:
        answer = {"code": "out-of-memory", "message": "", "detail": None}
    except BaseException as error:  # noqa: BLE001 — a panic or SystemExit is an item's error too
        answer = _failure(error)
    answer["own_s"] = time.perf_counter() - begun
    answer["cpu_s"] = time.process_time() - used
    answer["peak_mb"] = peak_mb()
    return answer


def _failure(error: BaseException) -> dict[str, Any]:
    code = getattr(error, "code", None)
    own = isinstance(code, str) and code != "" and not isinstance(error, SystemExit)
    text = getattr(error, "message", None) if own else None
    message = text if isinstance(text, str) else str(error)
    if not own:
        code = "task-error"
        message = f"{type(error).__name__}: {message}" if message else type(error).__name__
    # Addresses differ from process to process; the table must not.
    message = _ADDRESS.sub("0x…", message)
    place, hint = getattr(error, "place", None), getattr(error, "hint", None)
    detail = {
        "place": {str(k): str(v) for k, v in place.items()} if isinstance(place, dict) else None,
        "hint": hint if isinstance(hint, str) else None,
        "traceback": traceback.format_exc(limit=-6),
    }
    return {"code": code, "message": message, "detail": detail}


def _figures(figures: Mapping[str, Any], taken: tuple[str, ...]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for name, value in figures.items():
        if not isinstance(name, str) or not name:
            raise BadResult(f"A figure has the name {name!r}, which is no text.")
        if name in taken:
            raise BadResult(f"A figure has the name {name}, which is a column already.")
        result[name] = _plain(name, value)
    return result


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
    raise BadResult(
        f"The figure {name} is of type {type(value).__name__}; "
        "text, numbers and lists of them can be kept."
    )


def _requests(stream: IO[bytes]) -> queue.SimpleQueue[Any]:
    """Frames from the parent, read by a thread, which ends the process when the parent is gone."""
    received: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def read() -> None:
        try:
            while True:
                received.put(receive(stream))
        except BaseException:  # noqa: BLE001
            # An item may be running; nobody waits for it any more.
            os._exit(0)

    threading.Thread(target=read, daemon=True, name="requests").start()
    return received


def main() -> None:
    """Serves items until the parent goes."""
    # What a task prints must not come between the frames.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    requests = _requests(os.fdopen(os.dup(0), "rb"))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    setup = requests.get()
    for path in setup["path"]:
        if path not in sys.path:
            sys.path.append(path)
    try:
        task = task_of(setup["task"])
        setup["shared"] = pickle.loads(setup["shared"])
    except BaseException as error:  # noqa: BLE001
        send(answers, {"failed": _failure(error)})
        return
    if setup["memory_limit_mb"] is not None:
        limit_address_space(setup["memory_limit_mb"])
    send(answers, {"ready": os.getpid()})
    while True:
        values = requests.get()
        answer = run_item(task, setup, values)
        try:
            send(answers, answer)
        except OSError:
            return
        if answer.get("code") == "out-of-memory":
            return


if __name__ == "__main__":
    main()
