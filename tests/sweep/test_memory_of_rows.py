"""Memory of a sweep: what is done lies on disc until all is, and then has its place once."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweep import run
from cosserat_casadi.sweep.outcome_file import write_sweep
from cosserat_casadi.sweep.outcome_table import Sweep
from cosserat_casadi.sweep.run import Plan, plan_sweep, run_shard, run_sweep
from cosserat_casadi.sweep.shards import Shard
from cosserat_casadi.sweep.store import Store, StoreChangedError
from cosserat_casadi.sweep.table import table_of
from tests.sweep.conftest import PLANAR

ROWS = 40_000


class Constant:
    """Answers every row at once, with numbers that are its input."""

    def __init__(self, width: int) -> None:
        self.width = width

    def solve(self, inputs: FloatArray) -> FloatArray:
        results = np.repeat(inputs[:, :1], self.width, axis=1)
        results[:, 0] = 0.0
        return results


@pytest.fixture(autouse=True)
def rows_take_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    def tasks(plan: Plan, choice: Any, rest: Any, progress: Any) -> Iterator[tuple[Any, Any]]:
        for chunk in rest:
            yield chunk, [(Constant(len(plan.results)), plan.variants.given(chunk.rows))]

    monkeypatch.setattr(run, "_tasks", tasks)
    monkeypatch.setattr(run, "check", lambda *_: [])


@pytest.fixture
def peak() -> Iterator[Any]:
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
    # The file takes a block of rows at once, however many there are.
    monkeypatch.setattr(run, "write_sweep", lambda *_: None)
    found = run_sweep(plan, cores=1)
    # Beside the results themselves: outcomes, the verdicts on errors, and some chunks at once.
    assert peak() < 1.5 * found.values.nbytes
    assert_array_equal(found["rod.x"], found["push.force.x"])


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


def test_a_file_takes_a_block_of_rows_at_once(
    answered: Sweep, tmp_path: Path, peak: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cosserat_casadi.sweep.outcome_file.BLOCK", 64)
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
