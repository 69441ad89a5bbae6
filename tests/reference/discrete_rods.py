"""Equilibria of rods in contact by minimisation: discrete rods, gaps as constraints, solved by IPOPT.

A rod is a chain of N straight segments, each with an orientation; the relative rotation of two neighbours stores
elastic energy. Energy, loads and layers of soft contact are summed at second order in the length of a segment, and
hard obstacles keep off points of the segments, one inequality each. Nothing is shared with the
package: no polynomials, no places of contact, no search. Its minima are stable equilibria.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from .rods import Array, Table, rod_of

SETTINGS = {
    "print_time": False,
    "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10, "max_iter": 400, "mu_init": 1e-7},
}
"""Options of IPOPT; a small barrier keeps it next to where it begins."""

NEAR_AT_START = 0.05
"""Distance of the surfaces of ends, m, from which on they do not come to touch on a path."""

PARTS = 4
"""Points of a segment that are kept off hard obstacles."""


@dataclass(frozen=True)
class Chain:
    """Symbols of a discrete rod.

    Attributes:
        turns: of the segments: angles in the plane, 1×N, or quaternions w x y z, 4×N.
        ends: ends of the segments, 3×N, m.
        joined: zero where segments join and quaternions have the norm 1.
        energy: elastic energy and that of the loads, J.
        start: values of turns and ends at the shape to begin with.
        lengths: length of rod that each end stands for, shape (N,), m.
        radius: of the section, m.
        base: position of the clamp, shape (3,), m.
    """

    turns: ca.SX
    ends: ca.SX
    joined: ca.SX
    energy: ca.SX
    start: tuple[Array, Array]
    lengths: Array
    radius: float
    base: Array

    @property
    def densely(self) -> ca.SX:
        """Points of the segments, PARTS of each, 3×(PARTS N), m."""
        before = ca.horzcat(ca.DM(self.base), self.ends[:, :-1])
        return ca.horzcat(*[before + part / PARTS * (self.ends - before) for part in range(1, PARTS + 1)])


@dataclass(frozen=True)
class _Problem:
    """Energy and constraints of all rods of a scene.

    Attributes:
        chains: rods by name.
        x: turns and ends of all rods, stacked.
        start: values of them.
        energy: with the layers of soft contact, J.
        joined: zero where all rods hold together.
        gaps: obstacle, gaps of ends of one rod or of a body, 1×k, m, and the lengths that they stand for, m.
    """

    chains: dict[str, Chain]
    x: ca.SX
    start: Array
    energy: ca.SX
    joined: ca.SX
    gaps: list[tuple[Table, ca.SX, Array]]

    def ends(self, x: Any) -> dict[str, Array]:
        """Ends of the segments of each rod, shape (N, 3), m."""
        found = ca.Function("ends", [self.x], [chain.ends.T for chain in self.chains.values()]).call([ca.DM(x)])
        return {name: ends.full() for name, ends in zip(self.chains, found, strict=True)}


@dataclass(frozen=True)
class Minimum:
    """What the minimisation ended with.

    Attributes:
        solved: whether IPOPT says so.
        ends: rod → ends of its segments, shape (N, 3), m.
        pressing: obstacle → sum of its multipliers, N.
    """

    solved: bool
    ends: dict[str, Array]
    pressing: dict[str, float]


Poses = Mapping[str, tuple[Array, Array]]
"""Rod → positions of N + 1 sections, evenly apart, (N + 1, 3), m, and rotations halfway between them, (N, 3, 3)."""


def discrete_equilibrium(scene: Table, poses: Poses) -> Minimum:
    """Minimum of the energy next to a shape.

    Args:
        scene: its tables. Rods are planar or Kirchhoff, clamped, straight, and given by their stiffness or a circle;
            bodies are balls fixed to tips.
        poses: where to begin.
    """
    problem = _problem(scene, poses)
    hard = [(obstacle, gap) for obstacle, gap, _ in problem.gaps if "width" not in obstacle]
    kept = ca.vertcat(problem.joined, *[gap.T for _, gap in hard])
    upper = np.concatenate([np.zeros(problem.joined.numel()), np.full(kept.numel() - problem.joined.numel(), np.inf)])
    functions = {"x": problem.x, "f": problem.energy, "g": kept}
    solver = ca.nlpsol("discrete_rods", "ipopt", functions, SETTINGS)
    end = solver(x0=problem.start, lbg=0.0, ubg=upper)
    multipliers = -end["lam_g"].full()[problem.joined.numel() :, 0]
    pressing: dict[str, float] = {}
    for obstacle, gap in hard:
        forces, multipliers = np.split(multipliers, [gap.numel()])
        pressing[obstacle["name"]] = pressing.get(obstacle["name"], 0.0) + float(forces.sum())
    return Minimum(solver.stats()["success"], problem.ends(end["x"]), pressing)


def discrete_friction_path(scene: Table, poses: Poses, factors: Array) -> dict[str, Array] | None:
    """Ends of rods on which gravity grows while they rub on obstacles with a width; None where an increment fails.

    Coulomb's law in increments: an end that touches drags the layer along, which holds it with the stiffness of the
    obstacle, and slips where that is more than the coefficient times the force along the normal.

    Args:
        scene: as of :func:`discrete_equilibrium`, with soft obstacles alone; rods have no radius.
        poses: at the first factor, in balance.
        factors: shares of gravity, rising; nothing rubs at the first.
    """
    if "rod_contacts" in scene:
        return _pair_path(scene, poses, factors)
    share = ca.SX.sym("share")
    problem = _problem(scene, poses, share)
    multipliers = ca.SX.sym("multipliers", problem.joined.numel())
    balance = ca.gradient(problem.energy + ca.dot(multipliers, problem.joined), problem.x)
    origins, moved = [], []
    for obstacle, gap, lengths in problem.gaps:
        chain = next(chain for chain in problem.chains.values() if chain.ends.shape[1] == gap.shape[1])
        origin = ca.SX.sym("origin", *chain.ends.shape)
        columns = []
        for k, length in enumerate(lengths):
            normal = ca.gradient(gap[k], chain.ends[:, k])
            pressing = (
                obstacle["stiffness"] * ca.fmax(obstacle["width"] - gap[k], 0) ** 3 / (3 * obstacle["width"] ** 2)
            )
            way = chain.ends[:, k] - origin[:, k]
            way = way - ca.dot(normal, way) * normal
            reach = obstacle["friction"] * pressing / obstacle["stiffness"]
            dragged = ca.fmax(ca.sqrt(ca.sumsqr(way) + 1e-24), reach)
            friction = -obstacle["stiffness"] * length * reach / dragged * way
            balance -= ca.jacobian(chain.ends[:, k], problem.x).T @ friction
            columns.append(chain.ends[:, k] - way * reach / dragged)
        origins.append(origin)
        moved.append(ca.horzcat(*columns))
    unknowns = ca.vertcat(problem.x, multipliers)
    given = [unknowns, share, *origins]
    residual = ca.vertcat(balance, problem.joined)
    equations = ca.Function("equations", given, [residual, ca.jacobian(residual, unknowns)])
    after = ca.Function("after", [problem.x, *origins], moved)
    x = np.concatenate([problem.start, np.zeros(problem.joined.numel())])
    at = [chain.start[1] for obstacle, gap, _ in problem.gaps for chain in problem.chains.values()]
    for number, factor in enumerate(factors):
        end = _newton(lambda x, factor=factor, at=at: equations(x, factor, *at), x)
        if end is None:
            return None
        x = end
        if number == 0:
            at = [problem.ends(x[: problem.x.numel()])[name].T for _, _, _ in problem.gaps for name in problem.chains]
        else:
            at = [origin.full() for origin in after.call([x[: problem.x.numel()], *at])]
    return problem.ends(x[: problem.x.numel()])


def _pair_path(scene: Table, poses: Poses, factors: Array) -> dict[str, Array] | None:
    """The same of two rods in space that rub on each other: each pair of ends remembers how far it was dragged.

    The force acts at the point of both sections that touches, whose way turns with the segments.
    """
    share, rubs = ca.SX.sym("share"), ca.SX.sym("rubs")
    problem = _problem(scene, poses, share)
    multipliers = ca.SX.sym("multipliers", problem.joined.numel())
    last = ca.SX.sym("last", problem.x.numel())
    (table,) = scene["rod_contacts"]
    first, second = (problem.chains[name] for name in table["rods"])
    before = [[ca.substitute(field, problem.x, last) for field in (own.ends, own.turns)] for own in (first, second)]
    width, touching = table["width"], first.radius + second.radius
    square = (touching + width) ** 2 - touching**2
    coefficient = 5 * table["stiffness"] / (32 * square**1.5 * (5 * touching**2 - square))
    slip_way = table["friction"] * width / 3
    apart_at_start = first.start[1].T[:, None] - second.start[1].T
    near = np.argwhere(np.linalg.norm(apart_at_start, axis=2) < touching + width + NEAR_AT_START)
    drag = ca.SX.sym("drag", 3, len(near))
    work, after, symbols, values = ca.SX(0), [], [], []
    for p, (k, m) in enumerate(near.tolist()):
        apart = first.ends[:, k] - second.ends[:, m]
        distance = ca.sqrt(ca.sumsqr(apart))
        inside = ca.fmax((touching + width) ** 2 - distance**2, 0)
        pressing = 6 * coefficient * first.lengths[k] * second.lengths[m] * distance * inside**2
        way = drag[:, p]
        force = ca.SX.sym("force", 3)
        sides = ((first, k, -first.radius, 1), (second, m, second.radius, -1))
        for (own, number, reach, sign), (ends, turns) in zip(sides, before, strict=True):
            rotation = _matrix(own.turns[:, number])
            arm = rotation.T @ apart * (reach / touching)
            way = way + sign * (own.ends[:, number] - ends[:, number] + (rotation - _matrix(turns[:, number])) @ arm)
            fixed = ca.SX.sym("arm", 3)
            work += sign * ca.dot(force, own.ends[:, number] + rotation @ fixed)
            symbols.append(fixed)
            values.append(arm)
        way = way - apart * (ca.dot(apart, way) / distance**2)
        dragged = ca.fmax(ca.sqrt(ca.sumsqr(way) + 1e-24), slip_way)
        symbols.append(force)
        values.append(-rubs * table["friction"] * pressing / dragged * way)
        after.append(rubs * ca.if_else(pressing > 0, slip_way / dragged, 0) * way)
    friction = ca.substitute(ca.gradient(work, problem.x), ca.vertcat(*symbols), ca.vertcat(*values))
    balance = ca.gradient(problem.energy + ca.dot(multipliers, problem.joined), problem.x) - friction
    residual, unknowns = ca.vertcat(balance, problem.joined), ca.vertcat(problem.x, multipliers)
    given = [unknowns, share, rubs, last, drag]
    equations = ca.Function("equations", given, [residual, ca.jacobian(residual, unknowns)])
    update = ca.Function("update", given, [ca.horzcat(*after)])
    x = np.concatenate([problem.start, np.zeros(problem.joined.numel())])
    at: list[Any] = [0.0, problem.start, np.zeros(drag.shape)]
    for factor in factors:
        end = _newton(lambda x, factor=factor, at=at: equations(x, factor, *at), x)
        if end is None:
            return None
        x = end
        at = [1.0, x[: problem.x.numel()], update(x, factor, *at).full()]
    return problem.ends(x[: problem.x.numel()])


def _matrix(quaternion: Any) -> Any:
    """Rotation matrix of a unit quaternion w x y z."""
    w, x, y, z = ca.vertsplit(quaternion)
    across = ca.vertcat(w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y))
    return ca.horzcat(across, ca.cross(_tangent(quaternion), across), _tangent(quaternion))


def _newton(equations: Any, x: Array) -> Array | None:
    """Root of equations that have corners, by halved steps; None where they do not fall."""
    residual, jacobian = equations(x)
    for _ in range(60):
        size = float(ca.norm_2(residual))
        if size < 1e-11:
            return x
        step = spsolve(csc_matrix(jacobian.sparse()), residual.full()[:, 0])
        for halving in range(12):
            trial = x - 0.5**halving * step
            residual, jacobian = equations(trial)
            if float(ca.norm_2(residual)) < size:
                break
        x = trial
    return None


def _problem(scene: Table, poses: Poses, share: Any = 1.0) -> _Problem:
    chains = {rod["name"]: _chain(scene, rod, *poses[rod["name"]], share) for rod in scene["rods"]}
    gaps = list(_gaps(scene, chains))
    energy = sum(chain.energy for chain in chains.values())
    energy += sum(_layer(obstacle, gap, lengths) for obstacle, gap, lengths in gaps if "width" in obstacle)
    energy += sum(
        _pair_energy(pair, *(chains[name] for name in pair["rods"])) for pair in scene.get("rod_contacts", [])
    )
    return _Problem(
        chains,
        ca.veccat(*[symbol for chain in chains.values() for symbol in (chain.turns, chain.ends)]),
        np.concatenate([value.ravel(order="F") for chain in chains.values() for value in chain.start]),
        energy,
        ca.vertcat(*[chain.joined for chain in chains.values()]),
        gaps,
    )


def _chain(scene: Table, rod: Table, positions: Array, rotations: Array, share: Any) -> Chain:
    name = rod["name"]
    loads = [load for load in scene.get("loads", []) if load.get("rod", name) == name]
    data = rod_of({**scene, "rods": [rod], "loads": loads, "bodies": []})
    N = len(rotations)
    h = data.length / N
    base = Rotation.from_matrix(data.base_rotation)
    planar = rod["strain"] == "planar"
    if planar:
        turns = ca.SX.sym(name, 1, N)
        relative = (base.inv() * Rotation.from_matrix(rotations)).as_matrix()
        start = np.unwrap(np.arctan2(relative[:, 0, 2], relative[:, 2, 2]))[None]
        flat = ca.vertcat(ca.cos(turns / 2), ca.SX(1, N), ca.sin(turns / 2), ca.SX(1, N))
        quaternions = ca.horzcat(*[_product(base.as_quat(scalar_first=True), flat[:, k]) for k in range(N)])
    else:
        turns = quaternions = ca.SX.sym(name, 4, N)
        start = Rotation.from_matrix(rotations).as_quat(scalar_first=True)
        for k in range(1, N):
            start[k] *= np.sign(start[k] @ start[k - 1])
        start = start.T
    ends = ca.SX.sym(f"{name}_ends", 3, N)
    points = ca.horzcat(ca.DM(data.base_position), ends)
    tangents = ca.horzcat(*[_tangent(quaternions[:, k]) for k in range(N)])
    joined = [ca.vec(ca.diff(points, 1, 1) - h * tangents)]
    if not planar:
        joined.append(ca.sum1(turns**2).T - 1)
    lengths = np.full(N, h)
    lengths[-1] = h / 2
    energy = ca.SX(0)
    before, apart = ca.DM(base.as_quat(scalar_first=True)), h / 2
    for k in range(N):
        stiffness = _stiffness(data.compliance((k + 0.25 * (k == 0)) / N))
        bend = 2 * _vector_part(before, quaternions[:, k]) / apart
        energy += apart * ca.sumsqr(ca.sqrt(stiffness) * bend) / 2
        before, apart = quaternions[:, k], h
    for k in range(N):
        energy -= share * lengths[k] * ca.dot(data.dead_load((k + 1) / N)[:3], ends[:, k])
    for point in data.points:
        low = min(int(point.at * N), N - 1)
        share = point.at * N - low
        energy -= ca.dot(point.force, (1 - share) * points[:, low] + share * points[:, low + 1])
    for body in _bodies_at(scene, name):
        energy -= share * body["mass"] * ca.dot(_gravity(scene), ends[:, -1])
    radius = float(rod.get("section", {}).get("radius", 0.0))
    return Chain(
        turns, ends, ca.vertcat(*joined), energy, (start, positions[1:].T), lengths, radius, data.base_position
    )


def _stiffness(compliance: Array) -> ca.DM:
    """Stiffnesses of bending about x and y and of torsion; none where a strain is not admitted."""
    diagonal = np.diag(np.asarray(compliance))[:3] if np.ndim(compliance) == 2 else np.asarray(compliance)[:3]
    return ca.DM(np.divide(1.0, diagonal, out=np.zeros(3), where=diagonal > 0))


def _product(first: Any, second: Any) -> ca.SX:
    first, second = ca.SX(ca.DM(first)) if not isinstance(first, ca.SX) else first, second
    return ca.vertcat(
        first[0] * second[0] - ca.dot(first[1:], second[1:]),
        first[0] * second[1:] + second[0] * first[1:] + ca.cross(first[1:], second[1:]),
    )


def _vector_part(first: Any, second: Any) -> Any:
    """Vector part of the rotation from the first to the second quaternion, in axes of the first, 3×1."""
    return first[0] * second[1:] - second[0] * first[1:] - ca.cross(first[1:], second[1:])


def _tangent(quaternion: Any) -> Any:
    w, x, y, z = ca.vertsplit(quaternion)
    return ca.vertcat(2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z)


def _gravity(scene: Table) -> Array:
    return np.sum([load["acceleration"] for load in scene["loads"] if load["kind"] == "gravity"] or [[0, 0, 0]], axis=0)


def _bodies_at(scene: Table, rod: str) -> list[Table]:
    names = {joint["body"] for joint in scene.get("joints", []) if joint["rod"] == rod}
    return [body for body in scene.get("bodies", []) if body["name"] in names]


def _gaps(scene: Table, chains: Mapping[str, Chain]) -> Iterator[tuple[Table, ca.SX, Array]]:
    """Each obstacle, gaps of the ends of one rod, 1×N, or of one body, and the lengths that they stand for."""
    carriers = {body["name"]: name for name in chains for body in _bodies_at(scene, name)}
    radii = {body["name"]: body.get("radius") for body in scene.get("bodies", [])}
    for obstacle in scene.get("obstacles", []):
        at = chains[carriers[obstacle["body"]]].ends[:, -1] if "body" in obstacle else ca.SX(3, 1)
        bodies = obstacle.get("bodies", [])
        for name in obstacle.get("rods", [] if bodies else list(chains)):
            chain = chains[name]
            points = chain.ends if "width" in obstacle else chain.densely
            yield obstacle, _distance(obstacle, points, at) - chain.radius, chain.lengths
        for name in bodies:
            yield obstacle, _distance(obstacle, chains[carriers[name]].ends[:, -1], at) - radii[name], np.ones(1)


def _distance(obstacle: Table, points: ca.SX, at: ca.SX) -> ca.SX:
    """Distance of points from a surface, 1×k, m; `at` is where the body of the obstacle is."""
    if obstacle["kind"] == "plane":
        normal = np.array(obstacle["normal"]) / np.linalg.norm(obstacle["normal"])
        return normal[None] @ (points - ca.repmat(ca.DM(obstacle["point"]) + at, 1, points.shape[1]))
    if obstacle["kind"] == "sphere":
        away = points - ca.repmat(ca.DM(obstacle["centre"]) + at, 1, points.shape[1])
        return ca.sqrt(ca.sum1(away**2)) - obstacle["radius"]
    start, axis = np.array(obstacle["from"]), np.subtract(obstacle["to"], obstacle["from"])
    away = points - ca.repmat(ca.DM(start), 1, points.shape[1])
    share = ca.fmin(ca.fmax(ca.DM(axis[None]) @ away / (axis @ axis), 0), 1)
    return ca.sqrt(ca.sum1((away - ca.DM(axis) @ share) ** 2)) - obstacle["radius"]


def _layer(obstacle: Table, gap: ca.SX, lengths: Array) -> ca.SX:
    width, stiffness = obstacle["width"], obstacle["stiffness"]
    stored = stiffness * ca.fmax(width - gap, 0) ** 4 / (12 * width**2)
    return ca.dot(ca.DM(lengths), stored.T)


def _pair_energy(pair: Table, first: Chain, second: Chain) -> ca.SX:
    """Energy of the layer between two rods, from sums over all pairs of ends."""
    width, touching = pair["width"], first.radius + second.radius
    square = (touching + width) ** 2 - touching**2
    coefficient = 5 * pair["stiffness"] / (32 * square**1.5 * (5 * touching**2 - square))
    energy = ca.SX(0)
    for k, length in enumerate(first.lengths):
        away = second.ends - ca.repmat(first.ends[:, k], 1, second.ends.shape[1])
        inside = ca.fmax((touching + width) ** 2 - ca.sum1(away**2), 0) ** 3
        energy += length * coefficient * ca.dot(ca.DM(second.lengths), inside.T)
    return energy
