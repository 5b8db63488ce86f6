"""The four built-in tasks of campaigns give what the library gives by itself."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import Any

import pytest
from campaign_helpers import needs_library, needs_ray, rows, sha

from stiffarm.campaign import Campaign, CampaignError
from stiffarm import StiffarmError

pytestmark = needs_library

#: The built-in cell of measured wrenches has neither a load to plan with nor a prior.
PLANNED = {
    "stiffness": {"prior_nm_per_rad": [1.0e6, 1.5e6, 1.2e6, 4.0e5, 3.0e5, 2.0e5]},
    "load": {"kind": "rope", "anchor_mm": [1700, 0, 0], "magnitude_n": 800},
}
SELECT: dict[str, Any] = {
    "name": "select",
    "task": "select",
    "axes": {
        "cell": ["builtin:comau", "fanuc"],
        "postures": [3, 4],
        "index": ["expected_error", "d"],
        "seed": [2],
    },
    "options": {"rounds": 1},
    "cells": {"fanuc": {"base": "builtin:fanuc-r2000ic", **PLANNED}},
}


def run(data: dict[str, Any], folder: Path, **arguments: Any) -> list[dict[str, Any]]:
    Campaign.from_dict(data).run(folder, progress=False, **arguments)
    made = rows(folder)
    assert [row["error_message"] for row in made] == [None] * len(made)
    return made


def with_axes(task: str, options: dict[str, Any] | None = None, **axes: Any) -> dict[str, Any]:
    axes = {"cell": ["builtin:comau"], **axes}
    return {"name": task, "task": task, "axes": axes, "options": options or {}}


@pytest.fixture(scope="module")
def selected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the selections by one worker."""
    folder = tmp_path_factory.mktemp("selected")
    run(SELECT, folder)
    return folder


def test_select_is_what_the_library_selects(selected: Path) -> None:
    import stiffarm as sa

    for row in rows(selected):
        if row["cell"] == "fanuc":
            fanuc = sa.Cell.built_in("fanuc-r2000ic")
            cell = fanuc.with_changes(PLANNED)
        else:
            cell = sa.Cell(row["cell"])
        plan = sa.select(
            cell, count=row["postures"], index=row["index"], seed=row["seed"], rounds=1,
            no_certificate=True,
        ).to_dict()  # fmt: skip
        assert row["postures_deg"] == plan["postures_deg"]
        assert row["index_value"] == plan["value"] == row[f"index_{row['index']}"]
        margin = plan["smallest_margin_m"]
        assert row["smallest_margin_mm"] == (None if margin is None else margin * 1e3)
        expected = plan["evaluation"]["expected_deviation"]
        assert [row[f"expected_relative_deviation_joint{j + 1}"] for j in range(6)] == expected


@needs_ray
def test_one_worker_two_and_ray_give_the_same_bytes(selected: Path, tmp_path: Path, ray_here: Any) -> None:
    run(SELECT, tmp_path / "two", workers=2)
    run(SELECT, tmp_path / "ray", workers=2, address="auto")
    assert sha(selected) == sha(tmp_path / "two") == sha(tmp_path / "ray")


def test_a_search_that_a_limit_ends_is_no_result(tmp_path: Path) -> None:
    data = with_axes("select", {"rounds": 1_000_000}, seed=[1])
    Campaign.from_dict(data).run(tmp_path, progress=False, time_limit_s=1.0)
    (row,) = rows(tmp_path)
    assert row["error_code"] == "time-limit" and "index_value" not in row


def test_simulations_are_those_of_the_library(tmp_path: Path) -> None:
    import stiffarm as sa

    group = "builtin:comau-group1"
    data = with_axes("simulate", {"runs": 40, "postures_file": group}, noise_factor=[1.0, 4.0], seed=[3])
    first, noisy = run(data, tmp_path)
    level = sa.simulate(sa.Cell("builtin:comau"), group, runs=40, levels=[1.0], seed=3).to_dict()["groups"][0]["levels"][0]
    assert first["runs"] == level["runs"] == 40
    for joint in range(1, 7):
        for figure, key in [
            ("relative_deviation", "mean_deviation"),
            ("relative_deviation_standard_error", "standard_error"),
            ("expected_relative_deviation", "expected_deviation"),
        ]:
            assert first[f"{figure}_joint{joint}"] == pytest.approx(level[key][joint - 1], rel=1e-9)
        expected = first[f"expected_relative_deviation_joint{joint}"]
        # Four times the variance is twice the deviation.
        assert noisy[f"expected_relative_deviation_joint{joint}"] == pytest.approx(2 * expected, rel=0.01)


def test_a_scattered_prior_costs_something_under_the_true_one(tmp_path: Path) -> None:
    data = with_axes("select", {"rounds": 1}, postures=[4], prior_scatter=[0.0, 1.0], seed={"first": 1, "last": 3})
    items = run(data, tmp_path)
    exact, scattered = (
        [row["index_expected_error"] for row in items if row["prior_scatter"] == scatter]
        for scatter in (0.0, 1.0)
    )
    assert statistics.fmean(scattered) > statistics.fmean(exact)
    values = [row["index_value"] for row in items]
    assert values[:3] == exact
    # Each seed draws its own prior.
    assert len(set(values)) == 6


def test_coverage_is_that_of_the_library(tmp_path: Path) -> None:
    import stiffarm as sa

    data = with_axes("coverage", {"runs": 60, "select": {"rounds": 1}}, postures=[6], seed=[1])
    (row,) = run(data, tmp_path)
    cell = sa.Cell("builtin:comau")
    plan = sa.select(cell, count=6, index="expected_error", seed=1, rounds=1, no_certificate=True)
    expected = sa.coverage(cell, plan, runs=60, seed=1).to_dict()
    assert row["coverage"] == expected["coverage"] and row["experiments"] == expected["experiments"] == 60
    assert row["relative_half_width_joint6"] == expected["joints"][5]["relative_half_width"]


def test_identify_reads_files_beside_the_campaign(tmp_path: Path) -> None:
    import stiffarm as sa

    cell = sa.Cell.built_in("comau")
    postures = sa.Postures.read("builtin:comau-group1", cell)
    (tmp_path / "m.csv").write_text(sa.simulate_measurements(cell, postures, seed=3).to_csv())
    data = with_axes("identify", measurements=["m.csv"])
    campaign = Campaign.from_dict(data, folder=tmp_path)
    campaign.run(tmp_path / "a", progress=False)
    (row,) = rows(tmp_path / "a")
    assert row["status"] == "ok", row["error_message"]
    expected = sa.identify(cell, str(tmp_path / "m.csv"), seed=1, brief=True).to_dict()
    for number, joint in enumerate(expected["joints"], start=1):
        assert row[f"stiffness_nm_per_rad_joint{number}"] == joint["stiffness"]
        assert row[f"readings_interval_low_nm_per_rad_joint{number}"] == joint["interval"][0]
        # A brief identification knows the readings alone, and its table says so.
        assert f"interval_low_nm_per_rad_joint{number}" not in row


def test_tools_loads_and_anchors_change_the_cell(tmp_path: Path) -> None:
    import stiffarm as sa

    keys = sa.Cell.built_in("comau").to_dict()
    long_tool = {**keys["tool"], "loading_point_mm": [400, 0, 250]}
    del long_tool["has_sensor"]
    data = with_axes(
        "select", {"rounds": 1}, postures=[4], tool=["long"], load=["other"], load_n=[300, 600], seed=[1]
    )
    data["tools"] = {"long": long_tool}
    rope = {"kind": "rope", "anchor_mm": [1600, 600, 0]}
    data["loads"] = {"other": {**rope, "magnitude_n": 100}}
    items = run(data, tmp_path)
    for row in items:
        keys["tool"] = long_tool
        keys["load"] = {**rope, "magnitude_n": row["load_n"]}
        cell = sa.Cell.from_dict(keys)
        plan = sa.select(cell, count=4, index="expected_error", seed=1, rounds=1, no_certificate=True)
        assert row["postures_deg"] == plan.to_dict()["postures_deg"]


def test_what_the_library_refuses_is_a_row_with_its_code(tmp_path: Path) -> None:
    data = with_axes("select", {"rounds": 1}, index=["expected_error", "expected_eror"], seed=[1])
    outcome = Campaign.from_dict(data).run(tmp_path, progress=False)
    assert (outcome.done, outcome.failed) == (2, 1)
    row = rows(tmp_path)[1]
    assert row["error_code"] == "unknown-name"
    assert "expected_eror" in row["error_message"]


def test_a_cell_that_is_none_ends_the_run_before_it_starts(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text("format = 1\n[robot]\ncatalog = 3\n")
    data = with_axes("select", cell=["cell.toml"], seed=[1])
    with pytest.raises(StiffarmError) as caught:
        Campaign.from_dict(data, folder=tmp_path).run(tmp_path / "a")
    assert caught.value.place["line"] == 3
    with pytest.raises(StiffarmError, match="comua"):
        Campaign.from_dict(with_axes("select", cell=["builtin:comua"], seed=[1])).run(tmp_path / "b")
    assert not (tmp_path / "a").exists() and not (tmp_path / "b").exists()


def test_a_changed_cell_file_is_another_campaign(tmp_path: Path) -> None:
    import stiffarm as sa

    path = tmp_path / "cell.toml"
    path.write_text(sa.Cell.built_in("comau").to_toml())
    data = with_axes("select", {"rounds": 1}, cell=["cell.toml"], seed=[1])
    Campaign.from_dict(data, folder=tmp_path).run(tmp_path / "a", progress=False)
    path.write_text(path.read_text() + "\n")
    with pytest.raises(CampaignError, match=r"cell\.toml was changed since"):
        Campaign.from_dict(data, folder=tmp_path).run(tmp_path / "a")
