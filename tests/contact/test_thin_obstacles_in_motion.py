"""Motions of rods and bodies through thin smooth obstacles: what was computed so is told, and no fit ends there."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import Motion, MotionOutcome, build, identify, parse_scene, simulate

ROD = """
schema = 1
accuracy = { modes = 3, nodes = 12 }
simulation = { duration = 6.0, start = "unloaded", tolerance = 3e-2 }
[[rods]]
name = "rod"
length = 0.3
strain = "planar"
base = { tangent = [1, 0, 0] }
stiffness = { bending_y = 2e-3 }
damping = { bending_y = 4e-4 }
linear_density = 0.03
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""

WIRE = """
[[obstacles]]
name = "wire"
kind = "capsule"
from = [{x}, -0.1, -0.03]
to = [{x}, 0.1, -0.03]
radius = {radius}
width = {width}
"""

BEAD = """
[[obstacles]]
name = "bead"
kind = "sphere"
centre = [0.298, 0, -0.03]
radius = 1e-3
width = 9e-4
bodies = ["ball"]
[[bodies]]
name = "ball"
mass = 0.002
radius = 1e-3
[[joints]]
body = "ball"
rod = "rod"
kind = "fixed"
"""


def moved(*more: str) -> Motion:
    return simulate(build(parse_scene(ROD + "".join(more)), moving=True))


THIN = WIRE.format(x=0.2, radius=5e-4, width=4e-4)


@pytest.mark.parametrize("obstacle", [THIN, THIN + "stiffness = 50.0\n", BEAD], ids=["stiff", "soft", "bead"])
def test_what_falls_through_a_thin_obstacle_between_two_rows_is_told(obstacle: str) -> None:
    """In 15 ms, the time between two states that are watched, the rod is past it; long steps miss a stiff one."""
    motion = moved(obstacle)
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert "passes through an obstacle" in motion.message
    assert "more modes" not in motion.message and "allow more" not in motion.message
    assert motion.tip().position[-1, 2] < -0.1


def test_what_falls_beside_a_thin_obstacle_is_computed_to_its_end() -> None:
    motion = moved(WIRE.format(x=0.31, radius=5e-4, width=4e-4))
    assert motion.converged, motion.message
    assert motion.tip().position[-1, 2] < -0.1


def test_what_a_bar_catches_is_computed_to_its_end() -> None:
    motion = moved(WIRE.format(x=0.2, radius=5e-3, width=4e-3), "damping = 0.3\n")
    assert motion.converged, motion.message
    assert np.all(motion.tip().position[:, 2] > -0.1)


MEASURED = """
[[measurements]]
name = "tip"
quantity = "position"
file = "tip.csv"
time = "t"
rod = "rod"
columns = ["x", "y", "z"]
sigma = 1e-3
[[unknowns]]
parameter = "rod.stiffness.bending_y"
lower = 1e-3
upper = 4e-3
"""


SOFT = THIN + "stiffness = 1.0\n"


@pytest.mark.parametrize(("obstacle", "outcome"), [("", "converged"), (SOFT, "unresolved")], ids=["free", "wire"])
def test_a_fit_of_a_motion_through_a_wire_is_not_found(obstacle: str, outcome: str) -> None:
    """The tip of a rod that falls freely was measured: that of the scene falls through a wire that is too soft."""
    falls = moved()
    rows = np.flatnonzero(falls.times <= 0.19)
    places = falls.tip().position[rows].T
    data = {"t": falls.times[rows], **dict(zip("xyz", places, strict=True))}
    scene = parse_scene(ROD + obstacle + MEASURED, ["simulation.step=0.015"])
    found = identify(build(scene.with_unknowns()), {"tip.csv": data})
    assert found.outcome == outcome, found.message
    assert ("passes through an obstacle" in found.message) == (outcome == "unresolved")
