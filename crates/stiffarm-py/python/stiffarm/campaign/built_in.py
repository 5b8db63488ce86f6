"""The four built-in tasks: what an item of each computes and which figures it keeps.

Figures are the numbers of the library's results under names with their units; what is relative
has no unit. Figures of single joints are columns of their own, ``…_joint1`` to ``…_joint6``:
robots with other numbers of joints have others, empty elsewhere. ``postures_deg`` is a list of
postures, each a list of angles in degrees.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .errors import CampaignError
from .item_cell import Values, cell_of, file_of, library
from .options import NAMES, NUMBER, TEXT, WHOLE, YES_NO, OptionKind


class BadResult(Exception):
    """A task gave something that a table cannot keep."""

    code = "bad-result"

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message


@dataclass(frozen=True)
class BuiltIn:
    """Parts of a built-in task, as in :class:`stiffarm.campaign.tasks.Task`."""

    name: str
    axes: tuple[str, ...]
    options: Mapping[str, OptionKind]
    headline: tuple[str, ...]
    check: Callable[[Mapping[str, Any], Mapping[str, Any], Mapping[str, Any]], None]
    run: Callable[[Values, Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]


# --- Reading results -------------------------------------------------------------------------


def plain_result(result: Any) -> dict[str, Any]:
    """The plain data of a result of the library."""
    data: dict[str, Any] = result.to_dict()
    return data


def by_joint(stem: str, values: Sequence[Any] | None) -> dict[str, Any]:
    """Columns ``stem_joint1``, ``stem_joint2``, …"""
    return {f"{stem}_joint{number}": value for number, value in enumerate(values or (), start=1)}


# --- The tasks -------------------------------------------------------------------------------

_SELECT = {
    "rounds": WHOLE,
    "certificate": YES_NO,
    "angle_step_deg": NUMBER,
}
#: Indices that are not numbers alone.
_INDEX_UNITS = {"task": "index_task_m", "prediction": "index_prediction_m"}
_PLANNED = ("cell", "tool", "load", "anchor_mm", "load_n", "postures", "index", "noise_factor",
            "prior_scatter", "seed")  # fmt: skip


def _selection(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> Any:
    return library().select(
        cell_of(values, shared, scattered=True),
        postures=values.get("postures", 6),
        index=values.get("index", "expected_error"),
        seed=values.get("seed", 1),
        **options,
    )


def select(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Postures chosen under an index; figures are the indices of the chosen group.

    With ``prior_scatter`` the choice is made with the scattered prior, and all indices but
    ``index_value`` are those of the chosen group under the cell's own stiffness.
    """
    result = _selection(values, {"certificate": False, **options}, shared)
    data = plain_result(result)
    evaluation = data["evaluation"]
    if float(values.get("prior_scatter", 0.0)) > 0.0:  # type: ignore[arg-type]
        evaluation = _evaluated(values, data["postures_deg"], shared)
    figures: dict[str, Any] = {"index_value": data["value"]}
    figures |= {
        _INDEX_UNITS.get(name, f"index_{name}"): value
        for name, value in evaluation["indices"].items()
        if not isinstance(value, str)
    }
    margin = data.get("smallest_margin_m")
    figures["smallest_margin_mm"] = None if margin is None else margin * 1e3
    figures["evaluations"] = data["evaluations"]
    figures["rounds"] = data["rounds"]
    figures["termination"] = data["termination"]
    if data.get("certificate"):
        figures["efficiency"] = data["certificate"].get("efficiency")
    figures |= by_joint("expected_relative_deviation", evaluation["expected_deviation"])
    figures["postures_deg"] = data["postures_deg"]
    return figures


def _evaluated(values: Values, postures_deg: Any, shared: Mapping[str, Any]) -> dict[str, Any]:
    evaluated = library().evaluate(cell_of(values, shared), postures_deg, degrees=True)
    group: dict[str, Any] = plain_result(evaluated)["groups"][0]
    return group


def _group(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> Any:
    """Postures of an item: those of the option's file, or chosen."""
    if "postures_file" in options:
        return file_of(options["postures_file"], shared)
    return _selection(values, {"certificate": False, **options.get("select", {})}, shared)


def simulate(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Deviations of the stiffness over simulated identifications, relative to the truth."""
    own = {k: v for k, v in options.items() if k not in ("select", "postures_file")}
    result = library().simulate(
        cell_of(values, shared),
        _group(values, options, shared),
        levels=[1.0],
        seed=values.get("seed", 1),
        **own,
    )
    group = plain_result(result)["groups"][0]
    level = group["levels"][0]
    mean = level["mean_deviation"]
    figures: dict[str, Any] = {
        "relative_deviation": sum(mean) / len(mean),
        "relative_deviation_worst_joint": max(mean),
        "runs": level["runs"],
    }
    figures |= by_joint("relative_deviation", mean)
    figures |= by_joint("relative_deviation_standard_error", level["standard_error"])
    figures |= by_joint("expected_relative_deviation", level["expected_deviation"])
    figures["postures_deg"] = group["postures_deg"]
    return figures


def coverage(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """How often the intervals of simulated identifications held the truth."""
    own = {k: v for k, v in options.items() if k not in ("select", "postures_file")}
    result = library().coverage(
        cell_of(values, shared), _group(values, options, shared), seed=values.get("seed", 1), **own
    )
    data = plain_result(result)
    figures: dict[str, Any] = {
        "coverage": data["coverage"],
        "coverage_standard_error": data["standard_error"],
        "relative_half_width": data["relative_half_width"],
        "open_above": data["open_above"],
        "without_interval": data["without_interval"],
        "experiments": data["experiments"],
        "degrees_of_freedom": data["degrees_of_freedom"],
    }
    figures |= by_joint("coverage", [joint["coverage"] for joint in data["joints"]])
    figures |= by_joint(
        "relative_half_width", [joint["relative_half_width"] for joint in data["joints"]]
    )
    return figures


def identify(values: Values, options: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, Any]:
    """Joint stiffness with its intervals from a file of measurements."""
    name = str(values.get("measurements", options.get("measurements")))
    own = {k: v for k, v in options.items() if k != "measurements"}
    result = library().identify(
        cell_of(values, shared, scattered=True),
        file_of(name, shared),
        seed=values.get("seed", 1),
        **{"brief": True, **own},
    )
    data = plain_result(result)
    joints = data["joints"]
    figures: dict[str, Any] = {
        "residual_rms_mm": data["residual_rms_m"] * 1e3,
        "condition": data["condition"],
        "undetermined_joints": len(data["undetermined_joints"]),
        "degrees_of_freedom": data["degrees_of_freedom"],
    }
    figures |= by_joint("stiffness_nm_per_rad", [joint["stiffness"] for joint in joints])
    # The readings alone are all that a brief identification knows.
    for part in ["", "readings_"] if data["budget"] else ["readings_"]:
        errors = [joint[f"{part}standard_error"] for joint in joints]
        figures |= by_joint(f"{part}standard_error_nm_per_rad", errors)
        for end, side in enumerate(("low", "high")):
            ends = [joint[f"{part}interval"][end] for joint in joints]
            figures |= by_joint(f"{part}interval_{side}_nm_per_rad", ends)
    return figures


# --- Checks before the start -----------------------------------------------------------------


def _needs_cell(axes: Mapping[str, Any], place: Mapping[str, Any]) -> None:
    if "cell" not in axes:
        raise CampaignError(
            "missing-key",
            "The axis cell is missing.",
            place={**place, "key": "axes.cell"},
            hint='For example cell = ["builtin:comau"].',
        )


def _check_select(
    axes: Mapping[str, Any], options: Mapping[str, Any], place: Mapping[str, Any]
) -> None:
    _needs_cell(axes, place)


def _check_group(
    axes: Mapping[str, Any], options: Mapping[str, Any], place: Mapping[str, Any]
) -> None:
    _needs_cell(axes, place)
    if "postures_file" not in options:
        return
    for name in ("postures", "index", "prior_scatter"):
        if name in axes:
            raise CampaignError(
                "conflict",
                f"The postures come from a file, so the axis {name} would change nothing.",
                place={**place, "key": f"axes.{name}"},
                hint="Leave out the axis, or options.postures_file.",
            )
    if "select" in options:
        raise CampaignError(
            "conflict",
            "The postures come from a file, so nothing is selected.",
            place={**place, "key": "options.select"},
        )


def _check_identify(
    axes: Mapping[str, Any], options: Mapping[str, Any], place: Mapping[str, Any]
) -> None:
    _needs_cell(axes, place)
    if ("measurements" in axes) == ("measurements" in options):
        raise CampaignError(
            "missing-key",
            "Measurements must be given once: as an axis of files, or as an option with one file.",
            place={**place, "key": "axes.measurements"},
        )


#: Errors of the model in simulations: their standard deviations, in the unit of the name.
_MODEL_ERRORS = dict.fromkeys(
    ("force_scale_percent", "force_percent", "joint_angle_deg", "loading_point_mm", "anchor_mm"),
    NUMBER,
)
#: How the stiffness is estimated.
_FIT = {
    "estimator": TEXT,
    "terms": NAMES,
    "weights": TEXT,
    "prior_std_percent": NUMBER,
    "noise": TEXT,
    "confidence": NUMBER,
}
_CHOSEN = OptionKind("a table of options of select", (dict,), inner=_SELECT)
_FILE = OptionKind("the name of a file", (str,))

ALL: tuple[BuiltIn, ...] = (
    BuiltIn(
        "select", _PLANNED, _SELECT, ("index_value", "index_expected_error"), _check_select, select
    ),
    BuiltIn(
        "simulate",
        _PLANNED,
        {"runs": WHOLE, "select": _CHOSEN, "postures_file": _FILE, **_MODEL_ERRORS},
        ("relative_deviation", "relative_deviation_worst_joint"),
        _check_group,
        simulate,
    ),
    BuiltIn(
        "coverage",
        _PLANNED,
        {"runs": WHOLE, "select": _CHOSEN, "postures_file": _FILE, **_FIT, "bootstrap": WHOLE},
        ("coverage", "relative_half_width"),
        _check_group,
        coverage,
    ),
    BuiltIn(
        "identify",
        ("cell", "tool", "load", "anchor_mm", "load_n", "noise_factor", "prior_scatter",
         "measurements", "seed"),
        {"measurements": _FILE, "brief": YES_NO, "exclude": NAMES, "elastic": TEXT, **_FIT},
        ("residual_rms_mm", "condition"),
        _check_identify,
        identify,
    ),
)  # fmt: skip
