"""A tentacle whose data say little of its Poisson ratio: the search meets a bound and goes on along it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import Model, build, identify, read_scene, solve
from cosserat_casadi.maths.typing import FloatArray

SCENE = Path(__file__).with_name("tentacle.toml")

NOISE = 5e-3
"""Standard deviation of the measured positions, m."""


@pytest.fixture(scope="module")
def tentacle() -> Model:
    return build(read_scene(SCENE).with_unknowns())


def measured(tentacle: Model) -> dict[str, FloatArray]:
    """Positions of two markers by column, as the scene's numbers and noise give them."""
    # Noise with which a search that cut single unknowns off at their bounds stalled.
    rng = np.random.default_rng(2)
    tensions = [(0.0, 0.0), (4.0, 0.0), (8.0, 0.0), (0.0, 4.0), (0.0, 8.0), (6.0, 3.0)]
    offsets = np.array([[0.0, -0.021, 0.0], [0.0, 0.0, 0.008]])
    positions = []
    for first, second in tensions:
        solution = solve(tentacle, {"m1.tension": first, "m2.tension": second})
        assert solution.converged
        pose = solution.pose(np.array([0.6, 1.0]))
        markers = pose.position + np.einsum("kij,kj->ki", pose.rotation, offsets)
        positions.append((markers + NOISE * rng.standard_normal(markers.shape)).ravel())
    columns = np.hstack([np.array(tensions), np.array(positions)])
    return dict(zip(("t1", "t2", "mx", "my", "mz", "tx", "ty", "tz"), columns.T, strict=True))


def test_the_bound_is_named_and_the_others_go_on(tentacle: Model) -> None:
    data = measured(tentacle)
    found = identify(tentacle, {"middle": data, "tip": data})
    assert found.converged, found.message
    assert found.at_bounds == ("arm.material.poisson_ratio",)
    assert found.shared[found.labels.index("arm.material.poisson_ratio")] == 0.4
    others = [label not in found.at_bounds for label in found.labels]
    assert_array_equal(np.isfinite(found.sigma), others)
    assert any("At a bound: arm.material.poisson_ratio" in warning for warning in found.warnings)
