"""Equilibrium paths of rods against buckling loads, elliptic integrals and published limit loads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from cosserat_casadi import EquilibriumPath, Model, Outcome, Scene, SceneError, build, discretise, follow, solve
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.numerics.trace import PathOutcome
from tests.catalogue.cases import column_tip
from tests.families import mostly_slow
from tests.pose_errors import distance_between
from tests.scenes import HOOK, push, rod, scene

CRITICAL = np.pi**2 / 4
"""Euler's load of a clamped-free column, in EI/L²."""


def column(strain: str = "planar", modes: int = 12, length: float = 1.0, **stiffness: float) -> Model:
    """A column along z, clamped at its foot; a force at its top and its weight are inputs."""
    given = {"planar": {"bending_y": 1.0}, "kirchhoff": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.7}}[strain]
    rod = {"name": "rod", "length": length, "strain": strain, "stiffness": given | stiffness, "linear_density": 1.0}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, 0]}
    standing = scene(push(force=[0, 0, 0]), weight, rods=[rod])
    return build(standing, discretise(standing, modes, 2 * modes + 4, "magnus8"))


def test_euler_column_buckles_at_eulers_load_and_is_unstable_beyond() -> None:
    length = 0.7
    path = follow(column(length=length), "push.force", [0, 0, -12 * CRITICAL / length**2])
    assert path.converged
    assert [event.kind for event in path.events] == ["bifurcation", "bifurcation"]
    assert_allclose([12 * event.factor for event in path.events], [1.0, 9.0], rtol=1e-9, atol=0)
    assert_allclose(path.tip().position, np.tile([0, 0, length], (len(path.factor), 1)), rtol=0, atol=1e-14)
    assert path.stable is not None
    assert np.array_equal(path.stable, path.factor < 1 / 12)


@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff"], quick=["kirchhoff"]))
@pytest.mark.parametrize("ratio", mostly_slow([1.5, 9.1], quick=[9.1]))
def test_buckled_column_vs_elliptic_integrals(strain: str, ratio: float) -> None:
    path = follow(column(strain), "push.force", [0, 0, -ratio * CRITICAL], branch=True)
    assert path.converged
    assert_allclose(ratio * path.events[0].factor, 1.0, rtol=1e-9, atol=0)
    assert path.branch is not None
    assert path.stable is not None
    assert path.neutral is not None
    x, y, z = path.tip().position[-1]
    assert_allclose([np.hypot(x, y), z], column_tip(ratio), rtol=0, atol=1e-6)
    # The round column may turn about its axis at no cost; the flat one may not.
    assert np.all(path.neutral[path.branch :] == (strain == "kirchhoff"))
    assert np.all(path.stable[path.branch :])
    for factor, tip in list(zip(path.factor, path.tip().position, strict=True))[path.branch + 1 :: 5]:
        assert_allclose([np.hypot(tip[0], tip[1]), tip[2]], column_tip(ratio * factor), rtol=0, atol=1e-6)


def test_both_halves_of_both_branches_of_the_column() -> None:
    """The second branch is the elastica of a third of the length, three times: it leaves at 9 P_c and is unstable."""
    model = column()
    halves = {k: follow(model, "push.force", [0, 0, -9.1 * CRITICAL], branch=k) for k in (1, -1, 2, -2)}
    ends = {k: path.tip().position[-1] for k, path in halves.items()}
    for k in (1, 2):
        assert halves[k].converged
        assert halves[-k].converged
        assert_allclose(ends[-k], ends[k] * [-1, 1, 1], rtol=0, atol=1e-9)
        assert_allclose(9.1 * halves[k].events[-1].factor, (2 * k - 1) ** 2, rtol=1e-9, atol=0)
    x, z = column_tip(9.1 / 9)
    # Three quarter waves of the same elastica: two of them cancel sideways.
    assert_allclose([abs(ends[2][0]), ends[2][2]], [x / 3, z], rtol=0, atol=1e-8)
    assert halves[1].stable is not None
    assert halves[2].stable is not None
    assert halves[1].stable[-1]
    assert not halves[2].stable[-1]


def test_round_column_loses_two_stiffnesses_at_once() -> None:
    path = follow(column("kirchhoff"), "push.force", [0, 0, -2 * CRITICAL])
    assert path.converged
    (event,) = path.events
    assert (event.kind, event.multiplicity) == ("bifurcation", 2)
    assert_allclose(2 * event.factor, 1.0, rtol=1e-9, atol=0)
    assert path.stable is not None
    assert not path.stable[-1]
    (told,) = path.to_dict()["events"]
    assert_allclose(told["rods"]["rod"]["tip"]["position"], path.event_position(event, 1.0), rtol=0, atol=1e-12)


def test_column_with_unequal_stiffnesses_buckles_about_the_soft_axis_first() -> None:
    path = follow(column("kirchhoff", bending_x=1.3), "push.force", [0, 0, -1.5 * CRITICAL])
    assert [event.multiplicity for event in path.events] == [1, 1]
    assert_allclose([1.5 * event.factor for event in path.events], [1.0, 1.3], rtol=1e-9, atol=0)


def test_standing_column_buckles_under_its_weight() -> None:
    """A. G. Greenhill 1881: ρA g L³/EI = 9/4 j², j = 1.866350858… the first zero of the Bessel function J₋₁⸝₃."""
    length = 2.0
    path = follow(column(length=length), "weight.acceleration", [0, 0, -10 / length**3])
    assert path.converged
    assert_allclose(10 * path.events[0].factor, 9 / 4 * 1.8663508588**2, rtol=1e-8, atol=0)


ARCH = {"radius": 100.0, "stiffness": 1e6, "opening": np.deg2rad(215.0)}


def arch(modes: int) -> Model:
    """Clamped left, hinged right, pushed down at its crown; unloaded it meets both ends."""
    radius, opening = ARCH["radius"], ARCH["opening"]
    foot = np.array([radius * np.sin(opening / 2), 0.0, radius * np.cos(opening / 2)])
    bent: dict[str, Any] = {
        "name": "rod",
        "length": radius * opening,
        "strain": "planar",
        "stiffness": {"bending_y": ARCH["stiffness"]},
        "intrinsic": {"curvature": [0, 1 / radius, 0]},
        "base": {"position": [-foot[0], 0, foot[2]], "tangent": [np.cos(opening / 2), 0, np.sin(opening / 2)]},
    }
    crown = {"name": "crown", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0, 0, 0]}
    pinned = scene(crown, rods=[bent], supports=[{"rod": "rod", "kind": "pinned", "position": foot.tolist()}])
    return build(pinned, discretise(pinned, modes, 2 * modes + 6, "magnus8"))


@pytest.mark.slow
def test_deep_arch_vs_published_limit_load() -> None:
    """D. A. DaDeppo, R. Schmidt, J. Appl. Mech. 42 (1975) 305: the limit load is 8.97 EI/R², 8.97309 with more digits.

    The path leads down through zero and back up; it ends at factor 1 on the far side.
    """
    path = follow(arch(14), "crown.force", [0, 0, -1000.0])
    assert path.converged
    assert [event.kind for event in path.events] == ["limit", "limit"]
    assert_allclose(1000 * path.events[0].factor, 897.309, rtol=1e-6, atol=0)
    assert path.factor[0] == 0.0
    assert_allclose(path.x[0], 0.0, rtol=0, atol=1e-12)
    assert path.factor.min() < 0.0
    assert path.stable is not None
    first, second = (event.position for event in path.events)
    assert np.all(path.stable[:first])
    assert not np.any(path.stable[first:second])
    foot = ARCH["radius"] * np.sin(ARCH["opening"] / 2)
    assert_allclose(path.tip().position[:, 0], foot, rtol=1e-9, atol=0)
    assert path.section() == 0.5
    crown = path.position(0.5)
    assert_allclose(crown[0], [0, 0, ARCH["radius"]], rtol=0, atol=1e-8 * ARCH["radius"])
    assert np.all(np.diff(crown[:first, 2]) < 0)


def test_path_without_events_ends_where_solve_does() -> None:
    model = build(scene(push(), strain="reissner"))
    force = [0.9, 0.5, -0.4]
    path, direct = follow(model, "push.force", force), solve(model)
    assert path.converged
    assert path.events == ()
    assert_allclose(path.x[-1], direct.x, rtol=0, atol=1e-10)
    assert_allclose(path.inputs(1.0), direct.inputs, rtol=0, atol=0)
    assert_allclose(path.tip().position[-1], direct.tip().position, rtol=0, atol=1e-10)
    assert path.solution(-1).residual_norm < 1e-10
    assert path.solution(len(path.factor) // 2).residual_norm < 1e-10
    assert path.solution(-1).stable
    assert path.section() == 1.0
    assert_allclose(path.position(1.0), path.tip().position, rtol=0, atol=1e-12)


def test_multipliers_of_a_held_rod_vs_solve() -> None:
    """The curve counts multipliers in units of the load; what is recorded does not."""
    held = [{"rod": "rod", "kind": "pinned", "position": [0.3, 0.1, 0.6]}]
    model = build(scene({**HOOK, "force": [20.0, -9.0, 5.0]}, supports=held))
    path, direct = follow(model, "hook.force", [20.0, -9.0, 5.0]), solve(model)
    assert path.converged
    assert path.events == ()
    assert path.stable is not None
    assert path.stable[-1]
    assert_allclose(path.x[-1], direct.x, rtol=0, atol=1e-9)


@pytest.mark.parametrize("length", [0.3, 0.6])
def test_tips_of_a_rod_whose_length_and_base_are_inputs_vs_solve(length: float) -> None:
    """Their values belong to the poses of the path, though no path follows them."""
    free = {"inputs": ["push.force", "rod.length", "rod.base.position"]}
    model = build(scene(push(force=[0.2, 0, 0]), rods=[rod("planar", base={"position": [0.1, 0, 0.2]})], **free))
    path = follow(model, "push.force", [0.2, 0, 0], {"rod.length": length})
    direct = solve(model, {"rod.length": length})
    assert path.converged
    assert_allclose(path.tip().position[0], [0.1, 0, 0.2 + length], rtol=0, atol=1e-12)
    assert_allclose(path.tip().position[-1], direct.tip().position, rtol=0, atol=1e-10)
    assert_allclose(path.position(0.5)[-1], direct.pose(0.5).position, rtol=0, atol=1e-10)


def test_other_loads_stay_at_their_values() -> None:
    """The start is the rod under its weight alone."""
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]}
    model = build(scene(push(force=[0, 0, 0]), weight))
    path = follow(model, "push.force", [0.4, 0, 0], {"weight.acceleration": [0.5, 0, -1.0]})
    alone = solve(model, {"weight.acceleration": [0.5, 0, -1.0]})
    assert_allclose(path.x[0], alone.x, rtol=0, atol=1e-10)


def test_follower_force_has_no_stability_and_no_event() -> None:
    """Beck's column: no equilibrium but the straight one, no potential, no static bifurcation."""
    model = build(scene(push(force=[0, 0, 0], frame="body"), strain="planar"))
    path = follow(model, "push.force", [0, 0, -60.0])
    assert path.converged
    assert path.stable is None
    assert path.events == ()


def test_dead_and_follower_force_together_vs_closed_form() -> None:
    """No potential, so the determinant decides: P dead and F follower buckle a column at P cos √(P + F) = −F."""
    follower = {"name": "beck", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.3], "frame": "body"}
    upright = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    both = scene(push(force=[0, 0, 0]), follower, rods=[upright])
    path = follow(build(both, discretise(both, 12, 28, "magnus8")), "push.force", [0, 0, -4.0])
    assert path.converged
    assert path.stable is None
    (event,) = path.events
    critical = brentq(lambda P: P * np.cos(np.sqrt(P + 0.3)) + 0.3, 2.0, 3.0, xtol=1e-14)
    assert_allclose(4 * event.factor, critical, rtol=1e-8, atol=0)


def test_modes_are_chosen_until_events_and_end_stay() -> None:
    free = scene(push(force=[0, 0, 0]), rods=[rod("planar", length=1.0, stiffness={"bending_y": 1.0})])
    path = follow(free, "push.force", [0, 0, -3 * CRITICAL], branch=True)
    assert path.converged
    assert path.error_estimate is not None
    x, _, z = path.tip().position[-1]
    error = max(distance_between([abs(x), z], column_tip(3.0)), abs(3 * path.events[0].factor - 1.0))
    assert error <= path.error_estimate <= free.accuracy.tolerance


def test_a_path_of_a_held_rod_is_known_between_its_ends() -> None:
    """Its tip is where it is held on any modes, which therefore says nothing of the path."""
    arch = rod("planar", length=1.0, stiffness={"bending_y": 1.0}, intrinsic={"curvature": [0, 3.0, 0]})
    held = {"rod": "rod", "kind": "clamped", "position": [(1 - np.cos(3)) / 3, 0, np.sin(3) / 3]}
    held["quaternion"] = [np.cos(1.5), 0, np.sin(1.5), 0]
    force = [35.0, 0.0, -55.0]
    push_crown = {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0, 0, 0]}
    clamped = scene(push_crown, rods=[arch], supports=[held], accuracy={"tolerance": 1e-6})
    path = follow(clamped, "push.force", force)
    _assert_known(path, clamped, {"push.force": force}, index=-1, sections=[0.25, 0.5, 0.75])


def test_a_path_that_ends_unloaded_is_known_where_it_begins() -> None:
    bent = scene(push(force=[0, 0, 0]), rods=[rod("planar", length=1.0, stiffness={"bending_y": 1.0})])
    start = {"push.force": [30.0, 0.0, -12.0]}
    path = follow(bent, "push.force", [0, 0, 0], start)
    _assert_known(path, bent, start, index=0, sections=[1.0])


FAR = {"name": "far", "kind": "plane", "point": [0, 0, -5], "normal": [0, 0, 1]}


@pytest.mark.parametrize("obstacle", [{}, FAR])
def test_a_path_that_is_straight_at_both_ends_is_known_between(obstacle: dict[str, object]) -> None:
    """A heavy rod that is turned from hanging to standing, without obstacles or among such as it does not touch."""
    beam = rod("planar", length=1.0, stiffness={"bending_y": 1.0}, linear_density=1.0)
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, 7.0]}
    given: dict[str, Any] = {"rods": [beam], "inputs": ["rod.base.quaternion"], "accuracy": {"tolerance": 1e-6}}
    turned = scene(weight, **given, obstacles=[obstacle] if obstacle else [])
    path = follow(turned, "rod.base.quaternion", [0, 0, 1, 0], {"rod.base.quaternion": [1, 0, 0, 0]})
    assert not path.events
    assert_allclose(path.tip().position[[0, -1]], [[0, 0, 1], [0, 0, -1]], rtol=0, atol=1e-12)
    index = int(np.argmin(np.abs(path.factor - 0.74)))
    there = {"rod.base.quaternion": path.value_at(path.factor[index])}
    _assert_known(path, scene(weight, **given), there, index=index, sections=[1.0])


def _assert_known(
    path: EquilibriumPath, subject: Scene, values: Mapping[str, npt.ArrayLike], *, index: int, sections: list[float]
) -> None:
    """Sections at a point of a path are as near as told to those on far more modes, and within the tolerance."""
    truth = solve(build(subject, discretise(subject, 24, 48, "magnus8")), values).pose(sections)
    found = path.solution(index % len(path.factor)).pose(sections)
    distance = np.linalg.norm(found.position - truth.position, axis=1).max()
    assert path.converged
    assert path.error_estimate is not None
    assert 1e-12 < distance <= path.error_estimate <= subject.accuracy.tolerance


def test_fixed_modes_are_used_as_they_are() -> None:
    fixed = scene(push(), strain="planar", accuracy={"modes": 4, "nodes": 12})
    path = follow(fixed, "push.force", [0.5, 0, 0])
    assert path.converged
    assert path.error_estimate is None
    assert path.model.discretisation["rod"].modes == (4,)


def test_load_that_is_never_reached_is_said() -> None:
    path = follow(arch(8), "crown.force", [0, 0, -1000.0], settings=ArcSettings(steps=30))
    assert path.outcome is PathOutcome.MAX_STEPS
    assert not path.converged
    assert "Largest factor reached" in path.message
    assert 0.0 < path.factor[-1] < 1.0


def test_no_bifurcation_to_leave_at_is_said() -> None:
    path = follow(column(), "push.force", [0, 0, -0.5 * CRITICAL], branch=True)
    assert path.outcome is PathOutcome.NO_BIFURCATION
    assert path.branch is None


def test_no_start_is_said() -> None:
    """Upright at a whole length sideways: the support cannot be met."""
    aside = {"rod": "rod", "kind": "clamped", "position": [0.8, 0.0, 0.0], "quaternion": [1, 0, 0, 0]}
    far = scene(push(), strain="planar", supports=[aside])
    path = follow(build(far), "push.force", [1, 0, 0])
    assert path.outcome is PathOutcome.NO_START
    assert path.factor.shape == (0,)
    assert path.x.shape == (0, build(far).size)


LOW = {"name": "low", "kind": "plane", "point": [0, 0, -5], "normal": [0, 0, 1]}


@pytest.mark.parametrize("obstacles", [[], [LOW]])
def test_points_on_too_few_nodes_are_unresolved_as_solves_are(obstacles: list[dict[str, object]]) -> None:
    turn = {"name": "turn", "kind": "tip_wrench", "rod": "rod", "moment": [0, 0, 0]}
    accuracy = {"modes": 2, "nodes": 2}
    model = build(scene(turn, strain="planar", inputs=["turn.moment"], accuracy=accuracy, obstacles=obstacles))
    path = follow(model, "turn.moment", [0, 8.0, 0])
    solved = solve(model, {"turn.moment": [0, 8.0, 0]})
    assert path.solution(0).outcome is Outcome.CONVERGED
    assert path.solution(-1).outcome is solved.outcome is Outcome.UNRESOLVED
    # So is the whole path, which tells from where on; one that ends before is converged.
    assert path.outcome is PathOutcome.UNRESOLVED
    first = int(np.argmax(path.resolution_indices > 1.0))
    assert f"From factor {path.factor[first]:.6g} on the modes and nodes are too few" in path.message
    assert path.solution(first - 1).outcome is Outcome.CONVERGED
    assert follow(model, "turn.moment", [0, 8.0 * path.factor[first - 1], 0]).converged


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("shove.force", [0, 0, 1], "is not an input"),
        ("push.force", 1.0, "must have 3 numbers"),
        ("push.force", [0, np.inf, 0], "must be finite"),
    ],
)
def test_bad_inputs_are_refused(name: str, value: object, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        follow(build(scene(push())), name, value)  # type: ignore[arg-type]


def test_progress_grows_to_one() -> None:
    shares: list[float] = []
    follow(build(scene(push(), strain="planar")), "push.force", [1, 0, 0], progress=shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)
