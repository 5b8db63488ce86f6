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

from .errors import CampaignError, load
from .values import Value, canonical, digest, overlay

Values = Mapping[str, Value]

#: Cells of items before, which the next ones often share.
_CELLS: dict[str, Any] = {}
_MOST_CELLS = 64
_LIBRARY: list[Any] = []


def library() -> Any:
    """The package ``stiffarm`` with one worker thread."""
    if not _LIBRARY:
        stiffarm = load("stiffarm", "A built-in task")
        stiffarm.set_threads(1)
        _LIBRARY.append(stiffarm)
    return _LIBRARY[0]


def changes_of(values: Values, shared: Mapping[str, Any]) -> dict[str, Any]:
    """What an item changes in its cell, as keys of a cell file; without the prior's scatter.

    A tool or load takes the place of the cell's own; ``anchor_mm``, ``load_n`` and
    ``noise_factor`` change one key.

    Raises:
        CampaignError: ``missing-key`` where there is no variance for ``noise_factor`` to multiply.
    """
    keys = shared["cells"][values["cell"]]["keys"]
    changes: dict[str, Any] = {}
    for axis, tables in (("tool", "tools"), ("load", "loads")):
        if axis in values:
            new = shared[tables][values[axis]]
            # None takes a key of the old table away.
            changes[axis] = {**dict.fromkeys(keys.get(axis, {})), **new}
    if "anchor_mm" in values:
        anchor = {"anchor_mm": list(values["anchor_mm"])}  # type: ignore[arg-type]
        changes = overlay(changes, {"load": anchor})
    if "load_n" in values:
        changes = overlay(changes, {"load": {"magnitude_n": values["load_n"]}})
    if "noise_factor" in values:
        variance = keys.get("noise", {}).get("variance_mm2")
        if variance is None:
            raise CampaignError(
                "missing-key",
                f"The cell {values['cell']} has no variance that noise_factor could multiply.",
                place={"key": "noise.variance_mm2"},
            )
        changes["noise"] = {"variance_mm2": variance * float(values["noise_factor"])}  # type: ignore[arg-type]
    return changes


def cell_of(values: Values, shared: Mapping[str, Any], scattered: bool = False) -> Any:
    """The cell of an item.

    Args:
        values: Values of the item.
        shared: What the driver prepared.
        scattered: With the prior stiffness drawn about the cell's own, as the item's
            ``prior_scatter`` says; this is what a planner knows, not the truth.
    """
    changes = changes_of(values, shared)
    known = shared["cells"][values["cell"]]
    scatter = float(values.get("prior_scatter", 0.0))  # type: ignore[arg-type]
    if scattered and scatter > 0.0:
        prior = known["prior_nm_per_rad"]
        if prior is None:
            raise CampaignError(
                "missing-key",
                f"The cell {values['cell']} has no stiffness that prior_scatter could change.",
                place={"key": "stiffness.prior_nm_per_rad"},
            )
        drawn = scatter_prior(prior, scatter, int(values.get("seed", 1)))  # type: ignore[arg-type]
        changes["stiffness"] = {"prior_nm_per_rad": drawn}
    cell = known["cell"]
    if not changes:
        return cell
    key = canonical([values["cell"], changes])
    if key not in _CELLS:
        if len(_CELLS) >= _MOST_CELLS:
            _CELLS.clear()
        _CELLS[key] = cell.with_changes(changes)
    return _CELLS[key]


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
