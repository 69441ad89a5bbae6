"""Damping in proportion to mass: decay of flight, of modes, the balance of energy, and exact derivatives."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, modes_of, scene_from_dict, simulate
from tests.motion.stepping import moving_model
from tests.moving_scenes import FOLLOW, WEIGHT, rod, scene

RATE = 3.0
WATER = {"name": "water", "kind": "flow", "density": 1000.0, "diameter": 0.04, "velocity": [0.3, 0.1, -0.2]}


def arm(free: bool, strain: str = "kirchhoff", **damping: float) -> dict[str, Any]:
    return rod(strain=strain, base={"free": free}, damping={"mass_proportional": RATE, **damping})


def simulated(tables: dict[str, Any], duration: float) -> Any:
    simulation = {"duration": duration, "frames": 5, "start": "unloaded", "step": duration / 64.0}
    return simulate(scene_from_dict({**tables, "simulation": simulation}))


@pytest.mark.slow
@pytest.mark.parametrize("loads", [[WEIGHT], []], ids=["weight", "none"])
def test_flight_decays_as_a_body_in_a_viscous_medium(loads: list[dict[str, Any]]) -> None:
    """r̈ = g − α ṙ of each point that does not turn: v = (v₀ − g/α) e^(−αt) + g/α."""
    velocity = np.array([1.0, -2.0, 0.5])
    tables = scene(arm(free=True), loads=loads, velocities=[{"rod": "a", "linear": velocity.tolist()}])
    motion = simulated(tables, 0.5)
    gravity = np.array(WEIGHT["acceleration"] if loads else [0.0, 0.0, 0.0])
    t = motion.times[:, None]
    last = gravity / RATE
    moved = (velocity - last) * (1.0 - np.exp(-RATE * t)) / RATE + last * t
    assert_allclose(motion.tip().position, moved + np.array([0.0, 0.0, 0.8]), rtol=0, atol=1e-9)
    assert np.abs(motion.energy.imbalance).max() < 1e-9
    lost = motion.energy.kinetic[0] - motion.energy.kinetic - (motion.energy.potential - motion.energy.potential[0])
    assert_allclose(motion.energy.dissipated, lost, rtol=1e-8, atol=1e-9)


def test_every_mode_decays_at_half_the_rate() -> None:
    tables = scene(arm(free=False), loads=[], accuracy={"modes": 4, "nodes": 12})
    modes = modes_of(scene_from_dict(tables), count=4).modes
    assert_allclose([mode.eigenvalue.real for mode in modes], -RATE / 2.0, rtol=1e-8, atol=0)


def test_the_water_that_moves_along_is_not_damped() -> None:
    """Across a uniform rod in still water each mode has α ρA/(ρA + m) in the place of α."""
    water = {"name": "water", "kind": "flow", "density": 1000.0, "diameter": 0.04, "normal": 0.0, "tangential": 0.0}
    slender = {"strain": "planar", "linear_density": 0.8, "rotary_inertia": [0.0, 0.0, 0.0]}
    along = 1000.0 * np.pi / 4.0 * 0.04**2
    tables = scene({**arm(free=False), **slender}, loads=[water], accuracy={"modes": 4, "nodes": 12})
    modes = modes_of(scene_from_dict(tables), count=4).modes
    assert_allclose([mode.eigenvalue.real for mode in modes], -RATE / 2.0 * 0.8 / (0.8 + along), rtol=1e-8, atol=0)


@pytest.mark.parametrize("loads", [[WEIGHT, FOLLOW], [WEIGHT, WATER]], ids=["loads", "water"])
@pytest.mark.parametrize("free", [False, True])
def test_derivatives_are_those_of_the_residual(free: bool, loads: list[dict[str, Any]]) -> None:
    model = moving_model(scene(arm(free, "reissner", bending_x=0.02), loads=loads))
    rng = np.random.default_rng(5)
    x, v, a = (0.1 * rng.normal(size=model.size) for _ in range(3))
    still = np.zeros(model.inputs.size)
    arguments = [x, v, a, model.pack(), still, still]
    stiffness, damping, mass, _ = model.dynamics_jacobian(*arguments)
    symbols = model.inverse_dynamics.mx_in()
    residual = model.inverse_dynamics(*symbols)
    for number, matrix in enumerate((stiffness, damping, mass)):
        by_differentiation = ca.Function("derivative", symbols, [ca.jacobian(residual, symbols[number])])
        expected = by_differentiation(*arguments).full()
        assert_allclose(matrix.full(), expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_a_moved_base_feels_it() -> None:
    """The base is dragged at a speed that grows to v: the clamp works against −α ∫ρA v in the end."""
    tables = scene(arm(free=False, bending_x=0.1, bending_y=0.1, torsion=0.1), loads=[])
    tables["motions"] = [
        {"input": "a.base.position", "times": [0.0, 0.5, 1.0], "values": [[0, 0, 0], [0, 0.1, 0], [0, 0.2, 0]]}
        | {"interpolation": "cubic"}
    ]
    motion = simulated(tables, 1.0)
    assert np.abs(motion.energy.imbalance).max() < 1e-5
    assert motion.energy.dissipated[-1] > 0.0


def test_an_empty_table_is_refused() -> None:
    with pytest.raises(SceneError, match="mass_proportional"):
        scene_from_dict(scene(rod(damping={}), loads=[]))
