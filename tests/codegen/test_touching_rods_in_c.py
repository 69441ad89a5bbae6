"""Rods that touch rods without a width, at rest in exported C: against Python, beams, and differences."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, build, export, scene_from_dict, solve
from cosserat_casadi.codegen.contact.compiled import CompiledContactSolution
from cosserat_casadi.equilibrium.contact.rod_gaps import RodsApart
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from tests.codegen.contact_libraries import ContactLibrary
from tests.codegen.libraries import C99, QUICK, compile_quickly, gcc
from tests.contact.test_rods_that_rest_on_rods import BELOW, LENGTH, bending, pressed, rod

LINT = (*C99, "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Wvla", "-Werror")

MODULUS = "a.material.youngs_modulus"


def model_of(tables: dict[str, Any], modes: int, nodes: int) -> Model:
    """The model of a scene on fixed modes."""
    return build(scene_from_dict(tables | {"accuracy": {"modes": modes, "nodes": nodes}}))


def down(force: float) -> FloatArray:
    """Stacked inputs of a force downwards."""
    return np.array([0.0, 0.0, -force])


def library(model: Model, folder: Path, load_cases: list[FloatArray], **options: bool) -> ContactLibrary:
    return ContactLibrary(model, export(model, folder, load_cases=np.array(load_cases), **options))


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """Two crossed rods on two modes, which know contact and none."""
    tables = pressed([0, 0, -3e-4], BELOW)
    for entry in tables["rods"]:
        entry["strain"] = ["bending_x", "bending_y"]
    folder = tmp_path_factory.mktemp("small") / "small"
    return library(model_of(tables, 2, 4), folder, [down(3e-4)], estimate_errors=False)


@pytest.fixture(scope="module")
def crossed(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """Two crossed rods with errors, stability, batches and a parameter."""
    tables = pressed([0, 0, -5e-4], BELOW, parameters=[MODULUS])
    folder = tmp_path_factory.mktemp("crossed") / "crossed"
    return library(model_of(tables, 3, 6), folder, [down(2e-4)], stability=True, batches=True)


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """A rod on the ends of which two others press: their places are not in the order of the contacts on it."""
    rods = [
        rod("c", 1e-3, {"position": [0.03, -0.05, 0.0025], "tangent": [0, 1, 0]}),
        rod("b", 1e-3, {"tangent": [1, 0, 0]}),
        rod("a", 1e-3, {"position": [0.07, 0.06, 0.0025], "tangent": [0, -1, 0]}),
    ]
    loads = [{"name": name, "kind": "tip_wrench", "rod": name[-1], "force": [0, 0, -2e-4]} for name in ("on_a", "on_c")]
    tables = {"schema": 1, "rods": rods, "loads": loads, "rod_contacts": [{"exact": True}]}
    tables |= {"inputs": ["on_a.force", "on_c.force"]}
    folder = tmp_path_factory.mktemp("three") / "three"
    cases = [np.array([0, 0, -2e-4, 0, 0, 1e-4]), np.array([0, 0, 1e-4, 0, 0, -2e-4])]
    return library(model_of(tables, 2, 4), folder, cases, estimate_errors=False)


def assert_same(found: CompiledContactSolution, wanted: Solution) -> None:
    """Whether C and Python agree on tips, on both places of every contact, and on its force."""
    assert found.converged, found.message
    assert wanted.converged, wanted.message
    for name in wanted.model.lengths:
        assert_allclose(found.tips[name][:3], wanted.tip(name).position, rtol=0, atol=1e-10 * LENGTH)
    assert len(found.contacts) == len(wanted.contacts)
    for own, other in zip(found.contacts, wanted.contacts, strict=True):
        assert (own.owner, own.obstacle, own.kind) == (other.owner, other.obstacle, other.kind)
        assert_allclose(own.on_rods or (), other.on_rods or (), rtol=0, atol=1e-10)
        scale = float(np.linalg.norm(other.force))
        assert_allclose(own.force, other.force, rtol=0, atol=1e-10 * scale)
        assert_allclose(own.ends, other.ends, rtol=1e-10, atol=0)


def differences(held: ContactLibrary, at: FloatArray, near: CompiledContactSolution, size: float) -> list[FloatArray]:
    """Central differences of tips and of contacts by every input, one input a row, tips of all rods first."""
    columns = []
    for axis in range(len(at)):
        change = size * np.eye(len(at))[axis]
        ends = [held.loaded.solve(at + sign * change, near) for sign in (1, -1)]
        numbers = [
            np.concatenate(
                [
                    *end.tips.values(),
                    *([c.start, c.end, c.ends[0], 0.0, (c.on_rods or (0, 0))[1]] for c in end.contacts),
                ]
            )
            for end in ends
        ]
        columns.append((numbers[0] - numbers[1]) / (2 * size))
    return columns


def test_two_rods_that_touch(small: ContactLibrary) -> None:
    """Places, force and tips are those of Python, and their derivatives those of central differences."""
    inputs = np.array([0.0, 1e-4, -4e-4])
    found = small.loaded.solve(inputs)
    assert_same(found, solve(small.model, inputs, estimate_error=False))
    tips = small.loaded.sensitivity(found)
    contacts = small.loaded.contact_sensitivity(found)
    assert len(found.contacts) == 1 and tips is not None and contacts is not None
    by_inputs = np.concatenate([*tips.values(), *contacts])
    wanted = np.transpose(differences(small, inputs, found, 1e-8))
    largest = np.abs(by_inputs).max(axis=1, keepdims=True)
    scale = np.where(largest > 0.0, largest, 1.0)
    assert_allclose(by_inputs / scale, wanted / scale, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_touch_slide_and_lift_off(crossed: ContactLibrary) -> None:
    """Rods touch, slide, part and touch again as in Python."""
    found = crossed.loaded.start()
    wanted: Solution | None = None
    counts = []
    for inputs in (down(3e-4), down(1e-3), down(1e-5), np.array([0.0, 1e-4, -3e-4])):
        found = crossed.loaded.solve(inputs, found)
        wanted = solve(crossed.model, inputs, start=wanted, estimate_error=False)
        assert_same(found, wanted)
        counts.append(len(found.contacts))
    assert counts == [1, 1, 0, 1]


def test_no_step_leads_through_another_rod(small: ContactLibrary) -> None:
    """A load that would take the rod to the other side at once, where nothing touches, ends in contact.

    A turn of a control loop goes there in parts; with a budget for few of them it says so.
    """
    far = small.loaded.solve(down(1e-5))
    assert far.converged and not far.contacts
    for force in (1e-3, 2e-3, 5e-3):
        found = small.loaded.solve(down(force), far)
        tracked = small.loaded.track(down(force), far)
        for end in (found, tracked):
            assert end.converged and len(end.contacts) == 1
        assert_allclose(tracked.z, found.z, rtol=0, atol=1e-9)
        short = small.loaded.track(down(force), far, max_iterations=60, max_parts=20)
        assert short.outcome in (Outcome.CONTACT_UNSETTLED, Outcome.LOST_TRACK)


def test_rods_touch_where_their_surfaces_meet(small: ContactLibrary) -> None:
    """A beam that bends to another rod touches it at the force 6 EI g/(w² (3L − w)): none below, contact above."""
    own = 0.07
    force = 2e-3 * 6 * bending(1e-3) / (own**2 * (3 * LENGTH - own))
    far = small.loaded.solve(down(0.6 * force))
    for share, count in ((0.98, 0), (1.02, 1)):
        found = small.loaded.solve(down(share * force), far)
        assert found.converged, found.message
        assert len(found.contacts) == count
    margins = small.loaded.margins(far)
    assert margins is not None
    assert_allclose(margins.gap * LENGTH, 0.4 * 2e-3, rtol=2e-2, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("force", [(0, 2e-6, -1e-5), (0, 4e-5, -2e-4), (0, 1e-4, -5e-4), (4.4e-5, 1e-5, -1e-4)])
def test_errors_verdicts_and_margins(crossed: ContactLibrary, force: tuple[float, ...]) -> None:
    """They are those of Python, in contact and without; many load cases have the answers of single ones.

    Under the last force the place on the other rod has the largest error.
    """
    inputs = np.array(force)
    found = crossed.loaded.solve(inputs)
    wanted = solve(crossed.model, inputs)
    assert_same(found, wanted)
    assert_allclose(found.error_estimate, wanted.error_estimate, rtol=1e-4, atol=1e-10)
    judged = crossed.loaded.stability(found)
    assert judged is not None and judged.stable and wanted.stable
    assert_allclose(judged.smallest_eigenvalue, wanted.smallest_eigenvalue, rtol=1e-9, atol=0)
    margins = crossed.loaded.margins(found)
    assert margins is not None and margins.gap > 0.0
    assert np.isfinite(margins.force) == bool(found.contacts)
    if not found.contacts:
        # The nearest section of the other rod is none of those that are looked at first; the first rod's is one.
        least = min(valley.gap for valley in RodsApart.of(wanted, ("a", "b")).valleys)
        assert_allclose(margins.gap, least, rtol=0, atol=2e-5)
    (one,) = crossed.loaded.solve_batch(inputs[None])
    assert_same(one, wanted)


@pytest.mark.slow
def test_parameters_of_rods_that_touch(crossed: ContactLibrary) -> None:
    """A stiffer rod touches elsewhere: as in Python, and with derivatives as by central differences."""
    found = crossed.loaded.solve(down(5e-4), parameters={MODULUS: 2.2e6})
    assert_same(found, solve(crossed.model, down(5e-4), parameters={MODULUS: 2.2e6}))
    derivatives = crossed.loaded.contact_sensitivity(found)
    assert derivatives is not None
    ends = [crossed.loaded.solve(down(5e-4), found, parameters={MODULUS: 2.2e6 + way}) for way in (200.0, -200.0)]
    places = [np.array(end.contacts[0].on_rods) for end in ends]
    slope = (places[0] - places[1]) / 400.0
    assert_allclose(derivatives[0][[0, 4], 3], slope, rtol=1e-6, atol=0)


@pytest.mark.slow
def test_what_the_library_does_not_know_is_told(crossed: ContactLibrary, tmp_path: Path) -> None:
    """From rods that are apart a library without load cases knows no contact; a tip that slips off is no answer."""
    apart = model_of(pressed([0, 0, -1e-5], BELOW), 2, 4)
    ignorant = library(apart, tmp_path / "apart", [down(1e-5)], estimate_errors=False).loaded
    assert ignorant.arrangements == [[]]
    assert ignorant.solve(down(9e-6)).converged
    told = ignorant.solve(down(5e-4))
    assert told.outcome is Outcome.CONTACT_UNSETTLED and not told.converged
    slipped = crossed.loaded.solve(np.array([0.0, 2e-3, -5e-3]))
    assert not slipped.converged


@pytest.mark.slow
@pytest.mark.parametrize("force", [2.5e-5, 4e-5])
def test_two_crossed_beams(crossed: ContactLibrary, force: float) -> None:
    """Small forces bend two cantilevers until they touch: what closes the gap N is on both, w³/3EI each.

    The rods turn by 0.05 rad, so that beams are right to some thousandths of the deflection.
    """
    found = crossed.loaded.solve(down(force))
    (contact,) = found.contacts
    own, other = np.array(contact.on_rods) * LENGTH
    stiffness = bending(1e-3)
    free = force * own**2 * (3 * LENGTH - own) / (6 * stiffness)
    push = (free - 2e-3) / ((own**3 + other**3) / (3 * stiffness))
    assert_allclose(contact.ends[0], push, rtol=1e-2, atol=0)
    assert_allclose([own, other], [0.07, 0.05], rtol=1e-2, atol=0)


@pytest.mark.slow
def test_places_of_second_rods_in_any_order(three: ContactLibrary) -> None:
    """Of three rods either, both and none press, as in Python."""
    found = three.loaded.start()
    wanted: Solution | None = None
    for a, c, count in ((-2e-4, -2e-4, 2), (-2e-4, 1e-4, 1), (1e-4, 1e-4, 0), (1e-4, -2e-4, 1), (-3e-4, -1e-4, 2)):
        inputs = np.array([0, 0, a, 0, 0, c])
        found = three.loaded.solve(inputs, found)
        wanted = solve(three.model, inputs, start=wanted, estimate_error=False)
        assert_same(found, wanted)
        assert len(found.contacts) == count


@pytest.mark.slow
def test_sources_compile_without_a_word_and_the_demo_runs(crossed: ContactLibrary, tmp_path: Path) -> None:
    """Without a read or write out of bounds, and without undefined arithmetic."""
    for file in ("crossed.c", "crossed_demo.c"):
        gcc(*LINT, "-fsyntax-only", crossed.folder / file)
    sources = [crossed.folder / f"crossed{end}.c" for end in ("_demo", "", "_kernels")]
    compile_quickly("-std=c99", *QUICK, *sources, "-o", tmp_path / "demo", "-lm")
    printed = subprocess.run([tmp_path / "demo", "0", "0", "-4e-4"], check=True, capture_output=True, text=True).stdout
    answer = json.loads(printed)
    assert answer["status"] == "converged"
    (contact,) = answer["contacts"]
    wanted = solve(crossed.model, down(4e-4)).contacts[0]
    assert_allclose(contact["force"], wanted.force, rtol=0, atol=1e-10)
