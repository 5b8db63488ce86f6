"""Runs on this machine: equal bytes, limits, errors, resuming, folders."""

from __future__ import annotations

import errno
import importlib
import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet
import pytest
from campaign_helpers import (
    WAYS,
    alive,
    begun_items,
    command,
    finish,
    journal_numbers,
    kill,
    lines,
    rows,
    serially,
    sha,
    slow,
    wait_until,
)

from stiffarm import StiffarmError
from stiffarm.campaign import Campaign, CampaignError, Progress
from stiffarm.campaign.journal import Journal
from stiffarm.campaign.table import write_results

#: The module that the class of the same package hides.
campaign_module = importlib.import_module("stiffarm.campaign.campaign")

def test_the_table_has_axes_status_and_figures(grid: dict[str, Any], tmp_path: Path) -> None:
    campaign = Campaign.from_dict(grid)
    outcome = campaign.run(tmp_path / "a", progress=False)
    assert (outcome.total, outcome.done, outcome.failed, outcome.ran) == (24, 24, 0, 24)
    assert outcome.complete and not outcome.interrupted
    table = parquet.read_table(outcome.results)
    assert table.column_names == [
        "item", "id", "name", "n", "index", "seed", "status", "error_code", "error_message",
        "index_value", "evaluations", "fine", "termination", "postures_deg", "margin_mm",
    ]  # fmt: skip
    types = {field.name: str(field.type) for field in table.schema}
    assert types["index_value"] == types["margin_mm"] == "double"
    assert types["evaluations"] == types["n"] == "int64"
    assert types["fine"] == "bool"
    assert types["postures_deg"].startswith("list<")
    from campaign_tasks import smooth

    for item, row in zip(campaign, table.to_pylist()):
        figures = smooth(**item.values, scale=2.0)
        assert {**item.values, **figures}.items() <= row.items()
        assert (row["item"], row["id"], row["name"]) == (item.number, item.id, item.name)
        assert row["margin_mm"] == figures.get("margin_mm")
    metadata = table.schema.metadata
    assert metadata[b"stiffarm.campaign_hash"].decode() == campaign.hash
    assert json.loads(metadata[b"stiffarm.declaration"]) == campaign.declaration.to_dict()
    assert metadata[b"stiffarm.items"] == b"24"


def test_the_same_grid_gives_the_same_bytes(grid: dict[str, Any], tmp_path: Path) -> None:
    for name, workers in (("a", 1), ("b", 2)):
        Campaign.from_dict(grid).run(tmp_path / name, workers=workers, progress=False)
    assert sha(tmp_path / "a") == sha(tmp_path / "b")
    grid["options"]["scale"] = 2.5
    Campaign.from_dict(grid).run(tmp_path / "c", progress=False)
    assert sha(tmp_path / "a") != sha(tmp_path / "c")


def test_what_goes_wrong_is_a_row_and_the_rest_goes_on(wild: Path) -> None:
    by_way = {row["way"]: row for row in rows(wild)}
    expected = {
        "raises": ("task-error", "ValueError: seed 2 at <object object at 0x…>"),
        "refuses": ("invalid_value", "The load is none."),
        "exits": ("task-error", "SystemExit: 3"),
        "dies": ("worker-died", "The worker died 3 times while it ran this item."),
        "hangs": ("time-limit", "It took longer than its limit of 1 s."),
        "swallows": ("time-limit", "It took longer than its limit of 1 s."),
        "asks": ("out-of-memory", "There was not enough memory."),
        "no_dict": ("bad-result", "The task returned list, not a dict."),
        "takes_a_column": ("bad-result", "A figure has the name seed, which is a column already."),
        "an_object": (
            "bad-result",
            "The figure value is of type object; text, numbers and lists of them can be kept.",
        ),
        "not_a_number": ("bad-result", "The figure list is nan; a number is finite, and None where there is none."),
        "infinite": ("bad-result", "The figure value is -inf; a number is finite, and None where there is none."),
    }
    for way in WAYS:
        row = by_way[way]
        if way in expected:
            assert row["status"] == "failed"
            assert (row["error_code"], row["error_message"]) == expected[way]
            assert row["value"] is None
        else:
            assert row["status"] == "ok" and row["value"] == 2.0 and row["nothing"] is None
    journal = {one["number"]: one for one in map(json.loads, (wild / "journal.jsonl").read_text().splitlines())}
    assert "in wild" in journal[WAYS.index("raises")]["detail"]["traceback"]
    assert journal[WAYS.index("refuses")]["detail"]["hint"] == "Do not."


def test_without_limits_an_item_may_take_its_time(tmp_path: Path) -> None:
    data = {"name": "a", "task": "campaign_tasks:slow", "axes": {"seed": [1]}, "options": {"time_s": 1.2}}
    assert Campaign.from_dict(data).run(tmp_path, progress=False).failed == 0


def test_what_is_done_is_not_run_again(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    campaign = Campaign.read(slow(tmp_path / "c.toml", 4, 0.0, begun))
    folder = tmp_path / "a"
    assert campaign.run(folder, progress=False).ran == 4
    before = sha(folder)
    (folder / "results.parquet").unlink()
    again = campaign.run(folder, progress=False)
    assert (again.ran, again.done) == (0, 4)
    assert lines(begun) == 4
    assert sha(folder) == before


def test_what_failed_is_run_again_when_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = {"name": "a", "task": "campaign_tasks:slow", "axes": {"seed": [1, 2]}, "options": {"time_s": 0.5}}
    campaign = Campaign.from_dict(data)
    folder = tmp_path / "a"
    assert campaign.run(folder, progress=False, time_limit_s=0.1).failed == 2
    assert campaign.run(folder, progress=False).failed == 2
    monkeypatch.setenv("CAMPAIGN_TEST_HURRY", "1")
    outcome = campaign.run(folder, progress=False, retry_failed=True)
    assert (outcome.failed, outcome.done, outcome.ran) == (0, 2, 2)
    campaign.run(tmp_path / "b", progress=False)
    assert sha(folder) == sha(tmp_path / "b")


def test_the_driver_killed_loses_only_what_was_under_way(tmp_path: Path) -> None:
    folder, begun = tmp_path / "a", tmp_path / "begun"
    campaign = slow(tmp_path / "c.toml", 30, 0.05, begun)
    driver = command("run", campaign, folder)
    wait_until(lambda: lines(folder / "journal.jsonl") >= 8)
    kill(driver.pid)
    driver.communicate()
    worker = next(begun_items(begun))[1]
    wait_until(lambda: not alive(worker), 5.0)
    done = journal_numbers(folder)
    assert not (folder / "results.parquet").exists()
    # As a crash in the middle of a line would leave it.
    with open(folder / "journal.jsonl", "ab") as file:
        file.write(b'{"number":29,"figures":{"val')
    code, out, _ = finish("run", campaign, folder)
    assert code == 0 and "30 of 30 items, 0 failed" in out
    times = [seed - 1 for seed, _ in begun_items(begun)]
    assert all(times.count(number) == 1 for number in done)
    assert len(times) <= 31
    assert sorted(journal_numbers(folder)) == list(range(30))
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_a_worker_killed_from_outside_has_its_item_run_again(tmp_path: Path) -> None:
    folder, begun = tmp_path / "a", tmp_path / "begun"
    campaign = slow(tmp_path / "c.toml", 12, 0.1, begun)
    driver = command("run", campaign, folder)
    wait_until(lambda: lines(begun) >= 4)
    kill(list(begun_items(begun))[-1][1])
    assert driver.wait(30) == 0
    driver.communicate()
    assert [row["status"] for row in rows(folder)] == ["ok"] * 12
    assert sum(parquet.read_table(folder / "timings.parquet")["tries"].to_pylist()) == 13
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_ctrl_c_leaves_the_table_of_what_is_done(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 200, 0.05), tmp_path / "a"
    driver = command("run", campaign, folder)
    wait_until(lambda: lines(folder / "journal.jsonl") >= 3)
    driver.send_signal(signal.SIGINT)
    out, err = driver.communicate(timeout=20)
    assert driver.returncode == 130
    assert out.startswith("Interrupted. ") and "Traceback" not in err
    done = rows(folder)
    assert [row["item"] for row in done] == sorted(journal_numbers(folder))
    assert 3 <= len(done) < 200


def test_nothing_done_is_an_empty_table(grid: dict[str, Any], tmp_path: Path) -> None:
    campaign = Campaign.from_dict(grid)

    def stop(progress: Progress) -> None:
        raise KeyboardInterrupt

    outcome = campaign.run(tmp_path, progress=stop)
    # The first item was written before it was told.
    assert outcome.interrupted and outcome.done == len(rows(tmp_path)) == 1
    (tmp_path / "journal.jsonl").write_bytes(b"")
    with Journal(tmp_path / "journal.jsonl", 24) as journal:
        write_results(tmp_path, campaign.items, campaign.declaration.axes, journal, {})
    assert rows(tmp_path) == []
    assert "0 of 24 items" in str(campaign.summary())


def test_the_folder_of_another_campaign_is_refused(grid: dict[str, Any], tmp_path: Path) -> None:
    Campaign.from_dict(grid).run(tmp_path, progress=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def refused(words: str) -> None:
        with pytest.raises(CampaignError, match=words) as caught:
            Campaign.from_dict(grid).run(tmp_path, progress=False)
        assert caught.value.code == "other-campaign"

    grid["options"]["scale"] = 3.0
    refused("its options differs")
    grid["options"]["scale"] = 2.0
    grid["axes"] = dict(reversed(grid["axes"].items()))
    refused("its axes come in the order n, index, seed")
    grid["axes"] = dict(reversed(grid["axes"].items()))
    record = json.loads((tmp_path / "campaign.json").read_text())
    (tmp_path / "campaign.json").write_text(json.dumps({**record, "hash": "0", "version": "0.0.1"}))
    refused("with version 0.0.1")
    (tmp_path / "campaign.json").unlink()
    refused("no campaign.json")
    (tmp_path / "campaign.json").write_bytes(before["campaign.json"])
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_two_runs_do_not_write_to_one_folder(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 1000, 0.05), tmp_path / "a"
    driver = command("run", campaign, folder)
    try:
        wait_until(lambda: lines(folder / "journal.jsonl") >= 1)
        with pytest.raises(CampaignError, match="Another run"):
            Campaign.read(campaign).run(folder, progress=False)
    finally:
        kill(driver.pid)
        driver.communicate()


def test_progress_says_how_far_and_how_long(grid: dict[str, Any], tmp_path: Path) -> None:
    said: list[Progress] = []
    data = {"name": "a", "task": "campaign_tasks:slow", "axes": {"seed": {"first": 1, "last": 8}}}
    Campaign.from_dict(data).run(tmp_path, progress=said.append)
    assert said[-1].done == said[-1].total == 8 and said[-1].remaining_s == 0
    middle = said[len(said) // 2]
    assert middle.remaining_s is not None
    # 50 ms for each item that is left, and what starting took.
    assert middle.remaining_s >= 0.05 * (8 - middle.done) * 0.9




def test_without_pyarrow_nothing_is_run(
    grid: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(CampaignError, match="pyarrow"):
        Campaign.from_dict(grid).run(tmp_path / "a")
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"workers": 0}, "invalid-value"),
        ({"workers": "some"}, "wrong-type"),
        ({"workers": True}, "wrong-type"),
        ({"workers": None}, "wrong-type"),
        ({"time_limit_s": 0.0}, "invalid-value"),
    ],
)
def test_arguments_that_cannot_be(
    grid: dict[str, Any], tmp_path: Path, arguments: dict[str, Any], code: str
) -> None:
    with pytest.raises(StiffarmError) as caught:
        Campaign.from_dict(grid).run(tmp_path / "a", **arguments)
    assert caught.value.code == code
    assert not (tmp_path / "a").exists()


def test_without_ray_there_is_no_cluster(
    grid: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(CampaignError, match="needs the package ray") as caught:
        Campaign.from_dict(grid).run(tmp_path, address="auto")
    assert "stiffarm[campaign]" in str(caught.value.hint)


def test_no_more_processors_are_taken_than_asked_for(grid: dict[str, Any], tmp_path: Path) -> None:
    for name, arguments, count in (("a", {}, 1), ("b", {"workers": 2}, 2)):
        outcome = Campaign.from_dict(grid).run(tmp_path / name, progress=False, **arguments)  # type: ignore[arg-type]
        assert len(set(parquet.read_table(outcome.timings)["worker"].to_pylist())) <= count


def test_a_script_without_a_guard_is_told_so(grid: dict[str, Any], tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    words = "from stiffarm.campaign import Campaign\n"
    script.write_text(f"{words}Campaign.from_dict({grid!r}).run({str(tmp_path / 'a')!r})\n")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "A worker process could not be started." in done.stderr
    assert 'if __name__ == "__main__":' in done.stderr.splitlines()[-1]


def test_a_full_disk_is_a_sentence_and_the_run_goes_on_later(
    grid: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, full = tmp_path / "whole", tmp_path / "full"
    campaign = Campaign.from_dict(grid)
    campaign.run(whole, progress=False)
    append = Journal.append

    def no_room(*_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    def until_full(self: Journal, record: dict[str, Any]) -> None:
        if len(self) == 5:
            no_room()
        append(self, record)

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "append", until_full)
        # The tables of what is done find no room either.
        patch.setattr(campaign_module.table, "write_results", no_room)
        with pytest.raises(CampaignError, match="No space left on device") as error:
            campaign.run(full, progress=False)
    assert error.value.code == "file-write" and "run it again" in str(error.value)
    assert campaign.run(full, progress=False).ran == len(campaign) - 5
    assert sha(full) == sha(whole)


def test_no_lock_stays_in_a_finished_folder(grid: dict[str, Any], tmp_path: Path) -> None:
    campaign = Campaign.from_dict(grid)
    folder = tmp_path / "a"
    campaign.run(folder, progress=False)
    assert not (folder / "lock").exists()
    with campaign_module._locked(folder), pytest.raises(CampaignError) as error, campaign_module._locked(folder):
        pass
    assert error.value.code == "in-use"
