"""Random rods on tables, bars and balls, with loads that act where they may lie, as text of scenes."""

from __future__ import annotations

import numpy as np

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
