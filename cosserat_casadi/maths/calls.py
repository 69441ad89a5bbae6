"""Which functions a function calls."""

from __future__ import annotations

import casadi as ca


def called_functions(function: ca.Function) -> dict[int, ca.Function]:
    """The function that each call of a scalar function is of, by the number of its instruction.

    Args:
        function: of scalar instructions (an ``SXFunction``).
    """
    calls = [k for k in range(function.n_instructions()) if function.instruction_id(k) == ca.OP_CALL]
    if not calls:
        return {}
    elements = function.instructions_sx().nz
    return {k: elements[k].which_function() for k in calls}


def chooses(function: ca.Function) -> bool:
    """Whether a function calls another one, deep inside too, or leaves it out, by a value.

    Written as scalars, or as a program without branches, it would compute all that it may leave out.
    """
    return any(called.class_name() == "Switch" for called in function.find_functions())
