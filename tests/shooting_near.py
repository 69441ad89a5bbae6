"""Scenes and solutions of the package beside the shooting of the tests, which reads tables and shares no code."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.testing import assert_allclose
from numpy.typing import ArrayLike

from cosserat_casadi import Scene, Solution
from cosserat_casadi.model.watched import watched_sections
from tests.fine_reference import RodState
from tests.reference import shooting
from tests.reference.shooting import Tip, solve_by_shooting


def integrate(scene: Scene, force: ArrayLike, moment: ArrayLike) -> Tip:
    """The scene's only rod integrated from its base, where the clamp exerts this force and moment on it."""
    return shooting.integrate(tables_of(scene), np.concatenate([force, moment]))


def tables_of(scene: Scene) -> dict[str, Any]:
    """Tables of a scene file."""
    tables: dict[str, Any] = scene.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return tables


def shoot(solution: Solution, X: ArrayLike | None = None) -> RodState:
    """Sections and clamp of the only rod of a scene, at the scene's own inputs.

    Args:
        solution: starts Newton's method with its wrench of the clamp, and so says which equilibrium is meant.
        X: abscissae of the sections; those that the package watches by default.

    Raises:
        ValueError: the scene holds what shooting does not know.
        NoEquilibriumError: none is near.
    """
    model = solution.model
    (rod,) = model.scene.rods
    assert_allclose(solution.inputs, model.pack(), rtol=0, atol=0)
    clamp = solution.base_wrench()
    truth = solve_by_shooting(
        tables_of(model.scene),
        samples=watched_sections(model.scene, rod.name) if X is None else X,
        base_wrench=np.concatenate([clamp.force, clamp.moment]),
    )
    return RodState(
        length=rod.length,
        position=truth.sections.position,
        rotation=truth.sections.rotation,
        base_wrench=np.concatenate([truth.base_force, truth.base_moment]),
    )
