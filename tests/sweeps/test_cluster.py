"""Sweeps on a real cluster of processes on this machine."""

from __future__ import annotations

import gc
import os
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError, sweep
from cosserat_casadi.sweeps.cluster import ClusterError, _connected
from cosserat_casadi.sweeps.store import Store
from tests.sweeps.conftest import PLANAR

distributed = pytest.importorskip("distributed")

pytestmark = [
    pytest.mark.usefixtures("few_checked"),
    # What dask leaves open when its processes are killed is not ours.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@contextmanager
def running(workers: int) -> Iterator[Any]:
    """A cluster of processes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # What thousands of tests have left behind takes the collector seconds, in which no thread of dask begins.
        gc.collect()
        gc.freeze()
        with distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as cluster:
            yield cluster
        gc.unfreeze()


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with running(1) as cluster:
        yield cluster


@pytest.mark.slow
def test_a_worker_is_killed_and_every_row_comes_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows of a compiled library, whose stiffness is a parameter; a worker dies while both work."""
    rng = np.random.default_rng(1)
    stiffness = np.concatenate([np.full(4000, 1.4), rng.uniform(1.0, 2.0, 32)])
    table = {"push.force.x": rng.uniform(-2.0, 2.0, 4032), "rod.stiffness.bending_y": stiffness}
    added: list[int] = []
    killed: list[int] = []

    def add(store: Store, number: int, results: np.ndarray) -> None:
        kept(store, number, results)
        added.append(number)
        if len(added) == 3:
            killed.append(next(iter(two.workers.values())).process.pid)
            os.kill(killed[0], signal.SIGKILL)

    kept = Store.add
    monkeypatch.setattr(Store, "add", add)
    with running(2) as two:
        sweep(PLANAR, table, tmp_path / "cluster.csv", scheduler=two.scheduler_address)
    assert killed
    assert sorted(added) == list(range(8))
    monkeypatch.undo()
    monkeypatch.setattr("cosserat_casadi.sweeps.choice.CHECKED", 2)
    sweep(PLANAR, table, tmp_path / "here.csv")
    assert (tmp_path / "cluster.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


def test_a_sweep_begun_here_ends_on_the_cluster(cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = {"push.force.x": np.linspace(-1.0, 1.0, 1500)}
    kept = Store.add

    def add(store: Store, number: int, results: np.ndarray) -> None:
        kept(store, number, results)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Store, "add", add)
        sweep(PLANAR, table, tmp_path / "a.csv")
    assert (tmp_path / "a.csv.part").exists()
    found = sweep(PLANAR, table, tmp_path / "a.csv", scheduler=cluster.scheduler_address)
    assert_array_equal(found.values, sweep(PLANAR, table).values)


def test_schedulers_that_do_not_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.cluster.PATIENCE", 1)
    for address in ("tcp://127.0.0.1:9", "nowhere"):
        with pytest.raises(SceneError, match="no scheduler answers"):
            sweep(PLANAR, {"push.force.x": [0.1]}, scheduler=address)


def test_other_versions_are_refused(cluster: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.cluster.version", lambda name: "0.0.1")
    with pytest.raises(ClusterError, match=r"differ from 0\.0\.1 here"):
        sweep(PLANAR, {"push.force.x": [0.1]}, scheduler=cluster.scheduler_address)


def test_a_thread_of_dask_that_begins_late() -> None:
    """It gives its own thread ten seconds; after three tries the machine is called too busy."""
    made: list[str] = []

    def late(address: str, **options: Any) -> str:
        made.append(address)
        assert len(made) > 2
        return "client"

    assert _connected(late, "tcp://here") == "client"
    made.clear()

    def never(address: str, **options: Any) -> str:
        made.append(address)
        raise AssertionError

    with pytest.raises(ClusterError, match="too busy"):
        _connected(never, "tcp://here")
    assert len(made) == 3


@pytest.mark.slow
def test_lost_clients_are_collected_before_another_is_made() -> None:
    """Dask's clients take a lock where they are collected, which the making of a client holds."""

    class Lost:
        def __init__(self) -> None:
            self.itself = self

        def __del__(self) -> None:
            collected.append(True)

    def make(address: str, **options: Any) -> str:
        assert collected
        return "client"

    collected: list[bool] = []
    gc.disable()
    try:
        Lost()
        assert not collected
        assert _connected(make, "tcp://here") == "client"
    finally:
        gc.enable()


@pytest.mark.slow
def test_a_scheduler_without_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.cluster.PATIENCE", 2)
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as empty,
        pytest.raises(ClusterError, match="no workers"),
    ):
        sweep(PLANAR, {"push.force.x": [0.1]}, scheduler=empty.scheduler_address)
