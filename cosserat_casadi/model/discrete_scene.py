"""A scene with everything settled that does not depend on the unknowns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.section_constraint import SectionConstraint
from cosserat_casadi.model.constraints import FORCE_WEIGHT, PlacedConstraint, placed_constraints
from cosserat_casadi.model.floating_frames import FloatingFrame, FrameName, UnloadedScene
from cosserat_casadi.model.homotopy import Compliance
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.rods import rod_properties
from cosserat_casadi.model.unknowns import Block, BlockKind, Unknowns
from cosserat_casadi.rod.cable import Routing
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.strain import DiscreteRod


@dataclass(frozen=True)
class CableOfLength:
    """A tendon of given length, whose tension is an unknown.

    Attributes:
        tendon: as the scene has it.
        routing: where it runs.
        compliance: how its equation yields on the way to the scene.
    """

    tendon: scenes.Actuator
    routing: Routing

    @property
    def compliance(self) -> Compliance:
        """The spring between its length and the wanted one; slack cables have their tension in the equation."""
        slack = EFFECTS[self.tendon.kind].may_go_slack(self.tendon)
        return Compliance(power=1, sign=1.0 if slack else -1.0)


@dataclass(frozen=True)
class DiscreteScene:
    """A scene with its constant matrices.

    Attributes:
        scene: the scene.
        layout: its inputs.
        rods: the constant matrices of each rod.
    """

    scene: scenes.Scene
    layout: InputLayout
    rods: dict[str, DiscreteRod]

    @cached_property
    def unloaded(self) -> UnloadedScene:
        """Poses of rods and bodies where nothing acts."""
        return UnloadedScene(self.scene, self.rods)

    @property
    def frames(self) -> dict[FrameName, FloatingFrame]:
        """Floating frames by name."""
        return self.unloaded.frames

    @cached_property
    def constraints(self) -> list[PlacedConstraint]:
        """Supports, bases of carried rods and joints, in the order of their multipliers."""
        return placed_constraints(self.unloaded)

    @cached_property
    def cables(self) -> list[CableOfLength]:
        """Tendons of given length."""
        cables = []
        for actuator in self.scene.actuators:
            member = EFFECTS[actuator.kind]
            if member.prescribes_conjugate(actuator):
                cables.append(CableOfLength(actuator, member.quantity(actuator, self.rods[actuator.rod].grid)))
        return cables

    def constraint(self, where: str) -> SectionConstraint:
        """The constraint of a table of the scene, by its path."""
        return next(placed.constraint for placed in self.constraints if placed.where == where)

    @property
    def is_assembly(self) -> bool:
        """Whether constraints close rods to each other, or a carried rod to the world."""
        return any(placed.closes_assembly for placed in self.constraints)

    def constraints_on(self, rod: str) -> list[PlacedConstraint]:
        """Constraints that hold sections of a rod."""
        return [placed for placed in self.constraints if placed.rod == rod]

    @cached_property
    def unknowns(self) -> Unknowns:
        """What the unknowns x are and where they stand: strains, multipliers, poses, tensions."""
        blocks = [*self._strain_blocks(), *self._multiplier_blocks(), *self._pose_blocks(), *self._tension_blocks()]
        return Unknowns(tuple(blocks))

    def _strain_blocks(self) -> Iterator[Block]:
        for name, rod in self.rods.items():
            yield Block(BlockKind.STRAIN, name, name, rod.size, rod.energy_unit, 1.0)

    def _multiplier_blocks(self) -> Iterator[Block]:
        for placed in self.constraints:
            unit = placed.constraint.unit
            yield Block(BlockKind.MULTIPLIER, placed.where, placed.rod, placed.size, unit, placed.step_weight)

    def _pose_blocks(self) -> Iterator[Block]:
        for name, frame in self.frames.items():
            yield Block(BlockKind.POSE, str(name), None, FloatingFrame.SIZE, frame.unit, 1.0)

    def _tension_blocks(self) -> Iterator[Block]:
        for cable in self.cables:
            rod = cable.tendon.rod
            unit = self.rods[rod].energy_unit
            yield Block(BlockKind.TENSION, cable.tendon.name, rod, 1, unit, FORCE_WEIGHT)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.unknowns.size

    def multipliers(self, placed: PlacedConstraint) -> slice:
        """Where the multipliers of a constraint stand in x."""
        return self.unknowns.slice_of(BlockKind.MULTIPLIER, placed.where)

    def deviation(self, frame: FrameName) -> slice:
        """Where the deviation of a floating frame stands in x."""
        return self.unknowns.slice_of(BlockKind.POSE, str(frame))

    def tension(self, cable: CableOfLength) -> slice:
        """Where the tension of a cable of given length stands in x."""
        return self.unknowns.slice_of(BlockKind.TENSION, cable.tendon.name)

    def tension_unit(self, rod: str) -> float:
        """EI/ℓ² of a rod, N."""
        return self.rods[rod].energy_unit / self.rods[rod].properties.length


def discrete_scene(
    scene: scenes.Scene, layout: InputLayout, discretisation: Mapping[str, Discretisation]
) -> DiscreteScene:
    """Constant matrices of every rod of a scene."""
    rods = {rod.name: DiscreteRod(rod_properties(rod), discretisation[rod.name]) for rod in scene.rods}
    return DiscreteScene(scene, layout, rods)
