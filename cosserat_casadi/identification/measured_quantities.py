"""Measured quantities as expressions of the model: the difference between model and measurement.

Each quantity is a class, which defines ``difference``, or for a vibration its value as a function of the eigenvalue.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import any_symbolic, as_matrix, as_vector, is_symbolic
from cosserat_casadi.maths.rotation import (
    quaternion_conjugate,
    quaternion_product,
    quaternion_to_matrix,
    rotation_vector,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.section_poses import SectionPoses, interpolation_weights
from cosserat_casadi.model.system import Arguments, System, ratio_of
from cosserat_casadi.motion.eigenproblem import ComplexArray
from cosserat_casadi.scene.families import Kind, Kinds, register
from cosserat_casadi.scene.measurement_record import MEASUREMENTS, MeasurementRecord
from cosserat_casadi.scene.measurements import (
    MeasuredBaseWrench,
    MeasuredDampingRatio,
    MeasuredFrequency,
    MeasuredLength,
    MeasuredPose,
    MeasuredPosition,
    MeasuredStrain,
    MeasuredTension,
)
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions

RecordType = TypeVar("RecordType", bound=MeasurementRecord)


@dataclass(frozen=True)
class MeasurementSite:
    """System, record and measurement in which the expression of a quantity is written.

    Attributes:
        written: the equations in their symbols; None for tubes.
        record: the measurement.
        at: abscissae of the sections, 1×k.
        measured: the measurement, a column for each section, entries×k.
    """

    written: System | None
    record: Any
    at: Matrix
    measured: Matrix

    @property
    def system(self) -> System:
        """The equations of rods in their symbols."""
        assert self.written is not None, "rules of the scene: of tubes positions and poses are measured"
        return self.written

    @property
    def sections(self) -> int:
        """Number k of sections."""
        return int(self.at.shape[1])

    def weights(self, rod: str) -> Matrix:
        """Weights of the values at the nodes of a rod, nodes×k."""
        abscissae = ca.horzsplit(self.at)
        return ca.horzcat(*(interpolation_weights(self.system.discrete, rod, X) for X in abscissae))

    @cached_property
    def poses(self) -> ca.MX:
        """Symbol for position and unit quaternion at each section or of the body, 7×k, in which a quantity is written.

        :meth:`placed` returns its value and its derivative; a quantity is differentiated by the symbol.
        """
        return ca.MX.sym("poses", 7, self.sections)

    def frames(self) -> list[tuple[Matrix, Matrix]]:
        """Position of the marker, 3×1, and unit quaternion, 4×1, at each section or of the body, world axes."""
        offset = as_matrix(as_vector(self.record.offset))
        markers: list[tuple[Matrix, Matrix]] = []
        for pose in ca.horzsplit(self.poses):
            marker = pose[:3]
            quaternion = pose[3:]
            if any_symbolic(self.record.offset) or any(self.record.offset):
                marker = marker + quaternion_to_matrix(quaternion) @ offset
            markers.append((marker, quaternion))
        return markers

    def placed(self) -> tuple[Matrix, Matrix]:
        """Value of :attr:`poses`, 7×k, and its derivative with the unknowns, 7k×size."""
        if self.record.rod is None:
            frame = self.system.frame(FrameName("body", str(self.record.body)))
            pose = ca.densify(ca.vertcat(frame.position, frame.quaternion))
            by_unknowns = ca.jacobian(pose, self.system.arguments.x)
            return ca.repmat(pose, 1, self.sections), ca.repmat(by_unknowns, self.sections, 1)
        sections = SectionPoses(self.system, self.record.rod, self.weights(self.record.rod))
        return sections.stacked, sections.by_unknowns


@dataclass(frozen=True)
class TubeSite(MeasurementSite):
    """Robot, record and measurement in which the expression of a quantity of concentric tubes is written.

    Attributes:
        section: unknowns, inputs and abscissa ↦ position and quaternion.
        arguments: the unknowns, the inputs and the parameters.
    """

    section: ca.Function
    arguments: tuple[ca.MX, ...]

    def placed(self) -> tuple[Matrix, Matrix]:
        """Value of :attr:`poses`, 7×k, and its derivative with the unknowns, 7k×size."""
        poses = ca.vertcat(*self.section.map(self.sections)(*self.arguments, self.at))
        return poses, ca.jacobian(ca.vec(poses), self.arguments[0])


class MeasuredQuantity(Kind, ABC, Generic[RecordType]):
    """One measured quantity.

    Attributes:
        coordinates: number of the first entries that are coordinates of a point of the world, m.
        unmeasured: placeholder of each entry that was not measured, which has no effect; zeros by default.
    """

    record: ClassVar[type[MeasurementRecord]]
    family = MEASUREMENTS
    kinds = Kinds(MEASUREMENTS)
    coordinates: ClassVar[int] = 0
    unmeasured: ClassVar[tuple[float, ...]] = ()

    def faults(self, values: FloatArray) -> list[tuple[int, str, str]]:
        """Problems of measured entries, shape (rows, entries): the row, the problem and the remedy."""
        return []

    def number(self, entry: int, values: FloatArray) -> float:
        """Measured number from which a difference is counted, among the entries of one row."""
        return float(values[entry])

    def blank(self, *shape: int) -> FloatArray:
        """Placeholders of entries that were not measured, shape (*shape, entries)."""
        values = np.zeros((*shape, len(self.record.entries)))
        if self.unmeasured:
            values[...] = self.unmeasured
        return values


QUANTITIES = MeasuredQuantity.kinds
"""Measured quantities by the word of the scene format."""


class StateQuantity(MeasuredQuantity[RecordType]):
    """A measured quantity that depends on the unknowns of an equilibrium, or of an instant."""

    @abstractmethod
    def difference(self, site: MeasurementSite) -> Matrix:
        """Model minus measurement, a column for each section, in the units of the record's `differences`."""


@final
@register
class Position(StateQuantity[MeasuredPosition]):
    """Position of a marker."""

    record = MeasuredPosition
    coordinates = 3

    def difference(self, site: MeasurementSite) -> Matrix:
        """A distance, 3×k, m."""
        positions = [position for position, _ in site.frames()]
        return ca.horzcat(*positions) - site.measured


@final
@register
class MarkerPose(StateQuantity[MeasuredPose]):
    """Position and orientation of a marker."""

    record = MeasuredPose
    coordinates = 3
    # A quaternion has a length, also where none was measured.
    unmeasured = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)

    def difference(self, site: MeasurementSite) -> Matrix:
        """A distance, m, and the rotation vector from the measured orientation, 6×k."""
        differences = []
        for k, (position, quaternion) in enumerate(site.frames()):
            measured = site.measured[:, k]
            wanted = measured[3:] / ca.norm_2(measured[3:])
            turn = quaternion_product(quaternion, quaternion_conjugate(wanted))
            differences.append(ca.vertcat(position - measured[:3], rotation_vector(turn)))
        return ca.horzcat(*differences)

    def faults(self, values: FloatArray) -> list[tuple[int, str, str]]:
        """Check that a quaternion has all of its numbers, or none."""
        quaternions = values[:, 3:]
        given = np.isfinite(quaternions)
        norms = np.linalg.norm(np.where(given, quaternions, 0.0), axis=1)
        faults = []
        for row, (known, norm) in enumerate(zip(given, norms, strict=True)):
            if known.any() and not known.all():
                faults.append((row, "has a quaternion with empty cells", "give all four, or none"))
            elif known.all() and norm == 0.0:
                faults.append((row, "has a quaternion that is zero", ""))
        return faults

    def number(self, entry: int, values: FloatArray) -> float:
        """Measured coordinate; 0 for a rotation, which is counted from the measured orientation."""
        return float(values[entry]) if entry < self.coordinates else 0.0


@final
@register
class Tension(StateQuantity[MeasuredTension]):
    """Tension of a tendon."""

    record = MeasuredTension

    def difference(self, site: MeasurementSite) -> Matrix:
        """A force, 1×k, N."""
        tension = site.system.actuators.state(site.record.actuator)[0]
        return ca.repmat(tension, 1, site.sections) - site.measured


@final
@register
class TendonLength(StateQuantity[MeasuredLength]):
    """Length of a tendon within its rod."""

    record = MeasuredLength

    def difference(self, site: MeasurementSite) -> Matrix:
        """A length, 1×k, m."""
        length = site.system.actuators.state(site.record.actuator)[1]
        return ca.repmat(length, 1, site.sections) - site.measured


@final
@register
class ClampWrench(StateQuantity[MeasuredBaseWrench]):
    """Force and moment of the clamp."""

    record = MeasuredBaseWrench

    def difference(self, site: MeasurementSite) -> Matrix:
        """A force, N, and a moment, N m, world axes, 6×k."""
        rotation = site.system.base(site.record.rod).rotation
        statics = site.system.rods[site.record.rod].statics
        wrench = ca.vertcat(rotation @ statics.held_force, rotation @ statics.held_moment)
        return ca.repmat(wrench, 1, site.sections) - site.measured


@final
@register
class FibreStrain(StateQuantity[MeasuredStrain]):
    """Strain of a fibre: its stretch |Γ + K × r| over the stretch in the unloaded rod, less one."""

    record = MeasuredStrain

    def difference(self, site: MeasurementSite) -> Matrix:
        """A strain, 1×k."""
        rod = site.record.rod
        system = site.system
        discrete = system.discrete.rods[rod]
        x, y = site.record.fibre
        place = ca.MX(as_matrix(as_vector((x, y, 0.0))))
        ratio = ratio_of(system.discrete, rod, system.arguments)
        q = system.arguments.x[system.discrete.unknowns.strain(rod)]
        # Strains are polynomials that the nodes resolve: the interpolant through them is exact.
        strain = _strains(discrete.strain_rows(q, range(6), ratio), discrete.grid.size)
        at_rest = discrete.strain_rows(ca.MX.zeros(discrete.size), range(6), ratio)
        unloaded = _strains(at_rest, discrete.grid.size)
        weights = site.weights(rod)
        stretch, unloaded_stretch = (_stretch(rows @ weights, place) for rows in (strain, unloaded))
        return stretch / unloaded_stretch - 1 - site.measured


class VibrationQuantity(MeasuredQuantity[RecordType]):
    """A measured quantity of a vibration: a function of its eigenvalue λ, 1/s."""

    @abstractmethod
    def value(self, eigenvalue: complex) -> float:
        """Value of the quantity for an eigenvalue."""

    @abstractmethod
    def slope(self, eigenvalue: complex, change: ComplexArray) -> FloatArray:
        """Derivatives of the quantity for given derivatives of the eigenvalue."""


@final
@register
class Frequency(VibrationQuantity[MeasuredFrequency]):
    """Frequency |λ| / 2π."""

    record = MeasuredFrequency

    def value(self, eigenvalue: complex) -> float:
        """The frequency, Hz."""
        return abs(eigenvalue) / (2 * np.pi)

    def slope(self, eigenvalue: complex, change: ComplexArray) -> FloatArray:
        """Derivatives of the frequency for given derivatives of the eigenvalue."""
        return np.asarray(_slope_of_size(eigenvalue, change) / (2 * np.pi))


@final
@register
class DampingRatio(VibrationQuantity[MeasuredDampingRatio]):
    """Damping ratio −Re λ / |λ|."""

    record = MeasuredDampingRatio

    def value(self, eigenvalue: complex) -> float:
        """The damping ratio."""
        return -eigenvalue.real / abs(eigenvalue)

    def slope(self, eigenvalue: complex, change: ComplexArray) -> FloatArray:
        """Derivatives of the damping ratio for given derivatives of the eigenvalue."""
        size = abs(eigenvalue)
        of_size = _slope_of_size(eigenvalue, change)
        return np.asarray(-change.real / size + eigenvalue.real * of_size / size**2)


def _slope_of_size(eigenvalue: complex, change: ComplexArray) -> FloatArray:
    """Derivatives of |λ| for given derivatives of λ."""
    return np.asarray((np.conj(eigenvalue) * change).real / abs(eigenvalue))


def _strains(rows: Sequence[Matrix | None], count: int) -> Matrix:
    """Strains at the nodes, 6×nodes."""
    full = [ca.MX.zeros(1, count) if row is None else ca.densify(ca.MX(row)) for row in rows]
    return ca.vertcat(*full)


def _stretch(strain: Matrix, place: ca.MX) -> Matrix:
    """Length of a fibre per length of the centreline at each section, 1×k."""
    return ca.horzcat(*[ca.norm_2(own[3:] + ca.cross(own[:3], place)) for own in ca.horzsplit(strain)])


def difference(model: AnyModel, record: Any, sections: int) -> ca.Function:
    """Make the function of model minus measurement, and its derivatives.

    Args:
        model: model with parameters.
        record: the measurement in the scene of the model's equations, with unknown numbers as expressions of p.
        sections: number k of sections that are evaluated at once.

    Returns:
        (x, inputs, p, at 1×k, measured entries×k) ↦ difference, section by section, (d k)×1, and its derivatives
        with respect to x, inputs and p.
    """
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    p = model.parameters.symbol
    at = ca.MX.sym("at", 1, sections)
    measured = ca.MX.sym("measured", len(record.entries), sections)
    place = getattr(record, "at", None)
    # A place that is unknown is a number of p, whatever the rows say.
    places = ca.repmat(place, 1, sections) if is_symbolic(place) else at
    site: MeasurementSite
    if isinstance(model, TubeFunctions):
        given = (x, inputs, p) if model.parameters.size else (x, inputs)
        site = TubeSite(None, record, places, measured, model.section[record.rod], given)
    else:
        site = MeasurementSite(System(model.discrete, Arguments(x, inputs)), record, places, measured)
    stacked = ca.vec(ca.densify(ca.MX(QUANTITIES[record.quantity].difference(site))))
    derivatives = [ca.jacobian(stacked, argument) for argument in (x, inputs, p)]
    results = [stacked, *derivatives]
    if ca.depends_on(stacked, site.poses):
        poses, by_unknowns = site.placed()
        by_poses = ca.jacobian(stacked, site.poses)
        of_poses = [by_unknowns, *[ca.jacobian(ca.vec(poses), argument) for argument in (inputs, p)]]
        chained = [own + by_poses @ inner for own, inner in zip(derivatives, of_poses, strict=True)]
        results = ca.substitute([stacked, *chained], [site.poses], [poses])
    return ca.Function("difference", [x, inputs, p, at, measured], [ca.densify(result) for result in results])
