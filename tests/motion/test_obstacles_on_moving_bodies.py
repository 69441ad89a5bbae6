"""Exact contact in motion with obstacles that bodies carry: blows, contacts that last, starts that touch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize_scalar

from cosserat_casadi import Motion, SceneError, build, read_scene, scene_from_dict, simulate, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.pose_series import section_poses
from tests.conftest import ROOT

RADIUS = 5e-3
BALL = 0.02
SPEED = 1.0
FINGERS = ROOT / "examples" / "finger_on_finger.toml"


def free_rod(name: str, youngs_modulus: float, position: list[float]) -> dict[str, Any]:
    return {
        "name": name,
        "length": 0.3,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": youngs_modulus, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": RADIUS},
        "base": {"free": True, "position": position, "tangent": [1, 0, 0]},
    }


def struck(share: float, duration: float) -> Motion:
    """A free rod falls on the ball at the tip of another free rod."""
    tables = {
        "schema": 1,
        "accuracy": {"modes": 2},
        "simulation": {"duration": duration, "frames": 6, "tolerance": 1e-5},
        "rods": [free_rod("lower", 2e7, [0, 0, 0]), free_rod("upper", 4e7, [0.1, 0.004, 0.05])],
        "bodies": [{"name": "head", "mass": 0.02, "inertia": [1e-5, 1e-5, 1e-5]}],
        "joints": [{"body": "head", "rod": "lower", "kind": "fixed"}],
        "obstacles": [
            {
                "name": "ball",
                "kind": "sphere",
                "centre": [0, 0, 0],
                "radius": BALL,
                "body": "head",
                "rods": ["upper"],
                "restitution": share,
            }
        ],
        "velocities": [{"rod": "upper", "linear": [0, 0, -SPEED]}],
    }
    return simulate(build(scene_from_dict(tables).with_motion_inputs(), moving=True))


def gap_between(model: Model, x: FloatArray) -> float:
    """Distance of the upper rod from the ball, m, by poses of sections and of the body."""
    inputs = model.pack()
    centre = model.body["head"](x, inputs)[0].full()[:, 0]

    def distance(X: float) -> float:
        positions = section_poses(model, "upper", np.array([X]), x[None], inputs[None]).position
        return float(np.linalg.norm(positions[0, 0] - centre))

    nearest = minimize_scalar(distance, bounds=(0.5, 0.9), method="bounded", options={"xatol": 1e-10})
    return float(nearest.fun) - BALL - RADIUS


def momentum(motion: Motion, row: int) -> FloatArray:
    """Momentum and angular momentum about the origin, shape (6,)."""
    inputs = motion.model.pack()
    parts = motion.model.momentum(motion.x[row], motion.v[row], inputs, 0.0 * inputs)
    return np.concatenate([part.full()[:, 0] for part in parts])


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_a_blow_on_a_ball_at_a_tip(share: float) -> None:
    """Its impulse and energy follow from the gap by differences, and from the masses of both rods and of the body."""
    motion = struck(share, 0.03)
    blow = motion.events[0]
    assert blow.kind == "impact"
    model = motion.model
    inputs = model.pack()
    # Until the blow the upper rod falls freely, and nothing bends.
    x, v = motion.x[0], motion.v[0]
    x = x + blow.time * v
    assert_allclose(gap_between(model, x), 0.0, rtol=0, atol=1e-12)
    moves = model.discrete.unknowns.differential
    slopes = np.zeros(model.size)
    for entry in np.flatnonzero(moves):
        change = np.zeros(model.size)
        change[entry] = 1e-6
        slopes[entry] = (gap_between(model, x + change) - gap_between(model, x - change)) / 2e-6
    still = np.zeros(model.size)
    stiffness, _, mass, _ = (
        part.full() for part in model.dynamics_jacobian(x, v, still, inputs, 0 * inputs, 0 * inputs)
    )
    # Balances with constraints: M δv + Cᵀ μ = ∇g, C δv = 0, each balance over its unit.
    system = np.where(np.outer(moves, moves), mass, np.where(np.outer(~moves, ~moves), 0.0, stiffness))
    pushed = np.where(moves, slopes / model.discrete.unknowns.units, 0.0)
    answer = np.linalg.lstsq(system, pushed, rcond=1e-13)[0]
    compliance = slopes @ np.where(moves, answer, 0.0)
    approach = -slopes @ v
    assert_allclose(blow.impulse, (1 + share) * approach / compliance, rtol=1e-4, atol=0)
    assert_allclose(blow.energy, (1 - share**2) * approach**2 / compliance / 2, rtol=1e-4, atol=0)
    size = np.linalg.norm(momentum(motion, 0)[:3])
    assert_allclose(momentum(motion, -1), momentum(motion, 0), rtol=0, atol=1e-6 * size)


def fingers(duration: float, times: list[float], tensions: list[float]) -> Motion:
    """A finger that presses with the disk at its tip on another one; both are damped."""
    changes = [
        "inputs=['flexor.tension']",
        "upper.damping={retardation_time=0.05}",
        "lower.damping={retardation_time=0.05}",
        f"simulation={{duration={duration}, tolerance=1e-4, frames=6}}",
        f"motions=[{{input='flexor.tension', times={times}, values={tensions}}}]",
    ]
    return simulate(read_scene(FINGERS, changes).with_motion_inputs())


@pytest.mark.parametrize(
    ("duration", "times", "tensions", "row"),
    [(0.2, [0.0, 0.2], [1.5, 0.5], 0), (1.5, [0.0, 0.3, 1.5], [0.0, 1.5, 1.5], -1)],
    ids=["starts there", "comes there"],
)
def test_rest_in_contact_vs_statics(duration: float, times: list[float], tensions: list[float], row: int) -> None:
    """Statics divides the rod where it touches, and bears the reaction on the body by its own equations."""
    motion = fingers(duration, times, tensions)
    assert motion.converged, motion.message
    rest = solve(read_scene(FINGERS, ["accuracy.tolerance=1e-6"]))
    for rod in ("upper", "lower"):
        assert_allclose(motion.tip(rod).position[row], rest.tip(rod).position, rtol=0, atol=2e-6)
    (contact,) = motion.contacts[row]
    (expected,) = rest.contacts
    assert (contact.owner, contact.obstacle) == (expected.owner, expected.obstacle)
    assert_allclose(contact.at, expected.start, rtol=0, atol=1e-4)
    assert_allclose(contact.force, expected.force, rtol=1e-3, atol=1e-6)


def test_friction_on_such_an_obstacle_is_refused() -> None:
    shape = "name='rim', kind='sphere', body='disk', centre=[0, 0, 0], radius=0.012"
    rubbing = f"obstacles=[{{{shape}, rods=['lower'], friction=0.3}}]"
    with pytest.raises(SceneError, match="is for simulate, and without friction: rim"):
        simulate(read_scene(FINGERS, [rubbing, "simulation={duration=0.1}"]))
