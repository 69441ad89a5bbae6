"""What a figure makes of kinds that it has no drawing for, and of more categories than it has colours."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from cosserat_casadi import Solution, build, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.colours import CATEGORIES, CATEGORY_MARKERS, category_style
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.plots.scenery import ACTUATOR_STYLES
from cosserat_casadi.plots.sweep_plot import plot_sweep
from cosserat_casadi.sweeps.outcome_table import LABELS
from tests.plots.test_colours import linear_rgb
from tests.plots.test_plot import swept
from tests.scenes import HOOK, WEIGHT, WIND, push, scene

CABLE = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 0.3, "offset": [0.01, 0.0]}


@pytest.fixture(scope="module")
def loaded() -> Solution:
    return solve(build(scene(push(), WEIGHT, HOOK, WIND, strain="kirchhoff", actuators=[CABLE])))


def test_the_routing_of_a_tendon_is_drawn_with_its_end(loaded: Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = len(plot_solution(loaded).axes[0].get_lines())
    monkeypatch.setattr("cosserat_casadi.actuators.tendon.TendonActuator.drawn_as", "channel")
    # A channel has no end that is fixed to a section.
    assert len(plot_solution(loaded).axes[0].get_lines()) == drawn - 1


def test_every_known_actuator_is_drawn() -> None:
    from cosserat_casadi.actuators.actuator import Actuator
    from cosserat_casadi.model.registry import EFFECTS

    styles = {member.drawn_as for member in EFFECTS.values() if isinstance(member, Actuator)}
    assert styles == set(ACTUATOR_STYLES)


def test_as_many_outcomes_as_one_likes_have_a_style(monkeypatch: pytest.MonkeyPatch) -> None:
    labels = (*LABELS, *(f"outcome_{i}" for i in range(20)))
    monkeypatch.setattr("cosserat_casadi.plots.sweep_plot.LABELS", labels)
    sweep = swept(planar=True, failing=True)
    # Rows without a result stay failures.
    sweep.outcomes[1:38] = 1 + np.arange(37) % (len(labels) - 1)
    inputs = plot_sweep(sweep, "outcome").axes[1]
    assert len(inputs.collections) == len(set(sweep.outcomes.tolist())) > len(CATEGORIES)


def test_categories_differ_in_colour_or_marker() -> None:
    count = len(CATEGORIES) * len(CATEGORY_MARKERS)
    styles = [tuple(category_style(index).values()) for index in range(count)]
    assert len(set(styles)) == count
    assert category_style(count) == category_style(0)


# What dichromats see, in linear RGB: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes,
# IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291.
SEEN_BY = {
    "all cones": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def cielab(rgb: FloatArray) -> FloatArray:
    xyz_of_rgb = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(xyz_of_rgb @ rgb / xyz_of_rgb.sum(axis=1))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("sight", SEEN_BY)
def test_colours_of_categories_stay_apart(sight: str) -> None:
    """A distance of 2.3 in CIELAB is just noticeable; six times that is seen in a small dot."""
    seen = [cielab(np.clip(SEEN_BY[sight] @ linear_rgb(colour), 0.0, 1.0)) for colour in CATEGORIES]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 6 * 2.3
