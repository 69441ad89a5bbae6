"""Random rods on tables, bars and balls, with loads that act where they may lie, as text of scenes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

LENGTH = 1.0


def contact_scene(seed: int) -> str:
    """A heavy rod that is clamped level, pushed and lifted at sections, above up to three obstacles."""
    generator = np.random.default_rng(seed)
    stiffness = generator.uniform(0.02, 0.3)
    density = generator.uniform(0.05, 0.3)
    weight = 9.81 * density * LENGTH
    spatial = generator.random() < 0.25
    text = f"""
schema = 1
accuracy = {{ tolerance = 1e-5 }}
[[rods]]
name = "rod"
length = {LENGTH}
strain = "{"kirchhoff" if spatial else "planar"}"
stiffness = {{ bending_x = {stiffness}, bending_y = {stiffness}, torsion = {stiffness} }}
linear_density = {density}
base = {{ position = [0, 0, 0], tangent = [1, 0, 0] }}
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, {-generator.uniform(0.02, 0.12)}]
normal = [0, 0, 1]
"""
    for number in range(generator.integers(1, 4)):
        force = weight * generator.uniform(-0.6, 0.3)
        sideways = weight * generator.uniform(-0.05, 0.05) if spatial else 0.0
        text += f"""
[[loads]]
name = "load{number}"
kind = "point_wrench"
rod = "rod"
at = {generator.uniform(0.3, 0.98):.3f}
force = [0, {sideways}, {force}]
"""
    if generator.random() < 0.4:
        x, radius = generator.uniform(0.3, 0.7), generator.uniform(0.03, 0.1)
        text += f"""
[[obstacles]]
name = "bar"
kind = "capsule"
from = [{x}, -1.0, {-radius - 0.01}]
to = [{x}, 1.0, {-radius - 0.01}]
radius = {radius}
"""
    if generator.random() < 0.3:
        text += f"""
[[obstacles]]
name = "ball"
kind = "sphere"
centre = [{generator.uniform(0.3, 0.9)}, {0.02 * spatial}, -0.13]
radius = 0.1
"""
    return text


FAMILIES = ("nearly", "zero", "tangent", "squeezed", "base", "tip")
"""Where a bar stands to a section of a rod that nothing touches: see :func:`placed_scene`."""


def placed_scene(seed: int, family: str, place: Callable[[str, float], tuple[FloatArray, FloatArray]]) -> str:
    """A heavy rod that is clamped level, and bars across it that just miss it, just touch it, or press it.

    Args:
        seed: of the numbers.
        family: ``nearly`` is a gap of 1e-9 to 1e-4, ``zero`` none to rounding; ``tangent``, ``base`` and ``tip`` hold
            the rod up by a share of its way down, of 1e-6 to 1, somewhere or there; ``squeezed`` is one bar below the
            straight rod and one above it, against which it is pulled up.
        place: the scene without bars and an abscissa ↦ position and normal of that section where nothing touches, each
            in x and z, m.
    """
    generator = np.random.default_rng([seed, FAMILIES.index(family)])
    stiffness = generator.uniform(0.05, 0.3)
    text = f"""
schema = 1
accuracy = {{ tolerance = 1e-5 }}
[[rods]]
name = "rod"
length = {LENGTH}
strain = "planar"
stiffness = {{ bending_y = {stiffness} }}
linear_density = {generator.uniform(0.02, 0.1)}
base = {{ position = [0, 0, 0], tangent = [1, 0, 0] }}
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
name = "push"
kind = "point_wrench"
rod = "rod"
at = 1.0
force = [0, 0, {generator.uniform(0.5, 1.0) if family == "squeezed" else generator.uniform(-0.2, 0.0)}]
"""
    small = 10.0 ** generator.uniform(-9, -4)
    share = 10.0 ** generator.uniform(-6, 0)
    at = generator.uniform(0.3, 0.95)
    bars = {
        "nearly": [(at, 1, -small)],
        "zero": [(at, 1, 0.0)],
        "tangent": [(at, 1, share)],
        "squeezed": [(generator.uniform(0.3, 0.5), 1, -small), (generator.uniform(0.7, 0.9), -1, -small)],
        "base": [(generator.uniform(0.02, 0.1), 1, share)],
        "tip": [(1.0, 1, share)],
    }
    whole = text
    for number, (X, side, depth) in enumerate(bars[family]):
        radius = generator.uniform(0.01, 0.1)
        position, normal = place(text, X)
        if family == "squeezed":
            position, normal = np.array([X * LENGTH, 0.0]), np.array([0.0, 1.0])
        if depth > 0:
            depth = depth * -position[1]
        # Below the section, or above it, its surface is so deep past the centre line.
        x, z = position - side * (radius - depth) * normal
        whole += f"""
[[obstacles]]
name = "bar{number}"
kind = "capsule"
from = [{float(x)!r}, -1.0, {float(z)!r}]
to = [{float(x)!r}, 1.0, {float(z)!r}]
radius = {float(radius)!r}
"""
    return whole
