"""A whole bench of a planar rod: table, files, resumption, interruption, refusals."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console
from work_precision import session
from work_precision.figure import FIGURES
from work_precision.grid import Candidate
from work_precision.measurement import Measurement
from work_precision.plan import make_plan, run_plan
from work_precision.record import CSV, JSON

from cosserat_casadi import Scene, SceneError
from cosserat_casadi.cli.effect_times import effect_times, motion_costs, print_effects, print_motion_times
from cosserat_casadi.codegen.timed_program import Times
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.model.build import build
from cosserat_casadi.model.operation_cost import is_damped, price, without_damping
from cosserat_casadi.model.operations import count
from tests.fine_reference import NoReferenceError
from tests.moving_scenes import model_of
from tests.scenes import push, rod, scene


def planar() -> Scene:
    return scene(push(force=[0.9, 0.0, -0.4]), rods=[rod("planar")], title="A planar rod")


def quiet(*_: object) -> None:
    """No report."""


POINTS = [
    Candidate("magnus4", 2, 3),
    Candidate("dial", tolerance=1e-4),
    Candidate("magnus4", 7, 10),
]


def bench(folder: Path | None) -> tuple[str, list[Measurement]]:
    plan = make_plan(planar(), folder, "magnus4,dial", 2, quick=False)
    plan.candidates = list(POINTS)
    console = Console(record=True, width=200, file=io.StringIO())
    assert run_plan(plan, console, quiet) is False
    return console.export_text(), plan.rows


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, str, list[Measurement]]]:
    folder = tmp_path_factory.mktemp("bench") / "out"
    yield folder, *bench(folder)


@pytest.mark.slow
def test_every_point_is_measured(measured: tuple[Path, str, list[Measurement]]) -> None:
    _, _, rows = measured
    assert [row.name for row in rows] == [point.name for point in POINTS]
    for row in rows:
        assert row.note == ""
        assert row.in_plane
        assert row.igm_us > 0
        # Times are those of a machine that may be busy: that they are there is all that holds.
        assert min(row.jacobian_us, row.cold_us, row.vm_igm_us, row.vm_cold_us) > 0
        assert row.igm_operations < row.jacobian_operations
    coarse, dial, fine = rows
    assert fine.pose_error < 1e-6 < 1e-5 < coarse.pose_error
    assert dial.pose_error < 1e-4


def test_table_marks_the_front_and_names_the_reference(measured: tuple[Path, str, list[Measurement]]) -> None:
    _, text, rows = measured
    for row in rows:
        (line,) = [line for line in text.splitlines() if f" {row.name} " in line]
        assert str(row.unknowns) in line.split()
    assert "● " in text
    assert "against a far finer discretisation" in text
    assert "A planar rod" in text


def test_files_hold_the_same_rows(measured: tuple[Path, str, list[Measurement]]) -> None:
    folder, _, rows = measured
    assert {path.name for path in folder.iterdir()} == {CSV, JSON, *FIGURES}
    content = json.loads((folder / JSON).read_text())
    assert [row["name"] for row in content["rows"]] == [row.name for row in rows]
    assert content["reference"]["method"].startswith("a far finer discretisation")
    assert set(content["front"]) <= {row.name for row in rows}
    assert str(folder) not in (folder / JSON).read_text()
    assert (folder / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "figure.pdf").read_bytes().startswith(b"%PDF")


def test_what_is_measured_is_not_measured_again(measured: tuple[Path, str, list[Measurement]]) -> None:
    folder, _, rows = measured
    plan = make_plan(planar(), folder, "dial", None, quick=False)
    assert [row.name for row in plan.rows] == [row.name for row in rows]
    assert [candidate.name for candidate in plan.candidates][:3] == ["dial 0.01", "dial 0.001", "dial 1e-05"]


def test_an_interrupted_bench_keeps_its_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(self: session.Session, candidates: list[Candidate]) -> Iterator[Measurement]:
        yield Measurement(name=candidates[0].name, method=candidates[0].method)
        raise KeyboardInterrupt

    monkeypatch.setattr(session.Session, "measure", interrupted)
    plan = make_plan(planar(), tmp_path / "out", "magnus4", 3, quick=False)
    console = Console(record=True, width=200, quiet=True)
    assert run_plan(plan, console, quiet) is True
    assert [path.name for path in (tmp_path / "out").iterdir()] == [CSV]
    again = make_plan(planar(), tmp_path / "out", "magnus4", 3, quick=False)
    assert [row.name for row in again.rows] == [plan.candidates[0].name]
    assert again.candidates == plan.candidates[1:]


def test_csv_of_another_scene_is_refused_and_left_alone(measured: tuple[Path, str, list[Measurement]]) -> None:
    folder = measured[0]
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(SceneError, match="another scene"):
        make_plan(scene(push()), folder, None, None, quick=True)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_missing_compiler_is_refused_with_the_other_faults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(SceneError) as refused:
        make_plan(planar(), None, "euler", None, quick=False)
    assert len(refused.value.problems) == 2


@pytest.mark.slow
def test_scene_without_equilibrium_has_no_reference(tmp_path: Path) -> None:
    held = {"rod": "rod", "kind": "clamped", "position": [0.8, 0.0, 0.0], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    lost = scene(rods=[rod("planar")], supports=[held])
    plan = make_plan(lost, tmp_path / "out", "magnus4", 1, quick=False)
    with pytest.raises(NoReferenceError):
        run_plan(plan, Console(quiet=True), quiet)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_point_that_is_not_compiled_says_why() -> None:
    opened = session.Session.open(planar(), "/bin/false")
    (row,) = opened.measure([Candidate("magnus4", 3, 5)])
    assert "the compiler fails" in row.note
    assert not row.in_plane
    assert row.pose_error < 1e-2
    (large,) = opened.measure([Candidate("permuted", 3, 9)])
    assert large.note == "not compiled: literal system of 9 intervals"
    assert replace(large, note="").pose_error < 1e-2


@pytest.mark.slow
def test_effects_are_priced_in_time() -> None:
    """The whole scene and the scene without each load, compiled and run."""
    wanted = planar()
    whole, parts = effect_times(wanted, find_compiler())
    assert isinstance(whole, Times)
    assert list(parts) == [load.name for load in wanted.loads]
    for times in parts.values():
        assert isinstance(times, Times)
        assert times.igm > 0.0


def test_the_rod_is_named_whose_igm_is_timed() -> None:
    """Of several rods the first is timed alone: its name stands beside the figure."""
    times = Times(cold=9.0, warm=3.0, igm=1.0, jacobian=4.0)
    headings = []
    for rods in (["left"], ["left", "right"]):
        console = Console(file=io.StringIO(), width=160)
        print_effects(console, rods, times, {"push": replace(times, igm=0.5)})
        headings.append(console.file.getvalue())
    assert "IGM, µs" in headings[0]
    assert "IGM of left alone, µs" in headings[1]


@pytest.mark.slow
def test_a_motion_is_priced_beside_statics() -> None:
    """Inertia and damping cost something, and derivatives more; the table has the operations that the model counts."""
    model = model_of("planar")
    (cost,) = motion_costs(model)
    counts, times = zip(*cost.values(), strict=True)
    residual, jacobian, inverse_dynamics, dynamics_jacobian = (operations.number for operations in counts)
    assert residual < inverse_dynamics < dynamics_jacobian
    assert jacobian < dynamics_jacobian
    assert (counts[0], counts[1]) == (price(model).residual, price(model).jacobian)
    assert min(times) > 0.0
    console = Console(file=io.StringIO(), width=160)
    print_motion_times(console, model.size, cost)
    printed = console.file.getvalue()
    assert "not compiled" in printed
    assert "of which damping" not in printed
    assert all(str(operations) in printed for operations in counts)


@pytest.mark.slow
def test_damping_has_rows_of_its_own() -> None:
    """They are what the equations of a rod with damping have over those of the same rod without any."""
    damped = rod("planar", damping={"retardation_time": 0.01}, linear_density=0.5)
    elastic = rod("planar", linear_density=0.5)
    model, bare = (build(scene(push(), rods=[tables]), moving=True) for tables in (damped, elastic))
    whole, undamped = motion_costs(model, bare)
    console = Console(file=io.StringIO(), width=160)
    print_motion_times(console, model.size, whole, undamped)
    rows = [line.split("│") for line in console.file.getvalue().splitlines() if "of which damping" in line]
    shown = [int(row[2].replace(",", "")) for row in rows]
    residual = (whole["inverse_dynamics"][0] - undamped["inverse_dynamics"][0]).number
    jacobian = (whole["dynamics_jacobian"][0] - undamped["dynamics_jacobian"][0]).number
    assert shown == [residual, jacobian]
    assert residual > 0
    assert jacobian > 0


def damped_scene() -> Scene:
    """Rods and contact that are damped, and a parameter of damping."""
    tables = rod("planar", damping={"retardation_time": 0.01}, linear_density=0.5)
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -9], "normal": [0, 0, 1], "width": 0.1, "damping": 2.0}
    names = ["rod.damping.retardation_time", "rod.length"]
    return scene(push(), rods=[tables], obstacles=[floor], parameters=names)


def test_what_is_left_without_damping() -> None:
    """Neither rods nor contact are damped, and no parameter is of damping; all else is as it was."""
    damped = damped_scene()
    bare = without_damping(damped)
    assert is_damped(damped)
    assert not is_damped(bare)
    assert bare.parameters == ("rod.length",)
    for without in ({"rods": bare.rods}, {"obstacles": bare.obstacles}):
        assert is_damped(damped.model_copy(update={**without, "parameters": bare.parameters}))


@pytest.mark.slow
def test_each_kind_of_damping_has_its_price() -> None:
    damped = damped_scene()
    bare = without_damping(damped)
    still = count(build(bare, moving=True).inverse_dynamics).number
    moving = count(build(damped, moving=True).inverse_dynamics).number
    assert still < moving
    for without in ({"rods": bare.rods}, {"obstacles": bare.obstacles}):
        half = damped.model_copy(update={**without, "parameters": bare.parameters})
        assert count(build(half, moving=True).inverse_dynamics).number > still
