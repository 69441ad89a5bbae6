"""What was measured: tables of positions, tensions, wrenches and other quantities, for `cosserat identify`.

They do not act on the rods: a scene with measurements is solved like one without. A measured quantity is one record
here, registered with `MEASUREMENTS`, and one expression of the model in identification/quantities.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, Path, SceneTables, Table, frame_faults, shown
from cosserat_casadi.scene.input_rules import input_part_faults
from cosserat_casadi.scene.records import Entry, Record
from cosserat_casadi.scene.spelling import counted
from cosserat_casadi.scene.values import (
    BY_LENGTH,
    SEVERAL,
    SINGLE,
    Component,
    NotEmpty,
    Number,
    Positive,
    Share,
    Vector,
    Whole,
    numbers_of,
)


class InputColumn(Record):
    """Where the values of an input are: in a column, which is scaled and shifted, or one number for all rows."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "position"
file = "shapes.csv"
inputs = { "push.force.z" = { column = "hung_grams", scale = -9.81e-3 } }
rod = "finger"
columns = ["x", "y", "z"]
sigma = 1e-3
"""

    column: str | None = Field(None, description="name of the column; without one the input is shift in every row")
    scale: Number = Field(1.0, description="factor on the cells, such as 9.81e-3 for grams that hang, without unit")
    shift: Number = Field(0.0, description="what is added to the scaled cells, in the unit of the input")


def _as_input_column(value: Any) -> Any:
    """A text as the table of a column, a number as that of a constant."""
    if isinstance(value, str):
        return {"column": value}
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"shift": value}
    return value


MeasuredInput = Annotated[InputColumn, BeforeValidator(_as_input_column)]


PositiveComponent = Annotated[
    Annotated[Positive, SINGLE] | Annotated[tuple[Positive, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]
"""A number > 0, or several."""


def _text_or_number(value: Any) -> str:
    return TEXT.tag if isinstance(value, str) else NUMBER.tag


TEXT = Tag("⟨text⟩")
NUMBER = Tag("⟨number⟩")
BY_TYPE = Discriminator(_text_or_number)
"""Takes the choice marked `TEXT` for a text, the one marked `NUMBER` for anything else."""

Abscissa = Annotated[Annotated[str, TEXT] | Annotated[Share, NUMBER], BY_TYPE]
"""An abscissa X, or the column that has it."""

Cell = Annotated[Annotated[str, TEXT] | Annotated[Number, NUMBER], BY_TYPE]
"""What a cell of a table holds."""


class HashedTable(dict[str, Any]):
    """A table whose keys are the user's: frozen with its record, and so it has a hash."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))


class MeasurementRecord(Entry):
    """Columns of a table that hold one measured quantity.

    Attributes:
        entries: what each of the columns holds.
        differences: units of the numbers by which model and measurement differ: those that sigma is for.
    """

    entries: ClassVar[tuple[str, ...]] = ()
    differences: ClassVar[tuple[str, ...]] = ()

    if TYPE_CHECKING:
        quantity: str  # each member declares its own word, where it stands among its keys
    name: str | None = Field(None, description="what results call it; the file and the quantity when left out")
    file: str = Field(description="CSV file with a header, a row for each measured case, relative to the scene's file")
    # The class attribute `inputs` says which fields of an entry may stay free: none.
    set_inputs: Annotated[dict[str, MeasuredInput], AfterValidator(HashedTable)] = Field(
        default_factory=HashedTable,
        alias="inputs",
        description="by input, such as 'push.force.z': the column that sets it, a number, or a table of column, scale "
        "and shift",
    )
    columns: Annotated[tuple[str, ...], NotEmpty()] = Field(
        description="names of the columns of the quantity in their order; '' for what was not measured"
    )
    scale: Component = Field(
        1.0, description="factor on the cells, such as 1e-3 for mm, without unit; a number, or one for each column"
    )
    shift: Component = Field(
        0.0,
        description="what is added to the scaled cells, in the unit of the quantity; a number, or one for each column",
    )
    sigma: PositiveComponent = Field(
        description="standard deviation of one entry, in the unit of the quantity; a number, or one for each entry"
    )
    case: str | None = Field(
        None, description="column whose equal cells make rows, of all files, one case; else each row is a case"
    )
    where: Annotated[dict[str, Cell], AfterValidator(HashedTable)] = Field(
        default_factory=HashedTable,
        description="values that columns must have in the rows that are read; all when left out",
    )

    @property
    def title(self) -> str:
        """What results call it, where it has no other of that name."""
        return self.name or f"{PurePath(self.file).stem} {self.quantity}"

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """As many columns, factors and deviations as the quantity has numbers."""
        count = len(cls.entries)
        columns = given.get("columns")
        if isinstance(columns, list) and columns:
            if len(columns) != count:
                problem = f"must have {counted(count, 'column')}, got {len(columns)}"
                yield Fault(("columns",), problem, f"{', '.join(cls.entries)}; '' for what was not measured")
            elif not any(columns):
                yield Fault(("columns",), "names no column", "leave the measurement out")
        for key, wanted in (("scale", count), ("shift", count), ("sigma", len(cls.differences))):
            got = len(numbers_of(given.get(key)))
            if got > 1 and got != wanted:
                yield Fault((key,), f"must be 1 number or {wanted}, got {got}")
        if 0 in numbers_of(given.get("scale")):
            yield Fault(("scale",), "must not be 0", "'' in columns is for what was not measured")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """What the columns set are inputs of the scene."""
        inputs = given.get("inputs")
        if not isinstance(inputs, Mapping):
            return
        for name in inputs:
            if isinstance(name, str):
                for fault in input_part_faults(name, scene):
                    yield fault.below(("inputs", name))


MEASUREMENTS: Family[MeasurementRecord] = Family("measurements", key="quantity")
"""Measured quantities."""


class FrameMeasurement(MeasurementRecord):
    """Something that was measured at a section of a rod, or of a body."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods", "body": "bodies"}

    rod: str | None = Field(None, description="name of the rod; or body")
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


class ActuatorMeasurement(MeasurementRecord):
    """Something that was measured at a tendon."""

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
class MeasuredStrain(MeasurementRecord):
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

    quantity: Literal["strain"] = Field(description="strain of a fibre, without unit")
    rod: str = Field(description="name of the rod")
    at: Abscissa = Field(1.0, description="abscissa X of the section, or the column that has it, without unit")
    fibre: tuple[Number, Number] = Field(description="place x, y of the fibre in the section, m")


Measurement = Annotated[
    MeasuredPosition | MeasuredPose | MeasuredTension | MeasuredLength | MeasuredBaseWrench | MeasuredStrain,
    MEASUREMENTS,
]


class Prior(Record):
    """What is known of an unknown beforehand: a normal distribution."""

    example: ClassVar[str] = """\
[[unknowns]]
parameter = "finger.section.radius"
prior = { mean = 2e-3, sigma = 2e-5 }
"""

    mean: Component = Field(description="expected value in the unit of the unknown; a number, or one for each entry")
    sigma: PositiveComponent = Field(
        description="standard deviation in the unit of the unknown; a number, or one for each entry"
    )


class Unknown(Entry):
    """A number of the scene that is to be found: a parameter, or an input."""

    example: ClassVar[str] = """\
[[unknowns]]
parameter = "finger.material.youngs_modulus"
lower = 1e9
upper = 1e11
prior = { mean = 2e9, sigma = 5e8 }

[[unknowns]]
input = "push.force"
per_row = true
"""

    parameter: str | None = Field(
        None, description="the number's name as `parameters` spells it; it need not be listed there; or input"
    )
    input: str | None = Field(None, description="'load.field' of the input, or of a part such as 'push.force.z'")
    per_row: bool = Field(
        False,
        description="whether it is found anew for each case; a parameter by an estimate alone, between its bounds",
    )
    lower: Component | None = Field(None, description="least value in its unit; a number, or one for each entry")
    upper: Component | None = Field(None, description="largest value in its unit; a number, or one for each entry")
    prior: Prior | None = Field(None, description="what is known beforehand, in its unit")

    @property
    def name(self) -> str:
        """As the scene spells it."""
        return str(self.parameter or self.input)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A parameter or an input; bounds in their order."""
        if "parameter" in given and "input" in given:
            yield Fault(("input",), "stands beside parameter", "give one of the two")
        elif "parameter" not in given and "input" not in given:
            yield Fault(("parameter",), "missing", "name a parameter or an input")
        elif given.get("per_row") is True and "parameter" in given and not ("lower" in given and "upper" in given):
            problem = "asks for a parameter of each row, of which lower or upper is missing"
            yield Fault(("per_row",), problem, "say between which values it may be; an estimate begins there")
        lower = numbers_of(given.get("lower"))
        upper = numbers_of(given.get("upper"))
        count = max(len(lower), len(upper))
        if min(len(lower), len(upper)) > 1 and len(lower) != len(upper):
            yield Fault(("upper",), f"must have as many entries as lower, {len(lower)}, got {len(upper)}")
            return
        lowest = lower * count if len(lower) == 1 else lower
        highest = upper * count if len(upper) == 1 else upper
        if any(low >= high for low, high in zip(lowest, highest, strict=False)):
            yield Fault(("upper",), "must be above lower")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """The input exists, and no column sets it."""
        name = given.get("input")
        if not isinstance(name, str):
            return
        path: Path = ("input",)
        for fault in input_part_faults(name, scene):
            yield fault.below(path)
        for i, measurement in scene.tables("measurements"):
            inputs = measurement.get("inputs")
            if not isinstance(inputs, Mapping):
                continue
            for measured in inputs:
                if isinstance(measured, str) and overlap(name, measured):
                    problem = f"measurements[{i}] sets {shown(measured)}"
                    yield Fault(path, problem, "what is unknown has no column: leave it out there, or here")
                    return


def overlap(one: str, other: str) -> bool:
    """Whether one name is the other, or names a part of it.

    ``load.force.x.1`` is no part of ``load.force.x``, which names the constant beside that coefficient.
    """
    shorter, longer = sorted((one, other), key=len)
    if longer == shorter:
        return True
    return longer.startswith(f"{shorter}.") and not longer.removeprefix(f"{shorter}.").isdigit()


class Identification(Record):
    """How `cosserat identify` looks for the unknowns; all other commands leave it aside."""

    example: ClassVar[str] = """\
[identification]
loss = "huber"
starts = 8
"""

    loss: Literal["squares", "huber", "cauchy"] = Field(
        "squares",
        description="what a residual costs: its square, or less where it is large, so that outliers weigh less",
    )
    loss_width: Positive = Field(
        2.0, description="residual, in standard deviations, from which on 'huber' and 'cauchy' cost less, without unit"
    )
    noise: Literal["stated", "residual"] = Field(
        "stated",
        description="whether intervals follow from sigma as stated, or from sigma scaled so that the residuals fit it",
    )
    failures: Literal["leave_out", "stop"] = Field(
        "leave_out", description="what becomes of cases without an equilibrium: they are left out, or all stops"
    )
    hold_out: Annotated[Number, Field(ge=0, lt=1)] = Field(
        0.0, description="share of the cases that is not fitted but predicted, without unit"
    )
    starts: Annotated[Whole, Field(ge=1, le=10_000)] = Field(
        1, description="places between the bounds, or from the priors, from which the search begins"
    )
