"""What the library in C needs of memory: a workspace that the caller gives, and stack."""

from __future__ import annotations

import re
from collections.abc import Mapping

REAL, INTEGER = 8, 4
"""Bytes of a number in double precision, of an int."""

FRAMES = 2000
"""Bytes of stack for all functions that are no kernels, from the public one down."""


WITH_WORKSPACE = re.compile(r"_k_motion_|_k_(?:\d+_)?(?:residual|jacobian)$")
"""Names of kernels that are called with a workspace alone, however large it is."""


def largest_room(generated: Mapping[str, str], kind: str, *, on_stack: bool = False) -> int:
    """The most that any kernel asks its caller for: of numbers ("W"), of integers ("IW").

    Args:
        generated: source and header of the kernels by file name.
        kind: "W" or "IW".
        on_stack: whether kernels are left out that never find it on the stack.
    """
    header = "".join(text for file, text in generated.items() if file.endswith(".h"))
    rooms = re.findall(rf"(\w+)_SZ_{kind} (\d+)", header)
    return max(int(size) for name, size in rooms if not on_stack or not WITH_WORKSPACE.search(name))


def stack_bytes(generated: Mapping[str, str]) -> int:
    """Stack that a call needs, in double precision.

    A kernel in straight-line code keeps its values in local variables, which all lie on the stack where nothing is
    optimised; functions without a workspace have the room of their kernel there as well.

    Args:
        generated: source and header of the kernels by file name.
    """
    source = "".join(text for file, text in generated.items() if file.endswith(".c"))
    functions = re.split(r"^(?=(?:static|CASADI_SYMBOL_EXPORT) )", source, flags=re.M)
    locals_of_largest = max(_locals(function) for function in functions)
    largest = locals_of_largest + largest_room(generated, "W", on_stack=True)
    for file, text in generated.items():
        if file.endswith("_in_fours.h"):
            largest = max(largest, _locals_in_fours(text))
    return REAL * largest + FRAMES


def _locals(function: str) -> int:
    declared = re.findall(r"^  casadi_real (a\d.*);$", function, flags=re.M)
    return sum(line.count(",") + 1 for line in declared)


def _locals_in_fours(text: str) -> int:
    """Numbers on the stack of the largest kernel in fours, with the largest function that it calls."""
    functions = re.split(r"^(?=static )", text, flags=re.M)
    largest = 0
    for kernel in re.findall(r"^static int MADE\((\w+)\)", text, flags=re.M):
        own = [_locals(function) for function in functions if f"MADE({kernel})(" in function.partition("{")[0]]
        # A long kernel is a row of parts, which call the others.
        parts = []
        called = []
        for function in functions:
            head = function.partition("{")[0]
            if f"MADE({kernel}_part_" in head:
                parts.append(_locals(function))
            elif f"MADE({kernel}_" in head:
                called.append(_of_fours(function))
        largest = max(largest, sum(own) + max(parts, default=0) + max(called, default=0))
    return largest


def _of_fours(function: str) -> int:
    declared = re.findall(r"^  four (b\d.*);$", function, flags=re.M)
    variables: int = sum(line.count(",") + 1 for line in declared)
    return _locals(function) + 4 * variables


def workspace_bytes(size: int, inputs: int, factors: int, reuses: int, room: tuple[int, int], extra: int) -> int:
    """Size of the workspace in double precision.

    Args:
        size: number of unknowns.
        inputs: number of inputs, at least one.
        factors: numbers in a factorised Jacobian.
        reuses: most steps with one Jacobian.
        room: numbers and integers that kernels ask for.
        extra: numbers that the block elimination works in.
    """
    jacobian = factors + reuses * (size + 1)
    point = 3 * size + 1
    vectors = 7 * size + 2 * inputs
    derivatives = size * inputs + 7 * size
    reals = 2 * jacobian + 3 * point + vectors + derivatives + extra + room[0]
    integers = 2 * (size + 3) + room[1]
    return REAL * reals + INTEGER * integers
