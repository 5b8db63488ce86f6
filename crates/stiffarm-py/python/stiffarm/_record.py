"""Records: parts of a result, with keys as attributes and lists of numbers as arrays."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np


class Record(Mapping[str, Any]):
    """A part of a result: keys as attributes, lists of numbers as NumPy arrays, objects as records.

    Names are those of the command's JSON; each has its unit in it where it has one.
    """

    __slots__ = ("_data",)

    def __init__(self, data: dict[str, Any]) -> None:
        self._data = data

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return wrapped(self._data[name])
        except KeyError:
            known = ", ".join(sorted(self._data))
            raise AttributeError(f"There is no {name!r} here; there are: {known}") from None

    def __getitem__(self, name: str) -> Any:
        return wrapped(self._data[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._data]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={_short(v)}' for k, v in self._data.items())})"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._data,)

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries, lists and numbers: a copy of one's own."""
        return copy.deepcopy(self._data)


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def wrapped(value: Any) -> Any:
    """Records of objects, arrays of lists of numbers."""
    if isinstance(value, dict):
        return Record(value)
    if isinstance(value, list):
        array = _array(value)
        return [wrapped(one) for one in value] if array is None else array
    return value


def _array(values: list[Any]) -> np.ndarray | None:
    """An array of a list of numbers, or of lists of as many numbers each; null is NaN."""
    if not values:
        return None
    number = (int, float)
    if all(v is None or (isinstance(v, number) and not isinstance(v, bool)) for v in values):
        whole = all(isinstance(v, int) for v in values)
        return fixed(np.array(values if whole else [np.nan if v is None else v for v in values]))
    if all(isinstance(v, list) for v in values):
        rows = [_array(v) for v in values]
        if all(row is not None for row in rows) and len({row.shape for row in rows if row is not None}) == 1:
            return fixed(np.array(rows))
    return None


def fixed(array: np.ndarray) -> np.ndarray:
    """It is made afresh at each look: what one writes into it would be lost."""
    array.flags.writeable = False
    return array
