"""Figures of concentric tubes: the line between stations."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from cosserat_casadi.plots.tubes_plot import _between, plot_tubes
from cosserat_casadi.tubes.tube_solution import TubeShape
from tests.tubes.pendulum import Pendulum

CURVATURE = 3.0
LENGTH = 0.5


def distance_from_arc(stations: int) -> float:
    """Largest distance of the drawn line from the arc of a circle that its stations lie on, m."""
    s = np.linspace(0.0, LENGTH, stations)
    turned = CURVATURE * s
    zeros = np.zeros(stations)
    position = np.stack([(1.0 - np.cos(turned)) / CURVATURE, zeros, np.sin(turned) / CURVATURE], axis=1)
    quaternion = np.stack([np.cos(turned / 2.0), zeros, np.sin(turned / 2.0), zeros], axis=1)
    none = np.zeros((stations, 0))
    line, frames = TubeShape(s, position, quaternion, none, none).between(np.linspace(0.0, LENGTH, 12 * stations))
    assert_allclose(line[-1], position[-1], rtol=0, atol=1e-15)
    assert_allclose(frames[-1], quaternion[-1], rtol=0, atol=1e-15)
    radius = np.hypot(line[:, 0] - 1.0 / CURVATURE, line[:, 2])
    return float(np.abs(radius - 1.0 / CURVATURE).max())


def test_an_arc_is_drawn_to_order_four() -> None:
    coarse = distance_from_arc(5)
    assert coarse < 2e-5
    assert np.log2(coarse / distance_from_arc(9)) == pytest.approx(4.0, abs=0.2)


def test_a_station_off_by_rounding_belongs_to_both_sides() -> None:
    distance = np.array([0.0, 0.1, 0.30000000000000004, 0.5])
    assert _between(distance, 0.0, 0.3).tolist() == [True, True, True, False]
    assert _between(distance, 0.3, 0.5).tolist() == [False, False, True, True]


def test_each_tube_has_one_colour_in_space_and_beside() -> None:
    figure = plot_tubes(solve(Pendulum(1.0).scene(1.0, tolerance=1e-4)))
    in_space, beside = ({line.get_label(): line.get_color() for line in axes.get_lines()} for axes in figure.axes)
    assert in_space["outer"] != in_space["inner"]
    assert {name: in_space[name] for name in ("outer", "inner")} == {name: beside[name] for name in ("outer", "inner")}
