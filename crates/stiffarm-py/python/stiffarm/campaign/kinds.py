"""What the values of axes and options may be, and how they are written."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .._errors import nearest
from .errors import CampaignError, at, unknown_key
from .values import Value

#: Most values of one axis.
MOST_VALUES = 1_000_000


@dataclass(frozen=True)
class Kind:
    """What a value is.

    Attributes:
        says: What it must be, for messages.
        take: Turns what was written into a value, or raises ValueError.
        names_of: Table of the declaration whose names are the values, if it is that.
        a_range: Whether ``{ first = 1, last = 20 }`` may stand for a list.
    """

    says: str
    take: Callable[[Any], Any]
    names_of: str | None = None
    a_range: bool = False


def _of(wanted: type | tuple[type, ...], accept: Callable[[Any], bool] = lambda value: True) -> Callable[[Any], Any]:
    """Takes values of some types; yes and no are numbers to Python, but not here."""

    def take(value: Any) -> Any:
        if not isinstance(value, wanted) or (isinstance(value, bool) and wanted is not bool) or not accept(value):
            raise ValueError
        return value

    return take


def _number(accept: Callable[[float], bool]) -> Callable[[Any], float]:
    written = _of((int, float))

    def take(value: Any) -> float:
        number = float(written(value))
        if not math.isfinite(number) or not accept(number):
            raise ValueError
        return number

    return take


def _triple(value: Any) -> tuple[float, ...]:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ValueError
    return tuple(NUMBER.take(part) for part in value)


def _scalar(value: Any) -> Value:
    if isinstance(value, (str, bool)):
        return value
    taken: Value = (WHOLE if isinstance(value, int) else NUMBER).take(value)
    return taken


def _names(value: Any) -> list[str]:
    return [_of(str)(part) for part in _of(list)(value)]


WHOLE = Kind("a whole number", _of(int, lambda value: -(2**63) <= value < 2**63))
NUMBER = Kind("a number", _number(lambda value: True))
YES_NO = Kind("true or false", _of(bool))
TEXT = Kind("text", _of(str, bool))
NAMES = Kind("a list of names", _names)

#: Axes of the built-in tasks.
AXES: Mapping[str, Kind] = {
    "cell": Kind("a cell: a file, builtin:NAME or a name of [cells]", TEXT.take),
    "tool": Kind("a name of [tools]", TEXT.take, names_of="tools"),
    "load": Kind("a name of [loads]", TEXT.take, names_of="loads"),
    "anchor_mm": Kind("three coordinates [x, y, z] in mm", _triple),
    "load_n": Kind("a force above 0 in N", _number(lambda force: force > 0)),
    "postures": Kind("a number of postures, 1 or more", _of(int, lambda count: 1 <= count < 2**63), a_range=True),
    "index": Kind("the name of an index, for example expected_error", TEXT.take),
    "noise_factor": Kind("a factor above 0 on the variance of the cell's noise", _number(lambda factor: factor > 0)),
    "prior_scatter": Kind("a standard deviation of ln(stiffness), 0 or more", _number(lambda scatter: scatter >= 0)),
    "measurements": Kind("a file of measurements", TEXT.take),
    "seed": Kind("a whole number, 0 or more", _of(int, lambda seed: 0 <= seed < 2**63), a_range=True),
}
#: An axis of a task of one's own.
ANY_AXIS = Kind("text, a number, true or false", _scalar, a_range=True)

#: Options of a task: their kinds, or those of a table's options.
Known = Mapping[str, "Kind | Known"]
_BY_CLOCK = "A search that ends by the clock gives other results each time. Use rounds."
_WHY_NOT = {
    "time_limit_s": _BY_CLOCK,
    "time_limit": _BY_CLOCK,
    "threads": "Every item runs on one thread.",
    "progress": "Progress is an argument of run.",
}


def _taken(kind: Kind, written: Any, place: Mapping[str, Any]) -> Any:
    try:
        return kind.take(written)
    except (ValueError, OverflowError):
        raise CampaignError(f"{written!r} is not {kind.says}.", "wrong-type", dict(place)) from None


def read_options(
    written: Mapping[str, Any], known: Known, place: Mapping[str, Any], above: str = "options"
) -> dict[str, Any]:
    """The options, checked by name and kind.

    Raises:
        CampaignError: ``unknown-key`` or ``wrong-type`` with the key's path.
    """
    for name, value in written.items():
        if name not in known:
            raise unknown_key(name, known, place, above, _WHY_NOT.get(name))
        kind, key = known[name], f"{above}.{name}"
        if isinstance(kind, Kind):
            _taken(kind, value, at(place, key))
        elif isinstance(value, dict):
            read_options(value, kind, place, key)
        else:
            raise CampaignError(f"{value!r} is not a table of options.", "wrong-type", at(place, key))
    return dict(written)


def read_axis(
    name: str, written: Any, kind: Kind, names: Iterable[str], place: Mapping[str, Any]
) -> tuple[Value, ...]:
    """The values of one axis, in the order in which they were written.

    Args:
        name: Name of the axis.
        written: A list, a single value, or a range ``{first, last, step}``.
        kind: What the values must be.
        names: Names that are allowed where ``kind.names_of`` is set.
        place: Place of the declaration, for messages.

    Raises:
        CampaignError: ``wrong-type``, ``unknown-key``, ``unknown-name``, ``invalid-value``, ``duplicate``.
    """
    key = f"axes.{name}"
    # A dict keeps the order and finds what stands twice.
    values: dict[Value, None] = {}
    allowed = list(names)
    for number, part in enumerate(_parts(written, kind, place, key)):
        here = at(place, f"{key}[{number}]" if isinstance(written, list) else key)
        value: Value = _taken(kind, part, here)
        if kind.names_of and value not in allowed:
            hint = nearest(str(value), allowed) or f"Add a table [{kind.names_of}.{value}]."
            raise CampaignError(f"{value!r} is no name of [{kind.names_of}].", "unknown-name", here, hint)
        if value in values:
            hint = "Repetitions are what the axis seed is for."
            raise CampaignError(f"{part!r} stands twice; each item would be computed twice.", "duplicate", here, hint)
        values[value] = None
    if not values:
        message = "This axis has no values, so the campaign has no items."
        raise CampaignError(message, "invalid-value", at(place, key))
    return tuple(values)


def _parts(written: Any, kind: Kind, place: Mapping[str, Any], key: str) -> Sequence[Any]:
    if isinstance(written, dict):
        return _range(written, kind, place, key)
    if not isinstance(written, list):
        return [written]
    # [1800, 0, 0] alone is one anchor, not three values.
    alone = kind.take is _triple and written and not any(isinstance(part, list) for part in written)
    return [written] if alone else written


def _range(written: dict[str, Any], kind: Kind, place: Mapping[str, Any], key: str) -> Sequence[int]:
    here = at(place, key)
    if not kind.a_range:
        raise CampaignError(f"A table is not {kind.says}.", "wrong-type", here, "Write a list.")
    for part, value in written.items():
        if part not in ("first", "last", "step"):
            raise unknown_key(part, ("first", "last", "step"), place, key)
        _taken(WHOLE, value, at(place, f"{key}.{part}"))
    if "first" not in written or "last" not in written or written.get("step", 1) < 1:
        message, hint = "A range needs first and last, and a step of 1 or more.", "For example { first = 1, last = 20 }."
        raise CampaignError(message, "wrong-type", here, hint)
    values = range(written["first"], written["last"] + 1, written.get("step", 1))
    if len(values) > MOST_VALUES:
        raise CampaignError(f"An axis has at most {MOST_VALUES} values.", "invalid-value", here)
    return values
