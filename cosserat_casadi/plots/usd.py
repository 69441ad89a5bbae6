"""Films as Universal Scene Description in text form: meshes with time samples of their points."""

from __future__ import annotations

import json
import re

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.film import Film, FilmPart

RATE = 100
"""Time codes per second."""


def usda(film: Film) -> str:
    """Content of the ``.usda`` file of a film."""
    names: set[str] = set()
    meshes = [_mesh(part, film, _identifier(part.name, names)) for part in film.parts]
    head = [
        "#usda 1.0",
        "(",
        f"    doc = {json.dumps(film.title, ensure_ascii=False)}",
        '    defaultPrim = "scene"',
        '    upAxis = "Z"',
        "    metersPerUnit = 1",
        f"    timeCodesPerSecond = {RATE}",
        f"    startTimeCode = {RATE * film.times[0]:.6g}",
        f"    endTimeCode = {RATE * film.times[-1]:.6g}",
        ")",
        'def Xform "scene"',
        "{",
    ]
    return "\n".join([*head, *meshes, "}", ""])


def _identifier(name: str, taken: set[str]) -> str:
    """A valid USD name that is not in ``taken``; it is added to ``taken``."""
    base = re.sub(r"\W", "_", name, flags=re.ASCII)
    chosen, number = base, 1
    while chosen in taken:
        number += 1
        chosen = f"{base}_{number}"
    taken.add(chosen)
    return chosen


def _mesh(part: FilmPart, film: Film, name: str) -> str:
    red, green, blue, opacity = part.colour
    lines = [f'    def Mesh "{name}"', "    {", "        uniform bool doubleSided = 1"]
    lines.append(f"        int[] faceVertexCounts = [{', '.join(['3'] * len(part.faces))}]")
    lines.append(f"        int[] faceVertexIndices = [{', '.join(map(str, part.faces.ravel().tolist()))}]")
    if len(film.times) == 1:
        lines.append(f"        point3f[] points = {_points(part.at(0))}")
    else:
        lines.append("        point3f[] points.timeSamples = {")
        lines += [
            f"            {RATE * time:.6g}: {_points(part.at(i))}," for i, time in enumerate(film.times.tolist())
        ]
        lines.append("        }")
    lines.append(f"        color3f[] primvars:displayColor = [({red:.4g}, {green:.4g}, {blue:.4g})]")
    lines.append(f"        float[] primvars:displayOpacity = [{opacity:g}]")
    lines += ['        uniform token subdivisionScheme = "none"', "    }"]
    return "\n".join(lines)


def _points(points: FloatArray) -> str:
    return "[" + ", ".join(f"({x:.7g}, {y:.7g}, {z:.7g})" for x, y, z in np.asarray(points).tolist()) + "]"
