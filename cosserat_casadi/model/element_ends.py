"""Ends of the elements of rods: a load, an actuator, a body, a disk or a carried rod makes a jump there.

A rod that turns many times is cut between these places too, since an element resolves only so many turns.

A parameter may move such a place. The elements that end there move with it: their number, modes and nodes stay those
of the scene's own numbers, so that the order of the places along a rod must stay as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.loads.rods_point import RodsPoint
from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import Scalar, as_vector, is_symbolic, known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.contact_layers import joined_ends, layer_ends
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.load_records import LoadRecord

NARROWEST = 1e-6
"""Length of an element, relative to the rod, below which its two ends count as one."""


CLOSEST = 1e-13
"""Distance of two places relative to the rod below which rounding makes the equations between them singular.

At 1e-12 a rod with a load at each of two places is still solved to its tolerance.
"""

LONGEST_TURN = 40 * np.pi
"""Largest angle, rad, through which sections turn along an element of an unloaded rod."""

MOST_TURNS = 1280
"""Largest number of turns of an unloaded rod: with more than 64 elements a solve takes minutes."""

SECTIONS_OF_TURN = 64
"""Sections of an element at which its unloaded curvature is summed."""


def places_on(scene: scenes.Scene, rod: str) -> list[Scalar]:
    """Abscissae of a rod at which an element must end, in the order of the scene; several may coincide."""
    places: list[Scalar] = []
    for record in scene.causes:
        member = EFFECTS[record.kind]
        if member.acts_on(record, rod):
            places.extend(member.breaks(record))
    # The wrench of a carried rod is a point load on its carrier, at which the internal wrench jumps.
    places.extend(carried.base.at for carried in scene.rods if carried.base.rod == rod)
    # The wrench of a body is a point load too.
    places.extend(joint.at for joint in scene.joints if joint.rod == rod and not joint.holds_base)
    places.extend(at for row in scene.disks if row.rod == rod for at in row.places)
    loads: Sequence[LoadRecord] = scene.loads
    for load in loads:
        if isinstance(load, RodsPoint):
            places.extend(at for name, at in zip(load.rods, load.places, strict=True) if name == rod)
    return places


def element_ends(scene: scenes.Scene, rod: str) -> tuple[float, ...]:
    """Abscissae of the element ends of a rod: its ends, the places on it, and the ends for contact and for coils."""
    asked_for = tuple(sorted({0.0, 1.0, *map(float, places_on(scene, rod))}))
    (record,) = [record for record in scene.rods if record.name == rod]
    return _cut_coils(record, joined_ends(asked_for, layer_ends(scene, record)))


def _cut_coils(record: scenes.Rod, ends: tuple[float, ...]) -> tuple[float, ...]:
    """Element ends with elements halved until none of the unloaded rod turns more than LONGEST_TURN.

    Raises:
        SceneError: the rod turns more than MOST_TURNS times.
    """
    turns = unloaded_turns(record, ends)
    if max(turns) <= LONGEST_TURN:
        return ends
    times = sum(turns) / (2 * np.pi)
    if not times <= MOST_TURNS:
        problem = f"turns the rod about {times:.3g} times; at most {MOST_TURNS} turns are resolved"
        raise SceneError(Problem(f"rods.{record.name}.intrinsic", problem, "curvature is in 1/m; or join shorter rods"))
    elements = zip(pairwise(ends), turns, strict=True)
    middles = [(start + end) / 2 for (start, end), turn in elements if turn > LONGEST_TURN]
    return _cut_coils(record, tuple(sorted([*ends, *middles])))


@lru_cache(maxsize=64)
def unloaded_turns(record: scenes.Rod, breaks: tuple[float, ...]) -> tuple[float, ...]:
    """Angle through which sections of an unloaded rod turn along each of its elements, summed, rad.

    Args:
        record: the rod, whose curvature is numbers.
        breaks: ends of its elements.
    """
    properties = rod_properties(record)
    points, weights = gauss_legendre(SECTIONS_OF_TURN)
    turns = []
    for start, end in pairwise(breaks):
        X = start + (end - start) * (points + 1) / 2
        curvature = np.linalg.norm(known(properties.intrinsic_curvature(X)), axis=1)
        turns.append(properties.length * (end - start) / 2 * float(weights @ curvature))
    return tuple(turns)


def check_places(rod: str, ends: Sequence[float]) -> None:
    """Refuse places on a rod that are so near each other that there is no element between them.

    Args:
        rod: name of the rod.
        ends: abscissae of its element ends, ascending.

    Raises:
        SceneError: two are closer than CLOSEST.
    """
    for before, after in pairwise(ends):
        if after - before < CLOSEST:
            problem = f"its elements would end at {before!r} and at {after!r}, too close to each other to compute with"
            remedy = "give parts that meet on the rod the same abscissa X, or move one"
            raise SceneError(Problem(rod, problem, remedy))


def check_discretisation(scene: scenes.Scene, discretisation: Mapping[str, Discretisation]) -> None:
    """Refuse a discretisation that does not fit the rods of a scene.

    Raises:
        SceneError: a rod has no discretisation, or one with other strains or elements; it lists all faults.
    """
    rods = {rod.name: rod for rod in scene.rods}
    names = ", ".join(rods)
    unknown = [name for name in discretisation if name not in rods]
    problems = [
        Problem(f"discretisation.{name}", "is no rod of the scene", f"its rods are {names}") for name in unknown
    ]
    remedy = "make it with discretise(scene)"
    for name, rod in rods.items():
        where = f"discretisation.{name}"
        if name not in discretisation:
            problems.append(Problem(where, "missing", remedy))
            continue
        own = discretisation[name]
        *whole, whole_nodes = (isinstance(count, int | np.integer) and count >= 1 for count in (*own.modes, own.nodes))
        if len(own.modes) != len(rod.admitted) or not all(whole):
            wanted = f"must be {len(rod.admitted)} numbers >= 1, whole ones, one for each strain, got {own.modes}"
            problems.append(Problem(f"{where}.modes", wanted, remedy))
        if not whole_nodes:
            problems.append(Problem(f"{where}.nodes", f"must be >= 1 and whole, got {own.nodes}", remedy))
        ends = {0.0, 1.0, *map(float, places_on(scene, name))}
        ascend = all(before < after for before, after in pairwise(own.breaks))
        if not ascend or not ends <= set(own.breaks) or (min(own.breaks), max(own.breaks)) != (0.0, 1.0):
            asked_for = ", ".join(f"{end:g}" for end in sorted(ends))
            problem = f"must ascend from 0 to 1, with element ends at {asked_for}, got {own.breaks}"
            problems.append(Problem(f"{where}.breaks", problem, remedy))
    refuse(problems)


def moved_ends(
    nominal: scenes.Scene, scene: scenes.Scene, rod: str, breaks: tuple[float, ...]
) -> tuple[Scalar, ...] | None:
    """Element ends of a rod in a scene with other numbers, or expressions; None if none has moved.

    Args:
        nominal: the scene that the elements were made for.
        scene: the scene with other numbers.
        rod: name of the rod.
        breaks: element ends of the rod in the nominal scene.
    """
    moved: dict[float, Scalar] = {}
    for before, after in zip(places_on(nominal, rod), places_on(scene, rod), strict=True):
        assert not is_symbolic(before)
        if is_symbolic(after) or after != before:
            moved[float(before)] = after
    if not moved:
        return None
    return tuple(moved.get(end, end) for end in breaks)


def unmovable(name: str, nominal: scenes.Scene, scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of a parameter that cannot move places along rods.

    Args:
        name: name of the parameter.
        nominal: the scene with its own numbers.
        scene: the scene with symbols for the numbers of this parameter alone.
    """
    for rod in nominal.rods:
        before = places_on(nominal, rod.name)
        after = places_on(scene, rod.name)
        for place, written in zip(before, after, strict=True):
            if not is_symbolic(written):
                continue
            together = [other for was, other in zip(before, after, strict=True) if was == place]
            if place in (0.0, 1.0):
                problem = f"is at the end X = {place:g} of {rod.name!r}, which does not move along it"
                yield Problem(name, problem, "give a place inside the rod, which is the default")
            elif not all(is_symbolic(other) and ca.is_equal(other, written) for other in together):
                problem = f"is at X = {place:g} of {rod.name!r}, where another part is that does not move with it"
                yield Problem(name, problem, "tie the two together, or give them places with an element between them")


@dataclass(frozen=True)
class MovingEnds:
    """The element ends of a rod as a function of the parameters p.

    Attributes:
        rod: name of the rod.
        names: parameters that move element ends.
        ends: p ↦ abscissae, shape (E + 1,).
    """

    rod: str
    names: tuple[str, ...]
    ends: ca.Function

    def faults(self, p: FloatArray) -> Iterator[Problem]:
        """Problems of the element ends for values of the parameters."""
        ends = self.ends(p).full()[:, 0]
        if np.all(np.diff(ends) >= NARROWEST):
            return
        places = ", ".join(f"{end:g}" for end in ends)
        problem = f"the elements of {self.rod!r} would end at X = {places}: places must keep their order along the rod"
        yield Problem(", ".join(self.names), problem, "build a scene with these places for another order")


def moving_ends(
    nominal: scenes.Scene, scene: scenes.Scene, symbol: ca.MX, names: dict[str, tuple[str, ...]]
) -> tuple[MovingEnds, ...]:
    """The element ends of each rod on which parameters move some.

    Args:
        nominal: the scene with its own numbers.
        scene: the scene with entries of the symbol as its parameters.
        symbol: p.
        names: parameters that move places, by rod.
    """
    moving = []
    for rod, own in names.items():
        ends = moved_ends(nominal, scene, rod, element_ends(nominal, rod))
        assert ends is not None, "parameters move them"
        moving.append(MovingEnds(rod, own, ca.Function("ends", [symbol], [as_vector(ends)])))
    return tuple(moving)
