"""The notebooks run from top to bottom, and draw what they say."""

from __future__ import annotations

import base64
import os
import shutil
import struct
import time
from pathlib import Path
from typing import Any

import pytest

import stiffarm

nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
for needed in ("ipykernel", "matplotlib", "pandas", "scipy"):
    pytest.importorskip(needed, reason=f"{needed} is not installed")

FOLDER = Path(__file__).resolve().parent.parent / "notebooks"
#: Longest time that a notebook may take [s]; on two busy cores they take 7 to 15 s.
LONGEST_S = 60
#: Figures of each notebook.
FIGURES = {
    "1_the_paper_reproduced": 5,
    "2_my_own_robot": 3,
    "3_from_readings_to_a_prediction": 5,
    "4_your_own_index": 3,
}


def run(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Executes a notebook in a folder of its own."""
    path = folder / f"{name}.ipynb"
    shutil.copy(FOLDER / path.name, path)
    package = str(Path(stiffarm.__file__).parent.parent)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([package, os.environ.get("PYTHONPATH", "")]))
    # Figures come by the notebook's own backend.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook = nbformat.read(path, as_version=4)
    started = time.monotonic()
    # A cell that fails raises here, with its traceback.
    nbclient.NotebookClient(
        notebook, timeout=LONGEST_S, kernel_name="python3", resources={"metadata": {"path": str(folder)}}
    ).execute()
    assert time.monotonic() - started < LONGEST_S
    return notebook


def outputs(notebook: Any) -> list[Any]:
    return [one for cell in notebook.cells if cell.cell_type == "code" for one in cell.outputs]


def figures(notebook: Any) -> list[bytes]:
    pictures = [one.get("data", {}).get("image/png") for one in outputs(notebook)]
    return [base64.b64decode(png) for png in pictures if png]


def text(notebook: Any) -> str:
    return "".join(one.text for one in outputs(notebook) if one.output_type == "stream" and one.name == "stdout")


def check(notebook: Any, name: str) -> None:
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    pictures = figures(notebook)
    assert len(pictures) == FIGURES[name]
    for picture in pictures:
        width, height = struct.unpack(">II", picture[16:24])
        # 3.5 in and 7 in at 144 dots per inch, less what the notebook trims.
        assert 350 < width < 1100 and 250 < height < 1200
    # Warnings and whatever else goes wrong is written there.
    said = "".join(one.text for one in outputs(notebook) if one.output_type == "stream" and one.name == "stderr")
    assert "Warning" not in said and "Error" not in said, said


@pytest.mark.parametrize("name", FIGURES)
def test_notebook_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notebook = run(name, tmp_path, monkeypatch)
    check(notebook, name)
    if name.startswith("3_"):
        assert "model: mixed" in text(notebook)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.ipynb")), ids=lambda path: path.stem)
def test_no_outputs_are_kept(path: Path) -> None:
    assert path.stem in FIGURES
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert not cell.outputs and cell.execution_count is None
