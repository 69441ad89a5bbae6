"""How many operations a function takes."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.calls import called_functions


def operations(function: ca.Function) -> int:
    """Scalar operations of a function: expanded to scalars, common terms shared, inputs and outputs not counted.

    The kernels of the intervals stay functions of their own; each call counts with all its operations.
    """
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    results = ca.cse(list(function.call(symbols)))
    return _operations(ca.Function("scalar", symbols, results))


def _operations(scalar: ca.Function) -> int:
    called = called_functions(scalar)
    inside: dict[int, int] = {}
    total = 0
    for i in range(scalar.n_instructions()):
        kind = scalar.instruction_id(i)
        if kind == ca.OP_CALL:
            callee = hash(called[i])
            if callee not in inside:
                inside[callee] = _operations(called[i])
            total += inside[callee]
        elif kind not in (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST):
            total += 1
    return total
