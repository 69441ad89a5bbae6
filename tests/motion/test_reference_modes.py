"""Modes of the reference cases: by transfer matrices, and by chains of rigid slices in other coordinates."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import modes_of, read_scene
from tests.conftest import case_files

CASES = [path for path in case_files("dynamics") if path.stem.startswith("modes_")]
pytestmark = pytest.mark.skipif(not CASES, reason="the reference cases are not beside this checkout")

UNDERSTATED = {"modes_sagged": 3.0}
"""Factors on uncertainties that are too small: test_modes_of_the_literature.py has digits for this one."""

QUICK = {"modes_beck_15", "modes_wire_damped"}

EXACT = 1e-9
"""Uncertainty, relative, of what transfer matrices give."""


@pytest.mark.parametrize(
    "path",
    [path if path.stem in QUICK else pytest.param(path, marks=pytest.mark.slow) for path in CASES],
    ids=lambda path: path.stem,
)
def test_modes_vs_independent_program(path: Path) -> None:
    """Angular frequencies, and where they are given damping ratios and the tip of the equilibrium."""
    case = json.loads(path.with_suffix(".json").read_text())
    expected = case["expected"]["modes"]
    found = modes_of(read_scene(path), count=len(expected))
    assert found.converged, found.message
    uncertainty = 0.0
    if case["uncertainty"] > EXACT:
        uncertainty = UNDERSTATED[path.stem] * case["uncertainty"]
    for mode, entry in zip(found.modes, expected, strict=True):
        assert_allclose(mode.angular_frequency, entry["angular_frequency"], rtol=EXACT, atol=uncertainty)
        if "damping_ratio" in entry:
            assert_allclose(mode.damping_ratio, entry["damping_ratio"], rtol=EXACT, atol=0)
    if "tip" in case["expected"]:
        assert_allclose(found.solution.tip().position, case["expected"]["tip"], rtol=0, atol=1e-5)
