"""Loads of rods that touch a floor exactly, from places of markers that an independent solver gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.codegen.estimator import Knowledge
from cosserat_casadi.estimation.estimate import estimate
from cosserat_casadi.estimation.estimate_outcome import Estimate
from cosserat_casadi.estimation.rows_in_contact import RowsInContact
from cosserat_casadi.estimation.stacking import sections_of, stacked
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.numerics.arrow_least_squares import Limits
from tests.identification.over_floor import MARKERS, MODULUS, WEIGHTS, markers, tables


def estimated(cases: Sequence[int] = (0, 1, 2), **more: Any) -> Estimate:
    """The weight of some rows, where every search begins with the tip just off the floor."""
    weight = {"input": "weight.force.z", "per_row": True, "lower": -0.5, "upper": 0.1}
    unknowns = [weight | {"prior": {"mean": -0.012, "sigma": 0.1}}]
    scene = scene_from_dict({**tables(MODULUS, -0.012), "measurements": [MARKERS], "unknowns": unknowns, **more})
    columns = markers()["markers.csv"]
    chosen = np.isin(columns["case"], cases)
    data = {name: column[chosen] for name, column in columns.items() if name != "weight"}
    return estimate(build(scene.with_unknowns()), {"markers.csv": data})


@pytest.mark.slow
def test_weights_are_found_whether_rods_hang_touch_or_lie() -> None:
    found = estimated()
    assert found.found.all(), found.outcomes
    away = (found.values[:, 0] - WEIGHTS) / found.sigma[:, 0]
    assert np.abs(away).max() < 2.5
    # A rod that lies is told by less than one that hangs: the floor holds most of it.
    assert np.all(found.sigma[:, 0] < 0.04 * np.abs(WEIGHTS))
    # Squares of 27 differences and 3 priors less 3 unknowns, a chi-squared number.
    assert 12.0 < found.consistency.squares < 48.0


@pytest.mark.slow
def test_draws_are_as_wide_as_the_linear_model_where_contacts_stay() -> None:
    drawn = estimated([1], estimation={"draws": 20})
    linear = estimated([1])
    np.testing.assert_allclose(drawn.sigma, linear.sigma, rtol=0.15, atol=0)
    np.testing.assert_allclose(drawn.values, linear.values, rtol=1e-12, atol=0)


@pytest.mark.slow
def test_contacts_that_change_within_a_deviation_are_named() -> None:
    weight = {"input": "weight.force.z", "per_row": True, "lower": -0.5, "upper": 0.1}
    unknowns = [weight | {"prior": {"mean": -0.012, "sigma": 0.1}}]
    scene = scene_from_dict({**tables(MODULUS, -0.012), "measurements": [MARKERS], "unknowns": unknowns})
    model = build(scene.with_unknowns())
    cases = read_cases(model.scene, model.inputs, markers())
    sections = sections_of(model, cases)
    rows = RowsInContact(model, sections, [model.inputs.slices["weight.force"].stop - 1])
    table = stacked(model, cases, sections)
    narrow, wide = ([[sigma**2]] for sigma in (1e-5, 5e-3))
    numbers, covariance = np.array([[-0.006], [np.nan], [-0.014]]), np.array([narrow, wide, wide])
    limits = Limits(*(np.array([number]) for number in (-0.5, 0.1, 0.0, 0.0)), ratios=np.zeros(1, dtype=bool))
    known = Knowledge(limits, np.ones(1))
    assert rows.contact_changes(table, numbers, covariance, known) == {2: "a point of 'rod' on 'floor'"}
    # Within bounds that are nearer than a deviation contacts stay.
    bounded = replace(known, limits=replace(limits, lower=np.array([-0.0141]), upper=np.array([-0.0139])))
    assert rows.contact_changes(table, numbers[[1, 1, 2]], covariance, bounded) == {}
