"""Load cases: columns, refusals, points that cover a box."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.load_cases import CaseLayout, column_indices, spread
from tests.scenes import WIND, push, scene


@pytest.fixture
def layout() -> InputLayout:
    return input_layout(scene(push(force=[1.0, 2.0, 3.0]), {**WIND, "force": [0.0, [0.5, 0.25], 0.0]}))


def test_columns_are_named_in_the_order_of_the_inputs(layout: InputLayout) -> None:
    places = column_indices(layout)
    assert list(places.values()) == list(range(layout.size))
    assert list(places)[:3] == ["push.force.x", "push.force.y", "push.force.z"]
    stacked = layout.pack({"wind.force": [[0.0, 0.0], [0.7, 0.9], [0.0, 0.0]]})
    assert stacked[places["wind.force.y"]] == 0.7
    assert stacked[places["wind.force.y.1"]] == 0.9


def test_points_cover_the_box_evenly(layout: InputLayout) -> None:
    """Every cell of a 4×4 grid over two ranges holds its share of 160 points, within a third."""
    cases = spread(["push.force.x=-1:1", "push.force.z=2:6"], 160, CaseLayout(layout))
    places = column_indices(layout)
    x, z = cases[:, places["push.force.x"]], cases[:, places["push.force.z"]]
    assert_allclose([x[0], z[0]], [1.0, 6.0], rtol=0, atol=0)
    assert x.min() >= -1.0
    assert z.max() <= 6.0
    counts, _, _ = np.histogram2d(x, z, bins=4, range=[[-1, 1], [2, 6]])
    assert counts.min() >= 7
    assert counts.max() <= 13
    assert_allclose(cases[:, places["push.force.y"]], 2.0, rtol=0, atol=0)


def test_every_fault_of_ranges_is_named(layout: InputLayout) -> None:
    with pytest.raises(SceneError) as refused:
        spread(["pull.force.x=0:1", "push.force.x=0", "push.force.y=0:inf"], 3, CaseLayout(layout))
    assert len(refused.value.problems) == 3
