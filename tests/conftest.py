"""Fixtures shared by all tests: where the reference cases are, and short scenes to build on."""

from __future__ import annotations

import gc
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from cosserat_casadi.model.function_table import FunctionSpec
from tests.once import once
from tests.written_once import CHANGES_CODE, WrittenOnce

ROOT = Path(__file__).resolve().parents[1]
CASES = ROOT.parent / "shared" / "cases"
AWAY = ROOT / "tests" / "scenes_away"
"""Scenes whose inputs are moved away from the scene's own numbers."""


C_FLAGS = "COSSERAT_CASADI_TEST_C_FLAGS"
"""Environment variable with the optimisation that C is compiled with, instead of none."""

UNOPTIMISED = "-O0"

NEW_OBJECTS = 100_000
"""Objects that are made between two collections of garbage, far more than Python's own number: little is garbage."""

WRITTEN = WrittenOnce()

PYTHON_OWN = gc.get_threshold()
"""The numbers of objects that Python itself begins with."""


def c_flags() -> list[str]:
    """How C is optimised in these tests: not at all, since optimising takes the compiler far longer than it saves."""
    return os.environ.get(C_FLAGS, UNOPTIMISED).split()


def quickest_compiler() -> str:
    """What compiles C that is run for its digits: without optimisation clang takes a fifth of the time of gcc.

    Optimised C is that of gcc, whose rounding is then what is tested.
    """
    programs = ["clang", "gcc"] if c_flags() == [UNOPTIMISED] else ["gcc"]
    return next((found for word in programs if (found := shutil.which(word))), "gcc")


def case_files(folder: str) -> list[Path]:
    """Scene files of the reference cases; none where the cases are not at hand."""
    return sorted((CASES / folder).glob("*.toml"))


@pytest.fixture(scope="session")
def examples() -> list[Path]:
    return sorted((ROOT / "examples").glob("*.toml"))


@pytest.fixture(scope="session")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all processes of one test run share."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "workshop"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session", autouse=True)
def quick_compiler(workshop: Path) -> Iterator[None]:
    """What libraries compute matters, not how fast; they lie in the folder of these tests, not in the user's.

    The processes of a test run share libraries, and so the compiler: its file tells whether a library is its own.
    """
    script = workshop / "cc"
    once(script, _write_compiler)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", str(script))
        patch.setenv("XDG_CACHE_HOME", str(workshop / "cache"))
        patch.setenv("OPENBLAS_NUM_THREADS", "1")
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        yield


@pytest.fixture(scope="session", autouse=True)
def written_once() -> Iterator[None]:
    """Functions of models are written once for all tests that ask for the same equations."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(FunctionSpec, "build", lambda *arguments: WRITTEN.build(*arguments))
        yield


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Tests that change the package, or measure its memory, share no functions."""
    WRITTEN.active = CHANGES_CODE.isdisjoint(getattr(item, "fixturenames", ()))


@pytest.fixture
def usual_garbage() -> Iterator[None]:
    """Garbage is collected as often as users have it collected: for tests that measure memory."""
    gc.set_threshold(*PYTHON_OWN)
    yield
    gc.set_threshold(NEW_OBJECTS)


@pytest.fixture
def quick_gcc(workshop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines of pages that call gcc find the compiler of the tests by this name: it does not optimise."""
    folder = workshop / "named"
    folder.mkdir(exist_ok=True)
    once(folder / "gcc", lambda path: path.symlink_to(workshop / "cc"))
    monkeypatch.setenv("PATH", os.pathsep.join([str(folder), os.environ["PATH"]]))


WITHOUT_PRAGMAS = """#!/bin/sh
"$@" || exit
case "$*" in *" -E "*) ;; *) exit ;; esac
while [ "$1" != -o ]; do shift; done
exec sed -i '/^#pragma GCC optimize/d' "$2"
"""
"""Runs a step of gcc; what the preprocessor has written loses the optimisation that kernels ask for themselves."""


def _write_compiler(path: Path) -> None:
    """A script that has the last word on optimisation, and calls the quickest compiler.

    Threads and sanitisers are those of gcc: clang needs libraries for them that may not be installed.
    """
    gcc = shutil.which("gcc")
    quickest = quickest_compiler()
    if quickest == gcc and c_flags() == [UNOPTIMISED]:
        steps = path.with_name("step_of_gcc")
        _write_script(steps, WITHOUT_PRAGMAS)
        quickest = f"{gcc} -no-integrated-cpp -wrapper '{steps}'"
    lines = [
        "#!/bin/sh",
        'case " $* " in',
        f'*openmp*|*sanitize*) exec {gcc} "$@" {" ".join(c_flags())};;',
        f'*) exec {quickest} "$@" {" ".join(c_flags())};;',
        "esac",
    ]
    _write_script(path, "\n".join(lines) + "\n")


def _write_script(path: Path, text: str) -> None:
    path.write_text(text)
    path.chmod(0o755)


def pytest_configure(config: pytest.Config) -> None:
    """The second process of a run begins with the last folders: each compiles half of the files for both."""
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw1" and config.args_source is pytest.Config.ArgsSource.TESTPATHS:
        folders = [path for path in (ROOT / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"]
        places = [*folders, *(ROOT / "tests").glob("test_*.py")]
        config.args = sorted(map(str, places), reverse=True)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """All processes of a run have the tests in one order, wherever they began."""
    items.sort(key=lambda item: item.path)


def pytest_collection_finish() -> None:
    """Thousands of tests live until the end: the garbage collector need not look at them again and again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(NEW_OBJECTS)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-generated", action="store_true", help="write the folders in generated/ anew")
