"""Catalogue (a) – (c): elastica, follower load, roll-up, the helical form, from cold starts."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.catalogue import cases
from tests.catalogue.checks import initial_value_error, solved
from tests.reference.closed_forms import elastica, roll_up


@pytest.mark.parametrize("load", [50.0, 100.0])
def test_elastica_under_a_strong_force_vs_elliptic_integrals(load: float) -> None:
    shortening, across, angle = elastica(load)
    tip = solved(cases.table({}, cases.tip([load, 0, 0]))).tip()
    assert_allclose(tip.position, [across, 0, 1 - shortening], rtol=0, atol=1e-8)
    assert_allclose(tip.rotation[:, 2], [np.sin(angle), 0, np.cos(angle)], rtol=0, atol=1e-8)


@pytest.mark.parametrize("load", [20.0, 40.0])
def test_follower_force_vs_pendulum(load: float) -> None:
    tip = solved(cases.table({}, cases.tip([load, 0, 0], frame="body"))).tip()
    across, along = cases.follower_cantilever(load)
    assert_allclose(tip.position, [across, 0, along], rtol=0, atol=1e-8)


@pytest.mark.parametrize("turns", [5, 12])
def test_roll_up_into_many_circles(turns: int) -> None:
    """Two circles are in test_independent.py."""
    tip = solved(cases.table(cases.round_rod(1.0), cases.tip(moment=[0, 2 * np.pi * turns, 0]))).tip()
    position, rotation = roll_up(turns)
    assert_allclose(tip.position, position, rtol=0, atol=1e-8)
    assert_allclose(tip.rotation, rotation, rtol=0, atol=1e-8)


def test_two_turns_of_the_helical_form_vs_initial_value() -> None:
    assert initial_value_error(solved(cases.helical_form(0.2), 1e-8)) < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_helical_form_vs_initial_value(share: float) -> None:
    """Ten turns at share 1."""
    assert initial_value_error(solved(cases.helical_form(share), 1e-9)) < 1e-8
