"""Obstacles with a width: kernels, closed forms, convergence to exact contact, motion, and all that takes loads."""

from __future__ import annotations

import itertools
import pickle
import re
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import (
    Model,
    Outcome,
    PathOutcome,
    Solution,
    build,
    discretise,
    export,
    follow,
    identify,
    inverse,
    linearise,
    load,
    modes_of,
    parse_scene,
    read_scene,
    simulate,
    solve,
    sweep,
)
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.control import embedded, stability_margin
from cosserat_casadi.equilibrium.contact.passing_through import LookedAt
from cosserat_casadi.equilibrium.load_path import continuation_limits, input_path
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers, past_no_obstacle
from cosserat_casadi.equilibrium.solve import is_behind
from cosserat_casadi.errors import SceneError
from cosserat_casadi.estimation.estimate import estimate
from cosserat_casadi.loads.contact_layer import ContactLayer, ContactLayerLoad
from cosserat_casadi.loads.load_trace import traced
from cosserat_casadi.scene import with_exact_contact
from cosserat_casadi.sweeps.run import plan_sweep
from cosserat_casadi.sweeps.table import table_of
from tests.commands import cosserat
from tests.conftest import ROOT
from tests.derivatives import central_differences
from tests.families import mostly_slow
from tests.pose_errors import pose_error

EXAMPLES = ROOT / "examples"
WIDTH = 0.01
STIFFNESS = 600.0

ROD = """
schema = 1
accuracy = { modes = 5, nodes = 12 }
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
linear_density = 0.1
base = { position = [0, 0, 0], tangent = [1, 0, 0] }
"""

PUSH = """
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -0.6]
"""

TABLE = f"""
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.06]
normal = [0, 0, 1]
width = {WIDTH}
"""

OBSTACLES = {
    "plane": 'kind = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]',
    "sphere": 'kind = "sphere"\ncentre = [0, 0, 0]\nradius = 0.1',
    "capsule": 'kind = "capsule"\nfrom = [0, -0.2, 0]\nto = [0, 0.2, 0]\nradius = 0.1',
    "lumen": 'kind = "lumen"\npoints = [[0, 0, -0.1], [0, 0, 0.2], [0.05, 0, 0.4]]\nradius = 0.1',
}


def layer_of(obstacle: str) -> ContactLayer:
    """The layer in front of an obstacle of the origin."""
    scene = parse_scene(f'{ROD}[[obstacles]]\nname = "it"\n{OBSTACLES[obstacle]}\nwidth = {WIDTH}\n')
    return ContactLayer.model_construct(name="layer", obstacle=scene.obstacles[0], stiffness=STIFFNESS, rod="rod")


def kernels(obstacle: str) -> tuple[ca.Function, ca.Function, ca.Function]:
    """Energy, force and stiffness of a layer as functions of the point; sections have a radius of 2 mm."""
    kernel = traced(ContactLayerLoad(), layer_of(obstacle), {}, 1).kernel
    point = ca.SX.sym("point", 3)
    origin = [ca.DM.eye(3), ca.DM.zeros(3, 1), ca.DM.eye(3), ca.DM(0, 1), ca.vertcat(1, 1, 2e-3)]
    force, _ = kernel.wrench(point, *origin)
    assert kernel.energy is not None
    results = [kernel.energy(point, *origin), force, kernel.stiffness(point, *origin)]
    energy, force, stiffness = (ca.Function("kernel", [point], [value]) for value in results)
    return energy, force, stiffness


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_kernels_are_derivatives_of_their_energy(obstacle: str) -> None:
    energy, force, stiffness = kernels(obstacle)
    scale = {"plane": 0.005, "lumen": 0.095}.get(obstacle, 0.105)
    rng = np.random.default_rng(17)
    pressed = 0
    for _ in range(20):
        direction = rng.normal(size=3)
        direction[1 if obstacle in ("capsule", "lumen") else 0] *= 0.05
        point = scale * direction / np.linalg.norm(direction)
        if obstacle == "lumen":
            point = np.array([scale * np.cos(direction[1]), scale * np.sin(direction[1]), 0.05])
        assert_allclose(force(point).T, -central_differences(energy, point, 1e-6), rtol=0, atol=1e-7)
        matrix = stiffness(point).full()[:3, :3]
        assert_allclose(matrix, central_differences(force, point, 1e-6), rtol=1e-5, atol=1e-4)
        assert_allclose(matrix, matrix.T, rtol=0, atol=1e-10)
        pressed += float(energy(point)) > 0.0
    assert pressed > 3


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_kernels_are_finite_everywhere(obstacle: str) -> None:
    # Centres, axes, ends of axes, beyond the ends of a lumen, edges of the layer, and far away.
    points = [[0, 0, 0], [0, 0.2, 0], [0, 0, 0.2], [0.05, 0, 0.4], [0, 0, -3.0], [0, 0, 0.112], [1e4, -1e4, 1e4]]
    for kernel in kernels(obstacle):
        hessian = ca.Function("second", *_second(kernel))
        for point in points:
            assert np.all(np.isfinite(kernel(point).full()))
            assert np.all(np.isfinite(hessian(point).full()))


def _second(kernel: ca.Function) -> tuple[list[ca.SX], list[ca.SX]]:
    point = ca.SX.sym("point", 3)
    return [point], [ca.jacobian(ca.jacobian(ca.vec(kernel(point)), point), point)]


@pytest.mark.parametrize(
    ("gap", "pressing", "rate"),
    [
        (0.0, STIFFNESS * WIDTH / 3, STIFFNESS),
        (WIDTH, 0.0, 0.0),
        (5 * WIDTH, 0.0, 0.0),
        (-WIDTH, STIFFNESS * WIDTH * 8 / 3, 4 * STIFFNESS),
    ],
)
def test_law_of_the_force(gap: float, pressing: float, rate: float) -> None:
    """Nothing from the width on; k w/3 at the surface, where it grows by k."""
    energy, force, stiffness = kernels("plane")
    point = [0.0, 0.0, gap + 2e-3]
    assert_allclose(force(point).full()[:, 0], [0.0, 0.0, pressing], rtol=1e-12, atol=1e-12)
    assert_allclose(stiffness(point).full()[2, 2], -rate, rtol=1e-12, atol=1e-9)
    assert_allclose(float(energy(point)), pressing * (WIDTH - gap) / 4, rtol=1e-12, atol=1e-15)


def test_a_rod_that_lies_flat_has_the_gap_at_which_its_weight_is_carried() -> None:
    weight = 0.1 * 9.81
    gap = WIDTH - (3 * weight * WIDTH**2 / STIFFNESS) ** (1 / 3)
    text = (
        ROD
        + f"""
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, {-gap!r}]
normal = [0, 0, 1]
width = {WIDTH}
stiffness = {STIFFNESS}
"""
    )
    lying = solve(parse_scene(text))
    assert lying.converged
    assert lying.stable
    assert_allclose(lying.pose([0.3, 1.0]).position[:, 2], 0.0, rtol=0, atol=1e-12)
    (contact,) = lying.contacts
    assert (contact.kind, contact.start, contact.end, contact.width) == ("smooth", 0.0, 1.0, WIDTH)
    assert contact.gap is not None
    assert_allclose(contact.gap, gap, rtol=0, atol=1e-12)
    assert_allclose(contact.force, [0.0, 0.0, weight], rtol=0, atol=1e-9)
    entry = lying.to_dict()["contacts"][0]
    assert (entry["kind"], entry["width"], entry["from"], entry["to"]) == ("smooth", WIDTH, 0.0, 1.0)


@pytest.fixture(scope="module")
def pressed() -> Solution:
    """A rod whose tip is pushed onto a table."""
    return solve(build(parse_scene(ROD + PUSH + TABLE)))


def check_balance(solution: Solution, load: list[float], atol: float) -> None:
    """The clamp bears what loads and contacts leave."""
    forces = sum((contact.force for contact in solution.contacts), np.array(load))
    assert_allclose(solution.base_wrench().force, -forces, rtol=0, atol=atol)


def test_the_jacobian_is_exact_and_symmetric(pressed: Solution) -> None:
    model, x, inputs = pressed.model, pressed.x, pressed.inputs
    assert pressed.converged
    assert pressed.stable
    check_balance(pressed, [0.0, 0.0, -0.6], 2e-3)
    jacobian = model.jacobian(x, inputs)[0].full()
    differences = central_differences(lambda x: model.residual(x, inputs), x, 1e-6)
    assert_allclose(jacobian, differences, rtol=0, atol=1e-6)
    assert_allclose(jacobian, jacobian.T, rtol=0, atol=1e-12)


def test_width_and_stiffness_may_be_parameters() -> None:
    """The model at other values is that of a scene with them, on the same elements; places are no parameters."""
    path = EXAMPLES / "rod_over_bar.toml"
    coarse = ["accuracy.modes=2", "accuracy.nodes=4", "bar.stiffness=4e4"]
    names = 'parameters=["bar.width", "bar.stiffness"]'
    model = build(read_scene(path, [*coarse, "bar.width=0.02", names]))
    other = read_scene(path, [*coarse[:2], "bar.width=0.01", "bar.stiffness=1e5"])
    wanted = solve(build(other, model.discretisation), estimate_error=False)
    found = solve(model, parameters={"bar.width": 0.01, "bar.stiffness": 1e5}, estimate_error=False)
    assert found.converged and found.contacts
    np.testing.assert_allclose(found.x, wanted.x, rtol=0, atol=1e-10)
    assert with_exact_contact(model.scene).parameters == ()
    tied = read_scene(path, ["bar.width=0.02", 'parameters=[["obstacles[0].width", "rod.length"]]'])
    assert with_exact_contact(tied).parameters == ("rod.length",)
    with pytest.raises(SceneError, match="radius of an obstacle decides where contacts are looked for, or how"):
        read_scene(path, ['parameters=["bar.radius"]'])


@pytest.mark.slow
def test_smooth_contact_becomes_exact_as_the_width_shrinks() -> None:
    """The error is proportional to the width: the layer holds the rod off by a part of it."""
    modes = ["accuracy.modes=4", "accuracy.nodes=12"]
    scene = read_scene(EXAMPLES / "rod_over_bar.toml", modes)
    exact = solve(build(scene))
    (point,) = exact.contacts
    widths = [0.04, 0.02, 0.01]
    tips = []
    forces = []
    for width in widths:
        smooth = solve(build(read_scene(EXAMPLES / "rod_over_bar.toml", [*modes, f"bar.width={width}"])))
        assert smooth.converged
        (contact,) = smooth.contacts
        assert contact.start < point.start < contact.end
        tips.append(float(np.linalg.norm(smooth.tip().position - exact.tip().position)))
        forces.append(float(np.linalg.norm(contact.force - point.force)))
    rates = np.log2(np.array(tips[:-1]) / tips[1:])
    assert np.all(rates > 0.7), rates
    assert tips[-1] < 1.5 * widths[-1]
    assert forces[0] > forces[1] > forces[2]
    # The same scene without its widths is the exact one.
    assert with_exact_contact(smooth.model.scene) == scene


@pytest.mark.parametrize("example", ["rod_over_bar", pytest.param("rod_on_table", marks=pytest.mark.slow)])
def test_the_error_of_the_layer_is_told(example: str) -> None:
    """Against exact contact: at a point and a line, outside of the obstacle and, on the table, inside."""
    name = example.split("_")[-1]
    modes = ["accuracy.modes=6", "accuracy.nodes=20"]
    path = EXAMPLES / f"{example}.toml"
    exact = solve(build(read_scene(path, modes)), estimate_error=False)
    assert exact.layer_error_estimate is None
    true = []
    for width in (0.02, 0.01):
        smooth = solve(build(read_scene(path, [*modes, f"{name}.width={width}"])), estimate_error=False)
        tips = [(tip.position, tip.rotation) for tip in (smooth.tip(), exact.tip())]
        true.append(pose_error(*tips, smooth.model.scene.rods[0].length))
        assert smooth.layer_error_estimate is not None
        assert 1.0 < smooth.layer_error_estimate / true[-1] < 1.7
    # The rod on the table sinks in less and less, so that its error falls faster than the width.
    assert true[1] < 0.7 * true[0]


def test_a_rod_that_is_pushed_through_is_no_equilibrium(pressed: Solution) -> None:
    soft = build(parse_scene(ROD + PUSH + TABLE + "stiffness = 1.0\n"))
    through = solve(soft)
    assert through.outcome is Outcome.UNRESOLVED
    assert "'rod' is " in through.message
    assert "widths deep inside 'table'" in through.message
    assert float(soft.contact_depth(through.x, through.inputs)) > 1.0


@pytest.mark.slow
def test_no_tolerance_is_met_by_a_rod_that_is_pushed_through() -> None:
    text = (ROD + PUSH + TABLE).replace("modes = 5, nodes = 12", "tolerance = 1e-3")
    found = solve(parse_scene(text + "stiffness = 1.0\n"))
    assert found.outcome is Outcome.UNRESOLVED
    assert "widths deep" in found.message


def test_no_step_of_the_load_path_passes_through_a_thin_bar() -> None:
    """A push that would bend the free rod far beyond a bar of two centimetres ends at the bar."""
    bar = """
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.9, -1, -0.05]
to = [0.9, 1, -0.05]
radius = 0.01
width = 5e-3
"""
    held = solve(build(parse_scene((ROD + PUSH + bar).replace("-0.6", "-1.5"))))
    assert held.converged
    (contact,) = held.contacts
    assert contact.force[2] > 0.5
    assert held.pose(contact.start).position[2] > -0.05


SHEARED = ROD.replace('"planar"', '"reissner"').replace(
    "torsion = 0.4", "torsion = 0.4, shear_x = 500, shear_y = 500, extension = 500"
)
CARRIED = (
    ROD
    + """
[[rods]]
name = "second"
length = 0.5
strain = "planar"
stiffness = { bending_y = 0.3 }
base = { rod = "rod", at = 1.0 }
"""
)
PLATFORM = (
    ROD.replace('"planar"', '"kirchhoff"')
    + """
[[bodies]]
name = "ball"
radius = 0.02
[[joints]]
body = "ball"
rod = "rod"
kind = "fixed"
"""
)


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["sheared", "carried", "body"])
def test_rods_that_shear_assemblies_and_bodies(assembly: str) -> None:
    text = {
        "sheared": SHEARED + PUSH + TABLE,
        "carried": CARRIED + PUSH.replace('rod = "rod"', 'rod = "second"') + TABLE,
        "body": PLATFORM + PUSH + TABLE + 'bodies = ["ball"]\n',
    }[assembly]
    held = solve(build(parse_scene(text)))
    assert held.converged
    assert held.stable
    contact = held.contacts[-1]
    assert contact.force[2] > 0.1
    assert contact.of_body == (assembly == "body")
    forces = sum((contact.force for contact in held.contacts), np.array([0.0, 0.0, -0.6]))
    assert_allclose(held.base_wrench("rod").force, -forces, rtol=0, atol=5e-3 if assembly != "body" else 1e-9)
    if assembly == "sheared":
        with pytest.raises(SceneError, match="admits shear"):
            with_exact_contact(parse_scene(text))
        return
    exact = solve(build(with_exact_contact(parse_scene(text))))
    assert exact.converged
    (touching,) = exact.contacts
    assert touching.of_body == (assembly == "body")
    assert_allclose(exact.tip("rod").position, held.tip("rod").position, rtol=0, atol=0.01)


BALL = """
schema = 1
accuracy = { modes = 1, nodes = 4 }
[[rods]]
name = "rod"
length = 0.2
strain = "planar"
material = { youngs_modulus = 1e9, poisson_ratio = 0.4, density = 1000.0 }
section = { shape = "circle", radius = 5e-3 }
base = { position = [0, 0, 0], tangent = [1, 0, 0], free = true }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.02]
normal = [0, 0, 1]
width = 0.01
stiffness = 2e3
damping = 0.8
[simulation]
duration = 0.16
frames = 17
start = "unloaded"
tolerance = 1e-6
"""


def test_a_rod_that_falls_flat_bounces_as_a_mass_on_the_law_of_hunt_and_crossley() -> None:
    scene = parse_scene(BALL)
    motion = simulate(build(scene, moving=True))
    assert motion.converged, motion.message

    mass = 1000.0 * np.pi * 5e-3**2

    def rates(_: float, state: np.ndarray) -> list[float]:
        height, speed = state
        pressing = 2e3 / (3 * 0.01**2) * max(0.01 - (height + 0.02 - 5e-3), 0.0) ** 3
        return [speed, -9.81 + pressing * (1 - 0.8 * speed) / mass]

    bounce = solve_ivp(rates, (0.0, 0.16), [0.0, 0.0], t_eval=motion.times, rtol=1e-10, atol=1e-13, max_step=1e-3)
    assert np.any(bounce.y[1] > 0.1)
    assert_allclose(motion.tip().position[:, 2], bounce.y[0], rtol=0, atol=2e-5)

    # What is stored in the layer is potential energy, and what the contact takes is dissipated: no work is done.
    energy = motion.energy
    assert_allclose(energy.work, 0.0, rtol=0, atol=1e-15)
    assert np.abs(energy.imbalance).max() < 1e-4
    assert np.all(np.diff(energy.dissipated) >= -1e-9)
    lost = -(energy.kinetic + energy.elastic + energy.potential - energy.potential[0])
    assert_allclose(energy.dissipated, lost, rtol=0, atol=1e-5 * energy.kinetic.max())
    assert energy.dissipated[-1] > 0.2 * energy.kinetic.max()


TARGET = """
[[targets]]
kind = "position"
rod = "rod"
at = 1.0
position = {position}
"""


@pytest.mark.slow
def test_what_takes_loads_takes_smooth_contact(pressed: Solution) -> None:
    """One equilibrium, by every way that leads there."""
    model = pressed.model
    followed = follow(model, "push.force", [0.0, 0.0, -0.6], values={"push.force": [0.0, 0.0, -0.1]})
    assert followed.outcome is PathOutcome.CONVERGED
    assert_allclose(followed.tip().position[-1], pressed.tip().position, rtol=0, atol=1e-9)

    assert plan_sweep(model.scene, table_of({"push.force.z": [-0.3, -0.6]}))

    target = TARGET.format(position=pressed.tip().position.tolist())
    found = inverse(build(parse_scene('inputs = ["push.force"]\n' + ROD + PUSH + TABLE + target)))
    assert found.solution.converged
    assert_allclose(found.values["push.force"][2], -0.6, rtol=0, atol=1e-5)

    # The table makes the rod stiff: in contact its lowest vibration is faster.
    modes = modes_of(pressed, count=1)
    free = modes_of(solve(build(parse_scene(ROD + PUSH))), count=1)
    assert modes.modes[0].frequency > 1.5 * free.modes[0].frequency
    assert np.all(linearise(pressed).eigenvalues.real < 1e-6)
    assert embedded(model, pressed) is not None


def test_parameters_move_the_rod_and_not_the_table() -> None:
    text = ROD + PUSH + TABLE + "stiffness = 5e3\n"
    model = build(parse_scene('parameters = ["rod.stiffness.bending_y"]\n' + text))
    softer = solve(model, parameters={"rod.stiffness.bending_y": 0.4})
    expected = solve(build(parse_scene(text.replace("bending_y = 0.5", "bending_y = 0.4"))))
    assert softer.converged
    assert_allclose(softer.tip().position, expected.tip().position, rtol=0, atol=1e-8)
    assert_allclose(softer.contacts[0].force, expected.contacts[0].force, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_c_presses_and_judges_as_python_does(tmp_path: Path) -> None:
    """A table that is too soft: unknowns are those of Python, and the status says that they are no contact."""
    text = (ROD + PUSH + TABLE).replace("modes = 5, nodes = 12", "modes = 2, nodes = 6")
    model = build(parse_scene(text + "stiffness = 1.0\n"))
    expected = solve(model)
    assert expected.outcome is Outcome.UNRESOLVED
    export(model, tmp_path / "through", "through")
    found = load(tmp_path / "through").solve(expected.inputs)
    assert found.outcome is Outcome.UNRESOLVED
    assert_allclose(found.x, expected.x, rtol=0, atol=1e-9)


def test_a_scene_pays_only_for_the_obstacles_that_it_names() -> None:
    bare = parse_scene(ROD + PUSH)
    exact = with_exact_contact(parse_scene(ROD + PUSH + TABLE))
    smooth = parse_scene(ROD + PUSH + TABLE)
    counts = []
    for scene in (bare, exact, smooth):
        model: Model = build(scene, discretise(bare, 4))
        functions = (model.residual, model.jacobian, model.resolution_index, model.inverse_dynamics, model.energies)
        counts.append([model.operations(function) for function in functions])
    assert counts[0] == counts[1]
    assert all(free < met for free, met in zip(counts[0], counts[2], strict=True))


@pytest.mark.slow
def test_the_command_line_tells_that_contact_is_smooth(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text((ROD + PUSH + TABLE).replace("modes = 5, nodes = 12", "modes = 3, nodes = 8"))
    smooth = cosserat("solve", "scene.toml", "--json", cwd=tmp_path)
    assert smooth.returncode == 0
    assert '"kind": "smooth"' in smooth.stdout
    exact = cosserat("solve", "scene.toml", "--json", "--exact-contact", cwd=tmp_path)
    assert exact.returncode == 0
    assert '"kind": "point"' in exact.stdout
    checked = cosserat("check", "scene.toml", cwd=tmp_path)
    assert "smooth plane" in checked.stdout


def test_the_scene_with_exact_contact_has_no_layer_to_sum() -> None:
    smooth = parse_scene(ROD + PUSH + TABLE, ["accuracy.sections=8"])
    assert with_exact_contact(smooth).accuracy == parse_scene(ROD + PUSH).accuracy


def test_the_scene_with_exact_contact_keeps_its_bodies() -> None:
    """Without its bodies the table would hold off the rod, which it does not concern."""
    body = '[[bodies]]\nname = "ball"\nradius = 0.02\n'
    weld = '[[joints]]\nname = "weld"\nkind = "fixed"\nrod = "rod"\nbody = "ball"\n'
    scene = with_exact_contact(parse_scene(ROD + PUSH + body + weld + TABLE + 'bodies = ["ball"]\n'))
    (table,) = scene.obstacles
    assert table.bodies == ("ball",)
    assert table.width is None


LUMEN = 'name = "it"\nkind = "lumen"\npoints = [[0, 0, -0.1], [0, 0, 0.2]]\nradius = 0.01\nrods = ["rod"]\n'

REFUSED = {
    "no width": (
        TABLE.replace("width = 0.01", "stiffness = 10.0"),
        "obstacles[0].stiffness",
        "contact without a width",
    ),
    "negative": (TABLE.replace("0.01", "-0.01"), "obstacles[0].width", "must be > 0"),
    "some without": (
        TABLE + TABLE.replace('"table"', '"other"').replace("width = 0.01", ""),
        "obstacles[1].width",
        "other obstacles have a width",
    ),
    "thick": (
        f'[[obstacles]]\nname = "it"\n{OBSTACLES["sphere"]}\nwidth = 0.2\n',
        "obstacles[0].width",
        "must be < radius",
    ),
    "play": (f"[[obstacles]]\n{LUMEN}width = 0.011\n", "obstacles.it.width", "must be less than the play"),
    "clamp": (TABLE.replace("-0.06", "0.01"), "obstacles.table", "starts 0.01 m inside it"),
    "radius": (
        TABLE + 'bodies = ["ball"]\n' + '[[bodies]]\nname = "ball"\n',
        "obstacles[0].bodies[0]",
        "has no radius",
    ),
    "body": (TABLE + 'bodies = ["none"]\n', "obstacles[0].bodies[0]", "no body is named"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_scenes(case: str) -> None:
    text, where, problem = REFUSED[case]
    with pytest.raises(SceneError) as refused:
        build(parse_scene(ROD + text))
    assert any(fault.where == where and problem in fault.problem for fault in refused.value.problems), refused.value


GROWING = """
schema = 1
inputs = ["rod.length"]
accuracy = { modes = 3, nodes = 8, tolerance = 1e-3 }
[[rods]]
name = "rod"
length = 0.5
strain = "planar"
material = { youngs_modulus = 1e7, poisson_ratio = 0.4, density = 1000.0 }
section = { shape = "circle", radius = 5e-3 }
base = { position = [0, 0, 0.04], tangent = [1, 0, -0.2] }
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.08]
normal = [0, 0, 1]
width = 0.02
stiffness = 2e3
damping = 2.0
[simulation]
duration = 0.2
frames = 21
tolerance = 1e-4
[[motions]]
input = "rod.length"
times = [0.0, 0.2]
values = [0.5, 0.6]
interpolation = "cubic"
"""


@pytest.mark.slow
def test_energy_of_a_rod_that_is_pushed_out_onto_a_table_balances() -> None:
    """Where a length moves no load counts as potential: the power of contact is work, without what it dissipates."""
    motion = simulate(build(parse_scene(GROWING).with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    assert motion.energy.dissipated[-1] > 1e-3 * np.abs(motion.energy.work).max()
    assert np.abs(motion.energy.imbalance).max() < 1e-4


WIRE = """
[[obstacles]]
name = "wire"
kind = "capsule"
from = [0.9, -1, -0.1]
to = [0.9, 1, -0.1]
radius = 4e-3
width = 1e-3
"""


@pytest.mark.slow
def test_no_step_of_a_path_passes_through_a_thin_wire() -> None:
    """Steps of their own length would end behind it; the solve from a solution and the path end in front of it."""
    model = build(parse_scene(ROD + PUSH + WIRE))
    path = follow(model, "push.force", [0.0, 0.0, -2.5])
    assert path.converged
    held = path.solution(-1)
    assert held.pose(0.906).position[2] > -0.1
    assert held.tip().position[2] > -0.2


@pytest.mark.slow
def test_no_step_from_a_solution_passes_through_a_thin_wire() -> None:
    """The lower wire holds the rod. One that rubs presses nodes alone: the path stalls in front of it, and says so."""
    lower = ROD + PUSH + WIRE.replace("-0.1]", "-0.2]")
    for wire, outcome in (("", Outcome.CONVERGED), ("friction = 0.1\n", Outcome.LOAD_STALLED)):
        model = build(parse_scene(lower + wire))
        near = solve(model, {"push.force": [0.0, 0.0, -0.05]})
        assert near.converged
        far = solve(model, {"push.force": [0.0, 0.0, -2.5]}, start=near)
        assert far.outcome is outcome
        assert far.tip().position[2] > -0.3
        assert not far.converged or far.pose(0.9).position[2] > -0.2


def test_parameters_that_change_at_once_take_no_rod_through_a_wire() -> None:
    """A rod above a wire that becomes as soft as one below it comes to lie on the wire, as parameters are followed.

    From a solution of another model nothing can be followed: it stays where it is, and the message says what to do.
    """
    name = "rod.stiffness.bending_y"
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    model = build(parse_scene(f'parameters = ["{name}"]' + ROD + PUSH + WIRE, few))
    above = solve(model, parameters={name: 5.0})
    assert above.converged and not above.contacts
    below = solve(build(parse_scene(ROD + PUSH, few)))
    assert below.pose(0.9).position[2] < -0.15
    # The same model, and one built anew from a solution that was stored, follow the parameters alike.
    anew = build(parse_scene(f'parameters = ["{name}"]' + ROD + PUSH + WIRE, few))
    for again, start in ((model, above), (anew, pickle.loads(pickle.dumps(above)))):
        held = solve(again, start=start)
        assert held.converged
        assert [contact.obstacle for contact in held.contacts] == ["wire"]
        assert_allclose(held.tip().position, solve(model).tip().position, rtol=0, atol=1e-6)
    jumped = solve(build(parse_scene(ROD + PUSH + WIRE, few)), start=above)
    assert jumped.outcome is Outcome.LOAD_STALLED
    assert "change them by less" in jumped.message
    assert_allclose(jumped.x, above.x, rtol=0, atol=0)
    nearer = solve(model, parameters={name: 4.0}, start=above)
    assert nearer.converged
    assert nearer.pose(0.9).position[2] < above.pose(0.9).position[2]


@pytest.mark.parametrize(
    "head", mostly_slow(['parameters = ["rod.base.position"]', ""], quick=[""]), ids=["parameter", "scene"]
)
def test_a_base_that_another_scene_sets_across_a_wire_takes_no_rod_through(head: str) -> None:
    """The same unknowns stand for a rod below the wire there: none is found from those above it.

    As a parameter the base is followed to its place: the tip stays behind, and the rod hangs on the wire.
    """
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    text = head + ROD + PUSH.replace("-0.6", "-0.05") + WIRE
    above = solve(build(parse_scene(text, few)))
    below = build(parse_scene(text, [*few, "rod.base.position=[0, 0, -0.3]"]))
    resting = solve(below)
    assert resting.converged and resting.tip().position[2] < -0.1
    found = solve(below, start=above)
    if head:
        assert found.converged
        (wire,) = found.contacts
        assert wire.force[2] > 0.0
        assert found.tip().position[2] > -0.1
    else:
        assert found.outcome is Outcome.LOAD_STALLED
        assert "change them by less" in found.message


@pytest.mark.parametrize(
    ("degrees", "sign"), mostly_slow(itertools.product((70.0, 160.0), (1.0, -1.0)), quick=[(70.0, 1.0)])
)
def test_a_base_that_turns_takes_no_rod_through_a_wire(degrees: float, sign: float) -> None:
    """The chord of the tip leads past the wire, its arc does not; with the other sign the base turns no other way."""
    text = 'inputs = ["rod.base.quaternion"]\n' + ROD + THIN.replace("[0.9, -1, -0.1]", "[0.8, -1, -0.48]")
    model = build(
        parse_scene(text.replace("[0.9, 1, -0.1]", "[0.8, 1, -0.48]"), ["accuracy.modes=3", "accuracy.nodes=8"])
    )
    above = solve(model)
    assert above.converged
    half = np.radians(90.0 + np.array([20.0, degrees])) / 2
    near, far = np.stack([np.cos(half), 0.0 * half, np.sin(half), 0.0 * half], axis=1)
    found = solve(model, {"rod.base.quaternion": near}, start=above)
    assert found.converged
    assert_allclose(found.tip().position, [np.cos(np.radians(20.0)), 0.0, -np.sin(np.radians(20.0))], rtol=0, atol=1e-9)
    barred = solve(model, {"rod.base.quaternion": sign * far}, start=above)
    assert barred.outcome is Outcome.LOAD_STALLED


def test_a_path_to_other_inputs_and_parameters_knows_its_rate() -> None:
    """Against central differences of the residual, beside the wire, where all of them act."""
    model = build(parse_scene('parameters = ["rod.stiffness.bending_y", "wire.width"]' + ROD + PUSH + WIRE))
    assert model.parameters.size == 2
    inputs = model.pack()
    x = solve(model, estimate_error=False).x
    ends = (inputs, inputs + 0.1 * np.arange(inputs.size)), (model.parameters.pack(), np.array([2.0, 1.5e-3]))
    path = input_path(model, x, *ends[0], ends[1])
    step = 1e-6
    differences = (path.residual(x, 0.3 + step) - path.residual(x, 0.3 - step)) / (2 * step)
    assert_allclose(path.rate(x, 0.3), differences, rtol=0, atol=1e-7 * np.abs(differences).max())


def test_no_step_of_a_path_leads_to_parameters_that_the_scene_refuses() -> None:
    model = build(parse_scene('parameters = ["rod.stiffness.bending_y"]' + ROD + PUSH + WIRE))
    x, inputs = model.unloaded(), model.pack()
    ends, parameters = (inputs, inputs), (np.array([2.0]), np.array([-2.0]))
    path = past_no_obstacle(input_path(model, x, *ends, parameters), model, ends, parameters)
    assert path.admits is not None
    assert path.admits((x, 0.0), (x, 0.25))
    assert not path.admits((x, 0.0), (x, 0.75))


def test_no_relaxing_leads_through_a_wire() -> None:
    """A column beyond its buckling load falls to either side; a wire beside it is in the way to one of them."""
    thrust = PUSH.replace("[0, 0, -0.6]", "[-2.5, 0, 0]")
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    free = solve(build(parse_scene(ROD + thrust, few)), stable=True)
    assert free.stable
    height = 0.05 * np.sign(free.tip().position[2])
    wire = WIRE.replace("-0.1]", f"{height}]").replace("0.9,", "0.5,")
    found = solve(build(parse_scene(ROD + thrust + wire, few)), stable=True)
    assert not (found.stable and found.pose(0.5).position[2] * height > 0.05**2), found.message


@pytest.mark.parametrize("force", [0.3, pytest.param(1.5, marks=pytest.mark.slow)])
def test_no_inverse_problem_is_met_behind_a_wire(force: float) -> None:
    """A target below a wire that hangs under the rod; without the wire it is met."""
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    head = 'inputs = ["push.force"]\n' + ROD + PUSH.replace("-0.6", "-0.05")
    free = build(parse_scene(head, few))
    below = solve(free, {"push.force": [0.0, 0.0, -force]}).tip().position
    target = f"[[targets]]\nkind = 'position'\nrod = 'rod'\nposition = {below.tolist()}\n"
    if force == 0.3:
        assert inverse(build(parse_scene(head + target, few)), estimate_error=False).met
    found = inverse(build(parse_scene(head + WIRE + target, few)), estimate_error=False)
    assert not found.met
    assert "led through an obstacle or a rod" in found.solution.message
    assert found.solution.pose(0.9).position[2] > -0.1


FELT_TIP = """
[[measurements]]
quantity = "position"
file = "tip.csv"
rod = "rod"
columns = ["x", "y", "z"]
sigma = 1e-3
[[unknowns]]
input = "push.force.z"
per_row = true
prior = { mean = -0.05, sigma = 1.0 }
"""


@pytest.mark.slow
def test_no_row_of_estimates_is_found_behind_a_wire() -> None:
    """Tips above the wire, and below it where no force brings the rod from above; without the wire all are found."""
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    head = 'inputs = ["push.force"]\n' + ROD + PUSH.replace("-0.6", "-0.05")
    free = build(parse_scene(head, few))
    tips = [solve(free, {"push.force": [0.0, 0.0, -force]}).tip().position for force in (0.05, 0.3)]
    data = {"tip.csv": dict(zip("xyz", np.transpose(tips), strict=True))}
    for obstacle, outcomes in (("", ("found", "found")), (WIRE, ("found", "behind"))):
        found = estimate(build(parse_scene(head + obstacle + FELT_TIP, few).with_unknowns()), data)
        assert found.outcomes == outcomes
        assert_allclose(found.values[0], [-0.05], rtol=0, atol=1e-4)
        assert np.isnan(found.values[1, 0]) == bool(obstacle)


@pytest.mark.parametrize(
    ("begun", "force", "wire", "behind"),
    [
        ([0, 0, -0.3], [0, 0, -0.3], [0.9, -0.1], True),
        ([-1.8, 0, 0.02], [-1.8, 0, -0.02], [0.5, 0.01], False),
        ([0, 0, -0.3], [0, 0, -0.3], [0.9, -0.3], False),
    ],
    ids=["below", "column", "above"],
)
def test_what_paths_of_loads_do_not_tell_to_be_behind_is_not_known_to_be(
    begun: list[float], force: list[float], wire: list[float], behind: bool
) -> None:
    """A rod below a wire stays there as its load vanishes; a column below one is where growing loads lead to."""

    def with_wire_at(x: float, z: float, force: list[float]) -> Model:
        ends = [f"wire.{end}={[x, y, z]}" for end, y in (("from", -1.0), ("to", 1.0))]
        few = ["accuracy.modes=3", "accuracy.nodes=8"]
        return build(parse_scene(ROD + PUSH + WIRE, [*few, *ends, f"push.force={force}"]))

    free = solve(with_wire_at(0.5, 5.0, begun), stable=begun[0] < 0)
    model = with_wire_at(*wire, force)
    found = solve(model, start=free.x)
    assert found.converged
    assert_allclose(found.tip().position, free.tip().position, rtol=0, atol=2e-2)
    assert is_behind(model, found.x, found.inputs) is behind


THIN = WIRE.replace("radius = 4e-3", "radius = 1e-3").replace("width = 1e-3", "width = 4e-4")

CROSSING = """
[[rods]]
name = "other"
length = 1.0
strain = "planar"
material = { youngs_modulus = 1e8, poisson_ratio = 0.4, density = 1000.0 }
section = { shape = "circle", radius = 4e-3 }
base = { position = [0.6, -0.5, -0.1], tangent = [0, 1, 0] }
[[rod_contacts]]
rods = ["rod", "other"]
width = 1e-3
"""


ON_A_BAR = """
schema = 1
inputs = ["push.force"]
accuracy = { modes = 2, nodes = 24 }
[[rods]]
name = "rod"
length = 0.5
strain = "planar"
material = { youngs_modulus = 1e8, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 2e-3 }
base = { tangent = [1, 0, 0] }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -0.05]
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.3, -0.2, -0.03]
to = [0.3, 0.2, -0.03]
radius = 5e-3
width = 2e-3
"""


OFF_A_BAR = np.array([0.0017, 0.0, 0.0087])
"""A push that lifts its rod off the bar."""


def test_a_path_leaves_a_thin_bar() -> None:
    """A point that is off by more than the layer is wide has a tangent that leads elsewhere: the path stalled."""
    pressed = solve(build(parse_scene(ON_A_BAR)), estimate_error=False)
    assert [contact.obstacle for contact in pressed.contacts] == ["bar"]
    off = solve(pressed.model, {"push.force": OFF_A_BAR}, start=pressed, estimate_error=False)
    assert off.converged and not off.contacts
    # Nothing is touched there: it is the equilibrium of the rod alone.
    alone = build(parse_scene(ON_A_BAR.partition("[[obstacles]]")[0], ["accuracy.modes=10"]))
    free = solve(alone, {"push.force": OFF_A_BAR}, estimate_error=False)
    assert_allclose(off.tip().position, free.tip().position, rtol=0, atol=1e-4)


def test_sections_go_straight_in_a_step_but_for_half_a_thickness() -> None:
    """The sagitta of the arc of a rod of length 1 m that turns about its base by the angle of the longest step."""
    angle = continuation_limits(build(parse_scene(ROD + PUSH + THIN))).longest
    assert_allclose(1.0 - np.cos(angle / 2), 1e-3, rtol=1e-3, atol=0)


THICK = """
schema = 1
accuracy = { modes = 4, nodes = 10 }
[[rods]]
name = "rod"
length = 0.5
strain = "planar"
material = { youngs_modulus = 1e6, poisson_ratio = 0.4, density = 1000.0 }
section = { shape = "circle", radius = 0.01 }
base = { tangent = [1, 0, 0] }
[[obstacles]]
name = "wire"
kind = "capsule"
from = [0.35, -1, -0.013]
to = [0.35, 1, -0.013]
radius = 1e-3
width = 9.5e-4
stiffness = 4000.0
"""


def test_a_thick_rod_may_sink_into_a_thin_wire_by_its_width() -> None:
    """By 0.94 of the radius of the wire, a tenth of that of the rod: its axis is far from the middle of the wire."""
    model = build(parse_scene(THICK + PUSH.replace("-0.6", "-0.035")))
    pressed = solve(model)
    assert pressed.converged
    (contact,) = pressed.contacts
    assert contact.gap is not None and -9.5e-4 < contact.gap < -9e-4
    harder = solve(model, {"push.force": [0, 0, -0.0353]}, start=pressed)
    assert harder.converged, harder.message
    assert harder.contacts[0].gap < contact.gap


@pytest.mark.parametrize(("beyond", "passes"), [(4.5e-5, True), (-1e-4, False)], ids=["through", "before"])
def test_a_wire_between_the_few_sections_that_are_looked_at_bars_the_way(beyond: float, passes: bool) -> None:
    """A rod that coils past a wire, or not as far: the chords of every eighth section are 7.5e-5 off its arc."""
    few = ["accuracy.modes=1", "accuracy.nodes=6"]
    model = build(parse_scene(ROD + PUSH + THIN, few))
    x = np.full(model.size, 6.0)
    assert_allclose(model.tip["rod"](x, model.pack())[0].full()[0, 0], np.sin(6.0) / 6.0, rtol=0, atol=1e-6)
    # The place of X = 0.505, and the side from which the rod comes there as it winds up.
    nodes = LookedAt(model, "rod").positions(model.scene.obstacles[0], x, model.pack())
    outwards = nodes[404] - (nodes[400] + nodes[408]) / 2
    centre = nodes[404] + beyond * outwards / np.linalg.norm(outwards)
    ends = [f"wire.{end}={[float(centre[0]), y, float(centre[2])]}" for end, y in (("from", -1.0), ("to", 1.0))]
    barriers = SmoothBarriers(
        build(parse_scene(ROD + PUSH + THIN, [*few, *ends, "wire.radius=4e-5", "wire.width=1e-5"]))
    )
    inputs = model.pack()
    assert barriers.are_between(model.unloaded(), x, (inputs, inputs)) == passes


@pytest.mark.slow
def test_no_row_of_a_sweep_converges_behind_a_thin_wire() -> None:
    """The solver in C stalls before the wire; Python may settle the row."""
    few = ["accuracy.modes=2", "accuracy.nodes=6"]
    # One that rubs presses nodes alone: between them a rod sinks in.
    scene = parse_scene('inputs = ["push.force"]\n' + ROD + PUSH + THIN + "friction = 0.1\n", few)
    pushes = np.array([-0.1, -0.25])
    table = np.stack([0 * pushes, 0 * pushes, pushes], axis=1)
    ends = row_library(build(scene)).solve(table)[:, 0].astype(int)
    assert [OUTCOMES[end] for end in ends] == [Outcome.CONVERGED, Outcome.LOAD_STALLED]
    found = sweep(scene, {"push.force.x": 0.0, "push.force.y": 0.0, "push.force.z": pushes}, cores=1)
    watched = solve(build(scene), {"push.force": table[1]})
    assert found.outcome == ["converged", watched.outcome.label]
    if watched.converged:
        assert_allclose(found["rod.z"][1], watched.tip().position[2], rtol=0, atol=1e-8)
    else:
        assert np.isnan(found["rod.z"][1])


MEASURED_TIP = """
[[measurements]]
name = "tip"
quantity = "position"
file = "tip.csv"
rod = "rod"
columns = ["x", "y", "z"]
sigma = 1e-3
[[unknowns]]
parameter = "rod.stiffness.bending_y"
lower = 0.1
upper = 20.0
"""


def test_a_fit_takes_no_rod_through_a_wire() -> None:
    """A tip that hangs below the wire: no stiffness brings the rod there from above, and the fit says why."""
    few = ["accuracy.modes=3", "accuracy.nodes=8"]
    below = solve(build(parse_scene(ROD + PUSH, few))).tip().position
    scene = parse_scene(ROD + PUSH + WIRE + MEASURED_TIP, [*few, "rod.stiffness.bending_y=2.0"])
    model = build(scene.with_unknowns())
    found = identify(model, {"tip": {axis: [place] for axis, place in zip("xyz", below, strict=True)}})
    position, _, _ = model.at(found.shared).tip["rod"](found.unknowns_x[0], found.inputs[0])
    assert -0.2 < float(position[2]) < -0.1
    assert found.at_bounds == ("rod.stiffness.bending_y",)
    assert any("refused steps through an obstacle or a rod" in warning for warning in found.warnings)


def test_a_path_on_which_a_rod_is_pushed_through_is_not_resolved(pressed: Solution) -> None:
    soft = build(parse_scene(ROD + PUSH + TABLE + "stiffness = 1.0\n"))
    path = follow(soft, "push.force", [0.0, 0.0, -0.6])
    assert path.outcome is PathOutcome.UNRESOLVED
    assert "widths deep" in path.message
    # As one that is not tells how deep it is.
    fine = follow(pressed.model, "push.force", [0.0, 0.0, -0.6])
    contact = fine.to_dict()["contact"]
    assert contact["widths"] == {"table": WIDTH}
    assert -1.0 < max(contact["depth"]) < 1.0


def test_a_refusal_names_a_width_that_does_what_it_says() -> None:
    """With the width of the sentence the rod is off by about as much: half of it to twice."""
    example, loose = ROOT / "examples" / "rod_over_bar.toml", "accuracy.tolerance=1e-2"
    exact = build(read_scene(example, [loose]))
    with pytest.raises(SceneError, match=r"such as \S+ m: contact is smooth then") as refused:
        stability_margin(exact)
    (width,) = re.findall(r"such as (\S+) m:", str(refused.value))
    smooth = build(read_scene(example, [loose, f"bar.width={width}"]))
    tips = [solve(model).tip("rod").position for model in (exact, smooth)]
    assert 0.5 < np.linalg.norm(tips[1] - tips[0]) / float(width) < 2.0


def test_a_base_that_a_parameter_turns_takes_no_rod_through_a_wire() -> None:
    """The chord from upright to level passes below the wire, the arc does not; either sign of a quaternion will do.

    Turned to where it would be below the wire, the rod hangs on it.
    """
    model = build(parse_scene(UPRIGHT))
    above = solve(model)
    for angle, hangs in ((0.5, False), (1.5, True)):
        turned = {"rod.base.quaternion": [-np.cos(angle / 2), 0.0, -np.sin(angle / 2), 0.0]}
        led = solve(model, parameters=turned, start=above)
        assert led.converged
        if hangs:
            (wire,) = led.contacts
            assert wire.force[2] > 0.0
            assert led.tip().position[2] > 0.31
            assert_allclose(wire.force + led.base_wrench().force, 0.0, rtol=0, atol=1e-10)
        else:
            assert_allclose(led.tip().position, 0.5 * np.array([np.sin(angle), 0.0, np.cos(angle)]), rtol=0, atol=1e-6)


UPRIGHT = """
schema = 1
parameters = ["rod.base.quaternion"]
accuracy = { modes = 1, nodes = 5 }
[[rods]]
name = "rod"
length = 0.5
strain = "planar"
stiffness = { bending_y = 0.5 }
base = { position = [0, 0, 0], quaternion = [1, 0, 0, 0] }
[[obstacles]]
name = "wire"
kind = "capsule"
from = [0.33, -0.1, 0.31]
to = [0.33, 0.1, 0.31]
radius = 0.01
width = 5e-3
"""
