"""Coulomb's friction of joints in motion, against its closed form, SciPy and derivatives of the equations."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import Motion, SceneError, build, follow, scene_from_dict, simulate
from cosserat_casadi.model.operation_cost import is_damped, price, without_damping
from cosserat_casadi.model.operations import count
from tests.equilibria import solve
from tests.model.test_base_joints import link, scene
from tests.model.test_joint_coordinates import ALONG, HINGE, SLIDE
from tests.model.test_joint_stops import INERTIA, WEIGHT, lever

STIFFNESS, FRICTION, REST = 40.0, 0.12, 0.02
"""Spring, N/m, friction, N, of a slide, and its displacement where the spring is unloaded, m."""


def sliding_rod(**joint: Any) -> dict[str, Any]:
    """A rigid rod on a slide that its spring pulls away, without weight."""
    slide = {**SLIDE, "stiffness": STIFFNESS, "rest": REST, "friction": FRICTION, **joint}
    rod = link("a", strain=["torsion"], base=ALONG)
    simulation = {"duration": 0.5, "frames": 501, "start": "unloaded", "tolerance": 1e-5}
    tables = scene([rod], [slide], simulation=simulation, loads=[])
    tables["accuracy"] = {"modes": 1, "nodes": 4}
    return tables


def displacements(motion: Motion) -> np.ndarray:
    return motion.joint("slide").conjugate


@pytest.fixture(scope="module")
def slid() -> Motion:
    motion = simulate(scene_from_dict(sliding_rod()))
    assert motion.converged, motion.message
    return motion


@pytest.mark.slow
def test_turning_points_of_a_slide_on_a_spring(slid: Motion) -> None:
    """Each half turn brings the slide nearer to the rest of the spring by 2 F/k; within F/k of it, it sticks."""
    way = displacements(slid) - REST
    turns = np.flatnonzero(np.diff(np.sign(np.diff(way)))) + 1
    lost = 2.0 * FRICTION / STIFFNESS
    expected = [REST - lost, -(REST - 2.0 * lost), REST - 3.0 * lost]
    # The slip rate of 1e-3 m/s beside speeds of up to 0.5 m/s.
    assert_allclose(way[turns[:3]], expected, rtol=0, atol=2e-5)
    assert abs(way[-1]) < FRICTION / STIFFNESS
    assert abs(np.diff(way[-20:])).max() < 1e-3 * 1e-3


def test_energy_of_a_slide_is_lost_by_its_friction(slid: Motion) -> None:
    energy = slid.energy
    way = np.abs(np.diff(displacements(slid))).sum()
    assert_allclose(energy.dissipated[-1], FRICTION * way, rtol=1e-2, atol=0)
    assert_allclose(energy.imbalance, 0.0, rtol=0, atol=1e-5)


def test_lever_that_rubs_at_its_hinge_vs_scipy() -> None:
    rubs = {"friction": 0.05, "slip_rate": 0.1, "lower_stop": -3.0, "damping": 1e-3}
    motion = simulate(scene_from_dict(lever(duration=0.6, **rubs)))
    assert motion.converged, motion.message

    def rates(_t: float, y: np.ndarray) -> list[float]:
        against = 1e-3 * y[1] + 0.05 * y[1] / np.hypot(y[1], 0.1)
        return [y[1], (WEIGHT * np.cos(y[0]) - against) / INERTIA]

    fall = solve_ivp(rates, (0, 0.6), [0, 0], rtol=1e-9, atol=1e-10, t_eval=motion.times, max_step=1e-3)
    assert_allclose(-motion.joint("hinge").conjugate, fall.y[0], rtol=0, atol=2e-5)


def test_derivatives_vs_ad() -> None:
    model = build(scene_from_dict(sliding_rod(damping=0.3)), moving=True)
    x, v, a = (0.05 * np.random.default_rng(seed).standard_normal(model.size) for seed in (1, 2, 3))
    symbol = ca.MX.sym("v", model.size)
    inputs = model.pack()
    still = np.zeros(model.inputs.size)
    residual = model.inverse_dynamics(x, symbol, a, inputs, still, still)
    ad = ca.Function("ad", [symbol], [ca.jacobian(residual, symbol)])
    for rates in (v, np.zeros(model.size)):
        _, damping, _, _ = model.dynamics_jacobian(x, rates, a, inputs, still, still)
        assert_allclose(damping.full(), ad(rates).full(), rtol=1e-12, atol=1e-13)


def test_equilibria_and_paths_say_that_they_have_no_friction() -> None:
    scene = scene_from_dict(sliding_rod())
    words = "Friction of joints acts in motion alone"
    assert words in solve(scene).message
    smooth = scene_from_dict(sliding_rod(friction=0.0))
    assert words not in solve(smooth).message
    forced = sliding_rod(force=0.0)
    assert words in follow(build(scene_from_dict(forced)), "slide.force", 0.1).message


@pytest.mark.parametrize(
    ("joint", "where", "problem"),
    [
        ({"angle": 0.1, "friction": 1.0}, "friction", "stands beside angle"),
        ({"slip_rate": 0.1}, "slip_rate", "belongs to friction, and the joint has none"),
        ({"friction": -0.1}, "friction", "must be >= 0, got -0.1"),
    ],
)
def test_refusals(joint: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(scene([link("a", base=ALONG)], [{**HINGE, **joint}]))
    assert (f"joints[0].{where}", problem) in [(one.where, one.problem) for one in refused.value.problems]


@pytest.mark.parametrize("joint", [{}, {"angle": 0.1}], ids=["nothing acts", "drive"])
def test_friction_that_would_not_act_is_no_parameter(joint: dict[str, Any]) -> None:
    tables = scene([link("a", base=ALONG)], [{**HINGE, **joint}])
    with pytest.raises(SceneError, match=r"hinge\.friction.*is not given in the scene"):
        scene_from_dict({**tables, "parameters": ["hinge.friction"]})


def test_joint_that_rubs_costs_in_motion_alone() -> None:
    rubs = scene_from_dict({**sliding_rod(), "parameters": ["slide.friction"]})
    bare = without_damping(rubs)
    assert is_damped(rubs)
    assert not is_damped(bare)
    assert bare.joints[0].has_coordinate
    assert not bare.parameters
    rubbing, sliding = (build(one, moving=True) for one in (rubs, bare))
    assert rubbing.size == sliding.size
    assert count(rubbing.inverse_dynamics).number > count(sliding.inverse_dynamics).number
    assert price(rubbing).residual.number == price(sliding).residual.number
