"""An equilibrium of concentric tubes, with its shape, poses and stability."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.pose import NumericPose
from cosserat_casadi.maths.pose_change import change_size, rotation_vectors
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.spelling import closest
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_stability import TubeStability, stability_of


@dataclass(frozen=True)
class TubeShape:
    """A robot at k places from the plate to its tip.

    Attributes:
        distance: distance from the plate along the centre line, shape (k,), m.
        position: position in world axes, shape (k, 3), m.
        quaternion: frame that follows the centre line without turning about it, w x y z, shape (k, 4).
        angles: angles of the tubes against that frame, shape (k, n), rad; beyond its tip a tube keeps the tip's angle.
        torques: torques in the tubes, shape (k, n), N m.
    """

    distance: FloatArray
    position: FloatArray
    quaternion: FloatArray
    angles: FloatArray
    torques: FloatArray

    def between(self, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions, shape (m, 3), and quaternions, shape (m, 4), at distances from the plate, shape (m,).

        Positions are cubics with the tangents at the places of the robot, quaternions between two places are blended.
        """
        # Of places at one distance the last begins the piece behind it.
        before = np.searchsorted(self.distance, distance, side="right") - 1
        before = np.clip(before, 0, len(self.distance) - 2)
        step = np.diff(self.distance)[before][:, None]
        share = (distance - self.distance[before])[:, None] / np.where(step > 0.0, step, 1.0)
        tangent = quaternion_to_matrix(self.quaternion.T)[:, 2].T
        chord = np.diff(self.position, axis=0)[before]
        along_chord = self.position[before] + share**2 * (3.0 - 2.0 * share) * chord
        leaving = share * (1.0 - share) ** 2 * tangent[before]
        arriving = share**2 * (share - 1.0) * tangent[before + 1]
        position = along_chord + step * (leaving + arriving)
        blended = (1.0 - share) * self.quaternion[before] + share * self.quaternion[before + 1]
        return position, blended / np.linalg.norm(blended, axis=1, keepdims=True)


@dataclass(frozen=True, repr=False)
class TubeSolution(Equilibrium[TubeFunctions]):
    """An equilibrium of concentric tubes.

    The inputs are the rotation and translation of each tube, rad and m, then the loads, shape (2 n + 3 m,). The
    unknowns are the angles at the tips against the frame of the centre line, shape (n,), rad; under loads they are
    followed by that frame's quaternion in world axes, shape (n + 4,). The residual norm is the largest angle by which
    tubes miss their drives, rad; distances in the error estimate are relative to the protruding length. The iterations
    are those of the search with this model; 0 at points of a path.
    """

    @property
    def robot(self) -> Robot:
        """The tubes."""
        return self.model.robot

    @cached_property
    def stability(self) -> TubeStability:
        """Stability from the second variation of the energy."""
        return stability_of(self.model, self.x, self.inputs)

    @property
    def angles(self) -> FloatArray:
        """Angles at the tips against the frame of the centre line, shape (n,), rad."""
        return self.x[: self.robot.size]

    @property
    def stable(self) -> bool | None:
        """Whether the energy rises in every direction; None for loads without an energy."""
        return self.stability.stable

    @cached_property
    def energy(self) -> float:
        """Elastic energy of the protruding robot, and of torsion in the housing, less the work of the loads, J.

        The work counts if all loads have an energy.
        """
        return float(self.model.energy(self.x, self.inputs))

    @cached_property
    def shape(self) -> TubeShape:
        """The robot at the ends of all steps."""
        distance, position, quaternion, angles, torques = self.model.stations(self.x, self.inputs)
        return TubeShape(
            distance=np.ravel(distance.full()),
            position=position.full().T,
            quaternion=quaternion.full().T,
            angles=angles.full().T,
            torques=torques.full().T,
        )

    @cached_property
    def tips(self) -> dict[str, NumericPose]:
        """Pose of every tube's tip in the world, by name; z is the tangent, x the side to which the tube would bend."""
        position, quaternion = self.model.tips(self.x, self.inputs)
        return {
            name: NumericPose(position.full()[:, index], quaternion.full()[:, index])
            for index, name in enumerate(self.robot.names)
        }

    @property
    def remedy(self) -> str:
        """Remedy for an error above the tolerance."""
        return f"it has {self.model.steps} steps a piece: allow more of them, or ask for a larger tolerance."

    def tip(self, name: str | None = None) -> NumericPose:
        """Pose of a tube's tip in the world; without a name the tip of the tube that reaches farthest.

        Raises:
            SceneError: there is no such tube.
        """
        if name is None:
            name = self.robot.names[int(np.argmax(self.robot.translations(self.inputs)))]
        if name not in self.tips:
            raise SceneError(Problem(name, "is no tube", closest(name, self.tips)))
        return self.tips[name]

    @cached_property
    def tip_jacobian(self) -> FloatArray:
        """Derivatives of the poses of all tips by the inputs, shape (n, 6, 2 n + 3 m), angular first, rad and m."""
        jacobian = self.model.tip_jacobian(self.x, self.inputs).full()
        return np.asarray(jacobian.reshape(self.robot.size, 6, -1))


def tip_error(found: TubeSolution, finer: TubeSolution) -> float:
    """Largest pose error of the tips against a finer solution, with distances relative to the protruding length."""
    length = float(finer.robot.translations(finer.inputs).max())
    rough = found.tips.values()
    exact = finer.tips.values()
    displacements = np.array([tip.position for tip in rough]) - [tip.position for tip in exact]
    turns = rotation_vectors(
        np.array([tip.quaternion for tip in exact]),
        np.array([tip.quaternion for tip in rough]),
    )
    return change_size(np.concatenate([displacements / length, turns]))
