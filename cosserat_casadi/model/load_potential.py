"""Whether the loads of a scene have a potential."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load_trace import TracedLoad, has_potential
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import input_values, load_values
from cosserat_casadi.model.load_assembly import kernels_of, site_of
from cosserat_casadi.model.registry import EFFECTS


def loads_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether all loads of a scene have a potential at these inputs."""
    # What rubs remembers the way that it came.
    if discrete.layout.memory is not None:
        return False
    values = load_values(discrete.scene, discrete.layout, inputs)
    for load in discrete.loads:
        numbers = values.get(load.name, {})
        if not _has_potential_on_bodies(discrete, load, numbers):
            return False
        if not all(_has_potential_on_rod(discrete, rod, load, numbers) for rod in discrete.rods):
            return False
    return True


def _has_potential_on_bodies(
    discrete: DiscreteScene, load: scenes.LoadRecord, values: Mapping[str, FloatArray]
) -> bool:
    """Whether a load has a potential on the bodies that it acts on; it has on none."""
    member = EFFECTS[load.kind]
    if all(member.on_body(load, body) is None for body in discrete.scene.bodies):
        return True
    return has_potential(member, load, values, 0, one_axis=discrete.unloaded.all_in_parallel_planes)


def _has_potential_on_rod(
    discrete: DiscreteScene, rod: str, load: scenes.LoadRecord, values: Mapping[str, FloatArray]
) -> bool:
    """Whether a load has a potential on a rod, be it that it does not act there."""
    if not EFFECTS[load.kind].acts_on(load, rod):
        return True
    member = EFFECTS[load.kind]
    data_size = member.data(load, site_of(discrete, rod, load)).shape[0]
    return has_potential(member, load, values, data_size, one_axis=_turns_about_one_axis(discrete, rod))


def _turns_about_one_axis(discrete: DiscreteScene, rod: str) -> bool:
    """Whether all sections of a rod turn about one axis of the world; one that is carried about may not."""
    if discrete.unloaded.floating_base(rod) is not None and discrete.unloaded.plane(rod) is None:
        return False
    return len(discrete.rods[rod].properties.turning_axes) < 2


def is_dead_force(discrete: DiscreteScene, load: scenes.LoadRecord) -> bool:
    """Whether a load is a force of fixed direction and no moment, whatever its inputs: it has the energy −Σ f·r."""
    # Ones, since what the inputs may change need not stay zero; a moment that they may not change stores nothing.
    values = input_values(discrete.layout, load, ca.DM.ones(discrete.layout.size, 1))
    return all(_is_dead_force(kernel, values) for kernel in kernels_of(discrete, load, values))


def _is_dead_force(kernel: TracedLoad, values: Mapping[str, Matrix]) -> bool:
    # What depends on rates may be nothing at rest, and do work in motion.
    if kernel.follower or not kernel.pose_free or kernel.moving is not None:
        return False
    _, moment = kernel.coefficients(values)
    return moment is None
