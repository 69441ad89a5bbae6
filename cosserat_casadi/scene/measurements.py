"""Measurements: tables of positions, tensions, wrenches, frequencies and others, for `cosserat identify`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, SceneTables, Table, frame_faults, shown
from cosserat_casadi.scene.measurement_record import (
    MEASUREMENTS,
    Abscissa,
    MeasuredMode,
    MeasurementRecord,
    MovingMeasurement,
)
from cosserat_casadi.scene.values import Number, Vector


class FrameMeasurement(MovingMeasurement):
    """A quantity measured at a section of a rod, or at a body."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods", "body": "bodies"}
    of_sensor: ClassVar[tuple[str, ...]] = ("at", "offset")

    rod: str | None = Field(None, description="name of the rod, or of the tube; or body")
    at: Abscissa = Field(1.0, description="abscissa X of the section, or the column that has it, without unit")
    body: str | None = Field(None, description="name of the body; or rod")
    offset: Vector = Field(
        (0.0, 0.0, 0.0),
        description="marker from the centre of the section, in its axes, or in the body, m",
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A rod or a body; only rods have sections."""
        yield from super().conflicts(given)
        yield from frame_faults(given)


@MEASUREMENTS.register
class MeasuredPosition(FrameMeasurement):
    """Position of a marker, world axes."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "position"
file = "shapes.csv"
inputs = { "push.force.z" = "load_N", "cable.tension" = { column = "t1", scale = 9.81e-3 } }
rod = "finger"
at = "X"
columns = ["x", "y", "z"]
scale = 1e-3
sigma = 1e-3
"""

    entries: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    differences: ClassVar[tuple[str, ...]] = ("m", "m", "m")

    quantity: Literal["position"] = Field(description="position of a marker, m")


@MEASUREMENTS.register
class MeasuredPose(FrameMeasurement):
    """Position and orientation of a marker, world axes; they differ by a distance and by a rotation vector."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "pose"
file = "tracker.csv"
rod = "finger"
columns = ["x", "y", "z", "qw", "qx", "qy", "qz"]
sigma = [1e-4, 1e-4, 1e-4, 2e-3, 2e-3, 2e-3]
"""

    entries: ClassVar[tuple[str, ...]] = ("x", "y", "z", "qw", "qx", "qy", "qz")
    differences: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad", "rad", "rad")

    quantity: Literal["pose"] = Field(description="position, m, and quaternion, of any norm")


class ActuatorMeasurement(MovingMeasurement):
    """A quantity measured at a tendon."""

    references: ClassVar[Mapping[str, str]] = {"actuator": "actuators"}

    actuator: str = Field(description="name of the tendon")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """The actuator is a tendon."""
        yield from super().scene_conflicts(given, scene)
        name = given.get("actuator")
        named = scene.named("actuators")
        if isinstance(name, str) and name in named and named[name][1].get("kind") != "tendon":
            yield Fault(("actuator",), f"{shown(name)} is no tendon", "tension and length are those of tendons")


@MEASUREMENTS.register
class MeasuredTension(ActuatorMeasurement):
    """Tension of a tendon at its pulled end."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "tension"
file = "cells.csv"
actuator = "cable"
columns = ["t1"]
sigma = 0.05
"""

    entries: ClassVar[tuple[str, ...]] = ("tension",)
    differences: ClassVar[tuple[str, ...]] = ("N",)

    quantity: Literal["tension"] = Field(description="tension of a tendon, N")


@MEASUREMENTS.register
class MeasuredLength(ActuatorMeasurement):
    """Length of a tendon within the rod."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "length"
file = "drives.csv"
actuator = "cable"
columns = ["pull_mm"]
scale = -1e-3
shift = 0.2
sigma = 1e-4
"""

    entries: ClassVar[tuple[str, ...]] = ("length",)
    differences: ClassVar[tuple[str, ...]] = ("m",)

    quantity: Literal["length"] = Field(description="length of a tendon, m")


@MEASUREMENTS.register
class MeasuredBaseWrench(MeasurementRecord):
    """Force and moment of the clamp on a rod, or on rod and tendons together, about the base point, world axes."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "base_wrench"
file = "cell.csv"
rod = "finger"
columns = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
sigma = [0.05, 0.05, 0.05, 1e-3, 1e-3, 1e-3]
"""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}
    entries: ClassVar[tuple[str, ...]] = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
    differences: ClassVar[tuple[str, ...]] = ("N", "N", "N", "N m", "N m", "N m")

    quantity: Literal["base_wrench"] = Field(description="force and moment of the clamp, N and N m")
    rod: str = Field(description="name of the rod")


@MEASUREMENTS.register
class MeasuredStrain(MovingMeasurement):
    """Stretch of a fibre along the rod, relative to the fibre of the unloaded rod: what a strain gauge reads."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "strain"
file = "gauges.csv"
rod = "finger"
at = 0.1
fibre = [2e-3, 0]
columns = ["gauge_1"]
sigma = 2e-6
"""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}
    entries: ClassVar[tuple[str, ...]] = ("strain",)
    differences: ClassVar[tuple[str, ...]] = ("1",)
    of_sensor: ClassVar[tuple[str, ...]] = ("at", "fibre")

    quantity: Literal["strain"] = Field(description="strain of a fibre, without unit")
    rod: str = Field(description="name of the rod")
    at: Abscissa = Field(1.0, description="abscissa X of the section, or the column that has it, without unit")
    fibre: tuple[Number, Number] = Field(description="place x, y of the fibre in the section, m")


class ModeMeasurement(MeasurementRecord):
    """A quantity measured in a vibration about the equilibrium."""

    mode: MeasuredMode = Field(
        1,
        description="number of the mode among those that swing, from the lowest frequency on, without unit; or the "
        "column that has it",
    )


@MEASUREMENTS.register
class MeasuredFrequency(ModeMeasurement):
    """Natural frequency of a vibration about the equilibrium, as `cosserat modes` has it: |λ| / 2π."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "frequency"
file = "modes.csv"
mode = 2
columns = ["f2_Hz"]
sigma = 0.05
"""

    entries: ClassVar[tuple[str, ...]] = ("frequency",)
    differences: ClassVar[tuple[str, ...]] = ("Hz",)

    quantity: Literal["frequency"] = Field(description="natural frequency of a mode, Hz")


@MEASUREMENTS.register
class MeasuredDampingRatio(ModeMeasurement):
    """Damping ratio of a vibration about the equilibrium, −Re λ / |λ|."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "damping_ratio"
file = "modes.csv"
mode = "number"
columns = ["zeta"]
sigma = 2e-3
"""

    entries: ClassVar[tuple[str, ...]] = ("damping_ratio",)
    differences: ClassVar[tuple[str, ...]] = ("1",)

    quantity: Literal["damping_ratio"] = Field(description="damping ratio of a mode, without unit")


Measurement = Annotated[
    MeasuredPosition
    | MeasuredPose
    | MeasuredTension
    | MeasuredLength
    | MeasuredBaseWrench
    | MeasuredStrain
    | MeasuredFrequency
    | MeasuredDampingRatio,
    MEASUREMENTS,
]
