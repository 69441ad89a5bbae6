"""Stability judged in C beside the same in Python, which goes another way: singular values and dense eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, ExportError, Model, Scene, build, discretise, export, follow, load, solve
from cosserat_casadi.codegen.compiled_results import CompiledStability
from cosserat_casadi.codegen.stability import stability_files
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, stability_of, variations
from tests.codegen.libraries import ARMS, C99, HAND, HELD, LOAD, TENDON, WRISTS, attempt
from tests.scenes import push, scene, three_cables

CRITICAL = np.pi**2 / 4
"""Euler's load of a clamped-free column, in EI/L²."""

ROUND = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.7}


def column(strain: str, **changes: Any) -> Scene:
    """A rod of length 1 along z with unit bending stiffness, round where it is not planar."""
    stiffness = ROUND if strain == "kirchhoff" else {"bending_y": 1.0}
    upright = {"name": "rod", "length": 1.0, "strain": strain, "stiffness": stiffness}
    return scene(push(force=[0.0, 0.0, 0.0]), rods=[upright], **changes)


PINNED = [{"rod": "rod", "kind": "pinned", "position": [0, 0, 0.9]}]
PRESSED = [{"rod": "rod", "kind": "pinned", "position": [0, 0, 0.105]}]
GUY = {"name": "guy", "kind": "tendon", "rod": "rod", "length": 1.0, "offset": [0.02, 0.0], "slack": False}
SCENES = {
    "planar": (column("planar"), 6, 12, "magnus6"),
    "adjustable": (column("planar", parameters=["rod.stiffness.bending_y"]), 6, 12, "magnus6"),
    "round": (column("kirchhoff"), 4, 8, "magnus6"),
    "guyed": (column("kirchhoff", actuators=[GUY]), 4, 8, "magnus6"),
    "pinned": (column("kirchhoff", supports=PINNED), 5, 10, "magnus4"),
    "pressed": (column("kirchhoff", supports=PRESSED), 7, 16, "magnus4"),
    "robot": (scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS), 2, 4, "magnus4"),
    "cables": (three_cables(), 2, 4, "magnus4"),
    "tendons": (scene(push(), strain="reissner", actuators=[TENDON, HELD]), 2, 4, "magnus4"),
}


class Library:
    """A model and its compiled library with stability."""

    def __init__(self, name: str, folder: Path) -> None:
        chosen, modes, nodes, rotation = SCENES[name]
        self.model: Model = build(chosen, discretise(chosen, modes, nodes, rotation))
        self.folder = export(self.model, folder / name, name, stability=True)
        self.compiled: Compiled = load(self.folder)

    def judged(self, x: np.ndarray, inputs: np.ndarray) -> CompiledStability:
        """What C says of an equilibrium, once its eigenvalues are those of Python."""
        found = self.compiled.stability(inputs, x)
        assert found is not None
        jacobian = self.model.path_jacobian(x, inputs, 1.0).full()
        eigenvalues = admissible_eigenvalues(jacobian, variations(self.model))
        expected = stability_of(eigenvalues)
        assert_allclose(
            found.smallest_eigenvalue, expected.smallest_eigenvalue, rtol=1e-8, atol=1e-11 * np.abs(eigenvalues).max()
        )
        assert (found.negative, found.zero) == (expected.negative, expected.zero)
        return found


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Library]:
    """Libraries with stability by the name of their scene."""
    folder = tmp_path_factory.mktemp("stability")

    @cache
    def made(name: str) -> Library:
        return Library(name, folder)

    return made


@pytest.mark.parametrize(
    ("name", "share", "verdict", "negative"),
    [
        ("planar", 0.99, "stable", 0),
        ("planar", 1.01, "unstable", 1),
        ("planar", 9.1, "unstable", 2),
        ("round", 0.99, "stable", 0),
        ("round", 1.01, "unstable", 2),
        pytest.param("guyed", 1.01, "unstable", 1, marks=pytest.mark.slow),
    ],
)
def test_column_about_its_critical_loads(
    library: Callable[[str], Library], name: str, share: float, verdict: str, negative: int
) -> None:
    """Euler's loads of a clamped-free column are π²/4, nine times that and so on, once for each plane.

    A cable of given length beside the axis leaves the column only one plane to buckle in.
    """
    made = library(name)
    inputs = made.model.pack({"push.force": [0.0, 0.0, -share * CRITICAL]})
    solution = made.compiled.solve(inputs)
    assert solution.converged
    found = made.judged(solution.x, inputs)
    assert (found.verdict, found.negative, found.stable) == (verdict, negative, verdict == "stable")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["robot", "tendons", "cables"])
def test_constrained_equilibria_beside_python(library: Callable[[str], Library], name: str) -> None:
    """Loops, cables of given length, taut and slack: the same eigenvalues and verdicts as in Python."""
    made = library(name)
    rng = np.random.default_rng(1)
    own = made.model.pack()
    forces = [entries for entry, entries in made.model.inputs if entry.unit in ("N", "N m")]
    verdicts = set()
    for _ in range(8):
        inputs = own * rng.uniform(0.95, 1.05, len(own))
        for entries in forces:
            inputs[entries] += rng.uniform(-4.0, 4.0, inputs[entries].shape)
        solution = made.compiled.solve(inputs)
        if solution.converged:
            verdicts.add(made.judged(solution.x, inputs).verdict)
    assert "stable" in verdicts


@pytest.mark.slow
def test_neutral_equilibrium_is_stable(library: Callable[[str], Library]) -> None:
    """A round rod pushed together turns about its axis at no cost."""
    pinned = library("pinned")
    inputs = pinned.model.pack()
    bent = solve(pinned.model, stable=True)
    assert bent.stable is True
    found = pinned.judged(bent.x, inputs)
    assert (found.verdict, found.zero, found.stable) == ("neutral", 1, True)

    # The large force of the pin turns along and tells nothing of how far the rod was turned.
    pressed = library("pressed")
    found = pressed.judged(solve(pressed.model, stable=True).x, pressed.model.pack())
    assert (found.verdict, found.zero, found.stable) == ("neutral", 1, True)


def test_critical_equilibrium_is_not_stable(library: Callable[[str], Library]) -> None:
    """A column at its critical load leads nowhere along its zero eigenvalue: it is not taken for a neutral one."""
    planar = library("planar")
    towards = [0.0, 0.0, -2.0 * CRITICAL]
    (event, *_) = follow(planar.model, "push.force", towards).events
    at_event = planar.model.pack({"push.force": np.array(towards) * event.factor})
    straight = planar.compiled.solve(at_event)
    assert straight.converged
    found = planar.judged(straight.x, at_event)
    assert (found.verdict, found.stable) == ("critical", False)


@pytest.mark.slow
def test_stability_follows_parameters(library: Callable[[str], Library]) -> None:
    """A load beyond the critical one of the scene's own stiffness is not beyond that of twice as much."""
    compiled = library("adjustable").compiled
    inputs = np.array([0.0, 0.0, -1.01 * CRITICAL])
    verdicts = {}
    for stiffness in (1.0, 2.0):
        p = {"rod.stiffness.bending_y": stiffness}
        solution = compiled.solve(inputs, parameters=p)
        found = compiled.stability(inputs, solution.x, parameters=p)
        assert found is not None
        verdicts[stiffness] = found.verdict
    assert verdicts == {1.0: "unstable", 2.0: "stable"}
    # In units of the scene's own EI/ℓ: twice the load on twice the stiffness releases twice the energy.
    p = {"rod.stiffness.bending_y": 2.0}
    loaded = compiled.stability(inputs, np.zeros(compiled.size))
    doubled = compiled.stability(2.0 * inputs, np.zeros(compiled.size), parameters=p)
    assert loaded is not None and doubled is not None
    assert_allclose(doubled.smallest_eigenvalue, 2.0 * loaded.smallest_eigenvalue, rtol=1e-8, atol=0)


def test_what_is_no_equilibrium_is_not_judged(library: Callable[[str], Library]) -> None:
    planar = library("planar").compiled
    inputs = np.array([0.4, 0.0, 0.0, 0.0, 0.0, 0.0])[: len(planar.defaults)]
    assert planar.stability(inputs, np.zeros(planar.size)) is None
    assert planar.stability(inputs, np.full(planar.size, np.nan)) is None


def test_stability_is_there_only_where_it_is_asked_for(library: Callable[[str], Library], tmp_path: Path) -> None:
    made = library("planar")
    without = export(made.model, tmp_path / "planar", "planar")
    files = set(stability_files("planar"))
    assert {file.name for file in made.folder.iterdir()} - {file.name for file in without.iterdir()} == files
    for file in ("planar.c", "planar.h", "planar_config.h", "planar_kernels.c"):
        assert (made.folder / file).read_text() == (without / file).read_text()
    assert "_stability.c" in (made.folder / "CMakeLists.txt").read_text()
    assert "stability" not in (without / "CMakeLists.txt").read_text()
    refused = build(scene(push(frame="body")), discretise(scene(push(frame="body")), 1, 2))
    with pytest.raises(ExportError, match="no potential"):
        export(refused, tmp_path / "follower", "follower", stability=True)
    assert not (tmp_path / "follower").exists()


@pytest.mark.parametrize("flags", [("gcc", *C99), ("gcc", *C99, "-DROUND_SINGLE"), ("g++", "-x", "c++", "-std=c++20")])
def test_source_compiles_without_a_word(library: Callable[[str], Library], tmp_path: Path, flags: tuple[str]) -> None:
    folder = library("round").folder
    done = attempt(*flags, "-Wall", "-Wextra", "-c", folder / "round_stability.c", "-o", tmp_path / "round.o")
    assert (done.returncode, done.stderr) == (0, "")
