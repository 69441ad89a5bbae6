"""Sweeps: results beside closed forms and the solver in Python, on cores, after kills, as files."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import CosseratError, SceneError, build, read_sweep, solve, sweep
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps import work
from cosserat_casadi.sweeps.choice import pose_difference
from cosserat_casadi.sweeps.outcome_file import record_file
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.row_model import solved_poses
from cosserat_casadi.sweeps.run import plan_sweep
from cosserat_casadi.sweeps.store import Store
from cosserat_casadi.sweeps.table import table_of
from tests.families import mostly_slow
from tests.scenes import WEIGHT, push, rod, scene
from tests.sweeps.conftest import PLANAR

pytestmark = pytest.mark.usefixtures("few_checked")

TENDON = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.0]}
CHAMBER = {"name": "gas", "kind": "chamber", "rod": "rod", "pressure": 500.0, "area": 1e-4, "offset": [0.0, 0.02]}


def arcs(moments: np.ndarray, length: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Tips of clamped rods bent to arcs by moments about y, shape (k, 2): x and z."""
    angle = moments * length / stiffness
    return np.column_stack([length * (1 - np.cos(angle)) / angle, length * np.sin(angle) / angle])


def bent(count: int, **columns: object) -> dict[str, object]:
    """Tip moments alone."""
    moments = np.random.default_rng(1).uniform(0.2, 2.0, count)
    return {"push.moment.y": moments, "push.force.x": 0.0, "push.force.z": 0.0, **columns}


@pytest.mark.slow
def test_moments_and_lengths_vs_arcs() -> None:
    lengths = np.random.default_rng(2).uniform(0.4, 1.2, 1100)
    table = bent(1100, **{"rod.length": lengths})
    found = sweep(PLANAR, table)
    assert found.converged.all()
    assert found.columns[:5] == ("push.moment.y", "push.force.x", "push.force.z", "rod.length", "iterations")
    expected = arcs(found["push.moment.y"], lengths, np.full(1100, 1.4))
    assert_allclose(found.positions()[:, [0, 2]], expected, rtol=0, atol=1e-9)
    assert_allclose(found["rod.y"], 0.0, rtol=0, atol=1e-12)
    half = found["push.moment.y"] * lengths / 1.4 / 2
    assert_allclose(np.abs(found["rod.qw"]), np.abs(np.cos(half)), rtol=0, atol=1e-9)
    assert found.holds
    assert found.record["checked"]


@pytest.mark.parametrize("compiled_from", mostly_slow([1, 1000], quick=[1]))
def test_stiffnesses_vs_arcs_compiled_and_in_python(compiled_from: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "cosserat_casadi.sweeps.run.chunks",
        lambda found: work.chunks(found, compiled_from),
    )
    stiffness = np.tile([1.0, 2.5], 10)
    found = sweep(PLANAR, bent(20, **{"rod.stiffness.bending_y": stiffness}), cores=2)
    assert found.converged.all()
    expected = arcs(found["push.moment.y"], np.full(20, 0.8), stiffness)
    assert_allclose(found.positions()[:, [0, 2]], expected, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_everything_of_an_assembly_vs_python() -> None:
    """Two rods and a body, a tendon and a chamber: every column beside the solver in Python."""
    arms = [
        rod("planar", name="left", base={"position": [0.1, 0.0, 0.0]}),
        rod("planar", name="right", base={"position": [-0.1, 0.0, 0.0]}),
    ]
    wrists = [
        {"body": "hand", "rod": "left", "kind": "fixed", "position": [0.1, 0.0, 0.0]},
        {"body": "hand", "rod": "right", "kind": "fixed", "position": [-0.1, 0.0, 0.0]},
    ]
    load = {"name": "load", "kind": "body_wrench", "body": "hand", "force": [0.2, 0.0, -0.3]}
    given = scene(
        load,
        rods=arms,
        bodies=[{"name": "hand", "mass": 0.1}],
        joints=wrists,
        actuators=[{**TENDON, "rod": "left"}, {**CHAMBER, "rod": "right", "offset": [0.02, 0.0]}],
        accuracy={"modes": 2, "nodes": 6, "tolerance": 1e-2},
    )
    table = {"load.force.x": [-0.3, 0.1, 0.4], "pull.tension": [0.0, 0.5, 1.0]}
    found = sweep(given, table)
    assert found.converged.all()
    assert "pull.tension" not in found.found
    for row in range(3):
        force = [table["load.force.x"][row], 0.0, -0.3]
        expected = solve(given, {"load.force": force, "pull.tension": table["pull.tension"][row]})
        for name in ("left", "right"):
            assert_allclose(found.positions(name)[row], expected.tip(name).position, rtol=0, atol=1e-9)
        assert_allclose(found.positions("hand")[row], expected.body("hand").position, rtol=0, atol=1e-9)
        quaternion = [found[f"hand.{axis}"][row] for axis in ("qw", "qx", "qy", "qz")]
        assert_allclose(quaternion, expected.body("hand").quaternion, rtol=0, atol=1e-9)
        assert_allclose(found["pull.length"][row], expected.actuator("pull")["length"], rtol=0, atol=1e-9)
        assert_allclose(found["gas.pressure"][row], 500.0, rtol=0, atol=1e-9)
        assert_allclose(found["gas.volume"][row], expected.actuator("gas")["volume"], rtol=0, atol=1e-12)


def test_what_a_row_gives_depends_on_no_other() -> None:
    table = {"push.force.x": np.random.default_rng(3).uniform(-3.0, 3.0, 1200)}
    found = sweep(PLANAR, table)
    order = np.random.default_rng(4).permutation(1200)
    other = sweep(PLANAR, {"push.force.x": table["push.force.x"][order]}, cores=1)
    assert_array_equal(other.values, found.values[order])


def test_rows_without_an_equilibrium_show_none(tmp_path: Path) -> None:
    """Moments far beyond what three modes resolve: their rows say how they ended, and show nothing like a pose."""
    file = tmp_path / "rows.csv"
    found = sweep(PLANAR, {"push.moment.y": [0.3, 100.0, 0.2, 400.0]}, file)
    failed = ~found.converged
    assert failed.tolist() == [False, True, False, True]
    assert found.outcome == ["converged", "unresolved", "converged", "load_stalled"]
    assert np.isnan(found.positions()[failed]).all()
    rows = list(csv.DictReader(file.read_text().splitlines()))
    for row, missing in zip(rows, failed, strict=True):
        assert (row["rod.x"] == "") is bool(missing)
        assert row["iterations"].isdigit()
    assert_array_equal(read_sweep(file).values, found.values)
    assert json.loads(record_file(file).read_text())["outcomes"] == found.counts
    record_file(file).unlink()
    assert_array_equal(read_sweep(file).values, found.values)
    assert not read_sweep(file).holds


def test_the_discretisation_is_chosen_for_all_rows() -> None:
    """Pushes up to where the rod turns by far; the rows drawn for this test took no part in the choice."""
    free = scene(push(force=[0.0, 0.0, 0.0]), rods=[rod("planar")], accuracy={"tolerance": 1e-4})
    table = {"push.force.x": np.linspace(-3.0, 3.0, 50)}
    found = sweep(free, table, samples=3)
    assert found.converged.all()
    assert found.holds
    chosen = found.record["chosen"]
    assert chosen["error_estimate"] <= 1e-4
    assert {0, 49} <= set(chosen["rows"])
    exact = scene(push(force=[0.0, 0.0, 0.0]), rods=[rod("planar")], accuracy={"tolerance": 1e-8})
    for row in (3, 17):
        expected = solve(exact, {"push.force": [table["push.force.x"][row], 0.0, 0.0]}).tip().position
        # The tolerance is relative to the length, 0.8 m.
        assert_allclose(found.positions()[row], expected, rtol=0, atol=1e-4 * 0.8)


@pytest.mark.slow
def test_a_check_that_finds_the_tolerance_missed_says_so() -> None:
    coarse = scene(push(), WEIGHT, accuracy={"modes": 2, "nodes": 6, "tolerance": 1e-9})
    found = sweep(coarse, {"push.force.x": [1.0, 1.5]})
    assert found.converged.all()
    assert not found.holds


# Kept, gone on with, written


MANY = {"push.force.x": np.random.default_rng(5).uniform(-3.0, 3.0, 3_000)}

TO_THE_END = "from cosserat_casadi.cli.main import main; main()"

UNTIL_ROWS_ARE_KEPT = """
import time
from cosserat_casadi.cli.main import main
from cosserat_casadi.sweeps.store import Store

add = Store.add

def add_and_wait(store, number, results):
    add(store, number, results)
    if number == 1:
        print("kept", flush=True)
        time.sleep(1000.0)

Store.add = add_and_wait
main()
"""
"""A sweep that waits for its end when the rows of its second piece of work are on the disk."""


def command(folder: Path, output: str, code: str) -> list[str]:
    words = ["sweep", "scene.toml", "--over", "rows.csv", "--output", output]
    (folder / "scene.toml").write_text(scene_text(PLANAR))
    rows = "\n".join(map(repr, MANY["push.force.x"].tolist()))
    (folder / "rows.csv").write_text(f"push.force.x\n{rows}\n")
    return [sys.executable, "-c", code, *words]


def stopped(folder: Path, how: signal.Signals) -> subprocess.CompletedProcess[str]:
    """A sweep stopped when some of its rows are kept and others are not."""
    waiting = command(folder, "a.csv", UNTIL_ROWS_ARE_KEPT)
    process = subprocess.Popen(waiting, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    while (line := process.stdout.readline()) != "kept\n":
        assert line, process.communicate()
    assert (folder / "a.csv.part").stat().st_size > 10_000
    process.send_signal(how)
    out, err = process.communicate(timeout=300)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def test_a_killed_sweep_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    assert stopped(tmp_path, signal.SIGKILL).returncode == -signal.SIGKILL
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.csv.part", "rows.csv", "scene.toml"]
    again = subprocess.run(
        command(tmp_path, "a.csv", TO_THE_END), cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert again.returncode == 0, again.stderr
    sweep(PLANAR, MANY, tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    names = ["a.csv", "a.csv.json", "b.csv", "b.csv.json", "rows.csv", "scene.toml"]
    assert sorted(file.name for file in tmp_path.iterdir()) == names


@pytest.mark.slow
def test_an_interrupt_says_that_the_sweep_can_go_on(tmp_path: Path) -> None:
    done = stopped(tmp_path, signal.SIGINT)
    assert done.returncode == 130
    assert "the same command goes on" in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.csv.part", "rows.csv", "scene.toml"]


def test_what_is_kept_is_not_solved_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output, table = tmp_path / "a.csv", {"push.force.x": MANY["push.force.x"][:1300]}

    def stop(store: Store, number: int, results: np.ndarray) -> None:
        add(store, number, results)
        if number == 1:
            raise KeyboardInterrupt

    add = Store.add
    monkeypatch.setattr(Store, "add", stop)
    with pytest.raises(KeyboardInterrupt):
        sweep(PLANAR, table, output, cores=1)
    again: list[int] = []
    monkeypatch.setattr(
        Store, "add", lambda store, number, results: (again.append(number), add(store, number, results))
    )
    found = sweep(PLANAR, table, output)
    assert again == [2]
    assert_array_equal(found.values, sweep(PLANAR, table).values)


def test_a_damaged_end_of_the_store_is_cut_off(tmp_path: Path) -> None:
    results = np.random.default_rng(6).standard_normal((3, 5, 4))
    file = tmp_path / "x.part"
    with Store(file) as store:
        store.start({"sweep": "x"})
        for number, rows in enumerate(results):
            store.add(number, rows)
    whole = file.read_bytes()
    damaged = bytearray(whole)
    damaged[-10] ^= 1
    for content in (whole[:-1], whole[:-170], bytes(damaged), whole[:-180] + b"\0" * 180):
        file.write_bytes(content)
        with Store(file) as store:
            assert store.head() == {"sweep": "x"}
            store.resume({0: 5, 1: 5, 2: 5}, 4)
            assert sorted(store.done) == [0, 1]
            # Entries that are added stand at the end, wherever the file was read before.
            assert [number for number, _ in store.results()] == [0, 1]
            store.add(2, results[2])
            for number, kept in store.results():
                assert_array_equal(kept, results[number])
        assert file.read_bytes() == whole


def test_entries_that_the_sweep_does_not_have_are_cut_off(tmp_path: Path) -> None:
    file = tmp_path / "x.part"
    with Store(file) as store:
        store.start({"sweep": "x"})
        store.add(0, np.ones((5, 4)))
        store.add(7, np.ones((5, 4)))
    for rows, expected in (({0: 5, 7: 5}, [0, 7]), ({0: 5}, [0]), ({0: 4, 7: 5}, []), ({0: 5, 7: 10**15}, [0])):
        copied = tmp_path / "copied.part"
        copied.write_bytes(file.read_bytes())
        with Store(copied) as store:
            store.resume(rows, 4)
            assert sorted(store.done) == expected


def test_an_unfinished_sweep_whose_first_line_was_changed_is_refused(tmp_path: Path) -> None:
    table, output = {"push.force.x": [0.1]}, tmp_path / "a.csv"
    part = tmp_path / "a.csv.part"
    identity = plan_sweep(PLANAR, table_of(table), output).identity
    choice = {"discretisation": {"modes": [3], "nodes": 6, "rotation": "magnus6"}, "rows": [0], "converged": 1}
    with Store(part) as store:
        store.start({"sweep": identity, "choice": {**choice, "error_estimate": None}})
    sound = part.read_text()
    assert plan_sweep(PLANAR, table_of(table), output).part == part
    for old, new in (
        ("[3]", '"a"'),
        ('"nodes": 6', '"nodes": -6'),
        ('"choice"', '"chosen"'),
        (": 1", ": " + "9" * 400),
    ):
        part.write_text(sound.replace(old, new, 1))
        assert "a.csv.part belongs to another sweep, which was not finished, or was changed" in refused(output, table)
    part.write_text("[" * 100_000)
    assert "was changed" in refused(output, table)


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of a POSIX system")
def test_a_pipe_in_the_place_of_the_store_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.csv.part")
    assert "a.csv.part belongs to another sweep" in refused(tmp_path / "a.csv")


def test_a_finished_sweep_is_read_and_left_alone(tmp_path: Path) -> None:
    output, table = tmp_path / "a.csv", {"push.force.x": [0.1, 0.2]}
    first = sweep(PLANAR, table, output)
    written = output.stat().st_mtime_ns
    with Store(tmp_path / "a.csv.part") as left:
        left.start({"sweep": first.record["sweep"]})
    second = sweep(PLANAR, table, output)
    assert not left.path.exists()
    assert output.stat().st_mtime_ns == written
    assert_array_equal(second.values, first.values)
    assert second.record == first.record
    assert second.holds == first.holds


def refused(output: Path, table: dict[str, list[float]] | None = None) -> str:
    before = sorted((file.name, file.read_bytes()) for file in output.parent.glob("*") if file.is_file())
    with pytest.raises(SceneError) as error:
        plan_sweep(PLANAR, table_of(table or {"push.force.x": [0.1]}), output)
    assert sorted((file.name, file.read_bytes()) for file in output.parent.glob("*") if file.is_file()) == before
    return str(error.value)


def test_files_that_are_not_ours_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("mine")
    assert "a.csv exists, and does not belong to this sweep" in refused(tmp_path / "a.csv")
    sweep(PLANAR, {"push.force.x": [0.3]}, tmp_path / "b.csv")
    assert "b.csv exists, and does not belong to this sweep" in refused(tmp_path / "b.csv")
    (tmp_path / "c.csv.part").write_text("mine")
    assert "c.csv.part belongs to another sweep" in refused(tmp_path / "c.csv")
    (tmp_path / "d.csv.json").write_text("{}")
    assert "d.csv.json exists" in refused(tmp_path / "d.csv")


def test_every_fault_is_told_before_anything_is_written(tmp_path: Path) -> None:
    said = refused(tmp_path / "none" / "a.txt", {"pull.x": [1.0], "outcome": [1.0]})
    for words in ("pull.x", "outcome", "folder"):
        assert words in said
    assert "neither CSV nor Parquet" in refused(tmp_path / "a.txt")


def test_parquet_holds_the_same(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    import pyarrow.parquet

    table = {"push.moment.y": [0.3, 100.0, 0.2]}
    found = sweep(PLANAR, table, tmp_path / "a.parquet")
    columns = pyarrow.parquet.read_table(tmp_path / "a.parquet").to_pydict()
    assert columns["outcome"] == found.outcome
    assert columns["rod.x"][1] is None
    assert columns["iterations"] == found["iterations"].astype(int).tolist()
    assert_array_equal(read_sweep(tmp_path / "a.parquet").values, found.values)
    sweep(PLANAR, table, tmp_path / "b.parquet")
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()


def test_what_lacks_an_extra_says_which(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("pyarrow", "distributed"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(CosseratError, match=r"cosserat-casadi\[sweep\]"):
        sweep(PLANAR, {"push.force.x": [0.1]}, tmp_path / "a.parquet")
    with pytest.raises(CosseratError, match=r"cosserat-casadi\[sweep\]"):
        sweep(PLANAR, {"push.force.x": [0.1]}, scheduler="tcp://127.0.0.1:1")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_no_process_outlives_a_killed_sweep(tmp_path: Path) -> None:
    """Rows in Python run in processes beside the sweep; they end with it."""
    code = (
        "from tests.sweeps.conftest import PLANAR; from cosserat_casadi import sweep; import numpy as np; "
        "sweep(PLANAR, {'rod.stiffness.bending_y': np.linspace(1, 2, 400)}, 'a.csv', cores=1)"
    )
    process = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path)
    patience = time.monotonic() + 300
    while not (found := children(process.pid)) or not (tmp_path / "a.csv.part").exists():
        assert process.poll() is None
        assert time.monotonic() < patience
        time.sleep(0.02)
    process.kill()
    process.wait()
    while any(Path(f"/proc/{child}").exists() for child in found):
        assert time.monotonic() < patience
        time.sleep(0.02)


def children(pid: int) -> list[int]:
    """Processes that a process started; needs /proc."""
    if not Path("/proc/self/task").exists():
        pytest.skip("there is no /proc")
    listed: list[int] = []
    for task in Path(f"/proc/{pid}/task").iterdir():
        listed += map(int, (task / "children").read_text().split())
    return listed


# The check of some rows: how far results lie from a solution, and what that says of the sweep.


FINE = {"row": 0, "error_estimate": 2e-5, "difference": 1e-12, "stable": True}


def test_difference_of_a_row_from_a_solution() -> None:
    """Distances count over the length, 0.8 m; a quaternion and its negative are one rotation."""
    solution = solve(build(PLANAR), raise_on_failure=True)
    row = solved_poses(solution)
    position, quaternion = slice(0, 3), slice(3, 7)
    moved = row.copy()
    moved[position] += [0.004, 0.0, 0.003]
    assert_allclose(pose_difference(moved, solution), 0.005 / 0.8, rtol=1e-12, atol=0)
    w, x, y, z = row[quaternion]
    turned = row.copy()
    # Turned on by 0.02 rad about the axis y of the section.
    c, s = np.cos(0.01), np.sin(0.01)
    turned[quaternion] = [c * w - s * y, c * x - s * z, c * y + s * w, c * z + s * x]
    assert_allclose(pose_difference(turned, solution), 0.02, rtol=1e-12, atol=0)
    turned[quaternion] *= -1
    assert_allclose(pose_difference(turned, solution), 0.02, rtol=1e-12, atol=0)
    assert pose_difference(row, solution) == 0.0


@pytest.mark.parametrize(
    ("chosen", "checked", "outcomes", "holds"),
    [
        (3e-5, [FINE], [0, 0], True),
        (None, [], [0, 3], True),
        (3e-5, [], [3, 3], False),
        (3e-3, [FINE], [0, 0], False),
        (3e-5, [FINE, FINE | {"error_estimate": 2e-3}], [0, 0], False),
        (3e-5, [FINE, FINE | {"difference": 2e-3}], [0, 0], False),
        (3e-5, [FINE, FINE | {"error_estimate": None, "difference": None}], [0, 0], False),
        (np.nan, [FINE], [0, 0], False),
    ],
)
def test_a_sweep_holds_where_nothing_that_was_looked_at_misses(
    chosen: float | None, checked: list[dict[str, Any]], outcomes: list[int], holds: bool
) -> None:
    record = {"tolerance": 1e-4, "chosen": {"error_estimate": chosen}, "checked": checked}
    assert Sweep(("a.b",), ("iterations",), np.zeros((2, 2)), np.array(outcomes), record).holds is holds
