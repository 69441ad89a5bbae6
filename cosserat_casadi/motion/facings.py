"""Pairs that may touch exactly in a motion: a rod or a body with an obstacle, and a rod with a rod."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import named_pairs
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.coincident_ends import watched_ends
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_sections import BodyFacing, RodFacing
from cosserat_casadi.motion.moving_points import MovingPoints, centre_of, nodes_of, nodes_of_both
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries
from cosserat_casadi.motion.rods_facing import RodsFacing


def facings(model: Model, libraries: Libraries = INTERPRETED) -> list[Facing]:
    """Make all pairs that may touch exactly: a rod or a body with an obstacle, and a rod with a rod.

    Args:
        model: the model, built for a motion.
        libraries: shared objects that contain the functions of :func:`touching_points`.
    """
    # Its functions are those of every motion of the model.
    kept: dict[Libraries, list[Facing]] = kept_with(model, "_facings", dict)
    if libraries not in kept:
        kept[libraries] = _facings(model, libraries)
    return kept[libraries]


def touching_points(model: Model, libraries: Libraries = INTERPRETED) -> list[MovingPoints]:
    """Points of all rods and bodies that may touch; an empty list without exact contact."""
    return points_of(facings(model, libraries))


def points_of(pairs: Sequence[Facing]) -> list[MovingPoints]:
    """Points of the given pairs, each rod's or body's once."""
    return list(dict.fromkeys(facing.points for facing in pairs))


def _facings(model: Model, libraries: Libraries) -> list[Facing]:
    found: list[Facing] = []
    exact = [obstacle for obstacle in model.scene.obstacles if not obstacle.is_smooth]
    for rod in model.scene.rods:
        concerned = [obstacle for obstacle in exact if obstacle.concerns(rod.name)]
        carriers = dict.fromkeys(obstacle.body for obstacle in concerned)
        seen_from = {carrier: nodes_of(model, rod.name, libraries, carrier) for carrier in carriers}
        for obstacle in concerned:
            ends = watched_ends(model, rod.name, obstacle)
            found.append(RodFacing(model, rod.name, obstacle, seen_from[obstacle.body], False, ends))
    for body in model.scene.bodies:
        concerned = [obstacle for obstacle in exact if obstacle.concerns_body(body.name)]
        if not concerned:
            continue
        points = centre_of(model, body.name, libraries)
        found += [BodyFacing(model, body.name, obstacle, points, True, body.ball_radius) for obstacle in concerned]
    for contact, rods in named_pairs(model.scene):
        if contact.exact:
            points = nodes_of_both(model, rods, libraries)
            # An end that is held does not move, and another rod may strike it.
            own, other = (RodFacing(model, rod, contact, points, False, (True, True)) for rod in rods)
            found.append(RodsFacing(model, own.owner, contact, points, False, own.watched_ends, other))
    return found
