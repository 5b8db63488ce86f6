"""The four built-in tasks: what an item of each computes and which figures it keeps.

Figures are the numbers of the library's results under names with their units; what is relative has no unit. Figures of
single joints are columns of their own, ``…_joint1`` to ``…_joint6``: robots with other numbers of joints have others,
empty elsewhere. ``postures_deg`` is a list of postures, each a list of angles in degrees.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .. import commands
from .._checks import number, texts, truth, whole
from .errors import CampaignError
from .item_cell import Values, cell_of, file_of
from .kinds import Known, text
from .task import Task


def by_joint(stem: str, values: Sequence[Any] | None, numbers: Sequence[int] | None = None) -> dict[str, Any]:
    """Columns ``stem_joint1``, ``stem_joint2``, …, or those of the joints with these ``numbers``."""
    each = values or ()
    return {f"{stem}_joint{number}": value for number, value in zip(numbers or range(1, len(each) + 1), each)}


def _numbers(cell: Any, joints: Sequence[str]) -> list[int]:
    """Numbers of the joints that a result speaks of: the load of the cell may leave some out."""
    names = list(cell.spring_names)
    return [names.index(joint) + 1 for joint in joints]


#: Indices that are not numbers alone.
_INDEX_UNITS = {"task": "index_task_m", "prediction": "index_prediction_m"}


def _selection(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> Any:
    own = dict(options)
    return commands.select(
        cell_of(values, shared, scattered=True),
        count=values.get("postures", 6),
        index=values.get("index", "expected_error"),
        seed=values.get("seed", 1),
        no_certificate=not own.pop("certificate", False),
        **own,
    )


def select(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Postures chosen under an index; figures are the indices of the chosen group.

    With ``prior_scatter`` the choice is made with the scattered prior, and all indices but ``index_value`` are those of
    the chosen group under the cell's own stiffness.
    """
    result = _selection(values, options, shared)
    data = result.to_dict()
    evaluation = data["evaluation"]
    if float(values.get("prior_scatter", 0.0)) > 0.0:
        evaluated = commands.evaluate(cell_of(values, shared), data["postures_deg"], degrees=True)
        evaluation = evaluated.to_dict()["groups"][0]
    figures: dict[str, Any] = {"index_value": data["value"]}
    figures |= {
        _INDEX_UNITS.get(name, f"index_{name}"): value
        for name, value in evaluation["indices"].items()
        if not isinstance(value, str)
    }
    margin = data.get("smallest_margin_m")
    figures["smallest_margin_mm"] = None if margin is None else margin * 1e3
    figures |= {name: data[name] for name in ("evaluations", "rounds", "termination")}
    if data.get("certificate"):
        figures["efficiency"] = data["certificate"].get("efficiency")
    numbers = _numbers(cell_of(values, shared), data["joints"])
    figures |= by_joint("expected_relative_deviation", evaluation["expected_deviation"], numbers)
    figures["postures_deg"] = data["postures_deg"]
    return figures


def _group(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> Any:
    """Postures of an item: those of the option's file, or chosen."""
    if "postures_file" in options:
        return file_of(options["postures_file"], shared)
    return _selection(values, options.get("select", {}), shared)


def simulate(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Deviations of the stiffness over simulated identifications, relative to the truth."""
    own = {k: v for k, v in options.items() if k not in ("select", "postures_file")}
    cell = cell_of(values, shared)
    result = commands.simulate(
        cell, _group(values, options, shared), levels=[1.0], seed=values.get("seed", 1), **own
    ).to_dict()
    group = result["groups"][0]
    level = group["levels"][0]
    mean = level["mean_deviation"]
    figures: dict[str, Any] = {
        "relative_deviation": sum(mean) / len(mean),
        "relative_deviation_worst_joint": max(mean),
        "runs": level["runs"],
    }
    numbers = _numbers(cell, result["joints"])
    figures |= by_joint("relative_deviation", mean, numbers)
    figures |= by_joint("relative_deviation_standard_error", level["standard_error"], numbers)
    figures |= by_joint("expected_relative_deviation", level["expected_deviation"], numbers)
    figures["postures_deg"] = group["postures_deg"]
    return figures


def coverage(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """How often the intervals of simulated identifications held the truth."""
    own = {k: v for k, v in options.items() if k not in ("select", "postures_file")}
    result = commands.coverage(
        cell_of(values, shared), _group(values, options, shared), seed=values.get("seed", 1), **own
    )
    data = result.to_dict()
    names = ("coverage", "relative_half_width", "open_above", "without_interval", "experiments", "degrees_of_freedom")
    figures: dict[str, Any] = {name: data[name] for name in names}
    figures["coverage_standard_error"] = data["standard_error"]
    figures |= by_joint("coverage", [joint["coverage"] for joint in data["joints"]])
    figures |= by_joint("relative_half_width", [joint["relative_half_width"] for joint in data["joints"]])
    return figures


def identify(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Joint stiffness with its intervals from a file of measurements."""
    name = str(values.get("measurements", options.get("measurements")))
    own = {k: v for k, v in options.items() if k != "measurements"}
    result = commands.identify(
        cell_of(values, shared, scattered=True),
        file_of(name, shared),
        seed=values.get("seed", 1),
        **{"brief": True, **own},
    )
    data = result.to_dict()
    joints = data["joints"]
    figures: dict[str, Any] = {
        "residual_rms_mm": data["residual_rms_m"] * 1e3,
        "condition": data["condition"],
        "undetermined_joints": len(data["undetermined_joints"]),
        "degrees_of_freedom": data["degrees_of_freedom"],
    }
    figures |= by_joint("stiffness_nm_per_rad", [joint["stiffness"] for joint in joints])
    # The readings alone are all that a brief identification knows.
    for part in ["", "readings_"] if data["systematic_errors"] else ["readings_"]:
        errors = [joint[f"{part}standard_error"] for joint in joints]
        figures |= by_joint(f"{part}standard_error_nm_per_rad", errors)
        for end, side in enumerate(("low", "high")):
            ends = [joint[f"{part}interval"][end] for joint in joints]
            figures |= by_joint(f"{part}interval_{side}_nm_per_rad", ends)
    return figures


def _check(axes: Mapping[str, Any], options: Mapping[str, Any]) -> None:
    if "cell" not in axes:
        hint = 'For example cell = ["builtin:comau"].'
        raise CampaignError("The axis cell is missing.", "missing-key", {"key": "axes.cell"}, hint)
    if "postures_file" not in options:
        return
    message = "The postures come from a file, so this would change nothing."
    for key in ("axes.postures", "axes.index", "axes.prior_scatter", "options.select"):
        table, _, name = key.partition(".")
        if name in (axes if table == "axes" else options):
            raise CampaignError(message, "conflict", {"key": key}, "Leave it out, or options.postures_file.")


def _check_identify(axes: Mapping[str, Any], options: Mapping[str, Any]) -> None:
    _check(axes, options)
    if ("measurements" in axes) == ("measurements" in options):
        message = "Measurements must be given once: as an axis of files, or as an option with one file."
        raise CampaignError(message, "missing-key", {"key": "axes.measurements"})


_CELL_AXES = ("cell", "tool", "load", "anchor_mm", "load_n", "noise_factor", "prior_scatter", "seed")
_PLANNED = (*_CELL_AXES, "postures", "index")
_SELECT: Known = {"rounds": whole, "certificate": truth, "angle_step_deg": number}
_GROUP: Known = {"runs": whole, "select": _SELECT, "postures_file": text}
#: Errors of the model in simulations: their standard deviations, in the unit of the name.
_MODEL_ERRORS = dict.fromkeys(
    ("force_scale_error_percent", "force_error_percent", "joint_angle_error_deg", "loading_point_error_mm", "anchor_error_mm"), number
)
#: How the stiffness is estimated.
_FIT = {
    "estimator": text,
    "terms": texts,
    "weights": text,
    "prior_std_percent": number,
    "noise": text,
    "confidence": number,
}
_IDENTIFY = {"measurements": text, "brief": truth, "exclude": texts, "elastic": text, **_FIT}

ALL: Mapping[str, Task] = {
    task.name: task
    for task in (
        Task("select", select, _check, ("index_value", "index_expected_error"), _PLANNED, _SELECT),
        Task(
            "simulate", simulate, _check, ("relative_deviation", "relative_deviation_worst_joint"), _PLANNED,
            {**_GROUP, **_MODEL_ERRORS},
        ),
        Task(
            "coverage", coverage, _check, ("coverage", "relative_half_width"), _PLANNED,
            {**_GROUP, **_FIT, "bootstrap": whole},
        ),
        Task(
            "identify", identify, _check_identify, ("residual_rms_mm", "condition"), (*_CELL_AXES, "measurements"),
            _IDENTIFY,
        ),
    )
}  # fmt: skip
