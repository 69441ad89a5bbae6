"""The model's functions: names, exactness, what a scene pays for, and the budget of its graph."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Discretisation, Model, Scene, SceneError, build, discretise
from cosserat_casadi.maths.rotation import quaternion_from_tangent
from tests.derivatives import central_differences
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.reference.rods import rotation_from_quaternion
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene

LOADS = {
    "weight": WEIGHT,
    "push": push(),
    "push_and_twist": push(moment=[0.1, -0.2, 0.3]),
    "follower": push(frame="body", moment=[0.1, -0.2, 0.3]),
    "hook": HOOK,
    "hook_follower": {**HOOK, "frame": "body", "moment": [0.1, 0.0, -0.1]},
    "wind": WIND,
    "wind_follower": {**WIND, "frame": "body", "moment": [0.1, [0.0, 0.2], 0.0]},
}
STRAINS = ["planar", "kirchhoff", "reissner", ["bending_x", "extension"]]


def coarse(wanted: Scene, transport: str = "magnus6") -> Model:
    return build(wanted, discretise(wanted, 3, 8, transport))


def point(model: Model, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    return 0.4 * np.random.default_rng(seed).normal(size=model.size), model.pack()


def test_functions_name_their_inputs_and_outputs() -> None:
    model = coarse(scene(push(), WEIGHT))
    assert model.residual.name_in() == ["x", "inputs"]
    assert model.jacobian.name_out() == ["jacobian", "residual"]
    assert model.input_jacobian.name_out() == ["input_jacobian"]
    assert model.igm["rod"].name_in() == ["q", "base_position", "base_quaternion", "inputs"]
    assert model.igm["rod"].name_out() == ["generalised_force", "base_force", "base_moment"]
    assert model.tip["rod"].name_out() == ["position", "quaternion", "rotation"]
    assert model.shape["rod"].name_in() == ["x", "inputs", "X"]


def test_inputs_are_what_the_scene_asks_for() -> None:
    model = coarse(scene(push(), WEIGHT, inputs=["push.force"]))
    assert model.inputs.names == ("push.force",)
    assert model.inputs.size == 3
    everything = coarse(scene(push(moment=[0, 0, 0.1]), WEIGHT, WIND))
    assert set(everything.inputs.names) == {"push.force", "push.moment", "weight.acceleration", "wind.force"}
    assert everything.inputs.size == 3 + 3 + 3 + 6


def test_baked_input_vs_free_input() -> None:
    free, baked = coarse(scene(push(), WEIGHT)), coarse(scene(push(), WEIGHT, inputs=[]))
    x, inputs = point(free)
    assert_allclose(baked.residual(x, []).full(), free.residual(x, inputs).full(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("strain", STRAINS, ids=str)
def test_structured_jacobian_vs_automatic_differentiation(strain: str, load: str) -> None:
    model = coarse(scene(LOADS[load], strain=strain))
    x, inputs = point(model)
    symbols = model.residual.mx_in()
    automatic = ca.Function("automatic", symbols, [ca.jacobian(model.residual(*symbols), symbols[0])])
    assert_allclose(model.jacobian(x, inputs)[0].full(), automatic(x, inputs).full(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["pinned", "clamped"])
@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner"])
def test_structured_jacobian_with_supports_vs_automatic_differentiation(strain: str, kind: str) -> None:
    support = {"rod": "rod", "kind": kind, "position": [0.3, 0.0, 0.5]}
    if kind == "clamped":
        support["quaternion"] = [0.8, 0.0, 0.6, 0.0]
    model = coarse(scene(WEIGHT, HOOK, strain=strain, supports=[support]))
    x, inputs = point(model)
    symbols = model.path_jacobian.mx_in()
    derivative = ca.jacobian(model.path_residual(*symbols), symbols[0])
    automatic = ca.Function("automatic", symbols, [derivative])
    for factor in (0.3, 1.0):
        found = model.path_jacobian(x, inputs, factor).full()
        assert_allclose(found, automatic(x, inputs, factor).full(), rtol=0, atol=1e-12)
    assert_allclose(model.jacobian(x, inputs)[0].full(), model.path_jacobian(x, inputs, 1.0).full(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("transport", ["magnus6", "permuted"])
@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner"])
def test_tip_jacobian_vs_automatic_differentiation(strain: str, transport: str) -> None:
    support = {"rod": "rod", "kind": "pinned", "position": [0.3, 0.0, 0.5]}
    given = scene(WEIGHT, strain=strain, supports=[support])
    assert_tip_jacobian_as_automatic(build(given, discretise(given, 3, 8, transport)))


@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner"])
def test_tip_jacobian_of_a_floating_base_vs_automatic_differentiation(strain: str) -> None:
    base = {"position": [0.1, 0.0, -0.2], "tangent": [0.8, 0.0, 0.6], "free": True}
    model = coarse(scene(WEIGHT, rods=[rod(strain, base=base)]))
    assert model.size > sum(rod.size for rod in model.discrete.rods.values())
    assert_tip_jacobian_as_automatic(model)


def assert_tip_jacobian_as_automatic(model: Model) -> None:
    x, inputs = point(model)
    symbols = model.tip["rod"].mx_in()
    pose = ca.vertcat(*model.tip["rod"](*symbols)[:2])
    automatic = ca.Function("automatic", symbols, [ca.jacobian(pose, symbol) for symbol in symbols])
    for found, expected in zip(model.tip_jacobian["rod"](x, inputs), automatic(x, inputs), strict=True):
        assert_allclose(found.full(), expected.full(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("load", LOADS)
def test_path_rate_vs_finite_differences(load: str) -> None:
    model = coarse(scene(LOADS[load], supports=[{"rod": "rod", "kind": "pinned", "position": [0.3, 0.0, 0.5]}]))
    x, inputs = point(model)
    rng = np.random.default_rng(3)
    inputs_rate, factor_rate, step = rng.standard_normal(model.inputs.size), 0.7, 1e-6
    ahead = model.path_residual(x, inputs + step * inputs_rate, 0.4 + step * factor_rate)
    behind = model.path_residual(x, inputs - step * inputs_rate, 0.4 - step * factor_rate)
    found = model.path_rate(x, inputs, 0.4, inputs_rate, factor_rate)
    assert_allclose(found.full(), (ahead - behind).full() / (2 * step), rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("supported", [False, True])
@pytest.mark.parametrize("load", LOADS)
def test_path_tangent_vs_small_factor(load: str, supported: bool) -> None:
    """The unloaded scene is in equilibrium at factor 0, whatever the inputs, and responds linearly."""
    supports = [{"rod": "rod", "kind": "pinned", "position": [0.3, 0.0, 0.5]}] if supported else []
    model = coarse(scene(LOADS[load], supports=supports))
    inputs, factor = point(model)[1], 1e-7
    assert_allclose(model.path_residual(model.unloaded(), inputs, 0.0).full(), 0.0, rtol=0, atol=1e-15)
    tangent = model.path_tangent(inputs).full()[:, 0]
    left = model.path_residual(factor * tangent, inputs, factor).full()
    assert_allclose(left, 0.0, rtol=0, atol=1e-11 * (1 + np.linalg.norm(tangent)))


@pytest.mark.parametrize("load", ["push_and_twist", "follower", "wind_follower", "weight"])
def test_input_jacobian_vs_finite_differences(load: str) -> None:
    model = coarse(scene(LOADS[load]))
    x, inputs = point(model)
    differences = central_differences(lambda given: model.residual(x, given), inputs, 1e-6)
    assert_allclose(model.input_jacobian(x, inputs).full(), differences, rtol=0, atol=1e-9)


@pytest.mark.parametrize("load", ["push", "wind", "hook", "weight"])
@pytest.mark.parametrize("strain", STRAINS, ids=str)
def test_magnus_residual_vs_literal_permuted_residual(strain: str, load: str) -> None:
    """Two routes from rotation to generalised force: exponentials and transpose, or chapter 3 and quadrature."""
    wanted = scene(LOADS[load], strain=strain)
    fast, literal = (build(wanted, discretise(wanted, 3, 36, t)) for t in ("magnus8", "permuted"))
    x, inputs = point(fast)
    assert_allclose(fast.residual(x, inputs).full(), literal.residual(x, inputs).full(), rtol=0, atol=1e-11)


def test_literal_route_solves_to_the_same_rod() -> None:
    wanted = scene(push(), WEIGHT)
    fast, literal = (solve(build(wanted, discretise(wanted, 5, 24, t))) for t in ("magnus8", "permuted"))
    assert literal.converged
    assert_allclose(literal.tip().position, fast.tip().position, rtol=0, atol=1e-10)


def test_igm_of_a_floating_base_vs_the_scene_turned() -> None:
    """Turning base and dead loads together turns the base wrench and leaves the generalised force."""
    model = coarse(scene(push(moment=[0.1, 0.2, -0.1]), WEIGHT))
    x, inputs = point(model)
    quaternion = quaternion_from_tangent([0.3, -0.5, 0.2])
    rotation = rotation_from_quaternion(quaternion)
    turned = (rotation @ inputs.reshape(-1, 3).T).T.ravel()
    igm = model.igm["rod"]
    force, base_force, base_moment = igm(x, [0, 0, 0], [1, 0, 0, 0], inputs)
    other, turned_force, turned_moment = igm(x, [4, 5, 6], quaternion, turned)
    assert_allclose(other.full(), force.full(), rtol=0, atol=1e-13)
    assert_allclose(turned_force.full(), rotation @ base_force.full(), rtol=0, atol=1e-13)
    assert_allclose(turned_moment.full(), rotation @ base_moment.full(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("load", ["push", "hook"])
def test_shape_function_vs_numeric_interpolation_and_nodes(load: str) -> None:
    solution = solve(coarse(scene(LOADS[load])))
    model = solution.model
    nodes = model.discrete.rods["rod"].grid.nodes
    for X in [*nodes[:: len(nodes) // 5], 0.123, 0.4, 0.77, 1.0]:
        position, quaternion = (v.full()[:, 0] for v in model.shape["rod"](solution.x, solution.inputs, X))
        expected = solution.pose(X)
        assert_allclose(position, expected.position, rtol=0, atol=1e-12)
        assert_allclose(quaternion, expected.quaternion, rtol=0, atol=1e-12)
    tip = model.tip["rod"](solution.x, solution.inputs)
    assert_allclose(tip[0].full()[:, 0], solution.tip().position, rtol=0, atol=1e-12)
    assert_allclose(tip[2].full(), solution.tip().rotation, rtol=0, atol=1e-12)


def test_energy_gradient_is_the_elastic_part_of_the_residual() -> None:
    model = coarse(scene(strain="reissner"))
    x, inputs = point(model)
    symbols = model.energy.mx_in()
    gradient = ca.Function("gradient", symbols, [ca.gradient(model.energy(*symbols), symbols[0])])
    unit = model.discrete.rods["rod"].energy_unit
    assert_allclose(gradient(x, inputs).full() / unit, model.residual(x, inputs).full(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("strain", STRAINS, ids=str)
def test_residual_vs_gradient_of_the_potential(strain: str) -> None:
    """With dead forces only the residual is the exact gradient of the discrete energy."""
    model = coarse(scene(push(), WEIGHT, HOOK, WIND, strain=strain))
    x, inputs = point(model)
    assert model.potential is not None
    symbols = model.potential.mx_in()
    gradient = ca.Function("gradient", symbols, [ca.gradient(model.potential(*symbols), symbols[0])])
    unit = model.discrete.rods["rod"].energy_unit
    assert_allclose(gradient(x, inputs).full() / unit, model.residual(x, inputs).full(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("load", ["follower", "push_and_twist", "wind_follower"])
def test_potential_is_none_where_there_is_none(load: str) -> None:
    assert coarse(scene(LOADS[load])).potential is None


def test_work_of_the_push_is_what_the_rod_stores() -> None:
    """d(elastic energy) = F·d(tip) along a path of equilibria: Simpson's rule over the growing force."""
    wanted = scene(push())
    model = build(wanted, discretise(wanted, 6, 16, "magnus8"))
    shares = np.linspace(0, 1, 9)
    force = np.array(push()["force"])
    solutions = [solve(model, {"push.force": share * force}) for share in shares]
    lengths = np.array([force @ s.tip().position for s in solutions])
    stored = np.array([float(model.energy(s.x, s.inputs)) for s in solutions])
    # Complementary work: ∫ u dF = F u − energy, smooth in the share.
    weights = np.array([1, 4, 2, 4, 2, 4, 2, 4, 1]) / 24
    complementary = weights @ (lengths - lengths[0])
    assert_allclose(lengths[-1] - lengths[0] - stored[-1], complementary, rtol=1e-6, atol=0)


@pytest.mark.parametrize("load", mostly_slow(LOADS, quick=["hook_follower"]))
def test_all_derivatives_are_finite_at_the_straight_unloaded_rod(load: str) -> None:
    wanted = scene(LOADS[load], strain="reissner")
    model = build(wanted, discretise(wanted, 2, 5, "magnus6"))
    symbols = model.residual.mx_in()
    jacobian = ca.jacobian(model.residual(*symbols), symbols[0])
    second = ca.Function("second", symbols, [ca.jacobian(ca.vec(jacobian), symbols[0])])
    x, inputs = model.unloaded(), np.zeros(model.inputs.size)
    values = second(x, inputs).full()
    assert np.all(np.isfinite(values))
    step = 1e-5
    direction = np.random.default_rng(0).normal(size=model.size)
    ahead, behind = (model.jacobian(x + s * direction, inputs)[0].full() for s in (step, -step))
    change = (values @ direction).reshape(model.size, model.size, order="F")
    assert_allclose(change, (ahead - behind) / (2 * step), rtol=0, atol=1e-8)


# What a scene pays


def counted(wanted: Scene) -> int:
    model = coarse(wanted)
    return model.operations(model.residual)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff"], quick=["planar"]))
def test_a_load_baked_at_zero_costs_what_no_load_costs(strain: str, load: str) -> None:
    """An effect that is zero for good leaves the same instructions as one that was never named."""
    zero = {k: [0, 0, 0] if k in ("force", "moment", "acceleration") else v for k, v in LOADS[load].items()}
    without = scene(push(), strain=strain)
    named = scene(push(), {**zero, "name": "nothing"}, strain=strain, inputs=["push.force"])
    cut = {"rod": Discretisation((3,) * (1 if strain == "planar" else 3), 8)}
    if "hook" in load:
        cut = {"rod": Discretisation((3,) * (1 if strain == "planar" else 3), 8, (0.0, 0.4, 1.0))}
    one, other = build(without, cut), build(named, cut)
    assert one.operations(one.residual) == other.operations(other.residual)
    assert one.operations(one.jacobian) == other.operations(other.jacobian)


@pytest.mark.parametrize("load", [k for k in LOADS if "hook" not in k])
def test_registry_makes_no_difference(load: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With every other effect struck from the registry the model has the same instructions."""
    from cosserat_casadi.model.registry import EFFECTS

    wanted = scene(LOADS[load])
    full = counted(wanted)
    for kind in [k for k in EFFECTS if k != LOADS[load]["kind"]]:
        monkeypatch.delitem(EFFECTS, kind)
    assert counted(wanted) == full


@pytest.mark.parametrize("load", ["push", "weight", "wind"])
def test_planar_vs_spatial_at_least_four_times_smaller(load: str) -> None:
    planar, spatial = coarse(scene(LOADS[load], strain="planar")), coarse(scene(LOADS[load]))
    assert 4 * planar.operations(planar.residual) <= spatial.operations(spatial.residual)
    assert 4 * planar.operations(planar.jacobian) <= spatial.operations(spatial.jacobian)


def test_dead_force_needs_no_integration_of_the_position() -> None:
    """Cost grows in proportion to the nodes: twice the nodes, at most 2.2 times the operations."""
    wanted = scene(push())
    small, large = (build(wanted, discretise(wanted, 3, n)) for n in (16, 32))
    assert large.operations(large.residual) <= 2.2 * small.operations(small.residual)


def test_graph_budget() -> None:
    """One Kirchhoff rod, 12 unknowns, 12 intervals, tip wrench and gravity."""
    wanted = scene(push(moment=[0.1, 0.2, 0.3]), WEIGHT)
    model = build(wanted, discretise(wanted, 4, 12))
    functions = (model.igm["rod"], model.residual, model.jacobian)
    assert model.size == 12
    igm, residual, jacobian = (model.operations(f) for f in functions)
    assert igm <= 5_500
    assert residual <= 5_500
    assert jacobian <= 34_000


def test_graph_budget_of_a_dead_force() -> None:
    """One Kirchhoff rod, 18 unknowns, 8 intervals, a force on the tip alone: one triangle of the Jacobian is formed."""
    wanted = scene(push())
    model = build(wanted, discretise(wanted, 6, 8))
    assert model.size == 18
    assert model.operations(model.residual) <= 3_900
    assert model.operations(model.jacobian) <= 31_000
    matrix = model.jacobian(0.3 * np.random.default_rng(0).normal(size=18), model.pack())[0].full()
    assert_allclose(matrix, matrix.T, rtol=0, atol=0)


@pytest.mark.parametrize("basis", ["legendre", "chebyshev"])
def test_bases_span_the_same_space(basis: str) -> None:
    reference = solve(coarse(scene(push(), WEIGHT)))
    other = solve(coarse(scene(push(), WEIGHT, rods=[rod(basis=basis)])))
    assert_allclose(other.tip().position, reference.tip().position, rtol=0, atol=1e-12)


def test_base_given_by_tangent_vs_by_quaternion() -> None:
    tangent = [0.3, -0.4, 0.5]
    quaternion = quaternion_from_tangent(tangent).tolist()
    one, other = (
        solve(coarse(scene(push(), rods=[rod(base={"position": [1, 2, 3], **orientation})])))
        for orientation in ({"tangent": tangent}, {"quaternion": quaternion})
    )
    assert_allclose(one.tip().position, other.tip().position, rtol=0, atol=1e-12)
    straight = solve(coarse(scene(rods=[rod(base={"tangent": tangent})])))
    assert_allclose(straight.tip().position, 0.8 * np.array(tangent) / np.linalg.norm(tangent), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"breaks": (0.0, 0.33, 1.0)},
            r"discretisation.rod.breaks: must ascend from 0 to 1, with element ends at 0, 0.5",
        ),
        ({"breaks": (0.0, 0.5, 0.2, 1.0)}, "must ascend from 0 to 1"),
        ({"modes": (3,), "nodes": 0}, r"(?s)modes: must be 3 numbers >= 1.*nodes: must be >= 1 and whole, got 0"),
        ({"modes": (3, 2.5, 3), "nodes": 8.5}, r"(?s)3 numbers >= 1, whole.*nodes: must be >= 1 and whole, got 8.5"),
    ],
)
def test_a_discretisation_of_another_rod_is_refused(changes: dict[str, Any], words: str) -> None:
    inner = {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [1, 0, 0]}
    pushed = scene(inner)
    own = discretise(pushed, 3, 8)["rod"]
    with pytest.raises(SceneError, match=words):
        build(pushed, {"rod": replace(own, **changes)})
    with pytest.raises(SceneError, match=r"(?s)discretisation.other: is no rod.*discretisation.rod: missing"):
        build(pushed, {"other": own})
