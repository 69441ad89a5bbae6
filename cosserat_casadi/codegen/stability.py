"""Stability of equilibria in C: further sources of a library, which a folder contains only on request."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.codegen.library import SECOND_VARIATION
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.equilibrium.judge import ASIDE
from cosserat_casadi.equilibrium.stability import DEPENDENT, ZERO, variations
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.continuation import ContinuationSettings

ALWAYS = "The loads of this scene have a potential whatever the inputs."
AT_TIMES = (
    "The loads of this scene have a potential only where some inputs, such\n   as a force that turns with the rod, are "
    "zero: elsewhere the result means nothing."
)


def stability_files(name: str) -> tuple[str, str, str]:
    """File names for the stability of a library: source, header, and the file that the source includes."""
    return f"{name}_stability.c", f"{name}_stability.h", SECOND_VARIATION


def check_stability(model: Model) -> None:
    """Refuse the stability of a scene whose loads have no potential.

    Raises:
        ExportError: eigenvalues have no meaning at the scene's own inputs.
    """
    if not model.has_potential(model.pack()):
        remedy = "leave it out; cosserat modes judges such equilibria by their motion"
        raise ExportError(Problem("--stability", "the loads have no potential at the scene's inputs", remedy))


def stability_sources(model: Model, names: Names) -> dict[str, str]:
    """Write source and header of the stability of equilibria, by file name.

    Args:
        model: the exported model.
        names: names of the library to which they belong.
    """
    allowed = variations(model)
    units = allowed.units
    # Rods with equal energy units need no scaling, and keep their digits, as in Python.
    roots = np.sqrt(units / units.max()) if len(set(units)) > 1 else np.ones(len(units))
    words: dict[str, Any] = {
        "name": names.name,
        "MACRO": names.macro,
        "free": len(allowed.free),
        "held": len(allowed.held),
        # C has no array without entries.
        "held_room": max(len(allowed.held), 1),
        "free_unknowns": numbers(allowed.free.tolist()),
        "held_unknowns": numbers(allowed.held.tolist() or [0]),
        "roots": numbers(roots.tolist()),
        **limits_of_stability(model),
        "tolerance": ContinuationSettings().newton.tolerance,
        **_parameter_words(model, names),
    }
    source, header, algorithm = stability_files(names.name)
    return {
        source: render("stability.c.in", words),
        header: render("stability.h.in", words),
        algorithm: resource("c", algorithm),
    }


def limits_of_stability(model: Model) -> dict[str, Any]:
    """Words of the templates for the limits of a verdict, and for the inputs at which it has a meaning."""
    everywhere = model.has_potential(np.ones(model.inputs.size))
    return {"zero": ZERO, "dependent": DEPENDENT, "aside": ASIDE, "potential_note": ALWAYS if everywhere else AT_TIMES}


def _parameter_words(model: Model, names: Names) -> dict[str, str]:
    """Words for the argument of parameters, if there are some, as in the library's header and source."""
    if not model.parameters.size:
        return dict.fromkeys(("parameters", "passed", "member", "given", "units_note"), "")
    argument = f"const {names.name}_real *parameters"
    units_note = " of the scene's own numbers, whatever the parameters"
    return {
        "parameters": f", {argument}",
        "passed": ", at->parameters",
        "member": "  const real *parameters;\n",
        "given": "parameters, ",
        "units_note": units_note,
    }
