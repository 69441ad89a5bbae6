"""A CasADi function called over and over: its arguments and its result are arrays that are written in place.

A call through matrices takes as long as the residual of a short rod itself.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray


class RepeatedCall:
    """The first result of a function, a dense column, for dense arguments.

    Args:
        function: the function.

    Raises:
        ValueError: an argument or the result is not dense.
    """

    def __init__(self, function: ca.Function) -> None:
        arguments = [function.sparsity_in(i) for i in range(function.n_in())]
        for sparsity in (*arguments, function.sparsity_out(0)):
            if not sparsity.is_dense():
                raise ValueError(f"{function.name()} has an argument or a result that is not dense")
        buffer, self._evaluate = function.buffer()
        self._arguments = [np.zeros(sparsity.nnz()) for sparsity in arguments]
        self._result = np.zeros(function.nnz_out(0))
        for number, argument in enumerate(self._arguments):
            buffer.set_arg(number, argument.data)
        buffer.set_res(0, self._result.data)
        # The evaluation reads and writes the buffer's memory: it has to live as long.
        self._buffer = buffer

    def __call__(self, *values: FloatArray) -> FloatArray:
        """The result, shape (n,), for arguments in their order."""
        for argument, value in zip(self._arguments, values, strict=True):
            argument[:] = value
        self._evaluate()
        return self._result.copy()
