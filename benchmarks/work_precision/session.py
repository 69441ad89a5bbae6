"""A bench from its scene to its rows: the reference, then point after point, each handed over as it is measured."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import SceneError
from tests.fine_reference import Reference, distance, find_reference
from work_precision.grid import DIAL, Candidate
from work_precision.measurement import Measurement, Trial

RICHER = {"planar": "kirchhoff", "kirchhoff": "reissner"}
"""The strain model that lets a rod do more."""


@dataclass
class Session:
    """One scene under measurement.

    Attributes:
        scene: the scene.
        compiler: command of a C compiler.
        reference: what errors are measured against.
    """

    scene: scenes.Scene
    compiler: str
    reference: Reference
    _references: dict[str, Reference] = field(default_factory=dict)

    @classmethod
    def open(cls, scene: scenes.Scene, compiler: str) -> Session:
        """Find the reference.

        Raises:
            NoReferenceError: there is none.
        """
        return cls(scene, compiler, find_reference(scene))

    def measure(self, candidates: Sequence[Candidate]) -> Iterator[Measurement]:
        """Rows in the order of the candidates.

        As many programs are compiled at once as there are cores; nothing is timed meanwhile.
        """
        width = max(1, os.cpu_count() or 1)
        for first in range(0, len(candidates), width):
            yield from self._batch(candidates[first : first + width])

    def _batch(self, candidates: Sequence[Candidate]) -> Iterator[Measurement]:
        trials: list[Trial] = []
        try:
            for candidate in candidates:
                scene, reference = self.problem(candidate.strain)
                trials.append(Trial(candidate, scene, reference, self.compiler))
            for trial in trials:
                trial.wait()
            # Only now, on a quiet machine.
            for trial in trials:
                yield trial.finish()
        finally:
            for trial in trials:
                trial.close()

    def problem(self, strain: str) -> tuple[scenes.Scene, Reference]:
        """The scene with a strain model, the empty name for the scene's model, and its reference."""
        if not strain:
            return self.scene, self.reference
        scene = with_strain(self.scene, strain)
        if strain not in self._references:
            self._references[strain] = find_reference(scene)
        return scene, self._references[strain]

    def facts(self) -> dict[str, Any]:
        """Facts that a reader of the rows needs, as data."""
        return {"reference": {"method": self.reference.method}, "strain_models": self.model_distances}

    @property
    def model_distances(self) -> dict[str, float]:
        """Pose distance of richer strain models from that of the scene."""
        distances = {}
        for strain, reference in self._references.items():
            distances[strain] = distance(self.reference.rods, reference.rods).pose
        return distances


def with_strain(scene: scenes.Scene, strain: str) -> scenes.Scene:
    """The scene with another strain model for all rods.

    Raises:
        SceneError: a stiffness is missing.
    """
    tables = scene.model_dump(mode="json", by_alias=True, exclude_unset=True)
    tables["rods"] = [{**rod, "strain": strain} for rod in tables["rods"]]
    tables.pop("accuracy", None)
    return scenes.scene_from_dict(tables)


def richer_candidates(scene: scenes.Scene) -> list[Candidate]:
    """The next richer strain model at the scene's tolerance, where the scene allows it; else none."""
    strains = {str(rod.strain) for rod in scene.rods}
    if len(strains) != 1:
        return []
    richer = RICHER.get(strains.pop())
    if richer is None:
        return []
    try:
        # A stiffness that the richer model needs may not be given.
        with_strain(scene, richer)
    except SceneError:
        return []
    return [Candidate(DIAL, tolerance=scene.accuracy.tolerance, strain=richer)]
