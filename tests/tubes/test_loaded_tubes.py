"""Tubes that bear loads: against shooting with other unknowns, rods of this package, differences and known loads."""

from __future__ import annotations

import itertools
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, parse_scene, solve
from cosserat_casadi.tubes.loaded_model import LoadedTubeModel
from cosserat_casadi.tubes.loaded_tangent import tangent_step
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_arrows import load_arrows
from cosserat_casadi.tubes.tube_solve import solution_near, solve_at
from tests.families import mostly_slow
from tests.tubes.functions_in_c import check_functions_in_c
from tests.tubes.shooting import DENSITY, forces_of, shot
from tests.tubes.test_tube_robots import THREE, TWO, check_tips, moved

DIFFERENCE = 1e-6

PUSH = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "inner"
force = [0.3, -0.2, -0.4]
"""

POKE = """
[[loads]]
name = "poke"
kind = "tip_wrench"
rod = "outer"
force = [-0.1, 0.4, 0.2]
"""

WEIGHT = """
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [1.0, 2.0, -9.0]
"""

WIND = """
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "inner"
force = [0.0, 0.8, 0.5]
"""


def weighed(text: str) -> str:
    """The tubes with their masses."""
    parts = text.split("straight =")
    masses = [f"linear_density = {density}\nstraight =" for density in DENSITY[: len(parts) - 1]]
    return "".join(itertools.chain(*zip(parts, masses, strict=False))) + parts[-1]


@pytest.mark.parametrize(
    ("text", "inputs"),
    [
        pytest.param(TWO + PUSH, {}, marks=pytest.mark.slow),
        pytest.param(weighed(THREE) + PUSH + POKE + WEIGHT + WIND, {}, marks=pytest.mark.slow),
        (weighed(THREE) + PUSH + POKE + WEIGHT, {"outer.translation": 0.05, "innermost.translation": 0.12}),
    ],
    ids=["push", "three tubes", "another order"],
)
def test_against_shooting(text: str, inputs: dict[str, float]) -> None:
    found = solve(parse_scene(text), inputs)
    assert found.converged
    assert found.error_estimate is not None
    assert found.error_estimate <= 1e-8
    truth = shot(found)
    assert_allclose(found.shape.torques[0], truth.torques, rtol=0, atol=1e-8)
    assert_allclose(found.tip().position, truth.position, rtol=0, atol=1e-8)


ONE = """
schema = 1
accuracy = { tolerance = 1e-10 }
[[tubes]]
name = "tube"
stiffness = { bending = 0.05, torsion = 0.04 }
linear_density = 0.05
straight = STRAIGHT
curved = 0.2
curvature = CURVATURE
translation = 0.2
"""

ROD = """
schema = 1
accuracy = { tolerance = 1e-10 }
[[rods]]
name = "tube"
length = 0.2
strain = "kirchhoff"
stiffness = { bending_x = 0.05, bending_y = 0.05, torsion = 0.04 }
linear_density = 0.05
intrinsic = { curvature = [0, CURVATURE, 0] }
"""


def wrench(**keys: object) -> str:
    lines = [f"{key} = {value}" for key, value in keys.items()]
    return '[[loads]]\nname = "wrench"\nkind = "tip_wrench"\nrod = "tube"\n' + "\n".join(lines) + "\n"


@pytest.mark.parametrize("curvature", [pytest.param(0.0, marks=pytest.mark.slow), 9.0])
@pytest.mark.parametrize(
    "load",
    [
        pytest.param(wrench(force=[0.5, -0.3, -1.2]), marks=pytest.mark.slow),
        pytest.param(wrench(force=[0.5, -0.3, -1.2], frame='"body"'), marks=pytest.mark.slow),
        pytest.param(wrench(moment=[0.04, 0.03, 0.06]), marks=pytest.mark.slow),
        wrench(moment=[0.04, 0.03, 0.06], force=[0.2, 0.1, 0.3], frame='"body"'),
        pytest.param(WEIGHT + wrench(force=[0.0, 0.6, 0.0]), marks=pytest.mark.slow),
    ],
    ids=["force", "follower", "moment", "following wrench", "weight"],
)
def test_one_tube_is_a_rod(load: str, curvature: float) -> None:
    found = solve(parse_scene(ONE.replace("CURVATURE", f"{curvature}").replace("STRAIGHT", "0.0") + load))
    rod = solve(parse_scene(ROD.replace("CURVATURE", f"{curvature}") + load))
    assert found.converged
    assert rod.converged
    tip = rod.tip("tube")
    assert_allclose(found.tip().position, tip.position, rtol=0, atol=1e-8)
    assert_allclose(found.tip().rotation, tip.rotation, rtol=0, atol=1e-7)
    assert found.stable == rod.stable


def poke(at: float, frame: str = "world") -> str:
    lines = f"at = {at}\nforce = [0.5, -0.3, -1.2]\nframe = '{frame}'\n"
    return '[[loads]]\nname = "poke"\nkind = "point_wrench"\nrod = "tube"\n' + lines


@pytest.mark.parametrize("frame", mostly_slow(["world", "body"], quick=["body"]))
def test_one_tube_with_a_force_beside_its_tip_is_a_rod(frame: str) -> None:
    load = poke(0.625, frame)
    found = solve(parse_scene(ONE.replace("CURVATURE", "9.0").replace("STRAIGHT", "0.0") + load))
    rod = solve(parse_scene(ROD.replace("CURVATURE", "9.0") + load))
    assert found.converged
    assert_allclose(found.tip().position, rod.tip("tube").position, rtol=0, atol=1e-8)
    assert_allclose(found.tip().rotation, rod.tip("tube").rotation, rtol=0, atol=1e-7)
    assert found.stable == rod.stable
    # The place moves with the tube; the derivatives know it.
    for index in range(found.inputs.size):
        poses = []
        # A translation has a corner where the curved part begins in the plate: the tube is drawn in.
        ahead, behind = (0.0, -1e-6) if index == 1 else (1e-6, -1e-6)
        for change in (ahead, behind):
            inputs = found.inputs.copy()
            inputs[index] += change
            poses.append(solution_near(found.model, inputs, found.x).tip().position)
        difference = (poses[0] - poses[1]) / (ahead - behind)
        assert_allclose(found.tip_jacobian[0, 3:, index], difference, rtol=0, atol=1e-5 if index == 1 else 1e-8)


@pytest.mark.slow
def test_a_force_beside_the_tip_of_two_tubes() -> None:
    scene = parse_scene(TWO + poke(0.9).replace('"tube"', '"inner"'))
    found = solve(scene)
    assert found.converged
    # 0.03 m from the tip of the tube, which is 0.3 m long and stands out by 0.24 m.
    place = int(np.argmin(np.abs(found.shape.distance - 0.21)))
    assert_allclose(found.shape.distance[place], 0.21, rtol=0, atol=1e-14)
    (arrow,) = load_arrows(found)
    assert_allclose(arrow.start, found.shape.position[place], rtol=0, atol=1e-14)
    # The energy changes with a force as its place has moved.
    for axis in range(3):
        energies = []
        for change in (1e-4, -1e-4):
            inputs = found.inputs.copy()
            inputs[4 + axis] += change
            energies.append(solution_near(found.model, inputs, found.x).energy)
        slope = (energies[0] - energies[1]) / 2e-4
        assert_allclose(slope, -found.shape.position[place][axis], rtol=0, atol=1e-8)


def test_the_housing_bears_a_force_in_it() -> None:
    tubes = ONE.replace("CURVATURE", "9.0").replace("STRAIGHT", "0.3")
    inside = solve(parse_scene(tubes + poke(0.5)))
    free = solve(parse_scene(tubes + poke(0.5)), {"poke.force": [0.0, 0.0, 0.0]})
    assert_allclose(inside.tip().position, free.tip().position, rtol=0, atol=1e-12)
    assert load_arrows(inside) == []
    # At the abscissa 1 it is a force at the tip.
    at_tip = solve(parse_scene(tubes + poke(1.0)))
    wanted = solve(parse_scene(tubes + wrench(force=[0.5, -0.3, -1.2])))
    assert_allclose(at_tip.tip().position, wanted.tip().position, rtol=0, atol=1e-14)


def test_a_moment_beside_the_tip_is_refused() -> None:
    text = poke(0.5).replace("force = [0.5, -0.3, -1.2]", "moment = [0.0, 0.0, 0.1]")
    with pytest.raises(SceneError, match="does not act on tubes beside their tips"):
        parse_scene(ONE.replace("CURVATURE", "9.0").replace("STRAIGHT", "0.3") + text)


def test_a_tube_in_its_housing_twists_there() -> None:
    text = ONE.replace("CURVATURE", "0.0").replace("STRAIGHT", "0.3")
    found = solve(parse_scene(text + wrench(moment=[0.0, 0.0, 0.02])))
    # Straight, and twisted from the drive to the tip.
    assert_allclose(found.tip().position, [0.0, 0.0, 0.2], rtol=0, atol=1e-14)
    assert_allclose(found.angles[0], 0.02 / 0.04 * 0.5, rtol=1e-12, atol=0)


@pytest.mark.slow
def test_aligned_tubes_are_a_rod_of_their_summed_stiffness() -> None:
    tubes = ONE.replace("CURVATURE", "9.0").replace("STRAIGHT", "0.0")
    # Of one shape, and of one ratio of torsion to bending: they twist alike.
    other = (
        tubes.partition("[[tubes]]")[2].replace('"tube"', '"other"').replace("0.05,", "0.1,").replace("0.04", "0.08")
    )
    load = wrench(force=[0.5, -0.9, -1.2])
    found = solve(parse_scene(tubes + "[[tubes]]" + other + load))
    summed = ROD.replace("CURVATURE", "9.0").replace("0.05,", "0.15,").replace("0.04 }", "0.12 }")
    rod = solve(parse_scene(summed + load))
    assert_allclose(found.tip("tube").position, rod.tip("tube").position, rtol=0, atol=1e-8)
    assert_allclose(found.angles[0], found.angles[1], rtol=0, atol=1e-10)


@pytest.mark.parametrize(("share", "falling"), [(1 - 1e-5, 0), (1 + 1e-5, 2), (9 - 1e-3, 2), (9 + 1e-3, 4)])
def test_a_straight_tube_buckles_at_eulers_load(share: float, falling: int) -> None:
    euler = np.pi**2 * 0.05 / (4 * 0.2**2)
    text = ONE.replace("CURVATURE", "0.0").replace("STRAIGHT", "0.1")
    robot = robot_of(parse_scene(text + wrench(force=[0.0, 0.0, -share * euler])))
    model = LoadedTubeModel(robot, 16)
    straight = np.array([0.0, 1.0, 0.0, 0.0, 0.0])
    found = solution_near(model, robot.inputs, straight)
    assert_allclose(found.x, straight, rtol=0, atol=1e-14)
    # It buckles to all sides alike: in two independent directions.
    assert found.stability.falling == falling
    assert found.stable == (falling == 0)


@pytest.mark.slow
def test_order_eight() -> None:
    scene = parse_scene(weighed(THREE) + PUSH + POKE + WEIGHT)
    robot = robot_of(scene)
    tips = []
    for steps in (3, 6, 12):
        found = solve_at(LoadedTubeModel(robot, steps), robot.inputs)
        tips.append(found.tip().position)
    rate = np.log2(np.abs(tips[0] - tips[2]).max() / np.abs(tips[1] - tips[2]).max())
    assert 7.0 < rate < 10.0


def test_derivatives_of_energy_and_tips() -> None:
    found = solve(parse_scene(weighed(TWO) + PUSH + WEIGHT))
    robot = found.robot
    for index, name in enumerate(robot.columns):
        ahead = moved(found, index, DIFFERENCE)
        behind = moved(found, index, -DIFFERENCE)
        assert ahead.converged
        assert behind.converged
        check_tips(found, index, ahead, behind, 2e-6)
        rate = (ahead.energy - behind.energy) / (2 * DIFFERENCE)
        if name.endswith(".rotation"):
            # The drive's torque is what the plate takes from the tube.
            tube = robot.names.index(name.removesuffix(".rotation"))
            assert_allclose(rate, -found.shape.torques[0, tube], rtol=0, atol=1e-7)
        if name.startswith("push.force"):
            # A dead force does its work on the tip.
            axis = "xyz".index(name[-1])
            assert_allclose(rate, -found.tip("inner").position[axis], rtol=0, atol=1e-8)


FOLLOW = PUSH.replace('"push"', '"follow"') + 'moment = [0.05, 0.02, -0.06]\nframe = "body"\n'

TWIST = POKE.replace('"poke"', '"twist"').replace("force", "moment").replace("[-0.1, 0.4, 0.2]", "[0.03, -0.05, 0.08]")


@pytest.mark.parametrize("loads", [WEIGHT + TWIST, FOLLOW + TWIST + WIND], ids=["dead", "follower"])
def test_the_jacobian_is_that_of_the_residual(loads: str) -> None:
    """By hand as by CasADi, at any x: a quaternion needs no norm of one, and nothing needs balance."""
    model = LoadedTubeModel(robot_of(parse_scene(weighed(TWO) + loads)), 2)
    symbols = [ca.MX.sym(f"x{i}", model.path_jacobian.size1_in(i)) for i in range(3)]
    differentiated = ca.Function("d", symbols, [ca.jacobian(model.path_residual(*symbols), symbols[0])])
    x = np.random.default_rng(5).standard_normal(model.size)
    at = (x, model.robot.inputs, 0.7)
    assert_allclose(model.path_jacobian(*at).full(), differentiated(*at).full(), rtol=0, atol=1e-13)
    jacobian, residual = model.jacobian(*at[:2])
    assert_allclose(jacobian.full(), model.path_jacobian(*at[:2], 1.0).full(), rtol=0, atol=1e-15)
    assert_allclose(residual.full(), model.path_residual(*at[:2], 1.0).full(), rtol=0, atol=1e-15)


def test_the_rate_of_a_path_is_that_of_differences() -> None:
    """Of inputs and load factor together, as a path of rods has it."""
    model = LoadedTubeModel(robot_of(parse_scene(TWO + PUSH)), 2)
    random = np.random.default_rng(6)
    x, inputs_rate = random.standard_normal(model.size), 0.1 * random.standard_normal(model.robot.inputs.size)
    ahead, behind = (
        model.path_residual(x, model.robot.inputs + step * inputs_rate, 0.7 + 0.3 * step).full()
        for step in (DIFFERENCE, -DIFFERENCE)
    )
    rate = model.path_rate(x, model.robot.inputs, 0.7, inputs_rate, 0.3)
    assert_allclose(rate.full(), (ahead - behind) / (2 * DIFFERENCE), rtol=0, atol=1e-8)


def test_moments_about_the_plate_balance() -> None:
    found = solve(parse_scene(TWO + PUSH + POKE))
    at_tips, _ = forces_of(found)
    arms = [found.tip(name).position for name in found.robot.names]
    moment = np.cross(arms, at_tips).sum(axis=0)
    assert_allclose(found.shape.torques[0].sum(), moment[2], rtol=0, atol=1e-10)


def test_without_force_the_loaded_model_is_the_other_one() -> None:
    found = solve(parse_scene(TWO + PUSH), {"push.force": [0.0, 0.0, 0.0]})
    plain = solve(parse_scene(TWO))
    assert_allclose(found.angles, plain.x, rtol=0, atol=1e-8)
    assert_allclose(found.tip().position, plain.tip().position, rtol=0, atol=1e-9)
    assert_allclose(found.energy, plain.energy, rtol=1e-8, atol=0)
    assert_allclose(found.stability.determinant, plain.stability.determinant, rtol=1e-6, atol=0)
    assert np.isfinite(found.tip_jacobian).all()


def test_tubes_without_loads_pay_nothing_for_them() -> None:
    model = solve(parse_scene(TWO)).model
    assert {name: computed(getattr(model, name)) for name in PLAIN} == PLAIN
    # Of what acts at a tip those do not pay for weight.
    sizes = []
    for load in (PUSH, PUSH + WEIGHT):
        loaded = LoadedTubeModel(robot_of(parse_scene(weighed(TWO) + load)), 4)
        sizes.append(computed(loaded._step.expand()))
    assert sizes == [5950, 6193]
    # Five directions by hand cost less than four steps more.
    changes = computed(tangent_step(2, 5, spread=False, follower=False).expand())
    assert changes < 5 * sizes[0]


PLAIN = {"residual": 239, "jacobian": 281, "tips": 435, "tip_jacobian": 590}
"""Instructions of a robot without loads that compute, no more than before there were any."""

COPIES = (ca.OP_GETNONZEROS, ca.OP_HORZREPMAT, ca.OP_NEG)
"""Instructions that copy or change signs: versions of CasADi differ in them."""


def computed(function: ca.Function) -> int:
    """Number of instructions without copies and signs."""
    return sum(function.instruction_id(k) not in COPIES for k in range(function.n_instructions()))


@pytest.mark.slow
def test_loaded_functions_in_c(tmp_path: Path) -> None:
    robot = robot_of(parse_scene(TWO + PUSH))
    found = solve_at(LoadedTubeModel(robot, 1), robot.inputs)
    check_functions_in_c(found, tmp_path, 0.01)
