"""Scenes in exact contact as exported folders that are compiled without optimisation."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi import Model, Scene, Solution, build, discretise, export
from cosserat_casadi.codegen.contact.compiled import CompiledContact, CompiledContactSolution
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import QUICK, compile_quickly
from tests.scenes import rod, scene

BAR = {"name": "bar", "kind": "capsule", "from": [0.5, -0.5, -0.08], "to": [0.5, 0.5, -0.08], "radius": 0.05}
TABLE = {"name": "table", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -3.0]}
WEIGHT = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, -6.0]}
FLAT = rod("planar", base={"position": [0, 0, 0], "tangent": [1, 0, 0]})


def over_bar() -> Scene:
    """A planar rod that a force at its tip bends over a bar."""
    return scene(rods=[FLAT], loads=[PUSH], obstacles=[BAR], accuracy={"tolerance": 1e-8})


def on_table() -> Scene:
    """A planar rod whose tip comes to a table, and that lies down on it under more load."""
    return scene(rods=[FLAT], loads=[WEIGHT], obstacles=[TABLE], accuracy={"tolerance": 1e-5})


def pulled_over_bar(tendon: dict[str, Any] | None = None, **more: Any) -> Scene:
    """The rod over a bar, with a tendon along it, of which entries may be others."""
    entry = {"name": "tendon", "kind": "tendon", "rod": "rod", "offset": [-0.01, 0], "tension": 2}
    plain = {"obstacles": [BAR], "accuracy": {"tolerance": 1e-8}}
    return scene(rods=[FLAT], loads=[PUSH], actuators=[entry | (tendon or {})], **plain | more)


@dataclass(frozen=True)
class ContactLibrary:
    """An exported scene in exact contact.

    Attributes:
        model: of the scene.
        folder: its sources.
    """

    model: Model
    folder: Path

    @cached_property
    def loaded(self) -> CompiledContact:
        """The library, compiled quickly."""
        manifest = json.loads((self.folder / "manifest.json").read_text())
        name = manifest["name"]
        library = self.folder.parent / f"{name}.so"
        wanted = (f"{name}.c", f"{name}_kernels.c", f"{name}_derivatives.c")
        sources = [self.folder / file for file in wanted if file in manifest["files"]]
        compile_quickly("-std=c99", *QUICK, "-shared", *sources, "-o", library, "-lm")
        return CompiledContact(library, manifest)


def exported_contact(
    wanted: Scene, folder: Path, load_cases: FloatArray, modes: int, nodes: int, **options: bool
) -> ContactLibrary:
    """A scene in exact contact as a folder, with options of an export."""
    model = build(wanted, discretise(wanted, modes, nodes))
    return ContactLibrary(model, export(model, folder, load_cases=load_cases, **options))


def assert_same(found: CompiledContactSolution, wanted: Solution, *, forces: float = 1e-9) -> None:
    """Whether C and Python agree on the tip and the places of contact to 1e-9, and on the forces."""
    assert found.converged, found.message
    assert wanted.converged, wanted.message
    np.testing.assert_allclose(found.tips["rod"][:3], wanted.tip().position, rtol=0, atol=1e-9)
    assert len(found.contacts) == len(wanted.contacts)
    for own, other in zip(found.contacts, wanted.contacts, strict=True):
        assert (own.obstacle, own.owner, own.kind) == (other.obstacle, other.owner, other.kind)
        np.testing.assert_allclose([own.start, own.end], [other.start, other.end], rtol=0, atol=1e-9)
        np.testing.assert_allclose(own.force, other.force, rtol=forces, atol=forces)
        np.testing.assert_allclose(own.ends, other.ends, rtol=forces, atol=forces)
