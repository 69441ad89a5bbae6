"""The page's own eigenvalues of the second variation against those of the library."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi.equilibrium.stability import ConstrainedVariations, admissible_eigenvalues
from tests.page.pages_made import run_node


def test_eigenvalues_over_the_admissible_variations(tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    cases = []
    expected = []
    # Without constraints; with three; with two that repeat each other; with a cable that is slack; with one that
    # stretches; rods of two energy units.
    for free, held, spoil in (
        (1, 0, ""),
        (9, 0, ""),
        (12, 3, ""),
        (12, 3, "repeat"),
        (8, 2, "slack"),
        (8, 2, "elastic"),
        (10, 3, "units"),
    ):
        n = free + held
        jacobian = random.normal(size=(n, n))
        jacobian = jacobian + jacobian.T
        jacobian[free:, free:] = 0.0
        units = np.ones(free)
        if spoil == "repeat":
            jacobian[-1] = 2 * jacobian[-2]
        if spoil == "slack":
            jacobian[-1] = 0.0
            jacobian[-1, -1] = 1.0
        if spoil == "elastic":
            jacobian[-1, -1] = 0.5
        if spoil == "units":
            units[: free // 2] = 0.01
        allowed = ConstrainedVariations(np.arange(free), np.arange(free, n), units)
        expected.append(admissible_eigenvalues(jacobian, allowed))
        plain = {"free": allowed.free.tolist(), "held": allowed.held.tolist(), "units": units.tolist()}
        cases.append({"jacobian": jacobian.tolist(), "allowed": plain})
    file = tmp_path / "cases.json"
    file.write_text(json.dumps(cases))
    for found, values in zip(run_node("symmetric_eigenvalues.js", file), expected, strict=True):
        assert_allclose(found, values, rtol=1e-10, atol=1e-12)


# How finely a page paints what moves follows from how long its pictures take.


LATE = 50.0
"""Milliseconds of a picture that is late."""

QUICK = 17.0


def qualities(tmp_path: Path, times: list[float]) -> list[int]:
    """The quality after each picture, 0 for the finest."""
    file = tmp_path / "times.json"
    file.write_text(json.dumps(times))
    found: list[int] = run_node("pace.js", file)
    return found


def test_late_pictures_make_the_next_ones_coarser_and_quick_ones_finer(tmp_path: Path) -> None:
    # Three late ones for a step; not beyond the coarsest of four.
    assert qualities(tmp_path, [LATE] * 12) == [0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3]
    # One that is late now and then, as while something else is loaded, changes nothing.
    assert set(qualities(tmp_path, [LATE, LATE, QUICK, QUICK] * 10)) == {0}
    found = qualities(tmp_path, [LATE] * 6 + [QUICK] * 120)
    assert found[5:65] == [2] * 60
    assert found[65:125] == [1] * 60
    assert found[125] == 0


def test_a_finer_quality_that_failed_is_tried_again_later_and_later(tmp_path: Path) -> None:
    found = qualities(tmp_path, [LATE] * 3 + [QUICK] * 60 + [LATE] * 3 + [QUICK] * 120 + [LATE] * 3 + [QUICK] * 239)
    steps = [i for i in range(1, len(found)) if found[i] != found[i - 1]]
    assert steps == [2, 62, 65, 185, 188]
    assert found[-1] == 1
