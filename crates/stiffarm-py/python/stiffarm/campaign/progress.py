"""How far a run is, on a terminal or for a callback; silent elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Union


@dataclass(frozen=True)
class Progress:
    """State of a run.

    Attributes:
        done: Items done, in earlier runs too.
        failed: How many of them failed.
        total: Items of the campaign.
        elapsed_s: Time since this run began [s].
        remaining_s: Estimated time to the end [s]: items left at the mean rate of this run. None before the first item
            of this run.
    """

    done: int
    failed: int
    total: int
    elapsed_s: float
    remaining_s: float | None


#: None: a line on a terminal, silent in a pipe. False: silent. Or a function of each Progress.
Reporter = Union[Callable[[Progress], object], bool, None]


class Meter:
    """Tells the reporter how far the run is, not more often than ten times a second."""

    def __init__(self, total: int, done: int, reporter: Reporter) -> None:
        self._total, self._before = total, done
        self._begun, self._told = time.monotonic(), 0.0
        self._line = not callable(reporter) and reporter is not False and sys.stderr.isatty()
        self._tell = reporter if callable(reporter) else _show if self._line else None

    def told(self, done: int, failed: int) -> None:
        """Says that so many items are done, and how many of them failed."""
        now = time.monotonic()
        if self._tell is None or (now - self._told < 0.1 and done < self._total):
            return
        self._told, elapsed, here = now, now - self._begun, done - self._before
        remaining = elapsed / here * (self._total - done) if here else None
        self._tell(Progress(done, failed, self._total, elapsed, remaining))

    def close(self) -> None:
        """Ends the line."""
        if self._line:
            sys.stderr.write("\n")


def _show(state: Progress) -> None:
    left = "" if state.remaining_s is None else f", {duration(state.remaining_s)} left"
    text = f"{state.done} of {state.total} items, {state.failed} failed{left}"
    sys.stderr.write(f"\r{text:<70}")
    sys.stderr.flush()


def duration(seconds: float) -> str:
    """A time as people say it: ``45 s``, ``12 min``, ``3 h 20 min``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
