"""How the cost of an assembly grows with its rods: Jacobian and its factors, in chains and in stars.

    python benchmarks/assemblies.py

Rods of one kind, in series or side by side under one body. Ratios to the smallest assembly, over the ratio of rods:
1.00 is growth in proportion to the rods.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import Model, build, scene_from_dict

ROUND = {"bending_x": 1.0, "bending_y": 1.4, "torsion": 0.7, "shear_x": 400.0, "shear_y": 600.0, "extension": 900.0}
COUNTS = (2, 4, 8, 16)
FIXED = {"modes": 6, "nodes": 14}


def rod(i: int, base: dict[str, Any]) -> dict[str, Any]:
    return {"name": f"rod_{i}", "length": 0.5, "strain": "reissner", "stiffness": ROUND, "base": base}


def chain(count: int) -> Model:
    """Each rod on the tip of the one before."""
    rods = [rod(i, {"rod": f"rod_{i - 1}"} if i else {}) for i in range(count)]
    push = {"name": "push", "kind": "tip_wrench", "rod": f"rod_{count - 1}", "force": [0.05, 0.02, 0.01]}
    return build(scene_from_dict({"schema": 1, "accuracy": FIXED, "rods": rods, "loads": [push]}))


def star(count: int) -> Model:
    """All rods clamped in one body."""
    circle = [(np.cos(2 * np.pi * i / count), np.sin(2 * np.pi * i / count), 0.0) for i in range(count)]
    rods = [rod(i, {"position": [0.1 * c for c in place]}) for i, place in enumerate(circle)]
    joints = [
        {"body": "plate", "rod": f"rod_{i}", "kind": "fixed", "position": [0.09 * c for c in place]}
        for i, place in enumerate(circle)
    ]
    push = {"name": "push", "kind": "body_wrench", "body": "plate", "force": [0.5, 0.2, 0.1]}
    tables = {"schema": 1, "accuracy": FIXED, "rods": rods, "bodies": [{"name": "plate"}], "joints": joints}
    return build(scene_from_dict({**tables, "loads": [push]}))


def entries_of_factors(matrix: ca.DM) -> int:
    """Entries of both factors of the sparse QR factorisation that a Newton step makes."""
    householder, triangular, *_ = ca.qr_sparse(matrix)
    return int(householder.nnz() + triangular.nnz())


def main() -> None:
    for make in (chain, star):
        print(f"{make.__name__}: rods, unknowns, entries, entries of factors, instructions; growth of the last three")
        first: tuple[float, ...] = ()
        for count in COUNTS:
            model = make(count)
            x = 0.1 * np.random.default_rng(0).standard_normal(model.size)
            matrix = model.path_jacobian(x, model.pack(), 1.0)
            figures = (matrix.nnz(), entries_of_factors(matrix), model.operations(model.jacobian))
            first = first or tuple(figure / count for figure in figures)
            growth = ", ".join(f"{figure / count / one:.2f}" for figure, one in zip(figures, first, strict=True))
            row = f"{count:3d} {model.size:5d} {figures[0]:8,} {figures[1]:8,} {figures[2]:12,}"
            print(f"  {row}   {growth}", flush=True)


if __name__ == "__main__":
    main()
