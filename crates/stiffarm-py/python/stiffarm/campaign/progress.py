"""How far a run is, on a terminal or for a callback; silent elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from typing import Union


@dataclass(frozen=True)
class Progress:
    """State of a run.

    Attributes:
        done: Items done, in earlier runs too.
        failed: How many of them failed.
        total: Items of the campaign.
        elapsed_s: Time since this run began [s].
        remaining_s: Estimated time to the end [s], at the mean rate of this run; None before its first item.
    """

    done: int
    failed: int
    total: int
    elapsed_s: float
    remaining_s: float | None

    def __str__(self) -> str:
        left = "" if self.remaining_s is None else f", {timedelta(seconds=round(self.remaining_s))} left"
        return f"{self.done} of {self.total} items, {self.failed} failed{left}"


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
            print(file=sys.stderr)


def _show(state: Progress) -> None:
    print(f"\r{state!s:<70}", end="", file=sys.stderr, flush=True)
