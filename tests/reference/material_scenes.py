"""Seeded laws of materials, chambers and muscles of one rod, and the stresses that follow from their formulas.

Fibres of rubber are summed by Gauss's rule in the plane of the section; tables go by SciPy's monotone cubics.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy.interpolate import PchipInterpolator

from tests.reference.random_scenes import directed
from tests.reference.rods import STRAINS, Array, RodData, Table, rod_of

Stress = Callable[[Array, Array], Array]
"""Changes of strain (k, 6) and abscissae (k,) ↦ stress beside that of the Hooke tensor (k, 6)."""

FIBRES = 24
"""Points of Gauss's rule along each coordinate of a section."""

SHARE_OF_CORNER = 0.1
"""Half of the width of a superelastic corner over the shorter piece beside it."""


# Drawing


def make_of_matter(rng: np.random.Generator, tables: Table, bending: float) -> None:
    """Give a scene's rod a law, a chamber and a muscle, each with some luck; ``bending`` is its stiffness, N m²."""
    (rod,) = tables["rods"]
    if "material" in rod and rng.random() < 0.9:
        _thicken(rng, rod)
        compliance = rod_of(tables).compliance(0.0)
        _draw_law(rng, rod, np.divide(1.0, compliance, out=np.zeros(6), where=compliance > 0.0))
    drawn = [draw(rng, rod["length"], bending) for draw in (_chamber, _muscle) if rng.random() < 0.3]
    if drawn:
        tables["actuators"] = [*tables.get("actuators", []), *drawn]


def _thicken(rng: np.random.Generator, rod: Table) -> None:
    """Another section of the same bending stiffness and weight, whose fibres are strained more."""
    scale = float(rng.uniform(1.0, 4.0))
    sizes = [key for key in rod["section"] if key not in ("shape", "shear_correction")]
    rod["section"] |= {key: (scale * np.array(rod["section"][key])).tolist() for key in sizes}
    powers = {"youngs_modulus": -4, "shear_modulus": -4, "density": -2}
    rod["material"] |= {key: rod["material"][key] * scale**p for key, p in powers.items() if key in rod["material"]}


def _draw_law(rng: np.random.Generator, rod: Table, hooke: Array) -> None:
    """Give the material of a rod a law; ``hooke`` are the stiffnesses at the base, zero of what does not move."""
    material = rod["material"]
    young = material["youngs_modulus"]
    free = np.flatnonzero(hooke)
    laws = ["neo_hookean", "mooney_rivlin", "yeoh", "ogden", "polynomial", "table"]
    round_section = rod["section"]["shape"] == "circle" and {0, 1} & set(free)
    law = str(rng.choice([*laws, "superelastic"] if round_section else laws))
    material["law"] = law
    share = float(rng.uniform(0.1, 0.9))
    units = np.array([1.0, 1.0, 1.0, 0.1 * rod["length"], 0.1 * rod["length"], 0.1 * rod["length"]]) / rod["length"]
    if law == "mooney_rivlin":
        material |= {"c10": share * young / 6, "c01": (1 - share) * young / 6}
    elif law == "yeoh":
        material |= {"c1": young / 6, "c2": share * young / 6, "c3": 0.3 * share * young / 6}
    elif law == "ogden":
        exponents = rng.uniform([1.1, -4.0], [4.0, -1.1]).tolist()
        shares = [share, 1 - share]
        material["ogden"] = [[w * young / (1.5 * a), a] for w, a in zip(shares, exponents, strict=True)]
    elif law == "polynomial":
        i, j = rng.choice(free, 2)
        stiffening = {STRAINS[i]: 4, "coefficient": float(0.1 * share * hooke[i] / units[i] ** 2)}
        coupled = {STRAINS[i]: 1, STRAINS[j]: 1} if i != j else {STRAINS[i]: 3}
        size = np.sqrt(hooke[i] * hooke[j]) / (1.0 if i != j else 4 * units[i])
        material["terms"] = [stiffening, {**coupled, "coefficient": float(0.3 * size * rng.uniform(-1, 1))}]
    elif law == "table":
        c = rng.choice(free)
        strains = np.cumsum(rng.uniform(0.3, 3.0, 5)) * units[c]
        stresses = hooke[c] * np.cumsum(np.diff(strains, prepend=0.0) * rng.uniform(0.2, 1.5, 5))
        material["table"] = {STRAINS[c]: np.column_stack([strains, stresses]).tolist()}
    elif law == "superelastic":
        start = float(max(_ends(rod["section"]["radius"])) / rod["length"] * rng.uniform(0.3, 3.0))
        material |= {"plateau_start": start, "plateau_end": start * float(rng.uniform(1.5, 6.0))}
        material |= {"plateau_modulus": 0.2 * share * young + 0.05 * young, "end_modulus": 0.6 * young}


def _chamber(rng: np.random.Generator, length: float, bending: float) -> Table:
    """A chamber that widens by polynomials, by its wall, or not at all."""
    area = float((0.02 * length) ** 2)
    pressure = float(bending / length / (0.02 * length * area) * 10 ** rng.uniform(-2, 0.3))
    chamber = {"name": "chamber", "kind": "chamber", "rod": "rod", "offset": directed(rng, 0.02 * length)[:2]}
    chamber["pressure"] = pressure
    kind = rng.integers(3)
    if kind == 0:
        inner = float(np.sqrt(area / np.pi))
        ratio = float(rng.uniform(1.05, 2.0))
        wall = {"inner_radius": inner, "outer_radius": inner * ratio}
        # Strains around the bore from 1 to 9 %.
        modulus = pressure * float(rng.uniform(16, 150)) / (1 - ratio**-2)
        return {**chamber, "wall": {**wall, "youngs_modulus": modulus}}
    grows = {"area_growth": rng.uniform(-0.3, 0.5, 2).tolist(), "offset_growth": [float(rng.uniform(-0.2, 0.2))]}
    return {**chamber, "area": area, **({**grows, "reference_pressure": 1.5 * pressure} if kind == 1 else {})}


def _muscle(rng: np.random.Generator, length: float, bending: float) -> Table:
    """A muscle with a profile of three coefficients, beside the axis."""
    size = bending / length * 10 ** rng.uniform(-2, 0.3)
    wrench = {"moment": directed(rng, size), "force": directed(rng, size / length)}
    placed = {"name": "muscle", "kind": "muscle", "rod": "rod", "offset": directed(rng, 0.05 * length)[:2]}
    profile = [1.0, *rng.uniform(-0.5, 0.5, 2).tolist()]
    return {**placed, **wrench, "activation": float(rng.uniform(-1, 1)), "profile": profile}


# Laws


def beyond_hooke(rod: Table, compliance: Callable[[float], Array]) -> Stress | None:
    """Stress of the law of a rod less that of its Hooke tensor; None of a linear one."""
    material = rod.get("material", {})
    law = material.get("law", "linear")
    if law == "linear":
        return None
    if law == "polynomial":
        return lambda change, X: _polynomial(material["terms"], change)

    def hooke(X: Array, c: int) -> Array:
        return np.array([1 / compliance(x)[c] for x in X])

    if law == "table":
        ((name, points),) = material["table"].items()
        c = STRAINS.index(name)
        return lambda change, X: _only(c, _tabulated(points, change[:, c]) - hooke(X, c) * change[:, c])
    if law == "superelastic":
        return lambda change, X: _superelastic(material, rod["section"]["radius"], change, X)
    return lambda change, X: _rubber(rod, change, X)


def _only(c: int, stress: Array) -> Array:
    found = np.zeros((len(stress), 6))
    found[:, c] = stress
    return found


def _polynomial(terms: Sequence[Table], change: Array) -> Array:
    """c Π ξ^p, differentiated."""
    found = np.zeros_like(change)
    for term in terms:
        powers = np.array([term.get(name, 0) for name in STRAINS])
        for c in np.flatnonzero(powers):
            lowered = powers - (np.arange(6) == c)
            found[:, c] += term["coefficient"] * powers[c] * np.prod(change**lowered, axis=1)
    return found


def _tabulated(points: Sequence[Sequence[float]], strain: Array) -> Array:
    strains, stresses = np.array(points).T
    odd = PchipInterpolator([*-strains[::-1], 0.0, *strains], [*-stresses[::-1], 0.0, *stresses])
    return np.asarray(odd(strain))


def _superelastic(material: Table, radius: float | list[float], change: Array, X: Array) -> Array:
    """Moment against curvature by Simpson's rule over the slope, along the direction of bending."""
    size = np.linalg.norm(change[:, :2], axis=1)
    first, last = _ends(radius)
    radii = first + (last - first) * X
    start, end = material["plateau_start"], material["plateau_end"]
    moduli = [material[key] for key in ("youngs_modulus", "plateau_modulus", "end_modulus")]
    corners = [start, end]
    widths = [SHARE_OF_CORNER * min(start, end - start), SHARE_OF_CORNER * (end - start)]
    stress = np.zeros_like(size)
    for at, width, step in zip(corners, widths, np.diff(moduli), strict=True):
        # The modulus rises in a straight line over the corner; its integral over strain is the stress of the fibre.
        inside = np.clip(radii * size - at + width, 0.0, 2 * width)
        past = np.maximum(radii * size - at - width, 0.0)
        stress += step * (inside**2 / (4 * width) + past)
    moment = np.pi / 4 * radii**3 * stress
    found = np.zeros_like(change)
    found[:, :2] = change[:, :2] * (moment / np.maximum(size, 1e-300))[:, None]
    return found


def _rubber(rod: Table, change: Array, X: Array) -> Array:
    """Nominal stress of every fibre less E ε, and its moments."""
    found = np.zeros_like(change)
    x, y, area = _fibres(rod["section"], X)
    strain = change[:, 5:] + y * change[:, :1] - x * change[:, 1:2]
    force = area * (fibre_stress(rod["material"], 1 + strain) - rod["material"]["youngs_modulus"] * strain)
    for c, lever in ((0, y), (1, -x), (5, 1.0)):
        found[:, c] = np.sum(lever * force, axis=1)
    return found


def _fibres(section: Table, X: Array) -> tuple[Array, Array, Array]:
    """Places and areas of fibres, each (k, fibres)."""
    nodes, weights = legendre.leggauss(FIBRES)
    sizes = {key: np.interp(X, [0, 1], _ends(section[key]))[:, None] for key in section if key != "shape"}
    u, v = (grid.ravel() for grid in np.meshgrid(nodes, nodes))
    shares = np.outer(weights, weights).ravel() / 4
    if section["shape"] == "rectangle":
        return sizes["width"] / 2 * u, sizes["height"] / 2 * v, sizes["width"] * sizes["height"] * shares
    outer = sizes.get("outer_radius", sizes.get("radius"))
    inner = sizes.get("inner_radius", 0.0)
    radius, angle = inner + (outer - inner) * (u + 1) / 2, np.pi * v
    return radius * np.cos(angle), radius * np.sin(angle), radius * (outer - inner) * 2 * np.pi * shares


def _ends(size: float | list[float]) -> list[float]:
    """A size at base and tip."""
    return size if isinstance(size, list) else [size, size]


def fibre_stress(material: Table, stretch: Any) -> Any:
    """Force per unloaded area of rubber that is stretched along itself, Pa: textbook formulas."""
    law, shrink = material["law"], stretch - stretch**-2
    if law == "mooney_rivlin":
        return 2 * shrink * (material["c10"] + material["c01"] / stretch)
    if law == "yeoh":
        above = stretch**2 + 2 / stretch - 3
        return 2 * shrink * (material["c1"] + 2 * material["c2"] * above + 3 * material["c3"] * above**2)
    if law == "ogden":
        # The pairs may be printed to three digits; the law is scaled to Young's modulus.
        scale = material["youngs_modulus"] / (1.5 * sum(mu * a for mu, a in material["ogden"]))
        return scale * sum(mu * (stretch ** (a - 1) - stretch ** (-a / 2 - 1)) for mu, a in material["ogden"])
    return material["youngs_modulus"] / 3 * shrink


# Chambers and muscles


def active_stress(actuators: Sequence[Table], X: Array) -> Array:
    """Moment and force of chambers and muscles in the sections, section axes, (k, 6)."""
    found = np.zeros((len(X), 6))
    for actuator in actuators:
        x, y = actuator.get("offset", [0.0, 0.0])
        if actuator["kind"] == "chamber":
            force = actuator["pressure"] * _widened(actuator)
            arm = _grown(actuator.get("offset_growth", []), actuator)
            found += [arm * y * force, -arm * x * force, 0, 0, 0, force]
        elif actuator["kind"] == "muscle":
            force = np.array(actuator["force"])
            wrench = [*(actuator["moment"] + np.cross([x, y, 0], force)), *force]
            profile = legendre.legval(2 * X - 1, actuator["profile"])
            found += actuator["activation"] * profile[:, None] * wrench
    return found


def _widened(chamber: Table) -> float:
    """Cross-section at the pressure: by polynomial, or by Lamé's cylinder without volume change, or plane strain."""
    wall = chamber.get("wall")
    if wall is None:
        return float(chamber["area"] * _grown(chamber.get("area_growth", []), chamber))
    inner, outer, nu = wall["inner_radius"], wall["outer_radius"], wall.get("poisson_ratio", 0.5)
    ratio = chamber["pressure"] / wall["youngs_modulus"] / (outer**2 - inner**2)
    displacement = ratio * (1 + nu) * inner * ((1 - 2 * nu) * inner**2 + outer**2)
    return float(np.pi * (inner + displacement) ** 2)


def _grown(coefficients: Sequence[float], chamber: Table) -> float:
    ratio = chamber["pressure"] / chamber["reference_pressure"] if coefficients else 0.0
    return float(np.polynomial.polynomial.polyval(ratio, [1.0, *coefficients]))


def with_materials(rod: RodData, tables: Table) -> RodData:
    """What :func:`rod_of` says of a rod, with its law and its active stress."""
    (table,) = tables["rods"]
    law = beyond_hooke(table, rod.compliance)
    actuators = tables.get("actuators", [])

    def beyond(change: Array, X: Array) -> Array:
        stress = -active_stress(actuators, X)
        return stress if law is None else stress + law(change, X)

    return replace(rod, beyond=beyond)
