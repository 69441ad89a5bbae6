"""Displacements of a rod by the strain coordinates of each degree along a motion, and by missing ones, by a power law.

Errors of a motion fall with a power p of its number of modes. So all further coefficients of a strain with m modes
together move a rod by m/p times the displacement by the last one. See docs/theory.md, section 11.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.materials import BENDING
from cosserat_casadi.model.watched import watched_sections
from cosserat_casadi.motion.displacement import LEVER, displacements
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.tip_paths import watched_arms, watched_states
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.scene import Body, Scene

UNKNOWN_ORDER = 1.7
"""Power of the number of modes with which errors fall, before two distances determine it."""

ORDER_OF_WAVES = 2.3
"""Power with which errors by undamped waves of all lengths fall, after a sudden load or a blow."""

SAFETY = 1.5
"""Safety factor on the error that is extrapolated by a power."""

REST = SAFETY / UNKNOWN_ORDER
"""Displacement by all further coefficients, over the one by the last coefficient times their number."""

LAST = 3
"""One coefficient in so many counts as one of the last."""

AT_FRONT = 0.6
"""Missing displacement where a front arrives, over the displacement by the last coefficient times their number.

A strain that jumps by J errs by 0.6 J / n at the tip on n coefficients; its n-th one moves the tip by 0.3 J / n², or up
to three times as much once waves are dispersed. On few coefficients the ratio is larger by the factor 1 + 2 / n. It is
an upper bound for the rods of tests/motion/test_wave_estimates.py.
"""

LAST_AT_FRONT = 4
"""Most coefficients that count as the last ones at fronts, by the root of their mean square; at most half of all."""

ANGLES = np.pi * np.arange(1, 40) / 40.0
"""Angles θ of the sections of an element at which its impedance is evaluated."""

TWIST = 2
"""Index of the torsion among the strains."""

STRETCH = 5
"""Index of the extension among the strains."""

ROUNDING = 1e-12
"""Lever arm, over the length, that counts as rounding."""

TINY = float(np.finfo(float).tiny)
"""Addend that keeps the ratio of zero accelerations finite."""


ByStrain = dict[str, list[FloatArray]]
"""Numbers by degree of the coefficients, for each admitted strain of each rod, by the name of the rod."""


def told_by_modes(modes: int, others: int, order: float) -> float:
    """Upper bound of the error of a motion over its distance from one on other modes, for errors ~ modes^−order.

    The motion on other modes then has (modes / others)^order times the error of the motion.
    """
    others_error: float = (modes / others) ** order
    return SAFETY / abs(1.0 - others_error)


def most_modes(chosen: Mapping[str, Discretisation]) -> int:
    """Largest number of polynomials of a strain in an element, of all rods."""
    return max(max(discretisation.modes) for discretisation in chosen.values())


def felt(history: History, duration: float) -> ByStrain:
    """Largest displacement along a motion by the coefficients of each degree of each strain, over the length."""

    def moved() -> ByStrain:
        states = watched_states(history, duration)
        return _by_strain(history.model, np.abs(states.x).max(axis=0) * displacements(history.model))

    return history.once("felt", duration, moved)


def _by_strain(model: Model, sizes: FloatArray) -> ByStrain:
    """Sort displacements by each unknown, over the rod's length, shape (model.size,), by strain; elements' maxima.

    The displacements are multiplied by the factors of :func:`_factors`.
    """
    factors = kept_with(
        model, "_factors_of_strains", lambda: {name: _factors(model, name) for name in model.discrete.rods}
    )
    by_strain = {}
    for name, rod in model.discrete.rods.items():
        of_rod = sizes[model.discrete.unknowns.strain(name)]
        by_strain[name] = [
            factor * of_rod[columns].reshape(rod.grid.elements, -1).max(axis=0)
            for factor, columns in zip(factors[name], rod.columns.values(), strict=True)
        ]
    return by_strain


def _factors(model: Model, name: str) -> list[float]:
    """Ratio of the displacement of everything that goes along with a rod to that of the rod, by strain.

    It is relative to the length of the shortest rod that goes along, as each path is watched over its own rod's length.
    A twist moves everything that goes along in proportion to its distance from the axis.
    """
    rod = model.discrete.rods[name]
    inputs = model.pack()
    shortest = min(model.length(other, inputs) for other in moved_along(model.scene, name).rods)
    longer = model.length(name, inputs) / shortest
    return [arm_of_twist(model, name) / LEVER if strain == TWIST else longer for strain in rod.admitted]


class MovedAlong(NamedTuple):
    """Names of the rods and bodies that a strain of a rod moves."""

    rods: set[str]
    bodies: set[str]


def moved_along(scene: Scene, rod: str) -> MovedAlong:
    """Find the rods and bodies that a strain of a rod moves: the rod, rods that start on it, all joined to these."""
    moved: set[tuple[str, str]] = {("rod", rod)}
    ties = []
    for joint in scene.joints:
        rods = [joint.rod, *(end.rod for end in joint.between or ())]
        bodies = {("body", place.body) for place in joint.places if place.body}
        ties.append({("rod", name) for name in rods if name} | bodies)
    before = 0
    while len(moved) > before:
        before = len(moved)
        moved |= {("rod", one.name) for one in scene.rods if ("rod", one.base.rod) in moved}
        moved = moved.union(*(tie for tie in ties if tie & moved))
    return MovedAlong(*({name for kind, name in moved if kind == wanted} for wanted in ("rod", "body")))


def arm_of_twist(model: Model, name: str) -> float:
    """Lever arm, over lengths of watched rods, with which the twist of a rod counts; at least LEVER.

    It is the largest distance of the other rods, and of points of bodies, that go along from the axis of the unloaded
    rod; for a curved rod, from its tangents.
    """
    moved = moved_along(model.scene, name)
    if moved == MovedAlong({name}, set()):
        return LEVER
    places, tangents = _unloaded_axis(model, name)
    directions = tangents / np.linalg.norm(tangents, axis=1)[:, None]
    points = [np.empty((0, 3))]
    lengths_of = {rod: model.length(rod, model.pack()) for rod in model.discrete.rods}
    lengths = []
    for other in moved.rods - {name}:
        points.append(_unloaded_axis(model, other)[0])
        lengths += [lengths_of[other]] * len(points[-1])
    longest = max(lengths_of.values())
    for body in model.scene.bodies:
        if body.name in moved.bodies:
            start = model.discrete.own_unloaded.body_frame(body.name).start
            points.append(start.position + watched_arms(body, longest) @ start.rotation.T)
            lengths += [longest] * len(points[-1])
    offsets = np.concatenate(points)[:, None] - places
    distances = np.linalg.norm(np.cross(offsets, directions), axis=2).max(axis=1)
    return float(np.max(distances / np.array(lengths), initial=LEVER))


def _along_axis(model: Model, name: str, other: str) -> float:
    """Largest absolute cosine of the angle between tangents of two unloaded rods."""
    first, second = (_unloaded_axis(model, rod)[1] for rod in (name, other))
    sizes = np.outer(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    return float(np.max(np.abs(first @ second.T) / sizes))


def _unloaded_axis(model: Model, name: str) -> tuple[FloatArray, FloatArray]:
    """Positions and tangents r' of an unloaded rod at its nodes, world axes, m, shape (nodes, 3) each."""
    base = model.discrete.own_unloaded.base(name)
    rod = model.discrete.rods[name]
    own = shape(rod, ca.DM.zeros(rod.size))
    in_base = [ca.DM(vectors).full().T for vectors in (own.position, own.tangent)]
    return base.position + in_base[0] @ base.rotation.T, in_base[1] @ base.rotation.T


def last_of(moved: FloatArray) -> float:
    """Largest displacement by the last coefficients of a strain; at least two count, as one may vanish by symmetry."""
    return float(moved[-max(2, len(moved) // LAST) :].max())


def lacking(history: History, duration: float) -> float:
    """Estimate of the largest displacement along a motion by the missing coefficients of a strain, over the length.

    Args:
        history: the motion.
        duration: its end, s.
    """
    moved_by = felt(history, duration)
    further = 0.0
    for name, of_rod in moved_by.items():
        for let_through, moved in zip(_let_through(history.model, name), of_rod, strict=True):
            further = max(further, let_through * REST * len(moved) * last_of(moved))
    return further + history.once("late", duration, lambda: out_of_phase(history, duration, moved_by))


def lacking_at_fronts(history: History, duration: float) -> float:
    """Estimate of the displacement that is missing where a wave with a front arrives, over the length.

    The errors in all rods that a front passes add up in squares, as errors at different times do.
    """
    by_rod = at_fronts(history, duration)
    squares = dict.fromkeys(by_rod, 0.0)
    for name, by_strain in by_rod.items():
        for other in moved_along(history.model.scene, name).rods:
            squares[other] += max(by_strain) ** 2
    return float(np.sqrt(max(squares.values())))


def at_fronts(history: History, duration: float) -> dict[str, list[float]]:
    """Missing displacement at fronts, by rod and strain; zero for curvatures, whose fronts make no kinks.

    A sudden load sends fronts of twist, stretch and shear along a rod. When a front arrives at the tip, its rotation
    or position has a kink, where polynomials converge with the first power of their number. The distance of two
    motions says little there, because their kinks err at different times.
    """
    return history.once("fronts", duration, lambda: _at_fronts(history.model, felt(history, duration)))


def _at_fronts(model: Model, moved_by: ByStrain) -> dict[str, list[float]]:
    return {
        name: [
            0.0
            if strain in BENDING
            else AT_FRONT
            * (len(moved) + 2)
            * float(np.sqrt(np.mean(moved[-min(LAST_AT_FRONT, max(2, len(moved) // 2)) :] ** 2)))
            * _fronts_over_seen(model, name)[strain]
            * let_through
            for strain, moved, let_through in zip(rod.admitted, moved_by[name], _let_through(model, name), strict=True)
        ]
        for name, rod in model.discrete.rods.items()
    }


def _fronts_over_seen(model: Model, name: str) -> dict[int, float]:
    """:func:`front_over_seen` by strain, for strains whose fronts make kinks; kept with the model."""
    fronts: dict[str, dict[int, float]] = kept_with(model, "_fronts_over_seen", dict)
    if name not in fronts:
        # Positions are second integrals of the curvatures, so that their fronts make no kinks.
        strains = [strain for strain in model.discrete.rods[name].admitted if strain not in BENDING]
        fronts[name] = {strain: front_over_seen(model, name, strain) for strain in strains}
    return fronts[name]


def front_over_seen(model: Model, name: str, strain: int) -> float:
    """Missing displacement of a front at watched sections, over the one that coefficients tell; 1 for a uniform rod.

    A front keeps its power, so that it moves sections with a velocity proportional to Z^−1/2, with the impedance
    Z = √(stiffness · inertia per length): most where the rod is thin. Polynomials follow it late, by the time in which
    it passes a fixed share of an element. The displacement by this delay at a watched section is compared with the
    one at the place that coefficients resolve best. At X = (1 − cos θ)/2 of an element a step acts on them with the
    factor √(sin θ), the size of Legendre polynomials there: near a thin tip they show little of it.

    If the watched sections are thicker than others, the square root of the ratio is taken: on few modes fronts are
    blurred, and grow less on their way to thin sections. Rods that go along are watched too; a twist enters a rod at
    an angle by its component about the axis of that rod.

    Args:
        model: the model.
        name: name of the rod.
        strain: index of the twist, the stretch or a shear.
    """
    rod = model.discrete.rods[name]
    ends = np.array(rod.grid.known_places)
    widths = np.diff(ends)
    inside = (ends[:-1, None] + widths[:, None] * (1.0 - np.cos(ANGLES)) / 2.0).ravel()
    watched = watched_sections(model.scene, name)
    if model.discrete.unloaded.floating_base(name) is not None:
        watched = np.append(watched, 0.0)
    stiffness, inertia = _along(rod.properties, strain, np.concatenate([inside, watched]))
    if min(stiffness.min(), inertia.min()) <= 0.0:
        # Such a rod carries no waves.
        return 1.0
    velocity = (stiffness * inertia) ** -0.25
    for other in moved_along(model.scene, name).rods - {name}:
        properties = model.discrete.rods[other].properties
        ahead = _along(properties, strain, watched_sections(model.scene, other))
        if strain in model.discrete.rods[other].admitted and min(ahead[0].min(), ahead[1].min()) > 0.0:
            share = _along_axis(model, name, other) if strain == TWIST else 1.0
            velocity = np.append(velocity, share * (ahead[0] * ahead[1]) ** -0.25)
    late = np.repeat(widths, len(ANGLES)) * np.sqrt(inertia / stiffness)[: len(inside)]
    seen = velocity[: len(inside)] * late * np.tile(np.sqrt(np.sin(ANGLES)), len(widths))
    at_watched = np.sqrt(velocity[len(inside) :].max() * velocity.max())
    return float(at_watched * late.max() / seen.max())


def _let_through(model: Model, name: str) -> list[float]:
    """:func:`let_through_at_tip` for all strains of a rod; kept with the model."""
    known_of: dict[str, list[float]] = kept_with(model, "_let_through_at_tips", dict)
    if name not in known_of:
        known_of[name] = [let_through_at_tip(model, name, strain) for strain in model.discrete.rods[name].admitted]
    return known_of[name]


def let_through_at_tip(model: Model, name: str, strain: int) -> float:
    """Amplitude of a tip with a body over that of a free tip, for waves that the coefficients of a strain lack.

    A body of mass m ends a rod of impedance Z: by a wave of frequency ω it moves 1/√(1 + (ω m / Z)²) times as much as
    a free tip. The waves that n coefficients of an element lack have frequencies above n / T, with the time T in which
    a wave passes it. With the mass of a uniform element, Z T, the share is 1/√(1 + (n m / Z T)²). Of a twist m is a
    moment of inertia. For waves of bending ω m / Z is k m / ρA, with the wave number k ≥ n / ℓ; but the body turns by
    them: its points on a radius of gyration move by up to the root of that share.

    The ratio is 1 if anything else goes along with the rod, or if sections before its tip are watched.

    Args:
        model: the model.
        name: name of the rod.
        strain: index of the strain.
    """
    scene, discrete = model.scene, model.discrete
    riding = discrete.unloaded.riding
    at_tip = [
        body
        for body in scene.bodies
        if body.name in riding
        and scene.joints[riding[body.name]].rod == name
        and scene.joints[riding[body.name]].at == 1.0
    ]
    goes_along = MovedAlong({name}, {body.name for body in at_tip})
    floats = discrete.unloaded.floating_base(name) is not None
    if not at_tip or floats or moved_along(scene, name) != goes_along or watched_sections(scene, name)[0] < 1.0:
        return 1.0
    rod = discrete.rods[name]
    ends = np.array(rod.grid.known_places)
    inside = (ends[:-1, None] + np.diff(ends)[:, None] * (1.0 - np.cos(ANGLES)) / 2.0).ravel()
    stiffness, inertia = _along(rod.properties, STRETCH if strain in BENDING else strain, np.append(inside, 1.0))
    if min(stiffness.min(), inertia.min()) <= 0.0 and strain not in BENDING:
        return 1.0
    slowness = np.ones(len(inside) + 1) if strain in BENDING else np.sqrt(inertia / stiffness)
    widths = np.repeat(np.diff(ends), len(ANGLES))
    of_element = inertia[-1] / slowness[-1] * float((widths * slowness[:-1]).max()) * model.length(name, model.pack())
    heaviest = max(_inertia_at_tip(model, name, body, strain) for body in at_tip)
    count = rod.discretisation.modes[rod.admitted.index(strain)]
    share = of_element / np.hypot(of_element, count * heaviest)
    return float(np.sqrt(share) if strain in BENDING else share)


def _inertia_at_tip(model: Model, name: str, body: Body, strain: int) -> float:
    """Inertia of a body felt at a tip: moment over angular acceleration, kg m², or force over acceleration, kg.

    The body is free to rotate, so that it yields as much as it can; 0 if it has no inertia against the rotation.

    Args:
        model: the model.
        name: name of the rod whose tip carries the body.
        body: the body.
        strain: index of the twist, for a moment, or of the stretch or a shear, for a force.
    """
    start = model.discrete.own_unloaded.body_frame(body.name).start
    tip, tangent = (vectors[-1] for vectors in _unloaded_axis(model, name))
    along = tangent / np.linalg.norm(tangent)
    inertia = start.rotation @ body.inertia_matrix @ start.rotation.T
    if strain == TWIST:
        turned = along[None]
    else:
        pushed = along[None] if strain == STRETCH else np.eye(3) - np.outer(along, along)
        lever = tip - start.position - start.rotation @ np.asarray(body.centre_of_mass)
        turned = np.cross(lever, pushed)
    is_turned = bool(np.abs(turned).max() > ROUNDING * model.length(name, model.pack()))
    if is_turned and np.linalg.matrix_rank(inertia) < len(inertia):
        return 0.0
    turns = np.linalg.solve(inertia, turned.T).T if is_turned else np.zeros_like(turned)
    if strain == TWIST:
        return float(1.0 / np.linalg.norm(turns))
    if body.mass == 0.0:
        return 0.0
    return float(1.0 / np.linalg.norm(pushed / body.mass + np.cross(turns, lever), ord=2))


def _along(properties: RodProperties, strain: int, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness and inertia per length against a twist, a stretch or a shear at abscissae X, shape (k,) each."""
    stiffness = np.broadcast_to(known(properties.hooke(X)), (len(X), 6))[:, strain]
    if strain == TWIST and properties.rotary_inertia is not None:
        return stiffness, np.broadcast_to(known(properties.rotary_inertia(X)), (len(X), 3))[:, strain]
    if strain != TWIST and properties.linear_density is not None:
        return stiffness, np.broadcast_to(known(properties.linear_density(X)), len(X))
    return stiffness, np.zeros(len(X))


def out_of_phase(history: History, duration: float, moved_by: ByStrain) -> float:
    """Estimate of the largest displacement by waves that come too early or too late for want of modes, over the length.

    A frequency errs by half the square of the missing share of its mode shape. So the path length of the last
    coefficients, times half of their share, bounds the displacement by which a wave is late at the end. The share is
    taken from accelerations, in which short waves are not hidden by long and larger ones.

    No wave errs by more than twice its displacement l / s, if l is the displacement by its last coefficient and s the
    share of this one. So it errs by no more than min(2 l / s, s Θ l / 2) after the phase Θ, which is at most √Θ l for
    any share. The path length of the last coefficient is 2 Θ l / π.

    Args:
        history: the motion.
        duration: its end, s.
        moved_by: the displacements of :func:`felt`.
    """
    if not history.rows:
        return 0.0
    # Strains are the same in the coordinates of the steps; forces of contacts stand behind the unknowns of the model.
    own = slice(history.model.size)
    _, rates, accelerations = np.abs(np.concatenate([rows.ends[:, :, own] for rows in history.rows])).swapaxes(0, 1)
    # A motion that goes on had waves before: its lateness adds up.
    sizes = np.concatenate([rows.facts[:, 2] for rows in history.rows]) * duration / (duration - history.begin)
    ways = _by_strain(history.model, sizes @ rates * displacements(history.model))
    largest = _by_strain(history.model, accelerations.max(axis=0))
    late = 0.0
    for rod, of_rod in ways.items():
        let_through = _let_through(history.model, rod)
        for passed, way, acceleration, moved in zip(let_through, of_rod, largest[rod], moved_by[rod], strict=True):
            share = last_of(acceleration) / max(acceleration.max(), TINY)
            of_any_share = float(np.sqrt(0.5 * np.pi * last_of(way) * last_of(moved)))
            late = max(late, passed * min(0.5 * last_of(way) * share, of_any_share))
    return late
