"""States along a robot of concentric tubes from its tip to the base plate, and a step of order eight in its stages.

The step is a symmetric composition of steps of order two whose errors cancel. Let Φ_h be a symmetric step of order
two, Φ_{-h} its inverse. Then Φ_{γ₁h} ∘ … ∘ Φ_{γ₁₅h} is a step of order eight that keeps whatever every Φ keeps: a
group, a symmetry, a symplectic form. M. Suzuki, K. Umeno, in *Computer Simulation Studies in Condensed-Matter Physics
VI*, Springer 1993; R. I. McLachlan, SIAM J. Sci. Comput. 16 (1995) 151; the digits are those of E. Hairer, C. Lubich,
G. Wanner, *Geometric Numerical Integration*, Springer 2006, section V.3.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.typing import Matrix

_FIRST_HALF = (
    0.74167036435061295344822780,
    -0.40910082580003159399730010,
    0.19075471029623837995387626,
    -0.57386247111608226665638773,
    0.29906418130365592384446354,
    0.33462491824529818378495798,
    0.31529309239676659663205666,
)

_MIDDLE = -0.79688793935291635401978884

SHARES = (*_FIRST_HALF, _MIDDLE, *reversed(_FIRST_HALF))
"""Shares γ of a step by its stages, some of them negative; their sum is one."""


@dataclass(frozen=True)
class March:
    """A robot, integrated from its tip to the base plate.

    Attributes:
        ends: stacked states at the ends of the pieces.
        stations: stacked states at all ends of steps from the tip to the plate, as columns.
        starts: stacked states at the starts of the steps, after the loads that act there, as columns.
        sections: stacked sections of the steps, with the loads, as columns.
    """

    ends: list[Matrix]
    stations: Matrix
    starts: Matrix
    sections: Matrix


@dataclass(frozen=True)
class Staged:
    """A step along a robot in its stages.

    Attributes:
        stage: (state, length of the stage before, length, section) ↦ state.
        last: (state, length of the last stage, section) ↦ state: the remainder of the last stage.
        energy: index of the energy in the state.
        carried: entries at the end of the section that change with the robot: force, and force per length.
    """

    stage: ca.Function
    last: ca.Function
    energy: int
    carried: int

    @property
    def width(self) -> int:
        """Number of entries of the state."""
        return int(self.stage.size1_in(0))

    @property
    def width_with_carried(self) -> int:
        """Number of entries of the state and the carried numbers."""
        return self.width + self.carried


def composed(name: str, stage: ca.Function, last: ca.Function) -> ca.Function:
    """Make (state, length, section) ↦ state: a step of order eight, with one function for all stages.

    Args:
        name: name of the function.
        stage: (state, length of the stage before, length, section) ↦ state, as `LoadedSection.stage`; quantities
            proportional to the lengths may accompany these.
        last: (state, length of the last stage, section) ↦ state: the remainder of the last stage.
    """
    whole = ca.MX.sym("length", stage.size1_in(2))
    start = ca.MX.sym("state", stage.size1_in(0))
    here = ca.MX.sym("section", stage.size1_in(3))
    shares = ca.DM(SHARES).T
    shares_before = ca.horzcat(0, shares[:-1])
    stages = stage.mapaccum("stages", len(SHARES))
    passed = stages(start, whole @ shares_before, whole @ shares, ca.repmat(here, 1, len(SHARES)))
    after = last(passed[:, -1], whole * shares[-1], here)
    return ca.Function(name, [start, whole, here], [after])
