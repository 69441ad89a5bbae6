"""Measured cases as arrays, the differences of all measurements as one function, and the library that solves rows."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.estimator import EstimatorLibrary, MeasuredCases, estimator_library
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.identification.measured_cases import Case
from cosserat_casadi.identification.measured_quantities import difference
from cosserat_casadi.identification.measured_rows import measured_numbers
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.scene.input_fields import AXES


def sections_of(model: Model, cases: Sequence[Case]) -> dict[int, int]:
    """Largest number of rows of each measurement in one case, by its index; measurements without rows are left out."""
    counts = {}
    for number in range(len(model.scene.measurements)):
        most = max((len(case.data.get(number, [])) for case in cases), default=0)
        if most:
            counts[number] = most
    return counts


def differences(model: Model, sections: dict[int, int], indices: Sequence[int], abscissae: FloatArray) -> ca.Function:
    """Make the differences of all measurements as one function.

    Args:
        model: the measured model.
        sections: number of rows of each measurement in one case, by its index.
        indices: indices of the estimated numbers among the stacked inputs, followed by parameters.
        abscissae: abscissae of all cases, shape (cases, sections); one that is equal in all cases is a constant of the
            function.

    Returns:
        (x, inputs, at, measured) ↦ differences, and their derivatives by x and by these numbers. Parameters are
        appended to the inputs.
    """
    x = ca.MX.sym("x", model.size)
    given = ca.MX.sym("inputs", given_size(model))
    inputs = given[: model.inputs.size]
    parameters = given[model.inputs.size :]
    records = {number: model.discrete.scene.measurements[number] for number in sections}
    at = ca.MX.sym("at", sum(sections.values()))
    measured = ca.MX.sym("measured", sum(len(records[number].entries) * count for number, count in sections.items()))
    results: list[list[ca.MX]] = [[], [], []]
    first_section = 0
    first_number = 0
    for number, count in sections.items():
        record = records[number]
        own = range(first_section, first_section + count)
        own_at = ca.horzcat(*(abscissae[0, k] if np.ptp(abscissae[:, k]) == 0.0 else at[k] for k in own))
        size = len(record.entries) * count
        own_measured = ca.reshape(measured[first_number : first_number + size], len(record.entries), count)
        first_section += count
        first_number += size
        of_record = difference(model, record, count)
        value, by_x, by_inputs, by_parameters = of_record.call([x, inputs, parameters, own_at, own_measured])
        by_found = ca.horzcat(by_inputs, by_parameters)[:, list(indices)]
        for stack, result in zip(results, (value, by_x, by_found), strict=True):
            stack.append(result)
    stacked = [ca.densify(ca.vertcat(*stack)) for stack in results]
    names = ["x", "inputs", "at", "measured"]
    return ca.Function("measured", [x, given, at, measured], stacked, names, ["difference", "by_x", "by_unknown"])


def stacked(model: Model, cases: Sequence[Case], sections: dict[int, int]) -> MeasuredCases:
    """Convert the cases to arrays, in the order of :func:`differences`."""
    at: list[FloatArray] = []
    measured: list[FloatArray] = []
    weights: list[FloatArray] = []
    for number, count in sections.items():
        record = model.scene.measurements[number]
        abscissae, numbers, known = measured_numbers(record, [case.data.get(number, []) for case in cases], count)
        inverse_sigma = 1.0 / np.broadcast_to(np.asarray(record.sigma, dtype=float), known.shape[2])
        at.append(abscissae)
        measured.append(numbers.reshape(len(cases), -1))
        weights.append(np.where(known, inverse_sigma, 0.0).reshape(len(cases), -1))
    p = model.parameters.pack()
    inputs = np.array([np.concatenate([case.inputs, p]) for case in cases])
    return MeasuredCases(inputs, np.hstack(at), np.hstack(measured), np.hstack(weights))


def sensor_names(model: Model, sections: dict[int, int], abscissae: FloatArray) -> list[str]:
    """Names of the differences in their order: the measurement, the number, and the section where cases share it.

    Args:
        model: the measured model.
        sections: number of rows of each measurement in one case, by its index.
        abscissae: abscissae of all cases, shape (cases, sections).
    """
    names = []
    first = 0
    for number, count in sections.items():
        record = model.scene.measurements[number]
        # The words name its numbers, or for a quaternion the axes of the angle.
        words = [word for word, unit in zip(record.entries, record.differences, strict=False) if unit != "rad"]
        words += [f"about {axis}" for axis in AXES[3]][: len(record.differences) - len(words)]
        for column in range(first, first + count):
            own = abscissae[:, column]
            where = f" at X = {own[0]:g}" if hasattr(record, "at") and np.ptp(own) == 0.0 else ""
            names += [f"{record.title} {word}{where}" for word in words]
        first += count
    return names


def row_library(
    model: Model, sections: dict[int, int], indices: Sequence[int], abscissae: FloatArray
) -> EstimatorLibrary:
    """Make the library for rows of these sections; the model keeps it.

    Writing it takes a second or more, thousands of times as long as a row takes in C.

    Args:
        model: the measured model.
        sections: number of rows of each measurement in one case, by its index.
        indices: indices of the estimated numbers among the stacked inputs, followed by parameters.
        abscissae: abscissae of all cases, shape (cases, sections); one that is equal in all cases is a constant of the
            library.

    Raises:
        ExportError: two parts of the scene would have one name in C.
    """
    same = np.ptp(abscissae, axis=0) == 0.0
    constant = np.where(same, abscissae[0], np.nan)
    kind = (tuple(sections.items()), tuple(indices), constant.tobytes())
    kept: dict[object, EstimatorLibrary] = model.__dict__.setdefault("_row_libraries", {})
    if kind not in kept:
        measured = differences(model, sections, indices, abscissae)
        kept[kind] = estimator_library(model, measured, indices, kind)
    return kept[kind]
