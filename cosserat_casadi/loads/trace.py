"""A load's wrench written in symbols once, to see its structure: what it depends on decides how it is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.loads.load import Load, Section, Site
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.section_kernel import SectionKernel

KERNEL_ARGUMENTS = ["position", "rotation", "parameters", "data"]


@dataclass(frozen=True)
class TracedLoad:
    """A load with its wrench as a kernel.

    Attributes:
        member: the kind of load.
        load: the load as the scene has it.
        kernel: its wrench in world axes; data are the profiles of force and moment, then those of :meth:`Load.data`.
        columns: number of profiles of the force and of the moment.
        pose_free: whether force and moment, in the load's axes, are the same whatever the pose and the data.
    """

    member: Load
    load: Any
    kernel: SectionKernel
    columns: tuple[int, int]
    pose_free: bool

    @property
    def follower(self) -> bool:
        """Whether a wrench that is free of the pose turns with its section."""
        return self.member.axes(self.load) == "section"

    def coefficients(self, values: Mapping[str, Matrix]) -> tuple[Matrix | None, Matrix | None]:
        """Force and moment of a load that is free of the pose, in its axes, 3×k each; None for one that is zero."""
        nowhere = Section(ca.DM.nan(3, 1), ca.DM.nan(3, 3), ca.DM.nan(0, 1))
        force, moment = self.member.wrench(self.load, nowhere, values)
        return force if force.nnz() else None, moment if moment.nnz() else None

    def data(self, site: Site) -> FloatArray:
        """What the kernel takes as data at the sections of a rod, shape (d, k)."""
        profiles = [self.member.profiles(self.load, site.rod, site.X, count) for count in self.columns]
        return np.vstack([*profiles, self.member.data(self.load, site)])


def traced(member: Load, load: Any, values: Mapping[str, Matrix], data_size: int = 0) -> TracedLoad:
    """The kernel of a load.

    Args:
        member: the kind of load.
        load: the load as the scene has it.
        values: its inputs; only which of their entries are stored is read.
        data_size: how many numbers of a section it depends on.
    """
    section = Section(ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3), ca.SX.sym("data", data_size))
    symbols = {name: ca.SX.sym(name, value.sparsity()) for name, value in values.items()}
    energy = member.energy(load, section, symbols)
    force, moment = (ca.sparsify(ca.SX(part)) for part in member.wrench(load, section, symbols))
    pose = _entries(section.position, section.rotation, section.data)
    pose_free = energy is None and not ca.depends_on(_entries(force, moment), pose)
    if energy is None and member.axes(load) == "section":
        force = section.rotation @ force
        moment = section.rotation @ moment
    columns = force.shape[1], moment.shape[1]
    profiles = [ca.SX.sym("force_profiles", columns[0]), ca.SX.sym("moment_profiles", columns[1])]
    arguments = [section.position, section.rotation, stored(symbols), ca.vertcat(*profiles, section.data)]
    results = [force @ profiles[0], moment @ profiles[1]]
    world_wrench = ca.Function("wrench", arguments, results, KERNEL_ARGUMENTS, ["force", "moment"])
    world_energy = None
    if energy is not None:
        # The wrench is the derivative of the energy times its first profile, and so is the energy.
        density = energy * profiles[0][0]
        world_energy = ca.Function("energy", arguments, [density], KERNEL_ARGUMENTS, ["energy"])
    return TracedLoad(member, load, SectionKernel(world_wrench, world_energy), columns, pose_free)


def stored(values: Mapping[str, Matrix]) -> Matrix:
    """The stored entries of all inputs of a load, p×1, in their order."""
    entries: Matrix = ca.vertcat(*[value.nz[:] for value in values.values()])
    return entries


def _entries(*parts: Matrix) -> Matrix:
    return ca.vertcat(*[ca.vec(part) for part in parts])


def has_potential(member: Load, load: Any, values: Mapping[str, FloatArray], data_size: int, *, one_axis: bool) -> bool:
    """Whether a load has a potential at these inputs, so that stability is the sign of an eigenvalue.

    A load that is given by its energy has, and so has a force of fixed direction. A moment of fixed direction has only
    where all that it acts on turns about one axis. A load that turns with its section, or depends on its pose in
    another way, has none, unless it vanishes at these inputs.
    """
    numbers = {name: ca.sparsify(ca.DM(value)) for name, value in values.items()}
    found = traced(member, load, numbers, data_size)
    if found.kernel.world_energy is not None:
        return True
    force_vanishes, moment_vanishes = _vanishing(found, numbers)
    if force_vanishes and moment_vanishes:
        return True
    if found.follower or not found.pose_free:
        return False
    return moment_vanishes or one_axis


def _vanishing(found: TracedLoad, numbers: Mapping[str, ca.DM]) -> tuple[bool, bool]:
    """Whether force and moment are zero at these inputs, whatever the pose."""
    kernel = found.kernel.world_wrench
    symbols = [ca.SX.sym(kernel.name_in(i), kernel.sparsity_in(i)) for i in range(kernel.n_in())]
    symbols[2] = ca.SX(stored(numbers))
    force, moment = (ca.sparsify(part) for part in kernel.call(symbols))
    return force.nnz() == 0, moment.nnz() == 0
