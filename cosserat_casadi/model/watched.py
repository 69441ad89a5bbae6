"""Watched poses of sections and bodies, and lengths of cables: the tolerance bounds their errors.

The tip of a rod that a support holds is at its pose, however coarse the model: such a rod is watched at sections
between its ends too, and every rod is if a scene asks for the whole shape. See docs/theory.md, section 10.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.pose_change import rotation_vectors
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.section_poses import SectionPoses, section_weights
from cosserat_casadi.model.system import System

BETWEEN = (0.25, 0.5, 0.75, 1.0)
"""Abscissae of the sections at which a held rod is watched."""

SAMPLES = (1 - np.cos(np.pi * np.arange(257) / 256)) / 2
"""Abscissae of the sections at which a whole shape is compared: several for each wave of the error of 60 modes."""

POSE_SIZE = 7
"""Numbers of a position and a quaternion."""

EVERY = 4
"""Stride through these sections to the watched ones, if the tolerance bounds the whole shape."""


@dataclass(frozen=True)
class Watched:
    """Watched poses and lengths of an equilibrium, in symbols or in numbers.

    Attributes:
        positions: positions of sections, then of bodies, over the lengths of their rods, 3×k.
        quaternions: world_Q_section of these sections and bodies, 4×k, with norm 1.
        cables: lengths of cables over the lengths of their rods, 1×c.
    """

    positions: Matrix
    quaternions: Matrix
    cables: Matrix

    @property
    def column(self) -> Matrix:
        """All entries of the positions, then of the quaternions, one section after the other, then the lengths."""
        return ca.densify(ca.MX(ca.vertcat(ca.vec(self.positions), ca.vec(self.quaternions), self.cables.T)))


@dataclass(frozen=True)
class WatchedNumbers:
    """Watched poses and lengths of an equilibrium, in numbers.

    Attributes:
        positions: of sections and bodies over lengths, shape (k, 3).
        quaternions: world_Q_section, shape (k, 4).
        cables: lengths of cables over the lengths of their rods, shape (c,).
    """

    positions: FloatArray
    quaternions: FloatArray
    cables: FloatArray

    @classmethod
    def of_column(cls, column: FloatArray, cables: int) -> WatchedNumbers:
        """Watched numbers from a :attr:`Watched.column` with this number of cables."""
        posed = (len(column) - cables) // POSE_SIZE
        positions, quaternions, lengths = np.split(column, [3 * posed, POSE_SIZE * posed])
        return cls(positions.reshape(-1, 3), quaternions.reshape(-1, 4), lengths)

    def moved(self, before: WatchedNumbers, after: WatchedNumbers) -> WatchedNumbers:
        """These numbers plus the change from one to another; quaternions keep norm 1 to first order alone."""
        return WatchedNumbers(
            self.positions + (after.positions - before.positions),
            self.quaternions + (after.quaternions - before.quaternions),
            self.cables + (after.cables - before.cables),
        )

    def change_from(self, before: WatchedNumbers) -> FloatArray:
        """Change of each pose and length, shape (2k + c, 3); see :mod:`cosserat_casadi.maths.pose_change`."""
        displacements = self.positions - before.positions
        rotations = rotation_vectors(before.quaternions, self.quaternions)
        lengthening = np.zeros((len(self.cables), 3))
        lengthening[:, 0] = self.cables - before.cables
        return np.concatenate([displacements, rotations, lengthening])


def watched_sections(scene: scenes.Scene, rod: str) -> FloatArray:
    """Abscissae of the sections of a rod with pose errors that the tolerance bounds, shape (k,)."""
    if scene.accuracy.shape:
        return np.asarray(SAMPLES[EVERY::EVERY])
    if rod in scene.rods_held_at_tips:
        return np.array(BETWEEN)
    return np.array([1.0])


def watched_owners(discrete: DiscreteScene) -> list[str]:
    """Names of the rod or the body of each entry of :attr:`Watched.column`; a cable has the rod that it runs along."""
    posed = [name for name in discrete.rods for _ in watched_sections(discrete.scene, name)]
    posed += list(discrete.bodies)
    of_positions = [name for name in posed for _ in range(3)]
    of_quaternions = [name for name in posed for _ in range(4)]
    return [*of_positions, *of_quaternions, *watched_cables(discrete).values()]


def watched_cables(discrete: DiscreteScene) -> dict[str, str]:
    """Cables with length errors that the tolerance bounds, and the rods that they run along."""
    cables = {}
    for actuator in discrete.scene.actuators:
        if EFFECTS[actuator.kind].drawn_as == "cable":
            cables[actuator.name] = actuator.rod
    return cables


def watched(system: System) -> Watched:
    """Watched poses and lengths of a system."""
    discrete = system.discrete
    positions = []
    quaternions = []
    for name in discrete.rods:
        sections = watched_sections(discrete.scene, name)
        rod_positions, rod_quaternions = section_poses(system, name, sections)
        positions.append(rod_positions / system.length(name))
        quaternions.append(rod_quaternions)
    for body in discrete.bodies:
        pose = system.body(body)
        positions.append(pose.position / system.body_length(body))
        quaternions.append(pose.quaternion)
    cables: list[Matrix] = [ca.MX(0, 1)]
    for name, rod in watched_cables(discrete).items():
        _, cable_length, _ = system.actuators.state(name)
        cables.append(cable_length / system.length(rod))
    return Watched(ca.horzcat(*positions), ca.horzcat(*quaternions), ca.vertcat(*cables).T)


def section_poses(system: System, rod: str, X: FloatArray) -> tuple[Matrix, Matrix]:
    """World positions (m) and unit quaternions of sections of a rod, 3×k and 4×k.

    Args:
        system: rods and frames in symbols or numbers.
        rod: name of the rod.
        X: abscissae, shape (k,).
    """
    if len(X) == 1 and X[0] == 1.0:
        base = system.base(rod)
        shape = system.shapes[rod]
        tip_quaternion = ca.densify(shape.quaternion[:, -1])
        return system.position_at(rod, -1), quaternion_product(ca.densify(base.quaternion), tip_quaternion)
    poses = SectionPoses(system, rod, section_weights(system.discrete, rod, X.tolist()))
    return poses.positions, poses.quaternions
