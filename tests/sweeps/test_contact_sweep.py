"""Sweeps of scenes with obstacles: rows in Python and in C, each from the contacts of a row before it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, choose, discretise, parse_scene, solve, sweep
from cosserat_casadi.codegen.rows import row_library, row_results
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.sweeps.outcome_file import read_sweep
from cosserat_casadi.sweeps.outcome_table import LABELS
from cosserat_casadi.sweeps.row_model import RowModel, result_row
from cosserat_casadi.sweeps.table import table_of
from cosserat_casadi.sweeps.variants import variants_of
from cosserat_casadi.sweeps.work import IN_CONTACT_FROM, LibraryWithPython, chunks
from tests.codegen.contact_libraries import pulled_over_bar
from tests.paths.test_contact_path import BAR

SCENE = BAR.replace('inputs = ["rod.base.position"]\n', "").replace("tolerance = 1e-6", "modes = 4")

PUSHES = np.array([-0.02, -0.5, -2.0, -1.0])


@pytest.mark.slow
def test_rows_hold_their_contacts(tmp_path: Path) -> None:
    scene = parse_scene(SCENE)
    file = tmp_path / "pushes.csv"
    swept = sweep(scene, {"push.force.z": PUSHES}, file, cores=1, stability=True)
    assert swept.counts == {"converged": 4}
    assert_allclose(swept["rod.bar.contacts"], [0, 1, 1, 1], rtol=0, atol=0)
    assert np.isnan(swept["rod.bar.from"][0])
    assert_allclose(swept["rod.bar.force.z"][0], 0.0, rtol=0, atol=0)
    model = build(scene)
    for row in (1, 3):
        alone = solve(model, {"push.force": [0, 0, PUSHES[row]]})
        (contact,) = alone.contacts
        found = [swept[f"rod.bar.{word}"][row] for word in ("from", "to", "force.x", "force.y", "force.z")]
        assert_allclose(found, [contact.start, contact.end, *contact.force], rtol=0, atol=1e-9)
        assert_allclose(swept.positions()[row], alone.tip().position, rtol=0, atol=1e-10)
        assert_allclose(swept["smallest_eigenvalue"][row], alone.smallest_eigenvalue, rtol=1e-7, atol=0)
    # The file says the same, with empty cells where nothing touches.
    assert_allclose(read_sweep(file).values, swept.values, rtol=0, atol=0, equal_nan=True)


def test_which_rows_in_contact_are_compiled() -> None:
    """Many that differ in inputs and parameters, by a library that looks for contact, and leaves what it does not find.

    Lengths and sections C has in numbers.
    """
    scene = parse_scene(SCENE)
    many = np.linspace(0.4, 0.6, IN_CONTACT_FROM)
    for column in ("push.force.z", "rod.stiffness.bending_y"):
        variants = variants_of(scene, table_of({column: many}))
        assert all(chunk.in_contact and not chunk.compiled for chunk in chunks(variants))
    lengths = variants_of(scene, table_of({"rods.rod.length": many}))
    assert not any(chunk.compiled or chunk.in_contact for chunk in chunks(lengths))
    # Errors of bodies are not those of C: their rows keep the small chunks of Python.
    body = '[[bodies]]\nname = "head"\nmass = 0.1\n[[joints]]\nrod = "rod"\nbody = "head"\nkind = "fixed"\n'
    headed = variants_of(parse_scene(SCENE + body), table_of({"push.force.z": many}))
    assert not any(chunk.in_contact for chunk in chunks(headed))
    few = variants_of(scene, table_of({"push.force.z": many[: IN_CONTACT_FROM - 1]}))
    assert not any(chunk.in_contact for chunk in chunks(few))


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [{}, {"rod.stiffness.bending_y": [0.9, 1.3, 0.7, 1.1]}])
def test_compiled_rows_in_contact_are_those_of_python(
    monkeypatch: pytest.MonkeyPatch, stiffness: dict[str, list[float]]
) -> None:
    scene = pulled_over_bar()
    model = build(scene, discretise(scene, 2, 4))
    table = {"push.force.z": PUSHES, "tendon.tension": [1.0, 2.0, 2.5, 0.5], **stiffness}
    in_python = sweep(model, table, cores=1, stability=True)
    for module in ("arguments", "work"):
        monkeypatch.setattr(f"cosserat_casadi.sweeps.{module}.IN_CONTACT_FROM", len(PUSHES))
    in_c = sweep(model, table, cores=1, stability=True)
    assert in_c.record["arguments"] == list(stiffness)
    assert in_c.columns == in_python.columns
    assert_allclose(in_c["rod.bar.contacts"], [0, 0, 1, 1], rtol=0, atol=0)
    # Iterations and residuals are those of another solver, errors are judged by the tips alone.
    judged = [in_c.columns.index(name) for name in ("iterations", "residual", "error_estimate")]
    same = [k for k in range(len(in_c.columns)) if k not in judged]
    assert_allclose(in_c.values[:, same], in_python.values[:, same], rtol=0, atol=1e-8, equal_nan=True)
    # C tells those of tips, Python those of all sections.
    assert np.all(in_c["error_estimate"] <= 1.01 * in_python["error_estimate"])


def test_python_solves_rows_with_parameters() -> None:
    """Which C leaves: as those of a scene with these numbers, eigenvalues in units of the scene as it stands."""
    baked, named = (SCENE.replace("bending_y = 0.5", f"bending_y = {value}") for value in (0.7, 0.5))
    head = 'parameters = ["rod.stiffness.bending_y"]\n'
    push = [0.0, 0.0, -1.0]
    (row,) = RowModel(head + named, stability=True, measure=SCENE).solve(np.array([[*push, 0.7]]))
    (own,) = RowModel(baked, stability=True).solve(np.array([push]))
    (counted,) = RowModel(baked, stability=True, measure=SCENE).solve(np.array([push]))
    assert_allclose(row, counted, rtol=1e-9, atol=1e-11)
    own[-2] *= 0.7 / 0.5
    assert_allclose(counted, own, rtol=1e-9, atol=1e-11)


def test_rows_that_c_leaves_are_solved_in_python() -> None:
    """And rows go to C from neighbour to neighbour, and come back in their order."""
    scene = parse_scene(SCENE)
    pushes = np.zeros((4, 3))
    pushes[:, 2] = [-0.02, -0.5, -0.1, -0.3]
    seen = []

    class Left:
        results = len(row_results(scene, estimate_errors=True))

        def solve(self, inputs: FloatArray) -> FloatArray:
            seen.extend(inputs[:, 2].tolist())
            rows = np.full((len(inputs), self.results), np.nan)
            rows[:, 0] = [0, LABELS.index("contact_unsettled"), 0, 0]
            return rows

    python = RowModel(SCENE, estimate_errors=True)
    rows = LibraryWithPython(Left(), python, in_contact=True).solve(pushes)  # type: ignore[arg-type]
    assert seen == [-0.02, -0.1, -0.3, -0.5]
    assert_allclose(rows[:, 0], np.zeros(4), rtol=0, atol=0)
    (expected,) = RowModel(SCENE, estimate_errors=True).solve(pushes[[2]])
    assert_allclose(rows[2], expected, rtol=0, atol=0, equal_nan=True)
    assert np.isnan(rows[[0, 1, 3], 1:]).all()


@pytest.mark.slow
def test_compiled_rows_of_smooth_contact_are_those_of_python() -> None:
    """The same columns, and in them the same numbers: none for contact, and stability in its own."""
    scene = parse_scene(SCENE + "width = 0.02\n")
    model = build(scene)
    columns = row_results(scene, stability=True)
    assert not any(".bar." in column for column in columns)
    solution = solve(model)
    assert solution.contacts
    (row,) = row_library(model, stability=True).solve(solution.inputs[None])
    expected = result_row(solution, len(columns), solution)
    # Iterations and residuals are those of another solver.
    assert_allclose(row[3:], expected[3:], rtol=1e-7, atol=1e-9)


def test_a_row_starts_from_the_row_before(monkeypatch: pytest.MonkeyPatch) -> None:
    starts = []

    def noted(model, inputs, start=None, **options):  # type: ignore[no-untyped-def]
        starts.append(start)
        return solve(model, inputs, start=start, **options)

    monkeypatch.setattr("cosserat_casadi.sweeps.row_model.solve", noted)
    RowModel(SCENE).solve(np.array([[0.0, 0.0, -0.5], [0.0, 0.0, -0.6]]))
    assert starts[0] is None
    assert starts[1].contacts[0].obstacle == "bar"


def test_a_row_whose_contacts_are_not_found_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    unsettled = Outcome.CONTACT_UNSETTLED

    def lost(model, inputs, **options):  # type: ignore[no-untyped-def]
        return replace(solve(model, inputs), outcome=unsettled, message=unsettled.value)

    monkeypatch.setattr("cosserat_casadi.sweeps.row_model.solve", lost)
    ((ended, *rest),) = RowModel(SCENE).solve(np.array([[0.0, 0.0, -0.01]])).tolist()
    assert LABELS[int(ended)] == "contact_unsettled"
    # Nothing of what was not found is told.
    assert np.all(np.isnan(rest[2:]))


@pytest.mark.slow
def test_modes_for_many_cases_in_contact() -> None:
    cases = [{"push.force": [0, 0, push]} for push in PUSHES]
    choice = choose(parse_scene(SCENE), tolerance=1e-5, cases=cases)
    assert choice.met
    assert [len(solve(choice.model, case).contacts) for case in cases] == [0, 1, 1, 1]
