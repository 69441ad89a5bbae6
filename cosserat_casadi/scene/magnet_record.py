"""Magnets in a field: magnetised rods, and dipoles that sit in a section or in a body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, Table, list_of, one_of
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LOADS, LoadRecord
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.values import ABOVE_BASE, Matrix3, Number, Polynomials, Vector, above_base

STRONGEST_FIELD = 100.0
"""Largest component of a field, T: above permanent magnets, below 20 mT written as 20."""

FIELDS = ("field", "gradient", "dipole")
"""Keys that give a field."""


class Dipole(Record):
    """A point source of a field: B = μ₀/4π (3 d (d·m)/|d|⁵ − m/|d|³), d from the source.

    A magnet that is far or small beside its distance.
    """

    example: ClassVar[str] = """\
[[loads]]
name = "pull"
kind = "magnet"
rod = "finger"
moment = [0, 0, 0.02]
at = 1.0
dipole = { position = [0.1, 0, 0.25], moment = [0, 0, 40.0] }     # of a permanent magnet that a robot moves
"""

    position: Vector = Field(description="position of the source in the world, m")
    moment: Vector = Field(description="its magnetic moment in world axes, A m²")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The source is a magnet."""
        yield from _zero("moment", given, "the magnetic moment of the source, A m²")


@LOADS.register
class Magnet(LoadRecord):
    """A magnetised rod, or a dipole in one of its sections or in a body, in a field: moment m × B and force ∇(m·B)."""

    example: ClassVar[str] = """\
[[loads]]
name = "coils"
kind = "magnet"
rod = "finger"
magnetisation = [0, 0, 8e4]     # along the rod; times the area of the section a moment per length
field = [0, 0.02, 0]
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "field": InputField("T", 3, axes="world"),
        "gradient": InputField("T/m", 3, polynomial=True, axes="world"),
        "moment": InputField("A m²", 3, axes="section"),
        "dipole.position": InputField("m", 3, axes="world"),
        "dipole.moment": InputField("A m²", 3, axes="world"),
    }
    references: ClassVar[Mapping[str, str]] = {"rod": "rods", "body": "bodies"}

    kind: Literal["magnet"] = Field(description="magnetised rod or dipole in a field")
    rod: str | None = Field(None, description="name of the rod that is magnetised, or that holds the dipole")
    body: str | None = Field(None, description="name of the body that holds the dipole; instead of rod")
    magnetisation: Polynomials | None = Field(
        None,
        description="magnetisation in section axes, A/m, or moment per length in A m for a rod given by its stiffness; "
        "a component may list Legendre coefficients in 2X − 1",
    )
    moment: Vector | None = Field(
        None, description="moment of a dipole in the axes of its section or body, A m²; instead of magnetisation"
    )
    at: Annotated[
        Number,
        above_base("a magnet on the base goes straight into the clamp: leave it out"),
        ABOVE_BASE,
    ] = Field(1.0, description="abscissa X of the section that holds the dipole, without unit, above 0 and at most 1")
    position: Vector = Field((0.0, 0.0, 0.0), description="point of the body that holds the dipole, in its axes, m")
    field: Vector | None = Field(None, description="field at the origin of the world, in its axes, T")
    gradient: Matrix3 | None = Field(
        None, description="rows ∂B_i/∂(x, y, z) in world axes, T/m; without sources symmetric and of trace zero"
    )
    dipole: Dipole | None = Field(None, description="a source whose field is added, world axes, m and A m²")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A magnet is in one place, has one moment, and is in a field."""
        yield from one_of("rod", "body", given)
        yield from one_of("magnetisation", "moment", given)
        if "body" in given and "magnetisation" in given:
            yield Fault(("magnetisation",), "is of a rod", "give the moment of the body's magnet, A m²")
        if "at" in given and "moment" not in given:
            yield Fault(("at",), "stands without moment", "a magnetised rod is magnetised along its whole length")
        if "at" in given and "body" in given:
            yield Fault(("at",), "is a section of a rod", "position is the point of a body")
        if "position" in given and "body" not in given:
            yield Fault(("position",), "is a point of a body", "at is the section of a rod")
        if not any(key in given for key in FIELDS):
            yield Fault(("field",), "missing", "give field, gradient or dipole")
        yield from _zero("moment", given, "a magnet without moment does nothing: leave the load out")
        yield from _zero("magnetisation", given, "a rod without magnetisation feels no field: leave the load out")
        yield from _too_strong(given)

    @classmethod
    def free_fields(cls, given: Table) -> tuple[str, ...]:
        """Fields that may be free: the field, and gradient, moment and source if the table has them."""
        fields = ["field", *(key for key in ("gradient", "moment") if key in given)]
        if "dipole" in given:
            fields += ["dipole.position", "dipole.moment"]
        return tuple(fields)


def _zero(key: str, given: Table, remedy: str) -> Iterator[Fault]:
    """The fault that all numbers under a key are zero."""
    value = list_of(given.get(key))
    if value and not any(_is_not_zero(component) for component in value):
        yield Fault((key,), "must not be zero", remedy)


def _is_not_zero(component: Any) -> bool:
    """Whether a component has a number that is not zero; faulty components have their own fault."""
    if isinstance(component, Mapping):
        return any(_is_not_zero(entry) for entry in component.values())
    if isinstance(component, list | tuple):
        return any(_is_not_zero(entry) for entry in component)
    return bool(component != 0)


def _too_strong(given: Table) -> Iterator[Fault]:
    """Faults of a field that is probably given in another unit than tesla."""
    for i, component in enumerate(list_of(given.get("field"))):
        if isinstance(component, int | float) and abs(component) > STRONGEST_FIELD:
            problem = f"must be at most {STRONGEST_FIELD:g} T, got {component:g}"
            yield Fault(("field", i), problem, "fields are in tesla: 1 mT is 1e-3, 1 G is 1e-4")
