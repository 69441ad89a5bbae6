"""Coils, and rods that loads roll up: paths, motions and inverse problems begin on modes that see their waves."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import (
    Outcome,
    Scene,
    SceneError,
    Solution,
    build,
    discretise,
    follow,
    inverse,
    scene_from_dict,
    simulate,
    solve,
)
from cosserat_casadi.accuracy.levels import SPARE_NODES, nodes_for_turn, verified_nodes
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.refine import FINER_MODES
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.control.inverse_levels import LevelsOfRods
from cosserat_casadi.equilibrium.blindness import TurnedElements
from cosserat_casadi.equilibrium.metrics import largest_turn, pose_distance
from cosserat_casadi.model.discrete_scene import Richer
from cosserat_casadi.model.discretise import nodes_for
from cosserat_casadi.model.element_ends import element_ends
from cosserat_casadi.motion.motion_refinement import ResolvedMotion, _Search
from tests.scenes import push, scene

PITCH = 0.126
"""Length of wire in a turn, m."""

DENSITY = 0.0246
"""Mass of the wire per length, kg/m."""

AREA_RADIUS = 5e-4
"""Radius of gyration of its sections about their diameters, m."""


def coil(turns: int, **changes: Any) -> dict[str, Any]:
    """A helical spring of steel wire, clamped at one end."""
    return {
        "name": "rod",
        "length": PITCH * turns,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 0.16, "bending_y": 0.16, "torsion": 0.124},
        "intrinsic": {"curvature": [0, 49.6, 4.34]},
        "base": {"position": [0, 0, 0], "quaternion": [0.03084, 0.706434, 0.706434, 0.03084]},
        **changes,
    }


def drawn(turns: int, force: list[float], tolerance: float, **changes: Any) -> Scene:
    """A coil with a force at its tip, N."""
    return scene(push(force=force), rods=[coil(turns)], accuracy={"tolerance": tolerance}, **changes)


def true_error(solution: Solution) -> float:
    """Distance of the tip from the tip on twice as many modes as waves along elements ask for, over the length."""
    turn = 2 * np.pi * solution.model.scene.rods[0].length / PITCH
    turn /= solution.model.discretisation["rod"].elements
    fine = build(
        solution.model.scene, discretise(solution.model.scene, int(turn) + 12, int(2.3 * turn) + 20, "magnus8")
    )
    reference = solve(fine, solution.inputs, estimate_error=False)
    assert reference.converged
    return pose_distance(solution, reference)


@pytest.mark.parametrize("modes", [25, 27])
def test_a_reference_tells_products_of_waves(modes: int) -> None:
    """The last modes tell 55 times too little of products of waves, which are shorter, and four more modes not all."""
    spring = drawn(5, [0.0, 0.0, 1.0], 1e-7)
    solution = solve(build(spring, discretise(spring, modes, 100, "magnus8")), estimate_error=False)
    true = true_error(solution)
    told = Resolution(Preview(solution), allowed=1e-7).modes_error
    assert 1e-8 < true < told < 2 * true


def test_turns_of_a_rolled_rod_are_those_unloaded_and_those_by_its_moment() -> None:
    """A moment adds two turns to the turn of a bent rod; one element has a quarter of its length."""
    bent = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    bent["intrinsic"] = {"curvature": [0.0, 2 * np.pi, 0.0]}
    roll = {"name": "roll", "kind": "tip_wrench", "rod": "rod", "moment": [0.0, 4 * np.pi, 0.0]}
    idle = push(force=[0.0, 0.0, 0.0]) | {"kind": "point_wrench", "at": 0.25}
    rolled = scene(roll, idle, rods=[bent], accuracy={"modes": 3, "nodes": 20})
    solution = solve(build(rolled))
    discrete = solution.model.discrete
    turns = TurnedElements(Richer(discrete, discrete)).turns_at(np.stack([0 * solution.x, solution.x]))
    assert_allclose(turns / (2 * np.pi), [[0.25, 0.75], [0.75, 2.25]], rtol=1e-6, atol=0)
    assert_allclose(largest_turn(solution), turns.max(), rtol=1e-6, atol=0)
    assert verified_nodes(rolled, 3, 0.0) - verified_nodes(scene(rods=[bent | {"intrinsic": {}}]), 3, 0.0) == 3
    assert verified_nodes(rolled, 3, turns.max()) > nodes_for_turn(3, turns.max())


def test_levels_see_turns_by_loads() -> None:
    """Eight turns by a moment ask for 28 modes of inverse problems, and for as many of motions, whose rods say none."""
    straight = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    roll = {"name": "roll", "kind": "tip_wrench", "rod": "rod", "moment": [0.0, 16 * np.pi, 0.0]}
    rolled = scene(roll, push(force=[3.0, 0.0, 0.0]), rods=[straight], accuracy={"tolerance": 1e-3})
    model = build(rolled, discretise(rolled, 6, 60, "magnus8"))
    levels = LevelsOfRods(rolled)

    def modes_after(solution: Solution, count: int) -> int:
        (modes,) = levels.finer(count, model, [solution]).discretisation["rod"].modes
        return modes

    assert modes_after(solve(model), 9) == 28
    # Five turns of a coil ask for 18.
    assert min(LevelsOfRods(drawn(5, [0.0, 0.0, 0.0], 1e-3)).first().discretisation["rod"].modes) >= 18
    still = solve(model, {"roll.moment": [0, 0, 0], "push.force": [0, 0, 0]})
    assert [modes_after(still, count) for count in (6, 12)] == [6 + FINER_MODES, 12]
    none = cast(Any, None)
    search = _Search(rolled, none, None, None, none, (), 1e-3, ladder=(6, 9, 21, 28, 36))
    search.levels.append(ResolvedMotion(none, none, none, rung=1, modes=9, distance=1e-9, turn=16 * np.pi))
    assert search.space_error == np.inf
    assert search.climb() == 3
    search.levels[-1] = ResolvedMotion(none, none, none, rung=1, modes=9, distance=1e-9, turn=100 * np.pi)
    assert search.climb() is None


def test_a_path_of_a_coil_knows_its_error() -> None:
    """Of five turns six and nine modes have no equilibrium to begin at."""
    path = follow(drawn(5, [0.0, 0.4, 0.0], 1e-2), "push.force", [0.0, 0.4, 0.0])
    assert path.converged
    assert path.error_estimate is not None
    assert true_error(path.solution(-1)) < path.error_estimate <= 1e-2


@pytest.mark.slow
def test_a_path_of_a_rod_that_a_moment_rolls_up_knows_its_error() -> None:
    """Twelve modes and sixteen see three fifths of their error along eight turns."""
    straight = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    moment = [0.0, 16 * np.pi, 0.0]
    roll = {"name": "roll", "kind": "tip_wrench", "rod": "rod", "moment": moment}
    rolled = scene(roll, push(force=[3.0, 0.0, 0.0]), rods=[straight], accuracy={"tolerance": 1e-3})
    path = follow(rolled, "roll.moment", moment)
    reference = follow(build(rolled, discretise(rolled, 40, 150, "magnus8")), "roll.moment", moment)
    assert path.error_estimate is not None
    assert pose_distance(path.solution(-1), reference.solution(-1)) < path.error_estimate <= 1e-3


def pulled(accuracy: dict[str, Any]) -> Scene:
    """A coil of three turns that is pulled across its axis and let go, within the period of its axial mode."""
    turns, period = 3, 0.0122
    half = [0.0, 1.67, 0.0]
    inertia = [DENSITY * AREA_RADIUS**2] * 2 + [2 * DENSITY * AREA_RADIUS**2]
    heavy = {"linear_density": DENSITY, "rotary_inertia": inertia, "damping": {"retardation_time": 0.02 * period}}
    wave = {"input": "push.force", "amplitude": half, "frequency": 1 / period, "wave": "one_minus_cosine"}
    return scene_from_dict(
        {
            "schema": 1,
            "rods": [coil(turns, **heavy)],
            "loads": [push(force=[0, 0, 0])],
            "accuracy": accuracy,
            "motions": [wave],
            "simulation": {"duration": period, "frames": 21, "start": "unloaded", "tolerance": 1e-2},
        }
    )


@pytest.mark.parametrize("accuracy", [{}, {"modes": 4, "nodes": 30}])
def test_a_motion_of_a_coil_knows_its_error(accuracy: dict[str, Any]) -> None:
    """Levels from six modes on told a fifth of their error along three turns, four modes and eight told less too."""
    motion = simulate(pulled(accuracy))
    reference = simulate(pulled({"modes": 18, "nodes": 46}))
    apart = np.linalg.norm(motion.tip().position - reference.tip().position, axis=1).max() / (3 * PITCH)
    assert reference.error_estimate < 2e-3
    assert apart < motion.error_estimate


def test_a_motion_within_one_turn_pays_for_no_turn() -> None:
    """A rod that a force bends by two radians moves on the intervals that its modes ask for."""
    rod = {"name": "rod", "length": 1.0, "strain": "planar", "damping": {"retardation_time": 0.1}}
    rod |= {"stiffness": {"bending_y": 1.0}, "linear_density": 1.0, "base": {"position": [0, 0, 0]}}
    bend = {"name": "bend", "kind": "tip_wrench", "rod": "rod", "force": [4.0, 0.0, 0.0]}
    simulation = {"duration": 2.0, "start": "unloaded", "tolerance": 1e-3}
    motion = simulate(scene(bend, rods=[rod], simulation=simulation))
    assert motion.converged, motion.message
    assert np.abs(motion.tip().position[:, 0]).max() > 0.8
    chosen = motion.model.discretisation["rod"]
    assert chosen.nodes == nodes_for(max(chosen.modes)) + SPARE_NODES


@pytest.mark.slow
def test_the_inverse_of_a_coil_knows_its_error() -> None:
    """Levels of six and nine modes do not resolve five turns."""
    unloaded = solve(drawn(5, [0.0, 0.0, 0.0], 1e-6))
    goal = unloaded.tip().position + np.array([2e-3, 1e-3, -1e-3])
    target = {"kind": "position", "rod": "rod", "position": goal.tolist()}
    found = inverse(drawn(5, [0.0, 0.0, 0.0], 1e-3, targets=[target], inputs=["push.force"]))
    assert found.met
    assert found.solution.error_estimate is not None
    assert true_error(found.solution) < found.solution.error_estimate <= 1e-3


@pytest.mark.slow
def test_an_equilibrium_of_twenty_five_turns_is_found() -> None:
    """They ask for 81 modes, more than the 64 of the finest level of other scenes."""
    found = solve(drawn(25, [0.4, 0.0, 0.0], 1e-3))
    assert found.converged
    assert found.error_estimate is not None
    assert true_error(found) < found.error_estimate <= 1e-3


def test_a_rod_of_many_turns_is_cut_into_equal_elements() -> None:
    """Elements of an unloaded rod turn at most twenty times."""
    assert element_ends(drawn(19, [0.0, 0.0, 0.0], 1e-3), "rod") == (0.0, 1.0)
    ends = element_ends(drawn(45, [0.0, 0.0, 0.0], 1e-3), "rod")
    assert_allclose(ends, [0.0, 0.25, 0.5, 0.75, 1.0], rtol=0, atol=1e-15)


def test_a_curvature_in_a_wrong_unit_is_told_at_once() -> None:
    with pytest.raises(SceneError, match=r"rods.rod.intrinsic: turns the rod about 1\.4e\+03 times"):
        element_ends(drawn(1400, [0.0, 0.0, 0.0], 1e-3), "rod")


@pytest.mark.slow
def test_an_equilibrium_of_forty_five_turns_is_found() -> None:
    """One element would ask for 144 modes."""
    found = solve(drawn(45, [0.2, 0.0, 0.0], 1e-3))
    assert found.converged, found.message
    assert found.error_estimate is not None
    assert true_error(found) < found.error_estimate <= 1e-3


def test_windings_that_no_level_resolves_say_what_they_ask_for() -> None:
    """A cable that winds sixty times round an element asks for 193 modes."""
    rod = {"name": "rod", "length": 0.3, "strain": "kirchhoff", "base": {"position": [0, 0, 0]}}
    rod["stiffness"] = {"bending_x": 6e-3, "bending_y": 6e-3, "torsion": 5e-3}
    helix = {"radius": 7e-3, "turns": 60.0}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 4.0, "helix": helix}
    found = solve(scene(rods=[rod], actuators=[cable], accuracy={"tolerance": 1e-3}))
    assert found.outcome is Outcome.UNRESOLVED
    assert "ask for more than 193 modes" in found.message
