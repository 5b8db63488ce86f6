"""What an engine is, the serial one, and the choice between it and Ray."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable, Iterator
from typing import Protocol

from .errors import INSTALL, CampaignError
from .items import Item
from .limits import Result, Setup, Worker

ENGINES = ("auto", "serial", "ray")


class Engine(Protocol):
    """Runs items and hands back what became of each, in the order in which they end."""

    name: str

    def results(self, items: Iterable[Item], count: int) -> Iterator[Result]:
        """Results of ``count`` items."""
        ...

    def close(self) -> None:
        """Ends all workers."""
        ...

    def wait(self) -> None:
        """Returns when everything that :meth:`close` ended is gone."""
        ...


class Serial:
    """One item after the other, in one worker process."""

    name = "serial"

    def __init__(self, setup: Setup) -> None:
        self._worker = Worker(setup)

    def results(self, items: Iterable[Item], count: int) -> Iterator[Result]:
        """Results in the order of the items."""
        for item in items:
            yield self._worker.run(item)

    def close(self) -> None:
        """Ends the worker process."""
        self._worker.close()

    def wait(self) -> None:
        """Nothing is left after :meth:`close`."""


def ray_installed() -> bool:
    """Whether Ray can be imported here."""
    return importlib.util.find_spec("ray") is not None


def choose(engine: str, workers: int | str, address: str | None) -> tuple[str, int | None]:
    """``serial`` or ``ray``, and the number of workers, None for all processors.

    ``auto`` is Ray where there is use for it: an address, or more than one worker.

    Raises:
        CampaignError: ``unknown-name``, ``invalid-value``, ``no-ray``, ``conflict``.
    """
    if engine not in ENGINES:
        raise CampaignError(
            "unknown-name", f"There is no engine {engine!r}.", hint=f"Known: {', '.join(ENGINES)}."
        )
    count = workers if isinstance(workers, int) and not isinstance(workers, bool) else None
    if workers != "all" and (count is None or count < 1):
        raise CampaignError(
            "invalid-value", f"Workers are a number from 1, or 'all'; not {workers!r}.", place={"key": "workers"}
        )
    several = count != 1
    if engine == "serial" and (address is not None or several):
        given = "an address" if address is not None else f"{workers} workers"
        raise CampaignError(
            "conflict",
            f"The serial engine runs one item after the other and has no use for {given}.",
            hint='Leave it out, or take engine="ray".',
        )
    if engine == "serial" or (engine == "auto" and address is None and not several):
        return "serial", count
    if not ray_installed():
        raise CampaignError(
            "no-ray",
            "Ray is not installed here, so items can only be run one after the other.",
            hint=f'{INSTALL} installs Ray; engine="serial" does without.',
        )
    return "ray", count


def make(name: str, setup: Setup, workers: int | None, address: str | None) -> Engine:
    """The engine of that name.

    Raises:
        CampaignError: Ray cannot be started, or the cluster not be reached.
    """
    if name == "serial":
        return Serial(setup)
    from .on_ray import OnRay

    return OnRay(setup, workers, address)
