"""A published robot of two sections and twenty disks: the model of its authors, integrated from tip to base.

P. Rao, Q. Peyron, S. Lilge and J. Burgner-Kahrs, Front. Robot. AI 7 (2021) 630245: a Cosserat rod between each two
disks, and pulls of straight tendons on the disks. Of the force on a disk that a tendon runs through they leave out the
component normal to the disk, which is small. Numbers of the robot are those of their program
(github.com/SvenLilge/tdcr-modeling).
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import build, read_scene, solve
from cosserat_casadi.maths.typing import FloatArray
from tests.conftest import ROOT
from tests.reference.rods import hat

YOUNGS_MODULUS = 54e9
POISSON_RATIO = 0.3
RADIUS = 0.7e-3
ARM = 10e-3
SECTION = 0.2
DISKS = 10
ANGLES = np.tile([np.pi / 2, -np.pi / 6, 7 * np.pi / 6], 2)
HOLES = ARM * np.stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(6)], axis=1)
LAST = np.repeat([DISKS, 2 * DISKS], 3)

SHEAR_MODULUS = YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO))
AREA = np.pi * RADIUS**2
SECOND_MOMENT = np.pi * RADIUS**4 / 4
BENDING = YOUNGS_MODULUS * SECOND_MOMENT
TORSION = 2 * SHEAR_MODULUS * SECOND_MOMENT
COMPLIANCE = 1 / np.array([BENDING, BENDING, TORSION, *AREA * np.array([SHEAR_MODULUS, SHEAR_MODULUS, YOUNGS_MODULUS])])
ITERATIONS = 30


def disk_before(force: FloatArray, moment: FloatArray, *, rigid: bool) -> tuple[FloatArray, FloatArray]:
    """Place and orientation of the disk before one, in its axes, from the wrench in the rod that comes to it.

    Where it is rigid the rod bends and twists alone.
    """

    def rates(_: float, state: FloatArray) -> FloatArray:
        place, turned = state[:3], state[3:].reshape(3, 3)
        bent = COMPLIANCE[:3] * (turned.T @ (moment - np.cross(place, force)))
        stretched = (0 if rigid else COMPLIANCE[3:]) * (turned.T @ force) + [0, 0, 1]
        return np.concatenate([turned @ stretched, (turned @ hat(bent)).ravel()])

    start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    end = solve_ivp(rates, (0, -SECTION / DISKS), start, "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    return end[:3], end[3:].reshape(3, 3)


def published(tensions: FloatArray, *, without_normal: bool, rigid: bool = False) -> FloatArray:
    """Tip of the robot as the base sees it, from disk to disk: the pulls on each hang on where the one before is.

    They hang on it weakly: each iteration takes some 25 times the error.
    """
    force, moment = np.zeros(3), np.zeros(3)
    place, turned = np.zeros(3), np.eye(3)
    after: FloatArray | None = None
    for disk in range(2 * DISKS, 0, -1):

        def pulls(holes_before: FloatArray, disk: int = disk, after: FloatArray | None = after) -> FloatArray:
            total = np.zeros((2, 3))
            for tension, hole, before, last, number in zip(tensions, HOLES, holes_before, LAST, range(6), strict=True):
                if disk > last:
                    continue
                pull = tension * (before - hole) / np.linalg.norm(before - hole)
                if disk < last:
                    assert after is not None
                    pull = pull + tension * (after[number] - hole) / np.linalg.norm(after[number] - hole)
                    pull = pull * [1, 1, 0] if without_normal else pull
                total += [pull, np.cross(hole, pull)]
            return total

        beyond = np.stack([force, moment])
        there, axes = np.array([0.0, 0.0, -SECTION / DISKS]), np.eye(3)
        for _ in range(ITERATIONS):
            force, moment = beyond + pulls(HOLES @ axes.T + there)
            moved, there, axes = (there, *disk_before(force, moment, rigid=rigid))
            if np.abs(moved - there).max() < 1e-15:
                break
        # All in the axes of the disk before from here on.
        force, moment = axes.T @ force, axes.T @ (moment - np.cross(there, force))
        after = (HOLES - there) @ axes
        place, turned = place + turned @ there, turned @ axes
    return -turned.T @ place


def tip(tensions: FloatArray, strain: str) -> FloatArray:
    """Of the robot of our example, m."""
    file = ROOT / "examples" / "disk_robot.toml"
    names = [actuator.name for actuator in read_scene(file).actuators]
    settings = [f"{name}.tension={tension}" for name, tension in zip(names, tensions, strict=True)]
    settings += [f'backbone.strain="{strain}"', "accuracy.modes=3", "accuracy.nodes=5"]
    solution = solve(build(read_scene(file, settings)))
    assert solution.converged, solution.message
    return np.asarray(solution.tip().position)


@pytest.mark.slow
@pytest.mark.parametrize(
    "tensions",
    [[4.0, 0, 0, 0, 2, 0], [2.0, 0, 0, 0, 1, 0], [8.0, 0, 0, 0, 0, 0]],
)
def test_two_sections_that_bend_and_twist(tensions: list[float]) -> None:
    """To 1e-7 of the length where shear and stretch are left out; with them, and their forces on disks, to 5e-4."""
    found = tip(np.array(tensions), "kirchhoff")
    same = published(np.array(tensions), without_normal=False, rigid=True)
    assert_allclose(found, same, rtol=0, atol=1e-7 * 2 * SECTION)
    theirs = published(np.array(tensions), without_normal=True)
    assert_allclose(found, theirs, rtol=0, atol=5e-4 * 2 * SECTION)


@pytest.mark.slow
def test_two_sections_that_shear_and_stretch_too() -> None:
    tensions = np.array([4.0, 0, 0, 0, 2, 0])
    assert_allclose(
        tip(tensions, "reissner"), published(tensions, without_normal=False), rtol=0, atol=1e-7 * 2 * SECTION
    )
