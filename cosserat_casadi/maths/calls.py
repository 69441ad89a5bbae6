"""Which functions a function calls."""

from __future__ import annotations

from collections.abc import Iterable

import casadi as ca


def called_functions(function: ca.Function, codes: Iterable[int] | None = None) -> dict[int, ca.Function]:
    """The function that each call of a scalar function is of, by the number of its instruction.

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
    return {k: elements[k].which_function() for k in calls}


def functions_within(function: ca.Function) -> list[ca.Function]:
    """The functions that a function calls, deep inside too, once each.

    CasADi 3.7 does not list what a map maps.
    """
    known: dict[int, ca.Function] = {}
    callers = [function]
    while callers:
        caller = callers.pop()
        called = list(caller.find_functions(0))
        if caller.is_a("Map"):
            called.append(caller.info()["f"])
        fresh = {each.__hash__(): each for each in called if each.__hash__() not in known}
        known.update(fresh)
        callers.extend(fresh.values())
    return list(known.values())


def chooses(function: ca.Function) -> bool:
    """Whether a function calls another one, deep inside too, or leaves it out, by a value.

    Written as scalars, or as a program without branches, it would compute all that it may leave out.
    """
    return any(called.class_name() == "Switch" for called in functions_within(function))
