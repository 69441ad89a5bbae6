"""Where compiled libraries and their texts are kept: under names that hold a hash of their origin, and one of content.

The first is of all that a file is made of: of a library its sources in C, of texts in C the model and the options that
they are written for. The second tells a file that was cut off or written over, as by a full disk, before it is loaded:
loading such a library could end the process.

The least recently used files are removed beyond a limit, so that the folder never grows without bound. Processes may do
all this at once: a file appears whole or not at all, and one that was used in the last hour is not removed.
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
"""Bytes of all files of ours in the folder, beyond which some are removed."""

MOST_TALLIED = 60_000
"""Bytes of a tally, a millisecond each: nothing takes that long to compile."""

IN_USE = 3600.0
"""Seconds since its last use for which a library is not removed: a process may be about to load it."""

SCRATCH = "cosserat_casadi-compiling-"
"""How folders begin in which libraries are compiled."""

LIBRARY = ".so"
TEXTS = ".texts"
TALLY = ".tally"
"""Ends of the names of libraries, of texts, and of tallies of the time that went without a library."""

OURS = re.compile(rf"\w+-[0-9a-f]{{20}}(-[0-9a-f]{{20}})?(\{LIBRARY}|\{TEXTS}|\{TALLY})")
"""Names of files of the cache; libraries of earlier versions had no hash of their content.

Whatever else lies in the folder is not ours to remove."""

ABANDONED = 86400.0
"""Seconds after which what a killed compilation left is removed."""


def cache_folder() -> Path:
    """Where compiled libraries are kept: what the variable names, or the cache folder of the user's platform.

    Of a user who has no home it is a folder that is removed when the process ends.
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
        # The user is not known to the system, as in a container: nobody else may write to what is made for us.
        return _folder_of_process()
    return home / FOLDERS.get(sys.platform, ".cache") / "cosserat_casadi"


@cache
def _folder_of_process() -> Path:
    """A folder that is removed when the process ends."""
    folder = tempfile.mkdtemp(prefix="cosserat_casadi-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def file_name(stem: str, content: bytes, ending: str = LIBRARY) -> str:
    """Name of a library or of texts: a stem that tells the origin, and a hash of the content."""
    return f"{stem}-{hashlib.sha256(content).hexdigest()[:20]}{ending}"


def kept_file(folder: Path, stem: str, ending: str = LIBRARY) -> Path | None:
    """A file of the folder, its content as it was written; one that has changed since is removed.

    Args:
        folder: with the files.
        stem: what the name of the file begins with: it tells the origin.
        ending: of its name.

    Returns:
        The file; None if the folder has no such file.
    """
    for file in sorted(folder.glob(f"{stem}-*{ending}")):
        try:
            if file.name == file_name(stem, file.read_bytes(), ending):
                return file
            file.unlink()
        except OSError:
            # Another process has removed it, or it is not ours to read.
            continue
    return None


def kept_texts(name: str, made_from: Sequence[Any], write: Callable[[], Mapping[str, str]]) -> dict[str, str]:
    """Texts by file name, written once for a model and its options: a later process takes them from the folder.

    Args:
        name: what the name of their file in the folder begins with.
        made_from: the model and all options on which the texts depend.
        write: writes the texts.
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
    """Texts in the folder under a stem; None where there are none."""
    with suppress(OSError):
        kept = kept_file(cache_folder(), stem, TEXTS)
        if kept is not None:
            texts: dict[str, str] = json.loads(zlib.decompress(kept.read_bytes()))
            mark_used(kept)
            return texts
    return None


def _keep_texts(folder: Path, stem: str, texts: Mapping[str, str]) -> None:
    """Keep texts in the folder, unless it takes none: they are at hand all the same."""
    content = zlib.compress(json.dumps(texts).encode(), 1)
    with suppress(OSError, WriteError):
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / file_name(stem, content, TEXTS), content)
        keep_within(folder)


def tallied(stem: str | None) -> float:
    """Time that all processes have noted under a stem, s: see :func:`tally`."""
    if stem is None:
        return 0.0
    with suppress(OSError):
        return 1e-3 * _tally_of(stem).stat().st_size
    return 0.0


def tally(stem: str | None, seconds: float) -> None:
    """Note time that went for want of a library, for processes to come: each process may be short.

    A byte stands for a millisecond, so that processes may append to the file at once. Without a stem nothing is noted.
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
    """A hash of sources and of all else that a library depends on.

    Args:
        compiler: words of its command. Programs among them are told by their files, since asking a compiler for its
            version would mean to run it.
        flags: its flags.
        contents: of the sources and of the files that they include, each as in its file.
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
    """Path, size and time of a program; nothing where a word is an option."""
    path = shutil.which(word)
    if path is None:
        return ""
    program = Path(path).resolve()
    with suppress(OSError):
        found = program.stat()
        return f"{program} {found.st_size} {found.st_mtime_ns}"
    return str(program)


def mark_used(file: Path) -> None:
    """Remember that a file is used now."""
    with suppress(OSError):
        os.utime(file, ns=(time.time_ns(), file.stat().st_mtime_ns))


def keep_within(folder: Path, limit: int = LIMIT) -> None:
    """Remove the least recently used libraries and texts beyond a limit, and what killed compilations left.

    Args:
        folder: with the files.
        limit: bytes.
    """
    now = time.time()
    files: list[tuple[float, int, Path]] = []
    for path in folder.iterdir():
        # Another process may remove what is listed here.
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
