"""Words in the templates of error estimates: equilibrium/answer_error.py in C."""

from __future__ import annotations

from cosserat_casadi.codegen.block_sources import Words
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.equilibrium import answer_error, blindness
from cosserat_casadi.equilibrium.metrics import ROUNDING
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.watched import POSE_SIZE, watched_cables, watched_owners

ERROR_FILES = ("solver_error.c",)

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
    elements = blindness.TurnedElements(richer)
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
        "is_among_last": numbers(richer.is_among_last.astype(int).tolist()),
        "elements": len(elements.unloaded),
        "element_of_unknown": numbers(elements.of_unknowns.tolist()),
        "turns": numbers(elements.turns.tolist()),
        "unloaded_turns": numbers(elements.unloaded.tolist()),
        "element_of_missing": numbers(elements.of_missing.tolist()),
        "modes_of_missing": numbers(elements.modes_of_missing.tolist()),
        "error_whole_turn": blindness.WHOLE_TURN,
        "error_beyond_turn": blindness.BEYOND,
        "error_unseen": blindness.UNSEEN * tolerance,
        "scene_tolerance": f"{tolerance:g}",
        "error_sweeps": answer_error.MOST_SWEEPS,
        "error_safety": answer_error.safety_for(model),
        "error_settled": answer_error.settled_for(model),
        "error_followed": FOLLOWED,
        "error_contracting": answer_error.CONTRACTING,
        "error_first_look": answer_error.FIRST_LOOK,
        "error_enough": answer_error.enough_for(model),
        "error_fastest": answer_error.FASTEST,
        "error_slowest": answer_error.SLOWEST,
        "error_floor": ROUNDING,
        "error_reals": 3 * (model.size + richer.missing_size + watched_count),
    }
