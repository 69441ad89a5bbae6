"""Statuses of the solver in C, which are outcomes, and of steps of a motion, by number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cosserat_casadi.codegen.names import Names
from cosserat_casadi.numerics.outcome import LabelledOutcome, Outcome

Outcomes = tuple[Outcome, ...]
"""Statuses of a solver in C, in the order of their numbers."""


def _without(*others: Outcome) -> Outcomes:
    return tuple(outcome for outcome in Outcome if outcome not in others)


OUTCOMES = _without(Outcome.CONTACT_UNSETTLED, Outcome.OUT_OF_RANGE)
"""Statuses of the solver of rods without exact contact."""

CONTACT_OUTCOMES = _without(Outcome.OUT_OF_RANGE)
"""Statuses of the solver of rods in exact contact."""

TUBE_OUTCOMES = _without(
    Outcome.PATH_VANISHED, Outcome.BEYOND_MATERIAL, Outcome.OUT_OF_PLANE, Outcome.CONTACT_UNSETTLED
)
"""Statuses of the solver of concentric tubes."""


class MotionStatus(LabelledOutcome):
    """Outcomes of a step in C; the value is the sentence for the user. New members come last."""

    DONE = "Done: the equations of motion are solved to the tolerance."
    NOT_SOLVED = "The step could not be solved, also not in parts: take shorter steps, or move less in a step."
    NOT_FINITE = "An input of the step, or a value of its equations, is not finite."
    SINGULAR = "The equations of the step are singular; constraints may contradict or repeat each other."
    BAD_STEP = "The length of the step is not a positive number of seconds."
    INCONSISTENT = "Supports, joints or cables are not closed: start from an equilibrium."
    NO_ACCELERATION = "A base, a length or a joint moves, but its acceleration is missing: give it, even if it is zero."
    PATH_VANISHED = (
        "At the end of the step the rod bends so far that the path of a tendon has no length left in it: lessen the "
        "loads, or move the path nearer to the axis."
    )
    BEYOND_MATERIAL = (
        "At the end of the step a strain, or the pressure in a chamber, is beyond where its law holds: lessen the "
        "loads, or give the law for larger ones."
    )
    OUT_OF_PLANE = (
        "At the end of the step a joint or a support is out of the plane that its rods bend in, or turned out of it: "
        "keep it in the plane, or admit the other bending and torsion of the rods."
    )
    SECTIONS_APART = (
        "Sections at which contact is summed lie too far apart for this length, radius or width: export the scene with "
        "these numbers, or on more intervals."
    )


MOTION_STATUSES = tuple(MotionStatus)
"""Outcomes of a step of a motion, in the order of their numbers in C."""


def status_words(names: Names, outcomes: Outcomes = OUTCOMES, prefix: str = "SOLVER") -> dict[str, str]:
    """Words of the templates of a solver for its statuses.

    Args:
        names: names of the library and its parts.
        outcomes: the statuses.
        prefix: prefix of the statuses in sources that are equal in all folders.
    """
    return _words(names.macro, prefix, outcomes)


def motion_status_words(names: Names, *, may_lie_apart: bool) -> dict[str, str]:
    """Words of the templates for the statuses of motions.

    Args:
        names: names of the library and its parts.
        may_lie_apart: whether sections at which contact is summed may be too far apart, which is the last status.
    """
    statuses = MOTION_STATUSES if may_lie_apart else MOTION_STATUSES[:-1]
    words = _words(f"{names.macro}_MOTION", "SOLVER_MOTION", statuses)
    return {f"motion_{key}": text for key, text in words.items()}


def _words(macro: str, prefix: str, statuses: Sequence[Outcome | MotionStatus]) -> dict[str, str]:
    symbols = {status: f"{macro}_{status.name}" for status in statuses}
    defined = [f"#define {prefix}_{status.name} {symbol}" for status, symbol in symbols.items()]
    return {
        "status_lines": _enumerators({symbol: status.value for status, symbol in symbols.items()}),
        "status_names": "\n".join(defined),
        "text_cases": _cases({symbol: status.value for status, symbol in symbols.items()}),
        "label_cases": _cases({symbol: status.label for status, symbol in symbols.items()}),
    }


def _enumerators(sentences: Mapping[str, str]) -> str:
    """Write the members of an enumeration, numbered in order, each with its sentence."""
    width = max(map(len, sentences))
    lines = []
    for number, (symbol, sentence) in enumerate(sentences.items()):
        comma = "," if number + 1 < len(sentences) else ""
        entry = f"{symbol.ljust(width)} = {number}{comma}"
        lines.append(f"  {entry.ljust(width + 6)}/* {sentence} */")
    return "\n".join(lines)


def _cases(texts: dict[str, str]) -> str:
    return "\n".join(f'    case {symbol}:\n      return "{text}";' for symbol, text in texts.items())
