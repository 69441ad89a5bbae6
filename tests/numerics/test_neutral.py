"""Inverses that move nothing along neutral directions."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.numerics.neutral import regular, regular_inverse


@pytest.mark.parametrize("smallest", [1.0, 1e-9, 1e-14, 0.0])
def test_neutral_directions_are_as_stiff_as_the_stiffest(smallest: float) -> None:
    """Singular values 3, 2 and one that is too small to count in two of the cases: there it is 3 afterwards."""
    random = np.random.default_rng(4)
    left, _, right = np.linalg.svd(random.normal(size=(3, 3)))
    matrix = left @ np.diag([3.0, 2.0, smallest]) @ right
    made = regular(matrix)
    last = smallest if smallest > 1e-12 else 3.0
    values = np.linalg.svd(made, compute_uv=False)
    assert_allclose(values, sorted([3.0, 2.0, last], reverse=True), rtol=1e-6, atol=0)
    # The other directions stay as they are.
    assert_allclose(made @ right[:2].T, matrix @ right[:2].T, rtol=0, atol=1e-13)
    assert_allclose(regular_inverse(matrix) @ made, np.eye(3), rtol=0, atol=1e-6)
