"""The command as a whole: options that are refused before anything is computed or written, and interrupts."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cosserat_casadi import SceneError, Solution, solve, sweep
from cosserat_casadi.cli.exit_codes import INTERRUPTED, REFUSED
from cosserat_casadi.scene.writing import scene_text
from tests.commands import cosserat
from tests.scenes import rod, scene
from tests.sweeps.conftest import PLANAR


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scene.toml").write_text(scene_text(PLANAR))
    (tmp_path / "grid.toml").write_text("push.force.x = [0.0, 0.1]")
    return tmp_path


def refused(folder: Path, *words: str) -> str:
    """What a sweep that is refused says, on one line."""
    before = sorted(file.name for file in folder.iterdir())
    over = [] if "--range" in words else ["--over", "grid.toml"]
    ended = cosserat("sweep", "scene.toml", *over, *words, cwd=folder)
    assert ended.returncode == REFUSED
    assert sorted(file.name for file in folder.iterdir()) == before
    return " ".join(ended.stderr.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--output", "a.csv", "--colour", "rod.x"), ["--colour: is for a figure"]),
        (("--output", "a.csv", "--plot", "a.png", "--colour", "x"), ["'x' is no column (there are outcome, push.f"]),
        (("--output", "a.csv", "--cores", "0"), ["--cores"]),
        (("--output", "a.csv", "--cores", "1", "--scheduler", "tcp://127.0.0.1:1"), ["--cores: are those of this"]),
        (("--output", "no/a.csv", "--colour", "rod.x"), ["the folder no does not exist", "--colour: is for a figure"]),
        (
            ("--output", "a.csv", "--range", "push.force.x=0:1"),
            ["does not say how many values (write push.force.x=0:1:21"],
        ),
        (("--output", "a.csv", "--range", "push.force.x=0:1:many"), ["has no whole number of values"]),
        # Colons about a letter are no emoji.
        (("--output", "a.csv", "--range", "push.force.x=a:b:3"), ["'push.force.x=a:b:3' has no two finite numbers"]),
        (
            ("--output", "a.csv", "--range", "push.force=0:1:300"),
            ["Refused: 1 problem", "'push.force' has 3 numbers", "name its entries: push.force.x, push.force.y, push"],
        ),
        (("--output", "a.csv", "--range", "push.force.x=0:1:1"), ["has one value between two ends"]),
        (
            ("--output", "a.csv", "--range", "push.force.x=0:1:10000", "--range", "push.force.z=0:1:10000"),
            ["asks for 100,000,000 rows"],
        ),
        (("--output", "a.csv", "--range", "push.force.x=0:1:2", "--range", "push.force.x=0:1:2"), ["has two ranges"]),
        (
            ("--output", "a.csv", "--over", "grid.toml", "--range", "push.force.x=0:1:2"),
            ["'push.force.x' is a column of grid.toml too"],
        ),
        (
            ("--output", "a.csv", "--sobol", "i.json", "--range", "push.force.x=0:1:2"),
            ["--sobol: needs random columns, and --over is missing"],
        ),
        (("--output", "no/a.csv", "--plot", "a.bmp", "--over", "b.csv"), ["folder no", "--plot", "b.csv: cannot be"]),
    ],
)
def test_options_that_are_refused(folder: Path, words: tuple[str, ...], said: list[str]) -> None:
    told = refused(folder, *words)
    for one in said:
        assert one in told


def test_the_extra_that_lacks_is_named_whole(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert "pip install 'cosserat-casadi[sweep]'" in refused(folder, "--output", "a.parquet")


def test_no_core_is_refused() -> None:
    with pytest.raises(SceneError, match="--cores: must be at least 1, got 0"):
        sweep(PLANAR, {"push.force.x": [0.1]}, cores=0)


def test_a_body_named_as_a_rod_is_refused() -> None:
    joint = {"body": "rod", "rod": "rod", "kind": "fixed"}
    given = scene(rods=[rod()], bodies=[{"name": "rod", "mass": 0.1}], joints=[joint])
    with pytest.raises(SceneError, match=r"bodies\[0\]\.name: 'rod' is the name of a rod too"):
        sweep(given, {"rod.length": [0.5]})


@pytest.mark.parametrize("command", ["sweep", "solve"])
def test_an_interrupt_that_is_lost_stops_the_command(
    command: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As CasADi loses what is raised while it looks at its arguments."""

    def losing(solver: Callable[..., Solution]) -> Callable[..., Solution]:
        def lose(*given: Any, **more: Any) -> Solution:
            try:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(1.0)
            except KeyboardInterrupt:
                lost.append(True)
            return solver(*given, **more)

        return lose

    lost: list[bool] = []
    # What this process has received is no signal to the commands of other tests.
    monkeypatch.setattr("cosserat_casadi.cli.signals._received", [])
    monkeypatch.setattr("cosserat_casadi.sweeps.choice.solve", losing(solve))
    monkeypatch.setattr("cosserat_casadi.cli.commands.solve.solve_scene", losing(solve))
    words = {"sweep": ["--over", "grid.toml", "--output", "out.csv"], "solve": ["--output", "out.json"]}[command]
    before = signal.getsignal(signal.SIGINT)
    ended = cosserat(command, "scene.toml", *words, cwd=folder)
    assert ended.returncode == INTERRUPTED
    assert lost == [True]
    assert signal.getsignal(signal.SIGINT) is before
    # A stopped sweep keeps the rows that it has, under a name of their own.
    assert not [file for file in ("out.csv", "out.json") if (folder / file).exists()]
    assert "Stopped" in ended.stderr
