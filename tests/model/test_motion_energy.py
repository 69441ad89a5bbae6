"""Balance of energy in motion, dissipation, momentum: against AD through time and against each other."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from tests.families import mostly_slow
from tests.moving_scenes import (
    FAMILIES,
    FOLLOW,
    PUSH,
    WEIGHT,
    State,
    consistent_state,
    drawn_state,
    model_of,
    symbols_of,
)

EVERY = pytest.mark.parametrize("family", FAMILIES)


@cache
def energy_rates(family: str) -> ca.Function:
    """Rates of kinetic energy, elastic energy and the energies of loads along a motion, by AD."""
    model = model_of(family)
    symbols = symbols_of(model)
    x, v, a, inputs, inputs_rate, inputs_acceleration = symbols
    energies = model.energies(x, v, inputs, inputs_rate)
    state = ca.vertcat(x, v, inputs, inputs_rate)
    direction = ca.vertcat(v, a, inputs_rate, inputs_acceleration)
    rates = [ca.jtimes(energy, state, direction) for energy in energies[:3]]
    return ca.Function("rates", symbols, rates)


def only_bases_and_lengths(state: State, family: str) -> State:
    """The same with loads and tensions that do not vary: their energies change by motion alone."""
    model = model_of(family)
    rates, accelerations = np.zeros((2, len(state.inputs)))
    for name in ("base.position", "base.quaternion", "length"):
        entries = model.discrete.layout.of_rod("a", name)
        if entries is not None:
            rates[entries] = state.inputs_rate[entries]
            accelerations[entries] = state.inputs_acceleration[entries]
    return State(state.x, state.v, state.a, state.inputs, rates, accelerations)


ALIKE = ("prismatic joint", "fixed joint", "carried")
"""Families whose powers are those of others with joints, and that take longest."""


@pytest.mark.parametrize("seed", mostly_slow([1, 2], quick=[1]))
@pytest.mark.parametrize("family", mostly_slow(FAMILIES, quick=[name for name in FAMILIES if name not in ALIKE]))
def test_balance_of_energy(family: str, seed: int) -> None:
    """Kinetic and elastic energy grow by the powers that are put in, and by the work of what the equations lack.

    The state is no solution of the equations of motion: their residuals are forces that do work on the rates.
    """
    model = model_of(family)
    state = consistent_state(model, seed)
    kinetic, elastic = (float(rate) for rate in energy_rates(family)(*state.all)[:2])
    dissipated, of_loads, of_actuators, of_bases = (power.full().ravel() for power in model.powers(*state.all))
    put_in = of_loads.sum() + of_actuators.sum() + of_bases.sum()
    lacking = model.discrete.unknowns.units * model.inverse_dynamics(*state.all).full().ravel()
    differential = np.asarray(model.discrete.unknowns.differential)
    work = lacking[differential] @ state.v[differential]
    terms = np.array([kinetic, elastic, dissipated.item(), put_in, work])
    size = np.abs(terms).max()
    assert_allclose(kinetic + elastic + dissipated.item(), put_in + work, rtol=0, atol=1e-13 * size)
    # The terms must be there to be wrong.
    assert np.abs([kinetic, work]).min() > 1e-6 * size


@EVERY
def test_dissipated_power_is_never_negative(family: str) -> None:
    model = model_of(family)
    damped = any(record.damping is not None for record in model.scene.rods)
    for seed in range(5):
        dissipated = float(model.powers(*drawn_state(model, seed).all)[0])
        assert dissipated > 0 if damped else dissipated == 0


@pytest.mark.parametrize("family", ["kirchhoff", "two elements", "fixed joint", "carried", "free", "moving base"])
def test_energy_of_a_dead_force_is_minus_its_work(family: str) -> None:
    model = model_of(family)
    state = only_bases_and_lengths(consistent_state(model, 3), family)
    rates = energy_rates(family)(*state.all)[2].full().ravel()
    powers = model.powers(*state.all)[1].full().ravel()
    dead = model.energies(*state.velocities)[3].full().ravel() > 0
    assert dead.any()
    assert_allclose(rates[dead], -powers[dead], rtol=0, atol=1e-12 * np.abs(powers).max())
    assert_allclose(rates[~dead], 0.0, rtol=0, atol=0)


def test_which_loads_have_an_energy() -> None:
    found = {}
    for family in ("kirchhoff", "reissner", "two elements", "moving base"):
        model = model_of(family)
        flags = model.energies(*drawn_state(model).velocities)[3].full().ravel()
        found |= {load.name: bool(flag) for load, flag in zip(model.scene.loads, flags, strict=True)}
    wanted = {"weight": True, "push": True, "hook": True, "breeze": True}
    assert found == {**wanted, "twist": False, "follow": False, "wind": False}


def test_powers_of_loads_vs_forces_times_velocities() -> None:
    """A force on the tip, a moment on it, and weight: by velocities that AD takes from the poses of the model."""
    model = model_of("kirchhoff")
    state = drawn_state(model, 4)
    x, inputs = ca.MX.sym("x", model.size), ca.MX(ca.DM(state.inputs))
    position, _, rotation = model.tip["a"](x, inputs)
    nodes = model.fields["a"](x, inputs)[0]
    v = ca.DM(state.v)
    outputs = [ca.jtimes(position, x, v), ca.jtimes(ca.vec(rotation), x, v), rotation, ca.jtimes(ca.vec(nodes), x, v)]
    tip, turning, R, along = (out.full() for out in ca.Function("rates", [x], outputs)(state.x))
    spin = turning.reshape(3, 3, order="F") @ R.T
    omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    grid = model.discrete.rods["a"].grid
    density = np.linspace(0.9, 0.7, 2) @ np.vstack([1 - grid.nodes, grid.nodes])
    masses = 0.8 * grid.weights * density
    velocities = along.reshape(3, -1, order="F")
    weight, push, twist = model.powers(*state.all)[1].full().ravel()
    assert_allclose(weight, np.array([0.3, -0.2, -2.0]) @ velocities @ masses, rtol=1e-12, atol=0)
    assert_allclose(push, np.array([0.4, 0.3, -0.4]) @ tip.ravel(), rtol=1e-12, atol=0)
    assert_allclose(twist, np.array([0.1, 0.05, 0.2]) @ omega, rtol=1e-12, atol=0)


def test_powers_of_actuators_are_efforts_times_rates_of_conjugates() -> None:
    model = model_of("tendons")
    state = drawn_state(model, 5)
    x = ca.MX.sym("x", model.size)
    of_actuators = model.powers(*state.all)[2].full().ravel()
    signs = {"cable": -1.0, "cell": 1.0}
    for (name, sign), power in zip(signs.items(), of_actuators, strict=True):
        effort, conjugate, _ = model.actuator[name](x, state.inputs)
        rate = ca.jtimes(conjugate, x, ca.DM(state.v))
        expected = ca.Function("power", [x], [sign * effort * rate])(state.x)
        assert_allclose(power, float(expected), rtol=1e-12, atol=0)


FREE = pytest.mark.parametrize("family", ["free", "free with body"])


def moved_as_a_whole(family: str, state: State, velocity: np.ndarray, spin: np.ndarray) -> np.ndarray:
    """Rates of the unknowns where all frames move as one rigid body about the origin of the world."""
    model = model_of(family)
    v = np.zeros(model.size)
    for name, frame in model.discrete.frames.items():
        entries = model.discrete.deviation(name)
        position = frame.start.position + frame.length * state.x[entries][:3]
        real, *imaginary = frame.start.quaternion + state.x[entries][3:]
        v[entries][:3] = (velocity + np.cross(spin, position)) / frame.length
        v[entries][3:] = np.concatenate([[-spin @ imaginary], real * spin + np.cross(spin, imaginary)]) / 2
    return v


def mass_points(family: str, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Masses and where they are: nodes of rods, and centres of mass of bodies."""
    model = model_of(family)
    masses, places = [], []
    for record in model.scene.rods:
        grid = model.discrete.rods[record.name].grid
        masses.append(record.length * grid.weights * (0.9 - 0.2 * grid.nodes))
        places.append(model.fields[record.name](state.x, state.inputs)[0].full().T)
    for body in model.scene.bodies:
        position, _, rotation = (m.full() for m in model.body[body.name](state.x, state.inputs))
        masses.append(np.array([body.mass]))
        places.append((position[:, 0] + rotation @ body.centre_of_mass)[None, :])
    return np.concatenate(masses), np.vstack(places)


@FREE
def test_momenta_of_a_scene_that_is_moved_along(family: str) -> None:
    model = model_of(family)
    state = consistent_state(model, 6)
    velocity = np.array([0.3, -0.2, 0.5])
    masses, places = mass_points(family, state)
    v = moved_as_a_whole(family, state, velocity, np.zeros(3))
    linear, angular = (m.full().ravel() for m in model.momentum(state.x, v, state.inputs, state.inputs_rate))
    kinetic = float(model.energies(state.x, v, state.inputs, state.inputs_rate)[0])
    assert_allclose(linear, masses.sum() * velocity, rtol=0, atol=1e-13)
    assert_allclose(angular, np.cross(masses @ places, velocity), rtol=0, atol=1e-13)
    assert_allclose(kinetic, masses.sum() * velocity @ velocity / 2, rtol=1e-13, atol=0)


@FREE
def test_momenta_of_a_scene_that_is_turned_about_the_origin(family: str) -> None:
    model = model_of(family)
    state = consistent_state(model, 6)
    spin = np.array([0.4, 0.1, -0.6])
    masses, places = mass_points(family, state)
    v = moved_as_a_whole(family, state, np.zeros(3), spin)
    linear, angular = (m.full().ravel() for m in model.momentum(state.x, v, state.inputs, state.inputs_rate))
    kinetic = float(model.energies(state.x, v, state.inputs, state.inputs_rate)[0])
    assert_allclose(linear, masses @ np.cross(spin, places), rtol=0, atol=1e-13)
    assert_allclose(spin @ angular, 2 * kinetic, rtol=1e-13, atol=0)
    of_points = masses @ np.cross(places, np.cross(spin, places))
    # Sections and bodies turn as well.
    assert spin @ angular > spin @ of_points


def in_motion(family: str, seed: int) -> State:
    """A consistent state with the accelerations that its forces, and any wrenches of its joints, give it."""
    model = model_of(family)
    state = consistent_state(model, seed)
    _, _, mass, residual = (m.full() for m in model.dynamics_jacobian(*state.all))
    moving = np.asarray(model.discrete.unknowns.differential)
    a = state.a.copy()
    a[moving] -= np.linalg.solve(mass[np.ix_(moving, moving)], residual.ravel()[moving])
    moved = State(state.x, state.v, a, state.inputs, state.inputs_rate, state.inputs_acceleration)
    assert np.abs(model.inverse_dynamics(*moved.all).full().ravel()[moving]).max() < 1e-10
    return moved


@FREE
def test_rates_of_the_momenta_are_the_loads(family: str) -> None:
    """Of a scene that touches nothing: resultant, and moment about the origin of the world. Joints drop out."""
    model = model_of(family)
    state = in_motion(family, 7)
    symbols = symbols_of(model)
    x, v, a, inputs, inputs_rate, _ = symbols
    momenta = ca.vertcat(*model.momentum(x, v, inputs, inputs_rate))
    rate = ca.jtimes(momenta, ca.vertcat(x, v), ca.vertcat(v, a))
    found = ca.Function("rate", symbols, [rate])(*state.all).full().ravel()
    force, moment = loads_in_the_world(family, state)
    assert_allclose(found[:3], force, rtol=0, atol=1e-10)
    assert_allclose(found[3:], moment, rtol=0, atol=1e-10)


def loads_in_the_world(family: str, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Resultant and moment about the origin of weight, push, follower and wind, summed by hand."""
    model = model_of(family)
    masses, places = mass_points(family, state)
    weight = masses[:, None] * np.asarray(WEIGHT["acceleration"])
    force, moment = weight.sum(axis=0), np.cross(places, weight).sum(axis=0)
    tip, _, world_R_tip = (m.full() for m in model.tip["a"](state.x, state.inputs))
    names = [load.name for load in model.scene.loads]
    push = np.asarray(PUSH["force"])
    force, moment = force + push, moment + np.cross(tip[:, 0], push)
    if "follow" in names:
        follow = world_R_tip @ FOLLOW["force"]
        force, moment = force + follow, moment + np.cross(tip[:, 0], follow) + world_R_tip @ FOLLOW["moment"]
    if "wind" in names:
        quaternions = model.fields["a"](state.x, state.inputs)[1].full().T
        grid = model.discrete.rods["a"].grid
        in_section = np.stack([0.4 + 0.3 * (2 * grid.nodes - 1), np.full(grid.size, 0.2), np.zeros(grid.size)], axis=1)
        wind = Rotation.from_quat(quaternions[:, [1, 2, 3, 0]]).apply(in_section) * (0.8 * grid.weights)[:, None]
        force, moment = force + wind.sum(axis=0), moment + np.cross(places[: grid.size], wind).sum(axis=0)
    return force, moment
