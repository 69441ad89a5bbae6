"""Commands that do not hear of a signal themselves, as inside a call of CasADi, end all the same."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from cosserat_casadi.cli.exit_codes import INTERRUPTED, TERMINATED

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of a POSIX system")

DEAF = """
import tempfile, threading, time
from pathlib import Path
from cosserat_casadi.cli import main as command_line

def deaf(**options):
    folder = tempfile.mkdtemp()
    Path("temporary").write_text(folder)
    {before}
    words = iter(["begun", "heard", "heard again"])
    while True:
        try:
            print(next(words), flush=True)
            time.sleep(1000.0)
        except KeyboardInterrupt:
            # As CasADi takes whatever Python raises for a refusal of an argument.
            pass

command_line.typer.main.get_command = lambda app: deaf
command_line.main()
"""


TAKES_TIME = "from cosserat_casadi.cli.signals import take_time; take_time()"


@pytest.mark.parametrize(
    ("before", "numbers", "code"),
    [
        ("pass", [signal.SIGINT], INTERRUPTED),
        ("pass", [signal.SIGTERM], TERMINATED),
        # One that writes what it has is waited for, until the user does not want to wait.
        (TAKES_TIME, [signal.SIGTERM, signal.SIGINT], TERMINATED),
    ],
)
def test_a_command_that_does_not_hear_is_ended(
    tmp_path: Path, before: str, numbers: list[signal.Signals], code: int
) -> None:
    command = [sys.executable, "-c", DEAF.format(before=before)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=tmp_path, **pipes) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        first, *others = numbers
        process.send_signal(first)
        for number in others:
            # A system hands over signals that come at once in the order of their numbers, not in that of their coming.
            assert process.stdout.readline() == "heard\n"
            process.send_signal(number)
        _, said = process.communicate(timeout=120)
    assert process.returncode == code
    assert said == "Stopped. Unfinished files were not written.\n"
    # What was temporary has gone with it.
    assert not Path((tmp_path / "temporary").read_text()).exists()
