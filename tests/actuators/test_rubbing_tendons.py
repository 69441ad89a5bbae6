"""Tendons that rub on their course: the capstan's law, exact derivatives, cycles of pulls, refusals."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, scene_from_dict
from cosserat_casadi.accuracy.ranges import Origin, input_ranges
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.moving_scenes import DAMPING, drawn_state, symbols_of
from tests.scenes import HOOK, STIFFNESS, push, rod, scene

FEW = {"modes": 3, "nodes": 8}
FINE = {"modes": 8, "nodes": 20}


def tendon(**changes: Any) -> dict[str, Any]:
    plain = {"name": "cable", "kind": "tendon", "rod": "rod", "offset": [0.02, 0.0], "friction": 0.3}
    return {**plain, **({} if "length" in changes else {"tension": 8.0}), **changes}


def with_tendon(*loads: dict[str, Any], strain: str = "kirchhoff", accuracy: Any = FEW, **changes: Any) -> Any:
    inputs = changes.pop("inputs", None)
    more = {} if inputs is None else {"inputs": inputs}
    return scene(*loads, strain=strain, accuracy=accuracy, actuators=[tendon(**changes)], **more)


@pytest.mark.parametrize(("pull", "sign"), [("in", 1.0), ("out", -1.0)])
def test_a_straight_course_on_a_rod_bent_by_it(pull: str, sign: float) -> None:
    """EI κ = d T and T' = ∓μ κ T: T = T₀/(1 ± μ d T₀ s/EI), and the rod has turned by ln(1 ± μ d T₀ ℓ/EI)/(±μ)."""
    bending, offset, length, friction, tension = STIFFNESS["bending_y"], 0.02, 0.8, 0.3, 8.0
    found = solve(build(with_tendon(strain="planar", accuracy=FINE, pull=pull)))
    assert found.converged
    assert found.stable is None
    share = sign * friction * offset * tension * length / bending
    turned = np.log(1 + share) / (sign * friction)
    tangent = found.tip().rotation[:, 2]
    assert_allclose(np.arctan2(tangent[0], tangent[2]), -turned * np.sign(-tangent[0]), rtol=1e-9, atol=0)


@pytest.mark.parametrize("turns", [0.5, 2.0])
def test_capstan_on_a_circle(turns: float) -> None:
    """On a rod that is a circle by itself and does not give way the tension falls to exp(−μ φ), φ its angle."""
    curvature = 2 * np.pi * turns / 0.8
    stiff = {name: 1e6 * value for name, value in STIFFNESS.items()}
    coil = rod(
        "planar",
        stiffness={"bending_y": stiff["bending_y"]},
        intrinsic={"curvature": [0.0, curvature, 0.0]},
    )
    tables = {"schema": 1, "accuracy": FINE, "rods": [coil], "actuators": [tendon(friction=0.2, tension=1.0)]}
    model = build(scene_from_dict(tables))
    rod_of = model.discrete.rods["rod"]
    x = np.zeros(model.size)
    force = rod_of.energy_unit * model.residual(x, model.pack()).full()[:, 0]
    decay = np.exp(-0.2 * 2 * np.pi * turns * rod_of.grid.nodes)
    lengths = rod_of.node_lengths
    # The moment of the cable is −T D_x about y.
    expected = -(rod_of.at_nodes[1].T @ (lengths * decay * 0.02))
    assert_allclose(force, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_capstan_of_a_helix_on_a_straight_rod() -> None:
    """A helix of radius r turns by 2πn r ω/√(1 + r² ω²) … of its length: curvature times length."""
    radius, turns, length = 0.02, 1.5, 0.8
    course = {"helix": {"radius": radius, "turns": turns}, "offset": None}
    table = {key: value for key, value in tendon(friction=0.4, **course).items() if value is not None}
    model = build(scene(strain="reissner", accuracy=FINE, actuators=[table]))
    rate = 2 * np.pi * turns / length
    slope = np.sqrt(1 + (radius * rate) ** 2)
    angle = radius * rate**2 / slope**2 * slope * length
    discrete = model.discrete.rods["rod"]
    force = discrete.energy_unit * model.residual(np.zeros(model.size), model.pack()).full()[:, 0]
    extension = force[discrete.columns[5]]
    decay = np.exp(-0.4 * angle * discrete.grid.nodes)
    expected = discrete.at_nodes[5].T @ (discrete.node_lengths * 8.0 * decay / slope)
    assert_allclose(extension, expected, rtol=0, atol=1e-12)


HELIX = {"helix": {"radius": 0.03, "turns": 0.8, "phase": 0.3}, "offset": None}
SKEW = {"offset": [[0.03, -0.02], [0.01, 0.01]]}
COURSES: dict[str, dict[str, Any]] = {
    "parallel": {},
    "converging": SKEW,
    "helical": HELIX,
    "part": {**SKEW, "span": [0.1, 0.7]},
    "let out": {**SKEW, "pull": "out"},
    "of length": {**SKEW, "length": 0.79},
    "elastic": {**SKEW, "length": 0.79, "axial_stiffness": 900.0, "winch_stiffness": 2e3, "pretension": 1.5},
    "elastic, slack": {**HELIX, "length": 0.79, "axial_stiffness": 900.0, "slack": True},
    "elastic without friction": {**SKEW, "length": 0.79, "axial_stiffness": 900.0, "friction": 0.0},
    "soft winch": {"length": 0.79, "winch_stiffness": 2e3, "friction": 0.0},
}


def model_of(name: str, strain: str, **changes: Any) -> Model:
    table = {key: value for key, value in tendon(**COURSES[name]).items() if value is not None}
    return build(scene(push(), HOOK, strain=strain, accuracy={"modes": 2, "nodes": 5}, actuators=[table], **changes))


@pytest.mark.parametrize("strain", mostly_slow(["planar", "reissner"], quick=["reissner"]))
@pytest.mark.parametrize("name", mostly_slow(COURSES, quick=["part", "elastic, slack", "soft winch"]))
def test_jacobian_vs_automatic_differentiation(name: str, strain: str) -> None:
    model = model_of(name, strain)
    x, inputs, factor = ca.MX.sym("x", model.size), ca.MX.sym("u", model.inputs.size), ca.MX.sym("factor")
    automatic = ca.Function("j", [x, inputs, factor], [ca.jacobian(model.path_residual(x, inputs, factor), x)])
    for seed, size in ((0, 0.3), (1, 1.0), (2, 0.0)):
        point = size * np.random.default_rng(seed).standard_normal(model.size)
        expected = automatic(point, model.pack(), 1.0).full()
        bound = 1e-12 * max(1.0, np.abs(expected).max())
        assert np.all(np.isfinite(expected))
        assert_allclose(model.jacobian(point, model.pack())[0].full(), expected, rtol=0, atol=bound)
        on_the_way = automatic(point, model.pack(), 0.6).full()
        assert_allclose(model.path_jacobian(point, model.pack(), 0.6).full(), on_the_way, rtol=0, atol=bound)


def test_second_derivatives_are_finite_at_zero_strain() -> None:
    for name in ("parallel", "helical", "elastic, slack"):
        model = model_of(name, "reissner")
        x, inputs = model.residual.mx_in()
        second = ca.Function("s", [x, inputs], [ca.jacobian(model.jacobian(x, inputs)[0], x)])
        assert np.all(np.isfinite(second(np.zeros(model.size), model.pack()).full()))


def test_direction_of_the_last_pull_is_an_input() -> None:
    free = build(with_tendon(inputs=["cable.tension", "cable.pull"]))
    let_out = build(with_tendon(pull="out"))
    without = build(with_tendon(friction=0.0))
    x = 0.5 * np.random.default_rng(0).standard_normal(free.size)
    assert free.inputs.names == ("cable.tension", "cable.pull")
    assert let_out.inputs.names == ("cable.tension",)
    found = free.residual(x, [8.0, -1.0]).full()
    assert_allclose(found, let_out.residual(x, [8.0]).full(), rtol=1e-14, atol=1e-14)
    assert_allclose(free.residual(x, [8.0, 0.0]).full(), without.residual(x, [8.0]).full(), rtol=1e-13, atol=1e-13)
    assert [free.has_potential(np.array(u)) for u in ([8.0, 1.0], [8.0, 0.0], [0.0, 1.0])] == [False, True, True]
    assert free.potential is None


def test_the_direction_of_the_last_pull_stays_within_in_and_out() -> None:
    free = ["cable.tension", "cable.pull"]
    told = dict(input_ranges(with_tendon(inputs=free)).with_origins())
    assert told["cable.pull=-1:1"] is Origin.PHYSICS
    beyond = {"input": "cable.pull", "times": [0.0, 1.0], "values": [-1.0, 1.1]}
    with pytest.raises(SceneError, match=r"values: cable\.pull must stay <= 1, and goes to 1\.1$"):
        scene(strain="kirchhoff", actuators=[tendon()], inputs=free, motions=[beyond])
    wave = {"input": "cable.pull", "amplitude": 0.3, "frequency": 1.0, "wave": "one_minus_cosine"}
    with pytest.raises(SceneError, match=r"amplitude: cable\.pull must stay <= 1, and goes to 1\.1$"):
        scene(strain="kirchhoff", actuators=[tendon(pull=0.5)], inputs=free, motions=[wave])


def test_without_friction_nothing_is_added() -> None:
    smooth, plain = tendon(friction=0.0), tendon()
    del plain["friction"]
    models = [build(scene(accuracy=FEW, actuators=[table])) for table in (smooth, plain)]
    assert models[0].operations(models[0].jacobian) == models[1].operations(models[1].jacobian)


def test_a_cycle_of_pulls_dissipates() -> None:
    """Pulled in and let out at the same tensions, the end turns back later: the area is the work of friction.

    ∮ T₀ dL over 8 → 12 → 8 N with the direction turned at each end, from the closed forms of both branches.
    """
    model = build(with_tendon(strain="planar", accuracy=FINE, inputs=["cable.tension", "cable.pull"]))
    bending, offset, length, friction = STIFFNESS["bending_y"], 0.02, 0.8, 0.3

    def shortened(tension: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """Length that the cable loses, d times the turn of the rod."""
        share = pull * friction
        return offset * np.log1p(share * offset * tension * length / bending) / share

    tensions = np.linspace(8.0, 12.0, 9)
    pulls = np.linspace(1.0, -1.0, 9)
    pulls[4] = 1e-9
    cycle = [
        *((tension, 1.0) for tension in tensions),
        *((12.0, pull) for pull in pulls[1:]),
        *((tension, -1.0) for tension in tensions[::-1][1:]),
        *((8.0, pull) for pull in pulls[::-1][1:]),
    ]
    found = None
    lengths = []
    for tension, pull in cycle:
        found = solve(model, {"cable.tension": tension, "cable.pull": pull}, start=found)
        assert found.converged
        lengths.append(float(found.actuator("cable")["length"]))
    T, p = np.array(cycle).T
    assert_allclose(lengths, length - shortened(T, p), rtol=0, atol=1e-9)
    # Work that goes in, −∮ T dL, is positive: the cable is shorter on the way back.
    work = -np.sum((T[1:] + T[:-1]) / 2 * np.diff(lengths))
    assert work > 0.01 * offset


def test_balance_of_energy_in_motion() -> None:
    """What the tendon gives to the rod is its generalised force times the rates, and less than T₀ dL."""
    tables = {
        "schema": 1,
        "accuracy": {"modes": 2, "nodes": 5},
        "rods": [rod("reissner", damping=DAMPING)],
        "actuators": [tendon(**SKEW)],
    }
    model = build(scene_from_dict(tables), moving=True)
    state = drawn_state(model, 1)
    bare = build(scene_from_dict({**tables, "actuators": []}), moving=True)
    in_bare = [state.x, state.v, state.a, *(np.zeros(0) for _ in range(3))]
    added = model.inverse_dynamics(*state.all).full() - bare.inverse_dynamics(*in_bare).full()
    power = float(model.powers(*state.all)[2])
    unit = model.discrete.rods["rod"].energy_unit
    assert_allclose(power, -unit * float(added[:, 0] @ state.v), rtol=1e-11, atol=0)
    symbols = symbols_of(model)
    automatic = ca.Function("a", symbols, [ca.jacobian(model.inverse_dynamics(*symbols), symbols[0])])
    expected = automatic(*state.all).full()
    stiffness = model.dynamics_jacobian(*state.all)[0].full()
    assert_allclose(stiffness, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


# Elasticity


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_elastic_cable_vs_closed_form(friction: float) -> None:
    """d θ = L₀ … : the rod takes d θ(T) of the course, cable and winch (T − T₁)(L₀ m/EA + 1/k)."""
    bending, offset, length = STIFFNESS["bending_y"], 0.02, 0.8
    given, axial, winch, pretension = 0.797, 900.0, 4e3, 1.5
    elastic = {"length": given, "axial_stiffness": axial, "winch_stiffness": winch, "pretension": pretension}
    found = solve(build(with_tendon(strain="planar", accuracy=FINE, friction=friction, **elastic)))
    assert found.converged, found.message
    tension = found.actuator("cable")["tension"]
    share = friction * offset * tension * length / bending
    turned = np.log1p(share) / friction if friction else offset * tension * length / bending
    # T(s) = T₀/(1 + share s/ℓ) on a course whose length loses d κ(s), κ = d T/EI.
    points, weights = np.polynomial.legendre.leggauss(30)
    s = (points + 1) / 2
    local = tension / (1 + share * s)
    stretch = 1 - offset**2 * local / bending
    mean = np.sum(weights / 2 * local / tension * stretch) / np.sum(weights / 2 * stretch)
    extension = (tension - pretension) * (given * mean / axial + 1 / winch)
    assert tension > 2 * pretension
    assert_allclose(length - offset * turned, given + extension, rtol=0, atol=1e-10)


def test_a_cable_at_its_pretension_has_its_length() -> None:
    taut = {"length": 0.8, "axial_stiffness": 900.0, "pretension": 4.0, "friction": 0.0}
    pair = [tendon(**{**taut, "name": name, "offset": [x, 0.0]}) for name, x in (("a", 0.02), ("b", -0.02))]
    found = solve(build(scene(strain="planar", accuracy=FEW, actuators=pair)))
    assert_allclose([found.actuator(name)["tension"] for name in "ab"], 4.0, rtol=1e-9, atol=0)
    assert_allclose(found.tip().position, [0, 0, 0.8], rtol=0, atol=1e-12)


def test_an_elastic_cable_may_go_slack() -> None:
    loose = {"length": 0.81, "axial_stiffness": 900.0, "slack": True, "friction": 0.0}
    found = solve(build(with_tendon(strain="planar", **loose)))
    assert found.converged
    assert_allclose(found.actuator("cable")["tension"], 0.0, rtol=0, atol=1e-6)


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"friction": -0.1}, "friction: must be >= 0"),
    ({"pull": "up"}, "pull: must be 'in' or 'out', or from -1 to 1, got 'up'"),
    ({"friction": 0.0, "pull": "in"}, "pull: stands without friction"),
    ({"axial_stiffness": 10.0}, "axial_stiffness: is for a tendon of given length"),
    ({"winch_stiffness": 10.0}, "winch_stiffness: is for a tendon of given length"),
    ({"length": 0.8, "pretension": 1.0}, "pretension: is for an elastic cable"),
    ({"length": 0.8, "axial_stiffness": 0.0}, "axial_stiffness: must be > 0"),
]


@pytest.mark.parametrize(("changes", "told"), REFUSED)
def test_refusals(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError, match=told):
        with_tendon(**changes)
