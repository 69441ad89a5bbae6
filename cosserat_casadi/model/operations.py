"""Number of operations of a function."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.calls import in_scalars

COUNTED_EXACTLY = 100_000
"""Operations up to which a function is expanded to be counted: sharing the terms of so many takes about a second."""

_MOVES = frozenset(
    {
        ca.OP_INPUT,
        ca.OP_OUTPUT,
        ca.OP_CONST,
        ca.OP_TRANSPOSE,
        ca.OP_RESHAPE,
        ca.OP_PROJECT,
        ca.OP_SPARSITY_CAST,
        ca.OP_GETNONZEROS,
        ca.OP_SETNONZEROS,
        ca.OP_HORZCAT,
        ca.OP_VERTCAT,
        ca.OP_DIAGCAT,
        ca.OP_HORZSPLIT,
        ca.OP_VERTSPLIT,
        ca.OP_DIAGSPLIT,
        ca.OP_HORZREPMAT,
    }
)
"""Instructions on matrices that compute nothing."""


@dataclass(frozen=True)
class Count:
    """Number of scalar operations.

    Attributes:
        number: number of operations.
        exact: whether it was counted after expansion, common terms shared; else it is a bound from above.
    """

    number: int
    exact: bool

    def __str__(self) -> str:
        if self.exact:
            return f"{self.number:,}"
        # Round up to two digits and zeros.
        unit = 10 ** max(len(str(abs(self.number))) - 2, 0)
        bound = -(-self.number // unit) * unit
        # A difference of bounds is no bound: an effect may leave fewer sections to sum at.
        return f"about {bound:,}" if bound < 0 else f"at most {bound:,}"

    def __sub__(self, other: Count) -> Count:
        return Count(self.number - other.number, self.exact and other.exact)


def operations(function: ca.Function) -> int:
    """Scalar operations of a function: expanded to scalars, common terms shared, inputs and outputs not counted.

    The kernels of the intervals stay separate functions; each call counts with all its operations.
    """
    return _scalar_operations(in_scalars(function, "scalar"))


def most_operations(function: ca.Function, known: dict[int, int] | None = None) -> int:
    """A bound of the scalar operations of a function, from its instructions on matrices: nothing is expanded.

    Terms that only expansion shows to be common, zero or one are counted: the bound is 1.2 to 5 times the operations.

    Args:
        function: the function.
        known: bounds of functions that it may call, by hash; bounds of this function and of its callees are added.
    """
    known = {} if known is None else known
    key = hash(function)
    if key not in known:
        known[key] = _bound(function, known)
    return known[key]


def counts(functions: Sequence[ca.Function]) -> list[Count]:
    """Operations of functions for a comparison: all exact, or all bounds if expansion would take seconds."""
    bounds = [most_operations(function) for function in functions]
    if sum(bounds) <= COUNTED_EXACTLY:
        return [Count(operations(function), exact=True) for function in functions]
    return [Count(bound, exact=False) for bound in bounds]


def count(function: ca.Function) -> Count:
    """Operations of a function, or a bound if its expansion would take seconds."""
    (of_function,) = counts([function])
    return of_function


def _bound(function: ca.Function, known: dict[int, int]) -> int:
    kind = function.class_name()
    if kind == "SXFunction":
        return _scalar_operations(function)
    if kind == "Map":
        parts = function.info()
        return int(parts["n"]) * most_operations(parts["f"], known)
    if kind == "Switch":
        # A switch calls one of its functions: the longest one bounds its operations.
        parts = function.info()
        return max(most_operations(part, known) for part in (*parts["f"], parts["f_def"]))
    total = 0
    for k in range(function.n_instructions()):
        instruction = function.instruction_id(k)
        if instruction not in _MOVES:
            total += _operations_of_node(instruction, function.instruction_MX(k), known)
    return total


def _operations_of_node(instruction: int, node: ca.MX, known: dict[int, int]) -> int:
    """Scalar operations of one instruction on matrices."""
    if instruction == ca.OP_CALL:
        return most_operations(node.which_function(), known)
    if instruction == ca.OP_MTIMES:
        # The product of the second and the third matrix is added to the first one; nothing is added to zeros.
        left, right = (ca.DM(node.dep(i).sparsity(), 1.0) for i in (1, 2))
        terms = (left @ right).nonzeros()
        first = node.dep(0)
        onto_zeros = first.is_constant() and not any(first.to_DM().nonzeros())
        return 2 * int(sum(terms)) - (len(terms) if onto_zeros else 0)
    # A power becomes several products.
    powers = (ca.OP_POW, ca.OP_CONSTPOW)
    if instruction not in powers and (node.is_unary() or node.is_binary()):
        return int(node.nnz())
    # Any other kind, such as a scalar product, is expanded with symbols as its arguments.
    before = [node.dep(i) for i in range(node.n_dep()) if not node.dep(i).is_constant()]
    symbols = [ca.MX.sym(f"before{i}", term.sparsity()) for i, term in enumerate(before)]
    (alone,) = ca.graph_substitute([node], before, symbols)
    return operations(ca.Function("node", symbols, [alone]))


def _scalar_operations(scalar: ca.Function) -> int:
    elements = scalar.instructions_sx().nz if scalar.find_functions(0) else []
    inside: dict[int, int] = {}
    total = 0
    for i in range(scalar.n_instructions()):
        kind = scalar.instruction_id(i)
        if kind == ca.OP_CALL:
            called = elements[i].which_function()
            if hash(called) not in inside:
                inside[hash(called)] = most_operations(called, {})
            total += inside[hash(called)]
        elif kind not in (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST):
            total += 1
    return total
