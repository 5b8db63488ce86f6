"""Results: what the command prints as JSON, with attributes, tables and files."""

from __future__ import annotations

import html
import json
import os
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from . import _checks, _stiffarm
from ._errors import StiffarmError
from ._files import write_file
from ._record import Record
from ._table import Table
from .cell import Cell

_R = TypeVar("_R", bound="Result")


class Result(Record):
    """What a function found: the same values as the command prints with ``--json``, to the last bit.

    Keys of the result are attributes: ``plan.value``, ``identified.joints[0].stiffness``. Lists
    of numbers are NumPy arrays (``null`` is NaN), objects are records of the same kind.
    """

    __slots__ = ("_cell", "_document", "_text", "interrupted")

    #: Keys that lead to the rows of :meth:`to_frame`.
    _rows: ClassVar[tuple[str, ...]] = ()

    #: :func:`stiffarm.plot.figure`, which says so itself: it knows results.
    _draw: ClassVar[Callable[..., Any] | None] = None

    #: Classes by the command whose results they are, and by its mode where it answers several questions.
    _classes: ClassVar[dict[tuple[str, str], type[Result]]] = {}

    #: True where Ctrl-C stopped the work and this is the best so far.
    interrupted: bool

    def __init_subclass__(cls, command: str = "", mode: str = "") -> None:
        super().__init_subclass__()
        if command:
            Result._classes[command, mode] = cls

    def __init__(self, text: str, interrupted: bool = False, cell: Cell | None = None) -> None:
        self._text = text
        self._cell = cell
        self._document: dict[str, Any] = json.loads(text)
        self.interrupted = interrupted
        super().__init__(self._document["result"])

    @property
    def command(self) -> str:
        """The command that gives the same."""
        return str(self._document["command"])

    @property
    def seed(self) -> int | None:
        """Seed of the random numbers, where there are any."""
        seed = self._document["seed"]
        return None if seed is None else int(seed)

    @property
    def options(self) -> Record:
        """Options of the command, defaults included, as its JSON has them."""
        return Record(self._document["options"])

    @property
    def command_line(self) -> str:
        """The command that gives the same; inputs are written as ``{role}``."""
        return shlex.join(["stiffarm", *self._document["arguments"]])

    @property
    def inputs(self) -> dict[str, str]:
        """SHA-256 of each input by its role. Arrays count as the table that would be written of them."""
        return dict(self._document["inputs"])

    @property
    def version(self) -> str:
        """Version of stiffarm that made it."""
        return str(self._document["stiffarm"])

    @property
    def findings(self) -> list[Record]:
        """What the result says about itself: each with ``code``, ``severity``, ``subject``, ``sentence``."""
        return [Record(f) for f in self._data.get("findings", [])]

    def to_json(self) -> str:
        """The text that the command prints with ``--json``: the result with what made it."""
        return self._text

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes :meth:`to_json` to a file, which ``validate``, ``predict`` or the command's ``report`` read.

        The file is written whole or not at all.

        Raises:
            StiffarmError: The file exists and ``overwrite`` is not set, or it cannot be written.
        """
        return write_file(path, self._text, overwrite=overwrite)

    @classmethod
    def load(cls: type[_R], path: str | os.PathLike[str]) -> _R:
        """Reads a result that :meth:`save` or the command wrote.

        Raises:
            StiffarmError: It cannot be read, or is the result of another function.
        """
        file = _checks.path(path)
        try:
            text = Path(file).read_text(encoding="utf-8")
            found = result_of(text, json.loads(text))
        except OSError as error:
            raise StiffarmError(f"The file cannot be read: {error.strerror}.", "file-read", {"file": file}) from None
        except (ValueError, KeyError, TypeError):
            raise StiffarmError("This is not a saved result.", "result-file", {"file": file}) from None
        if not isinstance(found, cls):
            message = f"This is the result of {found.command}: its class is {type(found).__name__}, not {cls.__name__}."
            raise StiffarmError(message, "result-file", {"file": file})
        return found

    def summary(self, *, details: bool = False) -> str:
        """What the result says, in the words of the command; ``print(result)`` shows the same without details.

        Raises:
            StiffarmError: A result of a command that prints no more than its values.
        """
        return self._summary("details" if details else "summary")

    def _summary(self, how: str) -> str:
        return _stiffarm.summary(self._text, self._native(), how).rstrip("\n")

    def _native(self) -> _stiffarm.Cell | None:
        return None if self._cell is None else self._cell._native

    def page(self) -> Page:
        """The result as one offline page, with the cell in 3D where the result was made in this process; a notebook
        shows it in place.

        Raises:
            StiffarmError: A result that has no page.
        """
        return Page(_stiffarm.page(self._text, self._native()))

    def report(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes :meth:`page` to a file.

        Raises:
            StiffarmError: A result that has no page, a file that exists or cannot be written.
        """
        return write_file(path, self.page(), overwrite=overwrite)

    def figures(self) -> dict[str, dict[str, Any]]:
        """The figures of the :meth:`page` by name: title, caption, and the panels with axes and series as data.

        Raises:
            StiffarmError: A result that has no page.
        """
        figures = json.loads(_stiffarm.figures(self._text, self._native()))
        return {figure["id"]: figure for figure in figures}

    def plot(self, name: str | None = None, *, panel: int | None = None, ax: Any = None, width_in: float = 3.5) -> Any:
        """Draws one of the :meth:`figures`, the first unless named: :func:`stiffarm.plot.figure`.

        Raises:
            StiffarmError: A result that has no such figure, or matplotlib is not installed.
        """
        draw = Result._draw
        assert draw is not None
        return draw(self, name, panel=panel, ax=ax, width_in=width_in)

    def table(self) -> Table:
        """The main table of the result, a row each; see :meth:`to_frame`."""
        rows: Any = self._data
        for key in self._rows:
            rows = rows[key]
        if not self._rows or not isinstance(rows, list):
            raise StiffarmError(f"A {type(self).__name__} has no table.", "unsupported")
        return table_of(rows)

    def to_frame(self, library: str | None = None) -> Any:
        """The main table as a frame of ``"pandas"`` or ``"polars"``; vectors become a column per component."""
        return self.table().to_frame(library)

    def __str__(self) -> str:
        try:
            return self.summary()
        except StiffarmError:
            return repr(self)

    def __repr__(self) -> str:
        try:
            said = self._summary("verdict")
        except StiffarmError:
            said = f"{self.command}, with {', '.join(self._data)}"
        return f"<{type(self).__name__}: {said}>"

    def _repr_html_(self) -> str:
        try:
            return self._summary("html")
        except StiffarmError:
            return f"<p>{html.escape(repr(self))}</p>"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._text, self.interrupted, self._cell)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Result) and self._text == other._text

    __hash__ = None  # type: ignore[assignment]


def result_of(text: str, document: dict[str, Any], interrupted: bool = False, cell: Cell | None = None) -> Result:
    """The result of a command as its class."""
    command = document["command"]
    mode = document["options"]["mode"] if command == "select" else ""
    if command == "map" and "candidates" in document["result"]:
        mode = "place"
    of_command = Result._classes.get((command, ""), Result)
    return Result._classes.get((command, mode), of_command)(text, interrupted, cell)


class Page(str):
    """A page of HTML; a notebook shows it in a frame of its own."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"<Page of {len(self) / 1e3:.0f} kB; in a notebook it is shown, report() writes it>"

    def _repr_html_(self) -> str:
        # The frame keeps styles and scripts of the page and those of the notebook apart.
        return f'<iframe srcdoc="{html.escape(self)}" style="width: 100%; height: 800px; border: 0"></iframe>'


def table_of(rows: list[dict[str, Any]]) -> Table:
    """Plain columns of records: numbers and text as they are, vectors by component, records by key."""
    names: dict[str, None] = {}
    flat = [dict(_cells("", row)) for row in rows]
    for row in flat:
        names.update(dict.fromkeys(row))
    columns = {name: [row.get(name) for row in flat] for name in names}
    # A column without a value says nothing.
    return Table({name: values for name, values in columns.items() if any(value is not None for value in values)})


def _cells(prefix: str, row: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in row.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _cells(f"{name}_", value)
        elif isinstance(value, list):
            for i, one in enumerate(value):
                if not isinstance(one, (list, dict)):
                    yield _component(name, i, len(value)), one
        else:
            yield name, value


def _component(name: str, i: int, of: int) -> str:
    """``shift_m`` gives ``shift_x_m``, ``q_deg`` gives ``q1_deg`` as in a posture file: the unit stays last."""
    stem, mark, unit = name.rpartition("_")
    stem, unit = (stem, f"_{unit}") if mark and unit in ("m", "mm", "deg", "n", "nm", "rad") else (name, "")
    if stem == "q" or stem.endswith("_q"):
        return f"{stem}{i + 1}{unit}"
    return f"{stem}_{'xyz'[i] if of == 3 else i + 1}{unit}"
