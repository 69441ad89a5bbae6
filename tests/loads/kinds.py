"""Kinds of load that do not ship, written as a user would write them: one record, one class, one registration each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, ClassVar, Literal

import casadi as ca

from cosserat_casadi import Scene, scene_from_dict
from cosserat_casadi.loads.load import BodyPoint, Load, Section, Site
from cosserat_casadi.maths.numbers import Numbers, rows_of, stacked_rows
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.registry import register
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LoadRecord
from tests.registration import forget

Vector = tuple[float, float, float]


class _SpringKeys(LoadRecord):
    """A spring between a section, or a point of a body, and a point of the world."""

    inputs: ClassVar[Mapping[str, InputField]] = {"stiffness": InputField("N/m", 1), "anchor": InputField("m", 3)}

    rod: str | None = None
    body: str | None = None
    at: float = 1.0
    position: Vector = (0.0, 0.0, 0.0)
    stiffness: float
    anchor: Vector


class SpringRecord(_SpringKeys):
    kind: Literal["spring"]


class ElasticSpringRecord(_SpringKeys):
    kind: Literal["elastic_spring"]


class _OnSectionOrBody(Load[Any]):
    def abscissa(self, load: Any) -> float:
        return float(load.at)

    def on_body(self, load: Any, body: Any) -> BodyPoint | None:
        return BodyPoint(load.position) if load.body == body.name else None


class Spring(_OnSectionOrBody):
    """A linear spring of no length at rest, given as a wrench."""

    record = SpringRecord

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        return values["stiffness"] * (values["anchor"] - section.position), ca.DM(3, 1)


class ElasticSpring(_OnSectionOrBody):
    """The same given as an energy."""

    record = ElasticSpringRecord

    def energy(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        return values["stiffness"] / 2 * ca.sumsqr(section.position - values["anchor"])


class DipoleRecord(LoadRecord):
    """A dipole fixed in a section or a body, in a field that is uniform but for a gradient along its own axis."""

    inputs: ClassVar[Mapping[str, InputField]] = {"field": InputField("T", 3)}

    kind: Literal["dipole"]
    rod: str | None = None
    body: str | None = None
    at: float = 1.0
    position: Vector = (0.0, 0.0, 0.0)
    dipole: Vector
    gradient: float = 0.0
    field: Vector


class Dipole(_OnSectionOrBody):
    """Energy −m·B of a dipole m = R m₀, with B + g z e_z: rotation and position are coupled."""

    record = DipoleRecord

    def energy(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        field = values["field"] + load.gradient * ca.vertcat(0, 0, section.position[2])
        return -ca.dot(section.rotation @ ca.DM(load.dipole), field)


class TorqueRecord(LoadRecord):
    """A dipole in a uniform field, as a moment."""

    inputs: ClassVar[Mapping[str, InputField]] = {"field": InputField("T", 3)}

    kind: Literal["torque"]
    rod: str
    at: float = 1.0
    dipole: Vector
    field: Vector


class Torque(_OnSectionOrBody):
    """The moment R m₀ × B on a section."""

    record = TorqueRecord

    def on_body(self, load: Any, body: Any) -> None:
        return None

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        return ca.DM(3, 1), ca.cross(section.rotation @ ca.DM(load.dipole), values["field"])


class _LineKeys(LoadRecord):
    """A load all along a rod with one number."""

    inputs: ClassVar[Mapping[str, InputField]] = {"strength": InputField("N/m²", 1)}

    rod: str
    frame: Literal["world", "body"] = "world"
    strength: float


class BedRecord(_LineKeys):
    kind: Literal["bed"]


class WhirlRecord(_LineKeys):
    kind: Literal["whirl"]


class FlagRecord(_LineKeys):
    kind: Literal["flag"]


class Bed(Load[Any]):
    """An elastic foundation: every section is drawn to where it was, and turned back, as an energy per length."""

    record = BedRecord

    def energy(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        apart = section.position - section.data[:3]
        turned = 3 - ca.dot(ca.vec(section.rotation), section.data[3:])
        return values["strength"] * (ca.sumsqr(apart) / 2 + 0.1 * turned)

    def data(self, load: Any, site: Site) -> Numbers:
        return stacked_rows([*rows_of(site.unloaded_position), *rows_of(site.unloaded_rotation)])


class Whirl(Load[Any]):
    """A circulating force and moment per length, with no potential, in the axes of the sections or of the world."""

    record = WhirlRecord

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        x, y, z = ca.vertsplit(section.position)
        force = values["strength"] * ca.vertcat(-y, x, ca.sin(z))
        return force, 0.1 * values["strength"] * section.rotation[:, 2] * (1 + x)


class Flag(Load[Any]):
    """A dead force per length, written with the pose in its hands and not touching it."""

    record = FlagRecord

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        return values["strength"] * ca.DM([1.0, 0.0, 0.0]), ca.DM(3, 1)


KINDS: tuple[type[Load[Any]], ...] = (Spring, ElasticSpring, Dipole, Torque, Bed, Whirl, Flag)


@contextmanager
def registered() -> Iterator[None]:
    """The kinds of this file known to the package."""
    for kind in KINDS:
        register(kind)
    try:
        yield
    finally:
        for kind in KINDS:
            forget(kind)


def with_loads(tables: dict[str, Any], *loads: LoadRecord, inputs: tuple[str, ...] | None = None) -> Scene:
    """A scene with loads of these kinds beside those of its tables."""
    scene = scene_from_dict(tables)
    return scene.model_copy(update={"loads": (*scene.loads, *loads), "inputs": inputs})
