"""The results of the functions, one class each.

Their keys are those of the command's JSON; ``stiffarm schema result-COMMAND`` of the command describes every one.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from . import _keys
from ._errors import StiffarmError
from ._record import Record, fixed
from ._result import Result, result_of, table_of
from ._table import Table
from .postures import Postures


#: Endings of what an identification says of a joint in N·m/rad.
_STIFF = ("stiffness", "interval", "standard_error")


class _WithPostures(Result):
    __slots__ = ()

    @property
    def postures(self) -> Postures:
        """The postures, under their names."""
        return Postures.of(self)

    def table(self) -> Table:
        """The postures: ``posture``, ``q1_deg``, ... as in a posture file."""
        return self.postures.table()


class Checked(Result, _keys.CheckedKeys, command="check"):
    """What to know about a cell before anybody measures: :func:`stiffarm.check`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("joints",)


class Plan(_WithPostures, _keys.PlanKeys, command="select"):
    """Postures to measure, and what they are worth: :func:`stiffarm.select`."""

    __slots__ = ()


class Chosen(_WithPostures, _keys.ChosenKeys, command="select", mode="candidates"):
    """The best postures of a list: :func:`stiffarm.select` with ``candidates``."""

    __slots__ = ()


class SpaceFilling(_WithPostures, _keys.SpaceFillingKeys, command="select", mode="space_filling"):
    """Postures that cover the joint space evenly: :func:`stiffarm.select` with ``space_filling``."""

    __slots__ = ()


class Dropped(_WithPostures, _keys.DroppedKeys, command="select", mode="drop"):
    """What each given posture is worth, and which ones stay: :func:`stiffarm.select` with ``drop``."""

    __slots__ = ()

    def table(self) -> Table:
        """A row per given posture: its name, whether it stays, the index once it alone is left out, and what that costs
        (fraction)."""
        worth = sorted(self._data["worth"], key=lambda one: int(one["posture"]))
        return Table(
            {
                "posture": self._data["posture_names"],
                "kept": [i in self._data["kept"] for i in range(len(worth))],
                "value_without": [one["value"] for one in worth],
                "loss": [one["loss"] for one in worth],
            }
        )


class Curve(Result, _keys.CurveKeys, command="select", mode="curve"):
    """The best value for each number of postures: :func:`stiffarm.select` with ``curve``."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("sizes",)


class Evaluated(Result, _keys.EvaluatedKeys, command="evaluate"):
    """Every index of groups of postures: :func:`stiffarm.evaluate`."""

    __slots__ = ()

    def table(self) -> Table:
        """A row per group: its name, number of postures, and every index; two are lengths, all others ratios."""
        rows = [group["evaluation"] if "evaluation" in group else group for group in self._data["groups"]]
        columns: dict[str, Any] = {
            "group": [row["name"] for row in rows],
            "postures": [row["posture_count"] for row in rows],
        }
        names = [key for key in rows[0]["indices"] if not isinstance(rows[0]["indices"][key], str)]
        for name in names:
            heading = f"{name}_m" if name in ("task", "prediction") else name
            columns[heading] = [row["indices"].get(name) for row in rows]
        return Table(columns)


class Simulation(Result, _keys.SimulationKeys, command="simulate"):
    """Monte Carlo of identifications with tracker noise: :func:`stiffarm.simulate`."""

    __slots__ = ()

    def table(self) -> Table:
        """A row per group, noise level and joint: simulated and expected deviation (fractions)."""
        rows: list[dict[str, Any]] = []
        for group in self._data["groups"]:
            for level in group["levels"]:
                if "mean_deviation" not in level:
                    rows.append({"group": group["name"], **level})
                    continue
                for j, joint in enumerate(self._data["joints"]):
                    rows.append(
                        {
                            "group": group["name"],
                            "variance_factor": level["variance_factor"],
                            "joint": joint,
                            "runs": level["runs"],
                            "mean_deviation": level["mean_deviation"][j],
                            "standard_error": level["standard_error"][j],
                            "median_deviation": level["median_deviation"][j],
                            "expected_deviation": level["expected_deviation"][j],
                        }
                    )
        return table_of(rows)


class Coverage(Result, _keys.CoverageKeys, command="coverage"):
    """How often intervals held the truth in simulation: :func:`stiffarm.coverage`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("joints",)


class Identified(Result, _keys.IdentifiedKeys, command="identify"):
    """Joint stiffness and how far to trust it: :func:`stiffarm.identify`."""

    __slots__ = ()

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Joint stiffness [N·m/rad], one per spring; NaN where the readings tell nothing of a joint. Whether a value can be
        used says ``verdict`` of the joint."""
        values = [joint["stiffness"] for joint in self._estimates()["joints"]]
        return fixed(np.array([np.nan if value is None else value for value in values]))

    @property
    def diagnosis(self) -> Record | None:
        """What the residuals say; ``None`` with ``brief=True``."""
        found = self._data.get("diagnosis")
        return None if found is None else Record(found)

    @property
    def findings(self) -> list[Record]:
        """What readings, residuals and systematic errors say: each with ``code``, ``severity``, ``subject``, ``sentence``."""
        systematic = self._data.get("systematic_errors") or {}
        readings = self._data.get("readings") or {}
        of_readings = [readings.get("reduction") or {}, readings.get("screening") or {}, self._data.get("screening") or {}]
        parts = [*of_readings, self._data.get("diagnosis") or {}, systematic, self._data]
        implausible = [Record(own) for own in [self._data.get("implausible")] if own]
        return implausible + [Record(finding) for part in parts for finding in part.get("findings", [])]

    def _estimates(self) -> dict[str, Any]:
        estimates: dict[str, Any] = self._data.get("estimates", self._data)
        return estimates

    def table(self) -> Table:
        """A row per joint: stiffness, its ±, interval and verdict with all errors together, then their parts.

        ``interval_holds`` says ``"all_errors"``, or ``"readings"`` where nothing else was examined
        (``brief=True``, ``clamped=True``).
        """
        rows = []
        for joint in self._estimates()["joints"]:
            row: dict[str, Any] = {}
            for key, value in joint.items():
                unit = "_nm_per_rad" if key.endswith(_STIFF) else ""
                unit = "_rad_per_nm" if key.startswith("compliance") else unit
                if key.endswith("interval"):
                    row[f"{key}_low{unit}"], row[f"{key}_high{unit}"] = value or (None, None)
                elif not isinstance(value, (dict, list)):
                    row[{"name": "joint", "half_width": "relative_half_width"}.get(key, f"{key}{unit}")] = value
            rows.append(row)
        return table_of(rows)


class Validated(Result, _keys.ValidatedKeys, command="validate"):
    """Calculated against measured displacements: :func:`stiffarm.validate`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("points",)

    @property
    def findings(self) -> list[Record]:
        """What the result says about itself, its readings and its stiffness."""
        own = [*self._data.get("findings", []), *self._data.get("remarks", [])]
        return [Record(f) for f in own]


class Registered(Result, _keys.RegisteredKeys, command="register"):
    """The transform from tracker to base axes: :func:`stiffarm.register`."""

    __slots__ = ()

    def table(self) -> Table:
        """A row per pair: its name, and what the transform leaves of it."""
        return table_of([{"pair": name, "residual_m": left} for name, left in zip(self._data["pairs"], self._data["residuals_m"], strict=True)])


class Predicted(Result, _keys.PredictedKeys, command="predict"):
    """How far the loaded tool bends away along a path: :func:`stiffarm.predict`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("points",)


class Compensated(Result, _keys.CompensatedKeys, command="compensate"):
    """The commands that make up for the deflection: :func:`stiffarm.compensate`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("points",)


class StiffnessMap(Result, _keys.StiffnessMapKeys, command="map"):
    """Stiffness over a region of the workspace: :func:`stiffarm.map`."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("nodes",)


class Placement(Result, _keys.PlacementKeys, command="map", mode="place"):
    """The best place of a workpiece: :func:`stiffarm.map` with ``place``."""

    __slots__ = ()
    _rows: ClassVar[tuple[str, ...]] = ("candidates",)


__all__ = [
    "Checked",
    "Chosen",
    "Compensated",
    "Coverage",
    "Curve",
    "Dropped",
    "Evaluated",
    "Identified",
    "Placement",
    "Plan",
    "Predicted",
    "Record",
    "Registered",
    "Result",
    "Simulation",
    "SpaceFilling",
    "StiffarmError",
    "StiffnessMap",
    "Validated",
    "result_of",
]
