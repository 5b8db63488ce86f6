"""Runs a campaign on a Ray cluster here that loses a node: python campaign_cluster_driver.py CAMPAIGN FOLDER...

There are as many nodes with a processor as folders. In each run one goes when a few items are done, and none takes its
place; in the last it is the only one that is left.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from pathlib import Path
from typing import Any

from stiffarm.campaign import Campaign, CampaignError, engines

if __name__ == "__main__":
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    # A node that is gone is noticed in seconds, not in half a minute.
    os.environ["RAY_health_check_period_ms"] = "500"
    os.environ["RAY_health_check_failure_threshold"] = "3"
    from ray.cluster_utils import Cluster

    folders = [Path(word) for word in sys.argv[2:]]
    memory = {"object_store_memory": 100_000_000}
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, **memory})
    nodes = [cluster.add_node(num_cpus=1, **memory) for _ in folders]
    engines.WAIT_S = 1.0

    def go(folder: Path, node: Any) -> None:
        journal = folder / "journal.jsonl"
        while not journal.exists() or journal.read_bytes().count(b"\n") < 6:
            time.sleep(0.05)
        cluster.remove_node(node, allow_graceful=False)

    try:
        for folder, node in zip(folders, nodes):
            going = threading.Thread(target=go, args=(folder, node), daemon=True)
            going.start()
            try:
                outcome = Campaign.read(sys.argv[1]).run(folder, workers="all", address=cluster.address, progress=False)
                print(f"{outcome.done} of {outcome.total} items, {outcome.failed} failed")
            except CampaignError as error:
                print(error)
            going.join()
    finally:
        cluster.shutdown()
