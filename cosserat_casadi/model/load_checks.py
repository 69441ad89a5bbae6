"""Loads that cannot be where the scene puts them: what only the unloaded shape of a rod shows."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.loads.load import Site, UnloadedPoses
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.load_assembly import unloaded_poses
from cosserat_casadi.model.registry import EFFECTS

LOOKED_AT = np.linspace(0.0, 1.0, 201)
"""Abscissae of the sections that a load is held against."""


def check_loads(discrete: DiscreteScene) -> None:
    """Refuse a scene whose loads cannot act on its unloaded rods.

    Raises:
        SceneError: with the faults of all loads.
    """
    problems = list(_problems(discrete))
    if problems:
        raise SceneError(*problems)


def _problems(discrete: DiscreteScene) -> Iterator[Problem]:
    for load in discrete.loads:
        member = EFFECTS[load.kind]
        for rod, discrete_rod in discrete.rods.items():
            if member.acts_on(load, rod):
                site = Site(discrete_rod.properties, LOOKED_AT, partial(_unloaded_poses, discrete, rod))
                yield from member.faults(load, site)


def _unloaded_poses(discrete: DiscreteScene, rod: str) -> UnloadedPoses:
    to_sections = discrete.rods[rod].grid.interpolation_matrix(LOOKED_AT)
    return unloaded_poses(discrete, rod, to_sections)
