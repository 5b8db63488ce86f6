"""Items that run while Ray starts, which takes as long as dozens of them.

The workers are those of the serial engine, children of this process. Each ends after its item once
a worker of Ray has taken its place.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

from .errors import CampaignError
from .items import Item
from .limits import Result, Setup, Worker


class HeadStart:
    """Workers of this process, each in a thread that waits for it."""

    def __init__(self, setup: Setup, count: int, draw: Callable[[], Item | None]) -> None:
        """Starts them.

        Args:
            setup: What the workers are told.
            count: How many.
            draw: Gives the next item, or None at the end; called from any thread.
        """
        self._results: queue.SimpleQueue[Result | CampaignError | None] = queue.SimpleQueue()
        self._draw = draw
        self._workers = [Worker(setup, number) for number in range(count)]
        self._stops = [threading.Event() for _ in self._workers]
        self._running = self.count = count
        self._threads = [
            threading.Thread(target=self._work, args=pair, daemon=True)
            for pair in zip(self._workers, self._stops)
        ]
        for thread in self._threads:
            thread.start()

    def _work(self, worker: Worker, stop: threading.Event) -> None:
        try:
            while not stop.is_set():
                item = self._draw()
                if item is None:
                    break
                self._results.put(worker.run(item))
        except CampaignError as error:
            self._results.put(error)
        except Exception as error:  # noqa: BLE001 — a lost item would be lost in silence
            self._results.put(CampaignError("worker-start", f"A worker failed: {error}"))
        finally:
            worker.close()
            self._results.put(None)

    @property
    def running(self) -> bool:
        """Whether there may be results to come."""
        return self._running > 0

    def next(self, timeout_s: float) -> Result | None:
        """The next result, or None where none came in that time.

        Raises:
            CampaignError: A worker could not be started.
        """
        try:
            result = self._results.get(timeout=timeout_s) if timeout_s > 0 else self._results.get_nowait()
        except queue.Empty:
            return None
        if result is None:
            self._running -= 1
        if isinstance(result, CampaignError):
            raise result
        return result

    def stop_one(self) -> None:
        """Lets one more worker end after its item."""
        for stop in self._stops:
            if not stop.is_set():
                stop.set()
                return

    def abort(self) -> None:
        """Ends all workers at once."""
        for stop, worker in zip(self._stops, self._workers):
            stop.set()
            worker.abort()
        for thread in self._threads:
            thread.join()
