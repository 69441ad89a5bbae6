"""What a kernel is by its structure: how it is computed, and whether it has a potential."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.loads.load_trace import has_potential, stored, traced
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.inputs import scene_value
from cosserat_casadi.model.registry import EFFECTS
from tests.scenes import push, scene

Wrench = tuple[Matrix, Matrix]
Kernel = Callable[[Section, Mapping[str, Matrix]], Wrench]
NONE = ca.DM(3, 1)


class Written(Load):
    """A load whose wrench is handed in."""

    kind = "written"

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> Wrench:
        return load.kernel(section, values)


class Stored(Load):
    """An energy that does not depend on the rotation."""

    kind = "stored"

    def energy(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        return -ca.dot(values["v"], section.position)


def load(kernel: Kernel, frame: str = "world") -> SimpleNamespace:
    return SimpleNamespace(kernel=kernel, frame=frame)


def force(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return values["v"], NONE


def moment(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return NONE, values["v"]


def varying(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return section.data[0] * values["v"], NONE


def spring(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return values["v"] - section.position, NONE


def scaled_spring(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return ca.sumsqr(values["v"]) * section.position, NONE


def torque(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return NONE, ca.cross(section.rotation[:, 2], values["v"])


def cancelled(section: Section, values: Mapping[str, Matrix]) -> Wrench:
    return values["v"] + 0 * section.position, NONE


V = ca.DM([1.0, 2.0, 3.0])
CASES: list[tuple[Kernel, str, bool, bool]] = [
    (force, "world", True, True),
    (force, "body", True, True),
    (varying, "world", False, True),
    (spring, "world", False, False),
    (torque, "world", False, False),
    (cancelled, "world", True, True),
]


@pytest.mark.parametrize(("kernel", "frame", "pose_free", "fixed"), CASES)
def test_what_a_wrench_depends_on(kernel: Kernel, frame: str, pose_free: bool, fixed: bool) -> None:
    trace = traced(Written(), load(kernel, frame), {"v": V}, data_size=1)
    assert (trace.pose_free, trace.fixed) == (pose_free, fixed)
    assert trace.follower is (frame == "body")


POTENTIAL: list[tuple[Kernel, str, bool, bool]] = [
    (force, "world", False, True),
    (force, "body", False, False),
    (moment, "world", False, False),
    (moment, "world", True, True),
    (moment, "body", True, False),
    (varying, "world", False, True),
    (varying, "body", False, False),
    (spring, "world", True, False),
    (torque, "world", True, False),
]


@pytest.mark.parametrize(("kernel", "frame", "one_axis", "expected"), POTENTIAL)
def test_potential(kernel: Kernel, frame: str, one_axis: bool, expected: bool) -> None:
    written = load(kernel, frame)
    assert has_potential(Written(), written, {"v": np.array([[1.0], [0.0], [2.0]])}, 1, one_axis=one_axis) is expected


@pytest.mark.parametrize("kernel", [force, moment, varying, torque, scaled_spring])
def test_a_load_that_vanishes_has_a_potential(kernel: Kernel) -> None:
    for frame in ("world", "body"):
        assert has_potential(Written(), load(kernel, frame), {"v": np.zeros((3, 1))}, 1, one_axis=False)


def test_entries_that_are_zero_for_good_are_not_in_the_kernel() -> None:
    value = ca.sparsify(ca.DM([1.0, 0.0, 0.0]))
    trace = traced(Written(), load(force), {"v": value})
    assert stored({"v": value}).shape == (1, 1)
    assert trace.kernel.world_wrench.nnz_out(0) == 1
    assert trace.kernel.world_wrench.nnz_out(1) == 0
    given, none = trace.coefficients({"v": value})
    assert given is not None
    assert given.nnz() == 1
    assert none is None


def test_energy_gives_the_wrench_and_its_derivative() -> None:
    trace = traced(Stored(), load(force), {"v": V})
    assert not trace.pose_free
    turned = ca.DM([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    given = [ca.DM([0.1, 0.2, 0.3]), turned, ca.DM([1.0, 0.0, 0.0]), turned, stored({"v": V}), ca.DM.ones(2)]
    found, couple = trace.kernel.wrench(*given)
    assert_allclose(found.full(), (turned.T @ V).full(), rtol=0, atol=1e-15)
    assert_allclose(couple.full(), 0.0, rtol=0, atol=0)
    assert trace.kernel.stiffness.nnz_out(0) == 0
    assert trace.kernel.energy is not None
    assert_allclose(float(trace.kernel.energy(*given)), -float(ca.dot(V, ca.DM([0.8, 0.1, 0.3]))), rtol=1e-15, atol=0)


def test_a_kernel_is_made_once_for_what_it_depends_on() -> None:
    member = EFFECTS["tip_wrench"]
    (world,) = scene(push()).loads
    (again,) = scene(push()).loads
    (follower,) = scene(push(frame="body")).loads
    values = {"force": ca.DM.ones(3), "moment": ca.DM(3, 1)}
    kernel = traced(member, world, values).kernel
    assert traced(member, again, {"force": 2 * ca.DM.ones(3), "moment": ca.DM(3, 1)}).kernel is kernel
    assert traced(member, follower, values).kernel is not kernel
    assert traced(member, world, {"force": ca.DM.ones(3), "moment": ca.DM.ones(3)}).kernel is not kernel
    assert traced(member, world, values, 2).kernel is not kernel


def test_kernels_of_loads_with_expressions_are_not_kept() -> None:
    """Expressions belong to a model, and would hold it for good."""
    magnetised = {"name": "coils", "kind": "magnet", "rod": "rod", "magnetisation": [0, 0, 2.0], "field": [0, 0.02, 0]}
    (magnet,) = scene(magnetised).loads
    strength = ca.MX.sym("strength")
    values = {key: ca.DM(scene_value(magnet, key)) for key in magnet.inputs}
    found = []
    for magnetisation in ((0.0, 0.0, 2.0), (0.0, 0.0, strength)):
        written = magnet.model_copy(update={"magnetisation": magnetisation})
        first, second = (
            traced(EFFECTS["magnet"], written, {**values, "magnetisation[2]": strength}, 1) for _ in range(2)
        )
        found.append(first.kernel is second.kernel)
    assert found == [True, False]
