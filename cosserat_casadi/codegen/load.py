"""Compilation and loading of an exported folder of any kind, which its manifest names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.contact.compiled import CompiledContact
from cosserat_casadi.codegen.manifest import (
    ARRANGEMENTS,
    EXPORT_FIRST,
    MANIFEST,
    TUBES,
    check_folder,
    input_count,
    is_sound,
    read_manifest,
)
from cosserat_casadi.codegen.tubes.compiled import CompiledTubes
from cosserat_casadi.compiling.compiler import find_compiler, shared_object
from cosserat_casadi.compiling.texts import files_in_c
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.numerics.progress import StageProgress

SCENE = "scene.toml"
"""File of an exported folder with its scene."""

ALWAYS = ("", "_kernels")
"""Suffixes of the stems of sources that every folder has."""

ASKED_FOR = ("_derivatives", "_stability", "_lanes")
"""Suffixes of the stems of sources that a folder has on request."""

Loaded = Compiled | CompiledContact
"""An exported folder of rods, of rods in exact contact, or of concentric tubes."""


def load(
    directory: str | os.PathLike[str], compiler: str | None = None, *, progress: StageProgress | None = None
) -> Loaded:
    """Compile an exported folder, once, and load it.

    The name of the shared object in the user's cache folder contains a hash of sources, compiler and flags: equal
    sources are compiled once, wherever they are, and an object that some process has loaded is never overwritten. The
    environment variable ``COSSERAT_CASADI_CACHE`` names another folder, or disables the cache with ``off``.

    Args:
        directory: a folder written by :func:`cosserat_casadi.export`.
        compiler: C compiler; by default the command in the environment variable CC, then cc, gcc, clang, python-zig.
        progress: callback with the file under compilation, the numbers of compiled files and of all, while any is left.

    Returns:
        The library of rods, of rods in exact contact, or of concentric tubes, as the manifest says.

    Raises:
        ExportError: the folder is not one of an export, another version has written it, its files do not belong
            together, there is no compiler, or it fails.
    """
    folder = Path(directory)
    described = read_manifest(folder)
    kind = _kind(described)
    if not is_sound(described, kind.is_sound):
        raise ExportError(Problem(str(folder / MANIFEST), "is not the manifest of an exported folder", EXPORT_FIRST))
    check_folder(folder, described, {"INPUTS": input_count(described), **kind.sizes(described)})
    name = described["name"]
    asked_for = [end for end in ASKED_FOR if f"{name}{end}.c" in described["files"]]
    sources = [folder / f"{name}{end}.c" for end in (*ALWAYS, *asked_for)]
    headers = [folder / f"{name}{end}.h" for end in ("", "_config", "_kernels")]
    beside = {*files_in_c(), *(f"{name}{end}.h" for end in ("_kernels_in_fours", *asked_for))}
    headers += [folder / file for file in described["files"] if file in beside]
    library = shared_object(name, sources, headers, find_compiler(compiler), progress)
    return kind(library, described, _scene_text(folder))


def _kind(described: Any) -> type[Compiled] | type[CompiledContact]:
    """The class of the folder that a manifest, which need not be sound, is of."""
    if isinstance(described, dict) and ARRANGEMENTS in described:
        return CompiledContact
    if isinstance(described, dict) and TUBES in described:
        return CompiledTubes
    return Compiled


def _scene_text(folder: Path) -> str:
    """Read the text of the scene of an exported folder; empty if the file was removed."""
    try:
        return (folder / SCENE).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return ""
