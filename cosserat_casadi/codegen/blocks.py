"""How the Jacobian of an assembly falls into blocks, one for each rod, with moving frames as their border.

A rod's strains, the multipliers of what holds it and the tensions in it meet the other rods through moving frames
alone. So each block is eliminated on its own, with its rows and columns of the border, and what is left of the border
is eliminated last: the work is linear in the number of rods. A front is a block with the border that it touches.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.model.discrete_scene import DiscreteScene

BORDER = -1
"""Owner of what belongs to no rod."""


@dataclass(frozen=True)
class Front:
    """A block with the part of the border that it touches.

    Attributes:
        members: unknowns of the block.
        edges: places in the border, not in x.
        first: where its matrix begins among all fronts.
    """

    members: list[int]
    edges: list[int]
    first: int

    @property
    def order(self) -> int:
        """Rows of its matrix."""
        return len(self.members) + len(self.edges)


@dataclass(frozen=True)
class Blocks:
    """Blocks of a Jacobian.

    Attributes:
        owners: for each unknown the number of its rod, or BORDER.
        pattern: sparsity of the Jacobian.
    """

    owners: list[int]
    pattern: ca.Sparsity

    @cached_property
    def entry_owners(self) -> list[int]:
        """For each entry of the Jacobian the rod that it belongs to, or BORDER."""
        rows, columns = self.pattern.get_triplet()
        return [max(self.owners[i], self.owners[j]) for i, j in zip(rows, columns, strict=True)]

    @property
    def separate(self) -> bool:
        """Whether no entry couples two blocks without the border."""
        rows, columns = self.pattern.get_triplet()
        pairs = ({self.owners[i], self.owners[j]} - {BORDER} for i, j in zip(rows, columns, strict=True))
        return all(len(pair) < 2 for pair in pairs)

    @cached_property
    def border(self) -> list[int]:
        """Unknowns of the border."""
        return [i for i, owner in enumerate(self.owners) if owner == BORDER]

    @cached_property
    def fronts(self) -> list[Front]:
        """Fronts of the rods."""
        rows, columns = map(np.array, self.pattern.get_triplet())
        owners, place = np.array(self.owners), {k: i for i, k in enumerate(self.border)}
        found, first = list[Front](), 0
        for rod in sorted(set(self.owners) - {BORDER}):
            touched = {*columns[owners[rows] == rod].tolist(), *rows[owners[columns] == rod].tolist()}
            edges = sorted(place[k] for k in touched if k in place)
            found.append(Front(np.flatnonzero(owners == rod).tolist(), edges, first))
            first += found[-1].order ** 2
        return found

    @property
    def border_first(self) -> int:
        """Where the border's own matrix begins."""
        return sum(front.order**2 for front in self.fronts)

    @property
    def room(self) -> int:
        """Numbers in all fronts and the border."""
        return self.border_first + len(self.border) ** 2

    @cached_property
    def places(self) -> list[int]:
        """Where each entry of the Jacobian stands in the fronts."""
        border = {k: i for i, k in enumerate(self.border)}
        local = [
            {k: i for i, k in enumerate([*front.members, *(self.border[e] for e in front.edges)])}
            for front in self.fronts
        ]
        places = []
        for i, j, owner in zip(*self.pattern.get_triplet(), self.entry_owners, strict=True):
            if owner == BORDER:
                places.append(self.border_first + border[i] + border[j] * len(border))
            else:
                front, own = self.fronts[owner], local[owner]
                places.append(front.first + own[i] + own[j] * front.order)
        return places

    @cached_property
    def dense_places(self) -> list[int]:
        """Where each entry stands in the dense matrix, column after column."""
        rows, columns = self.pattern.get_triplet()
        return [i + j * self.pattern.size1() for i, j in zip(rows, columns, strict=True)]


def blocks(frame: DiscreteScene, pattern: ca.Sparsity) -> Blocks | None:
    """Blocks of a scene's Jacobian; None where there is one rod alone, or nothing couples them, or too much does."""
    literal = any(discrete_rod.discretisation.transport == "permuted" for discrete_rod in frame.rods.values())
    if len(frame.rods) < 2 or not frame.frames or literal:
        return None
    found = Blocks(_owners(frame), pattern)
    return found if found.separate else None


def _owners(frame: DiscreteScene) -> list[int]:
    numbers: dict[str | None, int] = {rod: i for i, rod in enumerate(frame.rods)}
    owners = []
    for block in frame.unknowns.blocks:
        owners += [numbers.get(block.rod, BORDER)] * block.size
    return owners
