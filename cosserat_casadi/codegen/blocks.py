"""Blocks of the Jacobian of an assembly, one for each rod, with moving frames as their interface.

The strains of a rod, the multipliers of its supports and its tensions are coupled to the other rods through moving
frames alone. So each block is eliminated by itself, with its rows and columns of the interface, and the rest of the
interface is eliminated last: the work is linear in the number of rods. A front is a block with the interface
unknowns to which it is coupled.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.floating_frames import FloatingFrame

INTERFACE = -1
"""Owner number of unknowns that belong to no rod."""


@dataclass(frozen=True)
class Front:
    """A block with the part of the interface to which it is coupled.

    Attributes:
        members: unknowns of the block.
        interface: interface unknowns to which it is coupled, as indices within the interface, not within x.
        start: index of the first entry of its matrix among the matrices of all fronts.
    """

    members: list[int]
    interface: list[int]
    start: int

    @property
    def order(self) -> int:
        """Number of rows of the matrix."""
        return len(self.members) + len(self.interface)


@dataclass(frozen=True)
class Elimination:
    """An order of elimination as tables.

    Attributes:
        fronts: fronts, in the order of elimination.
        interface: unknowns of the interface, which is eliminated last.
        entry_fronts: for each entry its front, or the number of fronts for an entry of the interface.
        entry_rows: for each entry its row in the matrix of that front.
        entry_columns: for each entry its column in the matrix of that front.
    """

    fronts: list[Front]
    interface: list[int]
    entry_fronts: list[int]
    entry_rows: list[int]
    entry_columns: list[int]

    @property
    def interface_start(self) -> int:
        """Index of the first entry of the interface matrix, which follows the matrices of the fronts."""
        return sum(front.order**2 for front in self.fronts)

    @property
    def size(self) -> int:
        """Count of numbers in the matrices of all fronts and of the interface."""
        return self.interface_start + len(self.interface) ** 2

    @property
    def indices(self) -> list[int]:
        """Index of each entry among the numbers of all matrices."""
        starts = [*(front.start for front in self.fronts), self.interface_start]
        orders = [*(front.order for front in self.fronts), len(self.interface)]
        places = zip(self.entry_fronts, self.entry_rows, self.entry_columns, strict=True)
        return [starts[front] + row + column * orders[front] for front, row, column in places]


@dataclass(frozen=True)
class Blocks:
    """Blocks of a Jacobian.

    Attributes:
        owners: for each unknown the number of its rod, or INTERFACE.
        pattern: sparsity of the Jacobian.
        parts: for each unknown the rod with which its row is computed, or INTERFACE; a moving base belongs to the
            interface, but is computed with its rod, whose wrench acts on it.
    """

    owners: list[int]
    pattern: ca.Sparsity
    parts: list[int]

    @cached_property
    def entry_owners(self) -> list[int]:
        """Number of the rod to which each entry of the Jacobian belongs, or INTERFACE."""
        rows, columns = self.pattern.get_triplet()
        return [max(self.owners[i], self.owners[j]) for i, j in zip(rows, columns, strict=True)]

    @cached_property
    def entry_parts(self) -> list[int]:
        """Number of the rod with which each entry of the Jacobian is computed, or INTERFACE."""
        rows, columns = self.pattern.get_triplet()
        parts = []
        for owner, i, j in zip(self.entry_owners, rows, columns, strict=True):
            of_interface = self.parts[j] if self.parts[i] == INTERFACE else self.parts[i]
            parts.append(of_interface if owner == INTERFACE else owner)
        return parts

    @property
    def separate(self) -> bool:
        """Whether no entry couples two blocks directly, past the interface."""
        rows, columns = self.pattern.get_triplet()
        owners = ({self.owners[i], self.owners[j]} for i, j in zip(rows, columns, strict=True))
        return all(len(pair - {INTERFACE}) < 2 for pair in owners)

    @cached_property
    def interface(self) -> list[int]:
        """Unknowns of the interface."""
        return [i for i, owner in enumerate(self.owners) if owner == INTERFACE]

    @cached_property
    def fronts(self) -> list[Front]:
        """Fronts of the rods."""
        rows, columns = map(np.array, self.pattern.get_triplet())
        owners = np.array(self.owners)
        number = {unknown: i for i, unknown in enumerate(self.interface)}
        fronts = list[Front]()
        start = 0
        for rod in sorted(set(self.owners) - {INTERFACE}):
            touched = {*columns[owners[rows] == rod].tolist(), *rows[owners[columns] == rod].tolist()}
            shared = sorted(number[unknown] for unknown in touched if unknown in number)
            front = Front(np.flatnonzero(owners == rod).tolist(), shared, start)
            fronts.append(front)
            start += front.order**2
        return fronts

    @cached_property
    def by_fronts(self) -> Elimination:
        """Elimination of one front after another."""
        interface = {unknown: i for i, unknown in enumerate(self.interface)}
        local = list[dict[int, int]]()
        for front in self.fronts:
            unknowns = [*front.members, *(self.interface[i] for i in front.interface)]
            local.append({unknown: i for i, unknown in enumerate(unknowns)})
        local.append(interface)
        fronts = [len(self.fronts) if owner == INTERFACE else owner for owner in self.entry_owners]
        rows, columns = self.pattern.get_triplet()
        return Elimination(
            fronts=self.fronts,
            interface=self.interface,
            entry_fronts=fronts,
            entry_rows=[local[front][i] for front, i in zip(fronts, rows, strict=True)],
            entry_columns=[local[front][j] for front, j in zip(fronts, columns, strict=True)],
        )

    @property
    def as_a_whole(self) -> Elimination:
        """Elimination of all unknowns as one front."""
        rows, columns = self.pattern.get_triplet()
        whole = Front(list(range(len(self.owners))), [], 0)
        return Elimination([whole], [], [0] * len(rows), [*rows], [*columns])

    @cached_property
    def dense_indices(self) -> list[int]:
        """Index of each entry in the dense matrix, which is stored by columns."""
        rows, columns = self.pattern.get_triplet()
        return [i + j * self.pattern.size1() for i, j in zip(rows, columns, strict=True)]


def blocks(discrete: DiscreteScene, pattern: ca.Sparsity) -> Blocks | None:
    """Find the blocks of a scene's Jacobian; None for a single rod, and if rods are not coupled or couple directly."""
    literal = any(discrete_rod.discretisation.transport == "permuted" for discrete_rod in discrete.rods.values())
    if len(discrete.rods) < 2 or not discrete.frames or literal:
        return None
    numbers: dict[str | None, int] = {rod: i for i, rod in enumerate(discrete.rods)}
    owners = list[int]()
    for block in discrete.unknowns.blocks:
        owners += [numbers.get(block.rod, INTERFACE)] * block.size
    parts = owners.copy()
    for frame in discrete.frames:
        if frame.kind == "rod":
            base = discrete.deviation(frame)
            parts[base] = [numbers[frame.name]] * FloatingFrame.SIZE
    partition = Blocks(owners, pattern, parts)
    return partition if partition.separate else None
