"""Waves of a sudden moment along a rod that only twists: how fast modes meet them, beside d'Alembert's solution."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from cosserat_casadi import Motion, build, discretise, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.trajectory import MotionOutcome
from tests.families import mostly_slow
from tests.motion import transients

DURATION = 8.0
"""Two periods: a wave passes the rod, of length and speed one, in a unit of time."""

TIMES = np.linspace(0.0, DURATION, 1601)


def twisted(tolerance: float) -> transients.Table:
    """A clamped rod without damping under a moment of one about its axis, all there from t = 0 on."""
    rod = {
        "strain": ["torsion"],
        "stiffness": {"torsion": 1.0},
        "rotary_inertia": [1.0, 1.0, 1.0],
    }
    asked = {"duration": DURATION, "start": "unloaded", "tolerance": tolerance, "times": TIMES.tolist()}
    return transients.table(rod, transients.at_tip(moment=[1.0, 0.0, 0.0]), simulation=asked)


def turns_missed(motion: Motion) -> FloatArray:
    """Errors of the tip's turn at TIMES, on the arm of a tolerance: it rises to 2 and falls to 0 within 2 each, rad."""
    w, x, y, z = motion.tip().quaternion.T
    start = motion.tip().quaternion[0]
    along = np.stack([w, x, y, z]).T @ start
    across = np.sqrt(np.maximum(0.0, 1.0 - along**2))
    turn = 2.0 * np.arctan2(across, along)
    exact = 2.0 - np.abs(np.mod(TIMES, 4.0) - 2.0)
    return np.asarray(LEVER * np.abs(turn - exact))


def on_elements(elements: int, modes: int) -> Motion:
    """The motion on so many modes in each of some equal elements, with next to no error of the steps."""
    scene = scene_from_dict(twisted(1e-5)).with_motion_inputs()
    ends = tuple(float(end) for end in np.linspace(0.0, 1.0, elements + 1))
    chosen = {name: replace(one, breaks=ends) for name, one in discretise(scene, modes, modes + 2).items()}
    return simulate(build(scene, chosen, moving=True))


@pytest.mark.parametrize(
    ("elements", "finest"),
    mostly_slow([(1, 16), (2, 16), (4, 16), (1, 32), (2, 32), (4, 32)], quick=[(1, 16), (4, 16)]),
)
def test_the_turn_at_a_front_is_met_with_the_first_power_of_the_modes(elements: int, finest: int) -> None:
    """On any elements: the least power is that of the kink, and between fronts errors fall faster."""
    coarse, fine = (turns_missed(on_elements(elements, modes // elements)) for modes in (8, finest))
    finer = np.log(finest / 8)
    assert 0.8 < np.log(coarse.max() / fine.max()) / finer < 2.0
    assert np.log(np.median(coarse) / np.median(fine)) / finer > 1.2
    # Kinks are at the multiples of two.
    worst = TIMES[fine.argmax()]
    assert abs(worst - 2.0 * np.round(worst / 2.0)) < 0.1


@pytest.mark.parametrize("tolerance", mostly_slow([1e-2, 3e-3], quick=[1e-2]))
def test_estimate_of_waves_with_fronts_is_from_above(tolerance: float) -> None:
    """By the distance of two motions alone 8.8e-4 was told of an error of 1.8e-3: kinks of both err at other times."""
    motion = simulate(scene_from_dict(twisted(tolerance)))
    assert motion.converged, motion.message
    assert turns_missed(motion).max() < motion.error_estimate < tolerance


def test_a_tolerance_out_of_reach_is_told_before_the_most_modes() -> None:
    """With about as many modes as it would take: the error is 0.06 over their number."""
    motion = simulate(scene_from_dict(twisted(1e-3)))
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert turns_missed(motion).max() < motion.error_estimate
    assert motion.model.discretisation["rod"].modes == (28,)
    (modes,) = [int(number) for number in re.findall(r"about (\d+) modes", motion.message)]
    needed = 0.06 / 1e-3
    assert needed < modes < 2 * needed
