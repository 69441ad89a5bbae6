"""Tables of a sweep: grids, random samples, CSV files, what their columns are, what is refused."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import SceneError, read_sweep
from cosserat_casadi.sweeps.grid_file import grid
from cosserat_casadi.sweeps.outcome_file import write_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.sampling import representative_rows
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.table import crossed, range_table, read_table, table_of
from cosserat_casadi.sweeps.variants import Variants, variants_of
from tests.scenes import push, rod, scene
from tests.sweeps.conftest import PLANAR


def grid_of(text: str) -> tuple[tuple[str, ...], np.ndarray]:
    return grid(tomllib.loads(text), "grid.toml")


def refusals(text: str) -> str:
    with pytest.raises(SceneError) as refused:
        grid_of(text)
    return str(refused.value)


def test_every_combination_the_last_column_fastest() -> None:
    columns, rows = grid_of('"a.b" = { from = -1, to = 1, count = 3 }\nc.d = [5, 7]\ne = 2')
    assert columns == ("a.b", "c.d", "e")
    assert_allclose(rows, [[-1, 5, 2], [-1, 7, 2], [0, 5, 2], [0, 7, 2], [1, 5, 2], [1, 7, 2]], rtol=0, atol=1e-15)


def test_draws_stand_beside_every_combination() -> None:
    text = "samples = 4000\nseed = {}\na.u = {{ uniform = [2, 4] }}\nb.c = [1, 2]\nd.n = {{ normal = [10, 0.5] }}"
    columns, rows = grid_of(text.format(3))
    assert columns == ("a.u", "b.c", "d.n")
    assert rows.shape == (8000, 3)
    assert_allclose(rows[0::2, [0, 2]], rows[1::2, [0, 2]], rtol=0, atol=0)
    assert_allclose(rows[:, 1], np.tile([1.0, 2.0], 4000), rtol=0, atol=0)
    drawn = rows[0::2]
    assert drawn[:, 0].min() >= 2
    assert drawn[:, 0].max() <= 4
    # Four deviations of the mean of 4000 draws; the variance of a uniform one is a twelfth of its range squared.
    assert_allclose(drawn[:, 0].mean(), 3.0, rtol=0, atol=4 * 2 / np.sqrt(12 * 4000))
    assert_allclose(drawn[:, 2].mean(), 10.0, rtol=0, atol=4 * 0.5 / np.sqrt(4000))
    assert_allclose(drawn[:, 2].std(), 0.5, rtol=0.05, atol=0)
    assert abs(np.corrcoef(drawn[:, 0], drawn[:, 2])[0, 1]) < 0.07
    assert_allclose(grid_of(text.format(3))[1], rows, rtol=0, atol=0)
    assert not np.allclose(grid_of(text.format(4))[1], rows)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "names no column"),
        ("a.b = []", "empty list"),
        ("a.b = 'x'", "finite number, got 'x'"),
        ("a.b = [1, nan]", "finite number"),
        ("a.b = true", "finite number"),
        ("a.b = { from = 1, to = 2 }", "lacks count"),
        ("a.b = { from = 1, to = 2, count = 3, step = 1 }", "does not know step"),
        ("a.b = { from = 1, to = 2, count = 0 }", "count must be a whole number >= 1"),
        ("a.b = { from = 1, to = 2, count = 1 }", "one value between two ends"),
        ("a.b = { from = 1, to = 2, count = 900_000_000 }", "at most 20,000,000"),
        ("a.b = { from = 1, to = 2, count = 9000 }\nc.d = { from = 1, to = 2, count = 9000 }", "81,000,000 rows"),
        ("samples = 2\nseed = 1\na.b = { uniform = [2, 1] }", "no range"),
        ("samples = 2\nseed = 1\na.b = { normal = [2, 0] }", "no range"),
        ("samples = 2\nseed = 1\na.b = { normal = 2 }", "a list of mean and deviation"),
        ("samples = 2\nseed = 1\na.b = { normal = [1, 2], from = 1 }", "mixes from, normal"),
        ("a.b = { uniform = [1, 2] }", "samples: is missing"),
        ("samples = 2\na.b = { uniform = [1, 2] }", "seed: is missing"),
        ("samples = 2\nseed = 1\na.b = [1]", "samples: stands without random columns"),
        ("samples = 0\nseed = 1\na.b = { uniform = [1, 2] }", "samples must be a whole number >= 1"),
        ('a.b = 1\n"a.b" = 2', "twice"),
        ("samples = 2\nseed = {}\na.b = { uniform = [1, 2] }", "seed must be a whole number >= 0, got a table"),
        ("samples.x = 2\nseed = 1\na.b = { uniform = [1, 2] }", "samples must be a whole number >= 1, got a table"),
        (f"a.b = 1{400 * '0'}", "finite number"),
        ("a.b = { from = -1.7e308, to = 1.7e308, count = 3 }", "beyond the largest number"),
        ("samples = 2\nseed = 1\na.b = { uniform = [-1.7e308, 1.7e308] }", "beyond the largest number"),
        ("samples = 2\nseed = 1\na.b = { normal = [0, 1.7e308] }", "beyond the largest number"),
    ],
)
def test_faults_of_a_grid(text: str, said: str) -> None:
    assert said in refusals(text)


def test_every_fault_of_a_grid_is_told_at_once() -> None:
    said = refusals("samples = -1\na.b = []\nc.d = { from = 1 }\ne.f = 'x'")
    for words in ("samples", "grid.toml, a.b", "grid.toml, c.d", "grid.toml, e.f"):
        assert words in said


def test_ranges_are_a_grid() -> None:
    table = range_table(["a.b=-1:1:3", "c.d=5:7:2"])
    assert table.columns == ("a.b", "c.d")
    assert_allclose(table.values, [[-1, 5], [-1, 7], [0, 5], [0, 7], [1, 5], [1, 7]], rtol=0, atol=1e-15)


@pytest.mark.parametrize("on_disc", [False, True])
def test_ranges_stand_beside_every_row_of_a_file(tmp_path: Path, on_disc: bool) -> None:
    file = tmp_path / "rows.csv"
    file.write_text("e.f,g.h\n1,2\n\n3,4\n")
    rows = read_table(file, scratch=Scratch(tmp_path if on_disc else None))
    table = crossed(rows, range_table(["a.b=0:1:2"]))
    assert table.columns == ("e.f", "g.h", "a.b")
    assert_allclose(table.values, [[1, 2, 0], [1, 2, 1], [3, 4, 0], [3, 4, 1]], rtol=0, atol=0)
    # A refusal names the line of the file that the row comes from.
    assert [table.where_of(row) for row in range(4)] == [f"{file}, line {line}" for line in (2, 2, 4, 4)]


def test_every_fault_of_a_csv_is_named(tmp_path: Path) -> None:
    path = tmp_path / "loads.csv"
    path.write_text("push.force.x,push.force.x,pull.force.x\n1,2,3\n1,2\nnan,x,1\n")
    with pytest.raises(SceneError) as refused:
        read_table(path)
    said = str(refused.value)
    for words in ("push.force.x twice", "line 3", "2 values", "'nan'", "'x'"):
        assert words in said


@pytest.mark.parametrize("text", ["", "push.force.x\n"])
def test_a_csv_without_rows_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "loads.csv"
    path.write_text(text)
    with pytest.raises(SceneError, match="holds no row of numbers"):
        read_table(path)


def test_files_that_are_none(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text("a = [")
    (tmp_path / "long.toml").write_text(f"a = 1{5000 * '0'}")
    for name in ("none.toml", "none.csv"):
        with pytest.raises(SceneError, match="cannot be read"):
            read_table(tmp_path / name)
    for name in ("bad.toml", "long.toml"):
        with pytest.raises(SceneError, match="is not TOML"):
            read_table(tmp_path / name)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_columns_that_other_signs_separate(tmp_path: Path, separator: str) -> None:
    """Spreadsheets of some countries write semicolons, and commas in numbers."""
    file = tmp_path / "rows.csv"
    file.write_text(separator.join(["push.force.x", "push.force.z"]) + "\n" + separator.join(["0,1", "0,2"]) + "\n")
    with pytest.raises(SceneError, match="separate columns by commas"):
        read_table(file)


def test_faults_of_a_csv_name_line_and_column(tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    file.write_text("push.force.x,push.force.z\n1,2\n\nnan,x\n1\n")
    with pytest.raises(SceneError) as refused:
        read_table(file)
    said = str(refused.value)
    for words in ("line 4: push.force.x", "line 4: push.force.z", "line 5: has 1 values for 2 columns"):
        assert words in said
    file.write_text("push.force.x\n" + "x\n" * 100)
    with pytest.raises(SceneError, match="has 80 more faults"):
        read_table(file)


def test_arrays_that_are_no_table() -> None:
    for columns, said in (
        ({}, "holds no row"),
        ({"a": []}, "holds no row"),
        ({"a": [1, 2], "b": [1, 2, 3]}, "2, 3 rows .* numpy.meshgrid"),
        ({"a": [[1]]}, "2 dimensions"),
        ({"a": [np.inf]}, "not a finite number"),
        ({"a": ["x"]}, "a: must be a number"),
        ({"a": [1, [2, 3]]}, "a: must be a number"),
    ):
        with pytest.raises(SceneError, match=said):
            table_of(columns)
    assert_allclose(table_of({"a": 1, "b": [1, 2]}).values, [[1, 1], [1, 2]], rtol=0, atol=0)


# Columns


def seen(**columns: object) -> Variants:
    return variants_of(PLANAR, table_of({name.replace("__", "."): value for name, value in columns.items()}))  # type: ignore[misc]


def test_what_may_be_an_input_is_one_and_nothing_else() -> None:
    found = seen(rod__length=[0.5, 0.6], push__force__x=[1.0, 2.0], rod__stiffness__bending_y=[2.0, 2.0])
    assert found.layout.names == ("rod.length", "push.force")
    assert found.parameters == ("rod.stiffness.bending_y",)
    assert_allclose(found.inputs, [[0.5, 1.0, 0.0, -0.4], [0.6, 2.0, 0.0, -0.4]], rtol=0, atol=0)
    (entry,) = found.entries
    assert entry.scene.rods[0].stiffness is not None
    assert entry.scene.rods[0].stiffness.bending_y == 2.0


def test_rows_of_equal_parameters_share_a_scene() -> None:
    found = seen(rod__stiffness__bending_y=[3.0, 2.0, 3.0, 1.0, 2.0])
    assert [entry.rows.tolist() for entry in found.entries] == [[0, 2], [1, 4], [3]]
    assert [entry.scene.rods[0].stiffness.bending_y for entry in found.entries] == [3.0, 2.0, 1.0]  # type: ignore[union-attr]
    assert found.scene_of_row(4) is found.entries[1].scene


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"pull.force.x": [1.0]}, "named 'pull'"),
        ({"push.forc.x": [1.0]}, "push.forc"),
        ({"push.force.w": [1.0]}, "no 'w' to set"),
        ({"rod.length": [1.0, -1.0]}, "table, row 2, rod.length: must be > 0"),
        ({"rod.stiffness.bending_y": [1.0, 0.0]}, "table, row 2, rod.stiffness.bending_y"),
        ({"accuracy.modes": [3]}, "'accuracy.modes' cannot be swept"),
        ({"title": [3]}, "'title' cannot be swept"),
    ],
)
def test_columns_that_are_refused(columns: dict[str, list[float]], said: str) -> None:
    with pytest.raises(SceneError) as refused:
        variants_of(PLANAR, table_of(columns))
    assert said in str(refused.value)


@pytest.mark.parametrize(
    "columns",
    [
        ("push.force.x", "push.force[1]"),
        ("push.force.x", "loads[0].force[0]"),
        ("rod.length", "rods.rod.length"),
        ("rod.base.quaternion.w", "rod.base.tangent[0]"),
        ("rod.stiffness.bending_y", "rods[0].stiffness.bending_y"),
    ],
)
def test_two_names_of_one_thing_are_refused(columns: tuple[str, str]) -> None:
    with pytest.raises(SceneError, match=r"sets what '.*' sets"):
        variants_of(PLANAR, table_of({name: [0.1, 0.2] for name in columns}))


def test_entries_of_one_vector_may_be_parameters() -> None:
    found = variants_of(PLANAR, table_of({"push.force[0]": [0.1, 0.2], "push.force[1]": [0.3, 0.3]}))
    assert [entry.scene.loads[0].force for entry in found.entries] == [(0.1, 0.3, -0.4), (0.2, 0.3, -0.4)]  # type: ignore[union-attr]


def test_a_joint_between_sections_of_rods_is_named_by_its_columns() -> None:
    """The file does not list the body that such a joint holds, which has the joint's name."""
    rods = [rod("kirchhoff", name=name, base={"position": [x, 0, 0]}) for name, x in (("a", 0.0), ("b", 0.1))]
    ends = [{"rod": "a", "at": 0.5}, {"rod": "b", "at": 1.0}]
    elbow = {"name": "elbow", "kind": "revolute", "axis": [0, 1, 0], "stiffness": 1.0, "between": ends}
    found = variants_of(scene(rods=rods, joints=[elbow]), table_of({"elbow.stiffness": [1.0, 2.0]}))
    assert [entry.scene.joints[0].stiffness for entry in found.entries] == [1.0, 2.0]  # type: ignore[union-attr]


def test_joints_that_hold_too_little_are_refused_with_their_row() -> None:
    """A plate on three spherical joints: in the second row they lie on one line."""
    rods = [
        rod("kirchhoff", name=name, base={"position": [x, 0, 0]}) for name, x in (("a", 0.0), ("b", 0.1), ("c", 0.2))
    ]
    joints = [
        {"body": "plate", "rod": name, "kind": "spherical", "position": [x, y, 0]}
        for name, x, y in (("a", 0.0, 0.0), ("b", 0.1, 0.0), ("c", 0.2, 0.1))
    ]
    given = scene(rods=rods, bodies=[{"name": "plate"}], joints=joints)
    with pytest.raises(SceneError, match=r"table, row 2, bodies\[0\]: nothing holds the orientation of 'plate'"):
        variants_of(given, table_of({"joints[2].position[1]": [0.1, 0.0]}))
    joints[2]["position"] = [0.2, 0.0, 0.0]
    with pytest.raises(SceneError, match=r"^bodies\[0\]: nothing holds the orientation of 'plate'"):
        variants_of(scene(rods=rods, bodies=[{"name": "plate"}], joints=joints), table_of({"a.length": [0.8]}))


def test_a_tension_below_zero_is_refused() -> None:
    tendon = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.0]}
    given = scene(push(), rods=[rod()], actuators=[tendon])
    with pytest.raises(SceneError, match=r"table, row 2, pull\.tension: must be >= 0"):
        variants_of(given, table_of({"pull.tension": [0.0, -1e-3, 2.0]}))


def test_corners_are_among_the_rows_that_stand_for_all() -> None:
    _, rows = grid_of("a = { from = 0, to = 1, count = 9 }\nb = { from = -5, to = 5, count = 11 }\nc = 4")
    chosen = representative_rows(rows, 12)
    assert len(chosen) == 12
    corners = {(x, y) for x in (0.0, 1.0) for y in (-5.0, 5.0)}
    assert corners <= {(float(rows[i, 0]), float(rows[i, 1])) for i in chosen}
    assert representative_rows(rows, 12) == chosen
    assert representative_rows(rows[:1], 12) == [0]
    assert representative_rows(rows, 1) != []


def test_parquet_is_written_group_by_group(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of all columns would take as much memory again as the results."""
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file.ROW_GROUP", 4)
    values = np.column_stack([np.arange(10.0), np.arange(10.0) + 1, np.linspace(0.0, 1.0, 10)])
    values[7, 2] = np.nan
    found = Sweep(("push.force.x",), ("iterations", "rod.x"), values, np.zeros(10, dtype=np.int64), {"sweep": "0"})
    write_sweep(found, tmp_path / "rows.parquet")
    assert parquet.ParquetFile(tmp_path / "rows.parquet").num_row_groups == 3
    assert_array_equal(read_sweep(tmp_path / "rows.parquet").values, values)
