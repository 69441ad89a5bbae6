"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cosserat_casadi.errors import Problem, SceneError


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
    """A temporary file beside a path, to be filled; it is moved there at the end, or removed where that fails."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
