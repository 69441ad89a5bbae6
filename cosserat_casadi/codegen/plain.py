"""Functions of a compiled library as CasADi functions without derivatives."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray

EXPORT_WITH = "export the folder with derivatives: export(..., derivatives=True), or cosserat export --derivatives"
IN_PYTHON = "differentiate the model's own"
"""Remedies for a derivative that a folder can contain, and for one that it never contains."""

Shapes = dict[str, tuple[int, int]]

Evaluate = Callable[[Sequence[FloatArray]], Sequence[FloatArray]]
"""Function of argument vectors ↦ results."""


class PlainFunction(ca.Callback):  # type: ignore[misc]
    """A function without derivatives, whose error on a derivative names the remedy.

    Args:
        name: name of the function.
        arguments: shape of each argument by name.
        results: shape of each result by name.
        evaluate: function that computes the results.
        remedy: remedy for a missing derivative.
    """

    def __init__(self, name: str, arguments: Shapes, results: Shapes, evaluate: Evaluate, remedy: str) -> None:
        ca.Callback.__init__(self)
        self._arguments = arguments
        self._results = results
        self._evaluate = evaluate
        self._remedy = remedy
        self.construct(name, {})

    def get_n_in(self) -> int:
        """Number of arguments."""
        return len(self._arguments)

    def get_n_out(self) -> int:
        """Number of results."""
        return len(self._results)

    def get_name_in(self, i: int) -> str:
        """Name of an argument."""
        return list(self._arguments)[i]

    def get_name_out(self, i: int) -> str:
        """Name of a result."""
        return list(self._results)[i]

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Shape of an argument."""
        return ca.Sparsity.dense(*list(self._arguments.values())[i])

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Shape of a result."""
        return ca.Sparsity.dense(*list(self._results.values())[i])

    def eval(self, arguments: Sequence[ca.DM]) -> list[ca.DM]:
        """Evaluate the results."""
        vectors = [np.ascontiguousarray(argument.full().ravel()) for argument in arguments]
        return [ca.DM(result) for result in self._evaluate(vectors)]

    def has_jacobian(self) -> bool:
        """Return True, so that CasADi asks for the Jacobian and :meth:`get_jacobian` explains why there is none."""
        return True

    def get_jacobian(self, *_: Any) -> ca.Function:
        """Refuse the Jacobian, with the remedy.

        Raises:
            NotImplementedError: always.
        """
        raise NotImplementedError(f"{self.name()} was compiled without derivatives: {self._remedy}")


def pointer(array: FloatArray) -> Any:
    """Pass an array as an argument of a function in C."""
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def vector(value: npt.ArrayLike, size: int, name: str) -> FloatArray:
    """Convert numbers to a vector of a known size.

    Raises:
        ValueError: there are more or fewer numbers; the error mentions the name.
    """
    numbers = np.ascontiguousarray(value, dtype=np.float64).ravel()
    if len(numbers) != size:
        raise ValueError(f"{name} must have {size} numbers, got {len(numbers)}")
    return numbers
