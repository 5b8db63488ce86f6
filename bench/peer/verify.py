"""Merging the traces of several processes; recomputing what they claim."""

import numpy as np

from .cell import reference_cell
from .index_numpy import NumpyIndex


def merged_trace(traces):
    """Best index against time over all processes of a race."""
    merged, best = [], np.inf
    for entry in sorted((e for trace in traces for e in trace), key=lambda e: e["seconds"]):
        if entry["value"] < best:
            best = entry["value"]
            merged.append({"seconds": entry["seconds"], "value": best})
    return thinned(merged)


def thinned(trace, ratio=1 + 2e-5):
    """The trace without steps far below what counts as reached (0.01 %), except the last."""
    kept = []
    for entry in trace:
        if not kept or entry["value"] * ratio <= kept[-1]["value"]:
            kept.append(entry)
    if trace and kept[-1] is not trace[-1]:
        kept.append(trace[-1])
    return kept


def time_to(trace, value):
    """First time at which a trace is at or below a value, None where it never is."""
    return next((e["seconds"] for e in trace if e["value"] <= value), None)


def best_at(trace, seconds):
    """Best value of a trace at a time, None before its first."""
    return min((e["value"] for e in trace if e["seconds"] <= seconds), default=None)


def recompute(group_deg, claimed):
    """The novel index of a group by the singular values of Psi and J_N, and what is wrong."""
    cell = reference_cell()
    group = np.asarray(group_deg, dtype=float)
    if group.shape[1:] != (cell.joints,):
        return None, f"the best group has shape {group.shape}"
    q = np.radians(group)
    value = exact_novel_index(cell, q)
    over = float(np.max(np.maximum(cell.bounds[:, 0] - q, q - cell.bounds[:, 1])))
    if over > 1e-9:
        return value, f"its best group is {np.degrees(over):.1e} degrees outside the bounds."
    if not abs(value / claimed - 1) < 1e-6:
        return value, f"its best group has index {value:.8g}, not {claimed:.8g}."
    return value, None


def exact_novel_index(cell, q):
    """max_i k(J_N)_i x cond(Psi) without Gram matrices; q is postures x joints [rad]."""
    z, o, points = NumpyIndex(cell).axes(q)
    linear = np.cross(z[:, None], points[:, :, None] - o[:, None])
    rope = cell.anchor - points[:, 0]
    force = cell.magnitude * rope / np.linalg.norm(rope, axis=1, keepdims=True)
    torque = np.einsum("pjx,px->pj", linear[:, 0], force)
    psi = np.einsum("pmjx,pj->pmxj", linear[:, 1:], torque).reshape(-1, cell.joints)
    normalised = np.concatenate([linear[:, 1] / cell.length, z], axis=2)
    sigma = np.linalg.svd(normalised, compute_uv=False)
    dexterity = np.sqrt((sigma**2).sum(axis=1) * (sigma**-2).sum(axis=1)) / cell.joints
    return float(dexterity.max() * np.linalg.cond(psi))
