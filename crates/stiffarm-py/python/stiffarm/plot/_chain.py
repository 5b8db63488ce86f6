"""Where an arm is: the points that its links go through, from Jacobian and flange pose alone.

Column i of the Jacobian is the twist of axis i: its direction ω, and the velocity v = ω × (p − o) of the flange's origin p,
from which the point of the axis nearest to p is o = p + ω × v. Links run along the axes and along the common
perpendiculars between them, as Denavit–Hartenberg rows do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..robot import Robot

#: Axes closer to parallel than this sine have no common perpendicular of their own.
PARALLEL = 1e-4
#: Points nearer than this are one [m].
SAME = 1e-4


class Axis(NamedTuple):
    """A joint's axis in the base frame."""

    #: A point on it [m].
    point: NDArray[np.float64]
    #: Its direction, length 1.
    direction: NDArray[np.float64]


def axes(robot: Robot, angles: ArrayLike) -> list[Axis]:
    """The axes of the joints at controller angles [rad]."""
    q = np.asarray(angles, dtype=float)
    twists = _twists(robot, q)
    for i in range(len(q) - 1):
        if abs(np.linalg.norm(twists[i][3:]) - 1) > 1e-6:
            twists[i] = _uncoupled(robot, q, i)
    p = robot.pose(q)[:3, 3]
    return [Axis(p + np.cross(t[3:], t[:3]), t[3:]) for t in twists]


def links(robot: Robot, angles: ArrayLike) -> NDArray[np.float64]:
    """Points that the arm goes through from the base's origin to the flange's, k × 3 [m]."""
    lines = axes(robot, angles)
    points = [np.zeros(3)]
    for here, after in zip(lines, lines[1:], strict=False):
        points += _perpendicular(here, after, points[-1])
    # The last axis is left where the flange is nearest.
    flange = robot.pose(np.asarray(angles, dtype=float))[:3, 3]
    points += [_foot(lines[-1], flange), flange]
    kept = points[:1]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > SAME:
            kept.append(point)
    return np.array(kept)


def _twists(robot: Robot, q: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    return [column.copy() for column in robot.jacobian(q).T]


def _uncoupled(robot: Robot, q: NDArray[np.float64], i: int) -> NDArray[np.float64]:
    """The twist of an axis whose controller angle also turns the next one, as in arms with a parallelogram.

    The column is the sum of both twists or their difference. The right one of both answers is about an axis that stays
    where it is when its own angle changes.
    """
    turned = q.copy()
    turned[i] += 0.7
    best, least = _twists(robot, q)[i], np.inf
    for sign in (1.0, -1.0):
        lines = []
        for angles in (q, turned):
            columns = _twists(robot, angles)
            t = columns[i] + sign * columns[i + 1]
            lines.append((t, robot.pose(angles)[:3, 3]))
        (t, p), (t_turned, p_turned) = lines
        if abs(np.linalg.norm(t[3:]) - 1) > 1e-6:
            continue
        apart = p + np.cross(t[3:], t[:3]) - p_turned - np.cross(t_turned[3:], t_turned[:3])
        distance = float(np.linalg.norm(np.cross(t[3:], apart)))
        if distance < least:
            best, least = t, distance
    return best


def _foot(axis: Axis, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """The point of an axis nearest to a point."""
    return axis.point + axis.direction * float(np.dot(axis.direction, point - axis.point))


def _perpendicular(a: Axis, b: Axis, start: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """The ends of the common perpendicular of two axes; of parallel ones the one through where the arm has got to."""
    normal = np.cross(a.direction, b.direction)
    square = float(np.dot(normal, normal))
    if square < PARALLEL**2:
        near = _foot(a, start)
        return [near, _foot(b, near)]
    between = b.point - a.point
    s = float(np.dot(np.cross(between, b.direction), normal)) / square
    t = float(np.dot(np.cross(between, a.direction), normal)) / square
    return [a.point + s * a.direction, b.point + t * b.direction]


__all__ = ["Axis", "axes", "links"]
