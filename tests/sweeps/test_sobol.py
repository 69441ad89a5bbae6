"""Sobol indices: the Ishigami function's closed form, SciPy's on the same draws, and a rod that bends linearly."""

from __future__ import annotations

import json
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from rich.console import Console
from scipy import stats

from cosserat_casadi import SceneError, sobol_indices, sobol_table, sweep
from cosserat_casadi.cli.reports.sweep import print_sobol
from cosserat_casadi.plots.sweep_plot import plot_sobol
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps.sobol import estimates
from tests.commands import cosserat
from tests.scenes import push, rod, scene

A, B = 7.0, 0.1
"""Numbers of the Ishigami function: T. Ishigami, T. Homma, Proc. ISUMA 1990, 398-403."""

STIFFNESS, LENGTH = 1.4, 0.8
SMALL = scene(
    push(force=[0.0, 0.0, 0.0], moment=[0.0, 0.0, 0.0]),
    rods=[rod("planar", stiffness={"bending_y": STIFFNESS})],
    accuracy={"modes": 4, "nodes": 10, "tolerance": 1e-4},
    title="A rod that bends little",
)


def ishigami(x: np.ndarray) -> np.ndarray:
    return np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])


def drawn(function: Callable[[np.ndarray], np.ndarray], samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The function on two draws, and on the first with one column of the second after the other."""
    first, second = np.random.default_rng(3).uniform(-np.pi, np.pi, (2, samples, 3))
    mixed = []
    for column in range(3):
        rows = first.copy()
        rows[:, column] = second[:, column]
        mixed.append(function(rows))
    return function(first), function(second), np.array(mixed)


def test_ishigami_vs_its_closed_form_and_scipy() -> None:
    samples = 4096
    first_draw, second_draw, mixed = drawn(ishigami, samples)
    found = estimates(first_draw, second_draw, mixed)
    variance = A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18 + 0.5
    alone = np.array([(1 + B * np.pi**4 / 5) ** 2 / 2, A**2 / 8, 0.0]) / variance
    together = B**2 * np.pi**8 * (1 / 18 - 1 / 50) / variance
    total = alone + np.array([together, 0.0, together])
    assert_allclose(found.variance, variance, rtol=0.03, atol=0)
    assert_allclose(found.first, alone, rtol=0, atol=0.04)
    assert_allclose(found.total, total, rtol=0, atol=0.04)
    for interval, exact in ((found.first_interval, alone), (found.total_interval, total)):
        assert np.all(interval[:, 0] - 0.01 <= exact)
        assert np.all(exact <= interval[:, 1] + 0.01)
        assert np.all(np.ptp(interval, axis=1) < 0.1)
    values = {"f_A": first_draw[None], "f_B": second_draw[None], "f_AB": mixed[:, None]}
    other = stats.sobol_indices(func=values, n=samples)
    assert_allclose(found.first, other.first_order, rtol=1e-10, atol=0)
    assert_allclose(found.total, other.total_order, rtol=1e-10, atol=0)


@pytest.mark.slow
def test_intervals_hold_as_often_as_they_say() -> None:
    """Of a linear function the indices are known; 200 repetitions of 256 draws."""
    slopes = np.array([1.0, 2.0, 0.5])
    exact = slopes**2 / np.sum(slopes**2)
    rng = np.random.default_rng(8)
    held = []
    for _ in range(200):
        first, second = rng.normal(size=(2, 256, 3))
        mixed = [first @ slopes + (second - first)[:, k] * slopes[k] for k in range(3)]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("cosserat_casadi.sweeps.sobol.RESAMPLES", 200)
            found = estimates(first @ slopes, second @ slopes, np.array(mixed))
        held.append((found.total_interval[:, 0] <= exact) & (exact <= found.total_interval[:, 1]))
    assert 0.90 <= np.mean(held) <= 0.98


def test_a_result_that_does_not_vary_has_no_indices() -> None:
    found = estimates(np.full(10, 3.0), np.full(10, 3.0), np.full((2, 10), 3.0))
    assert (found.mean, found.variance) == (3.0, 0.0)
    assert np.isnan(found.first).all()
    assert np.isnan(found.total_interval).all()


@pytest.mark.usefixtures("few_checked")
def test_linear_rod_vs_beam_theory(tmp_path: Path) -> None:
    """Tip x = F L³/3EI + M L²/2EI while it bends little: shares are squares of these slopes times the variances."""
    grid = "samples = 400\nseed = 5\npush.force.x = { normal = [0.0, 1e-3] }\n"
    grid += "push.moment.y = { uniform = [-1e-3, 1e-3] }\npush.force.z = 0.0\n"
    (tmp_path / "grid.toml").write_text(grid)
    (tmp_path / "scene.toml").write_text(scene_text(SMALL))
    words = ["sweep", "scene.toml", "--over", "grid.toml", "--output", "rows.csv", "--sobol", "found.json"]
    done = cosserat(*words, "--plot", "found.png", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "push.moment.y" in done.stdout
    assert (tmp_path / "found.png").stat().st_size > 1000
    found = json.loads((tmp_path / "found.json").read_text())
    slopes = np.array([LENGTH**3 / 3, LENGTH**2 / 2]) / STIFFNESS
    parts = slopes**2 * np.array([1e-6, 4e-6 / 12])
    of_x = found["results"]["rod.x"]
    assert_allclose(of_x["standard_deviation"], np.sqrt(parts.sum()), rtol=0.1, atol=0)
    for name, share in zip(("push.force.x", "push.moment.y"), parts / parts.sum(), strict=True):
        for kind in ("first", "total"):
            assert_allclose(of_x[kind][name]["value"], share, rtol=0, atol=0.1)
            low, high = of_x[kind][name]["interval_95"]
            assert low - 0.02 <= share <= high + 0.02
    assert found["results"]["rod.y"]["first"]["push.force.x"] == {"value": None, "interval_95": [None, None]}
    assert (found["samples"], found["left_out"]) == (400, 0)

    again = sweep(
        SMALL,
        sobol_table(
            {
                "push.force.x": {"normal": [0.0, 1e-3]},
                "push.moment.y": {"uniform": [-1e-3, 1e-3]},
                "push.force.z": 0.0,
            },
            400,
            5,
        ),
    )
    indices = sobol_indices(again)
    assert_array_equal(indices.results["rod.x"].first, [of_x["first"][name]["value"] for name in found["factors"]])
    # Draws without an equilibrium are left out, and told.
    again.outcomes[7] = 1
    indices = sobol_indices(again)
    assert (indices.samples, indices.left_out) == (399, 1)
    out = Console(file=StringIO(), width=200)
    print_sobol(out, indices)
    assert isinstance(out.file, StringIO)
    assert "Left out: 1 draw of 400" in out.file.getvalue()
    assert len(plot_sobol(indices).axes) == 2
    again.outcomes[:] = 1
    with pytest.raises(SceneError, match="no variance to share"):
        sobol_indices(again)


@pytest.mark.parametrize(
    ("columns", "samples", "message"),
    [
        ({"push.force.x": 1.0}, 10, "no random column"),
        ({"push.force.x": {"uniform": [0, 1]}, "push.force.z": [1.0, 2.0]}, 10, "several values"),
        ({"push.force.x": {"uniform": [0, 1]}}, 1, "at least 2"),
        ({"push.force.x": {"uniform": [0, 1]}}, 10_000_000, "at most 20,000,000"),
    ],
)
def test_designs_that_make_no_sense_are_refused(columns: dict[str, object], samples: int, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        sobol_table(columns, samples)


@pytest.mark.slow
def test_rows_that_were_not_drawn_for_it_are_refused(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("push.force.x\n0.1\n")
    (tmp_path / "scene.toml").write_text(scene_text(SMALL))
    words = ["sweep", "scene.toml", "--over", "rows.csv", "--output", "out.csv", "--sobol", "found.json"]
    done = cosserat(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert "for Sobol indices they are drawn" in " ".join(done.stderr.split())
    assert not (tmp_path / "found.json").exists()
