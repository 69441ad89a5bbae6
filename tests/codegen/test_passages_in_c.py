"""Exported C takes no rod, disk or body through something thin: the criterion against Python's, then every function."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Outcome, build, parse_scene, solve
from cosserat_casadi.codegen.compiled_motion import StepOptions, StepState
from cosserat_casadi.codegen.functions_in_c import functions_in_c
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernel
from cosserat_casadi.codegen.library import FOURS, PROGRAM
from cosserat_casadi.codegen.memory import largest_room
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.codegen.passages import PASSAGE_FILES, passage_kernels, passage_words
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.codegen.status import OUTCOMES, MotionStatus
from cosserat_casadi.compiling.texts import fill, resource
from cosserat_casadi.equilibrium.contact.passing_through import LookedAt, admitted_depth
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers, depth_allowed, places_along
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import C99, HARNESS, Exported, compile_quickly, gcc
from tests.contact.test_contact_of_assemblies import BALL, HEAD
from tests.contact.test_contact_of_assemblies import ROD as LONG_ROD
from tests.contact.test_passage_of_bodies import DISK, SMALL
from tests.contact.test_rod_contacts import lengthened
from tests.contact.test_smooth_contact import CROSSING, OFF_A_BAR, ON_A_BAR, PUSH, ROD, THIN, WIRE
from tests.families import mostly_slow

ExportRecipe = Callable[..., Exported]

FEW = ("accuracy.modes=2", "accuracy.nodes=6")
PUSHED = 'inputs = ["push.force"]\n'
MOVED = 'inputs = ["rod.base.position"]\n'
MATERIAL = "\n".join(line for line in CROSSING.splitlines() if line.startswith(("material", "section")))
SOLID = re.sub("stiffness = .*\nlinear_density = .*", MATERIAL, ROD)
SPHERE = SMALL.format(height=-0.2) + "width = 0.01\n"
ON_BALL = """
[[bodies]]
name = "rim"
[[rods]]
name = "carrier"
length = 0.3
strain = "planar"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
base = { position = [0.6, 0.0, -0.5], tangent = [0, 0, 1] }
[[joints]]
body = "rim"
rod = "carrier"
kind = "fixed"
[[obstacles]]
name = "bump"
kind = "sphere"
body = "rim"
centre = [0, 0, 0.05]
radius = 0.06
width = 1e-3
rods = ["rod"]
"""

SCENES = {
    "wire": PUSHED + ROD + PUSH + WIRE,
    "tapered": PUSHED + SOLID.replace("radius = 4e-3", "radius = { base = 6e-3, tip = 2e-3 }") + PUSH + THIN,
    "wires": PUSHED + ROD + PUSH + WIRE + WIRE.replace("wire", "other").replace("-0.1]", "0.15]"),
    "base": MOVED + ROD + PUSH + THIN,
    "parameter": 'parameters = ["rod.base.position"]\n' + PUSHED + ROD + PUSH + WIRE,
    "body": MOVED + HEAD + LONG_ROD + BALL + SPHERE,
    "disk": MOVED + HEAD + LONG_ROD + DISK + SPHERE.replace("bodies", "disks"),
    "bump": PUSHED + ROD + PUSH + ON_BALL,
    "rods": PUSHED + SOLID + PUSH + CROSSING,
}
"""Everything that may pass through everything thin."""

ITSELF = '[[rod_contacts]]\nrods = ["rod"]\n'
STEPS = 50
"""Random steps of each scene."""

STEPS_WITH_PARAMETERS = 24
"""Those of a scene with parameters: each has a model of its own."""


@dataclass(frozen=True)
class TextRecipe:
    """A scene as text, with few elements, modes and nodes: contact is felt less, and seen as before."""

    text: str
    dynamics: bool = False

    def model(self) -> Model:
        scene = parse_scene(self.text, list(FEW))
        coarse = {name: replace(own, breaks=(0.0, 0.5, 1.0)) for name, own in build(scene).discretisation.items()}
        return build(scene, coarse, moving=self.dynamics)


def random_steps(model: Model, count: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Unknowns and inputs with parameters at both ends, shapes (count, 2, size) and (count, 2, given)."""
    rng = np.random.default_rng(seed)
    first = 1.5 * rng.standard_normal((count, 1, model.size)) / np.arange(1, model.size + 1)
    x = first + rng.uniform(0.0, 1.0, (count, 2, 1)) * rng.standard_normal((count, 2, model.size))
    own = np.concatenate([model.inputs.pack(), model.parameters.pack()])
    return x, own + 0.1 * rng.standard_normal((count, 2, own.size))


def barred_in_c(model: Model, folder: Path, rows: FloatArray) -> list[bool]:
    """Which steps lead through something thin, by the C of the folder: rows of unknowns and inputs at both ends."""
    names = model_names("watched", model)
    (places,) = [
        kernel(model, own.function, own.kernel) for own in functions_in_c(model, names) if own.spec.name == "places"
    ]
    files = kernel_sources([places, *passage_kernels(model, names)], names)
    words = {
        **passage_words(model, names),
        "size": model.size,
        "given": given_size(model),
        "kernel_reals": largest_room(files, "W"),
        "kernel_integers": largest_room(files, "IW"),
        "calls": resource("templates", "calls.c.in"),
    }
    files["main.c"] = fill((HARNESS / "passages.c").read_text(), words)
    files |= {name: resource("c", name) for name in (*PASSAGE_FILES, *FOURS, *PROGRAM)}
    for name, text in files.items():
        (folder / name).write_text(text)
    sources = [folder / "main.c", folder / "watched_kernels.c"]
    compile_quickly("-std=c99", "-O1", "-w", f"-I{folder}", *sources, "-lm", "-o", folder / "main")
    text = "\n".join(" ".join(map(repr, row)) for row in rows.tolist())
    told = subprocess.run([str(folder / "main")], input=text, capture_output=True, text=True, check=True, timeout=60)
    return [word == "1" for word in told.stdout.split()]


@pytest.mark.parametrize(
    "name", mostly_slow(SCENES, quick=["tapered", "wires", "parameter", "body", "disk", "bump", "rods"])
)
def test_steps_that_are_barred_vs_python(name: str, tmp_path: Path) -> None:
    model = build(parse_scene(SCENES[name], list(FEW)))
    count = STEPS_WITH_PARAMETERS if model.parameters.size else STEPS
    x, given = random_steps(model, count, 3)
    if name in ("body", "disk"):
        # The rod hardly bends, and comes down by more than the sphere is thick.
        x *= 0.1
        given[:, 1, 2] -= 0.4
    inputs, p = np.split(given, [model.inputs.size], axis=2)
    wanted = []
    for row in range(count):
        after = SmoothBarriers(model.at(p[row, 1]) if p.size else model)
        places = places_along(model, (p[row, 0], p[row, 1])) if p.size else None
        wanted.append(after.are_between(x[row, 0], x[row, 1], (inputs[row, 0], inputs[row, 1]), places))
    assert count / 10 < sum(wanted) < count - count / 10
    found = barred_in_c(model, tmp_path, np.concatenate([x, given], axis=2).reshape(count, -1))
    assert found == wanted


TURNS = 30

WITH_PARAMETERS = 9
"""Turns of which a parameter does the same."""

TURNED = 'inputs = ["rod.base.quaternion"]\n' + SOLID + PUSH + THIN


def turned(axis: FloatArray, angle: float, quaternion: FloatArray) -> FloatArray:
    """A quaternion behind a turn about an axis in the world, rad."""
    turn = np.array([np.cos(angle / 2), *np.sin(angle / 2) * axis / np.linalg.norm(axis)])
    return np.asarray(quaternion_product(turn[:, None], quaternion[:, None]))[:, 0]


def least_room(model: Model, x: FloatArray, inputs: FloatArray) -> float:
    """How much nearer a rod may come to its wire on the way between two shapes, over the depth that is admitted."""
    (wire,), properties = model.scene.obstacles, model.discrete.rods["rod"].properties
    radius = 4e-3
    admitted = float(admitted_depth(wire, 1.0, depth_allowed(wire, properties.length), radius))
    shares = np.linspace(0.0, 1.0, 151)[:, None]
    # Where a section is nearest on the way, then about there.
    for _ in range(2):
        ways = [(1.0 - shares) * first + shares * last for first, last in (x, inputs)]
        positions = LookedAt(model, "rod").paths(wire, *ways, every=2)
        distance = np.linalg.norm(positions[..., [0, 2]] - [wire.start[0], wire.start[2]], axis=-1) - wire.radius
        nearest = shares[np.argmin(distance.min(axis=1))]
        shares = np.clip(nearest + np.linspace(-0.01, 0.01, 151)[:, None], 0.0, 1.0)
    return float(distance.min() - radius + admitted) / admitted


def test_steps_in_which_a_base_turns_are_judged_by_where_sections_go(tmp_path: Path) -> None:
    """Turns of up to 170 degrees, against many places on the way; chords lead past the wire, or cut it."""
    model = build(parse_scene(TURNED, list(FEW)))
    of_parameters = TURNED.replace("inputs", "parameters").replace("tangent = [1, 0, 0]", "quaternion = [1, 0, 0, 0]")
    named = build(parse_scene(of_parameters, list(FEW)))
    rng = np.random.default_rng(11)
    start = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0])
    steps, wanted, kept = [], [], []
    for row in range(TURNS):
        first = turned(rng.standard_normal(3), rng.uniform(-0.4, 0.4), start)
        last = turned(np.array([0.2, 1.0, 0.2]) * rng.standard_normal(3), rng.uniform(0.3, 3.0), first)
        x = 0.2 * rng.standard_normal((2, model.size)) / np.arange(1, model.size + 1)
        room = least_room(model, x, np.array([first, last]))
        # Other signs of a quaternion are the same turn.
        last = last if row % 3 else -last
        steps.append(np.concatenate([x, [first, last]], axis=1).ravel())
        wanted.append(room < 0.0)
        # Which side of the bound a rod is on that comes so near to it is overlooked.
        kept.append(abs(room) > 0.5)
        in_python = SmoothBarriers(model).are_between(*x, (first, last))
        assert not kept[-1] or in_python == wanted[-1]
        if row < WITH_PARAMETERS:
            none = np.zeros(0)
            moved = SmoothBarriers(named.at(last))
            assert moved.are_between(*x, (none, none), places_along(named, (first, last))) == in_python
    assert sum(kept) > 0.9 * TURNS
    assert TURNS / 10 < sum(wanted) < TURNS - TURNS / 10
    found = barred_in_c(model, tmp_path, np.array(steps))
    assert [own for own, certain in zip(found, kept, strict=True) if certain] == [
        own for own, certain in zip(wanted, kept, strict=True) if certain
    ]


TAPERED_AND_MOVED = SCENES["tapered"].replace(PUSHED, MOVED)

SIZED = {
    "rod": ('parameters = ["rod.section.radius", "rod.length", "wire.width"]\n' + TAPERED_AND_MOVED, (6, 6, 2, 2)),
    "rods": (
        'parameters = [["rod.section.radius", "other.section.radius"], "other.length"]\n' + SCENES["rods"],
        (2, 8),
    ),
    "itself": ('parameters = ["rod.section.radius", "rod.length"]\n' + MOVED + SOLID + ITSELF, (3, 2)),
}
"""Scenes whose parameters are sizes of what is watched, and how many times as large they get at most."""


@pytest.mark.parametrize("name", SIZED)
def test_steps_are_judged_by_the_sizes_that_parameters_give(name: str, tmp_path: Path) -> None:
    """Python's judgement at the parameters; with the scene's own sizes steps of either scene are judged otherwise."""
    text, largest = SIZED[name]
    model = build(parse_scene(text, list(FEW)))
    count = STEPS_WITH_PARAMETERS
    x, given = random_steps(model, count, 5)
    own = model.parameters.pack()
    given[:, :, model.inputs.size :] = own * np.random.default_rng(6).uniform(0.3, largest, (count, 1, own.size))
    inputs, p = np.split(given, [model.inputs.size], axis=2)
    if name == "rod":
        # Straight, it comes down on its wire to where it touches, and every third time deeper than is admitted.
        base, tip, length, width = p[:, 1].T
        x *= 0.0
        inputs[:] = [0.0, 0.0, 0.05]
        inputs[:, 1, 2] = -0.1 + 1e-3 + base + 0.9 / length * (tip - base)
        inputs[::3, 1, 2] -= 1.6 * (1e-3 + width[::3])
    if name == "itself":
        # Of two numbers for each element the first is its mean bend: from half a circle to more than a whole one.
        x *= 0.02
        x[:, :, ::2] += 2.0 * np.pi * np.random.default_rng(7).uniform(0.5, 1.1, (count, 2, 1))
    wanted = []
    for row in range(count):
        step = (x[row, 0], x[row, 1], (inputs[row, 0], inputs[row, 1]))
        moved = SmoothBarriers(model.at(p[row, 1]))
        wanted.append(moved.are_between(*step))
    assert count / 10 < sum(wanted) < count - count / 10
    found = barred_in_c(model, tmp_path, np.concatenate([x, given], axis=2).reshape(count, -1))
    assert found == wanted


@dataclass(frozen=True)
class OwnRecipe:
    """A scene as text, on the modes and nodes that it fixes."""

    text: str
    dynamics: bool = False

    def model(self) -> Model:
        return build(parse_scene(self.text))


@pytest.mark.slow
def test_a_path_leaves_a_thin_bar_in_c(export_recipe: ExportRecipe) -> None:
    """As in Python; the compiler takes long over so many nodes."""
    made = export_recipe("leaves", OwnRecipe(ON_A_BAR), estimates=False)
    pressed = solve(made.model, estimate_error=False)
    wanted = solve(made.model, {"push.force": OFF_A_BAR}, start=pressed, estimate_error=False)
    found = made.compiled.follow(pressed.inputs, OFF_A_BAR, pressed.x)
    assert wanted.converged and found.converged
    assert_allclose(found.x, wanted.x, rtol=0, atol=1e-9)


def test_rods_that_an_input_lengthens_pass_no_rod_between_sections(tmp_path: Path) -> None:
    model, inputs = lengthened()
    still = np.zeros((len(inputs), 2, model.size))
    found = barred_in_c(model, tmp_path, np.concatenate([still, inputs], axis=2).reshape(len(inputs), -1))
    assert found == [True, False] * 4


ABOVE, BEHIND = np.array([0.0, 0.0, -0.1]), np.array([0.0, 0.0, -0.25])
"""Pushes under which the tip is above the wire, and under which it would be below without it."""

RUBBING = THIN + "friction = 0.1\n"
"""A wire that presses nodes, as what rubs does: between them a rod sinks in, and its loads stall."""


@pytest.fixture(scope="module")
def barred(export_recipe: ExportRecipe) -> Exported:
    """A rod above a wire, thinner than the steps of the load are long."""
    return export_recipe("barred", TextRecipe(PUSHED + ROD + PUSH + RUBBING), estimates=False)


def height(made: Exported, x: FloatArray, inputs: FloatArray) -> float:
    """Of the tip, m."""
    return float(made.tips(x, inputs)[0, 2])


def test_without_the_wire_the_rod_comes_to_its_other_side() -> None:
    model = TextRecipe(PUSHED + ROD + PUSH).model()
    for push, behind in ((ABOVE, False), (BEHIND, True)):
        found = solve(model, {"push.force": push}, estimate_error=False)
        assert found.converged
        assert (found.tip().position[2] < -0.1) == behind


def test_a_wire_that_presses_between_nodes_holds_the_rod() -> None:
    """Its stretch is shorter than sections are apart at which contacts are looked for: no contact was told."""
    pressed = solve(TextRecipe(PUSHED + ROD + PUSH + THIN).model(), {"push.force": BEHIND}, estimate_error=False)
    assert pressed.converged
    (wire,) = pressed.contacts
    assert wire.end - wire.start < 1e-3
    assert_allclose(wire.force + pressed.base_wrench().force, -BEHIND, rtol=0, atol=1e-12)
    # It lies on the wire, whose axis is at 0.9 and −0.1.
    assert pressed.pose(wire.start).position[2] > -0.1


def test_no_solve_leads_through_a_wire(barred: Exported) -> None:
    """From the unloaded rod, from a solution, and along the inputs; Python ends alike."""
    compiled = barred.compiled
    near = compiled.solve(ABOVE)
    assert near.converged
    assert_allclose(near.x, barred.solve(ABOVE).x, rtol=0, atol=1e-9)
    wanted = barred.solve(BEHIND)
    answers = [compiled.solve(BEHIND), compiled.solve(BEHIND, near.x), compiled.follow(ABOVE, BEHIND, near.x)]
    for found in answers:
        assert found.outcome is wanted.outcome is Outcome.LOAD_STALLED
        assert height(barred, found.x, BEHIND) > -0.15
        assert 0.0 < found.load_factor < 1.0


def test_sources_compile_without_a_warning(barred: Exported) -> None:
    gcc(*C99, "-Werror", "-fsyntax-only", barred.folder / "barred.c")


def test_a_rod_that_leaves_a_thin_wire_takes_few_steps(barred: Exported) -> None:
    """Steps are a hundred times as long as the wire is thick: C, which takes 400 at most, reaches large loads too."""
    away = np.array([0.0, 0.0, 2.0])
    found = barred.compiled.solve(away)
    assert found.converged
    assert found.iterations < 60
    assert_allclose(found.x, barred.solve(away).x, rtol=0, atol=1e-9)


def turn(made: Exported, word: str, inputs: FloatArray, x: FloatArray, memory: Any, *derivatives: None) -> Outcome:
    """A call of track or of recover, which moves x and memory."""
    work = ctypes.create_string_buffer(made.handle[f"{made.name}_workspace_size"]())
    function = made.handle[f"{made.name}_{word}"]
    status: int = function(pointer(inputs), pointer(x), memory, None, *derivatives, work, None)
    return OUTCOMES[status]


def test_no_turn_leads_through_a_wire(barred: Exported) -> None:
    """Turns up to the wire are followed; one beyond is lost, and no number of them recovers."""
    x = barred.compiled.solve(ABOVE).x.copy()
    # Far more than the memory of so few unknowns takes.
    memory = ctypes.create_string_buffer(1 << 16)
    assert turn(barred, "track", ABOVE, x, memory, None, None) is Outcome.CONVERGED
    before = x.copy()
    assert turn(barred, "track", BEHIND, x, memory, None, None) is Outcome.LOST_TRACK
    assert_allclose(x, before, rtol=0, atol=0)
    ends = [turn(barred, "recover", BEHIND, x, memory) for _ in range(20)]
    # Every other turn begins with a long step, whose halvings take up its budget.
    assert set(ends[-2:]) == {Outcome.LOAD_STALLED, Outcome.LOST_TRACK}
    assert Outcome.CONVERGED not in ends
    assert height(barred, x, BEHIND) > -0.15


@pytest.mark.parametrize("lanes", mostly_slow([False, True], quick=[True]), ids=["one by one", "side by side"])
def test_no_row_leads_through_a_wire(lanes: bool) -> None:
    model = TextRecipe(PUSHED + ROD + PUSH + RUBBING).model()
    library = row_library(model, lanes=lanes)
    assert library.in_lanes == lanes
    found = library.solve(np.array([ABOVE, BEHIND]))
    assert [OUTCOMES[int(end)] for end in found[:, 0]] == [Outcome.CONVERGED, Outcome.LOAD_STALLED]
    assert_allclose(found[0, 3:6], solve(model, {"push.force": ABOVE}).tip().position, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_no_step_of_a_motion_leads_through_a_wire(export_recipe: ExportRecipe) -> None:
    """A rod that swings past the place of a wire: the step is done where there is none, and not where there is."""
    ends = {}
    aside = THIN.replace("[0.9, -1", "[0.9, 5").replace("[0.9, 1", "[0.9, 7")
    for name, wire in (("swinging", aside), ("stopped", THIN)):
        made = export_recipe(name, TextRecipe(PUSHED + ROD + PUSH + wire, dynamics=True))
        model = made.model
        behind = solve(TextRecipe(PUSHED + ROD + PUSH).model(), {"push.force": BEHIND}).x
        still = np.zeros(model.size)
        state = StepState(x=still, v=behind / 0.02, a=still)
        for parts in (1, 4):
            options = StepOptions(tolerance=1e-11, iterations=20, parts=parts)
            ends[name, parts] = made.compiled.step(state, 0.02, np.zeros(3), options=options)
        if name == "swinging":
            end = ends[name, 1].state
            assert height(made, end.x, np.zeros(3)) < -0.15
        else:
            assert_allclose(ends[name, 4].state.x, state.x, rtol=0, atol=0)
    assert [(name, parts, end.status) for (name, parts), end in ends.items()] == [
        ("swinging", 1, MotionStatus.DONE),
        ("swinging", 4, MotionStatus.DONE),
        ("stopped", 1, MotionStatus.NOT_SOLVED),
        ("stopped", 4, MotionStatus.NOT_SOLVED),
    ]
