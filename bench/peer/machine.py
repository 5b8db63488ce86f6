"""The machine and the versions of a record."""

import importlib.metadata
import os
import platform
import subprocess
from pathlib import Path

from .cell import ROOT

PACKAGES = ("numpy", "scipy", "pin", "jax", "jaxlib", "matplotlib")


def describe(cores):
    """What a reader needs to judge rates: processor, cores, system, load at the start."""
    system = platform.system().lower()
    machine = platform.machine()
    return {
        "kind": f"{len(cores)}-core-{machine}-{system}".replace(" ", "-"),
        "processor": processor(),
        "cores_used": len(cores),
        "cores_present": os.cpu_count(),
        "pinned": hasattr(os, "sched_setaffinity"),
        "system": operating_system(),
        "load_at_start": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def processor():
    """Model of the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    if platform.system() == "Darwin":
        return output_of("sysctl", "-n", "machdep.cpu.brand_string") or platform.processor()
    return platform.processor() or "unknown"


def operating_system():
    """Name and kernel of the system."""
    try:
        name = platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.platform()
    return f"{name}, {platform.system()} {platform.release()}"


def versions():
    """Versions of everything that was timed."""
    found = {"Python": platform.python_version()}
    for package in PACKAGES:
        found[package] = importlib.metadata.version(package)
    found["rustc"] = (output_of("rustc", "--version") or "not found").removeprefix("rustc ")
    commit = output_of("git", "rev-parse", "--short=12", "HEAD")
    if commit:
        changed = output_of("git", "status", "--porcelain", "--untracked-files=no")
        found["stiffarm commit"] = f"{commit}, with local changes" if changed else commit
    return found


def output_of(*command):
    """First line a command prints, None where it fails."""
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip().split("\n")[0]
