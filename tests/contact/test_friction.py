"""Friction on obstacles with a width: sliding, creeping and rolling on an incline, directions of a rod, energy, C."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import Model, build, discretise, export, load, read_scene, scene_from_dict, simulate, solve
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.codegen.compiled_motion import CompiledMotion, StepState
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.scene import Scene
from tests.conftest import ROOT
from tests.derivatives import central_differences
from tests.families import mostly_slow

GRAVITY = 9.81
RADIUS = 0.01
DENSITY = 1000.0
WIDTH = 2e-3
STIFFNESS = 1e6
SLIP = 1e-3
TANGENTS = {"along": [1, 0, 0], "back": [-1, 0, 0], "across": [0, 1, 0]}
DURATION = 0.1


def incline(slope: float, friction: Any, direction: str = "along", **obstacle: Any) -> Scene:
    """A rod that rests on a plane at z = 0, whose gravity leans by an angle towards x."""
    weight = DENSITY * np.pi * RADIUS**2 * GRAVITY * np.cos(slope)
    # The gap at which the plane bears the weight: weight = k (w − g)³ / (3 w²).
    gap = WIDTH - np.cbrt(3 * weight * WIDTH**2 / STIFFNESS)
    base = {"position": [0, 0, RADIUS + gap], "tangent": TANGENTS[direction], "free": True}
    rod = {
        "name": "rod",
        "length": 0.2,
        "strain": "kirchhoff",
        "section": {"shape": "circle", "radius": RADIUS},
        "material": {"youngs_modulus": 1e9, "poisson_ratio": 0.3, "density": DENSITY},
        "base": base,
    }
    plane = {
        "name": "plane",
        "kind": "plane",
        "point": [0, 0, 0],
        "normal": [0, 0, 1],
        "width": WIDTH,
        "stiffness": STIFFNESS,
        "friction": friction,
        "slip_speed": SLIP,
        **obstacle,
    }
    gravity = [GRAVITY * np.sin(slope), 0, -GRAVITY * np.cos(slope)]
    return scene_from_dict(
        {
            "schema": 1,
            "rods": [rod],
            "obstacles": [plane],
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": gravity}],
            "simulation": {"duration": DURATION, "start": "unloaded", "tolerance": 1e-4},
        }
    )


def rigid(scene: Scene) -> Model:
    """Its model with next to no modes: the rod is stiff."""
    return build(scene, discretise(scene, 1, 4))


def way(motion: Motion) -> float:
    """Way of the tip down the incline, m."""
    assert motion.converged, motion.message
    positions = motion.tip("rod").position
    return float(positions[-1, 0] - positions[0, 0])


def slid(slope: float, friction: float) -> float:
    """The same of a point mass by SciPy, with the friction of the scene."""

    def rates(_: float, state: FloatArray) -> FloatArray:
        speed = state[1]
        rubbing = friction * np.cos(slope) * speed / np.sqrt(speed**2 + SLIP**2)
        return np.array([speed, GRAVITY * (np.sin(slope) - rubbing)])

    return float(solve_ivp(rates, (0, DURATION), [0, 0], "Radau", rtol=1e-10, atol=1e-13).y[0, -1])


DIRECTED = {"along": 0.1, "back": 0.2, "across": 0.45}


@pytest.mark.parametrize(
    ("friction", "direction", "coefficient"),
    mostly_slow([(0.3, "along", 0.3), (DIRECTED, "along", 0.1), (DIRECTED, "back", 0.2)], [(DIRECTED, "back", 0.2)]),
)
def test_a_rod_slides_as_a_point_mass(friction: Any, direction: str, coefficient: float) -> None:
    """With the coefficient of its direction; far above the slip speed that is g (sin − μ cos)."""
    motion = simulate(rigid(incline(0.5, friction, direction)))
    assert_allclose(way(motion), slid(0.5, coefficient), rtol=2e-3, atol=0)
    coulomb = GRAVITY * (np.sin(0.5) - coefficient * np.cos(0.5)) * DURATION**2 / 2
    assert_allclose(way(motion), coulomb, rtol=1.5e-2, atol=0)


def test_across_its_axis_a_rod_slides_or_rolls() -> None:
    """Little friction leaves it sliding, and turning; with much it rolls as a solid cylinder, at 2/3 g sin.

    The point that touches of a sliding cylinder lags behind its turning, so that friction stays the same.
    """
    sliding = simulate(rigid(incline(0.5, {"along": 0.9, "across": 0.1}, "across")))
    coulomb = GRAVITY * (np.sin(0.5) - 0.1 * np.cos(0.5)) * DURATION**2 / 2
    assert_allclose(way(sliding), coulomb, rtol=1.5e-2, atol=0)
    rolling = simulate(rigid(incline(0.5, 0.6, "across")))
    # It turns about the line that touches, a gap farther from its axis than its radius: 3e-3 at most.
    assert_allclose(way(rolling), GRAVITY * np.sin(0.5) * DURATION**2 / 3, rtol=3e-3, atol=0)


def test_what_sticks_creeps_slower_than_the_slip_speed() -> None:
    """At v with μ v/√(v² + s²) = tan of the slope."""
    slope, friction = 0.2, 0.6
    motion = simulate(rigid(incline(slope, friction)))
    positions = motion.tip("rod").position[:, 0]
    late = len(positions) // 2
    speed = (positions[-1] - positions[late]) / (motion.times[-1] - motion.times[late])
    wanted = SLIP * np.tan(slope) / np.sqrt(friction**2 - np.tan(slope) ** 2)
    assert_allclose(speed, wanted, rtol=3e-2, atol=0)
    # Once the layer bears the rod all of it is pressed, and sticks; on a steep slope it slips.
    last = len(motion.times) - 1
    assert [(found.rod, found.obstacle, found.slips) for found in motion.rubbing(last)] == [("rod", "plane", False)]
    assert "rod sticks on plane from 0 to 1" in repr(motion)


@pytest.mark.slow
def test_friction_takes_the_energy_of_the_way() -> None:
    """Force times way, and nothing is missing from the balance."""
    motion = simulate(rigid(incline(0.5, 0.3)))
    mass = DENSITY * np.pi * RADIUS**2 * 0.2
    wanted = 0.3 * mass * GRAVITY * np.cos(0.5) * way(motion)
    assert_allclose(motion.energy.dissipated[-1], wanted, rtol=1e-2, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-2 * wanted
    assert np.all(np.diff(motion.energy.dissipated) >= 0)
    *_, stretch = motion.to_dict()["contact"]["rubbing"]
    last = {"row": len(motion.times) - 1, "obstacle": "plane", "rod": "rod", "from": 0.0, "to": 1.0, "slips": True}
    assert stretch == last


@pytest.mark.slow
def test_at_rest_nothing_rubs_and_it_is_said() -> None:
    """Statics have not one instruction more, and an equilibrium in contact tells that friction is not in it."""
    lying = read_scene(ROOT / "examples" / "rod_on_table.toml", ["table.width=4e-3", "accuracy.modes=4"])
    rubbing = read_scene(
        ROOT / "examples" / "rod_on_table.toml", ["table.width=4e-3", "accuracy.modes=4", "table.friction=0.3"]
    )
    plain, with_friction = build(lying), build(rubbing)
    assert with_friction.residual.n_instructions() == plain.residual.n_instructions()
    found = solve(with_friction)
    assert found.contacts and "Friction acts in motion and on paths" in found.message
    assert "Friction" not in solve(plain).message
    searched = solve(unfixed(rubbing, 1e-2))
    assert searched.contacts and "Friction acts in motion and on paths" in searched.message


@pytest.mark.slow
def test_dynamics_in_c_are_those_of_python(tmp_path: Path) -> None:
    """Balance of a rod that slides aside and turns, and its derivatives, which are those of differences too."""
    scene = incline(0.5, DIRECTED, "back", damping=1.0)
    model = build(scene, discretise(scene, 1, 4), moving=True)
    library = load(export(model, tmp_path / "slide", dynamics=True))
    rng = np.random.default_rng(3)
    x = 1e-3 * rng.standard_normal(model.size)
    v = 0.2 * rng.standard_normal(model.size)
    a = rng.standard_normal(model.size)
    inputs = model.pack()
    still = np.zeros_like(inputs)

    def balance(v: FloatArray) -> FloatArray:
        return np.asarray(model.inverse_dynamics(x, v, a, inputs, still, still)).ravel()

    assert isinstance(library, CompiledMotion)
    assert_allclose(library.inverse_dynamics(StepState(x, v, a), inputs), balance(v), rtol=1e-10, atol=1e-12)
    _, damping, _, _ = model.dynamics_jacobian(x, v, a, inputs, still, still)
    differences = central_differences(balance, v, 1e-5)
    assert_allclose(damping.full(), differences, rtol=1e-5, atol=1e-6 * np.abs(damping.full()).max())


@pytest.mark.slow
def test_a_snake_crawls_as_fast_as_that_of_pyelastica() -> None:
    """Its steady speed over a period of 2 s is 0.0278 m/s there: version 1.0.0, 50 elements, steps of 1e-4 s."""
    motion = simulate(read_scene(ROOT / "examples" / "snake.toml"))
    assert motion.converged, motion.message
    positions = motion.section("snake", np.linspace(0, 1, 101)).position.mean(axis=1)
    periods = positions[[0, 100, 200, 300]]
    speeds = np.linalg.norm(np.diff(periods, axis=0), axis=1) / 2.0
    assert_allclose(speeds[2], 0.0278, rtol=0.05, atol=0)
    # From the tail to the head, against the wave.
    assert periods[3, 0] - periods[2, 0] > 0.05


REFUSED = {
    "a slip speed without width": (
        {"width": None, "stiffness": None},
        "contact without a width is exact",
    ),
    "a coefficient below zero": ({"friction": -0.1}, "friction"),
    "a direction that there is not": ({"friction": {"along": 0.1, "sideways": 0.2}}, "sideways"),
    "a slip speed of zero": ({"slip_speed": 0.0}, "slip_speed"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case: str) -> None:
    changes, sentence = REFUSED[case]
    with pytest.raises(SceneError, match=sentence):
        incline(0.5, changes.pop("friction", 0.3), **changes)
