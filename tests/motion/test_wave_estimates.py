"""Errors that are told of waves of sudden loads, twisting and stretching, beside d'Alembert's solution: from above.

A cone that is pulled has one as well: the displacement times the radius obeys the equation of a uniform rod.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Motion, Scene, build, discretise, scene_from_dict, simulate
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.felt_modes import (
    STRETCH,
    TWIST,
    arm_of_twist,
    lacking,
    lacking_at_fronts,
    let_through_at_tip,
)
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import paths
from tests.families import mostly_slow
from tests.motion import transients

PASSES = 8.0
"""Times that a wave passes the rod: two periods."""

ROWS = 1601

RISE = 2.0 - np.abs(np.mod(np.linspace(0.0, PASSES, ROWS), 4.0) - 2.0)
"""Displacement of the tip over the static one, at the times of a row: it rises to 2 and falls to 0, over and over."""

CARELESS = 6.0
"""An error is not told to be so many times what it is."""

FORCE, MOMENT = 0.2, 1.0
"""Of the rods without units, whose length, stiffness and speed of waves are one."""

WIRE = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0}
WIRE_RADIUS = 1e-3
WIRE_FORCE, WIRE_MOMENT = 1000.0, 0.05


CONE_RADIUS = 3e-3
"""At the base, m."""


def suddenly(kind: str, tolerance: float, modes: int | None = None) -> dict[str, Any]:
    """A clamped rod without damping that is pulled or twisted at its tip, with all of the load there from t = 0 on."""
    if kind == "twist":
        rod = {"strain": ["torsion"], "stiffness": {"torsion": 1.0}, "rotary_inertia": [1.0, 1.0, 1.0]}
        load = transients.at_tip(moment=[MOMENT, 0, 0])
    else:
        rod = {"strain": ["extension"], "stiffness": {"extension": 1.0}}
        load = transients.at_tip(force=[FORCE, 0, 0])
    scene = transients.table(rod, load, simulation=asked(PASSES, tolerance))
    if modes is not None:
        scene["accuracy"] = {"modes": modes, "nodes": modes + 2}
    return scene


def wire(kind: str, tolerance: float) -> dict[str, Any]:
    """A steel wire of 1 m with all six strains, pulled or twisted likewise."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "reissner",
        "material": WIRE,
        "section": {"shape": "circle", "radius": WIRE_RADIUS},
        "base": {"tangent": [1, 0, 0]},
    }
    force = [WIRE_FORCE if kind == "pull" else 0.0, 0, 0]
    moment = [WIRE_MOMENT if kind == "twist" else 0.0, 0, 0]
    stiffness = WIRE["youngs_modulus"] if kind == "pull" else shear_modulus()
    duration = PASSES / np.sqrt(stiffness / WIRE["density"])
    loads = [transients.at_tip(force=force, moment=moment)]
    return {"schema": 1, "rods": [rod], "loads": loads, "simulation": asked(duration, tolerance)}


def shear_modulus() -> float:
    return WIRE["youngs_modulus"] / 2.0 / (1.0 + WIRE["poisson_ratio"])


def asked(duration: float, tolerance: float) -> dict[str, Any]:
    return {"duration": float(duration), "start": "unloaded", "tolerance": tolerance, "frames": ROWS}


def missed(kind: str, motion: Motion, still: float) -> float:
    """Largest error of the tip, over the length; of its turn on the arm of a tolerance. ``still``: the static one."""
    tip = motion.tip()
    if kind == "pull":
        moved: FloatArray = tip.position[:, 0] - tip.position[0, 0]
        return float(np.abs(moved - still * RISE).max())
    along = np.abs(tip.quaternion @ tip.quaternion[0])
    turned = 2.0 * np.arctan2(np.sqrt(np.maximum(0.0, 1.0 - along**2)), along)
    return float(LEVER * np.abs(turned - still * RISE).max())


@pytest.mark.parametrize(
    ("kind", "modes"),
    mostly_slow(
        [(kind, modes) for kind in ("twist", "pull") for modes in (4, 6, 8, 12, 16, 24, 32)],
        quick=[("twist", 24), ("pull", 6)],
    ),
)
def test_errors_on_given_modes_are_told_from_above(kind: str, modes: int) -> None:
    motion = simulate(scene_from_dict(suddenly(kind, 3e-3, modes)))
    error = missed(kind, motion, MOMENT if kind == "twist" else FORCE)
    assert error < motion.error_estimate < CARELESS * error


def history_of(scene: Scene, modes: int, step_tolerance: float) -> History:
    """Its motion on so many modes, with next to no error of the steps."""
    simulation = scene.simulation
    assert simulation is not None
    model = build(scene, discretise(scene, modes, modes + 2), moving=True)
    return Simulator(model, simulation, started(model, simulation, None)).controlled(step_tolerance)


def pulled_by(history: History, duration: float) -> FloatArray:
    """Displacement of the tip along x at the times of a row, over the length."""
    times = np.linspace(0.0, duration, ROWS)
    place = paths(history.model, *history.rough_positions(times)).points[:, 0, 0]
    return np.asarray(place - place[0])


@pytest.mark.parametrize("modes", mostly_slow([4, 6, 9, 12, 16, 24, 32], quick=[6, 12]))
def test_last_coefficients_tell_the_error_at_fronts(modes: int) -> None:
    history = history_of(scene_from_dict(suddenly("pull", 1e-3)).with_motion_inputs(), modes, 1e-5)
    error = float(np.abs(pulled_by(history, PASSES) - FORCE * RISE).max())
    assert error < lacking_at_fronts(history, PASSES) < 3.0 * error


def test_given_modes_are_told_what_their_fronts_lack() -> None:
    """The distance from 10 modes, without regard to waves, would tell less."""
    modes = 6
    history = history_of(scene_from_dict(suddenly("pull", 1e-3)).with_motion_inputs(), modes, 1e-5)
    motion = simulate(scene_from_dict(suddenly("pull", 1e-3, modes)))
    assert motion.error_estimate > lacking_at_fronts(history, PASSES)


def chain(lengths: list[float], stiffnesses: list[float], duration: float) -> Scene:
    """Rods one after the other that only stretch, with waves of speed one, clamped and pulled at the last tip."""
    rods: list[dict[str, Any]] = []
    for number, (length, stiffness) in enumerate(zip(lengths, stiffnesses, strict=True)):
        rod = {"name": f"rod{number}", "length": length, "strain": ["extension"], "linear_density": stiffness}
        base = {"rod": rods[-1]["name"], "at": 1.0} if rods else {"tangent": [1, 0, 0]}
        rods.append(rod | {"stiffness": {"extension": stiffness}, "base": base})
    pull = transients.at_tip(rods[-1]["name"], force=[FORCE * min(stiffnesses), 0, 0])
    tables = {"schema": 1, "rods": rods, "loads": [pull], "simulation": asked(duration, 1e-3)}
    return scene_from_dict(tables).with_motion_inputs()


def of_chain(scene: Scene, modes: list[int], duration: float, moved: FloatArray) -> tuple[float, float]:
    """Error of its last tip's path on so many modes of each rod, and what is told of it by fronts, over its length."""
    names = [rod.name for rod in scene.rods]
    chosen = {name: discretise(scene, n, n + 2)[name] for name, n in zip(names, modes, strict=True)}
    model = build(scene, chosen, moving=True)
    assert scene.simulation is not None
    history = Simulator(model, scene.simulation, started(model, scene.simulation, None)).controlled(1e-5)
    times = np.linspace(0.0, duration, len(moved))
    # The base of the last rod is watched, too, and stands last.
    place = paths(model, *history.rough_positions(times)).points[:, -2, 0]
    error = float(np.abs(place - place[0] - moved / scene.rods[-1].length).max())
    return error, lacking_at_fronts(history, duration)


def test_what_a_long_rod_lacks_counts_over_the_length_of_a_short_one_at_its_tip() -> None:
    """Over that of the long rod a twentieth was told, and searches ended with three times the error that they told."""
    lengths = [2.0, 0.1]
    period = RISE[: ROWS // 2 + 1]
    duration = PASSES / 2.0 * sum(lengths)
    scene = chain(lengths, [1.0, 1.0], duration)
    error, told = of_chain(scene, [4, 4], duration, FORCE * sum(lengths) * period)
    assert error < told < CARELESS * error


def moved_beyond_a_step(thin: float, duration: int, rows: int) -> FloatArray:
    """Displacement of the tip of two rods of one length, impedances 1 and `thin`, with as many rows in a unit of time.

    Velocities are constant while waves pass a rod: v − N/Z runs to the tip, v + N/Z to the base.
    """
    to_joint, to_base, to_tip, back = 0.0, 0.0, 0.0, 0.0
    velocities = []
    for _ in range(duration):
        joint = (to_joint + thin * back) / (1.0 + thin)
        # The force is FORCE · thin.
        tip = to_tip + FORCE
        to_joint, to_base, to_tip, back = -to_base, 2.0 * joint - to_joint, 2.0 * joint - back, 2.0 * tip - to_tip
        velocities.append(tip)
    return np.concatenate([[0.0], np.cumsum(np.repeat(velocities, rows)) / rows])


def test_fronts_from_a_thick_rod_into_a_thin_one_are_told_from_above() -> None:
    """They grow at the step, and err by both rods: by the own law of each 0.7 of the error would be told."""
    duration = 12
    scene = chain([1.0, 1.0], [1.0, 1.0 / 3.0], float(duration))
    error, told = of_chain(scene, [9, 16], float(duration), moved_beyond_a_step(1.0 / 3.0, duration, 200))
    assert error < told < CARELESS * error


@pytest.mark.parametrize(
    ("thin", "duration", "tolerance", "is_met"),
    mostly_slow(
        [(0.05, 6, 2e-2, True), (0.2, 12, 4e-3, True), (1.0 / 3.0, 12, 6e-3, True), (1.0 / 3.0, 12, 2e-3, False)],
        quick=[(0.05, 6, 2e-2, True)],
    ),
)
def test_searches_in_a_chain_with_a_step_of_impedance_are_told_from_above(
    thin: float, duration: int, tolerance: float, is_met: bool
) -> None:
    """By fronts of long steps, 2.7e-3 were told of 3.0e-3; where the search gave up, 5.5e-3 of 5.7e-3.

    A thick rod that kept few modes, which its last coefficients called enough, left the error above the tolerance.
    """
    scene = chain([1.0, 1.0], [1.0, thin], float(duration))
    assert scene.simulation is not None
    asked_of = scene.simulation.model_copy(update={"tolerance": tolerance})
    motion = simulate(scene.model_copy(update={"simulation": asked_of}))
    moved = moved_beyond_a_step(thin, duration, 200)
    history: Any = motion.interpolant
    times = np.linspace(0.0, duration, len(moved))
    place = paths(motion.model, *history.__self__.rough_positions(times)).points[:, -2, 0]
    assert np.abs(place - place[0] - moved).max() < motion.error_estimate
    assert motion.converged == is_met


def twisted_with(base: dict[str, Any], length: float, stiffness: float = 1e6, **changes: Any) -> Scene:
    """A rod along x twisted by a tenth of MOMENT, which carries one of so little mass that its tip is free."""
    scene = suddenly("twist", 1e-2)
    scene["loads"][0]["moment"] = [0.1 * MOMENT, 0, 0]
    light = {"stiffness": {"torsion": stiffness}, "rotary_inertia": [1e-6] * 3, "linear_density": 1e-6}
    arm = {"name": "arm", "length": length, "strain": ["torsion"], **light, "base": {"rod": "rod", **base}}
    return scene_from_dict({**scene, "rods": [*scene["rods"], arm], **changes}).with_motion_inputs()


@pytest.mark.parametrize(
    ("base", "length", "arm"),
    [
        ({}, 0.5, LEVER),
        ({"tangent": [0, 1, 0]}, 0.5, 1.0),
        ({"tangent": [0, 3, 4]}, 2.0, 0.6),
        ({"position": [0, 0.2, 0]}, 0.1, 2.0),
    ],
)
def test_arm_of_a_twist(base: dict[str, Any], length: float, arm: float) -> None:
    """The distance of a carried rod's points from the axis over its own length; LEVER where it goes on straight."""
    scene = twisted_with(base, length)
    model = build(scene, discretise(scene, 4, 6), moving=True)
    assert_allclose(arm_of_twist(model, "rod"), arm, rtol=1e-12, atol=0)
    assert_allclose(arm_of_twist(model, "arm"), LEVER, rtol=1e-15, atol=0)


def test_arm_of_a_twist_that_turns_a_body() -> None:
    """A body is watched at its radius of gyration, over the length of the longest rod."""
    wheel = {"name": "wheel", "mass": 1.0, "inertia": [0.375] * 3}
    joint = {"kind": "fixed", "rod": "rod", "body": "wheel"}
    scene = twisted_with({}, 1.5, bodies=[wheel], joints=[joint])
    model = build(scene, discretise(scene, 4, 6), moving=True)
    assert_allclose(arm_of_twist(model, "rod"), 0.75 / 1.5, rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("modes", "stiffness"), mostly_slow([(6, 1e6), (9, 1e6), (6, 1.0)], quick=[(6, 1e6), (6, 1.0)])
)
def test_fronts_of_a_twist_count_at_the_arm_of_a_rod_across(modes: int, stiffness: float) -> None:
    """At an arm of LEVER a tenth was told, and searches ended with up to five times the error that they told.

    No twist runs into the rod across, however little its impedance: as if one did, 30 times as much would be told.
    """
    scene = twisted_with({"tangent": [0, 1, 0]}, 1.0, stiffness)
    history = history_of(scene, modes, 1e-5)
    tip = paths(history.model, *history.rough_positions(np.linspace(0.0, PASSES, ROWS))).points[:, 1, :]
    turn = 0.1 * MOMENT * RISE
    assert_allclose(tip[0], [1, 1, 0], rtol=0, atol=1e-12)
    exact = np.stack([np.ones(ROWS), np.cos(turn), np.sin(turn)], axis=1)
    error = float(np.linalg.norm(tip - exact, axis=1).max())
    assert error < lacking_at_fronts(history, PASSES) < CARELESS * error


def test_fronts_of_a_jump_after_a_motion_went_on_are_told() -> None:
    """On the modes that a first part fixed: 7e-4 of the length were told where 1.2e-3 were true."""
    begins, jumps, modes = 1.5, 2.0, 8
    scene = suddenly("twist", 1e-2, modes)
    scene["loads"][0]["moment"] = [0, 0, 0]
    table = {"times": [0, jumps], "values": [[0, 0, 0], [0.1 * MOMENT, 0, 0]], "interpolation": "step"}
    scene["motions"] = [{"input": "push.moment", **table}]
    first = simulate(scene_from_dict({**scene, "simulation": {**scene["simulation"], "duration": begins}}))
    motion = simulate(scene_from_dict(scene), start=first)
    tip = motion.tip().quaternion
    turned = 2.0 * np.arccos(np.minimum(1.0, np.abs(tip @ tip[0])))
    exact = 0.1 * MOMENT * np.where(motion.times < jumps, 0.0, 2.0 - np.abs(np.mod(motion.times - jumps, 4.0) - 2.0))
    error = float(LEVER * np.abs(turned - exact).max())
    assert error < motion.error_estimate < CARELESS * error


def cone(tip: float) -> Scene:
    """A steel cone of 1 m that only stretches, pulled at its tip, whose radius is so many times that of the base."""
    stretched: dict[str, Any] = wire("pull", 1e-3)
    section = {"shape": "circle", "radius": [CONE_RADIUS, tip * CONE_RADIUS]}
    stretched["rods"][0] |= {"strain": ["extension"], "section": section}
    return scene_from_dict(stretched).with_motion_inputs()


def cone_moved(tip: float) -> FloatArray:
    """Displacement of the tip of such a cone over F ℓ/(E A_base), at the times of a row.

    With the radius r over that at the base, φ = r u obeys φ″ = φ̈ in passes of the wave, and vanishes at the base: it is
    φ(X, t) = g(t + X − 1) − g(t − X − 1). The force r² u′ = r φ′ − r′ φ at the tip is 1, so that
    ġ(t) + α g(t) = 1/r − ġ(t − 2) + α g(t − 2) with α = −r′/r there. Interval by interval of 2 by the trapezoidal rule.
    """
    rate = (1.0 - tip) / tip
    rows = int(2.0 * (ROWS - 1) / PASSES)
    half_step = 1.0 / rows
    before, growth_before = np.zeros(rows + 1), np.zeros(rows + 1)
    moved: list[FloatArray] = []
    while len(moved) < PASSES / 2.0:
        driven = 1.0 / tip - growth_before + rate * before
        now = np.full(rows + 1, before[-1])
        for row in range(rows):
            risen = (1.0 - rate * half_step) * now[row] + half_step * (driven[row] + driven[row + 1])
            now[row + 1] = risen / (1.0 + rate * half_step)
        moved.append((now - before) / tip)
        before, growth_before = now, driven - rate * now
    return np.concatenate([*(one[:-1] for one in moved), moved[-1][-1:]])


@pytest.mark.parametrize(
    ("tip", "modes"),
    mostly_slow(
        [*((tip, modes) for tip in (0.125, 0.2, 0.5, 2.0) for modes in (4, 6, 9, 12, 16, 21)), (5.0, 9)],
        quick=[(0.125, 4), (0.125, 9), (5.0, 9)],
    ),
)
def test_last_coefficients_tell_the_error_at_the_fronts_of_a_cone(tip: float, modes: int) -> None:
    """Fronts grow as they run into a thin tip: by the law of a uniform rod 0.8 of the error would be told at 8 to 1.

    Of how much they fade towards a thick tip the root is believed.
    """
    duration = PASSES / np.sqrt(WIRE["youngs_modulus"] / WIRE["density"])
    history = history_of(cone(tip), modes, 1e-7 / max(1.0, tip**2))
    still = WIRE_FORCE / WIRE["youngs_modulus"] / np.pi / CONE_RADIUS**2
    error = float(np.abs(pulled_by(history, duration) - still * cone_moved(tip)).max())
    assert error < lacking_at_fronts(history, duration) < CARELESS * max(1.0, 0.5 * tip) * error


def test_a_search_goes_on_while_fronts_lack_more_than_modes_may_leave() -> None:
    """The last coefficients of a thin tip alone tell that six modes would do, and the fronts that they would not."""
    scene: dict[str, Any] = wire("twist", 3e-3)
    section = {"shape": "circle", "radius": [CONE_RADIUS, 0.25 * CONE_RADIUS]}
    scene["rods"][0] |= {"strain": ["torsion"], "section": section}
    scene["loads"] = [transients.at_tip(moment=[0.006, 0, 0])]
    motion = simulate(scene_from_dict(scene))
    assert motion.converged, motion.message
    assert motion.model.discretisation["rod"].modes > (6,)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [3e-2, 1e-2, 5e-3, 3e-3])
@pytest.mark.parametrize("kind", ["twist", "pull"])
def test_errors_on_chosen_modes_are_told_from_above(kind: str, tolerance: float) -> None:
    motion = simulate(scene_from_dict(suddenly(kind, tolerance)))
    assert missed(kind, motion, MOMENT if kind == "twist" else FORCE) < motion.error_estimate < tolerance


@pytest.mark.parametrize(
    ("kind", "tolerance"),
    mostly_slow(
        [("pull", 1e-3), ("pull", 1e-4), ("twist", 1e-2), ("twist", 3e-3), ("twist", 1e-3)], quick=[("twist", 1e-2)]
    ),
)
def test_a_steel_wire_is_told_from_above(kind: str, tolerance: float) -> None:
    motion = simulate(scene_from_dict(wire(kind, tolerance)))
    still = WIRE_FORCE / WIRE["youngs_modulus"] / np.pi / WIRE_RADIUS**2
    if kind == "twist":
        still = WIRE_MOMENT / shear_modulus() / (np.pi * WIRE_RADIUS**4 / 2.0)
    assert missed(kind, motion, still) < motion.error_estimate < tolerance


def test_the_arm_of_a_twist_follows_parameters() -> None:
    """The rod that goes along begins along the axis, or across: what the file has counts for neither."""
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}
    rod = {"strain": "kirchhoff", "stiffness": stiffness, "linear_density": 1.0, "rotary_inertia": [1e-3, 1e-3, 2e-3]}
    tilted = {"rod": "first", "at": 1.0, "quaternion": [np.cos(0.4), 0.0, np.sin(0.4), 0.0]}
    tables = {
        "schema": 1,
        "parameters": ["second.base.quaternion"],
        "accuracy": {"modes": 2, "nodes": 6},
        "rods": [{"name": "first", "length": 0.5, **rod}, {"name": "second", "length": 0.2, "base": tilted, **rod}],
    }
    model = build(scene_from_dict(tables), moving=True)
    for half, arm in ((0.0, 0.1), (np.pi / 8, np.sqrt(0.5)), (np.pi / 4, 1.0)):
        turned = model.at({"second.base.quaternion": [np.cos(half), 0.0, np.sin(half), 0.0]}).in_motion
        assert_allclose(arm_of_twist(turned, "first"), arm, rtol=1e-9, atol=0)


def turn_of_tip(history: History, times: FloatArray) -> FloatArray:
    """Turn of the tip of a rod that twists, at these times, rad."""
    _, _, rotations = evaluated(history.model.tip["rod"], *history.rough_positions(times))
    x_axes, tangent = rotations[:, :, 0], rotations[0, :, 2]
    return np.unwrap(np.arctan2(x_axes @ np.cross(tangent, x_axes[0]), x_axes @ x_axes[0]))


def test_waves_are_late_by_no_more_than_they_move() -> None:
    """As if they were later and later for ever, 37 times the error was told after 40 passes."""
    scene = suddenly("twist", 1e-3, 6)
    duration = 5.0 * PASSES
    scene["simulation"]["duration"] = duration
    history = history_of(scene_from_dict(scene).with_motion_inputs(), 6, 1e-5)
    times = np.linspace(0.0, duration, 5 * ROWS)
    exact = MOMENT * (2.0 - np.abs(np.mod(times, 4.0) - 2.0))
    error = float(LEVER * np.abs(turn_of_tip(history, times) - exact).max())
    assert error < lacking(history, duration) < 10.0 * error


def with_body(kind: str, changes: dict[str, Any], modes: int = 6, **tables: Any) -> Scene:
    """A rod of :func:`suddenly` with a body of mass 0.3 fixed to its tip, of the moment of inertia 0.2 about x."""
    scene = suddenly(kind, 1e-3, modes)
    body = {"name": "weight", "mass": 0.3, "inertia": [0.2, 0.15, 0.15], **changes}
    joint = {"kind": "fixed", "rod": "rod", "body": "weight"}
    return scene_from_dict({**scene, "bodies": [body], "joints": [joint], **tables}).with_motion_inputs()


@pytest.mark.parametrize(
    ("kind", "strain", "changes", "inertia"),
    [
        ("pull", STRETCH, {}, 0.3),
        ("pull", STRETCH, {"mass": 0.0}, 0.0),
        # The mass lies ahead of the tip, or beside it: then the body turns and gives way.
        ("pull", STRETCH, {"centre_of_mass": [0.0, 0.0, 0.2]}, 0.3),
        ("pull", STRETCH, {"centre_of_mass": [0.2, 0.0, 0.0]}, 1.0 / (1.0 / 0.3 + 0.2**2 / 0.15)),
        ("pull", STRETCH, {"centre_of_mass": [0.2, 0.0, 0.0], "inertia": [0.0, 0.0, 0.0]}, 0.0),
        ("twist", TWIST, {"inertia": [0.15, 0.15, 0.2]}, 0.2),
        ("twist", TWIST, {"inertia": [0.0, 0.0, 0.0]}, 0.0),
    ],
)
def test_a_body_at_the_tip_holds_it_by_its_inertia(
    kind: str, strain: int, changes: dict[str, Any], inertia: float
) -> None:
    """Of waves above the frequency n: the mass of the rod, its inertia and the speed of its waves are one."""
    scene = with_body(kind, changes)
    model = build(scene, discretise(scene), moving=True)
    assert_allclose(let_through_at_tip(model, "rod", strain), 1.0 / np.hypot(1.0, 6.0 * inertia), rtol=1e-12, atol=0)


def test_what_bends_a_rod_turns_the_body_at_its_tip() -> None:
    rod = {"strain": ["bending_x", "bending_y"], "stiffness": {"bending_x": 1.0, "bending_y": 2.0}}
    scene = with_body("pull", {}, rods=[{**suddenly("pull", 1e-3)["rods"][0], **rod}])
    model = build(scene, discretise(scene), moving=True)
    for strain in (0, 1):
        found = let_through_at_tip(model, "rod", strain)
        assert_allclose(found, np.hypot(1.0, 6.0 * 0.3) ** -0.5, rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    "changes",
    [
        {"joints": [{"kind": "fixed", "rod": "rod", "at": 0.5, "body": "weight"}]},
        {"joints": [{"kind": "spherical", "rod": "rod", "body": "weight"}]},
        {"accuracy": {"modes": 6, "nodes": 8, "shape": True}},
        {"bodies": []},
    ],
)
def test_a_tip_is_held_by_nothing_else(changes: dict[str, Any]) -> None:
    """A body elsewhere holds no tip, and where other sections are watched it does not matter."""
    tables = {**suddenly("pull", 1e-3, 6), "joints": [{"kind": "fixed", "rod": "rod", "body": "weight"}]}
    tables["bodies"] = [{"name": "weight", "mass": 0.3}]
    tables |= changes
    if not tables["bodies"]:
        del tables["joints"]
    scene = scene_from_dict(tables).with_motion_inputs()
    assert let_through_at_tip(build(scene, discretise(scene), moving=True), "rod", STRETCH) == 1.0


def weight_moved(mass: float) -> FloatArray:
    """Displacement of a mass at the tip of the pulled rod without units, at the times of a row.

    The wave w that leaves the tip comes back from the base as −w after two passes: the velocity v = w(t) − w(t − 2) of
    the tip obeys mass · v̇ = F − v − 2 w(t − 2). By the trapezoidal rule, row by row.
    """
    step = PASSES / (ROWS - 1)
    delay = round(2.0 / step)
    left = np.zeros(ROWS)
    velocity = np.zeros(ROWS)
    for row in range(1, ROWS):
        before, now = (left[at - delay] if at >= delay else 0.0 for at in (row - 1, row))
        driven = 2.0 * FORCE - 2.0 * (before + now) - velocity[row - 1]
        velocity[row] = (mass * velocity[row - 1] + 0.5 * step * driven) / (mass + 0.5 * step)
        left[row] = velocity[row] + now
    return np.concatenate([[0.0], np.cumsum(0.5 * step * (velocity[1:] + velocity[:-1]))])


@pytest.mark.parametrize(
    ("mass", "modes"),
    mostly_slow(
        [(mass, modes) for mass in (0.03, 0.1, 0.3, 1.0, 3.0) for modes in (4, 6, 9, 12)], quick=[(0.03, 6), (1.0, 9)]
    ),
)
def test_last_coefficients_tell_the_error_of_a_tip_with_a_mass(mass: float, modes: int) -> None:
    """It is a low pass: as if the tip were free, up to several hundred times the error was told."""
    history = history_of(with_body("pull", {"mass": mass, "inertia": [0.0] * 3}), modes, 1e-6)
    error = float(np.abs(pulled_by(history, PASSES) - weight_moved(mass)).max())
    assert error < lacking_at_fronts(history, PASSES) < 30.0 * error
    assert error < lacking(history, PASSES) < 40.0 * error
