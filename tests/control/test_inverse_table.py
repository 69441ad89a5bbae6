"""Tables of targets: each row as alone, from its nearest neighbour, on models that are built once."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from cosserat_casadi import Scene, SceneError, build, inverse, solve
from cosserat_casadi.cli.main import app
from cosserat_casadi.control import inverse_accuracy
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.control.target_table import read_targets
from cosserat_casadi.scene import scene_from_dict
from cosserat_casadi.scene.writing import scene_tables, scene_text
from tests.scenes import push, scene

POSITION = {"kind": "position", "rod": "rod", "position": [0.0, 0.0, 0.8]}
POSE = {"kind": "pose", "rod": "rod", "position": [0.0, 0.0, 0.8], "quaternion": [1, 0, 0, 0]}
STRAINS = ["bending_x", "bending_y", "torsion", "extension"]
"""Without extension a nearly straight rod would tell little of the force along it."""

FORCES = ([0.3, 0.0, 0.0], [0.6, 0.1, 0.0], [0.9, 0.2, -0.1], [1.2, 0.3, 0.2])


BOUNDS = [{"input": "push.force", "lower": -1.5, "upper": 1.5}]


def wanted(target: dict[str, Any] = POSITION, **changes: Any) -> Scene:
    """A rod whose tip force is to be found, on modes that are fixed and do for a coarse tolerance."""
    accuracy = {"modes": 4, "nodes": 9, "tolerance": 1e-3}
    plain = {"inputs": ["push.force"], "targets": [target], "accuracy": accuracy}
    return scene(push(force=[0.0, 0.0, 0.0]), strain=STRAINS, **{**plain, **changes})


def tips(given: Scene) -> list[list[float]]:
    """Position and quaternion of the tip under each force."""
    model = build(given)
    rows = []
    for force in FORCES:
        tip = solve(model, {"push.force": force}).tip()
        rows.append([*tip.position.tolist(), *tip.quaternion.tolist()])
    return rows


def write(path: Path, rows: list[list[float]], header: str) -> Path:
    lines = [header, *(",".join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    "accuracy",
    [pytest.param({"tolerance": 1e-5}, marks=pytest.mark.slow), {"modes": 4, "nodes": 9, "tolerance": 1e-3}],
)
def test_forces_are_recovered_for_every_row(tmp_path: Path, accuracy: dict[str, Any]) -> None:
    given = wanted(accuracy=accuracy)
    rows = [row[:3] for row in tips(given)]
    table = read_targets(write(tmp_path / "table.csv", rows, "x,y,z"), given)
    found = inverse_rows(given, table.rows)
    for force, row in zip(FORCES, found, strict=True):
        assert row.met
        assert_allclose(row.values["push.force"][:, 0], force, rtol=0, atol=2e-5)
        assert (row.solution.error_estimate or 1.0) <= accuracy["tolerance"]


@pytest.mark.slow
def test_a_row_is_found_as_alone(tmp_path: Path) -> None:
    given = wanted()
    rows = [row[:3] for row in tips(given)]
    together = inverse_rows(given, read_targets(write(tmp_path / "table.csv", rows, "x,y,z"), given).rows)
    alone = inverse(scene_from_dict({**scene_tables(given), "targets": [{**POSITION, "position": rows[2]}]}))
    assert_allclose(together[2].values["push.force"], alone.values["push.force"], rtol=1e-7, atol=1e-9)
    assert_allclose(alone.values["push.force"][:, 0], FORCES[2], rtol=0, atol=2e-5)


@pytest.mark.slow
def test_poses_with_orientations(tmp_path: Path) -> None:
    """Force and moment from position and quaternion; its sign does not matter."""
    given = wanted(POSE, inputs=["push.force", "push.moment"])
    model = build(given)
    truth = {"push.force": [0.4, 0.2, 0.0], "push.moment": [0.05, -0.1, 0.08]}
    tip = solve(model, truth).tip()
    rows = [[*tip.position.tolist(), *(sign * tip.quaternion).tolist()] for sign in (1, -1)]
    table = read_targets(write(tmp_path / "table.csv", rows, "x,y,z,qw,qx,qy,qz"), given)
    for row in inverse_rows(given, table.rows):
        assert row.met
        assert row.gaps[0].angle is not None
        for name, value in truth.items():
            assert_allclose(row.values[name][:, 0], value, rtol=0, atol=5e-5)


@pytest.mark.slow
def test_models_and_optimisers_are_built_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = wanted()
    rows = [row[:3] for row in tips(given)]
    built = []
    nlpsol = ca.nlpsol

    def counted(*arguments: Any) -> Any:
        built.append(arguments[0])
        return nlpsol(*arguments)

    monkeypatch.setattr(ca, "nlpsol", counted)
    counts = []
    for count in (1, 4):
        built.clear()
        table = read_targets(write(tmp_path / "table.csv", rows[:count], "x,y,z"), given)
        assert all(row.met for row in inverse_rows(given, table.rows))
        counts.append(len(built))
    assert counts[1] == counts[0]


@pytest.mark.slow
def test_rows_start_from_their_nearest_neighbour(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In whatever order they are given: along the line that the tips make."""
    given = wanted()
    order = [2, 0, 3, 1]
    rows = [tips(given)[i][:3] for i in order]
    seen: list[tuple[Any, Any]] = []

    def recording(search: Any) -> Any:
        def recorded(problem: Any, start: Any, *others: Any) -> Any:
            seen.append((problem.targets[0].position, start.tip().position))
            return search(problem, start, *others)

        return recorded

    for name in ("search", "search_near"):
        monkeypatch.setattr(inverse_accuracy, name, recording(getattr(inverse_accuracy, name)))
    inverse_rows(given, read_targets(write(tmp_path / "table.csv", rows, "x,y,z"), given).rows)
    searched = [rows.index(list(position)) for position, _ in seen[:4]]
    assert [order[row] for row in searched] == [0, 1, 2, 3]
    for (_, start), (before, _) in zip(seen[1:4], seen[:3], strict=True):
        assert_allclose(start, before, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_a_row_out_of_reach_leaves_the_others_alone(tmp_path: Path) -> None:
    given = wanted(bounds=BOUNDS)
    rows = [row[:3] for row in tips(given)]
    rows.insert(1, [0.0, 0.0, -0.2])
    found = inverse_rows(given, read_targets(write(tmp_path / "table.csv", rows, "x,y,z"), given).rows)
    assert [row.met for row in found] == [True, False, True, True, True]


@pytest.mark.parametrize(
    ("target", "text", "expected"),
    [
        (POSITION, "x,y\n1,2\n", "has no column z"),
        (POSITION, "x,y,z,u\n1,2,3,4\n", "has an unknown column u"),
        (POSITION, "x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n", "has orientations, but the target leaves orientations free"),
        (POSE, "x,y,z,qw,qx,qy\n1,2,3,1,0,0\n", "has no column qz"),
        (
            POSE,
            "x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n1,2,3,2,0,0,0\n",
            "line 3: the quaternion must have norm 1, got norm 2",
        ),
        (POSITION, "x,y,z\n1,2,a\n", "line 2"),
        (POSITION, "x,y,z\n", "holds no row of numbers"),
    ],
)
def test_refused_tables(tmp_path: Path, target: dict[str, Any], text: str, expected: str) -> None:
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises(SceneError, match=expected):
        read_targets(tmp_path / "table.csv", wanted(target))


@pytest.mark.parametrize(
    ("targets", "expected"),
    [
        ([], "holds 0 targets"),
        ([POSITION, POSE], "holds 2 targets"),
        ([{"kind": "curve", "rod": "rod", "at": [1.0], "points": [[0, 0, 0]]}], "is of kind curve"),
    ],
)
def test_a_table_is_of_one_section_or_body(tmp_path: Path, targets: list[Any], expected: str) -> None:
    write(tmp_path / "table.csv", [[0.0, 0.0, 0.8]], "x,y,z")
    with pytest.raises(SceneError, match=expected):
        read_targets(tmp_path / "table.csv", wanted(targets=targets))


def run(folder: Path, *options: str) -> Any:
    return CliRunner().invoke(app, ["inverse", str(folder / "scene.toml"), *options])


def test_command_writes_a_row_for_each_target(tmp_path: Path) -> None:
    given = wanted()
    (tmp_path / "scene.toml").write_text(scene_text(given))
    rows = [row[:3] for row in tips(given)[:2]]
    output = tmp_path / "found.csv"
    table = write(tmp_path / "table.csv", rows, "x,y,z")
    done = run(tmp_path, "--table", str(table), "--output", str(output))
    assert done.exit_code == 0, done.output
    with output.open() as file:
        read = list(csv.DictReader(file))
    assert [row["outcome"] for row in read] == ["met", "met"]
    assert_allclose([float(row["push.force.x"]) for row in read], [0.3, 0.6], rtol=0, atol=2e-5)
    assert_allclose([float(row["x"]) for row in read], [row[0] for row in rows], rtol=0, atol=0)
    assert all(row["angle_gap"] == "" for row in read)


@pytest.mark.slow
def test_command_names_rows_that_fail(tmp_path: Path) -> None:
    given = wanted(bounds=BOUNDS)
    (tmp_path / "scene.toml").write_text(scene_text(given))
    rows = [tips(given)[0][:3], [0.0, 0.0, -0.2]]
    output = tmp_path / "found.csv"
    table = write(tmp_path / "table.csv", rows, "x,y,z")
    done = run(tmp_path, "--table", str(table), "--output", str(output))
    assert done.exit_code == 3
    assert "1 of 2 rows" in done.output
    assert "line 3: missed" in done.output
    with output.open() as file:
        assert [row["outcome"] for row in csv.DictReader(file)] == ["met", "missed"]


def test_command_needs_a_file_for_what_is_found(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(scene_text(wanted()))
    table = write(tmp_path / "table.csv", [[0.0, 0.0, 0.8]], "x,y,z")
    done = run(tmp_path, "--table", str(table), "--plot", str(tmp_path / "figure.png"))
    assert done.exit_code != 0
    assert isinstance(done.exception, SceneError)
    assert len(done.exception.problems) == 2


def test_distance_of_rows_counts_orientations() -> None:
    here = np.array([[0.0, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0]])
    turned = [np.cos(0.1), np.sin(0.1), 0.0, 0.0]
    rows = np.array([here, [[0.0, 0.3, 0.4, 1.0, 0.0, 0.0, 0.0]], [[0.0, 0.0, 0.8, *turned]]])
    found = inverse_accuracy._distances(rows, here, np.array([0.8]))
    assert_allclose(found, [0.0, 0.5 / 0.8, 0.2], rtol=1e-12, atol=0)


@pytest.mark.slow
def test_rounds_of_all_discretisations_are_told() -> None:
    """On a finer one Newton's method has next to nothing left to do: the optimiser worked before."""
    found = inverse(wanted({**POSITION, "position": [0.2, 0.05, 0.95]}, accuracy={"tolerance": 1e-10}))
    assert found.met
    assert max(found.solution.model.discretisation["rod"].modes) > 6
    assert found.rounds > 0
