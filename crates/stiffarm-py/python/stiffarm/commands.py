"""The commands of ``stiffarm`` as functions, made of what the command line says of itself.

Each takes what the command takes, by the same names, words joined by ``_``, and gives what the command prints with
``--json``. Where the command reads a file a function also takes what Python has in its place: a cell, postures, an array
of angles, a frame, a result. ``help(stiffarm.select)`` shows the options of one, :mod:`stiffarm.results` what comes back.
"""

from __future__ import annotations

import functools
import inspect
import json
import os
import re
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from . import _checks, _inputs, _native_cell, _stiffarm
from ._errors import StiffarmError, StiffarmWarning, nearest
from ._result import Result
from .cell import Cell
from .results import result_of

#: Arguments that every function has, or some, beside those of the command.
_PROGRESS = "progress: Called as ``progress(what, done, of)`` while work is long; ``True`` shows a bar."
_DEGREES = "degrees: Arrays of angles are in degrees; they are in radians otherwise."
_ACCEPT = (
    "accept: A limit of your own, called with the angles of one posture [rad]: true where it may be chosen. It is asked "
    "about candidates, at the end of each local search and about the plan, from several threads one after the other; its "
    "answer must depend on the angles alone."
)
_Spec = Mapping[str, Any]


@functools.cache
def _described() -> dict[str, _Spec]:
    return {one["name"]: one for one in json.loads(_stiffarm.commands())}


def names() -> list[str]:
    """The commands that are functions here."""
    return list(_described())


@functools.cache
def __getattr__(name: str) -> Any:
    if name not in _described():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _function(_described()[name])


def __dir__() -> list[str]:
    return [*globals(), *_described()]


def _keyword(option: str) -> str:
    """The keyword of an option."""
    return option.replace("-", "_")


def _default(argument: _Spec) -> Any:
    if argument["kind"] == "flag":
        return False
    text = argument["default"]
    if text is None:
        return None
    if argument["kind"] == "whole":
        return int(text)
    return float(text) if argument["kind"] == "number" else text


def _signature(spec: _Spec) -> inspect.Signature:
    kinds = inspect.Parameter
    found, optional = [], False
    for argument in spec["arguments"]:
        if argument["option"] is None:
            optional |= not argument["required"]
            default = _default(argument) if optional else kinds.empty
            found.append(kinds(argument["name"], kinds.POSITIONAL_OR_KEYWORD, default=default))
    # What has a short form on the command line may stand by its place here: select(cell, 6).
    for argument in sorted(spec["arguments"], key=lambda one: not one["short"]):
        if argument["option"] is not None:
            kind = kinds.POSITIONAL_OR_KEYWORD if argument["short"] else kinds.KEYWORD_ONLY
            found.append(kinds(argument["name"], kind, default=_default(argument)))
    for extra in _extras(spec):
        default = False if extra is _DEGREES else None
        found.append(kinds(extra.partition(":")[0], kinds.KEYWORD_ONLY, default=default))
    return inspect.Signature(found)


def _extras(spec: _Spec) -> list[str]:
    """What a function takes that its command does not, as it is documented."""
    tables = [one for one in spec["arguments"] if one["kind"] == "input" and one["name"] not in ("cell", "stiffness")]
    return [_DEGREES] * bool(tables) + [_ACCEPT] * (spec["name"] == "select") + [_PROGRESS]


def _documentation(spec: _Spec) -> str:
    lines = [f"{spec['about']} (``stiffarm {spec['name']}``).", "", "Args:"]
    for argument in spec["arguments"]:
        said = _OPTION.sub(lambda found: _keyword(found[1]), argument["help"]).replace("`", "``")
        choices = "".join(f" ``{choice}``" for choice in argument["choices"])
        lines.append(f"    {argument['name']}: {said}.{f' One of{choices}.' if choices else ''}")
    lines += [f"    {extra}" for extra in _extras(spec)]
    return "\n".join([*lines, "", "Raises:", "    StiffarmError: Anything that is wrong, with its place and what to do."])


def _function(spec: _Spec) -> Callable[..., Any]:
    signature = _signature(spec)

    def function(*args: Any, **kwargs: Any) -> Any:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as error:
            unknown = next((key for key in kwargs if key not in signature.parameters), None)
            if unknown is None:
                got = "" if str(error).startswith("missing") else "got "
                raise TypeError(f"{spec['name']}() {got}{error}") from None
            meant = nearest(unknown, signature.parameters)
            message = f"{spec['name']}() got an unexpected keyword argument {unknown!r}"
            raise TypeError(f"{message}. {meant}" if meant else message) from None
        return _Call(spec, given).run()

    function.__name__ = function.__qualname__ = spec["name"]
    function.__module__ = "stiffarm"
    function.__doc__ = _documentation(spec)
    function.__signature__ = signature  # type: ignore[attr-defined]
    return function


class _Call:
    """One call: its words, and the inputs that are no files."""

    def __init__(self, spec: _Spec, given: Mapping[str, Any]) -> None:
        self.spec, self.given = spec, given
        self.inputs: dict[str, Any] = {}
        self.cell: Any = None
        self.degrees = _checks.truth(given.get("degrees", False), "degrees")

    def run(self) -> Result | dict[str, Any]:
        """What the command gives."""
        words = ["stiffarm", self.spec["name"]]
        for argument in self.spec["arguments"]:
            key = argument["name"]
            if self.given.get(key) is not None:
                words += self.words(argument, key, self.given[key])
            elif argument["required"] and key in self.given:
                needed = "A Cell" if key == "cell" else "A value"
                raise StiffarmError(f"{needed} is needed, got None.", "wrong-type", {"key": key})
        both = [self.given.get(key) is not None for key in ("folds", "stiffness")]
        if self.spec["name"] == "validate" and all(both):
            # A command line has measurements alone here.
            hint = "leave out the stiffness: each fold has its own, identified from the others"
            raise StiffarmError("With folds no stiffness is given.", "usage", {"key": "stiffness"}, hint)
        accept = self.given.get("accept")
        if accept is not None and not callable(accept):
            message = f"This must be a function, got {_checks.shown(accept)}."
            raise StiffarmError(message, "wrong-type", {"key": "accept"})
        with _inputs.Watching(self.given.get("progress")) as told:
            code, out, err, interrupted = _stiffarm.run([*words, "--json"], self.inputs, accept, told)
        return self.answer(code, out, err, interrupted)

    def answer(self, code: int, out: str, err: str, interrupted: bool) -> Result | dict[str, Any]:
        """The result, or what is wrong as an exception."""
        try:
            document = json.loads(out)
        except ValueError:
            raise StiffarmError((err or out).strip() or "The command printed nothing.", "internal") from None
        if "error" in document:
            raise _raised(document["error"])
        if "result" not in document:
            return dict(document)
        found = result_of(out, document, interrupted or code == 130, self.cell)
        if found.interrupted:
            warnings.warn("Stopped by Ctrl-C: this is the best so far.", StiffarmWarning, stacklevel=4)
        return found

    def words(self, argument: _Spec, key: str, value: Any) -> list[str]:
        """A value as words of the command line."""
        option = argument["option"]
        if argument["kind"] == "flag":
            return [f"--{option}"] if _checks.truth(value, key) else []
        if argument["bare"] and (value is True or value is False):
            return [f"--{option}"] if value else []
        texts = self.texts(argument, key, value)
        return texts if option is None else [f"--{option}={text}" for text in texts]

    def texts(self, argument: _Spec, key: str, value: Any) -> list[str]:
        kind, several = argument["kind"], argument["several"]
        if kind == "input":
            return self.files(key, value) if several else [self.file(key, value, f"<{key}>")]
        if kind == "numbers":
            return [",".join(map(repr, _checks.array(value, key).reshape(-1).tolist()))]
        if several:
            return [_plain(kind, one, key) for one in (_listed(value, key) or [value])]
        return [_plain(kind, value, key)]

    def file(self, key: str, value: Any, name: str) -> str:
        """The name of an input; what is no file is handed over under it."""
        if key == "cell" and isinstance(value, (str, os.PathLike)):
            value = Cell(value)
        if isinstance(value, Cell):
            self.cell, native = value, value._native
            known = str(native.name)
            while self.inputs.setdefault(known, native) is not native:
                # Another cell of the same name.
                known = f"<{known}>"
            return known
        if key == "cell":
            raise _native_cell.no_cell(value, key)
        if isinstance(value, (str, os.PathLike)):
            path = _checks.path(value, key)
            # A name with a dash in front would be an option.
            return os.path.join(os.curdir, path) if path.startswith("-") and path != "-" else path
        self.inputs[name] = _inputs.contents(key, value, self.degrees, self.cell)
        return name

    def files(self, key: str, value: Any) -> list[str]:
        """Names of several inputs, of one, or of several by name."""
        if key != "postures":
            listed = value if isinstance(value, (list, tuple)) else [value]
            single = f"<{key}>" if len(listed) == 1 else ""
            return [self.file(key, one, single or f"<{key} {i}>") for i, one in enumerate(listed, 1)]
        out = []
        for number, (name, one) in enumerate(_inputs.groups(value), 1):
            if name and isinstance(one, (str, os.PathLike)):
                one = _inputs.named(one, self.cell)
            # The command takes the name of the group from that of the file, or what stands behind builtin: as it is.
            name = name.removeprefix("builtin:")
            is_plain = Path(f"{name}.csv").name == f"{name}.csv"
            out.append(self.file(key, one, f"<postures {number}>/{name}.csv" if is_plain else f"builtin:{name}"))
        return out


def _plain(kind: str, value: Any, key: str) -> str:
    """A single value as a word."""
    if kind == "whole":
        return str(_checks.whole(value, key))
    if kind == "number":
        return repr(_checks.number(value, key))
    if kind == "path" or isinstance(value, (str, os.PathLike)):
        return _checks.path(value, key)
    numbers = [_checks.number(one, key) for one in _listed(value, key) or [value]]
    return ",".join(str(int(one)) if one == int(one) else repr(one) for one in numbers)


def _listed(value: Any, key: str) -> list[Any] | None:
    """The values of a list, not an empty one; none of what is one value."""
    if isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__") or getattr(value, "ndim", 1) == 0:
        return None
    found = [] if isinstance(value, (bytes, Mapping)) else list(value)
    if not found:
        raise StiffarmError(f"This must be a value or several, got {_checks.shown(value)}.", "wrong-type", {"key": key})
    return found


_OPTION = re.compile(r"--([a-z][a-z0-9-]*)")


def _raised(error: Mapping[str, Any]) -> BaseException:
    """The error of a command as an exception; what it calls options are keywords here."""
    if error["code"] == "interrupted":
        return KeyboardInterrupt(error["message"])

    def said(text: str) -> str:
        return _OPTION.sub(lambda found: _keyword(found[1]), text)

    place = {key: error[key] for key in ("file", "line", "column", "key") if error[key] is not None}
    if "key" in place:
        place["key"] = said(place["key"])
    elif error["code"] == "usage" and (found := _OPTION.search(error["message"])):
        place["key"] = _keyword(found[1])
    hint, message = error["hint"], said(error["message"])
    if error["code"] == "usage":
        # The parser of the command line writes neither sentences nor, below them, what helps here.
        message = message[:1].upper() + message[1:] + ("" if message.endswith((".", "?")) else ".")
        hint = None if hint is None or hint.startswith("Usage: ") else hint.removeprefix("tip: ")
    return StiffarmError(message, error["code"], place, said(hint) if hint else None)
