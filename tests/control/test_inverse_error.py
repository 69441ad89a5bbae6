"""The error of the model in answers of inverse problems: in Python, in tables and their files, in the summary."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from cosserat_casadi import Inverse, Scene, build, inverse, scene_from_dict, solve
from cosserat_casadi.cli.commands.inverse import print_inverse_table
from cosserat_casadi.cli.reports.solution import print_inverse
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.control.target_table import TargetTable, read_targets
from cosserat_casadi.results.inverse_table import row_outcome, table_text
from tests.scenes import push, scene

NEAR, FAR = (0.0365, 0.0, 0.7991), (0.1096, 0.0343, 0.7903)
"""Where forces of 0.3 N and of 0.9 N bring the tip, m."""

BOUNDS = [{"input": "push.force", "lower": -1.5, "upper": 1.5}]


def wanted(position: Sequence[float] = NEAR, **accuracy: Any) -> Scene:
    """A rod whose tip force is to be found, on modes that are fixed."""
    target = {"kind": "position", "rod": "rod", "position": list(position)}
    bending = ["bending_x", "bending_y", "torsion", "extension"]
    free = {"inputs": ["push.force"], "targets": [target], "bounds": BOUNDS}
    return scene(push(force=[0.0, 0.0, 0.0]), strain=bending, accuracy=accuracy, **free)


def printed(found: Inverse) -> str:
    out = StringIO()
    print_inverse(Console(file=out, width=300), found, [])
    return out.getvalue()


def test_the_error_of_an_answer_is_that_of_a_solve_at_its_inputs() -> None:
    model = build(wanted(modes=2, nodes=6, tolerance=1e-3))
    found = inverse(model)
    assert found.met
    assert found.solution.within_tolerance
    again = solve(model, found.values)
    assert_allclose(found.solution.error_estimate, again.error_estimate, rtol=1e-5, atol=0)
    assert "within the tolerance of 0.001" in printed(found)


def test_a_model_that_is_far_off_meets_no_target() -> None:
    model = build(wanted(modes=1, nodes=4, tolerance=1e-6))
    found = inverse(model)
    assert found.solution.converged
    assert found.solution.within_tolerance is False
    assert not found.met
    # Said once: by the sentence on the targets.
    assert found.solution.message.count("estimated error") == 1
    assert "above the tolerance of 1e-06" in printed(found)
    blind = inverse(model, estimate_error=False)
    assert blind.met
    assert blind.solution.error_estimate is None


def test_the_error_of_the_closest_pose_is_told() -> None:
    """Far outside of what the rod reaches, on a model that is not the rod either."""
    found = inverse(build(wanted((0.9, 0.0, 0.9), modes=1, nodes=4, tolerance=1e-6)), starts=0)
    assert not found.met
    assert "Not all targets are met" in found.solution.message
    assert "is above the tolerance of 1e-06; the scene fixes its modes" in found.solution.message


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> TargetTable:
    file = tmp_path_factory.mktemp("targets") / "targets.csv"
    file.write_text("\n".join(["x,y,z", *(",".join(map(str, row)) for row in (NEAR, FAR))]) + "\n")
    return read_targets(file, wanted(modes=2, nodes=6))


def summary(table: TargetTable, found: Sequence[Inverse]) -> str:
    out = StringIO()
    outcomes = [row_outcome(one, False) for one in found]
    print_inverse_table(Console(file=out, width=300), table, found, outcomes, Path("found.csv"))
    return out.getvalue()


def test_rows_of_a_table_carry_their_errors(table: TargetTable) -> None:
    found = inverse_rows(wanted(modes=2, nodes=6, tolerance=1e-6), table.rows)
    rows = list(csv.DictReader(StringIO(table_text(table, found, unstable=False))))
    for row, one in zip(rows, found, strict=True):
        assert float(row["error_estimate"]) == one.solution.error_estimate
        assert row["within_tolerance"] == str(one.solution.within_tolerance).lower()
    assert {row["within_tolerance"] for row in rows} == {"true", "false"}
    said = summary(table, found)
    assert "above the tolerance of 1e-06 (line 3), as in 1 row: the scene fixes its modes" in said


def test_rows_within_the_tolerance_say_so(table: TargetTable) -> None:
    found = inverse_rows(wanted(modes=2, nodes=6, tolerance=1e-2), table.rows)
    assert "within the tolerance of 0.01 (line" in summary(table, found)


def test_a_robot_with_disks_is_searched_on_few_modes_between_them() -> None:
    """Tensions that put its tip there, and where more modes see the tip under these tensions."""
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    tendon = {"kind": "tendon", "rod": "a", "tension": 1.0, "routing": "disks"}
    offsets = {"right": [0.05, 0.0], "front": [0.0, 0.05]}
    tables = {
        "schema": 1,
        "accuracy": {"tolerance": 1e-3},
        "rods": [{"name": "a", "length": 1.0, "strain": "kirchhoff", "stiffness": stiffness, "linear_density": 0.05}],
        "disks": [{"name": "disks", "rod": "a", "count": 5, "mass": 0.01, "radius": 0.06, "thickness": 0.01}],
        "actuators": [{**tendon, "name": name, "offset": offset} for name, offset in offsets.items()],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        "inputs": ["right.tension", "front.tension"],
    }
    fine = build(scene_from_dict({**tables, "accuracy": {"modes": 6, "nodes": 10}}))
    goal = solve(fine, [4.0, 2.0], raise_on_failure=True).tip("a").position
    target = {"kind": "position", "rod": "a", "position": goal.tolist()}
    result = inverse(scene_from_dict({**tables, "targets": [target]}))
    assert result.met, result.solution.message
    assert max(result.solution.model.discretisation["a"].modes) == 2
    seen = solve(fine, result.solution.inputs, raise_on_failure=True).tip("a").position
    assert np.linalg.norm(seen - goal) <= result.solution.error_estimate <= 1e-3
