"""The result of a solve: an equilibrium with the poses, strains and wrenches that follow from it.

Fields between the nodes are interpolants through them: docs/theory.md, section 3; the internal wrench: section 6.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Generic, NamedTuple, Self, TypeVar

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.result import Result

SECTIONS_APART = (
    "sections at which contact is summed lie too far apart for this length, radius or width: build the scene with "
    "these numbers, or on more intervals."
)
"""Remedy if inputs or parameters have drawn sections too far apart."""

ModelType = TypeVar("ModelType", bound=SystemFunctions)


@dataclass(frozen=True)
class SolvedPoses:
    """Pose of a section, a tip or a body in the world frame, or poses of k sections with an axis (k,) in front.

    Attributes:
        position: shape (3,) or (k, 3), m.
        rotation: world_R_section, shape (3, 3) or (k, 3, 3).
        quaternion: world_Q_section, w x y z, shape (4,) or (k, 4).
    """

    position: FloatArray
    rotation: FloatArray
    quaternion: FloatArray


@dataclass(frozen=True)
class BaseWrench:
    """Wrench of the clamp on the rod, world frame, about the base point.

    Attributes:
        force: shape (3,), N.
        moment: shape (3,), N m.
    """

    force: FloatArray
    moment: FloatArray


class SectionForce(NamedTuple):
    """A force on one section inside a line of contact.

    Attributes:
        at: abscissa X.
        force: along the normal, N.
    """

    at: float
    force: float


@dataclass(frozen=True)
class Contact:
    """A contact of a rod, or a body, with an obstacle, and its forces.

    Attributes:
        obstacle: name of the obstacle, or of the rod that presses.
        owner: name of the rod, or of the body, that touches.
        start: abscissa X at which contact begins; 0 for a body.
        end: abscissa at which it ends; ``start`` for a point.
        force: resultant on the rod, world axes, shape (3,), N.
        ends: force at the point, or at both ends of a line, along the normals there, N; empty for smooth contact.
        kind: "point" or "line"; "smooth" for an obstacle with a width.
        width: width of the obstacle, m; None for exact contact.
        of_body: whether the owner is a body.
        gap: smallest gap along a smooth contact, m, negative for a rod inside the obstacle; None for exact contact.
        inside: forces at sections inside a line, at which the obstacle balances loads.
        on_rods: abscissae X of the rod and of the other rod, the obstacle, where they are nearest; None for contact
            with an obstacle.
    """

    obstacle: str
    owner: str
    start: float
    end: float
    force: FloatArray
    ends: tuple[float, ...]
    kind: str
    width: float | None = None
    gap: float | None = None
    of_body: bool = False
    inside: tuple[SectionForce, ...] = ()
    on_rods: tuple[float, float] | None = None


@dataclass(frozen=True, repr=False)
class Equilibrium(Result, ABC, Generic[ModelType]):
    """The end of a solve; it is an equilibrium only if ``converged`` is true.

    Attributes:
        model: the model that was solved.
        inputs: stacked inputs of the solve, shape (model.inputs.size,).
        x: unknowns, shape (model.size,).
        outcome: how the solve ended.
        message: a sentence for the user.
        residual_norm: size of the residual at x, computed again at the end.
        iterations: Newton iterations of the search.
        load_factor: share of the loads, or of the path, that was reached; 1 unless the path stalled.
        error_estimate: estimated error of the poses of the tips, relative to a length and in rad; None if not
            estimated.
    """

    model: ModelType
    inputs: FloatArray
    x: FloatArray
    outcome: Outcome
    message: str
    residual_norm: float
    iterations: int
    load_factor: float = 1.0
    error_estimate: float | None = None

    @property
    @abstractmethod
    def stable(self) -> bool | None:
        """Whether the equilibrium is stable; None if stability is not defined."""

    @property
    @abstractmethod
    def remedy(self) -> str:
        """The remedy for an error above the tolerance."""

    @abstractmethod
    def tip(self, name: str | None = None) -> Any:
        """Pose of the tip of a rod, or a tube: its position and quaternion."""

    @property
    def converged(self) -> bool:
        """Whether x is an equilibrium to the solver's tolerance."""
        return self.outcome is Outcome.CONVERGED

    @property
    def judged_error(self) -> float | None:
        """Estimated error that the scene's tolerance bounds; None if not estimated."""
        return self.error_estimate

    @property
    def largest_error(self) -> float | None:
        """Estimated error of all sections, or of the tips if that is all that is known; None if not estimated."""
        return self.error_estimate

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the estimated error is within the scene's tolerance; None if no tolerance applies.

        A default tolerance does not apply to modes and nodes that the scene fixes. A solve that did not converge is not
        within any tolerance.
        """
        accuracy = self.model.scene.accuracy
        if not accuracy.binds:
            return None
        if not self.converged:
            return False
        if self.judged_error is None:
            return None
        # With this comparison an estimate that is NaN counts as too large.
        return self.judged_error <= accuracy.tolerance

    def unresolved(self) -> Self:
        """This solution with the outcome UNRESOLVED: it is an equilibrium of the discrete model alone."""
        return replace(self, outcome=Outcome.UNRESOLVED, message=Outcome.UNRESOLVED.value)


@dataclass(frozen=True, repr=False)
class Solution(Equilibrium[Model]):
    """The end of a solve of rods; it is an equilibrium only if ``converged`` is true.

    The residual norm is the relative norm of the dimensionless residual. The iterations of a scene count all
    discretisations that were tried. The error estimate covers the poses of the tips, as distance over the rod length
    and as angle in rad, and the lengths of cables over the rod length; of held rods sections between the ends too.

    Attributes:
        smallest_eigenvalue: smallest eigenvalue of the second variation, in units of EI/ℓ by the scene's own numbers,
            in exact contact by the values of its parameters; None if loads have no potential.
        stable: whether every admissible variation costs energy; None if stability is not defined.
        shape_error_estimate: the error estimate over all sections, sections between nodes included.
        wrench_error_estimate: estimated relative error of the wrenches of bases, supports and joints, and of unknown
            tensions; None if not estimated.
        contacts: contacts with obstacles, in order along each rod. Forces of exact contacts are inputs of the model.
        paced: whether tension grew large on the load path, so that the shape alone bounded its steps.
    """

    smallest_eigenvalue: float | None = None
    stable: bool | None = None
    shape_error_estimate: float | None = None
    wrench_error_estimate: float | None = None
    contacts: tuple[Contact, ...] = ()
    paced: bool = False

    @cached_property
    def layer_error_estimate(self) -> float | None:
        """Estimated change of the poses of tips and bodies to the equilibrium with zero widths of contact.

        It has the unit of ``error_estimate``, which judges the scene with its widths and does not contain this change.
        No tolerance bounds it. It is None without an equilibrium, without smooth contact, and if friction remembers a
        path. It is computed from the Jacobian on first use.
        """
        # The module imports this one.
        from cosserat_casadi.equilibrium.answer_error import layer_error

        return layer_error(self)

    @property
    def judged_error(self) -> float | None:
        """Estimated error of the tips, or of the shape if the scene asks for it; None if not estimated."""
        return self.shape_error_estimate if self.model.scene.accuracy.shape else self.error_estimate

    @property
    def largest_error(self) -> float | None:
        """Estimated error over all sections; None if not estimated."""
        return self.shape_error_estimate

    def unresolved(self) -> Self:
        """This solution with the outcome UNRESOLVED and no stability, since its stability is not that of the rod."""
        return replace(super().unresolved(), stable=None)

    @property
    def remedy(self) -> str:
        """The remedy for an error above the tolerance."""
        if self.sections_lie_apart:
            return SECTIONS_APART
        if self.model.scene.accuracy.fixed_by_hand:
            return "the scene fixes its modes, nodes or rotation: leave them out, or choose them for a range of inputs."
        if self._is_in_chosen_ranges:
            return "the modes were chosen for these inputs too: choose them for less, or ask for a larger tolerance."
        return "the modes were chosen for other inputs: choose them for the range of these inputs."

    @property
    def sections_lie_apart(self) -> bool:
        """Whether inputs or parameters have drawn sections at which contact is summed too far apart."""
        apart = self.model.sections_apart
        return apart is not None and bool(apart(self.x, self.inputs))

    @property
    def _is_in_chosen_ranges(self) -> bool:
        """Whether modes were chosen for ranges of inputs that contain these inputs; false with ranges of parameters."""
        ranges = self.model.scene.accuracy.chosen_ranges
        indices = column_indices(self.model.inputs)
        if not ranges or not ranges.keys() <= indices.keys():
            return False
        return all(low <= self.inputs[indices[column]] <= high for column, (low, high) in ranges.items())

    def tip(self, name: str | None = None) -> SolvedPoses:
        """Pose of a rod's tip."""
        return self.pose(1.0, name)

    def body(self, name: str | None = None) -> SolvedPoses:
        """Pose of a rigid body; the name may be left out in a scene with one body.

        Raises:
            KeyError: there is no such body, or there are several to choose from.
        """
        names = list(self.model.body)
        chosen = names[0] if name is None and len(names) == 1 else name
        if chosen not in names:
            raise KeyError(f"{name!r} is not a body of this scene; its bodies are {', '.join(names) or 'none'}")
        pose = self.model.body[chosen]
        position, quaternion, rotation = pose(self.x, self.inputs)
        return SolvedPoses(
            position=position.full()[:, 0],
            rotation=rotation.full(),
            quaternion=quaternion.full()[:, 0],
        )

    def pose(self, X: npt.ArrayLike, rod: str | None = None) -> SolvedPoses:
        """Poses at abscissae X in [0, 1]: the interpolant through the nodes.

        Args:
            X: one abscissa, or an array of shape (k,).
            rod: name of the rod; may be left out in a scene with one rod.
        """
        name = self.model.rod_name(rod)
        fields = self._nodal_fields(name)
        interpolation = self._interpolation(X, name)
        return poses_between_nodes(interpolation, fields.position.T, fields.quaternion.T)

    def strain(self, X: npt.ArrayLike, rod: str | None = None) -> FloatArray:
        """Strain ξ = [K; Γ] at abscissae X, shape (6,) at one or (k, 6) at k."""
        name = self.model.rod_name(rod)
        discrete = self.model.discrete
        discrete_rod = discrete.rods[name]
        rod_slice = discrete.unknowns.strain(name)
        # Strains are per reference length: the ratio of lengths scales them for a rod that is drawn out.
        ratio = self.model.length_ratio(name, self.inputs)
        q = ca.DM(self.x[rod_slice])
        strain = ca.DM(discrete_rod.at(q, np.atleast_1d(X), ratio))
        return np.reshape(strain.full().T, (*np.shape(X), 6))

    def internal_wrench(self, X: npt.ArrayLike, rod: str | None = None) -> FloatArray:
        """Internal wrench Λ = [M; N] of rod and actuators in section axes, N m and N, shape (6,) or (k, 6)."""
        name = self.model.rod_name(rod)
        fields = self._nodal_fields(name)
        interpolation = self._interpolation(X, name)
        wrench = interpolation @ fields.wrench.T
        return np.asarray(wrench)

    def base_wrench(self, rod: str | None = None) -> BaseWrench:
        """Force and moment of the clamp on a rod."""
        name = self.model.rod_name(rod)
        fields = self._nodal_fields(name)
        force = fields.base_force[:, 0]
        moment = fields.base_moment[:, 0]
        return BaseWrench(force, moment)

    def actuator(self, name: str) -> dict[str, float]:
        """Tension (N) and length (m) of a tendon, or pressure (Pa) and volume (m³) of a chamber."""
        function = self.model.actuator[name]
        values = function(self.x, self.inputs)
        # The third output, the derivative of the conjugate by the unknowns, is for control.
        return {function.name_out(i): float(values[i]) for i in range(2)}

    def joint(self, name: str) -> dict[str, float]:
        """Moment (N m) or force (N) along a joint on its section, and its angle (rad) or displacement (m).

        A joint with stops also has their push, which is part of the first number, as ``stop``.

        Raises:
            KeyError: no joint of this name has a coordinate.
        """
        function = self.model.joint[name]
        return {
            name: float(value) for name, value in zip(function.name_out(), function(self.x, self.inputs), strict=True)
        }

    def _nodal_fields(self, rod: str) -> _NodalFields:
        """Fields of a rod at its nodes."""
        function = self.model.fields[rod]
        outputs = function(self.x, self.inputs)
        arrays = (output.full() for output in outputs)
        return _NodalFields(*arrays)

    def _interpolation(self, X: npt.ArrayLike, rod: str) -> FloatArray:
        """Interpolation matrix from values at the nodes of a rod to abscissae, shape (nodes,) or (k, nodes)."""
        return self.model.discrete.rods[rod].grid.interpolation_matrix(X)


class _NodalFields(NamedTuple):
    """Outputs of ``model.fields``, one column for each node, in the world frame except the wrench.

    Attributes:
        position: shape (3, nodes), m.
        quaternion: world_Q_section, shape (4, nodes).
        wrench: internal wrench in the sections' frames, shape (6, nodes), N m and N.
        base_force: force of the clamp on the rod, shape (3, 1), N.
        base_moment: moment of the clamp on the rod, shape (3, 1), N m.
    """

    position: FloatArray
    quaternion: FloatArray
    wrench: FloatArray
    base_force: FloatArray
    base_moment: FloatArray


def poses_between_nodes(interpolation: FloatArray, position: FloatArray, quaternion: FloatArray) -> SolvedPoses:
    """Poses of sections from the poses at the nodes of a rod.

    Args:
        interpolation: :meth:`Grid.interpolation_matrix`, shape (nodes,) for one section or (k, nodes).
        position: positions of the nodes, shape (nodes, 3), m.
        quaternion: quaternions of the nodes, shape (nodes, 4).
    """
    between = interpolation @ quaternion
    # Between nodes the norm of an interpolated quaternion is 1 only to the accuracy of the grid.
    between /= np.linalg.norm(between, axis=-1, keepdims=True)
    return SolvedPoses(interpolation @ position, rotations(between), between)


def rotations(q: FloatArray) -> FloatArray:
    """Rotation matrices of unit quaternions.

    Args:
        q: w x y z, shape (4,) or (k, 4).

    Returns:
        shape (3, 3) or (k, 3, 3).
    """
    columns = quaternion_to_matrix(q.T)
    return columns if q.ndim == 1 else np.moveaxis(columns, -1, 0)
