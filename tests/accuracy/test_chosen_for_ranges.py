"""One discretisation for ranges of inputs: which ranges are taken, and that the tolerance holds all over them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, discretise, parse_scene, solve
from cosserat_casadi.accuracy.choose import Choice, choose
from cosserat_casadi.accuracy.ranges import Origin, input_ranges
from cosserat_casadi.equilibrium.locking import degrees_of_freedom
from cosserat_casadi.equilibrium.metrics import pose_distance, prolong
from cosserat_casadi.scene.writing import scene_text
from tests.contact.test_smooth_contact import ON_A_BAR
from tests.scenes import STIFFNESS, WEIGHT, push, rod, scene


def ends(ranged: object) -> dict[str, tuple[float, float, Origin]]:
    """Lower and upper end and origin by column."""
    taken = input_ranges(ranged)  # type: ignore[arg-type]
    return {
        column: (float(taken.lower[k]), float(taken.upper[k]), taken.origins[k])
        for column, k in taken.layout.columns.items()
    }


def test_a_force_reaches_as_far_as_it_turns_a_clamped_rod_by_a_radian() -> None:
    """F = 2 EI/ℓ² in every direction, by the softest one; a thrust turns nothing by itself."""
    found = ends(scene(push(force=[0.0, 0.0, 0.0])))
    assert STIFFNESS["bending_x"] < STIFFNESS["bending_y"]
    force = 2 * STIFFNESS["bending_x"] / 0.8**2
    for column in ("push.force.x", "push.force.y", "push.force.z"):
        low, high, origin = found[column]
        assert_allclose([low, high], [-force, force], rtol=1e-9, atol=0)
        assert origin is Origin.TURN


def test_in_a_loop_a_force_bends_the_softest_rod_by_a_radian() -> None:
    """No load turns the rods of an unloaded loop, whose joints close along the load path."""
    legs = [rod(name="a"), rod(name="b", base={"position": [0.3, 0, 0]}, length=1.0)]
    joints = [
        {"rod": name, "body": "plate", "kind": "fixed", "position": [x, 0, 0]} for name, x in (("a", 0), ("b", 0.3))
    ]
    load = {"name": "load", "kind": "body_wrench", "body": "plate", "force": [0, 0, 0]}
    found = ends(scene(load, rods=legs, joints=joints, bodies=[{"name": "plate"}], inputs=["load.force", "a.length"]))
    energy_unit = build(scene(rods=[rod(name="b", length=1.0)])).discrete.rods["b"].energy_unit
    assert_allclose(found["load.force.x"][:2], [-2 * energy_unit, 2 * energy_unit], rtol=1e-9, atol=0)
    assert_allclose(found["a.length"][:2], [0.72, 0.88], rtol=1e-12, atol=0)


def test_tensions_begin_at_zero_and_gravity_keeps_its_size() -> None:
    """A tension T at an offset r turns a rod by T r ℓ / EI."""
    tendon = {"name": "east", "kind": "tendon", "rod": "rod", "tension": 1.0, "offset": [0.01, 0.0]}
    found = ends(scene(WEIGHT, actuators=[tendon], inputs=["east.tension", "weight.acceleration", "rod.length"]))
    by_turn = STIFFNESS["bending_y"] / (0.01 * 0.8)
    assert_allclose(found["east.tension"][:2], [0.0, 1.0 + by_turn], rtol=1e-9, atol=0)
    size = float(np.linalg.norm(WEIGHT["acceleration"]))
    assert_allclose(found["weight.acceleration.x"][:2], [-size, size], rtol=1e-12, atol=0)
    assert found["weight.acceleration.x"][2] is Origin.GRAVITY
    assert_allclose(found["rod.length"][:2], [0.72, 0.88], rtol=1e-12, atol=0)


def test_what_is_asked_for_goes_before_the_table_and_that_before_bounds() -> None:
    bounds = [
        {"input": "push.force", "lower": -3.0, "upper": 3.0},
        {"input": "weight.acceleration", "lower": -2, "upper": 2},
    ]
    ranged = scene(push(), WEIGHT, ranges={"push.force": [-1, 1]}, bounds=bounds)
    taken = input_ranges(ranged, {"push.force.x": (-0.5, 0.25)})
    assert taken.described == (
        "push.force.x=-0.5:0.25",
        "push.force.y=-1:1",
        "push.force.z=-1:1",
        "weight.acceleration.x=-2:2",
        "weight.acceleration.y=-2:2",
        "weight.acceleration.z=-2:2",
    )
    assert taken.origins == (Origin.ASKED, Origin.RANGES, Origin.RANGES, Origin.BOUNDS, Origin.BOUNDS, Origin.BOUNDS)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"push.force.x": (1, 1)}, "two different ends"),
        ({"push.force.x": (1, -1)}, "the lower end first"),
        ({"push.force.x": (0, np.nan)}, "two finite ends"),
        ({"pull.force.x": (0, 1)}, "is not an input or a parameter"),
        ({"push.force": [(0, 1), (0, 1)]}, "must have 1 pair or 3 of ends"),
    ],
)
def test_a_range_that_is_asked_for_is_refused_where(asked: dict[str, object], sentence: str) -> None:
    with pytest.raises(SceneError, match=sentence):
        input_ranges(scene(push()), asked)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def chosen() -> Choice:
    """For forces in all directions, of a scene whose own force bends the rod in a plane."""
    return choose(scene(push(force=[0.4, 0.0, 0.0]), accuracy={"tolerance": 1e-3}), {"push.force": (-2.0, 2.0)})


def test_the_tolerance_holds_all_over_the_ranges(chosen: Choice) -> None:
    """At corners and at random points, against finer modes; the scene's own inputs would do with fewer."""
    assert chosen.met
    assert not chosen.without_equilibrium
    fine = build(chosen.scene, discretise(chosen.scene, 12, 28, "magnus8"))
    random = np.random.default_rng(5)
    for force in ([2.0, 2.0, -2.0], [-2.0, 2.0, 2.0], *random.uniform(-2, 2, (6, 3))):
        coarse = solve(chosen.model, {"push.force": force}, estimate_error=False)
        assert pose_distance(coarse, solve(fine, {"push.force": force}, estimate_error=False)) <= 1e-3
    own = solve(scene(push(force=[0.4, 0.0, 0.0]), accuracy={"tolerance": 1e-3}))
    assert own.model.size < chosen.model.size


def test_the_scene_says_what_was_chosen_for_which_ranges(chosen: Choice) -> None:
    """Those that were asked for, not those of the points; a second choice verifies the same modes over the same."""
    assert chosen.scene.accuracy.chosen_for == tuple(f"push.force.{axis}=-2:2" for axis in "xyz")
    again = parse_scene(scene_text(chosen.scene))
    assert again == chosen.scene
    verified = choose(again)
    assert verified.met
    assert verified.ranges.described == chosen.ranges.described
    assert verified.model.discretisation == chosen.model.discretisation


def test_beyond_its_ranges_a_choice_says_what_to_do(chosen: Choice) -> None:
    answer = solve(chosen.model, {"push.force": [14.0, 14.0, 0.0]})
    assert answer.within_tolerance is False
    assert "the modes were chosen for other inputs: choose them for the range of these inputs" in answer.message


def test_inside_its_ranges_a_choice_that_missed_does_not_blame_the_scene() -> None:
    """Modes that were chosen are no modes that the scene fixes, and these inputs are no other ones."""
    few = {"tolerance": 1e-6, "modes": 1, "nodes": 6, "rotation": "magnus6", "chosen_for": ["push.force.x=-1:1"]}
    model = build(scene(push(force=[0.9, 0.0, 0.0]), strain="planar", accuracy=few))
    inside = solve(model)
    assert inside.within_tolerance is False
    assert "the modes were chosen for these inputs too: choose them for less" in inside.message
    outside = solve(model, {"push.force": [1.1, 0.0, 0.0]})
    assert "the modes were chosen for other inputs" in outside.message


def test_it_is_no_dearer_than_twice_the_cheapest(chosen: Choice) -> None:
    """No discretisation with half as many unknowns keeps the tolerance at a corner."""
    half = chosen.model.size // 2
    corner = {"push.force": [2.0, 2.0, -2.0]}
    fine = solve(build(chosen.scene, discretise(chosen.scene, 12, 28, "magnus8")), corner)
    for first in range(1, half - 1):
        for second in range(1, half - first):
            modes = (first, second, half - first - second)
            coarse = solve(build(chosen.scene, discretise(chosen.scene, modes, 16, "magnus8")), corner)
            assert not coarse.converged or pose_distance(coarse, fine) > 1e-3


@pytest.mark.slow
def test_ranges_of_parameters_are_taken_as_those_of_inputs() -> None:
    """A rod that may be three times as soft, and loaded by an input: right at the corners, against finer modes."""
    bending = "rod.stiffness.bending_y"
    soft = scene(push(force=[0.1, 0.0, 0.0]), strain="planar", parameters=[bending], accuracy={"tolerance": 1e-6})
    choice = choose(soft, {bending: (0.5, 1.5), "push.force.x": (-1.0, 1.0), "push.force.z": (-1.0, 0.5)}, samples=4)
    assert choice.met
    assert f"{bending}=0.5:1.5" in choice.scene.accuracy.chosen_for
    fine = build(soft, discretise(soft, 12, 28, "magnus8"))
    for stiffness in (0.5, 1.5):
        force = {"push.force": [1.0, 0.0, -1.0]}
        found = solve(choice.model, force, parameters={bending: stiffness})
        exact = solve(fine, force, parameters={bending: stiffness}, estimate_error=False)
        assert pose_distance(found, exact) <= 1e-6
    # Without a range a parameter keeps its value, and a stiff rod bends less.
    stiff = choose(soft, {"push.force.x": (-1.0, 1.0), "push.force.z": (-1.0, 0.5)}, samples=4)
    assert stiff.model.size < choice.model.size


def test_points_without_equilibrium_are_told() -> None:
    choice = choose(scene(push(), strain="planar", accuracy={"tolerance": 1e-2}), {"push.force.x": (0.0, 1e200)})
    assert choice.without_equilibrium


def test_a_tolerance_that_nobody_has_written_holds_on_the_modes_chosen_for_it() -> None:
    """It is the one that they were chosen for: their answers beyond the ranges are told to miss it."""
    choice = choose(scene(push(), strain="planar"), {"push.force": (-0.1, 0.1)}, samples=1)
    assert choice.within_tolerance is True
    assert solve(choice.model, {"push.force": [0.1, 0.0, 0.0]}).within_tolerance is True
    far = solve(choice.model, {"push.force": [20.0, 0.0, 0.0]})
    assert far.converged
    assert far.within_tolerance is False
    assert "above the tolerance" in far.message


def test_fixed_modes_are_verified(chosen: Choice) -> None:
    """Too few of them: the choice says so, with the point where it shows."""
    coarse = scene(push(), accuracy={"tolerance": 1e-3, "modes": 1, "nodes": 4})
    choice = choose(coarse, {"push.force": (-2.0, 2.0)})
    assert not choice.met
    assert choice.error_estimate is not None
    assert choice.error_estimate > 1e-3
    assert choice.model.discretisation == discretise(coarse)


def test_a_model_with_no_more_freedom_than_constraints_is_locked() -> None:
    """A rod held at both ends: six constraints, and six modes leave nothing that moves."""
    held = scene(
        push(), supports=[{"rod": "rod", "kind": "clamped", "position": [0.1, 0, 0.7], "quaternion": [1, 0, 0, 0]}]
    )
    assert degrees_of_freedom(build(held, discretise(held, 2, 6))) == 0
    assert degrees_of_freedom(build(held, discretise(held, 3, 8))) == 3


@pytest.mark.slow
def test_modes_are_chosen_beside_a_thin_bar() -> None:
    """Few intervals do, for its layer is summed between nodes; away from points that are tried the error holds too."""
    free = "accuracy = { modes = 2, nodes = 24 }"
    pressed = parse_scene(ON_A_BAR.replace(free, ""), ["bar.radius=2e-3", "bar.width=1e-3", "accuracy.tolerance=1e-3"])
    chosen = choose(pressed, {"push.force.z": (-0.05, -0.03)})
    assert chosen.met and not chosen.without_equilibrium
    assert max(own.nodes for own in chosen.model.discretisation.values()) <= 12
    fine = build(chosen.scene, discretise(chosen.scene, 5, 24))
    push = {"push.force": [0.0, 0.0, -0.037]}
    coarse = solve(chosen.model, push, estimate_error=False)
    assert coarse.converged
    assert pose_distance(coarse, solve(fine, push, start=prolong(coarse, fine), estimate_error=False)) <= 1e-3
