"""Statuses of the solver in C: the outcomes, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Mapping

from cosserat_casadi.codegen.motion_status import STATUSES
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.tubes.status import STATUSES as TUBE_STATUSES
from cosserat_casadi.numerics.outcome import Outcome

OUTCOMES = tuple(outcome for outcome in Outcome if outcome is not Outcome.CONTACT_UNSETTLED)
"""Statuses of the solver in C, in the order of their numbers: it does not look for contact."""

CONTACT_OUTCOMES = tuple(Outcome)
"""Statuses of the solver of rods in exact contact, in the order of their numbers."""


def status_words(names: Names) -> dict[str, str]:
    """What the templates say of statuses: all of it follows from the outcomes."""
    symbols = {outcome: f"{names.macro}_{outcome.name}" for outcome in OUTCOMES}
    return {
        "status_lines": _enumerators({symbol: outcome.value for outcome, symbol in symbols.items()}),
        "status_names": "\n".join(f"#define SOLVER_{outcome.name} {symbols[outcome]}" for outcome in OUTCOMES),
        "text_cases": _cases({symbols[outcome]: outcome.value for outcome in OUTCOMES}),
        "label_cases": _cases({symbols[outcome]: outcome.label for outcome in OUTCOMES}),
    }


def contact_status_words(names: Names) -> dict[str, str]:
    """What the templates of exact contact say of statuses."""
    symbols = {outcome: f"{names.macro}_{outcome.name}" for outcome in CONTACT_OUTCOMES}
    return {
        "status_lines": _enumerators({symbol: outcome.value for outcome, symbol in symbols.items()}),
        "status_names": "\n".join(f"#define CONTACT_{outcome.name} {symbols[outcome]}" for outcome in CONTACT_OUTCOMES),
        "text_cases": _cases({symbols[outcome]: outcome.value for outcome in CONTACT_OUTCOMES}),
        "label_cases": _cases({symbols[outcome]: outcome.label for outcome in CONTACT_OUTCOMES}),
    }


def motion_status_words(names: Names) -> dict[str, str]:
    """What the templates say of the statuses of motions."""
    symbols = {status: f"{names.macro}_MOTION_{status.name}" for status in STATUSES}
    defined = [f"#define SOLVER_MOTION_{status.name} {symbol}" for status, symbol in symbols.items()]
    return {
        "motion_status_lines": _enumerators({symbol: status.value for status, symbol in symbols.items()}),
        "motion_status_names": "\n".join(defined),
        "motion_text_cases": _cases({symbol: status.value for status, symbol in symbols.items()}),
        "motion_label_cases": _cases({symbol: status.label for status, symbol in symbols.items()}),
    }


def tube_status_words(names: Names) -> dict[str, str]:
    """What the templates of concentric tubes say of statuses."""
    symbols = {status: f"{names.macro}_{status.name}" for status in TUBE_STATUSES}
    return {
        "status_lines": _enumerators({symbol: status.value for status, symbol in symbols.items()}),
        "status_names": "\n".join(f"#define SOLVER_{status.name} {symbol}" for status, symbol in symbols.items()),
        "text_cases": _cases({symbol: status.value for status, symbol in symbols.items()}),
        "label_cases": _cases({symbol: status.label for status, symbol in symbols.items()}),
    }


def _enumerators(sentences: Mapping[str, str]) -> str:
    """Members of an enumeration, numbered in their order, with a sentence each."""
    width = max(map(len, sentences))
    lines = []
    for number, (symbol, sentence) in enumerate(sentences.items()):
        comma = "," if number + 1 < len(sentences) else ""
        entry = f"{symbol.ljust(width)} = {number}{comma}"
        lines.append(f"  {entry.ljust(width + 6)}/* {sentence} */")
    return "\n".join(lines)


def _cases(texts: dict[str, str]) -> str:
    return "\n".join(f'    case {symbol}:\n      return "{text}";' for symbol, text in texts.items())
