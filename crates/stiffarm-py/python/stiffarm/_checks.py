"""Arguments of the wrong type as the package's one exception."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import StiffarmError
from ._stiffarm import MOST_POSTURES

#: Largest whole number of an option, so that the library's own are wide enough for it.
LARGEST = 2**53


def whole(value: Any, key: str) -> int:
    """A whole number of 0 or more."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        message = f"This must be a whole number, got {shown(value)}."
        hint = f"{key}=int(generator.integers(2**32)) draws one" if isinstance(value, np.random.Generator) else None
        raise StiffarmError(message, "wrong-type", {"key": key}, hint) from None
    if not 0 <= number <= LARGEST:
        raise StiffarmError(f"This must be a whole number from 0, got {number}.", "invalid-value", {"key": key})
    return number


def count(value: int, key: str) -> int:
    """A number of postures that a plan can have."""
    found = whole(value, key)
    if not 1 <= found <= MOST_POSTURES:
        message = f"This must be a number of postures from 1 to {MOST_POSTURES}, got {found}."
        raise StiffarmError(message, "invalid-value", {"key": key})
    return found


def number(value: Any, key: str) -> float:
    """A finite number."""
    try:
        if isinstance(value, (bool, np.bool_, str, bytes)):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        raise StiffarmError(f"This must be a number, got {shown(value)}.", "wrong-type", {"key": key}) from None
    if not np.isfinite(found):
        raise StiffarmError(f"This must be a finite number, got {found}.", "not-finite", {"key": key})
    return found


def truth(value: Any, key: str) -> bool:
    """True or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise StiffarmError(f"This must be True or False, got {shown(value)}.", "wrong-type", {"key": key})
    return bool(value)


def text(value: Any, key: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise StiffarmError(f"This must be a text, got {shown(value)}.", "wrong-type", {"key": key})
    return value


def texts(value: Any, key: str) -> list[str]:
    """Names; one alone is a list of one."""
    if isinstance(value, str):
        return [value]
    try:
        return [text(one, key) for one in value]
    except TypeError:
        raise StiffarmError(f"This must be a list of texts, got {shown(value)}.", "wrong-type", {"key": key}) from None


def numbers(value: Any, key: str) -> list[float]:
    """Finite numbers."""
    if isinstance(value, (str, bytes, Mapping)):
        raise StiffarmError(f"This must be a list of numbers, got {shown(value)}.", "wrong-type", {"key": key})
    try:
        return [number(one, key) for one in value]
    except TypeError:
        raise StiffarmError(f"This must be a list of numbers, got {shown(value)}.", "wrong-type", {"key": key}) from None


def vector(value: Any, key: str, length: int | None = None) -> list[float]:
    """Finite numbers in one row, so many of them."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise StiffarmError(f"This must be numbers, got {shown(value)}.", "wrong-type", {"key": key}) from None
    if array.ndim != 1 or (length is not None and array.size != length):
        wanted = "a list of numbers" if length is None else f"{length} numbers"
        raise StiffarmError(f"This must be {wanted}, got {shown(value)}.", "dimension", {"key": key})
    if not np.isfinite(array).all():
        raise StiffarmError(f"This must be finite numbers, got {shown(value)}.", "not-finite", {"key": key})
    return [float(one) for one in array]


def array(value: Any, key: str) -> NDArray[np.float64]:
    """Numbers, in as many dimensions as they have."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise StiffarmError(f"This must be numbers, got {shown(value)}.", "wrong-type", {"key": key}) from None


def mapping(value: Any, key: str) -> dict[str, Any]:
    """Keys of a cell file."""
    if not isinstance(value, Mapping):
        raise StiffarmError(f"This must be a dictionary, got {shown(value)}.", "wrong-type", {"key": key})
    keys: Mapping[Any, Any] = value
    return {str(name): one for name, one in keys.items()}


def path(value: Any, what: str = "path") -> str:
    """The name of a file."""
    try:
        found = os.fsdecode(value)
    except (TypeError, ValueError):
        raise StiffarmError(f"This must be the name of a file, got {shown(value)}.", "wrong-type", {"key": what}) from None
    if "\0" in found:
        raise StiffarmError("The name of a file cannot hold a zero byte.", "file-read", {"key": what})
    return found


def shown(value: Any) -> str:
    """A value in a message, in a few words."""
    found = repr(value).replace("\n", " ")
    return found if len(found) <= 40 else f"{type(value).__name__} {found[:30]}..."


def depth(values: Any) -> int:
    """How deep lists or arrays are nested; 0 for what is neither, or not even."""
    try:
        return int(np.ndim(values))
    except ValueError:
        return 0


def floats(values: ArrayLike, dimensions: int, what: str) -> NDArray[np.float64]:
    """An array of so many dimensions, as the library reads it; a copy only where it must be one."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise StiffarmError(f"{what} must be numbers, all of them there: some are masked.", "wrong-type")
    try:
        given = np.asarray(values)
        if given.dtype.kind == "c":
            raise TypeError("they are complex")
        array = np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise StiffarmError(f"{what} must be numbers: {error}.", "wrong-type") from None
    if array.ndim != dimensions:
        raise StiffarmError(
            f"{what} must be an array of {dimensions} dimensions, got {array.ndim}.", "dimension"
        )
    return array
