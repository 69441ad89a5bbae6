"""Measured quantities as expressions of the model: how far the model is from what was measured.

A quantity is one function here, registered under the word that its record in scene/measurements.py has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from cosserat_casadi.maths.rotation import (
    quaternion_conjugate,
    quaternion_product,
    quaternion_to_matrix,
    rotation_vector,
)
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.interpolation import interpolation_weights
from cosserat_casadi.model.system import Arguments, System, ratio_of
from cosserat_casadi.scene.families import without_mechanics
from cosserat_casadi.scene.measurement_record import MEASUREMENTS


@dataclass(frozen=True)
class Site:
    """What an expression of a quantity is written in.

    Attributes:
        system: the equations in their symbols.
        record: the measurement.
        at: abscissae of the sections, 1×k.
        measured: what was measured, a column for each section, entries×k.
    """

    system: System
    record: Any
    at: Matrix
    measured: Matrix

    @property
    def sections(self) -> int:
        """Number k of sections."""
        return int(self.at.shape[1])

    def weights(self, rod: str) -> Matrix:
        """Weights of the values at the nodes of a rod, nodes×k."""
        abscissae = ca.horzsplit(self.at)
        return ca.horzcat(*(interpolation_weights(self.system.discrete, rod, X) for X in abscissae))

    def frames(self) -> list[tuple[Matrix, Matrix]]:
        """Position of the marker, 3×1, and unit quaternion, 4×1, at each section or of the body, world axes."""
        if self.record.rod is None:
            frame = self.system.frame(FrameName("body", str(self.record.body)))
            poses = [(frame.position, frame.quaternion)] * self.sections
        else:
            poses = self._sections(self.record.rod)
        offset = ca.DM(self.record.offset)
        markers: list[tuple[Matrix, Matrix]] = []
        for position, quaternion in poses:
            # A planar rod leaves entries of its quaternion structurally zero.
            unit = ca.densify(ca.MX(quaternion))
            marker = position
            if any(self.record.offset):
                marker = position + quaternion_to_matrix(unit) @ offset
            markers.append((marker, unit))
        return markers

    def _sections(self, rod: str) -> list[tuple[Matrix, Matrix]]:
        """Poses of sections of a rod, world axes."""
        rod_shape = self.system.rods[rod].shape
        base = self.system.base(rod)
        weights = self.weights(rod)
        rotation = quaternion_to_matrix(base.quaternion)
        positions = ca.horzsplit(ca.densify(ca.MX(rotation @ (rod_shape.position @ weights))))
        quaternions = ca.horzsplit(ca.densify(ca.MX(rod_shape.quaternion @ weights)))
        base_quaternion = ca.densify(ca.MX(base.quaternion))
        poses: list[tuple[Matrix, Matrix]] = []
        for position, quaternion in zip(positions, quaternions, strict=True):
            # Between nodes an interpolated quaternion has the norm 1 to the accuracy of the grid only.
            unit = quaternion / ca.sqrt(ca.sumsqr(quaternion))
            poses.append((base.position + position, quaternion_product(base_quaternion, unit)))
        return poses


Difference = Callable[[Site], Matrix]
"""Writes model minus measurement, a column for each section, in the units of the record's `differences`."""

QUANTITIES: dict[str, Difference] = {}
"""Expressions of the measured quantities by their words."""


def measures(word: str) -> Callable[[Difference], Difference]:
    """Register the expression of a quantity."""

    def register(difference: Difference) -> Difference:
        QUANTITIES[word] = difference
        return difference

    return register


@measures("position")
def _position(site: Site) -> Matrix:
    positions = [position for position, _ in site.frames()]
    return ca.horzcat(*positions) - site.measured


@measures("pose")
def _pose(site: Site) -> Matrix:
    differences = []
    for k, (position, quaternion) in enumerate(site.frames()):
        measured = site.measured[:, k]
        wanted = measured[3:] / ca.norm_2(measured[3:])
        turn = quaternion_product(quaternion, quaternion_conjugate(wanted))
        differences.append(ca.vertcat(position - measured[:3], rotation_vector(turn)))
    return ca.horzcat(*differences)


@measures("tension")
def _tension(site: Site) -> Matrix:
    tension = site.system.actuators.state(site.record.actuator)[0]
    return ca.repmat(tension, 1, site.sections) - site.measured


@measures("length")
def _length(site: Site) -> Matrix:
    length = site.system.actuators.state(site.record.actuator)[1]
    return ca.repmat(length, 1, site.sections) - site.measured


@measures("base_wrench")
def _base_wrench(site: Site) -> Matrix:
    rotation = quaternion_to_matrix(site.system.base(site.record.rod).quaternion)
    statics = site.system.rods[site.record.rod].statics
    wrench = ca.vertcat(rotation @ statics.base_force, rotation @ statics.base_moment)
    return ca.repmat(wrench, 1, site.sections) - site.measured


@measures("strain")
def _strain(site: Site) -> Matrix:
    """Stretch of the fibre |Γ + K × r| over that of the unloaded rod, less one."""
    rod = site.record.rod
    system = site.system
    discrete = system.discrete.rods[rod]
    x, y = site.record.fibre
    place = ca.DM([x, y, 0.0])
    ratio = ratio_of(system.discrete, rod, system.arguments)
    q = system.arguments.x[system.discrete.unknowns.strain(rod)]
    # Strains are polynomials that the nodes resolve: the interpolant through them is exact.
    strain = _strains(discrete.strain_rows(q, range(6), ratio), discrete.grid.size)
    at_rest = discrete.strain_rows(ca.MX.zeros(discrete.size), range(6), ratio)
    unloaded = _strains(at_rest, discrete.grid.size)
    weights = site.weights(rod)
    stretch, unloaded_stretch = (_stretch(rows @ weights, place) for rows in (strain, unloaded))
    return stretch / unloaded_stretch - 1 - site.measured


def _strains(rows: Sequence[Matrix | None], count: int) -> Matrix:
    """Strains at the nodes, 6×nodes."""
    full = [ca.MX.zeros(1, count) if row is None else ca.densify(ca.MX(row)) for row in rows]
    return ca.vertcat(*full)


def _stretch(strain: Matrix, place: ca.DM) -> Matrix:
    """Length of a fibre per length of the centreline at each section, 1×k."""
    columns = []
    for column in ca.horzsplit(strain):
        direction = column[3:] + ca.cross(column[:3], ca.MX(place))
        columns.append(ca.norm_2(direction))
    return ca.horzcat(*columns)


def difference(model: Model, record: Any, sections: int) -> ca.Function:
    """Model minus measurement, and its derivatives.

    Args:
        model: with parameters.
        record: the measurement.
        sections: number k of sections that are asked for at once.

    Returns:
        (x, inputs, p, at 1×k, measured entries×k) ↦ difference, section after section, (d k)×1, and its derivatives
        with respect to x, inputs and p.
    """
    discrete = model.discrete
    x = ca.MX.sym("x", discrete.size)
    inputs = ca.MX.sym("inputs", discrete.layout.size)
    p = discrete.parameters.symbol
    at = ca.MX.sym("at", 1, sections)
    measured = ca.MX.sym("measured", len(record.entries), sections)
    site = Site(System(discrete, Arguments(x, inputs)), record, at, measured)
    if record.quantity not in QUANTITIES:
        raise without_mechanics(MEASUREMENTS, record.quantity)
    stacked = ca.vec(ca.densify(ca.MX(QUANTITIES[record.quantity](site))))
    derivatives = [ca.densify(ca.jacobian(stacked, argument)) for argument in (x, inputs, p)]
    return ca.Function("difference", [x, inputs, p, at, measured], [stacked, *derivatives])
