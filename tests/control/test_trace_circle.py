"""The example that traces a circle: on the circle, within the bounds, at little effort."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from examples.trace_circle import LARGEST, RADIUS, finger, trace


def test_the_tip_is_on_the_circle_at_little_effort() -> None:
    model = finger()
    tensions, equilibria = trace(model, 4)
    tips = np.array([solve(model, s.model.inputs.unpack(s.inputs)).tip().position for s in equilibria])
    angles = np.pi / 2 * np.arange(4)
    assert_allclose(tips[:, 1:], RADIUS * np.column_stack([np.cos(angles), np.sin(angles)]), rtol=0, atol=1e-8)
    assert np.all((tensions >= 0.0) & (tensions <= LARGEST))
    assert all(s.stable for s in equilibria)
    assert_allclose(tensions.min(axis=1), 0.0, rtol=0, atol=1e-4)  # two pull, the third would only pull against them
