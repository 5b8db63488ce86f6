"""Runs a campaign on a Ray cluster of two nodes here, of which one goes: python campaign_cluster_driver.py CAMPAIGN FOLDER ALONE.

The second node goes when a few items are done, and none takes its place. With ``alone`` it was the only one with
processors.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from pathlib import Path

from stiffarm.campaign import Campaign, CampaignError, engines

if __name__ == "__main__":
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    # A node that is gone is noticed in seconds, not in half a minute.
    os.environ["RAY_health_check_period_ms"] = "500"
    os.environ["RAY_health_check_failure_threshold"] = "3"
    from ray.cluster_utils import Cluster

    folder, alone = Path(sys.argv[2]), sys.argv[3] == "alone"
    memory = {"object_store_memory": 100_000_000}
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0 if alone else 1, **memory})
    other = cluster.add_node(num_cpus=1, **memory)

    def go() -> None:
        journal = folder / "journal.jsonl"
        while not journal.exists() or journal.read_bytes().count(b"\n") < 6:
            time.sleep(0.05)
        cluster.remove_node(other, allow_graceful=False)

    threading.Thread(target=go, daemon=True).start()
    if alone:
        engines.WAIT_S = 3.0
    try:
        outcome = Campaign.read(sys.argv[1]).run(folder, workers="all", address=cluster.address, progress=False)
        print(f"{outcome.done} of {outcome.total} items, {outcome.failed} failed")
    except CampaignError as error:
        print(error)
    finally:
        cluster.shutdown()
