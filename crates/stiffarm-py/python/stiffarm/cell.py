"""The cell: robot, tool, load, limits, noise; what every function begins with."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _checks, _native_cell, _stiffarm
from ._errors import StiffarmError
from ._files import write_file
from .robot import Robot


def tool(
    loading_point_mm: ArrayLike,
    measuring_points_mm: Mapping[str, ArrayLike],
    **keys: Any,
) -> dict[str, Any]:
    """The ``[tool]`` of a cell: where it is loaded and where it is measured.

    Args:
        loading_point_mm: Where rope, weight or wrench act, flange axes [mm].
        measuring_points_mm: The reflectors by name, flange axes [mm]; the first is the tool centre point.
        **keys: Further keys of ``[tool]`` as in a cell file, for example ``mass_kg`` or ``shape``.
    """
    given = _checks.mapping(measuring_points_mm, "measuring_points_mm")
    points = [{"name": name, "position_mm": _checks.vector(at, f"measuring_points_mm.{name}", 3)} for name, at in given.items()]
    return {"loading_point_mm": _checks.vector(loading_point_mm, "loading_point_mm", 3), "measuring_point": points, **_native_cell.plain(keys)}


def rope(anchor_mm: ArrayLike, magnitude_n: float) -> dict[str, Any]:
    """The ``[load]`` of a rope from the loading point to an anchor in the base frame [mm, N]."""
    return {"kind": "rope", "anchor_mm": _checks.vector(anchor_mm, "anchor_mm", 3), "magnitude_n": _checks.number(magnitude_n, "magnitude_n")}


def weight(*, mass_kg: float | None = None, magnitude_n: float | None = None) -> dict[str, Any]:
    """The ``[load]`` of a weight that hangs on the loading point: its mass [kg] or its force [N]."""
    given = {"mass_kg": mass_kg, "magnitude_n": magnitude_n}
    if (mass_kg is None) == (magnitude_n is None):
        raise StiffarmError("A weight has either a mass or a force.", "usage", {"key": "mass_kg"})
    return {"kind": "weight", **{key: _checks.number(value, key) for key, value in given.items() if value is not None}}


def wrench(force_n: ArrayLike, moment_nm: ArrayLike = (0.0, 0.0, 0.0), *, axes: str = "base") -> dict[str, Any]:
    """The ``[load]`` of a constant force and moment about the loading point, in ``"base"`` or ``"tool"`` axes [N, N·m]."""
    force, moment = _checks.vector(force_n, "force_n", 3), _checks.vector(moment_nm, "moment_nm", 3)
    return {"kind": "wrench", "force_n": force, "moment_nm": moment, "axes": axes}


def cases(**loads: Mapping[str, Any]) -> dict[str, Any]:
    """The ``[load]`` of several loads under which every posture is measured, by name."""
    return {"kind": "cases", "case": [{"name": name, **_native_cell.plain(_checks.mapping(load, name))} for name, load in loads.items()]}


def measured() -> dict[str, Any]:
    """The ``[load]`` whose wrench comes with each measurement."""
    return {"kind": "measured"}


class Cell:
    """A robot cell.

    >>> import stiffarm
    >>> cell = stiffarm.Cell.built_in("comau")
    >>> cell.joint_count, cell.loading_point.tolist()
    (6, [0.2, 0.0, 0.25])
    >>> cell.with_changes({"load": {"magnitude_n": 600}}).to_dict()["load"]["magnitude_n"]
    600

    Read it from a cell file (``Cell("cell.toml")``), take a built-in one (``Cell.built_in("comau")``), or put it
    together (``Cell.of(robot, tool, load, ...)``, ``Cell.from_dict({...})``). Cells do not change;
    :meth:`with_changes` makes another. They can be pickled, meshes included.
    """

    __slots__ = ("_native",)

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Reads a cell file with the meshes beside it; ``builtin:NAME`` is a built-in one.

        Raises:
            StiffarmError: It cannot be read, or anything in it is wrong, with file, line, column and key.
        """
        self._native = _native_cell.of_file(_checks.path(path))

    @classmethod
    def _of(cls, native: _stiffarm.Cell) -> Cell:
        cell = cls.__new__(cls)
        cell._native = native
        return cell

    @classmethod
    def built_in(cls, name: str = "comau") -> Cell:
        """A built-in cell: ``comau`` (the paper's), ``comau-reference``, ``comau-shapes``, ``fanuc-r2000ic``.

        Raises:
            StiffarmError: There is no built-in cell of this name.
        """
        return cls._of(_stiffarm.Cell.built_in(_checks.text(name, "name")))

    @classmethod
    def from_toml(cls, text: str, name: str = "<text>", *, folder: str | os.PathLike[str] | None = None) -> Cell:
        """A cell of the text of a cell file; meshes are looked for in ``folder``.

        Raises:
            StiffarmError: As for a file.
        """
        where = None if folder is None else _checks.path(folder, "folder")
        return cls._of(_stiffarm.Cell(name, _checks.text(text, "text").encode(), {}, where))

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any], *, folder: str | os.PathLike[str] | None = None) -> Cell:
        """A cell of the keys of a cell file, units in their names; ``format`` may be left out.

        Raises:
            StiffarmError: As for a file; the place is a key, and a line of the text that is made of it.
        """
        where = None if folder is None else _checks.path(folder, "folder")
        return cls._of(_native_cell.of_keys(_checks.mapping(keys, "keys"), where))

    @classmethod
    def of(
        cls,
        robot: Robot | str,
        tool: Mapping[str, Any],
        load: Mapping[str, Any],
        *,
        stiffness_nm_per_rad: ArrayLike | None = None,
        obstacles: Sequence[Mapping[str, Any]] = (),
        name: str | None = None,
        **keys: Any,
    ) -> Cell:
        """A cell put together.

        Args:
            robot: The robot, or the name of one in the catalogue.
            tool: As :func:`tool` makes it.
            load: As :func:`rope`, :func:`weight`, :func:`wrench`, :func:`cases` or :func:`measured` makes it.
            stiffness_nm_per_rad: Joint stiffness known beforehand, one per joint [N·m/rad].
            obstacles: What stands in the cell: ``[[obstacle]]`` of a cell file.
            name: Name of the cell in results.
            **keys: Further tables of a cell file: ``bounds``, ``limits``, ``noise``, ``task``, ``work``, ...

        Raises:
            StiffarmError: Anything wrong with a value, with its key.
        """
        own = Robot.catalogue(robot) if isinstance(robot, str) else robot
        if not isinstance(own, Robot):
            message = f"A Robot is needed, got {_checks.shown(own)}."
            raise StiffarmError(message, "wrong-type", {"key": "robot"}, hint='Robot.catalogue("comau-nj165-3.0")')
        made: dict[str, Any] = {
            "robot": own.to_dict(),
            "tool": _checks.mapping(tool, "tool"),
            "load": _checks.mapping(load, "load"),
            **keys,
        }
        if name is not None:
            made["name"] = name
        if stiffness_nm_per_rad is not None:
            made["stiffness"] = {"prior_nm_per_rad": _native_cell.plain(stiffness_nm_per_rad)}
        if obstacles:
            made["obstacle"] = [_checks.mapping(one, "obstacles") for one in obstacles]
        return cls.from_dict(made)

    def with_changes(self, changes: Mapping[str, Any]) -> Cell:
        """The cell with some keys of its file changed: tables key by key, everything else as a whole.

        ``cell.with_changes({"load": {"magnitude_n": 500}})`` changes the force alone; ``None`` takes a key away. A table
        of another ``kind`` than before takes the place of the old one: ``cell.with_changes({"load": weight(mass_kg=20)})``.

        Raises:
            StiffarmError: Anything wrong with the new values.
        """
        text = _native_cell.toml(_merged(self.to_dict(), _native_cell.plain(_checks.mapping(changes, "changes"))))
        # A changed cell is built in no more.
        name = "<cell>" if self.file.startswith("builtin:") else self.file
        native = _stiffarm.Cell(name, text.encode(), self._native.files, None)
        return Cell._of(native)

    def to_dict(self) -> dict[str, Any]:
        """The keys of the cell file."""
        keys: dict[str, Any] = json.loads(_stiffarm.json_of_toml(self.to_toml()))
        return keys

    def to_toml(self) -> str:
        """The text of the cell file."""
        return self._native.text.decode("utf-8-sig")

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the cell file; meshes that it names are not written.

        Raises:
            StiffarmError: The file exists and ``overwrite`` is not set, or it cannot be written.
        """
        return write_file(path, self.to_toml(), overwrite=overwrite)

    @property
    def name(self) -> str:
        """Name of the cell in tables and reports."""
        return self._native.title

    @property
    def file(self) -> str:
        """Where it was read from."""
        return self._native.name

    @property
    def robot(self) -> Robot:
        """The robot."""
        return Robot._in(self._native, self.to_dict()["robot"])

    @property
    def inputs(self) -> dict[str, str]:
        """SHA-256 of the cell file and of each mesh, as results name them."""
        return self._native.inputs

    @property
    def joint_count(self) -> int:
        """Number of joints."""
        return self._native.joint_count

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints, base to flange."""
        return self._native.joint_names

    @property
    def spring_names(self) -> list[str]:
        """Names of the springs whose stiffness is identified; those of the joints unless springs mix them."""
        return self._native.spring_names

    @property
    def limits(self) -> NDArray[np.float64]:
        """The machine's limits of the controller angles, a row [low, high] per joint [rad]."""
        return self._native.limits

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Bounds of the controller angles for choosing postures, a row [low, high] per joint [rad]."""
        return self._native.bounds

    @property
    def prior_stiffness(self) -> NDArray[np.float64] | None:
        """Joint stiffness known beforehand [N·m/rad], one per spring, where there is one."""
        return self._native.prior

    @property
    def noise_std(self) -> float:
        """Standard deviation of one component of a measured displacement [m]."""
        return self._native.noise_std

    @property
    def characteristic_length(self) -> float | None:
        """L of Eq. (20) [m] where the cell file gives it."""
        return self._native.characteristic_length

    @property
    def loading_point(self) -> NDArray[np.float64]:
        """Where the load acts, flange axes [m]."""
        return self._native.loading_point

    @property
    def measuring_points(self) -> dict[str, NDArray[np.float64]]:
        """The reflectors by name, flange axes [m]."""
        return dict(zip(self._native.measuring_point_names, self._native.measuring_points, strict=True))

    def __reduce__(self) -> tuple[Any, ...]:
        return Cell._of, (self._native,)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Cell) and self.inputs == other.inputs

    def __hash__(self) -> int:
        return hash(tuple(sorted(self.inputs.items())))

    def __repr__(self) -> str:
        return f"<Cell {self.name!r}: {self._native.robot_name}, {self.joint_count} joints, from {self.file}>"


def _merged(old: dict[str, Any], new: dict[str, Any]) -> dict[str, Any]:
    out = copy.copy(old)
    for key, value in new.items():
        if value is None:
            out.pop(key, None)
        elif isinstance(value, dict) and isinstance(out.get(key), dict) and _is_alike(out[key], value):
            out[key] = _merged(out[key], value)
        else:
            out[key] = value
    return out


def _is_alike(old: dict[str, Any], new: dict[str, Any]) -> bool:
    """Whether keys of the old table can stay beside those of the new one."""
    return "kind" not in new or new["kind"] == old.get("kind")
