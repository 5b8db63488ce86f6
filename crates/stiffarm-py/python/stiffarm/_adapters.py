"""Robots of other libraries: what their Jacobian says at zero angles is the chain, as :meth:`stiffarm.Robot.of_axes` takes it."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import StiffarmError

Floats = NDArray[np.float64]

#: How far a column may be from that of a turn about one axis.
_ROUNDING = 1e-9


def of_pinocchio(model: Any, frame: str | None) -> dict[str, Any]:
    """See :meth:`stiffarm.Robot.of_pinocchio`."""
    try:
        pinocchio: Any = importlib.import_module("pinocchio")
    except ImportError:
        raise StiffarmError("Pinocchio is not installed.", "unsupported", hint="pip install pin") from None
    names = [one.name for one in model.frames]
    if frame is None:
        frame = names[-1]
    if frame not in names:
        raise StiffarmError(
            f'The model has no frame "{frame}".', "unknown-name", {"key": "frame"}, hint=f"frames: {', '.join(names)}"
        )
    which = model.getFrameId(frame)
    chain = [joint for joint in model.supports[model.frames[which].parentJoint] if joint > 0]
    data = model.createData()
    zero = pinocchio.neutral(model)
    for joint in chain:
        # The neutral angle of a joint within limits that exclude zero is zero all the same.
        if model.joints[joint].nq == 1:
            zero[model.joints[joint].idx_q] = 0.0
    pinocchio.computeJointJacobians(model, data, zero)
    pinocchio.updateFramePlacements(model, data)
    flange = np.array(data.oMf[which].homogeneous)
    jacobian = pinocchio.getFrameJacobian(model, data, which, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    columns, limits = [], []
    for joint in chain:
        own = model.joints[joint]
        if own.nv != 1:
            raise _not_a_turn(model.names[joint])
        columns.append(jacobian[:, own.idx_v])
        has_limits = own.nq == 1
        low = float(model.lowerPositionLimit[own.idx_q]) if has_limits else -np.inf
        high = float(model.upperPositionLimit[own.idx_q]) if has_limits else np.inf
        limits.append((low, high))
    joints = [str(model.names[joint]) for joint in chain]
    return _of_columns(str(model.name) or "robot", joints, np.array(columns), flange, limits)


def of_toolbox(robot: Any) -> dict[str, Any]:
    """See :meth:`stiffarm.Robot.of_toolbox`."""
    zero = np.zeros(robot.n)
    flange = np.array(robot.fkine(zero).A, dtype=float)
    columns = np.array(robot.jacob0(zero), dtype=float).T
    qlim = np.array(robot.qlim, dtype=float) if robot.qlim is not None else np.full((2, robot.n), np.nan)
    links = [link for link in robot.links if getattr(link, "isjoint", True)]
    names = [str(link.name) for link in links]
    if len(names) != robot.n or len(set(names)) != robot.n or not all(names):
        names = [f"joint {j + 1}" for j in range(robot.n)]
    limits = [(float(low), float(high)) for low, high in qlim.T]
    return _of_columns(str(robot.name) or "robot", names, columns, flange, limits)


def _of_columns(
    name: str,
    joints: Sequence[str],
    columns: Floats,
    flange: Floats,
    limits: Sequence[tuple[float, float]],
) -> dict[str, Any]:
    """The axes of a robot by the columns of its Jacobian at the flange, base axes: translation, then rotation."""
    points, directions = [], []
    for joint, column in zip(joints, columns, strict=True):
        shift, turn = column[:3], column[3:]
        if abs(np.linalg.norm(turn) - 1.0) > _ROUNDING or abs(shift @ turn) > _ROUNDING:
            raise _not_a_turn(joint)
        # shift = turn × (flange − point), of which the part across the axis follows.
        points.append(flange[:3, 3] - np.cross(shift, turn))
        directions.append(turn)
    whole = [(max(low, -2 * np.pi), min(high, 2 * np.pi)) for low, high in limits]
    known = all(np.isfinite(low) and np.isfinite(high) and low < high for low, high in whole)
    return {
        "points": np.array(points).reshape(-1, 3),
        "directions": np.array(directions).reshape(-1, 3),
        "flange": flange,
        "limits": whole if known else None,
        "joint_names": list(joints),
        "name": name,
    }


def _not_a_turn(joint: str) -> StiffarmError:
    return StiffarmError(f'The joint "{joint}" does not turn about one axis.', "unsupported")
