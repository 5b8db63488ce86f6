"""Options of the built-in tasks: which there are and what type they have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .axes import unknown_key
from .errors import CampaignError


@dataclass(frozen=True)
class OptionKind:
    """Type of an option.

    Attributes:
        says: What the value must be, for messages.
        types: Python types it may have; ``bool`` counts as a number only where it is named.
        inner: Options of a table, where the option is one.
        each: Types of the entries of a list, where the option is one.
    """

    says: str
    types: tuple[type, ...]
    inner: Mapping[str, OptionKind] | None = None
    each: tuple[type, ...] | None = None


WHOLE = OptionKind("a whole number", (int,))
NUMBER = OptionKind("a number", (int, float))
YES_NO = OptionKind("true or false", (bool,))
TEXT = OptionKind("text", (str,))
NAMES = OptionKind("a list of names", (list,), each=(str,))
FORBIDDEN: Mapping[str, str] = {
    "time_limit_s": "A search that ends by the clock gives other results each time. Use rounds.",
    "time_limit": "A search that ends by the clock gives other results each time. Use rounds.",
    "threads": "Every item runs on one worker thread.",
    "progress": "Progress is an argument of run.",
}


def read_options(
    written: Mapping[str, Any],
    known: Mapping[str, OptionKind],
    place: Mapping[str, Any],
    above: str = "options",
) -> dict[str, Any]:
    """The options, checked by name and type.

    Raises:
        CampaignError: ``unknown-key`` or ``wrong-type`` with the key's path.
    """
    result: dict[str, Any] = {}
    for name, value in written.items():
        here = {**place, "key": f"{above}.{name}"}
        if name in FORBIDDEN and name not in known:
            raise CampaignError(
                "unknown-key", f"{name!r} is no option of an item.", place=here, hint=FORBIDDEN[name]
            )
        if name not in known:
            raise unknown_key(name, known, place, above)
        kind = known[name]
        wrong = not isinstance(value, kind.types) or (
            isinstance(value, bool) and bool not in kind.types
        )
        if kind.each is not None and not wrong:
            several: Any = value
            wrong = any(isinstance(x, bool) or not isinstance(x, kind.each) for x in several)
        if wrong:
            raise CampaignError("wrong-type", f"{value!r} is not {kind.says}.", place=here)
        if kind.inner is not None:
            inner: Any = value
            value = read_options(inner, kind.inner, place, f"{above}.{name}")
        result[name] = value
    return result
