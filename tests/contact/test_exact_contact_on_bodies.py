"""Obstacles on bodies that are touched exactly: points, lines, paths, stability, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq, fsolve
from scipy.spatial.transform import Rotation

from cosserat_casadi import Solution, build, export, follow, parse_scene, read_scene, solve
from cosserat_casadi.codegen.rows import row_results
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_judgement import _gap_curvatures
from cosserat_casadi.equilibrium.contact.contact_search import contact_equilibrium
from cosserat_casadi.equilibrium.contact.contact_state import state_in, without_contacts
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs
from cosserat_casadi.errors import ExportError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.paths.contact_path import ContactPath
from cosserat_casadi.plots.canvas import Canvas
from cosserat_casadi.plots.figure import figure_class
from cosserat_casadi.plots.obstacle_drawing import surface_lines, surface_net
from cosserat_casadi.sweeps.row_model import RowModel
from tests.conftest import ROOT
from tests.contact.test_obstacles_on_bodies import DISK, HEAD, PUSHED, PUSHER, RADIUS, STIFFNESS, WIDTH, bent_to
from tests.reference.planar import elastica_end

RIM = DISK.replace(f"width = {WIDTH}\nstiffness = {STIFFNESS}\n", "")
FINGERS = HEAD + PUSHER + PUSHED + RIM
PUSH = 0.5

HEAVY = """
schema = 1
accuracy = { modes = 5, nodes = 10 }
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_y = 0.03 }
linear_density = 0.3
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
[[rods]]
name = "post"
length = 0.4
strain = "planar"
stiffness = { bending_y = 0.5 }
base = { position = [0.6, 0, -0.55] }
[[bodies]]
name = "plate"
[[joints]]
body = "plate"
rod = "post"
kind = "fixed"
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
rods = ["rod"]
[[obstacles]]
name = "table"
kind = "plane"
normal = [0, 0, 1]
rods = ["rod"]
"""
ON_PLATE = HEAVY + 'point = [0, 0, 0]\nbody = "plate"\n'
ON_GROUND = HEAVY + "point = [0, 0, -0.15]\n"

CROSSED = """
schema = 1
accuracy = { modes = 5, nodes = 12 }
[[rods]]
name = "pusher"
length = 1.0
strain = "kirchhoff"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
[[rods]]
name = "pushed"
length = 0.9
strain = "kirchhoff"
stiffness = { bending_x = 0.4, bending_y = 0.6, torsion = 0.3 }
base = { position = [0.95, -0.4, -0.1], tangent = [0, 1, 0.05] }
[[bodies]]
name = "ball"
[[joints]]
body = "ball"
rod = "pusher"
kind = "fixed"
[[loads]]
name = "push"
kind = "body_wrench"
body = "ball"
force = [0.0, 0.05, -0.4]
[[obstacles]]
name = "bar"
kind = "capsule"
body = "ball"
from = [0.01, 0, -0.3]
to = [0.02, 0, 0.2]
radius = 0.05
rods = ["pushed"]
"""


@pytest.fixture(scope="module")
def touching() -> Solution:
    """A finger whose disk touches another at one point, inside it."""
    solution = solve(build(parse_scene(FINGERS)))
    assert solution.converged and solution.stable, solution.message
    return solution


@pytest.fixture(scope="module")
def lying() -> Solution:
    """A heavy rod that lies on a plate which tilts under it."""
    solution = solve(build(parse_scene(ON_PLATE)))
    assert solution.converged and solution.stable, solution.message
    return solution


@pytest.fixture(scope="module")
def crossed() -> Solution:
    """A bar on a ball that crosses a rod in space."""
    solution = solve(build(parse_scene(CROSSED)))
    assert solution.converged and solution.stable, solution.message
    return solution


def _nothing_is_inside(solution: Solution) -> None:
    for rod, obstacle in pairs(solution.model.scene):
        assert gap_along(solution, rod, obstacle, np.linspace(0.0, 1.0, 3001)).min() > -1e-6
    assert all(min(contact.ends) > 0.0 for contact in solution.contacts if contact.kind == "point")


@pytest.mark.slow
def test_a_bar_that_crosses_a_rod_in_space(crossed: Solution) -> None:
    """Forces and moments of both clamps and of the push are in balance, and so are those on each rod."""
    solution = crossed
    _nothing_is_inside(solution)
    (contact,) = solution.contacts
    push = np.array([0, 0.05, -0.4])
    pushed, pusher = solution.base_wrench("pushed"), solution.base_wrench("pusher")
    assert np.linalg.norm(contact.force) > 0.05
    assert_allclose(pushed.force + contact.force, 0.0, rtol=0, atol=1e-9)
    assert_allclose(pusher.force + push - contact.force, 0.0, rtol=0, atol=1e-9)
    # The force acts where they touch: about the origin it has one moment, on the one rod and on the other.
    place = solution.pose(contact.start, "pushed").position
    moment = np.cross(place, contact.force)
    base = np.array([0.95, -0.4, -0.1])
    assert_allclose(np.cross(base, pushed.force) + pushed.moment + moment, 0.0, rtol=0, atol=1e-9)
    loaded = np.cross(solution.body("ball").position, push)
    assert_allclose(pusher.moment + loaded - moment, 0.0, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_the_axes_of_the_body_do_not_matter(crossed: Solution) -> None:
    """The same bar in other axes of its body: forces, shape and the second variation are the same."""
    turned = Rotation.from_rotvec([0.4, -0.7, 1.1])
    x, y, z, w = turned.as_quat()
    other = CROSSED.replace('kind = "fixed"', f'kind = "fixed"\nquaternion = [{w}, {x}, {y}, {z}]')
    for point in ([0.01, 0, -0.3], [0.02, 0, 0.2]):
        other = other.replace(str(point), str(turned.apply(point).tolist()))
    first = crossed
    second = solve(build(parse_scene(other)))
    assert second.converged
    assert_allclose(second.contacts[0].force, first.contacts[0].force, rtol=0, atol=1e-10)
    assert_allclose(second.tip("pushed").position, first.tip("pushed").position, rtol=0, atol=1e-10)
    assert first.smallest_eigenvalue is not None
    assert_allclose(second.smallest_eigenvalue, first.smallest_eigenvalue, rtol=1e-7, atol=0)


def _equations(solution: Solution) -> tuple[ContactEquations, FloatArray]:
    """The equations of the contacts of a solution, and their unknowns there."""
    scene = without_contacts(solution.model.scene)
    grids = Grids(solution.model.discretisation)
    equations = ContactEquations(scene, input_layout(scene).pack(), grids, state_in(solution.model.scene))
    forces = solution.inputs[equations.nominal.force_entries] / equations.nominal.force_units
    return equations, np.concatenate([solution.x, forces, equations.state.places])


@pytest.mark.slow
def test_equations_have_their_exact_derivative(touching: Solution, lying: Solution) -> None:
    for solution in (touching, lying):
        equations, z = _equations(solution)
        given = equations.given
        assert_allclose(equations.residual(z, given), 0.0, rtol=0, atol=1e-7)
        moved = z + 1e-3 * np.random.default_rng(2).normal(size=len(z))
        jacobian = equations.jacobian(moved, given)
        steps = 1e-6 * np.eye(len(z))
        columns = [(equations.residual(moved + h, given) - equations.residual(moved - h, given)) / 2e-6 for h in steps]
        assert_allclose(jacobian, np.transpose(columns), rtol=0, atol=2e-8 * np.abs(jacobian).max())


def test_the_gap_curves_as_its_differences_say(touching: Solution) -> None:
    """How the place slides hangs on it, and so does stability."""
    equations, z = _equations(touching)
    found = contact_equilibrium(equations, z, equations.given)
    (touch,) = equations.state.touches
    ((rod, disk),) = pairs(equations.scene)
    step = 2e-3
    before, at, after = gap_along(touching, rod, disk, touch.start + step * np.array([-1.0, 0.0, 1.0]))
    assert_allclose(_gap_curvatures(found, touch), (after - 2 * at + before) / step**2, rtol=2e-3, atol=0)


@pytest.mark.slow
def test_a_rod_on_a_plate_that_does_not_move_lies_as_on_the_ground() -> None:
    stiff = solve(build(parse_scene(ON_PLATE.replace("bending_y = 0.5 }", "bending_y = 1e6 }"))))
    ground = solve(build(parse_scene(ON_GROUND)))
    assert stiff.converged and ground.converged
    (first,), (second,) = stiff.contacts, ground.contacts
    assert first.kind == second.kind == "line"
    # The plate gives way by the weight over a stiffness of 1e6.
    assert_allclose(first.force, second.force, rtol=0, atol=1e-6)
    assert_allclose([first.start, *first.ends], [second.start, *second.ends], rtol=0, atol=1e-6)
    assert_allclose(stiff.tip("rod").position, ground.tip("rod").position, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_a_rod_lies_on_a_plate_that_tilts(lying: Solution) -> None:
    """The line is straight, tilted with the plate, and carries what the clamps do not."""
    _nothing_is_inside(lying)
    (contact,) = lying.contacts
    assert contact.kind == "line" and contact.end == 1.0
    plate = lying.body("plate")
    stretch = lying.pose(np.linspace(contact.start, 1.0, 50), "rod").position
    assert_allclose((stretch - plate.position) @ plate.rotation[:, 2], 0.0, rtol=0, atol=1e-8)
    assert abs(plate.rotation[0, 2]) > 0.05
    weight = np.array([0, 0, 0.3 * 9.81])
    rod, post = lying.base_wrench("rod"), lying.base_wrench("post")
    assert_allclose(rod.force + contact.force, weight, rtol=0, atol=1e-9)
    assert_allclose(post.force, contact.force, rtol=0, atol=1e-9)
    # About the origin: both clamps, and the weight at the middle of the rod.
    sections, weights = np.polynomial.legendre.leggauss(60)
    centre = weights / 2 @ lying.pose((sections + 1) / 2, "rod").position
    total = rod.moment + post.moment + np.cross([0.6, 0, -0.55], post.force) - np.cross(centre, weight)
    assert_allclose(total, 0.0, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_two_cantilevers_share_a_small_push() -> None:
    """(P − N) L³/3EI of the one less N a³/3EI of the other is the gap that there was, to the square of the slopes."""
    near = FINGERS.replace("[0.3, 0, -0.1]", "[0.3, 0, -0.052]").replace(
        "force = [0, 0, -0.5]", "force = [0, 0, -0.02]"
    )
    solution = solve(build(parse_scene(near)))
    pusher, pushed = 1.0 / (3 * 0.5), 0.7**3 / (3 * 0.4)
    expected = (0.02 * pusher - 0.002) / (pusher + pushed)
    assert_allclose(solution.contacts[0].force[2], -expected, rtol=3e-3, atol=0)


class Elasticas:
    """Two planar elasticas that touch at one point, as an initial-value problem: nothing is shared with the model."""

    def residual(self, unknowns: FloatArray) -> list[float]:
        """Unknowns: curvatures at both bases, the force of contact, and where along the second rod it is, m."""
        first, second, force, place = unknowns
        section = self.section(second, force, place)
        normal = np.array([np.sin(section[2]), -np.cos(section[2])])
        disk = self.disk(first, force * normal)
        return [disk[3], section[3], *(disk[:2] + RADIUS * normal - section[:2])]

    def section(self, curvature: float, force: float, place: float) -> FloatArray:
        """The section that is touched: the rod beyond it is straight, and the force is normal to it."""

        def end(angle: float) -> FloatArray:
            pressing = force * np.array([np.sin(angle), -np.cos(angle)])
            return elastica_end(place, [0.3, -0.1, 0.0, curvature], pressing, 0.4)

        return end(brentq(lambda angle: float(end(angle)[2] - angle), -1.5, 1.0, xtol=1e-13))

    def disk(self, curvature: float, pressing: FloatArray) -> FloatArray:
        """The tip that carries the disk."""
        return elastica_end(1.0, [0.0, 0.0, 0.0, curvature], np.array([0.0, -PUSH]) - pressing, 0.5)


def test_large_deflections_are_those_of_two_elasticas(touching: Solution) -> None:
    elasticas = Elasticas()
    (contact,) = touching.contacts
    found, _, status, message = fsolve(elasticas.residual, [-0.4, -0.5, 0.25, 0.65], full_output=True, xtol=1e-12)
    assert status == 1, message
    first, second, force, place = found
    section = elasticas.section(second, force, place)
    assert_allclose(contact.ends[0], force, rtol=1e-6, atol=0)
    assert_allclose(contact.start, place / 0.9, rtol=1e-6, atol=0)
    assert_allclose(touching.pose(contact.start, "pushed").position[[0, 2]], section[:2], rtol=0, atol=1e-7)
    normal = np.array([np.sin(section[2]), -np.cos(section[2])])
    disk = elasticas.disk(first, force * normal)
    assert_allclose(touching.body("ball").position[[0, 2]], disk[:2], rtol=0, atol=1e-7)
    assert section[2] < -0.15 and disk[2] < -0.15


@pytest.mark.slow
def test_smooth_contact_becomes_exact_as_the_width_shrinks(touching: Solution) -> None:
    distances = []
    for width in (0.02, 0.01, 0.005):
        disk = DISK.replace(f"width = {WIDTH}\nstiffness = {STIFFNESS}", f"width = {width}")
        text = HEAD.replace("nodes = 12", "nodes = 60") + PUSHER + PUSHED + disk
        smooth = solve(build(parse_scene(text)))
        assert smooth.converged
        distances.append(np.linalg.norm(smooth.body("ball").position - touching.body("ball").position))
    assert distances[0] < 0.02
    assert np.all(np.diff(distances) < 0.0)
    assert distances[2] < 0.6 * distances[1] < 0.36 * distances[0]


def _energy(solution: Solution, strains: FloatArray) -> tuple[float, float]:
    """Energy of both rods and of the push, and the gap, m, for strains of both rods."""
    moved, position = bent_to(solution, strains)
    near = np.linspace(solution.contacts[0].start - 0.1, solution.contacts[0].start + 0.1, 101)
    gaps = np.linalg.norm(moved.pose(near, "pushed").position - position, axis=1) - RADIUS
    # The least of a parabola through the three points about the lowest.
    k = int(np.clip(gaps.argmin(), 1, len(near) - 2))
    before, at, after = gaps[k - 1 : k + 2]
    least = at - (after - before) ** 2 / (8 * (after - 2 * at + before))
    return float(solution.model.energy(moved.x, moved.inputs)) + PUSH * float(position[2]), float(least)


def _brought_back(solution: Solution, strains: FloatArray) -> float:
    """Energy where the second rod is bent away, or back, until the disk touches it again."""
    direction = np.zeros(len(strains))
    direction[solution.model.discrete.unknowns.strain("pushed").start] = 1.0
    share = brentq(lambda share: _energy(solution, strains + share * direction)[1], -0.2, 0.2, xtol=1e-11)
    return _energy(solution, strains + share * direction)[0]


def test_every_motion_that_keeps_the_contact_costs_energy(touching: Solution) -> None:
    count = sum(rod.size for rod in touching.model.discrete.rods.values())
    strains = touching.x[:count]
    least, gap = _energy(touching, strains)
    assert abs(gap) < 1e-8
    rng = np.random.default_rng(7)
    for _ in range(8):
        change = 3e-3 * rng.normal(size=count)
        above = _brought_back(touching, strains + change) - least
        below = _brought_back(touching, strains - change) - least
        assert min(above, below) > 0.0
        # There is no slope: to both sides it costs alike.
        assert abs(above - below) < 0.3 * (above + below)


@pytest.mark.slow
def test_a_path_touches_where_the_elastica_says(touching: Solution) -> None:
    """The finger alone bends until its disk is at the other, which is straight: z = −0.05 and X from its x."""
    model = build(parse_scene(FINGERS))
    path = follow(model, "push.force", [0.0, 0.0, -PUSH], values={"push.force": [0.0, 0.0, 0.0]})
    assert path.converged and isinstance(path, ContactPath)
    (touch,) = path.events
    assert (touch.kind, touch.contact.obstacle, touch.contact.owner) == ("touch", "disk", "pushed")

    def tip(push: float) -> FloatArray:
        def bent(curvature: float) -> FloatArray:
            return elastica_end(1.0, [0.0, 0.0, 0.0, curvature], [0.0, -push], 0.5)

        return bent(brentq(lambda curvature: bent(curvature)[3], -2.0, 0.0, xtol=1e-13))

    push = brentq(lambda push: tip(push)[1] + 0.1 - RADIUS, 0.01, 0.4, xtol=1e-12)
    assert_allclose(touch.contact.start, (tip(push)[0] - 0.3) / 0.9, rtol=0, atol=1e-6)
    last = path.solution(-1)
    assert_allclose(last.body("ball").position, touching.body("ball").position, rtol=0, atol=1e-8)
    assert_allclose(last.contacts[0].force, touching.contacts[0].force, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_disk_that_slips_off_loses_stability_at_the_limit() -> None:
    """The curve turns back where the smallest eigenvalue of the second variation changes its sign, told apart."""
    short = FINGERS.replace("length = 0.9", "length = 0.555").replace("[0.3, 0, -0.1]", "[0.4, 0, -0.1]")
    path = follow(build(parse_scene(short)), "push.force", [0, 0, -4.0], values={"push.force": [0, 0, 0]})
    assert path.converged and isinstance(path, ContactPath)
    assert [event.kind for event in path.events][:2] == ["touch", "limit"]
    turns = int(np.argmax(np.diff(path.factor) < 0.0))
    assert turns > 3
    # The point of the largest factor may be on either side of the limit.
    assert np.all(path.stable[:turns])
    assert not path.stable[turns + 1]


@pytest.mark.slow
def test_rows_of_a_sweep_tell_the_contact(touching: Solution) -> None:
    names = row_results(parse_scene(FINGERS))
    (row,) = RowModel(FINGERS).solve(np.array([[0.0, 0.0, -PUSH]]))
    by_name = dict(zip(names, row, strict=True))
    assert by_name["pushed.disk.contacts"] == 1.0
    force = [by_name[f"pushed.disk.force.{axis}"] for axis in "xyz"]
    assert_allclose(force, touching.contacts[0].force, rtol=1e-8, atol=1e-12)


@pytest.mark.slow
def test_the_example_presses(tmp_path: Path) -> None:
    solution = solve(build(read_scene(ROOT / "examples" / "finger_on_finger.toml", ["accuracy.modes=4"])))
    assert solution.converged and solution.stable
    (contact,) = solution.contacts
    assert (contact.obstacle, contact.owner, contact.kind) == ("rim", "lower", "point")
    assert_allclose(solution.base_wrench("lower").force, -contact.force, rtol=0, atol=1e-9)
    solution.write(tmp_path / "fingers.png")


def test_an_obstacle_is_drawn_where_its_body_is(touching: Solution) -> None:
    """The outline in the plane, and the net in space, are as far from the body as the rim is."""
    body = touching.body("ball")
    (disk,) = touching.model.scene.obstacles
    shown = touching.pose(np.linspace(0.0, 1.0, 20), "pushed").position
    axes = figure_class()().add_subplot()
    (outline,) = surface_lines(Canvas(axes, (0, 2), 1.0), disk, shown, body)
    net = surface_net(disk, shown, 1.0, body)
    assert_allclose(np.linalg.norm(outline - body.position, axis=1), RADIUS, rtol=0, atol=2e-4)
    assert_allclose(np.linalg.norm(net.reshape(-1, 3) - body.position, axis=1), RADIUS, rtol=0, atol=1e-12)


def test_what_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="C finds no exact contact with an obstacle on a body, nor of a disk"):
        export(build(parse_scene(FINGERS)), tmp_path / "fingers", "fingers")
