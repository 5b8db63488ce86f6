"""From readings to joint stiffness: registration, identification, validation, simulation."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _inputs, _stiffarm
from ._checks import checked, vector, whole
from ._errors import StiffarmError, StiffarmWarning
from ._inputs import PosturesLike, Progress, TableLike
from ._result import Record, Result
from ._table import Table
from .cell import Cell
from .results import Coverage, Identified, Registered, Simulation, Validated


def _fit(
    estimator: str | None,
    terms: Sequence[str],
    elastic: str | None,
    weights: str | None,
    prior_std_percent: float | None,
    noise: str | None,
    confidence: float | None,
) -> dict[str, Any]:
    return {
        "estimator": estimator,
        "terms": list(terms),
        "elastic": elastic,
        "weights": weights,
        "prior_std_percent": prior_std_percent,
        "noise": noise,
        "confidence": confidence,
    }


@checked
def identify(
    cell: Cell,
    measurements: TableLike | list[TableLike],
    *,
    postures: PosturesLike | None = None,
    registration: Registered | str | os.PathLike[str] | None = None,
    exclude: Sequence[str] = (),
    estimator: str | None = None,
    terms: Sequence[str] = (),
    elastic: str | None = None,
    weights: str | None = None,
    prior_std_percent: float | None = None,
    noise: str | None = None,
    confidence: float | None = None,
    bootstrap: int | None = None,
    seed: int = 1,
    brief: bool = False,
    flange_fixed: bool = False,
    angle_noise_deg: float | None = None,
    progress: Progress = None,
) -> Identified:
    """Joint stiffness from measured displacements or raw readings, and how far to trust it (``stiffarm identify``).

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> readings = stiffarm.simulate_measurements(cell, "builtin:comau-group1")
    >>> found = stiffarm.identify(cell, readings)
    >>> found.stiffness.shape, found.joints[0].interval.shape
    ((6,), (2,))
    >>> [joint.name for joint in found.joints] == cell.spring_names
    True

    Args:
        cell: The cell.
        measurements: One table or several, with the columns of a measurement file: a path, or a frame.
        postures: Controller angles by posture name, where the measurements have none.
        registration: What places raw readings in the base frame.
        exclude: Postures to leave out, for example those kept for validation.
        estimator: ``two-variance`` unless given; ``ordinary``, ``weighted``, ``huber``, ``non-negative`` or ``prior``.
        terms: Further terms: ``tilt``, ``base``, ``lost``, ... as the command takes them.
        elastic: What gives way: ``axes`` alone, ``mixed`` as far as the data show, ``auto`` what they call for.
        weights: ``readings`` or ``tracker``.
        prior_std_percent: Standard deviation of the cell's prior stiffness for ``estimator="prior"`` [%].
        noise: Size of the noise: ``estimated`` from the residuals, ``known`` from the cell, from ``repeats``.
        confidence: Of the intervals; 0.95 unless given.
        bootstrap: Also resample the postures so often for an interval.
        seed: Seed of the resampling and of the search for the next posture.
        brief: Estimates and residuals only.
        flange_fixed: The flange was fixed: the table has the controller's angles and the wrench of the fixture
            (``--clamped``).
        angle_noise_deg: Standard deviation of a difference of two angles, with ``flange_fixed`` [deg].
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: Anything wrong with a table, with file, line and column; unknown names; too few data.
    """
    fit = _fit(estimator, terms, elastic, weights, prior_std_percent, noise, confidence)
    own = None if postures is None else _inputs.postures(postures)
    tables = _inputs.tables(measurements, "measurements")
    if flange_fixed:
        if len(tables) != 1:
            raise StiffarmError("With flange_fixed one table is read.", "usage", {"key": "measurements"})
        if registration is not None or bootstrap is not None or elastic not in (None, "axes"):
            raise StiffarmError(
                "With flange_fixed there are neither registration nor bootstrap nor another elastic model.",
                "conflict",
                {"key": "flange_fixed"},
            )
        return Identified(
            _stiffarm.identify_with_flange_fixed(
                cell._native, tables[0], own, list(exclude), fit, angle_noise_deg
            )
        )
    with _inputs.Watching(progress) as told:
        return Identified._of(
            _stiffarm.identify(
                cell._native,
                tables,
                own,
                None if registration is None else _inputs.result(registration, "registration"),
                list(exclude),
                fit,
                bootstrap,
                seed,
                brief,
                told,
            )
        )


def diagnose(cell: Cell, measurements: TableLike | list[TableLike], **options: Any) -> Record:
    """What the residuals of an identification say: the ``diagnosis`` of :func:`identify`, whose options it takes.

    Raises:
        StiffarmError: As :func:`identify`; ``brief=True``, which leaves it out.
    """
    found = identify(cell, measurements, **options).diagnosis
    if found is None:
        raise StiffarmError("There is no diagnosis with brief=True.", "conflict", {"key": "brief"})
    return found


@checked
def validate(
    cell: Cell,
    stiffness: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any] | None,
    measurements: TableLike | list[TableLike],
    *,
    postures: PosturesLike | None = None,
    registration: Registered | str | os.PathLike[str] | None = None,
    model: str = "linear",
    tolerance_mm: float | None = None,
    only: Sequence[str] = (),
    folds: int | str | None = None,
    estimator: str | None = None,
    terms: Sequence[str] = (),
    elastic: str | None = None,
    weights: str | None = None,
    prior_std_percent: float | None = None,
    noise: str | None = None,
    confidence: float | None = None,
    progress: Progress = None,
) -> Validated:
    """Calculated against measured displacements, Eq. (22) (``stiffarm validate``).

    Args:
        cell: The cell.
        stiffness: What :func:`identify` found or the name of its file, a list [N·m/rad], or ``None`` with ``folds``.
        measurements: As :func:`identify` has them.
        postures: As :func:`identify` has them.
        registration: As :func:`identify` has it.
        model: ``linear``, or ``equilibrium`` for the exact static one.
        tolerance_mm: Largest deviation allowed [mm]; ``passed`` says whether it is met.
        only: Only these postures.
        folds: Without a stiffness: leave out so many folds of postures in turn and predict each from the others;
            ``"all"`` leaves out one posture at a time. The options below are those of the fits.
        estimator: As :func:`identify` has it; with ``folds`` alone, as all below.
        terms: Further terms.
        elastic: What gives way.
        weights: Relative weight of single displacements.
        prior_std_percent: Standard deviation of the prior [%].
        noise: Size of the noise.
        confidence: Of the bands.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: Both a stiffness and folds, or neither; anything wrong with the inputs.
    """
    fit = _fit(estimator, terms, elastic, weights, prior_std_percent, noise, confidence)
    if (stiffness is None) == (folds is None):
        raise StiffarmError(
            "Either a stiffness is validated, or fits fold by fold.", "usage", {"key": "folds"}
        )
    if folds is None and any(value not in (None, []) for value in fit.values()):
        raise StiffarmError(
            "Options of a fit can be used only with folds.",
            "usage",
            {"key": next(key for key, value in fit.items() if value not in (None, []))},
            hint="a saved stiffness brings its own estimator, terms and confidence",
        )
    if folds not in (None, "all") and (isinstance(folds, str) or whole(folds, "folds") < 2):
        raise StiffarmError('folds must be a number from 2, or "all".', "invalid-value", {"key": "folds"})
    with _inputs.Watching(progress) as told:
        return Validated._of(
            _stiffarm.validate(
                cell._native,
                None if stiffness is None else _stiffness(cell, stiffness),
                _inputs.tables(measurements, "measurements"),
                None if postures is None else _inputs.postures(postures),
                None if registration is None else _inputs.result(registration, "registration"),
                model,
                tolerance_mm,
                list(only),
                0 if folds in (None, "all") else int(folds or 0),
                fit,
                told,
            )
        )


@checked
def register(
    pairs: TableLike,
    *,
    std_mm: float | None = None,
    exclude: Sequence[str] = (),
) -> Registered:
    """The transform from tracker to base axes from pairs of points (``stiffarm register``).

    >>> import stiffarm
    >>> found = stiffarm.register("builtin:example-pairs")
    >>> found.command
    'register'

    Args:
        pairs: Columns ``name``, ``tracker_x_mm`` to ``tracker_z_mm``, ``base_x_mm`` to ``base_z_mm``.
        std_mm: Standard deviation of each coordinate of a pair, both frames together [mm]; from the residuals unless
            given.
        exclude: Points to leave out.

    Raises:
        StiffarmError: Anything wrong with the table; points that determine no transform.
    """
    return Registered(_stiffarm.register(_inputs.table(pairs, "pairs"), std_mm, list(exclude)))


@checked
def simulate(
    cell: Cell,
    groups: PosturesLike | Mapping[str, PosturesLike] | Iterable[PosturesLike],
    *,
    runs: int | None = None,
    levels: Sequence[float] | None = None,
    elastic: str | None = None,
    seed: int = 1,
    force_scale_percent: float = 0.0,
    force_percent: float = 0.0,
    joint_angle_deg: float = 0.0,
    loading_point_mm: float = 0.0,
    anchor_mm: float = 0.0,
    degrees: bool = False,
    progress: Progress = None,
) -> Simulation:
    """Monte Carlo of identifications with tracker noise, Section IV (``stiffarm simulate``).

    Args:
        cell: The cell; its prior stiffness is the truth.
        groups: One group of postures, several, or several by name.
        runs: Runs per group and noise level; 200 unless given (100 with ``elastic``).
        levels: Factors on the cell's variance; 0.5, 1, ... 3 unless given (1 with ``elastic``).
        elastic: ``mixed`` or ``auto``: an arm that gives way beyond its axes, identified with both models.
        seed: Seed of the random numbers.
        force_scale_percent: Standard deviation of the scale of the force reading, one error per run [%].
        force_percent: Of the force reading, a fresh error per posture [%].
        joint_angle_deg: Of each joint angle [deg].
        loading_point_mm: Of each coordinate of the loading point, one error per run [mm].
        anchor_mm: Of each coordinate of the anchor, one error per run [mm].
        degrees: Arrays are in degrees.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: A cell without prior; a group that cannot determine every joint; numbers below zero.
    """
    errors = {
        "force_scale_percent": force_scale_percent,
        "force_percent": force_percent,
        "joint_angle_deg": joint_angle_deg,
        "loading_point_mm": loading_point_mm,
        "anchor_mm": anchor_mm,
    }
    with _inputs.Watching(progress) as told:
        return Simulation._of(
            _stiffarm.simulate(
                cell._native,
                _inputs.groups(groups, degrees=degrees),
                runs,
                levels,
                elastic,
                seed,
                errors,
                told,
            )
        )


@checked
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
    own = _inputs.postures(postures, degrees=degrees)
    return Table.from_csv(_stiffarm.simulate_measurements(cell._native, own, seed, readings))


@checked
def coverage(
    cell: Cell,
    postures: PosturesLike,
    *,
    runs: int = 10_000,
    seed: int = 1,
    estimator: str | None = None,
    terms: Sequence[str] = (),
    weights: str | None = None,
    prior_std_percent: float | None = None,
    noise: str | None = None,
    confidence: float | None = None,
    bootstrap: int | None = None,
    degrees: bool = False,
    progress: Progress = None,
) -> Coverage:
    """How often the intervals of :func:`identify` hold the truth, counted in simulated experiments.

    Args:
        cell: The cell; its prior stiffness is the truth.
        postures: What is measured.
        runs: Number of experiments.
        seed: Seed of the random numbers.
        estimator: As :func:`identify` has it, as all below.
        terms: Further terms.
        weights: Relative weight of single displacements.
        prior_std_percent: Standard deviation of the prior [%].
        noise: Size of the noise.
        confidence: Of the intervals.
        bootstrap: Count intervals of so many resamples instead.
        degrees: An array is in degrees.
        progress: Called as ``progress(what, done, of)``; ``True`` shows a bar.

    Raises:
        StiffarmError: A cell without prior; postures that do not determine every joint.
    """
    fit = _fit(estimator, terms, None, weights, prior_std_percent, noise, confidence)
    with _inputs.Watching(progress) as told:
        return Coverage._of(
            _stiffarm.coverage(
                cell._native, _inputs.postures(postures, degrees=degrees), runs, seed, fit, bootstrap, told
            )
        )


def _stiffness(
    cell: Cell, value: Identified | str | os.PathLike[str] | Sequence[float] | Mapping[str, Any]
) -> str | tuple[str, bytes]:
    """A saved stiffness, one in memory, or a bare list, alone or as its file has it; a word where it is one of another
    cell."""
    if isinstance(value, Result) and value.inputs.get("cell", "") not in ("", cell.inputs["cell"]):
        message = "The stiffness was identified with another version of this cell."
        warnings.warn(message, StiffarmWarning, stacklevel=4)
    if isinstance(value, (Result, str, os.PathLike)):
        return _inputs.result(value, "stiffness")
    if isinstance(value, Mapping):
        own = {str(key): item.tolist() if isinstance(item, np.ndarray) else item for key, item in value.items()}
        try:
            return "<stiffness>", json.dumps(own).encode()
        except (TypeError, ValueError) as error:
            raise StiffarmError(f"The stiffness cannot be written as JSON: {error}.", "wrong-type") from None
    bare = vector(value, "stiffness")
    return "<stiffness>", json.dumps({"stiffness_nm_per_rad": bare}).encode()
