"""Unions of discretisations, and scenes with fixed or open modes and nodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.discretise import discretise, with_discretisation
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.writing import scene_tables

Chosen = Mapping[str, Discretisation]
"""Discretisation of every rod."""


def union(several: Iterable[Chosen]) -> dict[str, Discretisation]:
    """The least discretisation of every rod that contains the modes and intervals of several discretisations."""
    first, *others = several
    joined = dict(first)
    for other in others:
        for name, own in joined.items():
            joined[name] = replace(union_of([own, other[name]]), breaks=own.breaks)
    return joined


def union_of(chosen: Sequence[Discretisation]) -> Discretisation:
    """The least discretisation that contains the modes and nodes of all; one number of modes if rods differ."""
    counts = {len(d.modes) for d in chosen}
    if len(counts) == 1:
        by_component = zip(*[d.modes for d in chosen], strict=True)
        modes = tuple(max(component) for component in by_component)
    else:
        modes = (max(max(d.modes) for d in chosen),)
    nodes = max(d.nodes for d in chosen)
    # Names of the Magnus methods sort by their order.
    transport = max(d.transport for d in chosen)
    sections, fibres = max(d.sections for d in chosen), max(d.fibres for d in chosen)
    return Discretisation(modes, nodes, transport=transport, sections=sections, fibres=fibres)


def unfixed(scene: scenes.Scene, tolerance: float) -> scenes.Scene:
    """The scene with an open discretisation and a tolerance."""
    return with_accuracy(
        scene,
        tolerance=tolerance,
        modes=None,
        nodes=None,
        rotation=None,
        sections=None,
        fibres=None,
        of_rods=None,
        chosen_for=None,
    )


def fixed_alike(scene: scenes.Scene, chosen: Discretisation) -> scenes.Scene:
    """The scene with all rods on one discretisation that was chosen for its tolerance."""
    modes: int | tuple[int, ...] = chosen.modes
    # One number suits rods that admit different strains too.
    if len(set(chosen.modes)) == 1:
        modes = chosen.modes[0]
    return with_accuracy(
        scene,
        tolerance=scene.accuracy.tolerance,
        modes=modes,
        nodes=chosen.nodes,
        rotation=chosen.transport,
        sections=chosen.sections or None,
        fibres=chosen.fibres or None,
        of_rods=None,
    )


def with_accuracy(scene: scenes.Scene, **changes: object) -> scenes.Scene:
    """The scene with other entries of its accuracy, read again; None removes an entry."""
    tables = scene_tables(scene)
    entries = tables.get("accuracy", {})
    entries = {**entries, **changes}
    tables["accuracy"] = {key: value for key, value in entries.items() if value is not None}
    # The scene is read again, so that the rules of the format apply here too.
    return scenes.scene_from_dict(tables)


def on_elements_of(scene: scenes.Scene, chosen: Chosen) -> dict[str, Discretisation]:
    """A discretisation with the element ends of a scene."""
    own = discretise(scene, 1, 2)
    return {name: replace(chosen[name], breaks=elements.breaks) for name, elements in own.items()}


def fixed_by_rod(scene: scenes.Scene, chosen: Chosen, ranges: Sequence[str]) -> scenes.Scene:
    """The scene with every rod's discretisation fixed, and the ranges that it was chosen for.

    A scene that fixes modes, nodes or rotation stays as it is.
    """
    if scene.accuracy.fixed:
        return scene
    return with_accuracy(with_discretisation(scene, chosen), chosen_for=list(ranges) or None)
