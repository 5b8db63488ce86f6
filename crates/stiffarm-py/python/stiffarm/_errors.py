"""The package's one exception, and what its hints say of names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


class StiffarmError(ValueError):
    """What is wrong, where, and what to do.

    >>> import stiffarm
    >>> try:
    ...     stiffarm.Cell.built_in("comauu")
    ... except stiffarm.StiffarmError as error:
    ...     print(error.code, "|", error.message)
    unknown-name | There is no built-in cell "comauu".

    Attributes:
        message: One sentence, without place and hint.
        code: Stable name of the kind of error, as ``docs/errors.md`` lists them: ``"missing-key"``,
            ``"not-identifiable"``, ...
        place: Where it is: any of ``file``, ``line``, ``column`` (both from 1) and ``key`` (a key path of a
            cell file, a column of a table, or a parameter).
        hint: What to do about it, or ``None``.
    """

    def __init__(
        self,
        message: str,
        code: str = "usage",
        place: dict[str, Any] | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.place: dict[str, Any] = dict(place or {})
        self.hint = hint

    def __str__(self) -> str:
        at = [str(self.place[part]) for part in ("file", "line", "column") if part in self.place]
        parts = [":".join(at)] if at else []
        if "key" in self.place:
            parts.append(str(self.place["key"]))
        text = ": ".join([*parts, self.message])
        return f"{text}\n  hint: {self.hint}" if self.hint else text

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.code, self.place, self.hint)


class StiffarmWarning(UserWarning):
    """A result that is less than what was asked for: work that Ctrl-C stopped."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """A sentence with the name that was probably meant, or None."""
    found = difflib.get_close_matches(name, list(known), n=1)
    return f"Did you mean {found[0]!r}?" if found else None
