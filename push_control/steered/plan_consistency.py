"""Checks of a plan against itself: its contact is between both bodies, its rates are its own."""

import numpy as np
from push_control.steered.estimation.contact_site import CONTACT_TOLERANCE
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory
from push_navigation.obstacle import inflate

# Distance of the contact from both bodies in a straight push [m]; chosen: its samples are means of
# what different friction would lead to, and 46 mm were measured in 248 such plans.
MEAN_TOLERANCE = 0.12
# Difference between a stated rate and that from sample to sample, over the highest speed of the
# robot from sample to sample, and the least that is allowed [m/s]. Chosen: at most 0.19 was
# measured in 532 plans, of all kinds of contacts and both drives.
RATE_TOLERANCE = 0.4
MIN_RATE_TOLERANCE = 0.01
# Difference between the length of a line and that of the robot's path [m]; chosen: samples cut
# an arc short by far less.
LINE_TOLERANCE = 0.05


def check_consistency(plan: PushTrajectory, obj: PushedObject, robot: RoundRobot) -> None:
    """
    Refuse a plan whose numbers contradict each other.

    :raises ValueError: naming the array, the value and what was expected.
    """
    if plan.line is not None and abs(plan.line.length - plan.path_length) > LINE_TOLERANCE:
        raise ValueError(f'line.length: got {plan.line.length:.3f} m, expected that of '
                         f'robot_poses, {plan.path_length:.3f} m')
    _check_contact_points(plan, obj, robot)
    _check_rates(plan, obj, robot)


def _check_contact_points(plan: PushTrajectory, obj: PushedObject, robot: RoundRobot) -> None:
    """Refuse contacts beside the rim of the robot, or beside the outline of the object."""
    tolerance = MEAN_TOLERANCE if plan.style.is_straight else CONTACT_TOLERANCE
    from_robot = np.hypot(*(plan.contact_poses - plan.robot_poses)[:, :2].T) - robot.radius
    _refuse_above('contact_poses', np.abs(from_robot), tolerance, 'm from the rim of the robot')
    c, s = np.cos(plan.object_poses[:, 2]), np.sin(plan.object_poses[:, 2])
    x, y = (plan.contact_poses - plan.object_poses)[:, :2].T
    in_object = np.stack((c * x + s * y, c * y - s * x), axis=1)
    from_object = inflate(obj.outline, obj.radius, 0.0).distances(in_object)
    _refuse_above('contact_poses', np.abs(from_object), tolerance,
                  'm from the outline of the object')


def _check_rates(plan: PushTrajectory, obj: PushedObject, robot: RoundRobot) -> None:
    """Refuse rates that are not those of the poses, and a drive that moves sideways."""
    robot_steps = _steps(plan.robot_poses, plan.times)
    tolerance = max(RATE_TOLERANCE * float(np.hypot(*robot_steps[:, :2].T).max()),
                    MIN_RATE_TOLERANCE)
    for name, poses, twists, extent in (
            ('object_twists', plan.object_poses, plan.object_twists, obj.size),
            ('robot_twists', plan.robot_poses, plan.robot_twists, robot.radius)):
        differences = _differences(twists, _steps(poses, plan.times), extent)
        _refuse_above(name, differences, tolerance, 'm/s beside the rate of the poses')
    arms = (plan.contact_poses - plan.object_poses)[:, :2]
    material = (plan.object_twists[:, :2]
                + plan.object_twists[:, 2:] * np.stack((-arms[:, 1], arms[:, 0]), axis=1))
    slip = np.hypot(*(plan.contact_twists[:, :2] - material).T)
    _refuse_above('contact_twists', slip, tolerance, 'm/s beside the object that it is on')
    turning = _differences(plan.contact_twists * (0.0, 0.0, 1.0), _steps(
        plan.contact_poses, plan.times) * (0.0, 0.0, 1.0), robot.radius)
    _refuse_above('contact_twists', turning, tolerance, 'm/s beside the rate of the normal')
    if robot.drive == 'differential':
        v_x, v_y, _ = plan.robot_twists.T
        heading = plan.robot_poses[:, 2]
        sideways = np.abs(v_y * np.cos(heading) - v_x * np.sin(heading))
        _refuse_above('robot_poses', sideways, tolerance, 'm/s across the heading of the robot')


def _steps(poses: FloatArray, times: FloatArray) -> FloatArray:
    """Mean rates between the samples, shape (n - 1, 3)."""
    unwrapped = np.column_stack((poses[:, :2], np.unwrap(poses[:, 2])))
    return np.asarray(np.diff(unwrapped, axis=0) / np.diff(times)[:, None])


def _differences(twists: FloatArray, steps: FloatArray, extent: float) -> FloatArray:
    """
    Compare rates with those before and after them, of which the nearer counts: they may jump.

    :param extent: of the body, at which a yaw rate is a speed [m].
    :return: [m/s], shape (n,).
    """
    def speeds(rates: FloatArray) -> FloatArray:
        return np.maximum(np.hypot(rates[:, 0], rates[:, 1]), extent * np.abs(rates[:, 2]))
    before, after = np.vstack((steps[:1], steps)), np.vstack((steps, steps[-1:]))
    return np.minimum(speeds(twists - before), speeds(twists - after))


def _refuse_above(name: str, values: FloatArray, limit: float, what: str) -> None:
    sample = int(np.argmax(values))
    # False for what is not a number as well.
    if not values[sample] <= limit:
        raise ValueError(f'{name}: got {values[sample]:.3g} {what} at sample {sample}, expected '
                         f'at most {limit:.3g}')
