"""Kernels for values that several functions of scalars compute from common arguments.

Residual, tip and sections of a rod begin with common kinematics. Each value has the set of functions that need it. If
the values of one set are many, they form a kernel, which returns the values that are read outside of it, and reads the
values of kernels that more functions share.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise

import casadi as ca

from cosserat_casadi.compiling.listing import Called, Computed, Listing
from cosserat_casadi.compiling.printed_kernels import PrintedKernel
from cosserat_casadi.compiling.scalars_in_c import ColumnedFunction, columns_in_fours, scalars_in_c, shared_in_c
from cosserat_casadi.maths.calls import with_shared_terms

FEWEST_SHARED = 100
"""Least number of shared values that form a kernel; for fewer, a call saves little code."""


def with_shared_kernels(written: Sequence[ca.Function | ColumnedFunction], name: str) -> list[PrintedKernel]:
    """Write functions in C that call kernels for the values that they share.

    Args:
        written: functions of scalars with dense results and a common first argument. Further arguments of equal names
            are also common, up to the first whose names differ.
        name: prefix of the names of kernels, before their numbers.

    Raises:
        UnknownOperationError: there is an operation that has no form here.
    """
    scalars = [one.form.function if isinstance(one, ColumnedFunction) else one for one in written]
    functions, kernels = _Sharing(scalars, name).functions_and_kernels()
    printed = []
    for one, function in zip(written, functions, strict=True):
        if isinstance(one, ColumnedFunction):
            printed.append(columns_in_fours(replace(one.form, function=function), one.signature, kernels))
        else:
            printed.append(scalars_in_c(function, function, kernels=kernels))
    return printed


def _arguments_of(function: ca.Function, known: dict[tuple[str, ...], ca.SX]) -> list[ca.SX]:
    """Symbols of the arguments of a function, shared with other functions as long as the names are equal.

    Args:
        function: the function.
        known: symbols of other functions, by the names of all arguments up to each; new ones are added.
    """
    # The first one is the same, whatever it is called.
    names = ["x", *function.name_in()[1:]]
    symbols = []
    for i, name in enumerate(names):
        symbols.append(known.setdefault(tuple(names[: i + 1]), ca.SX.sym(name, function.sparsity_in(i))))
    return symbols


class _Sharing:
    """Extractor of the kernels that functions share.

    Sets of functions are integers with a bit for each function.
    """

    def __init__(self, functions: Sequence[ca.Function], name: str) -> None:
        self._functions = functions
        self._name = name
        known: dict[tuple[str, ...], ca.SX] = {}
        self._arguments = [_arguments_of(function, known) for function in functions]
        results = []
        for function, arguments in zip(functions, self._arguments, strict=True):
            results.append(ca.vertcat(*map(ca.vec, function.call(arguments))))
        symbols = list(known.values())
        self._listing = Listing(with_shared_terms("joint", symbols, results))
        self._read = self._listing.known_arguments(symbols)
        self._homes = self._homes_of_values()
        self._handed_over = self._read_elsewhere()
        self._kernels: dict[int, ca.Function] = {}
        self._printed: dict[int, PrintedKernel] = {}

    def functions_and_kernels(self) -> tuple[list[ca.Function], dict[int, PrintedKernel]]:
        """Return the functions, which call the kernels, and the kernels in C by the hash of their functions."""
        for home in sorted(self._handed_over, key=lambda home: (-home.bit_count(), home)):
            self._add_kernel(home)
        kernels = {hash(kernel): self._printed[home] for home, kernel in self._kernels.items()}
        return [self._function(i) for i in range(len(self._functions))], kernels

    def _homes_of_values(self) -> list[int]:
        """Set of functions whose kernel computes each value; 0 if each function computes the value itself."""
        listing = self._listing
        users = [0] * len(listing.values)
        for i, output in enumerate(listing.outputs):
            for number in output.values():
                users[number] |= 1 << i
        for number in reversed(range(len(users))):
            value = listing.values[number]
            if isinstance(value, Called):
                results = listing.calls[value.call].results
                for result in results:
                    users[results[0]] |= users[result]
                for result in results:
                    users[result] = users[results[0]]
            for operand in listing.operands(number):
                users[operand] |= users[number]
        # A value that depends on an argument of one function is computed by that function.
        homes = []
        for number, value in enumerate(listing.values):
            shared = users[number].bit_count() > 1 and isinstance(value, Computed | Called)
            homes.append(users[number] if shared else 0)
        counts = Counter(homes)
        return [home if counts[home] >= FEWEST_SHARED else 0 for home in homes]

    def _read_elsewhere(self) -> dict[int, list[int]]:
        """Numbers of the values that each kernel returns, by its set of functions."""
        handed_over: dict[int, set[int]] = defaultdict(set)
        for number, home in enumerate(self._homes):
            for operand in self._listing.operands(number):
                if self._homes[operand] not in (0, home):
                    handed_over[self._homes[operand]].add(operand)
        for number in self._listing.wanted():
            if self._homes[number]:
                handed_over[self._homes[number]].add(number)
        return {home: sorted(numbers) for home, numbers in handed_over.items()}

    def _add_kernel(self, home: int) -> None:
        """Add the kernel of the values of a set, which reads the results of kernels of larger sets."""
        symbols = [ca.SX.sym("shared", len(self._handed_over[other])) for other in self._larger(home)]
        entries = [symbol.nonzeros() for symbol in symbols]
        wanted = self._handed_over[home]
        expressions = self._expressions(wanted, dict(zip(self._larger(home), entries, strict=True)))
        arguments = [*self._common(home), *symbols]
        words = [f"given_{i}" for i in range(len(arguments))]
        results = [ca.vertcat(*[expressions[number] for number in wanted])]
        name = f"{self._name}_{len(self._kernels)}"
        kernel = ca.Function(name, arguments, results, words, ["shared"], {"never_inline": True})
        earlier = [self._printed[other] for other in self._larger(home)]
        first = max((printed.reals for printed in self._printed.values()), default=0)
        self._printed[home] = shared_in_c(kernel, earlier, first)
        self._kernels[home] = kernel

    def _common(self, home: int) -> list[ca.SX]:
        """Arguments with which all functions of a set begin; the kernel of the set takes them in place."""
        first, *others = [arguments for i, arguments in enumerate(self._arguments) if home >> i & 1]
        common = list[ca.SX]()
        for places in zip(first, *others, strict=False):
            if any(symbol is not places[0] for symbol in places):
                break
            common.append(places[0])
        return common

    def _larger(self, users: int) -> list[int]:
        """The kernels of larger sets that contain this one, in the order of their calls."""
        return [home for home in self._kernels if home & users == users != home]

    def _function(self, i: int) -> ca.Function:
        """Make the i-th function, which calls its kernels."""
        function = self._functions[i]
        results: dict[int, ca.SX] = {}
        for home, kernel in self._kernels.items():
            if home >> i & 1:
                arguments = [*self._common(home), *(results[other] for other in self._larger(home))]
                (results[home],) = kernel.call(arguments, False, True)
        handed_over = {home: result.nonzeros() for home, result in results.items()}
        expressions = self._expressions(self._listing.outputs[i].values(), handed_over)
        entries = self._listing.entries(i, expressions)
        patterns = [function.sparsity_out(k) for k in range(function.n_out())]
        ends = accumulate((pattern.nnz() for pattern in patterns), initial=0)
        vectors = [ca.vertcat(*entries[begin:end]) for begin, end in pairwise(ends)]
        shaped = list(map(ca.SX, patterns, vectors))
        return ca.Function(function.name(), self._arguments[i], shaped, function.name_in(), function.name_out())

    def _expressions(self, wanted: Iterable[int], known: Mapping[int, Sequence[ca.SX]]) -> dict[int, ca.SX]:
        """Expressions of values, and of the values on which they depend, by number.

        Args:
            wanted: numbers of the values.
            known: entries of the result of each called kernel, by its set of functions.
        """
        expressions = dict(self._read)
        for home, entries in known.items():
            expressions |= zip(self._handed_over[home], entries, strict=True)
        return self._listing.expressions(wanted, expressions)
