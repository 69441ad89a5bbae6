"""What every motion keeps, whatever moves: momentum, energy, the direction of time, the place of the observer."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Motion, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion import history
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.momentum import MomentumKeeper, flies_free
from cosserat_casadi.motion.trajectory import MotionState
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from tests import moving_scenes
from tests.families import mostly_slow
from tests.motion import transients
from tests.motion.stepping import moving_model, orders, stepped

FREE = {"position": [0.1, 0.2, 0.3], "quaternion": [0.6, 0, 0.8, 0], "free": True}


def undamped(strain: str = "kirchhoff", **changes: Any) -> dict[str, Any]:
    """The rod of the moving scenes without damping."""
    rod = moving_scenes.rod(strain=strain, **changes)
    del rod["damping"]
    return rod


def simulated(scene: dict[str, Any], **simulation: Any) -> Motion:
    asked = {"duration": 0.5, "tolerance": 1e-4, **simulation}
    motion = simulate(moving_model({**scene, "simulation": asked}))
    assert motion.converged, motion.message
    return motion


def step_ends(history: History) -> list[MotionState]:
    """The motion at its start and at the ends of all steps."""
    states = history.states(np.array([0.0, *(step.end.time for _, step in history.steps)]))
    return [MotionState(*parts) for parts in zip(states.x, states.v, states.a, states.inputs, strict=True)]


def energies(model: Model, states: list[MotionState]) -> FloatArray:
    """Kinetic, elastic and potential energy together, shape (T,), J."""
    still = np.zeros(model.inputs.size)
    totals = []
    for state in states:
        kinetic, elastic, of_loads, dead = model.energies(state.x, state.v, state.inputs, still)
        potential = (dead[:, 0].T @ of_loads).full()
        totals.append(float(kinetic) + float(elastic) + float(potential.sum()))
    return np.array(totals)


# Momentum of a free rod


def spinning() -> tuple[Model, FloatArray, FloatArray]:
    """A free Kirchhoff rod that is bent, moves and turns, with nothing that acts on it."""
    model = moving_model(moving_scenes.scene(undamped(base=FREE), loads=[]), 2, 6)
    draw = np.random.default_rng(1).standard_normal
    strains = model.discrete.unknowns.strain("a")
    x = np.zeros(model.size)
    x[strains] = 0.1 * draw(strains.stop)
    v = 0.5 * draw(model.size)
    # The norm of the base's quaternion, the last four unknowns, stays: its rate is across it.
    quaternion = np.array(FREE["quaternion"])
    v[-4:] -= quaternion * (quaternion @ v[-4:])
    return model, x, v


def momenta(model: Model, states: list[MotionState]) -> FloatArray:
    """Momentum and angular momentum at T states, shape (T, 6), without moving inputs."""
    still = np.zeros(model.inputs.size)
    rows = []
    for state in states:
        linear, angular = model.momentum(state.x, state.v, state.inputs, still)
        rows.append(np.concatenate([linear.full()[:, 0], angular.full()[:, 0]]))
    return np.array(rows)


@pytest.mark.parametrize("steps", mostly_slow([200, 1000], quick=[200]))
def test_momentum_of_a_free_rod_is_kept_to_rounding(steps: int) -> None:
    """Over a thousand steps, which alone would miss it by 1e-9 and more."""
    model, x, v = spinning()
    found = momenta(model, step_ends(stepped(model, radau(3), 2e-3, 2e-3 * steps, x, v)))
    assert_allclose(found, np.tile(found[0], (steps + 1, 1)), rtol=0, atol=1e-12 * np.abs(found[0]).max())


@pytest.mark.slow
def test_a_rod_that_spins_a_thousand_times_keeps_momentum_and_energy() -> None:
    """A bent rod that vibrates as it spins once a second, in ten steps a turn: neither wears off."""
    bent = undamped("planar", base=FREE, intrinsic={"curvature": [0.0, 0.8, 0.0]})
    model = moving_model(moving_scenes.scene(bent, loads=[]), 2, 6)
    x = model.unloaded()
    along, about = np.split(MomentumKeeper(model).rigid_motions(x), 2, axis=1)
    v = 2.0 * np.pi * about[:, 2]
    linear, moved = (model.momentum(x, rates, [], [])[0].full()[:, 0] for rates in (v, along[:, 0]))
    # About its middle: far away the angular momentum about the origin would be all rounding.
    v -= along @ linear / moved[0]
    states = step_ends(stepped(model, gauss(3), 0.1, 1000.0, x, v))
    found = momenta(model, states)
    assert_allclose(found, np.tile(found[0], (len(states), 1)), rtol=0, atol=1e-11 * np.abs(found[0]).max())
    kept = energies(model, states)
    assert np.ptp(kept) < 1e-3 * kept[0]
    quaternions = np.array([np.array(FREE["quaternion"]) + state.x[-4:] for state in states])
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    turned = 2.0 * np.arccos(np.minimum(1.0, np.abs(np.sum(quaternions[1:] * quaternions[:-1], axis=1))))
    assert turned.sum() > 2.0 * np.pi * 990.0


def hinged() -> transients.Table:
    """Two free rods with their tips on the two sides of a small body: scissors."""
    second = undamped(name="b", base={**FREE, "position": [0.5, 0.1, 0.3]}, length=0.7)
    joints = [moving_scenes.joint("a"), moving_scenes.joint("b", "revolute", axis=[0.3, -0.5, 0.8])]
    return moving_scenes.scene(undamped(base=FREE), second, loads=[], bodies=[moving_scenes.PLATE], joints=joints)


def chain() -> transients.Table:
    """A free rod that carries a second one, whose tip a ball joint and a body hold to a third, free one."""
    carried = undamped(name="b", base={"rod": "a", "at": 0.7, "tangent": [1, 0, 0]}, length=0.5)
    third = undamped("reissner", name="c", base={**FREE, "position": [0.8, 0.1, 0.5]}, length=0.6)
    joints = [moving_scenes.joint("b", "spherical"), moving_scenes.joint("c", "spherical", position=[-0.1, 0, 0])]
    rods = [undamped(base=FREE), carried, third]
    return moving_scenes.scene(*rods, loads=[], bodies=[moving_scenes.PLATE], joints=joints)


@pytest.mark.slow
@pytest.mark.parametrize("jointed", [hinged, chain])
def test_momentum_of_free_rods_that_are_joined_is_kept_to_rounding(jointed: Callable[[], transients.Table]) -> None:
    """Forces in joints act within: steps alone would miss 5e-7 of the momentum of the scissors."""
    model = moving_model(jointed(), 2, 6)
    state = moving_scenes.consistent_state(model, seed=1)
    v = 0.3 * state.v
    states = step_ends(stepped(model, radau(3), 5e-3, 0.1, state.x, v))
    found = momenta(model, states)
    assert_allclose(found, np.tile(found[0], (len(states), 1)), rtol=0, atol=1e-12 * np.abs(found[0]).max())
    # What puts momentum right moves all as one: neither does it open joints, nor have they a rate by it.
    held = moving_scenes.constrained_rows(model)
    gap = model.residual(states[-1].x, states[-1].inputs).full()[held]
    assert_allclose(gap, 0.0, rtol=0, atol=1e-10)
    differential = model.discrete.unknowns.differential
    turns = model.jacobian(states[-1].x, states[-1].inputs)[0].full()[np.ix_(held, differential)]
    rates = turns @ MomentumKeeper(model).rigid_motions(states[-1].x)[differential]
    assert_allclose(rates, 0.0, rtol=0, atol=1e-9 * np.abs(turns).max())


def test_rods_that_nothing_joins_are_not_one_piece() -> None:
    """One rigid motion of both would give the one what the other lacks."""
    apart = undamped(name="b", base={**FREE, "position": [2.0, 0, 0]})
    assert flies_free(moving_model(hinged(), 2, 6))
    assert not flies_free(moving_model(moving_scenes.scene(undamped(base=FREE), apart, loads=[]), 2, 6))
    assert not flies_free(moving_model(moving_scenes.scene(undamped(), loads=[]), 2, 6))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "order"),
    [
        (radau(3), 5),
        (gauss(2), 4),
        (gauss(3), 6),
    ],
    ids=["Radau-3", "Gauss-2", "Gauss-3"],
)
def test_momentum_put_right_leaves_the_order_of_the_steps(method: Collocation, order: int) -> None:
    """Of positions, velocities and energy, beside the same steps as they are."""
    model, x, v = spinning()
    histories = [stepped(model, method, size, 0.2, x, v) for size in (0.01, 0.005, 0.0025)]
    ends = [history.end for history in histories]
    errors = [[np.abs(end.x - ends[2].x).max(), np.abs(end.v - ends[2].v).max()] for end in ends[:2]]
    assert np.all(orders(errors)[-1] > order - 0.6)
    drifts = [np.ptp(energies(model, step_ends(history))) for history in histories]
    assert np.all(orders(drifts) > order - 0.7)


def test_impulse_of_loads_is_what_momentum_gains() -> None:
    """A force and a moment that come and go: ∫ f dt of a wave is its closed form, and weight adds m g t."""
    scene = moving_scenes.scene(undamped(base=FREE), loads=[moving_scenes.WEIGHT])
    push = {"name": "push", "kind": "tip_wrench", "rod": "a", "force": [0, 0, 0]}
    scene["loads"].append(push)
    wave = {"wave": "one_minus_cosine", "frequency": 2.0}
    scene["motions"] = [{"input": "push.force", "amplitude": [0.3, -0.2, 0.1], **wave}]
    motion = simulated(scene, start="unloaded", tolerance=1e-3)
    found = momenta(motion.model, [motion.at(float(time)) for time in motion.times])[:, :3]
    model = motion.model
    drop = momenta(model, [motion.at(0.0)])[0, :3]
    turns = 4.0 * np.pi * motion.times
    impulse = (motion.times - np.sin(turns) / (4.0 * np.pi))[:, None] * np.array([0.3, -0.2, 0.1])
    weighing = 0.8 * motion.times[:, None] * 0.8 * np.array(moving_scenes.WEIGHT["acceleration"])
    # The linear density of the rod is 0.9 at its base and falls to 0.7 at its tip: 0.8 kg/m on average.
    last = len(motion.times) - 1
    assert_allclose(found[last] - drop, (impulse + weighing)[last], rtol=0, atol=2e-6)


@pytest.mark.parametrize("free", [True, False])
def test_rods_keep_no_speed_of_short_steps(monkeypatch: pytest.MonkeyPatch, free: bool) -> None:
    """Where more steps count as short Newton's method takes more iterations for them."""
    rod = undamped(base=FREE) if free else undamped()
    scene = moving_scenes.scene(rod, loads=[moving_scenes.PUSH])
    iterations = []
    for share in (history.DRIFTING, 100.0):
        monkeypatch.setattr(history, "DRIFTING", share)
        motion = simulated(scene, start="unloaded", duration=0.02, tolerance=1e-3)
        iterations.append(motion.statistics.iterations)
    assert iterations[1] > iterations[0]


def test_free_fall_is_a_parabola_without_strain() -> None:
    """Uniform gravity moves the rod as a whole, whatever its shape: exact for every step that is taken."""
    rod = undamped("reissner", base=FREE, intrinsic={"curvature": [0.5, [-1.0, 0.4], 0.3], "tangent": [0, 0, 1]})
    motion = simulated(moving_scenes.scene(rod, loads=[moving_scenes.WEIGHT]), start="unloaded")
    fall = 0.5 * motion.times[:, None] ** 2 * np.array(moving_scenes.WEIGHT["acceleration"])
    tip = motion.tip()
    assert_allclose(tip.position, tip.position[0] + fall, rtol=0, atol=1e-12)
    assert_allclose(tip.quaternion, np.tile(tip.quaternion[0], (len(fall), 1)), rtol=0, atol=1e-12)
    assert_allclose(motion.energy.elastic, 0.0, rtol=0, atol=1e-20)
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=1e-12)


# Energy


@pytest.mark.slow
def test_imbalance_of_energy_falls_with_the_tolerance() -> None:
    """Loads of all kinds, damping, a base that moves and a tendon that is pulled: all enter the balance."""
    scene = moving_scenes.FAMILIES["all driven"]()
    del scene["inputs"]
    wave = {"wave": "one_minus_cosine", "frequency": 2.0}
    scene["motions"] = [
        {"input": "a.base.position", "amplitude": [0.03, 0.02, -0.02], **wave},
        {"input": "a.base.quaternion", "amplitude": [0.05, 0.1, -0.1, 0.05], **wave},
        {"input": "a.length", "amplitude": 0.04, **wave},
        {"input": "cable.tension", "amplitude": 0.5, **wave},
        {"input": "push.force", "amplitude": [0.5, 0.2, -0.3], **wave},
    ]
    imbalances = []
    for tolerance in (1e-3, 1e-4, 1e-5):
        energy = simulated(scene, tolerance=tolerance).energy
        assert energy.dissipated[-1] > 0.0
        imbalances.append(np.abs(energy.imbalance).max())
    for coarse, fine in pairwise(imbalances):
        assert fine < coarse / 3
    assert imbalances[-1] < 1e-5


def test_times_that_leave_the_start_out_have_the_same_energies() -> None:
    scene = transients.line_load(duration=0.5, tolerance=1e-3, times=[0.0, 0.2, 0.4])
    scene["accuracy"] = {"modes": 4, "nodes": 10}
    whole = simulate(moving_model(scene)).energy
    scene["simulation"]["times"] = [0.2, 0.4]
    part = simulate(moving_model(scene)).energy
    for name in ("kinetic", "elastic", "potential", "dissipated", "work"):
        assert_allclose(getattr(part, name), getattr(whole, name)[1:], rtol=1e-12, atol=1e-18)
    assert_allclose(part.imbalance, whole.imbalance[1:], rtol=1e-9, atol=1e-15)


def swinging() -> tuple[Model, FloatArray]:
    """A soft cantilever on two modes, let go under its weight: it swings far, and nothing damps it."""
    model = moving_model(transients.table({}, transients.gravity(5.0), accuracy={"modes": 2, "nodes": 6}))
    return model, model.unloaded()


def largest_change_of_energy(steps: int, parts: int) -> FloatArray:
    """Largest change of energy in each of some equal parts of a motion by Gauss's method, over what is exchanged."""
    model, x = swinging()
    states = step_ends(stepped(model, gauss(3), 0.02, 0.02 * steps, x))
    exchanged = 5.0
    changes = np.abs(energies(model, states)[1:]) / exchanged
    return np.asarray(changes.reshape(parts, -1).max(axis=1))


@pytest.mark.slow
def test_energy_is_bounded_by_gauss() -> None:
    """It swings about its value and does not drift: late steps are as good as early ones."""
    changes = largest_change_of_energy(2000, 4)
    assert changes.max() < 1e-6
    assert changes[-1] < 3 * changes[0]


@pytest.mark.slow
def test_energy_is_bounded_by_gauss_over_many_steps() -> None:
    changes = largest_change_of_energy(100_000, 10)
    assert changes.max() < 1e-6
    assert changes[-1] < 3 * changes[0]


# Time


@pytest.mark.parametrize("method", [gauss(1), gauss(2), gauss(3)], ids=["Gauss-1", "Gauss-2", "Gauss-3"])
def test_steps_of_gauss_run_backwards(method: Collocation) -> None:
    """Velocities turned round, the rod goes the same way back: the method is symmetric. Radau IIA is not."""
    assert distance_after_return(method) < 1e-10
    assert distance_after_return(radau(3)) > 1e-7


def distance_after_return(method: Collocation) -> float:
    """How far from its start a rod is that goes there and back."""
    model, x = swinging()
    there = stepped(model, method, 0.02, 0.5, x).at(0.5)
    back = stepped(model, method, 0.02, 0.5, there.x, -there.v).at(0.5)
    return float(np.abs(back.x - x).max() + np.abs(back.v).max())


# Observers


def test_rod_on_a_base_in_uniform_motion_moves_as_on_one_at_rest() -> None:
    scene = moving_scenes.scene(undamped(), loads=[moving_scenes.WEIGHT, moving_scenes.FOLLOW])
    still = simulated(scene, start="unloaded")
    speed = np.array([0.7, -0.4, 0.2])
    drift = {"input": "a.base.position", "times": [0.0, 1.0], "values": [[0, 0, 0], speed.tolist()]}
    carried = simulated({**scene, "motions": [drift]}, start="unloaded")
    assert carried.start.endswith("without a jerk.")
    assert still.start == "At rest in the unloaded shape."
    drifted = still.tip().position + still.times[:, None] * speed
    assert_allclose(carried.tip().position, drifted, rtol=0, atol=1e-9)
    assert_allclose(carried.tip().quaternion, still.tip().quaternion, rtol=0, atol=1e-9)


def test_a_base_that_is_shaken_is_weight_that_turns() -> None:
    """For who rides on the base: p = a (1 − cos ωt), and g − p̈ in place of g."""
    scene = moving_scenes.scene(undamped(), loads=[moving_scenes.WEIGHT])
    amplitude = np.array([0.02, -0.01, 0.0])
    wave: dict[str, Any] = {"frequency": 2.0, "wave": "one_minus_cosine"}
    shaken = {"input": "a.base.position", "amplitude": amplitude.tolist(), **wave}
    turning = {
        "input": "weight.acceleration",
        "amplitude": (-((4.0 * np.pi) ** 2) * amplitude).tolist(),
        "frequency": 2.0,
        "phase": np.pi / 2.0,
    }
    ridden = simulated({**scene, "motions": [shaken]}, start="unloaded")
    turned = simulated({**scene, "motions": [turning]}, start="unloaded")
    base = amplitude * (1.0 - np.cos(4.0 * np.pi * ridden.times))[:, None]
    assert np.abs(turned.tip().position[:, :2]).max() > 0.02
    assert_allclose(ridden.tip().position - base, turned.tip().position, rtol=0, atol=8e-5)


def test_turned_scene_moves_as_the_scene_does() -> None:
    """Base, weight and force turned by the same rotation: so is the path."""
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    weight = np.array(moving_scenes.WEIGHT["acceleration"])
    plain = simulated(moving_scenes.scene(undamped(), loads=[moving_scenes.WEIGHT]), start="unloaded")
    turned_weight = {**moving_scenes.WEIGHT, "acceleration": (turn @ weight).tolist()}
    # x to y, y to z, z to x: a third of a turn about the diagonal.
    base = {"quaternion": [0.5, 0.5, 0.5, 0.5]}
    turned = simulated(moving_scenes.scene(undamped(base=base), loads=[turned_weight]), start="unloaded")
    assert_allclose(turned.tip().position, plain.tip().position @ turn.T, rtol=0, atol=1e-11)


@pytest.mark.slow
def test_two_rods_in_series_move_as_one() -> None:
    """One carries the other at its tip; the joint is a constraint, and the modes of the halves are others."""
    length = 0.8
    loads = [moving_scenes.WEIGHT, {**moving_scenes.PUSH, "rod": "b"}]
    whole = undamped(name="b", linear_density=0.8, length=length)
    halves = [
        undamped(name="a", linear_density=0.8, length=length / 2),
        undamped(name="b", linear_density=0.8, length=length / 2, base={"rod": "a"}),
    ]
    one = simulated({**moving_scenes.scene(whole, loads=loads), "accuracy": {"modes": 8, "nodes": 20}})
    two = simulated({**moving_scenes.scene(*halves, loads=loads), "accuracy": {"modes": 5, "nodes": 14}})
    assert_allclose(two.tip("b").position, one.tip().position, rtol=0, atol=2e-4 * length)
    assert_allclose(two.tip("a").position, one.section(None, [0.5]).position[:, 0], rtol=0, atol=2e-4 * length)
