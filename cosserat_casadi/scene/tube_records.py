"""Concentric tubes: nested pre-curved tubes that drives behind a base plate turn and slide."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, SceneTables, Table, below, numbers_of, refused_keys, shown, table_of
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.material_records import Material
from cosserat_casadi.scene.records import Entry, Record
from cosserat_casadi.scene.values import Name, NotNegative, Number, Positive

BESIDE_TUBES = (
    "schema",
    "title",
    "accuracy",
    "parameters",
    "loads",
    "tubes",
    "ranges",
    "bounds",
    "targets",
    "measurements",
    "unknowns",
    "identification",
)
"""Keys of a scene that may stand beside tubes."""

LOADS_ON_TUBES = ("tip_wrench", "point_wrench", "distributed_wrench", "gravity")
"""Kinds of loads that may act on tubes."""

MEASURED_ON_TUBES = ("position", "pose")
"""Quantities that can be measured on tubes."""

OF_RODS = ("shape", "modes", "nodes", "rotation", "sections", "fibres", "chosen_for")
"""Keys of `[accuracy]` that are for rods."""


class TubeSection(Record):
    """The wall of a tube."""

    example: ClassVar[str] = """\
[[tubes]]
name = "wire"
material = { youngs_modulus = 6.0e10, poisson_ratio = 0.33 }
section = { outer_radius = 0.4e-3, inner_radius = 0 }
straight = 0.3
curved = 0.05
curvature = 25.0
translation = 0.2
"""

    outer_radius: Positive = Field(description="outer radius, m")
    inner_radius: NotNegative = Field(description="inner radius, m; 0 for a wire")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The bore fits into the tube."""
        outer = numbers_of(given.get("outer_radius"))
        inner = numbers_of(given.get("inner_radius"))
        if outer and inner and inner[0] >= outer[0]:
            problem = f"must be < outer_radius, got {shown(inner[0])} in {shown(outer[0])}"
            yield Fault(("inner_radius",), problem)


class TubeStiffness(Record):
    """Stiffnesses of a tube."""

    example: ClassVar[str] = """\
[[tubes]]
name = "inner"
stiffness = { bending = 0.025, torsion = 0.019 }
straight = 0.2
curved = 0.1
curvature = 12.0
translation = 0.25
"""

    bending: Positive = Field(description="bending stiffness EI, N m²")
    torsion: Positive = Field(description="torsional stiffness GJ, N m²")


class Tube(Entry):
    """A tube of a concentric tube robot: a straight part towards the drive, then a part of constant curvature.

    All tubes leave the plate at the origin of the world along z. They share the centre line; each turns in the others
    without friction, bears no torque at its tip, and is held straight in the housing behind the plate, up to its drive.
    """

    example: ClassVar[str] = """\
[[tubes]]
name = "outer"
material = { youngs_modulus = 6.0e10, poisson_ratio = 0.33 }
section = { outer_radius = 1.2e-3, inner_radius = 1.0e-3 }
straight = 0.1
curved = 0.1
curvature = 8.0
rotation = 0.0
translation = 0.15
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "rotation": InputField("rad", 1),
        "translation": InputField("m", 1, lower=0.0),
    }

    name: Name = Field(description="name of the tube, a letter, then letters, digits and underscores")
    material: Material | None = Field(None, description="material of the tube; with section")
    section: TubeSection | None = Field(None, description="its cross-section; with material")
    stiffness: TubeStiffness | None = Field(None, description="stiffnesses, N m²; instead of material and section")
    linear_density: Positive | None = Field(
        None, description="mass per length, kg/m; with stiffness, needed where gravity acts"
    )
    straight: NotNegative = Field(description="length of the straight part, m")
    curved: NotNegative = Field(description="length of the curved part, which ends at the tip, m")
    curvature: Number = Field(
        0.0, description="curvature of the curved part, 1/m; at the rotation 0 it bends towards x"
    )
    rotation: Number = Field(0.0, description="angle of its drive about z, rad")
    translation: NotNegative = Field(
        description="distance of its tip from the plate along the tube, m; at most its length"
    )

    @property
    def length(self) -> float:
        """Length of both parts, m."""
        return self.straight + self.curved

    def input_upper(self, field: str) -> float:
        """Largest translation, m, at which a tube is still in its drive; inf for its rotation."""
        return self.length if field == "translation" else super().input_upper(field)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The elasticity is given once; the tube has a length, and is not pushed out of its drive."""
        for key in ("material", "section"):
            if "stiffness" in given and key in given:
                yield Fault((key,), "stands beside stiffness", "give material and section, or stiffness")
            elif "stiffness" not in given and key not in given:
                yield Fault((key,), "missing", "give material and section, or stiffness")
        if "linear_density" in given and "stiffness" not in given:
            yield Fault(("linear_density",), "stands without stiffness", "give the density of the material, kg/m³")
        straight = numbers_of(given.get("straight"))
        curved = numbers_of(given.get("curved"))
        translation = numbers_of(given.get("translation"))
        if not straight or not curved or min(straight[0], curved[0]) < 0.0:
            return
        length = straight[0] + curved[0]
        if length == 0.0:
            yield Fault(("curved",), "the tube has no length", "give straight, curved or both")
        elif translation and translation[0] > length:
            problem = f"must be at most the length of the tube, {shown(length)} m, got {shown(translation[0])}"
            yield Fault(("translation",), problem, "beyond that the tube would leave its drive")


def tube_faults(scene: SceneTables) -> Iterator[Fault]:
    """Faults of tubes beside rods or tubes that do not fit into each other, and of a scene without either."""
    tubes = scene.tables("tubes")
    if scene.get("tubes") is None:
        if scene.get("rods") is None:
            yield Fault(("rods",), "missing", "a scene has rods, or tubes")
        return
    for key in scene.keys:
        if key not in BESIDE_TUBES:
            problem = "stands beside tubes, which are solved on their own"
            others = ", ".join(other for other in BESIDE_TUBES if other not in ("schema", "tubes"))
            yield Fault((key,), problem, f"leave it out; beside tubes may stand {others}")
    accuracy, remedy = table_of(scene.get("accuracy")), "tubes are computed to tolerance: leave it out"
    yield from below(("accuracy",), refused_keys(accuracy, OF_RODS, "is for rods", remedy))
    if tubes and not any(_reaches_out(table) for _, table in tubes):
        index, _ = tubes[0]
        yield Fault(("tubes", index, "translation"), "no tube stands out of the plate", "push one out: translation > 0")
    yield from _nesting_faults(scene)
    yield from _load_faults(scene)
    yield from _target_faults(scene)
    yield from _measurement_faults(scene)


def _load_faults(scene: SceneTables) -> Iterator[Fault]:
    """Faults of loads of kinds or forms that do not act on tubes."""
    names = scene.named("tubes")
    for index, load in scene.tables("loads"):
        kind = load.get("kind")
        if not isinstance(kind, str):
            continue
        if kind not in LOADS_ON_TUBES:
            remedy = f"on tubes act {', '.join(LOADS_ON_TUBES)}"
            yield Fault(("loads", index, "kind"), f"{shown(kind)} does not act on tubes", remedy)
        elif kind == "point_wrench" and "moment" in load:
            problem = "does not act on tubes beside their tips"
            yield Fault(("loads", index, "moment"), problem, 'give a force, N, or a "tip_wrench"')
        elif kind == "distributed_wrench":
            yield from below(("loads", index), _spread_faults(load))
        name = load.get("name")
        if isinstance(name, str) and name in names:
            first, _ = names[name]
            problem = f"{shown(name)} is already the name of tubes[{first}]"
            yield Fault(("loads", index, "name"), problem, "their inputs could not be told apart")


def _target_faults(scene: SceneTables) -> Iterator[Fault]:
    """Faults of targets for other places on tubes than their tips."""
    for index, target in scene.tables("targets"):
        if target.get("kind") == "curve":
            remedy = "for tubes, give the pose or the position of a tip"
            yield Fault(("targets", index, "kind"), "is for points along a rod", remedy)
        elif numbers_of(target.get("at", 1.0)) != [1.0]:
            yield Fault(("targets", index, "at"), "is a place on a rod", "leave it out: for a tube it is the tip")


def _measurement_faults(scene: SceneTables) -> Iterator[Fault]:
    """Faults of measured quantities that belong to rods, and of measurements over time."""
    for index, measurement in scene.tables("measurements"):
        quantity = measurement.get("quantity")
        if isinstance(quantity, str) and quantity not in MEASURED_ON_TUBES:
            remedy = f"of tubes, give {' or '.join(MEASURED_ON_TUBES)}"
            yield Fault(("measurements", index, "quantity"), f"{shown(quantity)} is not measured on tubes", remedy)
        if "time" in measurement:
            yield Fault(("measurements", index, "time"), "needs a motion, and tubes have none", "leave it out")


def _spread_faults(load: Table) -> Iterator[Fault]:
    """Faults of a wrench per length on tubes, without the path of the load: a moment, a frame, or a profile."""
    if "moment" in load:
        yield Fault(("moment",), "does not act on tubes along their length", "give a force, N/m")
    if load.get("frame") == "body":
        yield Fault(("frame",), "does not act on tubes along their length", 'give the force in axes of the "world"')
    force = load.get("force")
    if isinstance(force, list) and any(isinstance(component, list | Mapping) for component in force):
        yield Fault(("force",), "varies along the tube", "give three numbers, N/m, of the tube up to its tip")


def _reaches_out(tube: Table) -> bool:
    """Whether a tube stands out of the plate; a tube with a faulty translation may."""
    translation = numbers_of(tube.get("translation"))
    return not translation or translation[0] > 0.0


def _nesting_faults(scene: SceneTables) -> Iterator[Fault]:
    """Faults of tubes, in the order of size, that do not fit into the next one."""
    walls: list[tuple[float, float, int, Any]] = []
    for index, tube in scene.tables("tubes"):
        section = table_of(tube.get("section"))
        outer = numbers_of(section.get("outer_radius"))
        inner = numbers_of(section.get("inner_radius"))
        if outer and inner:
            walls.append((outer[0], inner[0], index, tube.get("name")))
    walls.sort(key=lambda wall: (wall[0], wall[2]))
    for (outer, _, index, _), (_, bore, _, around) in itertools.pairwise(walls):
        if outer > bore:
            problem = f"must be at most the bore {shown(bore)} of the tube {_named(around)}, got {shown(outer)}"
            yield Fault(("tubes", index, "section", "outer_radius"), problem, "tubes fit into each other")


def _named(name: Any) -> str:
    return shown(name) if isinstance(name, str) else "without a name"
