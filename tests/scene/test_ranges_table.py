"""The table of ranges: what it refuses, how it is kept, and that it bounds inputs as [[bounds]] do."""

from __future__ import annotations

from typing import Any

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, parse_scene
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import WEIGHT, push, scene

REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "ends are equal": ({"push.force": [1, 1]}, "must have two different ends, got 1.0 twice"),
    "ends are reversed": ({"push.force": [1, -1]}, r"must have the lower end first, got \[1\.0, -1\.0\]"),
    "an end is not finite": ({"push.force": [0, float("inf")]}, "must be finite|finite number"),
    "it is of nothing": ({"pull.force": [0, 1]}, "is not free at run time .inputs and parameters: push.force"),
    "it is of what is fixed": ({"weight.acceleration": [0, 1]}, "is not free at run time"),
    "it has too few pairs": ({"push.force": [[0, 1], [0, 1]]}, "must have 1 pair or 3, got 2"),
    "it has one end": ({"push.force": [1]}, "must be a list of 2 numbers, low and high, got 1"),
    "it is a number": ({"push.force": 1}, "must be a list of 2 numbers, low and high, got 1"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_range_is_refused_where(case: str) -> None:
    ranges, sentence = REFUSED[case]
    with pytest.raises(SceneError, match=sentence) as refused:
        scene(push(), WEIGHT, inputs=["push.force"], ranges=ranges)
    assert len(refused.value.problems) == 1


def test_every_faulty_range_is_told_at_once() -> None:
    faulty = {"push.force": [1, 1], "pull.force": [0, 1]}
    with pytest.raises(SceneError) as refused:
        scene(push(), ranges=faulty)
    assert len(refused.value.problems) == 2


def test_ranges_are_written_as_they_were_read() -> None:
    ranges = {"push.force": [[-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.2]], "weight.acceleration": [-10, 10]}
    kept = scene(push(), WEIGHT, ranges=ranges)
    assert parse_scene(scene_text(kept)) == kept
    assert hash(kept) == hash(parse_scene(scene_text(kept)))


def test_ranges_narrow_what_inputs_may_be() -> None:
    """They feed what exported code clamps to, and a parameter's range concerns no input."""
    ranges = {"push.force": [[-0.5, 0.5], [-0.4, 0.4], [-0.3, 0.2]], "rod.length": [0.7, 0.9]}
    ranged = scene(push(), ranges=ranges, parameters=["rod.length"])
    lower, upper = ranges_of_inputs(ranged, input_layout(ranged))
    assert_allclose(lower, [-0.5, -0.4, -0.3], rtol=0, atol=0)
    assert_allclose(upper, [0.5, 0.4, 0.2], rtol=0, atol=0)
