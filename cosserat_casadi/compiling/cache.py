"""Cache of compiled libraries and their texts, by names with a hash of their origin and a hash of their content.

The first hash covers everything from which a file is made: the C sources of a library, or the model and the options of
texts in C. The second one reveals a file that was truncated or overwritten, for example by a full disk, before it is
loaded: to load such a library could end the process.

Beyond a limit the least recently used files are removed, but none that was used in the last hour. Processes may use the
cache at once, as a file appears complete or not at all.
"""

from __future__ import annotations

import atexit
import hashlib
import json
import os
import platform
import re
import shutil
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from cosserat_casadi.compiling.description import key_of
from cosserat_casadi.errors import WriteError
from cosserat_casadi.files import sources_hash, write_atomically

VARIABLE = "COSSERAT_CASADI_CACHE"
"""Environment variable that names the folder; ``off`` keeps nothing beyond the end of the process."""

OFF = "off"

BASES = {"win32": "LOCALAPPDATA", "darwin": ""}
"""Environment variable that names the folder of caches, by platform; elsewhere it is XDG_CACHE_HOME."""

FOLDERS = {"win32": "AppData/Local", "darwin": "Library/Caches"}
"""The folder of caches in a user's home, by platform; elsewhere it is .cache."""

LIMIT = 500_000_000
"""Largest size of all files of the cache, bytes."""

MOST_TALLIED = 60_000
"""Largest size of a tally, bytes, of a millisecond each: nothing takes that long to compile."""

IN_USE = 3600.0
"""Time since its last use, s, for which a library is not removed, as a process may be about to load it."""

SCRATCH = "cosserat_casadi-compiling-"
"""Prefix of folders in which libraries are compiled."""

LIBRARY = ".so"
TEXTS = ".texts"
TALLY = ".tally"
"""Suffixes of libraries, of texts, and of tallies of the time spent without a library."""

OURS = re.compile(rf"\w+-[0-9a-f]{{20}}(-[0-9a-f]{{20}})?(\{LIBRARY}|\{TEXTS}|\{TALLY})")
"""Pattern of the names of files of the cache; libraries of earlier versions had no hash of their content.

Other files in the folder are never removed."""

ABANDONED = 86400.0
"""Time, s, after which the remains of a killed compilation are removed."""


def cache_folder() -> Path:
    """Return the folder of the cache: the one that the variable names, or the cache folder of the user's platform.

    For a user without a home it is a folder that is removed when the process ends.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen == OFF:
        return _folder_of_process()
    if chosen:
        return Path(chosen)
    named = os.environ.get(BASES.get(sys.platform, "XDG_CACHE_HOME"))
    if named:
        return Path(named) / "cosserat_casadi"
    try:
        home = Path.home()
    except RuntimeError:
        # The system does not know the user, as in a container: nobody else may write to our files.
        return _folder_of_process()
    return home / FOLDERS.get(sys.platform, ".cache") / "cosserat_casadi"


@cache
def _folder_of_process() -> Path:
    """Make a folder that is removed when the process ends."""
    folder = tempfile.mkdtemp(prefix="cosserat_casadi-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def file_name(stem: str, content: bytes, ending: str = LIBRARY) -> str:
    """Name of a library or of texts: a stem that identifies the origin, and a hash of the content."""
    return f"{stem}-{hashlib.sha256(content).hexdigest()[:20]}{ending}"


def kept_file(folder: Path, stem: str, ending: str = LIBRARY) -> Path | None:
    """Find a file of the folder with unchanged content; a file that has changed is removed.

    Args:
        folder: folder with the files.
        stem: prefix of the file name, which identifies the origin.
        ending: suffix of the file name.

    Returns:
        The file; None if the folder has no such file.
    """
    names = list[str]()
    # The folder may be missing, or not ours to read.
    # Names are compared as texts: a pattern takes milliseconds in a folder of thousands of files.
    with suppress(OSError), os.scandir(folder) as entries:
        names = [entry.name for entry in entries if entry.name.startswith(f"{stem}-") and entry.name.endswith(ending)]
    for name in sorted(names):
        file = folder / name
        try:
            if name == file_name(stem, file.read_bytes(), ending):
                return file
            file.unlink()
        except OSError:
            # Another process has removed it, or it is not ours to read.
            continue
    return None


def kept_texts(name: str, made_from: Sequence[Any], write: Callable[[], Mapping[str, str]]) -> dict[str, str]:
    """Return texts by file name, written once for a model and its options; later processes read them from the folder.

    Args:
        name: prefix of the name of their file in the folder.
        made_from: the model and all options on which the texts depend.
        write: function that writes the texts.
    """
    key = key_of(*made_from)
    kept = None if key is None else _texts_in_cache(f"{name}-{key}")
    if kept is not None:
        return kept
    written = dict(write())
    # Sources that changed meanwhile may have written parts of it.
    if key is not None and sources_hash() is not None:
        _keep_texts(cache_folder(), f"{name}-{key}", written)
    return written


def _texts_in_cache(stem: str) -> dict[str, str] | None:
    """Read the texts in the folder with a stem; None without them."""
    with suppress(OSError):
        kept = kept_file(cache_folder(), stem, TEXTS)
        if kept is not None:
            texts: dict[str, str] = json.loads(zlib.decompress(kept.read_bytes()))
            mark_used(kept)
            return texts
    return None


def _keep_texts(folder: Path, stem: str, texts: Mapping[str, str]) -> None:
    """Keep texts in the folder if it can be written to; otherwise they are used without it."""
    content = zlib.compress(json.dumps(texts).encode(), 1)
    with suppress(OSError, WriteError):
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / file_name(stem, content, TEXTS), content)
        keep_within(folder)


def tallied(stem: str | None) -> float:
    """Time that all processes have recorded under a stem, s; see :func:`tally`."""
    if stem is None:
        return 0.0
    with suppress(OSError):
        return 1e-3 * _tally_of(stem).stat().st_size
    return 0.0


def tally(stem: str | None, seconds: float) -> None:
    """Record time spent for want of a library, for later processes, as each process may be short.

    A byte stands for a millisecond, so that processes may append to the file at once. Without a stem nothing happens.
    """
    if stem is None:
        return
    file = _tally_of(stem)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("ab") as opened:
            left = max(MOST_TALLIED - opened.tell(), 0)
            opened.write(bytes(min(round(1e3 * seconds), left)))


def _tally_of(stem: str) -> Path:
    return cache_folder() / f"{stem}{TALLY}"


def content_hash(compiler: Sequence[str], flags: Sequence[str], contents: Iterable[bytes]) -> str:
    """Hash the sources and everything else on which a library depends.

    Args:
        compiler: words of its command. Programs among them are identified by their files, because to ask a compiler for
            its version would mean to run it.
        flags: flags of the compiler.
        contents: contents of the sources and of the files that they include.
    """
    programs = [_program_facts(word) for word in compiler]
    # The folder may lie in a home that machines of several kinds share.
    machine = [platform.system(), platform.machine()]
    words = [*compiler, *programs, *flags, *machine]
    digest = hashlib.sha256("\0".join(words).encode())
    for content in contents:
        digest.update(hashlib.sha256(content).digest())
    return digest.hexdigest()[:20]


def _program_facts(word: str) -> str:
    """Path, size and time of a program; an empty string for an option."""
    path = shutil.which(word)
    if path is None:
        return ""
    program = Path(path).resolve()
    with suppress(OSError):
        found = program.stat()
        return f"{program} {found.st_size} {found.st_mtime_ns}"
    return str(program)


def mark_used(file: Path) -> None:
    """Mark a file as used now."""
    with suppress(OSError):
        os.utime(file, ns=(time.time_ns(), file.stat().st_mtime_ns))


def keep_within(folder: Path, limit: int = LIMIT) -> None:
    """Remove the least recently used libraries and texts beyond a limit, and the remains of killed compilations.

    Args:
        folder: folder of the cache.
        limit: largest size of all files, bytes.
    """
    now = time.time()
    files: list[tuple[float, int, Path]] = []
    for path in folder.iterdir():
        # Another process may remove the listed files.
        with suppress(OSError):
            found = path.stat()
            if path.name.startswith(SCRATCH) and now - found.st_mtime > ABANDONED:
                shutil.rmtree(path, ignore_errors=True)
            elif OURS.fullmatch(path.name):
                files.append((found.st_atime, found.st_size, path))
    size = sum(size for _, size, _ in files)
    for used, own_size, path in sorted(files):
        if size <= limit or now - used < IN_USE:
            return
        with suppress(OSError):
            path.unlink()
            size -= own_size
