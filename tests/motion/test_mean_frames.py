"""The mean frame of a rod that flies free: what its mass matrix is in the rates of the mean motion."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion import history
from cosserat_casadi.motion.mean_frames import MeanFrames
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.numerics import step_run
from cosserat_casadi.numerics.mean_frame import MeanFrame
from tests.motion import transients


@pytest.fixture(scope="module")
def flying() -> Model:
    """A rod that is kicked in space, and how it begins to fly."""
    asked = transients.flying_in_space(duration=4.0, frames=2)
    scene = scene_from_dict({**asked, "accuracy": {"modes": 5, "nodes": 10}})
    return build(scene.with_motion_inputs(), moving=True)


def bent(model: Model, rng: np.random.Generator) -> FloatArray:
    """Unknowns of a bent rod in any pose."""
    x = 0.3 * rng.normal(size=model.size)
    ((_, pose),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
    (frame,) = model.discrete.frames.values()
    quaternion = rng.normal(size=4)
    x[pose][3:] = quaternion / np.linalg.norm(quaternion) - frame.start.quaternion
    return x


def in_mean_rates(frame: MeanFrame, mass: FloatArray) -> FloatArray:
    """T⁻ᵀ M T⁻¹."""
    half = np.stack([frame.forces_to_mean(column) for column in mass.T], axis=1)
    return np.stack([frame.forces_to_mean(row) for row in half], axis=0)


def test_mean_motion_and_shape_share_no_mass(flying: Model) -> None:
    x = bent(flying, np.random.default_rng(3))
    inputs = flying.pack()
    frame = MeanFrames(flying).at(x, inputs)
    mass = in_mean_rates(frame, flying.mass_matrix(x, inputs).full())
    shape = np.setdiff1d(np.arange(flying.size), frame.poses)
    # The first rate of a spin is that of the quaternion's norm.
    between = mass[np.ix_(np.delete(frame.poses, 3), shape)]
    assert_allclose(between, 0.0, rtol=0, atol=1e-12 * np.abs(mass).max())


def test_mass_in_mean_rates_does_not_see_how_the_rod_is_turned(flying: Model) -> None:
    rng = np.random.default_rng(4)
    one = bent(flying, rng)
    other = bent(flying, rng)
    ((_, pose),) = flying.discrete.unknowns.of_kind(BlockKind.POSE)
    strains = np.setdiff1d(np.arange(flying.size), np.arange(pose.start, pose.stop))
    other[strains] = one[strains]
    inputs = flying.pack()
    masses = []
    for x in (one, other):
        frame = MeanFrames(flying).at(x, inputs)
        masses.append(in_mean_rates(frame, flying.mass_matrix(x, inputs).full()))
    assert_allclose(masses[1], masses[0], rtol=0, atol=1e-12 * np.abs(masses[0]).max())


def test_frames_of_instants_with_one_shape_are_those_of_each(flying: Model) -> None:
    rng = np.random.default_rng(5)
    x = np.stack([bent(flying, rng) for _ in range(3)])
    ((_, pose),) = flying.discrete.unknowns.of_kind(BlockKind.POSE)
    strains = np.setdiff1d(np.arange(flying.size), np.arange(pose.start, pose.stop))
    x[:, strains] = x[1, strains]
    frames = MeanFrames(flying)
    inputs = flying.pack()
    for together, unknowns in zip(frames.along(x, inputs), x, strict=True):
        alone = frames.at(unknowns, inputs)
        assert_allclose(together.turn, alone.turn, rtol=0, atol=1e-15)
        assert_allclose(together.share, alone.share, rtol=0, atol=1e-12 * np.abs(alone.share).max())


def test_a_frame_where_momentum_overflows_is_no_number(flying: Model) -> None:
    with np.errstate(all="ignore"):
        frame = MeanFrames(flying).at(np.full(flying.size, np.inf), flying.pack())
    assert np.all(np.isnan(frame.share))


def test_steps_are_solved_sooner_and_alike(flying: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = flying.scene.simulation
    assert simulation is not None
    simulator = Simulator(flying, simulation, started(flying, simulation, None))
    # As of rods whose parameters are asked for: their steps are in the unknowns of the model.
    monkeypatch.setattr(history, "can_be_centred", lambda model: False)
    carried_on = simulator.controlled(1e-3)
    monkeypatch.setattr(step_run, "FEW_CARRIED_ITERATIONS", step_run.FEW_ITERATIONS)
    carried = simulator.controlled(1e-3)
    monkeypatch.setattr(history, "MeanFrames", lambda model: None)
    plain = simulator.controlled(1e-3)
    for motion in (carried_on, carried, plain):
        assert motion.completed
    assert carried.statistics.iterations < 0.75 * plain.statistics.iterations
    assert carried_on.statistics.iterations < plain.statistics.iterations
    assert carried_on.statistics.jacobians < 0.5 * carried.statistics.jacobians
    end = plain.end.x
    for motion in (carried_on, carried):
        moved = np.abs(motion.end.x - end) * simulator.displacements
        assert moved.max() < 1e-3
