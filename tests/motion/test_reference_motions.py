"""Motions of the reference cases: by chains of rigid slices, in other coordinates, integrated by other methods."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosserat_casadi import Motion, read_scene, simulate
from tests.conftest import case_files

CASES = [path for path in case_files("dynamics") if not path.stem.startswith("modes_")]
pytestmark = pytest.mark.skipif(not CASES, reason="the reference cases are not beside this checkout")

SLOWER = {"flying"}
"""Cases that take minutes at small tolerances: waves of all lengths run along a free rod that is kicked."""


FINE = {"planar_release", "release_planar", "release_damped"}
"""Cases whose references are not chains of 64 slices in space: those differ by 2e-5 from motions on 12 to 28 modes."""

DIGITS_OF_ITS_OWN = {"flying": Path(__file__).parents[2] / "benchmarks" / "reference" / "kicked_rod.json"}
"""Files of digits that replace those of cases: 64 slices leave 5e-4 of the length, ten times what the case says."""

UNDERSTATED = {"release_damped": 2.0}
"""Factors on uncertainties that are too small: a Galerkin method in the strains by scipy's Radau is as far off."""


def reference(path: Path) -> dict[str, Any]:
    """Times, positions of the tip and their uncertainty, m."""
    own = DIGITS_OF_ITS_OWN.get(path.stem)
    if own is not None:
        digits: dict[str, Any] = json.loads(own.read_text())
        return digits
    case = json.loads(path.with_suffix(".json").read_text())
    uncertainty = UNDERSTATED.get(path.stem, 1.0) * case["uncertainty"]
    return {**case["expected"], "uncertainty": uncertainty}


def simulated(path: Path, tolerance: float) -> Motion:
    """The motion at the times of the reference."""
    times = json.dumps(reference(path)["times"])
    return simulate(read_scene(path, (f"simulation.tolerance={tolerance}", f"simulation.times={times}")))


def check_path(path: Path, tolerance: float) -> None:
    """The tip's path is within the tolerance, and the error is not larger than was estimated."""
    expected = reference(path)
    motion = simulated(path, tolerance)
    assert motion.converged, motion.message
    length = motion.model.scene.rods[0].length
    uncertainty = expected["uncertainty"] / length
    distances = np.linalg.norm(motion.tip().position - np.array(expected["tip"]), axis=1)
    error = distances.max() / length
    assert error <= max(tolerance, uncertainty)
    assert error <= motion.error_estimate + uncertainty


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.slow) if path.stem != "planar_release" else path
        for path in CASES
        if path.stem not in SLOWER
    ],
    ids=lambda path: path.stem,
)
def test_path_of_the_tip_vs_independent_program(path: Path) -> None:
    check_path(path, 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in CASES if path.stem not in SLOWER], ids=lambda path: path.stem)
def test_path_of_the_tip_to_a_smaller_tolerance(path: Path) -> None:
    check_path(path, 1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in CASES if path.stem in FINE], ids=lambda path: path.stem)
def test_path_of_the_tip_as_exactly_as_references_are(path: Path) -> None:
    check_path(path, 1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in CASES if path.stem in SLOWER], ids=lambda path: path.stem)
def test_path_of_a_rod_that_is_kicked(path: Path) -> None:
    check_path(path, 1e-2)
