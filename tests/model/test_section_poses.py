"""Poses of several sections of a rod against one at a time, and their derivatives against automatic ones."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise
from cosserat_casadi.model.section_poses import SectionPoses, section_weights
from cosserat_casadi.model.system import Arguments, System
from tests.codegen.libraries import ARMS, HAND, LOAD, WRISTS
from tests.scenes import WEIGHT, push, rod, scene

ABSCISSAE = (0.0, 0.3, 0.5, 0.71, 1.0)
TOUCH = {"name": "touch", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.1, 0.2, 0.0]}


def two_elements() -> Model:
    wanted = scene(push(), WEIGHT, TOUCH, strain="kirchhoff")
    return build(wanted, discretise(wanted, 3, 5))


def planar() -> Model:
    wanted = scene(push(), strain="planar")
    return build(wanted, discretise(wanted, 3, 5))


def reissner() -> Model:
    """A rod that shears and stretches, on a base that is turned."""
    base = {"position": [0.1, 0.2, 0.3], "tangent": [1, 0, 0]}
    wanted = scene(push(), rods=[rod("reissner", base=base)])
    return build(wanted, discretise(wanted, 2, 4))


def moving_place() -> Model:
    """The elements end at the place of a load, which is a parameter."""
    wanted = scene(push(), TOUCH, strain="kirchhoff", parameters=["touch.at", "rod.length"])
    return build(wanted, discretise(wanted, 2, 4))


def floating() -> Model:
    """The base of a rod moves with a body."""
    wanted = scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS)
    return build(wanted, discretise(wanted, 1, 3))


def literal() -> Model:
    wanted = scene(push(), strain="kirchhoff")
    return build(wanted, discretise(wanted, 2, 4, "permuted"))


@pytest.mark.parametrize("make", [two_elements, planar, reissner, moving_place, floating, literal])
def test_poses_and_derivatives(make: Callable[[], Model]) -> None:
    model = make()
    discrete = model.discrete
    name = list(discrete.rods)[-1]
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    p = discrete.parameters.symbol
    poses = SectionPoses(System(discrete, Arguments(x, inputs)), name, section_weights(discrete, name, ABSCISSAE))
    automatic = ca.jacobian(ca.vec(poses.stacked), x)
    function = ca.Function("poses", [x, inputs, p], [poses.stacked, poses.by_unknowns, automatic])
    at = [0.3 * np.random.default_rng(5).standard_normal(model.size), model.pack()]
    stacked, by_unknowns, by_casadi = function(*at, model.parameters.pack())
    given = [*at, model.parameters.pack()] if model.parameters.size else at
    one_by_one = [ca.vertcat(*model.shape[name](*given, X)) for X in ABSCISSAE]
    assert_allclose(stacked.full(), ca.horzcat(*one_by_one).full(), rtol=1e-12, atol=1e-13)
    assert_allclose(by_unknowns.full(), by_casadi.full(), rtol=1e-10, atol=1e-12)
