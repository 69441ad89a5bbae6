"""Cables of given length that may go slack: where all are taut the answer is that of cables that may not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, follow, scene_from_dict
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow

ROD = {
    "name": "rod",
    "length": 0.25,
    "strain": "reissner",
    "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33},
    "section": {"shape": "circle", "radius": 0.6e-3},
}
STALLED = (0.2462773, 0.2461656, 0.257319)
"""Lengths of which one cable is slack while the rod is straight and taut once it has bent, m."""


def robot(*cables: dict[str, Any], slack: bool = False) -> Model:
    """A rod with three parallel cables at 8 mm, each of a given length or tension."""
    angles = 2 * np.pi * np.arange(3) / 3
    offsets = 8e-3 * np.column_stack([np.cos(angles), np.sin(angles)])
    tendons = [
        {"name": f"cable_{k}", "kind": "tendon", "rod": "rod", "offset": offset.tolist(), **cable}
        for k, (cable, offset) in enumerate(zip(cables, offsets, strict=True))
    ]
    for tendon in tendons:
        if "length" in tendon:
            tendon["slack"] = slack
    return build(scene_from_dict({"schema": 1, "rods": [ROD], "actuators": tendons}))


def of_length(lengths: Any, *, slack: bool) -> Model:
    return robot(*[{"length": float(length)} for length in lengths], slack=slack)


def assert_alike(lengths: Any) -> None:
    held = solve(of_length(lengths, slack=False))
    slack = solve(of_length(lengths, slack=True))
    assert held.converged
    assert slack.converged, slack.message
    assert_allclose(slack.tip().position, held.tip().position, rtol=0, atol=1e-9 * 0.25)
    assert_allclose(slack.tip().rotation, held.tip().rotation, rtol=0, atol=1e-8)


def test_cable_that_is_slack_on_the_way_and_taut_in_the_end() -> None:
    assert_alike(STALLED)


@pytest.mark.parametrize("seed", mostly_slow(range(8), quick=[3]))
def test_taut_cables_vs_cables_that_cannot_go_slack(seed: int) -> None:
    """Lengths of a stable equilibrium under tensions from 0.2 to 10 N."""
    tensions = np.random.default_rng(seed).uniform(0.2, 10.0, 3)
    pulled = solve(robot(*[{"tension": float(tension)} for tension in tensions]))
    assert pulled.converged
    if not pulled.stable:
        pytest.skip("these tensions buckle the rod")
    assert_alike([float(pulled.actuator(f"cable_{k}")["length"]) for k in range(3)])


def test_cable_that_is_too_long_stays_slack() -> None:
    model = of_length((0.2475, 0.2505, 0.262), slack=True)
    solution = solve(model)
    assert solution.converged
    tensions = np.array([float(solution.actuator(f"cable_{k}")["tension"]) for k in range(3)])
    lengths = np.array([float(solution.actuator(f"cable_{k}")["length"]) for k in range(3)])
    assert tensions[0] > 1.0
    assert_allclose(tensions[2], 0.0, rtol=0, atol=1e-6)
    assert lengths[2] < 0.262 - 1e-3


@pytest.mark.parametrize("slack", [False, True])
@pytest.mark.parametrize("load_factor", mostly_slow([1.0, 0.6, 0.0], quick=[0.6]))
def test_jacobian_vs_ad(load_factor: float, slack: bool) -> None:
    model = of_length(STALLED, slack=slack)
    check_jacobian(model, load_factor, seed=3, atol=1e-12)


def test_path_on_which_a_cable_becomes_taut() -> None:
    model = robot({"tension": 0.0}, {"length": 0.2505}, {"tension": 0.0}, slack=True)
    path = follow(model, "cable_0.tension", 1.0)
    assert path.converged, path.message
    tensions = np.array(
        [float(model.actuator["cable_1"](x, u)[0]) for x, u in zip(path.x, path.all_inputs, strict=True)]
    )
    assert tensions[0] < 1e-12 and tensions[-1] > 0.1
    assert_allclose(path.x[-1], solve(model, {"cable_0.tension": 1.0}).x, rtol=0, atol=1e-8)
