"""A fluid around rods: drag of its stream, buoyancy, and added mass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, SceneTables, Table, shown
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LOADS, LoadRecord
from cosserat_casadi.scene.rod_records import is_round
from cosserat_casadi.scene.values import Names, NotNegative, Positive, Size, Vector


@LOADS.register
class Flow(LoadRecord):
    """A fluid round rods: drag −½ ρ d (C_n |v_n| v_n + π C_t |v| v_t) − ζ_n v_n − ζ_t v_t per length.

    v is the velocity relative to the stream.
    """

    example: ClassVar[str] = """\
[[loads]]
name = "stream"
kind = "flow"
rods = ["finger"]
density = 1000.0
velocity = [0.3, 0, 0]
gravity = [0, 0, -9.81]     # the finger floats by the weight of the water that it displaces
"""

    inputs: ClassVar[Mapping[str, InputField]] = {"velocity": InputField("m/s", 3, axes="world")}
    references: ClassVar[Mapping[str, str]] = {"rods": "rods"}

    kind: Literal["flow"] = Field(description="fluid round the rods")
    density: Positive = Field(description="density of the fluid, kg/m³")
    velocity: Vector = Field((0.0, 0.0, 0.0), description="velocity of the stream in world axes, m/s")
    normal: NotNegative = Field(1.1, description="drag coefficient C_n across the rod, without unit")
    tangential: NotNegative = Field(0.01, description="drag coefficient C_t along the rod, without unit")
    normal_resistance: NotNegative = Field(
        0.0, description="viscous drag across the rod per length and speed, ζ_n of resistive force theory, Pa s"
    )
    tangential_resistance: NotNegative = Field(
        0.0, description="viscous drag along the rod per length and speed, ζ_t, Pa s"
    )
    added_mass: NotNegative = Field(
        1.0,
        description="mass of fluid that moves along with the rod across its tangent, over the "
        "displaced mass, in motion, without unit",
    )
    gravity: Vector | None = Field(
        None,
        description="gravity in world axes, m/s², for the buoyancy of the displaced fluid; no buoyancy when left out",
    )
    diameter: Size | None = Field(
        None, description="diameter for the drag, m; the diameter of the section when left out"
    )
    rods: Names | None = Field(None, description="names of the rods in the fluid; all rods when left out")

    def has_kinks_on(self, rod: str) -> bool:
        """Whether drag may have a kink on this rod: it has one where the rod is along the stream."""
        return self.acts_on_rod(rod)

    def acts_on_rod(self, rod: str) -> bool:
        """Whether the rod of this name is in the fluid."""
        return self.rods is None or rod in self.rods

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of rods in the fluid without a diameter."""
        if "diameter" in given:
            return
        named = given.get("rods")
        for _, rod in scene.tables("rods"):
            if isinstance(named, list) and rod.get("name") not in named:
                continue
            section = rod.get("section")
            # A faulty section may have a diameter.
            without_shape = isinstance(section, Mapping) and "shape" not in section
            if not without_shape and not is_round(section):
                problem = f"missing: rod {shown(rod.get('name'))} has no round section"
                yield Fault(("diameter",), problem, "give the diameter that the stream sees, m")
                return
