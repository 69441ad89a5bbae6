"""A folder of generated files, written completely or not at all, and never over foreign files."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from cosserat_casadi.codegen.manifest import read_manifest
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.files import write_atomically


def check_folder(directory: Path) -> set[str]:
    """Refuse a folder with files that an export did not write.

    Args:
        directory: the folder; it need not exist.

    Returns:
        names of the files of an earlier export.

    Raises:
        ExportError: the path is a file, holds foreign files, or cannot be written to.
    """
    if not os.path.lexists(directory):
        _check_parent(directory)
        return set()
    if not directory.is_dir():
        raise ExportError(Problem("--output", f"{directory} is no folder", "name one"))
    if not os.access(directory, os.R_OK | os.W_OK | os.X_OK):
        raise ExportError(Problem("--output", f"the folder {directory} cannot be written to", "name another"))
    ours = _listed(directory)
    held = {path.name: path.name in ours and path.is_file() for path in directory.iterdir()}
    foreign = sorted(name for name, known in held.items() if not known)
    if foreign:
        shown = ", ".join(foreign[:5]) + (" …" if len(foreign) > 5 else "")
        problem = f"the folder {directory} holds files that no export wrote: {shown}"
        raise ExportError(Problem("--output", problem, "name a new or an empty folder"))
    return set(held)


def write_folder(directory: Path, files: Mapping[str, str], stale: set[str]) -> None:
    """Write all files, or leave the folder as it was.

    Args:
        directory: the folder; made if it does not exist.
        files: text by name.
        stale: files of an earlier export, which are removed unless they are written again.
    """
    made = not directory.exists()
    before = {name: (directory / name).read_bytes() for name in stale}
    directory.mkdir(exist_ok=True)
    try:
        for name, text in files.items():
            write_atomically(directory / name, text.encode())
        for name in stale - set(files):
            (directory / name).unlink()
    except BaseException:
        _restore(directory, set(files), before)
        if made:
            with contextlib.suppress(OSError):
                directory.rmdir()
        raise


def _restore(directory: Path, written: set[str], before: Mapping[str, bytes]) -> None:
    for name in written - set(before):
        (directory / name).unlink(missing_ok=True)
    for name, content in before.items():
        write_atomically(directory / name, content)


def _listed(directory: Path) -> set[str]:
    """Names of the files of an earlier export; empty if the manifest is damaged or foreign."""
    try:
        described = read_manifest(directory)
        files, versions = described["files"], described["versions"]
    except (ExportError, KeyError, TypeError):
        return set()
    if not isinstance(versions, dict) or "cosserat_casadi" not in versions or not isinstance(files, list):
        return set()
    return {name for name in files if isinstance(name, str)}


def _check_parent(directory: Path) -> None:
    parent = directory.absolute().parent
    if not parent.is_dir():
        raise ExportError(Problem("--output", f"the folder {parent} does not exist", "make it first"))
    if not os.access(parent, os.W_OK):
        raise ExportError(Problem("--output", f"the folder {parent} cannot be written to", "name another"))
