"""Discretisation of a rod: data that a user fixes, or the search for a tolerance chooses."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from cosserat_casadi.maths.grid import Grid

TRANSPORTS = ("magnus4", "magnus6", "magnus8", "permuted")
"""Rotation integrators: three product-of-exponentials methods and the literal system of chapter 3."""


@dataclass(frozen=True)
class Discretisation:
    """Polynomials and grid of one rod.

    Attributes:
        modes: number of polynomials per admitted strain and element, degrees 0 … n − 1.
        nodes: Chebyshev intervals per element.
        breaks: element ends on [0, 1]; a point load must sit on one.
        transport: one of TRANSPORTS.
        sections: sections of an element at which thin layers are summed; 0 for as many as its intervals ask for.
        fibres: points across half of a section at which the law of its material is summed; 0 for one that is not.
    """

    modes: tuple[int, ...]
    nodes: int
    breaks: tuple[float, ...] = (0.0, 1.0)
    transport: str = "magnus6"
    sections: int = 0
    fibres: int = 0

    def __post_init__(self) -> None:
        if self.transport not in TRANSPORTS:
            raise ValueError(f"transport is one of {TRANSPORTS}, got {self.transport!r}")

    def plain(self) -> dict[str, Any]:
        """The discretisation as data; numbers of sums are left out where they are zero."""
        return {name: value for name, value in asdict(self).items() if name not in ("sections", "fibres") or value}

    def with_more_fibres(self, count: int = 1) -> Discretisation:
        """The discretisation with further points for a law that is summed; itself for a law that is not."""
        return replace(self, fibres=self.fibres + count) if self.fibres else self

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.breaks) - 1

    @property
    def unknowns(self) -> int:
        """Number of strain coordinates q of the rod."""
        return self.elements * sum(self.modes)

    @property
    def grid(self) -> Grid:
        """The grid the rod's fields live on."""
        return Grid(self.breaks, self.nodes)
