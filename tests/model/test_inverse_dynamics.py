"""Equations of motion of whole scenes: statics at rest, Lagrange's equations, derivatives, moving bases."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, read_scene, scene_from_dict
from cosserat_casadi.model.floating_frames import FrameName
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.moving_scenes import (
    FAMILIES,
    PLATE,
    PUSH,
    ROTARY,
    State,
    consistent_state,
    drawn_state,
    joint,
    model_of,
    rod,
    scene,
    symbols_of,
)
from tests.reference.random_scenes import random_scene

QUICK = (
    "planar",
    "reissner",
    "two elements",
    "revolute joint",
    "carried",
    "free with body",
    "slack",
    "driven and held",
)
EVERY = pytest.mark.parametrize("family", mostly_slow(FAMILIES, quick=QUICK))
LIVELIEST = pytest.mark.parametrize(
    "family", mostly_slow(FAMILIES, quick=["carried", "driven and held", "slack", "free with body"])
)
"""Families that move in most ways: the others are compared with derivatives by CasADi every time."""

COARSE = {"modes": 3, "nodes": 7}
LIVELY = ("linear_density", "rotary_inertia", "damping")


# At rest


def at_rest(model: Model, x: np.ndarray) -> np.ndarray:
    zero = np.zeros(model.size)
    still = np.zeros(model.discrete.layout.size)
    return np.asarray(model.inverse_dynamics(x, zero, zero, model.pack(), still, still).full())


@EVERY
def test_residual_at_rest_is_that_of_statics_to_the_last_bit(family: str) -> None:
    model = model_of(family)
    for seed in range(3):
        x = drawn_state(model, seed).x
        np.testing.assert_array_equal(at_rest(model, x), model.residual(x, model.pack()).full())


@EVERY
def test_residual_in_scalars_vs_that_of_matrices(family: str) -> None:
    model = model_of(family)
    state = drawn_state(model, seed=5)
    expected = model.inverse_dynamics(*state.all).full()
    found = model.inverse_dynamics_in_scalars(*state.all).full()
    assert_allclose(found, expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())


# Concentric tubes have no rods to build.
OF_RODS = sorted(path.name for path in (ROOT / "examples").glob("*.toml") if "[[tubes]]" not in path.read_text())


@pytest.mark.parametrize("name", mostly_slow(OF_RODS, quick=OF_RODS[::9]))
def test_examples_at_rest_are_static_to_the_last_bit(name: str) -> None:
    tables = read_scene(ROOT / "examples" / name)
    model = build(tables)
    x = 0.2 * np.random.default_rng(1).standard_normal(model.size)
    np.testing.assert_array_equal(at_rest(model, x), model.residual(x, model.pack()).full())


@pytest.mark.parametrize("seed", mostly_slow(range(12), quick=range(4)))
def test_random_scenes_at_rest_are_static_to_the_last_bit(seed: int) -> None:
    model = build(scene_from_dict({**random_scene(seed), "accuracy": COARSE}))
    x = np.random.default_rng(seed).standard_normal(model.size)
    np.testing.assert_array_equal(at_rest(model, x), model.residual(x, model.pack()).full())


def test_what_moves_costs_statics_not_one_instruction() -> None:
    """Mass, damping, a time to simulate and inputs over time are not there for residual, Jacobian and tip."""
    bare = [{key: record[key] for key in record if key not in LIVELY} for record in (rod(), rod("b", "reissner"))]
    body = {"name": "plate"}
    still = scene(*bare, loads=[PUSH], bodies=[body], joints=[joint("a"), joint("b")])
    lively = scene(rod(), rod("b", "reissner"), loads=[PUSH], bodies=[PLATE], joints=[joint("a"), joint("b")])
    lively["simulation"] = {"duration": 1.0}
    lively["motions"] = [{"input": "push.force", "amplitude": [0.1, 0.2, 0.3], "frequency": 2.0}]
    models = [build(scene_from_dict(tables)) for tables in (still, lively)]
    for name in ("residual", "jacobian", "path_residual", "path_jacobian", "input_jacobian", "energy"):
        counts = [model.operations(getattr(model, name)) for model in models]
        assert counts[0] == counts[1], name


# Lagrange


def norm_rows(model: Model, state: State) -> np.ndarray:
    """τ² Q (Q·Q̈ + Q̇·Q̇) of the frames, τ² = (m ℓ² + tr J)/unit: not of mechanics."""
    rows = np.zeros(model.size)
    for name, frame in model.discrete.frames.items():
        entries = model.discrete.deviation(name)
        Q = frame.start.quaternion + state.x[entries][3:]
        rate, second = state.v[entries][3:], state.a[entries][3:]
        time = turning_mass(model, name, frame.length) / frame.unit
        rows[entries][3:] = time * Q * (Q @ second + rate @ rate)
    return rows


def turning_mass(model: Model, name: FrameName, length: float) -> float:
    if name.kind == "body":
        body = next(body for body in model.scene.bodies if body.name == name.name)
        return body.mass * length**2 + float(np.trace(body.inertia_matrix))
    record = next(record for record in model.scene.rods if record.name == name.name)
    disks = sum(row.mass * len(row.places) for row in model.scene.disks)
    return float(record.length * np.mean(record.linear_density) + disks) * length**2


@cache
def lagrange(family: str) -> ca.Function:
    """d/dt ∂T/∂v − ∂T/∂x, ∂T/∂v, and the Hessian of T with v, by AD of the kinetic energy."""
    return lagrange_of(model_of(family))


@cache
def without_disks(family: str) -> ca.Function:
    """The same of rods whose disks have no mass."""
    tables = FAMILIES[family]()
    for row in tables.get("disks", []):
        row["mass"] = 0.0
    return lagrange_of(build(scene_from_dict(tables), moving=True))


def lagrange_of(model: Model) -> ca.Function:
    symbols = symbols_of(model)
    x, v, a, inputs, inputs_rate, inputs_acceleration = symbols
    kinetic = model.energies(x, v, inputs, inputs_rate)[0]
    momentum = ca.gradient(kinetic, v)
    state = ca.vertcat(x, v, inputs, inputs_rate)
    direction = ca.vertcat(v, a, inputs_rate, inputs_acceleration)
    left = ca.jtimes(momentum, state, direction) - ca.gradient(kinetic, x)
    outputs = [ca.densify(value) for value in (left, momentum, ca.jacobian(momentum, v))]
    return ca.Function("lagrange", symbols, outputs)


def undamped(model: Model, state: State) -> np.ndarray:
    """What motion adds to the residual, times the units, J: without damping."""
    added = model.inverse_dynamics(*state.all).full().ravel() - model.residual(state.x, state.inputs).full().ravel()
    for name, matrices in model.discrete.rods.items():
        entries = model.discrete.unknowns.strain(name)
        length = model.discrete.layout.of_rod(name, "length")
        ratio, rate = 1.0, 0.0
        if length is not None:
            ratio = float(state.inputs[length][0] / matrices.length)
            rate = float(state.inputs_rate[length][0] / matrices.length)
        strain_rate = (state.v[entries] - state.x[entries] * rate / ratio) / ratio
        added[entries] -= matrices.viscosity @ strain_rate
    return np.asarray(model.discrete.unknowns.units * (added - norm_rows(model, state)))


@LIVELIEST
def test_inertia_vs_lagrange(family: str) -> None:
    """Of the discrete kinetic energy, in any state: floating frames of any norm, bodies, moving bases.

    A rod that is drawn out gains mass that comes at the speed of its section: Lagrange's equations of a mass that is
    there are short of it.
    """
    model = model_of(family)
    for seed in (1, 2):
        state = drawn_state(model, seed)
        left = lagrange(family)(*state.all)[0].full().ravel()
        length = model.discrete.layout.of_rod("a", "length")
        if length is not None:
            momentum = without_disks(family)(*state.all)[1].full().ravel()
            left = left - momentum * state.inputs_rate[length] / state.inputs[length]
        assert_allclose(undamped(model, state), left, rtol=0, atol=1e-13 * np.abs(left).max())


@LIVELIEST
def test_mass_is_the_hessian_of_the_kinetic_energy(family: str) -> None:
    model = model_of(family)
    state = drawn_state(model, 3)
    hessian = lagrange(family)(*state.all)[2].full()
    units = model.discrete.unknowns.units[:, None]
    mass = units * model.mass_matrix(state.x, state.inputs).full()
    in_motion = units * model.dynamics_jacobian(*state.all)[2].full()
    for name, frame in model.discrete.frames.items():
        entries = model.discrete.deviation(name)
        Q = frame.start.quaternion + state.x[entries][3:]
        spread = turning_mass(model, name, frame.length) * np.outer(Q, Q)
        hessian[entries, entries][3:, 3:] += spread
    size = np.abs(hessian).max()
    assert_allclose(mass, hessian, rtol=0, atol=1e-13 * size)
    assert_allclose(in_motion, hessian, rtol=0, atol=1e-13 * size)
    assert_allclose(mass, mass.T, rtol=0, atol=1e-14 * size)


@LIVELIEST
def test_forces_of_velocity_do_the_work_of_the_changing_mass(family: str) -> None:
    """2 v·c = v·Ṁ v with c the inertia at a = 0: v·(Ṁ − 2 C) v = 0 of textbooks, for any choice of their C."""
    model = model_of(family)
    state = consistent_state(model, 4)
    inputs, still = state.inputs, np.zeros(len(state.inputs))
    coasting = State(state.x, state.v, np.zeros(model.size), inputs, still, still)
    x, velocity = ca.MX.sym("x", model.size), ca.DM(state.v)
    units = ca.DM(model.discrete.unknowns.units)
    twice_kinetic = ca.dot(units * velocity, model.mass_matrix(x, inputs) @ velocity)
    rate = float(ca.Function("rate", [x], [ca.jtimes(twice_kinetic, x, velocity)])(state.x))
    moving = np.asarray(model.discrete.unknowns.differential)
    work = undamped(model, coasting)[moving] @ state.v[moving]
    assert_allclose(2 * work, rate, rtol=0, atol=1e-12 * max(abs(rate), 1e-3))


# Derivatives


@cache
def compared(family: str) -> ca.Function:
    """Derivatives of the residual as written, and by AD."""
    model = model_of(family)
    symbols = symbols_of(model)
    written = model.dynamics_jacobian(*symbols)
    residual = model.inverse_dynamics(*symbols)
    automatic = [ca.jacobian(residual, symbol) for symbol in symbols[:3]]
    return ca.Function("compared", symbols, [ca.densify(value) for value in (*written, *automatic)])


def check_derivatives(family: str, state: State) -> None:
    stiffness, damping, mass, residual, *automatic = (m.full() for m in compared(family)(*state.all))
    assert np.all(np.isfinite(residual))
    for own, by_ad in zip((stiffness, damping, mass), automatic, strict=True):
        assert np.all(np.isfinite(own))
        assert_allclose(own, by_ad, rtol=0, atol=1e-13 * max(1.0, np.abs(by_ad).max()))


@EVERY
def test_derivatives_vs_ad(family: str) -> None:
    for seed in (1, 2):
        check_derivatives(family, drawn_state(model_of(family), seed))


def turned(model: Model, state: State, angle: float) -> np.ndarray:
    """Unknowns without strain, and all floating frames turned by an angle."""
    x = np.zeros(model.size)
    for name, frame in model.discrete.frames.items():
        quaternion = np.array([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])
        x[model.discrete.deviation(name)][3:] = quaternion - frame.start.quaternion
    algebraic = ~np.asarray(model.discrete.unknowns.differential)
    x[algebraic] = state.x[algebraic]
    return x


@pytest.mark.parametrize("angle", [0.0, np.pi, 2 * np.pi])
@EVERY
def test_derivatives_without_strain_and_at_any_turn(family: str, angle: float) -> None:
    """Straight or unloaded rods, frames at the identity and half turns, with rates and without."""
    model = model_of(family)
    state = drawn_state(model, 5)
    x, zero, still = turned(model, state, angle), np.zeros(model.size), np.zeros(len(state.inputs))
    check_derivatives(family, State(x, state.v, state.a, state.inputs, state.inputs_rate, state.inputs_acceleration))
    check_derivatives(family, State(x, zero, zero, state.inputs, still, still))


@EVERY
def test_derivatives_vs_central_differences(family: str) -> None:
    model = model_of(family)
    state = drawn_state(model, 6)
    step = 1e-5
    own = [m.full() for m in model.dynamics_jacobian(*state.all)[:3]]
    for number, matrix in enumerate(own):
        steps = step * np.hstack([np.eye(model.size), -np.eye(model.size)])
        arguments: list[np.ndarray] = list(state.all)
        # A column for each step: CasADi calls the function for one after the other.
        arguments[number] = state.all[number][:, None] + steps
        ahead, behind = np.hsplit(model.inverse_dynamics(*arguments).full(), 2)
        differences = (ahead - behind) / (2 * step)
        assert_allclose(matrix, differences, rtol=1e-6, atol=1e-7 * max(1.0, np.abs(matrix).max()))


@EVERY
def test_algebraic_unknowns_have_no_rates(family: str) -> None:
    model = model_of(family)
    state = drawn_state(model, 7)
    algebraic = ~np.asarray(model.discrete.unknowns.differential)
    _, damping, mass, residual = (m.full() for m in model.dynamics_jacobian(*state.all))
    assert not damping[:, algebraic].any()
    assert not mass[:, algebraic].any()
    v, a = state.v.copy(), state.a.copy()
    v[algebraic] = a[algebraic] = np.nan
    unread = State(state.x, v, a, state.inputs, state.inputs_rate, state.inputs_acceleration)
    np.testing.assert_array_equal(model.inverse_dynamics(*unread.all).full(), residual)


def test_mass_of_a_kirchhoff_rod_may_be_singular_but_no_step_is() -> None:
    slender = rod(linear_density=0.9)
    del slender["rotary_inertia"]
    model = build(scene_from_dict(scene(slender, loads=[PUSH])))
    zero, still = np.zeros(model.size), np.zeros(len(model.pack()))
    stiffness, damping, mass, _ = model.dynamics_jacobian(zero, zero, zero, model.pack(), still, still)
    assert np.linalg.matrix_rank(mass.full()) < model.size
    step = stiffness.full() + 10.0 * damping.full() + 100.0 * mass.full()
    assert np.linalg.cond(step) < 1e3


# Moving bases


def test_a_base_that_moves_uniformly_is_at_rest() -> None:
    """Galilei: the residual reads the velocity of the base nowhere."""
    model = model_of("moving base")
    state = drawn_state(model, 8)
    still = np.zeros(len(state.inputs))
    uniform = still.copy()
    uniform[model.discrete.layout.of_rod("a", "base.position")] = [3.0, -7.0, 11.0]
    resting = model.inverse_dynamics(state.x, state.v, state.a, state.inputs, still, still)
    moving = model.inverse_dynamics(state.x, state.v, state.a, state.inputs, uniform, still)
    assert_allclose(moving.full(), resting.full(), rtol=0, atol=1e-13)


@cache
def driven_with_weight() -> Model:
    """A moving base under a weight that is an input too."""
    tables = FAMILIES["moving base"]()
    return build(scene_from_dict({**tables, "inputs": [*tables["inputs"], "weight.acceleration"]}))


def test_an_accelerated_base_is_as_good_as_weight() -> None:
    """Einstein's lift: the residual sees the acceleration of the base less that of weight alone."""
    model = driven_with_weight()
    state = drawn_state(model, 9)
    still, lifted = np.zeros(len(state.inputs)), np.zeros(len(state.inputs))
    push = np.array([0.7, -0.4, 1.2])
    lifted[model.discrete.layout.of_rod("a", "base.position")] = push
    heavier = state.inputs.copy()
    heavier[model.discrete.layout.of_load("weight", "acceleration")] -= push
    accelerated = model.inverse_dynamics(state.x, state.v, state.a, state.inputs, still, lifted)
    weighed = model.inverse_dynamics(state.x, state.v, state.a, heavier, still, still)
    assert_allclose(accelerated.full(), weighed.full(), rtol=0, atol=1e-13)
    pushed = model.base_wrench["a"](state.x, state.v, state.a, state.inputs, still, lifted)
    weighing = model.base_wrench["a"](state.x, state.v, state.a, heavier, still, still)
    for one, other in zip(pushed, weighing, strict=True):
        assert_allclose(one.full(), other.full(), rtol=0, atol=1e-12)


def test_stretch_of_a_rod_on_a_turning_table() -> None:
    """Kane, Ryan and Banerjee 1987: EA u'' = −ρA Ω² r has u(L) = tan(k L)/k − L with k² = ρA Ω²/EA; 5.14317e-4 here."""
    stiffness = {"bending_x": 1.4e4, "bending_y": 1.4e4, "torsion": 1e4}
    linear = {"shear_x": 1e7, "shear_y": 1e7, "extension": 2.8e7}
    arm = {
        "name": "a",
        "length": 10.0,
        "strain": "reissner",
        "stiffness": {**stiffness, **linear},
        "linear_density": 1.2,
    }
    tables = scene(arm, loads=[], inputs=["a.base.quaternion"], accuracy={"modes": 6, "nodes": 14})
    model = build(scene_from_dict(tables))
    speed = 6.0
    # About the x axis of the world, across the rod: Q = (cos, sin, 0, 0) of half the angle.
    rate = np.array([0.0, speed / 2, 0.0, 0.0])
    acceleration = np.array([-(speed**2) / 4, 0.0, 0.0, 0.0])
    x, zero = np.zeros(model.size), np.zeros(model.size)
    for _ in range(5):
        stiffness_now, _, _, residual = model.dynamics_jacobian(x, zero, zero, model.pack(), rate, acceleration)
        x = x - np.linalg.solve(stiffness_now.full(), residual.full()).ravel()
    assert np.abs(residual.full()).max() < 1e-12
    tip = model.tip["a"](x, model.pack())[0].full().ravel()
    k = speed * np.sqrt(1.2 / 2.8e7)
    assert_allclose(tip, [0.0, 0.0, np.tan(10 * k) / k], rtol=0, atol=1e-12)
    assert_allclose(tip[2] - 10, 5.14317e-4, rtol=1e-5, atol=0)
    # The clamp holds the rod on its circle: ρA Ω² ∫ r dX.
    force, _ = model.base_wrench["a"](x, zero, zero, model.pack(), rate, acceleration)
    pull = 2.8e7 * (1 / np.cos(10 * k) - 1)
    assert_allclose(force.full().ravel(), [0.0, 0.0, -pull], rtol=0, atol=1e-8 * pull)


@pytest.mark.parametrize("family", ["kirchhoff", "two elements", "moving base", "all driven", "free", "carried"])
def test_base_wrench_in_motion_vs_sum_over_the_nodes(family: str) -> None:
    """What motion adds is the sum of ρA r̈ and of the rates of the sections' angular momenta, about the base.

    Positions and rotations of the nodes are differentiated through time by AD, those of statics, with all that moves.
    """
    model = model_of(family)
    state = consistent_state(model, 10)
    t = ca.MX.sym("t")
    x, inputs = (
        ca.DM(value) + t * ca.DM(rate) + t**2 / 2 * ca.DM(second)
        for value, rate, second in ((state.x, state.v, state.a), state.all[3:])
    )
    for record in model.scene.rods:
        matrices = model.discrete.rods[record.name]
        fields = model.fields[record.name](x, inputs)
        positions, quaternions, base = fields[0], fields[1], model.base_wrench[record.name]
        count = matrices.grid.size
        length = model.discrete.layout.of_rod(record.name, "length")
        ratio = 1.0 if length is None else float(state.inputs[length][0] / record.length)
        tapered = 0.9 - 0.2 * matrices.grid.nodes
        lengths = ratio * matrices.node_lengths
        spins = []
        for node in range(count):
            R = _matrix(quaternions[:, node])
            turning = ca.reshape(ca.jacobian(ca.vec(R), t), 3, 3) @ R.T
            omega = ca.vertcat(turning[2, 1], turning[0, 2], turning[1, 0])
            spins.append(R @ ca.diag(ca.DM(ROTARY)) @ R.T @ omega)
        spin = ca.horzcat(*spins)
        rate = ca.jacobian(ca.vec(positions), t)
        outputs = [positions, ca.jacobian(rate, t), ca.jacobian(ca.vec(spin), t)]
        places, accelerations, couples = (
            m.full().reshape(3, count, order="F").T for m in ca.Function("rates", [t], outputs)(0.0)
        )
        forces = (lengths * tapered)[:, None] * accelerations
        moments = np.cross(places - places[0], forces) + lengths[:, None] * couples
        zero, still = np.zeros(model.size), np.zeros(len(state.inputs))
        moving = base(*state.all)
        resting = base(state.x, zero, zero, state.inputs, still, still)
        for one, other, total in zip(moving, resting, (forces, moments), strict=True):
            assert_allclose((one - other).full().ravel(), total.sum(axis=0), rtol=0, atol=1e-11)


def _matrix(Q: ca.MX) -> ca.MX:
    """Rotation matrix of a unit quaternion w, x, y, z: R = 1 + 2 w v^ + 2 v^ v^."""
    hat = ca.skew(Q[1:])
    return ca.MX.eye(3) + 2 * Q[0] * hat + 2 * hat @ hat
