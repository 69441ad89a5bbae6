"""The library that answers rows of measurements of a model: written once, however often rows come.

Writing it takes a second or more, thousands of times as long as a row takes in C.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.codegen.estimator import EstimatorLibrary, estimator_library
from cosserat_casadi.estimation.stacking import differences
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model


def row_library(
    model: Model, sections: dict[int, int], indices: Sequence[int], abscissae: FloatArray
) -> EstimatorLibrary:
    """The library for rows of these sections; the model keeps it.

    Args:
        model: the measured model.
        sections: rows of each measurement in one case, by its number.
        indices: of the numbers that are found among the stacked inputs and the parameters behind them.
        abscissae: of all cases, shape (cases, sections); an abscissa that is the same in all cases is a constant of the
            library.

    Raises:
        ExportError: two things of the scene would have one name in C.
    """
    same = np.ptp(abscissae, axis=0) == 0.0
    constant = np.where(same, abscissae[0], np.nan)
    kind = (tuple(sections.items()), tuple(indices), constant.tobytes())
    kept: dict[object, EstimatorLibrary] = model.__dict__.setdefault("_row_libraries", {})
    if kind not in kept:
        measured = differences(model, sections, indices, abscissae)
        kept[kind] = estimator_library(model, measured, indices, kind)
    return kept[kind]
