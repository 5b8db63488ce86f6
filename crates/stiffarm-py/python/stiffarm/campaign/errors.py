"""The error of campaigns, and the loading of packages that need not be there."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

INSTALL = 'pip install "stiffarm[campaign]"'


class CampaignError(Exception):
    """A campaign that cannot be read, started or resumed.

    What goes wrong inside one item is not an error of the campaign: it is a row of its table.

    Attributes:
        code: Stable name of what is wrong, for example ``unknown_key``.
        message: One sentence.
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
        super().__init__(message)
        self.code = code
        self.message = message
        self.place: dict[str, Any] = dict(place or {})
        self.hint = hint

    def __str__(self) -> str:
        where = ", ".join(str(part) for part in self.place.values())
        text = f"{where}: {self.message}" if where else self.message
        return f"{text} {self.hint}" if self.hint else text

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
        CampaignError: ``missing_package`` where it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        raise CampaignError(
            "missing_package",
            f"{wanted_for} needs the package {package}, which cannot be imported here ({error}).",
            hint=f"{INSTALL} installs it.",
        ) from error
