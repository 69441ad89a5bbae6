"""The words of the sources that estimate the error of an answer: equilibrium/answer_error.py in C."""

from __future__ import annotations

from cosserat_casadi.codegen.block_sources import Render, Words, numbers
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.equilibrium import answer_error
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.watched import watched_owners

ERROR_FILES = ("solver_error.c",)

WITHOUT: Words = {
    "error_config": "",
    "error_members": "",
    "error_header": "",
    "error_equations": "",
    "error_source": "",
    "error_with_parameters": "",
    "error_reals": 0,
}
"""Words of a library that estimates no errors."""

KERNEL = "richer_balance"
"""The kernel that a library has which estimates errors."""


def estimates_errors(names: Names) -> bool:
    """Whether a library estimates the errors of its answers."""
    return any(spec.name == KERNEL for spec in names.functions)


def error_words(render: Render, basics: Words, model: Model, names: Names) -> Words:
    """Words of a library, with the estimate where the library has its kernels.

    Args:
        render: fills in templates.
        basics: names and sizes of the library, with the words of parameters.
        model: what is exported.
        names: what things are called.
    """
    if not estimates_errors(names):
        return WITHOUT
    richer = model.discrete.richer
    tolerance = model.scene.accuracy.tolerance
    watched_count = len(watched_owners(model.discrete))
    words = {
        **basics,
        "missing": richer.missing_size,
        "watched": watched_count,
        "richer_size": richer.discrete.size,
        "is_among_last": numbers(richer.is_among_last.astype(int).tolist()),
        "scene_tolerance": f"{tolerance:g}",
        "error_sweeps": answer_error.MOST_SWEEPS,
        "error_safety": answer_error.SAFETY,
        "error_settled": answer_error.SETTLED,
        "error_contracting": answer_error.CONTRACTING,
        "error_enough": answer_error.enough_for(tolerance),
        "error_fastest": answer_error.FASTEST,
        "error_slowest": answer_error.SLOWEST,
        "error_floor": answer_error.ROUNDING,
    }
    return {
        "error_config": render("error_config.h.in", words),
        "error_members": render("error_workspace.h.in", words),
        "error_header": render("error.h.in", words),
        "error_equations": render("error_equations.c.in", words),
        "error_source": '#include "solver_error.c"\n',
        "error_with_parameters": render("error_with_parameters.c.in", words) if model.parameters.size else "",
        "error_reals": 3 * model.size + 3 * richer.missing_size + watched_count,
    }
