"""Checks before a simulation: a scene that cannot be simulated is refused with all its problems."""

from __future__ import annotations

from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_checks import untouchable
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.simulation import Simulation


def check_simulation(model: Model, simulation: Simulation | None) -> None:
    """Refuse a model or settings that cannot be simulated.

    Raises:
        SceneError: the model or the settings have problems, all of which the error lists.
    """
    problems = []
    if simulation is None:
        remedy = "add a table [simulation] with duration = 1.0 (s)"
        problems.append(Problem("simulation", "missing: it says how long to simulate", remedy))
    problems += immovable(model)
    if simulation is not None and simulation.integrator == "gauss" and not all(model.discrete.unknowns.differential):
        what = "'gauss' does not converge for supports, joints, carried rods and cables of given length"
        problems.append(Problem("simulation.integrator", what, "use 'radau'"))
    if simulation is not None and model.scene.touches_exactly:
        problems += list(untouchable(model, simulation))
    refuse(problems)


def check_movable(model: Model) -> None:
    """Refuse a model that has no motion.

    Raises:
        SceneError: the model has problems, all of which the error lists.
    """
    refuse(immovable(model))


def immovable(model: Model) -> list[Problem]:
    """Problems of a model that has no motion: rods without mass, a rotation without velocities."""
    problems = []
    for index, rod in enumerate(model.discrete.rods.values()):
        if rod.properties.linear_density is None:
            problems.append(_without_mass(model.scene.rods[index], index))
    if model.scene.accuracy.rotation == "permuted":
        what = "'permuted', the literal linear system, has no velocities"
        problems.append(Problem("accuracy.rotation", what, "leave it out, or use a product of exponentials"))
    return problems


def _without_mass(rod: Rod, index: int) -> Problem:
    """The problem of a rod without mass: its table lacks a density."""
    what = f"missing: {rod.name!r} has no mass, and a motion needs one"
    if rod.material is None:
        return Problem(f"rods[{index}].linear_density", what, "give the mass per length, kg/m")
    return Problem(f"rods[{index}].material.density", what, "give the density, kg/m³")
