"""Contact of rods with rods, or with themselves: smooth, or exact."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field, StrictBool

from cosserat_casadi.scene.faults import Fault, SceneTables, Table, refused_keys, table_of
from cosserat_casadi.scene.obstacle_records import without_exact_contact
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.rod_records import is_round
from cosserat_casadi.scene.values import Name, Names, NotNegative, Positive, Share

MOST_RODS = 2
"""Rods of a pair."""

SMOOTH_KEYS = ("width", "stiffness", "slip_speed")
"""Keys of smooth contact."""


class RodContact(Entry):
    """Two rods, or one rod and itself, that may not enter each other; rods without this table may."""

    example: ClassVar[str] = """\
[[rod_contacts]]
rods = ["finger"]
width = 5e-4
"""

    references: ClassVar[Mapping[str, str]] = {"rods": "rods"}

    name: Name | None = Field(None, description="name of the contact, a letter, then letters, digits and underscores")
    rods: Names | None = Field(
        None,
        description="names of two rods, or of one that touches itself; when left out, every two rods "
        "except those of which one starts on the other or that are joined to one body",
    )
    width: Positive | None = Field(
        None,
        description="gap from which on they push, smoothly, m; a fifth of the smallest radius of both when left out",
    )
    stiffness: Positive | None = Field(
        None,
        description="slope of the force per length against the gap, where the gap of parallel rods is "
        "zero, N/m²; "
        "30 EI/(L² width²) of the stiffer rod when left out",
    )
    friction: NotNegative = Field(
        0.0,
        description="coefficient μ of friction in motion, if smooth on paths too, without unit, in all directions",
    )
    slip_speed: Positive = Field(
        1e-3,
        description="with friction, smooth: speed, m/s, below which a contact that sticks creeps, under a "
        "force that grows with the speed",
    )
    exact: StrictBool = Field(
        False,
        description="whether rods touch without a width, which is found at rest, at points, and in motion",
    )
    restitution: Share = Field(
        0.0,
        description="with exact: speed after an impact over the speed of approach, without unit",
    )

    @property
    def coefficients(self) -> tuple[float, float, float]:
        """Coefficients of friction along the first rod, back, and across it: one number in all directions."""
        return (self.friction,) * 3

    @property
    def rubs(self) -> bool:
        """Whether there is friction."""
        return self.friction > 0.0

    @property
    def label(self) -> str:
        """Name of the contact in messages: its name, or else its rods."""
        if self.name is not None:
            return self.name
        if self.rods is None:
            return "rods on rods"
        return f"{self.rods[0]} on {self.rods[1] if len(self.rods) == MOST_RODS else 'itself'}"

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Refuse more than two rods."""
        rods = given.get("rods")
        if isinstance(rods, list | tuple) and len(rods) > MOST_RODS:
            problem = f"must be one rod or two, got {len(rods)}"
            yield Fault(("rods",), problem, "give a table for each pair, or leave rods out: every two rods then")
        exact = given.get("exact", False)
        if exact is False:
            problem = "describes impacts, which a smooth contact does not have"
            yield from refused_keys(given, ("restitution",), problem, "give exact = true, or leave it out")
        if exact is not True:
            return
        problem = "describes a smooth contact"
        yield from refused_keys(given, SMOOTH_KEYS, problem, "leave it out, or leave exact out")
        names = rods if isinstance(rods, list | tuple) else []
        if names and isinstance(names[0], str) and names.count(names[0]) == len(names):
            problem = "exact contact needs two rods, not one rod with itself"
            yield Fault(("exact",), problem, "leave it out: contact of a rod with itself is smooth")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of rods without a radius, of rods that always touch, and of obstacles beside them."""
        named = given.get("rods")
        known = scene.named("rods")
        listed = named if isinstance(named, list | tuple) else known
        names = [name for name in listed if isinstance(name, str) and name in known]
        for name in names:
            yield from _without_radius(name, known[name][1], given.get("width"))
        if isinstance(named, list | tuple) and len(names) == MOST_RODS and are_tied(names[0], names[1], _ties(scene)):
            problem = f"{names[0]!r} and {names[1]!r} are tied to each other, where they would always touch"
            yield Fault(("rods",), problem, "leave this pair out")
        if named is None and len(known) < MOST_RODS:
            problem = "missing: the scene has no two rods"
            yield Fault(("rods",), problem, "name the rod that touches itself, as in rods = ['finger']")
        exact = given.get("exact") is True
        if any(("width" not in other) is not exact for _, other in scene.tables("obstacles")):
            kinds = ("exact", "has a width") if exact else ("smooth", "is touched exactly")
            problem = "contact of rods is {}, and an obstacle of the scene {}".format(*kinds)
            remedy = "leave the width of each obstacle out" if exact else "give each obstacle a width, m"
            yield Fault((), problem, f"{remedy}, or leave one of the two out")
        if any((other.get("exact") is True) is not exact for _, other in scene.tables("rod_contacts")):
            problem = "is true for some pairs of rods, and not for all"
            yield Fault(("exact",), problem, "give it for all, or for none")
        if exact:
            for name in names:
                yield from without_exact_contact(name, known[name][1], "leave exact out, for a contact that is smooth")
                if name in scene.named("obstacles"):
                    problem = f"{name!r} is an obstacle too, so that contacts with either could not be told apart"
                    yield Fault((), problem, "give the obstacle another name")


def _without_radius(name: str, rod: Table, width: Any) -> Iterator[Fault]:
    """Faults of a rod that is not round, or not thicker than the width."""
    section = rod.get("section")
    if not isinstance(section, Mapping) or not is_round(section):
        problem = f"the rod {name!r} has no radius to keep"
        yield Fault((), problem, "take a round section, with a material")
        return
    radius = section.get("radius", section.get("outer_radius"))
    radii = radius if isinstance(radius, list | tuple) else [radius]
    numbers = [entry for entry in radii if isinstance(entry, int | float) and entry > 0]
    if numbers and isinstance(width, int | float) and width >= min(numbers):
        problem = f"must be < the radius of {name!r}, {min(numbers):g} m, got {width:g}"
        yield Fault(("width",), problem, "take a small part of the radius")


def _ties(scene: SceneTables) -> Iterator[tuple[Any, Any]]:
    """Pairs that are tied: rods with the rods that they start on, and with the bodies of their joints."""
    for name, (_, rod) in scene.named("rods").items():
        carrier = table_of(rod.get("base")).get("rod")
        if isinstance(carrier, str):
            yield name, carrier
    for _, joint in scene.tables("joints"):
        if isinstance(joint.get("body"), str):
            yield joint.get("rod"), ("body", joint["body"])


def are_tied(first: str, second: str, ties: Iterable[tuple[Any, Any]]) -> bool:
    """Whether two rods are tied to each other, or to a common rod or body."""
    held: dict[str, set[Any]] = {first: set(), second: set()}
    for one, other in ties:
        for rod, holder in ((one, other), (other, one)):
            if rod in held:
                held[rod].add(holder)
    return second in held[first] or bool(held[first] & held[second])
