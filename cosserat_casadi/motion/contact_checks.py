"""Checks of scenes with exact contact in motion, and of the depth of rods inside obstacles along a motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs
from cosserat_casadi.equilibrium.smooth_contact import depths_along
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.errors import Problem
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import named_pairs
from cosserat_casadi.motion.coincident_ends import meetings
from cosserat_casadi.motion.event_restart import LAID_DOWN
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.tip_paths import watched_states
from cosserat_casadi.scene.simulation import Simulation

THINNEST = 1e-3
"""Least sum of half the thickness of an obstacle and the radius of a section, over the length of the rod."""


MOST_ENDS = 400
"""Most ends of steps at which rods are checked; with more steps every second, third, … is checked."""

NOT_OF_RODS = "The computed motion of the discrete model is one that rods cannot make."
"""First sentence of the warning that a motion leads through an obstacle or a rod; more modes would not help."""

CLOSER = 17
"""Number of times, both ends included, at which a motion is checked again between two times with a barred way."""


def untouchable(model: Model, simulation: Simulation | None) -> Iterator[Problem]:
    """Problems of a scene with exact contact in motion: settings and parts of the scene that do not go with it.

    Args:
        model: the model.
        simulation: the settings; None for exported steps in C.
    """
    if simulation is not None and simulation.integrator == "gauss":
        yield Problem("simulation.integrator", "'gauss' does not converge for exact contact", "use 'radau'")
    remedy = "give each obstacle a width, m, for a contact that is smooth"
    yield from unfit_rods(model)
    yield from _too_thin(model)
    # Bodies that stand for rows of disks are rows again where the contact is smooth.
    disks = [body for body, _ in body_pairs(model.scene) if body.thickness is not None]
    for of_rows in (False, True):
        named = dict.fromkeys(disk.name for disk in disks if disk.stands_for_entry == of_rows)
        if named:
            what = (
                "only balls touch exactly in motion, since disks turn as they roll; these are disks: "
                f"{', '.join(named)}"
            )
            balls = "leave out their thickness, so that they are balls; or take [[disks]] and obstacles with a width, m"
            yield Problem("obstacles", what, remedy if of_rows else balls)


def unfit_rods(model: Model) -> Iterator[Problem]:
    """Problems of rods that touch rods exactly and whose ends coincide with others: that point would touch twice."""
    met = {end.rod for ends in meetings(model.scene) for end in ends}
    for contact, rods in named_pairs(model.scene):
        if contact.exact and met & set(rods):
            names = ", ".join(rod for rod in rods if rod in met)
            what = f"rods touch exactly only if their ends meet no end of another rod, and those of {names} do"
            yield Problem(f"rod_contacts.{contact.label}", what, "leave exact out, for a contact that is smooth")


def _too_thin(model: Model) -> Iterator[Problem]:
    """Problems of balls and bars so thin that a rod or body would turn about them in ever shorter steps."""
    met = []
    for rod, obstacle in pairs(model.scene):
        properties = model.discrete.rods[rod].properties
        own = float(section_radius(properties, np.array([0.0, 1.0])).min())
        met.append((obstacle, f"the section of {rod!r}", own, properties.length))
    for body, obstacle in body_pairs(model.scene):
        met.append(
            (obstacle, f"the ball of {body.name!r}", body.ball_radius, model.discrete.body_frame(body.name).length)
        )
    for contact, rods in named_pairs(model.scene):
        properties = [model.discrete.rods[rod].properties for rod in rods]
        thinnest = sum(float(section_radius(one, np.array([0.0, 1.0])).min()) for one in properties)
        least = THINNEST * properties[0].length
        if contact.exact and thinnest < least:
            what = f"the radii of both rods are {thinnest:.3g} m, below {least:.3g} m: too thin for a motion"
            remedy = "make them thicker, or leave exact out, for a contact that is smooth"
            yield Problem(f"rod_contacts.{contact.label}", what, remedy)
    for obstacle, whose, own, length in met:
        thinnest = obstacle.thickness / 2 + own
        least = THINNEST * length
        if thinnest < least:
            what = f"its radius with {whose} is {thinnest:.3g} m, below {least:.3g} m: too thin for a motion"
            yield Problem(f"obstacles.{obstacle.name}", what, "make it thicker, or give it a width, m")


def too_deep(history: History, duration: float) -> str:
    """Warning that a motion does not resolve its contact, rods being deeper than the width; empty otherwise."""
    if history.model.contact_depth is None:
        return ""
    times, x, inputs = watched_states(history, duration)
    depths = depths_along(history.model, x, inputs)
    worst = int(np.argmax(depths))
    if depths[worst] <= 1.0:
        return ""
    return (
        f"At t = {times[worst]:.6g} s a rod is {depths[worst]:.3g} widths deep inside an obstacle or a rod, too deep "
        "for contact: give the contact more width or stiffness."
    )


def told_passage(history: History, duration: float, model: Model | None = None) -> str:
    """Warning of rods that pass through smooth bars, balls or each other; empty if none does.

    The straight ways of sections between watched times and ends of steps are checked; where an obstacle bars one, the
    ways between closer times are.

    Args:
        history: the motion.
        duration: duration of the motion, s.
        model: the model of the motion with its parameters bound, if it has parameters.
    """
    barriers = SmoothBarriers(model or history.model)
    if not barriers.any:
        return ""
    ends = history.end_times
    times = np.union1d(watched_states(history, duration).times, ends[:: 1 + len(ends) // MOST_ENDS])
    for row in barriers.passages(*history.rough_positions(times)):
        closer = np.linspace(times[row], times[row + 1], CLOSER)
        if any(True for _ in barriers.passages(*history.rough_positions(closer))):
            return (
                f"Between t = {times[row]:.6g} and {times[row + 1]:.6g} s a rod or a body passes through an obstacle "
                "or a rod, or is deep inside: give their contact more width or stiffness, or take shorter steps."
            )
    return ""


def laid_down(history: History) -> list[str]:
    """Warnings of rods that were laid down because their contacts changed over and over, one for each obstacle."""
    times: dict[tuple[str, str], list[float]] = {}
    for event in history.events:
        if event.kind == LAID_DOWN:
            times.setdefault((event.owner, event.obstacle), []).append(event.time)
    return [
        f"Contacts of {owner!r} with {obstacle!r} changed over and over within almost no time ({len(found)} times, "
        f"first at t = {found[0]:.6g} s): the motion goes on with the rod lying on it there; the true motion may "
        "differ."
        for (owner, obstacle), found in times.items()
    ]


def told_inside(history: History, duration: float, deepest: float) -> str:
    """Warning of a section or a body inside an obstacle without a width, with time and place; empty otherwise.

    Args:
        history: the motion.
        duration: duration of the motion, s.
        deepest: depth over the length up to which a section touches.
    """
    if history.contacts is None:
        return ""
    times, x, inputs = watched_states(history, duration)
    found = [history.contacts.deepest(*state) for state in zip(x, inputs, strict=True)]
    number = int(np.argmax([one.depth for one in found]))
    worst = found[number]
    if worst.depth <= deepest:
        return ""
    what = f"the body {worst.owner!r}" if worst.of_body else f"the section X = {worst.place:.4g} of {worst.owner!r}"
    return (
        f"At t = {times[number]:.6g} s {what} is {worst.depth:.2g} of the length inside {worst.obstacle!r}, deeper "
        "than the tolerance: no contact was found there. Between the sections that touch, a lying rod sinks in less "
        "with more accuracy.modes."
    )
