"""The command ``python -m stiffarm.campaign``: run, status, summary.

Exit codes: 0 done, 1 done but items failed, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from datetime import timedelta
from pathlib import Path

from .._errors import StiffarmError
from .campaign import JOURNAL, Campaign, open_folder
from .journal import Journal


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m stiffarm.campaign",
        description="Runs a grid of items into a table, on one machine or on a Ray cluster.",
        epilog="Exit codes: 0 done, 1 done but items failed, 2 bad input, 130 interrupted.",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    run = commands.add_parser("run", help="run what is not done yet")
    run.add_argument("campaign", type=Path, help="the campaign, a TOML file")
    run.add_argument("folder", type=Path, help="folder of the results; made if missing")
    words = "worker processes, or all: one for each processor of the machine or cluster [default: 1]"
    run.add_argument("--workers", type=_workers, default=1, metavar="N", help=words)
    run.add_argument("--address", metavar="HOST", help="address of a Ray cluster [default: this machine, without Ray]")
    run.add_argument("--time-limit-s", type=float, metavar="S", help="longest time of an item [s]")
    run.add_argument("--retry-failed", action="store_true", help="also run again what failed")
    run.add_argument("-q", "--quiet", action="store_true", help="no progress")
    status = commands.add_parser("status", help="how far a folder is")
    status.add_argument("folder", type=Path)
    summary = commands.add_parser("summary", help="counts, failures and figures of a folder")
    summary.add_argument("folder", type=Path)
    return parser


def _workers(word: str) -> int | str:
    return int(word) if word.lstrip("-").isdigit() else word


def _run(arguments: argparse.Namespace) -> int:
    outcome = Campaign.read(arguments.campaign).run(
        arguments.folder,
        workers=arguments.workers,
        address=arguments.address,
        time_limit_s=arguments.time_limit_s,
        progress=False if arguments.quiet else None,
        retry_failed=arguments.retry_failed,
    )
    text = f"{outcome.done} of {outcome.total} items, {outcome.failed} failed: {outcome.results}"
    print(f"Interrupted. {text}" if outcome.interrupted else text)
    return 130 if outcome.interrupted else int(outcome.failed > 0)


def _status(arguments: argparse.Namespace) -> int:
    campaign = open_folder(arguments.folder)
    path = arguments.folder / JOURNAL
    if not path.exists():
        print(f"{campaign.name}: 0 of {len(campaign)} items")
        return 0
    with Journal(path, len(campaign), writable=False) as journal:
        own = [record.get("own_s", 0.0) for record in journal.records()]
        print(f"{campaign.name}: {len(journal)} of {len(campaign)} items, {len(journal.failed)} failed")
    left = len(campaign) - len(own)
    if own and left:
        rest = timedelta(seconds=round(sum(own) / len(own) * left))
        print(f"{left} left, about {rest} on one worker")
    return 0


def _summary(arguments: argparse.Namespace) -> int:
    print(open_folder(arguments.folder).summary())
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command and returns its exit code."""
    parsed = _parser().parse_args(arguments)
    command = {"run": _run, "status": _status, "summary": _summary}[parsed.command]
    try:
        return command(parsed)
    except StiffarmError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
