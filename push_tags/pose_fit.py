"""
Pose of an object from the corners of its tags: least squares of reprojection.

With the corners m_i on the object, their pixels z_i, and the pose (t, R) of the object in the
frame of the floor,

    min  sum_j r_j' S_j^-1 r_j + e_z^2 / h^2 + (n_x^2 + n_y^2) / tau^2,
    S_j = sigma_j^2 I + delta^2 G_j G_j'

where r_j has the four z_i - project(R m_i + t) of a tag, and G_j their derivatives with respect to
a shift of that tag on the object, of standard deviation delta. Near tags err by that shift, far
ones by sigma_j, the noise of corners. n is the z axis of the object. The last terms say that it
stands on the floor. That it seems tilted, by d = (-n_y, n_x, 0), is taken for a tilt of the
camera, which turns its position about the lens at l too. Without that tilt it stands at

    e = t - d x (t - l)

and e_z is what remains of its height. h and tau are the standard deviations of height and tilt.
Steps are those of Levenberg and Marquardt, along (t, omega) with dR = omega x R. At the minimum
the covariance of a step is (J' J)^-1, of which that of e_x, e_y and yaw is made.
"""

from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.rigid_transform import RigidTransform
from push_tags.camera import CameraIntrinsics
from push_tags.settings import DetectorSettings

# Iterations; chosen: twice as many as any image of the tests takes.
MAX_ITERATIONS = 30
# Descents, each with the covariances of the tags at the pose where the last one ended; chosen: the
# start may be far off.
ROUNDS = 3
# Decrease of the cost, of its size, below which it is a minimum; chosen.
TOLERANCE = 1e-9
# Damping at the start, and by how much it changes; chosen as usual.
DAMPING, DAMPING_FACTOR = 1e-3, 5.0
MAX_DAMPING = 1e6
# Least depth of a corner [m]; chosen: nearer than any lens sees sharp.
MIN_DEPTH = 0.01
# Width of a tag below which its corners are noisier, and the power with which they are [pixel];
# measured in images of MuJoCo: below it the blur of an edge reaches the cells behind the border.
SHARP_WIDTH, BLUR_POWER = 20.0, 3.0
# Corners of a tag.
CORNERS = 4
# Yaw among the steps.
YAW = np.array((0.0, 0.0, 0.0, 0.0, 0.0, 1.0))


class CornerPixels(NamedTuple):
    """
    Corners of tags, four of each, and where they are seen.

    :param points: in the frame of the object, shape (4 n, 3) [m].
    :param pixels: columns and rows, shape (4 n, 2) [pixel].
    """

    points: FloatArray
    pixels: FloatArray


class View(NamedTuple):
    """
    A camera and where it is.

    :param camera: ``CameraIntrinsics``.
    :param optical_pose: of the optical frame, in the frame of object poses.
    """

    camera: CameraIntrinsics
    optical_pose: RigidTransform


class PoseFit(NamedTuple):
    """
    A minimum.

    :param pose: ``Pose`` of the object on the floor.
    :param covariance: of (x, y, theta), shape (3, 3).
    :param cost: sum of squares, each in units of its deviation.
    """

    pose: Pose
    covariance: FloatArray
    cost: float


class _SeenCorners(NamedTuple):
    """Corners, the view of them, and what gives each tag's residuals unit covariance."""

    corners: CornerPixels
    view: View
    whitening: FloatArray


class _Linearization(NamedTuple):
    """Residuals in units of their deviations, and their derivatives with respect to a step."""

    residual: FloatArray
    jacobian: FloatArray

    @property
    def cost(self) -> float:
        return float(self.residual @ self.residual)


def fit_pose(start: Pose, corners: CornerPixels, view: View,
             settings: DetectorSettings) -> PoseFit | None:
    """
    Fit the pose of an object to the corners of its tags.

    :param start: ``Pose`` near which to look.
    :param corners: ``CornerPixels``.
    :param view: ``View``.
    :param settings: with the deviations of the formula.
    :return: ``PoseFit``; None where a corner comes to lie behind the lens.
    """
    pose = RigidTransform.from_angles((start.x, start.y, 0.0), (0.0, 0.0, start.theta))
    current = None
    for _ in range(ROUNDS):
        whitening = _whitening(pose, corners, view, settings)
        if whitening is None:
            return None
        pose, current = _minimize(pose, _SeenCorners(corners, view, whitening), settings)
        if current is None:
            break
    if current is None:
        return None
    standing, gradient = _standing(pose, view)
    x, y, _ = standing.tolist()
    planar = np.stack((gradient[0], gradient[1], YAW))
    covariance = np.asarray(planar @ np.linalg.inv(current.jacobian.T @ current.jacobian)
                            @ planar.T, dtype=np.float64)
    return PoseFit(pose.planar._replace(x=x, y=y), covariance, current.cost)


def _minimize(pose: RigidTransform, seen: _SeenCorners, settings: DetectorSettings
              ) -> tuple[RigidTransform, _Linearization | None]:
    """Descend from a pose to a minimum; None where a corner lies behind the lens at first."""
    current = _linearize(pose, seen, settings)
    if current is None:
        return pose, None
    damping = DAMPING
    for _ in range(MAX_ITERATIONS):
        hessian = current.jacobian.T @ current.jacobian
        step = np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)),
                               -current.jacobian.T @ current.residual)
        next_pose = _moved(pose, np.asarray(step, dtype=np.float64))
        following = _linearize(next_pose, seen, settings)
        if following is None or following.cost > current.cost:
            damping *= DAMPING_FACTOR
            if damping > MAX_DAMPING:
                break
            continue
        decrease = current.cost - following.cost
        pose, current, damping = next_pose, following, damping / DAMPING_FACTOR
        if decrease <= TOLERANCE * (1.0 + current.cost):
            break
    return pose, current


def _standing(pose: RigidTransform, view: View) -> tuple[FloatArray, FloatArray]:
    """Return where the object stands, e, and the derivative with respect to a step, (3, 6)."""
    n_x, n_y, n_z = pose.rotation_matrix[:, 2].tolist()
    tilt = np.array((-n_y, n_x, 0.0))
    arm = np.array(pose[:3]) - view.optical_pose[:3]
    # dn = omega x n.
    tilt_gradient = np.array(((n_z, 0.0, -n_x), (0.0, n_z, -n_y), (0.0, 0.0, 0.0)))
    return (np.asarray(pose[:3] - np.cross(tilt, arm), dtype=np.float64),
            np.hstack((np.eye(3) - _cross(tilt), _cross(arm) @ tilt_gradient)))


def _cross(vector: FloatArray) -> FloatArray:
    """Return the matrix that takes the cross product of a vector with what it multiplies."""
    x, y, z = vector.tolist()
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


def _whitening(pose: RigidTransform, corners: CornerPixels, view: View,
               settings: DetectorSettings) -> FloatArray | None:
    """Invert the roots of the covariances of the tags, shape (n, 8, 8); None behind the lens."""
    to_camera = view.optical_pose.inverse()
    axes = to_camera.rotation_matrix
    in_object = corners.points @ pose.rotation_matrix.T + pose[:3]
    in_camera = in_object @ axes.T + to_camera[:3]
    # False for what is not a number.
    if not (in_camera[:, 2] > MIN_DEPTH).all():
        return None
    shifts = view.camera.projection_gradient(in_camera).reshape(-1, 2 * CORNERS, 3)
    noise = settings.corner_noise * _blur(corners.pixels.reshape(-1, CORNERS, 2))
    covariances = (settings.tag_deviation ** 2 * shifts @ np.swapaxes(shifts, 1, 2)
                   + noise[:, None, None] ** 2 * np.eye(2 * CORNERS))
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariances)), dtype=np.float64)


def _blur(tags: FloatArray) -> FloatArray:
    """Return how much noisier the corners of tags are than those of wide ones, shape (n,)."""
    middles = 0.5 * (tags + np.roll(tags, -1, axis=1))
    widths = np.linalg.norm(middles[:, 2:] - middles[:, :2], axis=2).min(axis=1)
    return np.maximum(1.0, SHARP_WIDTH / np.maximum(widths, 1.0)) ** BLUR_POWER


def _linearize(pose: RigidTransform, seen: _SeenCorners,
               settings: DetectorSettings) -> _Linearization | None:
    (corners, view, whitening), rotation = seen, pose.rotation_matrix
    arms = corners.points @ rotation.T
    to_camera = view.optical_pose.inverse()
    camera_axes = to_camera.rotation_matrix
    in_camera = (arms + pose[:3]) @ camera_axes.T + to_camera[:3]
    # False for what is not a number.
    if not (in_camera[:, 2] > MIN_DEPTH).all():
        return None
    residual = (view.camera.project(in_camera) - corners.pixels).reshape(-1, 2 * CORNERS, 1)
    gradient = view.camera.projection_gradient(in_camera) @ camera_axes
    # omega x arm, as a matrix that omega is multiplied with.
    turns = -np.cross(arms[:, None], np.eye(3))
    jacobian = np.concatenate((gradient, gradient @ np.swapaxes(turns, 1, 2)), axis=2)
    jacobian = whitening @ jacobian.reshape(-1, 2 * CORNERS, 6)
    n_x, n_y, n_z = rotation[:, 2].tolist()
    height, tilt = settings.height_deviation, settings.tilt_deviation
    standing, gradient_of_standing = _standing(pose, view)
    priors = np.array([gradient_of_standing[2] / height,
                       (0.0, 0.0, 0.0, 0.0, n_z / tilt, -n_y / tilt),
                       (0.0, 0.0, 0.0, -n_z / tilt, 0.0, n_x / tilt)])
    return _Linearization(
        np.concatenate(((whitening @ residual).ravel(),
                        (standing[2] / height, n_x / tilt, n_y / tilt))),
        np.concatenate((jacobian.reshape(-1, 6), priors)))


def _moved(pose: RigidTransform, step: FloatArray) -> RigidTransform:
    """Move a pose by a translation and a rotation vector in the axes of the floor."""
    omega = step[3:]
    angle = float(np.linalg.norm(omega))
    scale = np.sin(0.5 * angle) / angle if angle > 1e-12 else 0.5
    turn = RigidTransform.from_parts((0.0, 0.0, 0.0),
                                     [*(scale * omega).tolist(), float(np.cos(0.5 * angle))])
    rotated = turn @ pose._replace(x=0.0, y=0.0, z=0.0)
    x, y, z = (np.array(pose[:3]) + step[:3]).tolist()
    return rotated._replace(x=x, y=y, z=z)
