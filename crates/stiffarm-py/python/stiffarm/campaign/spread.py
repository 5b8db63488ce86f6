"""How the values of a figure spread."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from typing import Any

#: Statistics of a figure; ``p05`` is the 5 % quantile.
STATISTICS = ("mean", "std", "p05", "p25", "median", "p75", "p95")
_SHARES = {"p05": 0.05, "p25": 0.25, "median": 0.5, "p75": 0.75, "p95": 0.95}


def is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    return type(value) in (int, float) and math.isfinite(value)


def statistics_of(values: Sequence[Any]) -> dict[str, Any]:
    """Number, mean, standard deviation and quantiles of the finite numbers among the values."""
    numbers = sorted(float(value) for value in values if is_number(value))
    if not numbers:
        return {"values": 0, **dict.fromkeys(STATISTICS)}
    spread = statistics.stdev(numbers) if len(numbers) > 1 else None
    result: dict[str, Any] = {"values": len(numbers), "mean": statistics.fmean(numbers), "std": spread}
    for name, share in _SHARES.items():
        place = share * (len(numbers) - 1)
        low = math.floor(place)
        high = min(low + 1, len(numbers) - 1)
        result[name] = numbers[low] + (place - low) * (numbers[high] - numbers[low])
    return result
