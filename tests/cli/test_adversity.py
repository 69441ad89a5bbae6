"""Every command where letters, room or time run out: a terminal without letters, a full disk, a folder that takes
nothing, a signal. A sentence and an exit code are owed each time, and nothing half-written stays."""

from __future__ import annotations

import json
import os
import resource
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from typer.main import get_command

from cosserat_casadi.cli.exit_codes import INTERRUPTED, NOT_FOUND, NOT_WRITTEN, REFUSED, TERMINATED
from cosserat_casadi.cli.main import app
from cosserat_casadi.cli.signals import forget_signals, remembered_interrupt, remove_temporary_files
from cosserat_casadi.cli.terminal import HANDLER, prepare_streams
from cosserat_casadi.errors import WriteError
from cosserat_casadi.files import atomic_file, atomic_folder
from cosserat_casadi.maths.typing import FloatArray
from tests.commands import WIRE
from tests.families import mostly_slow

SCENE = (
    """
schema = 1
title = "Draht, 3 µm² dünn"
inputs = ["push.force"]
accuracy = { modes = 3, nodes = 8, tolerance = 0.05 }
"""
    + WIRE
    + """[[actuators]]
name = "muscle"
kind = "chamber"
rod = "wire"
area = 1e-6
offset = [1e-3, 0]
pressure = 1e3
[[targets]]
kind = "position"
rod = "wire"
position = [0.1, 0, 0.15]
[[bounds]]
input = "push.force"
lower = [0, 0, 0]
upper = [1, 0, 0]
[simulation]
duration = 0.1
frames = 5
[[motions]]
input = "push.force"
times = [0, 0.1]
values = [[0.2, 0, 0], [0, 0, 0]]
"""
)

MEASURED = """
schema = 1
title = "Draht, 3 µm² dünn"
inputs = ["push.force"]
accuracy = { modes = 2, nodes = 4, tolerance = 0.05 }
[[rods]]
name = "wire"
length = 0.2
strain = "planar"
material = { youngs_modulus = 60e9, poisson_ratio = 0.33, density = 6450.0 }
section = { shape = "circle", radius = 0.5e-3 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "wire"
force = [0.05, 0, 0]
[[measurements]]
quantity = "position"
file = "shapes.csv"
rod = "wire"
columns = ["x", "", "z"]
sigma = 1e-3
"""
"""A scene with what was measured, without what is to be found."""

MODULUS = """
inputs = { "push.force.x" = "force" }
[[unknowns]]
parameter = "wire.material.youngs_modulus"
lower = 5e9
upper = 500e9
"""

TOUCH = """
[[unknowns]]
input = "push.force.x"
per_row = true
prior = { mean = 0.0, sigma = 0.1 }
"""

SHAPES = "force,x,z\n0.02,0.018,0.199\n0.04,0.035,0.196\n0.06,0.05,0.192\n"
"""Tips of a wire of the modulus above, rounded to millimetres."""

TUBES = """
schema = 1
title = "Röhrchen, dünn"
[[tubes]]
name = "outer"
material = { youngs_modulus = 6.0e10, poisson_ratio = 0.33 }
section = { outer_radius = 1.20e-3, inner_radius = 0.95e-3 }
straight = 0.10
curved = 0.12
curvature = 14.0
translation = 0.13
[[tubes]]
name = "inner"
material = { youngs_modulus = 6.0e10, poisson_ratio = 0.33 }
section = { outer_radius = 0.90e-3, inner_radius = 0.60e-3 }
straight = 0.18
curved = 0.14
curvature = 18.0
rotation = 0.6
translation = 0.20
"""

GIVEN = {
    "wire.toml": SCENE,
    "tubes.toml": TUBES,
    "rows.csv": "push.force.x\n0.1\n0.2\n0.3\n",
    "wanted.csv": "x,y,z\n0.018,0,0.199\n0.035,0,0.196\n",
    "modulus.toml": MEASURED + MODULUS,
    "touch.toml": MEASURED + TOUCH,
    "shapes.csv": SHAPES,
}
"""Files that are there before a command runs."""

COMMANDS = {
    "check": ["check", "wire.toml"],
    "check_time": ["check", "wire.toml", "--time"],
    "docs": ["docs", "command-line"],
    "solve": ["solve", "wire.toml", "--output", "out.json", "--plot", "out.svg"],
    "path": ["path", "wire.toml", "--input", "push.force", "--to", "[0.3,0,0]", "--output", "out.json"],
    "inverse": ["inverse", "wire.toml", "--output", "out.json"],
    "sweep": ["sweep", "wire.toml", "--over", "rows.csv", "--output", "out.csv", "--cores", "1"],
    "tune": ["tune", "wire.toml", "--range", "push.force.x=0:0.1", "--samples", "2", "--output", "out.toml"],
    "tubes": ["solve", "tubes.toml", "--output", "out.json", "--plot", "out.svg"],
    "export": ["export", "wire.toml", "--output", "out"],
    "export_tubes": ["export", "tubes.toml", "--output", "out"],
    "export_fmu": ["export", "wire.toml", "--fmu", "out.fmu"],
    "simulate": ["simulate", "wire.toml", "--output", "out.json", "--plot", "out.svg"],
    "modes": ["modes", "wire.toml", "--count", "2", "--output", "out.json", "--plot", "out.svg"],
    "inverse_table": ["inverse", "wire.toml", "--table", "wanted.csv", "--output", "out.csv"],
    "identify": [
        "identify",
        "modulus.toml",
        "--output",
        "out.json",
        "--write",
        "out.toml",
        "--plot",
        "out.svg",
    ],
    "estimate": ["estimate", "touch.toml", "--output", "out.csv", "--plot", "out.svg", "--cores", "1"],
    "new": ["new", "out.toml"],
    "examples": ["examples", "deep_arch", "--output", "out"],
}
"""One call of each command that ends by itself, with every file that it can write."""

READING = ("check", "check_time", "docs")
"""Those that write no file."""

UNTITLED = ("docs", "export_fmu", "tune", "inverse_table", "new", "examples")
"""Those that do not print the title of a scene."""

WRITERS = [name for name in COMMANDS if name not in READING]
"""Commands that write files."""

VIEW = ["view", "wire.toml", "--no-browser"]
"""The command that goes on until it is ended."""

UNREADY = {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
"""What makes a terminal know ASCII alone: Python's own ways round it are closed."""

SMALLEST_FILE = 150
"""Bytes that fit on the full disk: less than any result."""

PROGRAM = [sys.executable, "-B", "-c", "from cosserat_casadi.cli.main import main; main()"]
"""No compiled modules are kept: where the disk is full Python leaves them cut off beside the sources."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in GIVEN.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def start(
    arguments: list[str],
    folder: Path,
    setting: dict[str, str] | None = None,
    limit: Callable[[], None] | None = None,
) -> subprocess.Popen[bytes]:
    """A command on its way, with this setting of variables."""
    return subprocess.Popen(
        [*PROGRAM, *arguments],
        cwd=folder,
        env={**os.environ, **(setting or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=limit,
    )


def ended(process: subprocess.Popen[bytes]) -> tuple[int, str, str]:
    """Exit code, standard output and standard error, neither with a traceback."""
    output, errors = process.communicate(timeout=120)
    shown = output.decode()
    said = errors.decode()
    for text in (shown, said):
        assert "Traceback" not in text, text
        # What the package for options draws in place of a traceback.
        assert "Error │" not in text, text
    return process.returncode, shown, said


def new_files(folder: Path) -> list[str]:
    """What a command has left, without what was there before."""
    return sorted({path.name for path in folder.rglob("*")} - set(GIVEN))


def test_every_command_is_called() -> None:
    called = {arguments[0] for arguments in COMMANDS.values()}
    assert called | {VIEW[0]} == set(get_command(app).commands)


@pytest.mark.parametrize("command", mostly_slow(COMMANDS, quick=["check"]))
def test_terminals_that_know_ascii_alone(folder: Path, command: str) -> None:
    code, shown, said = ended(start(COMMANDS[command], folder, UNREADY))
    # The target lies beside the curve that the tip can move on.
    assert code == (NOT_FOUND if command == "inverse" else 0), said
    assert shown.isascii()
    assert said.isascii()
    if command not in UNTITLED:
        assert "dunn" in shown


@pytest.mark.slow
def test_units_are_written_in_plain_letters(folder: Path) -> None:
    _, shown, _ = ended(start(["solve", "wire.toml"], folder, UNREADY))
    assert "m^3" in shown
    assert "3 um^2 dunn" in shown
    _, shown, _ = ended(start(["solve", "wire.toml", "--json"], folder, UNREADY))
    assert json.loads(shown)["title"] == "Draht, 3 µm² dünn"


@pytest.mark.parametrize(
    ("letters", "plain"),
    [
        ("10⁶ N/m², 10⁻¹² s", "10^6 N/m^2, 10^-12 s"),
        ("½ ∂, 10½", "1/2 ?, 10 1/2"),
        ("λ, ξ and Γ in µm", "lambda, xi and Gamma in um"),
        ("Röhrchen, ẋ, −3 ≤ φ ≤ 4·10³", "Rohrchen, x, -3 <= phi <= 4.10^3"),
    ],
)
def test_plain_letters_keep_numbers(letters: str, plain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # The stream is prepared anew, and is not ours to keep.
    monkeypatch.setattr(sys, "stderr", sys.stderr)
    prepare_streams()
    assert letters.encode("ascii", errors=HANDLER).decode() == plain


def fill_disk() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALLEST_FILE, SMALLEST_FILE))


@pytest.mark.parametrize("command", mostly_slow(WRITERS, quick=["solve"]))
def test_full_disk(folder: Path, command: str) -> None:
    code, _, said = ended(start(COMMANDS[command], folder, limit=fill_disk))
    assert code == NOT_WRITTEN, said
    assert "could not be written:" in " ".join(said.split())
    assert [name for name in new_files(folder) if name != "out"] == []


@pytest.mark.slow
def test_full_disk_behind_standard_output(folder: Path) -> None:
    with (folder / "shown.json").open("wb") as shown:
        command = [*PROGRAM, "solve", "wire.toml", "--json"]
        done = subprocess.run(
            command, cwd=folder, stdout=shown, stderr=subprocess.PIPE, preexec_fn=fill_disk, timeout=120, check=False
        )
    assert done.returncode == NOT_WRITTEN
    assert b"Standard output" in done.stderr
    assert b"Traceback" not in done.stderr


SHELL = f"{shlex.join(PROGRAM)} "
"""What a line of a shell begins with that runs a command."""


def in_shell(folder: Path, line: str) -> subprocess.CompletedProcess[str]:
    """Run a line in a shell, which opens and closes streams."""
    return subprocess.run(
        ["sh", "-c", SHELL + line], cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell closes streams")
def test_results_for_a_standard_output_that_is_closed_are_told_to_be_lost(folder: Path) -> None:
    done = in_shell(folder, "solve wire.toml --json >&-")
    assert done.returncode == NOT_WRITTEN
    assert "Standard output or a temporary file could not be written: Bad file descriptor" in " ".join(
        done.stderr.split()
    )
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell closes streams")
def test_files_do_not_take_the_place_of_streams_that_are_closed(folder: Path) -> None:
    assert in_shell(folder, "solve wire.toml --output out.json >&- 2>&- <&-").returncode == 0
    assert json.loads((folder / "out.json").read_text())["converged"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="has no /dev/full")
@pytest.mark.parametrize(
    ("line", "code"),
    [("solve nowhere.toml", REFUSED), pytest.param("solve wire.toml", 0, marks=pytest.mark.slow)],
)
def test_a_standard_error_that_is_full_changes_no_exit_code(folder: Path, line: str, code: int) -> None:
    assert in_shell(folder, f"{line} 2>/dev/full").returncode == code


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell sets the variable")
@pytest.mark.parametrize("columns", ["0", "00", "''"])
def test_no_columns_are_those_of_a_pipe(folder: Path, columns: str) -> None:
    wanted = in_shell(folder, "solve --help").stdout
    shown = subprocess.run(
        ["sh", "-c", f"COLUMNS={columns} {SHELL} solve --help"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert shown.stdout == wanted
    assert len(wanted) > 100


@pytest.mark.slow
def test_a_reader_that_has_seen_enough(folder: Path) -> None:
    process = start(["solve", "wire.toml", "--json"], folder)
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    said = process.stderr.read().decode()
    process.stderr.close()
    assert process.wait(timeout=120) != 0
    assert "Traceback" not in said
    assert "Exception ignored" not in said


@pytest.mark.slow
@pytest.mark.parametrize("command", WRITERS)
def test_folder_that_takes_nothing(folder: Path, command: str) -> None:
    """/proc takes no file, even from a user who may write anywhere."""
    arguments = [f"/proc/{word}" if word.startswith("out") else word for word in COMMANDS[command]]
    code, _, said = ended(start(arguments, folder))
    assert code in (REFUSED, NOT_WRITTEN)
    assert "/proc" in said
    assert new_files(folder) == []


@pytest.mark.parametrize("unfinished", [atomic_file, atomic_folder])
def test_what_is_being_written_is_removed_before_an_abrupt_end(
    tmp_path: Path, unfinished: Callable[[Path], AbstractContextManager[Path]]
) -> None:
    with pytest.raises(WriteError), unfinished(tmp_path / "out") as part:
        assert part.parent == tmp_path
        assert part.exists()
        remove_temporary_files()
        assert list(tmp_path.iterdir()) == []
    assert list(tmp_path.iterdir()) == []


def listens(process: subprocess.Popen[bytes]) -> bool:
    """Whether the command has its handlers of signals: before, it is Python that is still being loaded."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt"))
    mask = int(caught.split()[1], 16)
    return bool(mask >> (signal.SIGTERM - 1) & 1)


def stopped(command: str, number: signal.Signals, delay: float, folder: Path) -> None:
    """Send a signal so long after the command has begun; it ends with its code, or was done already."""
    process = start(COMMANDS[command], folder)
    while process.poll() is None and not listens(process):
        time.sleep(0.01)
    time.sleep(delay)
    process.send_signal(number)
    code, shown, said = ended(process)
    expected = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}[number]
    # A signal that comes when all is written ends the process without a word.
    assert code in (expected, 0, NOT_FOUND, -number), said
    # A motion that was interrupted is told of, as far as it goes.
    if code == expected:
        assert "Stopped" in said or "was interrupted" in " ".join(shown.split())
    left = new_files(folder)
    assert [name for name in left if name.endswith(".part") and name != "out.csv.part"] == []
    if "out.json" in left:
        json.loads((folder / "out.json").read_text())


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_view_is_served_until_it_is_ended(folder: Path, number: signal.Signals) -> None:
    process = start(VIEW, folder, UNREADY)
    assert process.stdout is not None
    for line in process.stdout:
        if b"The robot is at http" in line:
            break
    process.send_signal(number)
    code, shown, said = ended(process)
    assert code == {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}[number], said
    assert shown.isascii()
    assert said.isascii()
    assert new_files(folder) == []


SIGNALS = (signal.SIGINT, signal.SIGTERM)
DELAYS = {"solve": 0.05, "sweep": 0.3, "export": 0.15, "simulate": 0.5}
MOMENTS = [(command, delay, number) for command, delay in DELAYS.items() for number in SIGNALS]


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc what a process listens to")
@pytest.mark.parametrize(
    ("command", "delay", "number"),
    mostly_slow(MOMENTS, quick=[("solve", 0.05, signal.SIGINT), ("sweep", 0.3, signal.SIGTERM)]),
)
def test_signals(folder: Path, command: str, delay: float, number: signal.Signals) -> None:
    stopped(command, number, delay, folder)


SWALLOWED = """
import ctypes, os, signal
import typer.core
from cosserat_casadi.cli import main
def stopped_in_c(*arguments, **options):
    # A call from C that raises: a library that prints the error by PyErr_Print, and goes on.
    ctypes.pythonapi.PyRun_SimpleString(b"import os, signal; os.kill(os.getpid(), signal.SIGINT)")
    return 0
typer.core.TyperGroup.main = stopped_in_c
main.main()
"""
"""A command in whose place a library in C swallows an interrupt."""


def test_an_interrupt_that_a_library_swallows_shows_no_traceback(folder: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", SWALLOWED], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    code, _, said = ended(process)
    assert said == ""
    assert code == 0


def test_an_interrupt_while_casadi_converts_a_matrix_is_raised_at_the_next_report(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    convert = np.ascontiguousarray
    signals = 0

    def interrupted(values: FloatArray) -> FloatArray:
        nonlocal signals
        signals += 1
        signal.raise_signal(signal.SIGINT)
        return convert(values)

    # CasADi calls this from C; an exception here came out as another error, in code that used the matrix.
    monkeypatch.setattr(np, "ascontiguousarray", interrupted)
    try:
        with remembered_interrupt() as raise_interrupt:
            matrix = ca.DM([[1.0, 2.0], [3.0, 4.0]]).full()
            np.testing.assert_array_equal(matrix, [[1.0, 2.0], [3.0, 4.0]])
            if not signals:
                pytest.skip("CasADi 3.7 converts matrices without NumPy's function")
            with pytest.raises(KeyboardInterrupt):
                raise_interrupt()
            with pytest.raises(KeyboardInterrupt):
                interrupted(matrix)
    finally:
        forget_signals()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc what a process listens to")
@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("delay", [0.0, 0.02, 0.1, 0.25, 0.6])
@pytest.mark.parametrize("command", COMMANDS)
def test_signals_at_every_moment(folder: Path, command: str, number: signal.Signals, delay: float) -> None:
    stopped(command, number, delay, folder)
