"""The arm at work: how far it bends, what to command instead, and where it is stiffest."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _inputs, _stiffarm
from ._checks import checked, number, shown, text, vector, whole
from ._errors import StiffarmError
from ._inputs import Progress, TableLike
from .cell import Cell
from .measure import _stiffness
from .results import Compensated, Identified, Placement, Predicted, StiffnessMap


def _triple(value: ArrayLike | None, key: str, length: int | None = 3) -> list[float] | None:
    return None if value is None else vector(value, key, length)


def _along(
    axes: str | None,
    force_n: ArrayLike | None,
    moment_nm: ArrayLike | None,
    load_uncertainty_percent: float,
    start_deg: ArrayLike | None,
    max_step_deg: float,
    free_turn: int | None,
) -> dict[str, Any]:
    return {
        "axes": axes,
        "force_n": _triple(force_n, "force_n"),
        "moment_nm": _triple(moment_nm, "moment_nm"),
        "load_uncertainty_percent": load_uncertainty_percent,
        "start_deg": _triple(start_deg, "start_deg", None),
        "max_step_deg": max_step_deg,
        "free_turn": free_turn,
    }


@checked
def predict(
    cell: Cell,
    stiffness: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any],
    path: TableLike | None = None,
    *,
    axes: str | None = None,
    force_n: ArrayLike | None = None,
    moment_nm: ArrayLike | None = None,
    load_uncertainty_percent: float = 0.0,
    start_deg: ArrayLike | None = None,
    max_step_deg: float = 30.0,
    free_turn: int | None = None,
    model: str = "equilibrium",
    matrix: bool = False,
    cell_load: bool = False,
    load_case: str | None = None,
    progress: Progress = None,
) -> Predicted:
    """How far the loaded tool bends away along a path, and how sure that is (``stiffarm predict``).

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> bend = stiffarm.predict(cell, "prior", "builtin:contour")
    >>> len(bend.points), bend.deflection_max_m < 0.01
    (61, True)

    Args:
        cell: The cell.
        stiffness: What :func:`identify` found or the name of its file, a list [N·m/rad], the same as
            ``{"stiffness_nm_per_rad": [...]}``, or ``"prior"``.
        path: Joint angles or poses with their loads: a table with the columns of a path file; the tasks of the cell
            unless given.
        axes: Axes of the path's forces and of ``force_n``: ``base``, ``tool``, ``workpiece`` or ``path``.
        force_n: Force on the robot's tip where the path has none [N]; ``axes`` says in which axes.
        moment_nm: Moment about the tip, with ``force_n`` [N·m].
        load_uncertainty_percent: Standard uncertainty of the load [%].
        start_deg: Posture that the first one should be near [deg].
        max_step_deg: Largest change of a joint from point to point [deg].
        free_turn: Where the turn about the tool axis is free: try so many of them.
        model: ``equilibrium`` for the exact static one, or ``linear``.
        matrix: Also the Cartesian stiffness matrix at each point.
        cell_load: The cell's own load, acting at its loading point, instead of a load at the tip; the deflection is
            that of the tip all the same.
        load_case: Which of several load cases, with ``cell_load``.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: Anything wrong with path or stiffness; poses out of reach, with the line of the path.
    """
    along = _along(axes, force_n, moment_nm, load_uncertainty_percent, start_deg, max_step_deg, free_turn)
    with _inputs.Watching(progress) as told:
        return Predicted._of(
            _stiffarm.predict(
                cell._native,
                _stiffness(cell, stiffness),
                None if path is None else _inputs.table(path, "path"),
                along,
                model,
                matrix,
                cell_load,
                load_case,
                told,
            )
        )


@checked
def compensate(
    cell: Cell,
    stiffness: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any],
    path: TableLike,
    *,
    axes: str | None = None,
    force_n: ArrayLike | None = None,
    moment_nm: ArrayLike | None = None,
    load_uncertainty_percent: float = 0.0,
    start_deg: ArrayLike | None = None,
    max_step_deg: float = 30.0,
    free_turn: int | None = None,
    progress: Progress = None,
) -> Compensated:
    """The commands that make up for the deflection along a path (``stiffarm compensate``).

    Arguments are those of :func:`predict`. Look at ``findings`` before commanding: the command writes no path with a
    serious one, or with ``beyond-measured`` or ``beyond-load``, unless it is asked to.

    Raises:
        StiffarmError: As :func:`predict`.
    """
    along = _along(axes, force_n, moment_nm, load_uncertainty_percent, start_deg, max_step_deg, free_turn)
    with _inputs.Watching(progress) as told:
        return Compensated._of(
            _stiffarm.compensate(
                cell._native, _stiffness(cell, stiffness), _inputs.table(path, "path"), along, told
            )
        )


def _region(
    plane: tuple[str, float] | None,
    from_mm: ArrayLike | None,
    to_mm: ArrayLike | None,
    steps: int | Sequence[int] | None,
) -> dict[str, Any]:
    counts: list[int] | None = None
    if steps is not None:
        counts = [whole(n, "steps") for n in (steps if isinstance(steps, (list, tuple, np.ndarray)) else [steps])]
    if plane is not None:
        if not isinstance(plane, (list, tuple)) or len(plane) != 2:
            message = f"A plane is a name and a coordinate, got {shown(plane)}."
            raise StiffarmError(message, "wrong-type", {"key": "plane"}, hint='for example plane=("z", 800.0)')
        plane = text(plane[0], "plane"), number(plane[1], "plane")
    return {"plane": plane, "from_mm": _triple(from_mm, "from_mm"), "to_mm": _triple(to_mm, "to_mm"), "steps": counts}


@checked
def map(
    cell: Cell,
    stiffness: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any],
    *,
    plane: tuple[str, float] | None = None,
    from_mm: ArrayLike | None = None,
    to_mm: ArrayLike | None = None,
    steps: int | Sequence[int] | None = None,
    rpy_deg: ArrayLike | None = None,
    free_turn: int | None = None,
    force_n: ArrayLike | None = None,
    moment_nm: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    progress: Progress = None,
) -> StiffnessMap:
    """Stiffness over a region of the workspace (``stiffarm map``).

    Args:
        cell: The cell.
        stiffness: As :func:`predict` has it.
        plane: A plane of the base frame, for example ``("z", 800.0)`` [mm].
        from_mm: Lower corner [mm]; the cell's box, else what the arm may reach.
        to_mm: Upper corner [mm].
        steps: Nodes along the longest side, or along x, y and z.
        rpy_deg: Orientation of the tip frame: turns about the base's x, then y, then z [deg]; the tool axis down unless
            given.
        free_turn: Where the turn about the tool axis is free: try so many of them.
        force_n: Force on the robot at the tip, base axes [N].
        moment_nm: Moment about the tip, base axes, with ``force_n`` [N·m].
        direction: Direction of the stiffness, base axes.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: A region that is none, or of more nodes than a map may have.
    """
    with _inputs.Watching(progress) as told:
        return StiffnessMap._of(
            _stiffarm.map(
                cell._native,
                _stiffness(cell, stiffness),
                _region(plane, from_mm, to_mm, steps),
                _triple(rpy_deg, "rpy_deg"),
                free_turn,
                _triple(force_n, "force_n"),
                _triple(moment_nm, "moment_nm"),
                _triple(direction, "direction"),
                told,
            )
        )


@checked
def place(
    cell: Cell,
    stiffness: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any],
    path: TableLike,
    *,
    axes: str | None = None,
    plane: tuple[str, float] | None = None,
    from_mm: ArrayLike | None = None,
    to_mm: ArrayLike | None = None,
    steps: int | Sequence[int] | None = None,
    yaw_deg: Sequence[float] = (0.0,),
    refine: int = 2,
    free_turn: int | None = None,
    progress: Progress = None,
) -> Placement:
    """The place of the workpiece where a path bends the arm least (``stiffarm map --place``).

    Args:
        cell: The cell.
        stiffness: As :func:`predict` has it.
        path: As :func:`predict` has it.
        axes: Axes of the path's forces where its rows do not say.
        plane: As :func:`map` has it, as all of the region.
        from_mm: Lower corner [mm].
        to_mm: Upper corner [mm].
        steps: Nodes.
        yaw_deg: Turns of the workpiece about the base's z to try [deg].
        refine: Finer grids, each about the best place so far; 8 at most.
        free_turn: Turns about the tool axis to try where the path leaves it free.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: As :func:`map` and :func:`predict`.
    """
    with _inputs.Watching(progress) as told:
        return Placement._of(
            _stiffarm.place_workpiece(
                cell._native,
                _stiffness(cell, stiffness),
                _inputs.table(path, "path"),
                axes,
                _region(plane, from_mm, to_mm, steps),
                [float(yaw) for yaw in yaw_deg],
                refine,
                free_turn,
                told,
            )
        )
