"""Ranges of inputs in exported folders, in C and in Python, by what inputs are and by the bounds of the scene."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError
from tests.codegen.libraries import TENDON, Exported, Recipe
from tests.scenes import push, scene

BOUNDS = [
    {"input": "push.force", "lower": [-1.0, -0.5, 0.0], "upper": 2.0},
    {"input": "pull.tension", "upper": 5.0},
]


@pytest.fixture(scope="module")
def made(export_recipe: Callable[..., Exported]) -> Exported:
    """A rod with a bounded force, a tendon bounded above, and a moment that nothing bounds."""
    loads = push(force=[0.5, 0.2, 0.1], moment=[0.1, 0.0, 0.0])
    wanted = scene(loads, strain="planar", actuators=[TENDON], inputs=None, bounds=BOUNDS)
    return export_recipe("bounded", Recipe(wanted, 2, 4), estimates=False)


def in_c(made: Exported, inputs: np.ndarray) -> tuple[bool, int, np.ndarray]:
    """Whether inputs are in range, how many are moved, and where to."""
    moved = np.array(inputs, dtype=float)
    pointer = moved.ctypes.data_as(ctypes.c_void_p)
    inside = bool(made.handle.bounded_in_range(pointer))
    count = int(made.handle.bounded_clamp(pointer))
    return inside, count, moved


@pytest.mark.parametrize(
    ("changes", "clamped"),
    [
        ({}, {}),
        ({"push.force": [-1.0, 2.0, 0.0]}, {}),
        ({"push.force": [-1.1, 2.1, 0.0]}, {"push.force": [-1.0, 2.0, 0.0]}),
        ({"push.force": [1e300, -np.inf, -1e-9]}, {"push.force": [2.0, -0.5, 0.0]}),
        ({"push.moment": [1e6, -1e6, 0.0]}, {}),
        ({"pull.tension": -1e-6}, {"pull.tension": 0.0}),
        ({"pull.tension": 6.0}, {"pull.tension": 5.0}),
    ],
)
def test_ranges_in_c_and_in_python(made: Exported, changes: dict[str, object], clamped: dict[str, object]) -> None:
    """A tension is not below zero though the scene bounds it above alone; what nothing bounds is in range."""
    slices = made.model.inputs.slices
    inputs, wanted = (made.model.pack() for _ in range(2))
    for name, value in changes.items():
        inputs[slices[name]] = wanted[slices[name]] = value
    for name, value in clamped.items():
        wanted[slices[name]] = value
    inside, count, moved = in_c(made, inputs)
    assert inside == made.compiled.in_range(inputs) == (not clamped)
    assert count == np.count_nonzero(inputs != wanted)
    assert_array_equal(moved, wanted)
    assert_array_equal(made.compiled.clamp(inputs), wanted)


def test_what_is_no_number_is_in_no_range_and_stays(made: Exported) -> None:
    inputs = made.model.pack()
    inputs[0] = np.nan
    inside, count, moved = in_c(made, inputs)
    assert not inside
    assert not made.compiled.in_range(inputs)
    assert count == 0
    assert np.isnan(moved[0])
    assert np.isnan(made.compiled.clamp(inputs)[0])


def test_ranges_by_name(made: Exported) -> None:
    assert made.compiled.in_range({"pull.tension": 5.0})
    assert not made.compiled.in_range({"pull.tension": 5.1})
    with pytest.raises(SceneError, match="is not an input"):
        made.compiled.in_range({"pull.length": 0.1})
