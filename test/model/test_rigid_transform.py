"""Laws of rigid transforms, against matrices and scipy's rotations."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
import pytest
from scipy.spatial.transform import Rotation, Slerp

RNG = np.random.default_rng(0)
TRANSFORMS = [RigidTransform.from_parts(RNG.normal(size=3).tolist(), RNG.normal(size=4).tolist())
              for _ in range(8)]
PAIRS = list(zip(TRANSFORMS, TRANSFORMS[1:]))


def matrix(transform):
    """Make the homogeneous matrix of a transform by other means."""
    result = np.eye(4)
    result[:3, :3] = Rotation.from_quat(transform.quaternion).as_matrix()
    result[:3, 3] = transform[:3]
    return result


@pytest.mark.parametrize('a, b', PAIRS)
def test_composition_is_that_of_matrices(a, b):
    """Both products are the same transform."""
    np.testing.assert_allclose(matrix(a @ b), matrix(a) @ matrix(b), atol=1e-12)


@pytest.mark.parametrize('transform', TRANSFORMS)
def test_the_inverse_undoes(transform):
    """A transform and its inverse are the identity; the matrix is that of scipy."""
    np.testing.assert_allclose(matrix(transform @ transform.inverse()), np.eye(4), atol=1e-12)
    np.testing.assert_allclose(transform.rotation_matrix, matrix(transform)[:3, :3], atol=1e-12)


@pytest.mark.parametrize('a, b', PAIRS)
@pytest.mark.parametrize('ratio', [0.0, 0.3, 1.0])
def test_interpolation_turns_at_a_constant_rate(a, b, ratio):
    """Its rotation is scipy's Slerp, its translation lies on the straight line."""
    between = a.interpolate(b, ratio)
    rotations = Rotation.from_quat([a.quaternion, b.quaternion])
    expected = Slerp([0.0, 1.0], rotations)(ratio)
    assert (Rotation.from_quat(between.quaternion) * expected.inv()).magnitude() < 1e-7
    straight = (1 - ratio) * np.array(a[:3]) + ratio * np.array(b[:3])
    np.testing.assert_allclose(between[:3], straight)


def test_angles_are_about_fixed_axes():
    """Roll, pitch and yaw in this order about the axes of the parent."""
    angles = 0.3, -0.4, 1.1
    transform = RigidTransform.from_angles((1.0, 2.0, 3.0), angles)
    expected = Rotation.from_euler('xyz', angles).as_matrix()
    np.testing.assert_allclose(transform.rotation_matrix, expected, atol=1e-12)


@pytest.mark.parametrize('angles, tilt', [
    ((0.0, 0.0, 2.0), 0.0), ((0.3, 0.0, 0.0), 0.3), ((0.0, -0.2, 1.0), 0.2),
    ((math.pi, 0.0, 0.0), math.pi)])
def test_the_tilt_is_the_angle_between_the_z_axes(angles, tilt):
    """It knows nothing of yaw."""
    assert RigidTransform.from_angles((0.0, 0.0, 0.0), angles).tilt == pytest.approx(tilt)


def test_upright_transforms_compose_as_poses_in_the_plane():
    """Seen from above, composition is that of SE(2), whatever the heights."""
    a = RigidTransform.from_angles((1.0, -2.0, 0.3), (0.0, 0.0, 0.7))
    b = RigidTransform.from_angles((0.4, 0.1, -1.0), (0.0, 0.0, -0.2))
    np.testing.assert_allclose((a @ b).planar, Pose(1.0, -2.0, 0.7) @ Pose(0.4, 0.1, -0.2))


@pytest.mark.parametrize('translation, quaternion', [
    ((0.0, math.nan, 0.0), (0.0, 0.0, 0.0, 1.0)), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.0, math.inf, 0.0, 1.0))])
def test_what_is_no_transform_is_refused(translation, quaternion):
    """The error shows what came."""
    with pytest.raises(ValueError, match='transform: got .* expected finite numbers'):
        RigidTransform.from_parts(translation, quaternion)
