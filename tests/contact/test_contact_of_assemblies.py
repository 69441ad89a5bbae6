"""Exact contact of carried rods, closed loops and bodies: one rod instead of two, statics by hand, sums, energy."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console
from scipy.optimize import brentq

from cosserat_casadi import Solution, build, export, follow, parse_scene, solve
from cosserat_casadi.cli.reports.solution import print_solution
from cosserat_casadi.codegen.rows import row_results
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_state import state_in, without_contacts
from cosserat_casadi.equilibrium.contact.gaps import body_gap, body_pairs, gap_along, pairs
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.paths.contact_path import ContactPath
from cosserat_casadi.scene import Scene, with_exact_contact
from cosserat_casadi.sweeps.row_model import RowModel
from cosserat_casadi.sweeps.run import plan_sweep
from cosserat_casadi.sweeps.table import table_of

DENSE = np.linspace(0.0, 1.0, 3001)

HEAD = """
schema = 1
accuracy = { modes = 6 }
"""

STIFF = "stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }"

ROD = f"""
[[rods]]
name = "rod"
length = 1.0
strain = "kirchhoff"
{STIFF}
base = {{ position = [0, 0, 0], tangent = [1, 0, 0] }}
"""

PUSH = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -1.0]
"""

BAR = """
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.4, -0.5, -0.12]
to = [0.5, 0.5, -0.12]
radius = 0.1
"""

BALL = """
[[bodies]]
name = "ball"
radius = 0.05
[[joints]]
body = "ball"
rod = "rod"
kind = "fixed"
"""

DOME = """
[[obstacles]]
name = "dome"
kind = "sphere"
centre = [0.9, 0.03, -0.6]
radius = 0.35
bodies = ["ball"]
"""

FRAME = """
[[rods]]
name = "left"
length = 0.5
strain = "planar"
stiffness = { bending_y = 0.3 }
[[rods]]
name = "right"
length = 0.5
strain = "planar"
stiffness = { bending_y = 0.3 }
base = { position = [0.3, 0, 0] }
[[bodies]]
name = "deck"
radius = 0.04
[[joints]]
body = "deck"
rod = "left"
kind = "fixed"
position = [-0.15, 0, 0]
[[joints]]
body = "deck"
rod = "right"
kind = "fixed"
position = [0.15, 0, 0]
[[loads]]
name = "push"
kind = "body_wrench"
body = "deck"
force = [2.0, 0, -1.0]
"""

WALL = """
[[obstacles]]
name = "wall"
kind = "plane"
point = [0.2, 0, 0.5]
normal = [-1, 0, 0.1]
bodies = ["deck"]
"""


PEG = """
[[obstacles]]
name = "peg"
kind = "capsule"
from = [0.322, -1, 0.2]
to = [0.322, 1, 0.2]
radius = 0.02
rods = ["right"]
"""


def solved(text: str) -> Solution:
    solution = solve(build(parse_scene(HEAD + text)))
    assert solution.converged, solution.message
    return solution


def chain(share: float) -> str:
    """The rod over the bar made of two, the first of which is a share of it."""
    first = ROD.replace('"rod"', '"first"').replace("length = 1.0", f"length = {share}")
    second = ROD.replace("length = 1.0", f"length = {1 - share}")
    carried = second.replace("base = { position = [0, 0, 0], tangent = [1, 0, 0] }", 'base = { rod = "first" }')
    return first + carried + PUSH + BAR


def check_complementary(solution: Solution, tolerance: float) -> None:
    """Nothing is inside an obstacle, no force pulls, and forces act where the gap is zero alone."""
    scene = solution.model.scene
    for rod, obstacle in pairs(scene):
        assert gap_along(solution, rod, obstacle, DENSE).min() >= -tolerance
    for body, obstacle in body_pairs(scene):
        assert body_gap(solution, body, obstacle) >= -tolerance
    obstacles = {obstacle.name: obstacle for obstacle in scene.obstacles}
    bodies = {body.name: body for body in scene.bodies}
    for contact in solution.contacts:
        assert min(contact.ends) > 0.0
        if contact.of_body:
            gaps = np.array([body_gap(solution, bodies[contact.owner], obstacles[contact.obstacle])])
        else:
            X = np.linspace(contact.start, contact.end, 101)
            gaps = gap_along(solution, contact.owner, obstacles[contact.obstacle], X)
        assert_allclose(gaps, 0.0, rtol=0, atol=tolerance)


@pytest.fixture(scope="module")
def one_rod() -> Solution:
    return solved(ROD + PUSH + BAR)


@pytest.fixture(scope="module")
def on_dome() -> Solution:
    return solved(ROD + PUSH + BALL + DOME)


# Carried rods


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "touching", "atol"),
    [
        (0.3, "rod", 1e-9),
        (0.6, "first", 1e-9),
        # The place of contact is next to the joint, on either side, and on it: there the tip of the first rod touches.
        (0.455, "rod", 1e-9),
        (0.47, "first", 1e-9),
        (0.46958636, "first", 1e-7),
    ],
)
def test_two_rods_in_series_touch_as_one(one_rod: Solution, share: float, touching: str, atol: float) -> None:
    two = solved(chain(share))
    assert_allclose(two.tip("rod").position, one_rod.tip().position, rtol=0, atol=atol)
    (contact,) = two.contacts
    (expected,) = one_rod.contacts
    assert contact.owner == touching
    place = share * contact.start if touching == "first" else share + (1 - share) * contact.start
    assert_allclose(place, expected.start, rtol=0, atol=atol)
    assert_allclose(contact.force, expected.force, rtol=0, atol=10 * atol)
    assert two.stable and one_rod.stable
    check_complementary(two, 1e-9)


BRANCH = (
    ROD
    + f"""linear_density = 0.05
[[rods]]
name = "twig"
length = 0.5
strain = "kirchhoff"
{STIFF.replace("0.5", "0.1")}
linear_density = 0.05
base = {{ rod = "rod", at = 0.6, position = [0, 0.01, 0], quaternion = [0.8, -0.6, 0, 0] }}
[[bodies]]
name = "fruit"
mass = 0.02
radius = 0.03
[[joints]]
body = "fruit"
rod = "twig"
kind = "fixed"
position = [0, 0, -0.03]
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "shelf"
kind = "plane"
point = [0, 0, -0.15]
normal = [0.1, 0.05, 1]
bodies = ["fruit"]
[[obstacles]]
name = "peg"
kind = "capsule"
from = [0.4, -1, -0.05]
to = [0.45, 1, -0.05]
radius = 0.02
rods = ["rod", "twig"]
"""
)


def _mean(solution: Solution, rod: str) -> np.ndarray:
    """Mean position of a rod, element by element, in each of which it is smooth."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    ends = solution.model.element_ends(rod)
    mean = np.zeros(3)
    for start, end in itertools.pairwise(ends):
        X = start + (end - start) * (nodes + 1) / 2
        mean += (end - start) / 2 * weights @ solution.pose(X, rod).position
    return mean


@pytest.mark.slow
def test_a_tree_whose_fruit_and_branch_touch_is_in_balance() -> None:
    """Force and moment of the clamp make up, about the base, for weights and contacts."""
    tree = solved(BRANCH)
    assert {(contact.owner, contact.of_body) for contact in tree.contacts} == {("rod", False), ("fruit", True)}
    check_complementary(tree, 1e-9)
    down = np.array([0.0, 0.0, -9.81])
    fruit = tree.body("fruit").position
    forces = [0.02 * down]
    moments = [0.02 * np.cross(fruit, down)]
    for rod, mass in (("rod", 0.05), ("twig", 0.025)):
        centre = _mean(tree, rod)
        forces.append(mass * down)
        moments.append(mass * np.cross(centre, down))
    for contact in tree.contacts:
        at = fruit if contact.of_body else tree.pose(contact.start, contact.owner).position
        forces.append(contact.force)
        moments.append(np.cross(at, contact.force))
    wrench = tree.base_wrench("rod")
    assert_allclose(wrench.force, -np.sum(forces, axis=0), rtol=0, atol=1e-9)
    assert_allclose(wrench.moment, -np.sum(moments, axis=0), rtol=0, atol=1e-8)


HEAVY = """
[[rods]]
name = "first"
length = 0.9
strain = "planar"
stiffness = { bending_y = 0.03 }
linear_density = 0.1
base = { tangent = [1, 0, 0] }
[[rods]]
name = "rod"
length = 0.3
strain = "planar"
stiffness = { bending_y = 0.03 }
linear_density = 0.1
base = { rod = "first" }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.08]
normal = [0, 0, 1]
"""


def test_a_line_over_a_joint_is_not_settled_and_named() -> None:
    lying = solve(build(parse_scene(HEAD + HEAVY)))
    assert lying.outcome is Outcome.CONTACT_UNSETTLED
    assert "'first' and 'rod' lie on 'table' on both sides of their joint" in lying.message
    assert not lying.stable


@pytest.mark.slow
def test_a_line_on_the_last_rod_of_a_chain_is_that_of_one_rod() -> None:
    """Where the first rod ends in the air, the second lies on the table as the end of one rod does."""
    cut = solved(HEAVY.replace("length = 0.9", "length = 0.4").replace("length = 0.3", "length = 0.8"))
    whole = HEAVY[: HEAVY.index('[[rods]]\nname = "rod"')] + HEAVY[HEAVY.index("[[loads]]") :]
    one = solved(whole.replace("length = 0.9", "length = 1.2"))
    (contact,) = cut.contacts
    (expected,) = one.contacts
    assert contact.kind == expected.kind == "line"
    assert_allclose(0.4 + 0.8 * contact.start, 1.2 * expected.start, rtol=0, atol=1e-6)
    assert_allclose(contact.force, expected.force, rtol=0, atol=1e-6)


# Bodies


def test_a_ball_on_a_dome(on_dome: Solution) -> None:
    (contact,) = on_dome.contacts
    assert (contact.owner, contact.obstacle, contact.kind, contact.of_body) == ("ball", "dome", "point", True)
    check_complementary(on_dome, 1e-12)
    # The force is along the line of centres, and the clamp bears the rest.
    out = on_dome.body().position - [0.9, 0.03, -0.6]
    assert_allclose(contact.force, contact.ends[0] * out / 0.4, rtol=0, atol=1e-12)
    assert_allclose(on_dome.base_wrench().force, -contact.force - [0, 0, -1.0], rtol=0, atol=1e-10)


@pytest.mark.parametrize("bending", [50.0, pytest.param(500.0, marks=pytest.mark.slow)])
def test_a_nearly_rigid_rod_presses_as_statics_by_hand_says(bending: float) -> None:
    """Off the top of a sphere, by an angle α, a load F on the ball presses with F cos α; the rod bears the rest.

    As the rod bends by F/EI the error falls with its stiffness.
    """
    alpha = 0.4
    normal = np.array([0.0, np.sin(alpha), np.cos(alpha)])
    centre = np.array([1.0, 0.0, 0.0]) - 0.4 * normal
    sphere = f'[[obstacles]]\nname = "dome"\nkind = "sphere"\ncentre = {centre.tolist()}\nradius = 0.35\n'
    stiff = ROD.replace("bending_x = 0.5, bending_y = 0.5", f"bending_x = {bending}, bending_y = {bending}")
    pressed = solved(stiff + PUSH + BALL + sphere + 'bodies = ["ball"]\n')
    (contact,) = pressed.contacts
    assert_allclose(contact.ends[0], np.cos(alpha), rtol=0, atol=0.15 / bending)
    assert_allclose(contact.ends[0], np.cos(alpha), rtol=0, atol=0.5 / bending)
    slide = -np.array([0.0, 0.0, 1.0]) + np.cos(alpha) * normal
    assert_allclose(pressed.body().position - [1, 0, 0], slide / (3 * bending), rtol=0, atol=0.2 / bending**2)


@pytest.mark.parametrize(("share", "stable"), [pytest.param(0.98, True, marks=pytest.mark.slow), (1.02, False)])
def test_a_ball_on_top_of_a_dome_rolls_off_at_the_load_that_theory_says(share: float, stable: bool) -> None:
    """Aside by v it sinks by v²/(2 (R + ρ)), and the rod pulls it back with 3 EI v/L³: it is stable below that load.

    With a thin layer instead of the exact contact the sign of the second variation is the same.
    """
    critical = 3 * 0.5 * 0.4
    push = PUSH.replace("-1.0", f"{-share * critical}")
    dome = DOME.replace("[0.9, 0.03, -0.6]", "[1.0, 0.0, -0.4]")
    on_top = solved(ROD + push + BALL + dome)
    assert_allclose(on_top.contacts[0].ends[0], share * critical, rtol=1e-9, atol=0)
    assert on_top.stable == stable
    layer = solved(ROD + push + BALL + dome + "width = 1e-3\n")
    assert layer.stable == stable


@pytest.mark.slow
def test_energy_on_the_dome_is_least(on_dome: Solution) -> None:
    """None of 100 shapes beside it, whose ball is outside of the dome, has less energy."""
    bare = build(parse_scene(HEAD + ROD + PUSH), on_dome.model.discretisation)
    strains = on_dome.model.discrete.unknowns.strain("rod")
    x = on_dome.x[strains]
    inputs = bare.pack()
    least = float(bare.potential(x, inputs))
    random = np.random.default_rng(7)
    outside = 0
    tried = 0
    while outside < 100:
        tried += 1
        assert tried < 1000
        other = x + 0.05 * random.standard_normal(len(x)) / (1 + np.arange(len(x)) % 6) ** 2
        tip = bare.fields["rod"](other, inputs)[0].full()[:, -1]
        if np.linalg.norm(tip - [0.9, 0.03, -0.6]) < 0.4:
            continue
        outside += 1
        assert float(bare.potential(other, inputs)) > least


@pytest.mark.slow
def test_smooth_contact_of_a_body_becomes_exact_as_the_width_shrinks(on_dome: Solution) -> None:
    scene = parse_scene(HEAD + ROD + PUSH + BALL + DOME)
    off = []
    for width in (0.016, 0.008, 0.004):
        smooth = parse_scene(HEAD + ROD + PUSH + BALL + DOME + f"width = {width}\n")
        assert with_exact_contact(smooth) == scene
        near = solve(build(smooth))
        assert near.converged
        off.append(np.linalg.norm(near.body().position - on_dome.body().position))
    rates = np.log2(np.divide(off[:-1], off[1:]))
    assert_allclose(rates, 1.0, rtol=0, atol=0.1)


# Closed loops


@pytest.fixture(scope="module")
def frame() -> Solution:
    return solved(FRAME + WALL)


@pytest.mark.slow
def test_a_frame_that_leans_on_a_wall(frame: Solution) -> None:
    (contact,) = frame.contacts
    assert contact.of_body
    check_complementary(frame, 1e-12)
    bases = sum(frame.base_wrench(rod).force for rod in ("left", "right"))
    assert_allclose(bases, -contact.force - [2.0, 0, -1.0], rtol=0, atol=1e-9)
    assert frame.stable
    # Leaning takes what the frame would give: it is stiffer than without the wall.
    free = solved(FRAME)
    assert free.body().position[0] > frame.body().position[0] + 0.01
    assert free.smallest_eigenvalue is not None and frame.smallest_eigenvalue is not None
    assert frame.smallest_eigenvalue > free.smallest_eigenvalue


@pytest.mark.slow
def test_a_leg_of_a_loop_and_its_body_touch() -> None:
    held = solved(FRAME.replace("[2.0, 0, -1.0]", "[4.0, 0, -1.0]") + WALL + PEG)
    assert {(contact.owner, contact.obstacle) for contact in held.contacts} == {("deck", "wall"), ("right", "peg")}
    check_complementary(held, 1e-9)
    bases = sum(held.base_wrench(rod).force for rod in ("left", "right"))
    contacts = sum(contact.force for contact in held.contacts)
    assert_allclose(bases, -contacts - [4.0, 0, -1.0], rtol=0, atol=1e-9)
    assert held.stable


def test_the_jacobian_is_exact(frame: Solution) -> None:
    scene = without_contacts(frame.model.scene)
    given = input_layout(scene).pack()
    equations = ContactEquations(scene, given, Grids(frame.model.discretisation), state_in(frame.model.scene))
    z = np.concatenate([frame.x, [1.3]])
    random = np.random.default_rng(3)
    for _ in range(3):
        way = random.standard_normal(len(z))
        step = 1e-6
        by_difference = equations.residual(z + step * way, given) - equations.residual(z - step * way, given)
        assert_allclose(equations.jacobian(z, given) @ way, by_difference / (2 * step), rtol=1e-6, atol=1e-6)


# Paths


@pytest.fixture(scope="module")
def lowered() -> ContactPath:
    path = follow(build(parse_scene(HEAD + ROD + PUSH + BALL + DOME)), "push.force", [0.0, 0.0, -1.0])
    assert isinstance(path, ContactPath)
    return path


@pytest.mark.slow
def test_a_ball_comes_down_on_a_dome(lowered: ContactPath, on_dome: Solution) -> None:
    (touch,) = lowered.events
    assert touch.kind == "touch"
    assert touch.contact is not None and touch.contact.of_body
    bare = build(parse_scene(HEAD + ROD + PUSH + BALL))

    def gap(factor: float) -> float:
        free = solve(bare, {"push.force": [0.0, 0.0, -factor]})
        return float(np.linalg.norm(free.body().position - [0.9, 0.03, -0.6]) - 0.4)

    assert_allclose(touch.factor, brentq(gap, 0.1, 0.5, xtol=1e-12), rtol=0, atol=1e-8)
    end = lowered.solution(-1)
    assert_allclose(end.contacts[0].ends, on_dome.contacts[0].ends, rtol=1e-9, atol=0)
    assert end.smallest_eigenvalue is not None and lowered.smallest_eigenvalue is not None
    assert_allclose(lowered.smallest_eigenvalue[-1], end.smallest_eigenvalue, rtol=1e-9, atol=0)
    entry = lowered.to_dict()["events"][0]["contact"]
    assert entry == {"obstacle": "dome", "body": "ball", "kind": "point"}


@pytest.mark.slow
def test_a_ball_lifts_off_where_it_came_down(lowered: ContactPath) -> None:
    lift = PUSH.replace('"push"', '"lift"').replace("-1.0", "0.0")
    model = build(parse_scene(HEAD + ROD + PUSH + lift + BALL + DOME))
    lifted = follow(model, "lift.force", [0.0, 0.0, 0.95])
    (event,) = lifted.events
    assert event.kind == "lift_off"
    assert_allclose(1.0 - 0.95 * event.factor, lowered.events[0].factor, rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.46, 0.4786])
def test_along_a_path_a_point_slides_from_one_rod_to_the_next(share: float) -> None:
    """As along one rod: at the same loads it touches, and ends with the same place, force and stability."""
    growing = ("push.force", [0.0, 0.0, -2.0])
    whole = follow(build(parse_scene(HEAD + ROD + PUSH + BAR)), *growing)
    cut = follow(build(parse_scene(HEAD + chain(share))), *growing)
    assert [event.kind for event in cut.events] == ["touch", "slide_over_joint"]
    assert_allclose(cut.events[0].factor, whole.events[0].factor, rtol=0, atol=1e-9)
    (expected,) = whole.contacts(-1)
    (contact,) = cut.contacts(-1)
    assert contact.owner == "rod"
    assert_allclose(share + (1 - share) * contact.start, expected.start, rtol=0, atol=1e-9)
    assert_allclose(contact.ends, expected.ends, rtol=1e-8, atol=0)
    # At the event its place on the first rod is a little before the joint, as it is along the whole one.
    at_event = np.interp(cut.events[1].factor, whole.factor, [_place(whole, i) for i in range(len(whole.factor))])
    assert_allclose(at_event, share, rtol=0, atol=2e-3)


def _place(path: ContactPath, index: int) -> float:
    """Where the one contact of a point of a path begins, NaN without any."""
    contacts = path.contacts(index)
    return contacts[0].start if contacts else np.nan


@pytest.mark.slow
def test_a_point_slides_back_over_the_joint() -> None:
    """Against the force that has drawn it on to the second rod another draws it back."""
    lift = PUSH.replace('"push"', '"lift"').replace("-1.0", "0.0")
    model = build(parse_scene(HEAD + chain(0.46) + lift))
    path = follow(model, "lift.force", [0.0, 0.0, 0.95])
    assert [event.kind for event in path.events] == ["slide_over_joint", "lift_off"]
    back = path.events[0].contact
    assert back is not None and back.owner == "rod"


@pytest.mark.slow
def test_a_path_ends_where_a_point_comes_to_a_rod_on_its_rod_and_says_so() -> None:
    """A solve beyond finds the contact on the other side, where the rod alone has it: the twig bears nothing."""
    twig = """
[[rods]]
name = "twig"
length = 0.1
strain = "planar"
stiffness = { bending_y = 0.5 }
base = { rod = "rod", at = 0.46, quaternion = [0.8, 0.6, 0, 0] }
"""
    model = build(parse_scene(HEAD + ROD + twig + PUSH + BAR + 'rods = ["rod"]\n'))
    path = follow(model, "push.force", [0.0, 0.0, -1.0])
    assert not path.converged
    assert path.factor[-1] < 1.0
    assert "'rod' with 'bar' has come to X = 0.46, where a load or another rod acts" in path.message
    beyond = solve(model)
    assert beyond.converged
    (contact,) = beyond.contacts
    assert contact.start > 0.465


# Results


def test_results_name_the_body(on_dome: Solution, tmp_path: Path) -> None:
    (entry,) = on_dome.to_dict()["contacts"]
    assert (entry["body"], entry["kind"]) == ("ball", "point")
    assert "rod" not in entry and len(entry["point_forces"]) == 1
    console = Console(record=True, width=200)
    print_solution(console, on_dome, [])
    assert "body" in console.export_text()
    on_dome.write(tmp_path / "ball.png")


def test_rows_tell_the_force_on_the_body(on_dome: Solution) -> None:
    text = HEAD + ROD + PUSH + BALL + DOME
    names = row_results(parse_scene(text))
    (row,) = RowModel(text).solve(on_dome.model.inputs.pack()[None, :3])
    by_name = dict(zip(names, row, strict=True))
    assert by_name["ball.dome.contacts"] == 1.0
    force = [by_name[f"ball.dome.force.{axis}"] for axis in "xyz"]
    assert_allclose(force, on_dome.contacts[0].force, rtol=1e-9, atol=1e-12)


FREE = ROD.replace("base = { position = [0, 0, 0], tangent = [1, 0, 0] }", "base = { free = true }")

HELD_BY_CONTACT = {"free rod": FREE + BAR, "ball of a free rod": FREE + BALL + DOME}

STATICS: dict[str, Callable[[Scene, Path], object]] = {
    "solve a model": lambda scene, _: solve(build(scene)),
    "solve": lambda scene, _: solve(scene),
    "follow": lambda scene, _: follow(build(scene), "push.force", [0, 0, -2.0]),
    "plan_sweep": lambda scene, _: plan_sweep(scene, table_of({"push.force.z": [-1.0]})),
    "export": lambda scene, folder: export(build(scene), folder),
}


@pytest.mark.parametrize("case", HELD_BY_CONTACT)
@pytest.mark.parametrize("what", STATICS)
def test_free_rods_are_not_held_by_contact_alone(case: str, what: str, tmp_path: Path) -> None:
    scene = parse_scene(HEAD + HELD_BY_CONTACT[case] + PUSH)
    with pytest.raises((SceneError, ExportError), match="is free: at rest only contact could hold it"):
        STATICS[what](scene, tmp_path / "c")


REFUSED = {
    "too wide": (
        ROD
        + BALL
        + DOME[: DOME.index("kind")]
        + 'kind = "lumen"\npoints = [[-0.1, 0, 0], [1.2, 0, 0]]\nradius = 0.04\n'
        'bodies = ["ball"]\n',
        "has the radius",
    ),
    "no radius": (ROD + BALL.replace("radius = 0.05", "") + DOME, "has no radius to keep"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_scenes(case: str) -> None:
    text, problem = REFUSED[case]
    with pytest.raises(SceneError, match=problem):
        build(parse_scene(HEAD + text))
