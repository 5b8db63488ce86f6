"""Who runs the items: processes of this machine, or a cluster of Ray; and what happens when one of them dies."""

from __future__ import annotations

import os
import queue
import signal
import threading
import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import get_context
from typing import Any

from .errors import CampaignError, load
from .items import Item
from .worker import Answer, Setup, run_item, run_on_ray, serve

#: Tries of an item whose worker dies.
TRIES = 3
#: Time without a result after which somebody looks whether there can be one [s].
_LOOK_S = 1.0
#: Time without any processor in the cluster after which the run ends [s].
WAIT_S = 600.0


class Died(Exception):
    """A worker died while it ran an item."""


def results(engine: Processes | OnRay, items: Iterable[Item]) -> Iterator[dict[str, Any]]:
    """A record of each item, in the order in which they end.

    An item whose worker dies is begun again, a bounded number of times: it may be its fault or not.
    """
    waiting = iter(items)
    again: deque[tuple[Item, int]] = deque()
    under_way: dict[Future[Answer], tuple[Item, int]] = {}
    # Not wait(): it looks at all futures each time.
    ended: queue.SimpleQueue[Future[Answer]] = queue.SimpleQueue()
    while True:
        while len(under_way) < engine.most:
            item, tries = again.popleft() if again else (next(waiting, None), 0)
            if item is None:
                break
            future = engine.submit(item.values)
            under_way[future] = item, tries + 1
            future.add_done_callback(ended.put)
        if not under_way:
            return
        try:
            future = ended.get(timeout=_LOOK_S)
        except queue.Empty:
            engine.look()
            continue
        item, tries = under_way.pop(future)
        try:
            answer = engine.answer(future)
        except Died:
            if tries < TRIES:
                again.append((item, tries))
                continue
            message = f"The worker died {tries} times while it ran this item."
            answer = {"code": "worker-died", "message": message}
        yield {"number": item.number, **answer, "tries": tries}


class Processes:
    """Processes of this machine. Each has an executor of its own: one that dies takes no other with it.

    Attributes:
        most: Most items under way.
    """

    def __init__(self, setup: Setup, workers: int) -> None:
        self.most = workers
        self._setup = setup
        self._own = threading.local()
        self._pools: dict[ProcessPoolExecutor, int] = {}
        self._closed = False
        self._threads = ThreadPoolExecutor(workers, "campaign")
        # Libraries read it when they are loaded; Ray sets it too, so that sums are rounded alike.
        self._before = os.environ.get("OMP_NUM_THREADS")
        os.environ["OMP_NUM_THREADS"] = "1"

    def submit(self, values: Mapping[str, Any]) -> Future[Answer]:
        """Begins an item in the process of a thread that is free."""
        return self._threads.submit(self._run, values)

    def answer(self, future: Future[Answer]) -> Answer:
        """The answer of an item that is done.

        Raises:
            Died: Its worker died.
            CampaignError: ``worker-start`` where there can be no worker.
        """
        return future.result()

    def look(self) -> None:
        """Processes that die are heard of at once."""

    def _run(self, values: Mapping[str, Any]) -> Answer:
        if not hasattr(self._own, "pool"):
            self._own.pool = self._start()
        pool: ProcessPoolExecutor = self._own.pool
        try:
            return pool.submit(run_item, values).result()
        except BrokenProcessPool:
            del self._own.pool, self._pools[pool]
            raise Died from None

    def _start(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(1, get_context("spawn"), serve, (self._setup,))
        try:
            self._pools[pool] = pool.submit(os.getpid).result()
        except BrokenProcessPool:
            hint = 'A script runs campaigns below if __name__ == "__main__":, since workers import it.'
            raise CampaignError("A worker process could not be started.", "worker-start", hint=hint) from None
        if self._closed:
            self._kill()
        return pool

    def _kill(self) -> None:
        for process in list(self._pools.values()):
            with suppress(OSError):
                os.kill(process, signal.SIGTERM)

    def close(self) -> None:
        """Ends the processes."""
        self._closed = True
        self._kill()
        self._threads.shutdown(cancel_futures=True)
        for pool in list(self._pools):
            pool.shutdown()
        del os.environ["OMP_NUM_THREADS"]
        if self._before is not None:
            os.environ["OMP_NUM_THREADS"] = self._before


class OnRay:
    """Plain tasks of Ray, one for each item."""

    def __init__(self, setup: Setup, workers: int | None, address: str) -> None:
        """Connects to Ray, unless this program is connected already.

        Args:
            setup: What the workers are told.
            workers: Most items at a time; None for all processors.
            address: Address of the cluster, for example ``auto`` or ``ray://head:10001``.

        Raises:
            CampaignError: ``no-cluster`` where there is no Ray at the address, ``missing-package``.
        """
        # Nothing is reported to Ray's makers unless the user says so.
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        self._ray = load("ray", "A cluster")
        self._connected = not self._ray.is_initialized()
        if self._connected:
            try:
                self._ray.init(address=address, log_to_driver=False, logging_level="ERROR")
            except (ConnectionError, ValueError, RuntimeError, OSError, ImportError) as error:
                first = (str(error).strip() or "no answer").splitlines()[0]
                message = f"Ray cannot be reached at {address}: {first}"
                raise CampaignError(message, "no-cluster", {"key": "address"}) from error
        # Twice the processors, so that none waits for the driver.
        self.most = workers or 2 * max(1, self._processors())
        self._setup = self._ray.put(setup)
        # Whoever dies is counted by us: Ray would begin an item again for ever that needs all memory of a node.
        self._task = self._ray.remote(num_cpus=1, max_retries=0)(run_on_ray)
        self._under_way: dict[Future[Answer], Any] = {}
        self._seen = time.monotonic()

    def _processors(self) -> int:
        return int(self._ray.cluster_resources().get("CPU", 0))

    def submit(self, values: Mapping[str, Any]) -> Future[Answer]:
        """Hands an item to Ray."""
        reference = self._task.remote(self._setup, values)
        future: Future[Answer] = reference.future()
        self._under_way[future] = reference
        return future

    def answer(self, future: Future[Answer]) -> Answer:
        """The answer of an item that is done; whatever is wrong with a node or a process is a death."""
        del self._under_way[future]
        self._seen = time.monotonic()
        try:
            return future.result()
        except self._ray.exceptions.RayTaskError as error:
            message = f"A worker could not be started: {error.cause}"
            hint = "Is stiffarm installed on all machines of the cluster, and the module of the task?"
            raise CampaignError(message, "worker-start", hint=hint) from error
        except self._ray.exceptions.RayError:
            raise Died from None

    def look(self) -> None:
        """Looks whether the cluster has processors at all; busy ones are waited for.

        Raises:
            CampaignError: ``no-cluster`` where it had none for long.
        """
        if self._processors() > 0:
            self._seen = time.monotonic()
        elif time.monotonic() - self._seen > WAIT_S:
            message = f"The cluster has had no processor for {WAIT_S:g} s."
            raise CampaignError(message, "no-cluster", hint="Running it again does what is left.")

    def close(self) -> None:
        """Ends what is under way, and the connection where it was made here."""
        for reference in self._under_way.values():
            with suppress(Exception):
                self._ray.cancel(reference, force=True)
        if self._connected:
            self._ray.shutdown()
