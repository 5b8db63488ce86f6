"""Each line of ``refusals.toml`` is refused by the function of its command with the command's code, place and hint."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import Command

import stiffarm
from stiffarm import StiffarmError
from stiffarm.campaign.declaration import toml_reader

CRATES = Path(__file__).resolve().parents[2]
TESTS = CRATES / "stiffarm" / "tests"
TABLE: dict[str, Any] = toml_reader().loads((TESTS / "refusals" / "refusals.toml").read_text(encoding="utf-8"))
ROWS: list[dict[str, Any]] = [row for row in TABLE["refusal"] if "not_python" not in row]


def write_inputs(row: dict[str, Any], folder: Path) -> None:
    """The files of a row, as ``rows.rs`` writes them."""
    shared = {name: text for name, text in TABLE["files"].items() if name in row["line"].split(" ")}
    inputs = {name: text.encode() for name, text in {**shared, **row.get("files", {})}.items()}
    inputs |= {name: bytes(numbers) for name, numbers in row.get("bytes", {}).items()}
    if "cell" in row:
        text = (CRATES / "stiffarm-files" / "data" / "cells" / "comau.toml").read_text(encoding="utf-8")
        for before, after in row["cell"]:
            assert before in text
            text = text.replace(before, after)
        inputs["cell.toml"] = ("\ufeff" * row.get("mark", False) + text).encode()
    if row.get("workbook"):
        inputs["readings.xlsx"] = (TESTS / "golden" / "xlsx" / "readings.xlsx").read_bytes()
    for name, content in inputs.items():
        (folder / name).write_bytes(content)


def value(kind: str, word: str) -> Any:
    """A word of the command line as Python has it; what is none of its kind as it is typed."""
    number = {"whole": int, "number": float, "numbers": float}.get(kind, str)
    try:
        values = [number(one) for one in word.split(",")]
    except ValueError:
        return word
    return values[0] if len(values) == 1 else word if number is str else values


def keywords(arguments: list[dict[str, Any]], words: list[str]) -> dict[str, Any]:
    """The words of a command line as keywords of its function."""
    inputs = [argument for argument in arguments if argument["option"] is None]
    options = {argument["option"]: argument for argument in arguments if argument["option"]}
    files, kwargs = [], {}
    words = words[::-1]
    while words:
        word = words.pop()
        if not word.startswith("--"):
            files.append(word)
            continue
        option = options[word[2:]]
        alone = option["kind"] == "flag" or (option["bare"] and (not words or words[-1].startswith("--")))
        kwargs[option["name"]] = True if alone else value(option["kind"], words.pop())
    if [argument["name"] for argument in inputs] == ["cell", "stiffness", "measurements"] and len(files) == 2:
        # Python has no files without their parameter.
        files.insert(1, None)
    for argument in inputs:
        if argument["several"]:
            kwargs[argument["name"]], files = files, []
        elif files:
            kwargs[argument["name"]] = files.pop(0)
    return kwargs


def in_python(text: str) -> str:
    """What the command calls options are keywords here."""
    return re.sub(r"--([a-z][a-z0-9-]*)", lambda option: option[1].replace("-", "_"), text)


@pytest.mark.parametrize("row", ROWS, ids=[row["what"] for row in ROWS])
def test_refused(row: dict[str, Any], command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_inputs(row, tmp_path)
    before = sorted(tmp_path.iterdir())
    name, *words = row["line"].split(" ")
    error = json.loads(command([name, *words, "--json"]).stdout)["error"]
    described = {one["name"]: one["arguments"] for one in json.loads(command(["docs", "commands"]).stdout)}
    with pytest.raises(StiffarmError) as raised:
        getattr(stiffarm, name)(**keywords(described[name], words))
    ours = raised.value
    assert type(ours) is StiffarmError
    assert sorted(tmp_path.iterdir()) == before
    if "python" in row:
        # Refused before the command is asked.
        assert {"code": ours.code, **ours.place} == row["python"], ours
        return
    assert ours.code == error["code"] == row["code"], ours
    place = {part: error[part] for part in ("file", "line", "column", "key") if error[part] is not None}
    if "key" in place:
        place["key"] = in_python(place["key"])
    elif ours.code == "usage" and (named := re.search("--[a-z-]+", error["message"])):
        place["key"] = in_python(named[0])
    assert ours.place == place, ours
    hint = error["hint"]
    if ours.code == "usage" and hint is not None:
        # The parser of the command line shows how it is called.
        hint = None if hint.startswith("Usage: ") else hint.removeprefix("tip: ")
    assert ours.hint == (hint and in_python(hint)), ours
