"""Tasks of the tests. Each is a function of the values of axes and of options."""

from __future__ import annotations

import math
import os
import sys
import time
from typing import Any


def smooth(n: int, index: str, seed: int, *, scale: float = 1.0) -> dict[str, Any]:
    """Figures of several types, some of which differ from item to item."""
    value = scale * math.sin(n * 1.1 + seed) / (1 + len(index))
    figures: dict[str, Any] = {"index_value": value, "evaluations": n * seed, "fine": value > 0}
    figures["termination"] = "converged" if seed % 2 else "limit"
    figures["postures_deg"] = [[0.1 * seed, float(k)] for k in range(n)]
    if seed % 3 == 0:
        figures["margin_mm"] = value**2
    return figures


smooth.headline = ("index_value", "margin_mm")  # type: ignore[attr-defined]


def slow(seed: int, *, time_s: float = 0.05, begun: str = "") -> dict[str, Any]:
    """Takes its time unless a test is in a hurry, and leaves a line for each time it was begun."""
    if begun:
        with open(begun, "a", encoding="ascii") as file:
            file.write(f"{seed} {os.getpid()}\n")
    if "CAMPAIGN_TEST_HURRY" not in os.environ:
        time.sleep(time_s)
    return {"value": seed * 0.5}


class Refused(Exception):
    """An error with a code of its own, as the library's are."""

    code = "invalid_value"
    place = {"key": "load"}
    hint = "Do not."


def wild(way: str, seed: int) -> dict[str, Any]:
    """Goes wrong in every way."""
    if way == "raises":
        raise ValueError(f"seed {seed} at {object()!r}")
    if way == "refuses":
        raise Refused("The load is none.")
    if way == "exits":
        sys.exit(3)
    if way == "dies":
        os._exit(7)
    if way == "hangs":
        time.sleep(3600)
    if way == "swallows":
        try:
            time.sleep(3600)
        except BaseException:  # noqa: BLE001 — as the library does, which takes an alarm for Ctrl-C
            return {"value": 0.0}
    if way == "asks":
        bytearray(1 << 40)
    if way == "prints":
        print("x" * 100_000, flush=True)
    if way == "no_dict":
        return [1]  # type: ignore[return-value]
    if way == "takes_a_column":
        return {"seed": 1}
    if way == "an_object":
        return {"value": object()}
    if way == "not_a_number":
        return {"value": 1.0, "list": [1.0, math.nan]}
    if way == "infinite":
        return {"value": -math.inf}
    return {"value": float(seed), "nothing": None}
