"""What pytest found, a line a test: `ok name`, `FAILED name: reason`, `SKIPPED name: reason`; last their numbers.

A plugin (`pytest -p counted`), so that `cargo xtask test` counts tests of Python as it counts its own.
"""

from __future__ import annotations

from typing import Any

counts = {"passed": 0, "failed": 0, "skipped": 0}


def pytest_runtest_logreport(report: Any) -> None:
    """A test has three reports; the call decides, and the other two where they do not pass."""
    name = report.nodeid.replace("\\", "/")
    # A test that was expected to fail and did says nothing bad; one that did not fail is a failure by `xfail_strict`.
    as_expected = report.outcome == "skipped" and hasattr(report, "wasxfail")
    if report.outcome == "failed":
        stage = "" if report.when == "call" else f" ({report.when})"
        tell("failed", f"FAILED {name}{stage}: {last_line(report.longrepr)}")
    elif as_expected or (report.outcome == "passed" and report.when == "call"):
        tell("passed", f"ok {name}")
    elif report.outcome == "skipped":
        tell("skipped", f"SKIPPED {name}: {reason_of(report.longrepr)}")


def pytest_collectreport(report: Any) -> None:
    """A file that cannot be imported is a failure, one that skips itself a skip."""
    name = report.nodeid.replace("\\", "/")
    if report.outcome == "failed":
        tell("failed", f"FAILED {name}: {last_line(report.longrepr)}")
    elif report.outcome == "skipped":
        tell("skipped", f"SKIPPED {name}: {reason_of(report.longrepr)}")


def pytest_report_teststatus(report: Any) -> tuple[str, str, str]:
    """pytest's own counts without its letters, which would stand before the lines."""
    if hasattr(report, "wasxfail"):
        kind = "xfailed" if report.outcome == "skipped" else "xpassed"
    elif report.when == "call" or report.outcome == "skipped":
        kind = report.outcome
    else:
        kind = "error" if report.outcome == "failed" else ""
    return kind, "", ""


def pytest_unconfigure() -> None:
    """The closing line, after everything that pytest prints."""
    print(f"pytest: {', '.join(f'{number} {what}' for what, number in counts.items())}", flush=True)


def tell(what: str, line: str) -> None:
    """Counts and prints one test."""
    counts[what] += 1
    print(line, flush=True)


def reason_of(longrepr: Any) -> str:
    """Why a test was skipped."""
    reason = longrepr[2] if isinstance(longrepr, tuple) else str(longrepr)
    return " ".join(reason.removeprefix("Skipped: ").split())


def last_line(longrepr: Any) -> str:
    """What a failure says last, which is most often the exception."""
    crash = getattr(longrepr, "reprcrash", None)
    lines = str(crash.message if crash else longrepr).strip().splitlines()
    line = (lines[0] if crash else lines[-1]) if lines else "no reason"
    return " ".join(line.split())
