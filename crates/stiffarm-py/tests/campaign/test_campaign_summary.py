"""Summaries and figures of a campaign are those of its rows, and its command says where it stands."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import Any

import pytest
from campaign_helpers import finish, rows, toml

from stiffarm.campaign import Campaign, CampaignError, open_folder
from stiffarm.campaign.__main__ import main
from stiffarm.campaign.summary import statistics_of


@pytest.fixture
def ran(grid: dict[str, Any], tmp_path: Path) -> Campaign:
    campaign = Campaign.from_dict(grid)
    campaign.run(tmp_path / "a", progress=False)
    return campaign


def test_aggregates_are_those_of_the_rows(ran: Campaign, tmp_path: Path) -> None:
    summary = ran.summary()
    assert summary.axes == ("n", "index")
    assert summary.figures == ("index_value", "margin_mm", "evaluations")
    table = summary.by("index", "n", figures=["index_value"]).to_pylist()
    assert [(row["index"], row["n"]) for row in table[:2]] == [("novel", 3), ("expected_error", 3)]
    assert len(table) == 6
    for row in table:
        values = [
            r["index_value"]
            for r in rows(tmp_path / "a")
            if r["index"] == row["index"] and r["n"] == row["n"]
        ]
        assert row["items"] == row["values"] == 4 and row["failed"] == 0
        assert row["mean"] == pytest.approx(statistics.fmean(values), rel=1e-15)
        assert row["std"] == pytest.approx(statistics.stdev(values), rel=1e-15)
        assert row["median"] == pytest.approx(statistics.median(values), rel=1e-15)
    (everything,) = summary.by(figures=["margin_mm"]).to_pylist()
    assert (everything["items"], everything["values"]) == (24, 6)


def test_quantiles_are_numpys() -> None:
    numpy = pytest.importorskip("numpy")
    values = [3.0, 1.5, 9.25, 4.0, -2.0, None, 7]
    summary = statistics_of(values)
    present = [3.0, 1.5, 9.25, 4.0, -2.0, 7.0]
    for name, share in (("p05", 5), ("p25", 25), ("median", 50), ("p75", 75), ("p95", 95)):
        assert summary[name] == pytest.approx(numpy.percentile(present, share), rel=1e-14)
    assert summary["values"] == 6
    assert statistics_of([None])["mean"] is None
    # No table holds one, and a mean over one is none.
    assert numpy.isnan(statistics_of([*values, float("nan")])["mean"])


def test_unknown_names_are_refused(ran: Campaign) -> None:
    summary = ran.summary()
    with pytest.raises(CampaignError, match="no axis 'robot'"):
        summary.by("robot")
    with pytest.raises(CampaignError, match="no figure 'termination'"):
        summary.by("n", figures=["termination"])
    with pytest.raises(CampaignError, match="not run yet"):
        Campaign(ran.declaration).summary()


def test_failures_are_counted_by_kind(tmp_path: Path) -> None:
    data = {
        "name": "wild",
        "task": "campaign_tasks:wild",
        "axes": {"way": ["raises", "fine", "refuses"], "seed": [1, 2, 3]},
    }
    campaign = Campaign.from_dict(data)
    campaign.run(tmp_path, progress=False)
    summary = campaign.summary()
    assert [(f["error_code"], f["count"], f["item"]) for f in summary.failures] == [
        ("invalid_value", 3, 6),
        ("task-error", 3, 0),
    ]
    assert summary.failed == 6
    by_way = summary.by("way", figures=["value"]).to_pylist()
    assert [(row["way"], row["failed"], row["values"]) for row in by_way] == [
        ("raises", 3, 0), ("fine", 0, 3), ("refuses", 3, 0),
    ]  # fmt: skip
    heading = next(line for line in str(summary).splitlines() if line.startswith("  way "))
    assert heading.split()[:4] == ["way", "items", "failed", "values"]
    assert "3 × invalid_value, first item 6 (way=refuses,seed=1): The load is none." in str(summary)


def printed(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of the command in this process, which needs no start."""
    code = main([str(one) for one in arguments])
    return code, *capsys.readouterr()


def test_the_command_runs_says_how_far_and_sums_up(
    grid: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign, folder = toml(tmp_path / "c.toml", grid), tmp_path / "a"
    code, out, err = finish("run", campaign, folder)
    assert (code, err) == (0, "")
    assert out == f"24 of 24 items, 0 failed: {folder / 'results.parquet'}\n"
    code, out, _ = printed(capsys, "status", folder)
    assert (code, out) == (0, "quick: 24 of 24 items, 0 failed\n")
    code, out, _ = printed(capsys, "summary", folder)
    assert code == 0 and "margin_mm by index" in out
    assert open_folder(folder).declaration == Campaign.read(campaign).declaration


def test_the_command_says_where_an_error_is(
    grid: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grid["axes"]["sede"] = grid["axes"].pop("seed")
    grid["task"] = "select"
    path = toml(tmp_path / "c.toml", grid)
    code, out, err = finish("run", path, tmp_path / "a")
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {path}: axes.n: 'n' is not known here.\n  hint: ")
    code, _, err = printed(capsys, "status", tmp_path)
    assert code == 2 and "no folder of a campaign" in err
    code, _, err = printed(capsys, "summary", tmp_path)
    assert code == 2 and "no folder of a campaign" in err
    failing = {"name": "w", "task": "campaign_tasks:wild", "axes": {"way": "raises", "seed": 1}}
    code, out, _ = printed(capsys, "run", toml(path, failing), tmp_path / "b")
    assert code == 1 and "1 failed" in out
