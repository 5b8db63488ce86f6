"""Keys of results by class; a wheel has their types beside this file, made of the JSON Schemas of the command."""

from __future__ import annotations

from typing import Any

from ._record import Record


def __getattr__(name: str) -> Any:
    if not name.endswith("Keys"):
        raise AttributeError(name)
    return type(name, (Record,), {"__slots__": ()})
