"""The same campaigns on Ray: the same bytes, and what is killed with SIGKILL costs nothing."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet
from campaign_helpers import (
    LIMIT_S,
    WILD,
    alive,
    begun_items,
    cluster_driver,
    command,
    finish,
    journal_numbers,
    kill,
    lines,
    needs_ray,
    rows,
    serially,
    sha,
    slow,
    wait_until,
)

from stiffarm.campaign import Campaign

pytestmark = needs_ray
#: Ray here, for one run.
HERE = ("--address", "local", "--workers", 2)


def test_ray_gives_the_bytes_of_one_worker(grid: dict[str, Any], tmp_path: Path, ray_here: Any) -> None:
    grid["axes"]["seed"] = {"first": 1, "last": 40}
    campaign = Campaign.from_dict(grid)
    campaign.run(tmp_path / "one", progress=False)
    for workers in (1, "all"):
        folder = tmp_path / str(workers)
        assert campaign.run(folder, workers=workers, address="auto", progress=False).done == 240
        assert sha(folder) == sha(tmp_path / "one")


def test_limits_and_errors_are_the_same_on_ray(tmp_path: Path, ray_here: Any) -> None:
    campaign = Campaign.from_dict(WILD)
    campaign.run(tmp_path / "two", workers=2, progress=False, time_limit_s=LIMIT_S)
    outcome = campaign.run(tmp_path / "ray", workers=2, address="auto", progress=False, time_limit_s=LIMIT_S)
    assert outcome.failed == 24
    assert rows(tmp_path / "ray") == rows(tmp_path / "two")
    assert sha(tmp_path / "ray") == sha(tmp_path / "two")


def test_the_driver_killed_loses_only_what_was_under_way(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 50, 0.04), tmp_path / "a", tmp_path / "begun"
    driver = command("run", campaign, folder, *HERE, begun=begun)
    wait_until(lambda: lines(folder / "journal.jsonl") >= 10)
    kill(driver.pid)
    driver.communicate()
    # Workers go with the driver.
    workers = {pid for _, pid in begun_items(begun)}
    wait_until(lambda: not any(map(alive, workers)), 30.0)
    done = journal_numbers(folder)
    code, out, err = finish("run", campaign, folder, begun=begun)
    assert code == 0, err
    assert "50 of 50 items, 0 failed" in out
    times = [seed - 1 for seed, _ in begun_items(begun)]
    assert all(times.count(number) == 1 for number in done)
    assert sorted(journal_numbers(folder)) == list(range(50))
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_workers_killed_have_their_items_run_again(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 60, 0.05), tmp_path / "a", tmp_path / "begun"
    driver = command("run", campaign, folder, *HERE, begun=begun)
    wait_until(lambda: lines(begun) >= 10)
    kill(list(begun_items(begun))[-1][1])
    out, err = driver.communicate(timeout=60)
    assert driver.returncode == 0, err
    assert [row["status"] for row in rows(folder)] == ["ok"] * 60
    assert sum(parquet.read_table(folder / "timings.parquet")["tries"].to_pylist()) == 61
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_a_node_that_goes_is_not_waited_for(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 60, 0.2), tmp_path / "a"
    out, err = cluster_driver(campaign, folder, alone=False)
    # Ray itself has words for it before.
    assert out.endswith("60 of 60 items, 0 failed\n"), err
    assert sorted(journal_numbers(folder)) == list(range(60))
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_without_any_node_the_run_ends_with_what_is_done(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 60, 0.2), tmp_path / "a"
    out, err = cluster_driver(campaign, folder, alone=True)
    done = journal_numbers(folder)
    assert 6 <= len(done) < 60
    assert "The cluster has had no processor for 3 s.\n" in out, err
    assert [row["item"] for row in rows(folder)] == sorted(done)
    assert serially(campaign, folder) == serially(campaign, tmp_path / "b")


def test_ctrl_c_ends_the_workers_too(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 4000, 0.05), tmp_path / "a", tmp_path / "begun"
    driver = command("run", campaign, folder, *HERE, begun=begun)
    wait_until(lambda: lines(folder / "journal.jsonl") >= 4)
    driver.send_signal(signal.SIGINT)
    out, err = driver.communicate(timeout=30)
    assert driver.returncode == 130
    assert out.startswith("Interrupted. ") and "Traceback" not in err
    assert [row["item"] for row in rows(folder)] == sorted(journal_numbers(folder))
    workers = {pid for _, pid in begun_items(begun)}
    wait_until(lambda: not any(map(alive, workers)), 10.0)


def test_an_address_without_a_cluster_is_an_error(tmp_path: Path) -> None:
    campaign = slow(tmp_path / "c.toml", 2, 0.0)
    code, _, err = finish("run", campaign, tmp_path / "a", "--address", "nowhere")
    assert code == 2
    assert "Ray cannot be reached" in err and "Traceback" not in err
