"""Smooth obstacles that move with bodies: derivatives, action and reaction, beams by hand, shooting, energy."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cosserat_casadi import Model, Outcome, Solution, build, export, follow, load, parse_scene, solve
from cosserat_casadi.control import embedded
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.motion.simulate import simulate
from tests.families import mostly_slow
from tests.reference.planar import elastica_end

HEAD = """
schema = 1
accuracy = { modes = 5, nodes = 12 }
"""

PUSHER = """
[[rods]]
name = "pusher"
length = 1.0
strain = "planar"
stiffness = { bending_y = 0.5 }
linear_density = 0.1
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
[[bodies]]
name = "ball"
mass = 0.05
inertia = [1e-4, 1e-4, 1e-4]
[[joints]]
body = "ball"
rod = "pusher"
kind = "fixed"
[[loads]]
name = "push"
kind = "body_wrench"
body = "ball"
force = [0, 0, -0.5]
"""

PUSHED = """
[[rods]]
name = "pushed"
length = 0.9
strain = "planar"
stiffness = { bending_y = 0.4 }
linear_density = 0.1
base = { position = [0.3, 0, -0.1], tangent = [1, 0, 0] }
"""

WIDTH, STIFFNESS, RADIUS = 0.01, 2000.0, 0.05

DISK = f"""
[[obstacles]]
name = "disk"
kind = "sphere"
body = "ball"
centre = [0, 0, 0]
radius = {RADIUS}
width = {WIDTH}
stiffness = {STIFFNESS}
rods = ["pushed"]
"""

FINGERS = HEAD + PUSHER + PUSHED + DISK

SPACE = (
    HEAD.replace("modes = 5, nodes = 12", "modes = 3, nodes = 8")
    + """
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
base = { position = [0, 0.05, -0.12], tangent = [1, 0, 0.05] }
[[rods]]
name = "carried"
length = 0.5
strain = "reissner"
stiffness = { bending_x = 0.4, bending_y = 0.6, torsion = 0.3, shear_x = 100, shear_y = 100, extension = 1000 }
base = { rod = "pushed", at = 0.6, tangent = [1, 0, 1.05] }
[[bodies]]
name = "ball"
mass = 0.1
[[joints]]
body = "ball"
rod = "pusher"
kind = "fixed"
position = [0.01, 0.02, 0.03]
[[loads]]
name = "push"
kind = "body_wrench"
body = "ball"
force = [0, 0.3, -1.0]
[[obstacles]]
name = "bar"
body = "ball"
width = 0.2
rods = ["pushed", "carried"]
"""
)

KINDS = {
    "sphere": 'kind = "sphere"\ncentre = [0.03, 0.02, 0.05]\nradius = 0.5',
    "capsule": 'kind = "capsule"\nfrom = [0.03, 0.02, 0.05]\nto = [0.3, 0.1, -0.2]\nradius = 0.4',
    "plane": 'kind = "plane"\npoint = [0.03, 0.02, 0.05]\nnormal = [0.5, 0.2, 0.9]',
    "lumen": 'kind = "lumen"\npoints = [[0, 0, -1.0], [0, 0, 0.2], [0.2, 0, 0.4]]\nradius = 0.3',
}


@pytest.fixture(scope="module")
def pressed() -> Solution:
    """A finger whose disk presses on another finger."""
    solution = solve(build(parse_scene(FINGERS.replace("nodes = 12", "nodes = 30"))))
    assert solution.converged, solution.message
    assert solution.stable
    return solution


@pytest.mark.parametrize("kind", mostly_slow(KINDS, ["capsule"]))
def test_derivatives_are_exact(kind: str) -> None:
    """At shapes that are no equilibria, with a rod that is carried by the one that is pressed."""
    model = build(parse_scene(SPACE + KINDS[kind]))
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    for factor in (1.0, 0.7):
        automatic = ca.Function("automatic", [x, inputs], [ca.jacobian(model.path_residual(x, inputs, factor), x)])
        for seed in range(2):
            shape = 0.15 * np.random.default_rng(seed).normal(size=model.size)
            expected = automatic(shape, model.pack()).full()
            written = model.path_jacobian(shape, model.pack(), factor).full()
            assert_allclose(written, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
            assert float(model.contact_depth(shape, model.pack())) > 0.5


@pytest.mark.parametrize("kind", mostly_slow(KINDS, ["plane"]))
def test_action_is_reaction(kind: str) -> None:
    """The two rods and the body, whose clamps alone hold them, in balance of forces and moments."""
    text = SPACE.replace("width = 0.2", "width = 0.02").replace("force = [0, 0.3, -1.0]", "force = [0, 0.02, -0.1]")
    sizes = {
        "sphere": 'kind = "sphere"\ncentre = [0.05, 0.02, -0.3]\nradius = 0.06',
        "capsule": 'kind = "capsule"\nfrom = [0.05, -0.3, -0.3]\nto = [0.05, 0.3, -0.3]\nradius = 0.05',
        "plane": 'kind = "plane"\npoint = [0.1, 0.02, 0.05]\nnormal = [1, 0.1, -0.2]',
        "lumen": 'kind = "lumen"\npoints = [[0.12, 0.03, -2.0], [0.1, 0.03, -0.5], [0.11, 0.04, 1]]\nradius = 0.04',
    }
    model = build(parse_scene(text.replace('"pushed", "carried"]', '"pushed"]') + sizes[kind]))
    solution = solve(model)
    assert solution.converged, solution.message
    assert solution.contacts, "they touch"
    push = np.array([0, 0.02, -0.1])
    pushed, pusher = solution.base_wrench("pushed"), solution.base_wrench("pusher")
    # The clamp of the rod that is pressed, and of what it carries, is told by the forces on the rod alone.
    assert_allclose(pushed.force + pusher.force + push, 0.0, rtol=0, atol=1e-9)
    pressing = sum(contact.force for contact in solution.contacts)
    assert np.linalg.norm(pressing) > 3e-3
    about_origin = np.cross([0, 0.05, -0.12], pushed.force) + pushed.moment + pusher.moment
    about_origin += np.cross(solution.body("ball").position, push)
    assert_allclose(about_origin, 0.0, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_an_obstacle_on_a_body_that_does_not_move_is_one_of_the_world() -> None:
    """The rod that carries it is stiff enough to give way by 1e-8 of its length."""
    table = '[[obstacles]]\nname = "roof"\nkind = "capsule"\nradius = 0.03\nwidth = 0.01\nstiffness = 2e3\n'
    lift = '[[loads]]\nname = "lift"\nkind = "tip_wrench"\nrod = "pushed"\nforce = [0, 0, 0.4]\n'
    held = HEAD + PUSHER.replace("0.5 }", "5e7 }").replace("force = [0, 0, -0.5]", "force = [0, 0, 0]") + PUSHED + lift
    # The body has the axes of the tip: its z is the x of the world, its x points down.
    on_body = solve(
        build(parse_scene(f'{held}{table}from = [0.02, -1, 0]\nto = [0.02, 1, 0]\nbody = "ball"\nrods = ["pushed"]'))
    )
    of_world = solve(build(parse_scene(f'{held}{table}from = [1, -1, -0.02]\nto = [1, 1, -0.02]\nrods = ["pushed"]')))
    assert on_body.converged and of_world.converged
    (first,), (second,) = on_body.contacts, of_world.contacts
    assert abs(second.force[2]) > 0.1
    assert_allclose(first.force, second.force, rtol=0, atol=1e-6)
    assert_allclose(on_body.tip("pushed").position, of_world.tip("pushed").position, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_two_cantilevers_share_a_small_push() -> None:
    """(P − N) L³/3EI of the one less N a³/3EI of the other is the way to the surface, to the square of the slopes."""
    near = (
        FINGERS.replace("nodes = 12", "nodes = 40")
        .replace("[0.3, 0, -0.1]", "[0.3, 0, -0.052]")
        .replace("force = [0, 0, -0.5]", "force = [0, 0, -0.02]")
    )
    solution = solve(build(parse_scene(near)))
    assert solution.converged
    (contact,) = solution.contacts
    assert contact.gap is not None
    way = 0.052 - RADIUS - contact.gap
    pusher, pushed = 1.0 / (3 * 0.5), 0.7**3 / (3 * 0.4)
    expected = (0.02 * pusher - way) / (pusher + pushed)
    assert_allclose(contact.force[2], -expected, rtol=2e-3, atol=0)
    assert 0.3 < expected / 0.02 < 0.9


class Shooting:
    """Two planar elasticas, one with a disk of the smooth law at its tip, as an initial-value problem."""

    def pushed(self, wrench: FloatArray, disk: FloatArray) -> FloatArray:
        """Tip of the rod that is pressed: x, z, angle, force 2, moment, and the force that it took, 2."""

        def rate(s: float, y: FloatArray) -> list[float]:
            x, z, angle, fx, fz, moment = y[:6]
            away = np.array([x, z]) - disk
            distance = float(np.hypot(*away))
            depth = max(WIDTH - (distance - RADIUS), 0.0)
            load = STIFFNESS * depth**3 / (3 * WIDTH**2) * away / distance
            # The angle grows as the rod bends down.
            turn = fx * np.sin(angle) + fz * np.cos(angle)
            return [np.cos(angle), -np.sin(angle), moment / 0.4, -load[0], -load[1], turn, load[0], load[1]]

        start = [0.3, -0.1, 0.0, wrench[0], wrench[1], wrench[2], 0.0, 0.0]
        run = solve_ivp(rate, (0.0, 0.9), start, rtol=1e-10, atol=1e-12, max_step=0.004)
        return np.asarray(run.y[:, -1])

    def pusher(self, wrench: FloatArray) -> FloatArray:
        """Tip of the rod with the disk: x, z, angle and curvature."""
        return elastica_end(1.0, [0.0, 0.0, 0.0, -wrench[2] / 0.5], wrench[:2], 0.5)

    def residual(self, unknowns: FloatArray) -> list[float]:
        """Unknowns: force and moment at both bases, and the place of the disk."""
        first, second, disk = np.split(unknowns, [3, 6])
        tip = self.pusher(first)
        end = self.pushed(second, disk)
        inner = np.array([0.0, -0.5]) - end[6:]
        return [*(tip[:2] - disk), tip[3], *(first[:2] - inner), *end[3:6]]


@pytest.mark.slow
def test_large_deflections_are_those_of_shooting(pressed: Solution) -> None:
    shooting = Shooting()
    pressing = pressed.contacts[0].force[[0, 2]]
    start = [*(np.array([0, -0.5]) - pressing), 0.3, *pressing, 0.2, *pressed.body("ball").position[[0, 2]]]
    found, _, status, message = fsolve(shooting.residual, start, full_output=True, xtol=1e-11)
    assert status == 1, message
    assert_allclose(pressed.body("ball").position[[0, 2]], found[6:], rtol=0, atol=1e-5)
    end = shooting.pushed(found[3:6], found[6:])
    assert_allclose(pressed.tip("pushed").position[[0, 2]], end[:2], rtol=0, atol=1e-5)
    assert_allclose(pressing, end[6:], rtol=0, atol=1e-3)
    # Both rods are bent by tenths of a radian.
    assert min(abs(shooting.pusher(found[:3])[2]), abs(end[2])) > 0.15


def bent_to(solution: Solution, strains: FloatArray) -> tuple[Solution, FloatArray]:
    """Both rods with other strains and the ball at the tip of the one, as if solved; and the place of the ball, m."""
    model, x = solution.model, solution.x.copy()
    x[: len(strains)] = strains
    # A fixed joint in its origin: the body is where the tip is.
    position, quaternion, _ = (part.full()[:, 0] for part in model.tip["pusher"](x, solution.inputs))
    frame = model.discrete.frames[FrameName("body", "ball")]
    where = model.discrete.deviation(FrameName("body", "ball"))
    x[where] = [*((position - frame.start.position) / frame.length), *(quaternion - frame.start.quaternion)]
    return Solution(model, solution.inputs, x, Outcome.CONVERGED, "", residual_norm=0.0, iterations=0), position


def _energy(solution: Solution, strains: FloatArray) -> float:
    """Elastic energy, that of the layer by a sum over sections, and of the push, for strains of both rods."""
    moved, position = bent_to(solution, strains)
    model = solution.model
    grid = model.discrete.rods["pushed"].grid
    nodes = np.asarray(grid.nodes, dtype=float)
    sections = moved.pose(nodes, "pushed").position
    gaps = np.linalg.norm(sections - position, axis=1) - RADIUS
    layer = STIFFNESS / (12 * WIDTH**2) * np.maximum(WIDTH - gaps, 0.0) ** 4
    return float(model.energy(moved.x, moved.inputs)) + 0.9 * float(grid.weights @ layer) + 0.5 * float(position[2])


@pytest.mark.slow
def test_every_variation_costs_energy(pressed: Solution) -> None:
    """The equilibrium is where the energy of all is least: the forces on rod and body are derivatives of one."""
    model = pressed.model
    count = sum(rod.size for rod in model.discrete.rods.values())
    strains = pressed.x[:count]
    least = _energy(pressed, strains)
    rng = np.random.default_rng(3)
    for _ in range(20):
        change = 2e-4 * rng.normal(size=count)
        above = _energy(pressed, strains + change)
        below = _energy(pressed, strains - change)
        assert above > least and below > least
        # Symmetric to the third order: there is no slope.
        assert abs(above - below) < 0.05 * (above + below - 2 * least)


def test_the_jacobian_of_an_equilibrium_is_symmetric(pressed: Solution) -> None:
    jacobian = pressed.model.jacobian(pressed.x, pressed.inputs)[0].full()
    units = np.asarray(pressed.model.discrete.unknowns.units)
    matrix = units[:, None] * jacobian
    frame = pressed.model.discrete.deviation(FrameName("body", "ball"))
    block = matrix[:, frame]
    count = sum(rod.size for rod in pressed.model.discrete.rods.values())
    assert_allclose(block[:count], matrix[frame, :count].T, rtol=0, atol=1e-9 * np.abs(block).max())
    assert np.abs(block[:count]).max() > 0.1


def test_what_takes_loads_takes_obstacles_on_bodies(pressed: Solution) -> None:
    model = pressed.model
    followed = follow(model, "push.force", [0.0, 0.0, -0.5], values={"push.force": [0.0, 0.0, -0.1]})
    assert followed.converged
    assert_allclose(followed.tip("pushed").position[-1], pressed.tip("pushed").position, rtol=0, atol=1e-9)
    assert embedded(model, pressed) is not None
    # Inertia adds nothing at rest: the equations of motion are those of statics there.
    still = np.zeros(model.size)
    rest = np.zeros(model.inputs.size)
    moving = model.inverse_dynamics(pressed.x, still, still, pressed.inputs, rest, rest).full()[:, 0]
    assert_allclose(moving, 0.0, rtol=0, atol=1e-10)


def test_derivatives_of_the_motion_are_exact(pressed: Solution) -> None:
    model = pressed.model
    x, v, a = (ca.MX.sym(name, model.size) for name in "xva")
    rest = np.zeros(model.inputs.size)
    residual = model.inverse_dynamics(x, v, a, pressed.inputs, rest, rest)
    automatic = ca.Function("automatic", [x, v, a], [ca.jacobian(residual, part) for part in (x, v, a)])
    rng = np.random.default_rng(5)
    rates = 0.3 * rng.normal(size=(2, model.size))
    state = pressed.x + 1e-3 * rng.normal(size=model.size)
    written = model.dynamics_jacobian(state, *rates, pressed.inputs, rest, rest)[:3]
    for one, other in zip(written, automatic(state, *rates), strict=True):
        assert_allclose(one.full(), other.full(), rtol=0, atol=1e-11 * float(ca.norm_inf(other)))


@pytest.mark.slow
def test_the_energy_of_a_motion_balances() -> None:
    """Two fingers that swing against each other, without damping."""
    motion = """
[simulation]
duration = 0.3
[[motions]]
input = "push.force"
times = [0, 0.05]
values = [[0, 0, -0.4], [0, 0, 0.4]]
"""
    scene = parse_scene(FINGERS.replace("modes = 5, nodes = 12", "modes = 3, nodes = 8") + motion)
    found = simulate(build(scene.with_motion_inputs(), moving=True))
    assert found.converged, found.message
    assert found.energy.potential.max() > 1e-4
    assert np.abs(found.energy.imbalance).max() < 1e-4


@pytest.mark.slow
def test_c_presses_as_python_does(pressed: Solution, tmp_path: Path) -> None:
    model = build(parse_scene(FINGERS.replace("modes = 5, nodes = 12", "modes = 3, nodes = 8")))
    expected = solve(model)
    export(model, tmp_path / "fingers", "fingers")
    found = load(tmp_path / "fingers").solve(expected.inputs)
    assert_allclose(found.x, expected.x, rtol=0, atol=1e-9)


def test_a_scene_pays_only_for_what_moves_with_a_body() -> None:
    """An obstacle of the world costs what it did; one on a body more."""
    coarse = HEAD.replace("modes = 5, nodes = 12", "modes = 2, nodes = 4") + PUSHER + PUSHED
    counts = []
    for obstacle in (DISK, DISK.replace('body = "ball"\n', "").replace("[0, 0, 0]", "[1, 0, 0]")):
        scene = parse_scene(coarse + obstacle.replace(f"width = {WIDTH}", "width = 0.04"))
        model: Model = build(scene)
        counts.append([model.operations(function) for function in (model.residual, model.jacobian)])
    assert all(on_body > of_world for on_body, of_world in zip(*counts, strict=True))


REFUSED = {
    "no rods": (DISK.replace('rods = ["pushed"]\n', ""), "obstacles[0].rods: missing"),
    "bodies too": (DISK + 'bodies = ["ball"]\n', "keeps off only rods"),
    "no such body": (DISK.replace('body = "ball"', 'body = "bell"'), "no body is named 'bell'"),
    "its own rod": (DISK.replace('["pushed"]', '["pusher"]'), "'pusher' is held by its body 0.05 m inside it"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_scenes(case: str) -> None:
    obstacle, sentence = REFUSED[case]
    with pytest.raises(SceneError) as caught:
        build(parse_scene(HEAD + PUSHER + PUSHED + obstacle))
    assert sentence in str(caught.value)
