"""Numbers, tables and records in C."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation


def table(name: str, values: Sequence[float]) -> str:
    """Write a constant array; an empty one is left out."""
    if not values:
        return ""
    kind = "int" if isinstance(values[0], int) else "real"
    return f"static const {kind} {name}[] = {{{numbers(values)}}};\n"


def numbers(values: Sequence[float]) -> str:
    """Write the entries of a constant array."""
    text = ", ".join(str(value) if isinstance(value, int) else f"(real){value!r}" for value in values)
    return text if len(text) < 60 else "\n" + textwrap.fill(text, 116, initial_indent="  ", subsequent_indent="  ")


def reals(name: str, values: FloatArray) -> str:
    """Write a constant array of floating-point numbers."""
    return f"static const real {name}[] = {{{numbers([float(value) for value in values])}}};"


def record(fields: Mapping[str, object]) -> str:
    """Write the initialiser of a record by its members."""
    return "{" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "}"


def record_table(kind: str, name: str, size: str, entries: Sequence[str]) -> str:
    """Write a constant array of records."""
    lines = ",\n".join(f"    {entry}" for entry in entries)
    return f"static const {kind} {name}[{size}] = {{\n{lines},\n}};"


def pairs(values: Sequence[complex] | np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return real and imaginary parts side by side."""
    return np.array([[complex(value).real, complex(value).imag] for value in values])


def initialiser(values: np.ndarray[Any, Any], real: str = "solver_real") -> str:
    """Write the initialiser of an array of real numbers."""
    if values.ndim == 0:
        return f"({real}){float(values)!r}"
    return "{" + ", ".join(initialiser(value, real) for value in values) + "}"


def method_words(method: Collocation, real: str = "solver_real") -> dict[str, str]:
    """Write the initialisers of nodes, tables and polynomials of a collocation method."""
    arrays = {
        "stage_nodes": method.nodes,
        "stage_table": method.matrix,
        "stage_table_squared": method.matrix_squared,
        "stage_polynomials": method.polynomials,
        "middle_values": method.values_at(0.5),
        "middle_integrals": method.integrals_at(0.5),
        "middle_double_integrals": method.double_integrals_at(0.5),
    }
    return {name: initialiser(values, real) for name, values in arrays.items()}
