"""Places on a rod that are next to each other: solved as long as there is an element between them, refused below."""

from __future__ import annotations

from typing import Any

import pytest

from cosserat_casadi import SceneError, build, solve
from tests.scenes import scene


def pulled_at(*places: float) -> Any:
    hooks = [
        {"name": f"hook_{i}", "kind": "point_wrench", "rod": "rod", "at": at, "force": [0.3, 0.0, 0.0]}
        for i, at in enumerate(places)
    ]
    return scene(*hooks, accuracy={"modes": 3, "nodes": 6})


@pytest.mark.parametrize("places", [(0.5, 0.5 + 1e-12), (1e-12, 0.5), (0.3, 0.3)])
def test_near_places_are_solved(places: tuple[float, float]) -> None:
    assert solve(build(pulled_at(*places))).converged


@pytest.mark.parametrize("places", [(0.3, 0.1 + 0.2), (1e-320, 0.5), (1e-155, 0.5), (0.5, 1.0 - 1e-16)])
def test_places_with_nothing_between_them_are_refused(places: tuple[float, float]) -> None:
    with pytest.raises(SceneError, match=r"rod: its elements would end at .* and at .*, too close to each other"):
        build(pulled_at(*places))


def test_a_tendon_that_begins_next_to_the_base_is_refused() -> None:
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "length": 0.8, "offset": [0.01, 0], "span": [1e-320, 1]}
    with pytest.raises(SceneError, match=r"rod: its elements would end at 0\.0 and at 1e-320"):
        build(scene(actuators=[cable]))
