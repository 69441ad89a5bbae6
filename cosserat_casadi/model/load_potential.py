"""Whether the loads of a scene have a potential."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load_trace import has_potential
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import input_values, load_values
from cosserat_casadi.model.load_assembly import kernels_of, site_of
from cosserat_casadi.model.registry import EFFECTS


def loads_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether all loads of a scene have a potential at these inputs."""
    # Friction depends on the path, so it has no potential.
    if discrete.layout.memory is not None:
        return False
    values = load_values(discrete.scene, discrete.layout, inputs)
    for load in discrete.loads:
        numbers = values.get(load.name, {})
        member = EFFECTS[load.kind]
        if any(member.on_body(load, body) is not None for body in discrete.scene.bodies):
            one_axis = discrete.unloaded.all_in_parallel_planes
            if not has_potential(member, load, numbers, 0, one_axis=one_axis):
                return False
        if not all(_has_potential_on_rod(discrete, rod, load, numbers) for rod in discrete.rods):
            return False
    return True


def _has_potential_on_rod(
    discrete: DiscreteScene, rod: str, load: scenes.LoadRecord, values: Mapping[str, FloatArray]
) -> bool:
    """Whether a load has a potential on a rod, or does not act on it."""
    if not EFFECTS[load.kind].acts_on(load, rod):
        return True
    member = EFFECTS[load.kind]
    data_size = member.data(load, site_of(discrete, rod, load)).shape[0]
    # Sections turn about one axis of the world, unless a body carries the rod about.
    in_plane = discrete.unloaded.floating_base(rod) is None or discrete.unloaded.plane(rod) is not None
    one_axis = in_plane and len(discrete.rods[rod].properties.turning_axes) < 2
    return has_potential(member, load, values, data_size, one_axis=one_axis)


def is_dead_force(discrete: DiscreteScene, load: scenes.LoadRecord) -> bool:
    """Whether a load is, for all inputs, a force of fixed direction without moment, with the energy −Σ f·r."""
    # Ones, since inputs that are zero may change; a moment that no input changes stores no entries if it is zero.
    values = input_values(discrete.layout, load, ca.DM.ones(discrete.layout.size, 1))
    # A load that depends on rates may be zero at rest and do work in motion.
    return all(
        kernel.pose_free and not kernel.follower and kernel.moving is None and kernel.coefficients(values)[1] is None
        for kernel in kernels_of(discrete, load, values)
    )
