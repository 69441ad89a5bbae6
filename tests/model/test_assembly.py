"""Equations of assemblies: derivatives, energy, symmetry, what is refused."""

from __future__ import annotations

from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi import Model, Scene, SceneError, build, scene_from_dict
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.scene.writing import scene_tables
from tests.derivatives import central_differences, jacobian_by_ad
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.scenes import STIFFNESS

FEW = {"modes": 3, "nodes": 8}
WEIGHT = {"name": "w", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]}


def rod(name: str, length: float, strain: str | list[str] = "kirchhoff", **changes: Any) -> dict[str, Any]:
    plain = {"name": name, "length": length, "strain": strain, "stiffness": STIFFNESS, "linear_density": 0.7}
    return {**plain, **changes}


def joint(name: str, body: str = "plate", kind: str = "fixed", **changes: Any) -> dict[str, Any]:
    return {"body": body, "rod": name, "kind": kind, "position": [0.02, -0.03, 0.01], **changes}


RODS = [
    rod("a", 0.8, "reissner", base={"position": [0, 0, 0.1], "tangent": [0.3, 0.2, 1]}),
    rod("b", 0.6, base={"rod": "a", "at": 0.5, "position": [0.02, 0.01, 0.0], "quaternion": [0.6, 0, 0.8, 0]}),
    rod("c", 0.7, "reissner", base={"position": [0.5, 0, 0]}),
    rod("d", 0.4, base={"rod": "b"}),
    rod("e", 0.4, base={"position": [0.4, 0, 0]}),
]
TABLES: dict[str, Any] = {
    "schema": 1,
    "accuracy": FEW,
    "rods": RODS,
    "bodies": [{"name": "plate", "mass": 0.2, "centre_of_mass": [0.1, 0.02, 0.03]}],
    "joints": [joint("a", quaternion=[0.8, 0.6, 0, 0]), joint("c", kind="spherical", position=[0, 0.1, 0]), joint("b")],
    "supports": [
        {"rod": "d", "kind": "clamped", "position": [0.3, 0.3, 0.7], "quaternion": [1, 0, 0, 0]},
        {"rod": "e", "kind": "pinned", "position": [0.3, 0.1, 0.3]},
    ],
    "loads": [WEIGHT],
}
VECTORS: dict[str, Any] = {"force": [0.3, 0.1, 0.5], "moment": [0.1, 0.05, 0.2]}
LOADS = [
    WEIGHT,
    {"name": "p", "kind": "body_wrench", "body": "plate", "position": [0.02, 0.0, 0.07], **VECTORS},
    {"name": "q", "kind": "body_wrench", "body": "plate", "position": [0.0, 0.1, 0.07], "frame": "body", **VECTORS},
    {"name": "t", "kind": "tip_wrench", "rod": "b", "frame": "body", **VECTORS},
    {"name": "s", "kind": "point_wrench", "at": 0.3, "rod": "b", **VECTORS},
    {"name": "l", "kind": "distributed_wrench", "rod": "b", "frame": "body", **VECTORS},
    {
        "name": "m",
        "kind": "distributed_wrench",
        "rod": "d",
        "force": [0.3, [0.1, 0.3], 0.5],
        "moment": [0.1, 0.05, 0.2],
    },
]


@cache
def loaded() -> Model:
    """Every kind of coupling under every kind of load, dead and following."""
    return build(scene_from_dict({**TABLES, "loads": LOADS}))


@cache
def conservative() -> Model:
    """The same under weight and a dead force on the body."""
    push = {"name": "p", "kind": "body_wrench", "body": "plate", "position": [0.02, 0, 0.07], "force": [0.3, 0.1, 0.5]}
    return build(scene_from_dict({**TABLES, "loads": [WEIGHT, push]}))


def unknowns(model: Model, seed: int) -> np.ndarray:
    return 0.3 * np.random.default_rng(seed).standard_normal(model.size)


@pytest.mark.parametrize("factor", mostly_slow([1.0, 0.6], quick=[0.6]))
def test_jacobian_vs_ad_vs_finite_differences(factor: float) -> None:
    model = loaded()
    x, inputs = unknowns(model, 1), model.pack()
    own = model.path_jacobian(x, inputs, factor).full()
    assert_allclose(own, jacobian_by_ad(model, x, factor), rtol=0, atol=1e-13)
    differences = central_differences(lambda x: model.path_residual(x, inputs, factor), x, 1e-6)
    assert_allclose(own, differences, rtol=0, atol=5e-9)


@pytest.mark.parametrize("angle", mostly_slow([0.0, 1.0, np.pi, 2 * np.pi], quick=[np.pi]))
def test_derivatives_finite_at_any_turn_of_a_frame(angle: float) -> None:
    """A quaternion has no singular rotation: identity, half turn and full turn alike."""
    model = loaded()
    x, inputs, symbol = model.unloaded(), model.pack(), ca.MX.sym("x", model.size)
    turned = np.array([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])
    for name, frame in model.discrete.frames.items():
        x[model.discrete.deviation(name)][3:] = turned - frame.start.quaternion
    jacobian = model.path_jacobian(symbol, inputs, 1.0)
    second = ca.Function("second", [symbol], [ca.jtimes(jacobian @ np.ones(model.size), symbol, np.ones(model.size))])
    assert_allclose(model.path_jacobian(x, inputs, 1.0).full(), jacobian_by_ad(model, x, 1.0), rtol=0, atol=1e-12)
    assert np.all(np.isfinite(second(x).full()))


def test_unloaded_scene_is_an_equilibrium_at_factor_zero() -> None:
    model = loaded()
    residual = model.path_residual(model.unloaded(), model.pack(), 0.0).full()
    assert_allclose(residual, 0.0, rtol=0, atol=1e-15)


def energy(model: Model, x: np.ndarray) -> float:
    """Elastic energy less the work of weight and push, from poses in the world; J."""
    inputs, g = model.pack(), np.array(WEIGHT["acceleration"])
    total = float(model.energy(x, inputs))
    for name, basis in model.discrete.rods.items():
        position = model.fields[name](x, inputs)[0].full()
        total -= 0.7 * basis.properties.length * basis.grid.weights @ (g @ position)
    position, _, rotation = (m.full() for m in model.body["plate"](x, inputs))
    force = np.array([0.3, 0.1, 0.5])
    total -= 0.2 * g @ (position[:, 0] + rotation @ [0.1, 0.02, 0.03])
    return total - force @ (position[:, 0] + rotation @ [0.02, 0, 0.07])


def test_residual_vs_gradient_of_energy() -> None:
    """Without multipliers, and with quaternions of length one, the residual is the gradient of the energy."""
    model = conservative()
    x = unknowns(model, 2)
    unknowns_of = model.discrete.unknowns
    for _, entries in unknowns_of.of_kind(BlockKind.MULTIPLIER):
        x[entries] = 0.0
    places = {(b.kind, b.owner): (s, b.unit) for b, s in unknowns_of.of_kind(BlockKind.STRAIN, BlockKind.POSE)}
    for name, frame in model.discrete.frames.items():
        place = model.discrete.deviation(name)
        q = frame.start.quaternion + x[place][3:]
        x[place.start + 3 : place.stop] = q / np.linalg.norm(q) - frame.start.quaternion
    residual = model.residual(x, model.pack()).full()[:, 0]
    (slopes,) = central_differences(lambda x: energy(model, x), x, 1e-5)
    for place, unit in places.values():
        assert_allclose(residual[place], slopes[place] / unit, rtol=1e-7, atol=2e-8)


def test_multipliers_are_conjugate_to_closed_gaps() -> None:
    """At closed gaps the rows of a tie are minus the transposed columns of its multipliers, in the same units."""
    tables = {
        **TABLES,
        "supports": [],
        "joints": [joint("a")],
        "loads": [WEIGHT],
        "rods": [RODS[0], rod("b", 0.6, base={"rod": "a", "at": 0.5, "position": [0.02, 0.01, 0.0]})],
    }
    model = build(scene_from_dict(tables))
    matrix = model.path_jacobian(model.unloaded(), model.pack(), 1.0).full()  # unloaded, these ties are closed
    matrix = model.discrete.unknowns.units[:, None] * matrix
    first = model.discrete.unknowns.count(BlockKind.STRAIN)
    gaps = slice(first, first + model.discrete.unknowns.count(BlockKind.MULTIPLIER))
    assert_allclose(matrix[gaps], -matrix[:, gaps].T, rtol=0, atol=1e-14)


def test_body_starts_where_the_unloaded_rods_want_it() -> None:
    """Two rods that ask for the same pose of the body: it starts there, and no gap is open."""
    turn = [np.cos(0.2), np.sin(0.2), 0.0, 0.0]
    rods = [rod(n, 0.5, base={"position": [x, 0, 0]}) for n, x in (("a", 0.0), ("b", 0.1))]
    joints = [joint("a", position=[0, 0, 0], quaternion=turn), joint("b", quaternion=turn, position=[0.1, 0, 0])]
    model = build(scene_from_dict({"schema": 1, "rods": rods, "bodies": [{"name": "plate"}], "joints": joints}))
    start = model.discrete.frames[FrameName("body", "plate")].start
    assert_allclose(start.position, [0, 0, 0.5], rtol=0, atol=1e-15)
    assert_allclose(start.quaternion, [np.cos(0.2), -np.sin(0.2), 0, 0], rtol=0, atol=1e-15)
    assert_allclose(model.residual(model.unloaded(), model.pack()).full(), 0.0, rtol=0, atol=1e-14)


def leg(name: str, x: float, strain: str | list[str], **base: Any) -> dict[str, Any]:
    return rod(name, 0.5, strain, base={"position": [x, 0, 0], **base})


def held_by(*rods: dict[str, Any], **changes: Any) -> Scene:
    joints = [joint(r["name"], position=[r["base"]["position"][0], 0, 0], **changes) for r in rods]
    return scene_from_dict({"schema": 1, "rods": list(rods), "bodies": [{"name": "plate"}], "joints": joints})


def test_joints_that_over_constrain_are_refused() -> None:
    quarter = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
    across = [leg("a", 0.0, "planar"), leg("b", 0.1, "planar", quaternion=quarter)]
    for scene in (held_by(leg("a", 0, ["extension"]), leg("b", 0.1, ["extension"])), held_by(*across)):
        with pytest.raises(SceneError) as refused:
            build(scene)
        (problem,) = refused.value.problems
        assert problem.where == "joints[1]"
        assert "over-constrains the tip of 'b' at 'plate'" in problem.problem


def test_joints_are_checked_at_the_lengths_of_the_scene() -> None:
    """Where lengths are inputs too: at length zero every joint over-constrains."""
    legs = (leg("a", 0.0, "kirchhoff"), leg("b", 0.1, "kirchhoff"), leg("c", 0.2, "kirchhoff"))
    tables = {**scene_tables(held_by(*legs)), "inputs": [f"{name}.length" for name in "abc"]}
    assert [placed.size for placed in build(scene_from_dict(tables)).discrete.constraints] == [6, 6, 6]


HANGING = {"name": "plate", "mass": 0.1, "centre_of_mass": [0.05, 0.0, -0.1]}
PULL = {"name": "pull", "kind": "body_wrench", "body": "plate", "force": [0.1, 0.2, 0.3], "position": [0.0, 0.0, 0.1]}
DOWN = {"name": "down", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
JOINTS = "the line through its joints"
SPINS: dict[str, tuple[list[float], dict[str, Any], str]] = {
    "joint": ([0.0], {}, "its joint"),
    "weight_at_the_joint": ([0.0], {"bodies": [{"name": "plate", "mass": 0.1}], "loads": [DOWN]}, "its joint"),
    "two": ([0.0, 0.1], {}, JOINTS),
    "three": ([0.0, 0.1, 0.3], {}, JOINTS),
    "weight_on_the_line": ([0.0, 0.1], {"bodies": [{"name": "plate", "mass": 0.1}], "loads": [DOWN]}, JOINTS),
    "force_on_the_line": ([0.0, 0.1], {"loads": [{**PULL, "position": [0.7, 0.0, 0.0]}]}, JOINTS),
    "force_that_turns": ([0.0, 0.1], {"loads": [{**PULL, "frame": "body"}]}, JOINTS),
    "moment": ([0.0, 0.1], {"loads": [{**PULL, "force": None, "moment": [0.1, 0.0, 0.0]}]}, JOINTS),
}


def hung(places: list[float], changes: dict[str, Any], *moved: float) -> Scene:
    """Rods abreast that hold a plate by spherical joints on a line, one more at each of the moved places off it."""
    legs = [leg(name, x, "kirchhoff") for name, x in zip("abcd", [*places, *moved], strict=False)]
    tables = scene_tables(held_by(*legs, kind="spherical"))
    for joint in tables["joints"][len(places) :]:
        joint["position"] = [joint["position"][0], 0.1, 0.0]
    loads = [{k: v for k, v in load.items() if v is not None} for load in changes.get("loads", [])]
    return scene_from_dict({**tables, **changes, "loads": loads})


@pytest.mark.parametrize(
    "case", mostly_slow(SPINS, quick=["joint", "weight_at_the_joint", "two", "weight_on_the_line"])
)
def test_bodies_that_turn_freely_are_refused(case: str) -> None:
    places, changes, about = SPINS[case]
    with pytest.raises(SceneError) as refused:
        build(hung(places, changes))
    (problem,) = refused.value.problems
    assert (problem.where, problem.problem) == (
        "bodies[0]",
        f"nothing holds the orientation of 'plate': it turns freely about {about}",
    )
    if len(places) > 1:
        assert len(build(hung(places, changes, 0.2)).discrete.constraints) == len(places) + 1


def test_a_body_that_hangs_from_a_line_is_held_by_its_weight() -> None:
    """A swing below its joints is stable, the same upside down is not; a force off the line holds it as well."""
    for height, stable in ((-0.1, True), (0.1, False)):
        body = {**HANGING, "mass": 0.01, "centre_of_mass": [0.05, 0.0, height]}
        solution = solve(build(hung([0.0, 0.1], {"bodies": [body], "loads": [DOWN]})))
        assert (solution.converged, solution.stable) == (True, stable)
        assert "neutral" not in solution.message
    assert solve(build(hung([0.0, 0.1], {"loads": [PULL]}))).stable


def test_what_hangs_from_one_joint_is_neutral() -> None:
    """The centre of mass is straight below the joint, and the body may turn about the vertical."""
    solution = solve(build(hung([0.0], {"bodies": [{**HANGING, "mass": 0.01}], "loads": [DOWN]})))
    assert (solution.converged, solution.stable) == (True, True)
    assert "neutral" in solution.message
    quaternion = solution.model.body["plate"](solution.x, solution.inputs)[1].full()[:, 0]
    lever = Rotation.from_quat(quaternion, scalar_first=True).apply(HANGING["centre_of_mass"])
    assert_allclose(lever / np.linalg.norm(lever), [0.0, 0.0, -1.0], rtol=0, atol=1e-8)


def test_planar_rods_of_one_plane_hold_a_body_in_it() -> None:
    """The first holds the body in the plane, the second holds what the plane leaves; so do hinges."""
    legs = (leg("a", 0.0, "planar"), leg("b", 0.1, "planar"))
    for kind, sizes in (("fixed", [6, 3]), ("spherical", [5, 2])):
        model = build(held_by(*legs, kind=kind))
        assert [placed.size for placed in model.discrete.constraints] == sizes
