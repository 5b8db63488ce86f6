"""Programs are read as tables of points and written back, and what does not fit its program is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stiffarm

GCODE = "(SLOT)\nG90 G21 G94\nG0 X0 Y0 Z20 (above)\nG1 Z0 F300\nG1 X40.0 F1200\nG0 Z20\n(EDGE)\nG1 Y10\n"
KRL = "DEF a()\n$VEL.CP=0.02\nLIN XP1\nLIN {X 10, Y 5}\nEND\n"
DAT = "DEFDAT a\nDECL E6POS XP1={X 0.0,Y 0.0,Z 5.0,A 0.0,B 90.0,C 0.0}\nENDDAT\n"


@pytest.fixture
def cell() -> stiffarm.Cell:
    force = {"force_n": [-200, 100, 50], "axes": "path"}
    work = {"workpiece_mm": [1500, 0, 900], "tip_mm": [0, 0, 200], "force": force, "milling": None}
    return stiffarm.Cell.built_in("comau").with_changes({"work": work})


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "part.nc"
    path.write_text(GCODE)
    return path


def test_a_program_is_a_table_of_its_points(cell: stiffarm.Cell, program: Path) -> None:
    points = stiffarm.read_path(cell, program)
    assert points["x_mm"].tolist()[0] == 0.0 and points["z_mm"].tolist()[0] == 20.0
    assert np.allclose(points["axis_z"], -1)
    assert points["feature"] == ["SLOT"] * (points["feature"].index("EDGE")) + ["EDGE"] * points["feature"].count("EDGE")
    assert set(points["feed_mm_per_min"][~np.isnan(points["feed_mm_per_min"])]) == {300.0, 1200.0}
    # Rapid moves have no load, the others that of the cell.
    assert np.nonzero(points["fx_n"] == 0)[0][0] == 0 and np.isnan(points["fx_n"]).sum() == points.row_count - 2


def test_a_prediction_of_the_table_is_that_of_the_program(cell: stiffarm.Cell, program: Path) -> None:
    stiffness = [3e6, 3e6, 2e6, 5e5, 4e5, 2e5]
    of_file = stiffarm.predict(cell, stiffness, program)
    of_table = stiffarm.predict(cell, stiffness, stiffarm.read_path(cell, program))
    deflections = [[point["deflection_m"] for point in one.points] for one in (of_file, of_table)]
    assert np.abs(np.array(deflections[0]) - np.array(deflections[1])).max() < 1e-12
    assert np.abs(deflections[0]).max() > 1e-5


def test_a_program_goes_out_as_it_came_in_and_moved(cell: stiffarm.Cell, program: Path, tmp_path: Path) -> None:
    points = stiffarm.read_path(cell, program)
    same = stiffarm.write_path(cell, program, points, tmp_path / "same.nc")
    assert same.read_bytes() == program.read_bytes()
    moved = {**points, "z_mm": points["z_mm"] + 0.25}
    higher = stiffarm.write_path(cell, program, moved, tmp_path / "higher.nc")
    assert "(above)" in higher.read_text() and "Z20.25" in higher.read_text()
    assert np.allclose(stiffarm.read_path(cell, higher)["z_mm"], moved["z_mm"], atol=1e-4)
    with pytest.raises(stiffarm.StiffarmError) as error:
        stiffarm.write_path(cell, program, moved, higher)
    assert error.value.code == "file-exists"
    stiffarm.write_path(cell, program, points, higher, overwrite=True)
    assert higher.read_bytes() == program.read_bytes()


def test_a_cell_may_be_the_name_of_its_file(cell: stiffarm.Cell, program: Path, tmp_path: Path) -> None:
    file = tmp_path / "cell.toml"
    file.write_text(cell.to_toml())
    assert stiffarm.read_path(file, program) == stiffarm.read_path(cell, program)
    same = stiffarm.write_path(str(file), program, stiffarm.read_path(str(file), program), tmp_path / "same.nc")
    assert same.read_bytes() == program.read_bytes()


def test_what_is_not_followed_is_among_the_findings(cell: stiffarm.Cell, program: Path) -> None:
    program.write_text(GCODE + "/G1 Y20\nG777\nG1 Y30\n")
    with pytest.warns(stiffarm.StiffarmWarning, match="G777"):
        points = stiffarm.read_path(cell, program)
    findings = {finding.code: (finding.severity, finding.sentence) for finding in points.findings}
    assert findings["optional-blocks"][0] == "note" and "line 9" in findings["optional-blocks"][1]
    assert findings["not-followed"][0] == "caution" and "line 10" in findings["not-followed"][1]


def test_points_beside_a_program_are_written_beside_it(cell: stiffarm.Cell, tmp_path: Path) -> None:
    source = tmp_path / "a.src"
    source.write_text(KRL)
    source.with_suffix(".dat").write_text(DAT)
    points = stiffarm.read_path(cell, source)
    out = stiffarm.write_path(cell, source, {**points, "x_mm": points["x_mm"] + 1}, tmp_path / "b.src")
    assert "X 1.0" in out.with_suffix(".dat").read_text() and "X 11" in out.read_text()


def test_slips(cell: stiffarm.Cell, program: Path, tmp_path: Path) -> None:
    points = stiffarm.read_path(cell, program)
    table = tmp_path / "path.csv"
    table.write_text(points.to_csv())
    short = {name: column[:-1] for name, column in points.items()}
    for path, columns, code in [
        (table, points, "unsupported"),
        (program, short, "dimension"),
        (tmp_path / "none.nc", points, "file-read"),
    ]:
        with pytest.raises(stiffarm.StiffarmError) as error:
            stiffarm.write_path(cell, path, columns, tmp_path / "out.nc")
        assert error.value.code == code
    assert not (tmp_path / "out.nc").exists()
    program.write_text("G1 X1 Y2 Z3\nG41 X5\n")
    with pytest.raises(stiffarm.StiffarmError) as error:
        stiffarm.read_path(cell, program)
    assert error.value.place["line"] == 2
