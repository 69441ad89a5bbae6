"""``cosserat simulate`` as a user meets it; the motion itself is made up."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
import types
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cosserat_casadi import Scene, Solution
from cosserat_casadi.cli.exit_codes import INTERRUPTED, NOT_FOUND, REFUSED, TERMINATED
from cosserat_casadi.cli.main import app, run
from cosserat_casadi.motion.event_restart import ContactEvent
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome, MotionProgress
from tests.commands import WIRE
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.motions import motion_of, without_start

SCENE = (
    """
schema = 1
title = "A wire"
inputs = ["push.force"]
accuracy = { modes = 3, nodes = 8 }
"""
    + WIRE
)

SIMULATION = """
[simulation]
duration = 0.2
frames = 5
"""

Simulate = Callable[..., Motion]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "still.toml").write_text(SCENE)
    (tmp_path / "wire.toml").write_text(SCENE + SIMULATION)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def swing(
    scene: Scene, *, start: Solution | None = None, progress: Any = None, compiled: Any = None, **_: Any
) -> Motion:
    """Stands for the simulation: it reports as one does, and comes to the end."""
    assert scene.simulation is not None
    duration = scene.simulation.duration
    for reached in (0.0, duration):
        progress(MotionProgress("Simulating", reached, duration, 1e-3))
    frames = len(scene.simulation.frame_times)
    return motion_of(scene, {"push.force": [0.1, 0.3, 0.0]}, duration=duration, frames=frames)


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Runs the command with a stand-in for the simulation; returns the exit code."""

    def run_with(*arguments: str, simulate: Simulate = swing) -> int:
        module = types.ModuleType("cosserat_casadi.motion.motion_refinement")
        module.simulate = simulate  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, module.__name__, module)
        return run(lambda **options: app(["simulate", *arguments], **options))

    return run_with


def new_files(folder: Path) -> list[str]:
    return sorted({path.name for path in folder.iterdir()} - {"still.toml", "wire.toml"})


def test_all_files_are_written_and_the_report_is_in_words(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    files = ["--output", "m.json", "--plot", "m.png", "--animation", "m.gif"]
    assert command("wire.toml", *files) == 0
    assert new_files(folder) == ["m.gif", "m.json", "m.png"]
    assert (folder / "m.gif").read_bytes().startswith(b"GIF8")
    assert (folder / "m.png").read_bytes().startswith(b"\x89PNG")
    data = json.loads((folder / "m.json").read_text())
    assert data["converged"] is True
    assert len(data["times"]) == 5
    shown = " ".join(capsys.readouterr().out.split())
    assert shown.startswith("A wire Motion computed to its end.")
    for words in (
        "at t = 0.2 s",
        "tip position, m",
        "start: At rest in the equilibrium",
        "steps: 57 of 0.00025 to 0.03 s, 3 rejected; 211 iterations, 18 Jacobians",
        "estimated error of the paths: 6.0e-06 m, 3.0e-05 of the length",
        "energies balance to",
        "wire: modes [3, 3, 3], 8 intervals",
        "wrote m.json",
        "wrote m.gif",
    ):
        assert words in shown


def test_an_error_above_the_tolerance_is_told(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    def coarse(scene: Scene, **options: Any) -> Motion:
        return replace(swing(scene, **options), tolerance=1e-5)

    assert command("wire.toml", "--output", "m.json", simulate=coarse) == 0
    assert json.loads((folder / "m.json").read_text())["within_tolerance"] is False
    assert "3.0e-05 of the length, above the tolerance of 1e-05" in " ".join(capsys.readouterr().out.split())


def test_moving_meshes_are_written_at_a_speed(folder: Path, command: Callable[..., int]) -> None:
    assert command("wire.toml", "--animation", "m.usda", "--speed", "0.5") == 0
    assert new_files(folder) == ["m.usda"]
    assert "endTimeCode = 40\n" in (folder / "m.usda").read_text()


@pytest.mark.parametrize(
    ("lift_offs", "words"),
    [(1, "1 impact, which took 0.5 J ± 0.02 J, 1 lift-off"), (2, "2 lift-offs")],
)
def test_contacts_are_counted_in_words(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str], lift_offs: int, words: str
) -> None:
    leaving = ContactEvent("lift_off", 0.1, "wire", "ball", 0.5)
    events = (ContactEvent("impact", 0.05, "wire", "ball", 0.5, energy=0.5), *[leaving] * lift_offs)

    def touch(scene: Scene, **options: Any) -> Motion:
        return replace(swing(scene, **options), events=events, impacts_spread=0.02)

    assert command("wire.toml", simulate=touch) == 0
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert any(line.startswith("contact: ") and line.endswith(words) for line in lines)


def test_options_override_the_scene(folder: Path, command: Callable[..., int]) -> None:
    seen: list[Scene] = []

    def remember(scene: Scene, **options: Any) -> Motion:
        seen.append(scene)
        return swing(scene, **options)

    given = ["--duration", "0.5", "--frames", "7", "--tolerance", "1e-5", "--set", "simulation.duration=9"]
    assert command("still.toml", *given, "--output", "m.npz", simulate=remember) == 0
    simulation = seen[0].simulation
    assert simulation is not None
    assert (simulation.duration, simulation.frames, simulation.tolerance) == (0.5, 7, 1e-5)
    assert command("wire.toml", "--step", "1e-3", simulate=remember) == 0
    assert seen[1].simulation is not None
    assert seen[1].simulation.step == 1e-3
    assert new_files(folder) == ["m.npz"]


def test_a_motion_may_start_from_a_result(folder: Path, command: Callable[..., int]) -> None:
    starts: list[Solution | None] = []

    def remember(scene: Scene, *, start: Solution | None, progress: Any, compiled: Any, **_: Any) -> Motion:
        starts.append(start)
        return swing(scene, progress=progress)

    assert run(lambda **options: app(["solve", "wire.toml", "--output", "r.json"], **options)) == 0
    assert command("wire.toml", "--from", "r.json", "--set", "push.force=[0,0,0]", simulate=remember) == 0
    assert command("wire.toml", simulate=remember) == 0
    assert isinstance(starts[0], Solution)
    # The motion has other inputs than its start: that is how a rod is let go.
    assert starts[0].inputs.tolist() == [0.2, 0.0, 0.0]
    assert starts[1] is None


@pytest.mark.parametrize(
    "outcome", mostly_slow([MotionOutcome.STEP_TOO_SMALL, MotionOutcome.UNRESOLVED], quick=[MotionOutcome.UNRESOLVED])
)
def test_a_motion_that_ended_early_is_written_with_exit_code_3(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str], outcome: MotionOutcome
) -> None:
    def end_early(scene: Scene, **options: Any) -> Motion:
        return replace(swing(scene, **options), outcome=outcome, message=outcome.value)

    assert command("wire.toml", "--output", "m.json", "--plot", "m.svg", simulate=end_early) == NOT_FOUND
    data = json.loads((folder / "m.json").read_text())
    assert data["converged"] is False
    assert data["outcome"] == outcome.label
    assert new_files(folder) == ["m.json", "m.svg"]
    assert outcome.value.split(":")[0] in " ".join(capsys.readouterr().out.split())


def test_a_motion_that_was_not_started_has_no_picture(folder: Path, command: Callable[..., int]) -> None:
    files = ["--output", "m.csv", "--plot", "m.png", "--animation", "m.gif"]
    assert command("wire.toml", *files, simulate=lambda scene, **_: without_start()) == NOT_FOUND
    assert new_files(folder) == ["m.csv"]


def test_why_a_motion_was_not_started_is_told_once(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    reason = "No equilibrium found: the rod buckles."
    unstarted = replace(without_start(), message=f"{without_start().message} {reason}", start=reason)
    assert command("wire.toml", simulate=lambda scene, **_: unstarted) == NOT_FOUND
    assert " ".join(capsys.readouterr().out.split()).count(reason) == 1


def test_warnings_go_to_standard_error(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    warning = "push.force jumps at t = 0.1 s: digits are limited."

    def warned(scene: Scene, **options: Any) -> Motion:
        return replace(swing(scene, **options), warnings=(warning,))

    assert command("wire.toml", simulate=warned) == 0
    shown = capsys.readouterr()
    assert warning in " ".join(shown.err.split())
    assert warning not in " ".join(shown.out.split())


@pytest.mark.slow
def test_a_hasty_animation_is_told_how_to_slow_down(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command("wire.toml", "--animation", "m.gif") == 0
    assert "The animation has 6 frames: add --speed 0.04" in " ".join(capsys.readouterr().err.split())
    assert command("wire.toml", "--animation", "m.gif", "--speed", "0.4") == 0
    assert "--speed" not in capsys.readouterr().err


def never(scene: Scene, **options: Any) -> Motion:
    """Stands for the simulation where what is asked for is refused before."""
    raise AssertionError


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["still.toml", "--output", "m.json"], ["simulation: missing", "add a table [simulation]", "--duration"]),
        (["wire.toml", "--output", "m.mat"], ["--output", "one of .json, .csv, .parquet, .npz"]),
        (["wire.toml", "--output", "no/m.json"], ["--output", "does not exist"]),
        (["wire.toml", "--plot", "m.gif"], ["--plot", ".png, .pdf, .svg"]),
        (["wire.toml", "--animation", "m.avi"], ["--animation", "one of .gif, .mp4, .glb, .usda"]),
        (["wire.toml", "--animation", "no/m.gif"], ["--animation", "does not exist"]),
        (["wire.toml", "--speed", "0"], ["--speed", "must be > 0, got 0"]),
        (["wire.toml", "--speed", "nan"], ["--speed", "must be > 0, got nan"]),
        (["wire.toml", "--duration", "-1"], ["--duration: must be > 0"]),
        (["wire.toml", "--step", "0.5"], ["--step: must be <= duration"]),
        (["wire.toml", "--step", "1e-12"], ["--step: makes more than 10,000,000 steps"]),
        (["wire.toml", "--from", "missing.json"], ["--from", "missing.json cannot be read"]),
        (["wire.toml", "--from", "wire.toml"], ["--from", "is not JSON"]),
        (["missing.toml"], ["missing.toml"]),
    ],
)
def test_refusals(
    folder: Path,
    command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: list[str],
) -> None:
    assert command(*arguments, simulate=never) == REFUSED
    said = " ".join(capsys.readouterr().err.split())
    for word in words:
        assert word in said
    assert new_files(folder) == []


def test_all_problems_are_told_at_once(
    folder: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = ["--output", "no/m.mat", "--animation", "m.avi", "--speed", "-1"]
    assert command("still.toml", *wrong, simulate=never) == REFUSED
    assert "5 problems" in capsys.readouterr().err


def test_mp4_without_ffmpeg_is_refused_before_the_simulation(
    folder: Path, command: Callable[..., int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(folder))
    assert command("wire.toml", "--animation", "m.mp4", simulate=never) == REFUSED
    assert "MP4 needs the program ffmpeg" in " ".join(capsys.readouterr().err.split())


INTERRUPTED_RUN = """
import sys, time, types
from dataclasses import replace
from cosserat_casadi.cli.main import main
from cosserat_casadi.motion.trajectory import MotionOutcome, MotionProgress
from tests.motions import motion_of

def simulate(scene, *, start, progress, compiled, **_):
    motion = motion_of(scene, {"push.force": [0.1, 0.3, 0.0]}, duration=0.2, frames=5)
    outcome = MotionOutcome.INTERRUPTED
    try:
        for _ in range(1000):
            progress(MotionProgress("Simulating", 0.1, 0.2, 1e-3))
            print("stepping", flush=True)
            time.sleep(0.05)
    except KeyboardInterrupt:
        return replace(motion, outcome=outcome, message=outcome.value)

module = types.ModuleType("cosserat_casadi.motion.motion_refinement")
module.simulate = simulate
sys.modules[module.__name__] = module
main()
"""


@pytest.mark.parametrize(
    ("number", "code"),
    mostly_slow([(signal.SIGINT, INTERRUPTED), (signal.SIGTERM, TERMINATED)], quick=[(signal.SIGTERM, TERMINATED)]),
)
def test_an_interrupted_simulation_writes_what_it_has(folder: Path, number: signal.Signals, code: int) -> None:
    files = ["--output", "m.json", "--plot", "m.png", "--animation", "m.gif"]
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED_RUN, "simulate", "wire.toml", *files],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "stepping\n"
    time.sleep(0.1)
    process.send_signal(number)
    shown, said = process.communicate(timeout=60)
    assert process.returncode == code, said
    assert "Traceback" not in said
    assert "it was interrupted" in shown
    assert "wrote m.json" in shown
    assert new_files(folder) == ["m.json"]
    data = json.loads((folder / "m.json").read_text())
    assert data["converged"] is False
    assert data["outcome"] == "interrupted"
