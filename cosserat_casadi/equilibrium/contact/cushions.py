"""A rough guess of contacts: rods on coarse elements sink a little into cushions as the loads grow from zero.

The pressure of the cushions shows which stretches are held off, and how. A cushion is a soft obstacle, which grows with
the loads, so that a rod whose unloaded shape lies in an obstacle, as a straight rod in a bent lumen does, is pushed out
gradually.

A rod that is pushed, or jumps, beyond the middle of a cushion leaves it on the other side, to an equilibrium that is
out of its reach. So bars and balls are barriers, which rods and bodies must not pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, isfinite

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_state import TIP, ContactState, Touch, at_end
from cosserat_casadi.equilibrium.contact.gaps import (
    DENSE,
    body_gap,
    body_pairs,
    gap_along,
    gap_at,
    inner_radius,
    pairs,
    rod_pairs,
    runs,
)
from cosserat_casadi.equilibrium.contact.passing_through import (
    MIDDLE,
    LookedAt,
    ball_is_inside_between,
    is_inside_between,
)
from cosserat_casadi.equilibrium.load_path import input_path, load_path
from cosserat_casadi.equilibrium.relax import can_relax, relaxed
from cosserat_casadi.equilibrium.smooth_contact import contacts_of_rods
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import Penetration, section_radius
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.contact_pairs import SURFACE_STIFFNESS
from cosserat_casadi.model.element_ends import element_ends
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.numerics.continuation import ContinuationResult, ContinuationSettings, Path, follow
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.rod.discretisation import Discretisation

Values = Mapping[str, npt.ArrayLike] | None
"""Inputs by name."""

ELEMENTS = 10
"""Elements of every rod in addition to the elements that its loads ask for: pressure is not smooth."""

MODES = 3
NODES = 6

MODES_ALONE = 5
"""Modes of a rod that touches no obstacle and needs no elements for pressure."""

STIFFNESS = 1e6
"""First stiffness of a cushion, in units of EI/ℓ⁵."""

SHALLOW = 0.01
"""Depth, relative to the length, to which rods may sink into a cushion."""

BALL_STIFFNESS = 1e5
"""First stiffness of a cushion on a body, in units of EI/ℓ⁴: at the depth SHALLOW it pushes with 10 EI/ℓ²."""

THIN_BALL_FORCE = 40.0
"""Least stiffness times the square of the distance to the middle: at half this distance it pushes with 10 EI/ℓ²."""

CUSHION = 0.5
"""Width of the cushion between two rods, over the radius of the thinnest rod."""

THINNEST_CUSHION = 0.01
"""Least width of that, and least radius of the cushion of a bar or ball, over the length of the longest rod."""

LONG = 0.2
"""Length of a stretch of pressure above which a line of contact is tried before a point."""

THIN_FORCE = 37.0
"""Stiffness of the cushion of a thin bar times the cube of its radius, in units of EI/ℓ⁵ and ℓ.

A rod across the bar that has sunk in by half the radius is pressed over two radii, with ten times EI/ℓ².
"""

MOST_ELEMENTS = 20
"""Most elements of a rod beside a thin bar, which must not fit between two nodes."""

HARDER = 10.0
"""Factor on the stiffness of cushions that a rod would pass."""

MOST_STIFFENINGS = 3
"""Most rounds in which cushions are made stiffer for rods that sink in too deep."""


@dataclass(frozen=True)
class Pressure:
    """The pressure of a cushion on a stretch of a rod.

    Attributes:
        rod: name of the rod.
        obstacle: name of the obstacle.
        X: abscissae of the stretch, shape (k,).
        values: force per length there, shape (k,), any unit.
    """

    rod: str
    obstacle: str
    X: FloatArray
    values: FloatArray

    def touch(self) -> Touch:
        """The contact that the pressure suggests."""
        start, end = float(self.X[0]), float(self.X[-1])
        rises = np.diff(self.values) > 0
        falls = np.flatnonzero(~rises)
        first_peak = float(self.X[falls[0]]) if len(falls) else end
        at_tip = end == TIP
        if end - start > LONG:
            last_rise = np.flatnonzero(rises)
            last_peak = float(self.X[last_rise[-1] + 1]) if len(last_rise) else start
            line_end = TIP if at_tip else last_peak
            if line_end - first_peak > LONG / 2:
                return Touch.line(self.obstacle, self.rod, first_peak, line_end)
        place = float(self.X[np.argmax(self.values)])
        if not at_tip:
            place = float(self.X @ self.values / self.values.sum())
        return Touch.point(self.obstacle, self.rod, place)


def cushioned(scene: scenes.Scene, factor: float = 1.0) -> Model:
    """The scene with cushions as obstacles, on coarse elements; cushions on rods may be raised at each node.

    Args:
        scene: without contacts.
        factor: factor on the stiffness of the cushions.
    """
    cushions: list[Penetration] = []
    records = {rod.name: rod for rod in scene.rods}
    discretisation = {rod.name: _coarse(scene, rod) for rod in scene.rods}
    for number, (rod_name, obstacle) in enumerate(pairs(scene), start=1):
        record = records[rod_name]
        stiffness = _unit(record) * max(STIFFNESS, THIN_FORCE * _thinness(obstacle, record) ** 3) * factor
        nodes = (len(discretisation[rod_name].breaks) - 1) * (NODES + 1)
        cushion = Penetration.model_construct(
            name=f"cushion {number}", rod=rod_name, obstacle=obstacle, stiffness=stiffness, raised=((0.0,) * nodes,)
        )
        cushions.append(cushion)
    cushions += _cushions_of_bodies(scene, factor)
    soft = tuple(_softened(contact, scene, factor) if contact.exact else contact for contact in scene.rod_contacts)
    changes: dict[str, object] = {"loads": (*scene.loads, *cushions), "rod_contacts": soft}
    if scene.inputs is not None:
        names = [f"{cushion.name}.stiffness" for cushion in cushions]
        names += [f"{cushion.name}.raised" for cushion in cushions if cushion.rod is not None]
        changes["inputs"] = (*scene.inputs, *names)
    return build(scene.model_copy(update=changes), discretisation)


def _thickened(scene: scenes.Scene, values: Values) -> scenes.Scene:
    """The scene with thicker bars and balls in place of thin ones, through whose cushions rods would cut.

    An obstacle grows by half its distance from the unloaded rods and bodies at most, so that they stay outside it.
    """
    if not has_thin_obstacles(scene):
        return scene
    least = _least_radius(scene)
    model = cushioned(scene)
    rods = model.discrete.rods
    unloaded = Barriers(model, model.pack(values)).unloaded
    gaps = [(bar.name, rods[rod].length * gap_along(unloaded, rod, bar, DENSE).min()) for rod, bar in pairs(scene)]
    gaps += [(bar.name, gap_at(bar, body, unloaded.body(body.name))) for body, bar in body_pairs(scene)]

    def thick(obstacle: scenes.ObstacleRecord) -> scenes.ObstacleRecord:
        if obstacle.thickness >= 2 * least:
            return obstacle
        apart = min((gap for name, gap in gaps if name == obstacle.name), default=0.0)
        radius = min(least, (obstacle.thickness + max(apart, 0.0)) / 2)
        return obstacle.model_copy(update={"radius": float(radius)})

    return scene.model_copy(update={"obstacles": tuple(map(thick, scene.obstacles))})


def has_thin_obstacles(scene: scenes.Scene) -> bool:
    """Whether a scene has bars or balls that are thinner than their cushions may be."""
    return any(obstacle.thickness < 2 * _least_radius(scene) for obstacle in scene.obstacles)


def _least_radius(scene: scenes.Scene) -> float:
    """Least radius of a cushion, m."""
    return THINNEST_CUSHION * max(rod.length for rod in scene.rods)


def _softened(contact: scenes.RodContact, scene: scenes.Scene, factor: float) -> scenes.RodContact:
    """A contact of rods with a cushion: so wide that few sections are enough, and as soft as the softest rod."""
    least_radius = min(section_radius(rod_properties(rod), DENSE).min() for rod in scene.rods)
    longest = max(rod.length for rod in scene.rods)
    width = float(max(CUSHION * least_radius, THINNEST_CUSHION * longest))
    softest = min(_unit(rod) * rod.length**3 for rod in scene.rods)
    stiffness = factor * SURFACE_STIFFNESS * softest / width**2
    changes = {"exact": False, "width": width, "stiffness": stiffness, "friction": 0.0, "restitution": 0.0}
    return contact.model_copy(update=changes)


def _coarse(scene: scenes.Scene, rod: scenes.Rod) -> Discretisation:
    """Coarse elements of a rod, with nodes no farther apart than the thickness of the thinnest bar."""
    own = element_ends(scene, rod.name)
    meets_rods = any(rod.name in rods for rods in rod_pairs(scene))
    if not (meets_rods or any(obstacle.concerns(rod.name) for obstacle in scene.obstacles)):
        return Discretisation((MODES_ALONE,) * len(rod.admitted), NODES, own)
    # Element ends that are too close to an end that loads ask for are left out.
    thinnest = max((_thinness(obstacle, rod) for obstacle in scene.obstacles), default=0.0)
    # The ratio may be beyond all range: it is bounded before it becomes a whole number.
    elements = max(ELEMENTS, ceil(min(thinnest / (2 * NODES), MOST_ELEMENTS)))
    further = [end for end in np.linspace(0.0, 1.0, elements + 1) if np.abs(end - own).min() > 0.2 / elements]
    return Discretisation((MODES,) * len(rod.admitted), NODES, tuple(sorted([*own, *map(float, further)])))


def _cushions_of_bodies(scene: scenes.Scene, factor: float) -> Iterator[Penetration]:
    """The cushion of every obstacle on every body that it concerns, in units of the rods that hold it."""
    records = {rod.name: rod for rod in scene.rods}
    for number, (body, obstacle) in enumerate(body_pairs(scene), start=1):
        holding = [records[joint.rod] for joint in scene.joints if joint.rod and joint.body == body.name] or scene.rods
        unit = max(_unit(rod) * rod.length for rod in holding)
        length = max(rod.length for rod in holding)
        radius = body.ball_radius
        thinness = length / (obstacle.thickness / 2 + radius)
        yield Penetration.model_construct(
            name=f"cushion of body {number}",
            rod=None,
            body=body.name,
            radius=radius,
            thickness=body.thickness,
            obstacle=obstacle,
            stiffness=unit * max(BALL_STIFFNESS, THIN_BALL_FORCE * thinness**2) * factor,
        )


def _thinness(obstacle: scenes.ObstacleRecord, rod: scenes.Rod) -> float:
    """Length of a rod over the radius of a bar or ball that it must not pass; 0 for other obstacles."""
    if not obstacle.concerns(rod.name):
        return 0.0
    return 2 * rod.length / obstacle.thickness


def _unit(rod: scenes.Rod) -> float:
    """EI/ℓ⁵ of a rod, N/m⁴, the unit of force per length over the square of a depth and a length."""
    properties = rod_properties(rod)
    return properties.bending_stiffness / properties.length**5


def approach(scene: scenes.Scene, values: Values, progress: Progress | None = None) -> Solution:
    """Equilibrium of a scene on its cushions, which are so stiff that rods sink in only a little.

    Args:
        scene: without contacts.
        values: inputs by name.
        progress: receives the share of the load path that is done.
    """
    settings = ContinuationSettings()
    scene = _thickened(scene, values)
    found = _under_growing_loads(cushioned(scene), values, settings, progress)
    factor = HARDER
    while (
        not found.converged
        and Barriers(found.model, found.inputs).give_way(found.x)
        and factor <= HARDER**MOST_STIFFENINGS
    ):
        # The cushion of a thin bar has given way: a stiffer one may hold.
        found = _under_growing_loads(cushioned(scene, factor), values, settings, progress)
        factor *= HARDER
    model = found.model
    inputs = found.inputs
    if not found.converged and can_relax(model) and model.has_potential(inputs):
        # The rod snaps along the path: from the end of the path it relaxes to less energy.
        settled = relaxed(found, settings.newton, progress)
        if settled is not None and Barriers(model, inputs).are_between(found.x, settled.x):
            settled = None
        found = found if settled is None else settled
    stiffening = 0
    while found.converged and depth(found) > SHALLOW and stiffening < MOST_STIFFENINGS:
        # Pressure grows with the square of the depth.
        factor = (2 * depth(found) / SHALLOW) ** 2
        stiffer = inputs.copy()
        for entry, span in model.inputs:
            if entry.owner.startswith("cushion ") and entry.field == "stiffness":
                stiffer[span] *= factor
        end = follow(_guarded(model, inputs, input_path(model, found.x, inputs, stiffer)), settings, None)
        found = _judged(model, stiffer, end)
        inputs = stiffer
        stiffening += 1
    return found


def _under_growing_loads(
    model: Model, values: Values, settings: ContinuationSettings, progress: Progress | None
) -> Solution:
    """The end of the load path on cushions, on which no rod passes a bar or ball."""
    inputs = model.pack(values)
    end = follow(_guarded(model, inputs, load_path(model, inputs)), settings, progress)
    return _judged(model, inputs, end)


def _guarded(model: Model, inputs: FloatArray, path: Path) -> Path:
    """A path without steps through bars, balls and other rods."""
    barriers = Barriers(model, inputs)
    if not (barriers.watched or barriers.watched_bodies or model.discrete.pairs):
        return path
    return replace(path, admits=lambda before, after: not barriers.are_between(before[0], after[0]))


def _judged(model: Model, inputs: FloatArray, end: ContinuationResult) -> Solution:
    """The end of a path as a solution; an insufficient resolution by coarse elements is accepted."""
    return Solution(
        model,
        inputs,
        end.x,
        end.outcome,
        end.outcome.value,
        residual_norm=end.residual_norm,
        iterations=end.iterations,
        load_factor=end.reached,
    )


def depth(solution: Solution) -> float:
    """Largest depth of rods and bodies in obstacles, relative to their lengths."""
    of_rods = [float(-gaps.min()) for _, _, gaps in _all_gaps(solution)]
    of_bodies = [-body_gap(solution, body, obstacle) for body, obstacle in body_pairs(solution.model.scene)]
    return max([max(of_rods, default=0.0), *of_bodies])


def first_state(solution: Solution) -> ContactState:
    """The contacts that the pressure of cushions suggests."""
    touches = []
    for rod, obstacle, gaps in _all_gaps(solution):
        # The pressure of cushions is quadratic in the depth.
        pressed = [Pressure(rod, obstacle.name, DENSE[part], gaps[part] ** 2) for part in runs(gaps < 0.0)]
        touches += [pressure.touch() for pressure in pressed]
    return ContactState.of([*touches, *pressed_alone(solution)])


def pressed_alone(solution: Solution) -> Iterator[Touch]:
    """The contacts of bodies that have sunk into cushions, and of rods that press each other."""
    for contact in contacts_of_rods(solution):
        assert contact.on_rods is not None, "two rods"
        yield Touch.of_rods((contact.owner, contact.obstacle), (at_end(contact.on_rods[0]), at_end(contact.on_rods[1])))
    for body, obstacle in body_pairs(solution.model.scene):
        if body_gap(solution, body, obstacle) < 0.0:
            yield Touch.ball(obstacle.name, body.name)


def _all_gaps(solution: Solution) -> Iterator[tuple[str, scenes.ObstacleRecord, FloatArray]]:
    """Gaps of every rod to every obstacle that concerns it, along all of it."""
    for rod, obstacle in pairs(solution.model.scene):
        yield rod, obstacle, gap_along(solution, rod, obstacle, DENSE)


@dataclass(frozen=True)
class Barriers:
    """The bars and balls around which the unloaded rods of a model are outside.

    Attributes:
        model: of a scene with obstacles.
        inputs: stacked inputs, shape (model.inputs.size,).
    """

    model: Model
    inputs: FloatArray

    @cached_property
    def unloaded(self) -> Solution:
        """The unloaded rods."""
        return self._shape(self.model.unloaded())

    @cached_property
    def watched(self) -> list[tuple[str, scenes.ObstacleRecord]]:
        """Pairs of a rod and an obstacle that it must not pass; a rod that begins inside is pushed out to any side."""
        return [
            (rod, obstacle)
            for rod, obstacle in pairs(self.model.scene)
            if isfinite(obstacle.thickness) and gap_along(self.unloaded, rod, obstacle, DENSE).min() >= 0.0
        ]

    @cached_property
    def watched_bodies(self) -> list[tuple[scenes.Body, scenes.ObstacleRecord]]:
        """Pairs of a body and an obstacle that it must not pass."""
        return [
            (body, obstacle)
            for body, obstacle in body_pairs(self.model.scene)
            if isfinite(obstacle.thickness) and body_gap(self.unloaded, body, obstacle) >= 0.0
        ]

    def are_between(self, before: FloatArray, after: FloatArray) -> bool:
        """Whether a rod or body comes near the middle of one, or of a rod, on the way between shapes, by unknowns."""
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            start = self._looked_at[rod].positions(obstacle, before, self.inputs)
            end = self._looked_at[rod].positions(obstacle, after, self.inputs)
            if is_inside_between(obstacle, properties, start, end, self._deepest(rod, obstacle)):
                return True
        for body, obstacle in self.watched_bodies:
            length = self.model.discrete.body_frame(body.name).length
            pose = self.model.body[body.name]
            way = (pose(before, self.inputs)[0].full().T, pose(after, self.inputs)[0].full().T)
            if ball_is_inside_between(obstacle, inner_radius(body), length, *way, self._deepest_ball(body, obstacle)):
                return True
        if not self.model.discrete.pairs:
            return False
        return SmoothBarriers(self.model).are_between(before, after, (self.inputs, self.inputs))

    def give_way(self, x: FloatArray) -> bool:
        """Whether a rod or a body has sunk into an obstacle by more than half of the depth that is admitted.

        Two rods give way if they are inside each other: the cushion between them should keep them apart.
        """
        shape = self._shape(x)
        rods_sink = any(
            gap_along(shape, rod, obstacle, DENSE).min() < -self._deepest(rod, obstacle) / 2
            for rod, obstacle in self.watched
        )
        bodies_sink = any(
            body_gap(shape, body, obstacle) < -self._deepest_ball(body, obstacle) / 2
            for body, obstacle in self.watched_bodies
        )
        rods_meet = any((contact.gap or 0.0) < 0.0 for contact in contacts_of_rods(shape))
        return rods_sink or bodies_sink or rods_meet

    @cached_property
    def _looked_at(self) -> dict[str, LookedAt]:
        return {rod: LookedAt(self.model, rod) for rod, _ in self.watched}

    def _deepest(self, rod: str, obstacle: scenes.ObstacleRecord) -> float:
        """Admitted depth of a rod in an obstacle, over the length of the rod."""
        radius = obstacle.thickness / 2
        return MIDDLE * radius / self.model.discrete.rods[rod].properties.length

    def _deepest_ball(self, body: scenes.Body, obstacle: scenes.ObstacleRecord) -> float:
        """Admitted depth of a body in an obstacle, over the body's unit of length: its centre stays off the middle."""
        radii = obstacle.thickness / 2 + inner_radius(body)
        return MIDDLE * radii / self.model.discrete.body_frame(body.name).length

    def _shape(self, x: FloatArray) -> Solution:
        """The rods at unknowns x, which need not be an equilibrium."""
        return Solution(self.model, self.inputs, x, Outcome.CONVERGED, "", residual_norm=0.0, iterations=0)
