"""What the library in C needs of memory: a workspace that the caller gives, and stack."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

REAL, INTEGER = 8, 4
"""Bytes of a number in double precision, of an int."""

FRAMES = 2000
"""Bytes of stack for all functions that are no kernels, from the public one down."""


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


def stack_bytes(generated: Mapping[str, str], without_workspace: Collection[str] = ()) -> int:
    """Stack that a call needs, in double precision: that of the kernel which needs most.

    A kernel in straight-line code keeps its values in local variables, which all lie on the stack where nothing is
    optimised, with those of the functions that it calls, one below the other. A kernel that is called without a
    workspace has its room there as well; all others work in the room of the workspace.

    Args:
        generated: source and header of the kernels by file name.
        without_workspace: names of the kernels that are called without one.
    """
    rooms = _rooms(generated, "W")
    deepest = _on_calls(generated)
    needed = []
    for name in rooms:
        room = rooms[name] if name in without_workspace else 0
        needed.append(room + deepest[name])
    return REAL * max(needed) + FRAMES


def _on_calls(generated: Mapping[str, str]) -> dict[str, int]:
    """Numbers in local variables of each function of the kernels, with those of the deepest of its calls."""
    deepest: dict[str, int] = {}
    for file, text in generated.items():
        if file.endswith("_in_fours.h"):
            deepest |= _locals_in_fours(text)
    for file, text in generated.items():
        if file.endswith(".c"):
            deepest |= _locals_of_calls(text)
    return deepest


def _locals_of_calls(source: str) -> dict[str, int]:
    """Numbers on the stack of each function in straight-line code, with the largest function that it calls."""
    needed: dict[str, int] = {}
    # Functions come before those that call them.
    for function in re.split(r"^(?=(?:static|CASADI_SYMBOL_EXPORT) )", source, flags=re.M)[1:]:
        head, _, body = function.partition("{")
        defined = re.search(r"(\w+)\(", head)
        if defined is None:
            # A table of numbers.
            continue
        called = [name for name in re.findall(r"(\w+)\(", body) if name in needed]
        needed[defined[1]] = _locals(function) + max((needed[name] for name in called), default=0)
    return needed


def _locals(function: str) -> int:
    declared = re.findall(r"^  casadi_real (a\d.*);$", function, flags=re.M)
    return sum(line.count(",") + 1 for line in declared)


def _locals_in_fours(text: str) -> dict[str, int]:
    """Numbers on the stack of each function in fours, with the largest function that it calls."""
    needed: dict[str, int] = {}
    # Functions come before those that call them.
    for function in re.split(r"^(?=static )", text, flags=re.M)[1:]:
        name, *called = re.findall(r"\bMADE\((\w+)\)", function)
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
