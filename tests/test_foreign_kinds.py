"""The families are open: a load and an actuator that do not ship, known to this file alone, run through everything.

Each is one record, one class and one registration. Nothing else of the package, its documents or its tests has heard
of them.
"""

from __future__ import annotations

import csv
import json
import shutil
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from pydantic import Field

from cosserat_casadi import load, read_scene, scene_from_dict, solve_scene
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.cli.main import REFUSED, app, run
from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.registry import register
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.rod.actuation import StrainSum
from cosserat_casadi.scene.actuators import ActuatorRecord
from cosserat_casadi.scene.inputs import InputField
from cosserat_casadi.scene.loads import LoadRecord
from tests.initial_value import integrate
from tests.registration import forget

STIFFNESS = 3.0
ANCHOR = np.array([0.15, 0.05, 0.25])
CONTRACTION = 0.4


class SpringRecord(LoadRecord):
    """A spring from a section to a point of the world."""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "anchor": InputField("m", 3, axes="world"),
        "stiffness": InputField("N/m", 1, positive=True),
    }
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["spring_to_point"] = Field(description="spring from a section to a point of the world")
    rod: str = Field(description="name of the rod that it is tied to")
    at: float = Field(1.0, gt=0.0, le=1.0, description="abscissa X of the section, without unit")
    anchor: tuple[float, float, float] = Field(description="the point of the world, m")
    stiffness: float = Field(gt=0.0, description="force per length, N/m")


class Spring(Load[SpringRecord]):
    """k (a − r) on the section."""

    record = SpringRecord

    def abscissa(self, load: SpringRecord) -> float:
        return load.at

    def energy(self, load: SpringRecord, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        return values["stiffness"] / 2 * ca.sumsqr(section.position - values["anchor"])


class MuscleRecord(ActuatorRecord):
    """A muscle along the rod that bends it."""

    inputs: ClassVar[Mapping[str, InputField]] = {"contraction": InputField("N m", 1, lower=0.0)}
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["muscle"] = Field(description="muscle along the rod")
    rod: str = Field(description="name of the rod that it bends")
    span: tuple[float, float] = Field((0.0, 1.0), description="where it begins and ends, X, without unit")
    contraction: float = Field(ge=0.0, description="bending moment, N m")


class Muscle(Actuator[MuscleRecord]):
    """A moment that works on the total turn about the y axis of the sections."""

    record = MuscleRecord
    effort = "contraction"
    conjugate = "turn"
    conjugate_unit = "rad"
    energy_sign = -1.0

    def quantity(self, actuator: MuscleRecord, grid: Grid) -> StrainSum:
        inside = (grid.nodes >= actuator.span[0]) & (grid.nodes <= actuator.span[1])
        return StrainSum((1,), inside[None, :].astype(float))


SCENE = f"""
schema = 1
title = "A finger on a spring"
inputs = ["spring.anchor", "muscle.contraction", "push.force"]
accuracy = {{ tolerance = 1e-6 }}
[[rods]]
name = "finger"
length = 0.3
strain = "kirchhoff"
stiffness = {{ bending_x = 0.05, bending_y = 0.06, torsion = 0.04 }}
linear_density = 0.02
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.02, -0.03, 0]
[[loads]]
name = "spring"
kind = "spring_to_point"
rod = "finger"
anchor = {ANCHOR.tolist()}
stiffness = {STIFFNESS}
[[actuators]]
name = "muscle"
kind = "muscle"
rod = "finger"
contraction = {CONTRACTION * 0.05}
"""


@pytest.fixture(autouse=True)
def foreign() -> Iterator[None]:
    members: tuple[Any, ...] = (Spring, Muscle)
    for member in members:
        register(member)
    yield
    for member in members:
        forget(member)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "finger.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def cosserat(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["cosserat", *words])
    return run(app)


def test_solve_report_and_plot(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code = cosserat(monkeypatch, "solve", "finger.toml", "--output", "finger.json", "--plot", "finger.png")
    printed = capsys.readouterr().out
    assert code == 0, printed
    assert "muscle" in printed
    assert (folder / "finger.png").stat().st_size > 10_000
    result = json.loads((folder / "finger.json").read_text())
    assert result["converged"]
    assert result["stable"] is True
    assert result["actuators"]["muscle"]["contraction"] == CONTRACTION * 0.05
    assert result["actuators"]["muscle"]["turn"] > 0.0


def test_solution_vs_initial_value(folder: Path) -> None:
    """The clamp's wrench, the pull of the spring and the moment of the muscle lead to the tip that is reported."""
    scene = read_scene(folder / "finger.toml")
    solution = solve_scene(scene)
    assert solution.converged
    tip = solution.tip().position[0]
    pull = STIFFNESS * (ANCHOR - tip)
    weight = 0.02 * 0.3 * np.array([0, 0, -9.81])
    push = np.array([0.02, -0.03, 0.0])
    assert_allclose(solution.base_wrench().force, -(pull + weight + push), rtol=0, atol=1e-6)
    # The same rod with the spring's pull as a dead force, the muscle's moment as pre-curvature.
    curvature = CONTRACTION * 0.05 / 0.06
    rod = {
        "name": "finger",
        "length": 0.3,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 0.05, "bending_y": 0.06, "torsion": 0.04},
        "linear_density": 0.02,
        "intrinsic": {"curvature": [0, curvature, 0], "tangent": [0, 0, 1]},
    }
    tables: dict[str, Any] = {
        "schema": 1,
        "rods": [rod],
        "loads": [
            {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]},
            {"name": "push", "kind": "tip_wrench", "rod": "finger", "force": (push + pull).tolist()},
        ],
    }
    reached = integrate(scene_from_dict(tables), solution.base_wrench().force, solution.base_wrench().moment)
    assert_allclose(reached.position, tip, rtol=0, atol=2e-6 * 0.3)


def test_an_actuator_without_routing_is_named_and_not_drawn(folder: Path) -> None:
    solution = solve_scene(read_scene(folder / "finger.toml"))
    legend = plot_solution(solution).axes[0].get_legend_handles_labels()[1]
    assert "muscle: 0.02 N m" in legend


def test_check_names_it_and_its_price(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cosserat(monkeypatch, "check", "finger.toml") == 0
    printed = capsys.readouterr().out
    assert "spring_to_point" in printed
    assert "muscle" in printed


def test_path(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["--input", "push.force", "--to", "[0.3,0,0]", "--output", "path.json", "--plot", "path.png"]
    assert cosserat(monkeypatch, "path", "finger.toml", *words) == 0
    path = json.loads((folder / "path.json").read_text())
    assert path["outcome"] == "converged"


def test_inverse(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pose that other inputs lead to is found again, by the spring's end and the muscle alone."""
    driven = SCENE.replace('"muscle.contraction", "push.force"]', '"muscle.contraction"]')
    moved = read_scene(_written(folder / "moved.toml", driven), ("spring.anchor=[0.16,0.06,0.26]",))
    wanted = solve_scene(moved, {"muscle.contraction": 0.03}).tip().position[0]
    target = f'[[targets]]\nkind = "position"\nrod = "finger"\nposition = {wanted.tolist()}\n'
    ranges = (("spring.anchor", -1.0, 1.0), ("muscle.contraction", 0.0, 0.1))
    bounds = [f'[[bounds]]\ninput = "{name}"\nlower = {low}\nupper = {high}\n' for name, low, high in ranges]
    _written(folder / "wanted.toml", driven + target + "".join(bounds))
    assert cosserat(monkeypatch, "inverse", "wanted.toml", "--output", "found.json") == 0
    file = json.loads((folder / "found.json").read_text())
    assert_allclose(file["rods"]["finger"]["tip"]["position"], wanted, rtol=0, atol=1e-5)


def _written(file: Path, text: str) -> Path:
    file.write_text(text)
    return file


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
def test_export_load_and_sweep(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _written(folder / "finger.toml", SCENE.replace("tolerance = 1e-6", "modes = 3, nodes = 6, tolerance = 0.05"))
    assert cosserat(monkeypatch, "export", "finger.toml", "--output", "finger", "--derivatives") == 0
    library = load(folder / "finger")
    solution = solve_scene(read_scene(folder / "finger.toml"))
    found = library.solve()
    assert found.converged
    position = library.tip["finger"](found.x, library.defaults)[0].full()[:, 0]
    assert_allclose(position, solution.tip().position[0], rtol=0, atol=1e-9)
    grid = "push.force.x = [0.0, 0.1, 0.2]\nspring.anchor.y = [0.0, 0.1]\nspring.stiffness = [2.0, 3.0]\n"
    (folder / "grid.toml").write_text(grid)
    assert cosserat(monkeypatch, "sweep", "finger.toml", "--over", "grid.toml", "--output", "rows.csv") == 0
    rows = list(csv.DictReader((folder / "rows.csv").read_text().splitlines()))
    assert len(rows) == 12
    assert {row["outcome"] for row in rows} == {"converged"}
    assert "muscle.turn" in rows[0]


def test_bad_tables_are_refused_in_plain_words(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = SCENE.replace("stiffness = 3.0", "stiffness = -3.0").replace(
        'kind = "muscle"\nrod = "finger"', 'kind = "muscle"\nrod = "thumb"'
    )
    (folder / "bad.toml").write_text(bad)
    assert cosserat(monkeypatch, "check", "bad.toml") == REFUSED
    told = capsys.readouterr().err
    assert "loads[2].stiffness" in told
    assert "actuators[0].rod" in told
    assert "no rod is named 'thumb'" in told
