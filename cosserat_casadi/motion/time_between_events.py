"""Time during which an error of velocity acts while rods touch: until the next contact event resets velocities.

The time of that event is not known beforehand. It is estimated as some swings of a rod, or some times of a fall by its
length: neither depends on the duration of the motion.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.inertia import rod_mass
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.load_records import Gravity
from cosserat_casadi.scene.rod_records import Rod

SLOWEST_ROOT = 1.87510407
"""Least root k of cos k cosh k = −1: k² √(EI/ρA)/ℓ² is the lowest angular frequency of a cantilever rod."""

RAYLEIGH = 33.0 / 140.0
"""Share of a rod's mass that counts as mass at its end (Lord Rayleigh, *The Theory of Sound*, 1877, chapter 8)."""

SWINGS = 3.0
"""Swings, or falls, within which the next event is expected."""


def time_between_events(model: Model, duration: float) -> float:
    """Expected time until the next contact event, s, at most the duration of the motion."""
    scene = model.scene
    carried = sum(body.mass for body in scene.bodies)
    times = [_time_of_swing(_by_its_own_numbers(model, rod), carried) for rod in scene.rods]
    weights = [np.linalg.norm(load.acceleration) for load in scene.loads if isinstance(load, Gravity)]
    longest = max(float(rod.length) for rod in scene.rods)
    times += [float(np.sqrt(2.0 * longest / weight)) for weight in weights if weight > 0.0]
    return min(duration, SWINGS * max(times))


def _by_its_own_numbers(model: Model, rod: Rod) -> DiscreteRod:
    """Return a rod scaled by the values of its parameters, not by the numbers in the file."""
    discrete_rod = model.at().discrete.rods[rod.name]
    own = replace(rod_properties(rod), fixed_masses=discrete_rod.properties.fixed_masses)
    return replace(discrete_rod, properties=own)


def _time_of_swing(rod: DiscreteRod, carried: float) -> float:
    """Period of the slowest swing of a cantilever rod with a mass at its tip, s; infinite without any mass.

    Args:
        rod: the rod.
        carried: the mass at its tip, kg.
    """
    mass = rod_mass(rod) + carried / RAYLEIGH
    if mass == 0.0:
        return inf
    # EI/ℓ over m ℓ².
    slowest_rate = SLOWEST_ROOT**2 * np.sqrt(rod.energy_unit / mass) / rod.length
    return float(2.0 * np.pi / slowest_rate)
