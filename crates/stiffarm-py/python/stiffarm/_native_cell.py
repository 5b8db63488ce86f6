"""Cells of the extension module: of files, of keys, of what one has at hand. Robots and postures need no more of a cell."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _checks, _stiffarm
from ._errors import StiffarmError


def of_file(name: str) -> _stiffarm.Cell:
    """The cell of a cell file with the meshes beside it; ``builtin:NAME`` is a built-in one."""
    if name.startswith("builtin:"):
        return _stiffarm.Cell.built_in(name.removeprefix("builtin:"))
    try:
        text = Path(name).read_bytes()
    except OSError as error:
        raise StiffarmError(
            f"The file cannot be read: {error.strerror}.",
            "file-read",
            {"file": name},
            hint='Cell.built_in("comau") is built in',
        ) from None
    return _stiffarm.Cell(name, text, {}, str(Path(name).parent))


def of_keys(keys: Mapping[str, Any], folder: str | None = None) -> _stiffarm.Cell:
    """The cell of the keys of a cell file; ``format`` may be left out."""
    return _stiffarm.Cell("<dict>", toml({"format": 1, **keys}).encode(), {}, folder)


def of(value: Any) -> Any:
    """What the extension module has of a cell, or of the cell file of this name."""
    try:
        return value._native
    except AttributeError:
        if isinstance(value, (str, os.PathLike)):
            return of_file(_checks.path(value))
        raise no_cell(value, "cell") from None


def no_cell(value: Any, key: str) -> StiffarmError:
    """That this is no cell."""
    hint = f'stiffarm.Cell("{value}")' if isinstance(value, str) else 'stiffarm.Cell("cell.toml")'
    return StiffarmError(f"A Cell is needed, got {_checks.shown(value)}.", "wrong-type", {"key": key}, hint=hint)


def toml(keys: Mapping[str, Any]) -> str:
    """The text of a cell file."""
    try:
        return _stiffarm.toml_of_json(json.dumps(plain(keys)))
    except TypeError as error:
        hint = "values are text, numbers, true, false, lists and dictionaries"
        raise StiffarmError(f"A cell file cannot hold this: {error}.", "wrong-type", hint=hint) from None


def plain(value: Any) -> Any:
    """Numbers, lists and dictionaries as JSON has them."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return value
