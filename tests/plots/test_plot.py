"""Figures: what they show is what was solved, and files are whole and the same every time."""

from __future__ import annotations

import builtins
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, SceneError, Solution, build, solve
from cosserat_casadi.plots.figure import PlotUnavailableError, check_plot_path
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.plots.solved_shapes import SAMPLES
from tests.families import mostly_slow
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene


@pytest.fixture(scope="module")
def spatial() -> Solution:
    return solve(build(scene(push(moment=[0.1, 0.2, 0.1]), WEIGHT, HOOK, WIND, strain="reissner")))


@pytest.fixture(scope="module")
def planar() -> Solution:
    flat = {"force": [0.5, 0, -0.3], "moment": [0, 0.4, 0]}
    return solve(build(scene(push(**flat), {**WEIGHT, "acceleration": [0, 0, -2.0]}, strain="planar")))


def lines(axes: Any) -> dict[str, Any]:
    return {line.get_label(): line for line in axes.get_lines()}


def test_space_shows_rod_loads_and_frames(spatial: Solution) -> None:
    scenery, *_ = plot_solution(spatial).axes
    assert scenery.name == "3d"
    labels = scenery.get_legend_handles_labels()[1]
    assert {"unloaded", "deformed"} <= set(labels)
    for load in ("push", "hook", "weight", "wind"):
        assert any(label.startswith(load) for label in labels)
    drawn = np.array(lines(scenery)["deformed"].get_data_3d()).T
    assert_allclose(drawn, spatial.pose(SAMPLES).position, rtol=0, atol=1e-15)
    # Nine section frames of three axes, the two shapes and the base.
    assert len(scenery.get_lines()) == 9 * 3 + 3


def test_a_plane_scene_is_drawn_in_its_plane(planar: Solution) -> None:
    scenery, *_ = plot_solution(planar).axes
    assert scenery.name == "rectilinear"
    drawn = lines(scenery)["deformed"].get_xydata()
    assert_allclose(drawn, planar.pose(SAMPLES).position[:, [0, 2]], rtol=0, atol=1e-15)
    assert (scenery.get_xlabel(), scenery.get_ylabel()) == ("x, m", "z, m")
    assert any(text.get_text() in "↺↻" for text in scenery.texts if text.get_text())


@pytest.mark.parametrize("angle", [0.6, 2.5])
def test_a_plane_that_stands_askew_is_drawn_as_a_plane_too(angle: float) -> None:
    """A planar rod in a plane turned about the vertical: the picture is that of the same rod in the x–z plane."""
    towards = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-np.sin(angle), np.cos(angle), 0.0])
    push_askew = push(force=(0.5 * towards - [0, 0, 0.3]).tolist(), moment=(0.4 * across).tolist())
    turned = {"position": [0.0, 0.0, 0.0], "quaternion": [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]}
    askew = solve(build(scene(push_askew, rods=[rod(strain="planar", base=turned)])))
    scenery = plot_solution(askew).axes[0]
    assert scenery.name == "rectilinear"
    right = towards * np.sign(towards[0])
    drawn = lines(scenery)["deformed"].get_xydata()
    position = askew.pose(SAMPLES).position
    assert_allclose(drawn, np.stack([position @ right, position[:, 2]], axis=1), rtol=0, atol=1e-9)
    assert scenery.get_xlabel() == f"along ({right[0]:.3g}, {right[1]:.3g}, 0), m"
    assert scenery.get_ylabel() == "z, m"
    # A moment about the normal that points away from the reader is seen clockwise.
    (sign,) = [text.get_text() for text in scenery.texts if text.get_text()]
    assert sign == {True: "↻", False: "↺"}[bool(towards[0] > 0)]


def test_panels_hold_strain_moment_and_force(spatial: Solution) -> None:
    _, strain, moment, force, linear = plot_solution(spatial).axes
    assert_allclose(lines(strain)["K_y"].get_ydata(), spatial.strain(SAMPLES)[:, 1], rtol=0, atol=1e-15)
    assert_allclose(lines(linear)["Γ_z − 1"].get_ydata(), spatial.strain(SAMPLES)[:, 5] - 1, rtol=0, atol=1e-15)
    wrench = spatial.internal_wrench(SAMPLES)
    assert_allclose(lines(moment)["M_x"].get_ydata(), wrench[:, 0], rtol=0, atol=1e-15)
    assert_allclose(lines(force)["N_z"].get_ydata(), wrench[:, 5], rtol=0, atol=1e-15)


def test_components_that_are_zero_are_not_drawn(planar: Solution) -> None:
    _, strain, moment, _ = plot_solution(planar).axes
    assert [line.get_label() for line in strain.get_lines()] == ["K_y"]
    assert [line.get_label() for line in moment.get_lines()] == ["M_y"]


def test_several_rods_are_named() -> None:
    other = rod(name="other", base={"position": [0.3, 0, 0]})
    solution = solve(build(scene(push(), rods=[rod(), other])))
    figure = plot_solution(solution)
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"rod", "other"} <= set(labels)
    # Colours tell the rods in all panels: strokes of components are named once, in no rod's colour.
    for panel in figure.axes[1:]:
        legend = panel.get_legend()
        if legend is not None:
            named = [text.get_text() for text in legend.get_texts()]
            assert len(named) == len(set(named))
            assert {handle.get_color() for handle in legend.get_lines()} == {"0.3"}


def boxes(figure: Any) -> tuple[list[Any], list[Any]]:
    """Where all axes and all legends of a figure are, pixels."""
    figure.draw_without_rendering()
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None]
    axes_boxes = [axes.get_window_extent() for axes in figure.axes]
    return axes_boxes, [legend.get_window_extent() for legend in [*figure.legends, *legends]]


@pytest.mark.parametrize("kind", ["spatial", "planar"])
def test_legends_cover_nothing(kind: str, request: pytest.FixtureRequest) -> None:
    axes_boxes, legend_boxes = boxes(plot_solution(request.getfixturevalue(kind)))
    assert len(legend_boxes) == 4
    for legend in legend_boxes:
        for axes in axes_boxes:
            width = min(legend.x1, axes.x1) - max(legend.x0, axes.x0)
            height = min(legend.y1, axes.y1) - max(legend.y0, axes.y0)
            # A pixel is the line around the axes.
            assert min(width, height) < 1.0


def test_powers_of_ten_stand_beside_legends() -> None:
    thin = rod("planar", stiffness={"bending_y": 1e-6})
    figure = plot_solution(solve(build(scene(push(force=[1e-6, 0, 0]), rods=[thin]))))
    figure.draw_without_rendering()
    moment = figure.axes[2]
    power = moment.yaxis.get_offset_text()
    assert power.get_text().startswith("1e−")
    assert not power.get_window_extent().overlaps(moment.get_legend().get_window_extent())


def test_axes_of_space_have_one_scale(spatial: Solution) -> None:
    scenery = plot_solution(spatial).axes[0]
    limits = np.array([scenery.get_xlim(), scenery.get_ylim(), scenery.get_zlim()])
    widths = np.ptp(limits, axis=1)
    # matplotlib gives the sides of its box by no public name.
    sides = scenery._box_aspect
    assert_allclose(sides / sides.max(), widths / widths.max(), rtol=1e-12, atol=0)
    drawn = spatial.pose(SAMPLES).position
    assert np.all(drawn > limits[:, 0])
    assert np.all(drawn < limits[:, 1])


def test_many_rods_differ_in_colour_or_marks() -> None:
    many = [rod(name=f"rod_{i}", base={"position": [0.1 * i, 0, 0]}) for i in range(8)]
    scenery = plot_solution(solve(build(scene(WEIGHT, rods=many)))).axes[0]
    drawn = lines(scenery)
    styles = {(drawn[f"rod_{i}"].get_color(), drawn[f"rod_{i}"].get_marker()) for i in range(8)}
    assert len(styles) == 8


def test_an_unconverged_solution_says_so_in_red(planar: Solution) -> None:
    stalled = replace(planar, outcome=Outcome.LOAD_STALLED, message=Outcome.LOAD_STALLED.value)
    title = plot_solution(stalled).axes[0].title
    assert title.get_text() == Outcome.LOAD_STALLED.value
    assert title.get_color() == "#cc3311"


@pytest.mark.parametrize(
    ("suffix", "signature"),
    mostly_slow(
        [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")], quick=[("pdf", b"%PDF"), ("svg", b"<?xml")]
    ),
)
def test_files_are_the_same_every_time(planar: Solution, tmp_path: Path, suffix: str, signature: bytes) -> None:
    first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    planar.write(first)
    planar.write(second)
    assert first.read_bytes().startswith(signature)
    assert first.read_bytes() == second.read_bytes()


def test_unknown_suffix_is_refused_and_nothing_written(planar: Solution, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"cannot be written to .*png"):
        planar.write(tmp_path / "figure.doc")
    assert list(tmp_path.iterdir()) == []


def test_missing_matplotlib_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **options: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(PlotUnavailableError, match=r"pip install 'cosserat-casadi\[plot\]'"):
        check_plot_path("figure.png")
