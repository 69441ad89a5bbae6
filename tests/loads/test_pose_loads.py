"""Loads that depend on the pose of what they act on: written in one file, exact in every kind of scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import fsolve

from cosserat_casadi import Model, build, discretise
from cosserat_casadi.loads.load import Load
from cosserat_casadi.model.registry import EFFECTS, register
from cosserat_casadi.scene.records import Record
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.loads.kinds import (
    BedRecord,
    DipoleRecord,
    ElasticSpringRecord,
    FlagRecord,
    SpringRecord,
    TorqueRecord,
    WhirlRecord,
    registered,
    with_loads,
)
from tests.reference.planar import elastica_end
from tests.scenes import push, rod

BASE = {"position": [0.1, -0.2, 0.3], "quaternion": [0.5, 0.5, -0.5, 0.5]}
STIFFNESS = {"bending_x": 1.0, "bending_y": 1.4, "torsion": 0.7, "shear_x": 40.0, "shear_y": 60.0, "extension": 90.0}
FEW = {"modes": 2, "nodes": 5}
CURVED = {"curvature": [[0.4, -0.3], 0.5, [-0.2, 0.1]], "tangent": [0.02, 0, 1.05]}


@pytest.fixture(autouse=True, scope="module")
def kinds() -> Iterator[None]:
    with registered():
        yield


def tables(**changes: Any) -> dict[str, Any]:
    return {"schema": 1, "accuracy": FEW, **changes}


def named(name: str, length: float, **changes: Any) -> dict[str, Any]:
    plain = {"name": name, "length": length, "strain": "kirchhoff", "stiffness": STIFFNESS, "linear_density": 0.7}
    return {**plain, **changes}


CLAMPED = tables(rods=[rod("reissner", base=BASE, intrinsic=CURVED)], loads=[push(moment=[0.1, 0.2, 0.1])])
SCENES: dict[str, dict[str, Any]] = {
    "planar": tables(rods=[rod("planar")]),
    "kirchhoff": tables(rods=[rod(base=BASE)], loads=[push(frame="body", moment=[0.1, -0.2, 0.3])]),
    "reissner": CLAMPED,
    "odd strains": tables(rods=[rod(["bending_y", "shear_x", "extension"], intrinsic=CURVED)]),
    "stretched": tables(rods=[rod(["extension"])]),
    "held": tables(
        rods=[rod("reissner", base=BASE)],
        supports=[{"rod": "rod", "kind": "pinned", "position": [0.5, 0.1, 0.2]}],
    ),
    "carried": tables(
        rods=[
            named("below", 0.6, strain="reissner", base=BASE),
            named("rod", 0.8, strain="reissner", base={"rod": "below", "at": 0.5, "quaternion": [0.6, 0, 0.8, 0]}),
        ],
        loads=[push(moment=[0.1, 0.2, 0.3]), push(name="jet", frame="body")],
    ),
    "platform": tables(
        rods=[named("rod", 0.8, base={"position": [0, 0, 0.1]}), named("other", 0.7, base={"position": [0.3, 0, 0]})],
        bodies=[{"name": "plate", "mass": 0.2, "centre_of_mass": [0.1, 0.02, 0.03]}],
        joints=[
            {"body": "plate", "rod": "rod", "kind": "fixed", "position": [0.02, -0.03, 0.01]},
            {"body": "plate", "rod": "other", "kind": "spherical", "position": [0.3, 0, 0]},
        ],
    ),
}
SPRING: dict[str, Any] = {"name": "load", "stiffness": 3.0, "anchor": (0.4, 0.2, 0.9)}
DIPOLE: dict[str, Any] = {"name": "load", "dipole": (0.3, 0.5, -0.8), "field": (0.4, 1.0, -0.6)}
LOADS: dict[str, Record] = {
    "spring": SpringRecord(kind="spring", rod="rod", **SPRING),
    "elastic spring": ElasticSpringRecord(kind="elastic_spring", rod="rod", **SPRING),
    "dipole": DipoleRecord(kind="dipole", rod="rod", gradient=0.7, **DIPOLE),
    "torque": TorqueRecord(kind="torque", rod="rod", **DIPOLE),
    "bed": BedRecord(name="load", kind="bed", rod="rod", strength=2.0),
    "whirl": WhirlRecord(name="load", kind="whirl", rod="rod", strength=2.0),
    "whirl in the sections": WhirlRecord(name="load", kind="whirl", rod="rod", strength=2.0, frame="body"),
}
INNER: dict[str, Record] = {
    "inner spring": SpringRecord(kind="spring", rod="rod", at=0.4, **SPRING),
    "inner dipole": DipoleRecord(kind="dipole", rod="rod", at=0.4, gradient=0.7, **DIPOLE),
}
ON_PLATE: dict[str, Any] = {"body": "plate", "position": (0.05, 0.1, 0.02)}
ON_BODY: dict[str, Record] = {
    "spring": SpringRecord(kind="spring", **ON_PLATE, **SPRING),
    "elastic spring": ElasticSpringRecord(kind="elastic_spring", **ON_PLATE, **SPRING),
    "dipole": DipoleRecord(kind="dipole", gradient=0.7, **ON_PLATE, **DIPOLE),
}


@cache
def made(scene: str, load: str, on_body: bool = False) -> Model:
    record = (ON_BODY if on_body else {**LOADS, **INNER})[load]
    return build(with_loads(SCENES[scene], record))


def anywhere(model: Model, seed: int = 0, size: float = 0.3) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(model.size)


CASES = [(scene, load) for scene in SCENES for load in LOADS] + [("carried", load) for load in INNER]
BODY_CASES = list(ON_BODY)
DEAR = ("carried", "platform")
QUICK = [case for case in CASES if case[0] not in DEAR or case[1] in ("bed", "dipole", "inner spring")]


def assert_jacobian_is_exact(model: Model) -> None:
    x, inputs, factor = ca.MX.sym("x", model.size), ca.MX.sym("u", model.inputs.size), ca.MX.sym("factor")
    automatic = ca.Function("j", [x, inputs, factor], [ca.jacobian(model.path_residual(x, inputs, factor), x)])
    for seed, size in ((0, 0.3), (1, 1.0), (2, 0.0)):
        point = anywhere(model, seed, size)
        expected = automatic(point, model.pack(), 1.0).full()
        bound = 1e-12 * max(1.0, np.abs(expected).max())
        assert_allclose(model.jacobian(point, model.pack())[0].full(), expected, rtol=0, atol=bound)
        on_the_way = model.path_jacobian(point, model.pack(), 0.6).full()
        assert_allclose(on_the_way, automatic(point, model.pack(), 0.6).full(), rtol=0, atol=bound)


@pytest.mark.parametrize(("scene", "load"), mostly_slow(CASES, quick=QUICK[::5]))
def test_jacobian_vs_automatic_differentiation(scene: str, load: str) -> None:
    assert_jacobian_is_exact(made(scene, load))


@pytest.mark.parametrize("load", BODY_CASES)
def test_jacobian_on_a_body_vs_automatic_differentiation(load: str) -> None:
    assert_jacobian_is_exact(made("platform", load, on_body=True))


# The residual


def energy_of(record: Any, position: ca.MX, rotation: ca.MX) -> ca.MX:
    """Energies of the point loads, written again."""
    if record.kind in ("spring", "elastic_spring"):
        return record.stiffness / 2 * ca.sumsqr(position - ca.DM(record.anchor))
    field = ca.DM(record.field) + record.gradient * ca.DM([0, 0, 1]) * position[2]
    return -ca.dot(rotation @ ca.DM(record.dipole), field)


def units(model: Model) -> np.ndarray:
    """Energy unit of every unknown that moves something; NaN for multipliers."""
    unknowns = model.discrete.unknowns
    return np.where(unknowns.differential, unknowns.units, np.nan)


def assert_residual_is_gradient(with_load: Model, energy: Callable[[ca.MX], ca.MX], x: np.ndarray) -> None:
    """What the load adds to the residual against the gradient of its energy, as a function of all unknowns."""
    scene = with_load.scene
    loads = tuple(load for load in scene.loads if load.name != "load")
    without = build(scene.model_copy(update={"loads": loads}), with_load.discretisation)
    symbol = ca.MX.sym("x", with_load.size)
    gradient = ca.Function("g", [symbol], [ca.gradient(energy(symbol), symbol)])(x).full()[:, 0]
    added = with_load.residual(x, with_load.pack()).full()[:, 0] - without.residual(x, without.pack()).full()[:, 0]
    unit = units(with_load)
    moving = np.isfinite(unit)
    scale = max(1.0, np.abs(gradient[moving] / unit[moving]).max())
    assert_allclose(added[moving], gradient[moving] / unit[moving], rtol=0, atol=1e-12 * scale)
    assert_allclose(added[~moving], 0.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("load", ["spring", "elastic spring", "dipole"])
def test_residual_vs_gradient_of_the_energy_at_the_tip(scene: str, load: str) -> None:
    model = made(scene, load)

    def energy(x: ca.MX) -> ca.MX:
        position, _, rotation = model.tip["rod"](x, model.pack())
        return energy_of(LOADS[load], position, rotation)

    assert_residual_is_gradient(model, energy, anywhere(model))


@pytest.mark.parametrize("load", ON_BODY)
def test_residual_vs_gradient_of_the_energy_on_a_body(load: str) -> None:
    model, record = made("platform", load, on_body=True), ON_BODY[load]

    def energy(x: ca.MX) -> ca.MX:
        position, _, rotation = model.body["plate"](x, model.pack())
        return energy_of(record, position + rotation @ ca.DM(record.position), rotation)

    assert_residual_is_gradient(model, energy, anywhere(model))


@pytest.mark.parametrize("scene", SCENES)
def test_residual_vs_gradient_of_the_energy_of_a_foundation(scene: str) -> None:
    """The energy summed over the nodes, from the poses that the model shows and those of the unloaded scene."""
    model = made(scene, "bed")
    discrete_rod = model.discrete.rods["rod"]
    weights = discrete_rod.properties.length * discrete_rod.grid.weights
    position, quaternion, *_ = model.fields["rod"](np.zeros(model.size), model.pack())

    def energy(x: ca.MX) -> ca.MX:
        moved, turned, *_ = model.fields["rod"](x, model.pack())
        total = ca.MX(0.0)
        for k, weight in enumerate(weights):
            # tr(R₀ᵀ R) = 4 (Q₀·Q)² − 1 for unit quaternions.
            trace = 4 * ca.dot(quaternion[:, k], turned[:, k]) ** 2 - 1
            apart = ca.sumsqr(moved[:, k] - position[:, k]) / 2
            total += weight * 2.0 * (apart + 0.1 * (3 - trace))
        return total

    assert_residual_is_gradient(model, energy, anywhere(model))


@pytest.mark.parametrize("load", ["elastic spring", "dipole", "bed"])
@pytest.mark.parametrize("scene", ["planar", "odd strains"])
def test_potential_vs_residual(scene: str, load: str) -> None:
    """Where an energy can be written the residual is its gradient and the Jacobian its Hessian, symmetric."""
    model = made(scene, load)
    assert model.potential is not None
    x, inputs = model.potential.mx_in()
    unit = model.discrete.rods["rod"].energy_unit
    gradient = ca.Function("g", [x, inputs], [ca.gradient(model.potential(x, inputs), x) / unit])
    point = anywhere(model)
    residual = model.residual(point, model.pack()).full()
    assert_allclose(residual, gradient(point, model.pack()).full(), rtol=1e-12, atol=1e-12)
    matrix = model.jacobian(point, model.pack())[0].full()
    assert_allclose(matrix, matrix.T, rtol=0, atol=1e-12 * np.abs(matrix).max())


@pytest.mark.parametrize("scene", mostly_slow(["reissner", "carried"], quick=["reissner"]))
@pytest.mark.parametrize("load", LOADS)
def test_second_derivatives_are_finite_at_zero_strain(scene: str, load: str) -> None:
    model = made(scene, load)
    x, inputs = model.residual.mx_in()
    second = ca.Function("s", [x, inputs], [ca.jacobian(model.jacobian(x, inputs)[0], x)])
    assert np.all(np.isfinite(second(np.zeros(model.size), model.pack()).full()))


@pytest.mark.parametrize("load", mostly_slow(LOADS, quick=["spring", "dipole", "bed"]))
def test_rod_of_free_length_and_base(load: str) -> None:
    """Equations of a rod drawn out by its inputs against those of a scene that is written with that length and base."""
    inputs = ("rod.length", "rod.base.position", "rod.base.quaternion")
    position, quaternion = [0.3, 0.1, -0.2], [0.6, 0.0, 0.8, 0.0]
    values = {"rod.length": 1.1, "rod.base.position": position, "rod.base.quaternion": quaternion}
    plain = tables(rods=[rod("reissner", base=BASE)])
    free = build(with_loads(plain, LOADS[load], inputs=inputs))
    drawn = tables(rods=[rod("reissner", length=1.1, base={"position": position, "quaternion": quaternion})])
    fixed = build(with_loads(drawn, LOADS[load], inputs=()))
    u = free.pack(values)
    x, symbols = free.residual.mx_in()
    automatic = ca.Function("j", [x, symbols], [ca.jacobian(free.residual(x, symbols), x)])
    point = anywhere(free)
    matrix = free.jacobian(point, u)[0].full()
    assert_allclose(matrix, automatic(point, u).full(), rtol=0, atol=1e-12 * np.abs(matrix).max())
    if load == "bed":
        # It draws to where the rod of its own scene was: another place here.
        return
    solution, expected = solve(free, values), solve(fixed)
    assert solution.converged and expected.converged
    assert_allclose(solution.tip().position, expected.tip().position, rtol=0, atol=1e-10)


# Equilibria


def test_bar_on_a_spring_vs_closed_form() -> None:
    """Along the axis: EA u / L = k (a − L − u)."""
    length, stiffness, anchor, axial = 0.8, 30.0, 1.0, STIFFNESS["extension"]
    record = SpringRecord(name="load", kind="spring", rod="rod", stiffness=stiffness, anchor=(0.0, 0.0, anchor))
    solution = solve(build(with_loads(tables(rods=[rod(["extension"])]), record)))
    stretch = stiffness * (anchor - length) / (axial / length + stiffness)
    assert solution.converged
    assert_allclose(solution.tip().position, [0.0, 0.0, length + stretch], rtol=0, atol=1e-13)


def test_planar_rod_on_a_spring_vs_shooting() -> None:
    """The tip's force is k (a − r): three unknowns at the base."""
    length, bending, stiffness, anchor = 0.8, STIFFNESS["bending_y"], 8.0, np.array([0.7, 0.1])

    def tip(unknown: np.ndarray) -> tuple[np.ndarray, float]:
        upright = [0.0, 0.0, np.pi / 2, -unknown[2] / bending]
        state = elastica_end(length, upright, unknown[:2], bending)
        return state[:2], state[3]

    def misfit(unknown: np.ndarray) -> np.ndarray:
        position, curvature = tip(unknown)
        return np.array([*(unknown[:2] - stiffness * (anchor - position)), curvature])

    unknown = fsolve(misfit, np.array([1.0, -1.0, 1.0]), xtol=1e-13)
    assert_allclose(misfit(unknown), 0.0, rtol=0, atol=1e-10)
    record = ElasticSpringRecord(
        name="load", kind="elastic_spring", rod="rod", stiffness=stiffness, anchor=(anchor[0], 0.0, anchor[1])
    )
    scene = with_loads({"schema": 1, "rods": [rod("planar")]}, record)
    solution = solve(build(scene, discretise(scene, 12, 28)))
    assert solution.converged
    assert solution.stable
    found = solution.tip().position
    assert_allclose(found[[0, 2]], tip(unknown)[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("scene", mostly_slow(["carried", "platform"], quick=["carried"]))
@pytest.mark.parametrize("load", mostly_slow(["spring", "dipole", "bed"], quick=["bed"]))
def test_assemblies_are_solved(scene: str, load: str) -> None:
    solution = solve(made(scene, load))
    assert solution.converged
    # The carried rod has a follower, and the spring given as a wrench has no energy.
    assert (solution.stable is None) is (scene == "carried" or load == "spring")


# What follows from the structure


def test_wrench_that_leaves_the_pose_alone_costs_what_a_dead_load_costs() -> None:
    flag = FlagRecord(name="wind", kind="flag", rod="rod", strength=1.0)
    wind = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [1.0, 0.0, 0.0]}
    own = build(with_loads(tables(rods=[rod()]), flag, inputs=()))
    shipped = build(with_loads(tables(rods=[rod()], loads=[wind]), inputs=()))
    for one, other in ((own.residual, shipped.residual), (own.jacobian, shipped.jacobian)):
        assert own.operations(one) == shipped.operations(other)


@pytest.mark.parametrize(
    ("load", "strain", "expected"),
    [
        ("spring", "kirchhoff", False),
        ("elastic spring", "kirchhoff", True),
        ("dipole", "kirchhoff", True),
        ("torque", "kirchhoff", False),
        ("torque", "planar", False),
        ("bed", "reissner", True),
        ("whirl", "reissner", False),
        ("whirl in the sections", "reissner", False),
    ],
)
def test_potential_follows_from_the_kernel(load: str, strain: str, expected: bool) -> None:
    model = build(with_loads(tables(rods=[rod(strain)]), LOADS[load]))
    assert model.has_potential(model.pack()) is expected
    if not expected:
        assert model.potential is None
        assert model.has_potential(np.zeros(model.inputs.size))


def test_same_word_twice_is_refused() -> None:
    class Another(Load[SpringRecord]):
        record = SpringRecord

    kept = EFFECTS["spring"]
    with pytest.raises(ValueError, match="'spring' is the word of Spring already"):
        register(Another)
    assert EFFECTS["spring"] is kept


def test_load_without_wrench_and_energy_says_so() -> None:
    class Empty(Load[SpringRecord]):
        pass

    with pytest.raises(NotImplementedError, match="Empty gives neither a wrench nor an energy"):
        Empty().wrench(None, None, {})  # type: ignore[arg-type]


def test_first_tangent_of_the_load_path_is_exact_at_the_inputs_of_the_scene() -> None:
    """The wrench of a spring is bilinear in stiffness and anchor: no linear map of the inputs by probes."""
    model = made("kirchhoff", "spring")
    none, inputs = np.zeros(model.size), model.pack()
    rate = model.path_rate(none, inputs, 0.0, np.zeros(model.inputs.size), 1.0).full()
    expected = -np.linalg.solve(model.path_jacobian(none, inputs, 0.0).full(), rate)
    assert np.abs(expected).max() > 0.1
    assert_allclose(model.path_tangent(inputs).full(), expected, rtol=0, atol=1e-12)
