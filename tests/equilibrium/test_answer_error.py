"""The error of an answer at inputs that its modes were not chosen for."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, Solution, build, discretise, read_scene, scene_from_dict, solve
from cosserat_casadi.equilibrium import answer_error as estimates
from cosserat_casadi.equilibrium.metrics import cable_distance, pose_distance, prolong
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discretise import summed_at
from cosserat_casadi.model.watched import SAMPLES
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.strain_density import energy_beyond_hooke, stiffness_beyond_hooke
from tests.conftest import AWAY, ROOT
from tests.families import mostly_slow
from tests.model.test_material_laws import CIRCLE, LENGTH, RADIUS, E, loaded, rod
from tests.pose_errors import pose_error
from tests.scenes import push, scene
from tests.shooting_near import shoot

MOST_ABOVE = 3.0
"""Most that an estimate may be above the true error."""

LEAST = 0.7
"""Least share of the true error that an estimate may be."""


TAPERED = {
    "name": "rod",
    "length": 0.4,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1000.0},
    "section": {"shape": "circle", "radius": [3e-3, 2e-3]},
}


def true_error(solution: Solution) -> float:
    """Distance to the equilibrium on ten modes and as many intervals more, which is converged to rounding beside it."""
    model = solution.model
    most = max(max(chosen.modes) for chosen in model.discretisation.values()) + 10
    nodes = max(chosen.nodes for chosen in model.discretisation.values()) + 20
    finer = build(model.scene.baked(), discretise(model.scene, most, nodes, "magnus8"))
    reference = solve(finer, solution.inputs, start=prolong(solution, finer), estimate_error=False)
    assert reference.converged
    return max(pose_distance(solution, reference), cable_distance(solution, reference))


def assert_estimated(solution: Solution) -> None:
    assert solution.converged
    assert solution.error_estimate is not None
    ratio = solution.error_estimate / true_error(solution)
    assert LEAST < ratio < MOST_ABOVE, ratio


@pytest.fixture(scope="module")
def tendon_robot() -> Model:
    read = read_scene(AWAY / "tendon_robot.toml")
    return build(read, solve(read).model.discretisation)


@pytest.mark.parametrize(
    "values",
    [
        {"north.tension": 9.0, "east.tension": 0.5},
        {"payload.force": [0.0, 0.5, 0.0]},
        pytest.param({"payload.force": [0.0, 2.0, 0.0]}, marks=pytest.mark.slow),
    ],
)
def test_modes_of_a_planar_load_know_their_error_under_others(tendon_robot: Model, values: dict[str, Any]) -> None:
    moved = solve(tendon_robot, values)
    assert_estimated(moved)
    assert moved.within_tolerance is False
    assert f"{moved.error_estimate:.2g} of the length" in moved.message
    assert "0.0001" in moved.message


def test_answers_at_the_inputs_of_the_choice_are_within_the_tolerance(tendon_robot: Model) -> None:
    chosen = solve(tendon_robot)
    assert_estimated(chosen)
    assert chosen.within_tolerance is True
    assert "tolerance of" not in chosen.message


@pytest.mark.slow
def test_a_grip_beside_the_plane_of_the_choice() -> None:
    read = read_scene(ROOT / "examples" / "tendon_finger.toml")
    model = build(read, solve(read).model.discretisation)
    aside = solve(model, {"grip.force": [0.0, 0.025, -0.05]})
    assert_estimated(aside)
    assert aside.error_estimate is not None
    assert aside.error_estimate > 1e3 * read.accuracy.tolerance


@pytest.mark.parametrize("seed", mostly_slow(range(3), quick=[0]))
def test_robot_of_six_tendons(seed: int) -> None:
    read = read_scene(AWAY / "six_tendons.toml")
    # Those that the robot takes at its own inputs.
    model = build(read, discretise(read, (1, 2, 1), 3, "magnus4"))
    tensions = np.random.default_rng(seed).uniform(0, 8, 6)
    away = solve(model, {f"t{i + 1}.tension": tension for i, tension in enumerate(tensions)})
    assert_estimated(away)
    assert away.within_tolerance is False


@pytest.mark.slow
def test_platform_that_its_modes_lock() -> None:
    read = read_scene(AWAY / "platform_locks.toml")
    locked_platform = build(read, discretise(read, (2, 2, 1), 4, "magnus4"))
    pushed = solve(locked_platform, {"load.force": [3.0, 2.0, 0.0]})
    still = solve(locked_platform, estimate_error=False)
    # As many constraints as coordinates that move: it stays where it is.
    assert_allclose(pushed.body().position, still.body().position, rtol=0, atol=1e-10)
    assert pushed.error_estimate is not None
    assert 1.0 < pushed.error_estimate / true_error(pushed) < 1.5
    assert pushed.within_tolerance is False


@pytest.mark.parametrize(("tension", "height"), [(11.3, -0.0703), (5.17, -0.0356)])
def test_a_wall_is_no_chance_for_missing_modes_to_settle(tension: float, height: float) -> None:
    # Elastic steps know nothing of the bar: the missing modes bounce, and the first look is 9 times too small.
    read = read_scene(ROOT / "examples" / "reach_past_bar.toml", ["accuracy.tolerance=2e-3"])
    model = build(read, discretise(read, 1, 2, "magnus6"))
    pressed = solve(model, {"flexor.tension": tension, "robot.base.position": [0.0, 0.0, height]})
    assert_estimated(pressed)
    assert pressed.within_tolerance is False


def test_a_sweep_behind_one_that_bounces_is_not_believed() -> None:
    """Two sweeps agree to a twentieth, at half of the error; the first one bounces."""
    read = read_scene(ROOT / "examples" / "reach_past_bar.toml", ["accuracy.tolerance=1e-3"])
    model = build(read, summed_at(discretise(read, 1, 2, "magnus6"), 31))
    pressed = solve(model, {"flexor.tension": 5.7, "robot.base.position": [0.0, 0.0, -0.034]})
    assert_estimated(pressed)
    assert pressed.within_tolerance is False


def test_estimate_of_a_rod_beside_shooting() -> None:
    """Shooting integrates the rod's equations by Runge and Kutta: it has no modes."""
    pushed = scene(push(force=[3.0, 2.0, -1.0], moment=[0.0, 0.5, 0.3]))
    for modes in (2, 3, 4, 5):
        solution = solve(build(pushed, discretise(pushed, modes, 2 * modes + 4)))
        truth = shoot(solution, [1.0])
        tip = solution.tip()
        error = pose_error((tip.position, tip.rotation), (truth.position[0], truth.rotation[0]), truth.length)
        assert solution.error_estimate is not None
        assert LEAST * error < solution.error_estimate < MOST_ABOVE * error


def test_estimate_falls_as_fast_as_the_error() -> None:
    pushed = scene(push(force=[3.0, 2.0, -1.0]), rods=[TAPERED])
    ratios = []
    for modes in (2, 4, 6, 8):
        solution = solve(build(pushed, discretise(pushed, modes, 2 * modes + 6)))
        assert solution.error_estimate is not None
        ratios.append(solution.error_estimate / true_error(solution))
    assert max(ratios) < MOST_ABOVE
    assert min(ratios) > LEAST
    assert solution.error_estimate < 1e-6


def test_wrench_at_the_clamp_knows_its_error() -> None:
    """A soft foundation lets the moment decay near the clamp: poses are right long before it is."""
    read = read_scene(AWAY / "foundation.toml")
    coarse = solve(build(read, discretise(read, 5, 14)))
    fine = solve(build(read, discretise(read, 16, 40)), estimate_error=False)
    wanted = fine.base_wrench()
    found = coarse.base_wrench()
    moment_error = np.linalg.norm(found.moment - wanted.moment) / np.linalg.norm(wanted.moment)
    force_error = np.linalg.norm(found.force - wanted.force) / np.linalg.norm(wanted.force)
    true = max(moment_error, force_error)
    assert coarse.wrench_error_estimate is not None
    assert LEAST * true < coarse.wrench_error_estimate < MOST_ABOVE * true


def spring(turns: int = 5, force: float = 4.0) -> Scene:
    """A helical spring, drawn out by a force along its axis, N."""
    wire = {
        "name": "rod",
        "length": 0.126 * turns,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 0.16, "bending_y": 0.16, "torsion": 0.124},
        "intrinsic": {"curvature": [0, 49.6, 4.34]},
        "base": {"position": [0, 0, 0], "quaternion": [0.03084, 0.706434, 0.706434, 0.03084]},
    }
    return scene(push(force=[force, 0.0, 0.0]), rods=[wire], accuracy={"tolerance": 1e-9})


def test_intervals_of_the_highest_order_know_their_error() -> None:
    """No higher order shows the error of the order, so that the richer model has a quarter more intervals."""
    drawn = spring()
    solution = solve(build(drawn, discretise(drawn, 42, 80, "magnus8")))
    reference = solve(build(drawn, discretise(drawn, 42, 160, "magnus8")), estimate_error=False)
    assert solution.error_estimate is not None
    ratio = solution.error_estimate / pose_distance(solution, reference)
    assert LEAST < ratio < MOST_ABOVE, ratio


def test_shape_knows_the_error_of_modes_that_even_the_richer_model_lacks() -> None:
    """The shape waves between the ends of the spring, with a hundred times the error of the tip."""
    drawn = spring()
    solution = solve(build(drawn, discretise(drawn, 27, 84, "magnus8")))
    reference = solve(build(drawn, discretise(drawn, 44, 100, "magnus8")), estimate_error=False)
    assert solution.shape_error_estimate is not None
    ratio = solution.shape_error_estimate / pose_distance(solution, reference, SAMPLES)
    assert LEAST < ratio < MOST_ABOVE, ratio


@pytest.mark.parametrize(("turns", "force", "modes", "finer"), [(5, 4.0, 25, 44), (10, 0.3, 15, 76)])
def test_coils_put_waves_and_their_products_into_modes_that_an_answer_lacks(
    turns: int, force: float, modes: int, finer: int
) -> None:
    """Coils wave up to a degree of π times their turns, products of waves up to twice that: three modes see neither."""
    drawn = spring(turns, force)
    solution = solve(build(drawn, discretise(drawn, modes, 15 * turns, "magnus8")))
    reference = solve(build(drawn, discretise(drawn, finer, 20 * turns, "magnus8")), estimate_error=False)
    assert solution.error_estimate is not None
    assert 1.0 < solution.error_estimate / pose_distance(solution, reference) < MOST_ABOVE


def rolled_up(force: float) -> Scene:
    """A planar rod that a moment rolls into three turns, with a force at its tip."""
    straight = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    return scene(push(force=[force, 0, 0], moment=[0, 6 * np.pi, 0]), rods=[straight])


def test_modes_that_are_blind_to_what_loads_roll_up_do_not_know_their_error() -> None:
    """Of four modes and three more the tip sees a hundredth of its error; a circle has none that could be missed."""
    pulled, circle = (solve(build(rolled_up(force), discretise(rolled_up(force), 4, 24))) for force in (1.0, 0.0))
    seen = solve(build(rolled_up(1.0), discretise(rolled_up(1.0), 12, 24, "magnus8")))
    assert pose_distance(pulled, seen) > 1e-3
    assert pulled.error_estimate == estimates.UNKNOWN
    assert pulled.within_tolerance is False
    assert seen.error_estimate is not None and circle.error_estimate is not None
    assert pose_distance(seen, solve(rolled_up(1.0))) < seen.error_estimate < 1e-4
    assert circle.error_estimate < 1e-10


def test_levels_in_contact_are_blind_to_what_loads_roll_up_as_well() -> None:
    """Of six turns the levels of five and seven modes see a fiftieth of their error; the obstacle is far off."""
    far = {"name": "far", "kind": "sphere", "centre": [0.0, 0.0, 9.0], "radius": 0.1}
    bending = {"youngs_modulus": 4e8 / np.pi, "poisson_ratio": 0.4}
    round_one = {"material": bending, "section": {"shape": "circle", "radius": 1e-2}}
    straight = {"name": "rod", "length": 1.0, "strain": "planar", **round_one}
    rolling = push(force=[3.0, 0.0, 0.0], moment=[0.0, 12 * np.pi, 0.0])
    found, alone = (
        solve(scene(rolling, rods=[straight], obstacles=obstacles, accuracy={"tolerance": tolerance}))
        for obstacles, tolerance in (([far], 1e-3), ([], 1e-6))
    )
    assert found.error_estimate is not None
    assert pose_distance(found, alone) < found.error_estimate <= 1e-3


def test_levels_in_contact_go_as_far_as_coils_ask() -> None:
    """Five and seven modes of ten turns have no equilibrium; the obstacle is far off."""
    far = {"name": "far", "kind": "sphere", "centre": [0.0, 0.0, 9.0], "radius": 0.1}
    round_one = {
        "material": {"youngs_modulus": 2e11, "poisson_ratio": 0.29},
        "section": {"shape": "circle", "radius": 1e-3},
    }
    coiled = {"intrinsic": {"curvature": [0, 49.6, 4.34]}}
    wire = {"name": "rod", "length": 1.26, "strain": "kirchhoff", **round_one, **coiled}
    drawn = push(force=[0.3, 0.0, 0.0])
    found, alone = (
        solve(scene(drawn, rods=[wire], obstacles=obstacles, accuracy={"tolerance": tolerance}))
        for obstacles, tolerance in (([far], 1e-3), ([], 1e-5))
    )
    assert found.error_estimate is not None
    assert pose_distance(found, alone) < found.error_estimate + 1e-5 < 1e-3


@pytest.mark.parametrize(
    ("modes", "nodes", "length", "velocity"),
    [((7, 7, 1), 10, 0.6, [0.285, -0.249, -0.123]), ((5, 5, 1), 12, 0.594, [0.296, -0.161, 0.136])],
)
def test_a_stream_along_a_longer_rod_takes_more_intervals_and_sweeps(
    modes: tuple[int, ...], nodes: int, length: float, velocity: list[float]
) -> None:
    """Its drag has a kink where it lies along the stream; of the second the watched tip settles before modes rest."""
    read = read_scene(ROOT / "examples" / "rod_in_stream.toml", ['inputs=["rod.length", "water.velocity"]'])
    model = build(read, discretise(read, modes, nodes))
    longer = solve(model, {"rod.length": length, "water.velocity": velocity})
    assert longer.error_estimate is not None
    assert 1.0 <= longer.error_estimate / true_error(longer) < MOST_ABOVE


def test_parameters_move_the_stiffness_of_missing_modes() -> None:
    bent = scene(push(), rods=[TAPERED], parameters=["rod.material.youngs_modulus"])
    model = build(bent, discretise(bent, 3, 10))
    softer = solve(model, parameters={"rod.material.youngs_modulus": 0.7e9})
    assert_estimated(softer)


def test_a_first_look_leaves_room_for_what_a_second_adds() -> None:
    """The second sweep makes the change of a heavier soft arm one and a half times that of the first."""
    changes = ["accuracy.tolerance=2e-4", "arm.material.density=1512.0"]
    arm = read_scene(ROOT / "examples" / "soft_arm.toml", changes)
    heavier = solve(build(arm, discretise(arm, [1, 3, 2, 2, 1, 1], 4)))
    assert heavier.within_tolerance
    assert heavier.error_estimate is not None
    assert 1.0 <= heavier.error_estimate / true_error(heavier) < MOST_ABOVE


def test_error_that_no_correction_settles_near_counts_as_the_whole_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(estimates, "MOST_SWEEPS", 1)
    monkeypatch.setattr(estimates, "MOST_STEPS", 1)
    read = read_scene(AWAY / "tendon_robot.toml")
    model = build(read, discretise(read, (1, 3, 1), 4))
    away = solve(model, {"payload.force": [0.0, 2.0, 0.0]})
    assert away.error_estimate == estimates.UNKNOWN
    assert away.within_tolerance is False
    assert "Its error is not known" in away.message


def test_tolerance_that_nobody_wrote_asks_nothing_of_fixed_modes() -> None:
    fixed = scene(push(force=[3.0, 2.0, -1.0]), accuracy={"modes": 2, "nodes": 6})
    solution = solve(build(fixed))
    assert solution.error_estimate is not None
    assert solution.error_estimate > fixed.accuracy.tolerance
    assert solution.within_tolerance is None
    asked = scene(push(force=[3.0, 2.0, -1.0]), accuracy={"modes": 2, "nodes": 6, "tolerance": 1e-6})
    assert solve(build(asked)).within_tolerance is False


def test_no_estimate_where_none_is_wanted_or_nothing_was_solved() -> None:
    pushed = scene(push(force=[3.0, 2.0, -1.0]))
    model = build(pushed, discretise(pushed, 4))
    assert solve(model, estimate_error=False).error_estimate is None
    failed = solve(model, {"push.force": [1e9, 0.0, 0.0]})
    assert not failed.converged
    assert failed.error_estimate is None
    assert failed.within_tolerance is False


def test_answers_in_exact_contact_know_their_error() -> None:
    read = read_scene(ROOT / "examples" / "rod_over_bar.toml")
    coarse = solve(build(read, discretise(read, 3, 10)))
    reference = solve(read)
    assert coarse.error_estimate is not None
    assert coarse.error_estimate > LEAST * pose_distance(coarse, reference)


def gripper(length: float) -> dict[str, Any]:
    """Tables of two upright rods that hold a body at their tips, one of them with a tendon."""
    other = {**TAPERED, "name": "other", "base": {"position": [0.1, 0, 0]}}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 3.0, "offset": [4e-3, 0]}
    ties: list[dict[str, Any]] = [
        {"rod": "rod", "body": "hand", "kind": "fixed"},
        {"rod": "other", "body": "hand", "kind": "spherical", "position": [0.1, 0, 0]},
    ]
    return {
        "schema": 1,
        "rods": [{**TAPERED, "length": length}, {**other, "length": length}],
        "bodies": [{"name": "hand", "mass": 0.01}],
        "joints": ties,
        "actuators": [cable],
        "loads": [{"name": "pull", "kind": "body_wrench", "body": "hand", "force": [1.0, 0.6, 0]}],
    }


@pytest.mark.parametrize("kind", ["parameters", "inputs"])
def test_errors_are_over_the_length_that_a_rod_has(kind: str) -> None:
    lengths = ["rod.length", "other.length"]
    named = lengths if kind == "parameters" else [*lengths, "cable.tension"]
    moved = scene_from_dict({**gripper(0.4), "inputs": ["cable.tension"], kind: named})
    values = dict.fromkeys(lengths, 0.15)
    model = build(moved, discretise(moved, 3, 10))
    solution = solve(model, parameters=values) if kind == "parameters" else solve(model, values)
    short = scene_from_dict(gripper(0.15))
    same = solve(build(short, discretise(short, 3, 10)))
    # Tips, the body and the cable over the length that the rods have, and a distance between two answers likewise.
    assert_allclose(*(one.model.watched(one.x, one.inputs).full() for one in (solution, same)), rtol=0, atol=1e-6)
    bent = solve(solution.model, {**values, "cable.tension": 6.0} if kind == "inputs" else {"cable.tension": 6.0})
    bent_same = solve(same.model, {"cable.tension": 6.0})
    assert_allclose(pose_distance(solution, bent), pose_distance(same, bent_same), rtol=1e-4, atol=0)
    assert_allclose(cable_distance(solution, bent), cable_distance(same, bent_same), rtol=1e-4, atol=0)
    assert_allclose(solution.shape_error_estimate, same.shape_error_estimate, rtol=1e-2, atol=0)
    assert_estimated(solution)


def stiffened(strain: Any, force: float) -> Scene:
    """A rod that its tip force, in units of EI/ℓ², strains so far that it is several times as stiff as unloaded."""
    bending = E * np.pi * RADIUS**4 / 4
    terms = [{"bending_y": 4, "coefficient": 0.3 * bending * LENGTH**2}]
    if "extension" in strain:
        terms.append({"bending_y": 2, "extension": 1, "coefficient": bending})
    table = rod({"law": "polynomial", "terms": terms}, CIRCLE, strain)
    return loaded(table, force=[force * bending / LENGTH**2, 0, 0])


@pytest.mark.parametrize("strain", ["planar", ["bending_y", "extension"]])
def test_sweeps_know_the_stiffness_of_strained_laws(strain: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """C has sweeps alone: by the stiffness of the unloaded rod they would not contract."""
    monkeypatch.setattr(estimates, "_newton_steps", lambda _: iter(()))
    strained = stiffened(strain, 6.0)
    coarse, fine = (solve(build(strained, discretise(strained, *sizes))) for sizes in ((3, 10), (10, 20)))
    assert coarse.converged and fine.converged and coarse.error_estimate is not None
    assert 0.75 * coarse.error_estimate < pose_distance(coarse, fine) < coarse.error_estimate


def test_stiffness_of_strained_laws_is_a_derivative() -> None:
    strained = stiffened(["bending_y", "extension"], 6.0)
    richer = build(strained, discretise(strained, 3, 10)).discrete.richer
    own = richer.discrete.rods["rod"]
    q = ca.MX.sym("q", own.size)
    energy = energy_beyond_hooke(shape(own, q))
    stiffness = stiffness_beyond_hooke(shape(own, q))
    assert energy is not None and stiffness is not None
    v = np.random.default_rng(1).normal(size=own.size)
    hessian = ca.hessian(energy.value, q)[0] / own.energy_unit
    given = [hessian, stiffness.diagonal, stiffness.times(ca.DM(v))]
    whole, diagonal, product = (one.full() for one in ca.Function("K", [q], given)(0.5 * v))
    assert_allclose(diagonal[:, 0], np.diag(whole), rtol=1e-10, atol=0)
    assert_allclose(product[:, 0], whole @ v, rtol=0, atol=1e-10 * np.abs(product).max())
