"""Words in the templates of error estimates: equilibrium/answer_error.py in C."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.codegen.block_sources import Words
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.compiling.c_tables import numbers, record, table
from cosserat_casadi.equilibrium import answer_error, blindness
from cosserat_casadi.equilibrium.metrics import ROUNDING
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.watched import POSE_SIZE, watched_cables, watched_owners

BLINDNESS = "blind_turns.c"
"""File that looks for waves to which modes are blind."""

ERROR_FILES = (BLINDNESS, "solver_error.c")

STEPS_OF_ESTIMATE = 1
"""Number of the estimate's steps that update the last Jacobian of Newton's method."""

FOLLOWED = 0.5
"""Largest ratio of the second step's length to the first at which the last Jacobian of Newton's method serves."""

BALANCE = "richer_balance"
WATCHED = "watched"
KERNELS = (BALANCE, WATCHED)
"""Kernels of a library that estimates errors."""


def estimates_errors(names: Names) -> bool:
    """Whether a library estimates the errors of its answers."""
    return any(spec.name == BALANCE for spec in names.functions)


def error_words(model: Model, names: Names) -> Words:
    """Words of a library about error estimates, which it makes if it has the kernels.

    Args:
        model: the exported model.
        names: names of the library and its parts.
    """
    if not estimates_errors(names):
        return {"error_reals": 0}
    richer = model.discrete.richer
    tolerance = model.scene.accuracy.tolerance
    watched_count = len(watched_owners(model.discrete))
    cable_count = len(watched_cables(model.discrete))
    return {
        "estimates_errors": True,
        "tells_errors": True,
        "missing": richer.missing_size,
        "watched": watched_count,
        "watched_poses": (watched_count - cable_count) // POSE_SIZE,
        "watched_cables": cable_count,
        "richer_size": richer.discrete.size,
        "strains": richer.strain_count,
        "pair_of_unknown": numbers(richer.degree_pairs[richer.known].tolist()),
        "pair_of_missing": numbers(richer.degree_pairs[~richer.known].tolist()),
        "turned_elements": turned_tables("TURNED", blindness.TurnedElements(richer)),
        **blindness_words(tolerance),
        "scene_tolerance": f"{tolerance:g}",
        "error_sweeps": answer_error.MOST_SWEEPS,
        "error_safety": answer_error.safety_for(model),
        "error_settled": answer_error.settled_for(model),
        "error_followed": FOLLOWED,
        "error_contracting": answer_error.CONTRACTING,
        "error_first_look": answer_error.FIRST_LOOK,
        "error_enough": answer_error.enough_for(model),
        "error_slowest": answer_error.SLOWEST,
        "error_floor": ROUNDING,
        "error_reals": 3 * (model.size + watched_count) + 2 * richer.missing_size,
    }


def blindness_words(tolerance: float) -> Words:
    """Limits of waves to which modes are blind.

    Args:
        tolerance: of the scene.
    """
    return {
        "error_whole_turn": blindness.WHOLE_TURN,
        "error_beyond_turn": blindness.BEYOND,
        "error_unseen": blindness.UNSEEN * tolerance,
    }


def turned_tables(name: str, elements: blindness.TurnedElements, *, among_all: bool = False) -> str:
    """Elements that turn as a constant record in C, with its tables before it.

    Args:
        name: of the record.
        elements: of a model and of the richer one.
        among_all: whether missing coordinates stand among all unknowns of the richer model, in its order.
    """
    richer = elements.richer
    of_missing, modes_of_missing = elements.of_missing, elements.modes_of_missing
    if among_all:
        of_all = np.full((2, len(richer.known)), -1)
        of_all[:, ~richer.known] = of_missing, modes_of_missing
        of_missing, modes_of_missing = of_all
    tables = {
        "of_unknown": elements.of_unknowns,
        "by_unknown": elements.turns,
        "unloaded": elements.unloaded,
        "of_missing": of_missing,
        "modes": modes_of_missing,
    }
    sizes = {"elements": len(elements.unloaded), "unknowns": len(elements.turns), "missing": len(of_missing)}
    fields = {**sizes, **{field: f"{name}_{field.upper()}" for field in tables}}
    lines = [table(f"{name}_{field.upper()}", values.tolist()) for field, values in tables.items()]
    return f"{''.join(lines)}static const turned_elements {name} = {record(fields)};"
