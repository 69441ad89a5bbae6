"""Motions that begin to move: free flight, kinetic energy in closed form, bodies that go along, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, scene_from_dict, simulate

LENGTH = 0.5
DENSITY = 0.4
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}


def tables(*velocities: dict[str, Any], free: bool = False, **more: Any) -> dict[str, Any]:
    """A straight rod along z, of rotary inertia zero, without damping."""
    rod = {
        "name": "arm",
        "length": LENGTH,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 0.02, "bending_y": 0.02, "torsion": 0.016},
        "linear_density": DENSITY,
        "rotary_inertia": [0.0, 0.0, 1e-5],
        "base": {"free": free},
    }
    simulation = {"duration": 0.3, "frames": 4, "start": "unloaded"}
    return {"schema": 1, "rods": [rod], "simulation": simulation, "velocities": list(velocities), **more}


def test_a_rod_flies_and_spins_as_a_rigid_body() -> None:
    spin = 9.0
    start = {"rod": "arm", "linear": [1.0, 2.0, 3.0], "angular": [spin, 0.0, 0.0]}
    motion = simulate(scene_from_dict(tables(start, free=True, loads=[WEIGHT], accuracy={"modes": 2, "nodes": 6})))
    assert motion.converged, motion.message
    t = motion.times[:, None]
    half = LENGTH / 2.0
    # The base has the given velocity; the centre of mass that and ω × half the rod.
    begin = np.array([1.0, 2.0 - spin * half, 3.0])
    centre = np.array([0.0, 0.0, half]) + begin * t - 0.5 * np.array([0.0, 0.0, 9.81]) * t**2
    arm = half * np.hstack([0.0 * t, -np.sin(spin * t), np.cos(spin * t)])
    assert_allclose(motion.tip().position, centre + arm, rtol=0, atol=1e-4 * LENGTH)
    assert motion.warnings == ()
    assert motion.start == "With the velocities of the scene, in the unloaded shape."


def test_a_body_goes_along_with_the_strains() -> None:
    rate, mass, inertia = 1.5, 0.1, 2e-4
    body = {"name": "plate", "mass": mass, "inertia": [inertia, 3e-4, 4e-4]}
    joint = {"rod": "arm", "body": "plate", "kind": "fixed"}
    start = {"rod": "arm", "curvature_rate": [rate, 0, 0]}
    simulation = {"duration": 0.01, "frames": 2, "start": "unloaded", "step": 1e-3}
    more = {"bodies": [body], "joints": [joint], "accuracy": {"modes": 3, "nodes": 8}, "simulation": simulation}
    motion = simulate(scene_from_dict(tables(start, **more)))
    assert motion.converged, motion.message
    # A section at s moves by κ̇ s²/2, and turns by κ̇ s.
    of_rod = DENSITY * rate**2 * LENGTH**5 / 40.0
    of_body = mass * (rate * LENGTH**2 / 2.0) ** 2 / 2.0 + inertia * (rate * LENGTH) ** 2 / 2.0
    assert_allclose(motion.energy.kinetic[0], of_rod + of_body, rtol=1e-10, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-6


@pytest.mark.slow
def test_a_body_that_one_rod_carries_has_a_velocity_of_its_own() -> None:
    velocity = [1.0, 2.0, 3.0]
    body = {"name": "plate", "mass": 0.1, "inertia": [2e-4, 3e-4, 4e-4]}
    more = {"bodies": [body], "joints": [{"rod": "arm", "body": "plate", "kind": "fixed"}], "free": True}
    more["accuracy"] = {"modes": 2, "nodes": 6}
    of_rod = {"rod": "arm", "linear": velocity}
    of_body = {"body": "plate", "linear": velocity}
    one, both = (simulate(scene_from_dict(tables(*given, **more))) for given in ([of_rod], [of_rod, of_body]))
    assert both.converged, both.message
    assert both.model.size == one.model.size + 13
    wanted = np.array([0.0, 0.0, LENGTH]) + both.times[:, None] * velocity
    for motion in (one, both):
        assert_allclose(motion.body("plate").position, wanted, rtol=0, atol=1e-9)


def test_a_hinge_with_a_spring_turns_as_its_body_does() -> None:
    """A pendulum in the world that is pushed from where its spring is slack."""
    rate, inertia, spring = 2.0, 3e-4, 0.05
    body = {"name": "plate", "inertia": [2e-4, inertia, 2e-4]}
    ends = [{"world": True, "position": [1.0, 0.0, 0.0]}, {"body": "plate"}]
    joint = {"name": "hinge", "kind": "revolute", "axis": [0, 1, 0], "stiffness": spring, "between": ends}
    more = {"bodies": [body], "joints": [joint], "accuracy": {"modes": 1, "nodes": 4}}
    motion = simulate(scene_from_dict(tables({"body": "plate", "angular": [0, rate, 0]}, **more)))
    assert motion.converged, motion.message
    frequency = np.sqrt(spring / inertia)
    angle = rate / frequency * np.sin(frequency * motion.times)
    assert_allclose(motion.joint("hinge").conjugate, angle, rtol=0, atol=1e-4)


def test_velocities_that_a_support_does_not_allow_are_refused() -> None:
    support = {"rod": "arm", "kind": "pinned", "position": [0.0, 0.0, LENGTH]}
    scene = scene_from_dict(tables({"rod": "arm", "curvature_rate": [1.0, 0, 0]}, supports=[support]))
    with pytest.raises(SceneError, match="velocities: supports, joints or cables open at"):
        simulate(scene)


@pytest.mark.parametrize(
    ("velocity", "where", "problem"),
    [
        ({"rod": "arm", "linear": [1.0, 0, 0]}, "velocities[0].linear", "the base of the rod is held"),
        ({"rod": "arm", "tangent_rate": [0, 0, 1.0]}, "velocities[0].tangent_rate[2]", "does not admit"),
        ({"rod": "arm", "body": "arm"}, "velocities[0]", "a rod and a body"),
        ({"rod": "leg"}, "velocities[0].rod", "no rod is named"),
    ],
)
def test_faults_of_the_table_are_told(velocity: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables(velocity))
    (fault,) = [entry for entry in refused.value.problems if problem in entry.problem]
    assert fault.where == where


def test_two_velocities_of_one_rod_are_refused() -> None:
    with pytest.raises(SceneError, match="more than one initial velocity"):
        scene_from_dict(tables({"rod": "arm"}, {"rod": "arm"}))
