"""The estimated error of every row of a sweep: in C, in Python, in contact, of tubes, in files and the summary."""

from __future__ import annotations

import csv
import json
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from rich.console import Console

from cosserat_casadi import build, parse_scene, read_scene, read_sweep, sobol_table, solve, sweep
from cosserat_casadi.cli.reports.sweep import print_sweep
from cosserat_casadi.sweeps.outcome_file import record_file
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.run import plan_sweep
from cosserat_casadi.sweeps.sobol import varied_results
from cosserat_casadi.sweeps.table import table_of
from tests.families import mostly_slow
from tests.paths.test_contact_path import BAR
from tests.scenes import push, rod, scene

pytestmark = pytest.mark.usefixtures("few_checked")

COARSE = scene(push(force=[0.9, 0.0, -0.4]), rods=[rod("planar")], accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-4})
"""A rod on two modes, which keep the tolerance under small loads alone."""

PUSHES = [0.1, 0.5, 3.0, 4.0]
"""N, with errors on both sides of the tolerance."""


def printed(sweep: Sweep) -> str:
    out = StringIO()
    print_sweep(Console(file=out, width=400), sweep, Path("rows.csv"), None, finished=False)
    return out.getvalue()


@pytest.mark.parametrize("compiled_from", mostly_slow([1, 1000], quick=[1]))
def test_errors_of_rows_are_those_of_solve(compiled_from: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.arguments.COMPILED_FROM", compiled_from)
    file = tmp_path / "rows.csv"
    stiffness = [1.4, 1.4, 1.4, 1.5]
    found = sweep(COARSE, {"push.force.x": PUSHES, "rod.stiffness.bending_y": stiffness}, file)
    assert found.converged.all()
    assert found.columns[-2:] == ("error_estimate", "within_tolerance")
    expected = [solve(build(COARSE), {"push.force": [push_x, 0.0, -0.4]}) for push_x in PUSHES[:3]]
    assert_allclose(found["error_estimate"][:3], [one.error_estimate for one in expected], rtol=1e-5, atol=0)
    assert_array_equal(found["within_tolerance"][:3], [one.within_tolerance for one in expected])
    assert_array_equal(found.missed, found["error_estimate"] > 1e-4)
    assert found.missed.any()
    assert not found.missed.all()
    assert not found.holds
    rows = list(csv.DictReader(file.read_text().splitlines()))
    words = ["false" if missed else "true" for missed in found.missed]
    assert [row["within_tolerance"] for row in rows] == words
    read = read_sweep(file)
    assert_array_equal(read.values, found.values)
    assert_array_equal(read.missed, found.missed)
    assert json.loads(record_file(file).read_text())["missed"] == found.missed.sum()


def test_what_has_no_equilibrium_is_within_no_tolerance(tmp_path: Path) -> None:
    file = tmp_path / "rows.parquet"
    found = sweep(COARSE, {"push.moment.y": [0.3, 400.0], "push.force.x": 0.0, "push.force.z": 0.0}, file)
    assert found.converged.tolist() == [True, False]
    assert_array_equal(np.isnan(found["error_estimate"]), [False, True])
    assert_array_equal(found["within_tolerance"], [1.0, 0.0])
    # Only what claims to be an equilibrium can be one of another rod.
    assert not found.missed.any()
    assert_array_equal(read_sweep(file).values, found.values)


@pytest.mark.slow
def test_a_tolerance_that_nobody_wrote_is_not_missed() -> None:
    fixed = scene(push(), rods=[rod("planar")], accuracy={"modes": 2, "nodes": 8})
    found = sweep(fixed, {"push.force.x": PUSHES})
    assert (found["error_estimate"] > 1e-6).any()
    assert np.isnan(found["within_tolerance"]).all()
    assert found.holds
    assert "asks for no tolerance" in printed(found)


@pytest.mark.slow
def test_rows_without_estimates_are_those_of_older_tables(tmp_path: Path) -> None:
    """The same rows without the two columns, and another sweep than that with them."""
    file = tmp_path / "rows.csv"
    table = {"push.force.x": PUSHES}
    found = sweep(COARSE, table, file, estimate_errors=False)
    estimated = sweep(COARSE, table)
    assert estimated.columns == (*found.columns, "error_estimate", "within_tolerance")
    assert_array_equal(estimated.values[:, :-2], found.values)
    record = json.loads(record_file(file).read_text())
    assert "missed" not in record
    del record["tolerance_binds"]
    record_file(file).write_text(json.dumps(record))
    older = read_sweep(file)
    assert_array_equal(older.values, found.values)
    assert not older.missed.any()
    assert "Estimated error of" not in printed(older)
    plans = [plan_sweep(COARSE, table_of(table), estimate_errors=asked) for asked in (True, False)]
    assert plans[0].identity != plans[1].identity


def test_the_summary_counts_rows_that_miss_the_tolerance() -> None:
    found = sweep(COARSE, {"push.force.x": PUSHES})
    assert found.missed.tolist() == [False, False, True, True]
    said = printed(found)
    largest = f"at most {found['error_estimate'].max():.1e} (row {1 + np.argmax(found['error_estimate'])})"
    assert f"Estimated error of 4 converged rows {largest}: 2 rows above" in said
    assert "above the tolerance of 0.0001. The scene fixes its modes" in said
    small = sweep(COARSE, {"push.force.x": PUSHES[:1]})
    assert "(row 1), within 0.0001." in printed(small)
    assert small.holds


def test_modes_chosen_on_too_few_rows_are_to_be_chosen_on_more() -> None:
    record = {
        "title": None,
        "tolerance": 1e-4,
        "chosen": {"discretisation": {"modes": [3], "nodes": 9}, "rows": [0], "converged": 1, "error_estimate": 1e-5},
        "checked": [],
    }
    values = np.array([[7.0, 1e-5, 1.0], [7.0, 1.0, 0.0]])
    swept = Sweep((), ("iterations", "error_estimate", "within_tolerance"), values, np.zeros(2, dtype=np.int64), record)
    assert "1 row above the tolerance of 0.0001. Choose modes on more rows with --samples" in printed(swept)


TOUCHING = BAR.replace('inputs = ["rod.base.position"]\n', "").replace(
    "tolerance = 1e-6", "modes = 4, tolerance = 1e-3"
)


@pytest.mark.slow
def test_rows_in_contact_have_the_errors_of_their_solves() -> None:
    touching = parse_scene(TOUCHING)
    found = sweep(touching, {"push.force.z": [-0.5, -1.0]}, cores=1)
    expected = solve(build(touching), {"push.force": [0.0, 0.0, -0.5]})
    assert expected.contacts
    assert_allclose(found["error_estimate"][0], expected.error_estimate, rtol=1e-6, atol=0)
    assert found["within_tolerance"][0] == expected.within_tolerance


@pytest.mark.slow
def test_rows_of_tubes_have_the_errors_of_their_solves() -> None:
    tubes = read_scene(Path(__file__).parents[2] / "examples" / "concentric_tubes.toml")
    found = sweep(tubes, {"inner.rotation": [0.0, 1.3]}, cores=1)
    assert found.converged.all()
    assert (found["error_estimate"] <= tubes.accuracy.tolerance).all()
    assert_array_equal(found["within_tolerance"], [1.0, 1.0])


def test_errors_have_no_sensitivity_indices() -> None:
    table = sobol_table({"push.force.x": {"uniform": [-0.5, 0.5]}}, samples=3, seed=1)
    swept = sweep(COARSE, table)
    assert "error_estimate" in swept.found
    assert not {"error_estimate", "within_tolerance"} & set(varied_results(swept))
