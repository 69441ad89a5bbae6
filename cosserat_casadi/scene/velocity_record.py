"""Initial velocities of free bases, bodies and strains, for a motion that does not begin at rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import legendre
from pydantic import Field

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, list_of, refused_keys, shown, table_of
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.rod_records import STRAINS, admitted_strains
from cosserat_casadi.scene.values import Polynomials, Vector

STILL = (0.0, 0.0, 0.0)

OF_FRAMES = ("linear", "angular")
"""Keys of the velocity of a base or a body."""

OF_STRAINS = ("curvature_rate", "tangent_rate")
"""Keys of the rates of strains."""


class InitialVelocity(Entry):
    """Velocity of a free base or a body, and rates of the strains of a rod, at t = 0.

    Bases that are not named begin at rest. Bodies and carried bases that are not named move as their
    joints demand.
    """

    example: ClassVar[str] = """\
[[velocities]]
rod = "finger"
curvature_rate = [0, { base = 2.0, tip = 0.0 }, 0]
"""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods", "body": "bodies"}

    rod: str | None = Field(None, description="name of the rod that begins so; or body")
    body: str | None = Field(None, description="name of the body that begins so; or rod")
    linear: Vector = Field(STILL, description="velocity of the free base or of the body's origin, world axes, m/s")
    angular: Vector = Field(STILL, description="angular velocity of the free base or of the body, world axes, rad/s")
    curvature_rate: Polynomials = Field(
        STILL,
        description="rates of K_x, K_y, K_z, 1/(m s); a component may list Legendre coefficients in 2X − 1",
    )
    tangent_rate: Polynomials = Field(
        STILL, description="rates of Γ_x, Γ_y, Γ_z, 1/s; a component may list Legendre coefficients in 2X − 1"
    )

    @property
    def owner(self) -> str:
        """Name of the rod or body."""
        return self.body or self.rod or ""

    def strain_rates(self, X: FloatArray) -> FloatArray:
        """Rates of the six strains at abscissae X, shape (len(X), 6)."""
        components = (*self.curvature_rate, *self.tangent_rate)
        columns = [legendre.legval(2.0 * X - 1.0, np.atleast_1d(component)) for component in components]
        return np.stack(columns, axis=1)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A rod or a body, one of the two; a body has no strains."""
        if ("rod" in given) == ("body" in given):
            yield Fault((), "names a rod and a body, or neither", "give one of the two")
        if "body" in given:
            yield from refused_keys(given, OF_STRAINS, "a body has no strains", "leave it out")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of a held base, of a strain that the rod does not admit, or of a second velocity of an owner."""
        for key in ("rod", "body"):
            others = [table for _, table in scene.tables("velocities") if key in given and table.get(key) == given[key]]
            if len(others) > 1:
                yield Fault((key,), f"{shown(given[key])} has more than one initial velocity", "give one table for it")
        rod = scene.table_named("rods", given.get("rod"))
        if rod and table_of(rod.get("base")).get("free") is not True:
            problem = "the base of the rod is held, so that it has no initial velocity"
            yield from refused_keys(given, OF_FRAMES, problem, "move it by [[motions]], or set free = true")
        admitted = admitted_strains(rod.get("strain"))
        rates = [*_components(given, "curvature_rate"), *_components(given, "tangent_rate")]
        for index, (key, rate) in enumerate(rates):
            if admitted and index not in admitted and rate not in (0, 0.0, [0.0], [0]):
                yield Fault((key, index % 3), f"{STRAINS[index]} is a strain that the rod does not admit", "give 0")


def _components(given: Table, key: str) -> list[tuple[str, Any]]:
    """The three components of a key in the file; zeros if it does not have three."""
    rates = list_of(given.get(key))
    return [(key, rate) for rate in (rates if len(rates) == len(STILL) else STILL)]
