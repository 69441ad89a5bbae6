"""Which rows of a sweep have loads with a potential, so that the stability of their equilibria has a meaning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from cosserat_casadi.model.build import build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.variants import Variants
from cosserat_casadi.sweeps.work import Chunk


def rows_with_potential(variants: Variants, work: Sequence[Chunk], scratch: Scratch) -> npt.NDArray[np.bool_]:
    """Which rows have loads with a potential, shape (rows,).

    Whether they have depends on which inputs and parameters are zero, and on nothing else of them: one row of each
    pattern is asked about. Chunks that are solved in Python have been judged there, and count as having one.

    Args:
        variants: scenes and inputs of the rows.
        work: which of them are solved in C.
        scratch: where the result is to lie.
    """
    judged: npt.NDArray[np.bool_] = scratch.array((len(variants.inputs),), np.bool_)
    judged[:] = True
    compiled = dict.fromkeys(
        variant for chunk in work if chunk.compiled or chunk.in_contact for variant, _ in chunk.pieces
    )
    for variant in compiled:
        rows_of_variant = variants.entries[variant].rows
        verdicts: dict[bytes, bool] = {}
        for block in scratch.blocks(len(rows_of_variant)):
            rows = rows_of_variant[block]
            patterns, first, pattern_of_row = np.unique(
                variants.given(rows) != 0.0, axis=0, return_index=True, return_inverse=True
            )
            for pattern, row in zip(patterns, rows[first].tolist(), strict=True):
                if pattern.tobytes() not in verdicts:
                    verdicts[pattern.tobytes()] = _has_potential(variants, row)
            of_patterns = np.array([verdicts[pattern.tobytes()] for pattern in patterns])
            judged[rows] = of_patterns[pattern_of_row.ravel()]
    return judged


def _has_potential(variants: Variants, row: int) -> bool:
    scene = variants.scene_of_row(row)
    # The coarsest model: loads are the same on each.
    model = build(scene, discretise(scene, 1, 2))
    return model.has_potential(variants.inputs[row])
