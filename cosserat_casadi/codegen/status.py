"""Statuses of the solver in C: the outcomes, in the order of their numbers."""

from __future__ import annotations

from cosserat_casadi.codegen.names import Names
from cosserat_casadi.numerics.outcome import Outcome

OUTCOMES = tuple(Outcome)
"""Statuses of the solver in C, in the order of their numbers."""


def status_words(names: Names) -> dict[str, str]:
    """What the templates say of statuses: all of it follows from the outcomes."""
    symbols = {outcome: f"{names.macro}_{outcome.name}" for outcome in OUTCOMES}
    width = max(len(symbol) for symbol in symbols.values())
    enumerators = []
    for number, outcome in enumerate(OUTCOMES):
        comma = "," if number + 1 < len(OUTCOMES) else ""
        entry = f"{symbols[outcome].ljust(width)} = {number}{comma}"
        enumerators.append(f"  {entry.ljust(width + 6)}/* {outcome.value} */")
    return {
        "status_lines": "\n".join(enumerators),
        "status_names": "\n".join(f"#define SOLVER_{outcome.name} {symbols[outcome]}" for outcome in OUTCOMES),
        "text_cases": _cases({symbols[outcome]: outcome.value for outcome in OUTCOMES}),
        "label_cases": _cases({symbols[outcome]: outcome.label for outcome in OUTCOMES}),
    }


def _cases(texts: dict[str, str]) -> str:
    return "\n".join(f'    case {symbol}:\n      return "{text}";' for symbol, text in texts.items())
