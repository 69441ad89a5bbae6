"""Held rods: the same scene ends on the same equilibrium at every tolerance, and on modes that a user fixes.

`benchmarks/held_rods.py` counts more of them.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from cosserat_casadi import Outcome
from cosserat_casadi.equilibrium.metrics import pose_distance
from tests.fine_reference import distance, states
from tests.fuzz.held import TOLERANCES, Verdict, alike, all_alike, says_unresolved, solved, verdict
from tests.shooting_near import shoot

pytestmark = pytest.mark.slow

BUCKLED = 20
"""Seed of a rod that is pushed together along its axis, and leaves it in any direction."""

LOST = (28, 36, 239, 240, 304, 403)
"""Seeds of rods that are drawn tight, pressed together and sharply bent: `load_stalled`, or `unresolved` at 1e-9."""

SHARPEST = 269
"""Seed of a rod that more than 64 modes resolve to 1e-9."""

PLAIN = 2
"""Seed of a rod that 19 modes resolve to 1e-9, and 15 to 1e-6."""

SHARPLY_BENT = 68
"""Seed of a rod that nine modes do not resolve."""


def test_a_buckled_rod_is_the_same_at_every_tolerance() -> None:
    coarse = solved(BUCKLED, {"tolerance": 1e-3})
    fine = solved(BUCKLED, {"tolerance": 1e-7})
    assert fine.converged
    assert fine.stable
    assert alike(coarse, fine)
    # The check can fail: the mirror image is another equilibrium.
    assert not alike(replace(coarse, x=-coarse.x), fine)


def test_a_rod_that_no_level_resolves_says_so_and_is_held_to_its_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = solved(PLAIN, {"tolerance": 1e-9})
    # The equilibrium is decided on 15 modes, which then do not do: what is known of fewer is kept.
    monkeypatch.setattr("cosserat_casadi.accuracy.levels.REFERENCE_MODES", (3, 5, 7, 9, 12, 15))
    coarse = solved(PLAIN, {"tolerance": 1e-3})
    fine = solved(PLAIN, {"tolerance": 1e-9})
    assert coarse.converged
    assert says_unresolved(fine)
    assert alike(coarse, fine)
    assert not alike(coarse, replace(fine, x=-fine.x))
    # A solve that has failed is not alike to it, nor is one that says nothing of its error.
    assert not alike(replace(coarse, outcome=Outcome.LOAD_STALLED), fine)
    assert not alike(coarse, replace(fine, error_estimate=None))
    assert fine.error_estimate is not None
    assert pose_distance(fine, truth) <= fine.error_estimate <= 1e-3
    assert verdict(PLAIN, [{"tolerance": 1e-3}, {"tolerance": 1e-9}]) is Verdict.SAYS_UNRESOLVED


def test_a_sharply_bent_rod_vs_shooting() -> None:
    solution = solved(SHARPEST, {"tolerance": 1e-9})
    assert solution.converged
    errors = distance({"rod": shoot(solution)}, states(solution))
    assert solution.error_estimate is not None
    assert errors.pose <= solution.error_estimate <= 1e-9


def test_fixed_modes_find_the_equilibrium_that_a_tolerance_finds() -> None:
    fine = solved(BUCKLED, {"tolerance": 1e-7})
    for modes in (9, 14):
        fixed = solved(BUCKLED, {"modes": modes, "nodes": 2 * modes + 2})
        assert fixed.converged
        assert alike(fixed, fine)


def test_modes_that_do_not_resolve_a_rod_are_held_to_its_shape() -> None:
    coarse = solved(SHARPLY_BENT, {"modes": 9, "nodes": 20})
    fine = solved(SHARPLY_BENT, {"tolerance": 1e-5})
    assert says_unresolved(coarse)
    assert fine.converged
    assert alike(coarse, fine)
    assert not alike(replace(coarse, x=-coarse.x), fine)


@pytest.mark.parametrize("seed", LOST)
def test_held_rods_that_were_lost_are_found(seed: int) -> None:
    assert verdict(seed, [{"tolerance": tolerance} for tolerance in (1e-3, 1e-9)]) is Verdict.ALIKE


@pytest.mark.parametrize("first", range(0, 60, 5))
def test_held_rods_are_the_same_at_every_tolerance(first: int) -> None:
    accuracies = [{"tolerance": tolerance} for tolerance in TOLERANCES]
    different = [seed for seed in range(first, first + 5) if not all_alike(seed, accuracies)]
    assert different == []
