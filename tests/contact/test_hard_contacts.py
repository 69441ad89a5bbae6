"""Contacts that were once missed, entered or not settled: thin bars, grooves, planes that coincide, held rods."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cosserat_casadi import Solution, build, discretise, export, parse_scene, solve
from cosserat_casadi import follow as follow_input
from cosserat_casadi.equilibrium.contact.cushions import Barriers, cushioned
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs
from cosserat_casadi.equilibrium.contact.passing_through import SECTIONS, is_inside_between
from cosserat_casadi.equilibrium.load_path import load_path
from cosserat_casadi.errors import ExportError
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.numerics.continuation import ContinuationSettings, PathPoint, follow
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.scene.obstacle_records import Capsule
from tests.families import mostly_slow

DENSE = np.linspace(0.0, 1.0, 4001)

HEAD = "schema = 1\naccuracy = { tolerance = 1e-6 }\n"

PLANAR = """
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_y = 1.0 }
linear_density = 0.1019367991845056
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
"""

SPATIAL = PLANAR.replace('"planar"', '"kirchhoff"').replace(
    "{ bending_y = 1.0 }", "{ bending_x = 1.0, bending_y = 1.0, torsion = 0.8 }"
)


def push(force: float) -> str:
    return f'[[loads]]\nname = "push"\nkind = "tip_wrench"\nrod = "rod"\nforce = [0.0, 0.0, {force}]\n'


def weight(acceleration: float, sideways: float = 0.0) -> str:
    return f'[[loads]]\nname = "weight"\nkind = "gravity"\nacceleration = [0.0, {sideways}, {acceleration}]\n'


def bar(name: str, x: float, z: float, radius: float) -> str:
    ends = f"from = [{x}, -2.0, {z}]\nto = [{x}, 2.0, {z}]\n"
    return f'[[obstacles]]\nname = "{name}"\nkind = "capsule"\n{ends}radius = {radius}\n'


def plane(name: str, z: float, normal: tuple[int, int, int] = (0, 0, 1)) -> str:
    return f'[[obstacles]]\nname = "{name}"\nkind = "plane"\npoint = [0, 0, {z}]\nnormal = {list(normal)}\n'


def clamped_end(x: float, z: float) -> str:
    half = np.sqrt(0.5)
    turned = f"quaternion = [{half}, 0.0, {half}, 0.0]\n"
    return f'[[supports]]\nname = "s"\nrod = "rod"\nkind = "clamped"\nposition = [{x}, 0.0, {z}]\n{turned}'


def pinned_end(x: float, z: float) -> str:
    return f'[[supports]]\nname = "s"\nrod = "rod"\nkind = "pinned"\nposition = [{x}, 0.0, {z}]\n'


def solved(text: str) -> Solution:
    solution = solve(parse_scene(HEAD + text))
    assert isinstance(solution, Solution)
    return solution


def on_coarse_modes(text: str) -> Solution:
    scene = parse_scene(HEAD + text)
    return solve(build(scene, discretise(scene, 5)), estimate_error=False)


def check_holds(solution: Solution) -> None:
    """No section is inside an obstacle, and no force pulls."""
    for rod, obstacle in pairs(solution.model.scene):
        assert gap_along(solution, rod, obstacle, DENSE).min() >= -1e-6
    for contact in solution.contacts:
        assert min(contact.ends) >= 0.0


THIN_BAR = PLANAR + push(-4.0) + bar("bar", 0.6, -0.063, 0.005)


@pytest.mark.slow
def test_a_path_goes_on_from_points_that_it_was_let_to() -> None:
    """Near a fold an exact correction may lead behind the bar: no step was asked for that leads there."""
    model = cushioned(parse_scene(HEAD + THIN_BAR), 1000.0)
    inputs = model.pack(None)
    path = load_path(model, inputs)
    barriers = Barriers(model, inputs)
    met = [path.start]

    def admits(before: PathPoint, after: PathPoint) -> bool:
        assert any(np.array_equal(before[0], x) for x in met)
        if barriers.are_between(before[0], after[0]):
            return False
        met.append(after[0])
        return True

    end = follow(replace(path, admits=admits), ContinuationSettings(longest=0.15))
    assert end.outcome is Outcome.LOAD_STALLED


@pytest.mark.parametrize("radius", [1e-2, 2e-3, 1e-4])
def test_a_way_through_a_bar_is_seen_however_thin_it_is(radius: float) -> None:
    scene = parse_scene(HEAD + PLANAR)
    properties = rod_properties(scene.rods[0])
    obstacle = Capsule.model_validate(
        {"name": "bar", "kind": "capsule", "from": [0.6, -1, -0.3], "to": [0.6, 1, -0.3], "radius": radius}
    )
    straight = np.stack([SECTIONS, 0 * SECTIONS, 0 * SECTIONS], axis=1)
    inclined = straight * [0.9, 1.0, 1.0] - np.outer(0.4 * SECTIONS, [0.0, 0.0, 1.0])
    below = straight - [0.0, 0.0, 0.7]
    assert not is_inside_between(obstacle, properties, straight, inclined)
    assert is_inside_between(obstacle, properties, straight, below)
    assert is_inside_between(obstacle, properties, inclined, below)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("height", "radius", "tip"), [(-0.063, 0.005, (0.9412, -0.2524)), (-0.06, 0.002, (0.9409, -0.2530))]
)
def test_a_rod_touches_a_thin_bar(height: float, radius: float, tip: tuple[float, float]) -> None:
    """The tip is where a path of equilibria leads that begins without load."""
    solution = solved(PLANAR + push(-4.0) + bar("bar", 0.6, height, radius))
    assert solution.converged, solution.message
    check_holds(solution)
    (contact,) = solution.contacts
    assert contact.kind == "point"
    x, _, z = solution.tip().position
    assert_allclose([x, z], tip, rtol=0, atol=5e-5)
    assert solution.stable


def test_a_force_does_not_take_a_rod_to_the_other_side_of_a_thin_bar() -> None:
    """From the cushion of twice the radius Newton's method leads under the bar; from contact at less force it does not.

    The tip is where the path in contact leads.
    """
    stiff = PLANAR.replace("length = 1.0", "length = 0.8").replace("bending_y = 1.0", "bending_y = 1.4")
    scene = parse_scene(HEAD + stiff + push(-8.0) + bar("bar", 0.51, -0.05, 0.004))
    model = build(scene, discretise(scene, 4, 8))
    solution = solve(model)
    assert solution.converged, solution.message
    path = follow_input(model, "push.force", [0.0, 0.0, -8.0])
    assert path.converged
    assert_allclose(solution.tip().position, path.solution(-1).tip().position, rtol=0, atol=1e-9)


HEAVY = PLANAR + weight(-49.05) + plane("t", 0.0)
"""A rod of 5 N that is clamped on a plane, along it."""


@pytest.mark.parametrize(
    ("load", "end", "tip"),
    mostly_slow([(0.0, 1.0, 0.0), (-1.0, 1.0, 1.0), (0.5, 0.8, 0.5)], quick=[(0.5, 0.8, 0.5)]),
)
def test_a_rod_that_is_clamped_on_a_plane_lies_on_it_from_its_base(load: float, end: float, tip: float) -> None:
    """The plane bears all; a tip that a force F lifts leaves it where 2 F / weight of the rod are left."""
    solution = on_coarse_modes(HEAVY + push(load))
    assert solution.converged, solution.message
    check_holds(solution)
    (line,) = solution.contacts
    assert line.start == 0.0
    # Of second order in the slope of what is lifted.
    assert_allclose(line.end, end, rtol=0, atol=1e-6)
    assert_allclose(line.ends, [0.0, tip], rtol=0, atol=1e-5)
    assert_allclose(line.force, [0.0, 0.0, 5.0 - load], rtol=0, atol=1e-9)
    assert_allclose(solution.base_wrench().force, 0.0, rtol=0, atol=1e-9)


def test_a_rod_that_is_clamped_above_a_plane_meets_it_at_the_fourth_root_of_the_gap() -> None:
    """So small a gap is one: the rod falls through h = q s⁴ / 72 EI."""
    solution = on_coarse_modes(HEAVY.replace("point = [0, 0, 0.0]", "point = [0, 0, -1e-10]"))
    (line,) = solution.contacts
    assert_allclose(line.start, (72 * 1e-10 / 5.0) ** 0.25, rtol=1e-3, atol=0)


def test_c_is_not_written_for_a_line_from_the_base(tmp_path: Path) -> None:
    model = build(parse_scene(HEAD + HEAVY), discretise(parse_scene(HEAD + HEAVY), 5))
    with pytest.raises(ExportError, match="lies on 't' from its base on"):
        export(model, tmp_path)


@pytest.mark.slow
def test_planes_that_coincide_are_as_one() -> None:
    one = on_coarse_modes(PLANAR + weight(-49.05) + plane("t", -0.1))
    two = on_coarse_modes(PLANAR + weight(-49.05) + plane("t", -0.1) + plane("t2", -0.1))
    assert one.converged
    assert two.converged, two.message
    assert_allclose(two.tip().position, one.tip().position, rtol=0, atol=1e-12)
    (contact,) = two.contacts
    assert_allclose(contact.force, one.contacts[0].force, rtol=1e-9, atol=1e-12)


GROOVE = plane("v1", -0.08, (0, 1, 1)) + plane("v2", -0.08, (0, -1, 1))


@pytest.mark.slow
def test_a_rod_lies_in_a_groove_as_on_a_plane() -> None:
    """At the bottom of the groove; what its walls press along y they press against each other, and the weight."""
    sideways = 3.0
    in_groove = solved(SPATIAL + weight(-60.0, sideways) + GROOVE)
    assert in_groove.converged, in_groove.message
    check_holds(in_groove)
    assert {contact.obstacle for contact in in_groove.contacts} == {"v1", "v2"}
    on_plane = on_coarse_modes(PLANAR + weight(-60.0) + plane("floor", -0.08))
    assert_allclose(in_groove.tip().position, on_plane.tip().position, rtol=0, atol=2e-5)
    pressed = sum(contact.force for contact in in_groove.contacts)
    total = 0.1019367991845056 * np.array([0.0, sideways, -60.0])
    assert_allclose(pressed + total, -in_groove.base_wrench().force, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_line_on_one_wall_bears_the_force_where_the_rod_meets_the_other() -> None:
    """In a sharp groove the walls face each other: the force at the start of one line presses on the other wall."""
    normals = np.array([[0.0, 0.9, 0.5], [0.0, -0.9, 0.5]])
    walls = plane("v1", -0.05, (0, 9, 5)) + plane("v2", -0.05, (0, -9, 5))
    in_groove = solved(SPATIAL + weight(-60.0, 3.0) + walls)
    assert in_groove.converged, in_groove.message
    check_holds(in_groove)
    longer, shorter = sorted(in_groove.contacts, key=lambda contact: contact.start)
    assert (longer.kind, shorter.kind, longer.end, shorter.end) == ("line", "line", 1.0, 1.0)
    (section,) = longer.inside
    assert section.at == shorter.start
    apart = normals[0] @ normals[1] / np.prod(np.linalg.norm(normals, axis=1))
    assert_allclose(section.force, -apart * shorter.ends[0], rtol=1e-4, atol=0)
    pressed = sum(contact.force for contact in in_groove.contacts)
    total = 0.1019367991845056 * np.array([0.0, 3.0, -60.0])
    assert_allclose(pressed + total, -in_groove.base_wrench().force, rtol=0, atol=1e-9)


def line_by_shooting(weight_per_length: float, height: float) -> NDArray[np.float64]:
    """Start of the line of a rod of unit stiffness and length that is clamped above a plane, along it, and its force.

    The rod has no slope and no curvature where the line begins; SciPy integrates from there to the clamp.
    """

    def missed(start: float, force: float) -> list[float]:
        def rates(s: float, y: NDArray[np.float64]) -> list[float]:
            slope, curvature, _ = y
            lifted = force - weight_per_length * (start - s)
            return [curvature, -lifted * np.cos(slope), np.sin(slope)]

        slope, _, z = solve_ivp(rates, (start, 0.0), [0.0, 0.0, 0.0], rtol=1e-11, atol=1e-13).y[:, -1]
        return [slope, z - height]

    of_beam = (72 * height / weight_per_length) ** 0.25
    return np.asarray(fsolve(lambda p: missed(*p), [of_beam, weight_per_length * of_beam / 3], xtol=1e-13))


@pytest.mark.parametrize("acceleration", mostly_slow([40.3, 40.4, 41.0, 45.0], quick=[40.4]))
def test_a_short_line_at_the_tip_begins_where_shooting_says(acceleration: float) -> None:
    """Its depth, were it a point, is below all tolerances of depth: q w⁴/8 for the width w, here from 1e-3 on."""
    height = 0.0565
    solution = solved(PLANAR + weight(-acceleration) + plane("t", -height))
    assert solution.converged, solution.message
    assert gap_along(solution, "rod", solution.model.scene.obstacles[0], DENSE).min() >= -1e-9
    (line,) = solution.contacts
    start, force = line_by_shooting(0.1019367991845056 * acceleration, height)
    assert solution.error_estimate is not None
    assert line.kind == "line"
    assert_allclose(line.start, start, rtol=0, atol=solution.error_estimate)
    assert_allclose(line.ends, [force, 0.0], rtol=0, atol=2 * solution.error_estimate)


@pytest.mark.slow
def test_a_stretch_that_would_have_to_lie_on_two_planes_is_told_on_two_levels() -> None:
    """Points stand for the line: poses are right, and the error of its ends, which modes do not lessen, is told."""
    levels: list[str] = []
    in_groove = solve(parse_scene(HEAD + SPATIAL + weight(-60.0) + GROOVE), report=levels.append)
    assert isinstance(in_groove, Solution)
    assert in_groove.outcome is Outcome.UNRESOLVED
    # Which of the two comes first is rounding: they are mirror images.
    assert re.search("touches 'v[12]' and 'v[12]' together near X = 0.99", in_groove.message)
    assert "width" in in_groove.message
    assert levels == ["5 modes", "7 modes"]
    on_plane = on_coarse_modes(PLANAR + weight(-60.0) + plane("floor", -0.08))
    assert_allclose(in_groove.tip().position, on_plane.tip().position, rtol=0, atol=2e-5)
    # One plane is touched at a section, where it should be up to the tip.
    missing = 1.0 - min(touch.start for touch in on_plane.contacts)
    assert in_groove.error_estimate is not None
    assert in_groove.error_estimate > missing > 1e-2


@pytest.mark.slow
def test_a_rod_that_would_have_to_be_clamped_between_bars_is_told() -> None:
    """Bars that touch the rod from both sides at one section hold its slope: no forces that are finite do so."""
    between = bar("b1", 0.4, -0.05, 0.05) + bar("b2", 0.4, 0.05, 0.05)
    solution = solved(PLANAR + push(-3.0) + between)
    assert solution.outcome is Outcome.CONTACT_UNSETTLED
    assert "touches 'b2' and 'b1' together near X = 0.4" in solution.message
    assert "width" in solution.message


@pytest.mark.slow
def test_a_rod_that_is_clamped_at_both_ends_lies_on_a_plane() -> None:
    solution = solved(PLANAR + weight(-46.79568387832218) + plane("t", -0.133901) + clamped_end(0.872683, 0.0992853))
    assert solution.converged, solution.message
    check_holds(solution)


@pytest.mark.slow
def test_a_rod_that_is_pinned_on_a_plane_is_resolved() -> None:
    solution = solved(PLANAR + weight(-72.08712535182201) + plane("t", -0.127173) + pinned_end(0.766856, -0.0176784))
    assert solution.converged, solution.message
    check_holds(solution)
    assert solution.error_estimate is not None
    assert solution.error_estimate < 1e-6
