"""A twisted rod under tension: it buckles to one loop, which touches itself and winds up to a plectoneme.

The loop is that of an infinite rod, the plectoneme two helices that press each other: EI = L = 1. The rod is stiff in
torsion, so that it winds up as its base is turned and does not snap.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from cosserat_casadi import build, discretise, follow, scene_from_dict
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.paths.equilibrium_path import EquilibriumPath

RADIUS, WIDTH, TENSION, TORSION = 0.02, 8e-3, 256.6, 25.0

SETTINGS = ArcSettings(longest=2.0)
"""A rod that is wound up bends by tens of radians: steps of a quarter would be hundreds."""


def wound(angle: float, modes: int, *, touches: bool) -> EquilibriumPath:
    """A rod whose base is turned about its axis, while its tip slides along that and is pulled.

    Args:
        angle: of the base at the end, rad.
        modes: polynomials per strain and element.
        touches: whether it touches itself.
    """
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 4 / np.pi / RADIUS**4, "poisson_ratio": 1 / TORSION - 1},
        "section": {"shape": "circle", "radius": RADIUS},
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
    }
    turn = {"kind": "revolute", "name": "turn", "rod": "rod", "at": 0, "axis": [1, 0, 0], "angle": 0.0}
    slide = {"kind": "prismatic", "rod": "rod", "position": [1, 0, 0], "tangent": [1, 0, 0], "axis": [1, 0, 0]}
    pull = {"kind": "tip_wrench", "name": "pull", "rod": "rod", "force": [TENSION, 0, 0]}
    # It says where the rod buckles to.
    push = {"kind": "point_wrench", "name": "push", "rod": "rod", "at": 0.5, "force": [0, 0, 2e-3 * TENSION]}
    touch = {"rods": ["rod"], "width": WIDTH, "stiffness": 1e7}
    tables = {"schema": 1, "rods": [rod], "joints": [turn, slide], "loads": [pull, push]}
    scene = scene_from_dict(tables | ({"rod_contacts": [touch]} if touches else {}))
    path = follow(build(scene, discretise(scene, modes)), "turn.angle", angle, settings=SETTINGS)
    assert path.converged, path.message
    return path


def test_a_loop_of_a_twisted_rod_is_that_of_an_infinite_one() -> None:
    """J. Coyne, IEEE J. Oceanic Eng. 15 (1990) 72: end shortening and angle by the torque M = 2m √(EI T).

    They are 4 √(EI/T) √(1 − m²) and M L/GJ + 4 arccos m: a long rod would buckle at m = 1 (Greenhill).
    """
    path = wound(5.5, 8, touches=False)
    angles = 5.5 * path.factor
    rows = np.flatnonzero(angles > 3.8)[::2]
    assert len(rows) > 4
    torques = np.array([path.solution(row).base_wrench().moment[0] for row in rows])
    shares = torques / (2 * np.sqrt(TENSION))
    assert shares.min() < 0.4 < 0.7 < shares.max()
    shortening = 1.0 - path.position(1.0)[rows, 0]
    assert_allclose(shortening, 4 / np.sqrt(TENSION) * np.sqrt(1 - shares**2), rtol=3e-3, atol=0)
    assert_allclose(angles[rows], torques / TORSION + 4 * np.arccos(shares), rtol=0, atol=1e-2)


@pytest.mark.slow
def test_a_twisted_rod_winds_up_to_a_plectoneme() -> None:
    """N. Clauvelin, B. Audoly, S. Neukirch, Macromolecules 41 (2008) 4479, without what repels and without ends.

    Two helices of the radius R and the angle α to their axis have the energy EI sin⁴α/(2R²) per length of rod. Where a
    tension T and a torque M hold them, T = EI/R² sin⁴α (1/2 + 1/cos 2α) and M = 2 EI/R cos α sin³α/cos 2α, and the tip
    comes nearer by 2R/sin 2α for a radian of the base.
    """
    path = wound(11.5, 6, touches=True)
    angles = 11.5 * path.factor
    (contact,) = path.solution(-1).contacts
    assert contact.gap is not None and 0.0 < contact.gap < WIDTH
    radius = RADIUS + contact.gap / 2

    def excess(alpha: float) -> float:
        return float(np.sin(alpha) ** 4 * (0.5 + 1 / np.cos(2 * alpha)) / radius**2 - TENSION)

    alpha = brentq(excess, 0.1, 0.75)
    rows = np.flatnonzero(angles > 10.0)
    slope, _ = np.polyfit(angles[rows], path.position(1.0)[rows, 0], 1)
    assert_allclose(slope, -2 * radius / np.sin(2 * alpha), rtol=1e-2, atol=0)
    torque = path.solution(-1).base_wrench().moment[0]
    assert_allclose(torque, 2 / radius * np.cos(alpha) * np.sin(alpha) ** 3 / np.cos(2 * alpha), rtol=5e-2, atol=0)
