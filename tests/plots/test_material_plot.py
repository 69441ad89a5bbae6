"""The figure of materials: its curves are those of the laws, and linear scenes have none."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, read_scene
from cosserat_casadi.cli.main import REFUSED, app, run
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.plots.material_plot import plot_materials, stress_curves
from tests.conftest import ROOT

MATERIALS = ROOT / "examples" / "three_materials.toml"


def test_curves_are_those_of_the_laws() -> None:
    rubber, wire, lattice = read_scene(MATERIALS).rods
    (measured,) = stress_curves(rod_properties(lattice))
    assert_allclose(np.interp([-10.0, 5.0], measured.change, measured.stress), [-0.034, 0.020], rtol=2e-3, atol=0)
    # Beyond the last point there is no law.
    assert np.array_equal(measured.inside, np.abs(measured.change) < 40.0)
    assert 40.0 < measured.change[-1] <= 52.0
    # The line of small strains is the slope of the curve, not that of Young's modulus.
    near = np.abs(measured.change) < 0.5
    assert_allclose(measured.stress[near], measured.linear[near], rtol=2e-2, atol=0)
    (superelastic,) = stress_curves(rod_properties(wire))
    steep = np.abs(superelastic.change) * 0.5e-3 < 0.008
    assert_allclose(superelastic.stress[steep], superelastic.linear[steep], rtol=1e-12, atol=0)
    assert [curve.component for curve in stress_curves(rod_properties(rubber))] == [1, 5]


def test_every_curve_has_a_panel() -> None:
    figure = plot_materials(read_scene(MATERIALS))
    titles = [panel.get_title() for panel in figure.axes if panel.get_visible()]
    assert titles == ["rubber: bending y", "rubber: extension", "wire: bending y", "lattice: bending y"]
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert words == ["small strains", "material", "beyond its law"]


def test_linear_scene_has_no_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wire = ROOT / "examples" / "planar_strip.toml"
    with pytest.raises(SceneError, match="the scene has none"):
        plot_materials(read_scene(wire))
    monkeypatch.setattr(sys, "argv", ["cosserat", "check", str(wire), "--plot", str(tmp_path / "laws.png")])
    assert run(app) == REFUSED
    assert not list(tmp_path.iterdir())
    assert "the scene has none" in " ".join(capsys.readouterr().err.split())
