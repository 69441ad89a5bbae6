"""Outcomes of a solve, whose values are the sentences for the user. See docs/theory.md, sections 9 and 10."""

from __future__ import annotations

from enum import Enum


class LabelledOutcome(Enum):
    """Outcomes of a kind of work; the value of each is the sentence for the user."""

    @property
    def label(self) -> str:
        """Name of the outcome in result files."""
        return self.name.lower()


class Outcome(LabelledOutcome):
    """Outcomes of a solve. Only CONVERGED comes with a reliable result.

    The order gives the numbers in C and in the tables of sweeps: new members come last, but before the outcomes of
    contact and of concentric tubes, for which C has separate libraries.
    """

    CONVERGED = "Equilibrium found: the residual is below its tolerance."
    MAX_ITERATIONS = "No equilibrium found: the iterations ran out before the residual was small enough."
    NOT_FINITE = "No equilibrium found: the equations gave a value that is not a finite number."
    SINGULAR = "No equilibrium found: the Jacobian is singular and no step reduces the residual."
    LOAD_STALLED = (
        "No equilibrium found: the path from the unloaded scene, or from the solution started at, could not be "
        "followed further; there may be a limit point, a buckling load, or an obstacle or a rod in the way."
    )
    UNRESOLVED = (
        "An equilibrium of the discrete model was found, but it is not resolved by its modes and nodes, or its steps: "
        "allow more of them, or a larger tolerance."
    )
    NOT_IN_EQUILIBRIUM = "The unknowns are not an equilibrium at these inputs: solve first."
    LOST_TRACK = (
        "One turn could not follow the solution of the last turn to these inputs within its bounds: move the inputs "
        "less in a turn, or solve anew."
    )
    PATH_VANISHED = (
        "No equilibrium of the rod: it bends so far that the path of a tendon has no length left in it, and further "
        "bending would turn the matter inside out: lessen the loads, or move the path nearer to the axis."
    )
    BEYOND_MATERIAL = (
        "No equilibrium of the rod: a strain, or the pressure in a chamber, is beyond where its law holds, or a "
        "further strain would set energy free: lessen the loads, or give the law for larger ones."
    )
    OUT_OF_PLANE = (
        "No equilibrium of the scene: a joint or a support is out of the plane that its rods bend in, or turned out of "
        "it: keep it in the plane, or admit the other bending and torsion of the rods."
    )
    CONTACT_UNSETTLED = (
        "No equilibrium found: no set of contacts that was tried leaves rods outside the obstacles with forces that "
        "only push."
    )
    OUT_OF_RANGE = (
        "A translation is below zero or above the length of its tube, or no tube stands out of the plate: nothing was "
        "computed."
    )
