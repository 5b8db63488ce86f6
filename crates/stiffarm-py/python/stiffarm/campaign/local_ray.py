"""A Ray on this machine, started and ended beside the work.

Ray's processes end with the thread that started them, so one thread does it all: starts Ray, waits,
ends it. Meanwhile items run and tables are written.
"""

from __future__ import annotations

import threading
from typing import Any

#: The object store holds the setup alone; items travel in messages [bytes].
_STORE = 100_000_000
QUIET = {"log_to_driver": False, "logging_level": "ERROR"}


class LocalRay:
    """A Ray of this program."""

    def __init__(self, ray: Any, workers: int | None) -> None:
        self._ray = ray
        self._workers = workers
        self._ready = threading.Event()
        self._closing = threading.Event()
        #: What went wrong at the start.
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._live, daemon=True, name="ray")
        self._thread.start()

    def _live(self) -> None:
        try:
            self._ray.init(
                address="local",
                num_cpus=self._workers,
                include_dashboard=False,
                object_store_memory=_STORE,
                **QUIET,
            )
        except Exception as error:  # noqa: BLE001 — told by the thread that waits for it
            self.error = error
            return
        finally:
            self._ready.set()
        self._closing.wait()
        self._ray.shutdown()

    @property
    def ready(self) -> bool:
        """Whether it has started, or failed to."""
        return self._ready.is_set()

    def close(self) -> None:
        """Lets it end; :meth:`wait` says when it has."""
        self._closing.set()

    def wait(self) -> None:
        """Returns when all of it is gone."""
        self._thread.join()
