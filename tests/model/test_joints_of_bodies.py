"""Joints without a rod at either end: pendulums and mechanisms of rigid bodies, against closed forms and SciPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from cosserat_casadi import SceneError, build, export, load, modes_of, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.model.test_base_joints import GRAVITY, WEIGHT, link, scene

MASSES, ARMS, INERTIAS = np.array([0.7, 0.4]), np.array([0.3, 0.2]), np.array([0.01, 0.004])
"""Of two rigid links: kg, distance of the centre from the hinge above it, m, and moment of inertia about it, kg m²."""

FIRST = 0.5
"""Distance of the two hinges of the first link, m."""

SPRING = 0.3
"""Of the second hinge, N m/rad."""

CRANK, COUPLER = 0.1, 0.3
"""Lengths of a crank and of what couples it to a slider, m."""

Y = [0, 1, 0]


def hinge(carrier: dict[str, Any], carried: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {"kind": "revolute", "axis": Y, "between": [carrier, carried], **changes}


def body(number: int, **changes: Any) -> dict[str, Any]:
    inertia = [INERTIAS[number], INERTIAS[number], 1e-3]
    centre = {"mass": MASSES[number], "centre_of_mass": [0, 0, -ARMS[number]], "inertia": inertia}
    return {"name": ("upper", "lower")[number], **centre, **changes}


def pendulum(**changes: Any) -> dict[str, Any]:
    """Two links that hang in the world, beside a rod."""
    shoulder = hinge({"world": True, "position": [0, 0, 1]}, {"body": "upper"})
    elbow = hinge({"body": "upper", "position": [0, 0, -FIRST]}, {"body": "lower"}, name="elbow", stiffness=SPRING)
    beside = [link("a", base={"position": [1, 0, 0]})]
    return scene(beside, [shoulder, elbow], **{"bodies": [body(0), body(1)], **changes})


def slider_crank(angle: float = 0.3, **changes: Any) -> dict[str, Any]:
    """A crank that is driven in the world, and pushes a slider, which a force pulls; all have weight."""
    joints = [
        hinge({"world": True}, {"body": "arm"}, name="crank", angle=angle),
        # The coupler has its origin between its hinges.
        hinge({"body": "arm", "position": [CRANK, 0, 0]}, {"body": "coupler", "position": [-0.1, 0, 0]}),
        hinge({"body": "coupler", "position": [COUPLER - 0.1, 0, 0]}, {"body": "slider"}),
        {
            "kind": "prismatic",
            "axis": [1, 0, 0],
            "between": [{"world": True, "position": [CRANK + COUPLER, 0, 0]}, {"body": "slider"}],
        },
    ]
    joints[0]["between"][0]["position"] = [0, 0, 0]
    solid = {"mass": 0.2, "inertia": [1e-3, 1e-3, 1e-3]}
    bodies = [{"name": name, **solid} for name in ("arm", "coupler", "slider")]
    push = {"name": "push", "kind": "body_wrench", "body": "slider", "force": [5.0, 0, 0]}
    beside = [link("a", base={"position": [1, 0, 0]})]
    return scene(beside, joints, **{"bodies": bodies, "loads": [push, WEIGHT], "inputs": ["crank.angle"], **changes})


def reach(angle: float) -> tuple[float, float]:
    """Place of the slider, m, and its derivative with the angle of the crank."""
    sine, cosine = CRANK * np.sin(angle), CRANK * np.cos(angle)
    along = np.sqrt(COUPLER**2 - sine**2)
    return cosine + along, -sine - sine * cosine / along


@pytest.mark.parametrize(
    "elbow",
    [
        {"kind": "spherical"},
        {"kind": "prismatic", "axis": [0.3, 0.1, 1], "stiffness": 100.0},
        pytest.param({"kind": "prismatic", "axis": [0.3, 0.1, 1]}, marks=pytest.mark.slow),
        {"kind": "revolute", "axis": [0.3, 1, 0], "angle": 0.2},
        pytest.param({"kind": "fixed"}, marks=pytest.mark.slow),
    ],
)
def test_jacobian_vs_ad(elbow: dict[str, Any]) -> None:
    tables = pendulum()
    first = {"body": "upper", "position": [0, 0.1, -FIRST], "rotation_vector": [0.1, 0.2, 0.3]}
    second = {"body": "lower", "position": [0, 0.02, 0.03], "rotation_vector": [0.3, 0, 0.1]}
    tables["joints"][1] = {"name": "elbow", "between": [first, second], **elbow}
    model = build(scene_from_dict(tables), moving=True)
    check_jacobian(model)


def test_frequencies_of_a_double_pendulum() -> None:
    """Those of M q̈ + K q = 0 in the angles of the links, which hang; those of the rod beside them come after."""
    tables = pendulum(bodies=[body(0), body(1, centre_of_mass=[0, 0, 0.05 - ARMS[1]])])
    # The hinge is beside the origin of the lower link.
    tables["joints"][1]["between"][1]["position"] = [0, 0, 0.05]
    modes = modes_of(scene_from_dict(tables)).modes
    (m1, m2), (l1, l2) = MASSES, ARMS
    mass = np.diag(INERTIAS + MASSES * ARMS**2)
    mass += m2 * np.array([[FIRST**2, FIRST * l2], [FIRST * l2, 0.0]])
    stiffness = np.diag([(m1 * l1 + m2 * FIRST) * GRAVITY, m2 * l2 * GRAVITY]) + SPRING * np.array([[1, -1], [-1, 1]])
    squared = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)))
    assert_allclose([2 * np.pi * mode.frequency for mode in modes[:2]], np.sqrt(squared), rtol=1e-9, atol=0)


def let_go(tolerance: float) -> dict[str, Any]:
    """The two links let go where they stand askew, with a damper at the elbow."""
    tables = pendulum(simulation={"duration": 0.5, "frames": 6, "tolerance": tolerance})
    tables["joints"][0]["between"][0]["rotation_vector"] = [0, -1.2, 0]
    tables["joints"][1]["damping"] = 0.01
    return tables


def elbow(times: FloatArray) -> FloatArray:
    """Place of the elbow of the two links after that, shape (T, 3), m, from Lagrange's equations."""
    (m1, m2), (l1, l2) = MASSES, ARMS
    own = INERTIAS + MASSES * ARMS**2 + np.array([m2 * FIRST**2, 0.0])

    def rates(_: float, y: Any) -> Any:
        (a, b), (u, v) = y[:2], y[2:]
        coupling = m2 * FIRST * l2
        mass = np.array([[own[0], coupling * np.cos(a - b)], [coupling * np.cos(a - b), own[1]]])
        swirl = coupling * np.sin(a - b) * np.array([-(v**2), u**2])
        weight = -GRAVITY * np.array([(m1 * l1 + m2 * FIRST) * np.sin(a), m2 * l2 * np.sin(b)])
        at_elbow = (SPRING * (a - b) + 0.01 * (u - v)) * np.array([-1, 1])
        return [u, v, *np.linalg.solve(mass, swirl + weight + at_elbow)]

    angle = solve_ivp(rates, [0, times[-1]], [-1.2, -1.2, 0, 0], t_eval=times, rtol=1e-10, atol=1e-12).y[0]
    return np.column_stack([-FIRST * np.sin(angle), 0 * angle, 1 - FIRST * np.cos(angle)])


def test_double_pendulum_swings_as_scipy_says() -> None:
    """The motion of a mechanism begins unloaded, as there is no other rest near."""
    motion = simulate(scene_from_dict(let_go(1e-6)))
    assert motion.converged
    assert_allclose(motion.body("lower").position, elbow(motion.times), rtol=0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("modulus", [2e10, 2e14])
def test_how_stiff_a_link_is_does_not_matter(modulus: float) -> None:
    """A rod that only twists, beside one of 2 MPa: its own stiffness would hide what the other bears."""
    stiff = link("a", modulus, strain=["torsion"], base={"tangent": [1, 0, 0]})
    soft = link("b", 2e6, strain="kirchhoff")
    shoulder = {"rod": "a", "at": 0.0, "kind": "revolute", "axis": Y, "stiffness": 1.0}
    elbow = hinge({"rod": "a"}, {"rod": "b", "at": 0.0}, stiffness=1.0)
    solution = solve(build(scene_from_dict(scene([stiff, soft], [shoulder, elbow]))))
    assert solution.converged
    assert solution.iterations < 50
    # The place of the same chain with a link of 200 MPa, which twists as little.
    assert_allclose(solution.tip("b").position, [0.534588785, 0, -0.638986714], rtol=0, atol=1e-8)


@pytest.mark.parametrize("angle", mostly_slow([0.3, 2.5, -9.0], quick=[2.5]))
def test_slider_crank(angle: float) -> None:
    """Its place in closed form; the moment of its drive by virtual work. The loop is closed in the plane alone."""
    model = build(scene_from_dict(slider_crank()))
    solution = solve(model, {"crank.angle": angle})
    place, slope = reach(angle)
    assert solution.converged
    assert_allclose(solution.body("slider").position, [place, 0, 0], rtol=0, atol=1e-9)
    # The weight of the coupler acts a third of its length from the crank.
    lifted = -2 / 3 * CRANK * np.cos(angle)
    assert_allclose(solution.joint("crank")["moment"], 0.2 * GRAVITY * lifted - 5.0 * slope, rtol=1e-8, atol=0)
    assert [placed.size for placed in model.discrete.constraints] == [6, 5, 5, 2]


@pytest.mark.parametrize("load", [0.0, 40.0])
def test_slider_crank_with_a_coupler_that_bends(load: float) -> None:
    """A planar coupler is a spatial one, whose joints are all whole; straight it has the closed form of a rigid one."""
    tables = slider_crank()
    tables["bodies"] = [body for body in tables["bodies"] if body["name"] != "coupler"]
    first, _, _, guide = tables["joints"]
    first["angle"] = 1.0
    rod = link("coupler", length=COUPLER, base={"tangent": [1, 0, 0]})
    pin = hinge({"body": "arm", "position": [CRANK, 0, 0]}, {"rod": "coupler", "at": 0.0})
    wrist = hinge({"rod": "coupler"}, {"body": "slider"})
    middle = {"name": "middle", "kind": "point_wrench", "rod": "coupler", "at": 0.5, "force": [0, 0, load]}
    solutions = []
    for strain in ("planar", "kirchhoff"):
        changes = {"joints": [first, pin, wrist, guide], "loads": [middle], "accuracy": {"tolerance": 1e-8}}
        described = scene_from_dict({**tables, "rods": [{**rod, "strain": strain}], **changes})
        solutions.append(solve(build(described), {"crank.angle": 0.3}))
    planar, spatial = solutions
    assert planar.converged and spatial.converged
    assert [placed.size for placed in planar.model.discrete.constraints] == [6, 5, 2, 5]
    assert [placed.size for placed in spatial.model.discrete.constraints] == [6, 5, 5, 5]
    assert_allclose(planar.body("slider").position, spatial.body("slider").position, rtol=0, atol=1e-9)
    assert_allclose(planar.joint("crank")["moment"], spatial.joint("crank")["moment"], rtol=1e-7, atol=1e-12)
    shortened = reach(0.3)[0] - planar.body("slider").position[0]
    assert abs(shortened) < 1e-10 if load == 0.0 else shortened > 1e-5


def four_bar(coupler: str, rocker: str, *, tilt: float = 0.0) -> dict[str, Any]:
    """A crank, a coupler that bends and a rocker that bends; an axis that is tilted lets neither turn in the plane."""
    rods = [
        link("coupler", length=COUPLER, strain=coupler, base={"tangent": [1, 0, 0]}),
        link("rocker", length=0.2, strain=rocker, base={"position": [0.4, 0, -0.2], "tangent": [0, 0, 1]}),
    ]
    joints = [
        hinge({"world": True, "position": [0, 0, 0]}, {"body": "arm"}, name="crank", angle=0.0),
        hinge({"body": "arm", "position": [CRANK, 0, 0]}, {"rod": "coupler", "at": 0.0}),
        {"kind": "fixed", "between": [{"rod": "coupler"}, {"body": "knee"}]},
        hinge({"rod": "rocker"}, {"body": "knee"}, axis=[0, 1, tilt]),
        {"kind": "revolute", "axis": Y, "rod": "rocker", "at": 0.0},
    ]
    bodies = [{"name": "arm"}, {"name": "knee", "mass": 0.01, "inertia": [1e-6] * 3}]
    return scene(rods, joints, bodies=bodies, loads=[], inputs=["crank.angle"], accuracy={"tolerance": 1e-8})


@pytest.mark.parametrize(
    ("coupler", "rocker"),
    mostly_slow(
        [("planar", "planar"), ("planar", "kirchhoff"), ("kirchhoff", "planar"), ("kirchhoff", "kirchhoff")],
        quick=[("planar", "planar")],
    ),
)
def test_four_bar_of_two_links_that_bend(coupler: str, rocker: str) -> None:
    """Without loads they stay straight: the knee is where two circles meet."""
    solution = solve(build(scene_from_dict(four_bar(coupler, rocker))), {"crank.angle": 0.3})
    pin = CRANK * np.array([np.cos(0.3), 0, -np.sin(0.3)])
    foot = np.array([0.4, 0, -0.2])
    apart = foot - pin
    share = (COUPLER**2 - 0.2**2 + apart @ apart) / (2 * apart @ apart)
    aside = np.sqrt(COUPLER**2 / (apart @ apart) - share**2)
    knee = pin + share * apart + aside * np.array([-apart[2], 0, apart[0]])
    assert solution.converged
    assert_allclose(solution.body("knee").position, knee, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "end",
    [
        {"kind": "spherical"},
        {"kind": "revolute", "axis": Y},
        {"kind": "prismatic", "axis": [1, 0, 0]},
        pytest.param({"kind": "fixed"}, marks=pytest.mark.slow),
    ],
    ids=["spherical", "revolute", "prismatic", "fixed"],
)
def test_planar_rod_that_begins_on_a_hinged_body_ends_in_the_world(end: dict[str, Any]) -> None:
    """As one that bends and twists in space: joints and supports at its tip hold it in its plane alone."""
    place = {"world": True, "position": [0.15, 0.0, 0.45]}
    on_arm = {"kind": "fixed", "between": [{"rod": "a", "at": 0.0}, {"body": "arm", "position": [0.05, 0.0, 0.0]}]}
    joints = [hinge({"world": True}, {"body": "arm"}), on_arm, {**end, "between": [{"rod": "a"}, place]}]
    push = {"name": "push", "kind": "point_wrench", "rod": "a", "at": 0.5, "force": [0.4, 0.0, -0.3]}
    changes = {"bodies": [{"name": "arm", "mass": 0.0}], "loads": [push]}
    found, wanted = (
        solve(build(scene_from_dict(scene([link("a", strain=strain)], joints, **changes))))
        for strain in ("planar", "kirchhoff")
    )
    assert found.converged and wanted.converged
    assert found.stable == wanted.stable
    for X in (0.0, 0.5, 1.0):
        assert_allclose(found.pose(X).position, wanted.pose(X).position, rtol=0, atol=1e-9)
        assert_allclose(found.pose(X).rotation, wanted.pose(X).rotation, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("tilt", "again"), [(0.2, False), (0.0, True)])
def test_a_four_bar_that_is_held_twice_is_refused(tilt: float, again: bool) -> None:
    """Planar links whose last hinge leads out of their plane, and one that the world holds in it once more."""
    tables = four_bar("planar", "planar", tilt=tilt)
    if again:
        place = {"world": True, "position": [0.4, 0, 0]}
        tables["joints"] += [{"kind": "fixed", "between": [place, {"body": "knee"}]}] * 2
    with pytest.raises(SceneError, match="over-constrains"):
        build(scene_from_dict(tables))


@pytest.mark.parametrize(
    ("strain", "kind"),
    mostly_slow(
        [("planar", "spherical"), ("planar", "revolute"), ("kirchhoff", "revolute")], quick=[("planar", "revolute")]
    ),
)
def test_crank_without_rods_bends_a_rod(strain: str, kind: str) -> None:
    """It bends the rod as a slider at the pin of the crank would; a rod in the plane is held in it but once."""
    rod = link("a", strain=strain, base={"position": [-0.1, 0, 0], "tangent": [1, 0, 0]})
    pin = {"kind": kind, "between": [{"rod": "a"}, {"body": "arm", "position": [0.4, 0, 0]}]}
    pin |= {"axis": Y} if kind == "revolute" else {}
    crank = hinge({"world": True, "position": [0, 0, 0]}, {"body": "arm"}, name="crank", angle=0.3)
    solution = solve(build(scene_from_dict(scene([rod], [crank, pin], bodies=[{"name": "arm"}], loads=[]))))
    place = [0.4 * np.cos(0.3), 0, -0.4 * np.sin(0.3)]
    held = {"rod": "a", "kind": "pinned", "position": place}
    pinned = solve(build(scene_from_dict(scene([{**rod, "strain": "planar"}], [], loads=[], supports=[held]))))
    assert solution.converged
    assert_allclose(solution.tip().position, place, rtol=0, atol=1e-10)
    assert_allclose(solution.pose([0.5]).position, pinned.pose([0.5]).position, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_places_are_parameters() -> None:
    """A link that is longer by a parameter is one that is longer in its table, in both of its places."""
    tables = slider_crank(1.0, parameters=["pin.position", "pin.carries.position"])
    tables["joints"][1]["name"] = "pin"
    model = build(scene_from_dict(tables))
    changed = {"pin.position": [0.12, 0, 0], "pin.carries.position": [-0.11, 0, 0]}
    moved = solve(model, parameters=changed)
    tables = slider_crank(1.0)
    for end, place in zip(tables["joints"][1]["between"], changed.values(), strict=True):
        end["position"] = place
    assert_allclose(
        moved.body("slider").position, solve(build(scene_from_dict(tables))).body("slider").position, rtol=0, atol=1e-9
    )


SMALL = {"modes": 1, "nodes": 4}


@pytest.mark.slow
def test_in_c(tmp_path: Path) -> None:
    model = build(scene_from_dict(slider_crank(accuracy=SMALL)))
    library = load(export(model, tmp_path / "crank"))
    inputs = {"crank.angle": 2.0}
    assert_allclose(library.solve(inputs).x, solve(model, inputs).x, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_steps_in_c(tmp_path: Path) -> None:
    tables = pendulum(simulation={"duration": 0.2, "frames": 2, "tolerance": 1e-5}, accuracy=SMALL)
    tables["joints"][0]["between"][0]["rotation_vector"] = [0, -1.2, 0]
    described = scene_from_dict(tables)
    library = load(export(build(described, moving=True), tmp_path / "pendulum", dynamics=True))
    state, memory = library.rest(), library.step_memory()
    assert state is not None
    for _ in range(100):
        state = library.step(state, 2e-3, {}, memory=memory).state
    there, _ = library.body["lower"](state.x, library.defaults)
    assert_allclose(there.full().ravel(), simulate(described).body("lower").position[-1], rtol=0, atol=1e-5)


@pytest.mark.parametrize(
    ("joint", "where", "problem"),
    [
        ({"between": [{"body": "upper"}, {"body": "upper"}]}, "joints[1].between", "joins a body with itself"),
        ({"between": [{"world": True}, {"world": True}]}, "joints[1].between", "joins the world with itself"),
        ({"carries": {"body": "nobody"}, "body": "upper"}, "joints[1].carries.body", "no body is named 'nobody'"),
        ({"carries": {"body": "lower"}, "body": "upper", "rod": "a"}, "joints[1].rod", "stands beside carries"),
    ],
)
def test_refusals(joint: dict[str, Any], where: str, problem: str) -> None:
    tables = pendulum()
    tables["joints"][1] = {"kind": "spherical", **joint}
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables)
    assert (where, problem) in [(fault.where, fault.problem) for fault in refused.value.problems]


def test_bodies_that_hold_each_other_alone_are_refused() -> None:
    tables = pendulum()
    tables["joints"] = tables["joints"][1:]
    with pytest.raises(
        SceneError, match="nobody holds the body 'upper': its joints lead to no rod and not to the world"
    ):
        scene_from_dict(tables)


def on_an_arm(joint: dict[str, Any], **base: Any) -> dict[str, Any]:
    """A rod on a body that is held in the world."""
    held = hinge({"world": True, "position": [0, 0, 0]}, {"body": "arm"}, name="crank", angle=0.0)
    carried = {**joint, "between": [{"body": "arm", "position": [CRANK, 0, 0]}, {"rod": "a", "at": 0.0}]}
    arm = {"name": "arm", "mass": 0.2, "inertia": [1e-3, 1e-3, 1e-3]}
    return scene([link("a", base=base)], [held, carried], bodies=[arm])


@pytest.mark.parametrize(
    ("joint", "direction"),
    [
        ({"kind": "revolute", "axis": Y}, [0.6, 0.0, 0.8]),
        ({"kind": "spherical"}, [0.6, 0.0, 0.8]),
        ({"kind": "fixed"}, [0.0, 0.0, 1.0]),
        ({"kind": "revolute", "axis": [1, 0, 0]}, [0.0, 0.0, 1.0]),
        ({"kind": "revolute", "axis": Y, "stiffness": 0.1}, [0.0, 0.0, 1.0]),
    ],
)
def test_a_rod_on_a_body_starts_as_its_base_points_where_its_joint_turns_freely(
    joint: dict[str, Any], direction: list[float]
) -> None:
    discrete = build(scene_from_dict(on_an_arm(joint, tangent=[0.6, 0.0, 0.8]))).discrete
    tip = discrete.unloaded.section("a", 1.0).position
    length = discrete.records["a"].length
    assert_allclose(tip, np.array([CRANK, 0.0, 0.0]) + length * np.array(direction), rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("base", [{}, {"position": [0.3, 0.0, 0.0]}, {"quaternion": [1, 0, 0, 0]}])
def test_a_rod_whose_base_says_no_orientation_starts_as_its_body_points(base: dict[str, Any]) -> None:
    tables = on_an_arm({"kind": "revolute", "axis": Y}, **base)
    half_of_a_right_angle = [np.cos(np.pi / 8), 0.0, np.sin(np.pi / 8), 0.0]
    tables["joints"][1]["between"][0]["quaternion"] = half_of_a_right_angle
    discrete = build(scene_from_dict(tables)).discrete
    length = discrete.records["a"].length
    along = discrete.unloaded.section("a", 1.0).position - [CRANK, 0.0, 0.0]
    assert_allclose(along, length * np.array([0.5, 0.0, 0.5]) * np.sqrt(2.0), rtol=1e-14, atol=1e-14)


def test_the_start_of_a_hinged_rod_is_the_turn_nearest_to_its_base() -> None:
    wanted = np.array([0.5, -0.1, 0.7, 0.2])
    wanted /= np.linalg.norm(wanted)
    asked = Rotation.from_quat(np.roll(wanted, -1)).as_matrix()
    hinged = on_an_arm({"kind": "revolute", "axis": Y}, quaternion=wanted.tolist())
    turned = build(scene_from_dict(hinged)).discrete.unloaded.base("a").rotation
    angles = np.linspace(-np.pi, np.pi, 100_001)
    traces = np.cos(angles) * (asked[0, 0] + asked[2, 2]) + np.sin(angles) * (asked[0, 2] - asked[2, 0])
    nearest = angles[np.argmax(traces)]
    sine, cosine = np.sin(nearest), np.cos(nearest)
    about_y = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    assert_allclose(turned, about_y, rtol=0.0, atol=1e-4)


def test_a_loop_that_is_closed_unloaded_and_bears_nothing_takes_no_step() -> None:
    tables = on_an_arm({"kind": "revolute", "axis": Y}, tangent=[1, 0, 0])
    slide: dict[str, Any] = {"kind": "prismatic", "axis": [1, 0, 0], "between": [{"world": True}, {"body": "slider"}]}
    slide["between"][0]["position"] = [CRANK + tables["rods"][0]["length"], 0, 0]
    tables["joints"] += [hinge({"rod": "a"}, {"body": "slider"}), slide]
    tables["bodies"] += [{"name": "slider", "mass": 0.2, "inertia": [1e-3, 1e-3, 1e-3]}]
    push = {"name": "push", "kind": "body_wrench", "body": "slider", "force": [0, 0, 0]}
    model = build(scene_from_dict({**tables, "loads": [push]}))
    resting = solve(model)
    assert resting.converged
    assert resting.iterations == 0
    pushed = solve(model, {"push.force": [-1e-6, 0.0, 0.0]})
    assert pushed.converged
    assert pushed.iterations > 0
    assert np.linalg.norm(pushed.x - resting.x) > 0.0
