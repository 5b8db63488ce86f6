"""The same campaigns on Ray: the same bytes, and what is killed with SIGKILL costs nothing."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet
import pytest
from campaign_helpers import (
    LIMITS,
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
    ray_driver,
    rows,
    serially,
    sha,
    slow,
    wait_until,
)

from stiffarm.campaign import Campaign

pytestmark = needs_ray


@pytest.mark.parametrize("workers", [1, 2])
def test_ray_gives_the_bytes_of_the_serial_engine(
    grid: dict[str, Any], tmp_path: Path, ray_here: Any, workers: int
) -> None:
    grid["axes"]["seed"] = {"first": 1, "last": 40}
    campaign = Campaign.from_dict(grid)
    campaign.run(tmp_path / "serial", engine="serial", progress=False)
    outcome = campaign.run(tmp_path / "ray", engine="ray", workers=workers, progress=False)
    assert outcome.engine == "ray" and outcome.done == 240
    assert sha(tmp_path / "ray") == sha(tmp_path / "serial")
    used = parquet.read_table(outcome.timings)["worker"].to_pylist()
    assert set(used) <= set(range(workers))


def test_limits_and_errors_are_the_same_on_ray(tmp_path: Path, ray_here: Any) -> None:
    campaign = Campaign.from_dict(WILD)
    campaign.run(tmp_path / "serial", engine="serial", progress=False, **LIMITS)
    outcome = campaign.run(tmp_path / "ray", workers=2, progress=False, **LIMITS)
    assert outcome.engine == "ray" and outcome.failed == 24
    assert rows(tmp_path / "ray") == rows(tmp_path / "serial")
    assert sha(tmp_path / "ray") == sha(tmp_path / "serial")


def test_items_longer_than_those_before_go_back(
    tmp_path: Path, ray_here: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Twenty quick items make batches long, then come slow ones.
    data = {
        "name": "uneven",
        "task": "campaign_tasks:uneven",
        "axes": {"seed": {"first": 1, "last": 80}},
    }
    campaign = Campaign.from_dict(data)
    outcome = campaign.run(tmp_path / "ray", engine="ray", workers=2, progress=False)
    campaign.run(tmp_path / "serial", engine="serial", progress=False)
    assert sha(tmp_path / "ray") == sha(tmp_path / "serial")
    timings = parquet.read_table(outcome.timings)
    assert timings["tries"].to_pylist() == [1] * 80
    late = {worker for number, worker in zip(timings["item"].to_pylist(), timings["worker"].to_pylist())
            if number >= 72}  # fmt: skip
    assert len(late) == 2


def test_the_driver_killed_loses_only_what_was_under_way(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 50, 0.04), tmp_path / "a", tmp_path / "begun"
    driver = ray_driver(campaign, folder, begun)
    wait_until(lambda: lines(folder / "journal.jsonl") >= 10)
    kill(driver.pid)
    driver.communicate()
    # Workers and the processes that run their items go with the driver.
    workers = {pid for _, *pids in begun_items(begun) for pid in pids}
    wait_until(lambda: not any(map(alive, workers)), 30.0)
    done = journal_numbers(folder)
    code, out, err = finish("run", campaign, folder, "--workers", 2, begun=begun)
    assert code == 0, err
    assert "50 of 50 items, 0 failed" in out
    times = [seed - 1 for seed, _, _ in begun_items(begun)]
    assert all(times.count(number) == 1 for number in done)
    assert max(map(times.count, range(50))) == 2
    assert sorted(journal_numbers(folder)) == list(range(50))
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_workers_killed_have_their_items_run_again(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 60, 0.05), tmp_path / "a", tmp_path / "begun"
    driver = ray_driver(campaign, folder, begun)
    wait_until(lambda: lines(begun) >= 10)
    _, process, actor = list(begun_items(begun))[-1]
    # The actor of Ray, and so the process it watches.
    kill(actor)
    wait_until(lambda: not alive(process), 10.0)
    before = lines(begun)
    wait_until(lambda: lines(begun) >= before + 5)
    others = [pid for _, pid, _ in begun_items(begun) if alive(pid)]
    # A process that runs items, but not its actor.
    kill(others[-1])
    out, err = driver.communicate(timeout=60)
    assert driver.returncode == 0, err
    assert [row["status"] for row in rows(folder)] == ["ok"] * 60
    assert sorted(journal_numbers(folder)) == list(range(60))
    tries = parquet.read_table(folder / "timings.parquet")["tries"].to_pylist()
    # The second death may have hit an item of the first.
    assert max(tries) in (2, 3)
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_a_node_that_goes_is_not_waited_for(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 60, 0.2), tmp_path / "a"
    out, err = cluster_driver(campaign, folder, alone=False)
    # Ray itself has words for it before.
    assert out.endswith("60 of 60 items, 0 failed\n"), err
    assert sha(folder) == serially(campaign, tmp_path / "b")


def test_without_any_node_the_run_ends_with_what_is_done(tmp_path: Path) -> None:
    campaign, folder = slow(tmp_path / "c.toml", 60, 0.2), tmp_path / "a"
    out, err = cluster_driver(campaign, folder, alone=True)
    done = journal_numbers(folder)
    assert 6 <= len(done) < 60
    assert f"Ray gave no worker within 3 s; {60 - len(done)} items are left.\n" in out, err
    assert [row["item"] for row in rows(folder)] == sorted(done)
    assert serially(campaign, folder) == serially(campaign, tmp_path / "b")


def test_ctrl_c_ends_the_workers_too(tmp_path: Path) -> None:
    campaign, folder, begun = slow(tmp_path / "c.toml", 4000, 0.05), tmp_path / "a", tmp_path / "begun"
    driver = command("run", campaign, folder, "--workers", 2, begun=begun)

    def on_ray() -> set[int]:
        return {parent for _, _, parent in begun_items(begun)} - {driver.pid}

    wait_until(lambda: begun.exists() and len(on_ray()) == 2)
    # While Ray started, the first items ran in processes of the driver.
    assert driver.pid in {parent for _, _, parent in begun_items(begun)}
    driver.send_signal(signal.SIGINT)
    out, err = driver.communicate(timeout=30)
    assert driver.returncode == 130
    assert out.startswith("Interrupted. ") and "Traceback" not in err
    assert [row["item"] for row in rows(folder)] == sorted(journal_numbers(folder))
    workers = {pid for _, *pids in begun_items(begun) for pid in pids}
    wait_until(lambda: not any(map(alive, workers)), 10.0)


def test_an_address_without_a_cluster_is_an_error(tmp_path: Path) -> None:
    campaign = slow(tmp_path / "c.toml", 2, 0.0)
    code, _, err = finish("run", campaign, tmp_path / "a", "--address", "nowhere")
    assert code == 2
    assert "Ray cannot be reached" in err and "Traceback" not in err
