"""Strain reduction against its definition: B and B̄, polynomials, stiffness, for every set of admitted strains."""

from itertools import combinations

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre
from numpy.testing import assert_allclose
from rods import CURVED, HOOKE, coordinates, element_strain, rod, strain_basis, tapered, uniform
from scipy.integrate import quad_vec

from cosserat_casadi.rod.properties import STRAINS

SUBSETS = [s for count in range(1, 7) for s in combinations(range(6), count)]
NAMES = ["".join(map(str, s)) for s in SUBSETS]
VANDER = {"legendre": legendre.legvander, "chebyshev": chebyshev.chebvander}
POLYNOMIALS = pytest.mark.parametrize("polynomials", VANDER)
BREAKS = pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.3, 1.0), (0.0, 0.25, 0.5, 1.0)])
INNER = np.linspace(0.01, 0.99, 23)


def intrinsic(X):
    return np.stack([legendre.legval(2 * X - 1, np.array(c)) * np.ones_like(X) for c in CURVED])


def test_number_of_subsets_vs_two_to_the_sixth():
    assert len(SUBSETS) == 63
    assert len(STRAINS) == 6


@pytest.mark.parametrize("admitted", SUBSETS, ids=NAMES)
def test_strain_vs_selection_matrices(admitted):
    """ξ = B (ξ_a⁰ + Φ q) + B̄ ξ_c with B and B̄ the columns of the identity, (2.1)."""
    basis = strain_basis(rod(admitted), modes=2)
    q = coordinates(basis)
    B = np.eye(6)[:, list(admitted)]
    B_bar = np.eye(6)[:, [c for c in range(6) if c not in admitted]]
    phi = [s * legendre.legvander(2 * INNER - 1, 1) @ q[2 * i : 2 * i + 2] for i, s in enumerate(basis.scales)]
    xi_0 = intrinsic(INNER)
    expected = B @ (B.T @ xi_0 + np.array(phi)) + B_bar @ (B_bar.T @ xi_0)
    found = basis.at(ca.DM(q), INNER).full()
    assert_allclose(found, expected, rtol=1e-13, atol=1e-14)
    assert_allclose(B_bar.T @ found, B_bar.T @ xi_0, rtol=1e-15, atol=1e-16)
    assert np.all(np.abs(B.T @ (found - xi_0)).max(axis=1) > 1e-3)


@pytest.mark.parametrize("admitted", SUBSETS, ids=NAMES)
def test_strain_rows_vs_strain_at_the_nodes(admitted):
    basis = strain_basis(rod(admitted, ((0.0,),) * 5 + ((1.0,),)), modes=2)
    q = ca.DM(coordinates(basis))
    expected = basis.at(q, basis.grid.nodes).full()[3:]
    for row, value, c in zip(basis.strain_rows(q, (3, 4, 5)), expected, (3, 4, 5), strict=True):
        assert (row is None) == (c not in admitted and c != 5)
        if row is not None:
            assert_allclose(row.full().ravel(), value, rtol=1e-14, atol=1e-15)


@POLYNOMIALS
@BREAKS
def test_shape_functions_vs_numpy_vandermonde(polynomials, breaks):
    basis = strain_basis(rod((1, 3), basis=polynomials), modes=(4, 6), breaks=breaks)
    element = basis.grid.element_of(INNER)
    ends = np.array(breaks)
    local = 2 * (INNER - ends[element]) / (ends[element + 1] - ends[element]) - 1
    for scale, c, modes in zip(basis.scales, (1, 3), (4, 6), strict=True):
        found = basis.shape_functions(c, INNER, element).reshape(len(INNER), -1, modes)
        for row, e in enumerate(element):
            expected = scale * VANDER[polynomials](local[row], modes - 1)[0]
            assert_allclose(found[row, e], expected, rtol=1e-13, atol=1e-13)
            assert not np.any(np.delete(found[row], e, axis=0))


@POLYNOMIALS
@BREAKS
def test_strain_vs_reference_with_one_order_per_component(polynomials, breaks):
    basis = strain_basis(rod((0, 2, 5), basis=polynomials), modes=(1, 4, 2), breaks=breaks)
    q = coordinates(basis, 4)
    assert basis.size == 7 * (len(breaks) - 1)
    assert [basis.columns[c].stop - basis.columns[c].start for c in (0, 2, 5)] == [
        m * (len(breaks) - 1) for m in (1, 4, 2)
    ]
    element = basis.grid.element_of(INNER)
    expected = [element_strain(basis, q, e)(x) for x, e in zip(INNER, element, strict=True)]
    assert_allclose(basis.at(ca.DM(q), INNER).full().T, expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("at", [0.3, 0.5])
def test_strain_at_a_break_vs_the_element_it_ends(at):
    basis = strain_basis(rod((0,)), modes=2, breaks=(0.0, 0.3, 0.5, 1.0))
    q = coordinates(basis, 2)
    element = (0.3, 0.5).index(at)
    found = basis.at(ca.DM(q), np.array([at])).full().ravel()
    assert_allclose(found, element_strain(basis, q, element)(at), rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("admitted", [(0,), (0, 1, 2), (3, 5), (0, 5), tuple(range(6))])
@pytest.mark.parametrize("length", [0.5, 2.0])
def test_scales_vs_definition(admitted, length):
    basis = strain_basis(rod(admitted, length=length, hooke=tapered))
    mean = quad_vec(lambda x: tapered(np.array([x]))[0], 0, 1, epsabs=0, epsrel=1e-13)[0]
    angular = [mean[i] for i in admitted if i < 3]
    bending = min(angular or [mean[i] * length**2 for i in admitted])
    assert_allclose(basis.scales, [np.sqrt(bending / length**2 / mean[i]) for i in admitted], rtol=1e-13, atol=0)
    assert_allclose(basis.energy_unit, bending / length, rtol=1e-13, atol=0)


def quadrature_stiffness(basis):
    """K_εε = ℓ ∫ Φᵀ H_a Φ dX in joules, by adaptive quadrature of every element."""
    H, ends = basis.properties.hooke, np.array(basis.grid.breaks)
    total = np.zeros((basis.size, basis.size))
    for e in range(basis.grid.elements):

        def integrand(x, e=e):
            phi, place = np.zeros((len(basis.properties.admitted), basis.size)), 0
            local = 2 * (x - ends[e]) / (ends[e + 1] - ends[e]) - 1
            for i, modes in enumerate(basis.discretisation.modes):
                own = slice(place + e * modes, place + (e + 1) * modes)
                phi[i, own] = basis.scales[i] * VANDER[basis.properties.basis](local, modes - 1)
                place += modes * basis.grid.elements
            return phi.T @ np.diag(H(np.array([x]))[0][list(basis.properties.admitted)]) @ phi

        total += quad_vec(integrand, ends[e], ends[e + 1], epsabs=1e-14, epsrel=1e-13, norm="max")[0]
    return basis.properties.length * total


@POLYNOMIALS
@BREAKS
@pytest.mark.parametrize("hooke", [uniform(), tapered], ids=["uniform", "tapered"])
@pytest.mark.parametrize(("admitted", "modes"), [((0, 1, 2), (3, 2, 4)), ((1, 3, 5), (4, 1, 2))])
def test_stiffness_vs_adaptive_quadrature(polynomials, breaks, hooke, admitted, modes):
    basis = strain_basis(rod(admitted, basis=polynomials, hooke=hooke, length=0.7), modes=modes, breaks=breaks)
    expected = quadrature_stiffness(basis) / basis.energy_unit
    assert_allclose(basis.stiffness, expected, rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("length", [0.25, 3.0])
def test_stiffness_vs_printed_formula_without_the_length(length):
    """Slip of (2.14): the ℓ it drops is kept."""
    basis = strain_basis(rod((0, 5), length=length))
    expected = quadrature_stiffness(basis)
    assert_allclose(basis.stiffness * basis.energy_unit, expected, rtol=1e-12, atol=1e-13)
    printed = expected / length
    assert np.abs(basis.stiffness * basis.energy_unit - printed).max() > 0.5 * np.abs(printed).max()


@pytest.mark.parametrize("length", [0.25, 1.0, 3.0])
def test_energy_of_constant_bending_vs_beam_theory(length):
    basis = strain_basis(rod((0,), length=length), modes=1)
    kappa = 1.3
    q = kappa / basis.scales[0]
    energy = basis.energy_unit / 2 * q * basis.stiffness[0, 0] * q
    assert_allclose(energy, HOOKE[0] * kappa**2 * length / 2, rtol=1e-14, atol=0)


@pytest.mark.parametrize("slenderness", [1e2, 1e8])
def test_condition_of_stiffness_vs_slenderness(slenderness):
    """Scaled coordinates: stiff and soft strains weigh the same."""
    stiff = uniform(np.array([1.0, 1.0, 1.0, slenderness, slenderness, slenderness]))
    basis = strain_basis(rod(tuple(range(6)), hooke=stiff), modes=4)
    assert_allclose(np.linalg.cond(basis.stiffness), 7.0, rtol=1e-10, atol=0)
