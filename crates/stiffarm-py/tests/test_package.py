"""The package as it is installed. It needs numpy and pytest alone: it also runs on Pythons that have nothing else."""

from __future__ import annotations

import importlib.metadata
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
import stiffarm

PACKAGE = Path(__file__).resolve().parents[1]


def test_the_installed_package_is_tested_and_not_the_checkout() -> None:
    installed = Path(stiffarm.__file__).resolve()
    assert PACKAGE not in installed.parents
    assert (installed.parent / "py.typed").is_file()


def test_the_version_is_cargos() -> None:
    workspace = (PACKAGE.parents[1] / "Cargo.toml").read_text(encoding="utf-8")
    version = re.search(r'^version = "(.+)"$', workspace, flags=re.MULTILINE)
    assert version is not None
    assert stiffarm.__version__ == version[1]
    assert importlib.metadata.version("stiffarm") == version[1]


def test_the_wheel_says_its_licence_and_carries_it() -> None:
    files = importlib.metadata.files("stiffarm") or []
    licences = {path.name: path for path in files if "licenses" in path.parts}
    assert sorted(licences) == ["LICENSE-APACHE", "LICENSE-MIT"]
    for name, path in licences.items():
        assert path.read_binary() == (PACKAGE.parents[1] / name).read_bytes()
    metadata = importlib.metadata.metadata("stiffarm")
    assert metadata["License-Expression"] == "MIT OR Apache-2.0"
    assert {"frames", "plot", "progress", "campaign"} <= set(metadata.get_all("Provides-Extra") or [])


def test_everything_that_is_named_is_there() -> None:
    assert [name for name in stiffarm.__all__ if not hasattr(stiffarm, name)] == []
    assert list(stiffarm.__all__) == sorted(set(stiffarm.__all__))


def test_an_error_is_pickled_with_all_that_it_says() -> None:
    error = stiffarm.StiffarmError("too far", code="out-of-range", place={"file": "a.csv", "line": 3}, hint="move it")
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is stiffarm.StiffarmError
    assert str(again) == str(error) == "a.csv:3: too far\n  hint: move it"
    assert (again.code, again.place, again.hint) == (error.code, error.place, error.hint)


def test_an_error_of_the_library_says_code_place_and_hint(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text("[robot]\nnmae = 1\n", encoding="utf-8")
    with pytest.raises(stiffarm.StiffarmError) as raised:
        stiffarm.Cell(path)
    assert raised.value.place["file"] == str(path)
    assert raised.value.code
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.place) == (str(raised.value), raised.value.place)


def test_a_cell_is_pickled() -> None:
    cell = stiffarm.Cell.built_in("comau")
    again = pickle.loads(pickle.dumps(cell))
    postures = np.array([[0.1, -0.4, -1.5, 0.2, 0.8, -0.3]])
    expected = stiffarm.observation_matrix(cell, postures)
    assert expected.shape[1] == 6
    assert np.array_equal(stiffarm.observation_matrix(again, postures), expected)
