"""Sections at which a rod that lies on an obstacle is kept out of it.

A rod on polynomials cannot lie flat along a part of an element: its gap is zero at points and ripples between them. It
is kept out at sections that are close beside the ripples, and the remaining ripples are checked at the end.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

BENDING = (0, 1)
"""Numbers of the strains that bend a rod."""

SECTIONS_FOR_MODE = 3
"""Sections of an element for each of its modes of bending.

One would do to hold it still. With eight modes a rod that lies on a table was then 1.1e-3 of its length deep between
them, and 5e-5 with three, at much the same cost of time.
"""


def lobatto(count: int) -> FloatArray:
    """Nodes of Lobatto's quadrature on [0, 1], both ends among them, shape (count + 1,)."""
    degree = np.zeros(count + 1)
    degree[-1] = 1.0
    inner = legendre.legroots(legendre.legder(degree)).real if count > 1 else np.zeros(0)
    return np.asarray((np.concatenate([[-1.0], np.sort(inner), [1.0]]) + 1.0) / 2.0)


def laid_sections(model: Model, rod: str, ends: tuple[bool, bool]) -> FloatArray:
    """Abscissae of these sections, base to tip, shape (k,): Lobatto's in each element.

    Args:
        model: the model.
        rod: name of the rod.
        ends: whether base and tip are among them; not where they are held, or another rod has them.
    """
    discretisation = model.discretisation[rod]
    (record,) = [one for one in model.scene.rods if one.name == rod]
    strains = zip(record.admitted, discretisation.modes, strict=True)
    modes = max(count for strain, count in strains if strain in BENDING)
    local = lobatto(SECTIONS_FOR_MODE * modes)
    parts = [start + (end - start) * local[1:] for start, end in pairwise(discretisation.breaks)]
    sections = np.concatenate([[0.0], *parts])
    base, tip = ends
    return sections[0 if base else 1 : None if tip else -1]
