"""Inextensible rods that supports hold straight: lateral loads have no equilibrium."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.scene.rod_records import SHEAR_AND_EXTENSION

CLOSED = 1e-9
"""Residual of constraints, relative to the length of the rods, below which they are closed."""

STRAIGHT = 1e-9
"""Relative difference of the length along sections and the distance of the ends up to which a rod is straight."""

SECTIONS = 9
"""Number of sections of a rod that decide whether it is straight."""

DEPENDENT = 1e-9
"""Share of the largest singular value below which a singular value counts as zero."""

TAUT = (
    " The supports hold a rod that cannot extend at the distance of its length: it stays straight, and loads across "
    'it have no equilibrium. Admit its extension (strain = "reissner"), or hold its ends nearer to each other.'
)
"""Sentence in the message of a solve that fails for this reason."""


def held_taut(model: Model, inputs: FloatArray) -> bool:
    """Whether the unloaded rods meet their supports, and no small change of shape moves them in a held direction.

    Args:
        model: model of a scene; scenes with bodies or without supports have no such rods.
        inputs: stacked inputs, shape (model.inputs.size,).
    """
    discrete = model.discrete
    if not discrete.constraints or model.scene.bodies:
        return False
    unloaded = model.unloaded()
    if not is_closed(model, inputs, unloaded):
        return False
    held = np.r_[tuple(entries for _, entries in discrete.unknowns.of_kind(BlockKind.MULTIPLIER))]
    # With few modes a curved rod may be locked too, which more modes mend.
    stiff = [rod.name for rod in model.scene.rods if not set(rod.admitted) & SHEAR_AND_EXTENSION]
    if not any(_is_straight(model, unloaded, inputs, name) for name in stiff):
        return False
    changes = model.path_jacobian(unloaded, inputs, 1.0).full()[np.ix_(held, model.shape_unknowns)]
    singular = np.linalg.svd(changes, compute_uv=False)
    return bool(len(singular) < len(changes) or singular[-1] <= DEPENDENT * singular[0])


def is_closed(model: Model, inputs: FloatArray, x: FloatArray) -> bool:
    """Whether rods and bodies meet their supports and joints, however large the forces are."""
    held = np.r_[tuple(entries for _, entries in model.discrete.unknowns.of_kind(BlockKind.MULTIPLIER))]
    gaps = np.abs(column(model.path_residual(x, inputs, 1.0))[held])
    return bool(gaps.max(initial=0.0) <= CLOSED)


def _is_straight(model: Model, x: FloatArray, inputs: FloatArray, rod: str) -> bool:
    sections = np.linspace(0.0, 1.0, SECTIONS)
    positions = np.hstack([model.shape[rod](x, inputs, X)[0].full() for X in sections])
    length = np.linalg.norm(np.diff(positions), axis=0).sum()
    chord = np.linalg.norm(positions[:, -1] - positions[:, 0])
    return bool(chord >= (1.0 - STRAIGHT) * length)
