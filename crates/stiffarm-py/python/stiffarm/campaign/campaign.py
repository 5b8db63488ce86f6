"""A campaign: read it, run it into a folder, look at what came out."""

from __future__ import annotations

import importlib
import json
import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

from . import engine as engines
from . import table
from .declaration import Declaration, fingerprint, read_dict, read_toml
from .errors import CampaignError, load
from .items import Item, Items
from .journal import Journal
from .limits import Setup
from .progress import Meter, Reporter
from .resources import pickled, read_files, read_resources, version
from .summary import Summary, summarise
from .tasks import COLUMNS, task_of
from .values import canonical

RECORD = "campaign.json"
JOURNAL = "journal.jsonl"


@dataclass(frozen=True)
class Outcome:
    """What a run left in its folder.

    Attributes:
        folder: The folder.
        total: Items of the campaign.
        done: Items done, in earlier runs too.
        failed: How many of them failed.
        ran: Items that this run added.
        interrupted: Whether Ctrl-C ended it.
        engine: ``serial`` or ``ray``, or None where nothing was left to run.
    """

    folder: Path
    total: int
    done: int
    failed: int
    ran: int
    interrupted: bool
    engine: str | None

    @property
    def complete(self) -> bool:
        """Whether every item is done, well or not."""
        return self.done == self.total

    @property
    def results(self) -> Path:
        """The table of results."""
        return self.folder / "results.parquet"

    @property
    def timings(self) -> Path:
        """The table of times."""
        return self.folder / "timings.parquet"


class Campaign:
    """A declared grid of items and the task that each is given.

    >>> campaign = Campaign.from_dict({
    ...     "name": "indices",
    ...     "task": "select",
    ...     "axes": {"cell": "builtin:comau", "index": ["novel", "expected_error"],
    ...              "seed": {"first": 1, "last": 5}},
    ...     "options": {"rounds": 2},
    ... })
    >>> len(campaign)
    10
    >>> campaign.items[0].name
    'cell=builtin:comau,index=novel,seed=1'
    """

    def __init__(self, declaration: Declaration) -> None:
        self.declaration = declaration
        self.items = Items(declaration)
        self._folder: Path | None = None

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Campaign:
        """A campaign from a TOML file; file names in it start from its folder.

        Raises:
            CampaignError: The file cannot be read, or a key in it is unknown, of a wrong type or
                missing; the place has the path of the key.
        """
        return cls(read_toml(Path(path)))

    @classmethod
    def from_dict(
        cls, data: Mapping[str, Any], folder: str | os.PathLike[str] | None = None
    ) -> Campaign:
        """A campaign from a dict with the keys of the TOML file.

        Args:
            data: The keys.
            folder: Folder that file names start from; the current one by default.

        Raises:
            CampaignError: As for :meth:`read`.
        """
        return cls(read_dict(data, None if folder is None else Path(folder)))

    @property
    def name(self) -> str:
        """Name of the campaign."""
        return self.declaration.name

    def __len__(self) -> int:
        return len(self.items)

    def __iter__(self) -> Iterator[Item]:
        return iter(self.items)

    def __repr__(self) -> str:
        axes = " × ".join(f"{len(v)} {name}" for name, v in self.declaration.axes.items())
        return f"<Campaign {self.name!r}: {self.declaration.task}, {axes} = {len(self)} items>"

    @property
    def hash(self) -> str:
        """Hash of the declaration, the files it names and the version of the package.

        Raises:
            CampaignError: A file that it names cannot be read.
        """
        return fingerprint(self.declaration, read_files(self.declaration), version())

    def run(
        self,
        folder: str | os.PathLike[str],
        workers: int | str = 1,
        address: str | None = None,
        engine: str = "auto",
        time_limit_s: float | None = None,
        memory_limit_mb: float | None = None,
        progress: Reporter = None,
        retry_failed: bool = False,
    ) -> Outcome:
        """Runs the items that are not done yet, and writes the tables.

        An item that raises, passes a limit or kills its worker is a row with its error, and the
        others go on. Ctrl-C ends the run with the tables of what is done, and so does a cluster
        that gives no worker any more: with an error.

        Args:
            folder: Folder of this campaign; made if missing. What it has of the same campaign is
                kept, whatever ended that run.
            workers: Worker processes, each with one thread and so one processor: 1 unless more are
                asked for; ``"all"`` takes every processor of the machine or cluster.
            address: Address of a Ray cluster.
            engine: ``serial``, ``ray``, or ``auto``: Ray where there is an address or more than one
                worker is asked for.
            time_limit_s: Longest time of an item [s]; then its worker is ended.
            memory_limit_mb: Most memory of a worker process [MB]; then it is ended.
            progress: A function that gets a :class:`Progress`; None shows a line on a terminal;
                False is silent.
            retry_failed: Also run again what failed before.

        Returns:
            What is in the folder now.

        Raises:
            CampaignError: ``other-campaign`` where the folder belongs to another one, ``in-use``
                where another run writes to it, ``no-ray``, ``no-cluster``, ``missing-package``, and
                what is wrong with the files the campaign names.
        """
        for limit, name in ((time_limit_s, "time_limit_s"), (memory_limit_mb, "memory_limit_mb")):
            if limit is not None and not limit > 0:
                raise CampaignError(
                    "invalid-value", f"A limit must be above 0, not {limit}.", place={"key": name}
                )
        chosen, count = engines.choose(engine, workers, address)
        # Better before the first item than after the last.
        load("pyarrow.parquet", "The table of results")
        resources = read_resources(self.declaration)
        setup = Setup(
            task=self.declaration.task,
            options=self.declaration.options,
            shared=pickled(resources.shared),
            axis_columns=(*COLUMNS, *table.all_axis_columns(self.declaration.axes)),
            time_limit_s=time_limit_s,
            memory_limit_mb=memory_limit_mb,
            path=tuple(p or os.getcwd() for p in sys.path),
        )
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        with _locked(target):
            self._claim(target, resources.files)
            self._folder = target
            with Journal(target / JOURNAL, len(self)) as journal, ExitStack() as ending:
                again = journal.failed if retry_failed else frozenset()
                todo = [n for n in range(len(self)) if n not in journal or n in again]
                make = partial(engines.make, chosen, setup, count, address)
                try:
                    interrupted = self._work(journal, todo, make, progress, ending)
                except CampaignError:
                    self._write_tables(target, journal)
                    raise
                self._write_tables(target, journal)
                return Outcome(
                    folder=target,
                    total=len(self),
                    done=len(journal),
                    failed=journal.failures,
                    ran=journal.added,
                    interrupted=interrupted,
                    engine=chosen if todo else None,
                )

    def _work(
        self,
        journal: Journal,
        todo: list[int],
        make: Callable[[], engines.Engine],
        progress: Reporter,
        ending: ExitStack,
    ) -> bool:
        """Runs items into the journal; whether Ctrl-C ended it."""
        if not todo:
            return False
        meter = Meter(len(self), len(journal), journal.failures, progress)
        running: engines.Engine | None = None
        try:
            running = make()
            # Engines take their time to end; the tables are written meanwhile.
            ending.callback(running.wait)
            for result in running.results((self.items[n] for n in todo), len(todo)):
                new = result.number not in journal
                journal.append(result.to_dict())
                meter.count(new, journal.failures)
        except KeyboardInterrupt:
            return True
        finally:
            if running is not None:
                running.close()
            meter.close()
        return False

    def _claim(self, folder: Path, files: Mapping[str, str]) -> None:
        """Writes whose folder this is, or checks it."""
        path = folder / RECORD
        own = {
            "format": 1,
            "hash": fingerprint(self.declaration, files, version()),
            "version": version(),
            "declaration": self.declaration.to_dict(),
            "files": dict(files),
        }
        if path.exists():
            found = _record(path)
            if found["hash"] != own["hash"]:
                raise CampaignError(
                    "other-campaign",
                    f"This folder belongs to another campaign: {_difference(found, own)}.",
                    place={"file": str(folder)},
                    hint="Take a new folder.",
                )
            return
        if (folder / JOURNAL).exists() and (folder / JOURNAL).stat().st_size > 0:
            raise CampaignError(
                "other-campaign",
                f"This folder has a journal but no {RECORD} that says whose it is.",
                place={"file": str(folder)},
                hint="Take a new folder.",
            )
        write_whole(path, json.dumps(own, indent=1, ensure_ascii=False).encode() + b"\n")

    def _write_tables(self, folder: Path, journal: Journal) -> None:
        metadata = {
            "stiffarm.version": version(),
            "stiffarm.campaign": self.name,
            "stiffarm.campaign_hash": str(_record(folder / RECORD)["hash"]),
            "stiffarm.declaration": json.dumps(self.declaration.to_dict(), ensure_ascii=False),
            "stiffarm.items": str(len(self)),
        }
        table.write_results(folder, self.items, self.declaration.axes, journal, metadata)
        table.write_timings(folder, journal)

    def summary(self, folder: str | os.PathLike[str] | None = None) -> Summary:
        """Counts, failures and figures by the values of each axis.

        Args:
            folder: Folder of a run; that of the last :meth:`run` by default.

        Raises:
            CampaignError: ``no-table`` where nothing was run there.
        """
        where = self._folder if folder is None else Path(folder)
        if where is None:
            raise CampaignError(
                "no-table", "This campaign was not run yet.", hint="Give the folder of a run."
            )
        headline = task_of(self.declaration.task).headline
        return summarise(where, self.declaration, len(self), headline)


def open_folder(folder: str | os.PathLike[str]) -> Campaign:
    """The campaign of a folder, without the file it was declared in.

    It can be looked at; to run it on, read it from its file, whose folder its file names need.

    Raises:
        CampaignError: ``no-campaign`` where the folder is none of a campaign.
    """
    campaign = Campaign.from_dict(_record(Path(folder) / RECORD)["declaration"], folder)
    campaign._folder = Path(folder)
    return campaign


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file by another name first, so that it is there whole or not at all."""
    temporary = path.with_name(path.name + ".part")
    with open(temporary, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)


def _record(path: Path) -> dict[str, Any]:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(record, dict) and {"hash", "declaration", "files", "version"} <= set(record):
            return record
    except OSError as error:
        raise CampaignError(
            "no-campaign", f"This is no folder of a campaign ({error.strerror}).", place={"file": str(path)}
        ) from error
    except ValueError:
        pass
    raise CampaignError("no-campaign", "This file describes no campaign.", place={"file": str(path)})


def _difference(found: Mapping[str, Any], own: Mapping[str, Any]) -> str:
    """What is not the same, the first thing that a user would want to know."""
    for key in sorted({*found["declaration"], *own["declaration"]}):
        old, new = found["declaration"].get(key), own["declaration"].get(key)
        if canonical(old) != canonical(new):
            return f"its {key} differs"
    old_axes, new_axes = list(found["declaration"]["axes"]), list(own["declaration"]["axes"])
    if old_axes != new_axes:
        return f"its axes come in the order {', '.join(old_axes)}"
    for name in sorted({*found["files"], *own["files"]}):
        if found["files"].get(name) != own["files"].get(name):
            return f"{name} was changed since"
    return f"it was run with version {found['version']}, this is {own['version']}"


@contextmanager
def _locked(folder: Path) -> Generator[None, None, None]:
    """Keeps two runs from writing to one folder; the lock ends with the process."""
    try:
        fcntl: Any = importlib.import_module("fcntl")
    except ImportError:
        yield
        return
    file: BinaryIO
    with open(folder / "lock", "ab") as file:
        try:
            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise CampaignError(
                "in-use",
                "Another run writes to this folder.",
                place={"file": str(folder)},
                hint="Wait for it, or take another folder.",
            ) from error
        yield

