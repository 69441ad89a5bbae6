"""Springs, dampers, motors and drives of joints, against closed forms, clamps and SciPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import Model, SceneError, build, export, load, modes_of, scene_from_dict, simulate
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.model.test_base_joints import GRAVITY, LENGTH, link, scene

ALONG = {"tangent": [1, 0, 0]}
HINGE = {"name": "hinge", "rod": "a", "at": 0.0, "kind": "revolute", "axis": [0, 1, 0]}
SLIDE = {"name": "slide", "rod": "a", "at": 0.0, "kind": "prismatic", "axis": [1, 0, 0]}
TURN = {"name": "turn", "kind": "tip_wrench", "rod": "a", "moment": [0, 0.2, 0], "force": [0.3, 0, 0]}
RIGID = 2e11
"""Young's modulus of rods that hardly bend, Pa."""


def built(joints: list[Any], rods: list[Any] | None = None, **changes: Any) -> Model:
    return build(scene_from_dict(scene(rods or [link("a", base=ALONG)], joints, **changes)))


CARRIED = [link("a", strain="kirchhoff", base=ALONG), link("b", strain="kirchhoff", base={"rod": "a"})]
OBLIQUE = {"rod": "b", "axis": [1, 2, 0.5]}


@pytest.mark.parametrize(
    "joint",
    [
        {**HINGE, **OBLIQUE, "stiffness": 0.3, "rest": 0.2, "moment": 0.1},
        {**SLIDE, **OBLIQUE, "stiffness": 3.0, "force": 0.1},
        {**SLIDE, **OBLIQUE, "displacement": 0.05},
    ],
)
def test_jacobian_vs_ad(joint: dict[str, Any]) -> None:
    model = built([joint], CARRIED)
    check_jacobian(model)


@pytest.mark.parametrize(
    ("joint", "moment", "wanted"),
    [
        ({**HINGE, "stiffness": 0.5, "rest": 0.1}, 0.2, 0.1 + 0.2 / 0.5),
        # Three turns and more: the angle is an unknown and not a function of the poses.
        ({**HINGE, "stiffness": 0.05}, 1.0, 20.0),
        ({**HINGE, "stiffness": 0.5, "moment": 0.3}, 0.2, 1.0),
    ],
)
def test_spring_at_a_hinge_under_a_moment(joint: dict[str, Any], moment: float, wanted: float) -> None:
    turned = solve(built([joint], loads=[{**TURN, "moment": [0, moment, 0], "force": [0, 0, 0]}]))
    assert turned.converged and turned.stable
    state = turned.joint("hinge")
    assert_allclose([state["angle"], state["moment"]], [wanted, -moment], rtol=0, atol=1e-9)


def test_spring_at_a_slide_under_a_force() -> None:
    pulled = solve(built([{**SLIDE, "stiffness": 40.0, "rest": 0.01}], loads=[{**TURN, "moment": [0, 0, 0]}]))
    state = pulled.joint("slide")
    assert_allclose([state["displacement"], state["force"]], [0.01 + 0.3 / 40.0, -0.3], rtol=0, atol=1e-10)
    # The ends of the rod move as the slide does.
    assert_allclose(pulled.tip().position, [LENGTH + state["displacement"], 0, 0], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("kind", "acts", "load"),
    [
        ("prismatic", {"stiffness": 30.0, "rest": -0.02, "force": -1.0}, "force"),
        ("prismatic", {"force": -1.0}, "force"),
        ("revolute", {"stiffness": 0.5, "moment": 0.2}, "moment"),
    ],
)
def test_effort_along_a_joint_that_holds_a_clamped_rod_in_the_world(
    kind: str, acts: dict[str, float], load: str
) -> None:
    """The joint without an effort, and a load on the tip in its place, is the same equilibrium."""
    place = {"world": True, "position": [0.6 * LENGTH, 0.1 * LENGTH, 0.2 * LENGTH]}
    held = {"name": "held", "kind": kind, "axis": [0, 0, 1], "between": [place, {"rod": "a", "at": 1.0}]}
    rod = link("a", strain="kirchhoff", base=ALONG)
    loose = {**TURN, "force": [0, 0, 0], "moment": [0, 0, 0]}
    with_effort = solve(built([{**held, **acts}], [rod], loads=[]))
    assert with_effort.converged, with_effort.message
    effort = with_effort.joint("held")[load]
    alike = solve(built([held], [rod], loads=[{**loose, load: [0, 0, effort]}]))
    assert_allclose(with_effort.tip().position, alike.tip().position, rtol=0, atol=1e-9)
    assert_allclose(with_effort.tip().rotation, alike.tip().rotation, rtol=0, atol=1e-8)


@pytest.mark.parametrize("angle", mostly_slow([0.7, 20.0], quick=[20.0]))
def test_driven_angle_is_a_clamp_at_that_angle(angle: float) -> None:
    half = (np.pi / 2 + angle) / 2
    clamped = solve(built([], [link("a", base={"quaternion": [np.cos(half), 0, np.sin(half), 0]})]))
    driven = solve(built([{**HINGE, "angle": 0.0}]), {"hinge.angle": angle})
    assert driven.converged, driven.message
    assert_allclose(driven.tip().position, clamped.tip().position, rtol=0, atol=1e-10)
    assert_allclose(driven.joint("hinge")["moment"], clamped.base_wrench().moment[1], rtol=1e-8, atol=1e-12)


def test_frequency_of_a_pendulum_on_a_spring() -> None:
    rod = link("a", modulus=10 * RIGID, base={"tangent": [0, 0, -1]})
    first = modes_of(scene_from_dict(scene([rod], [{**HINGE, "stiffness": 0.5}]))).modes[0]
    mass = 1100.0 * np.pi * 5e-3**2 * LENGTH
    inertia = mass * (LENGTH**2 / 3 + 5e-3**2 / 4)
    wanted = np.sqrt((0.5 + mass * GRAVITY * LENGTH / 2) / inertia)
    assert_allclose(2 * np.pi * first.frequency, wanted, rtol=1e-4, atol=0)


def two_links(**simulation: Any) -> dict[str, Any]:
    """A double pendulum of rods that do not bend, with a motor at its shoulder, a spring and a damper at its elbow."""
    stiff = {"strain": ["torsion"]}
    rods = [link("a", base=ALONG, **stiff), link("b", base={"rod": "a"}, **stiff)]
    motor = {**HINGE, "moment": 0.0}
    elbow = {"name": "elbow", "rod": "b", "at": 0.0, "kind": "revolute", "axis": [0, 1, 0]}
    tables = scene(
        rods,
        [motor, {**elbow, "stiffness": 0.4, "rest": 0.3, "damping": 0.01}],
        simulation={"duration": 0.3, "frames": 3, "start": "unloaded", **simulation},
        motions=[{"input": "hinge.moment", "amplitude": 0.5, "frequency": 2.0}],
    )
    tables["accuracy"] = {"modes": 1, "nodes": 6}
    return tables


def angles_of_two_links(times: Any) -> np.ndarray:
    """Angles of the first link below the horizontal, and of the second against it, by Lagrange's equations, (2, T)."""
    mass = 1100.0 * np.pi * 5e-3**2 * LENGTH
    about_centre = mass * (LENGTH**2 / 12 + 5e-3**2 / 4)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        first, turn, rate, turn_rate = y
        second, second_rate = first + turn, rate + turn_rate
        coupling = mass * LENGTH**2 / 2
        m11, m22 = about_centre + mass * LENGTH**2 * 1.25, about_centre + mass * LENGTH**2 / 4
        matrix = np.array([[m11, coupling * np.cos(turn)], [coupling * np.cos(turn), m22]])
        joint = -0.4 * (turn - 0.3) - 0.01 * turn_rate
        weight = mass * GRAVITY * LENGTH
        right = np.array(
            [
                0.5 * np.sin(4 * np.pi * t)
                - joint
                + 1.5 * weight * np.cos(first)
                + coupling * np.sin(turn) * second_rate**2,
                joint + 0.5 * weight * np.cos(second) - coupling * np.sin(turn) * rate**2,
            ]
        )
        of_first, of_second = np.linalg.solve(matrix, right)
        return np.array([rate, turn_rate, of_first, of_second - of_first])

    return np.asarray(solve_ivp(rates, (0, 0.3), np.zeros(4), rtol=1e-10, atol=1e-10, t_eval=times).y[:2])


def tip_of_first_link(angle: np.ndarray) -> np.ndarray:
    return LENGTH * np.array([np.cos(angle), 0 * angle, -np.sin(angle)]).T


@pytest.mark.slow
def test_two_links_with_a_spring_a_damper_and_a_motor_vs_scipy() -> None:
    motion = simulate(scene_from_dict(two_links(tolerance=1e-4)))
    assert motion.converged, motion.message
    first, turn = angles_of_two_links(motion.times)
    assert_allclose(motion.joint("elbow").conjugate, turn, rtol=0, atol=2e-5)
    assert_allclose(motion.tip("a").position, tip_of_first_link(first), rtol=0, atol=2e-5 * LENGTH)
    # What the motor puts in is stored or lost.
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=2e-6)


@pytest.mark.slow
def test_work_of_a_drive() -> None:
    move = {"input": "hinge.angle", "amplitude": 1.0, "frequency": 1.0, "wave": "one_minus_cosine"}
    tables = scene(
        [link("a", modulus=RIGID, base=ALONG)],
        [{**HINGE, "angle": 0.0}],
        simulation={"duration": 0.25, "frames": 3, "tolerance": 1e-5},
        motions=[move],
    )
    motion = simulate(scene_from_dict(tables))
    assert motion.converged, motion.message
    assert_allclose(motion.joint("hinge").conjugate[-1], 1.0, rtol=0, atol=1e-9)
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=1e-6)
    assert abs(motion.energy.work[-1]) > 0.1 * np.abs(motion.energy.potential).max()


def test_a_joint_without_spring_costs_nothing() -> None:
    plain = built([{key: HINGE[key] for key in ("rod", "at", "kind", "axis")}])
    named = built([HINGE])
    assert named.size == plain.size
    counts = [model.residual.n_instructions() for model in (plain, named)]
    assert counts[0] == counts[1]
    assert built([{**HINGE, "stiffness": 1.0}]).size == plain.size + 2


@pytest.mark.slow  # A compiler runs.
def test_in_c(tmp_path: Path) -> None:
    model = built(
        [{**HINGE, "angle": 0.7}, {**HINGE, "name": "elbow", "rod": "b", "stiffness": 0.4, "moment": 0.1}],
        [
            link("a", base=ALONG),
            link("b", base={"rod": "a"}),
        ],
    )
    library = load(export(model, tmp_path / "arm"))
    inputs = {"hinge.angle": 2.0, "elbow.moment": 0.2}
    in_c, here = library.solve(inputs), solve(model, inputs)
    assert in_c.converged
    assert_allclose(in_c.x, here.x, rtol=0, atol=1e-9)
    effort, angle = library.joint["elbow"](here.x, here.inputs)
    assert_allclose([float(effort), float(angle)], list(here.joint("elbow").values()), rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize(
    ("joint", "where", "problem"),
    [
        ({**HINGE, "angle": 0.1, "stiffness": 1.0}, "joints[0].stiffness", "stands beside angle"),
        ({**HINGE, "rest": 0.1}, "joints[0].stiffness", "missing"),
        ({**HINGE, "name": None, "moment": 0.1}, "joints[0].name", "missing"),
        ({**HINGE, "name": "weight", "moment": 0.1}, "joints[0].name", "'weight' is already the name of loads[0]"),
    ],
)
def test_refusals(joint: dict[str, Any], where: str, problem: str) -> None:
    given = {key: value for key, value in joint.items() if value is not None}
    with pytest.raises(SceneError) as refused:
        scene_from_dict(scene([link("a")], [given]))
    assert (where, problem) in [(one.where, one.problem) for one in refused.value.problems]


def test_a_drive_that_is_not_there_is_no_input() -> None:
    with pytest.raises(SceneError, match="'hinge' has no angle"):
        scene_from_dict(scene([link("a")], [HINGE], inputs=["hinge.angle"]))


def test_a_planar_rod_does_not_turn_out_of_its_plane() -> None:
    tip = {
        "name": "pin",
        "rod": "a",
        "kind": "revolute",
        "position": [LENGTH, 0, 0],
        "axis": [1, 0, 0],
        "stiffness": 1.0,
    }
    with pytest.raises(SceneError, match="out of the plane that it bends in"):
        built([tip])
