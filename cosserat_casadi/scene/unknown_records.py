"""Unknowns of an identification or an estimate: `[[unknowns]]`, `[identification]` and `[estimation]`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, Path, SceneTables, Table, below, faults_of_ends, one_of, shown, table_of
from cosserat_casadi.scene.input_rules import input_part_faults
from cosserat_casadi.scene.measurement_record import overlap, table_that_moves
from cosserat_casadi.scene.records import Entry, Record
from cosserat_casadi.scene.values import Component, Number, Positive, PositiveComponent, TiedNames, Whole, names_in

MOST_STARTS = 10_000
"""Most starts of a search that a scene may ask for."""


class Prior(Record):
    """Prior of an unknown: a normal distribution."""

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
    """An unknown number of the scene: a parameter, or an input."""

    example: ClassVar[str] = """\
[[unknowns]]
parameter = "finger.material.youngs_modulus"
lower = 1e9
upper = 1e11
prior = { mean = 2e9, sigma = 5e8 }

[[unknowns]]
parameter = ["arm.stiffness.bending_x", "arm.stiffness.bending_y"]

[[unknowns]]
input = "push.force"
per_row = true
"""

    parameter: TiedNames | None = Field(
        None,
        description="the number's name as `parameters` spells it; it need not be listed there; or a list of names, "
        "whose numbers keep the ratios that they have in the scene: those of the first are found; or input",
    )
    input: str | None = Field(None, description="'load.field' of the input, or of a part such as 'push.force.z'")
    per_row: bool = Field(
        False,
        description="whether it is found anew for each case; a parameter only by an estimate, between "
        "its bounds; where it is false, an estimate needs a prior",
    )
    lower: Component | None = Field(None, description="least value in its unit; a number, or one for each entry")
    upper: Component | None = Field(None, description="largest value in its unit; a number, or one for each entry")
    prior: Prior | None = Field(None, description="prior knowledge of it, in its unit")

    @property
    def name(self) -> str:
        """Name of the unknown, as the scene spells it."""
        if self.parameter is not None:
            return names_in(self.parameter)[0]
        return str(self.input)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A parameter or an input; bounds in their order."""
        yield from one_of("parameter", "input", given, "name a parameter or an input")
        of_row = given.get("per_row") is True and "parameter" in given and "input" not in given
        if of_row and not ("lower" in given and "upper" in given):
            problem = "asks for a parameter of each row, but its lower or upper is missing"
            yield Fault(("per_row",), problem, "give its least and largest value, between which an estimate begins")
        yield from faults_of_ends(given, equal=False)

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """The input exists, and no column sets it."""
        name = given.get("input")
        if not isinstance(name, str):
            return
        path: Path = ("input",)
        yield from below(path, input_part_faults(name, scene))
        for i, measurement in scene.tables("measurements"):
            for measured in table_of(measurement.get("inputs")):
                if isinstance(measured, str) and overlap(name, measured):
                    problem = f"measurements[{i}] sets {shown(measured)}"
                    yield Fault(path, problem, "an unknown has no column: leave it out there, or here")
                    return
        over_time = any("time" in measurement for _, measurement in scene.tables("measurements"))
        mover = table_that_moves(name, scene)
        if over_time and mover is not None:
            problem = f"motions[{mover}] has its values over time"
            yield Fault(path, problem, "leave it out, or move it by a wave")


class IdentificationSettings(Record):
    """Settings of `cosserat identify`; all other commands ignore them."""

    example: ClassVar[str] = """\
[identification]
loss = "huber"
starts = 8
"""

    loss: Literal["squares", "huber", "cauchy"] = Field(
        "squares",
        description="cost of a residual: its square, or less where it is large, so that outliers weigh less",
    )
    loss_width: Positive = Field(
        2.0, description="residual, in standard deviations, from which on 'huber' and 'cauchy' cost less, without unit"
    )
    noise: Literal["stated", "residual"] = Field(
        "stated",
        description="whether intervals follow from sigma as stated, or from sigma scaled so that the residuals fit it",
    )
    failures: Literal["leave_out", "stop"] = Field(
        "leave_out", description="whether cases without an equilibrium are left out, or stop the identification"
    )
    hold_out: Annotated[Number, Field(ge=0, lt=1)] = Field(
        0.0, description="share of the cases that is not fitted but predicted, without unit"
    )
    starts: Annotated[Whole, Field(ge=1, le=MOST_STARTS)] = Field(
        1, description="places between the bounds, or from the priors, from which the search begins"
    )


class Estimation(Record):
    """Settings of `cosserat estimate`; all other commands ignore them."""

    example: ClassVar[str] = """\
[estimation]
starts = 8
draws = 256
"""

    starts: Annotated[Whole, Field(ge=1, le=1000)] = Field(
        3,
        description="values between the bounds of unknown parameters, such as places along a rod, from which the "
        "search of every row begins; one search where no parameter is unknown",
    )
    draws: Annotated[Whole, Field(ge=0, le=100_000)] = Field(
        0,
        description="draws from the posterior of every row in each of two rounds, from which the deviations follow, "
        "without unit; 0 for those of the model linearised there",
    )
