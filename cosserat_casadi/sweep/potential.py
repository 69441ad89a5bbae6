"""Which rows of a sweep have loads with a potential, so that the stability of their equilibria has a meaning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from cosserat_casadi.model.build import build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.sweep.variants import Variants
from cosserat_casadi.sweep.work import Chunk


def rows_with_potential(variants: Variants, work: Sequence[Chunk]) -> npt.NDArray[np.bool_]:
    """Which rows have loads with a potential, shape (rows,).

    Whether they have depends on which inputs and parameters are zero, and on nothing else of them: one row of each
    pattern is asked about. Rows that are solved in Python have been judged there, and count as having one.

    Args:
        variants: scenes and inputs of the rows.
        work: which of them are solved in C.
    """
    judged = np.ones(len(variants.inputs), dtype=bool)
    compiled = dict.fromkeys(variant for chunk in work if chunk.compiled for variant, _ in chunk.pieces)
    for variant in compiled:
        entry = variants.entries[variant]
        given = variants.given(entry.rows) != 0.0
        _, first, pattern_of_row = np.unique(given, axis=0, return_index=True, return_inverse=True)
        verdicts = []
        for row in entry.rows[first]:
            scene = variants.scene_of_row(int(row))
            # The coarsest model: loads are the same on each.
            model = build(scene, discretise(scene, 1, 2))
            verdicts.append(model.has_potential(variants.inputs[row]))
        judged[entry.rows] = np.array(verdicts, dtype=bool)[pattern_of_row.ravel()]
    return judged
