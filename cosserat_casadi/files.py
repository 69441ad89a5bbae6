"""Atomic writing of files; a hash of the sources of the package on the disk."""

from __future__ import annotations

import hashlib
import os
import secrets
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from typing import IO

from cosserat_casadi.errors import Problem, SceneError, WriteError

BLOCK = 1 << 20
"""Number of bytes that are copied at a time."""

_UNFINISHED: set[Path] = set()
"""Files and folders that are being written, under temporary names."""

MESHES = (".glb", ".usda")
"""Suffixes of files of meshes, which need no matplotlib."""


def check_writable(path: Path, option: str, *, folder: bool = False) -> None:
    """Refuse a path that cannot become a file, before any work is done for it.

    Links are followed; an existing device or pipe does not need a writable folder.

    Args:
        path: path of the file.
        option: option of the file, for messages.
        folder: whether the path should become a folder instead.

    Raises:
        SceneError: the path is an existing folder, a device or a pipe that cannot be written, or a link to itself; or
            its folder does not exist or cannot be written to.
    """
    if path.is_dir() and not folder:
        raise SceneError(Problem(option, f"{path} is a folder", "name a file in it"))
    if is_special(path):
        if not os.access(path, os.W_OK):
            raise SceneError(Problem(option, f"{path} cannot be written to"))
        return
    target = _target(path)
    if target.is_symlink():
        raise SceneError(Problem(option, f"{path} is a link that leads to itself", "remove it, or name another file"))
    parent = target.parent
    if parent.exists() and not parent.is_dir():
        raise SceneError(Problem(option, f"{parent} is a file, not a folder", "name another folder"))
    if not parent.is_dir():
        raise SceneError(Problem(option, f"the folder {parent} does not exist", "make it first"))
    if not os.access(parent, os.W_OK):
        raise SceneError(Problem(option, f"the folder {parent} cannot be written to"))


def is_special(path: Path) -> bool:
    """Whether a path leads to an existing thing that stores no content: a device, a pipe, a socket."""
    return path.exists() and not path.is_file() and not path.is_dir()


def are_one_file(first: Path, second: Path) -> bool:
    """Whether two paths lead to one regular file, existing or not; several may write to one device."""
    if first.exists() and second.exists():
        return first.is_file() and first.samefile(second)
    return os.path.realpath(first) == os.path.realpath(second)


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file atomically: under a temporary name beside its path, then move it there.

    A device or a pipe is not replaced by a file: the complete content is written into it.

    Raises:
        WriteError: the disk is full, or the folder cannot be written to.
    """
    with atomic_file(path) as temporary:
        temporary.write_bytes(content)


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A temporary file to fill; at the end it is moved to a path, or removed after a failure.

    If the path is a link the file goes to the target of the link. The content is written into a device or a pipe.

    Raises:
        WriteError: the disk is full, or the folder cannot be written to.
    """
    with write_errors(path):
        if is_special(path):
            with tempfile.TemporaryDirectory() as folder:
                filled = Path(folder) / path.name
                yield filled
                _pour(filled, path)
            return
        target = _target(path)
        with _unfinished(target) as temporary:
            temporary.touch(mode=0o600, exist_ok=False)
            yield temporary
            temporary.chmod(0o644)
            temporary.replace(target)


@contextmanager
def atomic_folder(path: Path) -> Iterator[Path]:
    """A temporary folder to fill; at the end it is moved to a path, or removed after a failure.

    If the path is a link the folder goes to the target of the link.

    Raises:
        WriteError: the disk is full, the parent folder cannot be written to, or the path exists.
    """
    with write_errors(path):
        target = _target(path)
        with _unfinished(target) as temporary:
            temporary.mkdir(mode=0o700)
            yield temporary
            temporary.chmod(0o755)
            temporary.rename(target)


@contextmanager
def _unfinished(target: Path) -> Iterator[Path]:
    """A path beside a target for its unfinished content, which is removed after a failure.

    The name is known before the content exists: a signal at any moment leaves nothing behind.
    """
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(8)}.part")
    _UNFINISHED.add(temporary)
    try:
        yield temporary
    except BaseException:
        _remove(temporary)
        raise
    finally:
        _UNFINISHED.discard(temporary)


def remove_unfinished() -> None:
    """Remove unfinished files and folders, before the process ends without cleanup."""
    for path in list(_UNFINISHED):
        _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _target(path: Path) -> Path:
    """Target of a path: itself, unless it is a link."""
    if path.is_symlink():
        return Path(os.path.realpath(path))
    return path


def _pour(source: Path, special: Path) -> None:
    """Write the content of a file into a device or a pipe."""
    with source.open("rb") as content, special.open("wb", buffering=0) as stream:
        while block := content.read(BLOCK):
            write_whole(stream, block)


def write_whole(stream: IO[bytes], content: bytes) -> None:
    """Write a content completely: an unbuffered stream may take only a part, and reports the cause at the next call.

    Raises:
        OSError: the disk is full.
    """
    rest = memoryview(content)
    while len(rest):
        written = stream.write(rest)
        rest = rest[written:]


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Convert a failure inside to an error that names the file, which the system's error does not.

    Raises:
        WriteError: the system reports an error, which this one replaces.
    """
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        raise WriteError(path, error) from error


ENDINGS = {".py", ".in", ".c", ".h", ".toml", ".json"}
"""Suffixes of the files that decide on the results of the package."""


def sources_hash(folder: Path | None = None) -> str | None:
    """A hash of the sources of the package.

    Args:
        folder: folder with the sources; by default the package's.

    Returns:
        the hash; None if a file has changed since the package was imported, or there are no files.
    """
    root = os.fspath(folder or Path(__file__).parent)
    # No module imports the package's own module, which is above all others.
    imported = sys.modules[__package__ or ""].IMPORTED
    digest = hashlib.sha256()
    # Paths are texts: sorting and comparing hundreds of Path objects takes longer than reading the files.
    files = sorted(f"{at}/{name}" for at, _, names in os.walk(root) for name in names if _is_source(name))
    for path in files:
        with FileIO(path) as file:
            facts = os.fstat(file.fileno())
            # A file that is moved or linked into place keeps its own time; the time of its entry in the folder changes.
            if max(facts.st_mtime, facts.st_ctime) >= imported:
                return None
            content = file.read()
        within = path[len(root) :].replace(os.sep, "/")
        digest.update(f"{within}\0{len(content)}\0".encode() + content)
    return digest.hexdigest() if files else None


def _is_source(name: str) -> bool:
    """Whether a file of this name decides on the results of the package."""
    stem, dot, ending = name.rpartition(".")
    return bool(stem) and dot + ending in ENDINGS
