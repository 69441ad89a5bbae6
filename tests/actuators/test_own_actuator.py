"""Actuators that do not ship: a density of the strains, and everything follows from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Scene, build, scene_from_dict, solve
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.registry import register
from cosserat_casadi.rod.strain_density import StrainDensity
from cosserat_casadi.scene.actuator_records import ActuatorRecord
from cosserat_casadi.scene.input_fields import InputField
from tests.families import mostly_slow
from tests.registration import forget
from tests.scenes import STIFFNESS, push

LENGTH = 0.8
TENDON: dict[str, Any] = {
    "name": "cable",
    "kind": "tendon",
    "rod": "rod",
    "tension": 0.7,
    "offset": [[0.03, 0.02], [0.01, -0.04]],
    "span": [0.0, 0.6],
}


class _CordKeys(ActuatorRecord):
    """A cord under tension, or a soft part whose volume depends on the strains."""

    inputs: ClassVar[Mapping[str, InputField]] = {"pull": InputField("N", 1)}

    rod: str
    pull: float
    offset: tuple[Any, Any] = (0.0, 0.0)
    span: tuple[float, float] = (0.0, 1.0)


class CordRecord(_CordKeys):
    kind: Literal["cord"]


class SwellingRecord(_CordKeys):
    kind: Literal["swelling"]


class _Pulled(Actuator[Any]):
    effort = "pull"
    conjugate = "reach"
    conjugate_unit = "m"
    energy_sign = 1.0

    def density(self, strain: Matrix, data: Matrix) -> Matrix:
        raise NotImplementedError

    def quantity(self, actuator: Any, grid: Grid) -> StrainDensity:
        course = routing(actuator, grid)
        data = np.vstack([course.offset, course.slope / LENGTH])
        return StrainDensity(self.density, course.nodes, data)


class Cord(_Pulled):
    """A tendon written as the length of its tangent."""

    record = CordRecord

    def density(self, strain: Matrix, data: Matrix) -> Matrix:
        offset = ca.vertcat(data[:2], 0)
        tangent = strain[3:] + ca.cross(strain[:3], offset) + ca.vertcat(data[2:], 0)
        return ca.sqrt(ca.sumsqr(tangent))


class Swelling(_Pulled):
    """A quantity of curvature, torsion and stretch together that no cable has."""

    record = SwellingRecord

    def density(self, strain: Matrix, data: Matrix) -> Matrix:
        bending = strain[0] ** 2 + strain[1] ** 2
        return strain[5] * ca.exp(-0.1 * bending) + ca.sin(strain[2]) * strain[3]


@pytest.fixture(autouse=True, scope="module")
def kinds() -> Iterator[None]:
    for kind in (Cord, Swelling):
        register(kind)
    yield
    for kind in (Cord, Swelling):
        forget(kind)


def scene(strain: str | list[str], *actuators: ActuatorRecord, **changes: Any) -> Scene:
    names = {"planar": ["bending_y"], "kirchhoff": ["bending_x", "bending_y", "torsion"], "reissner": list(STIFFNESS)}
    admitted = names[strain] if isinstance(strain, str) else strain
    rod = {"name": "rod", "length": LENGTH, "strain": strain, "stiffness": {n: STIFFNESS[n] for n in admitted}}
    curved = {"curvature": [0.3, [-0.2, 0.1], 0.2], "tangent": [0.02, 0.01, 1.03]} if strain != "planar" else {}
    tables = {"schema": 1, "accuracy": {"modes": 3, "nodes": 8}, "rods": [{**rod, "intrinsic": curved}]}
    plain = scene_from_dict({**tables, "loads": [push()], **changes})
    return plain.model_copy(update={"actuators": (*plain.actuators, *actuators)})


def point(model: Model) -> np.ndarray:
    return 0.3 * np.random.default_rng(0).standard_normal(model.size)


STRAINS = ["planar", "kirchhoff", "reissner", ["bending_y", "shear_x", "extension"]]


@pytest.mark.parametrize("strain", mostly_slow(STRAINS, quick=["planar", "kirchhoff"]))
def test_cord_as_density_vs_tendon(strain: str | list[str]) -> None:
    """The derivatives by CasADi against those that rod/cable.py writes out."""
    cord = CordRecord(
        name="cord", kind="cord", rod="rod", pull=0.7, offset=((0.03, 0.02), (0.01, -0.04)), span=(0.0, 0.6)
    )
    own, shipped = build(scene(strain, cord)), build(scene(strain, actuators=[TENDON]))
    x = point(own)
    assert_allclose(own.residual(x, own.pack()).full(), shipped.residual(x, shipped.pack()).full(), rtol=0, atol=1e-13)
    expected = shipped.jacobian(x, shipped.pack())[0].full()
    assert_allclose(own.jacobian(x, own.pack())[0].full(), expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    outputs = own.actuator["cord"](x, own.pack()), shipped.actuator["cable"](x, shipped.pack())
    for value, other in zip(*outputs, strict=True):
        assert_allclose(value.full(), other.full(), rtol=0, atol=1e-14)
    assert own.operations(own.jacobian) <= 1.05 * shipped.operations(shipped.jacobian)


@pytest.mark.parametrize("strain", STRAINS)
def test_muscle_vs_automatic_differentiation(strain: str | list[str]) -> None:
    muscle = SwellingRecord(name="muscle", kind="swelling", rod="rod", pull=0.7, span=(0.2, 0.6))
    model = build(scene(strain, muscle))
    assert model.potential is not None
    x, inputs = ca.MX.sym("x", model.size), ca.MX.sym("u", model.inputs.size)
    residual = model.residual(x, inputs)
    unit = model.discrete.rods["rod"].energy_unit
    outputs = [ca.gradient(model.potential(x, inputs), x) / unit, ca.jacobian(residual, x)]
    automatic = ca.Function("a", [x, inputs], outputs)
    gradient, jacobian = (value.full() for value in automatic(point(model), model.pack()))
    found = model.jacobian(point(model), model.pack())
    assert_allclose(found[1].full(), gradient, rtol=0, atol=1e-13)
    assert_allclose(found[0].full(), jacobian, rtol=0, atol=1e-12 * np.abs(jacobian).max())
    pull, reach, rate = model.actuator["muscle"](point(model), model.pack())
    assert model.actuator["muscle"].name_out() == ["pull", "reach", "d_reach_d_x"]
    assert float(pull) == 0.7
    changed = ca.Function("r", [x, inputs], [ca.jacobian(model.actuator["muscle"](x, inputs)[1], x)])
    assert_allclose(rate.full(), changed(point(model), model.pack()).full(), rtol=0, atol=1e-14)
    assert float(reach) > 0.0


def test_effort_is_an_input_and_the_rod_is_solved() -> None:
    muscle = SwellingRecord(name="muscle", kind="swelling", rod="rod", pull=0.7)
    model = build(scene("reissner", muscle))
    assert "muscle.pull" in model.inputs.names
    solution = solve(model, {"muscle.pull": 1.2})
    assert solution.converged
    assert solution.stable
    without = solve(model, {"muscle.pull": 0.0})
    assert np.abs(solution.tip().position - without.tip().position).max() > 1e-3


@pytest.mark.parametrize("kind", [CordRecord, SwellingRecord])
def test_a_density_on_moved_elements_vs_a_scene_of_its_own(kind: type[_CordKeys]) -> None:
    """Strains are counted per nominal length of their element: residual and Jacobian of the other scene follow."""
    record = kind(
        name="own", kind=kind.__name__[:-6].lower(), rod="rod", pull=0.7, offset=(0.03, 0.01), span=(0.2, 0.6)
    )
    nominal = build(scene("reissner", record).model_copy(update={"parameters": ("own.span",)}))
    moved = nominal.at({"own.span": [0.35, 0.5]})
    rebuilt = build(moved.scene)
    rod = moved.discrete.rods["rod"]
    widths = known(rod.grid.rates)
    element = [np.repeat(np.arange(3), rod.size_of(c) // 3) for c in rod.columns]
    rate = widths[np.concatenate(element)]
    x = point(moved)
    for found, wanted, factor in (
        (moved.residual(x, moved.pack()), rebuilt.residual(x / rate, moved.pack()), rate[:, None]),
        (moved.jacobian(x, moved.pack())[0], rebuilt.jacobian(x / rate, moved.pack())[0], np.outer(rate, rate)),
        (moved.actuator["own"](x, moved.pack())[1], rebuilt.actuator["own"](x / rate, moved.pack())[1], 1.0),
    ):
        expected = wanted.full() / factor
        assert_allclose(found.full(), expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())
