"""Rods that touch rods, and themselves: the law, its derivatives, beams, a closed elastica, motion and C."""

from __future__ import annotations

import pickle

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

from cosserat_casadi import Model, Outcome, build, follow, parse_scene, simulate, solve
from cosserat_casadi.equilibrium.answer_error import SAFETY
from cosserat_casadi.equilibrium.smooth_passage import EVERY, SmoothBarriers
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.loads.rod_contact import GROUP, PANEL, SectionPairs, SectionsInContact, coefficient
from cosserat_casadi.maths.calls import chooses, functions_within
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.trace import PathOutcome
from cosserat_casadi.scene import Simulation
from tests.derivatives import central_differences

RADIUS = 5e-3
WIDTH = 2e-3
TOUCHING = 2 * RADIUS
STIFFNESS = 1e6
SECTIONS = 12 * PANEL


def pushed(positions: FloatArray, other: FloatArray) -> tuple[float, FloatArray]:
    """Energy and force on the second of two straight rods of unit length."""
    along = (np.arange(SECTIONS) + 0.5) / SECTIONS
    data = ca.DM(np.vstack([np.full(SECTIONS, 0.2 / SECTIONS), np.full(SECTIONS, RADIUS), along]))
    sections = [SectionsInContact(ca.MX(ca.DM(own)), data) for own in (positions, other)]
    pairs = SectionPairs(*sections, ca.DM([WIDTH, STIFFNESS, -1e100, 0.4, 1e-3]))
    energy, first, second = (ca.evalf(value).full() for value in (pairs.energy, *pairs.gradient))
    assert_allclose(first.sum(axis=1), -second.sum(axis=1), rtol=0, atol=1e-12)
    return float(energy[0, 0]), -second.sum(axis=1)


def straight(angle: float, gap: float) -> tuple[FloatArray, FloatArray]:
    """Sections of two rods of 0.2 m whose middles lie above each other."""
    along = 0.2 * ((np.arange(SECTIONS) + 0.5) / SECTIONS - 0.5)
    none = 0 * along
    return np.array([along, none, none]), np.array(
        [along * np.cos(angle), along * np.sin(angle), none + TOUCHING + gap]
    )


@pytest.mark.parametrize("gap", [-0.5e-3, 0.0, 0.8e-3])
@pytest.mark.parametrize("angle", [np.pi / 2, 0.6])
def test_crossed_rods_press_with_the_force_of_the_page(angle: float, gap: float) -> None:
    distance = TOUCHING + gap
    inside = (TOUCHING + WIDTH) ** 2 - distance**2
    factor = coefficient(WIDTH, STIFFNESS, TOUCHING) / np.sin(angle)
    energy, force = pushed(*straight(angle, gap))
    assert_allclose(energy, np.pi / 4 * factor * inside**4, rtol=2e-3, atol=0)
    assert_allclose(force, [0, 0, 2 * np.pi * factor * distance * inside**3], rtol=2e-3, atol=1e-9)


@pytest.mark.parametrize("gap", [-0.5e-3, 0.0, 0.8e-3])
def test_parallel_rods_press_with_the_force_of_the_page(gap: float) -> None:
    distance = TOUCHING + gap
    inside = (TOUCHING + WIDTH) ** 2 - distance**2
    factor = 2 * distance * coefficient(WIDTH, STIFFNESS, TOUCHING)
    # The second term is of the ends, which feel one half of the other rod.
    wanted = factor * (16 / 5 * 0.2 * inside**2.5 - inside**3)
    assert_allclose(pushed(*straight(0.0, gap))[1], [0, 0, wanted], rtol=1e-3, atol=1e-9)


def test_parallel_rods_have_the_stiffness_that_was_given() -> None:
    factor = coefficient(WIDTH, STIFFNESS, TOUCHING)

    def per_length(distance: float) -> float:
        return 32 / 5 * factor * distance * ((TOUCHING + WIDTH) ** 2 - distance**2) ** 2.5

    step = 1e-7
    slope = (per_length(TOUCHING - step) - per_length(TOUCHING + step)) / (2 * step)
    assert_allclose(slope, STIFFNESS, rtol=1e-6, atol=0)
    square = (TOUCHING + WIDTH) ** 2 - TOUCHING**2
    wanted = STIFFNESS * TOUCHING * square / (5 * TOUCHING**2 - square)
    assert_allclose(per_length(TOUCHING), wanted, rtol=1e-12, atol=0)


def test_rods_that_are_apart_do_not_touch() -> None:
    energy, force = pushed(*straight(0.3, WIDTH))
    assert energy == 0.0
    assert not np.any(force)
    # Where axes coincide all is finite.
    energy, force = pushed(*straight(0.0, -TOUCHING))
    assert np.isfinite(energy)
    assert_allclose(force, 0.0, rtol=0, atol=1e-9)


CROSSED = """
schema = 1
accuracy = {{ modes = 3, nodes = 8 }}
[[rods]]
name = "lower"
length = 0.3
strain = "kirchhoff"
material = {{ youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }}
section = {{ shape = "circle", radius = 5e-3 }}
base = {{ position = [-0.15, 0, 0], tangent = [1, 0, 0] }}
[[rods]]
name = "upper"
length = 0.3
strain = "kirchhoff"
material = {{ youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }}
section = {{ shape = "circle", radius = 5e-3 }}
damping = {{ retardation_time = 0.01 }}
base = {{ position = [0, -0.15, 0.013], tangent = [0, 1, 0] }}
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "upper"
force = [0, 0, {push}]
[[rod_contacts]]
rods = ["lower", "upper"]
width = 2e-3
{more}
"""


def crossed(push: float = -1.0, more: str = "", *changes: str) -> Model:
    """Two crossed cantilevers, the upper one pushed down at its tip."""
    return build(parse_scene(CROSSED.format(push=push, more=more), list(changes)))


def test_crossed_cantilevers_bend_as_beams_do() -> None:
    push, length = 0.4, 0.3
    model = crossed(-push)
    solution = solve(model)
    assert solution.converged
    assert solution.stable
    (contact,) = solution.contacts
    (pair,) = model.discrete.pairs
    stiffness = 2e9 * np.pi / 4 * RADIUS**4
    factor = coefficient(WIDTH, pair.stiffness, TOUCHING)

    def distance(force: float) -> float:
        """Of the axes, where the middles of both are bent by the contact, and that of the upper by the push too."""
        by_push = push * 5 * length**3 / 48
        return 0.013 - (by_push - 2 * force * length**3 / 24) / stiffness

    def excess(force: float) -> float:
        inside = max((TOUCHING + WIDTH) ** 2 - distance(force) ** 2, 0.0)
        return 2 * np.pi * factor * distance(force) * inside**3 - force

    force = brentq(excess, 0.0, 2 * push)
    assert contact.owner == "lower"
    assert contact.on_rods is not None
    assert contact.gap is not None
    assert_allclose(contact.force, [0, 0, -force], rtol=5e-3, atol=0.02 * force)
    assert_allclose(contact.on_rods, 0.5, rtol=0, atol=2e-3)
    assert_allclose(contact.gap, distance(force) - TOUCHING, rtol=0, atol=0.02 * WIDTH)
    # The clamps bear the push, and nothing of the contact.
    borne = sum(solution.base_wrench(rod).force for rod in ("lower", "upper"))
    assert_allclose(borne, [0, 0, push], rtol=0, atol=1e-9)


def test_forces_on_a_rod_whose_length_is_a_parameter() -> None:
    text = CROSSED.format(push=-1.0, more="")
    model = build(parse_scene('parameters = ["lower.length"]\n' + text))
    longer = solve(model, parameters={"lower.length": 0.4})
    expected = solve(build(parse_scene(text, ["lower.length=0.4"])))
    assert longer.converged
    # Their sections lie otherwise along it.
    assert_allclose(longer.contacts[0].force, expected.contacts[0].force, rtol=0, atol=0.02)


def test_the_error_of_the_layer_is_that_of_beams_that_touch() -> None:
    """Without a width the gap is zero: the pushed middle of a cantilever moves by g, its tip turns by 3/2 g/L."""
    found = [solve(crossed(-1.0, more), estimate_error=False) for more in ("", "stiffness = 1e6")]
    for solution in found:
        (contact,) = solution.contacts
        assert contact.gap is not None
        assert solution.layer_error_estimate is not None
        # Forces grow as the gap falls: the closed form is of small ones.
        assert_allclose(solution.layer_error_estimate, SAFETY * 1.5 * contact.gap / 0.3, rtol=0.03, atol=0)
    apart = found[0].tip("upper").position[2] - found[1].tip("upper").position[2]
    told = sum(solution.layer_error_estimate or 0.0 for solution in found)
    assert 0.001 * 0.3 < apart < 0.3 * told
    assert solve(crossed(-0.1), estimate_error=False).layer_error_estimate == 0.0
    # Layers are part of the equations that are stored.
    thinner = pickle.loads(pickle.dumps(found[0].model.discrete.with_layers(0.5)))
    assert (thinner.layers, thinner.pairs[0].width) == (0.5, 0.5 * WIDTH)


def test_a_base_that_moves_takes_no_rod_through_a_rod() -> None:
    """The clamp of the upper rod is set below the lower one, where it would be as it was: it takes that one along."""
    name, low = "upper.base.position", [0, -0.15, -0.011]
    scene = parse_scene(
        f'parameters = ["{name}"]' + CROSSED.format(push=-0.1, more=""), ["accuracy.modes=1", "accuracy.nodes=5"]
    )
    model = build(scene)
    above = solve(model, estimate_error=False)
    assert above.converged and not above.contacts
    below = solve(model, parameters={name: low}, start=above, estimate_error=False)
    assert below.converged and below.contacts
    assert below.tip("lower").position[2] < -0.02
    equilibria = Equilibria(model, 1)
    start, _ = equilibria.loaded(above.inputs[None], model.parameters.pack())
    _, reached = equilibria.tracked(start, start.x, start.inputs, np.array([0, -0.15, -0.014]), far=False)
    assert not reached[0]
    assert equilibria.barred[0]


CARRIED = """
[[rods]]
name = "post"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 5e-3 }
base = { position = [0.0, -0.15, -0.187], tangent = [0, 0, 1] }
"""

ON_POST = 'upper.base={ rod = "post", quaternion = [0.7071067811865476, -0.7071067811865476, 0, 0] }'


@pytest.mark.parametrize(("radius", "passes"), [(5e-3, True), (4e-3, True), (3e-3, False)])
def test_rods_pass_each_other_by_the_radii_that_parameters_give(radius: float, passes: bool) -> None:
    """Straight rods whose axes come as near as 3.5 mm pass each other where half their thickness is more."""
    names = ["lower.section.radius", "upper.section.radius"]
    text = f"parameters = [{names}]" + CROSSED.format(push=0.0, more="")
    changes = ["accuracy.modes=1", "accuracy.nodes=5", "inputs=['upper.base.position']"]
    model = build(parse_scene(text, changes)).at({names[0]: radius})
    inputs = np.array([[0, -0.15, 0.013], [0, -0.15, 0.0035]])
    still = np.zeros(model.size)
    assert SmoothBarriers(model).are_between(still, still, (inputs[0], inputs[1])) is passes


def lengthened() -> tuple[Model, FloatArray]:
    """Rods that cross, and inputs at both ends of steps: one, eight times as long, comes down on the other or past it.

    The place where it crosses the other rod moves from a section that is looked at to the next.
    """
    changes = ["accuracy.modes=1", "accuracy.nodes=5", "inputs=['upper.base.position', 'upper.length']"]
    model = build(parse_scene(CROSSED.format(push=0.0, more=""), changes))
    (pair,) = model.discrete.pairs
    length = 8 * model.lengths["upper"]
    spacing = EVERY * length / pair.sections[pair.rods.index("upper")]
    places = [(-0.15 - share * spacing, last) for share in (0.0, 0.25, 0.5, 0.75) for last in (-0.02, 0.018)]
    return model, np.array([[[0.0, y, height, length] for height in (0.02, last)] for y, last in places])


def test_a_rod_that_an_input_lengthens_passes_no_rod_between_sections() -> None:
    """Its sections that are looked at are farther apart than half the thickness."""
    model, steps = lengthened()
    still = np.zeros(model.size)
    found = [SmoothBarriers(model).are_between(still, still, (first, last)) for first, last in steps]
    assert found == [True, False] * 4


def test_the_jacobian_is_that_of_differences_and_forces_leave_no_moment() -> None:
    model = crossed(-2.0, CARRIED, ON_POST, "accuracy.modes=1", "accuracy.nodes=5")
    solution = solve(model, estimate_error=False)
    assert solution.contacts
    x = solution.x + 1e-5 * np.random.default_rng(0).normal(size=model.size)
    jacobian = model.jacobian(x, solution.inputs)[0].full()
    wanted = central_differences(lambda x: model.residual(x, solution.inputs), x, 1e-7)
    assert_allclose(jacobian, wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())
    (terms,) = System(model.discrete, Arguments(ca.MX(ca.DM(x)), ca.DM(solution.inputs))).pairs
    gradients = [ca.evalf(gradient).full().T for gradient in terms.section_pairs.gradient]
    places = [ca.evalf(side.sections.positions).full().T for side in terms.sides]
    size = np.abs(gradients[0]).sum()
    assert size > 1.0
    assert_allclose(gradients[0].sum(axis=0) + gradients[1].sum(axis=0), 0.0, rtol=0, atol=1e-13 * size)
    moments = [np.cross(place, gradient).sum(axis=0) for place, gradient in zip(places, gradients, strict=True)]
    assert_allclose(moments[0] + moments[1], 0.0, rtol=0, atol=1e-13 * size)


LOOP = """
schema = 1
accuracy = { modes = 4, nodes = 10 }
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
material = { youngs_modulus = 2.0e7, poisson_ratio = 0.4 }
section = { shape = "circle", radius = 0.02 }
base = { position = [0, 0, 0], tangent = [0, 0, 1] }
[[loads]]
name = "turn"
kind = "tip_wrench"
rod = "rod"
moment = [0, 17.0, 0]
[[rod_contacts]]
rods = ["rod"]
width = 8e-3
"""


@pytest.mark.slow
def test_an_elastica_that_closes_on_itself() -> None:
    solution = solve(build(parse_scene(LOOP)))
    assert solution.outcome is Outcome.CONVERGED
    (contact,) = solution.contacts
    assert contact.on_rods is not None
    # It ends at its own base, and presses the centre of the end that is clamped.
    assert_allclose(contact.on_rods, [0.0, 1.0], rtol=0, atol=0.02)
    stiffness = 2e7 * np.pi / 4 * 0.02**4
    tip = solution.tip().position

    def shot(unknowns: FloatArray) -> FloatArray:
        """Of a planar elastica with the moment and a force at the tip: how far its tip is from where it is."""
        along_x, along_z = unknowns

        def rates(_: float, state: FloatArray) -> list[float]:
            x, z, angle = state
            # What is beyond a section turns it: the moment at the tip and the force on its arm.
            bending = 17.0 + (tip[2] - z) * along_x - (tip[0] - x) * along_z
            return [np.sin(angle), np.cos(angle), bending / stiffness]

        end = solve_ivp(rates, (0.0, 1.0), [0.0, 0.0, 0.0], rtol=1e-10, atol=1e-12).y[:, -1]
        return end[:2] - tip[[0, 2]]

    force = fsolve(shot, [0.0, 0.0], xtol=1e-12)
    assert np.hypot(*force) > 1.0
    assert_allclose(contact.force[[0, 2]], -force, rtol=0, atol=5e-3 * np.hypot(*force))
    assert_allclose(contact.force[1], 0.0, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_what_is_deeper_than_the_width_or_passes_through_is_told() -> None:
    weak = crossed(-2.0, "stiffness = 1e3")
    solution = solve(weak, estimate_error=False)
    assert not solution.converged
    # The upper rod above and below the lower one: on the straight way between them they meet.
    strong = crossed(-0.5)
    inputs = strong.pack()
    above = solve(strong, estimate_error=False)
    below = solve(crossed(-3.0, "stiffness = 1e-6"), method="rootfinder", estimate_error=False)
    barriers = SmoothBarriers(strong)
    assert above.converged
    assert barriers.are_between(above.x, below.x, (inputs, inputs))
    assert not barriers.are_between(above.x, above.x, (inputs, inputs))


def test_a_path_that_stops_where_rods_are_inside_each_other_tells_that() -> None:
    path = follow(crossed(0.0, "stiffness = 1e3"), "push.force", [0, 0, -6.0])
    assert path.outcome is PathOutcome.LOAD_STALLED
    assert "widths deep inside an obstacle or a rod" in path.message
    assert path.solution(0).converged
    last = path.solution(-1)
    assert last.outcome is Outcome.UNRESOLVED
    assert last.stable is None
    assert "widths deep inside 'upper'" in last.message


def test_rods_inside_each_other_from_the_start_are_refused() -> None:
    with pytest.raises(SceneError, match="inside each other where nothing acts"):
        crossed(-1.0, "", "upper.base.position=[0, -0.15, 0.005]")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ('rod_contacts=[{ rods = ["lower", "lowest"] }]', "lowest"),
        ('rod_contacts=[{ rods = [["lower"], "upper"] }]', r"rods\[0\]: must be text, got a list"),
        ('rod_contacts=[{ rods = ["lower", "upper"], width = 0.006 }]', "must be < the radius of 'lower'"),
        ('rod_contacts=[{ rods = ["lower", "upper"], depth = 0.006 }]', "depth"),
        ('upper.base={ rod = "lower", tangent = [1, 0, 0] }', "are tied to each other"),
        ('obstacles=[{ name = "floor", kind = "plane", point = [0, 0, -1], normal = [0, 0, 1] }]', "touched exactly"),
    ],
)
def test_contacts_that_cannot_be_are_refused(change: str, sentence: str) -> None:
    with pytest.raises(SceneError, match=sentence):
        crossed(-1.0, "", change)


def test_all_pairs_are_those_of_rods_that_are_not_tied() -> None:
    model = crossed(-1.0, CARRIED, ON_POST, "rod_contacts=[{ width = 1e-3 }]")
    assert [pair.rods for pair in model.discrete.pairs] == [("lower", "upper"), ("lower", "post")]


def test_rods_that_are_apart_cost_no_pair() -> None:
    """Bounds of the operations: without the pairs they grow as the sections do."""
    along = np.linspace(0.0, 1.0, 4 * PANEL)
    far = [SectionsInContact(ca.MX.sym("x", 3, count * PANEL), ca.DM(3, count * PANEL)) for count in (4, 4)]
    pairs = SectionPairs(*far, ca.DM([WIDTH, STIFFNESS, -1e100, 0.4, 1e-3]))
    gradient = ca.Function("gradient", [own.positions for own in far], list(pairs.gradient))
    calls = [function for function in functions_within(gradient) if function.class_name() == "Switch"]
    # One for the rods, one for the panels: nothing of either is called where rods are apart.
    assert len(calls) == 2
    places = np.vstack([along, 0 * along, 0 * along])
    force, _ = gradient(places, places + 5.0)
    assert not np.any(force.full())


@pytest.mark.parametrize("panels", [(3, 2), (GROUP, 1), (GROUP + 1, 1), (2 * GROUP + 3, GROUP + 2)])
@pytest.mark.parametrize("itself", [False, True])
def test_panels_and_groups_change_nothing(panels: tuple[int, int], itself: bool) -> None:
    """Energy, forces and stiffness are those of a sum over all pairs, in NumPy, wherever borders of panels lie."""
    rng = np.random.default_rng(1)
    counts = [PANEL * panels[0]] * 2 if itself else [PANEL * own for own in panels]
    apart = 0.1 if itself else -1e100
    along = [(np.arange(count) + 0.5) / count for count in counts]
    # Two helices that wind through each other and part, or one.
    angles = [40 * along[0], np.pi + 40 * along[1]]
    helices = [np.array([0.009 * np.cos(a), 0.009 * np.sin(a), 0.06 * x]) for a, x in zip(angles, along, strict=True)]
    helices[1][1] += 0.1 * along[1]
    if itself:
        helices[1] = helices[0]
    lengths = [np.full(count, 0.2 / count) for count in counts]
    data = [ca.DM(np.vstack([own, np.full(len(own), RADIUS), x])) for own, x in zip(lengths, along, strict=True)]
    places = [ca.MX.sym("p", 3, count) for count in counts]
    first = SectionsInContact(places[0], data[0])
    second = first if itself else SectionsInContact(places[1], data[1])
    pairs = SectionPairs(first, second, ca.DM([WIDTH, STIFFNESS, apart, 0.4, 1e-3]))
    motions = [rng.normal(size=(3 * 2, count)) for count in counts]
    given = [ca.DM(own) for own in motions]
    matrices = pairs.stiffness(given[0], given[0] if itself else given[1])
    arguments = places[:1] if itself else places
    function = ca.Function("pairs", arguments, [pairs.energy, *pairs.gradient, *matrices])

    def summed(one: FloatArray, other: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        between = one[:, :, None] - other[:, None, :]
        inside = np.maximum((TOUCHING + WIDTH) ** 2 - (between**2).sum(axis=0), 0.0)
        factor = coefficient(WIDTH, STIFFNESS, TOUCHING) * np.outer(*lengths)
        factor = factor * (along[1] - along[0][:, None] >= apart)
        forces = -6 * factor * inside**2 * between
        return float((factor * inside**3).sum()), forces.sum(axis=2), -forces.sum(axis=1)

    found = [result.full() for result in function(*(helices[:1] if itself else helices))]
    energy, *forces = summed(*helices)
    assert energy > 0.0
    assert_allclose(found[0][0, 0], energy, rtol=1e-12, atol=0)
    for place, force in enumerate(forces):
        assert_allclose(found[1 + place], force, rtol=0, atol=1e-12 * np.abs(forces[0]).max())

    # Of the work of the forces in a motion, by the numbers of both motions.
    def work(numbers: FloatArray, of: int, by: FloatArray) -> float:
        moved = list(helices)
        for place in (0, 1):
            shift = np.tensordot(numbers[place], motions[0 if itself else place].reshape(3, 2, -1), (0, 1))
            moved[place] = moved[place] + shift
        force = summed(*moved)[1 + of]
        return float(
            np.tensordot(by, (motions[0 if itself else of].reshape(3, 2, -1) * force[:, None]).sum(axis=(0, 2)), 1)
        )

    step = 1e-8
    blocks = np.zeros((2, 2, 2, 2))
    for of, own, to, other in np.ndindex(2, 2, 2, 2):
        change = np.zeros((2, 2))
        change[to, other] = step
        blocks[of, to, own, other] = (work(change, of, np.eye(2)[own]) - work(-change, of, np.eye(2)[own])) / (2 * step)
    wanted = [blocks[0, 0], blocks[1, 0], blocks[1, 1]]
    if itself:
        wanted = [blocks[0, 0] + blocks[1, 1], blocks[1, 0], np.zeros((2, 2))]
    for matrix, block in zip(found[3:], wanted, strict=True):
        assert_allclose(matrix, block, rtol=0, atol=1e-6 * np.abs(blocks).max())


def test_operations_of_rods_that_are_apart_grow_as_their_sections() -> None:
    """Groups of panels that are apart cost one comparison: nothing else is called."""
    sizes = []
    for groups in (2, 4, 6):
        columns = groups * GROUP * PANEL
        far = [SectionsInContact(ca.MX.sym("x", 3, columns), ca.DM(3, columns)) for _ in range(2)]
        pairs = SectionPairs(*far, ca.DM([WIDTH, STIFFNESS, -1e100, 0.4, 1e-3]))
        gradient = ca.Function("gradient", [own.positions for own in far], list(pairs.gradient))
        sizes.append(gradient.n_instructions())
    assert sizes[2] - sizes[1] <= 1.05 * (sizes[1] - sizes[0])
    calls = [function for function in functions_within(gradient) if function.class_name() == "Switch"]
    # One for groups, one for panels of the first, one for pairs of panels.
    assert len(calls) == 3


def test_what_does_not_push_has_no_pairs_in_it() -> None:
    """Nodal poses and their derivatives; and inverse dynamics leaves pairs out where they are apart."""
    model = crossed()
    assert not chooses(model.field_jacobian["lower"])
    assert chooses(model.inverse_dynamics)
    assert chooses(model.inverse_dynamics_in_scalars)


@pytest.mark.slow  # five seconds: each step takes its own Jacobians
def test_rods_that_touch_move_and_keep_their_energy() -> None:
    scene = parse_scene(
        CROSSED.format(push=-2.0, more=""),
        ["accuracy.modes=1", "accuracy.nodes=4", "lower.damping={ retardation_time = 0.01 }"],
    )
    motion = simulate(scene.model_copy(update={"simulation": Simulation(duration=0.06, frames=7, start="unloaded")}))
    assert motion.converged, motion.message
    assert np.abs(motion.energy.imbalance).max() < 2e-3
