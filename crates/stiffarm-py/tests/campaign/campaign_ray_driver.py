"""Runs a campaign on a Ray that is there before: python campaign_ray_driver.py CAMPAIGN FOLDER."""

from __future__ import annotations

import os
import sys

from stiffarm.campaign import Campaign

if __name__ == "__main__":
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    import ray

    ray.init(
        address="local",
        num_cpus=2,
        include_dashboard=False,
        log_to_driver=False,
        logging_level="ERROR",
        object_store_memory=100_000_000,
    )
    campaign = Campaign.read(sys.argv[1])
    outcome = campaign.run(sys.argv[2], workers=2, progress=False)
    print(f"{outcome.done} of {outcome.total} items, {outcome.failed} failed")
    ray.shutdown()
