"""The axes of a grid: which there are, what values they take, how they are written."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .errors import CampaignError, nearest
from .values import Value

#: Most values of one axis.
MOST_VALUES = 1_000_000


@dataclass(frozen=True)
class AxisKind:
    """What the values of an axis are.

    Attributes:
        says: What a value must be, for messages.
        take: Turns what was written into a value, or raises ValueError.
        names_of: Table of the declaration whose names are the values, if it is that.
        a_range: Whether ``{ first = 1, last = 20 }`` may stand for a list.
    """

    says: str
    take: Callable[[Any], Value]
    names_of: str | None = None
    a_range: bool = False


def _text(value: Any) -> Value:
    if not isinstance(value, str) or not value:
        raise ValueError
    return value


def whole(least: int) -> Callable[[Any], Value]:
    """Takes whole numbers from ``least`` to 2⁶³ − 1."""

    def take(value: Any) -> Value:
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError
        if not least <= value < 2**63:
            raise ValueError
        return value

    return take


def _number(accept: Callable[[float], bool]) -> Callable[[Any], Value]:
    def take(value: Any) -> Value:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError
        number = float(value)
        if not math.isfinite(number) or not accept(number):
            raise ValueError
        return number

    return take


def _triple(value: Any) -> Value:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ValueError
    any_number = _number(lambda x: True)
    return tuple(float(any_number(part)) for part in value)  # type: ignore[arg-type]


def _scalar(value: Any) -> Value:
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, int):
        return whole(-(2**63))(value)
    return _number(lambda x: True)(value)


#: Axes of the built-in tasks.
KINDS: Mapping[str, AxisKind] = {
    "cell": AxisKind(
        "a cell: a file, builtin:NAME or a name of [cells]", _text
    ),
    "tool": AxisKind("a name of [tools]", _text, names_of="tools"),
    "load": AxisKind("a name of [loads]", _text, names_of="loads"),
    "anchor_mm": AxisKind("three coordinates [x, y, z] in mm", _triple),
    "load_n": AxisKind("a force above 0 in N", _number(lambda x: x > 0)),
    "postures": AxisKind("a number of postures, 1 or more", whole(1), a_range=True),
    "index": AxisKind("the name of an index, for example expected_error", _text),
    "noise_factor": AxisKind(
        "a factor above 0 on the variance of the cell's noise", _number(lambda x: x > 0)
    ),
    "prior_scatter": AxisKind(
        "a standard deviation of ln(stiffness), 0 or more", _number(lambda x: x >= 0)
    ),
    "measurements": AxisKind("a file of measurements", _text),
    "seed": AxisKind("a whole number, 0 or more", whole(0), a_range=True),
}

#: An axis of a task of one's own.
ANY_KIND = AxisKind("text, a number, true or false", _scalar, a_range=True)


def read_axis(
    name: str, written: Any, kind: AxisKind, names: Iterable[str], place: dict[str, Any]
) -> tuple[Value, ...]:
    """The values of one axis, in the order in which they were written.

    Args:
        name: Name of the axis.
        written: A list, a single value, or a range ``{first, last, step}``.
        kind: What the values must be.
        names: Names that are allowed where ``kind.names_of`` is set.
        place: Place of the declaration, for messages.

    Raises:
        CampaignError: ``wrong-type``, ``unknown-key``, ``invalid-value``, ``duplicate``.
    """
    key = f"axes.{name}"
    values: list[Value] = []
    allowed = list(names)
    for number, part in enumerate(_parts(name, written, kind, place)):
        here = {**place, "key": f"{key}[{number}]" if isinstance(written, list) else key}
        try:
            value = kind.take(part)
        except (ValueError, OverflowError):
            raise CampaignError(
                "wrong-type", f"{part!r} is not {kind.says}.", place=here
            ) from None
        if kind.names_of and value not in allowed:
            raise CampaignError(
                "unknown-name",
                f"{value!r} is no name of [{kind.names_of}].",
                place=here,
                hint=nearest(str(value), allowed) or f"Add a table [{kind.names_of}.{value}].",
            )
        if value in values:
            raise CampaignError(
                "duplicate",
                f"{part!r} stands twice; each item would be computed twice.",
                place=here,
                hint="Repetitions are what the axis seed is for.",
            )
        values.append(value)
    if not values:
        raise CampaignError(
            "invalid-value",
            "This axis has no values, so the campaign has no items.",
            place={**place, "key": key},
        )
    return tuple(values)


def _parts(
    name: str, written: Any, kind: AxisKind, place: dict[str, Any]
) -> Sequence[Any]:
    key = f"axes.{name}"
    if isinstance(written, dict):
        return _range(written, kind, {**place, "key": key}, key)
    if not isinstance(written, list):
        return [written]
    coordinates = kind.take is _triple and not any(isinstance(x, list) for x in written)
    # [1800, 0, 0] alone is one anchor, not three axes values.
    return [written] if coordinates and written else written


def _range(
    written: dict[str, Any], kind: AxisKind, place: dict[str, Any], key: str
) -> Sequence[int]:
    if not kind.a_range:
        raise CampaignError(
            "wrong-type", f"A table is not {kind.says}.", place=place, hint="Write a list."
        )
    for part, value in written.items():
        if part not in ("first", "last", "step"):
            raise unknown_key(part, ("first", "last", "step"), place, key)
        if isinstance(value, bool) or not isinstance(value, int):
            raise CampaignError(
                "wrong-type", f"{value!r} is no whole number.", place={**place, "key": f"{key}.{part}"}
            )
    if "first" not in written or "last" not in written or written.get("step", 1) < 1:
        raise CampaignError(
            "wrong-type",
            "A range needs first and last, and a step of 1 or more.",
            place=place,
            hint="For example { first = 1, last = 20 }.",
        )
    values = range(written["first"], written["last"] + 1, written.get("step", 1))
    if len(values) > MOST_VALUES:
        raise CampaignError(
            "invalid-value", f"An axis has at most {MOST_VALUES} values.", place=place
        )
    return values


def unknown_key(
    name: str, known: Iterable[str], place: Mapping[str, Any], above: str = ""
) -> CampaignError:
    """The error of a key that nothing reads, with the nearest one that something does."""
    known = list(known)
    key = f"{above}.{name}" if above else name
    hint = nearest(name, known) or f"Known here: {', '.join(known)}."
    return CampaignError(
        "unknown-key", f"{name!r} is not known here.", place={**place, "key": key}, hint=hint
    )
