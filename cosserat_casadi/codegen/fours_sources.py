"""Kernels in fours (fours.py) as parts of a source and its header."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import casadi as ca

from cosserat_casadi.codegen.texts import fill, resource

PROTOTYPE = """int {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define {name}_SZ_ARG {arguments}
#define {name}_SZ_RES {results}
#define {name}_SZ_IW 0
#define {name}_SZ_W {reals}
"""


@dataclass(frozen=True)
class InFours:
    """A kernel that is written here.

    Attributes:
        signature: a function with its name, arguments and results.
        tables: constant arrays in C.
        body: functions in C that are compiled for each width of vectors; their names stand in ``MADE()``.
        callees: parameters and bodies of functions that these call by the name of the kernel and a word, by the word.
        reals: numbers that it works in.
        statements: how many there are.
    """

    signature: ca.Function
    tables: str
    body: str
    callees: Mapping[str, str]
    reals: int
    statements: int

    def name(self) -> str:
        """Its name in C."""
        name: str = self.signature.name()
        return name

    def n_instructions(self) -> int:
        """How many statements there are."""
        return self.statements

    def prototype(self) -> str:
        """Its declaration, and what it asks for."""
        arguments = self.signature.n_in()
        results = self.signature.n_out()
        return PROTOTYPE.format(name=self.name(), arguments=arguments, results=results, reals=self.reals)


Kernel: TypeAlias = ca.Function | InFours
"""A kernel that CasADi writes, or one that is written here."""


@dataclass(frozen=True)
class SourcesInFours:
    """What kernels in fours add to a source and its header.

    Attributes:
        source: what follows in the source.
        prototypes: what follows in the header.
        included: files by name that the source includes.
    """

    source: str
    prototypes: str
    included: dict[str, str]


def sources_in_fours(kernels: Sequence[InFours], stem: str) -> SourcesInFours:
    """Kernels in C, for any processor and for the wider vectors of newer ones.

    Args:
        kernels: the kernels.
        stem: of the file names.
    """
    words = {
        "stem": stem,
        "tables": "".join(kernel.tables for kernel in kernels),
        "kernels": "".join(f"KERNEL({kernel.name()})\n" for kernel in kernels),
    }
    bodies = "\n".join(_sharing_callees(kernels, stem))
    prototypes = "".join(kernel.prototype() for kernel in kernels)
    text = f"/* Included once for each width of vectors. */\n{bodies}"
    included = {f"{stem}_in_fours.h": text, "fours.h": resource("c", "fours.h")}
    return SourcesInFours(fill(resource("templates", "fours.c.in"), words), prototypes, included)


def _sharing_callees(kernels: Sequence[InFours], stem: str) -> list[str]:
    """Functions that kernels call, once for all that call the same, and the kernels."""
    functions = []
    bodies = []
    name_of: dict[str, str] = {}
    for kernel in kernels:
        body = kernel.body
        for word, callee in kernel.callees.items():
            if callee not in name_of:
                name = f"{stem}_{word}"
                name_of[callee] = f"{name}_{len(name_of)}" if name in name_of.values() else name
                functions.append(f"static void MADE({name_of[callee]}){callee}")
            body = body.replace(f"MADE({kernel.name()}_{word})", f"MADE({name_of[callee]})")
        bodies.append(body)
    return functions + bodies
