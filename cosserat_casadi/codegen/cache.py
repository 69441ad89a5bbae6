"""Where compiled libraries are kept: under names that hold a hash of all that they are made of.

The least recently used ones are removed beyond a limit, so that the folder never grows without bound. Processes may do
all this at once: a library appears whole or not at all, and one that was used in the last hour is not removed.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import platform
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path

VARIABLE = "COSSERAT_CASADI_CACHE"
"""Environment variable that names the folder; ``off`` keeps nothing beyond the end of the process."""

OFF = "off"

LIMIT = 500_000_000
"""Bytes of all libraries in the folder, beyond which some are removed."""

IN_USE = 3600.0
"""Seconds since its last use for which a library is not removed: a process may be about to load it."""

SCRATCH = "cosserat_casadi-compiling-"
"""How folders begin in which libraries are compiled."""

LIBRARY = re.compile(r"\w+-[0-9a-f]{20}\.so")
"""What libraries are called. Whatever else lies in the folder is not ours to remove."""

ABANDONED = 86400.0
"""Seconds after which what a killed compilation left is removed."""


def cache_folder() -> Path:
    """Where compiled libraries are kept: what the variable names, or the cache folder of the user's platform."""
    chosen = os.environ.get(VARIABLE)
    if chosen == OFF:
        return _folder_of_process()
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "cosserat_casadi"


@cache
def _folder_of_process() -> Path:
    """A folder that is removed when the process ends."""
    folder = tempfile.mkdtemp(prefix="cosserat_casadi-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def content_hash(compiler: str, flags: Sequence[str], contents: Iterable[bytes]) -> str:
    """A hash of sources and of all else that a library depends on.

    Args:
        compiler: path of the compiler. It is told by its file, since asking it for its version would mean to run it.
        flags: its flags.
        contents: of the sources and of what they include, each as in its file.
    """
    program = Path(compiler).resolve()
    with suppress(OSError):
        found = program.stat()
        flags = [*flags, str(found.st_size), str(found.st_mtime_ns)]
    # The folder may lie in a home that machines of several kinds share.
    machine = [platform.system(), platform.machine()]
    words = [version("cosserat-casadi"), compiler, str(program), *flags, *machine]
    digest = hashlib.sha256("\0".join(words).encode())
    for content in contents:
        digest.update(hashlib.sha256(content).digest())
    return digest.hexdigest()[:20]


def mark_used(library: Path) -> None:
    """Remember that a library is used now."""
    with suppress(OSError):
        os.utime(library, ns=(time.time_ns(), library.stat().st_mtime_ns))


def keep_within(folder: Path, limit: int = LIMIT) -> None:
    """Remove the least recently used libraries beyond a limit, and what killed compilations left.

    Args:
        folder: with the libraries.
        limit: bytes.
    """
    now = time.time()
    libraries: list[tuple[float, int, Path]] = []
    for path in folder.iterdir():
        # Another process may remove what is listed here.
        with suppress(OSError):
            found = path.stat()
            if path.name.startswith(SCRATCH) and now - found.st_mtime > ABANDONED:
                shutil.rmtree(path, ignore_errors=True)
            elif LIBRARY.fullmatch(path.name):
                libraries.append((found.st_atime, found.st_size, path))
    size = sum(size for _, size, _ in libraries)
    for used, own_size, path in sorted(libraries):
        if size <= limit or now - used < IN_USE:
            return
        with suppress(OSError):
            path.unlink()
            size -= own_size
