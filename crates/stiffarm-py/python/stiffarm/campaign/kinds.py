"""What the values of axes and options may be, and how they are written.

Errors have the path of the key alone as their place; :func:`stiffarm.campaign.declaration.read_dict` adds the file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from .. import _checks
from .._errors import nearest
from .errors import CampaignError
from .values import Value

#: Most values of one axis.
MOST_VALUES = 1_000_000
#: Takes what was written and its key; gives the value, or raises StiffarmError.
Kind = Callable[[Any, str], Any]
#: Options of a task: their kinds, or those of a table's options.
Known = Mapping[str, "Kind | Known"]


def text(value: Any, key: str) -> str:
    """A text that says something."""
    if not _checks.text(value, key).strip():
        raise CampaignError("This must not be empty.", "invalid-value", {"key": key})
    return str(value)


def table(value: Any, key: str) -> dict[str, Any]:
    """A table of keys."""
    if not isinstance(value, dict):
        raise CampaignError(f"This must be a table, got {_checks.shown(value)}.", "wrong-type", {"key": key})
    return value


def whole_from_1(value: Any, key: str) -> int:
    """A whole number of 1 or more."""
    return int(positive(_checks.whole(value, key), key))


def positive(value: Any, key: str) -> float:
    """A number above 0."""
    if _not_negative(value, key) == 0:
        raise CampaignError("This must be above 0.", "invalid-value", {"key": key})
    return float(value)


def _not_negative(value: Any, key: str) -> float:
    number = _checks.number(value, key)
    if number < 0:
        raise CampaignError(f"This must be 0 or more, got {number:g}.", "invalid-value", {"key": key})
    return number


def _point(value: Any, key: str) -> tuple[float, ...]:
    return tuple(_checks.vector(value, key, 3))


def scalar(value: Any, key: str) -> Value:
    """A value of an axis of a task of one's own."""
    if isinstance(value, (str, bool)) or (isinstance(value, int) and -(2**63) <= value < 2**63):
        return value
    return _checks.number(value, key)


#: Axes of the built-in tasks.
AXES: Mapping[str, Kind] = {
    "cell": text,
    "tool": text,
    "load": text,
    "anchor_mm": _point,
    "load_n": positive,
    "postures": _checks.count,
    "index": text,
    "noise_factor": positive,
    "prior_scatter": _not_negative,
    "measurements": text,
    "seed": _checks.whole,
}

_BY_CLOCK = "A search that ends by the clock gives other results each time. Use rounds."
_WHY_NOT = {
    "time_limit_s": _BY_CLOCK,
    "time_limit": _BY_CLOCK,
    "threads": "Every item runs on one thread.",
    "progress": "Progress is an argument of run.",
}


def check_keys(written: Iterable[str], known: Iterable[str], above: str = "") -> None:
    """Refuses a key that nothing reads, with the nearest one that something does.

    Raises:
        CampaignError: ``unknown-key``.
    """
    known = list(known)
    for name in written:
        if name not in known:
            hint = _WHY_NOT.get(name) or nearest(name, known) or f"Known here: {', '.join(known)}."
            raise CampaignError(f"{name!r} is not known here.", "unknown-key", {"key": above + name}, hint)


def check_options(written: Mapping[str, Any], known: Known, above: str = "options.") -> None:
    """Checks options by name and kind.

    Raises:
        StiffarmError: ``unknown-key``, ``wrong-type`` or ``invalid-value``, with the key's path.
    """
    check_keys(written, known, above)
    for name, value in written.items():
        kind, key = known[name], above + name
        if callable(kind):
            kind(value, key)
        else:
            check_options(table(value, key), kind, f"{key}.")


def read_axis(name: str, written: Any, kind: Kind, tables: Mapping[str, Any]) -> tuple[Value, ...]:
    """The values of one axis, in the order in which they were written.

    Args:
        name: Name of the axis.
        written: A list, a single value, or a range ``{first, last, step}``.
        kind: What the values must be.
        tables: Tables of the declaration, whose names the axes ``tool`` and ``load`` take.

    Raises:
        StiffarmError: ``wrong-type``, ``unknown-key``, ``unknown-name``, ``invalid-value``, ``duplicate``.
    """
    key, named = f"axes.{name}", f"{name}s"
    # A dict keeps the order and finds what stands twice.
    values: dict[Value, None] = {}
    for number, part in enumerate(_parts(written, kind, key)):
        here = f"{key}[{number}]" if isinstance(written, list) else key
        value: Value = kind(part, here)
        if kind is text and name in ("tool", "load") and value not in tables[named]:
            hint = nearest(str(value), tables[named]) or f"Add a table [{named}.{value}]."
            raise CampaignError(f"{value!r} is no name of [{named}].", "unknown-name", {"key": here}, hint)
        if value in values:
            message, hint = f"{part!r} stands twice.", "Repetitions are what the axis seed is for."
            raise CampaignError(message, "duplicate", {"key": here}, hint)
        values[value] = None
    if not values:
        raise CampaignError("This axis has no values, so there are no items.", "invalid-value", {"key": key})
    return tuple(values)


def _parts(written: Any, kind: Kind, key: str) -> Sequence[Any]:
    if isinstance(written, dict):
        return _range(written, key)
    # [1800, 0, 0] alone is one anchor, not three values.
    alone = kind is _point and isinstance(written, list) and written and not any(isinstance(x, list) for x in written)
    return written if isinstance(written, list) and not alone else [written]


def _range(written: dict[str, Any], key: str) -> Sequence[int]:
    check_keys(written, ("first", "last", "step"), f"{key}.")
    if "first" not in written or "last" not in written:
        hint = "For example { first = 1, last = 20 }."
        raise CampaignError("A range needs first and last.", "missing-key", {"key": key}, hint)
    first, last, step = (_checks.whole(written.get(part, 1), f"{key}.{part}") for part in ("first", "last", "step"))
    if step == 0 or (last - first) // step >= MOST_VALUES:
        message = f"A step is 1 or more, and an axis has at most {MOST_VALUES} values."
        raise CampaignError(message, "invalid-value", {"key": key})
    return range(first, last + 1, step)
