"""Ranges of free inputs and parameters, for which a discretisation is chosen."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator

from cosserat_casadi.scene.faults import Fault, SceneTables, list_of, listing, shown, table_of
from cosserat_casadi.scene.input_rules import entry_counts
from cosserat_casadi.scene.records import HashedTable, refusal
from cosserat_casadi.scene.values import SEVERAL, SINGLE, NotEmpty, Number, listed


def _low_and_high(value: tuple[float, float]) -> tuple[float, float]:
    """Refuse ends that are equal or reversed."""
    low, high = value
    if low == high:
        raise refusal([Fault((), f"must have two different ends, got {shown(low)} twice", "a range is [low, high]")])
    if low > high:
        raise refusal([Fault((), f"must have the lower end first, got [{shown(low)}, {shown(high)}]")])
    return value


Pair = Annotated[tuple[Number, Number], listed(2, "2 numbers, low and high"), AfterValidator(_low_and_high)]


def _one_or_several(value: Any) -> str:
    """The choice for a list of lists, or for anything else."""
    if isinstance(value, list | tuple) and value and isinstance(value[0], list | tuple):
        return SEVERAL.tag
    return SINGLE.tag


Pairs = Annotated[
    Annotated[Pair, SINGLE] | Annotated[tuple[Pair, ...], NotEmpty(), SEVERAL],
    Discriminator(_one_or_several),
]
"""A range for all entries of an input or a parameter, or a range for each entry."""

InputRanges = Annotated[dict[str, Pairs], AfterValidator(HashedTable)]
"""Ranges by the name of the input or the parameter."""


def ranges_of_no_input(scene: SceneTables) -> Iterator[Fault]:
    """Faults of ranges of names that are neither free nor parameters, or with another number of pairs than entries."""
    ranges = table_of(scene.get("ranges"))
    if not ranges:
        return
    counts = entry_counts(scene)
    # The first one of names that are tied together is the parameter's.
    listed = list_of(scene.get("parameters"))
    names = [*counts, *(entry[0] if isinstance(entry, list) and entry else entry for entry in listed)]
    for name, pairs in ranges.items():
        if name not in names:
            yield Fault(("ranges", name), "is not free at run time", listing(names, "inputs and parameters"))
            continue
        wanted = counts.get(name)
        if wanted is None or not isinstance(pairs, list) or _one_or_several(pairs) is SINGLE.tag:
            continue
        if len(pairs) not in (1, wanted):
            number = "1 pair" if wanted == 1 else f"1 pair or {wanted}"
            yield Fault(("ranges", name), f"must have {number}, got {len(pairs)}")
