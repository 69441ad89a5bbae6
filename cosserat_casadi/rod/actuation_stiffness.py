"""Stiffness of a rod from nonlinear functions of its strains: lengths, volumes, energy beyond Hooke's law."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.block_operators import summed
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import SectionMotions
from cosserat_casadi.rod.igm import InverseGeometricModel


def actuation_stiffness(igm: InverseGeometricModel, motions: SectionMotions) -> Matrix | None:
    """Σ τ ∂ pull/∂q / (EI/ℓ) of all efforts and of the material, n×n; None if it is zero.

    The part of frozen wrenches is left out: it is in the stiffness of the loads.
    """
    parts = []
    curved = _curvature_stiffness(igm)
    if curved is not None:
        parts.append(curved)
    for effort, conjugate in igm.strain_functions:
        further = conjugate.further_stiffness
        if further is not None:
            parts.append(effort / igm.rod.energy_unit * further)
    parts += _section_stiffness(igm, motions)
    return summed(parts)


def _section_stiffness(igm: InverseGeometricModel, motions: SectionMotions) -> list[Matrix]:
    """Stiffness by the change of efforts' wrenches with the motions of sections, n×n, for each set of sections."""
    operators: dict[tuple[int, ...], Matrix] = {}
    for effort, conjugate in igm.efforts:
        operator = conjugate.section_stiffness
        if operator is not None:
            nodes = tuple(conjugate.wrench_nodes)
            own = effort / igm.rod.energy_unit * operator
            operators[nodes] = operators[nodes] + own if nodes in operators else own
    moved = {nodes: motions.motion_of(list(nodes)) for nodes in operators}
    return [moved[nodes].T @ (operator @ moved[nodes]) for nodes, operator in operators.items()]


def _curvature_stiffness(igm: InverseGeometricModel) -> Matrix | None:
    """Σ τ ∂²L/∂q∂qᵀ / (EI/ℓ) of all efforts, n×n, from sums of their rows at the nodes."""
    admitted = igm.rod.admitted
    blocks = {}
    for a in admitted:
        for b in admitted:
            if a <= b:
                blocks[a, b] = _curvature_block(igm, a, b)
    if not any(block.nnz() for block in blocks.values()):
        return None
    for a, b in list(blocks):
        if a < b:
            blocks[b, a] = blocks[a, b].T
    return ca.blockcat([[blocks[a, b] for b in admitted] for a in admitted])


def _curvature_block(igm: InverseGeometricModel, a: int, b: int) -> Matrix:
    """Block of the stiffness in the coordinates of strain a, rows, and of strain b, columns."""
    # The rows of all efforts at the nodes are summed first: one product with Φ serves all.
    rows = []
    for effort, conjugate in igm.strain_functions:
        curvature = conjugate.curvature(a, b)
        if curvature is not None:
            rows.append(effort / igm.rod.energy_unit * curvature)
    phi_a = igm.rod.at_nodes[a]
    phi_b = igm.rod.at_nodes[b]
    total = summed(rows)
    if total is None:
        return ca.DM(phi_a.shape[1], phi_b.shape[1])
    left = ca.sparsify(ca.DM(phi_a)).T
    right = ca.sparsify(ca.DM(phi_b))
    block = left @ (ca.diag(total) @ right)
    # Symmetric to the last digit, and half the products.
    if a == b:
        return ca.triu2symm(ca.triu(block))
    return block
