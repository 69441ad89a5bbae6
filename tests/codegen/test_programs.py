"""Parts that are too long for straight-line code: what alike legs share in loops, and what that costs."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise
from cosserat_casadi.codegen.blocks import INTERFACE, blocks
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.parts import Parted, parted
from cosserat_casadi.codegen.programs import partial_program
from cosserat_casadi.compiling.steps import program_of
from cosserat_casadi.maths.calls import with_dense_results
from tests.families import mostly_slow
from tests.scenes import rod, scene

ARGUMENTS = ["x", "inputs", "factor"]


def legs(count: int, first: str = "reissner") -> Model:
    """A platform on legs, each of its own length and at its own place, and alike but for the first's strains."""
    places = [[0.1 + 0.013 * i, 0.02 - 0.011 * i, 0.0] for i in range(count)]
    rods = [
        rod("reissner" if i else first, name=f"leg_{i}", base={"position": place}, length=0.4 + 0.01 * i)
        for i, place in enumerate(places)
    ]
    joints = [{"body": "hand", "rod": f"leg_{i}", "kind": "fixed", "position": place} for i, place in enumerate(places)]
    load = {"name": "load", "kind": "body_wrench", "body": "hand", "force": [0.2, 0.0, -0.3]}
    wanted = scene(load, rods=rods, bodies=[{"name": "hand", "mass": 0.1}], joints=joints)
    return build(wanted, discretise(wanted, 3, 6, "magnus4"), moving=True)


def motion(model: Model) -> tuple[ca.Function, list[int]]:
    """Entries of stiffness, damping and mass of state and inputs with their rates, and whose each is."""
    size, given = model.size, model.inputs.size
    state, inputs, factor = ca.MX.sym("state", 3 * size), ca.MX.sym("inputs", 3 * given), ca.MX.sym("factor")
    arguments = [state[k * size : (k + 1) * size] for k in range(3)]
    arguments += [inputs[k * given : (k + 1) * given] for k in range(3)]
    matrices = model.dynamics_jacobian.call(arguments)[:3]
    partition = blocks(model.discrete, matrices[0].sparsity() + matrices[1].sparsity() + matrices[2].sparsity())
    assert partition is not None
    owners = []
    for matrix in matrices:
        pairs = zip(*matrix.sparsity().get_triplet(), strict=True)
        owners += [max(partition.owners[i], partition.owners[j]) for i, j in pairs]
    entries = ca.vertcat(*[matrix.nz[:] for matrix in matrices])
    return ca.Function("motion", [state, inputs, factor], [entries], ARGUMENTS, ["entries"]), owners


@cache
def split(count: int) -> tuple[ca.Function, Parted]:
    function, owners = motion(legs(count))
    return function, parted(function, owners, "k")


def assert_whole(function: ca.Function, split: Parted) -> None:
    """The parts compute the whole, each entry once."""
    rng = np.random.default_rng(5)
    arguments = [rng.uniform(-0.5, 0.5, function.numel_in(i)) for i in range(function.n_in())]
    found = np.full(function.nnz_out(0), np.nan)
    for part in split.parts:
        read = [argument[entries] for argument, entries in zip(arguments, part.reads, strict=True)]
        assert np.all(np.isnan(found[part.entries]))
        found[part.entries] = split.kernels[part.kernel](*read, part.constants).full()[:, 0]
    expected = np.array(function(*arguments).nonzeros())
    assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


@pytest.mark.slow
def test_alike_legs_share_one_kernel_in_loops() -> None:
    function, made = split(3)
    assert_whole(function, made)
    long = [number for number, kernel in enumerate(made.kernels) if not kernel.is_a("SXFunction")]
    # The platform's own entries are short, and straight-line code.
    assert len(long) == 1
    assert len(made.kernels) == 2
    of_legs = [part for part in made.parts if part.kernel == long[0]]
    assert len(of_legs) == 3
    assert len({tuple(part.constants) for part in of_legs}) == 3
    # Each reads its own strains and multipliers, and the platform.
    assert all(len(part.x) < function.size1_in(0) / 2 for part in of_legs)


@pytest.mark.slow
def test_a_leg_that_is_different_has_a_kernel_of_its_own() -> None:
    function, owners = motion(legs(2, first="kirchhoff"))
    made = parted(function, owners, "k")
    assert_whole(function, made)
    long = [kernel for kernel in made.kernels if not kernel.is_a("SXFunction")]
    assert len(long) == 2


@pytest.mark.slow
def test_more_alike_legs_are_little_more_code() -> None:
    sizes = []
    for count in (2, 3):
        _, made = split(count)
        names = scene_names("legs", legs(count).scene)
        source = kernel_sources(made.kernels, names)["legs_kernels.c"]
        sizes.append(len(source))
    assert sizes[1] < 1.02 * sizes[0]


def test_parts_are_cut_entry_by_entry_where_a_step_is_for_all_rods() -> None:
    """A sum over all rows of an assembly is, in the part of one rod, that of its own rows."""
    x = ca.MX.sym("x", 40)
    whole = ca.Function("whole", [x], [ca.sin(x) + ca.vertcat(3 * x[:20], 5 * x[20:])], ["x"], ["entries"])
    program = program_of(whole)
    one, other = partial_program(program, range(20)), partial_program(program, range(20, 40))
    assert one.reads == [list(range(20))]
    assert other.reads == [list(range(20, 40))]
    assert one.key == other.key
    assert sum(step.instructions for step in one.steps) == 60


def test_a_function_of_scalars_that_is_too_long_is_one_part() -> None:
    """It has no steps: the whole is one kernel."""
    x, inputs, factor = ca.SX.sym("x", 30), ca.SX.sym("inputs"), ca.SX.sym("factor")
    result = x
    for k in range(1000):
        result = ca.sin(result) * (inputs + k)
    function = ca.Function("long", [x, inputs, factor], [result], ARGUMENTS, ["entries"])
    made = parted(function, [i % 2 for i in range(30)], "k")
    assert len(made.kernels) == len(made.parts) == 1
    assert_whole(function, made)


BUDGETS = {
    "kirchhoff, 8 intervals": ("kirchhoff", 4, 8, 6_000, 74_000, 95_000),
    "reissner, 8 intervals": ("reissner", 2, 8, 6_500, 66_000, 127_000),
}
"""Rods with 12 unknowns: operations of inverse dynamics and of the motion's Jacobian, bytes of its C in loops."""


@pytest.mark.parametrize("name", mostly_slow(BUDGETS, quick=["kirchhoff, 8 intervals"]))
def test_budgets_of_the_equations_of_motion(name: str) -> None:
    strain, modes, nodes, of_residual, of_jacobian, size = BUDGETS[name]
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.1, 0.0, 0.05]}
    wanted = scene(push, rods=[rod(strain, name="rod")])
    model = build(wanted, discretise(wanted, modes, nodes, "magnus4"))
    assert model.size == 12
    assert model.operations(model.inverse_dynamics) <= of_residual
    assert model.operations(model.dynamics_jacobian) <= of_jacobian
    kernel = with_dense_results(model.dynamics_jacobian, "of_motion")
    assert len(kernel_sources([kernel], scene_names("moving", wanted))["moving_kernels.c"]) <= size


def test_interface_entries_belong_to_no_rod() -> None:
    _, owners = motion(legs(2))
    assert set(owners) == {INTERFACE, 0, 1}
