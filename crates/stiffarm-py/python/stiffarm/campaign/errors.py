"""The error of campaigns, and the loading of packages that need not be there."""

from __future__ import annotations

import importlib
from typing import Any

from .._errors import StiffarmError

INSTALL = 'pip install "stiffarm[campaign]"'


class CampaignError(StiffarmError):
    """A campaign that cannot be read, started or resumed.

    What goes wrong inside one item is not an error of the campaign: it is a row of its table.
    """


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
