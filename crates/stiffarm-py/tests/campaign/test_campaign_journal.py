"""The journal: lines are whole or not there."""

from __future__ import annotations

from pathlib import Path

import pytest

from stiffarm.campaign import CampaignError
from stiffarm.campaign.journal import Journal, decode, encode


def record(number: int) -> dict[str, object]:
    return {"number": number, "figures": {"value": 0.1 + number, "words": 'a "crc":"x"\n'}}


def filled(path: Path) -> bytes:
    with Journal(path, 10) as journal:
        for number in (4, 0, 7):
            journal.append(record(number))
    return path.read_bytes()


def test_records_come_back_in_the_order_of_the_items(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    filled(path)
    with Journal(path, 10) as journal:
        assert list(journal.records()) == [record(0), record(4), record(7)]
        assert len(journal) == 3
        assert 4 in journal and 5 not in journal


def test_a_line_torn_anywhere_is_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    whole = filled(path)
    start = whole.rindex(b'{"number":7')
    for end in range(start, len(whole)):
        path.write_bytes(whole[:end])
        with Journal(path, 10) as journal:
            assert [r["number"] for r in journal.records()] == [0, 4]
            journal.append(record(9))
        with Journal(path, 10) as journal:
            assert list(journal.records()) == [record(0), record(4), record(9)]


def test_looking_at_a_journal_does_not_change_it(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    torn = filled(path)[:-5]
    path.write_bytes(torn)
    with Journal(path, 10, writable=False) as journal:
        assert len(journal) == 2
    assert path.read_bytes() == torn


def test_a_changed_line_is_dropped_and_the_others_stay(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    whole = filled(path)
    path.write_bytes(whole.replace(b"0.1", b"0.2", 1))
    with Journal(path, 10) as journal:
        assert len(journal) == 2


def test_every_change_of_a_byte_is_seen() -> None:
    line = encode(record(3))
    assert decode(line) == record(3)
    for place in range(len(line)):
        changed = bytearray(line)
        changed[place] ^= 1
        assert decode(bytes(changed)) is None


def test_the_last_record_of_an_item_counts(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    with Journal(path, 10) as journal:
        journal.append({"number": 2, "code": "time-limit", "message": "…"})
        assert journal.failed == {2}
        journal.append(record(2))
        assert journal.failed == set()
    with Journal(path, 10) as journal:
        assert list(journal.records()) == [record(2)]
        assert journal.failed == set()


def test_an_item_that_there_is_not_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    filled(path)
    with pytest.raises(CampaignError, match="item 7"):
        Journal(path, 5)
