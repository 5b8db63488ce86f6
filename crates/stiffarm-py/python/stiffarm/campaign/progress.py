"""How far a run is, on a terminal or for a callback; silent elsewhere."""

from __future__ import annotations

import contextlib
import importlib
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Union


@dataclass(frozen=True)
class Progress:
    """State of a run.

    Attributes:
        done: Items done, in earlier runs too.
        failed: How many of them failed.
        total: Items of the campaign.
        elapsed_s: Time since this run began [s].
        remaining_s: Estimated time to the end [s]: items left at the mean rate of this run. None
            before the first item of this run.
    """

    done: int
    failed: int
    total: int
    elapsed_s: float
    remaining_s: float | None


#: None: a line on a terminal, silent in a pipe. False: silent. Or a function of each Progress.
Reporter = Union[Callable[[Progress], object], bool, None]


class Meter:
    """Counts items and tells the reporter, not more often than ten times a second."""

    def __init__(self, total: int, done: int, failed: int, reporter: Reporter) -> None:
        self._begun = time.monotonic()
        self._told = 0.0
        self._before = done
        self.total, self.done, self.failed = total, done, failed
        self._tell: Callable[[Progress], object] | None = None
        self._line: _Line | None = None
        if callable(reporter):
            self._tell = reporter
        elif reporter is not False and sys.stderr.isatty():
            self._line = _Line(total, done)

    def state(self) -> Progress:
        """The state now."""
        elapsed = time.monotonic() - self._begun
        here = self.done - self._before
        remaining = elapsed / here * (self.total - self.done) if here else None
        return Progress(self.done, self.failed, self.total, elapsed, remaining)

    def count(self, new: bool, failed: int) -> None:
        """Counts an item.

        Args:
            new: Whether it was not done before (a failed one may have been tried again).
            failed: Items that have failed so far.
        """
        self.done += int(new)
        self.failed = failed
        now = time.monotonic()
        if now - self._told >= 0.1 or self.done == self.total:
            self._told = now
            if self._tell is not None:
                self._tell(self.state())
            if self._line is not None:
                self._line.show(self.state())

    def close(self) -> None:
        """Ends the line."""
        if self._line is not None:
            self._line.close()


class _Line:
    """A line on the terminal: tqdm's where it is installed, else one of our own."""

    def __init__(self, total: int, done: int) -> None:
        self._bar: Any = None
        with contextlib.suppress(ImportError):
            tqdm = importlib.import_module("tqdm")
            self._bar = tqdm.tqdm(total=total, initial=done, unit=" items", file=sys.stderr)

    def show(self, state: Progress) -> None:
        if self._bar is not None:
            self._bar.set_postfix_str(f"{state.failed} failed", refresh=False)
            self._bar.update(state.done - self._bar.n)
            return
        left = "" if state.remaining_s is None else f", {duration(state.remaining_s)} left"
        text = f"{state.done} of {state.total} items, {state.failed} failed{left}"
        sys.stderr.write(f"\r{text:<70}")
        sys.stderr.flush()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        else:
            sys.stderr.write("\n")


def duration(seconds: float) -> str:
    """A time as people say it: ``45 s``, ``12 min``, ``3 h 20 min``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    if minutes < 90:
        return f"{minutes} min"
    return f"{minutes // 60} h {minutes % 60} min"
