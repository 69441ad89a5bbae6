"""The functions of a model in a C library, by the table of functions: their prototypes and wrappers.

The source of the solver calls its kernels directly. All other kernels are functions of the header: a comment, a
prototype and a wrapper, which follow from the entry of the table alone.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import solver_function
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import (
    ARGUMENT_UNITS,
    PARAMETERS,
    SCALAR_ARGUMENTS,
    FunctionSpec,
    Output,
    Owner,
    owners,
)

COUNTS = {"x": "UNKNOWNS", "inputs": "INPUTS", "v": "UNKNOWNS", "inputs_rate": "INPUTS", PARAMETERS: "PARAMETERS"}
"""Macros of the header with the number of entries of an argument."""

TANGENT = "path_tangent"
"""Name of the function whose kernel is a table of numbers."""

WORDS_IN_C = {PARAMETERS: "parameters"}
"""Names of arguments that are longer in C than in Python."""

WIDTH = 119
"""Number of characters of the longest line of the header."""

UNBROKEN = "\xa0"
"""Non-breaking space."""


@dataclass(frozen=True)
class FunctionInC:
    """A function of the scene, of a rod, of an actuator or of a body.

    Attributes:
        spec: entry of the function in the table.
        owner: name of the rod, the actuator or the body; None for the scene.
        model: the model of the function.
        names: names of the library and its parts in C.
    """

    spec: FunctionSpec
    owner: str | None
    model: Model
    names: Names

    @property
    def symbol(self) -> str:
        """Name in the header."""
        return self.names.function(self.spec.name_in_c, self.owner)

    @property
    def kernel(self) -> str:
        """Name of the generated kernel."""
        return self.names.kernel(self.spec.name_in_c, self.owner)

    @property
    def external(self) -> str:
        """Name for ``casadi.external``."""
        return self.names.differentiable(self.spec.name_in_c, self.owner)

    @cached_property
    def function(self) -> ca.Function:
        """The CasADi function with its outputs in C; for functions of the solver, parameters are further inputs."""
        if self.spec.kernel and not self.spec.public:
            return solver_function(self.model, self.spec)
        return self.spec.function_in_c(self.model, self.owner or "")

    @cached_property
    def arguments(self) -> list[str]:
        """Names of the arguments, with the parameters that the scene names."""
        return self.spec.arguments_of(self.model.discrete)

    @cached_property
    def outputs(self) -> tuple[Output, ...]:
        """The outputs of the function in C."""
        outputs = self.spec.outputs_of(self.model.discrete, self.owner or "")
        return outputs[: self.spec.kernel_outputs]

    @property
    def units(self) -> dict[str, str]:
        """Units of arguments and results by name."""
        arguments = {name: ARGUMENT_UNITS.get(name, "1") for name in self.arguments}
        return arguments | {output.name: output.unit for output in self.outputs}

    @property
    def description(self) -> str:
        """Sentence on the function, its arguments other than unknowns and inputs, its results, with sizes and units."""
        sentence = self.spec.header.format(owner=self.owner)
        results = ", ".join(self._described(i, output) for i, output in enumerate(self.outputs))
        given = ", ".join(self._given())
        if given:
            return f"{sentence} Takes {given}; gives {results}."
        return f"{sentence} Gives {results}."

    def prototype(self, basics: Mapping[str, Any]) -> str:
        """Write comment and prototype for the header, with the words of the library."""
        real = f"{self.names.name}_real"
        words = {
            "comment": _filled(f"/* {self.description} */"),
            "signature": _wrapped(f"void {self.symbol}(", self._parameters(real), ");"),
        }
        return render("function.h.in", {**basics, **words})

    def wrapper(self, basics: Mapping[str, Any]) -> str:
        """Write the definition, a call of the kernel, with the words of the library."""
        arguments = [f"&{name}" if name in SCALAR_ARGUMENTS else _word(name) for name in self.arguments]
        words = {
            "signature": _wrapped(f"void {self.symbol}(", self._parameters("real"), ") {"),
            "kernel": self.kernel,
            "arguments": ", ".join(arguments),
            "results": ", ".join(output.name for output in self.outputs),
        }
        return render("function.c.in", {**basics, **words})

    def _parameters(self, real: str) -> list[str]:
        parameters = []
        for name in self.arguments:
            declared = f"{real} {name}" if name in SCALAR_ARGUMENTS else f"const {real} *{_word(name)}"
            parameters.append(declared)
        return parameters + [f"{real} *{output.name}" for output in self.outputs]

    def _given(self) -> list[str]:
        """Arguments besides unknowns and inputs, with size and unit."""
        described = []
        for i, name in enumerate(self.arguments):
            if name not in COUNTS:
                size = self.function.size1_in(i)
                described.append(_with_facts(name, str(size) if size > 1 else "", self.units[name]))
        return described

    def _described(self, i: int, output: Output) -> str:
        """A result with shape and unit."""
        rows, columns = self.function.size_out(i)
        if output.derivative_by:
            shape = f"{rows} x {COUNTS[output.derivative_by]}"
        elif columns > 1:
            shape = f"{rows} x {columns}"
        else:
            shape = str(rows) if rows > 1 else ""
        return _with_facts(output.name, shape, output.unit)


def functions_in_c(model: Model, names: Names) -> list[FunctionInC]:
    """List all functions with a kernel: of the scene, then rod by rod, actuator by actuator, body by body."""
    kernels = [spec for spec in names.functions if spec.kernel]
    # Every rod, actuator and body has the functions of its kind.
    specs = [spec for spec in kernels if spec.owner is not Owner.SCENE or spec.function_of(model) is not None]
    if model.parameters.size:
        # The unloaded scene depends on the parameters: the solver solves for its tangent.
        specs = [spec for spec in specs if spec.name != TANGENT]
    return _functions(model, names, specs)


def public_functions(model: Model, names: Names) -> list[FunctionInC]:
    """List the functions of the header, except those of the solver."""
    return [function for function in functions_in_c(model, names) if function.spec.public]


def differentiable_functions(model: Model, names: Names) -> list[FunctionInC]:
    """List the functions that have derivatives in a loaded folder."""
    return _functions(model, names, [spec for spec in names.functions if spec.differentiable])


def _functions(model: Model, names: Names, specs: Sequence[FunctionSpec]) -> list[FunctionInC]:
    functions = []
    for kind in Owner:
        for owner in owners(model.discrete, kind):
            functions += [FunctionInC(spec, owner or None, model, names) for spec in specs if spec.owner is kind]
    return functions


def _word(argument: str) -> str:
    """Name of an argument in C."""
    return WORDS_IN_C.get(argument, argument)


def _with_facts(name: str, shape: str, unit: str) -> str:
    facts = [shape] if shape else []
    if unit != "1":
        facts.append(unit)
    return f"{name} ({', '.join(facts)})" if facts else name


def _filled(comment: str) -> str:
    """Break a comment into lines, none of which ends within parentheses."""
    unbroken = re.sub(r"\([^)]*\)", lambda match: match[0].replace(" ", UNBROKEN), comment)
    return _in_lines(unbroken, "   ")


def _wrapped(head: str, parameters: Sequence[str], end: str) -> str:
    """Break a signature into lines between parameters."""
    listed = ", ".join(parameter.replace(" ", UNBROKEN) for parameter in parameters)
    return _in_lines(f"{head.replace(' ', UNBROKEN)}{listed}{end.replace(' ', UNBROKEN)}", "    ")


def _in_lines(text: str, indent: str) -> str:
    lines = textwrap.fill(text, WIDTH, subsequent_indent=indent, break_long_words=False)
    return lines.replace(UNBROKEN, " ")
