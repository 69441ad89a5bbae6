"""Which functions a function of scalars calls, as functions of scalars themselves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache

import casadi as ca

from cosserat_casadi.compiling.numbered import function_of
from cosserat_casadi.compiling.steps import program_of


@dataclass(frozen=True)
class Known:
    """A function by its hash, which it keeps.

    Attributes:
        key: the hash.
        function: the function.
    """

    key: int
    function: ca.Function = field(compare=False)


def called_functions(function: ca.Function, codes: Iterable[int] | None = None) -> dict[int, ca.Function]:
    """The function of scalars that each call of such a function is of, by the number of its instruction.

    Args:
        function: of scalar instructions (an ``SXFunction``).
        codes: its instructions, where they are known.
    """
    if codes is None:
        codes = map(function.instruction_id, range(function.n_instructions()))
    calls = [k for k, code in enumerate(codes) if code == ca.OP_CALL]
    if not calls:
        return {}
    elements = function.instructions_sx().nz
    called = {k: elements[k].which_function() for k in calls}
    return {k: _in_scalars(Known(hash(one), one)) for k, one in called.items()}


@cache
def _in_scalars(known: Known) -> ca.Function:
    """A function of scalars: one function for all calls of a function of matrices."""
    function = known.function
    # CasADi would write one that is kept as a call of itself.
    return function_of(program_of(function)).expand() if function.is_a("MXFunction") else function
