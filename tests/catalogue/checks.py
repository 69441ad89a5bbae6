"""What the tests of the catalogue and the script of its page do with a case."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi import Model, Scene, Solution, build, discretise, scene_from_dict, solve
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, variations
from tests.catalogue.cases import Table, twisted_column, twisted_ring
from tests.pose_errors import pose_error
from tests.shooting_near import integrate

BRACKET = 1e-6
"""Relative distance, to both sides of a reference, at which an eigenvalue is looked at.

Small, because two that vanish together, with slopes of their own, change places there.
"""


def scene_of(tables: Table, tolerance: float = 1e-9) -> Scene:
    """The scene of tables, to be solved to a tolerance unless they fix modes."""
    return scene_from_dict({"accuracy": {"tolerance": tolerance}, **tables})


def solved(tables: Table, tolerance: float = 1e-9) -> Solution:
    """The equilibrium from a cold start with default settings."""
    found = solve(scene_of(tables, tolerance))
    assert found.converged, found.message
    return found


def initial_value_error(solution: Solution) -> float:
    """Pose error of the tip against the rod integrated from the clamp's wrench.

    Of a free tip the wrench left there counts too, relative to EI/L and EI/L²: what is not an equilibrium shows.
    """
    (rod,) = solution.model.discrete.rods.values()
    base, reached = solution.base_wrench(), integrate(solution.model.scene, *_wrench(solution))
    tip = solution.tip()
    claimed = (tip.position, tip.rotation)
    error = pose_error(claimed, (reached.position, reached.rotation), rod.properties.length)
    if solution.model.scene.supports:
        return error
    size = rod.energy_unit + np.abs(base.moment).max() + rod.properties.length * np.abs(base.force).max()
    left = max(np.abs(reached.moment_left).max(), rod.properties.length * np.abs(reached.force_left).max())
    return max(error, float(left / size))


def _wrench(solution: Solution) -> tuple[Any, Any]:
    base = solution.base_wrench()
    return base.force, base.moment


def fine_model(tables: Table, modes: int, nodes: int) -> Model:
    """A model of fixed discretisation."""
    scene = scene_of(tables)
    return build(scene, discretise(scene, modes, nodes, "magnus8"))


def eigenvalues(model: Model, x: Any) -> Any:
    """Eigenvalues of the second variation at x, ascending."""
    jacobian = model.path_jacobian(x, model.pack(), 1.0).full()
    return admissible_eigenvalues(jacobian, variations(model))


def column_eigenvalue(twist: float, stretch: float, torsion: float) -> float:
    """Smallest eigenvalue of the straight twisted column; it belongs to two modes."""
    model = fine_model(twisted_column(twist, stretch, torsion), 12, 30)
    found = solve(model)
    assert found.converged, found.message
    return float(eigenvalues(model, found.x)[0])


def ring_eigenvalue(twist: float, torsion: float) -> float:
    """Eigenvalue of the second variation of the flat twisted ring that is the smallest but for the neutral one.

    That of zero belongs to the turn of the whole ring about the tangent of its clamp: a round section allows it.
    """
    model = fine_model(twisted_ring(twist, torsion), 14, 34)
    spectrum = eigenvalues(model, flat_ring(model, twist))
    neutral = int(np.argmin(np.abs(spectrum)))
    assert abs(spectrum[neutral]) < 1e-10
    return float(np.delete(spectrum, neutral)[0])


def flat_ring(model: Model, twist: float) -> Any:
    """Unknowns of the flat ring: constant curvature, no twist left but the one unloaded, multipliers that hold it."""
    (basis,) = model.discrete.rods.values()
    x, strains = np.zeros(model.size), basis.size
    x[basis.columns[1].start] = 2 * np.pi / basis.scales[1]
    x[basis.columns[2].start] = twist / basis.scales[2]
    residual = model.path_residual(x, model.pack(), 1.0).full()[:, 0]
    jacobian = model.path_jacobian(x, model.pack(), 1.0).full()
    x[strains:] = np.linalg.lstsq(jacobian[:strains, strains:], -residual[:strains], rcond=1e-12)[0]
    left = model.path_residual(x, model.pack(), 1.0).full()
    assert np.abs(left).max() < 1e-9
    return x


def zero_near(function: Any, reference: float) -> float:
    """Zero of a smooth function by the chord from just below to just above a reference; far off if it is not there."""
    low, high = (1 - BRACKET) * reference, (1 + BRACKET) * reference
    before, after = function(low), function(high)
    return float(low - before * (high - low) / (after - before))
