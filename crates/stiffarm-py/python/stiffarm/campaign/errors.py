"""The error of campaigns, and the loading of packages that need not be there."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from .._errors import StiffarmError, nearest

__all__ = ["INSTALL", "CampaignError", "StiffarmError", "load", "nearest"]

INSTALL = 'pip install "stiffarm[campaign]"'


class CampaignError(StiffarmError):
    """A campaign that cannot be read, started or resumed.

    What goes wrong inside one item is not an error of the campaign: it is a row of its table.

    Attributes:
        message: One sentence, without place and hint.
        code: Stable name of what is wrong, for example ``unknown-key``.
        place: Where, for example ``{"file": "campaign.toml", "key": "axes.seed"}``.
        hint: What to do about it, or None.
    """

    def __init__(
        self,
        code: str,
        message: str,
        *,
        place: Mapping[str, Any] | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message, code, dict(place or {}), hint)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.code, self.message, self.place, self.hint)


def _again(
    code: str, message: str, place: Mapping[str, Any], hint: str | None
) -> CampaignError:
    return CampaignError(code, message, place=place, hint=hint)


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
        package = name.partition(".")[0]
        raise CampaignError(
            "missing-package",
            f"{wanted_for} needs the package {package}, which cannot be imported here ({error}).",
            hint=f"{INSTALL} installs it.",
        ) from error
