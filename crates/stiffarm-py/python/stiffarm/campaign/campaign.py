"""A campaign: read it, run it into a folder, look at what came out."""

from __future__ import annotations

import errno
import importlib
import json
import os
import pickle
import sys
import uuid
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import _stiffarm
from . import engines, kinds, table
from .declaration import Declaration, fingerprint, read_dict, read_toml
from .errors import CampaignError, load
from .items import Item, Items
from .journal import Journal
from .progress import Meter, Reporter
from .resources import read_resources
from .summary import Summary, summarise
from .task import COLUMNS
from .tasks import task_of
from .values import canonical
from .worker import Setup

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
    """

    folder: Path
    total: int
    done: int
    failed: int
    ran: int
    interrupted: bool

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
            CampaignError: The file cannot be read, or a key in it is unknown, of a wrong type or missing; the place has
                the path of the key.
        """
        return cls(read_toml(Path(path)))

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], folder: str | os.PathLike[str] | None = None) -> Campaign:
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
            StiffarmError: A file that it names cannot be read.
        """
        return fingerprint(self.declaration, read_resources(self.declaration)[0], _stiffarm.__version__)

    def run(
        self,
        folder: str | os.PathLike[str],
        workers: int | str = 1,
        address: str | None = None,
        time_limit_s: float | None = None,
        progress: Reporter = None,
        retry_failed: bool = False,
    ) -> Outcome:
        """Runs the items that are not done yet, and writes the tables.

        An item that raises, passes its limit or kills its worker is a row with its error, and the others go on. Ctrl-C
        ends the run with the tables of what is done, and so does a cluster without any processor: with an error.

        Args:
            folder: Folder of this campaign; made if missing. What it has of the same campaign is kept, whatever ended
                that run.
            workers: Worker processes, each with one thread and so one processor: 1 unless more are asked for; ``"all"``
                takes every processor of the machine or cluster.
            address: Address of a Ray cluster; without one the items run on this machine, without Ray.
            time_limit_s: Longest time of an item [s].
            progress: A function that gets a :class:`Progress`; None shows a line on a terminal; False is silent.
            retry_failed: Also run again what failed before.

        Returns:
            What is in the folder now.

        Raises:
            StiffarmError: ``other-campaign`` where the folder belongs to another one, ``in-use`` where another run
                writes to it, ``worker-start``, ``no-cluster``, ``missing-package``, and what is wrong with the
                arguments or the files that the campaign names.
        """
        count = None if workers == "all" else kinds.whole_from_1(workers, "workers")
        if time_limit_s is not None:
            kinds.positive(time_limit_s, "time_limit_s")
        # Better before the first item than after the last.
        for package in ["pyarrow.parquet"] + ["ray"] * (address is not None):
            load(package, "A campaign" if address is None else "A campaign on a cluster")
        files, shared = read_resources(self.declaration)
        setup = Setup(
            key=uuid.uuid4().hex,
            task=self.declaration.task,
            options=self.declaration.options,
            shared=pickle.dumps(shared),
            columns=(*COLUMNS, *table.all_axis_columns(self.declaration.axes)),
            time_limit_s=time_limit_s,
            path=tuple(folder or os.getcwd() for folder in sys.path),
        )
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        with _disk(target), _locked(target):
            self._claim(target, files)
            self._folder = target
            with Journal(target / JOURNAL, len(self)) as journal:
                again = journal.failed if retry_failed else frozenset()
                todo = [number for number in range(len(self)) if number not in journal or number in again]
                meter, interrupted = Meter(len(self), len(journal), progress), False
                engine: engines.Processes | engines.OnRay | None = None
                try:
                    if todo and address is None:
                        engine = engines.Processes(setup, min(count or os.cpu_count() or 1, len(todo)))
                    elif todo and address is not None:
                        engine = engines.OnRay(setup, count, address)
                    for record in engines.results(engine, (self.items[n] for n in todo)) if engine else ():
                        journal.append(record)
                        meter.told(len(journal), len(journal.failed))
                except KeyboardInterrupt:
                    interrupted = True
                finally:
                    if engine is not None:
                        engine.close()
                    meter.close()
                    self._write_tables(target, journal)
                failed = len(journal.failed)
                return Outcome(target, len(self), len(journal), failed, journal.added, interrupted)

    def _claim(self, folder: Path, files: Mapping[str, str]) -> None:
        """Writes whose folder this is, or checks it."""
        path, place, hint = folder / RECORD, {"file": str(folder)}, "Take a new folder."
        own = {
            "format": 1,
            "hash": fingerprint(self.declaration, files, _stiffarm.__version__),
            "version": _stiffarm.__version__,
            "declaration": self.declaration.to_dict(),
            "files": dict(files),
        }
        if path.exists():
            found = _record(path)
            if found["hash"] != own["hash"]:
                message = f"This folder belongs to another campaign: {_difference(found, own)}."
                raise CampaignError(message, "other-campaign", place, hint)
            return
        if (folder / JOURNAL).exists() and (folder / JOURNAL).stat().st_size > 0:
            message = f"This folder has a journal but no {RECORD} that says whose it is."
            raise CampaignError(message, "other-campaign", place, hint)
        with table.whole(path) as temporary:
            temporary.write_text(json.dumps(own, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")

    def _write_tables(self, folder: Path, journal: Journal) -> None:
        metadata = {
            "stiffarm.version": _stiffarm.__version__,
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
            raise CampaignError("This campaign was not run yet.", "no-table", hint="Give the folder of a run.")
        return summarise(where, self.declaration, len(self), task_of(self.declaration.task).headline)


def open_folder(folder: str | os.PathLike[str]) -> Campaign:
    """The campaign of a folder, without the file it was declared in.

    It can be looked at; to run it on, read it from its file, whose folder its file names need.

    Raises:
        CampaignError: ``no-campaign`` where the folder is none of a campaign.
    """
    campaign = Campaign.from_dict(_record(Path(folder) / RECORD)["declaration"], folder)
    campaign._folder = Path(folder)
    return campaign


def _record(path: Path) -> dict[str, Any]:
    place = {"file": str(path)}
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        message = f"This is no folder of a campaign ({error.strerror})."
        raise CampaignError(message, "no-campaign", place) from error
    except ValueError:
        record = None
    if not isinstance(record, dict) or not {"hash", "declaration", "files", "version"} <= set(record):
        raise CampaignError("This file describes no campaign.", "no-campaign", place)
    return record


def _difference(found: Mapping[str, Any], own: Mapping[str, Any]) -> str:
    """What is not the same, the first thing that a user would want to know."""
    for part, words in (("declaration", "its {} differs"), ("files", "{} was changed since")):
        old, new = found[part], own[part]
        for key in sorted({*old, *new}):
            # Axes in another order are the same here.
            if canonical(old.get(key)) != canonical(new.get(key)):
                return words.format(key)
    old_axes, new_axes = list(found["declaration"]["axes"]), list(own["declaration"]["axes"])
    if old_axes != new_axes:
        return f"its axes come in the order {', '.join(old_axes)}"
    return f"it was run with version {found['version']}, this is {own['version']}"


@contextmanager
def _locked(folder: Path) -> Generator[None, None, None]:
    """Keeps two runs from writing to one folder; the lock ends with the process."""
    try:
        fcntl: Any = importlib.import_module("fcntl")
    except ImportError:
        yield
        return
    path = folder / "lock"
    while True:
        with open(path, "ab") as file:
            try:
                fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                place, hint = {"file": str(folder)}, "Wait for it, or take another folder."
                raise CampaignError("Another run writes to this folder.", "in-use", place, hint) from error
            # A run that ended in between took its own file away, and this may be that one.
            if not path.exists() or not os.path.samestat(os.fstat(file.fileno()), path.stat()):
                continue
            try:
                yield
            finally:
                path.unlink(missing_ok=True)
            return


@contextmanager
def _disk(folder: Path) -> Generator[None, None, None]:
    """Says what the disk has against a run: what is done is kept."""
    try:
        yield
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS):
            raise
        message = f"The folder cannot be written to: {error.strerror or error}."
        hint = "What was done until then is kept: make room and run it again."
        raise CampaignError(message, "file-write", {"file": str(folder)}, hint) from error
