"""Notes the newest versions of what wanted.txt names: `python3.11 renew.py` writes python3.11.txt beside it.

Run it with every Python that has such a file, then `cargo xtask python`, and keep both in one commit.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

# Parts of Pinocchio, and of the keyring that twine asks: not everywhere.
UNIX = ("cmeel", "coal", "eigenpy", "libcoal", "libpinocchio", "pin==")
LINUX = ("jeepney", "secretstorage")


def where(pin: str) -> str:
    """The pin with the systems that have it."""
    name = pin.lower()
    if name.startswith(UNIX):
        return f'{pin}; sys_platform != "win32"'
    return f'{pin}; sys_platform == "linux"' if name.startswith(LINUX) else pin


def main() -> None:
    """Asks pip what it would install into an empty environment."""
    folder = Path(__file__).resolve().parent
    version = "{}.{}".format(*sys.version_info)
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([sys.executable, "-m", "venv", scratch], check=True)
        pip = [Path(scratch) / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python"), "-m", "pip"]
        # The pip that a Python brings may need very long to find versions that suit each other.
        subprocess.run([*pip, "install", "--quiet", "--upgrade", "pip"], check=True)
        ask = [*pip, "install", "--quiet", "--dry-run", "--ignore-installed", "--report", "-"]
        said = subprocess.run([*ask, "--requirement", folder / "wanted.txt"], check=True, stdout=subprocess.PIPE)
    chosen = [item["metadata"] for item in json.loads(said.stdout)["install"]]
    pins = sorted((f"{of['name']}=={of['version']}" for of in chosen), key=str.lower)
    write(folder / f"python{version}.txt", version, pins)


def write(path: Path, version: str, pins: list[str]) -> None:
    """One file."""
    head = f"# Versions of wanted.txt on Python {version}, all with wheels. Renewed by `python{version} renew.py`."
    lines = [head, "--only-binary :all:", *map(where, pins)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
