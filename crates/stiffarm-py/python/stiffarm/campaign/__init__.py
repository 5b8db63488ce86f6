"""Campaigns: a declared grid of items, run on one machine or on a Ray cluster into one table.

>>> from stiffarm.campaign import Campaign
>>> campaign = Campaign.read("campaign.toml")            # doctest: +SKIP
>>> outcome = campaign.run("results", workers=2)          # doctest: +SKIP
>>> print(campaign.summary())                             # doctest: +SKIP

The folder holds ``results.parquet`` (one row for each item, with equal bytes whatever ran it), ``timings.parquet``,
``journal.jsonl`` (each item as it was done; what a stopped run is resumed from) and ``campaign.json``.
"""

from __future__ import annotations

from .campaign import Campaign, Outcome, open_folder
from .declaration import Declaration
from .errors import CampaignError
from .items import Item, Items
from .progress import Progress
from .summary import Summary

__all__ = ["Campaign", "CampaignError", "Declaration", "Item", "Items", "Outcome", "Progress", "Summary", "open_folder"]
