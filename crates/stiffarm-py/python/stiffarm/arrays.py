"""Arrays beside the commands: indices of many groups at once, Ψ, bounds of a plan of one's own, simulated tables."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _checks, _inputs, _native_cell, _stiffarm
from ._checks import number, text, texts, truth, whole
from ._inputs import PosturesLike, Progress
from ._record import Record
from ._table import Table
from .cell import Cell
from .postures import Postures, angles_of

#: Indices that :func:`indices` gives unless others are named: all but ``prediction``, which takes longer than all others
#: together.
USUAL = tuple(name for name, *_ in _stiffarm.index_names() if name != "prediction")


def _postures(cell: Cell, value: PosturesLike, degrees: bool) -> Postures:
    """Postures of a file for the robot of the cell, or of what is at hand."""
    in_degrees = truth(degrees, "degrees")
    if isinstance(value, (str, os.PathLike)):
        return Postures.read(value, cell)
    return Postures.of(value, degrees=in_degrees)


def certificate(
    cell: Cell,
    postures: PosturesLike,
    *,
    index: str = "expected_error",
    given: PosturesLike | None = None,
    samples: int | None = None,
    degrees: bool = False,
    progress: Progress = None,
) -> Record:
    """How good a plan is beside the best that any plan of as many postures could be.

    Args:
        cell: The cell.
        postures: The plan.
        index: ``expected_error``, ``d`` or ``task``; others have no bound.
        given: Postures measured already.
        samples: Local searches that the bound rests on; 1024 unless given.
        degrees: Arrays are in degrees.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: An index without a bound (``unsupported``).
    """
    own = _postures(cell, postures, degrees).angles
    before = np.zeros((0, own.shape[1])) if given is None else _postures(cell, given, degrees).angles
    limit = None if samples is None else whole(samples, "samples")
    with _inputs.Watching(progress) as told:
        found, _ = _stiffarm.certificate(_native_cell.of(cell), text(index, "index"), own, before, limit, told)
    return Record(json.loads(found))


def indices(
    cell: Cell,
    postures: ArrayLike,
    names: Sequence[str] | None = None,
    *,
    degrees: bool = False,
) -> dict[str, Any]:
    """Indices of a group of postures, or of many groups at once on all cores.

    >>> import numpy as np, stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> group = stiffarm.Postures.read("builtin:comau-group1", cell)
    >>> many = np.stack([group.angles, group.angles + 0.1])
    >>> stiffarm.indices(cell, many, ["expected_error", "d"])["d"].shape
    (2,)

    Args:
        cell: The cell.
        postures: Angles of one group, postures × joints, or of many, groups × postures × joints [rad].
        names: Which indices; all but ``prediction`` unless given.
        degrees: The angles are in degrees.

    Returns:
        For one group numbers, for many arrays, by name; NaN where an index does not exist. The numbers are those of
        :func:`evaluate`, which takes angles as a posture file has them, in degrees: others than those that degrees reach
        are off there by the last bit.

    Raises:
        StiffarmError: An unknown index, angles of the wrong number or not finite.
    """
    own = _native_cell.of(cell)
    in_degrees = truth(degrees, "degrees")
    if _checks.depth(postures) == 3:
        array = angles_of(postures, in_degrees, 3, "Groups")
    else:
        array = angles_of(postures, in_degrees)
    wanted = list(USUAL) if names is None else texts(names, "names")
    if array.ndim == 3:
        return _stiffarm.indices(own, array, wanted)
    found = _stiffarm.indices(own, array[np.newaxis], wanted)
    return {name: float(values[0]) for name, values in found.items()}


def observation_matrix(
    cell: Cell,
    postures: ArrayLike,
    *,
    rotation_length: float | None = None,
    degrees: bool = False,
) -> NDArray[np.float64]:
    """Ψ of Ψ H = Δ, Eqs. (9)–(11).

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> stiffarm.observation_matrix(cell, [[0, 0, -90, 0, 45, 0], [30, 10, -120, 0, 20, 60]], degrees=True).shape
    (24, 6)

    Args:
        cell: The cell; its load gives the wrench at each posture.
        postures: Angles, postures × joints [rad].
        rotation_length: Also rows of rotations, multiplied by this length [m].
        degrees: The angles are in degrees.

    Returns:
        (3 · points · postures) × springs [m·N·m/rad]; rows by posture, load case, measuring point, then x, y, z in base
        axes (with rotations 6 rows per point).

    Raises:
        StiffarmError: Angles of the wrong number or not finite; a load that only a measurement gives.
    """
    own = _native_cell.of(cell)
    array = angles_of(postures, truth(degrees, "degrees"))
    length = None if rotation_length is None else number(rotation_length, "rotation_length")
    return _stiffarm.observation_matrix(own, array, length)


def index_names() -> dict[str, str]:
    """Every index with what it is; lower is better unless it says otherwise."""
    return {name: meaning for name, meaning, *_ in _stiffarm.index_names()}


def simulate_measurements(
    cell: Cell,
    postures: PosturesLike,
    *,
    seed: int = 1,
    readings: bool = False,
    degrees: bool = False,
) -> Table:
    """One simulated measurement (exact model, the cell's prior stiffness), to try :func:`identify` on.

    Args:
        cell: The cell.
        postures: What is measured.
        seed: Seed of the noise.
        readings: Raw readings of a whole experiment (tracker somewhere, loads up and down, repeats, drift) instead of
            displacements.
        degrees: An array is in degrees.

    Returns:
        The table, as ``stiffarm simulate --measurements`` or ``--readings`` writes it.

    Raises:
        StiffarmError: A cell without prior.
    """
    own = _postures(cell, postures, degrees)
    raw = truth(readings, "readings")
    made = _stiffarm.simulate_measurements(_native_cell.of(cell), own.names, own.angles, whole(seed, "seed"), raw)
    return Table.from_csv(made)
