"""Actuators of a scene as expressions of its unknowns and inputs: efforts, conjugates, cables of given length.

The conjugates also tell whether the forces of all actuators are gradients, so that the scene has a potential.

See docs/theory.md, sections 6 and 8.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import SMOOTHING, CableLength, Elasticity
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import CableOfLength, DiscreteScene
from cosserat_casadi.model.homotopy import LoadFactor, scaled_effort, smoothing_at
from cosserat_casadi.model.inputs import input_value, input_values, load_values
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.actuation import Actuation, Conjugate, ShapeQuantity
from cosserat_casadi.rod.cable import Cable
from cosserat_casadi.rod.kinematics import Shape, shape

CORNER = 0.01
"""Smoothing, relative to the rod's length, of the corner between slack and taut in the unloaded scene."""


@dataclass(frozen=True)
class SceneActuators:
    """Actuators of a scene in given arguments.

    Attributes:
        discrete: constant matrices of the scene.
        x: unknowns.
        inputs: stacked inputs.
        load_factor: λ from 0, the unloaded scene, to 1; None for the scene itself.
        shapes: shape of every rod, in its base frame.
    """

    discrete: DiscreteScene
    x: Matrix
    inputs: Matrix
    load_factor: LoadFactor
    shapes: Mapping[str, Shape]

    def state(self, name: str) -> tuple[Matrix, Matrix, Matrix]:
        """Effort of an actuator, its conjugate length or volume, and the derivative of the conjugate by x."""
        actuator, conjugate = self.conjugate(name)
        member = EFFECTS[actuator.kind]
        effort = self._effort(actuator)
        # The smooth complementarity leaves a slack cable with a tension of either sign, as small as its smoothing.
        if member.may_go_slack(actuator):
            effort = ca.fmax(effort, 0.0)
        gradient = self._among_unknowns(actuator.rod, conjugate.gradient)
        return effort, conjugate.value, gradient.T

    def conjugate(self, name: str) -> tuple[scenes.Actuator, Conjugate]:
        """An actuator, and the conjugate of its effort."""
        actuator = next(actuator for actuator in self.discrete.scene.actuators if actuator.name == name)
        return actuator, self._quantity(actuator).on(self.shapes[actuator.rod])

    def margin(self, actuator: scenes.Actuator) -> Matrix | None:
        """Margin of an actuator to the end of its law, 1×1; None if its law has no end."""
        values = input_values(self.discrete.layout, actuator, self.inputs)
        margin: Matrix | None = EFFECTS[actuator.kind].margin(actuator, values)
        return margin

    def pull(self, name: str) -> Matrix:
        """Generalised force on the unknowns by a unit of an actuator's effort, size×1."""
        actuator, conjugate = self.conjugate(name)
        return self._among_unknowns(actuator.rod, conjugate.pull)

    def on_rod(self, rod: str) -> tuple[Actuation, ...]:
        """Actuators on a rod: efforts from inputs, at the load factor, then unknown tensions."""
        given = rod_actuation(self.discrete, rod, self.inputs)
        efforts = [scaled_effort(actuation, self.load_factor) for actuation in given]
        for cable in self.discrete.cables:
            # An unknown tension already holds its length at this load factor: it is not scaled.
            if cable.tendon.rod == rod:
                tension = self._unknown_tension(cable)
                efforts.append(Actuation(self._quantity(cable.tendon), tension))
        return tuple(efforts)

    @cached_property
    def cable_lengths(self) -> dict[str, CableLength]:
        """Equations of the cables of given length by the names of their tendons."""
        return {cable.tendon.name: self._cable_length(cable) for cable in self.discrete.cables}

    def _quantity(self, actuator: scenes.Actuator) -> ShapeQuantity:
        """Conjugate of the effort of an actuator, for the inputs."""
        values = input_values(self.discrete.layout, actuator, self.inputs)
        grid = self.discrete.rods[actuator.rod].grid
        quantity: ShapeQuantity = EFFECTS[actuator.kind].worked_on(actuator, grid, values)
        return quantity

    def _effort(self, actuator: scenes.Actuator) -> Matrix:
        """Effort of an actuator: an input, or an unknown if the scene prescribes its conjugate."""
        member = EFFECTS[actuator.kind]
        if member.prescribes_conjugate(actuator):
            cable = next(cable for cable in self.discrete.cables if cable.tendon.name == actuator.name)
            return self._unknown_tension(cable)
        effort = input_value(self.discrete.layout, actuator, member.effort, self.inputs)
        if effort is None:
            return ca.DM(0.0)
        return effort

    def _cable_length(self, cable: CableOfLength) -> CableLength:
        tendon = cable.tendon
        wanted = input_value(self.discrete.layout, tendon, "length", self.inputs)
        # The scene's rules let no tendon of given length have the length zero.
        assert wanted is not None
        member = EFFECTS[tendon.kind]
        by_length, at_base = member.compliance(tendon)
        _, routed = self.conjugate(tendon.name)
        assert isinstance(routed, Cable), "only cables have a length"
        return CableLength(
            cable=routed,
            elasticity=Elasticity(by_length, at_base, member.resting_effort(tendon)),
            wanted=wanted,
            tension=self.x[self.discrete.tension(cable)],
            slack=member.may_go_slack(tendon),
            softness=cable.softness,
            smoothing=smoothing_at(CORNER, SMOOTHING, self.load_factor),
        )

    def _among_unknowns(self, rod: str, columns: Matrix) -> Matrix:
        """Extend columns over the coordinates of one rod to all unknowns, with zeros elsewhere."""
        entries = self.discrete.unknowns.strain(rod)
        count = columns.shape[1]
        zeros = type(columns)
        before = zeros(entries.start, count)
        after = zeros(self.discrete.size - entries.stop, count)
        return ca.vertcat(before, columns, after)

    def _unknown_tension(self, cable: CableOfLength) -> Matrix:
        """Tension of a cable of given length, N."""
        unit = self.discrete.tension_unit(cable.tendon.rod)
        tension = self.x[self.discrete.tension(cable)]
        return unit * tension


def actuators_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether the forces of all actuators of a scene are gradients at these inputs."""
    values = load_values(discrete.scene, discrete.layout, inputs)
    for actuator in discrete.scene.actuators:
        member = EFFECTS[actuator.kind]
        # Inputs that are zero leave no entry: a pull of zero means no friction.
        numbers = {name: ca.sparsify(ca.DM(value)) for name, value in values[actuator.name].items()}
        if not member.prescribes_conjugate(actuator) and not numbers[member.effort].nnz():
            # An actuator without effort does no work.
            continue
        rod = discrete.rods[actuator.rod]
        quantity = member.worked_on(actuator, rod.grid, numbers)
        unloaded = shape(rod, ca.DM.zeros(rod.size))
        if not quantity.on(unloaded).conservative:
            return False
    return True


def rod_actuation(discrete: DiscreteScene, rod: str, inputs: Matrix) -> list[Actuation]:
    """Efforts on one rod that the scene or its inputs give."""
    actuation = []
    for actuator in discrete.scene.actuators:
        member = EFFECTS[actuator.kind]
        # The effort of an actuator of given length is an unknown, not an input.
        if not member.acts_on(actuator, rod) or member.prescribes_conjugate(actuator):
            continue
        effort = input_value(discrete.layout, actuator, member.effort, inputs)
        if effort is not None:
            values = input_values(discrete.layout, actuator, inputs)
            quantity = member.worked_on(actuator, discrete.rods[rod].grid, values)
            actuation.append(Actuation(quantity, member.energy_sign * effort))
    return actuation
