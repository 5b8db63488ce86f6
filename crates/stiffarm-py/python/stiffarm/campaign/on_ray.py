"""Items on Ray: an actor for each worker, which runs items in a process of its own.

The actor only watches. The process that runs the items is a child of it, the same as under the
serial engine, so limits, errors and results are the same too. An actor that dies (its node, the
memory monitor of Ray, somebody's SIGKILL) takes its child along; its items are given to another
one, each a bounded number of times.

Short items are handed over in batches of about a quarter of a second, which is what a call costs
Ray several hundred times over; two batches are under way for each worker, so none waits for the
driver.
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from .errors import CampaignError, load
from .items import Item
from .limits import TRIES, Result, Setup, Worker, died

#: Own time of the items of a batch [s].
BATCH_S = 0.25
#: Time after which a worker hands back what is left of a batch [s].
LONGEST_S = 4 * BATCH_S
#: Most items of a batch.
MOST = 64
#: Batches under way for each worker, the running one included.
DEPTH = 2
#: Deaths of workers, one after the other without any result, after which the run ends.
MOST_DEATHS = 20
#: Time after which a cluster that gives no worker at all is an error [s].
WAIT_S = 600.0


class Supervisor:
    """The actor: runs batches of items."""

    def __init__(self, setup: Setup, number: int) -> None:
        self._worker = Worker(setup, number)

    def ready(self) -> int:
        """Process id, once the actor is there."""
        return os.getpid()

    def run(self, batch: list[tuple[Item, int]]) -> list[Result] | CampaignError:
        """Results of the first items of a batch, each with the number of times it was begun before.

        Fewer than all where they take longer than those before: then the others go back, so that
        results come in and other workers can take them.
        """
        begun = time.monotonic()
        results: list[Result] = []
        try:
            for item, tries in batch:
                results.append(self._worker.run(item, tries))
                if time.monotonic() - begun > LONGEST_S:
                    break
        except CampaignError as error:
            return error
        return results


@dataclass
class _Actor:
    handle: Any
    number: int
    ready: bool = False
    calls: list[Any] = field(default_factory=list)


class OnRay:
    """The engine that runs items on Ray."""

    name = "ray"

    def __init__(self, setup: Setup, workers: int | None, address: str | None) -> None:
        """Connects to Ray, or starts it here.

        Args:
            setup: What the workers are told.
            workers: Number of workers; all processors of the machine or cluster by default.
            address: Address of a cluster, for example ``auto`` or ``ray://head:10001``; without
                one a Ray that this program has started already, or a new one on this machine.

        Raises:
            CampaignError: ``no-cluster`` where there is no Ray at the address.
        """
        # Nothing is reported to Ray's makers unless the user says so.
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        self._ray = load("ray", 'engine="ray"')
        self._started = False
        try:
            self._connect(workers, address)
        except (ConnectionError, ValueError, RuntimeError, OSError) as error:
            first = str(error).strip().splitlines()[0] if str(error).strip() else "no answer"
            raise CampaignError(
                "no-cluster",
                f"Ray cannot be reached at {address or 'this machine'}: {first}",
                place={"key": "address"},
            ) from error
        cores = int(self._ray.cluster_resources().get("CPU", 1))
        self._count = workers or max(1, cores)
        self._setup = self._ray.put(setup)
        self._class = self._ray.remote(num_cpus=1, max_restarts=0)(Supervisor)
        self._actors: list[_Actor] = []
        self._made = 0

    def _connect(self, workers: int | None, address: str | None) -> None:
        if address is None and self._ray.is_initialized():
            return
        if self._ray.is_initialized():
            raise ValueError("this program is connected to Ray already; leave out the address")
        quiet = {"log_to_driver": False, "logging_level": "ERROR"}
        if address is not None:
            self._ray.init(address=address, **quiet)
        else:
            # Items travel in messages; the object store holds the setup alone.
            self._ray.init(
                address="local",
                num_cpus=workers,
                include_dashboard=False,
                object_store_memory=100_000_000,
                **quiet,
            )
        self._started = True

    def results(self, items: Iterable[Item], count: int) -> Iterator[Result]:
        """Results in the order in which they come."""
        run = _Run(self, iter(items), count)
        for _ in range(min(self._count, count)):
            run.new_actor()
        yield from run.results()

    def start_actor(self) -> _Actor:
        """Asks Ray for one more worker."""
        actor = _Actor(self._class.remote(self._setup, self._made), self._made)
        self._made += 1
        self._actors.append(actor)
        return actor

    def end_actor(self, actor: _Actor) -> None:
        """Ends a worker."""
        self._actors.remove(actor)
        try:
            self._ray.kill(actor.handle)
        except Exception:  # noqa: BLE001, S110 — it is gone already
            pass

    def close(self) -> None:
        """Ends all workers, and Ray where it was started here."""
        for actor in list(self._actors):
            self.end_actor(actor)
        if self._started:
            self._ray.shutdown()
            self._started = False


class _Run:
    """One pass over the items: what waits, what is under way, who does it."""

    def __init__(self, engine: OnRay, items: Iterator[Item], count: int) -> None:
        self._engine = engine
        self._ray = engine._ray
        self._died = (self._ray.exceptions.RayActorError, self._ray.exceptions.WorkerCrashedError,
                      self._ray.exceptions.ObjectLostError)  # fmt: skip
        self._items = items
        self._left = count
        #: Items that came back, with the number of times each was begun.
        self._again: deque[tuple[Item, int]] = deque()
        self._calls: dict[Any, tuple[_Actor, list[tuple[Item, int]]]] = {}
        self._mean_s: float | None = None
        self._deaths = 0
        self._since = time.monotonic()

    def new_actor(self) -> None:
        """Starts a worker; it gets items once it is there."""
        actor = self._engine.start_actor()
        call = actor.handle.ready.remote()
        actor.calls.append(call)
        self._calls[call] = (actor, [])

    def results(self) -> Iterator[Result]:
        """All results."""
        while self._calls:
            # Short enough for Ctrl-C to be seen at once.
            done, _ = self._ray.wait(list(self._calls), num_returns=1, timeout=0.5)
            if not done:
                self._check_patience()
            for call in done:
                yield from self._finish(call)

    def _finish(self, call: Any) -> Iterator[Result]:
        if call not in self._calls:
            return
        actor = self._calls[call][0]
        try:
            answer = self._ray.get(call)
        except self._died as error:
            yield from self._bury(actor, error)
            return
        except self._ray.exceptions.RayTaskError as error:
            cause = str(getattr(error, "cause", error)).strip().splitlines()[-1]
            raise CampaignError("worker-start", f"A worker failed: {cause}") from error
        batch = self._calls.pop(call)[1]
        actor.calls.remove(call)
        self._deaths = 0
        results = self._read(actor, batch, answer)
        # Work first, so that the actor does not wait while the driver writes.
        self._fill(actor)
        yield from results

    def _read(self, actor: _Actor, batch: list[tuple[Item, int]], answer: Any) -> list[Result]:
        if isinstance(answer, CampaignError):
            raise answer
        if not actor.ready:
            actor.ready = True
            return []
        results: list[Result] = answer
        self._again.extend(batch[len(results) :])
        for result in results:
            if result.own_s is not None:
                mean = self._mean_s
                self._mean_s = result.own_s if mean is None else 0.9 * mean + 0.1 * result.own_s
        return results

    def _bury(self, actor: _Actor, error: Exception) -> Iterator[Result]:
        """Takes back what a dead worker had, and starts another one."""
        self._deaths += 1
        cause = _cause_in_creation(error)
        if cause is not None or self._deaths > MOST_DEATHS:
            raise CampaignError(
                "worker-start",
                f"Workers cannot be started: {cause}"
                if cause
                else f"Workers died {self._deaths} times in a row without a result.",
                hint="Is stiffarm installed on all machines of the cluster? The logs of Ray, "
                "on this machine in /tmp/ray/session_latest/logs, say more.",
            )
        lost: list[list[tuple[Item, int]]] = []
        for call in actor.calls:
            batch = self._calls.pop(call)[1]
            try:
                # It may have ended well before the worker died.
                answer = self._ray.get(call, timeout=60)
                yield from self._read(actor, batch, answer)
            except (*self._died, self._ray.exceptions.GetTimeoutError):
                lost.append(batch)
        actor.calls.clear()
        self._engine.end_actor(actor)
        # An item of the first was running, nobody knows which; what waited behind it was not.
        for item, tries in lost[0] if lost else []:
            if tries + 1 >= TRIES:
                yield died(item.number, tries + 1)
            else:
                self._again.append((item, tries + 1))
        self._again.extend(pair for batch in lost[1:] for pair in batch)
        if self._again or self._left > 0:
            self.new_actor()

    def _fill(self, actor: _Actor) -> None:
        while len(actor.calls) < DEPTH:
            batch = self._batch()
            if not batch:
                return
            call = actor.handle.run.remote(batch)
            actor.calls.append(call)
            self._calls[call] = (actor, batch)

    def _batch(self) -> list[tuple[Item, int]]:
        # What came back goes alone: an item that a worker died with takes no other with it again.
        if self._again:
            return [self._again.popleft()]
        mean = self._mean_s
        size = 1 if mean is None else int(BATCH_S / max(mean, 1e-6))
        # Towards the end smaller ones, so that the workers end together.
        share = self._left // (DEPTH * max(1, len(self._engine._actors)))
        size = max(1, min(size, MOST, share))
        batch: list[tuple[Item, int]] = []
        for item in self._items:
            batch.append((item, 0))
            self._left -= 1
            if len(batch) >= size:
                break
        return batch

    def _check_patience(self) -> None:
        if any(actor.ready for actor in self._engine._actors):
            self._since = time.monotonic()
        elif time.monotonic() - self._since > WAIT_S:
            raise CampaignError(
                "no-cluster",
                f"Ray gave no worker within {WAIT_S:g} s.",
                hint="Are there free processors in the cluster?",
            )


def _cause_in_creation(error: Exception) -> str | None:
    """Why an actor could not even be made, or None where it died later."""
    text = str(error)
    if "creation task" not in text and "failed to be imported" not in text:
        return None
    return text.strip().splitlines()[-1].strip()
