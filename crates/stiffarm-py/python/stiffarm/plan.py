"""Which postures to measure, and how good any plan can be."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _inputs, _stiffarm
from ._checks import checked
from ._checks import count as count_of
from ._checks import native, number, shown, texts, truth, vector
from ._errors import StiffarmError
from ._inputs import PosturesLike, Progress, TableLike
from .cell import Cell
from .results import Certificate, Checked, Chosen, Curve, Dropped, Evaluated, Plan, SpaceFilling

#: Indices that :func:`indices` gives unless others are named: all but ``prediction``, which takes longer than all others
#: together.
USUAL = tuple(name for name, _, _ in _stiffarm.index_names() if name != "prediction")


@checked
def select(
    cell: Cell,
    postures: int | None = None,
    *,
    index: str = "expected_error",
    start: PosturesLike | None = None,
    given: PosturesLike | None = None,
    candidates: TableLike | None = None,
    add: int | None = None,
    rounds: int | None = None,
    time_limit_s: float | None = None,
    seed: int | None = None,
    max_iterations: int = 2000,
    angle_step_deg: float = 0.01,
    anchor_box_mm: ArrayLike | None = None,
    loading_point_box_mm: ArrayLike | None = None,
    largest_load_n: float | None = None,
    certificate: bool = True,
    sensitivity: bool = False,
    prices: bool = False,
    accept: Callable[[NDArray[np.float64]], bool] | None = None,
    degrees: bool = False,
    progress: Progress = None,
) -> Plan | Chosen:
    """Selects postures to measure (``stiffarm select``).

    Without more it searches the whole joint space for the best group; ``start`` improves a group locally as the paper
    does (Section III.B), ``given`` adds postures to ones that stay, ``candidates`` chooses out of a list.

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau-reference")
    >>> plan = stiffarm.select(cell, 3, rounds=1, certificate=False)
    >>> plan.postures
    <3 postures of 6 joints: 1, 2, 3>
    >>> print(f"{100 * plan.value:.1f} % expected error of a joint stiffness")
    1.3 % expected error of a joint stiffness

    Args:
        cell: The cell.
        postures: How many to select; 6 unless given.
        index: What to improve; :func:`index_names` lists the indices.
        start: An initial group to improve locally.
        given: Postures measured or planned already; ``add`` says how many more (1 unless given).
        candidates: A list to choose from: postures, or measurements, whose postures count under their wrenches.
        rounds: Exactly so many rounds of the search: the same result on any number of threads.
        time_limit_s: End after the round in which this time is over [s]. Without either, until nothing improves.
        seed: Seed of the random numbers; 1 unless given.
        max_iterations: Iterations of the optimiser from an initial group.
        angle_step_deg: Steps that angles are rounded to [deg]; 0 leaves them as they are.
        anchor_box_mm: Box in which the anchor may be chosen too: lowest and highest corner, base axes [mm].
        loading_point_box_mm: The same for the loading point, flange axes [mm].
        largest_load_n: Largest force allowed [N].
        certificate: Whether to bound how good any plan could be.
        sensitivity: Whether to examine if wrong assumptions would change the plan.
        prices: Whether to say what each kind of limit costs.
        accept: A constraint of your own: called with the angles of one posture [rad], true where it may be chosen.
            It is asked about candidates, at the end of each local search and about the plan itself, not at every
            step, from several threads one after the other; its answer must depend on the angles alone. What can be
            said as a limit of the cell is better said there.
        degrees: Arrays of ``start`` and ``given`` are in degrees.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Returns:
        The plan; Ctrl-C ends the search with the best so far (``interrupted`` is set, and a warning says so).

    Raises:
        StiffarmError: Options that exclude each other; a cell without what the index needs; postures that cannot
            determine every joint (``not-identifiable``).
    """
    if accept is not None and not callable(accept):
        raise StiffarmError(f"This must be a function, got {shown(accept)}.", "wrong-type", {"key": "accept"})
    for key, value in (("postures", postures), ("add", add)):
        if value is not None:
            count_of(value, key)
    if candidates is not None:
        refused = {"start": start, "given": given, "add": add, "rounds": rounds, "time_limit_s": time_limit_s}
        refused |= {"anchor_box_mm": anchor_box_mm, "loading_point_box_mm": loading_point_box_mm}
        refused |= {"largest_load_n": largest_load_n, "sensitivity": sensitivity or None, "prices": prices or None}
        refused |= {"accept": accept}
        _refuse("candidates", refused)
        with _inputs.Watching(progress) as told:
            return Chosen._of(
                _stiffarm.select_candidates(
                    cell._native,
                    index,
                    6 if postures is None else postures,
                    _list(candidates, degrees=degrees),
                    seed,
                    certificate,
                    told,
                )
            )
    if start is not None:
        refused = {"postures": postures, "given": given, "rounds": rounds, "time_limit_s": time_limit_s}
        refused |= {"anchor_box_mm": anchor_box_mm, "loading_point_box_mm": loading_point_box_mm}
        refused |= {"largest_load_n": largest_load_n, "prices": prices or None, "accept": accept}
        _refuse("start", refused)
    if given is not None:
        refused = {"postures": postures, "anchor_box_mm": anchor_box_mm, "sensitivity": sensitivity or None}
        refused |= {"loading_point_box_mm": loading_point_box_mm, "largest_load_n": largest_load_n}
        _refuse("given", refused)
    elif add is not None:
        raise StiffarmError("Postures are added to given ones.", "conflict", {"key": "add"}, hint="give given=")
    count = (1 if add is None else add) if given is not None else (6 if postures is None else postures)
    load = {
        "anchor_box_mm": _box(anchor_box_mm, "anchor_box_mm"),
        "loading_point_box_mm": _box(loading_point_box_mm, "loading_point_box_mm"),
        "largest_load_n": largest_load_n,
    }
    with _inputs.Watching(progress) as told:
        return Plan._of(
            _stiffarm.select(
                cell._native,
                index,
                count,
                None if start is None else _inputs.postures(start, "initial", degrees=degrees),
                None if given is None else _inputs.postures(given, "given", degrees=degrees),
                max_iterations,
                {"rounds": rounds, "time_limit_s": time_limit_s, "seed": seed},
                angle_step_deg,
                load,
                certificate,
                sensitivity,
                prices,
                accept,
                told,
            )
        )


@checked
def space_filling(
    cell: Cell,
    postures: int = 6,
    *,
    seed: int | None = None,
    angle_step_deg: float = 0.01,
    progress: Progress = None,
) -> SpaceFilling:
    """Postures that cover the joint space evenly, without any index: a baseline (``stiffarm select --space-filling``).

    Raises:
        StiffarmError: No posture within bounds and limits.
    """
    with _inputs.Watching(progress) as told:
        return SpaceFilling._of(
            _stiffarm.select_space_filling(cell._native, postures, seed, angle_step_deg, told)
        )


@checked
def drop(
    cell: Cell,
    given: PosturesLike,
    count: int = 1,
    *,
    index: str = "expected_error",
    degrees: bool = False,
    progress: Progress = None,
) -> Dropped:
    """Which of the given postures are least worth their measuring time (``stiffarm select --given --drop``).

    Raises:
        StiffarmError: As many as there are, or postures that leave a joint undetermined.
    """
    with _inputs.Watching(progress) as told:
        return Dropped._of(
            _stiffarm.select_drop(
                cell._native, index, _inputs.postures(given, "given", degrees=degrees), count, told
            )
        )


@checked
def curve(
    cell: Cell,
    largest: int = 12,
    *,
    index: str = "expected_error",
    rounds: int | None = None,
    time_limit_s: float | None = None,
    seed: int | None = None,
    certificate: bool = True,
    progress: Progress = None,
) -> Curve:
    """The best value for each number of postures, and what one more gains (``stiffarm select --curve``).

    Raises:
        StiffarmError: A cell without what the index needs.
    """
    count_of(largest, "largest")
    budget = {"rounds": rounds, "time_limit_s": time_limit_s, "seed": seed}
    with _inputs.Watching(progress) as told:
        return Curve._of(
            _stiffarm.select_curve(cell._native, index, largest, budget, certificate, told)
        )


@checked
def certificate(
    cell: Cell,
    postures: PosturesLike,
    *,
    index: str = "expected_error",
    given: PosturesLike | None = None,
    samples: int | None = None,
    degrees: bool = False,
    progress: Progress = None,
) -> Certificate:
    """How good a plan is beside the best that any plan of as many postures could be.

    Args:
        cell: The cell.
        postures: The plan.
        index: ``expected_error``, ``d`` or ``task``; others have no bound.
        given: Postures measured already.
        samples: Local searches that the bound rests on; 1024 unless given.
        degrees: Arrays are in degrees.
        progress: As :func:`select` has it.

    Raises:
        StiffarmError: An index without a bound (``unsupported``).
    """
    with _inputs.Watching(progress) as told:
        return Certificate._of(
            _stiffarm.certificate(
                cell._native,
                index,
                _inputs.postures(postures, degrees=degrees),
                None if given is None else _inputs.postures(given, "given", degrees=degrees),
                samples,
                told,
            )
        )


@checked
def check(cell: Cell) -> Checked:
    """What to know about a cell before anybody measures: units that look wrong, what its postures can tell of each joint
    (``stiffarm check``).

    Raises:
        StiffarmError: A cell whose postures cannot be calculated.
    """
    return Checked._of(_stiffarm.check(native(cell)))


@checked
def evaluate(
    cell: Cell,
    groups: PosturesLike | Mapping[str, PosturesLike] | Iterable[PosturesLike],
    *,
    degrees: bool = False,
) -> Evaluated:
    """Every index and the expected errors of groups of postures (``stiffarm evaluate``).

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> found = stiffarm.evaluate(cell, "builtin:comau-group1")
    >>> [group.posture_count for group in found.groups]
    [6]

    Args:
        cell: The cell.
        groups: One group, several, or several by name.
        degrees: Arrays are in degrees.

    Raises:
        StiffarmError: Postures of another robot, angles that are not finite.
    """
    return Evaluated._of(_stiffarm.evaluate(cell._native, _inputs.groups(groups, degrees=degrees)))


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
        :func:`evaluate`.

    Raises:
        StiffarmError: An unknown index, angles of the wrong number or not finite.
    """
    own = native(cell)
    in_degrees = truth(degrees, "degrees")
    if _inputs.depth(postures) == 3:
        array = _inputs.angles(postures, in_degrees, 3, "Groups")
    else:
        array = _inputs.angles(postures, in_degrees)
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
    own = native(cell)
    array = _inputs.angles(postures, truth(degrees, "degrees"))
    length = None if rotation_length is None else number(rotation_length, "rotation_length")
    return _stiffarm.observation_matrix(own, array, length)


def index_names() -> dict[str, str]:
    """Every index with what it is; lower is better unless it says otherwise."""
    return {name: meaning for name, meaning, _ in _stiffarm.index_names()}


def _refuse(option: str, others: Mapping[str, object]) -> None:
    for name, value in others.items():
        if value is not None:
            raise StiffarmError(f"This cannot be used with {option}.", "conflict", {"key": name})


def _box(box: ArrayLike | None, name: str) -> list[list[float]] | None:
    if box is None:
        return None
    try:
        flat = np.asarray(box, dtype=float).reshape(-1)
    except (TypeError, ValueError):
        raise StiffarmError("A box is six numbers.", "wrong-type", {"key": name}) from None
    if flat.size != 6:
        raise StiffarmError("A box is its lowest and its highest corner.", "dimension", {"key": name})
    corners = vector(flat, name)
    return [corners[:3], corners[3:]]


def _list(candidates: Any, *, degrees: bool) -> Any:
    """A list of candidates: a table as it is, postures as theirs."""
    from .postures import Postures

    if isinstance(candidates, (str, os.PathLike)) or (
        _inputs.is_table(candidates) and not isinstance(candidates, Postures)
    ):
        return _inputs.table(candidates, "candidates")
    return "<candidates>", Postures.of(candidates, degrees=degrees).to_csv().encode()
