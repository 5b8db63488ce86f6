"""The cell of an item, and the files it needs, on whatever machine the item runs."""

from __future__ import annotations

import contextlib
import math
import os
import random
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..cell import Cell
from .errors import CampaignError
from .values import canonical, digest

Values = Mapping[str, Any]

#: Cells of items before, which the next ones often share.
_CELLS: dict[str, Cell] = {}
_MOST_CELLS = 64


def cell_of(values: Values, shared: Mapping[str, Any], scattered: bool = False) -> Cell:
    """The cell of an item.

    A tool or load takes the place of the cell's own; ``anchor_mm``, ``load_n`` and ``noise_factor`` change one key.

    Args:
        values: Values of the item.
        shared: What the driver prepared.
        scattered: With the prior stiffness drawn about the cell's own, as the item's ``prior_scatter`` says; this is
            what a planner knows, not the truth.

    Raises:
        CampaignError: ``missing-key`` where the cell lacks what an axis changes.
    """
    cell: Cell = shared["cells"][values["cell"]]
    keys = cell.to_dict()
    changes: dict[str, Any] = {}
    for axis, tables in (("tool", "tools"), ("load", "loads")):
        if axis in values:
            # None takes a key of the old table away.
            changes[axis] = {**dict.fromkeys(keys.get(axis, {})), **shared[tables][values[axis]]}
    if "anchor_mm" in values:
        changes.setdefault("load", {})["anchor_mm"] = list(values["anchor_mm"])
    if "load_n" in values:
        changes.setdefault("load", {})["magnitude_n"] = values["load_n"]
    if "noise_factor" in values:
        variance = _known(keys.get("noise", {}).get("variance_mm2"), "noise.variance_mm2", "noise_factor")
        changes["noise"] = {"variance_mm2": variance * values["noise_factor"]}
    scatter = values.get("prior_scatter", 0.0)
    if scattered and scatter > 0.0:
        prior = _known(cell.prior_stiffness, "stiffness.prior_nm_per_rad", "prior_scatter").tolist()
        changes["stiffness"] = {"prior_nm_per_rad": scatter_prior(prior, scatter, values.get("seed", 1))}
    if not changes:
        return cell
    key = canonical([values["cell"], changes])
    if key not in _CELLS:
        if len(_CELLS) >= _MOST_CELLS:
            _CELLS.clear()
        _CELLS[key] = cell.with_changes(changes)
    return _CELLS[key]


def _known(value: Any, key: str, axis: str) -> Any:
    if value is None:
        raise CampaignError(f"This cell has nothing that {axis} could change.", "missing-key", {"key": key})
    return value


def scatter_prior(prior: Sequence[float], scatter: float, seed: int) -> list[float]:
    """Each stiffness times exp(scatter · z) with z normal [N·m/rad]; one draw for each seed."""
    draws = random.Random(f"stiffarm prior {seed}")
    return [value * math.exp(scatter * draws.gauss(0.0, 1.0)) for value in prior]


def file_of(name: str, shared: Mapping[str, Any]) -> str:
    """A file of the campaign on this machine: the driver's own, or a copy of it."""
    if name.startswith("builtin:"):
        return name
    known = shared["files"][name]
    path = Path(known["path"])
    with contextlib.suppress(OSError):
        if path.read_bytes() == known["data"]:
            return str(path)
    copy = Path(tempfile.gettempdir()) / f"stiffarm-{digest(known['data'])[:16]}-{path.name}"
    if not copy.exists():
        part = copy.with_name(f"{copy.name}.{os.getpid()}")
        part.write_bytes(known["data"])
        os.replace(part, copy)
    return str(copy)
