"""One pass over the items on Ray: what waits, what is under way, who does it."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any

from .errors import CampaignError
from .head_start import HeadStart
from .items import Item
from .limits import TRIES, Result, died
from .ray_actors import Actor, Actors, Batch

#: Own time of the items of a batch, at least [s].
BATCH_S = 0.5
#: The same for each worker: a call costs the driver 1.5 ms, however many items it carries, and
#: there is one driver for all workers [s].
BATCH_EACH_S = 0.004
#: Most items of a batch.
MOST = 256
#: Batches under way for each worker, the running one included.
DEPTH = 2
#: Deaths of workers, one after the other without any result, after which the run ends: so many and
#: all workers once, since those of a machine that goes die together.
MOST_DEATHS = 20
#: Time without any living worker after which the run ends [s].
WAIT_S = 600.0


class Source:
    """The items that nobody has begun, for whoever asks, and how many have no result yet."""

    def __init__(self, items: Iterator[Item], count: int) -> None:
        self._items = items
        self._lock = threading.Lock()
        #: How many nobody has begun.
        self.left = count
        #: How many have no result yet.
        self.undone = count

    def draw(self) -> Item | None:
        """The next item, or None at the end."""
        with self._lock:
            item = next(self._items, None)
            self.left = self.left - 1 if item is not None else 0
            return item

    def handed_on(self, results: Iterable[Result]) -> Iterator[Result]:
        """The results, counted: when the last item has one there is nothing to wait for."""
        for result in results:
            self.undone -= 1
            yield result


class Run:
    """One pass over the items with a set of actors."""

    def __init__(self, ray: Any, actors: Actors, source: Source, head: HeadStart | None) -> None:
        self._ray = ray
        self._died = (
            ray.exceptions.RayActorError,
            ray.exceptions.WorkerCrashedError,
            ray.exceptions.ObjectLostError,
        )
        self._actors = actors
        self._source = source
        self._head = head
        #: Items that came back, with the number of times each was begun.
        self._again: deque[tuple[Item, int]] = deque()
        self._calls: dict[Any, tuple[Actor, Batch]] = {}
        self._mean_s: float | None = None
        self._deaths = 0
        self._since = time.monotonic()

    def _new_actor(self) -> None:
        """Starts a worker; it gets items once it is there."""
        actor = self._actors.start()
        call = actor.handle.ready.remote()
        actor.calls.append(call)
        self._calls[call] = (actor, [])

    def results(self) -> Iterator[Result]:
        """Results as they come, those of the head start too, until every item has one.

        A worker that is asked for and does not come is not waited for: those that live do the work.
        """
        for _ in range(min(self._actors.wanted, self._source.left)):
            self._new_actor()
        while self._source.undone > 0:
            early = self._head is not None and self._head.running
            if self._head is not None and early:
                first = self._head.next(0.0 if self._calls else 0.5)
                if first is not None:
                    yield first
            if self._calls:
                # Short enough for Ctrl-C to be seen at once.
                done, _ = self._ray.wait(list(self._calls), num_returns=1, timeout=0.05 if early else 0.5)
                if done:
                    # All that are there by now: looking costs as much as there are workers.
                    done, _ = self._ray.wait(list(self._calls), num_returns=len(self._calls), timeout=0)
                for call in done:
                    yield from self._finish(call)
            self._hand_back()
            self._check_patience()

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

    def _read(self, actor: Actor, batch: Batch, answer: Any) -> list[Result]:
        if isinstance(answer, CampaignError):
            raise answer
        if not actor.ready:
            actor.ready = True
            if self._head is not None:
                self._head.stop_one()
            return []
        results: list[Result] = answer
        self._again.extend(batch[len(results) :])
        for result in results:
            if result.own_s is not None:
                mean = self._mean_s
                self._mean_s = result.own_s if mean is None else 0.9 * mean + 0.1 * result.own_s
        return results

    def _bury(self, actor: Actor, error: Exception) -> Iterator[Result]:
        """Takes back what a dead worker had, and starts another one."""
        self._deaths += 1
        cause = _cause_in_creation(error)
        if cause is not None or self._deaths > MOST_DEATHS + self._actors.wanted:
            raise CampaignError(
                "worker-start",
                f"Workers cannot be started: {cause}"
                if cause
                else f"Workers died {self._deaths} times in a row without a result.",
                hint="Is stiffarm installed on all machines of the cluster? The logs of Ray, "
                "on this machine in /tmp/ray/session_latest/logs, say more.",
            )
        lost: list[Batch] = []
        for call in actor.calls:
            batch = self._calls.pop(call)[1]
            try:
                # It may have ended well before the worker died.
                answer = self._ray.get(call, timeout=60)
                yield from self._read(actor, batch, answer)
            except (*self._died, self._ray.exceptions.GetTimeoutError):
                lost.append(batch)
        actor.calls.clear()
        self._actors.end(actor)
        # An item of the first was running, nobody knows which; what waited behind it was not.
        for item, tries in lost[0] if lost else []:
            if tries + 1 >= TRIES:
                yield died(item.number, tries + 1)
            else:
                self._again.append((item, tries + 1))
        self._again.extend(pair for batch in lost[1:] for pair in batch)
        if self._again or self._source.left > 0:
            self._new_actor()

    def _hand_back(self) -> None:
        """Gives what came back to workers that have nothing else to do."""
        for actor in self._actors.all:
            if not self._again:
                return
            if actor.ready:
                self._fill(actor)

    def _fill(self, actor: Actor) -> None:
        while len(actor.calls) < DEPTH:
            batch = self._batch()
            if not batch:
                return
            # Longer than planned where items take longer than those before.
            call = actor.handle.run.remote(batch, 4 * self._batch_s())
            actor.calls.append(call)
            self._calls[call] = (actor, batch)

    def _batch_s(self) -> float:
        return max(BATCH_S, BATCH_EACH_S * len(self._actors.all))

    def _batch(self) -> Batch:
        # What came back goes alone: an item that a worker died with takes no other with it again.
        if self._again:
            return [self._again.popleft()]
        mean = self._mean_s
        size = 1 if mean is None else int(self._batch_s() / max(mean, 1e-6))
        # Towards the end smaller ones, so that the workers end together.
        share = self._source.left // (DEPTH * max(1, len(self._actors.all)))
        size = max(1, min(size, MOST, share))
        batch: Batch = []
        while len(batch) < size and (item := self._source.draw()) is not None:
            batch.append((item, 0))
        return batch

    def _check_patience(self) -> None:
        early = self._head is not None and self._head.running
        if early or any(actor.ready for actor in self._actors.all):
            self._since = time.monotonic()
        elif time.monotonic() - self._since > WAIT_S:
            raise CampaignError(
                "no-cluster",
                f"Ray gave no worker within {WAIT_S:g} s; {self._source.undone} items are left.",
                hint="Are there free processors in the cluster? Running it again does what is left.",
            )


def _cause_in_creation(error: Exception) -> str | None:
    """Why an actor could not even be made, or None where it died later."""
    text = str(error)
    if "creation task" not in text and "failed to be imported" not in text:
        return None
    return text.strip().splitlines()[-1].strip()
