"""Memory of the library in C: a workspace that the caller provides, and stack."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Any

REAL, INTEGER = 8, 4
"""Bytes of a number in double precision, and of an int."""

FRAMES = 1800
"""Bytes of stack of all functions other than kernels, from the public one down."""


DEFINED = re.compile(r"MADE\((\w+)\)|(\w+)\(")
"""Pattern of the name at the definition of a function; functions for four numbers at a time have several names."""


def largest_room(generated: Mapping[str, str], kind: str) -> int:
    """Largest work memory that a kernel needs from its caller: numbers ("W"), or integers ("IW").

    Args:
        generated: source and header of the kernels by file name.
        kind: "W" or "IW".
    """
    return max(_rooms(generated, kind).values())


def _rooms(generated: Mapping[str, str], kind: str) -> dict[str, int]:
    """Work memory that each kernel needs from its caller."""
    header = "".join(text for file, text in generated.items() if file.endswith(".h"))
    return {name: int(size) for name, size in re.findall(rf"(\w+)_SZ_{kind} (\d+)", header)}


def stack_bytes(generated: Mapping[str, str], without_workspace: Collection[str] = ()) -> int:
    """Stack of a call in double precision, bytes: the need of the kernel with the largest one.

    A kernel of straight-line code keeps its values in local variables. Without optimisation all of them are on the
    stack, above the variables of the functions that it calls. The work memory of a kernel that is called without a
    workspace is there as well; other kernels use the workspace.

    Args:
        generated: source and header of the kernels by file name.
        without_workspace: names of the kernels that are called without a workspace.
    """
    rooms = _rooms(generated, "W")
    deepest = _on_calls(generated)
    needed = []
    for name in rooms:
        room = rooms[name] if name in without_workspace else 0
        needed.append(room + deepest[name])
    return REAL * max(needed) + FRAMES


def _on_calls(generated: Mapping[str, str]) -> dict[str, int]:
    """Count of numbers on the stack for each function of the kernels, including its deepest call."""
    included = [text for file, text in generated.items() if file.endswith("_in_fours.h")]
    sources = [text for file, text in generated.items() if file.endswith(".c")]
    text = "".join([*included, *sources])
    deepest: dict[str, int] = {}
    # Functions come before those that call them.
    for function in re.split(r"^(?=(?:static|CASADI_SYMBOL_EXPORT) )", text, flags=re.M)[1:]:
        head, _, rest = function.partition("{")
        # Text between a function and the next one holds none of its calls.
        body = rest.partition("\n}")[0]
        found = DEFINED.search(head)
        if found is None:
            # A table of numbers.
            continue
        name = found[1] or found[2]
        # A function that is written once calls the functions of its name for one number and for four.
        called = [word for word in re.findall(r"\w+", body) if word in deepest]
        deepest[name] = _locals(function) + max((deepest[word] for word in called), default=0)
    return deepest


def _locals(function: str) -> int:
    """Count of numbers in the local variables of a function; a vector of four counts as four."""
    single = re.findall(r"^ +casadi_real (a\d.*);$", function, flags=re.M)
    fours = re.findall(r"^ +FOUR (b\d.*);$", function, flags=re.M)
    return _variables(single) + 4 * _variables(fours)


def _variables(declared: list[str]) -> int:
    return sum(line.count(",") + 1 for line in declared)


def workspace_kb(words: Mapping[str, Any]) -> str:
    """Size of the workspace in double precision, kB, from the words of a library's sources."""
    size, inputs = words["unknowns"], words["input_room"]
    jacobian = words["factor_count"] + words["kept_steps"] * (size + 1)
    point = 3 * size + 1
    vectors = 7 * size + 2 * inputs
    derivatives = size * inputs + 7 * size
    rooms = ("kernel_reals", "linear_reals", "parameter_reals", "error_reals", "place_reals", "motion_reals")
    reals = 2 * jacobian + 3 * point + vectors + derivatives + sum(words.get(room, 0) for room in rooms)
    integers = 2 * (size + 3) + words["kernel_integers"] + words.get("motion_integers", 0)
    return f"{(REAL * reals + INTEGER * integers) / 1000:.1f}"
