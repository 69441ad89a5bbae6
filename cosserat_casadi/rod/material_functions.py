"""Stress of a nonlinear material, and margins of strains to its limits: docs/theory.md, section 6."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.properties import EnergyBeyondHooke
from cosserat_casadi.rod.strain_density import energy_beyond_hooke


def material_margin(shape: Shape) -> Matrix | None:
    """Least margin of the material at the nodes, 1×1, dimensionless; None for a linear rod.

    It is negative if a further strain would release energy, or if the strain is outside of the law.
    """
    energy = energy_beyond_hooke(shape)
    rod = shape.rod
    law = rod.properties.beyond_hooke
    if energy is None or law is None:
        return None
    nodes = rod.grid.size
    data = as_matrix(energy.quantity.data)
    hooke = as_matrix(rod.properties.hooke(rod.grid.nodes))[:, list(rod.admitted)]
    stiffness = ca.MX(hooke if hooke.shape[0] == nodes else ca.repmat(hooke, nodes, 1)).T
    kernel = section_margins(law, rod.admitted, data.shape[0]).map(nodes)
    least: Matrix = ca.mmin(kernel(energy.strain, data, stiffness))
    return least


def stress_beyond_hooke(law: EnergyBeyondHooke, data_size: int) -> ca.Function:
    """(change of strains 6×1, data) ↦ stress beyond the Hooke tensor's, 6×1, N m and N."""
    change = ca.SX.sym("change", 6)
    data = ca.SX.sym("data", data_size)
    gradient = ca.jacobian(law.density(change, data), change).T
    return ca.Function("stress_beyond_hooke", [change, data], [ca.densify(gradient)])


def section_margins(law: EnergyBeyondHooke, admitted: tuple[int, ...], data_size: int) -> ca.Function:
    """(change of strains, data, stiffnesses of the admitted strains) ↦ margin of one section."""
    first_column = [0] * len(admitted)
    change = ca.SX.sym("change", ca.Sparsity.triplet(6, 1, list(admitted), first_column))
    data = ca.SX.sym("data", data_size)
    stiffness = ca.SX.sym("stiffness", len(admitted))
    gradient = ca.jacobian(law.density(change, data), change).T
    curvature = ca.densify(ca.jacobian(gradient, change)[list(admitted), list(admitted)])
    roots = ca.sqrt(stiffness)
    # Relative to the Hooke tensor: strains have different units.
    relative = ca.SX.eye(len(admitted)) + curvature / (roots @ roots.T)
    shares = _pivots(relative)
    if law.margin is not None:
        shares = ca.vertcat(shares, law.margin(change, data))
    return ca.Function("material_margin", [change, data, stiffness], [ca.mmin(shares)])


def _pivots(matrix: ca.SX) -> ca.SX:
    """Pivots of Gaussian elimination of a symmetric matrix; all are positive if it is positive definite.

    Pivots after the first one that is not positive have no meaning, and are not used.
    """
    pivots = []
    remaining = matrix
    while remaining.shape[0]:
        pivot = remaining[0, 0]
        pivots.append(pivot)
        column = remaining[1:, 0]
        # A pivot that is not positive is already in the result; a division by it could give NaN.
        safe = ca.if_else(pivot > 0, pivot, 1)
        remaining = remaining[1:, 1:] - column @ column.T / safe
    return ca.vertcat(*pivots)
