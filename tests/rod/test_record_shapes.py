"""Records refuse matrices of another shape than theirs: CasADi would broadcast them in silence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosserat_casadi.rod.actuation import Actuation, StrainSum
from cosserat_casadi.rod.cable import Routing
from cosserat_casadi.rod.wrenches import LineWrench, WrenchAt

VECTOR = ca.DM.ones(3, 1)
NODES = np.arange(5)
PLANE = np.zeros((2, 5))

FAULTY: dict[str, tuple[Callable[[], Any], str]] = {
    "number for a force": (lambda: WrenchAt(1.0, ca.DM(1.0), None, follower=False), "force is 3×1"),
    "row for a moment": (lambda: WrenchAt(1.0, None, VECTOR.T, follower=False), "moment is 3×1"),
    "columns without profiles": (lambda: LineWrench(ca.DM.ones(3, 2), None, np.ones((1, 5)), follower=False), "3×1"),
    "vector for an effort": (lambda: Actuation(StrainSum((5,), np.ones((1, 5))), VECTOR), "effort is 1×1"),
    "one row of an offset": (lambda: Routing(NODES, PLANE[:1], PLANE), "offset is 2×5"),
    "slope of other nodes": (lambda: Routing(NODES, PLANE, PLANE[:, :4]), "slope is 2×5"),
}


@pytest.mark.parametrize("case", FAULTY)
def test_matrices_of_another_shape_are_refused(case: str) -> None:
    make, message = FAULTY[case]
    with pytest.raises(ValueError, match=message):
        make()


def test_vectors_of_the_right_shape_are_taken() -> None:
    assert WrenchAt(1.0, VECTOR, None, follower=True).force is VECTOR
    assert LineWrench(ca.DM.ones(3, 2), None, np.ones((2, 5)), follower=False).moment is None
    assert Routing(NODES, PLANE, PLANE).offset is PLANE
