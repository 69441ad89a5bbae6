"""What figures and animations of modes show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

from cosserat_casadi import modes_of
from cosserat_casadi.motion.vibration_modes import Modes
from cosserat_casadi.plots import modes_plot
from cosserat_casadi.plots.modes_plot import mode_words, plot_modes
from tests.scenes import rod, scene

ROUND = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.05}


@pytest.fixture(scope="module")
def modes() -> Modes:
    """Bending in two planes, then torsion."""
    soft = rod("kirchhoff", stiffness=ROUND, rotary_inertia=[0.0, 0.0, 0.02], damping={"bending_x": 1e-3})
    return modes_of(scene(rods=[soft]), count=3)


def test_one_panel_a_mode_in_the_plane_that_holds_it(modes: Modes) -> None:
    figure = plot_modes(modes)
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    bending = sorted(label for label, axes in zip(labels, figure.axes, strict=True) if axes.name != "3d")
    assert bending == [("x, m", "z, m"), ("y, m", "z, m")]
    assert [axes.name for axes in figure.axes].count("3d") == 1
    for index, axes in enumerate(figure.axes):
        assert axes.get_title() == mode_words(modes.modes[index], index)


def test_modes_in_a_plane_that_stands_askew_are_drawn_in_it() -> None:
    turned = {"quaternion": [np.cos(0.3), 0, 0, np.sin(0.3)]}
    figure = plot_modes(modes_of(scene(rods=[rod("planar", base=turned)]), count=2))
    assert [axes.name for axes in figure.axes] == ["rectilinear", "rectilinear"]
    assert figure.axes[0].get_xlabel() == "along (0.825, 0.565, 0), m"


def test_both_ends_of_a_swing_lie_about_the_equilibrium(modes: Modes) -> None:
    axes = next(axes for axes in plot_modes(modes).axes if axes.get_xlabel() == "x, m" and axes.name != "3d")
    rest, _, back, there = (line.get_xydata() for line in axes.get_lines()[:4])
    assert_allclose((back + there) / 2, rest, rtol=0, atol=1e-12)
    # A fifth of the rod's length, however large the mode's own numbers are.
    assert_allclose(np.abs(there - rest).max(), 0.2 * 0.8, rtol=1e-9, atol=0)


def test_words_of_a_damped_mode(modes: Modes) -> None:
    words = [mode_words(mode, index) for index, mode in enumerate(modes.modes)]
    damped = [text for text in words if "ζ" in text]
    assert len(damped) == 1
    assert all("Hz" in text for text in words)


def test_figure_and_animation_are_written(modes: Modes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes_plot, "PERIOD_FRAMES", 8)
    modes.write(tmp_path / "m.png")
    modes.write(tmp_path / "again.png")
    assert (tmp_path / "m.png").read_bytes() == (tmp_path / "again.png").read_bytes()
    torsion = next(index for index, axes in enumerate(plot_modes(modes).axes) if axes.name == "3d")
    shares: list[float] = []
    modes.animate(tmp_path / "m.gif", mode=torsion + 1, progress=shares.append)
    assert shares[-1] == 1.0
    with Image.open(tmp_path / "m.gif") as film:
        # Sections that only turn are seen to turn.
        assert film.n_frames == 8
