"""Modes of beams on two pins, of stout beams, of one about to fall: closed forms, published and independent digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Modes, modes_of, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.constraint_rank import check_constraints
from tests.motion.transients import Table, gravity

HINGE = 1e-10
"""Stiffness of what stands for a hinge, N m²: that of beams is 1 and more."""

BENDING = ["bending_x", "bending_y"]
UNIT = {"bending_x": 1.0, "bending_y": 1.0}

SAGGED = [6.80994672, 26.7295817, 62.40945945]
"""Angular frequencies in the plane of a soft rod that hangs from the horizontal, 1/s."""


def beam(strain: str | list[str], stiffness: dict[str, float], **changes: Any) -> Table:
    return {"name": "beam", "length": 1.0, "strain": strain, "stiffness": stiffness, "linear_density": 1.0, **changes}


def scene(*rods: Table, tolerance: float = 1e-8, **more: Any) -> Table:
    return {"schema": 1, "accuracy": {"tolerance": tolerance}, "rods": list(rods), **more}


def hinged(length: float, **changes: Any) -> list[Table]:
    """A beam along z whose base turns freely about x and y: two stubs without mass that twist, one on the other."""
    stub = {"length": 0.1, "strain": ["torsion"], "stiffness": {"torsion": HINGE}}
    about_y = {**stub, "name": "about_y", "base": {"position": [0, -0.1, 0], "tangent": [0, 1, 0]}}
    # Its sections have their y axis along −z of the world, and so have those of the second stub.
    about_x = {**stub, "name": "about_x", "base": {"rod": "about_y", "position": [-0.1, 0, 0], "tangent": [1, 0, 0]}}
    carried = {"length": length, "base": {"rod": "about_x", "tangent": [0, -1, 0]}}
    return [about_y, about_x, beam(**{**changes, **carried})]


def on_two_pins(length: float, tolerance: float = 1e-8, **changes: Any) -> Table:
    """The same with a pinned tip."""
    pin = {"rod": "beam", "kind": "pinned", "position": [0, 0, length]}
    return scene(*hinged(length, **changes), supports=[pin], tolerance=tolerance)


def modes_of_tables(tables: Table, count: int) -> Modes:
    modes = modes_of(scene_from_dict(tables), count=count)
    assert modes.converged, modes.message
    return modes


def frequencies(tables: Table, count: int) -> FloatArray:
    return modes_of_tables(tables, count).angular_frequencies


@pytest.mark.slow
def test_on_two_pins() -> None:
    """(j π)², in both planes."""
    found = frequencies(on_two_pins(1.0, strain=BENDING, stiffness=UNIT), 6)
    assert_allclose(found, np.repeat([np.pi**2, 4 * np.pi**2, 9 * np.pi**2], 2), rtol=1e-8, atol=0)


# Nachbagauer, Gruber, Gerstmayr, J. Comput. Nonlinear Dyn. 8 (2013) 021004: a beam of 2 m, 0.4 m thick

YOUNG, POISSON, DENSITY, SIDE, SPAN = 1e9, 0.3, 7850.0, 0.4, 2.0
AREA = SIDE**2
SECOND_MOMENT = SIDE**4 / 12
SHEAR_FACTOR = 10 * (1 + POISSON) / (12 + 11 * POISSON)
SHEAR = YOUNG / (2 * (1 + POISSON))
STOUT = {"linear_density": DENSITY * AREA, "rotary_inertia": DENSITY * SECOND_MOMENT * np.array([1.0, 1.0, 2.0])}


def stout(**changes: Any) -> Table:
    return {**STOUT, "rotary_inertia": STOUT["rotary_inertia"].tolist(), "length": SPAN, **changes}


def stout_on_two_pins() -> Table:
    bending = YOUNG * SECOND_MOMENT
    shear = SHEAR_FACTOR * SHEAR * AREA
    stiffness = {"bending_x": bending, "bending_y": bending, "shear_x": shear, "shear_y": shear}
    return on_two_pins(**stout(strain=list(stiffness), stiffness=stiffness))


def test_a_beam_stiffer_than_its_hinges_by_far_is_not_taken_for_rigid() -> None:
    check_constraints(scene_from_dict(stout_on_two_pins()))


@pytest.mark.slow
def test_stout_beam_on_two_pins() -> None:
    """Bending with shear in both planes: Timoshenko's closed formula, and the digits of 256 elements of Exudyn."""
    found = frequencies(stout_on_two_pins(), 6)
    assert_allclose(found, np.repeat([95.63398088, 332.23451364, 635.69628837], 2), rtol=1e-9, atol=0)
    assert_allclose(found[::2], [95.635645, 332.254, 635.769], rtol=2e-4, atol=0)


def test_stout_beam_along_its_axis_and_about_it() -> None:
    """One end held, the other free: the published torsion has both ends alike, and twice the frequency."""
    stiffness = {"torsion": 0.8436 * SHEAR * 2 * SECOND_MOMENT, "extension": YOUNG * AREA}
    rod = beam(list(stiffness), stiffness)
    found = frequencies(scene({**rod, **stout()}), 2)
    assert_allclose(found, [319.34980860 / 2, 280.32062513], rtol=1e-9, atol=0)


# A column that stands


@pytest.mark.slow
@pytest.mark.parametrize("beyond", [False, True])
def test_tallest_column(beyond: bool) -> None:
    """It falls at ρA g L³ / EI = 7.8373474388: Greenhill's."""
    load = 7.8373474388 * (1 + 1e-6 * (1 if beyond else -1))
    modes = modes_of_tables(scene(beam("planar", {"bending_y": 1.0}), loads=[gravity(load)]), 1)
    assert ("Statically unstable" in modes.message) == beyond
    assert modes.angular_frequencies[0] < 1e-2


# A soft rod in space that hangs from the horizontal


@pytest.mark.slow
def test_sagged_with_shear_extension_and_rotary_inertia() -> None:
    """In its plane: a Galerkin method of twelve polynomials a strain, its Hessian by complex steps.

    The chain of slices of the reference case comes within 1e-4 of these.
    """
    soft = {
        "name": "beam",
        "length": 0.5,
        "strain": "reissner",
        "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0},
        "section": {"shape": "circle", "radius": 0.02},
        "base": {"tangent": [1, 0, 0]},
    }
    modes = modes_of_tables(scene(soft, loads=[gravity(9.81)], tolerance=1e-7), 6)
    assert_allclose(modes.angular_frequencies[[1, 2, 5]], SAGGED, rtol=1e-8, atol=0)
    tip = modes.solution.tip().position
    assert_allclose(tip, [0.29575154340984866, 0.0, -0.3756570939541465], rtol=0, atol=1e-9)
