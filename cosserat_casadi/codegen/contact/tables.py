"""Tables of rods, obstacles and arrangements of contacts in C."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.codegen.contact.arrangements import Chosen
from cosserat_casadi.codegen.contact.kernels import RICHER_WORDS, touches_bodies, words_of
from cosserat_casadi.codegen.error_sources import turned_tables
from cosserat_casadi.compiling.c_tables import numbers, reals, record, record_table
from cosserat_casadi.equilibrium.blindness import TurnedElements
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations
from cosserat_casadi.equilibrium.contact.contact_state import TIP, Touch, is_sought
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs, rod_pairs
from cosserat_casadi.equilibrium.stability import variations
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import Richer
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.model.watched import watched_cables, watched_sections
from cosserat_casadi.rod.strain import DiscreteRod

POLYNOMIALS = {"legendre": chebyshev.legendre_polynomials, "chebyshev": chebyshev.chebyshev_polynomials}


@dataclass(frozen=True)
class _Level:
    """The arrangements at one level of modes.

    Attributes:
        prefix: prefix of the names of their tables.
        equations: equations of each arrangement.
        words: kernels of each arrangement.
    """

    prefix: str
    equations: Sequence[ContactEquations]
    words: Sequence[str]


@dataclass(frozen=True)
class Tables:
    """Tables of a scene and its arrangements, which the solver in C reads.

    Attributes:
        chosen: the arrangements.
        name: prefix of symbols.
    """

    chosen: Chosen
    name: str

    @property
    def rods(self) -> list[str]:
        """Names of the rods, in order."""
        return [rod.name for rod in self.chosen.scene.rods]

    @property
    def obstacles(self) -> list[str]:
        """Names of the obstacles, in order."""
        return [obstacle.name for obstacle in self.chosen.scene.obstacles]

    @property
    def owners(self) -> list[str]:
        """Names of the owners of contacts: the rods, then all bodies if any body may touch."""
        bodies = [body.name for body in self.chosen.scene.bodies]
        return [*self.rods, *(bodies if touches_bodies(self.chosen.scene) else [])]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Indices of owners of contacts with numbers of the obstacles, and of other rods, that they must not enter."""
        return [*self.pairs_with_obstacles, *self.pairs_of_rods]

    @property
    def pairs_with_obstacles(self) -> list[tuple[int, int]]:
        """Indices of the owners of contacts with the numbers of the obstacles that they must not enter."""
        scene = self.chosen.scene
        owners = [*pairs(scene), *((body.name, obstacle) for body, obstacle in body_pairs(scene))]
        return [(self.owners.index(owner), self.obstacles.index(obstacle.name)) for owner, obstacle in owners]

    @property
    def pairs_of_rods(self) -> list[tuple[int, int]]:
        """Indices of first rods, with the numbers of second rods, which stand in the place of obstacles."""
        rods = rod_pairs(self.chosen.scene)
        return [(self.rods.index(rod), self.touched(other, is_rod=True)) for rod, other in rods]

    def touched(self, name: str, *, is_rod: bool) -> int:
        """Number of an obstacle, or of another rod, which are counted behind the obstacles."""
        return len(self.obstacles) + self.rods.index(name) if is_rod else self.obstacles.index(name)

    def sizes(self, equations: ContactEquations) -> tuple[int, int, int]:
        """Count the unknowns, the forces and the places of an arrangement."""
        nominal = equations.nominal
        return nominal.model.size, len(nominal.force_units), len(equations.state.places)

    @property
    def largest(self) -> int:
        """Number of entries of the longest z."""
        return max(sum(self.sizes(equations)) for equations in self.chosen.equations)

    @property
    def _all(self) -> list[ContactEquations]:
        """The arrangements, followed by the arrangements on richer modes."""
        return [*self.chosen.equations, *self.chosen.richer]

    @property
    def largest_of_all(self) -> int:
        """Number of entries of the longest z, on richer modes too."""
        return max(sum(self.sizes(equations)) for equations in self._all)

    @cached_property
    def nodes_of_all(self) -> int:
        """Most nodes of all rods together."""
        counts = []
        for equations in self._all:
            rods = equations.nominal.model.discrete.rods.values()
            counts.append(sum(rod.grid.size for rod in rods))
        return max(counts) + len(self.owners) - len(self.rods)

    def text(self) -> str:
        """Write all tables of the library's contacts in C."""
        parts = [
            *(self._modes(level) for level in self._levels),
            self._rod_table(),
            self._pair_table(),
            *(
                self._arrangement(level, number, own)
                for level in self._levels
                for number, own in enumerate(level.equations)
            ),
            self._arrangement_table(),
            self._start(),
        ]
        return "\n".join(parts)

    @property
    def _levels(self) -> list[_Level]:
        """The level of modes of answers, and the richer level if errors are estimated."""
        levels = [_Level("", self.chosen.equations, words_of(self.chosen))]
        if self.chosen.richer:
            levels.append(_Level("RICHER_", self.chosen.richer, RICHER_WORDS))
        return levels

    def _modes(self, level: _Level) -> str:
        """Write the tables of modes and nodes of all rods."""
        lines = []
        entries = []
        for number, name in enumerate(self.rods):
            rod = level.equations[0].nominal.model.discrete.rods[name]
            suffix = f"{level.prefix}{number}"
            lines += [f"\n/* {name} */", *self._modes_of_rod(suffix, rod)]
            fields = {
                "intervals": rod.grid.intervals,
                "modes": f"MODES_{suffix}",
                "points": max(rod.discretisation.modes) + 2,
                "local_points": f"LOCAL_POINTS_{suffix}",
                "fits": f"FITS_{suffix}",
                "local_nodes": f"LOCAL_NODES_{suffix}",
                "barycentric": f"BARYCENTRIC_{suffix}",
            }
            entries.append(record(fields))
        return "\n".join([*lines, record_table("rod_modes", f"{level.prefix}ROD_MODES", "RODS", entries)])

    def _modes_of_rod(self, number: str, rod: DiscreteRod) -> list[str]:
        intervals = rod.grid.intervals
        modes = rod.discretisation.modes
        points = max(modes) + 2
        # Chebyshev points inside an element: a break belongs to neither side.
        local = (1 - np.cos(np.pi * (np.arange(points) + 0.5) / points)) / 2
        polynomials = POLYNOMIALS[rod.properties.basis]
        lines = [
            f"static const int MODES_{number}[] = {{{numbers(list(modes))}}};",
            reals(f"LOCAL_POINTS_{number}", local),
        ]
        inverses = {count: np.linalg.pinv(polynomials(count, local)) for count in sorted(set(modes))}
        lines += [reals(f"FIT_{number}_{count}", inverse.ravel()) for count, inverse in inverses.items()]
        fits = ", ".join(f"FIT_{number}_{count}" for count in modes)
        lines += [
            f"static const real *const FITS_{number}[] = {{{fits}}};",
            reals(f"LOCAL_NODES_{number}", chebyshev.nodes(intervals)),
            reals(f"BARYCENTRIC_{number}", chebyshev.barycentric_weights(intervals)),
        ]
        return lines

    def _rod_table(self) -> str:
        entries = []
        discrete = self.chosen.equations[0].nominal.model.discrete
        bodies = self.owners[len(self.rods) :]
        ranks = [*sorted(self.rods), *sorted(bodies)]
        for name in self.rods:
            rod = discrete.rods[name]
            radii = section_radius(rod.properties, np.array([0.0, 1.0])).tolist()
            fields = {
                "components": len(rod.discretisation.modes),
                "is_chebyshev": int(rod.properties.basis == "chebyshev"),
                "radius_at_base": repr(radii[0]),
                "radius_at_tip": repr(radii[1]),
                "length": repr(float(rod.properties.length)),
                "force_unit": repr(float(discrete.tension_unit(name))),
            }
            if self.chosen.judges_stability:
                fields["energy"] = repr(float(rod.energy_unit / self._largest_unit))
            entries.append(record({"rank": ranks.index(name), **fields}))
        radii_of_bodies = {body.name: body.ball_radius for body in self.chosen.scene.bodies}
        for name in bodies:
            fields = {
                "rank": ranks.index(name),
                "radius_at_base": repr(radii_of_bodies[name]),
                "radius_at_tip": repr(radii_of_bodies[name]),
                "length": repr(float(discrete.body_frame(name).length)),
                "force_unit": repr(float(discrete.contact_unit(name, of_body=True))),
            }
            entries.append(record(fields))
        return record_table("rod_entry", "ROD", "OWNERS", entries)

    @cached_property
    def _largest_unit(self) -> float:
        """Largest energy unit of the unknowns that vary, J."""
        return float(variations(self.chosen.equations[0].nominal.model).units.max())

    def roots(self, equations: ContactEquations) -> FloatArray:
        """Square root of the energy unit of each unknown, over the largest one; zero for multipliers and tensions."""
        allowed = variations(equations.nominal.model)
        roots = np.zeros(equations.nominal.model.size)
        roots[allowed.free] = np.sqrt(allowed.units / self._largest_unit)
        return roots

    @cached_property
    def varying(self) -> tuple[int, int, int]:
        """Sizes of one stability problem for all arrangements: unknowns that vary, constraints, most unknowns."""
        free, held, sizes = [], [], []
        for equations in self.chosen.equations:
            unknowns, forces, places = self.sizes(equations)
            free.append(int(np.count_nonzero(self.roots(equations))))
            held.append(unknowns - free[-1] + forces + places)
            sizes.append(unknowns)
        most = max(free)
        constraints = [own + most - varied for own, varied in zip(held, free, strict=True)]
        return most, max(*constraints, 1), max(sizes)

    @property
    def watched_counts(self) -> tuple[int, int]:
        """Numbers of the poses and of the cables whose errors are estimated."""
        discrete = self.chosen.equations[0].nominal.model.discrete
        sections = sum(len(watched_sections(self.chosen.scene, name)) for name in self.rods)
        return sections + len(discrete.bodies), len(watched_cables(discrete))

    def _pair_table(self) -> str:
        entries = []
        for owner, number in self.pairs:
            of_rods = number >= len(self.obstacles)
            fields = {
                "rod": owner,
                "obstacle": number,
                "distance": "0" if of_rods else f"{self.name}_k_distance_{number}",
            }
            entries.append(record(fields))
        return record_table("pair_entry", "PAIR", "PAIRS", entries)

    def _arrangement(self, level: _Level, number: int, equations: ContactEquations) -> str:
        lines = [f"\n/* {described(equations)} */"]
        model = equations.nominal.model
        elements = []
        first_node = 0
        for rod_number, name in enumerate(self.rods):
            discretisation = model.discretisation[name]
            rod = model.discrete.rods[name]
            suffix = f"{level.prefix}{number}_{rod_number}"
            places = self._places_of_ends(equations, name)
            lines.append(f"static const int PLACES_{suffix}[] = {{{numbers(places)}}};")
            lines.append(reals(f"NOMINAL_{suffix}", np.array(discretisation.breaks)))
            fields = {
                "elements": rod.grid.elements,
                "first_strain": model.discrete.unknowns.strain(name).start,
                "first_node": first_node,
                "place_of_end": f"PLACES_{suffix}",
                "nominal": f"NOMINAL_{suffix}",
            }
            elements.append(record(fields))
            first_node += rod.grid.size
        lines.append(record_table("rod_elements", f"ELEMENTS_{level.prefix}{number}", "RODS", elements))
        if self.chosen.judges_stability and not level.prefix:
            lines.append(reals(f"ROOTS_{number}", self.roots(equations)))
        if self.chosen.richer and not level.prefix:
            both = Richer(model.discrete, self.chosen.richer[number].nominal.model.discrete)
            lines.append(turned_tables(f"TURNED_{number}", TurnedElements(both), among_all=True))
        if equations.state.touches:
            lines.append(record_table("contact_entry", f"TOUCHES_{level.prefix}{number}", "", self._touches(equations)))
        return "\n".join(lines)

    def _places_of_ends(self, equations: ContactEquations, rod: str) -> list[int]:
        """Index of the place at each end of an element of a rod; −1 for a fixed end."""
        places: dict[float, int] = {}
        number = 0
        for touch in equations.state.touches:
            for owner, place in touch.sought:
                if owner == rod:
                    places[float(place)] = number
                number += 1
        return [places.get(end, -1) for end in equations.nominal.model.discretisation[rod].breaks]

    def _touches(self, equations: ContactEquations) -> list[str]:
        entries = []
        first_force = 0
        first_place = 0
        for touch in equations.state.touches:
            along = touch.moment_count(equations.nominal.modes[touch.owner]) if touch.is_line else 0
            fields: dict[str, object] = {
                "rod": self.owners.index(touch.owner),
                "obstacle": self.touched(touch.obstacle, is_rod=touch.other is not None),
                "is_line": int(touch.is_line),
                "ends": len(touch.ends),
                "moving": len(touch.moving),
                "first_force": first_force,
                "along": along,
                "first_place": first_place,
            }
            if self.chosen.scene.rods_touch_exactly:
                fields["held"] = _held(touch)
            entries.append(record(fields))
            first_force += len(touch.ends) + along
            first_place += len(touch.moving)
        return entries

    def _arrangement_table(self) -> str:
        """Write the table of arrangements, followed by those on richer modes in equal order."""
        entries = [self._entry(level, number) for level in self._levels for number in range(len(level.equations))]
        return "\n" + record_table("arrangement", "ARRANGEMENT", "", entries)

    def _entry(self, level: _Level, number: int) -> str:
        equations = level.equations[number]
        unknowns, forces, places = self.sizes(equations)
        touches = len(equations.state.touches)
        fields: dict[str, object] = {
            "size": unknowns + forces + places,
            "unknowns": unknowns,
            "strains": equations.nominal.model.discrete.unknowns.count(BlockKind.STRAIN),
            "forces": forces,
            "places": places,
            "touches": touches,
            "nodes_of_rods": sum(rod.grid.size for rod in equations.nominal.model.discrete.rods.values()),
            "touch": f"TOUCHES_{level.prefix}{number}" if touches else "0",
            "rods": f"ELEMENTS_{level.prefix}{number}",
            "modes": f"{level.prefix}ROD_MODES",
        }
        if self.chosen.judges_stability and not level.prefix:
            fields["roots"] = f"ROOTS_{number}"
        if self.chosen.richer and not level.prefix:
            fields["turned"] = f"&TURNED_{number}"
        for word in level.words:
            fields[word] = f"{self.name}_k_{level.prefix.lower()}{number}_{word}"
        return record(fields)

    def _start(self) -> str:
        given = self.chosen.given.tolist() or [0.0]
        lines = [
            "\n/* The solution of the scene's own inputs. */",
            f"enum {{ START_ARRANGEMENT = {self.chosen.start} }};",
            reals("START_Z", self.chosen.z),
            reals("START_INPUTS", np.array(given)),
        ]
        return "\n".join(lines)


def _held(touch: Touch) -> str:
    """Places of a contact of two rods, and -1 in the stead of one that is sought."""
    places = (0.0, 0.0) if touch.other is None else (touch.start, touch.other)
    return "{" + numbers([-1.0 if is_sought(place) else float(place) for place in places]) + "}"


def described(equations: ContactEquations) -> str:
    """Say in words who touches what in an arrangement."""
    words = []
    for touch in equations.state.touches:
        if touch.other is not None:
            words.append(f"{_section(touch.start)}{touch.owner} touches {_section(touch.other)}{touch.obstacle}")
            continue
        where = "at its tip" if touch.reaches_tip else "at a point"
        if touch.is_line:
            where = "along a line to its tip" if touch.reaches_tip else "along a line"
        words.append(f"{touch.owner} touches {touch.obstacle} {where}")
    return ", ".join(words) or "no contact"


def _section(place: float) -> str:
    """Words for the place of a contact on one of two rods, before the name of the rod."""
    if is_sought(place):
        return "a section of "
    return "the tip of " if place == TIP else "the base of "
