"""Values that a declaration may hold, and their one canonical text."""

from __future__ import annotations

import hashlib
import json
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

    def listed(part: Any) -> Any:
        if isinstance(part, range):
            return list(part)
        if hasattr(part, "tolist"):
            return part.tolist()
        raise TypeError(f"A value is neither text, number, list nor table, but {type(part).__name__}.")

    return json.loads(json.dumps(value, default=listed, allow_nan=False))
