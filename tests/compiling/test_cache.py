"""The folder of compiled libraries: what is compiled again, what is removed, and two processes at once."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import ExportError, build, discretise, export, load
from cosserat_casadi.compiling import cache, compiler
from cosserat_casadi.compiling.cache import (
    ABANDONED,
    IN_USE,
    MOST_TALLIED,
    OURS,
    SCRATCH,
    VARIABLE,
    cache_folder,
    content_hash,
    keep_within,
    tallied,
    tally,
)
from cosserat_casadi.compiling.compiler import find_compiler
from tests.families import mostly_slow
from tests.scenes import push, scene

needs_compiler = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
needs_shell = pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for the compiler")


@pytest.fixture(scope="module")
def strip_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An exported folder that no test changes."""
    given = scene(push(), strain="planar")
    return export(build(given, discretise(given, 2, 3)), tmp_path_factory.mktemp("once") / "strip")


@pytest.fixture
def strip(strip_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An exported folder of a test's own beside an empty cache."""
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path / "kept"))
    monkeypatch.setattr(compiler, "FLAGS", tuple("-O0" if flag == "-O2" else flag for flag in compiler.FLAGS))
    return Path(shutil.copytree(strip_once, tmp_path / "strip"))


def test_processes_note_their_time_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path / "kept"))
    stem = "steps-0123456789abcdef0123"
    assert tallied(stem) == 0.0
    # None is the stem of what has no key.
    tally(None, 1.0)
    assert tallied(None) == 0.0
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: tally(stem, 3.4e-3), range(100)))
    assert_allclose(tallied(stem), 0.3, rtol=1e-12, atol=0)
    tally(stem, 1e6)
    tally(stem, 1e6)
    assert_allclose(tallied(stem), 1e-3 * MOST_TALLIED, rtol=1e-12, atol=0)
    (file,) = (tmp_path / "kept").iterdir()
    assert OURS.fullmatch(file.name), "it is removed with what else is ours"


def counting_compiler(tmp_path: Path) -> tuple[str, Path]:
    """A compiler that writes a line for each of its runs."""
    runs = tmp_path / "runs"
    path = tmp_path / "countcc"
    path.write_text(f'#!/bin/sh\necho run >> "{runs}"\nexec gcc "$@"\n')
    path.chmod(0o755)
    return str(path), runs


@needs_compiler
@needs_shell
def test_the_second_load_runs_no_compiler_at_all(strip: Path, tmp_path: Path) -> None:
    compiler, runs = counting_compiler(tmp_path)
    told: list[tuple[str, int, int]] = []
    first = load(strip, compiler, progress=lambda *words: told.append(words))
    # Two sources and the link.
    assert runs.read_text().splitlines() == ["run"] * 3
    assert told == [("Compiling strip", done, 2) for done in range(3)]
    second = load(strip, compiler, progress=lambda *words: told.append(words))
    assert second.library == first.library
    assert first.library.parent == tmp_path / "kept"
    assert len(runs.read_text().splitlines()) == len(told) == 3


@pytest.mark.slow
@needs_compiler
@needs_shell
def test_another_compiler_under_the_same_name_compiles_again(strip: Path, tmp_path: Path) -> None:
    compiler, _ = counting_compiler(tmp_path)
    first = load(strip, compiler).library
    with Path(compiler).open("a") as stream:
        stream.write("# newer\n")
    assert load(strip, compiler).library != first


def test_contents_are_told_from_each_other_and_from_their_order() -> None:
    compiler = find_compiler()
    hashes = {content_hash([compiler], ["-O2"], contents) for contents in ([b"ab", b"c"], [b"a", b"bc"], [b"c", b"ab"])}
    assert len(hashes | {content_hash([compiler], ["-O3"], [b"ab", b"c"])}) == 4


@pytest.mark.slow
@needs_compiler
def test_switched_off_nothing_is_left(strip: Path, tmp_path: Path) -> None:
    code = (
        "import sys; from cosserat_casadi import load; a = load(sys.argv[1]).library; "
        "assert a.exists() and load(sys.argv[1]).library == a; print(a)"
    )
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    environment = {**os.environ, "COSSERAT_CASADI_CACHE": "off", "TMPDIR": str(temporary), "HOME": str(tmp_path)}
    command = [sys.executable, "-c", code, str(strip)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
    assert Path(done.stdout.strip()).is_relative_to(temporary)
    assert list(temporary.iterdir()) == []
    assert not (tmp_path / "kept").exists()


@needs_compiler
def test_two_processes_at_once(strip: Path, tmp_path: Path) -> None:
    code = "import sys; from cosserat_casadi import load; print(load(sys.argv[1]).solve().converged)"
    command = [sys.executable, "-c", code, str(strip)]
    processes = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    assert [process.communicate(timeout=120)[0].strip() for process in processes] == ["True", "True"]
    (library,) = (tmp_path / "kept").iterdir()
    assert library.suffix == ".so"


def test_the_least_recently_used_libraries_are_removed_beyond_the_limit(tmp_path: Path) -> None:
    now = time.time()
    ages = {"a": 5 * IN_USE, "b": 2 * IN_USE, "c": 3 * IN_USE, "d": IN_USE / 2}
    endings = {"a": "texts", "b": "so", "c": "so", "d": "so"}
    for name, age in ages.items():
        path = tmp_path / f"arm-{name * 20}.{endings[name]}"
        path.write_bytes(b"x" * 100)
        # Written long ago, used then.
        os.utime(path, (now - age, now - 10 * ABANDONED))
    mine = tmp_path / "mine.so"
    mine.write_bytes(b"x" * 100)
    os.utime(mine, (0, 0))
    keep_within(tmp_path, 250)
    kept = {f"arm-{name * 20}.so" for name in "bd"}
    assert {path.name for path in tmp_path.iterdir()} == {*kept, "mine.so"}
    # What may be in use stays, whatever the limit.
    keep_within(tmp_path, 0)
    assert {path.name for path in tmp_path.iterdir()} == {f"arm-{'d' * 20}.so", "mine.so"}


def test_use_is_remembered(tmp_path: Path) -> None:
    library = tmp_path / "a.so"
    library.write_bytes(b"x")
    os.utime(library, (0, 0))
    cache.mark_used(library)
    found = library.stat()
    assert found.st_mtime == 0
    assert time.time() - found.st_atime < 60


def test_what_a_killed_compilation_left_is_removed(tmp_path: Path) -> None:
    old, running = f"{SCRATCH}old", f"{SCRATCH}running"
    for name, age in ((old, 2 * ABANDONED), (running, 60.0), ("mine", 2 * ABANDONED)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "object.o").write_bytes(b"x")
        os.utime(tmp_path / name, (time.time() - age,) * 2)
    keep_within(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {running, "mine"}


def test_the_variable_names_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("COSSERAT_CASADI_CACHE")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg" / "cosserat_casadi"


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("damage", ["cut off", "empty", "text"])
def test_a_damaged_library_is_compiled_anew(strip: Path, damage: str) -> None:
    first = load(strip).library
    sound = first.read_bytes()
    contents = {"cut off": sound[: len(sound) // 2], "empty": b"", "text": b"not a library"}
    first.unlink()
    first.write_bytes(contents[damage])
    # In a process of its own: this one has the sound library in memory.
    code = f"""
import sys
from cosserat_casadi import load
from cosserat_casadi.compiling import compiler
compiler.FLAGS = {compiler.FLAGS}
print(load(sys.argv[1]).solve().converged)
"""
    command = [sys.executable, "-c", code, str(strip)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip() == "True", (done.returncode, done.stderr)
    (kept,) = first.parent.iterdir()
    assert kept.name == cache.file_name(first.name.rpartition("-")[0], kept.read_bytes())


def script(tmp_path: Path, *lines: str) -> str:
    """A compiler that does as these lines say."""
    path = tmp_path / "scriptcc"
    path.write_text("\n".join(["#!/bin/sh", *lines, ""]))
    path.chmod(0o755)
    return str(path)


LAST_WORD_OF_OUTPUT = 'while [ "$1" != -o ]; do shift; done'
"""Shifts the words of a call until the second is the file to write."""


@needs_shell
@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["exit 0"], r"says that it has compiled .*strip.*\.c, and wrote nothing"),
        ([LAST_WORD_OF_OUTPUT, ': > "$2"'], "and wrote nothing"),
        ([LAST_WORD_OF_OUTPUT, 'echo text > "$2"'], "has made no library that this machine can load"),
    ],
    ids=["nothing", "an empty file", "text"],
)
def test_a_compiler_that_only_says_that_it_compiles(strip: Path, tmp_path: Path, lines: list[str], words: str) -> None:
    with pytest.raises(ExportError, match=words):
        load(strip, script(tmp_path, *lines))
    assert list((tmp_path / "kept").iterdir()) == []


@needs_shell
def test_a_compiler_that_hangs_is_stopped(strip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "LONGEST", 0.5)
    running = tmp_path / "running"
    hanging = script(tmp_path, f"sleep 1000 & echo $! >> {running}", "wait")
    with pytest.raises(ExportError, match=r"was stopped: it had not compiled .*\.c after 0.5 s"):
        load(strip, hanging)
    # What it had started is stopped with it; on a busy machine it had started nothing yet.
    assert_ended(started(running))


@needs_shell
def test_an_interrupt_stops_compilers(strip: Path, tmp_path: Path) -> None:
    running = tmp_path / "running"
    hanging = script(tmp_path, f"sleep 1000 & echo $! >> {running}", "wait")

    def interrupted(doing: str, done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        load(strip, hanging, progress=interrupted)
    assert_ended(started(running))


def started(file: Path) -> list[int]:
    """Numbers of the processes that a script has written, none where it has not come so far."""
    return [int(word) for word in file.read_text().split()] if file.exists() else []


def assert_ended(numbers: list[int]) -> None:
    """Wait until processes that were killed have ended: a busy machine takes its time for it."""
    patience = time.monotonic() + 30.0
    while any(is_alive(number) for number in numbers):
        assert time.monotonic() < patience, "what was killed goes on"
        time.sleep(0.05)


def is_alive(number: int) -> bool:
    """Whether a process does anything: one that has ended may wait for whoever asks how."""
    found = subprocess.run(["ps", "-o", "stat=", "-p", str(number)], capture_output=True, text=True, check=False)
    return found.stdout.strip()[:1] not in ("", "Z")


@needs_compiler
@needs_shell
@pytest.mark.parametrize(
    ("command", "words"),
    mostly_slow(
        [
            ("{gcc} -O1 -DANSWER='4 2'", ["-O0", "-O1", "-DANSWER=4 2", "-c"]),
            ("{launcher} {gcc}", ["-O0", "-c"]),
            ("{blank}", ["-O0", "-c"]),
        ],
        quick=[("{gcc} -O1 -DANSWER='4 2'", ["-O0", "-O1", "-DANSWER=4 2", "-c"])],
    ),
    ids=["options", "launcher", "a path with a blank"],
)
def test_commands_of_several_words(
    strip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, words: list[str]
) -> None:
    calls = tmp_path / "calls"
    gcc = tmp_path / "noting-gcc"
    gcc.write_text(f'#!/bin/sh\nprintf "%s\\n" "$@" >> "{calls}"\nexec gcc "$@"\n')
    launcher = tmp_path / "launcher"
    launcher.write_text('#!/bin/sh\nexec "$@"\n')
    blank = tmp_path / "the compiler"
    blank.write_bytes(gcc.read_bytes())
    for program in (gcc, launcher, blank):
        program.chmod(0o755)
    monkeypatch.setenv("CC", command.format(gcc=gcc, launcher=launcher, blank=blank))
    assert load(strip).solve().converged
    # Ours come first: of two options a compiler takes the last, which is the user's.
    called = calls.read_text().splitlines()
    assert [word for word in called[: called.index("-c") + 1] if word in words] == words


def test_a_command_that_is_none(strip: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "gcc '-O1")
    with pytest.raises(ExportError, match="gcc '-O1 is no command: No closing quotation"):
        load(strip)
    monkeypatch.setenv("CC", "no-such-compiler -O1")
    with pytest.raises(ExportError, match="no-such-compiler -O1 is not a program"):
        load(strip)


@needs_shell
def test_a_launched_compiler_is_told_by_its_file(tmp_path: Path) -> None:
    program = Path(script(tmp_path, "exit 0"))
    before = content_hash(["env", str(program)], [], [])
    program.write_text("#!/bin/sh\nexit 1 # newer\n")
    assert content_hash(["env", str(program)], [], []) != before


@pytest.mark.skipif(sys.platform != "linux", reason="asks for the user by number")
def test_a_user_without_a_home_keeps_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(number: int) -> None:
        raise KeyError(number)

    for variable in ("COSSERAT_CASADI_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("pwd.getpwuid", unknown)
    folder = cache_folder()
    assert folder.is_dir()
    assert folder.is_relative_to(tempfile.gettempdir())


@needs_compiler
def test_wider_vectors_of_this_machine_change_no_digit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A product and a sum that were rounded as one would differ in the last digit, of some of so many numbers."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    source = """void added(const double *a, const double *b, double *c, int n) {
  for (int i = 0; i < n; i++) c[i] += a[i] * b[i];
}"""
    a, b, begin = np.random.default_rng(0).standard_normal((3, 1000))
    found = []
    for flags in (compiler.FLAGS, compiler.flags_of_machine()):
        path = compiler.compiled_texts("added", {"added.c": source}, find_compiler("gcc"), flags=flags)
        added = begin.copy()
        ctypes.CDLL(str(path)).added(*(ctypes.c_void_p(array.ctypes.data) for array in (a, b, added)), len(a))
        found.append(added)
    assert_array_equal(found[1], found[0])
    assert compiler.flags_of_machine()[: len(compiler.FLAGS)] == compiler.FLAGS
