"""Results of a sweep as a dataset: a folder of Parquet files that readers take as one table."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError, read_sweep, sweep
from cosserat_casadi.errors import WriteError
from cosserat_casadi.files import atomic_folder
from cosserat_casadi.sweeps.outcome_file import write_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.run import plan_sweep
from cosserat_casadi.sweeps.table import table_of
from tests.sweeps.conftest import PLANAR

pytestmark = pytest.mark.usefixtures("few_checked")

TABLE = {"push.force.x": [0.1, 0.2]}


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of five rows, in groups of two."""
    pytest.importorskip("pyarrow")
    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file.ROW_GROUP", 2)
    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file.PART_ROWS", 5)


def rows(count: int) -> Sweep:
    """Rows of which some have no result."""
    values = np.column_stack([np.arange(count) + 0.5, np.arange(count) % 7, np.linspace(0.0, 1.0, count)])
    outcomes = np.arange(count) % 3
    values[outcomes > 0, 2] = np.nan
    return Sweep(("push.force.x",), ("iterations", "rod.x"), values, outcomes, {"sweep": "0"})


def test_the_parts_hold_what_the_single_file_holds(tmp_path: Path) -> None:
    import pyarrow.parquet

    # More than ten parts, the last one shorter.
    found = rows(57)
    write_sweep(found, tmp_path / "rows.dataset")
    write_sweep(found, tmp_path / "rows.parquet")
    parts = sorted((tmp_path / "rows.dataset").iterdir())
    assert [part.name for part in parts] == [f"part-{number:05}.parquet" for number in range(12)]
    assert [pyarrow.parquet.ParquetFile(part).metadata.num_rows for part in parts] == [5] * 11 + [2]
    whole = pyarrow.parquet.read_table(tmp_path / "rows.parquet")
    assert pyarrow.parquet.read_table(tmp_path / "rows.dataset").equals(whole)
    read = read_sweep(tmp_path / "rows.dataset")
    assert_array_equal(read.values, found.values)
    assert_array_equal(read.outcomes, found.outcomes)
    assert read.record == found.record


def test_a_dataset_is_finished_once_and_left_alone(tmp_path: Path) -> None:
    output = tmp_path / "rows.dataset"
    found = sweep(PLANAR, TABLE, output)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["rows.dataset", "rows.dataset.json"]
    (part,) = output.iterdir()
    written = part.stat().st_mtime_ns
    plan = plan_sweep(PLANAR, table_of(TABLE), output)
    assert plan.finished
    assert_array_equal(sweep(PLANAR, TABLE, output).values, found.values)
    assert part.stat().st_mtime_ns == written
    with pytest.raises(SceneError, match=r"rows\.dataset exists, and does not belong to this sweep"):
        plan_sweep(PLANAR, table_of({"push.force.x": [0.3]}), output)


def test_folders_that_are_not_ours_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.dataset").mkdir()
    with pytest.raises(SceneError, match=r"mine\.dataset exists, and does not belong to this sweep"):
        plan_sweep(PLANAR, table_of(TABLE), tmp_path / "mine.dataset")
    (tmp_path / "mine.parquet").mkdir()
    with pytest.raises(SceneError, match=r"mine\.parquet is a folder"):
        plan_sweep(PLANAR, table_of(TABLE), tmp_path / "mine.parquet")


def test_a_dataset_that_cannot_be_written_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file._write_parquet", full)
    with pytest.raises(WriteError, match="No space left"):
        write_sweep(rows(12), tmp_path / "rows.dataset")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_goes_to_where_a_link_leads_and_over_nothing(tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "far")
    for _ in range(2):
        with atomic_folder(link) as folder:
            (folder / "a").write_text("first")
        assert (tmp_path / "far" / "a").read_text() == "first"
        assert link.is_symlink()
        with pytest.raises(WriteError), atomic_folder(link) as folder:
            (folder / "b").write_text("second")
        assert [path.name for path in (tmp_path / "far").iterdir()] == ["a"]
        (tmp_path / "far" / "a").unlink()


def test_numbers_are_read_as_arrays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers of Python would take several times as much memory as the results."""
    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file.ROW_GROUP", 65_536)
    found = rows(20_000)
    file = tmp_path / "rows.parquet"
    write_sweep(found, file)
    tracemalloc.start()
    read = read_sweep(file)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert_array_equal(read.values, found.values)
    # Beside them the outcomes, and one column at a time.
    assert peak < 2.0 * found.values.nbytes


def test_parquet_files_of_others_are_refused(tmp_path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    file = tmp_path / "rows.parquet"
    for outcomes, numbers, said in (
        (["converged", "lost"], [0.0, 1.0], "an outcome is not one that a row can have"),
        (["converged", None], [0.0, 1.0], "an outcome is not one that a row can have"),
        (["converged", "converged"], ["a", "b"], "rows.parquet: cannot be read as the results of a sweep"),
        (["converged", "converged"], [[1.0], [2.0]], "rows.parquet: cannot be read as the results of a sweep"),
    ):
        pyarrow.parquet.write_table(pyarrow.table({"outcome": outcomes, "iterations": numbers}), file)
        with pytest.raises(SceneError, match=said):
            read_sweep(file)
    pyarrow.parquet.write_table(pyarrow.table({"iterations": [1.0]}), file)
    with pytest.raises(SceneError, match="cannot be read as the results of a sweep"):
        read_sweep(file)
