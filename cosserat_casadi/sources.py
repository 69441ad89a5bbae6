"""The sources of the package as they lie on the disk: whether this process runs them, and a hash of them."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

ENDINGS = {".py", ".in", ".c", ".h", ".toml", ".json"}
"""Ends of the names of the files that decide on the results of the package."""


def sources_hash(folder: Path | None = None) -> str | None:
    """A hash of the sources of the package.

    Args:
        folder: with the sources; by default that of the package.

    Returns:
        None where a file has changed since the package was imported, or where there are no files.
    """
    root = folder or Path(__file__).parent
    # The package's own module stands above all others, so that none imports it.
    imported = sys.modules[__package__ or ""].IMPORTED
    digest = hashlib.sha256()
    files = sorted(path for path in root.rglob("*") if path.suffix in ENDINGS)
    for path in files:
        facts = path.stat()
        # A file that is moved or linked into place keeps its own time; that of its entry in the folder changes.
        if max(facts.st_mtime, facts.st_ctime) >= imported:
            return None
        content = path.read_bytes()
        digest.update(f"{path.relative_to(root).as_posix()}\0{len(content)}\0".encode() + content)
    return digest.hexdigest() if files else None
