"""A cable that is straight between holes in sections of a rod, as tendons are between disks.

Hole k is at p_k = r_k + R_k D_k, so that span j is the chord c_j = p_{j+1} − p_j and the length L = Σ |c_j|. With the
tension s_j in span j for a unit of tension at the base, the cable does the work −Σ s_j δ|c_j|: it pulls at hole k with
the force f_k = s_k ĉ_k − s_{k−1} ĉ_{k−1} and at the section there with the moment R_k D_k × f_k. These wrenches
balance, and the sweeps take them among the loads. Where the cable rubs, s falls at each hole by the angle φ between two
chords, s_k = s_{k−1} exp(−μ p φ_k), the law of the capstan. With Q the generalised force of a unit of tension,

    ∂Q/∂q = (frozen wrenches) − Σ δθᵀ (f^ (R D)^) δθ + Σ δcᵀ ∂(s ĉ)/∂c δc,

the first part is computed with the loads in tangent.py. See docs/theory.md, section 6.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import hat_operator
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.numbers import Numbers, as_matrix, is_zero
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import Matrix, check_shape
from cosserat_casadi.rod.cable import Cable
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.wrenches import LineWrench

STRAIGHT = 1e-6
"""Sine of an angle at a hole by which the angle is smoothed: its derivative is finite for a straight cable."""


@cache
def _spans(count: int, rubs: bool) -> ca.Function:
    """(chords, one in each row, μ p) ↦ mean tension, and the pull s ĉ of all spans with its derivative.

    Derivatives are by the chords, one component after the other.
    """
    chords = ca.SX.sym("chords", count, 3)
    friction = ca.SX.sym("friction")
    lengths = ca.sqrt(ca.sum2(chords**2))
    directions = chords / ca.repmat(lengths, 1, 3)
    shares = [ca.SX(1.0)]
    for before, after in zip(ca.vertsplit(directions)[:-1], ca.vertsplit(directions)[1:], strict=True):
        sine = ca.sqrt(ca.sumsqr(ca.cross(before.T, after.T)) + STRAIGHT**2)
        angle = ca.atan2(sine, ca.dot(before, after))
        shares.append(shares[-1] * ca.exp(-friction * angle) if rubs else shares[-1])
    tension = ca.vertcat(*shares)
    pull = ca.repmat(tension, 1, 3) * directions
    mean = ca.dot(tension, lengths) / ca.sum1(lengths)
    stiffness = ca.jacobian(ca.vec(pull), ca.vec(chords))
    by_mean = ca.reshape(ca.gradient(mean, ca.vec(chords)), count, 3)
    outputs = ca.cse([ca.sum1(lengths), directions, pull, stiffness, mean, by_mean])
    return ca.Function("spans", [chords, friction], outputs)


@dataclass(frozen=True)
class HoleRouting:
    """Holes of a cable in sections of a rod, from its entry to its anchor.

    Attributes:
        nodes: indices of the k nodes of the sections with holes, shape (k,).
        offset: D_x and D_y in the section, shape (2, k), m, numbers or expressions.
        friction: μ p, coefficient of friction times the direction of slip, 1×1; None without friction.
    """

    nodes: Indices
    offset: Numbers
    friction: Matrix | None = None

    def __post_init__(self) -> None:
        check_shape("offset", self.offset, 2, len(self.nodes))

    def on(self, shape: Shape) -> StraightCable:
        """The cable on a rod of this shape: the quantity is its length."""
        return StraightCable(shape, self)


@dataclass(frozen=True)
class StraightCable(Cable):
    """A cable straight between holes of a deformed rod.

    Attributes:
        routing: its holes.
    """

    routing: HoleRouting

    @property
    def conservative(self) -> bool:
        """Whether the cable is without friction, whose force is not a gradient."""
        return self.routing.friction is None

    @cached_property
    def arms(self) -> Matrix:
        """R D, from the centre of the sections to the holes, 3×k, m."""
        nodes = self.wrench_nodes
        rows = ca.vertsplit(as_matrix(self.routing.offset))
        total: Matrix = ca.DM(3, len(nodes))
        for director, row in zip(self.shape.directors, rows, strict=False):
            if not is_zero(row):
                total = total + director[:, nodes] * ca.repmat(row, 3, 1)
        return total

    @cached_property
    def chords(self) -> Matrix:
        """Spans between the holes, 3×(k − 1), m, base axes."""
        holes = self.shape.position[:, self.wrench_nodes] + self.arms
        return holes[:, 1:] - holes[:, :-1]

    @property
    def value(self) -> Matrix:
        """Length L, 1×1, m."""
        return self._results[0]

    @cached_property
    def gradient(self) -> Matrix:
        """∂L/∂q, n×1, m."""
        return self._work_of(self._results[1].T)

    @cached_property
    def pull(self) -> Matrix:
        """Generalised force of a unit of tension at the base, n×1, m."""
        return self.gradient if self.conservative else self._work_of(self._results[2].T)

    def curvature(self, a: int, b: int) -> None:
        """Return None: strains between two holes act together, not node by node."""
        return

    @cached_property
    def wrench(self) -> LineWrench:
        """Wrenches of a unit of tension at the base on the sections with holes."""
        return self._wrench_of(self._results[2].T)

    @property
    def wrench_nodes(self) -> list[int]:
        """Nodes of the sections with holes."""
        return list(map(int, self.routing.nodes))

    @cached_property
    def section_stiffness(self) -> Matrix:
        """Derivative of minus the wrench by [δr; δθ], 6k×6k: holes turn with sections, and spans with holes."""
        arms = hat_operator(self.arms)
        levers = hat_operator(self._at_holes(self._results[2].T)) @ arms
        to_spans = ca.kron(ca.DM.eye(3), ca.sparsify(ca.DM(np.diff(np.eye(len(self.wrench_nodes)), axis=0))))
        stretched = ca.horzcat(to_spans, -(to_spans @ arms))
        none = ca.DM(*levers.shape)
        return stretched.T @ (self._results[3] @ stretched) - ca.diagcat(none, levers)

    @property
    def mean_share(self) -> Matrix | None:
        """Mean tension along the course over the tension at its base, 1×1; None if the tension is uniform."""
        return None if self.conservative else self._results[4]

    @cached_property
    def mean_share_gradient(self) -> Matrix | None:
        """Derivative of the mean share with q, n×1; None if the tension is uniform."""
        return None if self.conservative else self._work_of(self._results[5].T)

    def rate(self, rate_of: Callable[[Matrix], Matrix]) -> Matrix:
        """Rate of the length on which the tension at the base does work, 1×1."""
        return ca.dot(self._results[2].T, rate_of(self.chords))

    @cached_property
    def _results(self) -> list[Matrix]:
        friction = self.routing.friction
        kernel = _spans(len(self.wrench_nodes) - 1, friction is not None)
        return list(kernel.call([self.chords.T, ca.DM(0.0) if friction is None else friction]))

    def _at_holes(self, pulls: Matrix) -> Matrix:
        """Forces on the holes, 3×k, of pulls in the spans, 3×(k − 1)."""
        none = ca.DM(3, 1)
        return ca.horzcat(pulls, none) - ca.horzcat(none, pulls)

    def _wrench_of(self, pulls: Matrix) -> LineWrench:
        """Wrenches of pulls in the spans, 3×(k − 1), on the sections with holes."""
        forces = self._at_holes(pulls)
        size = self.shape.rod.grid.size
        nodes = self.wrench_nodes
        # A force at a node counts as force per length: it is divided by the length of the node.
        lengths = ca.repmat(as_matrix(self.shape.rod.node_lengths)[nodes].T, 3, 1)
        to_nodes = ca.DM(ca.Sparsity.triplet(len(nodes), size, list(range(len(nodes))), nodes), 1.0)
        force, moment = ((part / lengths) @ to_nodes for part in (forces, cross(self.arms, forces)))
        return LineWrench(force, moment, None, follower=False)

    def _work_of(self, pulls: Matrix) -> Matrix:
        """Σ pull·∂c/∂q of pulls in the spans, 3×(k − 1), n×1."""
        alone = InverseGeometricModel(Statics(self.shape, [self._wrench_of(pulls)]))
        return self.shape.rod.energy_unit * alone.generalised_force
