"""Sources in C into one shared object, compiled once: the compiler, and the folder that keeps what it made."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from cosserat_casadi.codegen.cache import SCRATCH, VARIABLE, cache_folder, content_hash, keep_within, mark_used
from cosserat_casadi.errors import ExportError, Problem

REMEDY = "install gcc or clang, or name one in the environment variable CC"

EXPORT_ANEW = "export the folder anew"
"""What helps where files of a folder are missing, of another version, or do not belong together."""

FLAGS: tuple[str, ...] = ("-O2", "-std=c99", "-fPIC")

Progress = Callable[[str, int, int], None]
"""Takes what is being done, how much of it is done, and how much there is."""


def shared_object(
    name: str, sources: Sequence[Path], headers: Sequence[Path], compiler: str, progress: Progress | None = None
) -> Path:
    """Compile sources of one folder into the cache, unless that has been done; processes may do so at once.

    Args:
        name: what the name of the object begins with.
        sources: files to compile.
        headers: files beside them that they include.
        compiler: path of a C compiler.
        progress: told what is compiled, how many files are, and of how many.

    Raises:
        ExportError: a file is missing, the compiler fails, or the cache cannot be written to.
    """
    digest = content_hash(compiler, FLAGS, [_read(path) for path in (*sources, *headers)])
    target = cache_folder() / f"{name}-{digest}.so"
    if target.exists():
        mark_used(target)
        return target
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _compile(compiler, sources, target, progress)
        keep_within(target.parent)
    except OSError as error:
        remedy = f"name a folder for it in the environment variable {VARIABLE}"
        raise ExportError(Problem(str(target.parent), f"cannot be written to: {error.strerror}", remedy)) from None
    return target


def compiled_texts(
    name: str,
    texts: Mapping[str, str],
    compiler: str,
    included: Collection[str] = frozenset(),
    progress: Progress | None = None,
) -> Path:
    """As :func:`shared_object`, of sources and headers that are texts by file name.

    Args:
        name: what the name of the object begins with.
        texts: content by file name.
        compiler: path of a C compiler.
        included: files that others include: they are not compiled by themselves.
        progress: as there.
    """
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / file for file in texts]
        for path in paths:
            path.write_text(texts[path.name], encoding="utf-8")
        sources = [path for path in paths if path.suffix == ".c" and path.name not in included]
        headers = [path for path in paths if path not in sources]
        return shared_object(name, sources, headers, compiler, progress)


def _compile(compiler: str, sources: Sequence[Path], target: Path, progress: Progress | None = None) -> None:
    with tempfile.TemporaryDirectory(prefix=SCRATCH, dir=target.parent) as scratch:
        made = Path(scratch) / target.name
        objects = [Path(scratch) / f"{source.stem}.o" for source in sources]
        commands = [[compiler, *FLAGS, "-c", str(s), "-o", str(o)] for s, o in zip(sources, objects, strict=True)]
        doing = f"Compiling {target.name.rpartition('-')[0]}"
        if progress is not None:
            progress(doing, 0, len(sources))
        with ThreadPoolExecutor() as pool:
            running = [pool.submit(_run, command, sources[0].parent) for command in commands]
            for done, compiled in enumerate(as_completed(running), 1):
                compiled.result()
                if progress is not None:
                    progress(doing, done, len(sources))
        _run([compiler, *FLAGS, "-shared", *map(str, objects), "-o", str(made), "-lm"], sources[0].parent)
        made.replace(target)


def _run(command: list[str], folder: Path) -> None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise ExportError(Problem("compiler", f"{command[0]} cannot be run: {error.strerror}", REMEDY)) from None
    if done.returncode:
        raise ExportError(Problem(str(folder), f"{command[0]} could not compile it: {done.stderr.strip()[-800:]}"))


def find_compiler(wanted: str | None = None) -> str:
    """Path of a C compiler: the one wanted, else that of CC, else the first there is.

    Raises:
        ExportError: there is none.
    """
    asked = wanted or os.environ.get("CC")
    for candidate in [asked] if asked else ["cc", "gcc", "clang"]:
        path = shutil.which(candidate)
        if path:
            return path
    problem = f"{asked} is not a program" if asked else "there is no C compiler on the path"
    raise ExportError(Problem("compiler", problem, REMEDY))


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        raise ExportError(Problem(str(path), "is missing", EXPORT_ANEW)) from None
