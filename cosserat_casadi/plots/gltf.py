"""Films as glTF 2.0, binary: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html.

Moving parts have a skin: one animated node for each frame, and each point is fixed to one node.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.solution import rotations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.film import Film, FilmPart

Z_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
"""Quaternion, x y z w, that rotates the z axis to the vertical of glTF, y."""

FLOAT, SHORT, INTEGER = 5126, 5123, 5125
"""Codes of the component types in glTF."""

TYPES = {FLOAT: "<f4", SHORT: "<u2", INTEGER: "<u4"}
KINDS = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


class _Document:
    """A document under construction, and its binary buffer."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "cosserat_casadi"},
            "accessors": [],
            "bufferViews": [],
            "nodes": [{"name": "scene", "rotation": Z_UP, "children": []}],
            "meshes": [],
            "materials": [],
            "scene": 0,
            "scenes": [{"nodes": [0]}],
        }

    def add(self, key: str, entry: dict[str, Any]) -> int:
        """Append to a list of the document, and return the index of the entry."""
        entries = self.json.setdefault(key, [])
        entries.append(entry)
        return len(entries) - 1

    def accessor(self, values: npt.ArrayLike, component: int, *, bounds: bool = False) -> int:
        """Store numbers, shape (n, …), and return the index of their accessor."""
        array = np.ascontiguousarray(values, dtype=TYPES[component])
        entry: dict[str, Any] = {
            "bufferView": self.add(
                "bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
            ),
            "componentType": component,
            "count": len(array),
            "type": KINDS[array.shape[1:]],
        }
        if bounds:
            flat = array.reshape(len(array), -1)
            entry |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.data += array.tobytes()
        # Accessors begin at multiples of four bytes.
        self.data += b"\0" * (-len(self.data) % 4)
        return self.add("accessors", entry)

    def written(self) -> bytes:
        """Content of the file: header, JSON and binary buffer."""
        self.json["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps({key: value for key, value in self.json.items() if value != []}, separators=(",", ":"))
        head = text.encode()
        head += b" " * (-len(head) % 4)
        chunks = struct.pack("<I4s", len(head), b"JSON") + head
        chunks += struct.pack("<I4s", len(self.data), b"BIN\0") + bytes(self.data)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def glb(film: Film) -> bytes:
    """Content of the ``.glb`` file of a film, animated at the times of the film."""
    document = _Document()
    document.json["scenes"][0]["name"] = film.title
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []
    times = document.accessor(film.times, FLOAT, bounds=True) if len(film.times) > 1 else None
    for part in film.parts:
        mesh = document.add("meshes", {"name": part.name, "primitives": [_primitive(document, part, times)]})
        node: dict[str, Any] = {"name": part.name, "mesh": mesh}
        number = document.add("nodes", node)
        if times is None:
            document.json["nodes"][0]["children"].append(number)
            continue
        # Joints alone move the points of a skin; the transform of its node is ignored.
        document.json["scenes"][0]["nodes"].append(number)
        joints = []
        for frame in range(part.poses.position.shape[1]):
            position = part.poses.position[:, frame]
            quaternion = _continuous(part.poses.quaternion[:, frame])[:, [1, 2, 3, 0]]
            joint = document.add(
                "nodes",
                {
                    "name": f"{part.name} {frame}",
                    "translation": position[0].tolist(),
                    "rotation": quaternion[0].tolist(),
                },
            )
            document.json["nodes"][0]["children"].append(joint)
            joints.append(joint)
            for path, values in (("translation", position), ("rotation", quaternion)):
                samplers.append({"input": times, "output": document.accessor(values, FLOAT)})
                channels.append({"sampler": len(samplers) - 1, "target": {"node": joint, "path": path}})
        inverse = document.accessor(_inverses(part), FLOAT)
        node["skin"] = document.add("skins", {"joints": joints, "inverseBindMatrices": inverse, "skeleton": 0})
    if channels:
        document.add("animations", {"name": film.title, "channels": channels, "samplers": samplers})
    return document.written()


def _primitive(document: _Document, part: FilmPart, times: int | None) -> dict[str, Any]:
    """The triangles of a part at the first time."""
    points = part.at(0)
    attributes = {
        "POSITION": document.accessor(points, FLOAT, bounds=True),
        "NORMAL": document.accessor(_normals(points, part), FLOAT),
    }
    if times is not None:
        rest = np.zeros((len(points), 3), dtype=int)
        attributes["JOINTS_0"] = document.accessor(np.column_stack([part.frame, rest]), SHORT)
        attributes["WEIGHTS_0"] = document.accessor(np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1)), FLOAT)
    look: dict[str, Any] = {"baseColorFactor": list(part.colour), "metallicFactor": 0.1, "roughnessFactor": 0.6}
    material: dict[str, Any] = {"name": part.name, "pbrMetallicRoughness": look, "doubleSided": True}
    if part.colour[3] < 1.0:
        material["alphaMode"] = "BLEND"
    return {
        "attributes": attributes,
        "indices": document.accessor(part.faces.ravel(), INTEGER),
        "material": document.add("materials", material),
    }


def _normals(points: FloatArray, part: FilmPart) -> FloatArray:
    """Unit normals at the points: area-weighted means over the adjacent triangles."""
    a, b, c = (points[part.faces[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, part.faces[:, corner], across)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # The normal at a point of degenerate triangles is arbitrary.
    return np.where(lengths > 0.0, normals / np.maximum(lengths, 1e-300), [0.0, 0.0, 1.0])


def _continuous(quaternions: FloatArray) -> FloatArray:
    """Quaternions over time, shape (T, 4), with signs chosen for continuity."""
    products = np.einsum("ti,ti->t", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.concatenate([[1.0], np.where(products < 0.0, -1.0, 1.0)]))
    return np.asarray(signs[:, None] * quaternions)


def _inverses(part: FilmPart) -> FloatArray:
    """Inverse poses of the frames at the first time, column-major, shape (k, 4, 4)."""
    turned_back = np.swapaxes(rotations(part.poses.quaternion[0]), 1, 2)
    matrices = np.tile(np.eye(4), (len(turned_back), 1, 1))
    matrices[:, :3, :3] = turned_back
    matrices[:, :3, 3] = -np.einsum("kij,kj->ki", turned_back, part.poses.position[0])
    return np.swapaxes(matrices, 1, 2)
