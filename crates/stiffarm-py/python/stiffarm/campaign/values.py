"""Values that a declaration may hold, and their one canonical text."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, Union

#: A value of an axis: text, a whole number, a number, yes or no, or three coordinates.
Value = Union[str, int, float, bool, tuple[float, ...]]


def canonical(value: Any) -> str:
    """One text for equal values: JSON with sorted keys and without spaces."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def digest(text: str | bytes) -> str:
    """SHA-256 of a text, 64 hexadecimal digits."""
    return hashlib.sha256(text.encode() if isinstance(text, str) else text).hexdigest()


def show(value: Value) -> str:
    """A value as in the name of an item: ``novel``, ``6``, ``1800|0|0``."""
    if isinstance(value, tuple):
        return "|".join(show(part) for part in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def plain(value: Any) -> Any:
    """A copy of what TOML or Python gave, of plain types: dict, list, text, numbers; arrays become lists.

    Raises:
        TypeError: Something that a declaration cannot hold, for example a function or a date.
        ValueError: A number that is not finite.
    """
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{value} is not a finite number")
        return float(value)
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, (Sequence, range)) and not isinstance(value, (bytes, bytearray)):
        return [plain(part) for part in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    raise TypeError(f"{type(value).__name__} is neither text, number, list nor table")
