"""Modes that the data of a scene require, before anything is solved.

A cable that winds round a rod, an unloaded curvature or a spread load of high degree put waves into the stress.
Legendre coefficients of a wave are nearly zero up to about the degree of its frequency, and a helix of n turns in an
element excites degrees around πn: with fewer modes the last coefficients are small, however large the error is. The
data are therefore projected on polynomials, element by element, and no level below the degree at which their
coefficients have decayed can be a reference solution (docs/theory.md, section 10).
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.routing import holes
from cosserat_casadi.maths.numbers import as_vector, known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.element_ends import element_ends, unloaded_turns
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.strain import DiscreteRod

DECAYED = 0.1
"""Share of the largest coefficient, the constant excluded, that all coefficients beyond a signal's degree are below."""

FAINT = 1e-3
"""Share of the largest coefficient, the constant included, below which a coefficient is not part of a signal."""

BEYOND = 2
"""Modes beyond a signal's degree, whose decay shows how fast the remaining ones converge."""

SLOW_MODES = 7
"""Modes that resolve any slowly varying signal, whose square has few modes as well."""

WAVES_FACTOR = 2
"""Factor on modes with which products of waves are resolved, which have twice the frequency."""

PROJECTIONS = (12, 24, 48, 96, 192)
"""Modes of the projections of an actuator, tried one after the other until two agree."""


def signal_modes(scene: scenes.Scene) -> int:
    """Least modes per strain component and element of a level that resolves the waves in the scene's data."""
    degrees = [0]
    for record in scene.rods:
        breaks = element_ends(scene, record.name)
        for actuator in scene.actuators:
            # A cable that is straight between its holes pulls with one force in each gap: there are no waves.
            if EFFECTS[actuator.kind].acts_on(actuator, record.name) and holes(actuator) is None:
                degree = _actuator_degree(actuator, record, breaks)
                degrees.append(degree)
        degrees.append(_intrinsic_degree(record))
    for load in scene.loads:
        if isinstance(load, scenes.DistributedWrench):
            components = (*load.force, *load.moment)
            degrees += [_series_degree(component) for component in components]
    degrees += [_series_degree(wave) for motion in scene.motions if motion.travels for wave in motion.along_the_rod]
    return max(degrees) + BEYOND


@lru_cache(maxsize=64)
def _intrinsic_degree(record: scenes.Rod) -> int:
    """Degree at which the strains of a rod without load have decayed."""
    intrinsic = rod_properties(record).intrinsic
    return max(_series_degree(known(as_vector(coefficients))) for coefficients in intrinsic)


@lru_cache(maxsize=64)
def _actuator_degree(actuator: scenes.Actuator, record: scenes.Rod, breaks: tuple[float, ...]) -> int:
    """Degree at which the actuation stress along the unloaded rod has decayed in every element."""
    degree = -1
    for modes in PROJECTIONS:
        coarser = degree
        degree = _last_degree(_projection(actuator, _discrete_rod(record, breaks, modes)))
        # Too few nodes alias waves to longer ones, which a finer projection shows.
        if degree == coarser:
            break
    return degree


def _last_degree(sizes: FloatArray) -> int:
    """Last degree before the coefficients have decayed, from their sizes by degree; 0 for a constant signal."""
    varying = sizes[1:].max(initial=0.0)
    bound = max(DECAYED * varying, FAINT * sizes.max())
    present = np.flatnonzero(sizes[1:] > bound)
    if len(present) == 0:
        return 0
    return int(present[-1]) + 1


@lru_cache(maxsize=8)
def _discrete_rod(record: scenes.Rod, breaks: tuple[float, ...], modes: int) -> DiscreteRod:
    """A discrete rod with this number of modes for every strain in each element."""
    rod = rod_properties(record)
    return DiscreteRod(rod, Discretisation((modes,) * len(rod.admitted), 2 * modes, breaks, "magnus4"))


def _projection(actuator: scenes.Actuator, discrete_rod: DiscreteRod) -> FloatArray:
    """Largest strain coefficient of each degree under a unit effort, over components and elements, shape (modes,).

    The gradient of length or volume is the projection of the actuation stress, ∂L/∂q = ℓ ∫ Φᵀ Λ_ad dX.
    """
    discretisation = discrete_rod.discretisation
    # Length or volume of an actuator follows from strains alone: rotations of sections are not integrated.
    unturned = ca.repmat(ca.DM([1, 0, 0, 0]), 1, discrete_rod.grid.elements * discretisation.nodes + 1)
    unloaded = Shape(discrete_rod, ca.DM.zeros(discrete_rod.size), unturned, None)
    quantity = EFFECTS[actuator.kind].quantity(actuator, discrete_rod.grid)
    gradient = ca.DM(ca.densify(quantity.on(unloaded).gradient)).full()[:, 0]
    # In coordinates of unit stiffness all strains count alike, whatever the slenderness.
    units = np.sqrt(np.diag(known(discrete_rod.stiffness)))
    sizes = np.zeros(max(discretisation.modes))
    for component, columns in discrete_rod.columns.items():
        degrees = discrete_rod.degrees(component)
        np.maximum.at(sizes, degrees, np.abs(gradient[columns] / units[columns]))
    return sizes


def seeing_modes(scene: scenes.Scene, rod: str) -> int:
    """Modes of every strain of a rod from which on a richer model sees waves along it, and products of waves.

    Bending multiplies waves, and puts some at twice the degree.
    """
    waves = wave_modes(scene, rod)
    return waves if waves <= SLOW_MODES else WAVES_FACTOR * waves


def most_wave_modes(scene: scenes.Scene) -> int:
    """Modes that see what the scene and the turns of its unloaded rods put along any rod."""
    return max(signal_modes(scene), modes_for_turn(unloaded_turn(scene)))


def wave_modes(scene: scenes.Scene, rod: str) -> int:
    """Modes of every strain of a rod that see what its scene and its own turns put along it.

    Over an element that turns by T a force of fixed direction puts waves into the strains, whose coefficients are small
    up to about the degree T/2.
    """
    record = next(record for record in scene.rods if record.name == rod)
    return max(signal_modes(scene), modes_for_turn(_turn_of_rod(scene, record)))


def modes_for_turn(turn: float) -> int:
    """Modes whose last coefficients show waves along an element that turns by an angle, rad; 0 within one turn."""
    return ceil(turn / 2) + BEYOND if turn > 2 * np.pi else 0


def unloaded_turn(scene: scenes.Scene) -> float:
    """Largest angle through which sections turn along an element of an unloaded rod, summed, rad."""
    return max(_turn_of_rod(scene, record) for record in scene.rods)


def _turn_of_rod(scene: scenes.Scene, record: scenes.Rod) -> float:
    """Largest angle through which sections turn along an element of one unloaded rod, summed, rad."""
    return max(unloaded_turns(record, element_ends(scene, record.name)))


def _series_degree(component: npt.ArrayLike) -> int:
    """Degree at which the Legendre coefficients of a signal have decayed."""
    coefficients = np.atleast_1d(np.asarray(component, dtype=float))
    return _last_degree(np.abs(coefficients))
