"""How long an error of velocity acts while rods touch: until the next event of contact makes velocities anew.

When that comes is not known beforehand. It is some swings of a rod away, or some times that it falls its length in:
neither depends on how long the motion is watched.
"""

from __future__ import annotations

from math import inf

import numpy as np

from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.inertia import rod_mass
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.load_records import Gravity

SLOWEST_ROOT = 1.87510407
"""Least root k of cos k cosh k = −1: a rod that is clamped at one end swings at k² √(EI/ρA)/ℓ², its slowest rate."""

RAYLEIGH = 33.0 / 140.0
"""Share of a rod's mass that swings as one at its end does (Lord Rayleigh, *The Theory of Sound*, 1877, chapter 8)."""

SWINGS = 3.0
"""Swings, or falls, within which the next event is expected."""


def time_between_events(model: Model, duration: float) -> float:
    """Time in which the next event of contact is expected, s: at most the duration of the motion, s."""
    discrete = model.discrete.nominal
    carried = sum(body.mass for body in discrete.scene.bodies)
    times = [_time_of_swing(rod, discrete.tension_unit(name), carried) for name, rod in discrete.rods.items()]
    weights = [np.linalg.norm(load.acceleration) for load in model.scene.loads if isinstance(load, Gravity)]
    longest = max(float(rod.properties.length) for rod in discrete.rods.values())
    times += [float(np.sqrt(2.0 * longest / weight)) for weight in weights if weight > 0.0]
    return min(duration, SWINGS * max(times))


def _time_of_swing(rod: DiscreteRod, tension_unit: float, carried: float) -> float:
    """Period of the slowest swing of a rod clamped at one end with a mass at the other, s; infinite without any mass.

    Args:
        rod: the rod.
        tension_unit: EI/ℓ² of it, N.
        carried: the mass at its other end, kg.
    """
    mass = rod_mass(rod) + carried / RAYLEIGH
    if mass == 0.0:
        return inf
    length = float(rod.properties.length)
    slowest_rate = SLOWEST_ROOT**2 * np.sqrt(tension_unit / (mass * length))
    return float(2.0 * np.pi / slowest_rate)
