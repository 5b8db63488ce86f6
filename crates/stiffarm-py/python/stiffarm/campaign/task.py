"""What a task is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .kinds import Known

#: Columns that every table has; no axis and no figure may take their names.
COLUMNS = ("item", "id", "name", "status", "error_code", "error_message")


@dataclass(frozen=True)
class Task:
    """A task turns the values of one item into figures: a flat dict of column name → value.

    Attributes:
        name: Its name in the declaration.
        run: Values, options and shared data of an item → its figures.
        check: Checks axes and options together.
        headline: Figures that the summary shows first.
        axes: Axes of a built-in task, which gets cells; None where any name will do.
        options: Options of a built-in task; None where any name will do.
        source: Hash of the file of a function of one's own.
    """

    name: str
    run: Callable[[Mapping[str, Any], Mapping[str, Any], Mapping[str, Any]], Mapping[str, Any]]
    check: Callable[[Mapping[str, Any], Mapping[str, Any]], None]
    headline: tuple[str, ...] = ()
    axes: tuple[str, ...] | None = None
    options: Known | None = None
    source: str | None = None


class BadResult(Exception):
    """A task gave something that a table cannot keep."""

    code = "bad-result"

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message
