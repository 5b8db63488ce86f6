"""The reference cell and its golden numbers, read from the repository's own files.

Every peer takes its numbers from here, so that all of them work on the same cell.
SI inside: m, rad, N.
"""

import json
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
GOLDEN_FILE = ROOT / "crates/stiffarm/tests/golden/cell-comau.json"
CELL_FILE = ROOT / "cells/comau-reference.toml"

# The paper's group size (Section III.B).
POSTURES = 6


class BenchError(Exception):
    """Something the user has to know: a sentence that says what is wrong and what to do."""


@dataclass(frozen=True)
class Cell:
    """What the novel index needs of a cell."""

    rows: np.ndarray  # n x 4, modified Denavit-Hartenberg rows: alpha, a, d, offset
    coupling: np.ndarray  # n x n, serial angles = offset + coupling @ controller angles
    bounds: np.ndarray  # n x 2, controller angles [rad]
    loading_point: np.ndarray  # 3, flange axes [m]
    measuring_points: np.ndarray  # points x 3, flange axes [m]; the first is the TCP
    anchor: np.ndarray  # 3, base axes [m]
    magnitude: float  # force of the rope [N]
    length: float  # characteristic length of Eq. (20) [m]

    @property
    def joints(self):
        return len(self.rows)

    def group_bounds(self, postures=POSTURES):
        """Lower and upper bounds of all angles of a group, posture by posture."""
        return np.tile(self.bounds[:, 0], postures), np.tile(self.bounds[:, 1], postures)

    def random_group(self, generator, postures=POSTURES):
        """A flat group drawn uniformly from the bounds."""
        lower, upper = self.group_bounds(postures)
        return generator.uniform(lower, upper)


def golden_numbers():
    """The golden file as it is."""
    try:
        return json.loads(GOLDEN_FILE.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        name = GOLDEN_FILE.relative_to(ROOT)
        raise BenchError(
            f"The golden numbers {name} cannot be read ({error}); run from a complete checkout."
        ) from error


def reference_cell():
    """The reference cell; robot from the golden file, the rest from the shipped cell file.

    The robot's rows live in stiffarm's catalogue, which only Rust reads; the golden file has a
    copy. What both files have must agree, otherwise the peers would race on another cell.
    """
    golden = golden_numbers()
    shipped = tomllib.loads(CELL_FILE.read_text(encoding="utf-8"))
    tool, load = shipped["tool"], shipped["load"]
    millimetres = 1e-3
    cell = Cell(
        rows=np.array(golden["robot"]["dh_rows_alpha_a_d_offset"]),
        coupling=np.array(golden["robot"]["theta_from_q"]),
        bounds=np.array(shipped["bounds"]["q_deg"]) * (math.pi / 180),
        loading_point=np.array(tool["loading_point_mm"]) * millimetres,
        measuring_points=np.array([p["position_mm"] for p in tool["measuring_point"]])
        * millimetres,
        anchor=np.array(load["anchor_mm"]) * millimetres,
        magnitude=float(load["magnitude_n"]),
        length=shipped["robot"]["characteristic_length_mm"] * millimetres,
    )
    pairs = {
        "bounds": (np.degrees(cell.bounds), golden["robot"]["bounds_deg"]),
        "loading point": (cell.loading_point, golden["tool"]["loading_point"]),
        "measuring points": (cell.measuring_points, golden["tool"]["measuring_points"]),
        "anchor": (cell.anchor, golden["load"]["anchor"]),
        "force": (cell.magnitude, golden["load"]["magnitude_n"]),
        "characteristic length": (cell.length, golden["characteristic_length_m"]),
    }
    for what, (here, there) in pairs.items():
        if np.shape(here) != np.shape(there) or not np.allclose(
            here, there, rtol=1e-12, atol=1e-12
        ):
            raise BenchError(
                f"The {what} of {CELL_FILE.relative_to(ROOT)} and of "
                f"{GOLDEN_FILE.relative_to(ROOT)} differ; the golden numbers belong to the "
                "reference cell as shipped, so undo the change of one of them."
            )
    return cell


def check_golden(name, evaluate):
    """Holds a peer's index against the golden numbers before anything is timed.

    `evaluate(x)` takes a flat group [rad] and gives (ln cond(Psi), ln k(J_N) per posture).
    Returns the largest relative difference.
    """
    golden = golden_numbers()
    worst = 0.0
    for key in ("group1", "random_group"):
        expected = golden[key]
        log_condition, log_dexterity = evaluate(np.radians(expected["q_deg"]).ravel())
        condition, dexterity = np.exp(log_condition), np.exp(np.asarray(log_dexterity))
        found = {
            "k(J_N)": (dexterity, expected["k_jn"]),
            "cond(Psi)": (condition, expected["cond_psi"]),
            "novel index": (condition * dexterity.max(), expected["novel"]),
        }
        for what, (value, wanted) in found.items():
            difference = float(np.max(np.abs(np.asarray(value) / np.asarray(wanted) - 1)))
            # Gram matrices lose cond(Psi)^2 in rounding, about 1e-10 here.
            if not difference < 1e-8:
                raise BenchError(
                    f"{name}: {what} of {key} is {value}, the golden number is {wanted} "
                    f"(relative difference {difference:.1e}). This peer computes something else; "
                    "nothing was timed. Correct it before its numbers are compared."
                )
            worst = max(worst, difference)
    return worst
