"""Edges of what stands around an arm."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Line = NDArray[np.float64]


def edges(shape: dict[str, Any]) -> Iterator[Line]:
    """Lines of a shape of a cell file [mm]; none of a mesh, whose file is elsewhere, nor of an endless plane."""
    kind = shape.get("kind")
    if kind == "box":
        yield from _box(shape)
    elif kind in ("cylinder", "capsule"):
        yield from _round(shape)


def box_edges(low: Any, high: Any) -> Iterator[Line]:
    """The twelve edges of an upright box."""
    corners = [np.asarray(low, dtype=float), np.asarray(high, dtype=float)]
    middle, half = (corners[0] + corners[1]) / 2, (corners[1] - corners[0]) / 2
    yield from _around(middle, half, np.eye(3))


def _box(shape: dict[str, Any]) -> Iterator[Line]:
    roll, pitch, yaw = np.deg2rad(shape.get("rpy_deg", [0.0, 0.0, 0.0]))
    turn = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
    yield from _around(np.array(shape["center_mm"], dtype=float), np.array(shape["size_mm"], dtype=float) / 2, turn)


def _around(middle: Line, half: Line, turn: Line) -> Iterator[Line]:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    corners = middle + (signs * half) @ turn.T
    for i in range(8):
        for j in range(i + 1, 8):
            if abs(signs[i] - signs[j]).sum() == 2:
                yield corners[[i, j]]


def _round(shape: dict[str, Any]) -> Iterator[Line]:
    a, b = np.array(shape["from_mm"], dtype=float), np.array(shape["to_mm"], dtype=float)
    along = b - a
    length = float(np.linalg.norm(along))
    along = along / length if length > 0 else np.array([0.0, 0.0, 1.0])
    aside = np.cross(along, [1.0, 0.0, 0.0] if abs(along[0]) < 0.9 else [0.0, 1.0, 0.0])
    aside /= np.linalg.norm(aside)
    third = np.cross(along, aside)
    angle = np.linspace(0, 2 * np.pi, 33)[:, np.newaxis]
    ring = float(shape["radius_mm"]) * (np.cos(angle) * aside + np.sin(angle) * third)
    yield a + ring
    yield b + ring
    for k in (0, 8, 16, 24):
        yield np.array([a + ring[k], b + ring[k]])


def _turn(axis: int, angle: float) -> Line:
    c, s = np.cos(angle), np.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    out = np.eye(3)
    out[i, i] = out[j, j] = c
    out[i, j], out[j, i] = -s, s
    return out


__all__ = ["box_edges", "edges"]
