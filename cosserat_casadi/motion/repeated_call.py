"""A CasADi function called over and over: its arguments and its result are arrays that are written in place.

A call through matrices takes as long as the residual of a short rod itself.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import accumulate
from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.compiling.scalar_program import ScalarProgram
from cosserat_casadi.compiling.shared_records import address_of
from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.typing import FloatArray

MOST_LOADED = 256
"""Functions of shared objects that a process keeps loaded."""


@dataclass(frozen=True)
class MachineCode:
    """A function in a shared object, and the arguments of a call of it in C, as :class:`RepeatedCall` makes it.

    Attributes:
        address: of the function.
        arguments: addresses of its arguments.
        results: addresses of its results.
        integers: memory of the function for whole numbers.
        scratch: memory of the function for real numbers.
        library: the library that has the function.
        path: path of the library's file.
        evaluate: calls the function.
    """

    address: int
    arguments: npt.NDArray[np.uintp]
    results: npt.NDArray[np.uintp]
    integers: npt.NDArray[np.longlong]
    scratch: FloatArray
    library: ctypes.CDLL
    path: str
    evaluate: Callable[[], object]


class RepeatedCall:
    """The first results of a function, dense matrices, for dense arguments.

    Args:
        function: the function.
        results: how many of its results are wanted.
        library: shared object that has it, where it is in machine code.

    Attributes:
        arguments: arrays that the arguments are read from.
        results: matrices that the results are written to.
        evaluate: reads the arguments and writes the results.
        code: the function in machine code; None where CasADi's virtual machine runs it.
        program: of the function, for a loop in C; None where none was written.
        program_after: gives the program, or None, when a motion has taken so many iterations without one; None where
            none is to be written.

    Raises:
        ValueError: an argument or a result is not dense.
    """

    def __init__(self, function: ca.Function, results: int = 1, library: str | os.PathLike[str] | None = None) -> None:
        signature = _signature(function, results) if library is None else _kept_signature(function, results)
        sizes = [*signature.arguments, *(rows * columns for rows, columns in signature.results)]
        ends = list(accumulate(sizes))
        # One block: an array for each, and its address, would take longer than calls.
        block = np.zeros(ends[-1])
        parts = [block[end - size : end] for size, end in zip(sizes, ends, strict=True)]
        count = len(signature.arguments)
        self.arguments = parts[:count]
        # CasADi stores column by column.
        self.results = [
            part.reshape(shape, order="F") for part, shape in zip(parts[count:], signature.results, strict=True)
        ]
        self.program: ScalarProgram | None = None
        self.program_after: Callable[[int], ScalarProgram | None] | None = None
        self.code: MachineCode | None = None
        if library is None:
            buffer, self.evaluate = function.buffer()
            for number, part in enumerate(parts):
                if number < count:
                    buffer.set_arg(number, part.data)
                else:
                    buffer.set_res(number - count, part.data)
            # The evaluation reads and writes the buffer's memory: it has to live as long.
            self._buffer = buffer
            return
        first = block.ctypes.data
        places = [first + block.itemsize * (end - size) for size, end in zip(sizes, ends, strict=True)]
        self.code = _machine_code(function.name(), os.fspath(library), signature, places)
        self.evaluate = self.code.evaluate

    @property
    def library(self) -> str | None:
        """The shared object that has the function; None where CasADi's virtual machine runs it."""
        return None if self.code is None else self.code.path

    def __call__(self, *values: FloatArray) -> FloatArray:
        """The first result, column after column, as an array of shape (n,), for arguments in their order."""
        self._evaluated(values)
        return self.results[0].flatten(order="F")

    def matrices(self, *values: FloatArray) -> list[FloatArray]:
        """All results for arguments in their order."""
        self._evaluated(values)
        # Column after column, as they are: rows are made of them where they are asked for.
        return [result.copy(order="K") for result in self.results]

    def _evaluated(self, values: Sequence[FloatArray]) -> None:
        for argument, value in zip(self.arguments, values, strict=True):
            argument[:] = value
        self.evaluate()


class Signature(NamedTuple):
    """What a call of a function needs memory for.

    Attributes:
        arguments: entries of each argument.
        results: shapes of the results that are wanted.
        work: numbers of addresses of arguments and of results, of whole numbers and of real numbers of its work.
    """

    arguments: tuple[int, ...]
    results: tuple[tuple[int, int], ...]
    work: tuple[int, int, int, int]


def _signature(function: ca.Function, results: int) -> Signature:
    """The memory for a call of a function whose first results are wanted.

    Raises:
        ValueError: an argument or a result is not dense.
    """
    arguments = [function.sparsity_in(i) for i in range(function.n_in())]
    wanted = [function.sparsity_out(i) for i in range(results)]
    for sparsity in (*arguments, *wanted):
        if not sparsity.is_dense():
            raise ValueError(f"{function.name()} has an argument or a result that is not dense")
    work = function.sz_arg(), function.sz_res(), max(function.sz_iw(), 1), max(function.sz_w(), 1)
    return Signature(tuple(s.nnz() for s in arguments), tuple(s.shape for s in wanted), work)


_kept_signature = lru_cache(maxsize=MOST_LOADED)(_signature)
"""Signatures of functions of shared objects, of which each model asks for new calls."""


def _machine_code(name: str, library: str, signature: Signature, places: Sequence[int]) -> MachineCode:
    """A function in a shared object, called with arguments and results at these addresses."""
    loaded = _loaded(library)
    function = getattr(loaded, name)
    count = len(signature.arguments)
    arguments, results = (np.zeros(size, dtype=np.uintp) for size in signature.work[:2])
    arguments[:count] = places[:count]
    results[: len(signature.results)] = places[count:]
    integers, scratch = np.zeros(signature.work[2], dtype=np.longlong), np.zeros(signature.work[3])
    memory = [ctypes.c_void_p(array.ctypes.data) for array in (arguments, results, integers, scratch)]
    return MachineCode(
        address_of(function), arguments, results, integers, scratch, loaded, library, partial(function, *memory, 0)
    )


class Libraries(NamedTuple):
    """Shared objects with the functions of a motion; None where CasADi's virtual machine runs them.

    Attributes:
        residual: has inverse dynamics, and the functions that every iteration calls.
        jacobians: has its derivatives, and the other functions that equations are linearised with.
    """

    residual: str | None = None
    jacobians: str | None = None


INTERPRETED = Libraries()
"""Functions in CasADi's virtual machine, without shared objects."""


@lru_cache(maxsize=MOST_LOADED)
def external(name: str, library: str) -> ca.Function:
    """A function of a shared object, loaded once in a process: a file under the same name has the same contents."""
    return ca.external(name, library)


@lru_cache(maxsize=MOST_LOADED)
def _loaded(library: str) -> ctypes.CDLL:
    """A shared object, loaded once in a process: a file under the same name has the same contents."""
    return ctypes.CDLL(library)


def repeated(function: ca.Function, library: str | None, results: int = 1, *, as_scalars: bool = True) -> RepeatedCall:
    """A call of a function: by its name in a shared object, or, without one, in CasADi's virtual machine.

    Args:
        function: the function.
        library: the shared object; None without one.
        results: how many of its results are wanted.
        as_scalars: whether the virtual machine runs it as scalars, which takes a tenth to two thirds of the time.
    """
    if library is not None:
        return RepeatedCall(external(function.name(), library), results, library)
    return RepeatedCall(function.expand() if as_scalars and not chooses(function) else function, results)
