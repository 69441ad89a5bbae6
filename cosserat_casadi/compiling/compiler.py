"""Compilation of C sources into one shared object, once: the search for a compiler, and its calls."""

from __future__ import annotations

import ctypes
import logging
import os
import platform
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from functools import cache, lru_cache
from itertools import islice
from pathlib import Path
from types import TracebackType

from cosserat_casadi.compiling.cache import (
    SCRATCH,
    VARIABLE,
    cache_folder,
    content_hash,
    file_name,
    keep_within,
    kept_file,
    mark_used,
)
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.numerics.progress import StageProgress

LOG = logging.getLogger(__name__)

REMEDY = "install gcc or clang, or pip install ziglang, or name one in the environment variable CC"

COMPILERS = ("cc", "gcc", "clang", "python-zig cc")
"""Commands in the order of the search; the last one comes with the package ziglang of PyPI."""

EXPORT_ANEW = "export the folder anew"
"""Remedy for files of a folder that are missing, of another version, or do not belong together."""

FLAGS: tuple[str, ...] = ("-O2", "-std=c99", "-fPIC")

ENDS = (".c", ".cpp", ".cu")
"""Suffixes of source files."""

LONGEST = 1200.0
"""Time that the compiler has for one file, s: the largest file of the examples takes it less than a tenth of that."""


def shared_object(
    name: str,
    sources: Sequence[Path],
    headers: Sequence[Path],
    compiler: str,
    progress: StageProgress | None = None,
    *,
    flags: Sequence[str] | None = None,
    origin: str | None = None,
) -> Path:
    """Compile sources of one folder into the cache, unless that has been done; processes may do so at once.

    A library in the cache whose content has changed since it was compiled is compiled again.

    Args:
        name: prefix of the name of the object.
        sources: files to compile.
        headers: files in their folder that they include.
        compiler: command of a C compiler, of :func:`find_compiler`.
        progress: callback with the file under compilation, the number of compiled files, and of all files.
        flags: flags of the compiler, :data:`FLAGS` by default.
        origin: key of the origin of the sources, which identifies the library in the cache; by default the sources
            identify it.

    Raises:
        ExportError: a file is missing, the compiler fails, or the cache cannot be written to.
    """
    flags = FLAGS if flags is None else flags
    contents = [_read(path) for path in (*sources, *headers)] if origin is None else [origin.encode()]
    stem = _stem(name, compiler, flags, contents)
    folder = cache_folder()
    try:
        kept = _compiled_before(name, folder, stem)
        if kept is not None:
            return kept
        LOG.info("%s: compiling %d files in %s", name, len(sources), folder)
        folder.mkdir(parents=True, exist_ok=True)
        library = _compile(compiler, flags, sources, folder, stem, progress)
        keep_within(folder)
    except OSError as error:
        remedy = f"name a folder for it in the environment variable {VARIABLE}"
        raise ExportError(Problem(str(folder), f"cannot be written to: {error.strerror}", remedy)) from None
    return library


def compiled_texts(
    name: str,
    texts: Mapping[str, str],
    compiler: str,
    included: Collection[str] = frozenset(),
    progress: StageProgress | None = None,
    *,
    flags: Sequence[str] | None = None,
    origin: str | None = None,
) -> Path:
    """Compile sources and headers that are texts by file name, as :func:`shared_object` compiles files.

    Args:
        name: prefix of the name of the object.
        texts: content by file name.
        compiler: command of a C compiler, of :func:`find_compiler`.
        included: files that others include, which are not compiled separately.
        progress: callback, as in :func:`shared_object`.
        flags: flags of the compiler, as in :func:`shared_object`.
        origin: key of the origin, as in :func:`shared_object`.
    """
    flags = FLAGS if flags is None else flags
    sources = [file for file in texts if file.endswith(ENDS) and file not in included]
    headers = [file for file in texts if file not in sources]
    contents = [texts[file].encode() for file in (*sources, *headers)] if origin is None else [origin.encode()]
    with suppress(OSError):
        kept = _compiled_before(name, cache_folder(), _stem(name, compiler, flags, contents))
        if kept is not None:
            return kept
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for file, text in texts.items():
            (folder / file).write_bytes(text.encode())
        written = [folder / file for file in sources]
        beside = [folder / file for file in headers]
        return shared_object(name, written, beside, compiler, progress, flags=flags, origin=origin)


def compiled_from(name: str, origin: str, compiler: str, flags: Sequence[str]) -> Path | None:
    """Find the library of :func:`compiled_texts` with an origin and flags in the cache; None if it is not there."""
    with suppress(OSError):
        return _compiled_before(name, cache_folder(), _stem(name, compiler, flags, [origin.encode()]))
    return None


def flags_of_machine() -> tuple[str, ...]:
    """Flags for code that runs on this machine alone: :data:`FLAGS`, with wider vectors if any; with equal results."""
    return (*FLAGS, *_wider_vectors())


@cache
def _wider_vectors() -> tuple[str, ...]:
    # The first processor stands in the first few lines; of a hundred processors the file is long.
    with suppress(OSError), Path("/proc/cpuinfo").open() as lines:
        if platform.machine() == "x86_64" and any("avx2" in line.split() for line in islice(lines, 40)):
            return ("-mavx2",)
    return ()


def _stem(name: str, compiler: str, flags: Sequence[str], contents: Sequence[bytes]) -> str:
    """Prefix of the file name of a library, from its compiler, its flags and the contents of its sources."""
    return f"{name}-{content_hash(compiler_words(compiler), flags, contents)}"


def _compiled_before(name: str, folder: Path, stem: str) -> Path | None:
    """Find the library of an earlier compilation in the cache, if any."""
    kept = kept_file(folder, stem)
    if kept is not None:
        mark_used(kept)
        LOG.info("%s was compiled before: %s", name, kept)
    return kept


def find_compiler(wanted: str | None = None) -> str:
    """Find the command of a C compiler: the wanted one, else the command in CC, else the first existing command.

    Args:
        wanted: a program, or a command with options or a launcher before it, such as ``gcc -O1`` or ``ccache gcc``.

    Returns:
        the command in shell syntax, with the path of its program.

    Raises:
        ExportError: there is none.
    """
    return _found(wanted or os.environ.get("CC", "").strip(), os.environ.get("PATH"))


@lru_cache(maxsize=16)
def _found(asked: str, path: str | None) -> str:
    """Find the command on a path of folders, once in a process, because every motion asks."""
    # pip installs programs beside the interpreter, whose folder is on the path only in an activated environment.
    folders = os.pathsep.join([path or os.defpath, str(Path(sys.executable).parent)])
    for candidate in [asked] if asked else COMPILERS:
        # A path may hold blanks: the name of an existing program is not split into a command.
        whole = shutil.which(candidate, path=folders)
        words = [candidate] if whole else _words(candidate)
        program = shutil.which(words[0], path=folders)
        if program:
            return shlex.join([program, *words[1:]])
    problem = f"{asked} is not a program" if asked else "there is no C compiler on the path"
    raise ExportError(Problem("compiler", problem, REMEDY))


def compiler_words(compiler: str, flags: Sequence[str] = ()) -> list[str]:
    """Words of a call of a compiler, to be followed by files.

    Args:
        compiler: command, of :func:`find_compiler`.
        flags: flags of this package; options of the command follow, so that those of the user take precedence.
    """
    words = shlex.split(compiler)
    programs = [word.startswith("-") for word in [*words, "-"]].index(True)
    return [*words[:programs], *flags, *words[programs:]]


def _words(command: str) -> list[str]:
    try:
        return shlex.split(command)
    except ValueError as error:
        raise ExportError(Problem("compiler", f"{command} is no command: {error}", REMEDY)) from None


def _compile(
    compiler: str,
    flags: Sequence[str],
    sources: Sequence[Path],
    folder: Path,
    stem: str,
    progress: StageProgress | None,
) -> Path:
    """Compile sources into a folder, to a file whose name consists of a stem and a hash of the content."""
    name = stem.rpartition("-")[0]
    call = compiler_words(compiler, flags)
    with tempfile.TemporaryDirectory(prefix=SCRATCH, dir=folder) as scratch:
        objects = [Path(scratch) / f"{source.stem}.o" for source in sources]
        doing = f"Compiling {name}"
        if progress is not None:
            progress(doing, 0, len(sources))
        # A failure or an interrupt stops the running compilers.
        with ThreadPoolExecutor() as pool, Processes(LONGEST) as processes:
            running = [
                pool.submit(_run, processes, [*call, "-c", str(source), "-o", str(made)], made, source)
                for source, made in zip(sources, objects, strict=True)
            ]
            for done, compiled in enumerate(as_completed(running), 1):
                compiled.result()
                if progress is not None:
                    progress(doing, done, len(sources))
        made = Path(scratch) / f"{stem}.so"
        with Processes(LONGEST) as processes:
            command = [*call, "-shared", *map(str, objects), "-o", str(made), "-lm"]
            _run(processes, command, made, sources[0].parent)
        _check_loads(compiler, made)
        library = folder / file_name(stem, made.read_bytes())
        made.replace(library)
    return library


def _run(processes: Processes, command: list[str], made: Path, of: Path) -> None:
    """Run a compiler.

    Args:
        processes: group of processes to which it belongs.
        command: words of the command.
        made: file that the compiler has to write.
        of: source file or folder, for the error message.

    Raises:
        ExportError: the compiler cannot be run, does not end, fails, or writes nothing.
    """
    program = command[0]
    try:
        code, told = processes.run(command)
    except TimeoutError:
        problem = f"{program} was stopped: it had not compiled {of} after {LONGEST:g} s"
        raise ExportError(Problem("compiler", problem, "name another in the environment variable CC")) from None
    except OSError as error:
        raise ExportError(Problem("compiler", f"{program} cannot be run: {error.strerror}", REMEDY)) from None
    if code:
        folder = of if of.is_dir() else of.parent
        raise ExportError(Problem(str(folder), f"{program} could not compile it: {told.strip()[-800:]}"))
    if not made.exists() or made.stat().st_size == 0:
        problem = f"{program} says that it has compiled {of}, and wrote nothing"
        raise ExportError(Problem("compiler", problem, "name another in the environment variable CC"))


def _check_loads(compiler: str, library: Path) -> None:
    """Refuse the result of a compiler that is no library for this machine.

    Raises:
        ExportError: the library cannot be loaded.
    """
    try:
        ctypes.CDLL(str(library))
    except OSError as error:
        reason = str(error).replace(f"{library}: ", "")
        problem = f"{compiler} has made no library that this machine can load: {reason}"
        remedy = f"name another in the environment variable CC, or in {VARIABLE} a folder that programs may run from"
        raise ExportError(Problem("compiler", problem, remedy)) from None


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        raise ExportError(Problem(str(path), "is missing", EXPORT_ANEW)) from None


class Processes:
    """Running programs of this process, which are stopped at the end of a ``with`` block.

    Args:
        longest: time limit of each program, s.
    """

    def __init__(self, longest: float) -> None:
        self._longest = longest
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def run(self, command: list[str], folder: Path | None = None) -> tuple[int, str]:
        """Run a program until it ends; several threads may do so at once.

        Args:
            command: words of the command.
            folder: folder in which the program runs; None for the present one.

        Returns:
            the exit code and the text on standard error.

        Raises:
            OSError: the program cannot be run.
            TimeoutError: the program was stopped after its time limit.
        """
        with self._lock:
            if self._stopped:
                return -signal.SIGTERM, ""
            # The compiler gets its own session, so that its child processes can be stopped with it.
            process = subprocess.Popen(
                command,
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                start_new_session=True,
            )
            self._running.add(process)
        # Leaving the block waits for the program: it is stopped before.
        with process:
            try:
                _, told = process.communicate(timeout=self._longest)
            except subprocess.TimeoutExpired:
                raise TimeoutError from None
            finally:
                _stop(process)
                with self._lock:
                    self._running.discard(process)
        return process.returncode, told

    def stop(self) -> None:
        """Stop all programs, and start none any more."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                _stop(process)

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.stop()


def _stop(process: subprocess.Popen[str]) -> None:
    """Stop a program and its children, unless it has ended."""
    if process.poll() is not None:
        return
    with suppress(ProcessLookupError, PermissionError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
