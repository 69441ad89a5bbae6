"""Grids of one or several elements: exact on polynomials, with both sides of every break."""

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.testing import assert_allclose

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import known

BREAKS = [(0.0, 1.0), (0.0, 0.3, 1.0), (0.0, 0.125, 0.5, 0.9, 1.0)]
GRIDS = [Grid(breaks, N) for breaks in BREAKS for N in (1, 2, 5, 12)]
ALL_GRIDS = pytest.mark.parametrize("grid", GRIDS, ids=lambda g: f"{g.elements}x{g.intervals}")


def polynomials(grid, degree):
    """One polynomial for each element, not continuous at the breaks."""
    draw = np.random.default_rng((grid.elements, degree))
    return [Polynomial(draw.normal(size=degree + 1)) for _ in range(grid.elements)]


def element_numbers(grid):
    return np.repeat(np.arange(grid.elements), grid.intervals + 1)


def sampled(grid, pieces):
    return np.array([pieces[e](x) for e, x in zip(element_numbers(grid), grid.nodes, strict=True)])


def integral(grid, pieces, x, element):
    """∫₀ˣ of piecewise polynomials, x in the given element, in closed form."""
    ends = [*grid.breaks[: element + 1], x]
    return sum(p.integ()(b) - p.integ()(a) for p, a, b in zip(pieces, ends[:-1], ends[1:], strict=False))


@ALL_GRIDS
def test_nodes_vs_mapped_chebyshev_points(grid):
    local = chebyshev.nodes(grid.intervals)
    expected = [a + (b - a) * local for a, b in zip(grid.breaks, grid.breaks[1:], strict=False)]
    assert grid.size == grid.elements * (grid.intervals + 1) == len(grid.nodes)
    assert_allclose(grid.nodes.reshape(grid.elements, -1), expected, rtol=1e-15, atol=0)


@ALL_GRIDS
def test_element_ends_vs_breaks(grid):
    ends = grid.nodes.reshape(grid.elements, -1)
    assert_allclose(ends[:, 0], grid.breaks[:-1], rtol=0, atol=1e-16)
    assert_allclose(ends[:, -1], grid.breaks[1:], rtol=2e-16, atol=0)


@ALL_GRIDS
def test_weights_vs_one(grid):
    assert_allclose(grid.weights.sum(), 1.0, rtol=4e-16, atol=0)
    assert np.all(grid.weights > 0)


@ALL_GRIDS
def test_quadrature_vs_closed_form_on_piecewise_polynomials(grid):
    pieces = polynomials(grid, grid.intervals)
    expected = integral(grid, pieces, 1.0, grid.elements - 1)
    assert_allclose(grid.weights @ sampled(grid, pieces), expected, rtol=1e-13, atol=1e-14)


@ALL_GRIDS
def test_integration_matrix_vs_closed_form_on_piecewise_polynomials(grid):
    pieces = polynomials(grid, grid.intervals)
    places = zip(grid.nodes, element_numbers(grid), strict=True)
    expected = [integral(grid, pieces, x, e) for x, e in places]
    assert_allclose(grid.integration_matrix @ sampled(grid, pieces), expected, rtol=1e-12, atol=1e-14)


@ALL_GRIDS
def test_integrals_element_by_element_vs_the_matrix(grid):
    fields = np.random.default_rng(3).normal(size=(3, grid.size))
    assert_allclose(grid.integrated(ca.DM(fields)).full(), fields @ grid.integration_matrix.T, rtol=0, atol=1e-14)
    assert_allclose(
        grid.summed_by_integrals(ca.DM(fields)).full(), fields @ grid.integration_matrix, rtol=0, atol=1e-13
    )


@ALL_GRIDS
def test_last_row_of_integration_matrix_vs_weights(grid):
    assert_allclose(grid.integration_matrix[-1], grid.weights, rtol=1e-13, atol=1e-16)


@ALL_GRIDS
def test_interpolation_vs_piecewise_polynomials(grid):
    pieces = polynomials(grid, grid.intervals)
    X = np.random.default_rng(1).uniform(0, 1, 40)
    expected = [pieces[np.searchsorted(grid.breaks[1:-1], x)](x) for x in X]
    assert_allclose(grid.interpolation_matrix(X) @ sampled(grid, pieces), expected, rtol=1e-11, atol=1e-12)


@ALL_GRIDS
def test_interpolation_at_a_break_vs_the_side_of_the_base(grid):
    pieces = polynomials(grid, grid.intervals)
    X = np.array(grid.breaks[1:])
    expected = [p(x) for p, x in zip(pieces, X, strict=True)]
    assert_allclose(grid.interpolation_matrix(X) @ sampled(grid, pieces), expected, rtol=1e-12, atol=1e-13)


@ALL_GRIDS
def test_node_at_vs_the_last_node_of_its_element(grid):
    for e, x in enumerate(grid.breaks[1:]):
        node = grid.node_at(x)
        assert node == (e + 1) * (grid.intervals + 1) - 1
        assert_allclose(grid.nodes[node], x, rtol=2e-16, atol=0)


def test_node_at_vs_an_abscissa_that_is_no_break():
    with pytest.raises(ValueError, match="no element ends at"):
        Grid((0.0, 0.5, 1.0), 4).node_at(0.3)


@ALL_GRIDS
def test_intervals_vs_neighbouring_distinct_sections(grid):
    assert_allclose(grid.left_ends[1:], grid.right_ends[:-1], rtol=3e-16, atol=1e-16)
    assert len(grid.left_ends) == grid.elements * grid.intervals
    assert np.all(grid.right_ends > grid.left_ends)
    sections = np.append(grid.left_ends, 1.0)
    assert_allclose(sections[grid.section_of_node], grid.nodes, rtol=3e-16, atol=1e-16)


@ALL_GRIDS
def test_element_of_vs_comparison_with_breaks(grid):
    X = np.concatenate([np.linspace(0, 1, 33), grid.breaks])
    expected = [max(0, sum(x > b for b in grid.breaks[:-1]) - 1) for x in X]
    assert grid.element_of(X).tolist() == expected


@ALL_GRIDS
def test_mirrored_nodes_and_intervals_vs_reflected_abscissae(grid):
    def reflected(X):
        a, b = np.asarray(grid.breaks[:-1]), np.asarray(grid.breaks[1:])
        return ((a + b)[:, None] - X.reshape(grid.elements, -1)).ravel()

    assert_allclose(grid.nodes[grid.mirrored_nodes], reflected(grid.nodes), rtol=1e-14, atol=1e-15)
    assert_allclose(grid.left_ends[grid.mirrored_intervals], reflected(grid.right_ends), rtol=1e-14, atol=1e-15)


# Element ends elsewhere than the breaks.

MOVED = Grid((0.0, 0.3, 0.7, 1.0), 6, (0.0, 0.42, 0.55, 1.0))
THERE = Grid((0.0, 0.42, 0.55, 1.0), 6)


def test_a_moved_grid_vs_one_made_there():
    rates = known(MOVED.rates_in(MOVED.element_of_node))
    X = np.linspace(0, 1, 23)
    assert_allclose(MOVED.nodes, THERE.nodes, rtol=0, atol=1e-15)
    assert_allclose(MOVED.weights * rates, THERE.weights, rtol=1e-14, atol=0)
    assert_allclose(MOVED.integration_matrix * rates, THERE.integration_matrix, rtol=1e-13, atol=1e-16)
    assert_allclose(MOVED.interpolation_matrix(X), THERE.interpolation_matrix(X), rtol=1e-13, atol=1e-14)
    assert MOVED.node_at(0.42) == THERE.node_at(0.42)
    assert MOVED.nodes_in(0.42, 1.0).tolist() == THERE.nodes_in(0.42, 1.0).tolist()


def test_places_of_a_moved_grid_there_and_back():
    X = np.linspace(0, 1, 23)
    elements = MOVED.element_of(X)
    in_coordinate = MOVED.in_coordinate(X, elements)
    assert np.all(MOVED.element_of(X) == Grid(MOVED.breaks, 6).element_of(in_coordinate))
    assert_allclose(MOVED.on_rod(in_coordinate, elements), X, rtol=0, atol=1e-15)


def test_ends_that_are_expressions_vs_their_numbers():
    s = ca.MX.sym("s", 2)
    first, second = s[0], s[1]
    grid = Grid(MOVED.breaks, 6, (0.0, first, second, 1.0))
    values = ca.Function("values", [s], [grid.nodes, grid.rates])
    nodes, rates = values([0.42, 0.55])
    assert_allclose(nodes.full()[:, 0], THERE.nodes, rtol=0, atol=1e-15)
    assert_allclose(rates.full()[:, 0], MOVED.rates, rtol=1e-14, atol=0)
    assert grid.node_at(first) == THERE.node_at(0.42)
    assert grid.nodes_in(first, second).tolist() == THERE.nodes_in(0.42, 0.55).tolist()
    with pytest.raises(ValueError, match="no element ends at"):
        grid.node_at(0.42)


def test_fields_are_interpolated_where_element_ends_are_expressions() -> None:
    place = ca.MX.sym("place")
    sections = ca.MX.sym("sections", 6)
    moving = Grid((0.0, 0.4, 1.0), 5, (0.0, place, 1.0))
    nodal = ca.MX.sym("nodal", 2, moving.size)
    written = ca.Function("written", [nodal, place, sections], [moving.interpolated(nodal, sections)])
    fields = np.random.default_rng(3).standard_normal((2, moving.size))
    for end in (0.15, 0.4, 0.83):
        X = np.array([0.0, 0.1, end, np.nextafter(end, 1.0), 0.9, 1.0])
        fixed = Grid((0.0, 0.4, 1.0), 5, (0.0, end, 1.0))
        expected = fields @ fixed.interpolation_matrix(X).T
        assert_allclose(written(fields, end, X).full(), expected, rtol=0, atol=1e-13)
        assert_allclose(ca.DM(fixed.interpolated(ca.DM(fields), X)).full(), expected, rtol=0, atol=1e-15)
