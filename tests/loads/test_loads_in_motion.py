"""Loads that depend on the rates of their sections: equations of motion, their derivatives, powers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, scene_from_dict
from cosserat_casadi.loads.load import BodyPoint, Load, Section
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.registry import register
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LoadRecord
from tests.families import mostly_slow
from tests.moving_scenes import FAMILIES, State, Tables, drawn_state, rod, scene, symbols_of
from tests.registration import forget

FLOW: Tables = {
    "name": "water",
    "kind": "flow",
    "density": 40.0,
    "velocity": [0.3, -0.2, 0.4],
    "tangential": 0.2,
    "gravity": [0.0, 0.1, -2.0],
    "diameter": [0.06, 0.03],
}
SHAKER: Tables = {"name": "shaker", "kind": "shaker", "rod": "a", "at": 0.4, "strength": 0.3}
RUBBER: Tables = {"name": "rubber", "kind": "rubber", "rod": "a", "strength": 0.3}
WITHOUT_MASS = ("linear_density", "rotary_inertia")
TRIED = ("planar", "reissner", "two elements", "one strain", "carried", "free", "fixed joint", "all driven")


class _OneNumber(LoadRecord):
    inputs: ClassVar[Mapping[str, InputField]] = {"strength": InputField("N s/m", 1)}

    rod: str
    at: float = 1.0
    strength: float
    body: str | None = None


class ShakerRecord(_OneNumber):
    kind: Literal["shaker"]


class RubberRecord(_OneNumber):
    kind: Literal["rubber"]


class Shaker(Load[Any]):
    """All that a kernel may know, coupled, at a section."""

    record = ShakerRecord

    def abscissa(self, load: Any) -> float:
        return float(load.at)

    def on_body(self, load: Any, body: Any) -> BodyPoint | None:
        return BodyPoint() if load.body == body.name else None

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        slow = values["strength"] * (section.velocity + ca.cross(section.angular_velocity, section.position))
        fast = ca.cross(section.rotation[:, 0], section.acceleration) + 0.1 * section.angular_acceleration
        return slow + 0.2 * fast, 0.3 * fast - 0.1 * ca.cross(slow, section.angular_velocity)


class Rubber(Load[Any]):
    """Drag per length that does not depend on the pose: nothing at rest."""

    record = RubberRecord

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        return -values["strength"] * section.velocity, -0.1 * values["strength"] * section.angular_velocity


@pytest.fixture(autouse=True, scope="module")
def kinds() -> Iterator[None]:
    for kind in (Shaker, Rubber):
        register(kind)
    yield
    for kind in (Shaker, Rubber):
        forget(kind)


@cache
def made(family: str, *names: str) -> Model:
    tables = FAMILIES[family]() if family in FAMILIES else massless()
    added = [load for load in (FLOW, SHAKER, RUBBER) if load["name"] in names]
    return build(scene_from_dict({**tables, "loads": [*tables["loads"], *added]}), moving=True)


def massless() -> Tables:
    light = {key: value for key, value in rod(strain="reissner").items() if key not in WITHOUT_MASS}
    return scene(light, loads=[])


@pytest.mark.parametrize("family", mostly_slow([*TRIED, "massless"], quick=["reissner", "all driven"]))
def test_derivatives_vs_automatic_differentiation(family: str) -> None:
    model = made(family, "water", "shaker", "rubber")
    symbols = symbols_of(model)
    derivatives = [ca.jacobian(model.inverse_dynamics(*symbols), symbol) for symbol in symbols[:3]]
    automatic = ca.Function("automatic", symbols, derivatives)
    for seed in (0, 1):
        state = drawn_state(model, seed)
        found = model.dynamics_jacobian(*state.all)
        for ours, exact in zip(found[:3], automatic(*state.all), strict=True):
            size = max(1.0, np.abs(exact.full()).max())
            assert_allclose(ours.full(), exact.full(), rtol=0, atol=2e-12 * size)


@pytest.mark.parametrize("family", TRIED)
def test_at_rest_the_equations_are_those_of_statics(family: str) -> None:
    model = made(family, "water", "rubber")
    x = drawn_state(model).x
    still = np.zeros(model.discrete.layout.size)
    zero = np.zeros(model.size)
    at_rest = model.inverse_dynamics(x, zero, zero, model.pack(), still, still).full()
    assert_allclose(at_rest, model.residual(x, model.pack()).full(), rtol=0, atol=1e-14 * np.abs(at_rest).max())


def test_a_load_of_rates_alone_costs_statics_nothing() -> None:
    with_it, without = made("kirchhoff", "rubber"), made("kirchhoff")
    for name in ("residual", "jacobian", "path_jacobian"):
        assert with_it.operations(getattr(with_it, name)) == without.operations(getattr(without, name))


@pytest.mark.parametrize("family", ["reissner", "free", "carried", "all driven"])
def test_balance_of_energy(family: str) -> None:
    """Rates of the energies are the powers that go in and out, and the work of what the equations lack."""
    model = made(family, "water", "rubber")
    state = drawn_state(model, 3)
    names = [load.name for load in model.scene.loads]
    of_loads = model.powers(*state.all)[1].full().ravel()
    added = model.inverse_dynamics(*state.all) - bare_residual(family, state)
    units = np.asarray(model.discrete.unknowns.units)
    differential = np.asarray(model.discrete.unknowns.differential)
    powers = sum(of_loads[names.index(name)] for name in ("water", "rubber"))
    moved_by_base = base_power(model, family, state)
    work = -(units * added.full().ravel())[differential] @ state.v[differential]
    assert abs(work) > 1e-3
    assert_allclose(powers, work + moved_by_base, rtol=1e-12, atol=1e-12)


def in_bare(family: str, state: State) -> list[np.ndarray]:
    """The state of the scene without the loads of this file, whose inputs stand last."""
    count = made(family).discrete.layout.size
    inputs = (state.inputs, state.inputs_rate, state.inputs_acceleration)
    return [state.x, state.v, state.a, *(entries[:count] for entries in inputs)]


def bare_residual(family: str, state: State) -> ca.DM:
    return made(family).inverse_dynamics(*in_bare(family, state))


def base_power(model: Model, family: str, state: State) -> float:
    """What clamps and lengths that move take from the loads."""
    return float(made(family).powers(*in_bare(family, state))[3] - model.powers(*state.all)[3])


@pytest.mark.parametrize("family", ["kirchhoff", "free"])
def test_added_mass_vs_the_kinetic_energy_of_the_fluid(family: str) -> None:
    """In a fluid at rest, without drag, the force on the coordinates is Lagrange's of ½ Σ m_a |P ṙ|²."""
    tables = FAMILIES[family]()
    still = {**FLOW, "velocity": [0.0, 0.0, 0.0], "normal": 0.0, "tangential": 0.0, "added_mass": 0.8}
    del still["gravity"]
    model = build(scene_from_dict({**tables, "loads": [*tables["loads"], still]}), moving=True)
    symbols = symbols_of(model)
    x, v, a, inputs, *_ = symbols
    position, quaternion, *_ = model.fields["a"](x, inputs)
    rod_of = model.discrete.rods["a"]
    diameter = 0.06 - 0.03 * rod_of.grid.nodes
    masses = 0.8 * 40.0 * np.pi / 4 * diameter**2 * rod_of.node_lengths
    energy = ca.MX(0.0)
    for k, mass in enumerate(masses):
        velocity = ca.jtimes(position[:, k], x, v)
        w, i, j, z = ca.vertsplit(quaternion[:, k])
        tangent = ca.vertcat(2 * (i * z + w * j), 2 * (j * z - w * i), 1 - 2 * (i**2 + j**2))
        across = velocity - ca.dot(tangent, velocity) * tangent
        energy += mass / 2 * ca.sumsqr(across)
    momentum = ca.gradient(energy, v)
    force = ca.jtimes(momentum, ca.vertcat(x, v), ca.vertcat(v, a)) - ca.gradient(energy, x)
    expected = ca.Function("lagrange", symbols, [force])
    state = drawn_state(model, 2)
    added = model.inverse_dynamics(*state.all).full() - bare_residual(family, state).full()
    units = np.asarray(model.discrete.unknowns.units)
    reference = expected(*state.all).full().ravel()
    assert_allclose(units * added.ravel(), reference, rtol=0, atol=1e-12 * np.abs(reference).max())


def test_on_a_body_accelerations_are_not_known() -> None:
    tables = FAMILIES["fixed joint"]()
    shaken = {**SHAKER, "rod": "nothing", "body": "plate"}
    given = scene_from_dict({**tables, "loads": [*tables["loads"], SHAKER]})
    on_body = given.loads[-1].model_copy(update=shaken)
    with pytest.raises(ValueError, match="loads on bodies do not know them"):
        model = build(given.model_copy(update={"loads": (*given.loads[:-1], on_body)}), moving=True)
        model.inverse_dynamics  # noqa: B018
