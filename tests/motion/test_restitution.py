"""Impacts that rebound: Newton's law of restitution, the energy that a blow takes, and rest after many bounces."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, parse_scene, simulate
from cosserat_casadi.motion.trajectory import Motion
from tests.motion.test_exact_contact_in_motion import BALL, moving, rod

SHARE = 0.6


def struck(share: float, duration: float = 0.15) -> Motion:
    text = rod(f"{BALL}, restitution = {share}", duration=duration).replace("1e-4", "1e-3")
    motion = simulate(moving(text))
    assert motion.converged, motion.message
    return motion


def test_the_first_blow_takes_what_the_closed_form_says() -> None:
    """Of the energy that a blow without rebound takes, 1 − e² is lost; its impulse is 1 + e times as large."""
    dead, elastic = struck(0.0), struck(SHARE)
    first, rebound = dead.events[0], elastic.events[0]
    assert first.kind == rebound.kind == "impact"
    assert "float64" not in repr(first)
    assert_allclose(rebound.time, first.time, rtol=1e-5, atol=0)
    assert_allclose(rebound.energy / first.energy, 1.0 - SHARE**2, rtol=1e-3, atol=0)
    assert_allclose(rebound.impulse / first.impulse, 1.0 + SHARE, rtol=1e-3, atol=0)
    assert_allclose(elastic.energy.impacts[-1], sum(event.energy for event in elastic.events), rtol=1e-3, atol=0)
    assert np.abs(elastic.energy.imbalance).max() < 1e-3


@pytest.mark.slow
def test_nothing_is_lost_in_elastic_blows() -> None:
    motion = struck(1.0)
    assert motion.events
    assert_allclose(motion.energy.impacts[-1], 0.0, rtol=0, atol=1e-9)
    assert np.abs(motion.energy.imbalance).max() < 1e-3


def test_smooth_contact_has_no_restitution() -> None:
    with pytest.raises(SceneError, match="describes impacts"):
        parse_scene(rod(f"{BALL}, restitution = 0.5, width = 1e-3"))
