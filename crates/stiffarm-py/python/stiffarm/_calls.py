"""Calls as text: what a result says about how it was made, and the options that make it again."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

#: Parameters of each function whose results say how they were made; they come here where they are checked.
FUNCTIONS: dict[str, Mapping[str, inspect.Parameter]] = {}
#: Parameters that are inputs, by their annotation: a result names them and holds their hashes, not their values.
_INPUTS = re.compile("Cell|PosturesLike|TableLike|PathLike")
#: Parameters that are functions.
_FUNCTIONS = re.compile("Progress|Callable")


def text(name: str, parameters: Mapping[str, inspect.Parameter], given: Mapping[str, Any]) -> str:
    """``stiffarm.select(cell, postures=3)``: inputs by the names of their parameters, options that are not the default."""
    words: list[str] = []
    for key, value in given.items():
        parameter = parameters[key]
        annotation = str(parameter.annotation)
        if annotation == "Progress":
            continue
        is_input = _INPUTS.search(annotation) is not None
        written = (_input(value) if is_input else _option(value)) or key
        if parameter.default is not parameter.empty and written == _option(_listed(parameter.default)):
            continue
        words.append(written if is_input and parameter.default is parameter.empty else f"{key}={written}")
    return f"stiffarm.{name}({', '.join(words)})"


def options(call: str) -> dict[str, Any] | None:
    """Options of a call of :func:`text`, defaults included; None where the text is none of the package's functions."""
    try:
        found = ast.parse(call, mode="eval").body
        if not isinstance(found, ast.Call) or not isinstance(found.func, ast.Attribute):
            return None
        parameters = FUNCTIONS[found.func.attr]
        written = {keyword.arg: keyword.value for keyword in found.keywords}
        known = {
            key: ast.literal_eval(written[key]) if key in written else _listed(parameter.default)
            for key, parameter in parameters.items()
            if not _INPUTS.search(str(parameter.annotation)) and not _FUNCTIONS.search(str(parameter.annotation))
        }
    except (SyntaxError, ValueError, KeyError):
        return None
    return known


def _listed(default: Any) -> Any:
    """A default; lists are tuples where they are one, so that nobody can change them."""
    return list(default) if isinstance(default, tuple) else default


def _input(value: Any) -> str | None:
    """A table that is built in, the prior, none: what is the same wherever it stands."""
    several = value if isinstance(value, list) and value else [value]
    is_same = all(isinstance(one, str) and (one == "prior" or one.startswith("builtin:")) for one in several)
    return repr(value) if is_same or value is None else None


def _option(value: Any) -> str | None:
    """Numbers, names and lists of them."""
    plain = value if isinstance(value, (list, tuple)) or np.ndim(value) == 0 else np.asarray(value)
    plain = plain.tolist() if isinstance(plain, (np.ndarray, np.generic)) else plain
    written = repr(plain)
    try:
        ast.literal_eval(written)
    except (SyntaxError, ValueError):
        # Lists of NumPy's numbers; a function has no text.
        return None if callable(value) else repr(np.asarray(value).tolist())
    return written
