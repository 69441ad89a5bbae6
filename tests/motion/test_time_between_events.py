"""The time over which errors of velocity act while rods touch: of the rod and its weight, not of the film."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, modes_of, parse_scene
from cosserat_casadi.motion.time_between_events import SWINGS, time_between_events

ROD = """
schema = 1
accuracy = { modes = 8, nodes = 18 }
[[rods]]
name = "rod"
length = 0.4
strain = "planar"
stiffness = { bending_y = 0.02 }
linear_density = 0.2
rotary_inertia = [1e-12, 1e-12, 2e-12]
"""

WEIGHT = '[[loads]]\nname = "weight"\nkind = "gravity"\nacceleration = [0, 0, -9.81]\n'


def test_it_is_some_periods_of_the_slowest_mode_of_a_clamped_rod() -> None:
    """Against the frequency that vibration modes have, whose equations are others."""
    scene = parse_scene(ROD)
    (mode,) = modes_of(scene, count=1).modes
    model = build(scene, moving=True)
    for duration in (10.0, 1000.0):
        assert_allclose(time_between_events(model, duration), SWINGS / mode.frequency, rtol=1e-6, atol=0)


def test_of_a_stiff_rod_it_is_some_falls_over_its_length() -> None:
    model = build(parse_scene(ROD.replace("0.02", "2e3") + WEIGHT), moving=True)
    assert_allclose(time_between_events(model, 10.0), SWINGS * np.sqrt(2.0 * 0.4 / 9.81), rtol=1e-12, atol=0)


@pytest.mark.parametrize("weight", ["", WEIGHT])
def test_it_is_no_longer_than_the_motion(weight: str) -> None:
    model = build(parse_scene(ROD + weight), moving=True)
    assert time_between_events(model, 0.1) == 0.1


def test_what_a_rod_carries_swings_with_it_and_without_mass_the_motion_is_all_there_is() -> None:
    body = '[[bodies]]\nname = "head"\nmass = 10.0\ninertia = [1e-9, 1e-9, 1e-9]\n'
    body += '[[joints]]\nbody = "head"\nrod = "rod"\nkind = "fixed"\n'
    scene = parse_scene(ROD + body)
    (mode,) = modes_of(scene, count=1).modes
    # A heavy body swings at 3 EI/(m L³); Rayleigh's share has 12.36 · 33/140 = 2.91 in the place of 3.
    assert_allclose(time_between_events(build(scene, moving=True), 1e6), SWINGS / mode.frequency, rtol=2e-2, atol=0)
    without = "\n".join(line for line in ROD.splitlines() if "density" not in line and "inertia" not in line)
    assert time_between_events(build(parse_scene(without)), 7.0) == 7.0


def test_numbers_of_parameters_count_and_not_those_of_the_file() -> None:
    """A tenth of the stiffness, half as long again: as a scene written so."""
    named = parse_scene('parameters = ["rod.stiffness.bending_y", "rod.length"]\n' + ROD)
    moved = build(named, moving=True).at({"rod.stiffness.bending_y": 0.002, "rod.length": 0.6})
    written = build(parse_scene(ROD.replace("0.02", "0.002").replace("0.4", "0.6")), moving=True)
    times = [time_between_events(model, 1e3) for model in (moved, written)]
    assert_allclose(times[0], times[1], rtol=1e-12, atol=0)
