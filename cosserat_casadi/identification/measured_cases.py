"""Cases from tables: the measurements of each equilibrium, or of each motion.

A case is one equilibrium. Each row of a file is a case; measurements in one file share their cases. Rows with equal
inputs are one case, unless each row has separate unknown inputs. A column ``case`` joins rows, also of several files.
Rows with times belong to motions: rows with equal inputs are one motion.

Text cells of a table are converted to numbers on demand; empty ones become NaN.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, collect_problems, refuse
from cosserat_casadi.identification.measured_quantities import QUANTITIES
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.scene.faults import listing
from cosserat_casadi.scene.number_table import begun_rows, finite_number, length_faults, repeated, shortened

NOT_MEASURED = ("", "nan", "na", "none", "null")
"""Cells, in lower case, that mean that nothing was measured."""

Flags = npt.NDArray[np.bool_]

Data = Mapping[str, Mapping[str, npt.ArrayLike]]
"""Columns of each measurement, by its name or its file."""

SAME_TIME = 1e-9
"""Distance of a time from the motion, over the duration, that is rounding of a column's scale and shift."""


@dataclass(frozen=True)
class Datum:
    """One row of a measurement.

    Attributes:
        where: the row in words.
        at: abscissa of its section, or number of its mode; NaN if the quantity has neither.
        values: measured values, SI units, shape (entries,); NaN if not measured.
        time: time in the motion of its case, s; NaN for an equilibrium.
    """

    where: str
    at: float
    values: FloatArray
    time: float = math.nan


@dataclass
class Case:
    """The measurements of one equilibrium, or of one motion.

    Attributes:
        where: its first row in words.
        inputs: stacked inputs, shape (size of the inputs,); unknown ones have the scene's values.
        moves: whether it is a motion.
        data: rows by the index of their measurement.
        held_out: whether a row marks the case as predicted and not fitted.
    """

    where: str
    inputs: FloatArray
    moves: bool = False
    data: dict[int, list[Datum]] = field(default_factory=dict)
    held_out: bool = False


@dataclass
class _Row:
    """A row of a measurement that is not yet assigned to a case.

    Attributes:
        measurement: index of the measurement.
        where: the row in words.
        place: its table and its line there, which measurements of one file share.
        label: its cell in the column that joins rows to cases; None without one.
        set_inputs: values by index in the stacked inputs.
        datum: the measurement; None if the row contains only the conditions of others.
        moves: whether it is a row of a motion.
        held_out: whether it marks its case as held out.
    """

    measurement: int
    where: str
    place: tuple[str, int]
    label: str | None
    set_inputs: dict[int, float]
    datum: Datum | None
    moves: bool
    held_out: bool


refused_data = partial(SceneError, page="identify")
"""Refusal of the data of measurements."""


def read_cases(scene: scenes.Scene, layout: InputLayout, data: Data | None = None) -> list[Case]:
    """Read the cases of a scene's measurements.

    Args:
        scene: with measurements and unknowns.
        layout: inputs of its model.
        data: columns that replace files, by the name or the file of a measurement.

    Raises:
        SceneError: the tables have faults; the error lists all of them.
    """
    tables, problems = _tables(scene, data)
    per_row = any(unknown.per_row for unknown in scene.unknowns)
    duration = 0.0 if scene.simulation is None else scene.simulation.duration
    rows: list[_Row] = []
    for number, measurement in enumerate(scene.measurements):
        if number in tables:
            reader = _Reader(number, measurement, tables[number], layout, duration)
            rows += reader.rows()
            problems += shortened(reader.problems, tables[number].source)
    refuse(problems, refused_data)
    return _joined(rows, layout, per_row)


def _tables(scene: scenes.Scene, data: Data | None) -> tuple[dict[int, DataFile], list[Problem]]:
    """Read the table of each measurement, by its index, and collect problems of unknown names and files."""
    given = dict(data or {})
    names = [name for measurement in scene.measurements for name in (measurement.title, measurement.file)]
    problems = [Problem(name, "is no measurement of this scene") for name in given if name not in names]
    tables: dict[int, DataFile] = {}
    files: dict[str, DataFile | None] = {}
    for number, measurement in enumerate(scene.measurements):
        name = measurement.title if measurement.title in given else measurement.file
        if name not in files:
            files[name] = None
            with collect_problems(problems):
                files[name] = table_of(name, given[name]) if name in given else read_table(Path(name))
        table = files[name]
        if table is not None:
            tables[number] = table
    return tables, problems


@dataclass
class _Reader:
    """Reader of the rows of one measurement.

    Attributes:
        number: index of the measurement.
        measurement: record of the measurement.
        table: table with its rows.
        layout: inputs of the model.
        duration: simulated time, s.
        problems: problems of its rows.
    """

    number: int
    measurement: scenes.MeasurementRecord
    table: DataFile
    layout: InputLayout
    duration: float
    problems: list[Problem] = field(default_factory=list)

    def rows(self) -> list[_Row]:
        """Read the rows of the measurement; a row without a number still contains conditions of its case."""
        measurement, table = self.measurement, self.table
        columns = [column for column in measurement.columns if column]
        columns += [entry.column for entry in measurement.set_inputs.values() if entry.column is not None]
        columns += [*measurement.where, *measurement.held_out]
        place = self._place
        if isinstance(place, str):
            columns.append(place)
        time = self._time
        if time is not None and time.column is not None:
            columns.append(time.column)
        if measurement.case is not None:
            columns.append(measurement.case)
        self.problems += table.missing(columns)
        if self.problems:
            return []
        chosen = [row for row in range(len(table)) if table.holds_all(measurement.where, row)]
        values = self._values(chosen)
        measured = np.any(np.isfinite(values), axis=1)
        if not np.any(measured):
            remedy = "look at its columns, and at where"
            self.problems.append(Problem(table.source, f"{measurement.title}: nothing was measured in any row", remedy))
        self._check_labels(chosen)
        inputs = self._inputs(chosen, measured)
        abscissae = self._abscissae(chosen, measured)
        times = self._times(chosen, measured)
        rows = []
        for i, row in enumerate(chosen):
            where = table.where(row)
            set_inputs = {index: float(column[i]) for index, column in inputs.items() if np.isfinite(column[i])}
            datum = Datum(where, float(abscissae[i]), values[i], float(times[i])) if measured[i] else None
            case = measurement.case
            label = None if case is None else table.columns[case][row].strip()
            line = (table.source, table.lines[row])
            held_out = bool(measurement.held_out) and table.holds_all(measurement.held_out, row)
            rows.append(_Row(self.number, where, line, label, set_inputs, datum, time is not None, held_out))
        return rows

    @property
    def _place(self) -> str | float | None:
        """Abscissa of the section or number of the mode, or the column that contains it; None without either."""
        return getattr(self.measurement, "at", getattr(self.measurement, "mode", None))

    @property
    def _time(self) -> scenes.InputColumn | None:
        """Column with the times of the rows; None if each case is an equilibrium."""
        return getattr(self.measurement, "time", None)

    def _check_labels(self, rows: Sequence[int]) -> None:
        """Check that every row names its case, since rows with empty cells have nothing in common."""
        column = self.measurement.case
        if column is None:
            return
        for row in rows:
            if not self.table.columns[column][row].strip():
                problem = f"{column} is empty, but says which case the row belongs to"
                self.problems.append(Problem(self.table.where(row), problem, "name the case"))

    def _values(self, rows: Sequence[int]) -> FloatArray:
        """Cells of the quantity in SI units, shape (rows, entries); NaN if not measured."""
        measurement = self.measurement
        count = len(measurement.columns)
        scale = np.broadcast_to(np.asarray(measurement.scale), count)
        shift = np.broadcast_to(np.asarray(measurement.shift), count)
        values = np.full((len(rows), count), np.nan)
        for k, column in enumerate(measurement.columns):
            if column:
                numbers, problems = self.table.numbers(column, rows)
                self.problems += problems
                values[:, k] = scale[k] * numbers + shift[k]
        for i, problem, remedy in QUANTITIES[measurement.quantity].faults(values):
            self.problems.append(Problem(self.table.where(rows[i]), problem, remedy))
        return values

    def _abscissae(self, rows: Sequence[int], measured: Flags) -> FloatArray:
        """Abscissa of the section or number of the mode of each row; NaN if the quantity has neither."""
        place = self._place
        if not isinstance(place, str):
            return np.full(len(rows), np.nan if place is None else place)
        values, problems = self.table.numbers(place, rows)
        self.problems += problems
        told = {problem.where for problem in problems}
        of_modes = hasattr(self.measurement, "mode")
        for row, value, is_measured in zip(rows, values, measured, strict=True):
            if self.table.where(row) in told:
                continue
            fits = 0.0 <= value <= 1.0
            what = "an abscissa from 0 to 1"
            remedy = "divide the distance along the rod by its length"
            if of_modes:
                fits = value >= 1.0 and value == round(value)
                what = "the number of a mode: 1, 2, …"
                remedy = "count those that swing, by frequency"
            if is_measured and not fits:
                got = "an empty cell" if np.isnan(value) else f"{value:g}"
                self.problems.append(Problem(self.table.where(row), f"{place} must be {what}, got {got}", remedy))
        return values

    def _times(self, rows: Sequence[int], measured: Flags) -> FloatArray:
        """Time of each row in its motion, s; NaN if its case is an equilibrium."""
        time = self._time
        if time is None:
            return np.full(len(rows), np.nan)
        values = np.full(len(rows), time.shift)
        problems: list[Problem] = []
        if time.column is not None:
            numbers, problems = self.table.numbers(time.column, rows)
            self.problems += problems
            values = values + time.scale * numbers
        told = {problem.where for problem in problems}
        # Scale and shift round: 700 ms are 0.7000000000000001 s.
        within = np.clip(values, 0.0, self.duration)
        values = np.where(np.abs(values - within) <= SAME_TIME * self.duration, within, values)
        for row, value, is_measured in zip(rows, values, measured, strict=True):
            if self.table.where(row) in told:
                continue
            if is_measured and not 0.0 <= value <= self.duration:
                got = "an empty cell" if np.isnan(value) else f"{value:g} s"
                problem = f"the time must be from 0 to the duration of the simulation, {self.duration:g} s, got {got}"
                self.problems.append(Problem(self.table.where(row), problem, "shift it, or simulate for longer"))
        return values

    def _inputs(self, rows: Sequence[int], measured: Flags) -> dict[int, FloatArray]:
        """Inputs set by columns, each of shape (rows,), by index in the stacked inputs; NaN for empty cells."""
        indices = column_indices(self.layout)
        values = {}
        for name, entry in self.measurement.set_inputs.items():
            where = f"{self.measurement.title}: inputs"
            if name not in indices:
                parts = [column for column in indices if column.startswith(f"{name}.")]
                problem = "has several numbers" if parts else "is no input"
                self.problems.append(Problem(where, f"{name} {problem}", f"one of {', '.join(parts or indices)}"))
                continue
            column = np.full(len(rows), entry.shift)
            if entry.column is not None:
                numbers, problems = self.table.numbers(entry.column, rows)
                self.problems += problems
                told = {problem.where for problem in problems}
                column = column + entry.scale * numbers
                for row, number, is_measured in zip(rows, numbers, measured, strict=True):
                    if is_measured and np.isnan(number) and self.table.where(row) not in told:
                        problem = f"{entry.column} is empty, but sets {name}"
                        self.problems.append(Problem(self.table.where(row), problem, "give it, or leave the row out"))
            values[indices[name]] = column
        return values


def _joined(rows: Sequence[_Row], layout: InputLayout, per_row: bool) -> list[Case]:
    """Join the rows of each equilibrium or motion to one case.

    Args:
        rows: rows of all measurements.
        layout: inputs of the model.
        per_row: whether each row has separate unknown inputs.

    Raises:
        SceneError: rows of one case set an input to different values.
    """
    names = {index: name for name, index in column_indices(layout).items()}
    problems: list[Problem] = []
    # The inputs of a line hold for all measurements of its file.
    by_place = _settled(rows, [row.place for row in rows], names, problems)
    measured = [row for row in rows if row.datum is not None]
    keys = [_key(row, by_place[row.place], layout, per_row) for row in measured]
    by_case = _settled(measured, keys, names, problems)
    refuse(shortened(problems, "measurements"), refused_data)
    cases: dict[Hashable, Case] = {}
    for row, key in zip(measured, keys, strict=True):
        case = cases.setdefault(key, Case(row.where, layout.pack(), row.moves))
        case.held_out = case.held_out or row.held_out
        for index, (value, _) in {**by_case[key], **by_place[row.place]}.items():
            case.inputs[index] = value
        if row.datum is not None:
            case.data.setdefault(row.measurement, []).append(row.datum)
    return list(cases.values())


def _key(row: _Row, settled: Mapping[int, tuple[float, str]], layout: InputLayout, per_row: bool) -> Hashable:
    """Key of all rows of one case."""
    if row.label is not None:
        return "case", row.label, row.moves
    if per_row and not row.moves:
        return "row", row.place
    stacked = layout.pack()
    for index, (value, _) in settled.items():
        stacked[index] = value
    return "inputs", row.moves, *stacked.tolist()


def _settled(
    rows: Sequence[_Row], keys: Sequence[Hashable], names: Mapping[int, str], problems: list[Problem]
) -> dict[Hashable, dict[int, tuple[float, str]]]:
    """Value of each input set by rows of one key, and the row that set it, by key and index.

    Args:
        rows: some rows.
        keys: keys of these rows.
        names: names of the stacked inputs, by index.
        problems: list to which contradictions between rows are added.
    """
    known: dict[Hashable, dict[int, tuple[float, str]]] = {}
    for row, key in zip(rows, keys, strict=True):
        settled = known.setdefault(key, {})
        for index, value in row.set_inputs.items():
            first, where = settled.setdefault(index, (value, row.where))
            if first != value:
                problem = f"sets {names[index]} to {value:g}, but {where} sets it to {first:g} in the same case"
                problems.append(Problem(row.where, problem))
    return known


@dataclass(frozen=True)
class DataFile:
    """A table: rows of named cells.

    Attributes:
        source: the file, or another origin of the rows.
        columns: the cells of each column, as text.
        lines: line of each row in the file.
    """

    source: str
    columns: Mapping[str, Sequence[str]]
    lines: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.lines)

    def where(self, row: int) -> str:
        """Name of a row in messages."""
        return f"{self.source}, line {self.lines[row]}"

    def missing(self, names: Sequence[str]) -> list[Problem]:
        """Problems of missing columns."""
        remedy = listing(self.columns, "columns")
        absent = [name for name in dict.fromkeys(names) if name not in self.columns]
        return [Problem(self.source, f"has no column {name!r}", remedy) for name in absent]

    def numbers(self, name: str, rows: Sequence[int]) -> tuple[FloatArray, list[Problem]]:
        """Numbers of a column in some rows, NaN if nothing was measured, and the problems of other cells."""
        values = np.full(len(rows), np.nan)
        problems = []
        for i, row in enumerate(rows):
            cell = self.columns[name][row].strip()
            if cell.lower() in NOT_MEASURED:
                continue
            number = finite_number(cell)
            if number is None:
                problem = f"{name} must be a finite number, or empty where it was not measured, got {cell!r}"
                problems.append(Problem(self.where(row), problem))
            else:
                values[i] = number
        return values, problems

    def holds_all(self, values: Mapping[str, str | float], row: int) -> bool:
        """Whether the cells of a row are these texts and numbers, by column."""
        for column, value in values.items():
            cell = self.columns[column][row].strip()
            if value != (cell if isinstance(value, str) else finite_number(cell)):
                return False
        return True


def read_table(path: Path) -> DataFile:
    """Read the rows of a CSV file with a header.

    Raises:
        SceneError: the file cannot be read, has no row, has a column twice, or rows of unequal length.
    """
    header, later = begun_rows(path)
    rows = list(later)
    problems = [Problem(str(path), f"has the column {column!r} twice") for column in repeated(header)]
    for line, row in rows:
        problems += length_faults(f"{path}, line {line}", header, row)
    refuse(problems, refused_data)
    columns = {name: [row[k] for _, row in rows] for k, name in enumerate(header)}
    return DataFile(str(path), columns, tuple(line for line, _ in rows))


def table_of(name: str, columns: Mapping[str, npt.ArrayLike]) -> DataFile:
    """Make a table of columns from Python.

    Args:
        name: name of the table in messages.
        columns: columns of one length, each of shape (rows,); NaN means not measured.

    Raises:
        SceneError: the columns differ in length.
    """
    arrays = {key: np.atleast_1d(np.asarray(values)) for key, values in columns.items()}
    counts = {array.shape for array in arrays.values()}
    if len(counts) != 1 or len(next(iter(counts))) != 1:
        shapes = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
        raise SceneError(Problem(name, f"must have columns of one length, got {shapes or 'none'}"))
    texts = {key: [str(value) for value in array.tolist()] for key, array in arrays.items()}
    (count,) = next(iter(counts))
    return DataFile(name, texts, tuple(range(1, count + 1)))
