"""Functions of drawn operations, printed in C: they compute what CasADi does, whatever is nested, shared and called."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi.codegen import shared_values
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.shared_values import with_shared_kernels
from cosserat_casadi.compiling import scalars_in_c as printer
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from tests.codegen.libraries import C99, gcc
from tests.families import mostly_slow

ARITHMETIC = (lambda a, b: a + b, lambda a, b: a - b, lambda a, b: a * b, lambda a, b: a / b)
CHOICES = (
    lambda a, b: a < b,
    lambda a, b: a == b,
    lambda a, b: ca.fmin(a, b),
    lambda a, b: ca.if_else(a < b, a * b, a - b),
    lambda a, b: ca.logic_and(a <= b, ca.logic_not(b < 0.2)),
    lambda a, b: ca.logic_or(a != b, b < 0.1),
    lambda a, b: ca.if_else(a < b, b <= 0.3, 0.0),
    lambda a, b: ca.sin(a) + ca.sqrt(ca.fabs(b)),
    lambda a, b: -2 * a + 1 / b,
)
CONSTANTS = (1.0, -2.5, 0.1234567891234, -7.654321234567e-5)

FUNCTIONS = 8
"""Functions of one source."""

LENGTHS = (20, 12)
"""Entries of their arguments."""

RESULTS = 10
"""Entries of all their results."""

STORED_PRODUCT = 18
"""Seed of functions that store a product of a value which they need again."""


def drawn(rng: np.random.Generator, given: Sequence[ca.SX], count: int, callees: Sequence[ca.Function]) -> list[ca.SX]:
    """Values of drawn operations on those that are there, of the last ones above all."""
    values = list(given)

    def any_value() -> ca.SX:
        first = max(0, len(values) - 8) if rng.random() < 0.7 else 0
        return values[rng.integers(first, len(values))]

    while len(values) < count:
        if callees and rng.random() < 0.1:
            callee = callees[rng.integers(len(callees))]
            # From three calls on they are made four at a time.
            for _ in range(rng.integers(1, 6)):
                values += callee(ca.vertcat(*[any_value() for _ in range(callee.numel_in(0))])).nonzeros()
            continue
        a = ca.SX(float(rng.choice(CONSTANTS))) if rng.random() < 0.15 else any_value()
        family = ARITHMETIC if rng.random() < 0.75 else CHOICES
        values.append(family[rng.integers(len(family))](a, any_value()))
    return values


def drawn_callee(rng: np.random.Generator, name: str) -> ca.Function:
    """A function of sums, products and quotients, which lanes have, that is called."""
    x = ca.SX.sym("x", 3)
    values = x.nonzeros()
    for _ in range(6):
        a, b = rng.choice(len(values), 2)
        values.append(ARITHMETIC[rng.integers(len(ARITHMETIC))](values[a], values[b]))
    return ca.Function(name, [x], [ca.vertcat(*values[-3:])], {"never_inline": True})


def drawn_functions(rng: np.random.Generator) -> list[ca.Function]:
    """Functions of the same arguments with many values in common, and with values of their own."""
    # So many that some entries are read once, and stand where they are read.
    arguments = [ca.SX.sym("x", LENGTHS[0]), ca.SX.sym("y", LENGTHS[1])]
    callees = [drawn_callee(rng, f"callee_{i}") for i in range(2)]
    common = drawn(rng, [entry for argument in arguments for entry in argument.nonzeros()], 40, callees)
    functions = []
    for i in range(FUNCTIONS):
        values = drawn(rng, common, 40 + int(rng.integers(1, 60)), callees)
        # What is stored was just computed, or is none of these.
        wanted = [values[-int(rng.integers(1, 4 if rng.random() < 0.8 else len(values)))] for _ in range(RESULTS)]
        # One of several results may be asked for by no pointer.
        half = RESULTS // 2
        results = [ca.vertcat(*wanted)] if i % 2 else [ca.vertcat(*wanted[:half]), ca.vertcat(*wanted[half:])]
        functions.append(ca.Function(f"f{i}", arguments, [ca.densify(r) for r in results]))
    return functions


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize("seed", mostly_slow(range(40), quick=[STORED_PRODUCT]))
def test_printed_functions_compute_what_casadi_does(
    seed: int, shared: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(seed)
    # Short functions are rows of parts too, and few values are a kernel that several share.
    monkeypatch.setattr(printer, "LONGEST_OF_NUMBERS", int(rng.choice([400, 24])))
    monkeypatch.setattr(shared_values, "FEWEST_SHARED", int(rng.choice([100, 5])))
    functions = drawn_functions(rng)
    kernels = with_shared_kernels(functions, "shared") if shared else [scalars_in_c(f, f) for f in functions]
    for file, text in kernel_sources(kernels, library_names("drawn"), "drawn").items():
        (tmp_path / file).write_text(text)
    calls = [
        f"void computed_{kernel.name()}(const double *x, const double *y, double *made) {{\n"
        f"  const double *given[] = {{x, y}};\n  double *results[] = {{made, made + {RESULTS // 2}}};\n"
        f"  double w[{kernel.reals + 1}];\n  {kernel.name()}(given, results, 0, w, 0);\n}}\n"
        for kernel in kernels
    ]
    (tmp_path / "calls.c").write_text('#include "drawn.c"\n' + "".join(calls))
    lint = [*C99, "-Werror", "-Wno-unused-parameter", "-Wno-unused-function"]
    # Drawn functions compare what a model does not.
    lint += ["-Wno-bool-compare", "-Wno-int-in-bool-context", "-Wno-parentheses"]
    library = tmp_path / "drawn.so"
    gcc(*lint, "-O0", "-ffp-contract=off", "-fPIC", "-shared", tmp_path / "calls.c", "-lm", "-o", library)
    loaded = ctypes.CDLL(str(library))
    for function in functions:
        for _ in range(3):
            given = rng.standard_normal(LENGTHS[0]).round(1), rng.standard_normal(LENGTHS[1])
            found = np.full(RESULTS, -77.0)
            loaded[f"computed_{function.name()}"](*map(pointer, given), pointer(found))
            wanted = np.concatenate([result.full()[:, 0] for result in function.call(list(given))])
            assert_array_equal(found, wanted)
