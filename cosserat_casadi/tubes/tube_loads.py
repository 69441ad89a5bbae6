"""The loads of a scene of concentric tubes as numbers: the share of each input that every tube bears."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.numbers import Scalar, as_vector, is_symbolic, is_zero
from cosserat_casadi.rod.section import annulus

COMPONENTS = 3
"""Numbers of the input of a load: each is a vector."""


@dataclass(frozen=True)
class TubeLoad:
    """An input of a load: a vector, of which each tube bears a share.

    Attributes:
        name: name of the input, such as "push.force".
        shares: share of each tube: 1 for a wrench on it; for gravity its mass per length, kg/m, which may be an
            expression of parameters.
        is_moment: whether it is a moment, and not a force.
        spread: whether it acts per length from the plate to the tip, and not at the tip.
        follower: whether it turns with the tube, and does not keep its direction in the world.
        from_tip: distance of its point of action from the tip of its tube, along the tube, m.
    """

    name: str
    shares: tuple[Scalar, ...]
    is_moment: bool = False
    spread: bool = False
    follower: bool = False
    from_tip: Scalar = 0.0

    @property
    def has_energy(self) -> bool:
        """Whether the load has a potential, as a force of constant direction has."""
        return not self.is_moment and not self.follower

    @property
    def bearers(self) -> list[int]:
        """Indices of the tubes that bear it."""
        return [index for index, share in enumerate(self.shares) if not is_zero(share)]

    @property
    def is_beside_tip(self) -> bool:
        """Whether the load acts beside the tip, or a parameter may move it there."""
        return is_symbolic(self.from_tip) or self.from_tip > 0.0


def loads_of(scene: scenes.Scene) -> tuple[TubeLoad, ...]:
    """The inputs of the loads of a scene of tubes, in the order of the scene."""
    found: list[TubeLoad] = []
    for load in scene.loads:
        found += _inputs_of(load, scene.tubes)
    return tuple(found)


def _inputs_of(load: scenes.Load, tubes: Sequence[scenes.Tube]) -> Iterator[TubeLoad]:
    """The inputs of one load: the magnitudes that the scene gives."""
    if isinstance(load, scenes.Gravity):
        masses = tuple(linear_density(tube) if load.acts_on_rod(tube.name) else 0.0 for tube in tubes)
        yield TubeLoad(f"{load.name}.acceleration", masses, spread=True)
        return
    # The rules of the scene admit no other kinds beside tubes.
    assert isinstance(load, scenes.TipWrench | scenes.PointWrench | scenes.DistributedWrench)
    shares = tuple(float(tube.name == load.rod) for tube in tubes)
    from_tip: Scalar = 0.0
    if isinstance(load, scenes.PointWrench):
        length = sum(tube.length for tube in tubes if tube.name == load.rod)
        from_tip = (1.0 - load.at) * length
    for field in load.inputs:
        if field in load.model_fields_set:
            yield TubeLoad(
                name=f"{load.name}.{field}",
                shares=shares,
                is_moment=field == "moment",
                spread=isinstance(load, scenes.DistributedWrench),
                follower=load.frame == "body",
                from_tip=from_tip,
            )


def linear_density(tube: scenes.Tube) -> Scalar:
    """Mass per length of a tube, kg/m."""
    if tube.linear_density is not None:
        return tube.linear_density
    material = tube.material
    section = tube.section
    # The rules of the scene have seen to it that what is weighed has a mass.
    assert material is not None
    assert material.density is not None
    assert section is not None
    area: Scalar = annulus(as_vector([section.outer_radius]), as_vector([section.inner_radius])).area[0]
    return area * material.density
