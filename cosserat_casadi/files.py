"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from cosserat_casadi.errors import Problem, SceneError, WriteError


def check_writable(path: Path, option: str) -> None:
    """Refuse a path that cannot become a file, before any work is done for it.

    Raises:
        SceneError: the path is a folder, or its folder does not exist or cannot be written to.
    """
    folder = path.parent
    if path.is_dir():
        raise SceneError(Problem(option, f"{path} is a folder", "name a file in it"))
    if not folder.is_dir():
        raise SceneError(Problem(option, f"the folder {folder} does not exist", "make it first"))
    if not os.access(folder, os.W_OK):
        raise SceneError(Problem(option, f"the folder {folder} cannot be written to"))


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name beside its place, then move it there: it is never half there."""
    with atomic_file(path) as temporary:
        temporary.write_bytes(content)


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A temporary file beside a path, to be filled; it is moved there at the end, or removed where that fails.

    Raises:
        WriteError: the disk is full, or the folder cannot be written to.
    """
    with write_errors(path):
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        temporary = Path(name)
        try:
            os.close(handle)
            yield temporary
            temporary.chmod(0o644)
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def write_whole(stream: IO[bytes], content: bytes) -> None:
    """Write all of a content: an unbuffered stream may take a part of it, and tells the next time why.

    Raises:
        OSError: the disk is full.
    """
    rest = memoryview(content)
    while len(rest):
        written = stream.write(rest)
        rest = rest[written:]


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Say of a failure inside which file could not be written: the system does not.

    Raises:
        WriteError: in place of the system's own error.
    """
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        raise WriteError(path, error) from error
