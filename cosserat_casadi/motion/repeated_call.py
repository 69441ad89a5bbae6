"""A CasADi function called over and over: its arguments and its result are arrays that are written in place.

A call through matrices takes as long as the residual of a short rod itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray


class RepeatedCall:
    """The first results of a function, dense matrices, for dense arguments.

    Args:
        function: the function.
        results: how many of its results are wanted.

    Raises:
        ValueError: an argument or a result is not dense.
    """

    def __init__(self, function: ca.Function, results: int = 1) -> None:
        arguments = [function.sparsity_in(i) for i in range(function.n_in())]
        wanted = [function.sparsity_out(i) for i in range(results)]
        for sparsity in (*arguments, *wanted):
            if not sparsity.is_dense():
                raise ValueError(f"{function.name()} has an argument or a result that is not dense")
        buffer, self._evaluate = function.buffer()
        self._arguments = [np.zeros(sparsity.nnz()) for sparsity in arguments]
        # CasADi stores column by column.
        self._results = [np.zeros(sparsity.shape, order="F") for sparsity in wanted]
        for number, argument in enumerate(self._arguments):
            buffer.set_arg(number, argument.data)
        for number, result in enumerate(self._results):
            buffer.set_res(number, result.ravel(order="K").data)
        # The evaluation reads and writes the buffer's memory: it has to live as long.
        self._buffer = buffer

    def __call__(self, *values: FloatArray) -> FloatArray:
        """The first result, column after column, as an array of shape (n,), for arguments in their order."""
        self._evaluated(values)
        return self._results[0].flatten(order="F")

    def matrices(self, *values: FloatArray) -> list[FloatArray]:
        """All results for arguments in their order."""
        self._evaluated(values)
        return [result.copy() for result in self._results]

    def _evaluated(self, values: Sequence[FloatArray]) -> None:
        for argument, value in zip(self._arguments, values, strict=True):
            argument[:] = value
        self._evaluate()
