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
    every_night,
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


def at(ray: Any) -> tuple[object, ...]:
    """Options of the command for the Ray that tests share."""
    return ("--address", ray.get_runtime_context().gcs_address, "--workers", 2)


def test_ray_gives_the_bytes_of_one_worker(grid: dict[str, Any], tmp_path: Path, ray_here: Any) -> None:
    campaign = Campaign.from_dict(grid)
    campaign.run(tmp_path / "one", progress=False)
    for workers in (1, "all"):
        folder = tmp_path / str(workers)
        assert campaign.run(folder, workers=workers, address="auto", progress=False).done == 24
        assert sha(folder) == sha(tmp_path / "one")


def test_limits_and_errors_are_the_same_on_ray(wild: Path, tmp_path: Path, ray_here: Any) -> None:
    campaign = Campaign.from_dict(WILD)
    outcome = campaign.run(tmp_path, workers=2, address="auto", progress=False, time_limit_s=LIMIT_S)
    assert outcome.failed == 12
    assert rows(tmp_path) == rows(wild)
    assert sha(tmp_path) == sha(wild)


@every_night
def test_the_driver_killed_loses_only_what_was_under_way(tmp_path: Path, ray_here: Any) -> None:
    folder, begun = tmp_path / "a", tmp_path / "begun"
    campaign = slow(tmp_path / "c.toml", 50, 0.04, begun)
    driver = command("run", campaign, folder, *at(ray_here))
    wait_until(lambda: lines(folder / "journal.jsonl") >= 10)
    kill(driver.pid)
    driver.communicate()
    # Workers go with the driver.
    workers = {pid for _, pid in begun_items(begun)}
    wait_until(lambda: not any(map(alive, workers)), 30.0)
    done = journal_numbers(folder)
    code, out, err = finish("run", campaign, folder)
    assert code == 0, err
    assert "50 of 50 items, 0 failed" in out
    times = [seed - 1 for seed, _ in begun_items(begun)]
    assert all(times.count(number) == 1 for number in done)
    assert sorted(journal_numbers(folder)) == list(range(50))
    assert sha(folder) == serially(campaign, tmp_path / "b")


@every_night
def test_workers_killed_have_their_items_run_again(tmp_path: Path, ray_here: Any) -> None:
    folder, begun = tmp_path / "a", tmp_path / "begun"
    campaign = slow(tmp_path / "c.toml", 60, 0.05, begun)
    driver = command("run", campaign, folder, *at(ray_here))
    wait_until(lambda: lines(begun) >= 10)
    kill(list(begun_items(begun))[-1][1])
    out, err = driver.communicate(timeout=60)
    assert driver.returncode == 0, err
    assert [row["status"] for row in rows(folder)] == ["ok"] * 60
    assert sum(parquet.read_table(folder / "timings.parquet")["tries"].to_pylist()) == 61
    assert sha(folder) == serially(campaign, tmp_path / "b")


@every_night
def test_a_node_that_goes_is_not_waited_for_and_without_any_the_run_ends_with_what_is_done(tmp_path: Path) -> None:
    campaign, one_left, none_left = slow(tmp_path / "c.toml", 60, 0.1), tmp_path / "one", tmp_path / "none"
    out, err = cluster_driver(campaign, one_left, none_left)
    undisturbed = serially(campaign, tmp_path / "undisturbed")
    # Ray itself has words for it before.
    first, end, last = out.partition("60 of 60 items, 0 failed\n")
    assert end and "no processor" not in first, err
    assert sorted(journal_numbers(one_left)) == list(range(60))
    assert sha(one_left) == undisturbed
    done = journal_numbers(none_left)
    assert 6 <= len(done) < 60
    assert "The cluster has had no processor for 1 s.\n" in last, err
    assert [row["item"] for row in rows(none_left)] == sorted(done)
    assert serially(campaign, none_left) == undisturbed


@every_night
def test_ctrl_c_ends_the_workers_too(tmp_path: Path) -> None:
    folder, begun = tmp_path / "a", tmp_path / "begun"
    campaign = slow(tmp_path / "c.toml", 4000, 0.05, begun)
    # Ray here, for this run.
    driver = command("run", campaign, folder, "--address", "local", "--workers", 2)
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
