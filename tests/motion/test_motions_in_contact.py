"""Small motions of rods in exact contact: a pinned beam, solves at other inputs, and the motion itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import (
    Scene,
    SceneError,
    Solution,
    SolveError,
    build,
    linearise,
    modes_of,
    read_scene,
    scene_from_dict,
    simulate,
    solve,
)
from cosserat_casadi.equilibrium.contact.contact_search import equations_at
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.linear_model import DescriptorModel, LinearModel
from cosserat_casadi.motion.vibration_modes import WHILE_PRESSED, ModesOutcome
from tests.conftest import ROOT

STIFFNESS = 0.02
DENSITY = 0.1
PINNED = np.array([3.926602312047919, 7.068582745628732])
"""βℓ of a beam that is clamped at one end and pinned at the other: tan βℓ = tanh βℓ."""


def touching(obstacle: dict[str, Any], modes: int = 5, weight: float = 9.81, **tables: Any) -> Scene:
    """A heavy rod along x, a metre long, and an obstacle."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": tables.pop("strain", "planar"),
        "stiffness": {"bending_x": STIFFNESS, "bending_y": STIFFNESS, "torsion": STIFFNESS},
        "linear_density": DENSITY,
        "base": {"tangent": [1, 0, 0]},
    }
    loads = [
        {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -weight]},
        {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 0.15, "force": [0, 0, 0]},
    ]
    described = {
        "schema": 1,
        "rods": [rod],
        "loads": loads,
        "obstacles": [{"name": "obstacle", **obstacle}],
        "inputs": ["push.force"],
        "accuracy": {"modes": modes, "nodes": 2 * modes},
        **tables,
    }
    return scene_from_dict(described)


def floor(depth: float) -> dict[str, Any]:
    return {"kind": "plane", "point": [0, 0, -depth], "normal": [0, 0, 1]}


BAR = {"kind": "capsule", "from": [0.4, -0.5, -0.12], "to": [0.5, 0.5, -0.12], "radius": 0.1}

# A light rod bends by 1e-3 of its length at most: a beam, but for the square of that.
LIGHT = 8e-3 * STIFFNESS / DENSITY


def test_a_rod_whose_tip_lies_on_a_support_swings_as_a_pinned_beam() -> None:
    scene = touching(floor(7e-4), 7, weight=LIGHT)
    found = modes_of(scene, count=2)
    (contact,) = found.solution.contacts
    assert contact.start == 1.0
    assert WHILE_PRESSED in found.message
    wanted = PINNED**2 * np.sqrt(STIFFNESS / DENSITY)
    assert_allclose(found.angular_frequencies, wanted, rtol=2e-5, atol=0)
    errors = [mode.error_estimate or 0.0 for mode in found.modes]
    assert np.all(np.abs(found.angular_frequencies / wanted - 1.0) < np.array(errors) + 2e-6)


def gain(linear: LinearModel | DescriptorModel) -> FloatArray:
    """Outputs at rest for each input."""
    states, *_ = np.linalg.lstsq(linear.A, linear.B, rcond=1e-12)
    return np.asarray(linear.D - linear.C @ states)


def on_a_body() -> Scene:
    """The gap is one of two rods, which count in units of their own."""
    push = "loads=[{name='push', kind='point_wrench', rod='lower', at=0.3, force=[0, 0, 0]}]"
    changes = [push, "inputs=['push.force']", "accuracy.modes=4", "accuracy.nodes=8"]
    return read_scene(ROOT / "examples" / "finger_on_finger.toml", changes)


def over_bar() -> Scene:
    return touching(BAR, weight=2.0, strain="kirchhoff", inputs=["push.force", "rod.base.position"])


def on_table() -> Scene:
    return touching(floor(0.05), weight=2.0, inputs=["push.force", "rod.base.position"])


@pytest.mark.parametrize(
    ("scene", "kinds"),
    [(over_bar, ["point"]), (on_table, ["line"]), pytest.param(on_a_body, ["point"], marks=pytest.mark.slow)],
)
def test_what_a_linear_model_does_at_rest_is_what_a_solve_does(scene: Callable[[], Scene], kinds: list[str]) -> None:
    """Of a push and of a base that moves: the place of contact slides, a line becomes longer."""
    model = build(scene())
    rest = solve(model, estimate_error=False)
    assert rest.converged and [contact.kind for contact in rest.contacts] == kinds
    *_, rod = model.discretisation
    linear = linearise(rest, [(rod, 0.2), f"{rod}.tip.position"])
    assert not any(name.startswith("contact") for name in linear.inputs)
    given = model.inputs.size
    change = np.array([0.002, 0.0, -0.005, 0.03, 0.01 * (scene is over_bar), 0.05])[:given]
    step = 3e-3
    ends = []
    for sign in (1.0, -1.0):
        values = model.inputs.unpack(rest.inputs[:given] + sign * step * change)
        end = solve(model, values, start=rest, estimate_error=False)
        assert end.converged
        ends.append(np.concatenate([end.pose(0.2, rod).position, end.tip(rod).position]))
    wanted = (ends[0] - ends[1]) / (2 * step)
    assert_allclose(gain(linear)[:, :given] @ change, wanted, rtol=0, atol=2e-7)
    assert_allclose(gain(linear.descriptor)[:, :given] @ change, wanted, rtol=0, atol=2e-7)
    # Elements that move with the contacts tell the same.
    equations, z = equations_at(rest)
    none = np.zeros((0, 1))
    moved = equations.arguments_moved(equations.moved(z, change[:, None], none), change[:, None], none)[:, 0]
    arguments = np.concatenate(equations.arguments(z))
    sizes = np.cumsum([equations.model.size, equations.model.inputs.size])
    ends = []
    for sign in (1.0, -1.0):
        parts = np.split(arguments + sign * step * moved, sizes)
        places = [equations.model.shape[rod](*parts, X)[0].full()[:, 0] for X in (0.2, 1.0)]
        ends.append(np.concatenate(places))
    assert_allclose((ends[0] - ends[1]) / (2 * step), wanted, rtol=0, atol=2e-7)


@pytest.mark.slow
def test_a_rod_on_its_tip_swings_in_motion_as_its_modes_do() -> None:
    """A push that comes and goes leaves a sum of the modes, over a swing and a half of the slowest."""
    simulation = {"duration": 0.9, "start": "equilibrium", "tolerance": 1e-4, "frames": 91}
    push = {"input": "push.force", "times": [0, 0.1, 0.2], "values": [[0, 0, 0], [0, 0, -2e-3], [0, 0, 0]]}
    scene = touching(floor(0.05), 2, weight=0.3, simulation=simulation, motions=[push])
    model = build(scene, moving=True)
    rest = solve(model, estimate_error=False)
    motion = simulate(model)
    assert motion.converged and not motion.events
    left = motion.times > 0.2
    moved = motion.x[left] - rest.x

    def unexplained(frequencies: FloatArray) -> float:
        angles = np.outer(motion.times[left], frequencies)
        waves = np.hstack([np.cos(angles), np.sin(angles)])
        fitted, *_ = np.linalg.lstsq(waves, moved, rcond=None)
        return float(np.linalg.norm(moved - waves @ fitted) / np.linalg.norm(moved))

    frequencies = modes_of(rest).angular_frequencies
    others = min(unexplained(0.99 * frequencies), unexplained(1.01 * frequencies))
    assert unexplained(frequencies) < 5e-3 < 4e-2 < others


@pytest.mark.parametrize("pressed", [False, True])
def test_a_contact_that_hardly_presses_has_no_modes(pressed: bool) -> None:
    """A straight rod without weight on a ball: just above it, and where a push has gone."""
    ball = {"kind": "sphere", "centre": [0.9, 0, -0.05 - 1e-12], "radius": 0.05}
    model = build(touching(ball, 2, weight=0.0))
    rest = solve(model, estimate_error=False)
    if pressed:
        rest = solve(model, start=solve(model, {"push.force": [0, 0, -0.1]}), estimate_error=False)
    assert len(rest.contacts) == pressed
    found = modes_of(rest)
    assert found.outcome is ModesOutcome.MARGINAL_CONTACT and not found.modes
    assert "'rod' is" in found.message
    with pytest.raises(SolveError, match="No linear model: 'rod' is"):
        linearise(rest)


def pressed_at_tip(depth: float, weight: float, force: float, modes: int = 5) -> Solution:
    """A heavy rod above a floor, with a force across it at its tip."""
    loads = [
        {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -weight]},
        {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, force]},
    ]
    accuracy = {"modes": modes, "nodes": 14, "tolerance": 1e-3}
    return solve(build(touching(floor(depth), loads=loads, accuracy=accuracy)), estimate_error=False)


def test_a_rod_that_lies_unpressed_on_a_floor_has_no_modes_though_its_tip_presses() -> None:
    """All of it is on the floor, and may swing to one side alone."""
    rest = pressed_at_tip(0.0, 0.0, -0.1)
    assert [(touch.kind, touch.start) for touch in rest.contacts] == [("point", 1.0)]
    found = modes_of(rest)
    assert found.outcome is ModesOutcome.MARGINAL_CONTACT
    assert "of the length from 'obstacle', which it does not press." in found.message


@pytest.mark.slow
def test_points_that_stand_for_a_line_within_the_tolerance_have_no_modes() -> None:
    """The rod, of few modes, enters the floor between them: it is held by more."""
    rest = pressed_at_tip(3e-3, 0.3924, 8e-4, modes=2)
    assert [touch.kind for touch in rest.contacts] == ["point", "point"]
    assert "beside its contacts, within accuracy.tolerance" in modes_of(rest).message


@pytest.mark.slow
def test_a_rod_that_a_floor_holds_all_along_has_no_modes() -> None:
    with pytest.raises(SceneError, match="nothing can move: supports, joints or contacts hold everything"):
        modes_of(solve(build(touching(floor(0.0))), estimate_error=False))


def test_a_quick_torsion_spoils_no_linear_model() -> None:
    """A rod without rotary inertia, bent by its weight: its torsion has next to no mass."""
    rest = solve(build(touching(floor(10.0), 6, strain="kirchhoff")), estimate_error=False)
    linear = linearise(rest)
    assert_allclose(gain(linear), gain(linear.descriptor), rtol=0, atol=1e-9)
