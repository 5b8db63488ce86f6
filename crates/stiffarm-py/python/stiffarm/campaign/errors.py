"""The error of campaigns, and the loading of packages that need not be there."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from typing import Any

from .._errors import StiffarmError, nearest

INSTALL = 'pip install "stiffarm[campaign]"'


class CampaignError(StiffarmError):
    """A campaign that cannot be read, started or resumed.

    What goes wrong inside one item is not an error of the campaign: it is a row of its table.
    """


def at(place: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The place of a key."""
    return {**place, "key": key}


def unknown_key(
    name: str, known: Iterable[str], place: Mapping[str, Any], above: str = "", hint: str | None = None
) -> CampaignError:
    """The error of a key that nothing reads, with the nearest one that something does."""
    known = list(known)
    hint = hint or nearest(name, known) or f"Known here: {', '.join(known)}."
    key = f"{above}.{name}" if above else name
    return CampaignError(f"{name!r} is not known here.", "unknown-key", at(place, key), hint)


def load(name: str, wanted_for: str) -> Any:
    """The package ``name``, imported when it is needed and not before.

    Args:
        name: Import name, for example ``pyarrow``.
        wanted_for: What needs it, the subject of the message.

    Raises:
        CampaignError: ``missing-package`` where it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        message = f"{wanted_for} needs the package {name.partition('.')[0]}, which cannot be imported here ({error})."
        raise CampaignError(message, "missing-package", hint=f"{INSTALL} installs it.") from error
