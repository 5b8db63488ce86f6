"""Tasks by name: the four built-in ones and functions of one's own.

A task turns the values of one item into figures: a flat dict of column name → value. Built-in
tasks import ``stiffarm`` when an item runs, not before, so that reading a campaign stays cheap.
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import built_in
from .errors import CampaignError, nearest
from .options import read_options
from .values import Value, digest

#: Columns that every table has; no axis and no figure may take their names.
COLUMNS = ("item", "id", "name", "status", "error_code", "error_message")
_OWN = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*\Z")


@dataclass(frozen=True)
class Task:
    """A task.

    Attributes:
        name: Its name in the declaration.
        axes: Axes it knows, or None where any name will do.
        headline: Figures that the summary shows first.
        read_options: Checks the options, given them and their place.
        check: Checks axes and options together, given them and their place.
        run: Values, options and shared data of an item → its figures.
        needs_cells: Whether the driver reads cells for it before it starts.
        sources: Hashes of what it is made of, by name, for the campaign's hash.
    """

    name: str
    axes: tuple[str, ...] | None
    headline: tuple[str, ...]
    read_options: Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]
    check: Callable[[Mapping[str, Any], Mapping[str, Any], Mapping[str, Any]], None]
    run: Callable[[Mapping[str, Value], Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]
    needs_cells: bool = True
    sources: Callable[[], dict[str, str]] = dict


def _built_in(parts: built_in.BuiltIn) -> Task:
    return Task(
        name=parts.name,
        axes=parts.axes,
        headline=parts.headline,
        read_options=lambda written, place: read_options(written, parts.options, place),
        check=parts.check,
        run=parts.run,
    )


REGISTRY: Mapping[str, Task] = {parts.name: _built_in(parts) for parts in built_in.ALL}


def task_of(name: str, place: Mapping[str, Any] | None = None) -> Task:
    """The task of that name.

    Args:
        name: ``select``, ``simulate``, ``coverage``, ``identify``, or ``module:function`` for a
            function that can be imported. It is called with the values of the axes and the
            options as keyword arguments and returns a dict of figures.
        place: Place of the declaration, for messages.

    Raises:
        CampaignError: ``unknown-name``, or ``bad-task`` where the function cannot be imported.
    """
    if name in REGISTRY:
        return REGISTRY[name]
    here = {**(place or {}), "key": "task"}
    if not _OWN.match(name):
        known = ", ".join(REGISTRY)
        raise CampaignError(
            "unknown-name",
            f"There is no task {name!r}.",
            place=here,
            hint=nearest(name, REGISTRY) or f"Known: {known}, and your own as module:function.",
        )
    function = _own_function(name, here)
    return Task(
        name=name,
        axes=None,
        headline=tuple(getattr(function, "headline", ())),
        read_options=lambda written, place: dict(written),
        check=lambda axes, options, place: _check_own(function, axes, options, place),
        run=lambda values, options, shared: _run_own(function, values, options),
        needs_cells=False,
        sources=lambda: _source(name, function),
    )


def _own_function(name: str, place: Mapping[str, Any]) -> Callable[..., Any]:
    module_name, _, function_name = name.partition(":")
    if module_name == "__main__":
        raise CampaignError(
            "bad-task",
            "A function of the script itself cannot be imported by the workers.",
            place=place,
            hint="Put it into a module beside the script.",
        )
    try:
        function = getattr(importlib.import_module(module_name), function_name)
    except (ImportError, AttributeError) as error:
        raise CampaignError(
            "bad-task",
            f"{name} cannot be imported ({error}).",
            place=place,
            hint="The module must be on the path of the workers, for example by PYTHONPATH.",
        ) from error
    if not callable(function):
        raise CampaignError("bad-task", f"{name} is no function.", place=place)
    return function  # type: ignore[no-any-return]


def _check_own(
    function: Callable[..., Any],
    axes: Mapping[str, Any],
    options: Mapping[str, Any],
    place: Mapping[str, Any],
) -> None:
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return
    both = sorted(set(axes) & set(options))
    if both:
        raise CampaignError(
            "bad-task", f"{both[0]} is an axis and an option.", place={**place, "key": f"options.{both[0]}"}
        )
    try:
        signature.bind(**{**dict.fromkeys(axes), **options})
    except TypeError as error:
        raise CampaignError(
            "bad-task",
            f"The function does not take these axes and options: {error}.",
            place={**place, "key": "task"},
        ) from error


def _run_own(
    function: Callable[..., Any], values: Mapping[str, Value], options: Mapping[str, Any]
) -> dict[str, Any]:
    figures = function(**values, **options)
    if not isinstance(figures, Mapping):
        raise built_in.BadResult(f"The task returned {type(figures).__name__}, not a dict.")
    return dict(figures)


def _source(name: str, function: Callable[..., Any]) -> dict[str, str]:
    try:
        path = inspect.getsourcefile(function)
        return {name: digest(Path(path).read_bytes())} if path else {}
    except (OSError, TypeError):
        return {}
