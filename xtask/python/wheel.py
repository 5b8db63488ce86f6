"""Puts a wheel together from the checkout and the extension module that cargo has built with everything else.

    python wheel.py PACKAGE MODULE COMMAND OUT

The types of what the package makes when it runs are written of what COMMAND says (``generate.py``). maturin writes what a
wheel says of itself; building by maturin would compile the library a second time, because of
other features of its dependencies. The workflow builds and tries what is published.
"""

import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import zipfile


def main():
    package, module, command, out = map(pathlib.Path, sys.argv[1:])
    environment = {**os.environ, "STIFFARM_COMMAND": str(command)}
    # Beside the code, where checkers of types look too; git ignores them.
    types = package / "python" / "stiffarm"
    subprocess.run([sys.executable, package / "generate.py", types], env=environment, check=True)
    maturin = [sys.executable, "-m", "maturin", "pep517", "write-dist-info", "--interpreter", sys.executable]
    subprocess.run([*maturin, "--metadata-directory", out], cwd=package, check=True, stdout=subprocess.DEVNULL)
    (info,) = out.glob("*.dist-info")
    source = package / "python"
    files = {path.relative_to(source): path for path in source.rglob("*") if path.suffix in (".py", ".pyi", ".typed")}
    files |= {path.relative_to(out): path for path in info.rglob("*") if path.is_file()}
    ending = "pyd" if module.suffix == ".dll" else "abi3.so"
    files[pathlib.Path(f"stiffarm/_stiffarm.{ending}")] = module
    name, version = info.name.removesuffix(".dist-info").split("-")
    (tag,) = [line.split()[1] for line in (info / "WHEEL").read_text().splitlines() if line.startswith("Tag: ")]
    record = []
    with zipfile.ZipFile(out / f"{name}-{version}-{tag}.whl", "w") as wheel:
        # Without the time: the same files are the same wheel, which is installed once.
        def add(path, content):
            entry = zipfile.ZipInfo(path)
            entry.external_attr = 0o644 << 16
            wheel.writestr(entry, content, zipfile.ZIP_DEFLATED, 1)

        for path, place in sorted(files.items()):
            content = place.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path.as_posix()},sha256={digest},{len(content)}\n")
            add(path.as_posix(), content)
        add(f"{info.name}/RECORD", "".join(record) + f"{info.name}/RECORD,,\n")


if __name__ == "__main__":
    main()
