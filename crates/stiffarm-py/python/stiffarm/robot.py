"""The robot: of the catalogue, of Denavit–Hartenberg rows, of a URDF, or of another library's model."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _adapters, _checks, _native_cell, _stiffarm
from ._errors import StiffarmError
from .postures import angles_of


class Branch(NamedTuple):
    """A posture that holds the flange at a pose."""

    #: Controller angles [rad].
    angles: NDArray[np.float64]
    #: Whether they are within the machine's limits.
    within_limits: bool
    #: Condition number of the Jacobian at the flange, 1 at best.
    condition: float
    #: Whether the posture is singular: where angles are free, it stands for all of them.
    is_singular: bool


class Robot:
    """A serial arm of revolute joints.

    Angles are the controller's [rad]; poses are 4 × 4 arrays of the flange in the base frame [m].
    """

    __slots__ = ("_keys", "_native")

    def __init__(self, keys: Mapping[str, Any]) -> None:
        """A robot of the keys of ``[robot]`` of a cell file, units in their names.

        Raises:
            StiffarmError: Anything wrong with a key or value.
        """
        self._keys = _checks.mapping(keys, "keys")
        # One reader for robots: that of cell files, with a tool that nothing asks for.
        at = [0.0, 0.0, 0.0]
        tool = {"loading_point_mm": at, "measuring_point": [{"name": "flange", "position_mm": at}]}
        self._native = _native_cell.of_keys({"robot": self._keys, "tool": tool, "load": {"kind": "measured"}})

    @classmethod
    def _in(cls, native: _stiffarm.Cell, keys: dict[str, Any]) -> Robot:
        robot = cls.__new__(cls)
        robot._native, robot._keys = native, keys
        return robot

    @classmethod
    def catalogue(cls, name: str) -> Robot:
        """A robot of the catalogue, for example ``"comau-nj165-3.0"``; :func:`robots` lists them.

        Raises:
            StiffarmError: The catalogue has no robot of this name.
        """
        return cls({"catalogue": name})

    @classmethod
    def dh(
        cls,
        rows: ArrayLike,
        *,
        convention: str = "modified",
        limits_deg: ArrayLike | None = None,
        name: str = "robot",
        **keys: Any,
    ) -> Robot:
        """A robot of Denavit–Hartenberg rows.

        Args:
            rows: One row ``[alpha_deg, a_mm, d_mm, offset_deg]`` per joint.
            convention: ``"modified"`` (Craig) or ``"standard"``.
            limits_deg: The machine's limits [low, high] of each controller angle [deg].
            name: Name of the robot in results.
            **keys: Further keys of ``[robot]`` of a cell file: ``theta_from_q``, ``flange_xyz_mm``, ...

        Raises:
            StiffarmError: Anything wrong with the rows.
        """
        if convention not in ("modified", "standard"):
            raise StiffarmError(
                f'There is no convention "{convention}".', "unknown-name", hint="modified or standard"
            )
        made = {"name": name, f"dh_{convention}": _checks.array(rows, "rows").tolist(), **keys}
        if limits_deg is not None:
            made["limits_deg"] = _checks.array(limits_deg, "limits_deg").tolist()
        return cls(made)

    @classmethod
    def urdf(
        cls, path: str | os.PathLike[str], *, base: str | None = None, tip: str | None = None
    ) -> Robot:
        """A robot of a URDF file: the chain from the link ``base`` to the link ``tip``.

        Without names it goes from the root of the tree to the only end that a joint moves, else to ``tool0`` or
        ``flange``. Angles are those of the URDF.

        Raises:
            StiffarmError: No URDF, unknown links, several possible ends, joints that do not turn, with the line.
        """
        name = _checks.path(path)
        try:
            text = Path(name).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or "it is not UTF-8"
            raise StiffarmError(f"The file cannot be read: {reason}.", "file-read", {"file": name}) from None
        table, _, _, _ = _stiffarm.urdf_table(text, name, base, tip)
        return cls(json.loads(table))

    @classmethod
    def of_axes(
        cls,
        points: ArrayLike,
        directions: ArrayLike,
        flange: ArrayLike,
        *,
        limits: ArrayLike | None = None,
        joint_names: Sequence[str] | None = None,
        name: str = "robot",
    ) -> Robot:
        """A robot of its joint axes at zero angles, base frame.

        Args:
            points: A point on each axis, n × 3 [m].
            directions: Its direction, n × 3, of any length; the joint turns about it in the positive sense.
            flange: Pose of the flange, 4 × 4 [m].
            limits: The machine's limits [low, high] of each angle, n × 2 [rad].
            joint_names: A name for each joint.
            name: Name of the robot in results.

        Raises:
            StiffarmError: Numbers that are not finite, lists of different lengths, a pose that is none.
        """
        at, along = _checks.array(points, "points"), _checks.array(directions, "directions")
        for key, rows in (("points", at), ("directions", along)):
            if rows.ndim != 2 or rows.shape[1] != 3:
                raise StiffarmError("This must be rows of three numbers.", "dimension", {"key": key})
        ends = None if limits is None else _checks.array(limits, "limits")
        if ends is not None and (ends.ndim != 2 or ends.shape[1] != 2):
            raise StiffarmError("This must be rows of two numbers.", "dimension", {"key": "limits"})
        names = list(joint_names) if joint_names is not None else [f"joint {i + 1}" for i in range(len(at))]
        table = _stiffarm.axes_table(
            name,
            names,
            at.tolist(),
            along.tolist(),
            _pose(flange),
            None if ends is None else ends.tolist(),
        )
        return cls(json.loads(table))

    @classmethod
    def of_pinocchio(cls, model: Any, frame: str | None = None) -> Robot:
        """A robot of a model of Pinocchio: its joints from the root to ``frame``, by default the last frame.

        Raises:
            StiffarmError: Pinocchio is not installed, there is no such frame, or a joint does not turn about one axis.
        """
        return cls.of_axes(**_adapters.of_pinocchio(model, frame))

    @classmethod
    def of_toolbox(cls, robot: Any) -> Robot:
        """A robot of the Robotics Toolbox (``DHRobot`` or ``ERobot``): its joints from the base to the last link.

        Raises:
            StiffarmError: A joint does not turn about one axis.
        """
        return cls.of_axes(**_adapters.of_toolbox(robot))

    def to_dict(self) -> dict[str, Any]:
        """The keys of ``[robot]`` of a cell file."""
        return dict(self._keys)

    @property
    def name(self) -> str:
        """Name of the robot."""
        return self._native.robot_name

    @property
    def joint_count(self) -> int:
        """Number of joints."""
        return self._native.joint_count

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints, base to flange."""
        return self._native.joint_names

    @property
    def limits(self) -> NDArray[np.float64]:
        """The machine's limits of the controller angles, a row [low, high] per joint [rad]."""
        return self._native.limits

    def pose(self, angles: ArrayLike, *, degrees: bool = False) -> NDArray[np.float64]:
        """Pose of the flange in the base frame, 4 × 4 [m], at controller angles [rad], or [deg] with ``degrees=True``.

        Raises:
            StiffarmError: Angles of the wrong number, not finite, or so large that they must be degrees.
        """
        return _stiffarm.flange_pose(self._native, _row(angles, degrees))

    def jacobian(
        self, angles: ArrayLike, point: ArrayLike | None = None, *, degrees: bool = False
    ) -> NDArray[np.float64]:
        """Jacobian by the controller angles of a point in flange axes [m], by default the flange's origin.

        6 × n, base axes: three rows of translation [m/rad], three of rotation. The angles are as :meth:`pose` has them.

        Raises:
            StiffarmError: As :meth:`pose`.
        """
        at = None if point is None else _checks.vector(point, "point", 3)
        return _stiffarm.jacobian(self._native, _row(angles, degrees), at)

    def inverse(self, pose: ArrayLike) -> list[Branch]:
        """The postures that hold the flange at a pose (4 × 4, base frame [m]), inside the machine's limits or not.

        All of them for arms with a closed form, else those that a search from many starts finds.

        Raises:
            StiffarmError: No pose; one out of reach, with the distance.
        """
        _, found = _stiffarm.inverse(self._native, _pose(pose))
        return [Branch(*branch) for branch in found]

    def nearest(self, pose: ArrayLike, start: ArrayLike, *, degrees: bool = False) -> NDArray[np.float64]:
        """The posture within the machine's limits whose largest change of an angle from ``start`` is smallest [rad].

        ``start`` is as :meth:`pose` has its angles.

        Raises:
            StiffarmError: No pose; one out of reach or outside the machine's limits, with distance or joint.
        """
        return _stiffarm.nearest(self._native, _pose(pose), _row(start, degrees))

    def __reduce__(self) -> tuple[Any, ...]:
        return Robot, (self._keys,)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self._keys == other._keys

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Robot {self.name!r}, {self.joint_count} joints>"


def _row(angles: ArrayLike, degrees: bool) -> NDArray[np.float64]:
    return angles_of(angles, _checks.truth(degrees, "degrees"), max(1, _checks.depth(angles)), "Angles").reshape(-1)


def _pose(pose: ArrayLike) -> NDArray[np.float64]:
    found = np.ascontiguousarray(_checks.array(pose, "pose"))
    if found.shape != (4, 4):
        raise StiffarmError("A pose is an array of 4 rows and 4 columns.", "dimension", {"key": "pose"})
    return found
