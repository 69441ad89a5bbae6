"""How a function falls into parts: what is relied on of CasADi's instructions, and the example of the docstring."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise
from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.functions_in_c import functions_in_c
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernels
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.parts import in_one, parted, sharing
from cosserat_casadi.codegen.streams import Stream, same_but_for_rounding, shared
from tests.scenes import rod, scene


def function(expression: str) -> ca.Function:
    x, inputs, factor = ca.SX.sym("x", 5), ca.SX.sym("inputs", 2), ca.SX.sym("factor")
    names = {"x": x, "p": inputs, "factor": factor, "ca": ca}
    return ca.Function("f", [x, inputs, factor], [eval(expression, names)], ["x", "inputs", "factor"], ["entries"])


def test_values_of_the_example() -> None:
    stream, other = Stream(function("3*x[0] + x[4]")), Stream(function("5*x[1] + x[2]"))
    assert (stream.reads[:2], stream.constants) == ([[0, 4], []], [3.0])
    assert (other.reads[:2], other.constants) == ([[1, 2], []], [5.0])
    assert stream.key == other.key != Stream(function("3*x[0] - x[4]")).key


def test_casadi_writes_products_with_minus_one_and_two_and_quotients_of_one_as_operations_of_their_own() -> None:
    """Legs whose constants happen to be −1, 2 or 1 beside those of others must still have the same values."""
    keys = [Stream(function(f"({c})*x[0]")).key for c in ("-1", "2", "3.7")]
    assert keys[0] == keys[1] == keys[2]
    keys = [Stream(function(f"({c})/x[0]")).key for c in ("1", "3.7")]
    assert keys[0] == keys[1]


def test_one_constant_that_is_read_twice_is_two_constants() -> None:
    """Two constants of one leg may be equal by chance: CasADi has one of both then."""
    alike, apart = Stream(function("3*x[0] + 3*ca.sin(x[4])")), Stream(function("3*x[0] + 5*ca.sin(x[4])"))
    assert alike.key == apart.key
    assert (alike.constants, apart.constants) == ([3.0, 3.0], [3.0, 5.0])


def test_parts_that_differ_in_constants_share_a_kernel_and_compute_the_whole() -> None:
    whole = function("ca.vertcat(3*ca.sin(x[0]) + p[0]*factor, 2*ca.sin(x[4]) + p[1]*factor, x[1]*x[2])")
    split = parted(whole, [0, 1, 2], "k")
    assert [part.kernel for part in split.parts] == [0, 0, 1]
    assert [part.x for part in split.parts] == [[0], [4], [1, 2]]
    assert [part.constants for part in split.parts] == [[3.0], [2.0], []]
    x, inputs, entries = np.arange(1.0, 6.0), np.array([0.3, 0.7]), np.full(3, np.nan)
    for part in split.parts:
        kernel = split.kernels[part.kernel]
        entries[part.entries] = kernel(x[part.x], inputs[part.inputs], 0.4, part.constants).full()[:, 0]
    assert_allclose(entries, whole(x, inputs, 0.4).full()[:, 0], rtol=1e-15, atol=0)


def test_constants_that_differ_by_rounding_share_a_kernel_and_stay_in_its_code() -> None:
    """As a machine rounds them: of a one that is not quite one CasADi leaves no product out."""
    up = np.nextafter(1.0, 2.0)
    first = "1*x[0] + 0.3*ca.sin(x[1]) + 5*x[0]*x[1]"
    second = f"{up!r}*x[2] + {0.3 * up!r}*ca.sin(x[3]) + 7*x[2]*x[3]".replace("np.float64", "")
    whole = function(f"ca.vertcat({first}, {second})")
    split = parted(whole, [0, 1], "k")
    assert [part.kernel for part in split.parts] == [0, 0]
    assert [part.constants for part in split.parts] == [[5.0], [7.0]]
    x = np.arange(1.0, 6.0)
    expected = whole(x, [], 0.4).full()[:, 0]
    for part, value in zip(split.parts, expected, strict=True):
        found = split.kernels[0](x[part.x], [], 0.4, part.constants)
        assert_allclose(float(found), value, rtol=1e-15, atol=0)


def test_constants_are_rounded_beside_the_largest_number_that_a_call_takes_with_them() -> None:
    """Entries of a matrix that are zero but for rounding stay in the code; by itself such a number is an argument."""
    u, v = ca.SX.sym("u", 2), ca.SX.sym("v")
    product = ca.Function("product", [u, v], [u[0] * v + u[1]], {"never_inline": True})

    def leg(number: int, beside: float, alone: float) -> Stream:
        x = ca.SX.sym("x", 5)
        result = product(ca.vertcat(1000.0, beside), x[number]) + product(ca.vertcat(x[number], 1.0), alone)
        return Stream(ca.Function("leg", [x], [result], ["x"], ["entries"]))

    assert shared([leg(0, 1e-13, 3e-13), leg(1, 2e-13, 5e-13)], "k")[1] == [[3e-13], [5e-13]]
    assert shared([leg(0, 1e-9, 3.0), leg(1, 2e-9, 3.0)], "k")[1] == [[1e-9], [2e-9]]
    assert shared([leg(0, 1e-9, 3.0)], "k")[1] == [[]]


@pytest.mark.slow
def test_legs_of_any_length_share_one_kernel() -> None:
    """A stiffness of the equations is one, or one that is off by rounding, as the length of the leg has it."""
    lengths = (0.42, 0.43, 0.45, 0.44, 0.41, 0.46)
    places = [[0.1 * np.cos(angle), 0.1 * np.sin(angle), 0.0] for angle in np.arange(0.3, 6.0).tolist()]
    legs = [
        rod("reissner", name=f"leg_{i}", length=length, base={"position": place})
        for i, (length, place) in enumerate(zip(lengths, places, strict=True))
    ]
    joints = [{"body": "hand", "rod": f"leg_{i}", "kind": "fixed", "position": place} for i, place in enumerate(places)]
    wanted = scene(rods=legs, bodies=[{"name": "hand", "mass": 0.1}], joints=joints)
    model = build(wanted, discretise(wanted, 2, 4, "magnus4"))
    parts = assembled(model, scene_names("legs", wanted))
    assert parts is not None
    # One for the legs, one for what belongs to none of them.
    assert len(parts.residual.kernels) == 2
    assert len(parts.jacobian.kernels) == 2


def test_parts_that_call_functions_of_equal_counts_are_told_apart() -> None:
    """Three parts that differ in what they call alone; two of their callees compute the same."""
    a = ca.SX.sym("a")
    callees = [ca.Function("callee", [a], [scale * ca.sin(a)], {"never_inline": True}) for scale in (2, 3, 2)]
    x, inputs, factor = ca.SX.sym("x", 3), ca.SX.sym("inputs", 2), ca.SX.sym("factor")
    entries = ca.vertcat(*[callee(x[i]) for i, callee in enumerate(callees)])
    whole = ca.Function("f", [x, inputs, factor], [entries], ["x", "inputs", "factor"], ["entries"])
    split = parted(whole, [0, 1, 2], "k")
    assert [(part.kernel, part.entries) for part in split.parts] == [(0, [0]), (0, [2]), (1, [1])]
    for part in split.parts:
        found = split.kernels[part.kernel](np.array([0.3, 0.4, 0.5])[part.x], [], 1.0, part.constants)
        expected = whole([0.3, 0.4, 0.5], [0.0, 0.0], 1.0)[part.entries]
        assert_allclose(found.full(), expected.full(), rtol=1e-15, atol=0)


def straight(name: str, *expressions: str) -> ca.Function:
    """A function of two arguments, with zeros in its results."""
    x, scale = ca.SX.sym("x", 5), ca.SX.sym("scale")
    names = {"x": x, "scale": scale, "ca": ca}
    results = [ca.densify(eval(expression, names)) for expression in expressions]
    return ca.Function(name, [x, scale], results)


def test_kernels_that_compute_alike_call_one_function() -> None:
    zero = "ca.SX(1, 2)"
    alike = "ca.horzcat(3*ca.sin(x[0]) + 5*x[1], 0, scale)", zero
    also = "ca.horzcat(0, 7*ca.sin(x[3]) + 5*x[4], scale)", zero
    other = "ca.horzcat(x[2], x[2]**2, 0)", zero
    functions = [straight("a", *alike), straight("b", *also), straight("c", *other)]
    made = sharing(functions, functions, "shared")
    assert [function.name() for function in made] == ["a", "b", "c"]
    assert made[2] is functions[2]
    called = [function.find_functions() for function in made[:2]]
    assert [[callee.name() for callee in callees] for callees in called] == [["shared_0"], ["shared_0"]]
    x = np.arange(1.0, 6.0)
    for one, whole in zip(made, functions, strict=True):
        for found, expected in zip(one(x, 0.3), whole(x, 0.3), strict=True):
            assert found.sparsity().is_dense()
            assert_allclose(found.full(), expected.full(), rtol=1e-15, atol=0)


def test_one_column_whose_owners_compute_alike() -> None:
    whole = straight("whole", "ca.vertcat(x[1]*scale, 3*ca.sin(x[0]), x[2]*scale, 4*ca.sin(x[4]), x[3])")
    made = in_one(whole, [1, 0, 2, 0, 1], "made")
    x = np.arange(1.0, 6.0)
    assert_allclose(made(x, 0.3).full(), whole(x, 0.3).full(), rtol=1e-15, atol=0)


@pytest.mark.slow
def test_more_alike_legs_are_little_more_code() -> None:
    sizes = []
    for count in (2, 4):
        places = [[0.1 + 0.013 * i, 0.02 - 0.011 * i, 0.0] for i in range(count)]
        legs = [rod("reissner", name=f"leg_{i}", base={"position": place}) for i, place in enumerate(places)]
        joints = [
            {"body": "hand", "rod": f"leg_{i}", "kind": "fixed", "position": place} for i, place in enumerate(places)
        ]
        load = {"name": "load", "kind": "body_wrench", "body": "hand", "force": [0.2, 0.0, -0.3]}
        wanted = scene(load, rods=legs, bodies=[{"name": "hand", "mass": 0.1}], joints=joints)
        model = build(wanted, discretise(wanted, 2, 6, "magnus4"))
        names = scene_names("legs", wanted)
        functions = kernels(model, names, assembled(model, names))
        sizes.append(len(kernel_sources(functions, names)["legs_kernels.c"]))
        made = {function.name(): function for function in functions}
        rng = np.random.default_rng(count)
        for entry in functions_in_c(model, names):
            if entry.kernel not in made:
                continue
            given = [rng.uniform(0.1, 0.9, entry.function.size_in(i)) for i in range(entry.function.n_in())]
            for found, expected in zip(made[entry.kernel].call(given), entry.function.call(given), strict=True):
                scale = np.abs(expected.full()).max(initial=0.0)
                assert_allclose(found.full(), expected.full(), rtol=0, atol=1e-13 * scale)
    assert sizes[1] < 1.3 * sizes[0]


def test_constants_are_the_same_but_for_rounding_where_both_are_numbers() -> None:
    rounded = 1.0 + 2.0**-50
    assert same_but_for_rounding([1.0, np.inf, 0.0], [rounded, np.inf, -0.0])
    assert not same_but_for_rounding([1.0], [1.0 + 2.0**-40])
    for other in (1e300, -np.inf, np.nan):
        assert not same_but_for_rounding([np.inf], [other])
