"""What the library in C needs of memory: a workspace that the caller gives, and stack."""

from __future__ import annotations

import re
from collections.abc import Mapping

REAL, INTEGER = 8, 4
"""Bytes of a number in double precision, of an int."""

FRAMES = 2000
"""Bytes of stack for all functions that are no kernels, from the public one down."""


WITH_WORKSPACE = re.compile(
    r"_k_motion_|_k_(?:\d+_)?(?:residual|jacobian)$|_k_(?:residual|jacobian|input_jacobian)_\d+$"
)
"""Names of kernels that are called with a workspace alone, however large it is; those of parts have numbers."""


MADE = re.compile(r"\bMADE\((?!function\))(\w+)\)")
"""Names of functions in fours where they are written, but not in the definition of the macro."""


def largest_room(generated: Mapping[str, str], kind: str) -> int:
    """The most that any kernel asks its caller for: of numbers ("W"), of integers ("IW").

    Args:
        generated: source and header of the kernels by file name.
        kind: "W" or "IW".
    """
    return max(_rooms(generated, kind).values())


def _rooms(generated: Mapping[str, str], kind: str) -> dict[str, int]:
    """What each kernel asks its caller for."""
    header = "".join(text for file, text in generated.items() if file.endswith(".h"))
    return {name: int(size) for name, size in re.findall(rf"(\w+)_SZ_{kind} (\d+)", header)}


def stack_bytes(generated: Mapping[str, str]) -> int:
    """Stack that a call needs, in double precision.

    A kernel in straight-line code keeps its values in local variables, which all lie on the stack where nothing is
    optimised; functions without a workspace have the room of their kernel there as well.

    Args:
        generated: source and header of the kernels by file name.
    """
    source = "".join(text for file, text in generated.items() if file.endswith(".c"))
    functions = re.split(r"^(?=(?:static|CASADI_SYMBOL_EXPORT) )", source, flags=re.M)
    rooms = _rooms(generated, "W")
    on_stack = {name: 0 if WITH_WORKSPACE.search(name) else room for name, room in rooms.items()}
    included = [text for file, text in generated.items() if file.endswith("_in_fours.h")]
    in_fours = _locals_in_fours("".join([*included, source]))
    of_casadi = [function for function in functions if not MADE.search(function)]
    largest = max(map(_locals, of_casadi))
    largest += max((room for name, room in on_stack.items() if name not in in_fours), default=0)
    for name, room in on_stack.items():
        largest = max(largest, in_fours.get(name, 0) + room)
    return REAL * largest + FRAMES


def _locals(function: str) -> int:
    declared = re.findall(r"^  casadi_real (a\d.*);$", function, flags=re.M)
    return sum(line.count(",") + 1 for line in declared)


def _locals_in_fours(text: str) -> dict[str, int]:
    """Numbers on the stack of each function in fours, with the largest function that it calls."""
    needed: dict[str, int] = {}
    # Functions come before those that call them.
    for function in re.split(r"^(?=static )", text, flags=re.M)[1:]:
        name, *called = MADE.findall(function) or [""]
        if name and name not in needed:
            needed[name] = _of_fours(function) + max((needed[other] for other in called), default=0)
    return needed


def _of_fours(function: str) -> int:
    declared = re.findall(r"^  FOUR (b\d.*);$", function, flags=re.M)
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
