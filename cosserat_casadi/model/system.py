"""The equations of a scene as expressions: rods side by side, coupled by the wrenches of supports.

Unknowns x: the strain coordinates of every rod, then the multipliers of every support. A single rod is the case of
one; what couples rods adds rows and columns, never instructions to the rods themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import HeldLength
from cosserat_casadi.constraints.tip_support import Hold, Pose
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.assembly import Coupled
from cosserat_casadi.model.couplings import Carrier, Couplings, MovingFrame
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.model.load_assembly import RodBase, RodLoads, input_value, rod_actuation
from cosserat_casadi.model.registry import EFFECTS, SUPPORTS
from cosserat_casadi.model.rods import base_pose, rod_properties
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.cable import Routing
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod, Ratio
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import PoseWrench, RodLoad, Wrench


@dataclass(frozen=True)
class Arguments:
    """Symbols, or numbers, that a system is written in.

    Attributes:
        x: unknowns.
        inputs: stacked inputs.
        factor: 0 is the unloaded scene, 1 the scene itself; between them loads are scaled and supports yield.
    """

    x: Matrix
    inputs: Matrix
    factor: Matrix | float = 1.0


@dataclass(frozen=True)
class DiscreteScene:
    """A scene with everything that does not depend on the unknowns settled.

    Attributes:
        scene: the scene.
        layout: its inputs.
        rods: the constant matrices of each rod.
    """

    scene: scenes.Scene
    layout: InputLayout
    rods: dict[str, DiscreteRod]

    @cached_property
    def holds(self) -> list[tuple[scenes.Support, Hold]]:
        """Supports of rods that start in the world, each as the scene and as the mechanics have it."""
        still = [support for support in self.scene.supports if self.couplings.carrier(support.rod) is None]
        return [(support, self.hold(support)) for support in still]

    @cached_property
    def couplings(self) -> Couplings:
        """What couples the rods."""
        return Couplings(self.scene, self.rods)

    @cached_property
    def hold_slices(self) -> list[slice]:
        """Where each support's multipliers stand in x."""
        return _slices(self.strain_size, [hold.size for _, hold in self.holds])

    @cached_property
    def tie_slices(self) -> dict[str, slice]:
        """Where each tie's multipliers stand in x."""
        start, ties = self.strain_size + sum(hold.size for _, hold in self.holds), self.couplings.ties
        places = _slices(start, [tie.joint.size for tie in ties])
        return {tie.where: place for tie, place in zip(ties, places, strict=True)}

    @cached_property
    def moving_slices(self) -> dict[Carrier, slice]:
        """Where each moving frame's deviation stands in x."""
        start = self.strain_size + self.multiplier_size
        places = _slices(start, [MovingFrame.SIZE] * len(self.couplings.moving))
        return dict(zip(self.couplings.moving, places, strict=True))

    @cached_property
    def multiplier_size(self) -> int:
        """Number of multipliers of supports and ties."""
        ties = sum(tie.joint.size for tie in self.couplings.ties)
        return ties + sum(hold.size for _, hold in self.holds)

    @cached_property
    def rod_slices(self) -> dict[str, slice]:
        """Where each rod's coordinates stand in x."""
        ends = np.cumsum([0, *[discrete_rod.size for discrete_rod in self.rods.values()]])
        return {n: slice(int(a), int(b)) for n, a, b in zip(self.rods, ends, ends[1:], strict=False)}

    @cached_property
    def strain_size(self) -> int:
        """Number of strain coordinates of all rods."""
        return sum(discrete_rod.size for discrete_rod in self.rods.values())

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        moving = MovingFrame.SIZE * len(self.couplings.moving)
        return self.strain_size + self.multiplier_size + moving + len(self.cables)

    @cached_property
    def cables(self) -> list[tuple[scenes.Actuator, Routing]]:
        """Tendons of given length, whose tensions are unknowns, unit EI/ℓ² each."""
        held = [a for a in self.scene.actuators if EFFECTS[a.kind].prescribes_conjugate(a)]
        return [(tendon, EFFECTS[tendon.kind].quantity(tendon, self.rods[tendon.rod].grid)) for tendon in held]

    @cached_property
    def tension_slices(self) -> list[slice]:
        """Where the tensions of tendons of given length stand in x."""
        return _slices(self.size - len(self.cables), [1] * len(self.cables))

    def tension_place(self, tendon: str) -> int:
        """Where the tension of one of them stands in x."""
        return int(self.tension_slices[[cable.name for cable, _ in self.cables].index(tendon)].start)

    def tension_unit(self, rod: str) -> float:
        """EI/ℓ² of a rod, N."""
        return self.rods[rod].energy_unit / self.rods[rod].properties.length

    def base(self, rod: str) -> Pose:
        """World pose of a rod's base."""
        position, quaternion = base_pose(next(r for r in self.scene.rods if r.name == rod))
        return Pose(ca.DM(position), ca.DM(quaternion))

    def hold(self, support: scenes.Support) -> Hold:
        """The support as the mechanics see it."""
        discrete_rod, kind = self.rods[support.rod], SUPPORTS[support.kind]
        return Hold(
            discrete_rod.properties, discrete_rod.energy_unit, kind.turns, kind.target(support, self.base(support.rod))
        )


def discrete_scene(
    scene: scenes.Scene, layout: InputLayout, discretisation: Mapping[str, Discretisation]
) -> DiscreteScene:
    """Constant matrices of every rod of a scene."""
    bases = {rod.name: DiscreteRod(rod_properties(rod), discretisation[rod.name]) for rod in scene.rods}
    return DiscreteScene(scene, layout, bases)


def _slices(start: int, sizes: Sequence[int]) -> list[slice]:
    ends = np.cumsum([start, *sizes])
    return [slice(int(a), int(b)) for a, b in pairwise(ends)]


@dataclass(frozen=True)
class System:
    """The equations of a scene in given arguments.

    Attributes:
        discrete: what is constant.
        arguments: what they are written in.
    """

    discrete: DiscreteScene
    arguments: Arguments

    @cached_property
    def rods(self) -> dict[str, InverseGeometricModel]:
        """Balance of every rod, in its base frame."""
        return {name: self._rod(name) for name in self.discrete.rods}

    @cached_property
    def tangents(self) -> dict[str, Tangent]:
        """Variations of every rod's fields."""
        return {name: Tangent(igm) for name, igm in self.rods.items()}

    @cached_property
    def residual(self) -> Matrix:
        """Residuals of the rods, gaps of supports and ties, balance of moving frames, gaps of cables: without unit."""
        gaps = [self.closing(hold.gap(self.tip(s.rod)), multipliers) for s, hold, multipliers in self.holds]
        rods = [igm.residual for igm in self.rods.values()]
        lengths = [length.gap for length in self.lengths]
        return ca.vertcat(*rods, *gaps, *self.coupled.gaps, *self.coupled.balances, *lengths)

    @cached_property
    def coupled(self) -> Coupled:
        """What moving frames and ties add."""
        return Coupled(self)

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x from its structure, exact for the discrete model; sparse by rods."""
        if any(b.discretisation.transport == "permuted" for b in self.discrete.rods.values()):
            return ca.jacobian(self.residual, self.arguments.x)
        if self.discrete.couplings.ties or self.discrete.holds or self.discrete.cables:
            return self.coupled.jacobian
        return ca.diagcat(*[tangent.jacobian for tangent in self.tangents.values()])

    def tip(self, rod: str) -> Pose:
        """Pose of a rod's tip in its base frame."""
        place = self.rods[rod].shape
        return Pose(place.position_at(-1), place.quaternion[:, -1])

    def actuator(self, name: str) -> tuple[Matrix, Matrix, Matrix]:
        """Effort of an actuator, the length or volume that it works on, and the derivative of that with x."""
        one = next(actuator for actuator in self.discrete.scene.actuators if actuator.name == name)
        member = EFFECTS[one.kind]
        conjugate = member.quantity(one, self.discrete.rods[one.rod].grid).on(self.rods[one.rod].shape)
        unknown = member.prescribes_conjugate(one)
        effort = self._tension(one) if unknown else self._effort(one, member.effort)
        effort = ca.fmax(effort, 0.0) if member.may_go_slack(one) else effort
        extent, gradient = conjugate.value, conjugate.gradient
        rest = type(self.arguments.x)(self.discrete.size - self.discrete.strain_size, 1)
        return effort, extent, ca.vertcat(self._among_strains(one.rod, gradient), rest).T

    def _effort(self, actuator: scenes.Actuator, field: str) -> Matrix:
        value = input_value(self.discrete.layout, actuator, field, self.arguments)
        return ca.DM(0.0) if value is None else value

    def base(self, rod: str) -> Pose:
        """World pose of a rod's base."""
        if self.discrete.couplings.carrier(rod) is None:
            return self._still_base(rod)
        place = self.coupled.base(rod)
        return Pose(place.position, place.direction)

    def _still_base(self, rod: str) -> Pose:
        """Pose of a base that rests in the world: the scene's, or what the inputs say."""
        pose = self.discrete.base(rod)
        position, quaternion = (self._input(f"{rod}.base.{word}") for word in ("position", "quaternion"))
        turn = pose.quaternion if quaternion is None else quaternion / ca.sqrt(ca.sumsqr(quaternion))
        return Pose(pose.position if position is None else position, turn)

    def _input(self, name: str) -> Matrix | None:
        """An input of a rod's own geometry; None where the scene fixes it."""
        place = self.discrete.layout.slices.get(name)
        return None if place is None else self.arguments.inputs[place]

    def energy(self) -> Matrix:
        """Elastic energy of all rods, J."""
        return ca.sum1(ca.vertcat(*[igm.energy for igm in self.rods.values()]))

    def potential(self) -> Matrix | None:
        """Energy of all rods and their dead forces, J; None where some load has none that can be written."""
        terms = [igm.potential for igm in self.rods.values()]
        if self.discrete.scene.supports or self.discrete.couplings.ties or any(term is None for term in terms):
            return None
        return ca.sum1(ca.vertcat(*terms))

    @property
    def whole(self) -> bool:
        """Whether the equations are those of the scene itself, not of a point on the way to it."""
        return isinstance(self.arguments.factor, float) and self.arguments.factor == 1.0

    def closing(self, gap: Matrix, multipliers: Matrix) -> Matrix:
        """A support on the way to the scene: a spring between the tip and its target, from limp to rigid."""
        factor = self.arguments.factor
        return gap if self.whole else factor * gap + (1 - factor) * multipliers

    def dead_wrenches(self, rod: str) -> list[Wrench]:
        """Wrenches of the scene's loads on a rod that keep their direction in the world, base frame."""
        loads = self._loads(rod)
        return [load for load in loads if not isinstance(load, PoseWrench) and not load.follower]

    def _loads(self, rod: str) -> list[RodLoad]:
        base = RodBase(self.base(rod).position, self._base_R_world(rod))
        ratio = ratio_of(self.discrete, rod, self.arguments)
        return RodLoads(self.discrete, rod, base, self.arguments, ratio).all()

    @cached_property
    def holds(self) -> list[tuple[scenes.Support, Hold, Matrix]]:
        """Supports of rods that start in the world, with their multipliers."""
        found, start = [], self.discrete.strain_size
        for support, fixed in self.discrete.holds:
            hold = self._held(support, fixed)
            found.append((support, hold, self.arguments.x[start : start + hold.size]))
            start += hold.size
        return found

    def _held(self, support: scenes.Support, hold: Hold) -> Hold:
        """A support as the rod sees it from a base that inputs may move."""
        if not any(f"{support.rod}.base.{word}" in self.discrete.layout.slices for word in ("position", "quaternion")):
            return hold
        return replace(hold, target=SUPPORTS[support.kind].target(support, self.base(support.rod)))

    @cached_property
    def lengths(self) -> list[HeldLength]:
        """Equations of the cables of given length."""
        return [self._held_length(tendon, routing) for tendon, routing in self.discrete.cables]

    def _held_length(self, tendon: scenes.Actuator, routing: Routing) -> HeldLength:
        whole = replace(self.arguments, factor=1.0)
        return HeldLength(
            cable=routing.on(self.rods[tendon.rod].shape),
            wanted=input_value(self.discrete.layout, tendon, "length", whole),
            tension=self.arguments.x[self.discrete.tension_place(tendon.name)],
            slack=EFFECTS[tendon.kind].may_go_slack(tendon),
            factor=self.arguments.factor,
        )

    def _among_strains(self, rod: str, columns: Matrix) -> Matrix:
        """Columns on the coordinates of one rod, among those of all."""
        place, count = self.discrete.rod_slices[rod], columns.shape[1]
        pad = type(columns)
        before, after = pad(place.start, count), pad(self.discrete.strain_size - place.stop, count)
        return ca.vertcat(before, columns, after)

    def _rod(self, name: str) -> InverseGeometricModel:
        discrete_rod = self.discrete.rods[name]
        q = self.arguments.x[self.discrete.rod_slices[name]]
        loads = self._loads(name)
        loads += [hold.wrench(m) for s, hold, m in self.holds if s.rod == name]
        ties = [tie for tie in self.discrete.couplings.ties if tie.rod == name]
        loads += [tie.joint.wrench(self.coupled.multipliers(tie)) for tie in ties]
        efforts = rod_actuation(self.discrete, name, self.arguments)
        efforts += [Actuation(routing, self._tension(t)) for t, routing in self.discrete.cables if t.rod == name]
        place = shape(discrete_rod, q, ratio_of(self.discrete, name, self.arguments))
        return InverseGeometricModel(Statics(place, loads), tuple(efforts))

    def _tension(self, tendon: scenes.Actuator) -> Matrix:
        """Unknown tension of a tendon of given length, N."""
        return self.discrete.tension_unit(tendon.rod) * self.arguments.x[self.discrete.tension_place(tendon.name)]

    def _base_R_world(self, rod: str) -> Matrix:
        if self.discrete.couplings.carrier(rod) is not None:
            return self.coupled.base(rod).rotation.T
        rotation = quaternion_to_matrix(self._still_base(rod).quaternion)
        return ca.sparsify(rotation, 1e-16).T if isinstance(rotation, ca.DM) else rotation.T


def ratio_of(discrete: DiscreteScene, rod: str, arguments: Arguments) -> Ratio:
    """Length of a rod relative to the scene's where it is an input, else None."""
    place = discrete.layout.slices.get(f"{rod}.length") if rod in discrete.layout.rods else None
    return None if place is None else arguments.inputs[place] / discrete.rods[rod].properties.length
