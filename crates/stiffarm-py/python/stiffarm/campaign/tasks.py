"""Tasks by name: the four built-in ones and functions of one's own."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from .._errors import nearest
from . import built_in
from .errors import CampaignError
from .task import BadResult, Task
from .values import Value, digest

_HERE = {"key": "task"}
_OWN = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*\Z")


def task_of(name: str) -> Task:
    """The task of that name.

    Args:
        name: ``select``, ``simulate``, ``coverage``, ``identify``, or ``module:function`` for a function that can be
            imported. It is called with the values of the axes and the options as keyword arguments and returns a dict
            of figures.

    Raises:
        CampaignError: ``unknown-name``, or ``bad-task`` where the function cannot be imported.
    """
    if name in built_in.ALL:
        return built_in.ALL[name]
    if not _OWN.match(name):
        known = f"Known: {', '.join(built_in.ALL)}, and your own as module:function."
        hint = nearest(name, built_in.ALL) or known
        raise CampaignError(f"There is no task {name!r}.", "unknown-name", _HERE, hint)
    function = _imported(name)
    return Task(
        name=name,
        run=lambda values, options, shared: _run(function, values, options),
        check=lambda axes, options: _check(function, axes, options),
        headline=tuple(getattr(function, "headline", ())),
        source=_source(function),
    )


def _imported(name: str) -> Callable[..., Any]:
    module_name, _, function_name = name.partition(":")
    if module_name == "__main__":
        message = "A function of the script itself cannot be imported by the workers."
        raise CampaignError(message, "bad-task", _HERE, "Put it into a module beside the script.")
    try:
        function = getattr(importlib.import_module(module_name), function_name)
    except (ImportError, AttributeError) as error:
        hint = "The module must be on the path of the workers, for example by PYTHONPATH."
        raise CampaignError(f"{name} cannot be imported ({error}).", "bad-task", _HERE, hint) from error
    if not callable(function):
        raise CampaignError(f"{name} is no function.", "bad-task", _HERE)
    return function  # type: ignore[no-any-return]


def _check(function: Callable[..., Any], axes: Mapping[str, Any], options: Mapping[str, Any]) -> None:
    for name in axes:
        if name in options:
            raise CampaignError(f"{name} is an axis and an option.", "bad-task", {"key": f"options.{name}"})
    try:
        inspect.signature(function).bind(**dict.fromkeys(axes), **options)
    except TypeError as error:
        message = f"The function does not take these axes and options: {error}."
        raise CampaignError(message, "bad-task", _HERE) from error
    except ValueError:
        # Functions written in C may have no signature.
        return


def _run(function: Callable[..., Any], values: Mapping[str, Value], options: Mapping[str, Any]) -> Mapping[str, Any]:
    figures = function(**values, **options)
    if not isinstance(figures, Mapping):
        raise BadResult(f"The task returned {type(figures).__name__}, not a dict.")
    return figures


def _source(function: Callable[..., Any]) -> str | None:
    try:
        path = inspect.getsourcefile(function)
        return digest(Path(path).read_bytes()) if path else None
    except (OSError, TypeError):
        return None
