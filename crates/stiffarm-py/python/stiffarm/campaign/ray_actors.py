"""Workers on Ray: actors, each of which watches a process that runs items."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from typing import Any

from .errors import CampaignError
from .items import Item
from .limits import Result, Setup, Worker

#: Items, each with the number of times it was begun before.
Batch = list[tuple[Item, int]]


class Supervisor:
    """The actor: runs batches of items."""

    def __init__(self, setup: Setup, number: int) -> None:
        self._worker = Worker(setup, number)

    def ready(self) -> int:
        """Process id, once the actor is there."""
        return os.getpid()

    def run(self, batch: Batch, longest_s: float) -> list[Result] | CampaignError:
        """Results of the first items of a batch.

        Args:
            batch: The items.
            longest_s: Time after which the others go back, so that results come in and other
                workers can take them [s].
        """
        begun = time.monotonic()
        results: list[Result] = []
        try:
            for item, tries in batch:
                results.append(self._worker.run(item, tries))
                if time.monotonic() - begun > longest_s:
                    break
        except CampaignError as error:
            return error
        return results


@dataclass
class Actor:
    """An actor as the driver sees it: its handle, and its calls, oldest first."""

    handle: Any
    ready: bool = False
    calls: list[Any] = field(default_factory=list)


class Actors:
    """The actors of a run."""

    def __init__(self, ray: Any, setup: Setup, count: int | None, first: int) -> None:
        """Nothing is started yet.

        Args:
            ray: The package, connected.
            setup: What the workers are told.
            count: How many are wanted; None for all processors.
            first: Number of the first worker.
        """
        self._ray = ray
        self._setup = ray.put(setup)
        self._class = ray.remote(num_cpus=1, max_restarts=0)(Supervisor)
        self._number = first
        self.wanted = count or max(1, int(ray.cluster_resources().get("CPU", 1)))
        self.all: list[Actor] = []

    def start(self) -> Actor:
        """Asks Ray for one more."""
        actor = Actor(self._class.remote(self._setup, self._number))
        self._number += 1
        self.all.append(actor)
        return actor

    def end(self, actor: Actor) -> None:
        """Ends one."""
        self.all.remove(actor)
        try:
            self._ray.kill(actor.handle)
        except Exception:  # noqa: BLE001, S110 — it is gone already
            pass

    def close(self) -> None:
        """Ends all."""
        for actor in list(self.all):
            self.end(actor)
