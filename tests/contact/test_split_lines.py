"""Loads that act inside a line of contact: shooting, closed forms, balance, complementarity and energy."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import fsolve

from cosserat_casadi import Solution, build, discretise, parse_scene, solve
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_newton import sought
from cosserat_casadi.equilibrium.contact.contact_state import state_in, without_contacts
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.numerics.newton import NewtonSettings, relative_norm
from tests.contact.test_contact import TABLE, check_forces_sum, free_span
from tests.families import mostly_slow
from tests.reference.planar import elastica_end

BENDING, WEIGHT, HEIGHT, LENGTH = 0.03, 0.981, 0.08, 1.2

DENSE = np.linspace(0.0, 1.0, 3001)


def point_load(at: float, force: float, name: str = "load") -> str:
    return f'[[loads]]\nname = "{name}"\nkind = "point_wrench"\nrod = "rod"\nat = {at}\nforce = [0, 0, {force}]\n'


def solved(loads: str, modes: int = 7, start: Solution | None = None) -> Solution:
    scene = parse_scene(TABLE + loads)
    return solve(build(scene, discretise(scene, modes)), start=start)


def check_contact(solution: Solution, tolerance: float = 1e-8) -> None:
    """No section is in the table, none of its forces pulls, and it presses where it is touched alone.

    All to a tolerance, as a solution promises it: of forces relative to the largest one.
    """
    assert solution.converged, solution.message
    largest = max(float(np.linalg.norm(contact.force)) for contact in solution.contacts)
    for rod, obstacle in pairs(solution.model.scene):
        assert gap_along(solution, rod, obstacle, DENSE).min() >= -tolerance
        for contact in solution.contacts:
            touching = np.linspace(contact.start, contact.end, 301)
            assert_allclose(gap_along(solution, rod, obstacle, touching), 0.0, rtol=0, atol=tolerance)
            assert min(contact.ends) >= -tolerance * largest
            if (contact.kind, contact.end) == ("line", 1.0):
                # A free tip that lies down has no shear force, so that none stands on it.
                assert_allclose(contact.ends[1], 0.0, rtol=0, atol=tolerance * largest)
            assert all(section.force > 0.0 for section in contact.inside)


def check_balance(solution: Solution, loads: float) -> None:
    check_forces_sum(solution, np.array([0.0, 0.0, loads - WEIGHT * LENGTH]))


@pytest.fixture(scope="module")
def pressed() -> Solution:
    return solved(point_load(0.7, -0.5))


def test_the_table_takes_a_load_where_it_stands(pressed: Solution) -> None:
    """The free span does not know of it: the rod lifts off where it does without the load."""
    check_contact(pressed)
    (line,) = pressed.contacts
    length, reaction, _ = free_span()
    assert_allclose(line.start * LENGTH, length, rtol=0, atol=1e-7)
    assert (line.kind, line.end) == ("line", 1.0)
    assert_allclose(line.ends, [reaction, 0.0], rtol=0, atol=1e-7)
    (section,) = line.inside
    assert section.at == 0.7
    assert_allclose(section.force, 0.5, rtol=1e-8, atol=0)
    # All that lies there is borne there.
    on_table = (LENGTH - length) * WEIGHT
    assert_allclose(line.force, [0.0, 0.0, reaction + on_table + 0.5], rtol=1e-7, atol=1e-12)
    check_balance(pressed, -0.5)
    assert pressed.stable


@pytest.mark.slow
def test_files_list_the_forces_inside(pressed: Solution) -> None:
    (contact,) = pressed.to_dict()["contacts"]
    (section,) = pressed.contacts[0].inside
    assert contact["inside_forces"] == [{"at": 0.7, "force": section.force}]
    assert len(contact["point_forces"]) == 2
    (plain,) = solved("").to_dict()["contacts"]
    assert "inside_forces" not in plain


@pytest.mark.slow
def test_from_a_solution_the_line_is_tried_first(pressed: Solution) -> None:
    again = solve(pressed.model, {"load.force": [0.0, 0.0, -0.8]}, start=pressed)
    check_contact(again)
    assert_allclose(again.contacts[0].inside[0].force, 0.8, rtol=1e-8, atol=0)
    assert again.iterations < 15


@pytest.mark.parametrize("moved", [0.003, 0.004])
def test_places_are_sought_until_rounding_is_left(pressed: Solution, moved: float) -> None:
    """Steps from these starts would end at the aim of 1e-13 before: forces of short stretches need the digits."""
    scene = without_contacts(pressed.model.scene)
    own = state_in(pressed.model.scene)
    beside = own.at((own.places + moved).tolist())
    grids = Grids(pressed.model.discretisation)
    equations = ContactEquations(scene, input_layout(scene).pack(None), grids, beside)
    start = equations.start_from(pressed.x, equations.given)
    z, holds, _ = sought(equations, start, NewtonSettings())
    assert holds
    assert relative_norm(equations.residual(z, equations.given), z) < 1e-16


@pytest.mark.slow
@pytest.mark.parametrize("lift", [0.15, 0.05])
def test_a_load_that_lifts_opens_the_line(lift: float) -> None:
    """A heavy beam on a rigid plane rises over 3P/4q on either side; each end of what rises presses with P/4.

    EI w'''' = −q with w = w′ = w″ = 0 where it leaves the plane, w′ = 0 and EI w‴ = −P/2 under the load: half the width
    of what rises is 3P/(4q). The slopes are below 1e-3.
    """
    lifted = solved(point_load(0.7, lift))
    check_contact(lifted)
    first, second = lifted.contacts
    half = 3 * lift / (4 * WEIGHT) / LENGTH
    assert_allclose([first.end, second.start], [0.7 - half, 0.7 + half], rtol=0, atol=2e-6)
    assert_allclose([first.ends[1], second.ends[0]], lift / 4, rtol=1e-5, atol=0)
    length, _, _ = free_span()
    assert_allclose(first.start * LENGTH, length, rtol=0, atol=1e-7)
    check_balance(lifted, lift)
    assert lifted.stable


@pytest.mark.parametrize("beside", mostly_slow([1.5e-3, 1e-3, 2e-3], [1.5e-3]))
def test_a_line_begins_shortly_before_a_load(beside: float) -> None:
    """What a load lifts lies down again by 1e-3 of the length before another load, with the closed form above.

    On so short a stretch rounding leaves the polynomials of the force per length open.
    """
    lift = 0.03
    half = 3 * lift / (4 * WEIGHT) / LENGTH
    section = 0.8 + half + beside
    lifted = solved(point_load(0.8, lift) + point_load(section, -0.2, "other"))
    check_contact(lifted, 1e-7)
    first, second = lifted.contacts
    assert_allclose([first.end, second.start], [0.8 - half, 0.8 + half], rtol=0, atol=1e-7)
    assert_allclose([first.ends[1], second.ends[0]], lift / 4, rtol=2e-4, atol=0)
    assert [inside.at for inside in second.inside] == [section]
    assert_allclose(second.inside[0].force, 0.2, rtol=1e-5, atol=0)
    check_balance(lifted, lift - 0.2)


INSIDE = [(0.75, 0.002), (0.75, -0.002), (0.65, 0.001), (0.85, 0.001), (0.85, -0.001)]


@pytest.mark.parametrize(("at", "moment"), mostly_slow(INSIDE, quick=INSIDE[:4]))
def test_a_moment_opens_a_line(at: float, moment: float) -> None:
    """Forces that push bear no moment M: a heavy beam rises from a rigid plane over u and v beside it.

    EI w'''' = −q with w = w′ = w″ = 0 at either end of what rises, and w, w′ and w‴ continuous at the moment, give
    v = (2 + √3) u, q (v² − u²) / 2 = |M|, and end forces q v where u ends, q u where v does. Slopes are below 1e-3.
    """
    load = f'[[loads]]\nname = "load"\nkind = "point_wrench"\nrod = "rod"\nat = {at}\n'
    raised = solved(load + f"moment = [0, {-moment}, 0]\n")
    check_contact(raised)
    first, second = raised.contacts
    u = np.sqrt(2 * abs(moment) / WEIGHT / (6 + 4 * np.sqrt(3)))
    v = (2 + np.sqrt(3)) * u
    before, behind = (u, v) if moment > 0.0 else (v, u)
    assert_allclose([first.end, second.start], [at - before / LENGTH, at + behind / LENGTH], rtol=0, atol=2e-6)
    assert_allclose([first.ends[1], second.ends[0]], [WEIGHT * behind, WEIGHT * before], rtol=1e-4, atol=0)
    length, _, _ = free_span()
    assert_allclose(first.start * LENGTH, length, rtol=0, atol=1e-7)
    check_balance(raised, 0.0)
    assert raised.stable


BESIDE_LIFT_OFF = [(0.56, 0.005), (0.56, -0.005), (0.5, 0.03), (0.56, 0.03), (0.65, -0.03)]


@pytest.mark.parametrize(("at", "moment"), mostly_slow(BESIDE_LIFT_OFF, quick=[(0.56, 0.005), (0.65, -0.03)]))
def test_a_moment_near_the_start_of_a_line_leaves_a_point(at: float, moment: float) -> None:
    """Shooting of the heavy elastica from the clamp over the point and the moment to where it lies down."""

    def followed(start: float, end: float, y: np.ndarray, beyond: float) -> np.ndarray:
        return elastica_end(end - start, y, [0.0, beyond + WEIGHT * start], BENDING, WEIGHT)

    def missed(unknown: np.ndarray) -> np.ndarray:
        first, second, curvature, beyond, pressing = unknown
        sections = sorted([(first, 0.0, pressing), (at * LENGTH, moment, 0.0)])
        y = np.array([0.0, 0.0, 0.0, curvature])
        before = 0.0
        for s, turning, pushing in sections:
            y = followed(before, s, y, beyond)
            if pushing:
                at_point = y
            y = y - [0.0, 0.0, 0.0, turning / BENDING]
            beyond -= pushing
            before = s
        end = followed(before, second, y, beyond)
        return np.array([at_point[1] + HEIGHT, at_point[2], end[1] + HEIGHT, end[2], end[3]])

    load = f'[[loads]]\nname = "load"\nkind = "point_wrench"\nrod = "rod"\nat = {at}\n'
    solution = solved(load + f"moment = [0, {-moment}, 0]\n")
    check_contact(solution)
    point, line = solution.contacts
    (curvature,) = -solution.strain(np.array([0.0]))[:, 1]
    force = -solution.base_wrench().force[2]
    start = np.array([point.start * LENGTH, line.start * LENGTH, curvature, force, point.ends[0]])
    # From a hundredth beside it; scipy asks for no more than it can tell.
    found = fsolve(missed, 1.01 * start, xtol=1e-11)
    assert_allclose(missed(found), 0.0, rtol=0, atol=1e-9)
    first, second, _, beyond, pressing = found
    assert (point.kind, line.kind, line.end) == ("point", "line", 1.0)
    assert_allclose([point.start * LENGTH, line.start * LENGTH], [first, second], rtol=0, atol=1e-7)
    assert_allclose(point.ends, pressing, rtol=0, atol=1e-6)
    assert_allclose(line.ends, [beyond - pressing + WEIGHT * second, 0.0], rtol=0, atol=1e-6)
    check_balance(solution, 0.0)
    assert solution.stable


@pytest.mark.slow
def test_a_load_inside_a_line_over_a_drum() -> None:
    """Along a drum the bending moment is constant, and so there is no shear force: each normal force is borne at once.

    The drum takes of a load downwards at a section what is along its normal, and at the end of the line that share of
    the weight of what hangs beyond; the rest is tension.
    """
    load, radius, place = 0.5, 0.5, 0.45
    axis = np.array([0.35, 0.0, -0.02 - radius])
    drum = (
        f'[[obstacles]]\nname = "drum"\nkind = "capsule"\nradius = {radius}\n'
        f"from = [{axis[0]}, -1.0, {axis[2]}]\nto = [{axis[0]}, 1.0, {axis[2]}]\n"
    )
    scene = parse_scene(TABLE[: TABLE.index("[[obstacles]]")] + drum + point_load(place, -load))
    solution = solve(build(scene, discretise(scene, 7)))
    check_contact(solution)
    check_balance(solution, -load)
    (line,) = solution.contacts
    (section,) = line.inside
    assert (line.kind, section.at) == ("line", place)
    upwards = (solution.pose(np.array([place, line.end])).position - axis)[:, 2] / radius
    # As exact as the turn along the drum is integrated.
    assert_allclose(section.force, load * upwards[0], rtol=1e-6, atol=0)
    hanging = WEIGHT * LENGTH * (1.0 - line.end)
    assert_allclose(line.ends[1], hanging * upwards[1], rtol=1e-6, atol=0)


@pytest.mark.slow
def test_a_load_on_the_free_span() -> None:
    """Shooting of the heavy elastica with a load at 0.48 of the rod, which lies down beyond it."""
    load = 0.2
    place = 0.48 * LENGTH

    def missed(unknown: np.ndarray) -> np.ndarray:
        length, curvature, force = unknown
        first = elastica_end(place, [0.0, 0.0, 0.0, curvature], [0.0, force], BENDING, WEIGHT)
        beyond = force + load + WEIGHT * place
        end = elastica_end(length - place, first, [0.0, beyond], BENDING, WEIGHT)
        return np.array([end[1] + HEIGHT, end[2], end[3]])

    found = fsolve(missed, [0.61, -1.6, -0.4], xtol=1e-13)
    assert_allclose(missed(found), 0.0, rtol=0, atol=1e-9)
    length, _, force = found
    solution = solved(point_load(0.48, -load), modes=9)
    check_contact(solution)
    (line,) = solution.contacts
    assert line.inside == ()
    assert_allclose(line.start * LENGTH, length, rtol=0, atol=1e-7)
    assert_allclose(line.ends[0], force + load + WEIGHT * length, rtol=0, atol=1e-6)
    check_balance(solution, -load)


@pytest.mark.slow
def test_loads_close_to_each_other_and_to_the_tip() -> None:
    """Each is borne where it stands; next to lift-off and next to the tip as well."""
    places = [0.55, 0.62, 0.95]
    loads = "".join(point_load(at, -0.3 * number, f"load{number}") for number, at in enumerate(places, start=1))
    solution = solved(loads)
    check_contact(solution)
    (line,) = solution.contacts
    assert [section.at for section in line.inside] == places
    # The stretch from lift-off to the first is a hundredth of the rod: its forces have fewer digits.
    assert_allclose([section.force for section in line.inside], [0.3, 0.6, 0.9], rtol=1e-5, atol=0)
    check_balance(solution, -1.8)


@pytest.mark.slow
def test_a_couple_inside_a_line_lifts_it() -> None:
    """A table cannot bear a couple: the rod rises on both sides of it, and balance of moments holds there."""
    couple = '[[loads]]\nname = "twist"\nkind = "point_wrench"\nrod = "rod"\nat = 0.75\nmoment = [0, 2e-3, 0]\n'
    solution = solved(couple)
    check_contact(solution)
    assert any(contact.end < 0.75 for contact in solution.contacts)
    assert not any(contact.start < 0.75 < contact.end for contact in solution.contacts)
    check_balance(solution, 0.0)


@pytest.mark.slow
def test_admissible_shapes_have_more_energy(pressed: Solution) -> None:
    """Shapes that are held by other forces as well, all above the table, are not lower."""
    generator = np.random.default_rng(3)
    probes = "".join(point_load(at, 0.0, f"probe{at:.0e}".replace("-", "")) for at in (0.35, 0.62, 0.8))
    own = solved(point_load(0.7, -0.5) + probes)
    names = [name for name in own.model.inputs.unpack(own.inputs) if name.startswith("probe")]
    least = energy(own, own)
    for _ in range(4):
        forces = {name: [0.0, 0.0, generator.uniform(0.0, 0.4)] for name in names if name.endswith("force")}
        other = solve(own.model, forces)
        check_contact(other, 1e-7)
        assert energy(other, own) > least


def energy(shape: Solution, loads: Solution) -> float:
    """Potential of a shape under the loads of a solution, without those of contact."""
    weight, bending = 0.0, 0.0
    X, weights = np.polynomial.legendre.leggauss(400)
    X = (X + 1) / 2
    curvature = shape.strain(X)[:, 1]
    bending = LENGTH * float(weights / 2 @ curvature**2) * BENDING / 2
    weight = LENGTH * WEIGHT * float(weights / 2 @ shape.pose(X).position[:, 2])
    (height,) = shape.pose(np.array([0.7])).position[:, 2]
    return bending + weight + 0.5 * float(height)


@pytest.mark.slow
def test_a_scene_meets_its_tolerance() -> None:
    solution = solve(parse_scene(TABLE.replace("1e-7", "1e-6") + point_load(0.7, -0.5)))
    check_contact(solution, 1e-6)
    assert solution.error_estimate is not None
    assert solution.error_estimate < 1e-6
