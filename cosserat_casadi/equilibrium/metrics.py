"""Distances between two solutions of one scene, and turns of the rods of a solution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.model.watched import SAMPLES, watched_cables, watched_sections
from cosserat_casadi.rod.strain import DiscreteRod

SAFETY = 2.0
"""Safety factor on the distance from a finer solution with an unknown error."""

ROUNDING = 2e-14
"""Floor of every estimate."""


def with_estimate(
    coarse: Solution,
    fine: Solution,
    factor: float = SAFETY,
    fine_error: float = 0.0,
    fine_shape_error: float = 0.0,
) -> Solution:
    """A solution with its error estimated by a finer solution of the same scene and inputs.

    Args:
        coarse: the solution.
        fine: the finer solution.
        factor: factor on the distance of their poses and cables.
        fine_error: error of the finer solution, which is added.
        fine_shape_error: error of the finer solution's shape, which is added to the error of the whole shape.
    """
    tip_distance = pose_distance(coarse, fine)
    watched_distance = max(tip_distance, cable_distance(coarse, fine))
    sampled_distance = pose_distance(coarse, fine, SAMPLES)
    shape_distance = max(watched_distance, sampled_distance)
    return replace(
        coarse,
        error_estimate=factor * watched_distance + fine_error + ROUNDING,
        shape_error_estimate=factor * shape_distance + fine_shape_error + ROUNDING,
    )


def pose_distance(first: Solution, second: Solution, X: FloatArray | None = None) -> float:
    """Largest pose error of one solution against the other, over all rods and bodies.

    The pose error of a section, or a body, is the larger of two: the distance of its positions over the length of its
    rod, and the angle between its orientations, rad.

    Args:
        first: a solution.
        second: another solution of the scene.
        X: abscissae of the compared sections, shape (k,); by default the watched sections.
    """
    distances = [0.0]
    for name in first.model.discrete.rods:
        sections = watched_sections(first.model.scene, name) if X is None else X
        first_pose = first.pose(sections, name)
        second_pose = second.pose(sections, name)
        length = first.model.length(name, first.inputs)
        distances.append(distance_of_poses(first_pose, second_pose, length))
    for name in first.model.discrete.bodies:
        length = first.model.body_length(name, first.inputs)
        distances.append(distance_of_poses(first.body(name), second.body(name), length))
    return max(distances)


def cable_distance(first: Solution, second: Solution) -> float:
    """Largest difference of the lengths of cables, over the lengths of their rods."""
    changes = [0.0]
    for name, rod in watched_cables(first.model.discrete).items():
        _, first_length, _ = first.model.actuator[name](first.x, first.inputs)
        _, second_length, _ = second.model.actuator[name](second.x, second.inputs)
        changes.append(abs(float(first_length) - float(second_length)) / first.model.length(rod, first.inputs))
    return max(changes)


def has_more_modes(first: Solution, second: Solution) -> bool:
    """Whether a solution has more strain coordinates than another of the same scene."""
    count = first.model.discrete.unknowns.count(BlockKind.STRAIN)
    count_of_second = second.model.discrete.unknowns.count(BlockKind.STRAIN)
    return count > count_of_second


def largest_turn(solution: Solution) -> float:
    """Largest angle through which an element of a rod turns from end to end, summed along it, rad."""
    rods = solution.model.discrete.rods.values()
    turns = [_element_turn(discrete_rod, solution) for discrete_rod in rods]
    return max(turns)


def prolong(solution: Solution, model: Model) -> FloatArray:
    """Unknowns of another model of the scene: coefficients that both have are kept, others are zero.

    Args:
        solution: a solution of some model.
        model: the other model, usually a finer one, with the same elements.

    Returns:
        the unknowns, shape (model.size,).
    """
    discrete = solution.model.discrete
    blocks = []
    for name, coarse_rod in discrete.rods.items():
        q = solution.x[discrete.unknowns.strain(name)]
        fine_rod = model.discrete.rods[name]
        for component, columns in coarse_rod.columns.items():
            elements = fine_rod.grid.elements
            coarse = q[columns].reshape(elements, -1)
            modes = fine_rod.at_nodes[component].shape[1] // elements
            # Polynomials are sorted by degree, so a finer model adds its coefficients at the end.
            fine = np.zeros((elements, modes))
            common = min(modes, coarse.shape[1])
            fine[:, :common] = coarse[:, :common]
            blocks.append(fine.ravel())
    # Multipliers and poses of floating frames do not depend on the discretisation.
    blocks.append(solution.x[discrete.unknowns.count(BlockKind.STRAIN) :])
    return np.concatenate(blocks)


def distance_of_poses(first: SolvedPoses, second: SolvedPoses, length: float) -> float:
    """Largest distance of positions over a length, or angle between orientations, rad."""
    distances = np.linalg.norm(first.position - second.position, axis=-1)
    angles = rotation_angles(first.quaternion, second.quaternion)
    largest_distance = float(distances.max()) / length
    largest_angle = float(angles.max())
    return max(largest_distance, largest_angle)


def _element_turn(discrete_rod: DiscreteRod, solution: Solution) -> float:
    """Largest of ℓ ∫ |K| dX over the elements of a rod, rad."""
    grid = discrete_rod.grid
    rod = discrete_rod.properties
    strain = solution.strain(known(grid.nodes), rod.name)
    curvature = np.linalg.norm(strain[:, :3], axis=1)
    # Weights of the quadrature run over all nodes, element after element.
    turns = known(discrete_rod.node_lengths) * curvature
    by_element = turns.reshape(grid.elements, -1)
    element_turns = by_element.sum(axis=1)
    return float(element_turns.max())
