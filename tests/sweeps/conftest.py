"""Scenes whose sweeps take little time, and a compiler that does not optimise."""

from __future__ import annotations

import pytest

from tests.scenes import push, rod, scene


@pytest.fixture
def few_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two rows are solved again at the end of a sweep, not six."""
    monkeypatch.setattr("cosserat_casadi.sweeps.choice.CHECKED", 2)


PLANAR = scene(
    push(force=[0.9, 0.0, -0.4], moment=[0.0, 0.3, 0.0]),
    rods=[rod("planar", stiffness={"bending_y": 1.4})],
    accuracy={"modes": 3, "nodes": 10, "tolerance": 1e-4},
    title="A planar rod",
)
"""A rod in the plane of x and z with its discretisation fixed."""
