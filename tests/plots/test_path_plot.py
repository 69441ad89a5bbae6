"""What the figure of a path shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import EquilibriumPath, SceneError, build, follow
from cosserat_casadi.plots.path_plot import plot_path
from cosserat_casadi.results.presentation import csv_of
from tests.families import mostly_slow
from tests.scenes import push, rod, scene


@pytest.fixture(scope="module")
def straight() -> EquilibriumPath:
    """A column of length 2 that buckles at a third of the load; a second load bends it a little to no avail."""
    upright = rod("planar", length=2.0, stiffness={"bending_y": 1.0})
    model = build(scene(push(force=[0, 0, 0]), rods=[upright]))
    return follow(model, "push.force", [0, 0, -3 * np.pi**2 / 16])


@pytest.fixture(scope="module")
def buckled(straight: EquilibriumPath) -> EquilibriumPath:
    return follow(straight.model, "push.force", straight.value, branch=True)


def lines(figure: Any) -> list[Any]:
    return [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) > 1]


def test_unstable_parts_are_dashed_and_events_marked(straight: EquilibriumPath) -> None:
    figure = plot_path(straight)
    styles = [line.get_linestyle() for line in lines(figure) if line.get_color() != "0.7"]
    assert styles == ["-", "--"]
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"stable", "unstable", "bifurcation"} <= set(labels)
    assert "neutral" not in labels
    (mark,) = [line for line in figure.axes[0].get_lines() if line.get_label() == "bifurcation"]
    assert_allclose(mark.get_ydata(), [1 / 3], rtol=1e-6, atol=0)


def test_the_axis_of_the_factor_tells_its_unit(straight: EquilibriumPath) -> None:
    assert plot_path(straight).axes[0].get_ylabel() == "factor × push.force [0, 0, -1.851] N"


def test_displacement_is_relative_to_the_length(buckled: EquilibriumPath) -> None:
    figure = plot_path(buckled)
    ends = {line.get_color(): line.get_xdata()[-1] for line in lines(figure) if line.get_color() != "0.7"}
    tip = buckled.tip().position[-1]
    assert_allclose(sorted(ends.values()), sorted([tip[0] / 2, tip[2] / 2 - 1]), rtol=1e-12, atol=0)
    assert "neutral" not in figure.axes[0].get_legend_handles_labels()[1]


def test_a_path_that_ended_early_says_so_in_red(straight: EquilibriumPath) -> None:
    none = follow(straight.model, "push.force", [0, 0, -0.1], branch=True)
    title = plot_path(none).axes[0].title
    assert title.get_text() == none.message
    assert title.get_color() == "#cc3311"


@pytest.mark.parametrize("suffix", mostly_slow(["png", "pdf", "svg"], quick=["svg"]))
def test_files_are_the_same_every_time(buckled: EquilibriumPath, tmp_path: Path, suffix: str) -> None:
    first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    buckled.write(first)
    buckled.write(second)
    assert first.read_bytes() == second.read_bytes()


def test_unknown_suffix_is_refused(buckled: EquilibriumPath, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"cannot be written to .*use one of"):
        buckled.write(tmp_path / "figure.doc")
    assert list(tmp_path.iterdir()) == []


def test_a_path_without_a_start_can_be_drawn_and_written(tmp_path: Path) -> None:
    aside = {"rod": "rod", "kind": "clamped", "position": [0.8, 0.0, 0.0], "quaternion": [1, 0, 0, 0]}
    none = follow(build(scene(push(), strain="planar", supports=[aside])), "push.force", [1, 0, 0])
    none.write(tmp_path / "none.png")
    assert none.to_dict()["path"] == []
    assert none.to_dict()["outcome"] == "no_start"
    assert len(csv_of(none).splitlines()) == 1
