"""No command writes over what it reads: the scene, its tables, and what options name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.commands import WIRE, Ended, cosserat

SCENE = (
    'schema = 1\ninputs = ["push.force"]\naccuracy = { modes = 2, nodes = 4, tolerance = 0.05 }\n'
    + WIRE
    + """[simulation]
duration = 0.01
[[motions]]
input = "push.force"
file = "over_time"
[[measurements]]
quantity = "position"
file = "measured"
rod = "wire"
columns = ["x", "y", "z"]
sigma = 1e-3
[[unknowns]]
parameter = "wire.material.youngs_modulus"
[[targets]]
kind = "position"
rod = "wire"
position = [0.1, 0, 0.15]
"""
)

FILES = {
    "wire": SCENE,
    "wire.toml": SCENE,
    "over_time": "t,value.x,value.y,value.z\n0,0,0,0\n0.01,0.1,0,0\n",
    "measured": "x,y,z\n0.05,0,0.19\n",
    "cases": "push.force.x\n0.1\n",
    "targets": "x,y,z\n0.1,0,0.15\n",
    "start.json": "{}",
}
"""Names without suffix: a result may have any of them."""

COMMANDS = {
    "solve": "solve wire --output wire",
    "solve, a table of the scene": "solve wire.toml --output measured",
    "solve, a table of its motions": "solve wire.toml --output over_time",
    "path": "path wire --input push.force --to [0.1,0,0] --output wire",
    "path, points": "path wire --input push.force --to [0.1,0,0] --csv measured",
    "modes": "modes wire --output wire",
    "simulate": "simulate wire.toml --from start.json --output start.json",
    "inverse": "inverse wire --output wire",
    "inverse, table": "inverse wire.toml --table targets --output targets",
    "identify": "identify wire.toml --write wire.toml",
    "identify, measurements": "identify wire.toml --output measured",
    "sweep, indices": "sweep wire.toml --over cases --output rows.csv --sobol cases",
    "tune": "tune wire.toml --range push.force.x=0:0.1 --output wire.toml",
    "tune, cases": "tune wire.toml --over cases --output cases",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("command", COMMANDS)
def test_inputs_are_not_overwritten(folder: Path, command: str) -> None:
    ended = cosserat(*COMMANDS[command].split(), cwd=folder)
    _assert_kept(ended, folder)


OTHER_PATHS: dict[str, Callable[[Path, Path], None]] = {
    "symbolic link": lambda link, file: link.symlink_to(file.name),
    "hard link": lambda link, file: link.hardlink_to(file),
}


@pytest.mark.parametrize("kind", OTHER_PATHS)
def test_other_paths_to_an_input(folder: Path, kind: str) -> None:
    OTHER_PATHS[kind](folder / "other.toml", folder / "wire.toml")
    ended = cosserat("identify", "wire.toml", "--write", "other.toml", cwd=folder)
    _assert_kept(ended, folder)


def test_two_results_in_one_file_are_refused(folder: Path) -> None:
    ended = cosserat("path", "wire", "--input=push.force", "--to=[0,0,0]", "--output=a", "--csv=./a", cwd=folder)
    assert ended.returncode == 2
    assert "--csv: a is also the file of --output (name another file)" in ended.stderr


def test_a_folder_is_not_exported_over_its_own_scene(folder: Path) -> None:
    exported = cosserat("export", "wire.toml", "--output", "c", cwd=folder)
    assert exported.returncode == 0, exported.stderr
    before = {file.name: file.read_bytes() for file in (folder / "c").iterdir()}
    ended = cosserat("export", "c/scene.toml", "--output", "c", cwd=folder)
    assert ended.returncode == 2
    assert ", and would overwrite it" in ended.stderr
    assert {file.name: file.read_bytes() for file in (folder / "c").iterdir()} == before


def _assert_kept(ended: Ended, folder: Path) -> None:
    assert ended.returncode == 2, ended.stderr
    assert ", and would overwrite it" in " ".join(ended.stderr.split())
    for name, text in FILES.items():
        assert (folder / name).read_text() == text
