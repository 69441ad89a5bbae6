"""A CasADi function that is called repeatedly, with arrays for arguments and results that are written in place.

An ordinary call with CasADi matrices takes as long as the residual of a short rod itself.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.compiling.scalar_program import ScalarProgram
from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.typing import FloatArray

MOST_LOADED = 256
"""Number of functions of shared objects that a process keeps loaded."""


@dataclass(frozen=True)
class MachineCode:
    """A function in a shared object, and the memory of a :class:`RepeatedCall` of it, for calls in C.

    Attributes:
        function: the function; it keeps its library loaded.
        address: address of the function.
        arguments: addresses of its arguments.
        results: addresses of its results.
        integers: work memory of the function for integers.
        scratch: work memory of the function for real numbers.
        path: path of the library's file.
    """

    function: Callable[..., int]
    address: int
    arguments: npt.NDArray[np.uintp]
    results: npt.NDArray[np.uintp]
    integers: npt.NDArray[np.longlong]
    scratch: FloatArray
    path: str

    @property
    def bound(self) -> Callable[[], int]:
        """The call of the function from Python."""
        arrays = (self.arguments, self.results, self.integers, self.scratch)
        return partial(self.function, *(array.ctypes.data for array in arrays), 0)


class RepeatedCall:
    """A call of a function with dense arguments, for its first results, which are dense matrices.

    Args:
        function: the function.
        results: number of results that are wanted, the first ones.
        library: shared object that contains the function in machine code; None without one.

    Attributes:
        arguments: arrays that the arguments are read from.
        results: matrices that the results are written to.
        evaluate: function that reads the arguments and writes the results.
        code: the function in machine code; None if CasADi's virtual machine runs it.
        program: program of the function for a loop in C; None if none was written.
        at_stages: the function in machine code at the three stages of a step, a column each; None if there is none.
        program_after: function of the iterations that a motion has taken without a program ↦ the program, or None if
            it does not pay yet; None if no program is to be written.

    Raises:
        ValueError: an argument or a result is not dense.
    """

    def __init__(self, function: ca.Function, results: int = 1, library: str | os.PathLike[str] | None = None) -> None:
        sizes = _sizes(function, results)
        self.arguments = [np.zeros(count) for count in sizes.arguments]
        # CasADi stores column by column.
        self.results = [np.zeros(shape, order="F") for shape in sizes.results]
        self.program: ScalarProgram | None = None
        self.at_stages: RepeatedCall | None = None
        self.program_after: Callable[[int], ScalarProgram | None] | None = None
        self.code: MachineCode | None = None
        self.evaluate: Callable[[], object]
        if library is not None:
            self.code = self._machine_code(function.name(), os.fspath(library), sizes)
            self.evaluate = self.code.bound
            return
        # The evaluation reads and writes the buffer's memory: it has to live as long.
        self._buffer, self.evaluate = function.buffer()
        for number, argument in enumerate(self.arguments):
            self._buffer.set_arg(number, argument.data)
        for number, result in enumerate(self.results):
            self._buffer.set_res(number, result.ravel(order="K").data)

    @property
    def library(self) -> str | None:
        """The shared object that contains the function; None if CasADi's virtual machine runs it."""
        return None if self.code is None else self.code.path

    def __call__(self, *values: FloatArray) -> FloatArray:
        """Return the first result, column after column, shape (n,), for arguments in their order."""
        self._evaluated(values)
        return self.results[0].flatten(order="F")

    def matrices(self, *values: FloatArray) -> list[FloatArray]:
        """Return all results for arguments in their order."""
        self._evaluated(values)
        # Column after column, as they are: rows are made of them where they are asked for.
        return [result.copy(order="K") for result in self.results]

    def _evaluated(self, values: Sequence[FloatArray]) -> None:
        for argument, value in zip(self.arguments, values, strict=True):
            argument[:] = value
        self.evaluate()

    def _machine_code(self, name: str, library: str, sizes: _Sizes) -> MachineCode:
        function, address = _entry(name, library)
        pointers_in, pointers_out, integers_wanted, reals_wanted = sizes.work
        arguments, results = (np.zeros(size, dtype=np.uintp) for size in (pointers_in, pointers_out))
        arguments[: len(self.arguments)] = [array.ctypes.data for array in self.arguments]
        results[: len(self.results)] = [array.ctypes.data for array in self.results]
        integers, scratch = np.zeros(integers_wanted, dtype=np.longlong), np.zeros(reals_wanted)
        return MachineCode(function, address, arguments, results, integers, scratch, library)


class _Sizes(NamedTuple):
    """Sizes of the arrays of a function in C.

    Attributes:
        arguments: number of entries of each argument.
        results: shape of each result.
        work: numbers of pointers to arguments and to results, and of integers and real numbers of its work memory.
    """

    arguments: tuple[int, ...]
    results: tuple[tuple[int, int], ...]
    work: tuple[int, int, int, int]


@lru_cache(maxsize=MOST_LOADED)
def _sizes(function: ca.Function, results: int) -> _Sizes:
    """Sizes of the arrays of a function; to ask CasADi for them takes longer than a call of a short function.

    Raises:
        ValueError: an argument or a result is not dense.
    """
    arguments = [function.sparsity_in(i) for i in range(function.n_in())]
    wanted = [function.sparsity_out(i) for i in range(results)]
    if not all(sparsity.is_dense() for sparsity in (*arguments, *wanted)):
        raise ValueError(f"{function.name()} has an argument or a result that is not dense")
    work = function.sz_arg(), function.sz_res(), max(function.sz_iw(), 1), max(function.sz_w(), 1)
    counts = tuple(sparsity.nnz() for sparsity in arguments)
    return _Sizes(counts, tuple(sparsity.shape for sparsity in wanted), work)


class Libraries(NamedTuple):
    """Shared objects with the functions of a motion; None if CasADi's virtual machine runs them.

    Attributes:
        residual: shared object with inverse dynamics, and the functions that every iteration calls.
        jacobians: shared object with its derivatives, and the other functions of linearised equations.
    """

    residual: str | None = None
    jacobians: str | None = None


INTERPRETED = Libraries()
"""Functions in CasADi's virtual machine, without shared objects."""


@lru_cache(maxsize=MOST_LOADED)
def external(name: str, library: str) -> ca.Function:
    """Load a function of a shared object, once in a process: the name of a file determines its contents."""
    return ca.external(name, library)


@lru_cache(maxsize=MOST_LOADED)
def _entry(name: str, library: str) -> tuple[Callable[..., int], int]:
    """Load a function of a shared object and its address, once: the name of a file determines its contents."""
    function = getattr(ctypes.CDLL(library), name)
    function.argtypes = [*[ctypes.c_void_p] * 4, ctypes.c_int]
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None, "a function has an address"
    return function, address


@lru_cache(maxsize=MOST_LOADED)
def has_function(name: str, library: str) -> bool:
    """Whether a shared object has a function."""
    return hasattr(ctypes.CDLL(library), name)


def repeated(function: ca.Function, library: str | None, results: int = 1, *, as_scalars: bool = True) -> RepeatedCall:
    """Make a repeated call of a function: by its name in a shared object, or without one in CasADi's virtual machine.

    Args:
        function: the function.
        library: the shared object; None without one.
        results: number of results that are wanted, the first ones.
        as_scalars: whether the virtual machine runs it in scalars, which takes a tenth to two thirds of the time.
    """
    if library is not None:
        return RepeatedCall(external(function.name(), library), results, library)
    return RepeatedCall(function.expand() if as_scalars and not chooses(function) else function, results)
