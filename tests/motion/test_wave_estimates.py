"""Errors that are told of waves of sudden loads, twisting and stretching, beside d'Alembert's solution: from above."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cosserat_casadi import Motion, build, discretise, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.felt_modes import lacking_at_fronts
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import paths
from tests.families import mostly_slow
from tests.motion import transients

PASSES = 8.0
"""Times that a wave passes the rod: two periods."""

ROWS = 1601

RISE = 2.0 - np.abs(np.mod(np.linspace(0.0, PASSES, ROWS), 4.0) - 2.0)
"""Displacement of the tip over the static one, at the times of a row: it rises to 2 and falls to 0, over and over."""

CARELESS = 6.0
"""An error is not told to be so many times what it is."""

FORCE, MOMENT = 0.2, 1.0
"""Of the rods without units, whose length, stiffness and speed of waves are one."""

WIRE = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0}
WIRE_RADIUS = 1e-3
WIRE_FORCE, WIRE_MOMENT = 1000.0, 0.05


def suddenly(kind: str, tolerance: float, modes: int | None = None) -> dict[str, Any]:
    """A clamped rod without damping that is pulled or twisted at its tip, with all of the load there from t = 0 on."""
    if kind == "twist":
        rod = {"strain": ["torsion"], "stiffness": {"torsion": 1.0}, "rotary_inertia": [1.0, 1.0, 1.0]}
        load = transients.at_tip(moment=[MOMENT, 0, 0])
    else:
        rod = {"strain": ["extension"], "stiffness": {"extension": 1.0}}
        load = transients.at_tip(force=[FORCE, 0, 0])
    scene = transients.table(rod, load, simulation=asked(PASSES, tolerance))
    if modes is not None:
        scene["accuracy"] = {"modes": modes, "nodes": modes + 2}
    return scene


def wire(kind: str, tolerance: float) -> dict[str, Any]:
    """A steel wire of 1 m with all six strains, pulled or twisted likewise."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "reissner",
        "material": WIRE,
        "section": {"shape": "circle", "radius": WIRE_RADIUS},
        "base": {"tangent": [1, 0, 0]},
    }
    force = [WIRE_FORCE if kind == "pull" else 0.0, 0, 0]
    moment = [WIRE_MOMENT if kind == "twist" else 0.0, 0, 0]
    stiffness = WIRE["youngs_modulus"] if kind == "pull" else shear_modulus()
    duration = PASSES / np.sqrt(stiffness / WIRE["density"])
    loads = [transients.at_tip(force=force, moment=moment)]
    return {"schema": 1, "rods": [rod], "loads": loads, "simulation": asked(duration, tolerance)}


def shear_modulus() -> float:
    return WIRE["youngs_modulus"] / 2.0 / (1.0 + WIRE["poisson_ratio"])


def asked(duration: float, tolerance: float) -> dict[str, Any]:
    return {"duration": float(duration), "start": "unloaded", "tolerance": tolerance, "frames": ROWS}


def missed(kind: str, motion: Motion, still: float) -> float:
    """Largest error of the tip, over the length; of its turn on the arm of a tolerance. ``still``: the static one."""
    tip = motion.tip()
    if kind == "pull":
        moved: FloatArray = tip.position[:, 0] - tip.position[0, 0]
        return float(np.abs(moved - still * RISE).max())
    along = np.abs(tip.quaternion @ tip.quaternion[0])
    turned = 2.0 * np.arctan2(np.sqrt(np.maximum(0.0, 1.0 - along**2)), along)
    return float(LEVER * np.abs(turned - still * RISE).max())


@pytest.mark.parametrize(
    ("kind", "modes"),
    mostly_slow(
        [(kind, modes) for kind in ("twist", "pull") for modes in (4, 6, 8, 12, 16, 24, 32)],
        quick=[("twist", 24), ("pull", 6)],
    ),
)
def test_errors_on_given_modes_are_told_from_above(kind: str, modes: int) -> None:
    motion = simulate(scene_from_dict(suddenly(kind, 3e-3, modes)))
    error = missed(kind, motion, MOMENT if kind == "twist" else FORCE)
    assert error < motion.error_estimate < CARELESS * error


@pytest.mark.parametrize("modes", mostly_slow([4, 6, 9, 12, 16, 24, 32], quick=[6, 24]))
def test_last_coefficients_tell_the_error_at_fronts(modes: int) -> None:
    """With next to no error of the steps. The distance from 28 modes tells 0.8 of the error of 24."""
    scene = scene_from_dict(suddenly("pull", 1e-3)).with_motion_inputs()
    simulation = scene.simulation
    assert simulation is not None
    model = build(scene, discretise(scene, modes, modes + 2), moving=True)
    history = Simulator(model, simulation, started(model, simulation, None)).controlled(1e-5)
    times = np.linspace(0.0, PASSES, ROWS)
    place = paths(model, *history.rough_positions(times)).points[:, 0, 0]
    error = float(np.abs(place - place[0] - FORCE * RISE).max())
    assert error < lacking_at_fronts(history, PASSES) < 3.0 * error


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [3e-2, 1e-2, 5e-3, 3e-3])
@pytest.mark.parametrize("kind", ["twist", "pull"])
def test_errors_on_chosen_modes_are_told_from_above(kind: str, tolerance: float) -> None:
    motion = simulate(scene_from_dict(suddenly(kind, tolerance)))
    assert missed(kind, motion, MOMENT if kind == "twist" else FORCE) < motion.error_estimate < tolerance


@pytest.mark.parametrize(
    ("kind", "tolerance"),
    mostly_slow(
        [("pull", 1e-3), ("pull", 1e-4), ("twist", 1e-2), ("twist", 3e-3), ("twist", 1e-3)], quick=[("twist", 1e-2)]
    ),
)
def test_a_steel_wire_is_told_from_above(kind: str, tolerance: float) -> None:
    motion = simulate(scene_from_dict(wire(kind, tolerance)))
    still = WIRE_FORCE / WIRE["youngs_modulus"] / np.pi / WIRE_RADIUS**2
    if kind == "twist":
        still = WIRE_MOMENT / shear_modulus() / (np.pi * WIRE_RADIUS**4 / 2.0)
    assert missed(kind, motion, still) < motion.error_estimate < tolerance
