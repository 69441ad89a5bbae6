"""Catalogue (i), (j): slender wires, torsion far softer or stiffer than bending, shear that dominates."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.catalogue import cases
from tests.catalogue.checks import solved
from tests.reference.shooting import solve_by_shooting

QUICK = {
    "EA L²/EI = 1e10": cases.slender(1e10),
    "L/d = 1e4": cases.wire(1e4),
    "GJ/EI = 1e-3": cases.torsion_ratio(1e-3),
    "GA L²/EI = 1e-3": cases.shear_beam(1e-3),
}
SLOW = {
    "EA L²/EI = 1e2": cases.slender(1e2),
    "EA L²/EI = 1e6": cases.slender(1e6),
    "L/d = 10": cases.wire(10),
    "GJ/EI = 1e-2": cases.torsion_ratio(1e-2),
    "GJ/EI = 1e3": cases.torsion_ratio(1e3),
    "GA L²/EI = 0.1": cases.shear_beam(0.1),
    "GA L²/EI = 1": cases.shear_beam(1.0),
}


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_extreme_stiffness_vs_shooting(name: str) -> None:
    tables = {**QUICK, **SLOW}[name]
    solution, oracle = solved(tables), solve_by_shooting(tables)
    assert_allclose(solution.tip().position, oracle.tip_position, rtol=0, atol=1e-8)
    assert_allclose(solution.tip().rotation, oracle.tip_rotation, rtol=0, atol=1e-8)
    base, size = solution.base_wrench(), np.abs(oracle.base_force).max()
    assert_allclose(base.force, oracle.base_force, rtol=0, atol=1e-8 * size)
    assert_allclose(base.moment, oracle.base_moment, rtol=0, atol=1e-8 * max(size, np.abs(oracle.base_moment).max()))
