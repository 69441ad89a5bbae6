"""Common part of the tables of measurements: a file, its columns, and the conditions of each row.

They do not act on the rods: a scene with measurements is solved like a scene without them. A measured quantity is one
record in scene/measurements.py, and one class in identification/measured_quantities.py with its misfit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, below, numbers_of, shown, table_of
from cosserat_casadi.scene.input_rules import input_part_faults
from cosserat_casadi.scene.records import Entry, HashedTable, Record
from cosserat_casadi.scene.values import Component, NotEmpty, Number, PositiveComponent, Share, Whole
from cosserat_casadi.spelling import counted


class InputColumn(Record):
    """Source of the values of an input, or of the times: a column, scaled and shifted, or one number for all rows."""

    example: ClassVar[str] = """\
[[measurements]]
quantity = "position"
file = "shapes.csv"
inputs = { "push.force.z" = { column = "hung_grams", scale = -9.81e-3 } }
rod = "finger"
columns = ["x", "y", "z"]
sigma = 1e-3
"""

    column: str | None = Field(None, description="name of the column; without one it is shift in every row")
    scale: Number = Field(1.0, description="factor on the cells, such as 9.81e-3 for grams that hang, without unit")
    shift: Number = Field(0.0, description="addend of the scaled cells, in the unit of the input, or s")


def _as_input_column(value: Any) -> Any:
    """Convert a text to the table of a column, a number to the table of a constant."""
    if isinstance(value, str):
        return {"column": value}
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"shift": value}
    return value


MeasuredInput = Annotated[InputColumn, BeforeValidator(_as_input_column)]

TEXT = Tag("⟨text⟩")
NUMBER = Tag("⟨number⟩")
BY_TYPE = Discriminator(lambda value: TEXT.tag if isinstance(value, str) else NUMBER.tag)
"""Discriminator: the choice marked `TEXT` for a text, the one marked `NUMBER` for anything else."""

Abscissa = Annotated[Annotated[str, TEXT] | Annotated[Share, NUMBER], BY_TYPE]
"""An abscissa X, or the column that has it."""

MeasuredMode = Annotated[Annotated[str, TEXT] | Annotated[Annotated[Whole, Field(ge=1)], NUMBER], BY_TYPE]
"""The number of a mode, or the column that has it."""

Cell = Annotated[Annotated[str, TEXT] | Annotated[Number, NUMBER], BY_TYPE]
"""A cell of a table: text, or a number."""


class MeasurementRecord(Entry):
    """Columns of a table with one measured quantity.

    Attributes:
        entries: words for the numbers in the columns.
        differences: units of the differences between model and measurement, and so of sigma.
        of_sensor: keys with numbers that place the sensor, which may be unknowns.
    """

    entries: ClassVar[tuple[str, ...]] = ()
    differences: ClassVar[tuple[str, ...]] = ()
    of_sensor: ClassVar[tuple[str, ...]] = ()

    if TYPE_CHECKING:
        quantity: str  # each member declares its own word, where it stands among its keys
    name: str | None = Field(None, description="its name in results; the file and the quantity when left out")
    file: str = Field(description="CSV file with a header, a row for each measured case, relative to the scene's file")
    # The class attribute `inputs` of an entry names fields that may stay free: here none.
    set_inputs: Annotated[dict[str, MeasuredInput], AfterValidator(HashedTable)] = Field(
        default_factory=HashedTable,
        alias="inputs",
        description="by input, such as 'push.force.z': the column that sets it, a number, or a table of column, scale "
        "and shift",
    )
    columns: Annotated[tuple[str, ...], NotEmpty()] = Field(
        description="names of the columns of the quantity in their order; '' for a number that was not measured"
    )
    scale: Component = Field(
        1.0, description="factor on the cells, such as 1e-3 for mm, without unit; a number, or one for each column"
    )
    shift: Component = Field(
        0.0,
        description="addend of the scaled cells, in the unit of the quantity; a number, or one for each column",
    )
    sigma: PositiveComponent = Field(
        description="standard deviation of one entry, in the unit of the quantity; a number, or one for each entry"
    )
    case: str | None = Field(
        None,
        description="column whose equal cells join rows of all files into one case; when left out, each row is a case",
    )
    where: Annotated[dict[str, Cell], AfterValidator(HashedTable)] = Field(
        default_factory=HashedTable,
        description="values that columns must have in the rows that are read; all when left out",
    )
    held_out: Annotated[dict[str, Cell], AfterValidator(HashedTable)] = Field(
        default_factory=HashedTable,
        description="values that columns have in rows whose cases are held out: predicted and not fitted",
    )

    @property
    def title(self) -> str:
        """Name in results of a measurement without a name in the scene."""
        return self.name or f"{PurePath(self.file).stem} {self.quantity}"

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Refuse parameters for numbers with which the table is read."""
        if key in self.of_sensor:
            return super().parameter_refusal(key)
        known = " or ".join(self.of_sensor) or "none of its numbers"
        return "serves to read the table", f"of this measurement {known} may be unknown"

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require as many columns, factors and deviations as the quantity has numbers."""
        count = len(cls.entries)
        columns = given.get("columns")
        if isinstance(columns, list) and columns:
            if len(columns) != count:
                problem = f"must have {counted(count, 'column')}, got {len(columns)}"
                yield Fault(("columns",), problem, f"{', '.join(cls.entries)}; '' for a number that was not measured")
            elif not any(columns):
                yield Fault(("columns",), "names no column", "leave the measurement out")
        for key, wanted in (("scale", count), ("shift", count), ("sigma", len(cls.differences))):
            got = len(numbers_of(given.get(key)))
            if got > 1 and got != wanted:
                yield Fault((key,), f"must be 1 number or {wanted}, got {got}")
        if 0 in numbers_of(given.get("scale")):
            yield Fault(("scale",), "must not be 0", "'' in columns stands for a number that was not measured")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of columns for names that are not inputs of the scene."""
        for name in table_of(given.get("inputs")):
            if isinstance(name, str):
                yield from below(("inputs", name), input_part_faults(name, scene))


MEASUREMENTS: Family[MeasurementRecord] = Family("measurements", key="quantity")
"""Measured quantities."""


class MovingMeasurement(MeasurementRecord):
    """A quantity that can be measured over time, in the motion of the scene."""

    time: MeasuredInput | None = Field(
        None,
        description="times of the rows in the motion of the scene, s: a column, or a table of column, scale and "
        "shift; left out where each case is an equilibrium",
    )

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Measurements over time need a motion, and columns must not set inputs of it."""
        yield from super().scene_conflicts(given, scene)
        if "time" not in given:
            return
        time = given["time"]
        if numbers_of(time) or (isinstance(time, Mapping) and time.get("column") is None):
            yield Fault(("time",), "names no column, and all rows would be at one time", "name the column of the times")
        if scene.get("simulation") is None:
            remedy = "add a table [simulation] with duration = 1.0 (s), or leave time out"
            yield Fault(("time",), "needs a motion, and the scene has none", remedy)
        for name in table_of(given.get("inputs")):
            mover = table_that_moves(name, scene)
            if mover is not None:
                problem = f"motions[{mover}] has the values of {shown(name)} over time"
                yield Fault(("inputs", name), problem, "leave it out here, or move it by a wave")


def table_that_moves(name: Any, scene: SceneTables) -> int | None:
    """Index of the motion whose table stands for an input, or for a part of it; None without such a motion."""
    for i, motion in scene.tables("motions"):
        moved = motion.get("input")
        is_wave = "amplitude" in motion
        if isinstance(name, str) and isinstance(moved, str) and not is_wave and overlap(name, moved):
            return i
    return None


def overlap(one: str, other: str) -> bool:
    """Whether two names are equal, or one names a part of the other.

    ``load.force.x.1`` is no part of ``load.force.x``, which names the constant beside that coefficient.
    """
    shorter, longer = sorted((one, other), key=len)
    if longer == shorter:
        return True
    return longer.startswith(f"{shorter}.") and not longer.removeprefix(f"{shorter}.").isdigit()
