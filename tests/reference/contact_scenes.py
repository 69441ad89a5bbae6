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


PLACED = ("nearly", "zero", "tangent", "squeezed", "base", "tip")
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
    generator = np.random.default_rng([seed, PLACED.index(family)])
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


def smooth_scene(seed: int, friction: float = 0.0) -> str:
    """The rod of :func:`contact_scene`, whose obstacles have a width."""
    width = 10.0 ** np.random.default_rng([seed, 1]).uniform(-2.3, -1.7)
    head, *obstacles = contact_scene(seed).split("[[obstacles]]\n")
    # Loads stand between obstacles: the keys go to the head of each.
    keys = f"[[obstacles]]\nwidth = {width!r}\nstiffness = {300 / width!r}\nfriction = {friction!r}\n"
    return head + "".join(keys + rest for rest in obstacles)


def _finger(name: str, modulus: float, base: str, strain: str = "planar") -> str:
    """A soft rod of 0.2 m."""
    return f"""
[[rods]]
name = "{name}"
length = 0.2
strain = "{strain}"
material = {{ youngs_modulus = {modulus!r}, poisson_ratio = 0.4, density = 1100.0 }}
section = {{ shape = "circle", radius = 5e-3 }}
base = {base}
"""


HEAD = """
schema = 1
accuracy = { tolerance = 1e-5 }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""


def _ball(rod: str, mass: float, radius: float) -> str:
    """A ball that is fixed to the tip of a rod."""
    return f"""
[[bodies]]
name = "ball"
mass = {mass!r}
radius = {radius!r}
[[joints]]
body = "ball"
rod = "{rod}"
kind = "fixed"
"""


def body_scene(seed: int) -> str:
    """A ball at the tip of a heavy rod, above a leaning floor, and sometimes with a bar below the rod."""
    generator = np.random.default_rng([seed, 2])
    text = HEAD + _finger("rod", generator.uniform(2e6, 1e7), "{ position = [0, 0, 0], tangent = [1, 0, 0] }")
    text += _ball("rod", generator.uniform(2e-3, 15e-3), generator.uniform(6e-3, 20e-3))
    lean = generator.uniform(-0.1, 0.3)
    text += f"""
[[obstacles]]
name = "floor"
kind = "plane"
point = [0.1, 0, {-generator.uniform(0.03, 0.1)!r}]
normal = [{lean!r}, 0, 1]
rods = ["rod"]
bodies = ["ball"]
"""
    if generator.random() < 0.5:
        x, radius = generator.uniform(0.05, 0.12), generator.uniform(5e-3, 15e-3)
        text += f"""
[[obstacles]]
name = "bar"
kind = "capsule"
from = [{x!r}, -1, {-radius - 8e-3!r}]
to = [{x!r}, 1, {-radius - 8e-3!r}]
radius = {radius!r}
rods = ["rod"]
"""
    return text


def moving_scene(seed: int) -> str:
    """A finger that sinks onto another one, which stands below it, with the ball at its tip."""
    generator = np.random.default_rng([seed, 3])
    x, lean = generator.uniform(0.12, 0.2), generator.uniform(-0.3, 0.1)
    text = HEAD + _finger("upper", generator.uniform(2e6, 1e7), "{ position = [0, 0, 0], tangent = [1, 0, 0] }")
    text += _finger(
        "lower", generator.uniform(2e6, 1e7), f"{{ position = [{x!r}, 0, -0.24], tangent = [{lean!r}, 0, 1] }}"
    )
    radius = generator.uniform(8e-3, 20e-3)
    text += _ball("upper", generator.uniform(1e-2, 3e-2), radius)
    return (
        text
        + f"""
[[obstacles]]
name = "rim"
kind = "sphere"
body = "ball"
centre = [0, 0, 0]
radius = {radius!r}
rods = ["lower"]
"""
    )


def pair_scene(seed: int) -> str:
    """Two fingers in space of which one lies down across the other."""
    generator = np.random.default_rng([seed, 4])
    text = HEAD + _finger(
        "lower", generator.uniform(5e6, 1e7), "{ position = [0, 0, 0], tangent = [1, 0, 0] }", "kirchhoff"
    )
    y, z = generator.uniform(0.05, 0.12), generator.uniform(0.015, 0.03)
    across = f"{{ position = [0.12, {-y!r}, {z!r}], tangent = [0.1, 1, 0] }}"
    text += _finger("upper", generator.uniform(1e6, 3e6), across, "kirchhoff")
    return (
        text
        + """
[[rod_contacts]]
rods = ["lower", "upper"]
width = 4e-3
stiffness = 2e4
"""
    )


def rubbing_scene(seed: int) -> str:
    """The same with friction."""
    return pair_scene(seed) + f"friction = {np.random.default_rng([seed, 6]).uniform(0.1, 0.6)!r}\n"


def friction_scene(seed: int) -> str:
    """The same in space, on a table that leans to the side, with friction."""
    generator = np.random.default_rng([seed, 5])
    text = smooth_scene(seed, generator.uniform(0.05, 0.8)).replace('"planar"', '"kirchhoff"')
    return text.replace("normal = [0, 0, 1]", f"normal = [0, {generator.uniform(-0.3, 0.3)!r}, 1]")


COMPOSED = {
    "smooth": smooth_scene,
    "friction": friction_scene,
    "bodies": body_scene,
    "moving": moving_scene,
    "pairs": pair_scene,
    "rubbing": rubbing_scene,
}
"""Families of other contacts than of rods with fixed obstacles: name → text of the scene of a seed."""

FAMILIES = (*PLACED, *COMPOSED)
