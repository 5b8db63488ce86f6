"""Items of a grid: one for each combination of values, in a defined order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from .declaration import Declaration
from .values import Value, canonical, digest, show


@dataclass(frozen=True)
class Item:
    """One point of the grid.

    Attributes:
        number: Place in the order of the campaign, from 0.
        id: Twelve hexadecimal digits of the hash of task, options and values: the same in every campaign that has this
            item.
        name: The values as text, ``index=novel,seed=3``.
        values: Value of each axis.
    """

    number: int
    id: str
    name: str
    values: Mapping[str, Value]


class Items:
    """The items of a declaration; made when asked for, so a large grid costs no memory."""

    def __init__(self, declaration: Declaration) -> None:
        self._declaration = declaration
        self._tables = {"cell": declaration.cells, "tool": declaration.tools, "load": declaration.loads}

    def __len__(self) -> int:
        return len(self._declaration)

    def __iter__(self) -> Iterator[Item]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, number: int) -> Item:
        if not 0 <= number < len(self):
            raise IndexError(f"item {number} of {len(self)}")
        rest = number
        values: dict[str, Value] = {}
        axes = self._declaration.axes
        # The last axis varies fastest: its place is the lowest digit of the number.
        for axis in reversed(list(axes)):
            rest, digit = divmod(rest, len(axes[axis]))
            values[axis] = axes[axis][digit]
        values = {axis: values[axis] for axis in axes}
        name = ",".join(f"{axis}={show(value)}" for axis, value in values.items())
        return Item(number, self._id(values), name, values)

    def _id(self, values: Mapping[str, Value]) -> str:
        # What a name stands for belongs to the item, not the name alone.
        meant = {axis: table[str(values[axis])] for axis, table in self._tables.items() if values.get(axis) in table}
        return digest(canonical([self._declaration.task, dict(self._declaration.options), dict(values), meant]))[:12]
