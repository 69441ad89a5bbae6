"""Sweeps cut into shards: each does its part, goes on after a kill, and all together are the sweep to the last byte."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError, read_sweep, sweep
from cosserat_casadi.cli.exit_codes import REFUSED
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps.choice import Choice
from cosserat_casadi.sweeps.run import Plan, merge_shards, plan_sweep, run_shard
from cosserat_casadi.sweeps.store import StoreChangedError
from cosserat_casadi.sweeps.table import table_of
from cosserat_casadi.sweeps.work import Shard
from tests.commands import cosserat
from tests.sweeps.conftest import PLANAR

pytestmark = pytest.mark.usefixtures("few_checked")

FORCES = np.linspace(-0.5, 0.5, 40)
COLUMNS = {"push.force.x": FORCES}


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.work.COMPILED_ROWS", 8)


def plan_of(output: Path) -> Plan:
    """Rows in five chunks."""
    return plan_sweep(PLANAR, table_of(COLUMNS), output)


def test_shards_make_the_sweep(tmp_path: Path) -> None:
    whole = tmp_path / "whole.csv"
    sweep(PLANAR, COLUMNS, whole, cores=1)
    output = tmp_path / "rows.csv"
    plan = plan_of(output)
    # In any order, and one of them again: it has nothing left to do.
    rows = [run_shard(plan, Shard(number, 3), cores=1) for number in (2, 3, 1, 2)]
    assert rows == [16, 8, 16, 16]
    assert not output.exists()
    merged = merge_shards(plan)
    assert output.read_bytes() == whole.read_bytes()
    assert merged.converged.all()
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "rows.csv",
        "rows.csv.json",
        "whole.csv",
        "whole.csv.json",
    ]
    # A merge that is asked for again reads what is there.
    assert np.array_equal(merge_shards(plan).values, merged.values)


@pytest.mark.slow
def test_more_shards_than_chunks(tmp_path: Path) -> None:
    plan = plan_of(tmp_path / "rows.csv")
    for number in range(1, 6):
        run_shard(plan, Shard(number, 7), cores=1)
    # The last two would have no row: nobody has to run them.
    assert merge_shards(plan).converged.all()


def test_shards_that_a_killed_merge_left_are_removed(tmp_path: Path) -> None:
    plan = plan_of(tmp_path / "rows.csv")
    file = Shard(1, 1).file(tmp_path / "rows.csv")
    run_shard(plan, Shard(1, 1), cores=1)
    content = file.read_bytes()
    merged = merge_shards(plan)
    file.write_bytes(content)
    foreign = Shard(1, 2).file(tmp_path / "rows.csv")
    foreign.write_text("of nobody")
    assert_array_equal(merge_shards(plan).values, merged.values)
    assert not file.exists()
    assert foreign.exists()


def test_shards_that_are_no_whole_sweep_are_refused(tmp_path: Path) -> None:
    output = tmp_path / "rows.csv"
    plan = plan_of(output)
    with pytest.raises(SceneError, match="there is no shard beside"):
        merge_shards(plan)
    run_shard(plan, Shard(1, 3), cores=1)
    with pytest.raises(SceneError, match="missing: 2/3, 3/3"):
        merge_shards(plan)
    other = plan_sweep(PLANAR, table_of({"push.force.x": FORCES[:3]}), output)
    with pytest.raises(SceneError, match="belongs to another sweep"):
        run_shard(other, Shard(1, 3), cores=1)
    with pytest.raises(SceneError, match="from another sweep, or damaged: 1/3"):
        merge_shards(other)
    for number in (2, 3):
        run_shard(plan, Shard(number, 3), cores=1)
    file = Shard(2, 3).file(output)
    content = file.read_bytes()
    file.write_bytes(content[:-50])
    with pytest.raises(SceneError, match="not finished: 2/3"):
        merge_shards(plan)
    # The shard goes on behind what is sound.
    run_shard(plan, Shard(2, 3), cores=1)
    assert file.read_bytes() == content
    run_shard(plan, Shard(1, 2), cores=1)
    with pytest.raises(SceneError, match="was cut into 2 and 3 shards"):
        merge_shards(plan)


def test_a_shard_that_changes_while_it_is_merged_is_told_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rows that it lost would have whatever numbers the memory held."""
    output = tmp_path / "rows.csv"
    plan = plan_of(output)
    for number in (1, 2):
        run_shard(plan, Shard(number, 2), cores=1)
    file = Shard(2, 2).file(output)
    choice_of = Choice.read

    def read(plain: dict[str, Any]) -> Choice:
        """Read when all shards have been looked at, and none has been read."""
        file.write_bytes(file.read_bytes()[:-50])
        return choice_of(plain)

    monkeypatch.setattr(Choice, "read", read)
    with pytest.raises(StoreChangedError, match="was changed while the sweep ran"):
        merge_shards(plan)
    assert not output.exists()


@pytest.mark.parametrize("word", ["0/4", "5/4", "3", "a/b", "1/0", "-1/4", "1/1000000"])
def test_words_that_are_no_shard(word: str) -> None:
    with pytest.raises(SceneError, match="is no shard"):
        Shard.read(word)
    assert Shard.read("03/064") == Shard(3, 64)


def test_command(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(scene_text(PLANAR))
    (tmp_path / "rows.csv").write_text("push.force.x\n0.1\n0.2\n")
    words = ["sweep", "scene.toml", "--over", "rows.csv", "--output", "found.csv"]
    refused = cosserat(*words, "--shard", "1/2", "--merge", "--plot", "a.png", cwd=tmp_path)
    assert refused.returncode == REFUSED
    assert "needs all shards together" in refused.stderr
    assert "shows all rows" in refused.stderr
    first = cosserat(*words, "--shard", "1/2", "--cores", "1", cwd=tmp_path)
    assert first.returncode == 0
    assert "Shard 1/2: 2 rows kept in found.csv.shard-1-of-2" in " ".join(first.stdout.split())
    assert cosserat(*words, "--merge", cwd=tmp_path).returncode == 0
    assert read_sweep(tmp_path / "found.csv").converged.all()
    # A job of an array that is started once more sees that all is done.
    again = cosserat(*words, "--shard", "1/2", cwd=tmp_path)
    assert again.returncode == 0
    assert "found.csv already holds this sweep: nothing was computed" in " ".join(again.stdout.split())
    assert not list(tmp_path.glob("*.shard-*"))


ARRAY = """\
for SLURM_ARRAY_TASK_ID in 1 2 3; do
    cosserat sweep scene.toml --over rows.csv --output found.csv --shard $SLURM_ARRAY_TASK_ID/3 --cores 1 &
done
wait
cosserat sweep scene.toml --over rows.csv --output found.csv --merge
"""


@pytest.mark.slow
def test_shards_side_by_side_as_an_array_of_jobs(tmp_path: Path) -> None:
    """Three processes that begin together, each choosing its discretisation for itself."""
    free = PLANAR.model_copy(
        update={"accuracy": PLANAR.accuracy.model_copy(update={"modes": None, "nodes": None, "tolerance": 1e-2})}
    )
    (tmp_path / "scene.toml").write_text(scene_text(free))
    forces = np.linspace(-0.5, 0.5, 1200)
    lines = [repr(force) for force in forces.tolist()]
    (tmp_path / "rows.csv").write_text("\n".join(["push.force.x", *lines]) + "\n")
    program = f"{sys.executable} -c 'from cosserat_casadi.cli.main import main; main()' "
    script = ARRAY.replace("cosserat ", program)
    subprocess.run(["sh", "-ec", script], cwd=tmp_path, check=True, timeout=300)
    found = read_sweep(tmp_path / "found.csv")
    assert found.converged.all()
    assert np.array_equal(found["push.force.x"], forces)
