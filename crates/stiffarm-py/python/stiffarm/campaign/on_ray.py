"""Items on Ray: an actor for each worker, which runs items in a process of its own.

The actor only watches. The process that runs the items is a child of it, the same as under the
serial engine, so limits, errors and results are the same too. An actor that dies (its node, the
memory monitor of Ray, somebody's SIGKILL) takes its child along; its items are given to another
one, each a bounded number of times.

Short items are handed over in batches of about half a second, more where there are more than a
hundred workers: a call costs the driver the same however many items it carries. Two batches are
under way for each worker, so none waits for the driver. While Ray starts on this machine, the first items run in processes of the driver.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator

from .errors import CampaignError, load
from .head_start import HeadStart
from .items import Item
from .limits import Result, Setup
from .local_ray import QUIET, LocalRay
from .ray_actors import Actors
from .ray_run import Run, Source

#: Time between two looks whether Ray has started [s].
_LOOK_S = 0.1


class OnRay:
    """The engine that runs items on Ray."""

    name = "ray"

    def __init__(self, setup: Setup, workers: int | None, address: str | None) -> None:
        """Connects to Ray, or begins to start it here.

        Args:
            setup: What the workers are told.
            workers: Number of workers; None for all processors of the machine or cluster.
            address: Address of a cluster, for example ``auto`` or ``ray://head:10001``; without
                one a Ray that this program has started already, or a new one on this machine.

        Raises:
            CampaignError: ``no-cluster`` where there is no Ray at the address.
        """
        # Nothing is reported to Ray's makers unless the user says so.
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        self._ray = load("ray", 'engine="ray"')
        self._setup = setup
        self._workers = workers
        self._connected = False
        self._local: LocalRay | None = None
        self._head: HeadStart | None = None
        self._actors: Actors | None = None
        if address is not None:
            self._connect(address)
        elif not self._ray.is_initialized():
            self._local = LocalRay(self._ray, workers)

    def _connect(self, address: str) -> None:
        try:
            if self._ray.is_initialized():
                raise ValueError("this program is connected to Ray already; leave out the address")
            self._ray.init(address=address, **QUIET)
        except (ConnectionError, ValueError, RuntimeError, OSError, ImportError) as error:
            raise _no_cluster(address, error) from error
        self._connected = True

    def results(self, items: Iterable[Item], count: int) -> Iterator[Result]:
        """Results in the order in which they come."""
        source = Source(iter(items), count)
        return source.handed_on(self._results(source))

    def _results(self, source: Source) -> Iterator[Result]:
        if self._local is not None:
            cores = os.cpu_count() or 1
            most = min(self._workers or cores, cores, source.left)
            self._head = HeadStart(self._setup, most, source.draw)
            while self._starting():
                result = self._head.next(_LOOK_S)
                if result is not None:
                    yield result
                elif not self._head.running:
                    # Everything was done before Ray was there.
                    return
        first = 0 if self._head is None else self._head.count
        self._actors = Actors(self._ray, self._setup, self._workers, first)
        yield from Run(self._ray, self._actors, source, self._head).results()

    def _starting(self) -> bool:
        assert self._local is not None
        if self._local.error is not None:
            raise _no_cluster("this machine", self._local.error) from self._local.error
        return not self._local.ready

    def close(self) -> None:
        """Ends all workers; Ray where it was started here, or the connection to it."""
        if self._head is not None:
            self._head.abort()
        if self._actors is not None:
            self._actors.close()
        if self._local is not None:
            self._local.close()
        elif self._connected:
            self._ray.shutdown()

    def wait(self) -> None:
        """Returns when Ray has ended."""
        if self._local is not None:
            self._local.wait()


def _no_cluster(address: str, error: Exception) -> CampaignError:
    first = str(error).strip().splitlines()[0] if str(error).strip() else "no answer"
    return CampaignError(
        "no-cluster", f"Ray cannot be reached at {address}: {first}", place={"key": "address"}
    )


