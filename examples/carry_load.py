"""A parallel robot of three slender rods carries a heavy load along an arch without coming near an instability.

The rods are fed through feet that slide on rails. Without regard to stability the feet stay where they are and the legs
buckle on the way; with the margin to instability as a constraint they spread just as far as it asks for.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.control import lifted, stability_margin

LEGS = ("leg_1", "leg_2", "leg_3")
ANGLES = np.deg2rad([90.0, 210.0, 330.0])
RAILS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(3)])
"""Directions of the rails."""

LENGTH, LEAN = 0.38, 0.3
"""Length of the legs at first, m, and how far they lean inwards at their feet, rad."""

HOME, LONGEST = 0.06, 0.20
"""Where a foot wants to be on its rail and how far it can go, m."""

LOAD, HEIGHT = 3.0, 0.03
"""Mass on the platform, kg, and how high above it, m."""

LEAST = 0.03
"""Smallest eigenvalue that is allowed, in units of EI/L."""


def robot() -> Model:
    """Three rods of glass fibre, clamped in their feet and in a platform with a load."""
    rods: list[dict[str, Any]] = []
    joints: list[dict[str, Any]] = []
    for leg, rail in zip(LEGS, RAILS, strict=True):
        axis = np.array([rail[1], -rail[0], 0.0])
        turn = [np.cos(LEAN / 2), *(np.sin(LEAN / 2) * axis)]
        base = {"position": (HOME * rail).tolist(), "quaternion": turn}
        rods.append(
            {
                "name": leg,
                "length": LENGTH,
                "strain": "kirchhoff",
                "material": {"youngs_modulus": 4e10, "shear_modulus": 1.5e10, "density": 1900.0},
                "section": {"shape": "circle", "radius": 1.5e-3},
                "base": base,
            }
        )
        joints.append(
            {"body": "platform", "rod": leg, "kind": "fixed", "position": (0.04 * rail).tolist(), "quaternion": turn}
        )
    return build(
        scene_from_dict(
            {
                "schema": 1,
                "title": "A parallel robot that carries a load",
                "inputs": [f"{leg}.{what}" for what in ("length", "base.position") for leg in LEGS],
                "accuracy": {"modes": 3},
                "rods": rods,
                "bodies": [{"name": "platform", "mass": LOAD, "centre_of_mass": [0.0, 0.0, HEIGHT]}],
                "joints": joints,
                "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
            }
        )
    )


def arch(stages: int) -> np.ndarray:
    """Points that the load passes, stages×3, m."""
    x = np.linspace(-0.10, 0.10, stages)
    return np.column_stack([x, np.zeros(stages), 0.42 - 8.0 * x**2])


def posing(model: Model, bounded: bool) -> ca.Function:
    """The problem of one stage: the least travel of the feet that brings the load to a point."""
    x, drive, point = ca.MX.sym("x", model.size), ca.MX.sym("drive", 6), ca.MX.sym("point", 3)
    inputs = inputs_of(drive)
    state = lifted(model, x, inputs)
    position, _, rotation = model.body["platform"](x, inputs)
    missed = (position + rotation @ ca.DM([0, 0, HEIGHT]) - point) / LENGTH
    held = [state.residual, missed]
    if bounded:
        held.append(stability_margin(model)(x, inputs))
    problem = {"x": ca.vertcat(x, drive), "p": point, "f": ca.sumsqr(drive[3:] - HOME) / HOME**2, "g": ca.vertcat(*held)}
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-8}}
    return ca.nlpsol("posing", "ipopt", problem, options)


def inputs_of(drive: ca.MX | np.ndarray) -> ca.MX:
    """Inputs of the model from lengths and places of the feet on their rails."""
    feet = [drive[3 + i] * ca.DM(rail) for i, rail in enumerate(RAILS)]
    return ca.vertcat(drive[:3], *feet)
