"""Modes of scenes against closed forms and transfer matrices: lengths by L, time by L² √(ρA/EI)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, discretise, modes_of, scene_from_dict, solve
from cosserat_casadi.motion.eigenproblem import eigenpairs
from cosserat_casadi.motion.vibration_modes import ModesOutcome, small_motions
from tests.families import mostly_slow

CANTILEVER = [3.5160152685002, 22.034491564667, 61.697214413549, 120.90191605231, 199.8595301168]
FREE_FREE = [22.373285448061, 61.67282286792, 120.90339172712, 199.8594481272]
CLAMPED_PINNED = [15.41820571698, 49.9648620318, 104.24769645886]
UPRIGHT = [1.0, 0.0, 0.0, 0.0]
ARC = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0 / 1.3}


def rod(strain="planar", stiffness=None, **changes):
    plain = {
        "name": "rod",
        "length": 1.0,
        "strain": strain,
        "stiffness": stiffness or {"bending_y": 1.0},
        "linear_density": 1.0,
    }
    return {**plain, **changes}


def scene(rods, *loads, tolerance=1e-8, **changes):
    accuracy = {"tolerance": tolerance}
    return scene_from_dict({"schema": 1, "accuracy": accuracy, "rods": [rods], "loads": list(loads), **changes})


def thrust(size, frame="world"):
    return {"name": "thrust", "kind": "tip_wrench", "rod": "rod", "force": [0.0, 0.0, -size], "frame": frame}


def weight(*acceleration):
    return {"name": "weight", "kind": "gravity", "acceleration": list(acceleration)}


def frequencies(described, count):
    modes = modes_of(described, count=count)
    assert modes.outcome is ModesOutcome.RESOLVED
    return modes.angular_frequencies


def arc(angle):
    return rod("kirchhoff", ARC, length=angle, intrinsic={"curvature": [0.0, 1.0, 0.0]})


def helix(turns):
    """Radius 1, pitch 0.5."""
    rise = 0.5 / (2 * np.pi)
    squared = 1.0 + rise**2
    length = 2 * np.pi * turns * np.sqrt(squared)
    return rod("kirchhoff", ARC, length=length, intrinsic={"curvature": [0.0, 1.0 / squared, rise / squared]})


def round_section(diameter, shear_factor=None):
    """A round rod of this diameter over its length, ν = 0.3."""
    gyration = diameter**2 / 16
    inertia = [gyration, gyration, 2 * gyration]
    if shear_factor is None:
        return rod(rotary_inertia=inertia)
    shear = shear_factor / (2.6 * gyration)
    return rod(["bending_y", "shear_x"], {"bending_y": 1.0, "shear_x": shear}, rotary_inertia=inertia)


TIP_ON_THE_AXIS = {"rod": "rod", "position": [0.0, 0.0, 1.0]}

UNLOADED = {
    "cantilever": (scene(rod()), CANTILEVER, 1e-10),
    "clamped": (
        scene(rod(), supports=[{**TIP_ON_THE_AXIS, "kind": "clamped", "quaternion": UPRIGHT}]),
        FREE_FREE,
        1e-9,
    ),
    "pinned": (scene(rod(), supports=[{**TIP_ON_THE_AXIS, "kind": "pinned"}]), CLAMPED_PINNED, 1e-9),
    "axial": (scene(rod(["extension"], {"extension": 4.0})), np.pi * (2 * np.arange(3) + 1), 1e-9),
    "torsion": (
        scene(rod(["torsion"], {"torsion": 0.7}, rotary_inertia=[0.0, 0.0, 0.1])),
        np.sqrt(7.0) * np.pi * (np.arange(3) + 0.5),
        1e-9,
    ),
    "rotary": (scene(round_section(0.1)), [3.510918557, 21.814471080, 60.258748722, 115.839904455], 1e-9),
    "shear": (scene(round_section(0.1, 1.0)), [3.497804290, 21.275058968, 57.022467337, 105.616431183], 1e-9),
    "shear 0.9": (scene(round_section(0.1, 0.9)), [3.496355322, 21.217442768, 56.693473281], 1e-9),
    "stout": (scene(round_section(0.2, 1.0)), [3.445159216, 19.411375594, 47.907502910], 1e-9),
    "stout 0.9": (scene(round_section(0.2, 0.9)), [3.439658554, 19.238656987, 47.169426500], 1e-9),
    "quarter": (scene(arc(np.pi / 2)), [1.4517536886, 1.4981628842, 7.0149348258, 7.2249841179], 1e-9),
    "half": (scene(arc(np.pi)), [0.3996156575, 0.4351652796, 1.3300824195, 1.3749865422], 1e-9),
    "270°": (scene(arc(1.5 * np.pi)), [0.2211519792, 0.2474271204, 0.5180638998, 0.5422688731], 1e-9),
    "helix 1": (scene(helix(1)), [0.1683722809, 0.1893330136, 0.2916208191, 0.3117519959], 1e-9),
    "helix 2": (scene(helix(2)), [0.09732511822, 0.1070194881, 0.1351616487, 0.1395796447], 1e-9),
    "helix 4": (scene(helix(4)), [0.04516525728, 0.04579076759, 0.05617526874, 0.062994655], 2e-8),
}


@pytest.mark.parametrize(
    "name",
    mostly_slow(UNLOADED, quick=["helix 1"]),
)
def test_unloaded_rods(name):
    described, expected, tolerance = UNLOADED[name]
    assert_allclose(frequencies(described, len(expected)), expected, rtol=tolerance, atol=0)


COLUMN = {
    -1.0: [4.81477157025, 23.770134423],
    0.25: [3.07349918564, 21.5753681666],
    0.5: [2.53456021607, 21.1051723546],
    0.75: [1.81130345957, 20.623377714],
    0.9: [1.15327608015, 20.3285100384],
    0.99: [0.366216452545, 20.151],
}

BECK = {
    5.0: [4.21767523483, 20.435622435],
    10.0: [5.17576226128, 18.586794893],
    15.0: [6.62740668347, 16.2598297625],
    20.0: [10.5289421819, 11.5106166254],
}

OWN_WEIGHT = {
    -7.0: [1.151553226, 20.61276058, 60.26206154],
    -5.0: [2.118485944, 21.02928063, 60.67618825],
    -2.5: [2.903500329, 21.53805628],
    2.5: [4.035463391, 22.51940591],
    10.0: [5.291783357, 23.91199905, 63.68155425],
    100.0: [12.86874191, 36.50916713, 78.98032862],
    1000.0: [38.69550514, 92.28008610],
}

SAGGED = {
    5.0: ([0.846657179954, -0.495905044622], [4.115830897, 21.62035942, 58.3018636]),
    10.0: ([0.65635376124, -0.70019971551], [5.028974853, 21.61062774, 55.6443438]),
    20.0: ([0.445232052, -0.829881443], [6.528853173, 22.80512795, 54.574232]),
}


@pytest.mark.parametrize("load", mostly_slow([load for load in COLUMN if load < 0.99], quick=[0.75]))
def test_dead_thrust(load):
    described = scene(rod(), thrust(load * np.pi**2 / 4))
    assert_allclose(frequencies(described, 2), COLUMN[load], rtol=1e-9, atol=0)


def test_near_the_buckling_load():
    modes = modes_of(scene(rod(), thrust(0.99 * np.pi**2 / 4)), count=1)
    assert_allclose(modes.angular_frequencies, COLUMN[0.99][:1], rtol=1e-9, atol=0)
    assert "small motions stay small" in modes.message


def test_frequency_too_low_to_be_told_from_zero_is_bounded():
    """At 1 − 1e-8 of the load Rayleigh's quotient of the buckled shape, exact there, gives 3.7e-4 1/s."""
    modes = modes_of(scene(rod(), thrust((1 - 1e-8) * np.pi**2 / 4)), count=1)
    exact = np.sqrt(1e-8 * np.pi**4 / 32 / (1.5 - 4 / np.pi))
    assert modes.solution.stable
    assert modes.modes[0].eigenvalue == 0.0
    assert exact < modes.slowest < 5 * exact
    assert f"slower than {modes.slowest:.2g} 1/s" in modes.message


def test_at_and_beyond_the_buckling_load():
    critical = modes_of(scene(rod(), thrust(np.pi**2 / 4)), count=2)
    assert critical.modes[0].eigenvalue == 0.0
    assert "one motion meets no resistance" in critical.message.lower()
    beyond = modes_of(scene(rod(), thrust(1.1 * np.pi**2 / 4)), count=3)
    growing, decaying = beyond.modes[:2]
    assert growing.eigenvalue.imag == 0.0
    assert growing.eigenvalue.real > 1.0
    assert_allclose(decaying.eigenvalue, -growing.eigenvalue, rtol=1e-12, atol=0)
    assert growing.damping_ratio == -1.0
    assert "Statically unstable: one motion grows" in beyond.message


@pytest.mark.parametrize("load", mostly_slow(BECK, quick=[15.0]))
def test_follower_thrust(load):
    described = scene(rod(), thrust(load, "body"))
    modes = modes_of(described, count=2)
    assert_allclose(modes.angular_frequencies, BECK[load], rtol=1e-9, atol=0)
    assert_allclose(modes.eigenvalues.real, 0.0, rtol=0, atol=0)
    assert "unstable" not in modes.message


def test_flutter():
    """Two frequencies meet at P = 20.0509536189738, ω = 11.0155576409229."""
    below = modes_of(scene(rod(), thrust(20.05095, "body")), count=2)
    beyond = modes_of(scene(rod(), thrust(20.05096, "body")), count=2)
    assert "unstable" not in below.message
    assert "Dynamically unstable (flutter): one motion grows" in beyond.message
    assert_allclose(beyond.angular_frequencies, 11.0155576409229, rtol=1e-6, atol=0)
    assert_allclose(beyond.eigenvalues[1], -beyond.eigenvalues[0].conjugate(), rtol=1e-9, atol=0)


DAMPED_FLUTTER = {1e-5: 10.938849375, 1e-3: 10.939121997, 1e-2: 10.966111661}


@pytest.mark.parametrize("time", mostly_slow(DAMPED_FLUTTER, quick=[1e-3]))
def test_damping_lowers_the_flutter_load(time):
    critical = DAMPED_FLUTTER[time]
    growth = []
    for load in (critical - 1e-5, critical + 1e-5):
        described = scene(rod(damping={"retardation_time": time}), thrust(load, "body"), accuracy={"modes": 10})
        modes = modes_of(described, count=2)
        growth.append(modes.eigenvalues.real.max())
    assert growth[0] < 0.0 < growth[1]
    # The growth crosses zero on the straight line between both.
    crossing = critical - 1e-5 + 2e-5 * growth[0] / (growth[0] - growth[1])
    assert_allclose(crossing, critical, rtol=0, atol=2e-8)


@pytest.mark.parametrize("load", mostly_slow(OWN_WEIGHT, quick=[-7.0]))
def test_standing_and_hanging(load):
    expected = OWN_WEIGHT[load]
    assert_allclose(frequencies(scene(rod(), weight(0.0, 0.0, load)), len(expected)), expected, rtol=1e-8, atol=0)


@pytest.mark.parametrize("load", mostly_slow(SAGGED, quick=[20.0]))
def test_bent_by_its_own_weight(load):
    tip, expected = SAGGED[load]
    described = scene(rod(base={"tangent": [1.0, 0.0, 0.0]}), weight(0.0, 0.0, -load))
    modes = modes_of(described, count=3)
    position = modes.solution.tip().position
    assert_allclose(position[[0, 2]], tip, rtol=0, atol=1e-9)
    assert_allclose(modes.angular_frequencies, expected, rtol=8e-9, atol=0)


def test_free_rod_has_rigid_motions_and_the_frequencies_of_a_clamped_one():
    inertia = [1e-6, 1e-6, 2e-6]
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    described = scene(rod("kirchhoff", stiffness, base={"free": True}, rotary_inertia=inertia))
    modes = modes_of(described, count=10)
    assert_allclose(modes.eigenvalues[:6], 0.0, rtol=0, atol=0)
    assert_allclose(modes.angular_frequencies[6:], np.repeat(FREE_FREE[:2], 2), rtol=1e-4, atol=0)
    assert "6 motions meet no resistance" in modes.message


@pytest.mark.slow
def test_line_that_turns_about_itself_without_inertia_is_no_motion():
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    described = scene(rod("kirchhoff", stiffness, base={"free": True}))
    modes = modes_of(described, count=9)
    assert_allclose(modes.eigenvalues[:5], 0.0, rtol=0, atol=0)
    assert_allclose(modes.angular_frequencies[5:], np.repeat(FREE_FREE[:2], 2), rtol=1e-9, atol=0)


def test_free_damped_rod():
    described = scene(rod(base={"free": True}, damping={"retardation_time": 1e-3}, rotary_inertia=[1e-6, 1e-6, 2e-6]))
    modes = modes_of(described, count=8)
    assert_allclose(modes.eigenvalues[:6], 0.0, rtol=0, atol=0)
    assert_allclose(modes.angular_frequencies[6:], FREE_FREE[:2], rtol=1e-4, atol=0)
    assert_allclose([mode.damping_ratio for mode in modes.modes[6:]], 5e-4 * np.array(FREE_FREE[:2]), rtol=1e-4, atol=0)


def test_errors_are_estimated_honestly():
    """With the modes that a user fixes the estimates are about the errors, and never far below."""
    for count, fixed in ((3, 5), (4, 6), (5, 8)):
        modes = modes_of(scene(rod(), accuracy={"modes": fixed}), count=count)
        errors = np.abs(modes.angular_frequencies / CANTILEVER[:count] - 1.0)
        estimates = np.array([mode.error_estimate for mode in modes.modes])
        assert np.all(errors <= 1.5 * estimates + 1e-12)
        assert np.all(estimates <= 2.0 * errors + 2e-13)
    coarse = modes_of(scene(rod(), accuracy={"modes": 4, "tolerance": 1e-6}), count=4)
    assert coarse.outcome is ModesOutcome.UNRESOLVED
    assert not coarse.converged


def test_frequencies_converge_with_the_modes():
    """Spectrally: two further polynomials gain more than two digits of the second frequency."""
    errors = []
    for fixed in (3, 4, 5, 6, 7):
        described = scene(rod())
        solution = solve(build(described, discretise(described, fixed)))
        errors.append(modes_of(solution, count=2).angular_frequencies[1] / CANTILEVER[1] - 1.0)
    errors = np.array(errors)
    # Rayleigh: too few strains are too stiff.
    assert np.all(errors > 0.0)
    assert np.all(errors[2:] / errors[:-2] < 0.005)


def test_what_has_no_mass_is_refused():
    with pytest.raises(SceneError, match="mass"):
        modes_of(scene(weightless()))


def roped(length, **changes):
    """A rod with a cable beside its axis, whose length is given."""
    stiffness = {"bending_x": 1.0, "bending_y": 1.2, "torsion": 0.8, "extension": 900.0}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "length": length, "offset": [0.05, 0.0], **changes}
    return scene(rod(list(stiffness), stiffness, rotary_inertia=[1e-3, 1e-3, 2e-3]), actuators=[cable])


@pytest.mark.slow
def test_a_taut_cable_holds_and_a_slack_one_does_not():
    held = frequencies(roped(0.98), 5)
    assert_allclose(frequencies(roped(0.98, slack=True), 5), held, rtol=1e-9, atol=0)
    stiffness = {"bending_x": 1.0, "bending_y": 1.2, "torsion": 0.8, "extension": 900.0}
    alone = frequencies(scene(rod(list(stiffness), stiffness, rotary_inertia=[1e-3, 1e-3, 2e-3])), 5)
    assert_allclose(frequencies(roped(1.02, slack=True), 5), alone, rtol=1e-9, atol=0)
    # In the plane of the cable the rod is held, across it is not.
    assert np.abs(held - alone).max() > 0.1


def weightless(name="rod"):
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}
    described = rod("kirchhoff", stiffness, name=name)
    del described["linear_density"]
    return described


def test_a_mass_on_a_weightless_rod_has_two_modes():
    """ω² = 3 EI / (m L³), in both planes; the body has no inertia, and nothing else moves."""
    body = {"name": "ball", "mass": 0.75}
    joint = {"body": "ball", "rod": "rod", "kind": "fixed"}
    assert_allclose(frequencies(scene(weightless(), bodies=[body], joints=[joint]), 8), [2.0, 2.0], rtol=1e-10, atol=0)


def test_what_has_no_mass_and_no_stability_is_told():
    column = weightless("column")
    stable = rod(base={"position": [1.0, 0.0, 0.0]})
    push = {**thrust(3.0), "rod": "column"}
    tables = {"schema": 1, "rods": [stable, column], "loads": [push], "accuracy": {"tolerance": 1e-6}}
    modes = modes_of(scene_from_dict(tables), count=2)
    assert_allclose(modes.angular_frequencies, CANTILEVER[:2], rtol=1e-6, atol=0)
    assert "massless parts leave the equilibrium at once" in modes.message


@pytest.mark.slow
def test_no_equilibrium_no_modes():
    described = scene(rod(base={"free": True}), weight(0.0, 0.0, -1.0))
    modes = modes_of(described)
    assert modes.outcome is ModesOutcome.NO_EQUILIBRIUM
    assert modes.modes == ()


def test_at_least_one_mode_is_asked_for():
    with pytest.raises(ValueError, match="at least one"):
        modes_of(scene(rod()), count=0)


def test_no_more_modes_are_asked_for_than_the_last_level_has_unknowns():
    with pytest.raises(SceneError, match="--count: 100000 modes are more than the 54 unknowns"):
        modes_of(scene(rod()), count=100_000)


def test_shapes_are_those_of_a_cantilever():
    """φ = cosh βX − cos βX − σ (sinh βX − sin βX), and φ′ is the rotation."""
    modes = modes_of(scene(rod()), count=1)
    beta = np.sqrt(CANTILEVER[0])
    sigma = (np.cosh(beta) + np.cos(beta)) / (np.sinh(beta) + np.sin(beta))
    X = np.linspace(0.0, 1.0, 7)
    deflection = np.cosh(beta * X) - np.cos(beta * X) - sigma * (np.sinh(beta * X) - np.sin(beta * X))
    slope = beta * (np.sinh(beta * X) + np.sin(beta * X) - sigma * (np.cosh(beta * X) - np.cos(beta * X)))
    shape = modes.shape(X)
    # The rotation of the tip is the largest entry.
    scale = 1.0 / slope[-1]
    assert_allclose(shape.position[0, :, 0], scale * deflection, rtol=0, atol=1e-9)
    assert_allclose(shape.rotation[0, :, 1], scale * slope, rtol=0, atol=1e-9)


def test_shapes_are_derivatives_of_the_poses():
    described = scene(helix(1), weight(0.0, -0.002, -0.001))
    modes = modes_of(described, count=3)
    solution = modes.solution
    X = np.array([0.3, 1.0])
    shape = modes.shape(X)
    step = 1e-5
    for index, mode in enumerate(modes.modes):
        for place, abscissa in enumerate(X):
            poses = []
            for sign in (-1.0, 1.0):
                moved = solution.x + sign * step * np.real(mode.vector)
                poses.append(modes.model.shape["rod"](moved, solution.inputs, abscissa))
            position = (poses[1][0].full() - poses[0][0].full())[:, 0] / (2 * step)
            assert_allclose(shape.position[index, place].real, position, rtol=0, atol=1e-8)
            change = (poses[1][1].full() - poses[0][1].full())[:, 0] / (2 * step)
            quaternion = (poses[1][1].full() + poses[0][1].full())[:, 0] / 2
            w, v = quaternion[0], quaternion[1:]
            turn = 2 * (w * change[1:] - change[0] * v - np.cross(change[1:], v))
            assert_allclose(shape.rotation[index, place].real, turn, rtol=0, atol=1e-8)


def test_alike_modes_are_told_apart_by_their_plane():
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    modes = modes_of(scene(rod("kirchhoff", stiffness)), count=2)
    tips = modes.shape(np.array([1.0])).position[:, 0]
    assert_allclose(np.abs(tips[0, 1:]), 0.0, rtol=0, atol=1e-9)
    assert_allclose(np.abs(tips[1, [0, 2]]), 0.0, rtol=0, atol=1e-9)


BIELAWA = np.sqrt(1000.0)
"""Speed of R. L. Bielawa's rotor, whose frequencies are in units of it."""

ROTATING = {
    1.0: ([3.68164681, 22.18101115, 61.84176259], 3.54323627),
    2.0: ([4.13731957, 22.61492196, 62.27318411], 3.62179696),
    4.0: ([5.58500142, 24.27334939, 63.96676049], 3.89772252),
    6.0: ([7.36037302, 26.80908168, 66.68391438], 4.26322542),
    8.0: ([9.25683760, 29.99538189], 4.65714960),
    12.0: ([13.17015049, 37.60311233, 79.61447849], 5.42704928),
    BIELAWA: (BIELAWA * np.array([1.034558846, 2.603227497, 4.534128364]), BIELAWA * 0.265164111),
}


@pytest.mark.parametrize("speed", ROTATING)
def test_rotating_cantilever(speed):
    """A blade along x that turns about z: flap out of the plane, lag in it; lag² = flap² − Ω²."""
    flap, first_lag = ROTATING[speed]
    stiffness = {"bending_x": 1.0, "bending_y": 1.0}
    blade = rod(["bending_x", "bending_y"], stiffness, base={"tangent": [1.0, 0.0, 0.0]})
    described = scene(blade, inputs=["rod.base.quaternion"])
    model = build(described, discretise(described, 18))
    quaternion = model.pack()
    w, x, y, z = quaternion
    # The rate of a quaternion that turns about z at the speed Ω is half of (0, 0, 0, Ω) times it.
    rate = speed / 2 * np.array([-z, -y, x, w])
    acceleration = -(speed**2) / 4 * quaternion
    straight = model.unloaded()
    rest = np.zeros(model.size)
    balance = model.inverse_dynamics(straight, rest, rest, quaternion, rate, acceleration)
    assert_allclose(balance.full(), 0.0, rtol=0, atol=1e-11)
    motions = small_motions(model, straight, quaternion, rate, acceleration)
    assert_allclose(motions.free_damping, 0.0, rtol=0, atol=1e-11)
    still = np.zeros_like(motions.free_damping)
    pairs = eigenpairs(motions.free_stiffness, still, motions.free_mass, conservative=True)
    lag = np.sqrt(np.array(flap) ** 2 - speed**2)
    expected = np.sort(np.concatenate([flap, lag]))
    found = np.abs(pairs.values)
    assert_allclose(found[: len(expected)], expected, rtol=1e-8, atol=0)
    assert_allclose(found[:2], [first_lag, flap[0]], rtol=1e-8, atol=0)


def test_motions_that_modes_leave_aside_are_told():
    shaken = {"input": "rod.base.position", "amplitude": [0.1, 0.0, 0.0], "frequency": 1.0}
    still = scene(rod(), accuracy={"modes": 3, "nodes": 8})
    moved = scene(rod(), accuracy={"modes": 3, "nodes": 8}, motions=[shaken, shaken])
    assert "without the motion of" not in modes_of(still, count=1).message
    told = modes_of(moved, count=1)
    assert told.message.endswith("without the motion of rod.base.position in [[motions]].")
    assert_allclose(told.angular_frequencies, modes_of(still, count=1).angular_frequencies, rtol=1e-14, atol=0)


def test_body_at_the_tip():
    """Rayleigh beam with a body of offset centre of mass: transfer matrix, 1e-9."""
    carrier = {
        "name": "rod",
        "length": 0.4,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1200.0},
        "section": {"shape": "circle", "radius": 0.004},
    }
    body = {"name": "load", "mass": 0.3, "centre_of_mass": [0.0, 0.0, 0.02], "inertia": [2e-4, 2e-4, 1e-4]}
    joint = {"body": "load", "rod": "rod", "kind": "fixed"}
    expected = [7.2785278232870905, 7.2785278232870905, 84.71225107721509, 131.83130062507198, 131.83130062507198]
    found = frequencies(scene(carrier, bodies=[body], joints=[joint]), 6)
    assert_allclose(found, [*expected, 405.46622266363147], rtol=1e-9, atol=0)


@pytest.mark.slow
def test_bending_torsion_and_extension_of_a_soft_rod():
    """Transfer matrix of the Timoshenko beam with rotary inertia, and wave equations, 1e-9."""
    soft = {
        "name": "rod",
        "length": 0.5,
        "strain": "reissner",
        "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0},
        "section": {"shape": "circle", "radius": 0.02},
    }
    bending = [4.431019454602301, 27.177459243086265, 73.67391110270175]
    torsion = np.pi * np.sqrt(1e6 / 3 / 1000)
    extension = np.pi * np.sqrt(1e6 / 1000)
    expected = np.sort([*bending, *bending, torsion, extension])
    assert_allclose(frequencies(scene(soft), 8), expected, rtol=1e-9, atol=0)


def test_damped_wire():
    """ζ = τ ω / 2 of a Rayleigh beam with Kelvin–Voigt damping."""
    wire = {
        "name": "rod",
        "length": 0.5,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0},
        "section": {"shape": "circle", "radius": 0.001},
        "damping": {"retardation_time": 1e-4},
    }
    modes = modes_of(scene(wire), count=6)
    expected = np.repeat([35.49440563947164, 222.43655469866277, 622.8148182324308], 2)
    assert_allclose(modes.angular_frequencies, expected, rtol=1e-9, atol=0)
    assert_allclose([mode.damping_ratio for mode in modes.modes], 1e-4 * expected / 2, rtol=1e-9, atol=0)
    assert "die away" in modes.message


@pytest.mark.slow
def test_free_ring():
    """Bending in and out of the plane of a ring: two halves on a stub without mass, whose tips a body joins."""
    stub = rod("kirchhoff", ARC, name="stub", length=0.1, base={"free": True})
    del stub["linear_density"]
    halves = []
    for name, side in (("right", 1.0), ("left", -1.0)):
        base = {"rod": "stub", "tangent": [side, 0.0, 0.0]}
        curved = {"curvature": [0.0, side, 0.0]}
        halves.append(rod("kirchhoff", ARC, name=name, length=np.pi, intrinsic=curved, base=base))
    joints = [
        {"body": "clasp", "rod": "right", "kind": "fixed"},
        {"body": "clasp", "rod": "left", "kind": "fixed", "quaternion": [0.0, 0.0, 1.0, 0.0]},
    ]
    described = scene_from_dict(
        {
            "schema": 1,
            "rods": [stub, *halves],
            "bodies": [{"name": "clasp"}],
            "joints": joints,
            "accuracy": {"tolerance": 1e-7},
        }
    )
    modes = modes_of(described, count=14)
    waves = np.array([2.0, 3.0])
    in_plane = np.sqrt(waves**2 * (waves**2 - 1) ** 2 / (waves**2 + 1))
    out_of_plane = np.sqrt(waves**2 * (waves**2 - 1) ** 2 / (waves**2 + 1.3))
    expected = np.repeat(np.sort(np.concatenate([in_plane, out_of_plane])), 2)
    assert_allclose(modes.eigenvalues[:6], 0.0, rtol=0, atol=0)
    assert_allclose(modes.angular_frequencies[6:], expected, rtol=1e-8, atol=0)
