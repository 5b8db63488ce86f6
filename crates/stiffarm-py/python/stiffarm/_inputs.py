"""What people have at hand as what the library reads: files, frames, arrays, results."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._checks import depth, shown, vector
from ._errors import StiffarmError, StiffarmWarning
from ._result import Result
from ._table import Table, has_columns
from .postures import Postures

Floats: TypeAlias = NDArray[np.float64]

#: A table: a path (``.csv``, ``.xlsx``, ``builtin:NAME``), a frame of pandas, polars or any library with the Arrow C
#: interface, a mapping of columns, or a :class:`stiffarm.Table`.
TableLike: TypeAlias = Union[str, "os.PathLike[str]", Table, Mapping[str, Sequence[Any]], Any]

#: Postures: a table with the columns of a posture file, :class:`stiffarm.Postures`, a result that has postures, or an
#: array of angles, one row per posture [rad].
PosturesLike: TypeAlias = Union[TableLike, Postures, Result, ArrayLike]

#: Called as ``progress(what, done, of)`` while long work runs; ``True`` shows a bar of tqdm where that is installed.
Progress: TypeAlias = Union[Callable[[str, int, int], Any], bool, None]


def is_table(value: object) -> bool:
    """True for the name of a file, and for what has columns."""
    return isinstance(value, (str, os.PathLike)) or has_columns(value)


def contents(key: str, value: Any, degrees: bool, cell: Any) -> bytes:
    """What is no file, as the bytes of one: a saved result, or a table."""
    if isinstance(value, Result) and (key == "results" or "postures_deg" not in set(value)):
        other = value.inputs.get("cell", "")
        if key == "stiffness" and cell is not None and other not in ("", cell.inputs["cell"]):
            message = "The stiffness was identified with another version of this cell."
            warnings.warn(message, StiffarmWarning, stacklevel=7)
        return value.to_json().encode()
    if key == "stiffness":
        if isinstance(value, (Result, Postures)):
            hint = "what identify gives, or a stiffness per joint [N m/rad]"
            raise StiffarmError(f"A {type(value).__name__} holds no stiffness.", "wrong-type", {"key": key}, hint)
        return _stiffness(value)
    if isinstance(value, (Postures, Result)) or not has_columns(value):
        postures = Postures.of(value, degrees=degrees)
        if len(postures) == 0:
            raise StiffarmError("There are no postures.", "too-few-data", {"key": key})
        return postures.to_csv().encode()
    return Table.of(value).to_csv().encode()


def _stiffness(value: Any) -> bytes:
    """A bare stiffness, alone or as its file has it."""
    if not isinstance(value, Mapping):
        value = {"stiffness_nm_per_rad": vector(value, "stiffness")}
    own = {str(key): item.tolist() if isinstance(item, np.ndarray) else item for key, item in value.items()}
    try:
        return json.dumps(own).encode()
    except (TypeError, ValueError) as error:
        message = f"The stiffness cannot be written as JSON: {error}."
        raise StiffarmError(message, "wrong-type", {"key": "stiffness"}) from None


def named(path: str | os.PathLike[str], cell: Any) -> Postures:
    """Postures of a file that is a group under another name than its own."""
    return Postures.read(path, cell)


def groups(value: Any) -> list[tuple[str, Any]]:
    """Groups of postures with their names: one, several, or several by name; a file without one has its own."""
    if isinstance(value, Mapping) and not isinstance(value, (Result, Table)) and not _is_columns(value):
        return [(str(name), one) for name, one in value.items()]
    listed: Sequence[Any] = value if isinstance(value, (list, tuple)) else ()
    several = any(
        isinstance(one, (str, os.PathLike, Postures, Result)) or is_table(one) or depth(one) == 2
        for one in listed
    )
    members: list[Any] = [*listed] if several else [value]
    out: list[tuple[str, Any]] = []
    for number, one in enumerate(members, 1):
        own = one.name if isinstance(one, Postures) and one.name else ""
        fallback = f"group {number}" if len(members) > 1 else "postures"
        out.append(("" if isinstance(one, (str, os.PathLike)) else own or fallback, one))
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


__all__ = ["Floats", "PosturesLike", "Progress", "TableLike"]
