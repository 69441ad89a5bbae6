"""The workspace figure: its panels, its points, the same bytes twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError
from cosserat_casadi.plots.sweep_plot import plot_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep

POSE = ("rod.x", "rod.y", "rod.z", "rod.qw", "rod.qx", "rod.qy", "rod.qz")


def swept(*, planar: bool, failing: bool = False) -> Sweep:
    """Made-up results: 40 rows over two inputs."""
    rng = np.random.default_rng(8)
    values = rng.uniform(-1.0, 1.0, (40, 2 + 2 + 7))
    if planar:
        values[:, 5] = 0.0
    outcomes = np.zeros(40, dtype=np.int64)
    if failing:
        outcomes[::4] = 4
        values[::4, 4:] = np.nan
    return Sweep(("a.b", "c.d"), ("iterations", "residual", *POSE), values, outcomes, {"title": "Made up"})


def test_points_of_a_plane_are_one_map() -> None:
    sweep = swept(planar=True)
    figure = plot_sweep(sweep)
    panel, bar = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel(), bar.get_ylabel()) == ("x, m", "z, m", "a.b")
    points = panel.collections[0].get_offsets()
    assert_allclose(points, sweep.positions()[:, [0, 2]], rtol=0, atol=1e-12)
    assert_allclose(panel.collections[0].get_array(), sweep["a.b"], rtol=0, atol=0)


def test_points_in_space_are_seen_from_four_sides() -> None:
    figure = plot_sweep(swept(planar=False), "rod.qw")
    assert [axes.get_xlabel() for axes in figure.axes[:4]] == ["x, m", "x, m", "x, m", "y, m"]
    assert figure.axes[1].name == "3d"
    assert figure.axes[4].get_ylabel() == "rod.qw"


def test_rows_that_failed_are_shown_among_the_inputs() -> None:
    sweep = swept(planar=True, failing=True)
    figure = plot_sweep(sweep, "outcome")
    panel, inputs = figure.axes
    assert len(panel.collections[0].get_offsets()) == 30
    assert "10 without a result" in panel.get_title()
    assert [text.get_text() for text in inputs.get_legend().get_texts()] == ["converged", "load stalled"]
    assert_allclose(inputs.collections[1].get_offsets(), sweep.values[::4, :2], rtol=0, atol=0)


def test_nothing_converged() -> None:
    sweep = swept(planar=True)
    nothing = Sweep(sweep.swept, sweep.found, sweep.values, np.full(40, 2), sweep.record)
    assert "0 of 40 rows" in plot_sweep(nothing).axes[0].get_title()


@pytest.mark.slow
def test_the_same_sweep_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        swept(planar=False, failing=True).write(tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with pytest.raises(SceneError):
        swept(planar=True).write(tmp_path / "a.bmp")
    with pytest.raises(KeyError, match="'none' is no column"):
        plot_sweep(swept(planar=True), "none")
