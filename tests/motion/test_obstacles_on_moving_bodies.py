"""Exact contact in motion with obstacles that bodies carry: blows, contacts that last, starts that touch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize_scalar

from cosserat_casadi import Motion, build, read_scene, scene_from_dict, simulate, solve
from cosserat_casadi.maths.grid import gauss_legendre
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


def struck(share: float, duration: float, flies: Sequence[float] = (0.0, 0.0, -SPEED), friction: float = 0.0) -> Motion:
    """A free rod flies onto the ball at the tip of another free rod."""
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
                "friction": friction,
            }
        ],
        "velocities": [{"rod": "upper", "linear": list(flies)}],
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


def fingers(
    duration: float, times: list[float], tensions: list[float], obstacle: str = "friction=0.0", tolerance: float = 1e-4
) -> Motion:
    """A finger that presses with the disk at its tip on another one; both are damped."""
    shape = "name='rim', kind='sphere', body='disk', centre=[0, 0, 0], radius=0.012"
    changes = [
        "inputs=['flexor.tension']",
        f"obstacles=[{{{shape}, rods=['lower'], {obstacle}}}]",
        "upper.damping={retardation_time=0.05}",
        "lower.damping={retardation_time=0.05}",
        f"simulation={{duration={duration}, tolerance={tolerance}, frames=6}}",
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


def centre_of_upper(motion: Motion, row: int) -> FloatArray:
    """Centre of mass of the upper rod, shape (3,), m."""
    points, weights = gauss_legendre(12)
    inputs = motion.model.pack()
    positions = section_poses(motion.model, "upper", (points + 1) / 2, motion.x[row][None], inputs[None]).position[0]
    return weights @ positions / 2


def test_a_blow_askew_with_friction() -> None:
    """The push on the upper rod is along the normal, and μ times that against the sliding, which the blow outlasts."""
    friction, share = 0.05, 0.6
    flies = np.array([0.5, 0.2, -SPEED])
    motion = struck(share, 0.036, flies=flies.tolist(), friction=friction)
    (blow,) = [event for event in motion.events if event.kind == "impact"]
    assert motion.times[-2] > blow.time
    # Where the two touch nothing bends yet: the upper rod is a line along x.
    across = np.array([0.0, 0.004, 0.05]) + blow.time * flies * [0, 1, 1]
    normal = across / np.linalg.norm(across)
    sliding = flies - (flies @ normal) * normal
    rates = (centre_of_upper(motion, -1) - centre_of_upper(motion, -2)) / (motion.times[-1] - motion.times[-2])
    impulse = 1100.0 * np.pi * RADIUS**2 * 0.3 * (rates - flies)
    along = impulse @ normal
    assert along > 0.0
    held = impulse - along * normal
    assert_allclose(np.linalg.norm(held), friction * along, rtol=1e-5, atol=0)
    # The blow turns the sliding by as little as friction is.
    assert_allclose(held, -friction * along * sliding / np.linalg.norm(sliding), rtol=0, atol=friction**2 * along)
    size = np.linalg.norm(momentum(motion, 0)[:3])
    assert_allclose(momentum(motion, -1), momentum(motion, 0), rtol=0, atol=1e-8 * size)
    energies = motion.energy.kinetic + motion.energy.elastic
    assert energies[-1] < energies[0]


def test_a_finger_that_rubs_is_held_within_the_cone() -> None:
    """It is dragged along the disk: friction is μ times the push where it slips, and less where it sticks."""
    motion = fingers(0.2, [0.0, 0.1, 0.2], [0.5, 1.5, 1.4], obstacle="friction=0.3", tolerance=1e-2)
    assert motion.converged, motion.message
    # At the start the force is that of the first step, extended back.
    touching = [contact for contacts in motion.contacts[1:] for contact in contacts]
    assert len(touching) > 2
    for contact in touching:
        assert contact.friction is not None
        push, held = np.linalg.norm(contact.force), np.linalg.norm(contact.friction)
        assert_allclose(contact.force @ contact.friction, 0.0, rtol=0, atol=1e-9 * push**2)
        if contact.slips:
            assert_allclose(held, 0.3 * push, rtol=1e-6, atol=0)
        else:
            assert held <= 0.3 * push * (1 + 1e-9)
