"""Velocities and accelerations against published numbers, against AD through time, and against DOP853 of the report."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    KIRCHHOFF,
    PLANAR,
    REISSNER,
    RODS,
    STRAIGHT,
    coordinates,
    drawn_motion,
    hat,
    reference_motion,
    rod,
    strain_basis,
)
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.rod_motion import AT_REST, NO_CHANGE, FrameMotion, RodMotion, StrainRates

BREAKS = pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.35, 1.0)], ids=["one", "two"])


# Published state of A. Gotelli's code: random strains of degree two, a random state of the base, and what comes out at
# the tip. Its sections have the tangent first, quaternions w first, ξ = [K; Γ] and η = [Ω; V] in section axes.

BASE_QUATERNION = [0.2462418299374282, -0.3149241877569222, -0.8968666065772184, 0.1892564587045169]
BASE_POSITION = [0.5968800669521466, 0.8232947158735686, -0.6048972614132321]
BASE_ANGULAR_VELOCITY = [-0.329554488570222, 0.536459189623808, -0.4444505783936245]
BASE_VELOCITY = [0.107939911590861, -0.0452058962756795, 0.2577418495238488]
BASE_ANGULAR_RATE = [-0.2704310544163133, 0.02680182039123102, 0.9044594503494257]
BASE_VELOCITY_RATE = [0.8323901360074013, 0.2714234559198019, 0.4345938588653662]
STRAINS = np.array(
    [
        [-0.7167948892883933, 0.2139377525141173, -0.9673988567513409],
        [-0.5142264587405261, -0.7255368464279626, 0.6083535084539808],
        [-0.6866418214918308, -0.198111211507633, -0.7404191064370885],
    ]
)
STRAIN_RATES = np.array(
    [
        [-0.7823823959484615, 0.9978490360071179, -0.5634861893781862],
        [0.02586478880879683, 0.6782244693852144, 0.2252796651913225],
        [-0.4079367646053139, 0.2751045354060384, 0.04857438013356852],
    ]
)
STRAIN_ACCELERATIONS = np.array(
    [
        [-0.012834026018546, 0.945550047767139, -0.4149664311739459],
        [0.5427153955878297, 0.0534899584266777, 0.5398276725503746],
        [-0.1995427558196442, 0.7830589040103644, -0.433370507989717],
    ]
)
TIP_QUATERNION = [-0.090078251793251, -0.053224136132971, -0.984654391712109, -0.139674008923765]
TIP_POSITION = [-0.238384759351133, 1.250996566977977, -0.359262360477917]
TIP_ANGULAR_VELOCITY = [-1.442282141971034, 0.032269865004043, 0.099182531759785]
TIP_VELOCITY = [0.187274389913106, -0.248493771786830, -0.328646221332497]
TIP_ANGULAR_RATE = [0.226427901378442, -0.422319339785353, 0.965163990199137]
TIP_VELOCITY_RATE = [0.616508304158975, 1.498327030118051, 0.611873337997574]

# Our axes x, y, z are their 2, 3, 1: the columns are our axes in theirs.
THEIRS_R_OURS = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def ours(vector):
    """A vector of their section axes in ours, 3×1."""
    return ca.DM(THEIRS_R_OURS.T @ np.asarray(vector))


def ours_of_strains(basis, rows):
    """Coordinates of K₂, K₃, K₁ from those of K₁, K₂, K₃."""
    of_unit = np.repeat(1 / np.array(basis.scales), 3)
    return ca.DM(of_unit * rows[[1, 2, 0]].ravel())


def test_sweeps_vs_published_numbers():
    basis = strain_basis(rod(KIRCHHOFF, STRAIGHT, length=1.0), modes=3, nodes=36)
    rates = StrainRates(ours_of_strains(basis, STRAIN_RATES), ours_of_strains(basis, STRAIN_ACCELERATIONS))
    base = FrameMotion(
        velocity=ours(BASE_VELOCITY),
        angular_velocity=ours(BASE_ANGULAR_VELOCITY),
        # Their rate of V is that of its coordinates in axes that turn.
        acceleration=ours(np.add(BASE_VELOCITY_RATE, np.cross(BASE_ANGULAR_VELOCITY, BASE_VELOCITY))),
        angular_acceleration=ours(BASE_ANGULAR_RATE),
    )
    pose = shape(basis, ours_of_strains(basis, STRAINS))
    motion = RodMotion(pose, rates, base)

    permuted = Rotation.from_matrix(THEIRS_R_OURS).as_quat()[[3, 0, 1, 2]]
    world_Q_base = quaternion_product(ca.DM(BASE_QUATERNION), ca.DM(permuted))
    world_R_base = quaternion_to_matrix(world_Q_base)
    tip = quaternion_product(world_Q_base, ca.DM(pose.quaternion[:, -1]))
    theirs = quaternion_product(tip, ca.DM(permuted * [1, -1, -1, -1])).full().ravel()
    sign = np.sign(theirs @ TIP_QUATERNION)
    assert_allclose(sign * theirs, TIP_QUATERNION, rtol=0, atol=1e-12)
    position = ca.DM(BASE_POSITION) + world_R_base @ pose.position[:, -1]
    assert_allclose(position.full().ravel(), TIP_POSITION, rtol=0, atol=1e-12)

    tip_R_base = pose.rotation_at(-1).full().T
    omega, velocity, alpha, acceleration = (
        THEIRS_R_OURS @ tip_R_base @ field[:, -1].full().ravel()
        for field in (motion.angular_velocity, motion.velocity, motion.angular_acceleration, motion.acceleration)
    )
    assert_allclose(omega, TIP_ANGULAR_VELOCITY, rtol=0, atol=1e-12)
    assert_allclose(velocity, TIP_VELOCITY, rtol=0, atol=1e-12)
    assert_allclose(alpha, TIP_ANGULAR_RATE, rtol=0, atol=1e-12)
    assert_allclose(acceleration - np.cross(omega, velocity), TIP_VELOCITY_RATE, rtol=0, atol=1e-12)


def fields(motion):
    """Velocity, angular velocity, acceleration, angular acceleration of the nodes, (M, 3) each."""
    found = (motion.velocity, motion.angular_velocity, motion.acceleration, motion.angular_acceleration)
    return [ca.densify(field).full().T for field in found]


@BREAKS
@pytest.mark.parametrize("ratio", [None, 1.3], ids=["fixed", "drawn-out"])
@pytest.mark.parametrize("name", ["planar", "kirchhoff", "reissner", "stretched"])
def test_sweeps_vs_dop853_of_the_report(name, ratio, breaks):
    """The velocities of the continuous rod, body twists integrated from the base."""
    basis = strain_basis(rod(RODS[name]), modes=3, nodes=26, breaks=breaks)
    q = coordinates(basis, 1)
    rates, base = drawn_motion(basis, 2, ratio=ratio is not None)
    motion = RodMotion(shape(basis, ca.DM(q), None if ratio is None else ca.DM(ratio)), rates, base)
    expected, _ = reference_motion(basis, q, rates, base, ratio or 1.0)
    for found, wanted in zip(fields(motion), expected, strict=True):
        assert_allclose(found, wanted, rtol=0, atol=2e-12)


@pytest.mark.parametrize(("transport", "order"), [("magnus4", 4), ("magnus6", 6)])
def test_accelerations_converge_with_the_order_of_the_rotation(transport, order):
    """The accelerations are those of the discrete rotations, so that they lose no order to them."""
    errors = []
    for nodes in (16, 32):
        basis = strain_basis(rod(), modes=3, nodes=nodes, transport=transport)
        q = coordinates(basis, 1, 2.0)
        rates, base = drawn_motion(basis, 2, 2.0)
        motion = RodMotion(shape(basis, ca.DM(q)), rates, base)
        expected, _ = reference_motion(basis, q, rates, base)
        errors.append(np.abs(fields(motion)[2][-1] - expected[2][-1]).max())
    assert errors[1] < 1e-5
    assert np.log2(errors[0] / errors[1]) > order - 0.7


def motion_in_time(basis, q, rates, base, ratio):
    """Poses of a path that starts with these rates, and their first two time derivatives by AD.

    q(t), the length and the base move as polynomials of degree two; the base turns by a quaternion.
    """
    t = ca.MX.sym("t")
    path = ca.DM(q) + t * rates.velocity + t**2 / 2 * rates.acceleration
    path_ratio = None
    if ratio is not None:
        path_ratio = ratio + t * rates.ratio_rate + t**2 / 2 * rates.ratio_acceleration
    pose = shape(basis, path, path_ratio)
    # The quaternion (2, ω t + …) turns at ω, and at no other rate of the rate: its real part stands still.
    half_turn = t * base.angular_velocity + t**2 / 2 * base.angular_acceleration
    quaternion = ca.vertcat(2.0, half_turn)
    world_R_base = quaternion_to_matrix(quaternion / ca.norm_2(quaternion))
    shift = t * base.velocity + t**2 / 2 * base.acceleration
    position = ca.repmat(shift, 1, basis.grid.size) + world_R_base @ pose.position
    directors = [world_R_base @ director for director in pose.directors]
    values = [ca.densify(value) for value in (position, *directors)]
    outputs = []
    for value in values:
        rate = ca.jacobian(ca.vec(value), t)
        acceleration = ca.jacobian(rate, t)
        outputs += [ca.reshape(rate, *value.shape), ca.reshape(acceleration, *value.shape)]
    return [result.full() for result in ca.Function("in_time", [t], outputs)(0.0)]


@BREAKS
@pytest.mark.parametrize("moving", [False, True], ids=["clamped", "moving"])
@pytest.mark.parametrize("ratio", [None, 1.3], ids=["fixed", "drawn-out"])
@pytest.mark.parametrize("name", RODS)
def test_motion_vs_ad_of_the_discrete_poses(name, ratio, moving, breaks):
    """On a grid that is far too coarse: the derivatives are those of the discrete rod, not of the continuous one."""
    basis = strain_basis(rod(RODS[name]), modes=2, nodes=4, breaks=breaks, transport="magnus4")
    q = coordinates(basis, 3)
    rates, base = drawn_motion(basis, 4, ratio=ratio is not None, moving=moving)
    motion = RodMotion(shape(basis, ca.DM(q), None if ratio is None else ca.DM(ratio)), rates, base)
    found = [motion.velocity, motion.acceleration]
    for axis in range(3):
        found += [motion.director_rate(axis), motion.director_acceleration(axis)]
    expected = motion_in_time(basis, q, rates, base, ratio)
    for own, by_ad in zip(found, expected, strict=True):
        assert_allclose(ca.densify(own).full(), by_ad, rtol=0, atol=2e-13)


def test_spins_vs_rates_of_the_directors():
    """Ω^ = Ṙ Rᵀ, with the rate of R by differences of the rod a moment before and after."""
    basis = strain_basis(rod(REISSNER), modes=3, nodes=10)
    q, step = coordinates(basis, 5), 1e-5
    rates, _ = drawn_motion(basis, 6)
    motion = RodMotion(shape(basis, ca.DM(q)), rates, AT_REST)
    ends = [shape(basis, q + s * rates.velocity + s**2 / 2 * rates.acceleration) for s in (-step, step)]
    for node in (3, 10):
        before, after = (end.rotation_at(node).full() for end in ends)
        here = motion.shape.rotation_at(node).full()
        expected = (after - before) / (2 * step) @ here.T
        assert_allclose(hat(motion.angular_velocity[:, node].full().ravel()), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", RODS)
def test_a_rod_at_rest_has_no_motion(name):
    basis = strain_basis(rod(RODS[name]), modes=2, nodes=4)
    zeros = ca.DM.zeros(basis.size, 1)
    motion = RodMotion(shape(basis, ca.DM(coordinates(basis))), StrainRates(zeros, zeros))
    for field in fields(motion):
        assert_allclose(field, 0.0, rtol=0, atol=0)


@pytest.mark.parametrize("name", RODS)
def test_motion_is_finite_without_strain(name):
    """No angle is divided by: a straight rod that begins to move has all its derivatives."""
    basis = strain_basis(rod(RODS[name], STRAIGHT), modes=2, nodes=4)
    q = np.zeros(basis.size)
    rates, base = drawn_motion(basis, 7)
    motion = RodMotion(shape(basis, ca.DM(q)), rates, base)
    expected = motion_in_time(basis, q, rates, base, None)
    assert_allclose(motion.velocity.full(), expected[0], rtol=0, atol=1e-14)
    assert_allclose(motion.acceleration.full(), expected[1], rtol=0, atol=1e-14)


def test_planar_rod_of_a_resting_base_stores_one_spin_alone():
    """What is zero for good is not computed: a planar rod turns about one axis."""
    basis = strain_basis(rod(PLANAR, STRAIGHT), modes=2, nodes=4)
    q, v, a = (ca.MX.sym(name, basis.size) for name in "qva")
    motion = RodMotion(shape(basis, q), StrainRates(v, a))
    assert motion.section_angular_velocity[1:, :].nnz() == 0
    assert motion.section_angular_acceleration[1:, :].nnz() == 0
    assert NO_CHANGE.nnz() == 0
