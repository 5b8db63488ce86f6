"""The journal of a campaign: one line for each item that is done, whole or not at all.

A line is a JSON object whose last key is a checksum of the rest. Lines are appended in one write each, so a killed
driver leaves at most one torn line at the end, which the next run cuts off. What was written survives the end of the
process at once, and a loss of power from the last sync on, once a second.
"""

from __future__ import annotations

import errno
import json
import os
import time
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .errors import CampaignError

#: Time between two syncs to the disk [s].
SYNC_S = 1.0
_MARK = b',"crc":"'


def encode(record: dict[str, Any]) -> bytes:
    """A record as a line with its checksum."""
    body = json.dumps(record, separators=(",", ":"), ensure_ascii=False).encode()[:-1]
    return body + _MARK + f"{zlib.crc32(body):08x}".encode() + b'"}\n'


def decode(line: bytes) -> dict[str, Any] | None:
    """The record of a line, or None where the line is torn or was changed."""
    body, mark, tail = line.rpartition(_MARK)
    if not mark or len(tail) != 11 or tail[8:] != b'"}\n':
        return None
    if f"{zlib.crc32(body):08x}".encode() != tail[:8]:
        return None
    try:
        record = json.loads(body + b"}")
    except ValueError:
        return None
    return record if isinstance(record, dict) and isinstance(record.get("number"), int) else None


class Journal:
    """The journal of a folder, open for reading and appending."""

    def __init__(self, path: Path, items: int, writable: bool = True) -> None:
        """Opens the journal, made if missing, and cuts off what is torn at its end.

        Args:
            path: The file.
            items: Number of items of the campaign.
            writable: False to look at it while a run may be writing to it.

        Raises:
            CampaignError: ``broken-journal`` where a line names an item that there is not.
        """
        self.path = path
        self._items = items
        self._writable = writable
        self._file = open(path, "a+b" if writable else "rb", buffering=0)  # noqa: SIM115
        self._synced = time.monotonic()
        #: Place of the last whole line of each item that is done.
        self._offsets: dict[int, int] = {}
        #: Numbers of the items whose record is an error.
        self.failed: set[int] = set()
        #: Lines added since it was opened.
        self.added = 0
        offset = end = 0
        with open(path, "rb") as file:
            for line in file:
                record = decode(line)
                # Lines that a failing disk changed are run again.
                if record is not None:
                    self._note(record, offset)
                offset += len(line)
                end = offset if line.endswith(b"\n") else end
        if end < offset and writable:
            self._file.truncate(end)

    def _note(self, record: dict[str, Any], offset: int) -> None:
        number = record["number"]
        if not 0 <= number < self._items:
            message = f"It has item {number}; the campaign has {self._items}."
            raise CampaignError(message, "broken-journal", {"file": str(self.path)})
        self._offsets[number] = offset
        if "code" in record:
            self.failed.add(number)
        else:
            self.failed.discard(number)

    def append(self, record: dict[str, Any]) -> None:
        """Adds the record of an item, to be synced within about a second.

        Raises:
            OSError: The disk is full or gone; nothing of the line stays.
        """
        line = encode(record)
        offset = self._file.seek(0, os.SEEK_END)
        try:
            written = self._file.write(line)
            if written != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self.path))
        except OSError:
            self._file.truncate(offset)
            raise
        self._note(record, offset)
        self.added += 1
        if time.monotonic() - self._synced >= SYNC_S:
            os.fsync(self._file.fileno())
            self._synced = time.monotonic()

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *error: object) -> None:
        if self._writable:
            os.fsync(self._file.fileno())
        self._file.close()

    def __len__(self) -> int:
        return len(self._offsets)

    def __contains__(self, number: object) -> bool:
        return number in self._offsets

    def records(self) -> Iterator[dict[str, Any]]:
        """The last record of each item that is done, in the order of the items."""
        with open(self.path, "rb") as file:
            for number in sorted(self._offsets):
                file.seek(self._offsets[number])
                record = decode(file.readline())
                if record is not None:
                    yield record
