"""Thin layers that are summed between the nodes of a rod: derivatives, balance, and errors beside shooting."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cosserat_casadi import (
    Compiled,
    Model,
    Solution,
    build,
    discretise,
    export,
    load,
    modes_of,
    parse_scene,
    simulate,
    solve,
)
from cosserat_casadi.accuracy.assess import NeedsFinerSums, assess
from cosserat_casadi.accuracy.levels import Level
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.equilibrium.metrics import distance_of_poses, prolong
from cosserat_casadi.equilibrium.strain_limits import within_limits
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.contact_layers import share_of_more_modes
from cosserat_casadi.model.discretise import summed_at, with_discretisation
from cosserat_casadi.model.strain_margins import VANISHED
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.trajectory import MotionOutcome
from cosserat_casadi.motion.vibration_modes import ModesOutcome
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.scene.writing import scene_text
from tests.contact.test_smooth_contact import ON_A_BAR
from tests.families import mostly_slow

FREE = ON_A_BAR.replace("accuracy = { modes = 2, nodes = 24 }", "")
RADIUS, WIDTH = 2e-3, 1e-3
THIN = [f"bar.radius={RADIUS}", f"bar.width={WIDTH}"]
LENGTH, ROD_RADIUS = 0.5, 2e-3
BENDING = 1e8 * np.pi * ROD_RADIUS**4 / 4
"""EI of the rod, N m²."""
AXIS = np.array([0.3, -0.03])
"""Axis of the bar in the plane of the rod, x and z, m."""


@cache
def pressed(intervals: int = 5) -> Solution:
    scene = parse_scene(FREE, THIN)
    return solve(build(scene, discretise(scene, 2, intervals)), estimate_error=False)


def test_sections_lie_closer_than_nodes() -> None:
    """Six for each of eight intervals of an element of 62.5 mm: half of the stretch √(2 w d) apart at most."""
    (sections,) = pressed().model.discrete.closer_sections.values()
    assert sections.counts == (5 * 6,) * 8
    assert_allclose(np.sum(known(sections.lengths)), LENGTH, rtol=1e-14, atol=0)
    assert LENGTH / 8 / (8 * 6) < 0.5 * np.sqrt(2 * WIDTH * (RADIUS + ROD_RADIUS)) < LENGTH / 8 / (8 * 5)
    # Work of forces at the sections is that of what stands for them at the nodes.
    nodes = pressed().model.discrete.rods["rod"].grid.reference_nodes
    forces = np.sin(3 * sections.placed.coordinates)
    at_nodes = ca.evalf(ca.MX(sections.at_nodes(ca.DM(forces).T))).full()[0] * sections.rod.reference_lengths
    work = np.sum(forces * sections.lengths * sections.placed.coordinates**2)
    assert_allclose(at_nodes @ nodes**2, work, rtol=1e-13, atol=0)


def test_a_thick_bar_and_one_that_rubs_are_summed_at_nodes() -> None:
    for changes in (["bar.radius=0.02", "bar.width=5e-3"], [*THIN, "bar.friction=0.1"]):
        scene = parse_scene(FREE, changes)
        assert not build(scene, discretise(scene, 2, 5)).discrete.closer_sections


def differentiated(solution: Solution) -> FloatArray:
    """Jacobian by CasADi's derivatives of the residual."""
    model = solution.model
    x = ca.MX.sym("x", model.size)
    jacobian = ca.Function("J", [x], [ca.jacobian(model.residual(x, solution.inputs), x)])
    return np.asarray(jacobian(solution.x).full())


def test_jacobian_is_the_derivative_and_forces_balance() -> None:
    found = pressed()
    assert found.converged
    jacobian = found.model.jacobian(found.x, found.inputs)[0].full()
    assert_allclose(jacobian, differentiated(found), rtol=0, atol=1e-12 * np.abs(jacobian).max())
    assert_allclose(jacobian, jacobian.T, rtol=0, atol=1e-12 * np.abs(jacobian).max())
    (contact,) = found.contacts
    assert contact.force[2] > 0.05
    assert_allclose(contact.force + found.base_wrench().force, [0.0, 0.0, 0.05], rtol=0, atol=1e-12)


@pytest.mark.parametrize("sections", [6, 200])
def test_jacobian_by_sections_and_by_nodes(sections: int) -> None:
    """The stiffness of many sections is brought to the nodes."""
    scene = parse_scene(FREE, THIN)
    model = build(scene, summed_at(discretise(scene, 2, 5), sections))
    found = replace(pressed(), model=model)
    system = System(model.discrete, Arguments(ca.DM(found.x), ca.DM(found.inputs)))
    (stiff,) = system.tangents["rod"].stiff_sections
    assert stiff.is_cheaper_at_nodes is (sections == 200)
    jacobian = model.jacobian(found.x, found.inputs)[0].full()
    assert_allclose(jacobian, differentiated(found), rtol=0, atol=1e-12 * np.abs(jacobian).max())


def test_a_short_element_that_a_parameter_makes_long_has_sections_enough() -> None:
    """A bar presses an element that has a quarter of its length in the file, where eight sections would miss it."""
    stone = '[[loads]]\nname = "stone"\nkind = "point_wrench"\nrod = "rod"\nat = 0.655\nforce = [0, 0, 0.01]\n'
    changes = [*THIN, "bar.stiffness=9e5", "bar.from=[0.33, -0.2, -0.03]", "bar.to=[0.33, 0.2, -0.03]"]
    scene = parse_scene('parameters = ["stone.at"]\n' + FREE + stone, changes)
    moved = build(scene, discretise(scene, 2, 5)).at({"stone.at": 0.74})
    assert moved.discrete.closer_sections["bar on rod"].counts == (30,) * 9
    written = parse_scene(FREE + stone, [*changes, "stone.at=0.74"])
    found, wanted = (solve(own, estimate_error=False) for own in (moved, build(written, discretise(written, 2, 5))))
    assert found.converged and wanted.converged
    (contact,) = found.contacts
    assert 0.625 < contact.start < contact.end < 0.74
    assert_allclose(contact.force + found.base_wrench().force, [0.0, 0.0, 0.04], rtol=0, atol=1e-12)
    # Elements of the written scene end elsewhere, with two modes each; with eight sections it would be 3e-3.
    assert_allclose(found.tip().position, wanted.tip().position, rtol=0, atol=5e-4)


def test_the_deepest_section_tells_the_depth() -> None:
    """Between nodes 16 mm apart, as the gap of the contact has it on a fine raster."""
    scene = parse_scene(FREE, [*THIN, "bar.stiffness=3e4"])
    found = solve(build(scene, discretise(scene, 2, 5)), estimate_error=False)
    (contact,) = found.contacts
    assert contact.gap is not None and contact.gap < -0.1 * WIDTH
    depth = float(found.model.contact_depth(found.x, found.inputs))
    # Half of the way to the next section: a rod that lies on the bar is as much higher there at most.
    sag = (LENGTH / 8 / 30 / 2) ** 2 / (2 * (RADIUS + ROD_RADIUS))
    assert -contact.gap - sag < depth * WIDTH <= -contact.gap + 1e-9
    assert depth > 0.2


def shot(start: FloatArray, push: float, width: float = WIDTH) -> FloatArray:
    """Tip of the elastica before the layer, x, z in m and angle in rad, from moment and force at the base."""
    stiffness = 30 * BENDING / LENGTH**2 / width**2

    def slopes(_: float, y: FloatArray) -> list[float]:
        x, z, angle, moment, along, up = y
        away = np.array([x, z]) - AXIS
        distance = float(np.hypot(*away))
        depth = max(width - (distance - RADIUS - ROD_RADIUS), 0.0)
        force = stiffness * depth**3 / (3 * width**2) * away / distance
        turn = np.sin(angle) * along - np.cos(angle) * up
        return [np.cos(angle), np.sin(angle), moment / BENDING, turn, -force[0], -force[1]]

    def ends(base: FloatArray) -> FloatArray:
        state = np.concatenate([np.zeros(3), base])
        return np.asarray(
            solve_ivp(slopes, (0, LENGTH), state, method="DOP853", rtol=1e-10, atol=1e-12, max_step=width).y[:, -1]
        )

    base = fsolve(lambda own: ends(own)[3:] - [0.0, 0.0, push], start, xtol=1e-10)
    return ends(base)[:3]


def distance_to_shooting(found: Solution, push: float, width: float = WIDTH) -> float:
    """Distance of the tip over the length, or angle in rad, whichever is larger."""
    held = found.base_wrench()
    tip = shot(np.array([held.moment[1], -held.force[0], -held.force[2]]), push, width)
    pose = found.tip()
    off = np.hypot(pose.position[0] - tip[0], pose.position[2] - tip[1]) / LENGTH
    turned = abs(np.arctan2(pose.rotation[2, 2], pose.rotation[0, 2]) - tip[2])
    return float(max(off, turned))


@cache
def stretched() -> Model:
    """The rod on five intervals, whose length, place and width of layer are parameters."""
    names = '["bar.width", "rod.length", "rod.base.position.x"]'
    scene = parse_scene(f"parameters = {names}\n" + FREE, [*THIN, "accuracy.tolerance=1e-3"])
    return build(scene, discretise(scene, 2, 5))


def test_parameters_that_stretch_a_rod_find_sections_to_spare() -> None:
    """Twice as many, of which the model on which errors show has three times as many again."""
    discrete = stretched().discrete
    fixed = stretched().at({"bar.width": WIDTH / 2}).discrete
    assert discrete.closer_sections["bar on rod"].counts == (2 * 5 * 6,) * 8
    assert fixed.closer_sections["bar on rod"].counts == (2 * 5 * 6,) * 8
    assert discrete.richer.discrete.closer_sections["bar on rod"].counts == (3 * 2 * 5 * 6,) * 8
    scene = parse_scene('parameters = ["bar.stiffness"]\n' + FREE, [*THIN, "bar.stiffness=9e5"])
    assert build(scene, discretise(scene, 2, 5)).discrete.closer_sections["bar on rod"].counts == (5 * 6,) * 8


@pytest.mark.slow
def test_a_first_look_at_a_thin_layer_is_not_believed() -> None:
    """It tells 4.4e-5 of 5.5e-5, below a tolerance of 1e-3."""
    width, push = 4e-4, -0.02
    found = solve(stretched(), {"push.force": [0, 0, push]}, parameters={"bar.width": width})
    assert found.converged and found.error_estimate is not None
    true = distance_to_shooting(found, push, width)
    assert 0.5 * found.error_estimate < true < found.error_estimate


@pytest.mark.parametrize(
    "changes",
    [
        {"bar.width": WIDTH / 10},
        pytest.param({"bar.width": WIDTH / 4, "rod.length": 2 * LENGTH}, marks=pytest.mark.slow),
    ],
)
def test_where_sections_lie_too_far_apart_the_error_is_not_known(changes: dict[str, float]) -> None:
    """The sum alone is 3.1 and 6.8 times as wrong as was told, within the tolerance; one rod sinks in between them."""
    place = {"rod.base.position.x": 0.025 if len(changes) == 1 else -0.024}
    found = solve(stretched(), parameters={**changes, **place})
    assert found.converged and not found.within_tolerance
    assert found.error_estimate == 1.0
    assert "not known" in found.message


@pytest.mark.slow
def test_errors_of_modes_on_fixed_polynomials_bound_the_true_ones() -> None:
    """The finer modes that tell them leave a tenth of the error, by which it was told too small."""
    coarse, fine = (
        modes_of(parse_scene(FREE, [*THIN, f"accuracy.modes={modes}", f"accuracy.nodes={nodes}"]), count=4)
        for modes, nodes in ((3, 6), (7, 14))
    )
    frequencies = [np.array([mode.frequency for mode in found.modes]) for found in (coarse, fine)]
    true = np.abs(frequencies[0] / frequencies[1] - 1)
    told = np.array([mode.error_estimate for mode in coarse.modes])
    assert np.all(true < told)
    assert np.all(0.8 * told < true)


@pytest.mark.slow
def test_where_sections_lie_too_far_apart_c_does_not_know_the_error(tmp_path: Path) -> None:
    export(stretched(), tmp_path / "rod", "rod")
    library = load(tmp_path / "rod")
    assert isinstance(library, Compiled)
    for width, unknown in ((WIDTH, False), (WIDTH / 4, False), (WIDTH / 10, True)):
        p = library.parameters.pack({"bar.width": width})
        ours = library.solve(library.defaults, parameters=p)
        theirs = solve(stretched(), parameters=p)
        assert ours.converged and theirs.converged
        assert ours.error_estimate is not None and theirs.error_estimate is not None
        if unknown:
            assert ours.error_estimate == theirs.error_estimate == 1.0
        else:
            assert_allclose(np.log(ours.error_estimate), np.log(theirs.error_estimate), rtol=0, atol=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_told_errors_bound_the_distance_to_shooting(tolerance: float) -> None:
    found = solve(parse_scene(FREE, [*THIN, f"accuracy.tolerance={tolerance}"]))
    assert isinstance(found, Solution) and found.converged
    assert found.error_estimate is not None and found.error_estimate <= tolerance
    assert 0.1 * found.error_estimate < distance_to_shooting(found, -0.05) < found.error_estimate
    # Thirty would be needed for the nodes to lie as close.
    assert max(own.nodes for own in found.model.discretisation.values()) <= 20


@pytest.mark.parametrize(("place", "modes"), mostly_slow([(0.285, 4), (0.27, 4), (0.2807, 8)], quick=[(0.2807, 8)]))
def test_a_push_on_a_part_of_an_element_is_not_told_by_a_few_more_modes(place: float, modes: int) -> None:
    """Three modes more tell 4.2e-6 of 4.6e-6 at the first place: for few modes the push is at a point.

    At the last one six modes more, with their factor of safety, tell 8.6e-7 of 9.3e-7.
    """
    scene = parse_scene(FREE, [*THIN, f"rod.base.position=[{0.3 - place}, 0, 0]"])
    found = solve(build(scene, summed_at(discretise(scene, modes, modes + 4), 200)))
    finer = build(scene, summed_at(discretise(scene, modes + 10, modes + 22, "magnus8"), 400))
    exact = solve(finer, start=prolong(found, finer), estimate_error=False)
    assert found.converged and exact.converged and found.error_estimate is not None
    true = distance_of_poses(found.tip(), exact.tip(), LENGTH)
    assert 0.5 * found.error_estimate < true < found.error_estimate
    assert true < Resolution(Preview(found)).hidden_error < 2 * true


def test_sums_at_finer_sections_tell_the_error_of_sums() -> None:
    scene = parse_scene(FREE, THIN)
    coarse, fine = (build(scene, summed_at(discretise(scene, 2, 5), sections)) for sections in (24, 400))
    found = solve(coarse, estimate_error=False)
    exact = solve(fine, start=found.x, estimate_error=False)
    true = distance_of_poses(found.tip(), exact.tip(), LENGTH)
    assert true < Resolution(Preview(found)).sum_error < 4 * true


def test_a_reference_with_coarse_sums_asks_for_finer_ones() -> None:
    scene = parse_scene(FREE, THIN)
    uniform = discretise(scene, 8, 14)
    found = solve(build(scene, summed_at(uniform, 30)), estimate_error=False)
    verdict = assess(found, 1e-4)
    assert isinstance(verdict, NeedsFinerSums)
    finer = Level.first(1e-4, sections=30).with_finer_sums(verdict.factor)
    assert finer is not None
    better = solve(build(scene, summed_at(uniform, finer.sections)), start=found.x, estimate_error=False)
    assert Resolution(Preview(better)).sum_error < 0.25 * 1e-4


def test_what_modes_lack_of_a_push_at_a_point_falls_with_their_third_power() -> None:
    """The moment |s − p| in Legendre polynomials, over places p of the push: the work of the modes beyond n."""
    s, weights = np.polynomial.legendre.leggauss(600)
    degrees = np.arange(200)
    work = np.zeros(len(degrees))
    for p in np.linspace(-0.9, 0.9, 19):
        coefficients = np.polynomial.legendre.legvander(s, degrees[-1]).T @ (weights * abs(s - p))
        work += coefficients**2 * (2 * degrees + 1) / 2
    beyond = [float(work[n:].sum()) for n in (4, 10, 64)]
    share = (beyond[1] - beyond[2]) / (beyond[0] - beyond[1])
    assert_allclose(share_of_more_modes(4, 6, 1.0, np.pi / 2 / 64), share, rtol=0.3, atol=0)
    # Modes as short as the stretch see the push as it is.
    assert share_of_more_modes(4, 6, 1.0, np.pi / 2 / 10) == 0.0


def test_a_tolerance_asks_for_sections_and_not_for_intervals() -> None:
    """At nodes the sum took 108 intervals of an element for it."""
    scene = parse_scene(FREE, ["bar.radius=0.02", "bar.width=2e-3", "accuracy.tolerance=1e-6"])
    found = solve(scene)
    assert isinstance(found, Solution) and found.converged
    chosen = found.model.discretisation["rod"]
    assert max(chosen.modes) < chosen.nodes <= 24 and chosen.sections >= 40
    finer = build(scene, summed_at(discretise(scene, 24, 50, "magnus8"), 500))
    exact = solve(finer, start=prolong(found, finer), estimate_error=False)
    true = distance_of_poses(found.tip(), exact.tip(), LENGTH)
    assert found.error_estimate is not None and exact.converged
    assert 0.1 * found.error_estimate < true < found.error_estimate <= 1e-6
    # A scene that is written with them is discretised alike.
    written = parse_scene(scene_text(with_discretisation(scene, found.model.discretisation)))
    assert discretise(written) == found.model.discretisation
    (words,) = found.model.resolution_words
    assert words.endswith(f", layers summed at {chosen.sections} sections an element")


def test_nodes_at_which_a_layer_rubs_may_lie_apart() -> None:
    """In motion no finer sum shows what they miss; at rest Gauss points do."""
    for nodes, apart in ((5, True), (14, False)):
        scene = parse_scene(FREE, [*THICK, "bar.friction=0.2"])
        resting = build(scene, discretise(scene, 2, nodes))
        assert resting.strain_margins is None
        margins = resting.in_motion.strain_margins
        assert (margins is not None) is apart
        if margins is not None:
            assert float(margins(resting.unloaded(), resting.pack())) <= VANISHED
            # A motion may begin there: at rest the error is told.
            told, _ = within_limits(resting.in_motion, resting.unloaded(), resting.pack(), Outcome.CONVERGED)
            assert told is Outcome.CONVERGED


@pytest.mark.slow
def test_steps_in_c_say_where_sections_lie_too_far_apart(tmp_path: Path) -> None:
    export(stretched(), tmp_path / "rod", "rod", dynamics=True)
    library = load(tmp_path / "rod")
    assert isinstance(library, Compiled)
    for width, status in ((WIDTH, MotionStatus.DONE), (WIDTH / 10, MotionStatus.SECTIONS_APART)):
        p = library.parameters.pack({"bar.width": width})
        found = library.solve(library.defaults, parameters=p)
        assert found.converged and (found.error_estimate == 1.0) is (status is MotionStatus.SECTIONS_APART)
        state = library.rest(library.defaults, found.x, parameters=p)
        assert state is not None
        assert library.step(state, 1e-4, library.defaults, parameters=p).status is status


THICK = ["bar.radius=0.02", "bar.width=4e-3", "bar.from=[0.285, -0.2, -0.03]", "bar.to=[0.285, 0.2, -0.03]"]
"""A bar that presses on 13 mm of the rod to both sides, whose nodes are up to 14 mm apart on 14 intervals."""
TABLE = (
    FREE.partition("[[obstacles]]")[0].replace("length = 0.5", "length = 0.4")
    + """
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.02]
normal = [0, 0, 1]
width = 1.8e-3
"""
)
"""A plane below the rod."""


@pytest.mark.parametrize(("text", "changes"), [(FREE, THICK), (TABLE, ["accuracy.tolerance=1e-3"])])
def test_the_error_of_a_sum_at_nodes_is_told(text: str, changes: list[str]) -> None:
    """A richer model with a few more nodes told 2.2e-3 of 3.0e-3 beside the bar."""
    scene = parse_scene(text, changes)
    found = solve(build(scene, discretise(scene, 4, 14)))
    exact = solve(build(scene, discretise(scene, 8, 60)), estimate_error=False)
    assert found.converged and exact.converged and found.contacts
    assert not found.model.discrete.closer_sections
    true = distance_of_poses(found.tip(), exact.tip(), found.model.length("rod", found.inputs))
    assert found.error_estimate is not None
    assert 0.5 * found.error_estimate < true < found.error_estimate


def test_gauss_points_show_a_sum_at_nodes_without_friction_that_is_remembered() -> None:
    """Three for each interval that sees the layer: of nodes that are too few as well."""
    scene = parse_scene(FREE, THICK)
    coarse = build(scene, discretise(scene, 2, 3)).discrete
    (sections,) = coarse.richer.discrete.closer_sections.values()
    # Half of the stretch is 13.3 mm; an element of 125 mm has nodes up to 1.5 times as far apart on 10 intervals.
    assert sections.points == 0 and sections.counts == (3 * 10,) * 4
    # Exact for a polynomial along all of an element, where equal parts are not.
    work = np.sum(known(sections.lengths) * known(sections.placed.X) ** 7)
    assert_allclose(work, 0.5 / 8, rtol=1e-13, atol=0)
    # Element by element as by the whole matrix, to the sections and back to the nodes.
    rod = sections.rod
    nodes, forces = rod.grid.reference_nodes, np.sin(3 * sections.placed.coordinates)
    found = ca.evalf(sections.at_sections(ca.DM(nodes**2).T)).full()[0]
    assert_allclose(found, sections.placed.coordinates**2, rtol=0, atol=1e-14)
    at_nodes = ca.evalf(ca.MX(sections.at_nodes(ca.DM(forces).T))).full()[0] * rod.reference_lengths
    done = np.sum(forces * known(sections.lengths) * sections.placed.coordinates**2)
    assert_allclose(at_nodes @ nodes**2, done, rtol=1e-12, atol=0)
    rubbing = parse_scene(FREE, [*THICK, "bar.friction=0.2"])
    discrete = build(rubbing, discretise(rubbing, 2, 5)).discrete
    assert discrete.richer.discrete.closer_sections
    assert not discrete.with_memory.richer.discrete.closer_sections


def test_modes_and_motions_say_where_sections_lie_too_far_apart() -> None:
    names = '["bar.width"]'
    text = f"parameters = {names}\n" + FREE + '[simulation]\nduration = 2e-3\nframes = 3\nstart = "unloaded"\n'
    scene = parse_scene(text, THIN).with_motion_inputs()
    resting, moving = (build(scene, discretise(scene, 2, 5), moving=own) for own in (False, True))
    for width, lie_apart in ((WIDTH, False), (WIDTH / 10, True)):
        motion = simulate(moving.at({"bar.width": width}))
        assert (motion.outcome is MotionOutcome.UNRESOLVED) is lie_apart
        assert ("lie too far apart" in motion.message) is lie_apart
        assert np.isfinite(motion.error_estimate) is not lie_apart
        # Without a push the rod is straight above the bar.
        modes = modes_of(resting.at({"bar.width": width}), {"push.force": np.zeros(3)}, count=2)
        assert modes.outcome is (ModesOutcome.UNRESOLVED if lie_apart else ModesOutcome.NOT_ESTIMATED)
        assert ("error is not known" in modes.message) is lie_apart
