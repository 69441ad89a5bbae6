"""Supports that ship: the directions of a tip that each holds in the world."""

from __future__ import annotations

from typing import final

from cosserat_casadi.constraints.held_directions import CLAMPED, PINNED
from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.constraints.tip_holder import Support
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.constraint_records import ClampedSupport, PinnedSupport
from cosserat_casadi.scene.families import register

SUPPORT_KINDS = Support.kinds
"""Supports by the word of the scene format."""


@final
@register
class Clamped(Support[ClampedSupport]):
    """The tip keeps its pose."""

    record = ClampedSupport

    def held(self, record: ClampedSupport, rotation: FloatArray) -> HeldDirections:
        """Position and rotation."""
        return CLAMPED


@final
@register
class Pinned(Support[PinnedSupport]):
    """The tip keeps its position and turns freely."""

    record = PinnedSupport

    def held(self, record: PinnedSupport, rotation: FloatArray) -> HeldDirections:
        """The position."""
        return PINNED
