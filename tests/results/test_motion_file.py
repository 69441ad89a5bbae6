"""The files of a motion: every format says the same, and each is whole."""

from __future__ import annotations

import builtins
import csv
import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import SceneError
from cosserat_casadi.motion.trajectory import Energies, Motion, MotionOutcome
from cosserat_casadi.results.motion_file import FORMATS, check_motion_path, motion_columns
from cosserat_casadi.sweeps.outcome_file import ParquetUnavailableError
from tests.motions import START, motion_of, swinging_rod, two_rods_on_a_platform, with_energies, without_start
from tests.scenes import WIND, push, scene

ENERGIES = [field.name for field in fields(Energies)]


@pytest.fixture(scope="module")
def platform() -> Motion:
    return two_rods_on_a_platform(frames=5)


def written(motion: Motion, folder: Path, suffix: str) -> Path:
    path = folder / f"motion{suffix}"
    motion.write(path)
    return path


def test_json_has_the_keys_of_the_contract(platform: Motion, tmp_path: Path) -> None:
    data = json.loads(written(platform, tmp_path, ".json").read_text(encoding="utf-8"))
    assert data["schema"] == 1
    assert data["title"] == "Two rods, one platform"
    assert data["converged"] is True
    assert data["outcome"] == "completed"
    assert data["message"] == MotionOutcome.COMPLETED.value
    assert data["error_estimate"] == 3e-5
    assert data["steps"] == data["statistics"]["steps"] == 57
    assert data["start"] == START
    assert data["warnings"] == []
    assert data["times"] == platform.times.tolist()
    assert set(data["rods"]) == {"left", "right"}
    assert set(data["rods"]["left"]) == {"tip", "X", "position"}
    assert set(data["bodies"]["platform"]) == {"position", "quaternion"}
    assert set(data["actuators"]["cable"]) == {"tension", "length"}
    assert list(data["energy"]) == ENERGIES
    assert data["energy"]["imbalance"] == platform.energy.imbalance.tolist()
    assert set(data["discretisation"]) == {"left", "right"}


def test_json_arrays_vs_motion(platform: Motion) -> None:
    data = platform.to_dict()
    right = data["rods"]["right"]
    assert np.shape(right["position"]) == (5, 41, 3)
    assert np.shape(right["tip"]["quaternion"]) == (5, 4)
    assert_array_equal(right["tip"]["position"], platform.tip("right").position)
    assert_allclose(np.array(right["position"])[:, -1], platform.tip("right").position, rtol=0, atol=1e-13)
    assert_array_equal(data["bodies"]["platform"]["quaternion"], platform.body("platform").quaternion)
    assert_array_equal(data["inputs"]["cable.tension"], platform.actuator("cable").effort)
    assert_allclose(data["inputs"]["crown.force"][-1], [0.8, 0.9, -0.5], rtol=1e-14, atol=0)


def test_legendre_coefficients_of_an_input_are_rows(tmp_path: Path) -> None:
    windy = motion_of(scene(push(), WIND), {"wind.force": [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]}, frames=3)
    wind = np.array(windy.to_dict()["inputs"]["wind.force"])
    assert wind.shape == (3, 2, 3)
    assert_allclose(wind[-1], [[0.1, 0.3, 0.5], [0.2, 0.4, 0.6]], rtol=1e-14, atol=0)
    assert_array_equal(motion_columns(windy)["wind.force.x.1"], wind[:, 1, 0])
    with np.load(written(windy, tmp_path, ".npz")) as arrays:
        assert_array_equal(arrays["inputs.wind.force"], wind)


def test_scenes_of_rods_alone_have_no_other_tables() -> None:
    data = swinging_rod(frames=2).to_dict()
    assert "bodies" not in data
    assert "actuators" not in data


def test_csv_vs_arrays(platform: Motion, tmp_path: Path) -> None:
    with written(platform, tmp_path, ".csv").open(encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    assert header == list(motion_columns(platform))
    assert len(rows) == len(platform.times)
    table = dict(zip(header, np.array(rows, dtype=float).T, strict=True))
    # Numbers read back to the last digit.
    assert_array_equal(table["t"], platform.times)
    assert_array_equal(table["crown.force.y"], np.array(platform.to_dict()["inputs"]["crown.force"])[:, 1])
    assert_array_equal(table["left.tip.z"], platform.tip("left").position[:, 2])
    assert_array_equal(table["left.tip.qw"], platform.tip("left").quaternion[:, 0])
    middle = platform.section("right", [0.5]).position
    assert_array_equal(table["right.X=0.5.x"], middle[:, 0, 0])
    assert_array_equal(table["platform.y"], platform.body("platform").position[:, 1])
    assert_array_equal(table["cable.length"], platform.actuator("cable").conjugate)
    assert header.count("cable.tension") == 1
    assert_array_equal(table["energy.work"], platform.energy.work)


def test_parquet_vs_csv_columns(platform: Motion, tmp_path: Path) -> None:
    table = pyarrow.parquet.read_table(written(platform, tmp_path, ".parquet"))
    columns = motion_columns(platform)
    assert table.column_names == list(columns)
    for name, values in columns.items():
        assert_array_equal(table[name].to_numpy(), values)
    head = json.loads(table.schema.metadata[b"cosserat"])
    assert head["converged"] is True
    assert head["error_estimate"] == 3e-5


def test_npz_vs_json(platform: Motion, tmp_path: Path) -> None:
    data = platform.to_dict()
    with np.load(written(platform, tmp_path, ".npz")) as arrays:
        assert_array_equal(arrays["times"], data["times"])
        assert_array_equal(arrays["rods.left.position"], data["rods"]["left"]["position"])
        assert_array_equal(arrays["rods.left.tip.quaternion"], data["rods"]["left"]["tip"]["quaternion"])
        assert_array_equal(arrays["bodies.platform.position"], data["bodies"]["platform"]["position"])
        assert_array_equal(arrays["actuators.cable.length"], data["actuators"]["cable"]["length"])
        assert_array_equal(arrays["energy.dissipated"], data["energy"]["dissipated"])
        assert arrays["outcome"] == "completed"
        assert arrays["converged"]
        # None of them is an object that only pickle could read.
        assert all(arrays[name].dtype != object for name in arrays.files)


def test_what_is_not_finite_is_missing_in_every_format(tmp_path: Path) -> None:
    motion = swinging_rod(frames=3, error_estimate=float("nan"), outcome=MotionOutcome.INTERRUPTED)
    lost = np.array([0.0, np.inf, np.nan])
    motion = with_energies(motion, imbalance=lost)
    data = json.loads(written(motion, tmp_path, ".json").read_text(encoding="utf-8"))
    assert data["converged"] is False
    assert data["error_estimate"] is None
    assert data["energy"]["imbalance"] == [0.0, None, None]
    last_cells = [line.split(",")[-1] for line in written(motion, tmp_path, ".csv").read_text().splitlines()]
    assert last_cells == ["energy.imbalance", "0.0", "", ""]
    column = pyarrow.parquet.read_table(written(motion, tmp_path, ".parquet"))["energy.imbalance"]
    assert column.to_pylist() == [0.0, None, None]


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_motion_without_rows_is_written(tmp_path: Path, suffix: str) -> None:
    path = written(without_start(), tmp_path, suffix)
    assert path.stat().st_size > 0
    if suffix == ".json":
        assert json.loads(path.read_text(encoding="utf-8"))["times"] == []
    if suffix == ".csv":
        assert len(path.read_text().splitlines()) == 1


@pytest.mark.parametrize("suffix", FORMATS)
def test_files_are_the_same_every_time_and_alone(tmp_path: Path, suffix: str) -> None:
    motion = swinging_rod(frames=3)
    first = tmp_path / f"a{suffix}"
    second = tmp_path / f"b{suffix.upper()}"
    motion.write(first)
    motion.write(second)
    assert first.read_bytes() == second.read_bytes()
    assert sorted(tmp_path.iterdir()) == [first, second]


def test_unknown_suffix_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"path: .*use one of \.json, \.csv, \.parquet, \.npz"):
        swinging_rod(frames=2).write(tmp_path / "motion.mat")
    assert list(tmp_path.iterdir()) == []


def test_parquet_without_pyarrow_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **options: Any) -> Any:
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return real(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    check_motion_path("motion.npz")
    with pytest.raises(ParquetUnavailableError, match=r"or write \.csv"):
        check_motion_path("motion.parquet")
