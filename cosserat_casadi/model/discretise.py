"""Modes, nodes and element ends of every rod of a scene, and the richer discretisation that shows an answer's error.

The richer discretisation has the modes and intervals that an answer lacks: docs/theory.md, section 10.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import ceil
from typing import Any

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.element_ends import check_places, element_ends
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.rod.discretisation import Discretisation

DEFAULT_MODES = 6
"""Polynomials per strain component where neither the scene nor the caller gives them."""

DEFAULT_TRANSPORT = "magnus6"
"""Integration method of the rotation where neither the scene nor the caller gives one."""


ADDED_MODES = 3
"""Modes added to every strain: several, since an error may fall with every other mode alone."""

ADDED_MODES_IN_LAYERS = 6
"""Modes that are added where layers press a part of an element: the error falls with the third power of the modes."""

ADDED_NODES = 4
"""Intervals that are added to every element at least."""

NODES_ABOVE_MODES = 3
"""Intervals beyond the modes of a strain with which an error estimate by these modes is exact enough."""

NODES_ABOVE_MODES_IN_CONTACT = 8
"""Intervals beyond the modes of a strain where obstacles press on a few nodes: so short a push needs more of them."""

NODES_ABOVE_MODES_BESIDE_KINKS = 12
"""Intervals beyond the modes of a strain beside a kink in the pull of a cable, or in drag: their error falls slowly."""

NEXT_ORDER = {"magnus4": "magnus6", "magnus6": "magnus8"}
"""Rotation integrators of the next higher order, which show the error of the order itself."""

ENOUGH_GROWTH = {"magnus4": 1.7, "magnus6": 1.4, "magnus8": 1.3}
"""Factor on the intervals of the highest order, which shows seven eighths of the error of the order."""


def discretise(
    scene: scenes.Scene,
    modes: int | Sequence[int] | None = None,
    nodes: int | None = None,
    transport: str | None = None,
) -> dict[str, Discretisation]:
    """A discretisation for every rod: what the caller gives, else what the scene fixes, else a default.

    Args:
        scene: the scene.
        modes: polynomials per component and element, one number or one for each admitted strain.
        nodes: Chebyshev intervals per element.
        transport: integration method of the rotation.

    Raises:
        SceneError: the scene has tubes, or two places on a rod are too near each other to compute with.
    """
    refuse_tubes(scene)
    chosen = {}
    for rod in scene.rods:
        fixed = scene.accuracy.of_rod(rod.name)
        wanted_modes = modes if modes is not None else fixed.modes or DEFAULT_MODES
        modes_of_rod = (wanted_modes,) * len(rod.admitted) if isinstance(wanted_modes, int) else tuple(wanted_modes)
        intervals = nodes if nodes is not None else fixed.nodes or nodes_for(max(modes_of_rod))
        breaks = element_ends(scene, rod.name)
        check_places(rod.name, breaks)
        integrator = transport or fixed.rotation or DEFAULT_TRANSPORT
        fibres = fewest_fibres(rod) and (fixed.fibres or fewest_fibres(rod))
        chosen[rod.name] = Discretisation(modes_of_rod, intervals, breaks, integrator, fixed.sections or 0, fibres)
    return chosen


def fewest_fibres(rod: scenes.Rod) -> int:
    """Least points across half of a section at which the law of a rod is summed; 0 for a law that is not."""
    return 0 if rod.material is None else rod.material.fibres


def summed_at(chosen: Mapping[str, Discretisation], sections: int) -> dict[str, Discretisation]:
    """The discretisation of every rod, with at least this number of summed sections of layers in each element."""
    return {name: replace(own, sections=max(own.sections, sections)) for name, own in chosen.items()}


def with_more_fibres(chosen: Mapping[str, Discretisation], count: int = 1) -> dict[str, Discretisation]:
    """The discretisation of every rod, with further points for laws that are summed."""
    return {name: own.with_more_fibres(count) for name, own in chosen.items()}


def with_discretisation(scene: scenes.Scene, chosen: Mapping[str, Discretisation]) -> scenes.Scene:
    """The scene with modes, nodes and rotation fixed, so that :func:`discretise` returns this discretisation.

    A scene that leaves them open asks for its tolerance, written or not: with them fixed it still does.

    Args:
        scene: the scene.
        chosen: discretisation of every rod; elements end where the scene has them end.
    """
    numbers = {name: _described(own) for name, own in chosen.items()}
    first = next(iter(numbers.values()))
    counts = {len(own.modes) for own in chosen.values()}
    if len(counts) > 1 and not isinstance(first["modes"], int):
        # A list of modes has one number for each strain: it cannot serve rods with different numbers of strains.
        first = {**first, "modes": max(first["modes"])}
    others = tuple(scenes.RodDiscretisation(rod=name, **own) for name, own in numbers.items() if own != first)
    given = scene.accuracy.model_dump(by_alias=True, exclude_unset=True)
    given = {key: value for key, value in given.items() if key != "of_rods"} | first
    if others:
        given["of_rods"] = others
    if scene.accuracy.binds:
        given["tolerance"] = scene.accuracy.tolerance
    return scene.model_copy(update={"accuracy": scenes.Accuracy(**given)})


def _described(chosen: Discretisation) -> dict[str, Any]:
    """Keys of the scene format for a discretisation, with one number of modes if all strains have the same."""
    modes = chosen.modes[0] if len(set(chosen.modes)) == 1 else chosen.modes
    summed = {key: count for key in ("sections", "fibres") if (count := getattr(chosen, key))}
    return {"modes": modes, "nodes": chosen.nodes, "rotation": chosen.transport, **summed}


def nodes_for(modes: int) -> int:
    """Chebyshev intervals that resolve the shape of a rod whose strain has so many modes."""
    return 2 * modes + 2


def nodes_above_modes(scene: scenes.Scene, rod: str, *, touches: bool) -> int:
    """Intervals beyond the modes of a strain that show the error of a rod; ``touches``: whether it is in contact."""
    of_cables = any(actuator.rod == rod and actuator.has_kinks for actuator in scene.actuators)
    if of_cables or any(load.has_kinks_on(rod) for load in scene.loads):
        return NODES_ABOVE_MODES_BESIDE_KINKS
    return NODES_ABOVE_MODES_IN_CONTACT if touches else NODES_ABOVE_MODES


def enriched(
    discretisation: Discretisation, seeing_modes: int, above_modes: int, *, in_layers: bool = False
) -> Discretisation:
    """A discretisation with modes added to every strain, on intervals that resolve them.

    Args:
        discretisation: discretisation of a rod.
        seeing_modes: modes below which a rod cannot resolve the loads and strains along it.
        above_modes: intervals beyond the modes, of :func:`nodes_above_modes`.
        in_layers: whether layers press the rod.
    """
    added = ADDED_MODES_IN_LAYERS if in_layers else ADDED_MODES
    modes = tuple(max(count + added, seeing_modes) for count in discretisation.modes)
    nodes = max(discretisation.nodes + ADDED_NODES, max(modes) + above_modes)
    transport = discretisation.transport
    growth = ENOUGH_GROWTH.get(transport, 1.0) * discretisation.nodes
    if transport in NEXT_ORDER and nodes < growth:
        transport = NEXT_ORDER[transport]
    else:
        nodes = max(nodes, ceil(growth))
    return replace(discretisation.with_more_fibres(), modes=modes, nodes=nodes, transport=transport)
