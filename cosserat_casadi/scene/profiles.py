"""Profiles of values along a rod: tables, with one notation for every key, and the lists that keys store.

There are three tables, in the abscissa X or in 2X − 1; the key decides which of them a plain list stands for:

================================  ==============================================
``{ base = 8e-3, tip = 4e-3 }``   values at both ends, linear between them
``{ legendre = [6e-3, -2e-3] }``  coefficients of Legendre polynomials in 2X − 1
``{ powers = [8e-3, -4e-3] }``    coefficients of powers of X
================================  ==============================================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Any

import numpy as np
from numpy.polynomial import Legendre, Polynomial

from cosserat_casadi.scene.faults import Fault, Table, shown
from cosserat_casadi.spelling import closest

MOST_CONVERTED = 10
"""Most coefficients that are converted to other polynomials: powers of a higher degree would lose half their digits."""

REMEDY = "give base and tip, or legendre, or powers"


class Notation(Enum):
    """Meaning of the numbers of a profile; the value is its description."""

    ENDS = "base and tip"
    LEGENDRE = "Legendre coefficients"
    POWERS = "powers of X"


SERIES = {"legendre": Notation.LEGENDRE, "powers": Notation.POWERS}
"""Keys of a table that hold a list of coefficients."""

ENDS = ("base", "tip")
"""Keys of a table that is linear in X."""


class RefusedProfile(Exception):  # noqa: N818 - it never leaves the reading of scenes
    """Refusal of a table that is not a profile, with its faults."""

    def __init__(self, *faults: Fault) -> None:
        super().__init__(*faults)
        self.faults = faults


@dataclass(frozen=True)
class Profile:
    """A value along X.

    Attributes:
        notation: meaning of the numbers.
        numbers: values at base and tip, or coefficients of rising degree.
    """

    notation: Notation
    numbers: tuple[float, ...]

    @property
    def table(self) -> str:
        """The table of a scene file for this profile, with twelve digits; base and tip if it is linear."""
        if len(self.numbers) == 2:
            base, tip = self.ends
            return f"{{ base = {base:.12g}, tip = {tip:.12g} }}"
        numbers = ", ".join(f"{number:.12g}" for number in self.numbers)
        return f"{{ {_key(self.notation)} = [{numbers}] }}"

    @property
    def ends(self) -> tuple[float, float]:
        """Values at base and tip."""
        if self.notation is Notation.ENDS:
            base, tip = self.numbers
            return base, tip
        if self.notation is Notation.POWERS:
            return self.numbers[0], sum(self.numbers)
        # Every Legendre polynomial is 1 at the tip, and 1 or −1 at the base.
        even = sum(self.numbers[0::2])
        odd = sum(self.numbers[1::2])
        return even - odd, even + odd

    def converted(self, notation: Notation) -> Profile:
        """This profile in another notation.

        Raises:
            RefusedProfile: two values do not suffice, or too many coefficients would lose their digits.
        """
        if notation is self.notation:
            return self
        if notation is Notation.ENDS:
            return Profile(notation, self._linear_ends())
        if self.notation is Notation.ENDS:
            base, tip = self.numbers
            if notation is Notation.POWERS:
                return Profile(notation, (base, tip - base))
            return Profile(notation, (base / 2 + tip / 2, tip / 2 - base / 2))
        return Profile(notation, self._other_coefficients())

    def _linear_ends(self) -> tuple[float, float]:
        if len(self.numbers) > 2:
            problem = f"must be a list of 1 or 2 numbers, got {len(self.numbers)}"
            raise RefusedProfile(Fault((_key(self.notation),), problem, "it varies linearly along X"))
        return self.ends

    def _other_coefficients(self) -> tuple[float, ...]:
        count = len(self.numbers)
        if count > MOST_CONVERTED:
            problem = f"must be a list of at most {MOST_CONVERTED} numbers, got {count}"
            remedy = "powers of a higher degree lose their digits"
            raise RefusedProfile(Fault((_key(self.notation),), problem, remedy))
        # Numbers at the end of the range overflow; the ranges of the key refuse them.
        with np.errstate(all="ignore"):
            if self.notation is Notation.POWERS:
                other = Polynomial(self.numbers).convert(kind=Legendre, domain=[0, 1]).coef
            else:
                other = Legendre(self.numbers, domain=[0, 1]).convert(kind=Polynomial).coef
        # Leading zeros are dropped on the way; inputs count them.
        padded = np.zeros(count)
        padded[: len(other)] = other
        return tuple(padded.tolist())


def read_profile(table: Table) -> Profile:
    """The profile of a table of the scene.

    Raises:
        RefusedProfile: the table is faulty; it lists every fault.
    """
    known = (*ENDS, *SERIES)
    faults = [Fault((key,), "unknown key", closest(str(key), known)) for key in table if key not in known]
    given = [key for key in known if key in table]
    if not table:
        faults.append(Fault((), "says no values", REMEDY))
    for key in given:
        faults += _value_faults(key, table[key])
    faults += _notation_faults(given)
    if faults:
        raise RefusedProfile(*faults)
    key = given[0]
    if key in ENDS:
        return Profile(Notation.ENDS, (float(table["base"]), float(table["tip"])))
    return Profile(SERIES[key], tuple(float(number) for number in table[key]))


def ends_of(value: Any) -> tuple[float, ...]:
    """Base and tip of a size in the file, a number, a list of two or a table; empty if it is faulty."""
    if isinstance(value, Mapping):
        try:
            return read_profile(value).converted(Notation.ENDS).numbers
        except RefusedProfile:
            return ()
    ends: tuple[Any, ...] = tuple(value) if isinstance(value, list | tuple) else (value, value)
    if len(ends) != 2 or not all(_is_number(end) for end in ends):
        return ()
    return ends


def coefficient_count(value: Any) -> int:
    """Number of Legendre coefficients of a component in the file; 1 if it is faulty."""
    if isinstance(value, list | tuple):
        return len(value)
    if isinstance(value, Mapping):
        try:
            return len(read_profile(value).numbers)
        except RefusedProfile:
            return 1
    return 1


def _notation_faults(given: list[str]) -> list[Fault]:
    """Faults of a table with several notations, or with one end of a linear one."""
    of_ends = [key for key in given if key in ENDS]
    of_series = [key for key in given if key in SERIES]
    if of_series and len(given) > 1:
        return [Fault((of_series[-1],), f"stands beside {given[0]}", REMEDY)]
    if len(of_ends) == 1:
        (missing,) = set(ENDS) - set(of_ends)
        return [Fault((missing,), "missing", "give base and tip")]
    return []


def _value_faults(key: str, value: Any) -> list[Fault]:
    """Faults of the value of one key: a number for ``base`` and ``tip``, else a list of numbers."""
    if key in ENDS:
        return _number_faults((key,), value)
    if not isinstance(value, list | tuple):
        return [Fault((key,), f"must be a list, got {shown(value)}", SERIES[key].value)]
    if not value:
        return [Fault((key,), "must have at least one entry")]
    faults = []
    for i, number in enumerate(value):
        faults += _number_faults((key, i), number)
    return faults


def _number_faults(path: tuple[str | int, ...], value: Any) -> list[Fault]:
    if not _is_number(value):
        return [Fault(path, f"must be a number, got {shown(value)}")]
    try:
        finite = isfinite(value)
    except OverflowError:
        finite = False
    if not finite:
        return [Fault(path, f"must be finite, got {shown(value)}")]
    return []


def _is_number(value: Any) -> bool:
    # Truth values are integers in Python.
    return isinstance(value, int | float) and not isinstance(value, bool)


def _key(notation: Notation) -> str:
    """The key of a list of coefficients."""
    keys = {of: key for key, of in SERIES.items()}
    return keys[notation]
