"""Rods in contact: shooting, closed forms, sums of forces, complementarity between the nodes, energy, refusals."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve, minimize_scalar
from work_precision.plan import make_plan

from cosserat_casadi import (
    Solution,
    build,
    discretise,
    follow,
    parse_scene,
    read_scene,
    scene_from_dict,
    solve,
)
from cosserat_casadi.cli.reports.solution import print_solution
from cosserat_casadi.control import stability_margin
from cosserat_casadi.equilibrium.contact.contact_equations import Grids
from cosserat_casadi.equilibrium.contact.contact_search import Settling
from cosserat_casadi.equilibrium.contact.contact_state import state_in, without_contacts
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.errors import SceneError
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.plots.scene_plot import plot_solution
from tests.conftest import CASES
from tests.derivatives import central_differences
from tests.reference.planar import elastica_end

EFFECTS = CASES / "effects"

TABLE = """
schema = 1
title = "A heavy rod on a table"
accuracy = { tolerance = 1e-7 }
[[rods]]
name = "rod"
length = 1.2
strain = "planar"
stiffness = { bending_x = 0.03, bending_y = 0.03, torsion = 0.02 }
linear_density = 0.1
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.08]
normal = [0, 0, 2]
"""

ROD = """
schema = 1
accuracy = { tolerance = 1e-6 }
[[rods]]
name = "rod"
length = 1.0
strain = "kirchhoff"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
"""

PUSH = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -3.0]
"""

TWO_BARS = """
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.4, -1.0, -0.07]
to = [0.4, 1.0, -0.07]
radius = 0.05
[[obstacles]]
name = "second"
kind = "capsule"
from = [0.75, -1.0, -0.2]
to = [0.75, 1.0, -0.2]
radius = 0.05
"""

WIRE = """
schema = 1
title = "A guide wire in a bent vessel"
accuracy = { tolerance = 1e-6 }
[[rods]]
name = "wire"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 60.0e9, poisson_ratio = 0.3 }
section = { shape = "circle", radius = 4e-4 }
[[obstacles]]
name = "vessel"
kind = "lumen"
points = [[0, 0, -0.02], [0, 0, 0.04], [0.012, 0.003, 0.10], [0.045, 0.015, 0.16], [0.09, 0.03, 0.2]]
radius = [4e-3, 4e-3, 5e-3, 4e-3, 4e-3]
"""

DENSE = np.linspace(0.0, 1.0, 3001)


def solved(text: str, modes: int = 7, **inputs: object) -> Solution:
    scene = parse_scene(text)
    return solve(build(scene, discretise(scene, modes)), inputs or None)


def check_complementary(solution: Solution, tolerance: float) -> None:
    """No section is inside an obstacle, no force pulls, and forces act where the gap is zero alone."""
    assert solution.converged, solution.message
    for rod, obstacle in pairs(solution.model.scene):
        assert gap_along(solution, rod, obstacle, DENSE).min() >= -tolerance
    obstacles = {obstacle.name: obstacle for obstacle in solution.model.scene.obstacles}
    for contact in solution.contacts:
        assert min(contact.ends) >= 0.0
        touching = np.linspace(contact.start, contact.end, 101)
        assert_allclose(
            gap_along(solution, contact.owner, obstacles[contact.obstacle], touching), 0.0, rtol=0, atol=tolerance
        )


def check_forces_sum(solution: Solution, loads: np.ndarray) -> None:
    total = sum((contact.force for contact in solution.contacts), start=np.asarray(loads, dtype=float))
    assert_allclose(solution.base_wrench().force, -total, rtol=0, atol=1e-9 * np.abs(total).max())


@pytest.fixture(scope="module")
def table() -> Solution:
    return solved(TABLE, modes=9)


DRUM = """
[[obstacles]]
name = "drum"
kind = "capsule"
from = [0.5, -1.0, -1.03]
to = [0.5, 1.0, -1.03]
radius = 1.0
"""


@pytest.fixture(scope="module")
def bars() -> Solution:
    return solved(ROD + PUSH + TWO_BARS, modes=9)


@pytest.fixture(scope="module")
def wire() -> Solution:
    return solved(WIRE)


def free_span(bending: float = 0.03, weight: float = 0.1 * 9.81, height: float = 0.08) -> tuple[float, float, float]:
    """Length of the span that hangs free, reaction where it meets the table, and x there, by shooting.

    At the table z = −h, θ = 0 and κ = 0: beyond it the rod is straight.
    """

    def span(unknown: np.ndarray) -> np.ndarray:
        length, curvature, force = unknown
        return elastica_end(length, [0.0, 0.0, 0.0, curvature], [0.0, force], bending, weight)

    def missed(unknown: np.ndarray) -> np.ndarray:
        _, z, theta, kappa = span(unknown)
        return np.array([z + height, theta, kappa])

    # Of a beam with small slopes.
    length = (72 * bending * height / weight) ** 0.25
    found = fsolve(missed, [length, -weight * length**2 / (6 * bending), -2 * weight * length / 3], xtol=1e-13)
    assert_allclose(missed(found), 0.0, rtol=0, atol=1e-10)
    length, _, force = found
    return length, force + weight * length, span(found)[0]


def test_a_model_with_a_single_input_is_solved_where_nothing_touches() -> None:
    """A tendon draws a finger onto a table, and lets it off again, when it is an arc: its curvature is that of T e."""
    bending = 1e6 * np.pi * 4e-3**4 / 4
    finger = {
        "name": "finger",
        "length": 0.1,
        "strain": "planar",
        "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.48},
        "section": {"shape": "circle", "radius": 4e-3},
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
    }
    tables = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 8},
        "rods": [finger],
        "actuators": [{"name": "flexor", "kind": "tendon", "rod": "finger", "offset": [4e-3, 0], "tension": 1.0}],
        "obstacles": [{"name": "table", "kind": "plane", "point": [0, 0, -0.01], "normal": [0, 0, 1]}],
    }
    model = build(scene_from_dict(tables))
    drawn, let_off = (solve(model, [tension]) for tension in (1.0, 0.01))
    assert drawn.converged and len(drawn.contacts) == 1
    assert let_off.converged and not let_off.contacts
    curvature = 0.01 * 4e-3 / bending
    depth = (1 - np.cos(curvature * 0.1)) / curvature
    assert_allclose(let_off.tip().position[2], -depth, rtol=1e-9, atol=0)


@pytest.mark.slow
def test_heavy_rod_on_a_table(table: Solution) -> None:
    length, reaction, x = free_span()
    (contact,) = table.contacts
    assert contact.kind == "line"
    assert contact.end == 1.0
    assert_allclose(contact.start * 1.2, length, rtol=0, atol=1e-7)
    assert_allclose(contact.ends, [reaction, 0.0], rtol=0, atol=1e-7)
    assert_allclose(table.tip().position, [x + 1.2 - length, 0.0, -0.08], rtol=0, atol=1e-7)
    # What lies on the table presses by its weight, and by the reaction at lift-off.
    on_table = (1.2 - length) * 0.1 * 9.81
    assert_allclose(contact.force, [0.0, 0.0, reaction + on_table], rtol=0, atol=1e-6)
    check_complementary(table, 1e-8)
    check_forces_sum(table, np.array([0.0, 0.0, -0.1 * 9.81 * 1.2]))
    assert table.stable


@pytest.mark.slow
def test_two_points_of_contact(bars: Solution) -> None:
    first, second = bars.contacts
    assert (first.obstacle, first.kind, second.obstacle, second.kind) == ("bar", "point", "second", "point")
    check_complementary(bars, 1e-8)
    check_forces_sum(bars, np.array([0.0, 0.0, -3.0]))
    assert bars.stable
    # Without friction a force stands on the rod.
    for contact in bars.contacts:
        tangent = bars.pose(contact.start).rotation[:, 2]
        assert_allclose(contact.force @ tangent, 0.0, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_the_internal_wrench_knows_of_contact(bars: Solution) -> None:
    """Beyond the last contact it is the push alone."""
    beyond = np.array([0.9, 1.0])
    rotations = bars.pose(beyond).rotation
    force = np.einsum("kij,kj->ki", rotations, bars.internal_wrench(beyond)[:, 3:])
    assert_allclose(force, [[0.0, 0.0, -3.0]] * 2, rtol=0, atol=1e-9)


def test_result_names_contacts(table: Solution) -> None:
    data = table.to_dict()
    # The forces of contacts are found, not given.
    assert list(data["inputs"]) == ["weight.acceleration"]
    (line,) = data["contacts"]
    (contact,) = table.contacts
    assert (line["obstacle"], line["rod"], line["kind"]) == ("table", "rod", "line")
    assert (line["from"], line["to"]) == (contact.start, 1.0)
    assert_allclose(line["force"], contact.force, rtol=0, atol=0)
    assert_allclose(line["point_forces"], contact.ends, rtol=0, atol=0)
    json.dumps(data)


def test_report_and_figure(table: Solution, tmp_path: Path) -> None:
    console = Console(record=True, width=160)
    print_solution(console, table, [])
    start = table.contacts[0].start
    assert f"X = {start:.6g} to 1" in console.export_text()
    figure = plot_solution(table)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"table", "contact"} <= set(labels)
    table.write(tmp_path / "table.png")
    assert (tmp_path / "table.png").stat().st_size > 10_000


def test_what_knows_of_no_contact_refuses_obstacles(table: Solution) -> None:
    """Beside the rows of the table in the documents, which `test_verbs_in_contact.py` reads."""
    scene = parse_scene(TABLE)
    uses: list[Callable[[], object]] = [
        lambda: stability_margin(table.model),
        lambda: make_plan(scene, None, None, None, quick=True),
    ]
    for use in uses:
        with pytest.raises(SceneError, match="finds no exact contact"):
            use()


def test_a_scene_without_obstacles_is_as_it_was() -> None:
    """Neither the search nor its loads know of a scene that names no obstacle."""
    bare = parse_scene(TABLE[: TABLE.index("[[obstacles]]")])
    named = parse_scene(TABLE)
    first, second = (build(scene, discretise(scene, 4)) for scene in (bare, named))
    # Not one instruction: an obstacle is no part of a model but where a rod is found to touch it.
    assert first.operations(first.residual) == second.operations(second.residual)
    assert first.operations(first.jacobian) == second.operations(second.jacobian)


@pytest.mark.slow
def test_from_a_solution_the_contacts_are_tried_first(bars: Solution) -> None:
    harder = solve(bars.model, {"push.force": [0.0, 0.0, -3.3]}, start=bars)
    check_complementary(harder, 1e-8)
    check_forces_sum(harder, np.array([0.0, 0.0, -3.3]))
    # No load grows from zero once more: a few steps from the old contacts.
    assert harder.iterations < 10


def test_a_depth_that_few_modes_leave_beside_a_line_is_left_to_more_modes() -> None:
    """On 5 modes the rod enters the table before it lies down: no other contacts are sought in place of the line."""
    levels: list[str] = []
    solution = solve(read_scene("examples/rod_on_table.toml"), report=levels.append)
    assert isinstance(solution, Solution)
    radius, length = 8e-3, 1.5
    area = np.pi * radius**2
    free, reaction, _ = free_span(2e6 * area * radius**2 / 4, 1100.0 * 9.81 * area, 0.15 - radius)
    (contact,) = solution.contacts
    assert_allclose(contact.start * length, free, rtol=0, atol=1e-6)
    assert_allclose(contact.ends, [reaction, 0.0], rtol=0, atol=1e-6)
    assert levels == ["5 modes", "7 modes", "9 modes"]
    # Three states are solved; other contacts would take 440 steps more.
    assert solution.iterations < 60


def test_fixed_modes_leave_a_depth_beside_a_line_where_richer_ones_mend_it() -> None:
    """Fixed modes enter the table as few modes do: from a solution the line is kept and only moves."""
    scene_of_table = read_scene("examples/rod_on_table.toml")
    model = build(scene_of_table, discretise(scene_of_table, 5, 12))
    solution = solve(model)
    (contact,) = solution.contacts
    radius, length = 8e-3, 1.5
    area = np.pi * radius**2
    free, _, _ = free_span(2e6 * area * radius**2 / 4, 1100.0 * 9.81 * area, 0.15 - radius)
    assert solution.error_estimate is not None
    assert abs(contact.start - free / length) < solution.error_estimate < 1e-4
    # Other contacts would be sought in 400 steps more.
    assert solution.iterations < 60
    heavier = solve(model, {"weight.acceleration": [0.0, 0.0, -9.9]}, start=solution)
    assert heavier.converged
    assert heavier.iterations < 30


TAPERED = TABLE.replace(
    "stiffness = { bending_x = 0.03, bending_y = 0.03, torsion = 0.02 }\nlinear_density = 0.1",
    "material = { youngs_modulus = 2e6, poisson_ratio = 0.45, density = 1100.0 }\n"
    'section = { shape = "circle", radius = { base = 9e-3, tip = 5e-3 } }',
).replace("-0.08]", "-0.12]")


@pytest.mark.slow
def test_heavy_tapered_rod_on_a_table() -> None:
    """Its centre line comes to lie at the slope of its surface; stiffness and weight fall along the free span."""
    tapered = solved(TAPERED, modes=11)
    (contact,) = tapered.contacts

    def radius(s: float) -> float:
        return 9e-3 - 4e-3 * s / 1.2

    def span(unknown: np.ndarray) -> np.ndarray:
        length, moment, force = unknown

        def rate(s: float, y: np.ndarray) -> list[float]:
            _, theta, bending, shear = y
            stiffness = 2e6 * np.pi / 4 * radius(s) ** 4
            weight = 1100.0 * 9.81 * np.pi * radius(s) ** 2
            return [np.sin(theta), bending / stiffness, -shear * np.cos(theta), weight]

        start = [0.0, 0.0, moment, force]
        return solve_ivp(rate, (0.0, length), start, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]

    def missed(unknown: np.ndarray) -> np.ndarray:
        z, theta, bending, _ = span(unknown)
        return np.array([z + 0.12 - radius(unknown[0]), np.sin(theta) + 4e-3 / 1.2, bending])

    found = fsolve(missed, [0.41, -0.07, -0.7], xtol=1e-13)
    assert_allclose(missed(found), 0.0, rtol=0, atol=1e-10)
    assert_allclose(contact.start * 1.2, found[0], rtol=0, atol=1e-7)
    # What lies on the table is straight and bears no shear: the reaction at lift-off is that of the free span.
    assert_allclose(contact.ends[0], span(found)[3], rtol=1e-5, atol=0)
    check_complementary(tapered, 1e-8)
    volume = np.pi * 1.2 * (9e-3**2 + 9e-3 * 5e-3 + 5e-3**2) / 3
    check_forces_sum(tapered, np.array([0.0, 0.0, -1100.0 * 9.81 * volume]))


@pytest.mark.parametrize("radius", [0.02, pytest.param(0.008, marks=pytest.mark.slow), 1e-4])
def test_under_growing_loads_no_rod_passes_through_a_thin_bar(radius: float) -> None:
    """It comes to rest where the path of the push, which watches every margin, brings it."""
    bar = f"""
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.8, -0.5, {-0.13 - radius}]
to = [0.8, 0.5, {-0.13 - radius}]
radius = {radius}
"""
    rod = """
schema = 1
accuracy = { modes = 4 }
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -1.0]
"""
    held = solve(build(parse_scene(rod + bar)))
    (contact,) = held.contacts
    assert held.stable
    followed = follow(build(parse_scene(rod + bar)), "push.force", [0.0, 0.0, -1.0])
    assert_allclose(held.tip().position, followed.tip().position[-1], rtol=0, atol=1e-8)
    assert_allclose(contact.start, followed.contacts(-1)[0].start, rtol=0, atol=1e-8)


def test_from_a_solution_no_rod_passes_through_a_bar() -> None:
    """Newton's method alone would end below the bar, where nothing touches."""
    planar = ROD.replace('"kirchhoff"', '"planar"') + PUSH
    bar = (
        '[[obstacles]]\nname = "bar"\nkind = "capsule"\nfrom = [0.8, -1, -0.07]\nto = [0.8, 1, -0.07]\nradius = 0.05\n'
    )
    scene = parse_scene(planar + bar)
    model = build(scene, discretise(scene, 4))
    clear = solve(model, {"push.force": [0.0, 0.0, -0.02]})
    assert clear.contacts == ()
    pushed = solve(model, {"push.force": [0.0, 0.0, -0.5]}, start=clear)
    assert [contact.obstacle for contact in pushed.contacts] == ["bar"]
    check_complementary(pushed, 1e-6)


@pytest.mark.slow
def test_tip_on_a_table() -> None:
    """A cantilever whose tip is held up: for small deflections R = P (a²/2)(3 − a)/1 at a = 0.6, less P h EI."""
    text = ROD + PUSH.replace("tip_wrench", "point_wrench").replace("force", "at = 0.6\nforce").replace("-3.0", "-0.02")
    table = '[[obstacles]]\nname = "table"\nkind = "plane"\npoint = [0, 0, -2e-3]\nnormal = [0, 0, 1]\n'
    tip = solved(text + table)
    (contact,) = tip.contacts
    assert (contact.kind, contact.start) == ("point", 1.0)
    expected = 0.02 * 0.6**2 / 2 * (3 - 0.6) - 3 * 0.5 * 2e-3
    assert_allclose(contact.force, [0.0, 0.0, expected], rtol=1e-4, atol=1e-12)
    check_complementary(tip, 1e-9)
    # Pushed with less it stays clear of the table.
    clear = solve(tip.model, {"push.force": [0.0, 0.0, -1e-3]})
    assert clear.converged
    assert clear.contacts == ()
    assert_allclose(clear.base_wrench().force, [0.0, 0.0, 1e-3], rtol=0, atol=1e-12)


@pytest.mark.slow
def test_wire_in_a_lumen(wire: Solution) -> None:
    assert len(wire.contacts) >= 2
    check_complementary(wire, 1e-8)
    check_forces_sum(wire, np.zeros(3))
    assert wire.stable


@pytest.mark.slow
def test_energy_of_a_wedged_wire_is_least(wire: Solution) -> None:
    """No admissible perturbation out of a hundred has less elastic energy."""
    generator = np.random.default_rng(5)
    (rod,) = wire.model.discrete.rods
    (obstacle,) = wire.model.scene.obstacles
    contacts = np.array([contact.start for contact in wire.contacts])

    def gaps(x: np.ndarray, X: np.ndarray) -> np.ndarray:
        return gap_along(Solution(wire.model, wire.inputs, x, Outcome.CONVERGED, "", 0.0, 0), rod, obstacle, X)

    step = 1e-6
    columns = [(gaps(wire.x + step * unit, contacts) - gaps(wire.x, contacts)) / step for unit in np.eye(len(wire.x))]
    by_x = np.transpose(columns)
    looked_at = np.union1d(np.linspace(0.0, 1.0, 101), (contacts[:, None] + np.linspace(-0.02, 0.02, 9)).clip(0, 1))
    least = float(wire.model.energy(wire.x, wire.inputs))
    admissible = 0
    for _ in range(400):
        size = 10.0 ** generator.uniform(-4, -2)
        change = size * generator.normal(size=wire.model.size)
        # Where it would enter the wall it leaves it by some random way instead.
        wanted = size * generator.uniform(0.0, 0.1, len(contacts))
        change += np.linalg.pinv(by_x) @ (wanted - by_x @ change)
        if gaps(wire.x + change, looked_at).min() < 0.0:
            continue
        admissible += 1
        assert float(wire.model.energy(wire.x + change, wire.inputs)) >= least
        if admissible == 100:
            break
    assert admissible == 100


BALL = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0.1, -0.5]
[[obstacles]]
name = "ball"
kind = "sphere"
centre = [0.6, -0.1, -0.2]
radius = 0.15
"""

TURNED_BALL = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0.5, 0.1]
[[obstacles]]
name = "ball"
kind = "sphere"
centre = [0.6, 0.2, -0.1]
radius = 0.15
"""

UPRIGHT_BAR = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 1.0, 0]
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.45, 0.12, -1.0]
to = [0.45, 0.12, 1.0]
radius = 0.1
"""


@pytest.mark.slow
def test_turned_copies() -> None:
    """Turned by a quarter about its axis the rod does the same; a bar touches it as its middle ball does."""
    ball = solved(ROD + BALL)
    turned = solved(ROD + TURNED_BALL)
    # y becomes z, and z becomes −y.
    quarter = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    assert_allclose(turned.tip().position, quarter @ ball.tip().position, rtol=0, atol=1e-10)
    (contact,) = ball.contacts
    (same,) = turned.contacts
    assert_allclose(same.start, contact.start, rtol=0, atol=1e-9)
    assert_allclose(same.force, quarter @ contact.force, rtol=0, atol=1e-9)
    check_complementary(ball, 1e-9)
    check_forces_sum(ball, np.array([0.0, 0.1, -0.5]))
    # In space obstacles are nets.
    assert "ball" in [text.get_text() for text in plot_solution(ball).legends[0].get_texts()]
    bar = solved(ROD + UPRIGHT_BAR)
    in_its_place = 'kind = "sphere"\ncentre = [0.45, 0.12, 0]\nradius = 0.1\n'
    middle = solved(ROD + UPRIGHT_BAR[: UPRIGHT_BAR.index('kind = "capsule"')] + in_its_place)
    assert_allclose(middle.contacts[0].force, bar.contacts[0].force, rtol=0, atol=1e-9)
    assert_allclose(middle.contacts[0].start, bar.contacts[0].start, rtol=0, atol=1e-9)
    # Off a ball the rod slides aside, off a bar it does not.
    assert bar.stable
    assert not middle.stable


@pytest.mark.slow
def test_a_stretch_between_two_ends() -> None:
    """A heavy rod whose tip is lifted lies on the table in between: weight and lift are what it is held up by."""
    lift = '[[loads]]\nname = "lift"\nkind = "tip_wrench"\nrod = "rod"\nforce = [0, 0, 0.15]\n'
    lifted = solved(TABLE.replace("length = 1.2", "length = 1.6") + lift, modes=9)
    (contact,) = lifted.contacts
    assert contact.kind == "line"
    assert 0.2 < contact.start < contact.end < 0.95
    check_complementary(lifted, 1e-8)
    check_forces_sum(lifted, np.array([0.0, 0.0, 0.15 - 0.1 * 9.81 * 1.6]))
    # The free end does not know of the clamp: a longer rod on the table has the same.
    longer = solved(TABLE.replace("length = 1.2", "length = 1.8") + lift, modes=9)
    assert_allclose((1 - longer.contacts[0].end) * 1.8, (1 - contact.end) * 1.6, rtol=0, atol=1e-7)
    assert_allclose(longer.contacts[0].ends, contact.ends, rtol=0, atol=1e-7)


CHANGES: dict[str, Callable[[str], str]] = {
    "clamp": lambda text: text.replace("point = [0, 0, -0.08]", "point = [0, 0, 0.01]"),
    "normal": lambda text: text.replace("normal = [0, 0, 2]", "normal = [0, 0, 0]"),
    "shear": lambda text: text.replace('strain = "planar"', 'strain = "reissner"').replace(
        "torsion = 0.02", "torsion = 0.02, shear_x = 1e3, shear_y = 1e3, extension = 1e3"
    ),
    "rods": lambda text: text + 'rods = ["other"]\n',
    "name": lambda text: text + text[text.index("[[obstacles]]") :],
    "kind": lambda text: text.replace('kind = "plane"', 'kind = "wall"'),
    "square": lambda text: text.replace(
        "stiffness = { bending_x = 0.03, bending_y = 0.03, torsion = 0.02 }",
        'material = { youngs_modulus = 1e9, poisson_ratio = 0.3 }\nsection = { shape = "rectangle", width = 1e-2, '
        "height = 1e-3 }",
    ),
    "narrow": lambda text: WIRE.replace("radius = [4e-3, 4e-3, 5e-3, 4e-3, 4e-3]", "radius = 3e-4"),
    "radii": lambda text: WIRE.replace("radius = [4e-3, ", "radius = ["),
    "points": lambda text: WIRE.replace("[[0, 0, -0.02], [0, 0, 0.04],", "[[0, 0, 0.04], [0, 0, 0.04],"),
    "vessel": lambda text: WIRE.replace('name = "wire"', 'name = "wire"\nbase = { position = [0.02, 0, 0] }'),
    "axis": lambda text: ROD + TWO_BARS.replace("to = [0.4, 1.0, -0.07]", "to = [0.4, -1.0, -0.07]"),
}

REFUSALS = {
    "clamp": ("obstacles.table", "starts 0.01 m inside it"),
    "normal": ("obstacles[0].normal", "must not be zero"),
    "shear": ("obstacles[0]", "admits shear"),
    "rods": ("obstacles[0].rods[0]", "no rod is named"),
    "name": ("obstacles[1].name", "already the name"),
    "kind": ("obstacles[0].kind", "must be one of 'plane'"),
    "square": ("obstacles[0]", "is not round"),
    "vessel": ("obstacles.vessel", "m outside it"),
    "narrow": ("obstacles.vessel.radius", "has the radius"),
    "radii": ("obstacles[0].radius", "one radius for each of 5 points"),
    "points": ("obstacles[0].points[1]", "must differ from the point before it"),
    "axis": ("obstacles[0].to", "must differ from from"),
}


@pytest.mark.parametrize("change", REFUSALS)
def test_refused_scenes(change: str) -> None:
    where, problem = REFUSALS[change]
    with pytest.raises(SceneError) as refused:
        build(parse_scene(CHANGES[change](TABLE)))
    found = {fault.where: fault.problem for fault in refused.value.problems}
    assert problem in found[where]


def test_refused_starts(table: Solution) -> None:
    with pytest.raises(ValueError, match="only continuation finds contacts"):
        solve(table.model, method="rootfinder")
    with pytest.raises(ValueError, match="unknowns name no contacts"):
        solve(table.model, start=table.x)


@pytest.mark.parametrize("name", ["over_a_bar", "lying_on_plane"])
@pytest.mark.slow
def test_reference_cases(name: str) -> None:
    if not EFFECTS.is_dir():
        pytest.skip("the reference cases are not at hand")
    expected = json.loads((EFFECTS / f"{name}.json").read_text())["expected"]
    found = solve(read_scene(EFFECTS / f"{name}.toml"))
    assert found.converged
    assert found.stable
    assert found.error_estimate is not None
    assert found.error_estimate <= 1e-7
    assert_allclose(found.tip().position, expected["tip"]["position"], rtol=0, atol=1e-8)
    assert_allclose(found.base_wrench().force, expected["base_wrench"]["force"], rtol=0, atol=1e-7)
    assert_allclose(found.base_wrench().moment, expected["base_wrench"]["moment"], rtol=0, atol=1e-7)
    (contact,) = found.contacts
    place = expected["contact"].get("at", expected["contact"].get("from"))
    force = expected["contact"].get("force", expected["contact"].get("point_force"))
    assert_allclose(contact.start, place, rtol=0, atol=1e-8)
    assert_allclose(contact.end, expected["contact"].get("to", place), rtol=0, atol=1e-8)
    assert_allclose(contact.ends[0], force, rtol=0, atol=1e-7)
    check_complementary(found, 1e-7)


@pytest.mark.slow
def test_second_variation_of_a_point_that_slides() -> None:
    """The smallest eigenvalue is that of the energy over shapes that touch, found by differences alone.

    The place of contact is sought anew for every shape: as the rod moves the point slides along it.
    """
    planar = ROD.replace('"kirchhoff"', '"planar"') + PUSH.replace("-3.0", "-1.0")
    bar = solved(planar + TWO_BARS[: TWO_BARS.index("[[obstacles]]", 5)], modes=3)
    (contact,) = bar.contacts
    (obstacle,) = bar.model.scene.obstacles
    bare = build(parse_scene(planar), bar.model.discretisation)

    def gap(x: np.ndarray) -> float:
        shape = Solution(bare, bare.pack(), x, Outcome.CONVERGED, "", 0.0, 0)
        around = minimize_scalar(
            lambda X: gap_along(shape, "rod", obstacle, np.array([X]))[0],
            bounds=(contact.start - 0.05, contact.start + 0.05),
            method="bounded",
            options={"xatol": 1e-9},
        )
        return float(around.fun)

    (normal,) = central_differences(gap, bar.x, 1e-5)
    normal /= np.linalg.norm(normal)
    basis = np.linalg.svd(normal[None])[2][1:]

    def energy(along: np.ndarray) -> float:
        shape = bar.x + basis.T @ along
        back = brentq(lambda c: gap(shape + c * normal), -0.05, 0.05, xtol=1e-14)
        return float(bare.potential(shape + back * normal, bare.pack())) / bare.discrete.rods["rod"].energy_unit

    step = 3e-3
    size = len(basis)
    hessian = np.zeros((size, size))
    for i in range(size):
        for j in range(i + 1):
            one, two = step * np.eye(size)[i], step * np.eye(size)[j]
            corners = energy(one + two) - energy(one - two) - energy(two - one) + energy(-one - two)
            hessian[i, j] = hessian[j, i] = corners / (4 * step**2)
    assert_allclose(bar.smallest_eigenvalue, np.linalg.eigvalsh(hessian)[0], rtol=1e-5, atol=0)


@pytest.mark.slow
def test_points_that_stand_for_a_line_have_its_error() -> None:
    """A rod that is pressed on a drum harder than before lies down: a point holds to the tolerance, and is far off."""
    loose = parse_scene((ROD + PUSH + DRUM).replace("1e-6", "1e-3"))
    model = build(loose, discretise(loose, 5))
    less = solve(model, {"push.force": [0, 0, -3.0]})
    inputs = model.inputs.pack({"push.force": [0, 0, -6.0]})
    settling = Settling(without_contacts(loose), inputs, Grids(model.discretisation), NewtonSettings(), 1e-3)
    held, holds = settling.run([(state_in(less.model.scene), less)], admits=lambda _: True)
    assert held is not None and holds
    assert [touch.kind for touch in held.state.touches] == ["point"]
    exact = solve(build(parse_scene((ROD + PUSH + DRUM).replace("1e-6", "1e-7")), model.discretisation), inputs)
    true = pose_distance(held.solution, exact, DENSE)
    places = [abs(held.state.places[0] - contact.start) for contact in exact.contacts]
    assert true < held.unmet() and max(places) < held.unmet() < 3 * max(places)
    # Contacts that hold more closely are looked for from there.
    answer = solve(model, inputs, start=less)
    assert [contact.kind for contact in answer.contacts] == ["line"]
    assert answer.error_estimate is not None
    assert pose_distance(answer, exact, DENSE) < answer.error_estimate < 1e-3
