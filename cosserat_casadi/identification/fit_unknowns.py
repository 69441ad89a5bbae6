"""Unknowns of an identification as two vectors: those shared by all cases, and those of each case.

An unknown is one number or several. The quaternion of a base is three: the rotation vector, world axes, from the
scene's value. All others are the numbers of the scene themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.numerics.arrow_least_squares import Limits
from cosserat_casadi.scene.input_fields import AXES
from cosserat_casadi.scene.orientations import quaternion_about
from cosserat_casadi.tubes.tube_functions import AnyModel

TURN = 1e-4
"""Angle below which the derivative of a quaternion by its rotation vector is taken from the series."""


@dataclass(frozen=True)
class UnknownEntry:
    """One unknown of the scene.

    Attributes:
        record: record in the scene.
        labels: names of its numbers.
        unit: unit of each number.
        indices: indices of its numbers in the stacked parameters, or in the stacked inputs.
        start: values in the scene, shape (entries,).
        turns: whether it is a quaternion, whose rotation vector is found.
        scales: a typical size of each number, shape (n,).
        positive: whether no number may be negative.
    """

    record: scenes.Unknown
    labels: tuple[str, ...]
    unit: str
    indices: npt.NDArray[np.int64]
    start: FloatArray
    turns: bool
    scales: FloatArray
    positive: bool

    @property
    def of_input(self) -> bool:
        """Whether the unknown is an input, and not a parameter."""
        return self.record.input is not None

    @property
    def size(self) -> int:
        """Number of numbers in the search."""
        return len(self.labels)

    def values(self, found: FloatArray) -> FloatArray:
        """Values in the scene, shape (entries,), from the numbers of the search, shape (n,)."""
        if not self.turns:
            return found
        return _product_matrix(self.start) @ quaternion_about(found)

    def derivative(self, found: FloatArray) -> FloatArray:
        """Derivative of the values by the numbers of the search, shape (entries, n)."""
        if not self.turns:
            return np.eye(self.size)
        return _product_matrix(self.start) @ _quaternion_derivative(found)

    @property
    def start_numbers(self) -> FloatArray:
        """The numbers of the search at the values of the scene, shape (n,)."""
        return np.zeros(3) if self.turns else self.start.copy()

    def limits(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Least values, largest values, expected values and reciprocal standard deviations; each of shape (n,).

        Raises:
            SceneError: the scene has a wrong number of values.
        """
        record = self.record
        lower = self._spread("lower", record.lower, -np.inf)
        upper = self._spread("upper", record.upper, np.inf)
        if record.prior is None:
            return lower, upper, np.zeros(self.size), np.zeros(self.size)
        mean = self._spread("prior.mean", record.prior.mean, 0.0)
        sigma = self._spread("prior.sigma", record.prior.sigma, 1.0)
        return lower, upper, mean, 1 / sigma

    def _spread(self, key: str, given: float | Sequence[float] | None, otherwise: float) -> FloatArray:
        if given is None:
            return np.full(self.size, otherwise)
        numbers = np.atleast_1d(np.asarray(given, dtype=float))
        if numbers.size not in (1, self.size):
            what = ", ".join(self.labels)
            problem = f"{key} must have 1 number or {self.size}, got {numbers.size}"
            raise SceneError(Problem(f"unknowns: {self.record.name}", problem, f"they are {what}"))
        return np.broadcast_to(numbers, self.size).copy()


@dataclass(frozen=True)
class UnknownLayout:
    """All unknowns of a scene.

    Attributes:
        shared: unknowns that all cases share.
        own: unknowns of each case.
        p: the scene's parameters, shape (size of the parameters,).
    """

    shared: tuple[UnknownEntry, ...]
    own: tuple[UnknownEntry, ...]
    p: FloatArray

    @cached_property
    def shared_labels(self) -> tuple[str, ...]:
        """Names of the shared numbers."""
        return tuple(label for entry in self.shared for label in entry.labels)

    @cached_property
    def own_labels(self) -> tuple[str, ...]:
        """Names of the numbers of each case."""
        return tuple(label for entry in self.own for label in entry.labels)

    @cached_property
    def shared_limits(self) -> Limits:
        """Bounds and priors of the shared numbers."""
        return _limits(self.shared)

    @cached_property
    def own_limits(self) -> Limits:
        """Bounds and priors of the numbers of each case."""
        return _limits(self.own)

    def start(self, cases: int) -> tuple[FloatArray, FloatArray]:
        """The scene's values, clipped to the bounds: shared numbers, (n,), and numbers of each case, (cases, k)."""
        shared = np.concatenate([np.zeros(0), *(entry.start_numbers for entry in self.shared)])
        own = np.concatenate([np.zeros(0), *(entry.start_numbers for entry in self.own)])
        return self.shared_limits.clipped(shared), np.tile(self.own_limits.clipped(own), (cases, 1))

    def scales(self, shared: FloatArray) -> FloatArray:
        """Sizes for comparison with changes of the shared numbers, shape (n,): their values, or typical sizes."""
        typical = np.concatenate([np.zeros(0), *(entry.scales for entry in self.shared)])
        values = np.abs(shared)
        by_ratio = self.shared_limits.ratios & (values > 0)
        return np.where(by_ratio, values, np.maximum(values, typical))

    @cached_property
    def own_scales(self) -> FloatArray:
        """Typical sizes of the numbers of each case, shape (k,)."""
        return np.concatenate([np.zeros(0), *(entry.scales for entry in self.own)])

    def parameters(self, shared: FloatArray) -> FloatArray:
        """All parameters, shape (size of the parameters,)."""
        p = self.p.copy()
        for entry, found in parts(self.shared, shared):
            if not entry.of_input:
                p[entry.indices] = entry.values(found)
        return p

    def inputs(self, shared: FloatArray, own: FloatArray, measured: FloatArray) -> FloatArray:
        """Inputs of all cases, shape (cases, size of the inputs).

        Args:
            shared: shared numbers, shape (n,).
            own: numbers of each case, shape (cases, k).
            measured: inputs set by columns, and the scene's values of other inputs, shape as the result.
        """
        inputs = measured.copy()
        for entry, found in parts(self.shared, shared):
            if entry.of_input:
                inputs[:, entry.indices] = entry.values(found)
        for case in range(len(own)):
            for entry, found in parts(self.own, own[case]):
                inputs[case, entry.indices] = entry.values(found)
        return inputs

    def derivatives(self, shared: FloatArray, own: FloatArray, inputs: int) -> tuple[FloatArray, FloatArray]:
        """Derivatives by the shared numbers, then by the numbers of a case.

        Args:
            shared: shared numbers, shape (n,).
            own: numbers of each case, shape (cases, k).
            inputs: size of the inputs.

        Returns:
            derivatives of the parameters, shape (size of the parameters, n + k), and of the inputs of each case,
            shape (cases, inputs, n + k).
        """
        count = len(self.shared_labels) + len(self.own_labels)
        of_parameters = np.zeros((len(self.p), count))
        of_inputs = np.zeros((len(own), inputs, count))
        for case, numbers in enumerate(own):
            first = 0
            for entry, found in parts((*self.shared, *self.own), np.concatenate([shared, numbers])):
                rows = of_inputs[case] if entry.of_input else of_parameters
                rows[entry.indices, first : first + entry.size] = entry.derivative(found)
                first += entry.size
        return of_parameters, of_inputs

    def identified(self, shared: FloatArray, *, of_input: bool) -> dict[str, FloatArray]:
        """Identified values of the shared parameters, or inputs, by name, in the shape that the model takes."""
        found = parts(self.shared, shared)
        return {entry.record.name: entry.values(own) for entry, own in found if entry.of_input is of_input}


def parts(entries: Sequence[UnknownEntry], stacked: FloatArray) -> list[tuple[UnknownEntry, FloatArray]]:
    """Split the stacked numbers of all unknowns by unknown."""
    ends = np.cumsum([entry.size for entry in entries]).tolist()
    return [(entry, stacked[end - entry.size : end]) for entry, end in zip(entries, ends, strict=True)]


def _limits(entries: Sequence[UnknownEntry]) -> Limits:
    sides = [entry.limits() for entry in entries]
    empty = np.zeros(0)
    lower, upper, mean, weight = (np.concatenate([empty, *(side[k] for side in sides)]) for k in range(4))
    ratios = [label for entry in entries for label in [entry.positive] * entry.size]
    return Limits(lower, upper, mean, weight, np.array(ratios, dtype=bool))


def unknown_layout(model: AnyModel) -> UnknownLayout:
    """Collect the unknowns of a model's scene.

    Raises:
        SceneError: there are no unknowns, or the model has no such parameter or input.
    """
    scene = model.scene
    problems = []
    if not scene.unknowns:
        problems.append(Problem("unknowns", "missing", "name what is to be found"))
    entries = []
    parameters = {entry.name: entry for entry in model.parameters.entries}
    # Places in the stacked inputs by the name of an input, or of one of its numbers.
    indices = {name: [index] for name, index in column_indices(model.inputs).items()}
    indices |= {entry.name: list(range(span.start, span.stop)) for entry, span in model.inputs}
    typical = _typical_sizes(model)
    for number, record in enumerate(scene.unknowns):
        where = f"unknowns[{number}]"
        if record.parameter is not None and record.name in parameters:
            span = model.parameters.slices[record.name]
            places = list(range(span.start, span.stop))
            entries.append(_entry(model, record, places, parameters[record.name], typical))
        elif record.input is not None and record.input in indices:
            entries.append(_entry(model, record, indices[record.input], None, typical))
        else:
            remedy = "build(scene.with_unknowns()) has all that is unknown"
            if record.input is not None and any(name.startswith(f"{record.input}.") for name in indices):
                remedy = "name one of its parts"
            problems.append(Problem(where, f"the model has no {record.name}", remedy))
    for entry in entries:
        try:
            _, upper, _, _ = entry.limits()
        except SceneError as error:
            problems += error.problems
            continue
        if entry.positive and np.any(upper <= 0):
            problem = f"upper must be > 0, as {entry.record.name} is, got {upper.min():g}"
            problems.append(Problem(f"unknowns: {entry.record.name}", problem))
    refuse(problems)
    shared = tuple(entry for entry in entries if not entry.record.per_row)
    own = tuple(entry for entry in entries if entry.record.per_row)
    return UnknownLayout(shared, own, model.parameters.pack())


def refuse_row_parameters(scene: scenes.Scene) -> None:
    """Refuse parameters with a separate unknown value in each case; an identification has inputs for that.

    Raises:
        SceneError: there are such unknowns; the error lists all of them.
    """
    problem = "a parameter is the same in all cases of an identification"
    remedy = "leave per_row out, name an input, or find it with cosserat estimate"
    refused = [
        Problem(f"unknowns[{i}].per_row", problem, remedy)
        for i, unknown in enumerate(scene.unknowns)
        if unknown.per_row and unknown.parameter is not None
    ]
    refuse(refused)


def _entry(
    model: AnyModel,
    record: scenes.Unknown,
    places: list[int],
    parameter: scenes.NamedNumbers | None,
    typical: Mapping[str, float],
) -> UnknownEntry:
    """One unknown.

    Args:
        model: model with the parameter or the input.
        record: record in the scene.
        places: indices of its numbers in the stacked parameters, or in the stacked inputs.
        parameter: the unknown parameter; None for an unknown input.
        typical: typical sizes of numbers that may have any sign, by unit.
    """
    if parameter is not None:
        labels = parameter.cell_names
        unit = parameter.unit
        start = parameter.default.ravel(order="F")
        turns = parameter.keys[-1] == "quaternion"
        positive = _is_positive(model, parameter)
    else:
        names = {index: name for name, index in column_indices(model.inputs).items()}
        labels = tuple(names[place] for place in places)
        owner = next(entry for entry, entries in model.inputs if entries.start <= places[0] < entries.stop)
        unit = owner.unit
        start = model.pack()[places]
        turns = owner.field.endswith("quaternion")
        positive = owner.declared.positive
    turns = turns and start.size == 4
    if turns:
        labels = tuple(f"{record.name} about {axis}" for axis in AXES[3])
        unit = "rad"
        positive = False
    if len(labels) == 1:
        labels = (record.name,)
    sizes = np.full(len(labels), typical.get(unit, 0.0))
    if not turns:
        sizes = np.maximum(sizes, np.abs(start))
    sizes[sizes == 0.0] = 1.0
    return UnknownEntry(record, labels, unit, np.array(places), start, turns, sizes, positive)


def _is_positive(model: AnyModel, parameter: scenes.NamedNumbers) -> bool:
    """Whether the scene refuses the parameter with the opposite sign."""
    if not np.all(parameter.default > 0):
        return False
    try:
        model.parameters.set_in(model.scene, {parameter.name: -parameter.default})
    except SceneError:
        return True
    return False


def _typical_sizes(model: AnyModel) -> dict[str, float]:
    """Typical sizes of numbers that may have any sign, by unit, for a rod or tube bent by about a radian."""
    length, energy = model.typical_sizes
    return {
        "1": 1.0,
        "rad": 1.0,
        "m": length,
        "1/m": 1 / length,
        "N": energy / length,
        "N m": energy,
        "N/m": energy / length**2,
    }


# Rotations


def _quaternion_derivative(vector: FloatArray) -> FloatArray:
    """Derivative of the unit quaternion of a rotation vector, shape (4, 3)."""
    angle = float(np.linalg.norm(vector))
    sine = np.sinc(angle / (2 * np.pi)) / 2
    # (d sine / d angle) / angle; the quotient cancels at small angles.
    slope = (np.cos(angle / 2) / 2 - sine) / angle**2 if angle > TURN else -1 / 24
    by_vector = np.empty((4, 3))
    by_vector[0] = -sine * vector / 2
    by_vector[1:] = sine * np.eye(3) + slope * np.outer(vector, vector)
    return by_vector


def _product_matrix(q: FloatArray) -> FloatArray:
    """Matrix M of e ⊗ q = M e, from the rules of report (A.13)."""
    w, x, y, z = q
    return np.array([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]])
