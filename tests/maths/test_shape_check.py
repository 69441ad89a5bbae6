"""Shapes at the border of records."""

import casadi as ca
import numpy as np
import pytest

from cosserat_casadi.maths.typing import check_shape


@pytest.mark.parametrize("matrix", [ca.SX(3, 4), ca.MX(3, 4), ca.DM(3, 4), np.zeros((3, 4))])
@pytest.mark.parametrize(("rows", "columns"), [(3, 4), (3, None), (None, 4), (None, None)])
def test_the_wanted_shape_passes(matrix, rows, columns):
    check_shape("force", matrix, rows, columns)


@pytest.mark.parametrize(
    "matrix", [ca.SX(1, 1), ca.MX(2, 4), ca.DM(4, 3), np.zeros(3), np.zeros((3, 4, 1)), np.ones(())]
)
def test_another_shape_is_refused_with_its_name(matrix):
    with pytest.raises(ValueError, match=r"force is 3×4, but its shape is \("):
        check_shape("force", matrix, 3, 4)


@pytest.mark.parametrize(("shape", "wanted"), [((3, None), "3×k"), ((None, 5), "n×5")])
def test_a_free_size_is_a_letter_in_the_message(shape, wanted):
    with pytest.raises(ValueError, match=f"profiles is {wanted}"):
        check_shape("profiles", ca.DM(2, 2), *shape)
