"""The pose error is a distance and an angle: it does not depend on the axes that components are taken in."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi import Solution, build, discretise, follow, solve
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.maths.pose_change import change_size, rotation_angles, rotation_vectors
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.path_refinement import path_distance
from tests.pose_errors import distance_between, pose_error
from tests.scenes import WEIGHT, push, rod, scene

ANGLES = (0.0, 1e-15, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi)

TILTED = Rotation.align_vectors([[1.0, 1.0, 1.0]], [[1.0, 0.0, 0.0]])[0]
"""A turn of the world that puts what lay along x on its diagonal."""


def quaternion(rotation: Rotation) -> FloatArray:
    """Scalar first."""
    x, y, z, w = rotation.as_quat()
    return np.array([w, x, y, z])


@pytest.mark.parametrize("angle", ANGLES)
def test_angle_of_a_rotation_at_every_size(angle: float) -> None:
    """From nothing to half a turn without loss of digits, whatever the sign of the quaternion."""
    rng = np.random.default_rng(3)
    axis = rng.standard_normal(3)
    axis /= np.linalg.norm(axis)
    first = Rotation.random(random_state=5)
    second = first * Rotation.from_rotvec(angle * axis)
    pair = (quaternion(first)[None], quaternion(second)[None])
    assert_allclose(rotation_angles(*pair), [angle], rtol=1e-12, atol=4e-16)
    assert_allclose(rotation_angles(pair[0], -pair[1]), [angle], rtol=1e-12, atol=4e-16)
    if angle < np.pi - 1e-6:
        assert_allclose(rotation_vectors(*pair)[0], angle * axis, rtol=1e-7, atol=4e-16)


def test_changes_count_by_the_norms_of_their_rows() -> None:
    change = np.array([[3.0, 4.0, 0.0], [-2.0, 2.0, 1.0], [4.9, 0.0, 0.0]])
    assert change_size(change) == 5.0
    assert change_size(np.zeros((0, 3))) == 0.0
    assert change_size(np.array([[np.nan, 0.0, 0.0]])) == np.inf
    assert change_size(np.array([[-np.inf, 0.0, 0.0], [np.nan, 0.0, 1.0]])) == np.inf


def bent(rotation: Rotation, modes: int) -> Solution:
    """A rod bent in a plane, the whole scene turned in the world."""
    base = {"quaternion": quaternion(rotation).tolist()}
    force = rotation.apply([2.0, 0.0, -1.0]).tolist()
    wanted = scene(push(force=force), rods=[rod(base=base)])
    return solve(build(wanted, discretise(wanted, modes, 20, "magnus8")))


def test_pose_error_does_not_depend_on_the_axes_of_the_world() -> None:
    """Largest components differ by up to √3 between the two."""
    errors = []
    components = []
    for turn in (Rotation.identity(), TILTED, Rotation.random(random_state=1)):
        coarse, fine = bent(turn, 3), bent(turn, 12)
        errors.append(pose_distance(coarse, fine))
        components.append(np.abs(coarse.tip().position - fine.tip().position).max())
    assert_allclose(errors, errors[0], rtol=1e-7, atol=0)
    assert max(components) > 1.2 * min(components)


def test_pose_error_vs_rotation_matrices() -> None:
    coarse, fine = bent(TILTED, 3), bent(TILTED, 12)
    first, second = coarse.tip(), fine.tip()
    expected = pose_error((first.position, first.rotation), (second.position, second.rotation), 0.8)
    assert_allclose(pose_distance(coarse, fine), expected, rtol=1e-9, atol=0)


@pytest.mark.slow
def test_error_along_a_diagonal_is_refined() -> None:
    """Where four modes would do by the largest component of their error, they do not by its length."""
    coarse, truth = bent(Rotation.identity(), 4), bent(Rotation.identity(), 14)
    error = coarse.tip().position - truth.tip().position
    # The world is turned so that this very error lies along its diagonal.
    diagonal = Rotation.align_vectors([[1.0, 1.0, 1.0]], [error])[0]
    coarse, truth = bent(diagonal, 4), bent(diagonal, 14)
    by_components = np.abs(coarse.tip().position - truth.tip().position).max() / 0.8
    by_entries = np.abs(coarse.tip().rotation - truth.tip().rotation).max()
    distance = distance_between(coarse.tip().position, truth.tip().position) / 0.8
    assert_allclose(distance, np.sqrt(3) * by_components, rtol=1e-6, atol=0)
    tolerance = 0.9 * distance
    assert max(by_components, by_entries) < 0.7 * tolerance
    wanted = truth.model.scene
    accuracy = wanted.accuracy.model_copy(update={"tolerance": tolerance})
    found = solve(wanted.model_copy(update={"accuracy": accuracy}))
    assert found.error_estimate is not None
    assert pose_distance(found, truth) <= found.error_estimate <= tolerance
    assert found.model.discretisation["rod"].modes[1] > 4


def test_preview_measures_what_the_metrics_measure() -> None:
    """What coarsening foresees and what solutions are judged by is one measure."""
    wanted = scene(push(force=[4.0, 2.0, -1.0]), WEIGHT)
    fine = solve(build(wanted, discretise(wanted, 12, 30, "magnus8")))
    coarse = solve(build(wanted, discretise(wanted, 4, 30, "magnus8")))
    change = Preview(coarse).tips.change_from(Preview(fine).tips)
    assert_allclose(change_size(change), pose_distance(coarse, fine), rtol=1e-9, atol=0)
    resolution = Resolution(Preview(coarse))
    assert resolution.modes_error + resolution.grid_error >= pose_distance(coarse, fine)


def test_paths_are_compared_by_distances() -> None:
    """The tips of two paths, one of them with too few modes, in a world turned to the diagonal."""
    distances = []
    for turn in (Rotation.identity(), TILTED):
        base = {"quaternion": quaternion(turn).tolist()}
        free = scene(push(force=[0.0, 0.0, 0.0]), rods=[rod(base=base)])
        force = turn.apply([2.0, 0.0, -1.0]).tolist()
        paths = [follow(build(free, discretise(free, m, 20, "magnus8")), "push.force", force) for m in (3, 12)]
        distances.append(path_distance(*paths))
    assert_allclose(distances[0], distances[1], rtol=1e-5, atol=0)
