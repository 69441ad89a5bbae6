"""Inputs over time: tables of values, waves, and tables in separate files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.polynomial import legendre
from pydantic import Field, model_validator

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, Table, not_ascending, numbers_of, refused_keys
from cosserat_casadi.scene.input_fields import column_suffixes
from cosserat_casadi.scene.number_table import read_numbers, shortened
from cosserat_casadi.scene.profiles import coefficient_count
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.values import Component, LegendreComponent, NotEmpty, Number, Positive

SLOPE_SLACK = 1e-9
"""Change of slope, relative to the steepest one, that may be rounding."""

MOST_DEGREES = 80
"""Legendre coefficients beyond which a travelling wave is refused as too short."""

TRAVELLING = ("wavelength", "envelope")
"""Keys of travelling waves alone."""

MARGIN_OF_DECAY = 30
"""Legendre coefficients in which a wave decays to rounding, beyond the degree of its frequency."""

POINTS_BEYOND = 20
"""Points of the quadrature of a travelling wave beyond the number of its coefficients."""

WAVE_ROUNDING = 1e-12
"""Share of the largest Legendre coefficient of a travelling wave below which a coefficient is left out."""

TIME_COLUMN = "t"
"""The column of a file that holds times."""


class InputMotion(Entry):
    """An input over time: a table of values, or a wave about the scene's value.

    Several motions of one input add up: the sum of its tables replaces the scene's value, and waves are added to that.
    A file is read with the scene: the record has its rows as times and values.
    """

    example: ClassVar[str] = """\
[[motions]]
input = "push.force"
times = [0.0, 0.05, 0.6]
values = [[0, 0, 0], [0.8, -0.5, 0.4], [0.8, -0.5, 0.4]]

[[motions]]
input = "finger.base.position"
amplitude = [0.04, 0.03, 0.01]
frequency = 2.0
wave = "one_minus_cosine"
"""

    input: str = Field(description="'load.field' of the input; it need not be among those that the scene leaves free")
    times: Annotated[tuple[Number, ...], NotEmpty()] | None = Field(
        None, description="times of the values, increasing, s; before and after them the value is constant"
    )
    values: Annotated[tuple[Component, ...], NotEmpty()] | None = Field(
        None,
        description="value of the input at each time, in its unit: a number, or a list of its numbers; for "
        "polynomials those of each degree in turn",
    )
    interpolation: Literal["linear", "cubic", "step"] = Field(
        "linear",
        description="between the times: 'linear', a 'cubic' spline that begins and ends at rest, or a 'step' at each "
        "time",
    )
    amplitude: Component | None = Field(
        None, description="amplitude of a wave, in the unit of the input, a number for each of its numbers"
    )
    frequency: Positive | None = Field(None, description="frequency of the wave, Hz")
    phase: Number = Field(0.0, description="phase of the wave at t = 0, rad")
    wave: Literal["sine", "one_minus_cosine", "travelling"] = Field(
        "sine",
        description="value + amplitude sin(2π frequency t + phase); value + amplitude (1 − cos(2π frequency t + "
        "phase)), which begins at rest; or, of an input that varies along the rod, value + amplitude envelope(X) "
        "sin(2π (frequency t − X/wavelength) + phase)",
    )
    wavelength: Number | None = Field(
        None,
        description="length of a travelling wave relative to that of the rod, without unit; one below zero runs to "
        "the base",
    )
    envelope: LegendreComponent = Field(
        1.0,
        description="factor on the amplitude of a travelling wave along the rod, without unit; a list is of Legendre "
        "coefficients in 2X − 1",
    )
    file: str | None = Field(
        None,
        description="CSV file with columns t and value (or value.x, value.y, value.z), relative to the scene's file; "
        "instead of times and values",
    )

    @property
    def is_table(self) -> bool:
        """Whether the motion is a table of values and not a wave."""
        return self.times is not None

    @property
    def knots(self) -> FloatArray:
        """Times of the table, ascending, shape (k,), s; empty for a wave."""
        return np.asarray(self.times or (), dtype=float)

    @property
    def knot_values(self) -> FloatArray:
        """Values of the table in the unit of the input, a row for each time, shape (k, entries)."""
        # A single number may be in a list or not.
        rows = [np.atleast_1d(np.asarray(value, dtype=float)) for value in self.values or ()]
        return np.stack(rows) if rows else np.zeros((0, 0))

    @property
    def amplitudes(self) -> FloatArray:
        """Amplitude of the wave in the unit of the input, shape (entries,); empty for a table."""
        if self.amplitude is None:
            return np.zeros(0)
        return np.atleast_1d(np.asarray(self.amplitude, dtype=float))

    @property
    def entry_count(self) -> int:
        """Number of entries of the input at one time; for a travelling wave, entries of one Legendre degree."""
        if self.is_table:
            _, count = self.knot_values.shape
            return int(count)
        return self.amplitudes.size

    @property
    def travels(self) -> bool:
        """Whether the motion is a wave along the rod."""
        return self.wave == "travelling"

    @property
    def along_the_rod(self) -> FloatArray:
        """Legendre coefficients of envelope(X) cos(2π X/wavelength) and of envelope(X) sin(…), shape (2, degrees)."""
        assert self.wavelength is not None, "the record's rules ask for one"
        points, weights = legendre.leggauss(MOST_DEGREES + POINTS_BEYOND)
        angle = np.pi * (points + 1) / self.wavelength
        wave = legendre.legval(points, np.atleast_1d(self.envelope)) * np.array([np.cos(angle), np.sin(angle)])
        norms = (2 * np.arange(MOST_DEGREES) + 1) / 2
        coefficients = norms * ((wave * weights) @ legendre.legvander(points, MOST_DEGREES - 1))
        largest = np.abs(coefficients).max(axis=0)
        degrees = np.flatnonzero(largest > WAVE_ROUNDING * largest.max())
        return np.asarray(coefficients[:, : int(degrees.max(initial=0)) + 1])

    @property
    def degrees(self) -> int:
        """Number of Legendre coefficients of a travelling wave."""
        _, degrees = self.along_the_rod.shape
        return int(degrees)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the value itself jumps, s."""
        if not self.is_table or self.interpolation != "step":
            return ()
        values = self.knot_values
        changing = np.any(values[1:] != values[:-1], axis=1)
        times = self.knots[1:][changing]
        return tuple(times.tolist())

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times at which the value is continuous and its rate jumps, s."""
        if not self.is_table or self.interpolation != "linear":
            return ()
        # The format bounds no number: slopes that overflow are not compared.
        with np.errstate(over="ignore", invalid="ignore"):
            slopes = np.diff(self.knot_values, axis=0) / np.diff(self.knots)[:, None]
            steepest = np.abs(slopes).max(initial=0.0)
            # Outside of the table the value is constant.
            rest = np.zeros((1, self.entry_count))
            changes = np.diff(np.vstack([rest, slopes, rest]), axis=0)
            changing = np.any(np.abs(changes) > SLOPE_SLACK * steepest, axis=1)
        times = self.knots[changing]
        return tuple(times.tolist())

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The motion is a table, a wave or a file, without keys of the other two."""
        table = [key for key in ("times", "values") if key in given]
        wave = [key for key in ("amplitude", "frequency") if key in given]
        file = [key for key in ("file",) if key in given]
        ways = [keys[0] for keys in (table, wave, file) if keys]
        if not ways:
            yield Fault(("times",), "missing", "give times and values, amplitude and frequency, or file")
        elif len(ways) > 1:
            remedy = "one of table, wave and file in each [[motions]]: several of one input add up"
            yield Fault((ways[1],), f"stands beside {ways[0]}", remedy)
        elif wave:
            yield from _wave_faults(given)
        elif file:
            yield from _file_faults(given)
        else:
            yield from _table_faults(given)

    @model_validator(mode="before")
    @classmethod
    def _file_as_table(cls, given: Any) -> Any:
        """Put the rows of the file into times and values; the rules report a faulty file."""
        if not isinstance(given, Mapping) or not isinstance(given.get("file"), str):
            return given
        times, values, problems = _read(given["file"])
        if problems or "times" in given or "values" in given:
            return given
        others = {key: value for key, value in given.items() if key != "file"}
        return {**others, "times": times, "values": values}


# Rules of one table


def _wave_faults(given: Table) -> Iterator[Fault]:
    for key, remedy in (("amplitude", "in the unit of the input"), ("frequency", "Hz")):
        if key not in given:
            yield Fault((key,), "missing", f"a wave has an amplitude and a frequency: {remedy}")
    if "interpolation" in given:
        yield Fault(("interpolation",), "is for a table of values", "leave it out: a wave is smooth")
    if given.get("wave") == "travelling":
        yield from _travelling_faults(given)
        return
    yield from refused_keys(given, TRAVELLING, "is for a travelling wave", 'wave = "travelling", or leave it out')


def _travelling_faults(given: Table) -> Iterator[Fault]:
    """Faults of a wavelength, which must not be too short for a series of Legendre polynomials."""
    if "wavelength" not in given:
        yield Fault(("wavelength",), "missing", "a travelling wave has one, relative to the length of the rod")
    for wavelength in numbers_of(given.get("wavelength")):
        envelope = coefficient_count(given.get("envelope"))
        # Coefficients of a wave decay beyond the degree π/wavelength, and an envelope adds its degrees.
        least = np.pi / (MOST_DEGREES - MARGIN_OF_DECAY - envelope) if envelope < MOST_DEGREES / 2 else np.inf
        if abs(wavelength) < least:
            problem = f"must be at least {least:.2g} in size, got {wavelength:g}"
            yield Fault(("wavelength",), problem, "it is relative to the length of the rod")


def _table_faults(given: Table) -> Iterator[Fault]:
    yield from _without_wave(given)
    for key, other in (("times", "values"), ("values", "times")):
        if key not in given:
            yield Fault((key,), "missing", f"{other} are given")
    times = given.get("times")
    values = given.get("values")
    yield from islice(not_ascending(numbers_of(times), ("times",), "time"), 1)
    if not isinstance(values, list):
        return
    if isinstance(times, list) and len(times) != len(values):
        yield Fault(("values",), f"must have one entry for each of {len(times)} times, got {len(values)}")
    counts = [len(entry) if isinstance(entry, list) else 1 for entry in values]
    for i, count in enumerate(counts):
        if count != counts[0]:
            yield Fault(("values", i), f"must have as many numbers as the first entry, {counts[0]}, got {count}")
            return


def _file_faults(given: Table) -> Iterator[Fault]:
    yield from _without_wave(given)
    file = given["file"]
    # A value that is not a text has its own fault.
    if not isinstance(file, str):
        return
    _, _, problems = _read(file)
    for problem in problems:
        yield Fault(("file",), f"{problem.where}: {problem.problem}", problem.remedy)


def _without_wave(given: Table) -> Iterator[Fault]:
    remedy = "leave it out, or give amplitude and frequency"
    return refused_keys(given, ("phase", "wave", *TRAVELLING), "is for a wave", remedy)


# Files


def _read(file: str) -> tuple[list[float], list[list[float]], list[Problem]]:
    """Times and values of a CSV file, a row for each time, and problems; both are empty if there are problems."""
    try:
        header, numbers, lines, problems = read_numbers(Path(file))
    except SceneError as error:
        return [], [], list(error.problems)
    columns = _value_columns(header)
    missing = [column for column in (TIME_COLUMN, *columns) if column not in header]
    unknown = [column for column in header if column not in (TIME_COLUMN, *columns)]
    wanted = f"{TIME_COLUMN} and value, or {TIME_COLUMN} and value.x, value.y, value.z"
    problems += [Problem(file, f"has no column {column!r}", f"columns: {wanted}") for column in missing]
    problems += [Problem(file, f"has a column {column!r}", f"columns: {wanted}") for column in unknown]
    if problems:
        return [], [], shortened(problems, file)
    times = numbers[:, header.index(TIME_COLUMN)].tolist()
    for fault in not_ascending(times, (), "time"):
        row = int(fault.path[-1])
        return [], [], [Problem(f"{file}, line {lines[row]}", f"{TIME_COLUMN} {fault.problem}")]
    values = numbers[:, [header.index(column) for column in columns]]
    return times, values.tolist(), []


def _value_columns(header: Sequence[str]) -> list[str]:
    """The columns of values that a file with this header must have, in the order of the input's numbers."""
    given = [column for column in header if column.startswith("value")]
    if given in ([], ["value"]):
        return ["value"]
    components = 4 if "value.w" in given else 3
    # A number after the axis is the degree of a Legendre coefficient.
    matches = [re.fullmatch(r"value\.[xyz]\.([0-9]{1,2})", column) for column in given]
    degrees = [int(match[1]) for match in matches if match is not None]
    highest = max(degrees, default=0)
    return [f"value{suffix}" for suffix in column_suffixes(components, highest + 1)]
