"""Rods that touch rods without a width, at rest: beams, shooting, balance, derivatives, and random pairs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cosserat_casadi import Outcome, Solution, build, follow, linearise, simulate, solve, sweep
from cosserat_casadi.equilibrium.contact.contact_search import equations_at
from cosserat_casadi.equilibrium.contact.passing_through import lines_cross_between
from cosserat_casadi.equilibrium.contact.rod_gaps import distance_of_lines
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.derivatives import central_differences

LENGTH = 0.1
MODULUS = 2e6
POISSON = 0.45

Table = dict[str, Any]


def bending(radius: float) -> float:
    """EI, N m²."""
    return MODULUS * np.pi * radius**4 / 4


def rod(name: str, radius: float, base: Table, **more: Any) -> Table:
    """A rod of rubber."""
    material = {"youngs_modulus": MODULUS, "poisson_ratio": POISSON, "density": 1100.0}
    section = {"shape": "circle", "radius": radius}
    own = {"name": name, "length": LENGTH, "strain": "kirchhoff", "base": base}
    return own | {"material": material, "section": section} | more


def pressed(push: list[float], other: Table, radii: tuple[float, float] = (1e-3, 1e-3), **more: Any) -> Table:
    """A cantilever along x whose tip a force pushes on another cantilever."""
    rods = [rod("a", radii[0], {"tangent": [1, 0, 0]}), rod("b", radii[1], other)]
    loads = [{"name": "push", "kind": "tip_wrench", "rod": "a", "force": push}]
    contacts = [{"rods": ["a", "b"], "exact": True}]
    shared = {"schema": 1, "rods": rods, "loads": loads, "inputs": ["push.force"], "rod_contacts": contacts}
    return shared | {"accuracy": {"modes": 6, "nodes": 12}} | more


BELOW = {"position": [0.07, -0.05, -0.004], "tangent": [0, 1, 0]}


@cache
def crossed() -> Solution:
    """Two cantilevers of which the upper one is pushed down, bends by a third of its length and slides."""
    return solve(build(scene_from_dict(pressed([0, 0, -1e-3], BELOW))))


@dataclass(frozen=True)
class Shooting:
    """Two inextensible rods that touch at a section of either, integrated by SciPy.

    Attributes:
        radii: of both rods, m.
        bases: their positions, m, and rotations.
        forces: on their tips, N.
        held: whether the place on each is an end, which does not move.
    """

    radii: tuple[float, float]
    bases: tuple[tuple[FloatArray, FloatArray], ...]
    forces: tuple[FloatArray, ...]
    held: tuple[bool, bool]

    def solved(self, solution: Solution) -> tuple[FloatArray, FloatArray, float]:
        """Positions of the tips, shape (2, 3), places, shape (2,), and force, from a start at a solution."""
        (contact,) = solution.contacts
        units = [bending(radius) / LENGTH for radius in self.radii]
        moments = [-solution.base_wrench(name).moment / unit for name, unit in zip("ab", units, strict=True)]
        start = np.concatenate([*moments, contact.force, contact.on_rods or ()])
        scale = np.concatenate([np.ones(6), np.full(3, max(contact.ends[0], units[0] / LENGTH)), np.ones(2)])

        def residual(sought: FloatArray) -> FloatArray:
            return self._residual(scale * sought, start, scale)[0]

        first = start / scale
        mirrored = first * np.where(np.arange(11) < 6, -1.0, 1.0)
        first = min((first, mirrored), key=lambda guess: float(np.abs(residual(guess)).max()))
        found = fsolve(residual, first, xtol=1e-12)
        rest, tips, force = self._residual(scale * found, start, scale)
        assert np.abs(rest).max() < 1e-9
        return tips, found[9:], force

    def _residual(
        self, sought: FloatArray, start: FloatArray, scale: FloatArray
    ) -> tuple[FloatArray, FloatArray, float]:
        push, places = sought[6:9], sought[9:]
        ends, sections, tips = [], [], []
        for k, sign in enumerate((1.0, -1.0)):
            unit = bending(self.radii[k]) / LENGTH
            state = np.concatenate([self.bases[k][0], self.bases[k][1].ravel(), sought[3 * k : 3 * k + 3] * unit])
            touching = self._along(state, self.forces[k] + sign * push, places[k], k)
            tip = self._along(touching, self.forces[k], 1.0 - places[k], k)
            sections.append(touching)
            tips.append(tip[:3])
            ends.append(tip[12:] / unit)
        apart = sections[0][:3] - sections[1][:3]
        normal = apart / np.linalg.norm(apart)
        gap = (np.linalg.norm(apart) - sum(self.radii)) / LENGTH
        force = float(push @ normal)
        slopes = [
            places[k] - start[9 + k] if self.held[k] else normal @ sections[k][3:12].reshape(3, 3)[:, 2]
            for k in range(2)
        ]
        rest = np.concatenate([*ends, (push - force * normal) / scale[6] + gap * normal, slopes])
        return rest, np.array(tips), force

    def _along(self, state: FloatArray, force: FloatArray, share: float, k: int) -> FloatArray:
        """Position, rotation and moment of a section from those of another a share of the length before it."""
        stiffness = bending(self.radii[k]) * np.array([1.0, 1.0, 1 / (1 + POISSON)])
        if share == 0.0:
            return state

        def rates(_: float, y: FloatArray) -> FloatArray:
            rotation = y[3:12].reshape(3, 3)
            x, y_, z = rotation.T @ y[12:] / stiffness
            turned = rotation @ np.array([[0, -z, y_], [z, 0, -x], [-y_, x, 0]])
            return np.concatenate([rotation[:, 2], turned.ravel(), -np.cross(rotation[:, 2], force)])

        span = (0.0, share * LENGTH)
        return np.asarray(solve_ivp(rates, span, state, method="DOP853", rtol=1e-10, atol=1e-13).y[:, -1])


def shot(solution: Solution, radii: tuple[float, float], forces: tuple[FloatArray, ...]) -> tuple[float, float, float]:
    """Errors of the tips, over the length, of the places, and of the force, over the larger of itself and EI/ℓ²."""
    (contact,) = solution.contacts
    assert contact.on_rods is not None
    bases = tuple((pose.position, pose.rotation) for pose in (solution.pose(0.0, name) for name in "ab"))
    held = tuple(place in (0.0, 1.0) for place in contact.on_rods)
    tips, places, force = Shooting(radii, bases, forces, (held[0], held[1])).solved(solution)
    own = np.array([solution.pose(1.0, name).position for name in "ab"])
    of_force = abs(force - contact.ends[0]) / max(force, bending(radii[0]) / LENGTH**2)
    return (
        float(np.linalg.norm(own - tips, axis=1).max() / LENGTH),
        float(np.abs(places - contact.on_rods).max()),
        of_force,
    )


@pytest.mark.slow
def test_crossed_rods_are_those_of_shooting_within_the_told_error() -> None:
    found = crossed()
    (contact,) = found.contacts
    assert (contact.owner, contact.obstacle, contact.kind) == ("a", "b", "point")
    assert found.stable
    errors = shot(found, (1e-3, 1e-3), (np.array([0, 0, -1e-3]), np.zeros(3)))
    assert found.error_estimate is not None and found.error_estimate < 1e-7
    assert max(errors) < found.error_estimate


@pytest.mark.slow
def test_contacts_that_do_not_hold_from_cushions_are_found_as_loads_grow() -> None:
    """From the shape on cushions no contacts hold at the middle force; from a neighbouring equilibrium they do."""
    stiff = {"youngs_modulus": 3e9, "poisson_ratio": 0.4, "density": 1200.0}
    rods = [
        rod("a", 1e-3, {"tangent": [1, 0, 0]}, length=0.3),
        rod("b", 1.5e-3, {"position": [0.18, -0.12, -0.01], "tangent": [0, 1, 0]}, length=0.25),
    ]
    loads = [{"name": "push", "kind": "tip_wrench", "rod": "a", "force": [0, 0, -0.03]}]
    tables = {"schema": 1, "loads": loads, "rod_contacts": [{"exact": True}], "accuracy": {"modes": 5, "nodes": 12}}
    bent = [own | {"material": stiff, "strain": ["bending_x", "bending_y"]} for own in rods]
    model = build(scene_from_dict(tables | {"rods": bent}))
    near = solve(model, estimate_error=False)
    found, wanted = (
        solve(model, {"push.force": [0, 0, -0.035]}, start=start, estimate_error=False) for start in (None, near)
    )
    assert found.converged and wanted.converged
    assert_allclose(found.contacts[0].on_rods, wanted.contacts[0].on_rods, rtol=0, atol=1e-9)


def test_what_one_rod_bears_the_other_presses_with() -> None:
    found = crossed()
    (contact,) = found.contacts
    # The lower rod has no load: its clamp bears the push, through the point where the rods touch.
    clamp = found.base_wrench("b")
    lower = found.pose(contact.on_rods[1], "b").position - found.pose(0.0, "b").position  # type: ignore[index]
    assert_allclose(clamp.force, contact.force, rtol=0, atol=1e-12 * contact.ends[0])
    assert_allclose(clamp.moment, np.cross(lower, contact.force), rtol=0, atol=1e-12 * contact.ends[0] * LENGTH)
    upper = found.base_wrench("a").force + clamp.force
    assert_allclose(upper, [0, 0, 1e-3], rtol=0, atol=1e-15)


def thin_pair(radius: float) -> tuple[Table, FloatArray]:
    """Two crossed cantilevers of one radius, pushed like those of :func:`crossed`, and the force on the upper one."""
    push = np.array([0, 0, -1e-3 * (radius / 1e-3) ** 4])
    below = BELOW | {"position": [0.07, -0.05, -0.002 - 2 * radius]}
    return pressed(push.tolist(), below, (radius, radius)), push


def test_cushions_of_thin_rods_push_them_apart() -> None:
    """Wires much thinner than the cushion between them, by which the search for their contact begins."""
    tables, push = thin_pair(1e-4)
    found = solve(build(scene_from_dict(tables)))
    (contact,) = found.contacts
    assert found.converged and found.stable
    assert contact.on_rods is not None
    upper, lower = (found.pose(X, name).position for X, name in zip(contact.on_rods, "ab", strict=True))
    assert_allclose(np.linalg.norm(upper - lower), 2e-4, rtol=0, atol=1e-9 * LENGTH)
    clamps = found.base_wrench("a").force + found.base_wrench("b").force
    assert_allclose(clamps, -push, rtol=0, atol=1e-11 * np.linalg.norm(push))


@pytest.mark.slow
@pytest.mark.parametrize("radius", [2e-5, 1e-4, 3e-4])
def test_crossed_wires_are_those_of_shooting_within_the_told_error(radius: float) -> None:
    tables, push = thin_pair(radius)
    found = solve(scene_from_dict(tables | {"accuracy": {"tolerance": 1e-6}}))
    assert found.converged and found.error_estimate is not None
    assert max(shot(found, (radius, radius), (push, np.zeros(3)))) < found.error_estimate


@pytest.mark.slow
def test_wires_that_slide_far_are_those_of_shooting_within_the_told_error() -> None:
    """On cushions a wire slides in jerks, and stalls: the loads grow in exact contact instead."""
    radius = 6e-4 * LENGTH
    # The pushed rod is the first one, along x; the other one turns to it.
    other = {"position": [0.0975, -0.0332, 0.0], "tangent": [-0.573, -0.8196, 0]}
    other["position"] = [*(0.068 * np.array([1.0, 0, 0]) + 0.0405 * np.array([0.573, 0.8196, 0]))[:2], -0.0028]
    turned = np.array([[-0.573, 0.8196, 0], [-0.8196, -0.573, 0], [0, 0, 1.0]])
    push = 4.5 * bending(radius) / LENGTH**2 * turned @ [-0.178, -0.254, -0.951]
    tables = pressed(push.tolist(), other, (radius, radius), accuracy={"tolerance": 1e-4})
    found = solve(scene_from_dict(tables))
    assert found.converged and found.error_estimate is not None
    assert max(shot(found, (radius, radius), (push, np.zeros(3)))) < found.error_estimate


def test_jacobian_is_that_by_differences() -> None:
    equations, z = equations_at(crossed())
    jacobian = equations.jacobian(z, equations.given)
    differences = central_differences(lambda z: equations.residual(z, equations.given), z, 1e-6)
    assert_allclose(jacobian, differences, rtol=0, atol=1e-8 * np.abs(jacobian).max())


def test_small_changes_slide_along_both_rods() -> None:
    found = crossed()
    equations, z = equations_at(found)
    moved = equations.moved(z, np.eye(3), np.zeros((0, 3)))
    model = linearise(found)
    gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
    tip = equations.model.tip["a"]
    shifts = []
    for step in (1e-7, -1e-7):
        x, inputs, places = equations.arguments(z + step * moved[:, 2], equations.given + step * np.eye(3)[2])
        shifts.append(np.asarray(tip(x, inputs, places)[0].full())[:, 0])
    by_push = (shifts[0] - shifts[1]) / 2e-7
    assert_allclose(gain[:3, 2], by_push, rtol=1e-4, atol=1e-4 * np.abs(by_push).max())


def test_light_pushes_bend_rods_as_beams() -> None:
    """A load P at the tip ℓ, contact at a and b: N (a³ + b³/ratio)/3 = P a² (3ℓ − a)/6."""
    stiffer = 16.0
    radii = (1e-3, 2e-3)
    push = 1e-4 * bending(radii[0]) / LENGTH**2
    other = {"position": [0.07, -0.06, -sum(radii)], "tangent": [0, 1, 0]}
    tables = pressed([0, 0, -push], other, radii, accuracy={"modes": 4, "nodes": 8})
    found = solve(build(scene_from_dict(tables)), estimate_error=False)
    (contact,) = found.contacts
    a, b = 0.07, 0.06
    by_hand = push * a**2 * (3 * LENGTH - a) / 2 / (a**3 + b**3 / stiffer)
    assert_allclose(contact.ends[0], by_hand, rtol=1e-4, atol=0)
    assert_allclose(contact.on_rods or (), (0.7, 0.6), rtol=0, atol=1e-4)


def test_lines_cross_only_where_they_meet_on_the_way() -> None:
    along = np.linspace(-1.0, 1.0, 9)[:, None]
    first = along * [1.0, 0.0, 0.0]
    second = along * [0.1, 1.0, 0.0] + [0.05, 0.0, -0.5]
    up = np.array([0.0, 0.0, 1.0])
    beyond = second + up
    assert lines_cross_between([first, first], [second, beyond])
    assert not lines_cross_between([first, first], [second, second + 0.49 * up])
    # It goes by beside the end of the first line.
    aside = np.array([1.2, 0.0, 0.0])
    assert not lines_cross_between([first, first], [second + aside, beyond + aside])


def test_derivatives_of_a_distance_of_lines_are_those_by_differences() -> None:
    points, ways, bends = np.random.default_rng(0).normal(size=(3, 2, 3))

    def lines(at: FloatArray) -> list[list[FloatArray]]:
        """Two parabolas at a point of either, with their derivatives."""
        return [
            [points[k] + ways[k] * t + bends[k] * t**2 / 2, ways[k] + bends[k] * t, bends[k]] for k, t in enumerate(at)
        ]

    at = np.array([0.3, -0.2])
    _, slopes, curvatures = distance_of_lines(*lines(at))
    by_differences = central_differences(lambda t: distance_of_lines(*lines(t))[0], at, 1e-6)
    assert_allclose(slopes, by_differences[0], rtol=0, atol=1e-8)
    of_slopes = central_differences(lambda t: distance_of_lines(*lines(t))[1], at, 1e-6)
    assert_allclose(curvatures, of_slopes, rtol=0, atol=1e-8)


def random_pair(seed: int) -> tuple[Table, tuple[float, float], tuple[FloatArray, FloatArray]]:
    """Two cantilevers that cross, or nearly so, with forces on both tips; of odd numbers more strongly bent."""
    random = np.random.default_rng(seed)
    first, second = (float(radius) for radius in random.choice([5e-4, 1e-3, 2e-3, 4e-3], 2))
    along = [random.choice([random.uniform(0.3, 1.0), 1.0]) for _ in range(2)]
    turn = random.uniform(0.25, 0.75) * np.pi * random.choice([-1, 1])
    tilt = random.uniform(-0.3, 0.3)
    tangent = np.array([np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)])
    gap = random.uniform(0.0, 0.06) * LENGTH
    position = np.array([along[0] * LENGTH, 0, -first - second - gap]) - along[1] * LENGTH * tangent
    way = gap + random.uniform(0.0, 1.0 if seed % 2 else 0.3) * LENGTH
    push = np.array([*random.uniform(-0.3, 0.3, 2), -1.0]) * 3 * bending(first) / LENGTH**3 * way
    pull = random.uniform(-1.0, 1.0, 3) * 0.3 * bending(second) / LENGTH**2
    other = {"position": position.tolist(), "tangent": tangent.tolist()}
    tables = pressed(push.tolist(), other, (first, second), accuracy={"tolerance": 1e-4})
    tables["loads"].append({"name": "pull", "kind": "tip_wrench", "rod": "b", "force": pull.tolist()})
    return tables, (first, second), (push, pull)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_random_pairs_are_right_or_told(seed: int) -> None:
    tables, radii, forces = random_pair(seed)
    found = solve(scene_from_dict(tables))
    if not found.converged:
        assert found.outcome in (Outcome.CONTACT_UNSETTLED, Outcome.UNRESOLVED, Outcome.LOAD_STALLED), found.message
        return
    X = np.linspace(0.0, 1.0, 2001)
    centres = [found.pose(X, name).position for name in "ab"]
    apart = min(float(np.linalg.norm(centres[0] - point, axis=1).min()) for point in centres[1])
    assert apart > sum(radii) - 1e-6 * LENGTH
    assert len(found.contacts) <= 1
    if found.contacts:
        assert found.error_estimate is not None
        assert found.contacts[0].ends[0] > 0.0
        assert max(shot(found, radii, forces)) < max(found.error_estimate, 1e-9)


@pytest.mark.slow
def test_smooth_contact_tends_to_it() -> None:
    """The tip is off by about as much as the width lets rods stay apart."""
    tables = pressed([0, 0, -3e-4], BELOW, accuracy={"modes": 12, "nodes": 20})
    exact = solve(build(scene_from_dict(tables))).pose(1.0, "a").position
    distances = []
    for width in (8e-4, 4e-4, 2e-4):
        tables["rod_contacts"] = [{"rods": ["a", "b"], "width": width}]
        smooth = solve(build(scene_from_dict(tables)), estimate_error=False)
        assert smooth.converged
        distances.append(float(np.linalg.norm(smooth.pose(1.0, "a").position - exact)))
    rates = np.log2(np.array(distances[:-1]) / distances[1:])
    assert_allclose(rates, 1.0, rtol=0, atol=0.25)


@pytest.mark.slow
def test_a_damped_motion_comes_to_rest_on_it() -> None:
    tables = pressed([0, 0, -3e-4], BELOW, accuracy={"modes": 3, "nodes": 6})
    for table in tables["rods"]:
        table["damping"] = {"retardation_time": 0.2}
    rest = solve(build(scene_from_dict(tables)))
    tables["simulation"] = {"duration": 4.0, "start": "unloaded", "tolerance": 1e-3, "frames": 3}
    motion = simulate(build(scene_from_dict(tables), moving=True))
    assert motion.converged, motion.message
    for name in "ab":
        last = motion.tip(name).position[-1]
        assert_allclose(last, rest.pose(1.0, name).position, rtol=0, atol=2e-3 * LENGTH)


@pytest.mark.slow
def test_rods_whose_bases_float_touch() -> None:
    """A rod that another one carries with a corner: its base is an unknown, and what carries it bears the force."""
    stem = rod("stem", 1e-3, {"position": [0.07, -0.06, -0.024], "tangent": [0, 0, 1]}, length=0.02)
    carried = {"rod": "stem", "at": 1.0, "tangent": [0.1, 1.0, 0.0]}
    tables = pressed([0, 0, -5e-4], carried, accuracy={"modes": 4, "nodes": 8})
    tables["rods"].append(stem)
    found = solve(build(scene_from_dict(tables)))
    assert found.converged and found.stable and len(found.contacts) == 1
    assert_allclose(found.base_wrench("stem").force, found.contacts[0].force, rtol=0, atol=1e-14)
    equations, z = equations_at(found)
    jacobian = equations.jacobian(z, equations.given)
    differences = central_differences(lambda z: equations.residual(z, equations.given), z, 1e-6)
    assert_allclose(jacobian, differences, rtol=0, atol=1e-8 * np.abs(jacobian).max())


@pytest.mark.slow
def test_a_path_tells_where_rods_touch_slide_to_the_tip_and_lift_off() -> None:
    other = {"position": [0.096, -0.05, -0.004], "tangent": [0, 1, 0]}
    tables = pressed([0, 0, -1e-4], other, accuracy={"modes": 5, "nodes": 10})
    tables["loads"].append({"name": "pull", "kind": "tip_wrench", "rod": "b", "force": [0, 0, 0]})
    tables["inputs"].append("pull.force")
    model = build(scene_from_dict(tables))
    press = follow(model, "push.force", [0.0, 0.0, -1e-4])
    (touch,) = press.events
    assert press.converged and touch.kind == "touch" and touch.contact is not None
    # A beam bends by the gap of 2 mm at a = 0.096 m: P a² (3ℓ − a)/(6 EI).
    at_touch = 6 * bending(1e-3) * 2e-3 / (0.096**2 * (3 * LENGTH - 0.096))
    assert_allclose(touch.factor * 1e-4, at_touch, rtol=2e-3, atol=0)
    assert_allclose(touch.contact.on_rods or (), (0.96, 0.5), rtol=0, atol=1e-3)
    last = len(press.factor) - 1
    solved = solve(model, {"push.force": [0.0, 0.0, -1e-4]}, estimate_error=False)
    assert_allclose(press.solution(last).contacts[0].force, solved.contacts[0].force, rtol=0, atol=1e-12)
    assert press.smallest_eigenvalue is not None and solved.smallest_eigenvalue is not None
    assert_allclose(press.smallest_eigenvalue[last], solved.smallest_eigenvalue, rtol=1e-8, atol=0)
    outwards = follow(model, "pull.force", [1e-4, 0.0, 0.0])
    slide = next(event for event in outwards.events if event.contact is not None)
    assert slide.kind == "slide_to_tip" and slide.contact is not None and slide.contact.on_rods is not None
    assert slide.contact.on_rods[0] == 1.0
    down = follow(model, "pull.force", [0.0, 0.0, -6e-4])
    assert down.converged and [event.kind for event in down.events] == ["lift_off"]
    assert not down.contacts(len(down.factor) - 1)


@pytest.mark.slow
def test_rows_tell_where_rods_touch() -> None:
    model = build(scene_from_dict(pressed([0, 0, -3e-4], BELOW, accuracy={"modes": 5, "nodes": 10})))
    table = sweep(model, {"push.force.z": [-1e-6, -3e-4]}, cores=1)
    (contact,) = solve(model, estimate_error=False).contacts
    rows = {name: table.values[:, number] for number, name in enumerate(table.columns)}
    assert_allclose(rows["a.b.contacts"], [0.0, 1.0], rtol=0, atol=0)
    assert_allclose([rows["a.b.at"][1], rows["a.b.at_other"][1]], contact.on_rods or (), rtol=0, atol=1e-9)
    assert_allclose([rows[f"a.b.force.{axis}"][1] for axis in "xyz"], contact.force, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 11])
def test_nearly_parallel_rods_tell_their_error(seed: int) -> None:
    """Two rods along each other that end in one point of contact, against SciPy's shooting."""
    random = np.random.default_rng(1000 + seed)
    tilt = random.choice([0, 1e-4, 1e-3, 1e-2, 0.05]) * random.normal()
    rise = random.choice([0, 0, 1e-3, 1e-2]) * random.normal()
    way = np.array([random.choice([1, -1]), tilt, rise])
    way /= np.linalg.norm(way)
    shift = [random.uniform(-0.03, 0.03), random.choice([0, 0, 5e-4]) * random.normal()]
    below = [shift[0] + 0.1 * (way[0] < 0), shift[1], -(2e-3 + random.choice([1e-5, 3e-4, 1e-3]))]
    push = [0.0, 0.0, -float(random.choice([2e-4, 1e-3, 3e-3]))]
    tables = pressed(push, {"position": below, "tangent": way.tolist()}, accuracy={"modes": 7})
    solution = solve(build(scene_from_dict(tables)))
    assert solution.converged, solution.message
    off = shot(solution, (1e-3, 1e-3), (np.array(push), np.zeros(3)))
    assert max(off) < (solution.error_estimate or 0.0) + 1e-11
