"""What a campaign may declare, what it refuses, and the order and names of its items."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from stiffarm import Cell, StiffarmError
from stiffarm.campaign import Campaign, CampaignError
from stiffarm.campaign.declaration import toml_reader

TEXT = """
format = 1
name = "indices"
task = "select"

[axes]
cell = "builtin:comau"
tool = ["short", "long"]
anchor_mm = [[1800, 0, 0], [1500, 500.5, 0]]
index = ["novel", "expected_error"]
seed = { first = 1, last = 3 }

[options]
rounds = 2

[tools.short]
loading_point_mm = [200, 0, 250]
[tools.long]
loading_point_mm = [400, 0, 250]
"""


def of(**changes: Any) -> dict[str, Any]:
    """A declaration with keys changed; None removes one."""
    data: dict[str, Any] = {
        "name": "a",
        "task": "select",
        "axes": {"cell": ["builtin:comau"], "seed": [1, 2]},
    }
    data.update(changes)
    return {key: value for key, value in data.items() if value is not None}


def axes(**values: Any) -> dict[str, Any]:
    return of(axes={"cell": ["builtin:comau"], **values})


def refused(data: dict[str, Any]) -> CampaignError:
    with pytest.raises(CampaignError) as caught:
        Campaign.from_dict(data)
    return caught.value


def test_items_come_in_a_defined_order(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(TEXT)
    campaign = Campaign.read(path)
    assert len(campaign) == 1 * 2 * 2 * 2 * 3
    items = list(campaign)
    assert [item.number for item in items] == list(range(24))
    # The last axis varies fastest, the first slowest.
    assert [item.values["seed"] for item in items[:4]] == [1, 2, 3, 1]
    assert [item.values["tool"] for item in items] == ["short"] * 12 + ["long"] * 12
    assert items[7].name == (
        "cell=builtin:comau,tool=short,anchor_mm=1500|500.5|0,index=novel,seed=2"
    )
    assert items[7].values["anchor_mm"] == (1500.0, 500.5, 0.0)
    assert len({item.id for item in items}) == 24
    assert campaign.items[7] == items[7]
    with pytest.raises(IndexError):
        campaign.items[24]


def test_ids_do_not_depend_on_what_else_is_in_the_grid() -> None:
    small = Campaign.from_dict(axes(seed=[2]))
    large = Campaign.from_dict(axes(seed=[5, 3, 2]))
    assert small.items[0].id == large.items[2].id
    # Written down: ids are in tables that people keep.
    assert small.items[0].id == "8fc058d33139"


def test_ids_follow_what_a_name_stands_for() -> None:
    def tool(length: float) -> str:
        tools = {"one": {"loading_point_mm": [length, 0, 0]}}
        return Campaign.from_dict({**axes(tool="one"), "tools": tools}).items[0].id

    assert tool(200.0) == tool(200.0) != tool(300.0)


def test_a_dict_and_its_declaration_are_the_same(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(TEXT)
    campaign = Campaign.read(path)
    again = Campaign.from_dict(campaign.declaration.to_dict())
    assert again.declaration == campaign.declaration
    assert again.hash == campaign.hash


def test_the_hash_follows_order_options_and_files(tmp_path: Path) -> None:
    first = Campaign.from_dict(of()).hash
    assert Campaign.from_dict(of()).hash == first
    turned = {"seed": [1, 2], "cell": ["builtin:comau"]}
    assert Campaign.from_dict(of(axes=turned)).hash != first
    assert Campaign.from_dict(of(options={"rounds": 3})).hash != first
    cell, readings = tmp_path / "cell.toml", tmp_path / "m.csv"
    text = Cell.built_in("comau").to_toml()
    cell.write_text(text)
    readings.write_text("a")
    both = {"cell": ["cell.toml"], "measurements": ["m.csv"]}
    campaign = Campaign.from_dict(of(task="identify", axes=both), folder=tmp_path)
    with_files = campaign.hash
    readings.write_text("b")
    assert campaign.hash != with_files
    readings.write_text("a")
    assert campaign.hash == with_files
    cell.write_text(text + "#\n")
    assert campaign.hash != with_files


@pytest.mark.parametrize(
    ("data", "code", "key", "words"),
    [
        (of(axis={}), "unknown-key", "axis", "'axes'"),
        (of(name=None), "missing-key", "name", "missing"),
        (of(name=3), "wrong-type", "name", "a text"),
        (of(task="selct"), "unknown-name", "task", "'select'"),
        (of(task="no_such_module:f"), "bad-task", "task", "cannot be imported"),
        (of(task="__main__:f"), "bad-task", "task", "module"),
        (of(axes=None), "missing-key", "axes", "missing"),
        (of(axes={"seed": [1]}), "missing-key", "axes.cell", "builtin:comau"),
        (of(axes=[1]), "wrong-type", "axes", "a table"),
        (of(format=2), "unsupported", "format", "format 1"),
        (axes(sed=[1]), "unknown-key", "axes.sed", "'seed'"),
        (axes(seed=[1, -1]), "invalid-value", "axes.seed[1]", "from 0"),
        (axes(seed=[1.5]), "wrong-type", "axes.seed[0]", "whole number"),
        (axes(seed=[True]), "wrong-type", "axes.seed[0]", "whole number"),
        (axes(seed=2**63), "invalid-value", "axes.seed", "whole number"),
        (axes(seed=[]), "invalid-value", "axes.seed", "no values"),
        (axes(seed={"first": 3, "last": 1}), "invalid-value", "axes.seed", "no values"),
        (axes(seed={"first": 3}), "missing-key", "axes.seed", "first and last"),
        (axes(seed={"from": 3, "last": 4}), "unknown-key", "axes.seed.from", "first"),
        (axes(seed={"first": 0, "last": 10**12}), "invalid-value", "axes.seed", "1000000"),
        (axes(seed=[1, 2, 1]), "duplicate", "axes.seed[2]", "twice"),
        (axes(postures=0), "invalid-value", "axes.postures", "from 1"),
        (axes(load_n=[500, 0]), "invalid-value", "axes.load_n[1]", "above 0"),
        (axes(load_n=float("nan")), "not-finite", None, "finite"),
        (axes(anchor_mm=[[1, 2]]), "dimension", "axes.anchor_mm[0]", "3 numbers"),
        (axes(tool=["short"]), "unknown-name", "axes.tool[0]", "[tools.short]"),
        (axes(index={"first": 1, "last": 2}), "wrong-type", "axes.index", "a text"),
        (of(options={"round": 3}), "unknown-key", "options.round", "'rounds'"),
        (of(options={"rounds": 2.5}), "wrong-type", "options.rounds", "whole number"),
        (of(options={"rounds": True}), "wrong-type", "options.rounds", "whole number"),
        (of(options={"time_limit_s": 3}), "unknown-key", "options.time_limit_s", "rounds"),
        (
            of(task="simulate", options={"select": {"runs": 3}}),
            "unknown-key",
            "options.select.runs",
            "rounds",
        ),
        (
            {**axes(postures=[6]), "task": "simulate", "options": {"postures_file": "p.csv"}},
            "conflict",
            "axes.postures",
            "change nothing",
        ),
        (of(task="identify"), "missing-key", "axes.measurements", "once"),
        (of(task="campaign_tasks:smooth"), "bad-task", "task", "argument: 'n'"),
        (of(tools={"a": 3}), "wrong-type", "tools.a", "a table"),
    ],
)
def test_what_cannot_be_is_refused_with_its_key(
    data: dict[str, Any], code: str, key: str | None, words: str
) -> None:
    error = refused(data)
    assert error.code == code
    assert error.place.get("key") == key
    assert words in f"{error.message} {error.hint}"


def test_an_own_axis_cannot_have_the_name_of_a_column() -> None:
    data = {"name": "a", "task": "campaign_tasks:smooth", "axes": {"status": [1]}}
    assert refused(data).code == "invalid-value"


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    with pytest.raises(CampaignError, match="No such file") as caught:
        Campaign.read(path)
    assert caught.value.place == {"file": str(path)}
    path.write_text("name = ")
    with pytest.raises(CampaignError, match="no TOML"):
        Campaign.read(path)
    path.write_text('name = "a"\ntask = "select"\n[axes]\ncell = "none.toml"\n')
    with pytest.raises(StiffarmError, match=r"none\.toml.*No such file"):
        Campaign.read(path).hash


def test_large_grids_cost_nothing_until_their_items_are_asked_for() -> None:
    many = {"first": 1, "last": 1000}
    campaign = Campaign.from_dict(axes(seed=many, postures=many))
    assert len(campaign) == 1_000_000
    assert campaign.items[999_999].values["seed"] == 1000
    error = refused(axes(seed=many, postures=many, load_n=[1, 2]))
    assert error.code == "invalid-value"


def test_the_campaign_of_the_documentation_can_be_read() -> None:
    page = Path(__file__).parents[4] / "docs" / "campaigns.md"
    if not page.is_file():
        pytest.skip("docs/campaigns.md is not here: this is no checkout")
    text = page.read_text(encoding="utf-8")
    block = text.split("```toml\n")[1].split("```")[0]
    campaign = Campaign.from_dict(toml_reader().loads(block))
    assert len(campaign) == 2 * 2 * 3 * 2 * 2 * 20
