"""Memory of a sweep: what is done lies on disc until all is, and then has its place once."""

from __future__ import annotations

import errno
import gc
import mmap
import pickle
import subprocess
import sys
import tempfile
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.files import WriteError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps import run
from cosserat_casadi.sweeps.outcome_file import write_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.run import Plan, plan_sweep, run_shard, run_sweep
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.store import Store, StoreChangedError
from cosserat_casadi.sweeps.table import read_table, table_of
from cosserat_casadi.sweeps.work import Shard
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.sweeps.conftest import PLANAR

ROWS = 40_000

FEW = 4_000


class Constant:
    """Answers every row at once, with numbers that are its input."""

    def __init__(self, width: int) -> None:
        self.width = width

    def solve(self, inputs: FloatArray) -> FloatArray:
        results = np.repeat(inputs[:, :1], self.width, axis=1)
        results[:, 0] = 0.0
        return results


def answers_at_once(replace: Any) -> None:
    """Replace what solves rows."""

    def tasks(of: Any, rest: Any) -> Iterator[tuple[Any, Any]]:
        for chunk in rest:
            yield chunk, [(Constant(len(of.plan.results)), of.plan.variants.given(chunk.rows))]

    replace(run._Run, "_tasks", tasks)
    replace(run, "check", lambda *_: [])


@pytest.fixture(autouse=True)
def rows_take_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    answers_at_once(monkeypatch.setattr)


@pytest.fixture
def peak(usual_garbage: None) -> Iterator[Any]:
    """The most bytes that Python had from a call on, beside those that it had before."""
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    yield lambda: tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    return plan_sweep(PLANAR, table_of({"push.force.x": np.linspace(-1.0, 1.0, ROWS)}), tmp_path / "rows.csv")


def test_results_have_their_place_once(plan: Plan, peak: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the table is in memory, as arrays that Python gives are."""
    # The file takes a block of rows at once, however many there are.
    monkeypatch.setattr(run, "write_sweep", lambda *_: None)
    found = run_sweep(plan, cores=1)
    # Beside the results themselves: outcomes, the verdicts on errors, and some chunks at once.
    assert peak() < 1.5 * found.values.nbytes
    assert_array_equal(found["rod.x"], found["push.force.x"])


def swept(rows: int, over: Path, output: Path) -> int:
    """A whole sweep from the file of its table to that of its results; how many rows converged."""
    table = read_table(over, scratch=Scratch.beside(output))
    found = run_sweep(plan_sweep(PLANAR, table, output), cores=1)
    assert found.missed_count == 0
    known, largest, row = found.worst
    assert (known, row) == (rows, int(np.argmax(table.values[:, 0])))
    assert_allclose(largest, 1e-4, rtol=1e-12, atol=0)
    return found.counts["converged"]


def grid_of_rows(rows: int, file: Path) -> Path:
    """A grid, which names its rows in two lines."""
    forces = f'"push.force.x" = {{ from = -1e-4, to = 1e-4, count = {rows // 100} }}\n'
    file.write_text(forces + '"push.force.z" = { from = -1.0, to = 1.0, count = 100 }\n')
    return file


def list_of_rows(rows: int, file: Path) -> Path:
    """A table with a line for each row."""
    with file.open("w") as stream:
        stream.write("push.force.x\n")
        stream.writelines(f"{force!r}\n" for force in np.linspace(-1e-4, 1e-4, rows).tolist())
    return file


@pytest.mark.parametrize(
    ("written", "suffix"),
    mostly_slow([(grid_of_rows, ".toml"), (list_of_rows, ".csv")], quick=[(grid_of_rows, ".toml")]),
)
def test_four_times_the_rows_take_no_more_memory(
    written: Any, suffix: str, peak: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """But for a few bytes of each row in the places of chunks: what it has on disc are some two hundred."""
    for module in ("scratch", "table", "outcome_file"):
        monkeypatch.setattr(f"cosserat_casadi.sweeps.{module}.BLOCK", 512)
    # What writing takes is looked at apart.
    monkeypatch.setattr(run, "write_sweep", lambda *_: None)
    # How many chunks wait to be taken is else a matter of how threads are scheduled: 50 kB each.
    monkeypatch.setattr("cosserat_casadi.sweeps.local.AHEAD", 1)
    peaks = []
    for rows in (FEW, 4 * FEW):
        over = written(rows, tmp_path / f"over-{rows}{suffix}")
        # What the sweep before has left in cycles is no memory of this one.
        gc.collect()
        tracemalloc.reset_peak()
        assert swept(rows, over, tmp_path / f"{rows}.csv") == rows
        peaks.append(peak())
    few, many = peaks
    assert many - few < 8 * 3 * FEW
    assert many < 1.1 * few
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize(("written", "suffix"), [(grid_of_rows, ".toml"), (list_of_rows, ".csv")])
def test_a_table_on_disc_is_that_in_memory(
    written: Any, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    over = written(700, tmp_path / f"over{suffix}")
    monkeypatch.setattr("cosserat_casadi.sweeps.scratch.BLOCK", 64)
    in_memory = read_table(over)
    on_disc = read_table(over, scratch=Scratch.beside(tmp_path / "rows.csv"))
    assert_array_equal(on_disc.values, in_memory.values)
    assert on_disc.where_of(650) == in_memory.where_of(650)
    plans = [plan_sweep(PLANAR, table) for table in (in_memory, on_disc, pickle.loads(pickle.dumps(on_disc)))]
    assert len({plan.identity for plan in plans}) == 1
    assert_array_equal(plans[1].variants.inputs, plans[0].variants.inputs)
    assert list(tmp_path.iterdir()) == [over]


RESIDENT = """
import resource, sys
from pathlib import Path
sys.path.insert(0, sys.argv[3])
from tests.sweeps.test_memory_of_rows import answers_at_once, grid_of_rows, swept
rows, folder = int(sys.argv[1]), Path(sys.argv[2])
answers_at_once(setattr)
swept(rows, grid_of_rows(rows, folder / "over.toml"), folder / "rows.csv")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(mmap, "MADV_DONTNEED"), reason="the system takes pages when memory is short")
def test_a_process_does_not_grow_with_its_rows(tmp_path: Path) -> None:
    """Pages of files on disc too: what is let go leaves the process."""
    sizes = []
    for rows in (2 * ROWS, 8 * ROWS):
        folder = tmp_path / str(rows)
        folder.mkdir()
        command = [sys.executable, "-c", RESIDENT, str(rows), str(folder), str(ROOT)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        sizes.append(1024 * int(done.stdout))
    few, many = sizes
    assert many < 1.05 * few


def test_a_full_disc_is_told_before_a_page_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any, **__: Any) -> Any:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    with pytest.raises(WriteError, match="No space left on device"):
        Scratch.beside(tmp_path / "rows.csv").array((10, 2))


def test_a_shard_keeps_no_results_in_memory(plan: Plan, peak: Any) -> None:
    rows = run_shard(plan, Shard(1, 2), cores=1)
    results = 8 * len(plan.results) * rows
    # The places of its chunks, and some chunks at once.
    assert peak() < 0.4 * results


@pytest.fixture
def answered() -> Sweep:
    numbers = np.linspace(0.0, 1.0, ROWS)
    values = np.column_stack([numbers, np.ones(ROWS), numbers])
    return Sweep(("push.force.x",), ("iterations", "rod.x"), values, np.zeros(ROWS, dtype=np.int64), {})


@pytest.mark.slow
def test_a_file_takes_a_block_of_rows_at_once(
    answered: Sweep, tmp_path: Path, peak: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.outcome_file.BLOCK", 64)
    write_sweep(answered, tmp_path / "rows.csv")
    # Nothing has a number for each row.
    assert peak() < 0.3 * answered.values.nbytes


def test_a_store_that_others_changed_is_told_of(tmp_path: Path) -> None:
    with Store(tmp_path / "rows.part") as store:
        store.start({"sweep": "x"})
        store.add(0, np.ones((5, 4)))
        store.add(1, np.ones((5, 4)))
        content = store.path.read_bytes()
        store.path.write_bytes(content[:-1])
        kept = store.results()
        assert next(kept)[0] == 0
        with pytest.raises(StoreChangedError, match=r"rows\.part was changed"):
            next(kept)
