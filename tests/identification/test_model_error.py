"""The error of the model at what was measured: the largest of the cases, in the answer, its file and the report."""

from __future__ import annotations

from io import StringIO
from typing import Any

import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from cosserat_casadi import Identification, build, identify, solve
from cosserat_casadi.cli.reports.identification import print_identification
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import WIRE, MadeUp


def found_with(shapes: MadeUp, **accuracy: Any) -> Identification:
    scene = scene_from_dict({**WIRE, "accuracy": accuracy})
    return identify(build(scene.with_unknowns()), shapes.data)


@pytest.fixture(scope="module")
def coarse(shapes: MadeUp) -> Identification:
    return found_with(shapes, modes=2, nodes=6, tolerance=1e-4)


def printed(found: Identification) -> str:
    out = StringIO()
    print_identification(Console(file=out, width=200), found, [])
    return out.getvalue()


@pytest.mark.slow
def test_the_error_is_the_largest_of_solves_at_what_was_found(coarse: Identification) -> None:
    model = coarse.model.at(coarse.parameters)
    errors = {}
    for where, inputs in zip(coarse.cases, coarse.inputs, strict=True):
        errors[where] = solve(model, inputs).error_estimate
    worst = max(errors, key=lambda where: errors[where] or 0.0)
    assert_allclose(coarse.error_estimate, errors[worst], rtol=1e-6, atol=0)
    assert coarse.error_case == worst


def test_an_error_above_the_tolerance_is_told(coarse: Identification) -> None:
    assert coarse.converged
    assert coarse.error_estimate is not None
    assert coarse.error_estimate > 1e-4
    assert coarse.within_tolerance is False
    (warning,) = [text for text in coarse.warnings if text.startswith("The model itself may be off by")]
    assert f"in {coarse.error_case}, where the tolerance is 0.0001" in warning
    assert "cosserat tune" in warning
    told = coarse.to_dict()
    assert told["within_tolerance"] is False
    assert told["error_estimate"] == coarse.error_estimate
    assert "above the tolerance of 0.0001 (shapes.csv, line" in printed(coarse)


def test_an_error_within_the_tolerance_is_no_warning(shapes: MadeUp) -> None:
    fine = found_with(shapes, modes=4, nodes=10, tolerance=1e-4)
    assert fine.within_tolerance
    assert not any("The model itself" in text for text in fine.warnings)
    assert "within the tolerance of 0.0001" in printed(fine)


def test_a_tolerance_that_nobody_wrote_asks_nothing_of_fixed_modes(shapes: MadeUp) -> None:
    found = found_with(shapes, modes=2, nodes=6)
    assert found.error_estimate is not None
    assert found.within_tolerance is None
    assert not any("The model itself" in text for text in found.warnings)


@pytest.mark.slow
def test_modes_that_were_chosen_are_judged_by_the_scene_s_tolerance(shapes: MadeUp) -> None:
    """Also by one that the scene leaves at its default."""
    tables = {name: table for name, table in WIRE.items() if name != "accuracy"}
    found = identify(scene_from_dict(tables), shapes.data)
    assert found.within_tolerance is not None
