"""Values that several functions of scalars compute alike from the same arguments, in kernels that they call.

Residual, tip and sections of a rod begin with the same kinematics. Each value is known by the set of functions that
need it. The values of one set are a kernel, if they are many, which returns the values that are read outside of it. It
reads the values of kernels that more functions share.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise

import casadi as ca

from cosserat_casadi.codegen.listing import Called, Computed, Constant, Listing, Read
from cosserat_casadi.codegen.printed_kernels import PrintedKernel
from cosserat_casadi.codegen.scalars_in_c import scalars_in_c
from cosserat_casadi.codegen.streams import call_of_entries

FEWEST_SHARED = 100
"""Values from which on they are a kernel: fewer are computed in each function."""

GIVEN = 2
"""Arguments that all functions have: unknowns and inputs."""


def with_shared_kernels(functions: Sequence[ca.Function], name: str) -> list[PrintedKernel]:
    """Functions in C, which call kernels of the values that they share.

    Args:
        functions: of scalars, with dense results, and with the same first two arguments.
        name: of the kernels, before their numbers.

    Raises:
        UnknownOperationError: there is an operation that has no form here.
    """
    return _Sharing(functions, name).printed()


class _Sharing:
    """Functions on their way to kernels that they share.

    Sets of functions are whole numbers with a bit for each function.
    """

    def __init__(self, functions: Sequence[ca.Function], name: str) -> None:
        self._functions = functions
        self._name = name
        first = functions[0]
        self._given = [ca.SX.sym(first.name_in(i), first.sparsity_in(i)) for i in range(GIVEN)]
        self._further = [[ca.SX.sym("further", f.sparsity_in(i)) for i in range(GIVEN, f.n_in())] for f in functions]
        symbols = [*self._given, *(symbol for further in self._further for symbol in further)]
        results = []
        for function, further in zip(functions, self._further, strict=True):
            results.append(ca.vertcat(*map(ca.vec, function.call([*self._given, *further]))))
        self._listing = Listing(ca.Function("joint", symbols, ca.cse(results)))
        self._entries = [symbol.nonzeros() for symbol in symbols]
        self._homes = self._homes_of_values()
        self._handed_over = self._read_elsewhere()
        self._kernels: dict[int, ca.Function] = {}

    def printed(self) -> list[PrintedKernel]:
        """The functions, which call the kernels."""
        for home in sorted(self._handed_over, key=lambda home: (-home.bit_count(), home)):
            self._add_kernel(home)
        kernels = {hash(kernel): scalars_in_c(kernel, kernel) for kernel in self._kernels.values()}
        functions = [self._function(i) for i in range(len(self._functions))]
        return [scalars_in_c(function, function, kernels=kernels) for function in functions]

    def _homes_of_values(self) -> list[int]:
        """For each value the set of functions whose kernel computes it; 0 for what each function computes itself."""
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
        homes: list[int] = []
        of_given: list[bool] = []
        for number, value in enumerate(listing.values):
            known = not isinstance(value, Read) or value.argument < GIVEN
            of_given.append(known and all(of_given[operand] for operand in listing.operands(number)))
            shared = of_given[number] and users[number].bit_count() > 1 and isinstance(value, Computed | Called)
            homes.append(users[number] if shared else 0)
        counts = Counter(homes)
        return [home if counts[home] >= FEWEST_SHARED else 0 for home in homes]

    def _read_elsewhere(self) -> dict[int, list[int]]:
        """Values that each kernel hands over, by its set of functions."""
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
        known = [symbol.nonzeros() for symbol in symbols]
        wanted = self._handed_over[home]
        made = self._values(wanted, dict(zip(self._larger(home), known, strict=True)))
        arguments = [*self._given, *symbols]
        words = [f"given_{i}" for i in range(len(arguments))]
        results = [ca.vertcat(*[made[number] for number in wanted])]
        name = f"{self._name}_{len(self._kernels)}"
        self._kernels[home] = ca.Function(name, arguments, results, words, ["shared"], {"never_inline": True})

    def _larger(self, users: int) -> list[int]:
        """The kernels of sets that hold this one, in the order in which they are called."""
        return [home for home in self._kernels if home & users == users != home]

    def _function(self, i: int) -> ca.Function:
        """One of the functions, which calls its kernels."""
        function = self._functions[i]
        results: dict[int, ca.SX] = {}
        for home, kernel in self._kernels.items():
            if home >> i & 1:
                arguments = [*self._given, *(results[other] for other in self._larger(home))]
                (results[home],) = kernel.call(arguments, False, True)
        made = self._values(
            list(self._listing.outputs[i].values()), {home: result.nonzeros() for home, result in results.items()}
        )
        entries = [ca.SX(0.0)] * self._listing.function.nnz_out(i)
        for entry, number in self._listing.outputs[i].items():
            entries[entry] = made[number]
        ends = [0]
        for k in range(function.n_out()):
            ends.append(ends[-1] + function.nnz_out(k))
        vectors = [ca.vertcat(*entries[begin:end]) for begin, end in pairwise(ends)]
        shaped = [ca.SX(function.sparsity_out(k), vector) for k, vector in enumerate(vectors)]
        symbols = [*self._given, *self._further[i]]
        return ca.Function(function.name(), symbols, shaped, function.name_in(), function.name_out())

    def _values(self, wanted: Sequence[int], known: Mapping[int, Sequence[ca.SX]]) -> dict[int, ca.SX]:
        """Expressions of values from the results of kernels, by set."""
        listing = self._listing
        made: dict[int, ca.SX] = {}
        for home, entries in known.items():
            made |= zip(self._handed_over[home], entries, strict=True)
        needed = {number for number in wanted if number not in made}
        for number in reversed(range(len(listing.values))):
            if number in needed:
                needed |= {operand for operand in listing.operands(number) if operand not in made}
        for number in sorted(needed):
            value = listing.values[number]
            operands = [made[operand] for operand in listing.operands(number)]
            if isinstance(value, Constant):
                made[number] = ca.SX(value.value)
            elif isinstance(value, Read):
                made[number] = self._entries[value.argument][value.entry]
            elif isinstance(value, Computed):
                apply = ca.SX.unary if len(operands) == 1 else ca.SX.binary
                made[number] = apply(value.operation, *operands)
            elif number not in made:
                call = listing.calls[value.call]
                made |= zip(call.results, call_of_entries(call.function, operands), strict=True)
        return made
