"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from . import _checks
from ._errors import StiffarmError


def write_file(to: str | os.PathLike[str], contents: str | bytes, *, overwrite: bool) -> Path:
    """Writes a file by a temporary name in its folder, so that there is never half of it."""
    path = Path(_checks.path(to))
    place = {"file": os.fspath(path)}
    if path.exists() and not overwrite:
        raise StiffarmError("The file exists.", "file-exists", place, hint="overwrite=True")
    name = ""
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as out:
            name = out.name
            out.write(contents.encode() if isinstance(contents, str) else contents)
        # A temporary file is its owner's alone; a result is like any other file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    except OSError as error:
        if name and os.path.exists(name):
            os.unlink(name)
        raise StiffarmError(f"The file cannot be written: {error.strerror}.", "file-write", place) from None
    return path
