"""What people have at hand as what the library reads: files, frames, arrays, results."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _stiffarm
from ._checks import path as checked_path
from ._checks import shown
from ._errors import StiffarmError
from ._result import Result
from ._table import Table, has_columns

if TYPE_CHECKING:
    from .postures import Postures

Floats: TypeAlias = NDArray[np.float64]

#: A table: a path (``.csv``, ``.xlsx``, ``builtin:NAME``), a frame of pandas, polars or any library with the Arrow C
#: interface, a mapping of columns, or a :class:`stiffarm.Table`.
TableLike: TypeAlias = Union[str, "os.PathLike[str]", Table, Mapping[str, Sequence[Any]], Any]

#: Postures: a table with the columns of a posture file, :class:`stiffarm.Postures`, a result that has postures, or an
#: array of angles, one row per posture [rad].
PosturesLike: TypeAlias = Union[TableLike, "Postures", Result, ArrayLike]

#: Called as ``progress(what, done, of)`` while long work runs; ``True`` shows a bar of tqdm where that is installed.
Progress: TypeAlias = Union[Callable[[str, int, int], Any], bool, None]

#: What the extension module takes: a file's name, a text in memory with its name, or angles with the postures' names.
Given: TypeAlias = Union[str, tuple[str, bytes], tuple[list[str], Floats]]


def angles(values: Any, degrees: bool, dimensions: int = 2, what: str = "Postures") -> Floats:
    """Angles of postures [rad]: of an array, or of what has postures under names."""
    from .postures import Postures

    if isinstance(values, Postures) or has_columns(values):
        return Postures.of(values).angles
    of_array: Any = values
    return _stiffarm.radians(floats(of_array, dimensions, what), degrees)


def depth(values: Any) -> int:
    """How deep lists or arrays are nested; 0 for what is neither, or not even."""
    try:
        return int(np.ndim(values))
    except ValueError:
        return 0


def floats(values: ArrayLike, dimensions: int, what: str) -> Floats:
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


def is_table(value: object) -> bool:
    """True for the name of a file, and for what has columns."""
    return isinstance(value, (str, os.PathLike)) or has_columns(value)


def table(value: TableLike, role: str) -> str | tuple[str, bytes]:
    """A table as the library reads it."""
    from .postures import Postures

    if isinstance(value, (str, os.PathLike)):
        return checked_path(value, role)
    if isinstance(value, (Postures, Result)):
        return f"<{role}>", Postures.of(value).to_csv().encode()
    return f"<{role}>", Table.of(value).to_csv().encode()


def tables(value: TableLike | list[TableLike], role: str) -> list[str | tuple[str, bytes]]:
    """One table or several that are read as one."""
    if not isinstance(value, (list, tuple)):
        return [table(value, role)]
    return [table(one, f"{role} {number}") for number, one in enumerate(value, 1)]


def result(value: Result | str | os.PathLike[str], role: str) -> str | tuple[str, bytes]:
    """A saved result, or one in memory."""
    if isinstance(value, Result):
        return f"<{role}>", value.to_json().encode()
    if isinstance(value, (str, os.PathLike)):
        return checked_path(value, role)
    raise StiffarmError(
        f"The {role} must be a result or the name of a saved one, got {type(value).__name__}.",
        "wrong-type",
    )


def postures(value: PosturesLike, role: str = "postures", *, degrees: bool = False) -> Given:
    """Postures as the library reads them."""
    from .postures import Postures

    if is_table(value) and not isinstance(value, (Postures, Result)):
        return table(value, role)
    own = Postures.of(value, degrees=degrees)
    return own.names, own.angles


def groups(
    value: PosturesLike | Mapping[str, PosturesLike] | Iterable[PosturesLike],
    *,
    degrees: bool = False,
) -> list[tuple[str, Given]]:
    """Groups of postures with their names: one, several, or several by name."""
    from .postures import Postures

    if isinstance(value, Mapping) and not isinstance(value, (Result, Table)) and not _is_columns(value):
        return [(str(name), postures(one, str(name), degrees=degrees)) for name, one in value.items()]
    listed: Sequence[Any] = value if isinstance(value, (list, tuple)) else ()
    several = any(
        isinstance(one, (str, os.PathLike, Postures, Result)) or is_table(one) or depth(one) == 2
        for one in listed
    )
    members: list[Any] = [*listed] if several else [value]
    out: list[tuple[str, Given]] = []
    for number, one in enumerate(members, 1):
        own = one.name if isinstance(one, Postures) and one.name else ""
        fallback = f"group {number}" if len(members) > 1 else "postures"
        is_file = isinstance(one, (str, os.PathLike))
        out.append(("" if is_file else own or fallback, postures(one, own or fallback, degrees=degrees)))
    return out


def _is_columns(value: Mapping[Any, Any]) -> bool:
    """True for the columns of one table: its values are lists of plain values."""
    return all(
        not isinstance(column, Mapping) and not hasattr(column, "columns") and np.ndim(column) == 1
        for column in value.values()
    )


class Watching:
    """A progress callback: the caller's own, or a bar of tqdm."""

    def __init__(self, progress: Progress) -> None:
        self._bar: Any = None
        self.call: Callable[[str, int, int], Any] | None
        if progress is True:
            self.call = self._tell
        elif progress is False or progress is None:
            self.call = None
        elif callable(progress):
            self.call = progress
        else:
            raise StiffarmError(
                f"This must be True, False or a function, got {shown(progress)}.", "wrong-type", {"key": "progress"}
            )

    def _tell(self, what: str, done: int, of: int) -> None:
        if self._bar is None:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                self._bar = False
                return
            self._bar = tqdm(total=of, desc=what, leave=False)
        if self._bar is False:
            return
        if self._bar.desc != f"{what}: " or self._bar.total != of:
            self._bar.set_description(what, refresh=False)
            self._bar.reset(total=of)
        self._bar.update(max(0, done - self._bar.n))

    def __enter__(self) -> Callable[[str, int, int], Any] | None:
        return self.call

    def __exit__(self, *_: object) -> None:
        if self._bar:
            self._bar.close()


__all__ = ["Floats", "Given", "PosturesLike", "Progress", "TableLike", "_stiffarm"]
