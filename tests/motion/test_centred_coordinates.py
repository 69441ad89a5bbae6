"""Coordinates about the middle of a rod that flies free: the same motion as in those of its base, in fewer steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, read_scene, scene_from_dict
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion import history
from cosserat_casadi.motion.centred_coordinates import CentredCoordinates, can_be_centred
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.simulate import Simulator, moving_inputs, started
from cosserat_casadi.motion.tip_paths import path_distance
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from tests import moving_scenes
from tests.motion import transients

STEP = 1e-5
"""Of central differences: their error is of the order of its square, 1e-10."""


def kicked(duration: float = 4.0) -> Model:
    """A rod that is kicked in space."""
    asked = transients.flying_in_space(duration=duration, frames=2)
    scene = scene_from_dict({**asked, "accuracy": {"modes": 4, "nodes": 8}})
    return build(scene.with_motion_inputs(), moving=True)


@pytest.fixture(scope="module")
def flying() -> Model:
    return kicked()


@pytest.fixture(scope="module")
def coordinates(flying: Model) -> CentredCoordinates:
    return CentredCoordinates(flying)


def rod_name(model: Model) -> str:
    (name,) = model.discrete.rods
    return name


def pose_of(model: Model) -> slice:
    ((_, entries),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
    return entries


def some_motion(size: int, seed: int) -> Instant:
    rng = np.random.default_rng(seed)
    return Instant(0.01, 0.2 * rng.normal(size=size), rng.normal(size=size), rng.normal(size=size))


def along(motion: Instant, time: float) -> Instant:
    """The motion of constant acceleration, a time after the instant."""
    x = motion.x + time * motion.v + time**2 / 2.0 * motion.a
    return Instant(motion.time, x, motion.v + time * motion.a, motion.a)


def test_rates_are_those_of_positions_along_a_motion(flying: Model, coordinates: CentredCoordinates) -> None:
    motion = some_motion(flying.size, 1)
    before, now, after = (coordinates.to_model(along(motion, time)) for time in (-STEP, 0.0, STEP))
    assert_allclose((after.x - before.x) / (2.0 * STEP), now.v, rtol=0, atol=1e-7)
    assert_allclose((after.v - before.v) / (2.0 * STEP), now.a, rtol=0, atol=1e-6)


def test_way_to_the_model_and_back(flying: Model, coordinates: CentredCoordinates) -> None:
    motion = some_motion(flying.size, 2)
    back = coordinates.from_model(coordinates.to_model(motion))
    assert_allclose(back.x, motion.x, rtol=0, atol=1e-13)
    assert_allclose(back.v, motion.v, rtol=0, atol=1e-12)
    assert_allclose(back.a, motion.a, rtol=0, atol=1e-11)


def test_forces_of_contacts_are_the_same_in_both(flying: Model, coordinates: CentredCoordinates) -> None:
    motion = some_motion(flying.size, 6)
    pressed = Instant(motion.time, *(np.append(part, [3.0, 4.0]) for part in (motion.x, motion.v, motion.a)))
    at = coordinates.to_model(pressed)
    free = coordinates.to_model(motion)
    for both, alone in zip((at.x, at.v, at.a), (free.x, free.v, free.a), strict=True):
        assert_allclose(both, np.append(alone, [3.0, 4.0]), rtol=0, atol=0)
    back = coordinates.from_model(at)
    for found, expected in zip((back.x, back.v, back.a), (pressed.x, pressed.v, pressed.a), strict=True):
        assert_allclose(found, expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner", ["extension"], ["torsion"]], ids=str)
def test_jacobians_vs_differences(strain: str | list[str]) -> None:
    free = moving_scenes.rod(strain=strain, base={"free": True})
    model = build(scene_from_dict(moving_scenes.scene(free, loads=[moving_scenes.PUSH])), moving=True)
    piece = moving_inputs(model).pieces(4.0)[0]
    differ_by_jacobians(CentredCoordinates(model).equations(equations_of(model, piece)))


def test_jacobians_of_a_rod_that_touches_vs_differences() -> None:
    model = build(read_scene("examples/rod_hits_floor.toml").with_motion_inputs(), moving=True)
    piece = moving_inputs(model).pieces(0.4)[0]
    contacts = ExactContacts(model)
    touches = (MovingContact(0, 0.0, slides=False), MovingContact(0, 0.7, slides=False))
    phase = ContactPhase(touches, follower=Follower(contacts.facings, touches))
    equations, _ = contacts.arranged(equations_of(model, piece), piece, phase)
    differ_by_jacobians(CentredCoordinates(model).equations(equations))


def differ_by_jacobians(equations: MotionEquations) -> None:
    """Differences of equations along a direction are those of their Jacobians."""
    motion = some_motion(equations.size, 3)
    direction = np.random.default_rng(4).normal(size=equations.size)
    # Forces have neither rates nor accelerations.
    along_rates = np.where(equations.differential, direction, 0.0)
    jacobians = equations.jacobians(motion.time, motion.x, motion.v, motion.a)
    parts = [motion.x, motion.v, motion.a]
    for number, matrix in enumerate(jacobians):
        sides = []
        for sign in (1.0, -1.0):
            moved = list(parts)
            moved[number] = parts[number] + sign * STEP * (along_rates if number else direction)
            sides.append(equations.residual(motion.time, *moved))
        expected = (sides[0] - sides[1]) / (2.0 * STEP)
        assert_allclose(matrix @ direction, expected, rtol=0, atol=1e-7 * np.abs(expected).max())


def test_origin_has_the_momentum_of_the_rod() -> None:
    """Of a rod of 0.9 kg/m at the base and 0.7 kg/m at the tip, 0.8 m long: its mass is 0.64 kg."""
    free = moving_scenes.rod(strain="reissner", base={"free": True})
    model = build(scene_from_dict(moving_scenes.scene(free, loads=[])), moving=True)
    motion = some_motion(model.size, 5)
    at = CentredCoordinates(model).to_model(motion)
    momentum, _ = model.momentum(at.x, at.v, model.pack(), np.zeros(model.inputs.size))
    velocity = 0.8 * motion.v[pose_of(model)][:3]
    assert_allclose(momentum.full()[:, 0], 0.64 * velocity, rtol=0, atol=1e-13)


def wound(model: Model, turns: float) -> FloatArray:
    """Unknowns of the rod, bent to so many turns all along it."""
    x = np.zeros(model.size)
    (rod,) = model.discrete.rods.values()
    bending = rod.columns[0]
    strains = model.discrete.unknowns.strain(rod_name(model))
    x[np.arange(strains.start, strains.stop)[bending][0]] = 2.0 * np.pi * turns
    return x


NO_MEAN = 4.0 * 4.493409457909064 / (2.0 * np.pi)
"""Turns of a rod, bent evenly, whose mean quaternion is zero: four times the first root of tan a = a."""


@pytest.mark.parametrize("turns", [0.5, NO_MEAN, 10.0])
def test_frame_of_a_rod_that_is_coiled(turns: float) -> None:
    """All is alike on both sides of the middle, with which the frame turns; and it depends smoothly on the strains."""
    asked = transients.flying_in_space(duration=1.0, frames=2)
    scene = scene_from_dict({**asked, "accuracy": {"modes": 2, "nodes": 40}})
    model = build(scene.with_motion_inputs(), moving=True)
    coordinates = CentredCoordinates(model)
    still = np.zeros(model.size)
    x = wound(model, turns)
    centred = coordinates.from_model(Instant(0.0, x, still, still))
    (frame,) = model.discrete.frames.values()
    pose = pose_of(model)
    middle = section_poses(model, rod_name(model), [0.5], x[None], model.pack()[None]).quaternion[0, 0]
    found = quaternion_to_matrix(frame.start.quaternion + centred.x[pose][3:])
    assert_allclose(found, quaternion_to_matrix(middle), rtol=0, atol=1e-9)

    # Next to a coil that has no mean, strains that are not even would turn the frame at any rate.
    rates = np.random.default_rng(6).normal(size=model.size)
    rates[pose] = 0.0
    moved = coordinates.from_model(Instant(0.0, x, rates, still))
    assert np.abs(moved.v[pose]).max() < 10.0


def soft() -> Model:
    """A soft rod that a force and a moment kick at its tip."""
    kick = {"name": "kick", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0], "moment": [0, 0, 0]}
    rod = {
        "name": "rod",
        "length": 0.5,
        "strain": "reissner",
        "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0},
        "section": {"shape": "circle", "radius": 0.02},
        "base": {"position": [0, 0, 0], "free": True},
    }
    force = {"input": "kick.force", "times": [0, 0.1], "values": [[2.0, 1.0, -0.5], [0, 0, 0]]}
    moment = {"input": "kick.moment", "times": [0, 0.1], "values": [[0, 0.15, 0.1], [0, 0, 0]]}
    simulation = {"duration": 0.1, "start": "unloaded"}
    scene = scene_from_dict(
        {
            "schema": 1,
            "accuracy": {"modes": 4, "nodes": 12},
            "rods": [rod],
            "loads": [kick],
            "motions": [force, moment],
            "simulation": simulation,
        }
    )
    return build(scene.with_motion_inputs(), moving=True)


@pytest.mark.slow
def test_motion_is_that_in_coordinates_of_the_base_in_fewer_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    model = soft()
    simulation = model.scene.simulation
    assert simulation is not None
    simulator = Simulator(model, simulation, started(model, simulation, None))
    centred = simulator.controlled(1e-3)
    monkeypatch.setattr(history, "can_be_centred", lambda model: False)
    # A simulator keeps the coordinates that it began with.
    of_base = Simulator(model, simulation, simulator.start).controlled(1e-3)
    assert centred.completed
    assert of_base.completed
    assert path_distance(simulator.paths(centred), simulator.paths(of_base)) < 1e-3
    assert centred.statistics.steps < 0.9 * of_base.statistics.steps
    assert centred.statistics.iterations < 0.5 * of_base.statistics.iterations


def test_what_is_held_or_watched_in_its_unknowns_keeps_them() -> None:
    def model_of(rod: dict[str, Any], **more: Any) -> Model:
        return build(scene_from_dict(moving_scenes.scene(rod, loads=[], **more)), moving=True)

    free = moving_scenes.rod(base={"free": True})
    cable = {"name": "cable", "kind": "tendon", "rod": "a", "offset": [0.06, 0.01], "length": 0.8}
    assert can_be_centred(model_of(free))
    assert not can_be_centred(model_of(moving_scenes.rod()))
    assert can_be_centred(model_of(free, actuators=[cable]))
    assert not can_be_centred(model_of(free, actuators=[{**cable, "slack": True}]))
    assert not can_be_centred(model_of(free, inputs=["a.length"]))


def test_positions_alone_are_those_of_whole_states(coordinates: CentredCoordinates, flying: Model) -> None:
    motions = [some_motion(flying.size, seed) for seed in (4, 5, 6)]
    found = coordinates.positions_of_model(np.array([motion.x for motion in motions]))
    expected = [coordinates.to_model(motion).x for motion in motions]
    assert_allclose(found, expected, rtol=1e-13, atol=1e-14)
