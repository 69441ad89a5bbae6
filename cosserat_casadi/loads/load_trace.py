"""A load's wrench, written in symbols once: the symbols on which it depends decide how it is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.loads.load import Load, Section, Site
from cosserat_casadi.maths.numbers import Numbers, any_symbolic, as_matrix, is_symbolic, known, repeated
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.section_kernel import RATES, SectionKernel
from cosserat_casadi.scene.records import Entry, Record

KERNEL_ARGUMENTS = ["position", "rotation", "parameters", "data"]

REMEMBERED = 64
"""Number of kept kernels: enough for the loads of some scenes, a few kilobytes each."""

Patterns = tuple[tuple[str, tuple[int, ...]], ...]
"""Values by name with their sparsity patterns as CasADi compresses them."""

NO_RATES: Mapping[str, Matrix] = MappingProxyType({})
"""Rates of a kernel at rest: none."""


@dataclass(frozen=True)
class TracedLoad:
    """A load with its wrench as a kernel.

    Attributes:
        member: the kind of load.
        load: record of the load in the scene.
        kernel: its wrench at rest in world axes; data are the profiles of force and moment, then the numbers of
            :meth:`Load.data`.
        moving: its wrench in motion; None for a load that does not depend on rates.
        columns: number of profiles of the force and of the moment.
        pose_free: whether force and moment, in the load's axes, depend neither on the pose nor on the data.
        fixed: whether they do not depend on the pose, though they may depend on the data of the section.
    """

    member: Load[Any]
    load: Any
    kernel: SectionKernel
    moving: SectionKernel | None
    columns: tuple[int, int]
    pose_free: bool
    fixed: bool

    @property
    def follower(self) -> bool:
        """Whether a pose-free wrench turns with its section."""
        return self.member.axes(self.load) == "section"

    @property
    def moving_by_body(self) -> SectionKernel | None:
        """The kernel in motion of a load that acts on bodies or whose reaction a body bears.

        Raises:
            ValueError: it depends on accelerations, which such loads must not.
        """
        if self.moving is not None and not set(self.moving.rates) <= {"velocity", "angular_velocity"}:
            raise ValueError(f"{self.load.name!r} depends on accelerations, and loads on bodies do not know them")
        return self.moving

    def coefficients(self, values: Mapping[str, Matrix]) -> tuple[Matrix | None, Matrix | None]:
        """Force and moment of a pose-free load, in its axes, 3×k each; None for a zero one."""
        # The pose is NaN: a result that depended on it after all would be NaN.
        size = self.kernel.world_wrench.size1_in(3) - sum(self.columns)
        nowhere = Section(position=ca.DM.nan(3, 1), rotation=ca.DM.nan(3, 3), data=ca.DM.nan(size, 1))
        force, moment = self.member.wrench(self.load, nowhere, values)
        # A product with a structural zero would still be NaN: the symbolic pattern decides that it is zero.
        wrench = self.kernel.world_wrench
        return (
            _unless_zero(force) if wrench.nnz_out(0) else None,
            _unless_zero(moment) if wrench.nnz_out(1) else None,
        )

    def data(self, site: Site) -> Numbers:
        """Data of the kernel at the sections of a rod, shape (d, k)."""
        force_columns, moment_columns = self.columns
        rows = [
            self.member.profiles(self.load, site.rod, site.X, force_columns),
            self.member.profiles(self.load, site.rod, site.X, moment_columns),
            self.member.data(self.load, site),
        ]
        if any_symbolic(rows):
            # One profile may stand for all sections.
            columns = [repeated(row.T, site.X.shape[0]) if is_symbolic(row) else row.T for row in rows]
            return ca.vertcat(*[as_matrix(own).T for own in columns])
        return np.vstack([known(row) for row in rows])


def traced(member: Load[Any], load: Any, values: Mapping[str, Matrix], data_size: int = 0) -> TracedLoad:
    """The kernel of a load, made once for each load, stored entries of its values and size of its data.

    Args:
        member: the kind of load.
        load: record of the load in the scene.
        values: its inputs, and the numbers that are expressions of parameters; only their sparsity patterns matter.
        data_size: number of data of a section on which it depends.
    """
    patterns = tuple((name, tuple(value.sparsity().compress())) for name, value in values.items())
    # Expressions belong to a model, which the cache would keep alive; mutable records cannot be compared.
    if expressions_in(load) or not _has_hash(load):
        return _trace(member, load, patterns, data_size)
    return _trace_once(member, load, patterns, data_size)


def _has_hash(load: Any) -> bool:
    try:
        hash(load)
    except TypeError:
        return False
    return True


def _trace(member: Load[Any], load: Any, patterns: Patterns, data_size: int) -> TracedLoad:
    """The kernel of a load whose values have these names and stored entries."""
    section = Section(
        position=ca.SX.sym("position", 3),
        rotation=ca.SX.sym("rotation", 3, 3),
        data=ca.SX.sym("data", data_size),
    )
    # Entries that are always zero have no symbol, so that their products are structurally zero too.
    symbols = {name: ca.SX.sym(name, ca.Sparsity.compressed(pattern)) for name, pattern in patterns}
    written = with_expressions(load, symbols) if expressions_in(load) else load
    energy = member.energy(written, section, symbols)
    given_force, given_moment = member.wrench(written, section, symbols)
    force = ca.sparsify(ca.SX(given_force))
    moment = ca.sparsify(ca.SX(given_moment))
    wrench = _entries(force, moment)
    fixed = energy is None and not ca.depends_on(wrench, _entries(section.position, section.rotation))
    # A wrench that depends on the data of its section differs from node to node, and is evaluated at each too.
    pose_free = fixed and not ca.depends_on(wrench, section.data)
    if energy is None and member.axes(load) == "section":
        force = section.rotation @ force
        moment = section.rotation @ moment
    columns = force.shape[1], moment.shape[1]
    kernel = _kernel(section, stored(symbols), force, moment, energy)
    moving = _moving_kernel(member, written, section, symbols)
    return TracedLoad(member, load, kernel, moving, columns, pose_free, fixed)


_trace_once = lru_cache(maxsize=REMEMBERED)(_trace)


def _moving_kernel(
    member: Load[Any], load: Any, section: Section, symbols: Mapping[str, Matrix]
) -> SectionKernel | None:
    """The kernel of a load in motion; None for one that does not depend on rates."""
    rates = {name: ca.SX.sym(name, 3) for name in RATES}
    moving_section = replace(section, **rates)
    force, moment = (ca.sparsify(ca.SX(part)) for part in member.wrench(load, moving_section, symbols))
    read = [name for name, rate in rates.items() if ca.depends_on(_entries(force, moment), rate)]
    if not read:
        return None
    if member.axes(load) == "section":
        force = section.rotation @ force
        moment = section.rotation @ moment
    return _kernel(section, stored(symbols), force, moment, None, {name: rates[name] for name in read})


def _kernel(
    section: Section,
    parameters: Matrix,
    force: ca.SX,
    moment: ca.SX,
    energy: Matrix | None,
    rates: Mapping[str, Matrix] = NO_RATES,
) -> SectionKernel:
    """The kernel of a wrench, 3×k each, or an energy in the symbols of a section and of the inputs."""
    force_profiles = ca.SX.sym("force_profiles", force.shape[1])
    moment_profiles = ca.SX.sym("moment_profiles", moment.shape[1])
    data = ca.vertcat(force_profiles, moment_profiles, section.data)
    arguments = [section.position, section.rotation, parameters, data, *rates.values()]
    results = [force @ force_profiles, moment @ moment_profiles]
    wrench = ca.Function("wrench", arguments, results, [*KERNEL_ARGUMENTS, *rates], ["force", "moment"])
    if energy is None:
        return SectionKernel(wrench, rates=tuple(rates))
    # The wrench is the derivative of the energy times its one profile, so that the energy is multiplied by it too.
    density = energy * force_profiles[0]
    return SectionKernel(wrench, ca.Function("energy", arguments, [density], KERNEL_ARGUMENTS, ["energy"]))


def stored(values: Mapping[str, Matrix]) -> Matrix:
    """The stored entries of all inputs of a load, p×1, in their order."""
    # CasADi returns the entries of a row as a row: they are stacked too.
    entries = [ca.reshape(value.nz[:], value.nnz(), 1) for value in values.values()]
    stacked: Matrix = ca.vertcat(*entries)
    return stacked


def _entries(*parts: Matrix) -> Matrix:
    columns = [ca.vec(part) for part in parts]
    return ca.vertcat(*columns)


def _unless_zero(vector: Matrix) -> Matrix | None:
    if not vector.nnz():
        return None
    return vector


def has_potential(
    member: Load[Any], load: Any, values: Mapping[str, FloatArray], data_size: int, *, one_axis: bool
) -> bool:
    """Whether a load has a potential at these inputs, so that an eigenvalue decides on stability.

    Loads that are given by an energy have one, and so have forces of fixed direction. A moment of fixed direction has
    one only if all that it acts on turns about one axis. A follower, or a load that depends on its pose without an
    energy, has none, unless it is zero at these inputs.
    """
    # Inputs that are zero leave no entry, so that a wrench that vanishes with them is structurally zero.
    numbers = {name: ca.sparsify(ca.DM(value)) for name, value in values.items()}
    trace = traced(member, load, numbers, data_size)
    if trace.kernel.world_energy is not None:
        return True
    wrench = trace.kernel.world_wrench
    force_vanishes = wrench.nnz_out(0) == 0
    moment_vanishes = wrench.nnz_out(1) == 0
    if force_vanishes and moment_vanishes:
        return True
    # The work of a follower, or of a wrench that depends on the pose, may depend on the path: no potential is claimed.
    if trace.follower or not trace.fixed:
        return False
    return moment_vanishes or one_axis


# Numbers that depend on parameters get a symbol each in the kernel, beside the symbols of the inputs.


def expressions_in(record: Any) -> dict[str, Matrix]:
    """Expressions in a record by their paths, without its inputs."""
    found: dict[str, Matrix] = {}
    # Objects of other programs that stand in for records have none.
    if not isinstance(record, Entry):
        return found
    for key in type(record).model_fields:
        if key not in record.inputs:
            _collect(getattr(record, key), key, found)
    return found


def _collect(value: Any, path: str, found: dict[str, Matrix]) -> None:
    if is_symbolic(value):
        found[path] = value
    elif isinstance(value, tuple):
        for i, entry in enumerate(value):
            _collect(entry, f"{path}[{i}]", found)
    elif isinstance(value, Record):
        for key in type(value).model_fields:
            _collect(getattr(value, key), f"{path}.{key}", found)


def with_expressions(record: Entry, values: Mapping[str, Matrix]) -> Entry:
    """The record with these values at their paths; names of other things are ignored."""
    changes = {}
    for key in type(record).model_fields:
        if key not in record.inputs:
            changes[key] = _replaced(getattr(record, key), key, values)
    return record.model_copy(update=changes)


def _replaced(value: Any, path: str, values: Mapping[str, Matrix]) -> Any:
    if is_symbolic(value):
        return values[path]
    if isinstance(value, tuple):
        return tuple(_replaced(entry, f"{path}[{i}]", values) for i, entry in enumerate(value))
    if isinstance(value, Record):
        keys = type(value).model_fields
        return value.model_copy(update={key: _replaced(getattr(value, key), f"{path}.{key}", values) for key in keys})
    return value
