"""The unknowns x of a scene as records: what each block of entries is, its owner, and its slice of x.

This module alone knows the order of x; other modules ask for the block of a part of x.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray


class BlockKind(Enum):
    """Kind of a block of unknowns."""

    STRAIN = "strain"
    """Strain coordinates of a rod."""
    MULTIPLIER = "multiplier"
    """Forces and moments of a support, a joint or the base of a carried rod."""
    POSE = "pose"
    """Deviation of a floating frame from its pose in the unloaded scene."""
    COORDINATE = "coordinate"
    """Angle or displacement of a joint that something acts along."""
    TENSION = "tension"
    """Tension of a cable of given length."""
    STOP = "stop"
    """Moment or force of a stop of a joint."""
    FLOW = "flow"
    """Strain coordinates, since the start of a motion, of the dashpots of a rod with relaxing stress."""


@dataclass(frozen=True)
class UnknownBlock:
    """A run of unknowns of one kind and one owner.

    Attributes:
        kind: what the unknowns are.
        owner: name of the rod, the floating frame or the tendon; path of the scene's table of a constraint or a joint.
        rod: name of the rod with which the block is eliminated; None for a block that several rods share.
        size: number of unknowns.
        unit: energy that the equations are divided by, J.
        step_weight: how much one unit counts in the length of a continuation step.
    """

    kind: BlockKind
    owner: str
    rod: str | None
    size: int
    unit: float
    step_weight: float = 1.0

    @property
    def differential(self) -> bool:
        """Whether the unknowns are differential; multipliers, tensions and pushes are algebraic."""
        # Algebraic unknowns follow from the coordinates at every instant and have no rates.
        return self.kind in (BlockKind.STRAIN, BlockKind.POSE, BlockKind.COORDINATE, BlockKind.FLOW)


@dataclass(frozen=True)
class Unknowns:
    """All unknowns of a scene.

    Attributes:
        blocks: in the order in which they stand in x.
    """

    blocks: tuple[UnknownBlock, ...]

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        return sum(block.size for block in self.blocks)

    @cached_property
    def slices(self) -> dict[tuple[BlockKind, str], slice]:
        """Slice of each block in x, by kind and owner."""
        slices = {}
        start = 0
        for block in self.blocks:
            stop = start + block.size
            slices[block.kind, block.owner] = slice(start, stop)
            start = stop
        return slices

    @cached_property
    def ends(self) -> list[int]:
        """Last entry of each block in x, plus one."""
        return [entries.stop for entries in self.slices.values()]

    def of_kind(self, *kinds: BlockKind) -> Iterator[tuple[UnknownBlock, slice]]:
        """The blocks of some kinds with their slices of x."""
        for block, entries in zip(self.blocks, self.slices.values(), strict=True):
            if block.kind in kinds:
                yield block, entries

    def slice_of(self, kind: BlockKind, owner: str) -> slice:
        """Slice of a block in x.

        Raises:
            KeyError: there is no such block.
        """
        return self.slices[kind, owner]

    def strain(self, rod: str) -> slice:
        """Slice of the strain coordinates of a rod in x."""
        return self.slice_of(BlockKind.STRAIN, rod)

    def count(self, *kinds: BlockKind) -> int:
        """Number of unknowns of some kinds."""
        return sum(block.size for block, _ in self.of_kind(*kinds))

    @cached_property
    def step_weights(self) -> FloatArray:
        """How much each unknown counts in the length of a continuation step, shape (size,)."""
        return self._repeated([block.step_weight for block in self.blocks])

    @cached_property
    def units(self) -> FloatArray:
        """Energy that each equation is divided by, shape (size,), J."""
        return self._repeated([block.unit for block in self.blocks])

    @cached_property
    def differential(self) -> npt.NDArray[np.bool_]:
        """Whether each unknown is differential, shape (size,)."""
        return self._repeated([block.differential for block in self.blocks]) > 0.0

    def _repeated(self, values: Sequence[float]) -> FloatArray:
        """One value for each block, repeated for each of its unknowns, shape (size,)."""
        return np.repeat(np.asarray(values, dtype=float), [block.size for block in self.blocks])
