"""Sentences on small motions about an equilibrium: they grow, flutter, meet no resistance, or die away."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.motion.eigenproblem import REAL, ComplexArray


def stability_sentences(values: ComplexArray, believed: npt.NDArray[np.bool_], solution: Solution) -> str:
    """Sentences on how small motions about an equilibrium grow, swing or decay.

    Args:
        values: all eigenvalues of the model.
        believed: whether an eigenvalue that swings is taken for a motion of the rods, not of the discretisation.
        solution: the equilibrium.
    """
    growing = values.real > REAL * np.abs(values)
    swinging = values.imag > 0.0
    sentences = []
    unsettled = values[growing & ~swinging]
    if unsettled.size:
        count = _motions(unsettled.size, "grows", "grow")
        sentences.append(f"Statically unstable: {count} without swinging, at up to {unsettled.real.max():.6g} 1/s.")
    elif solution.stable is False and not np.any(values == 0.0):
        sentences.append("Statically unstable: what has no mass leaves the equilibrium at once.")
    fluttering = values[growing & swinging & believed]
    if fluttering.size:
        fastest = fluttering[np.argmax(fluttering.real)]
        count = _motions(fluttering.size, "grows", "grow")
        frequency = abs(fastest) / (2 * np.pi)
        sentences.append(
            f"Dynamically unstable (flutter): {count} while swinging, at {frequency:.6g} Hz by {fastest.real:.6g} 1/s."
        )
    neutral = int(np.sum(values == 0.0))
    if neutral:
        count = _motions(neutral, "meets", "meet")
        sentences.append(f"{count} no resistance: rigid, or neutral.".capitalize())
    if not sentences:
        sentences.append(_settled(values))
    return " ".join(sentences)


def _settled(values: ComplexArray) -> str:
    if np.all(values.real < 0.0):
        return "Stable: small motions die away."
    return "Stable: small motions stay small."


def _motions(count: int, singular: str, plural: str) -> str:
    if count == 1:
        return f"one motion {singular}"
    return f"{count} motions {plural}"
