"""
A control step of a push in numbers: where it stands, what the contact allows, and the command.

A step takes two calls: ``look``, before the law, and ``write_command``, after it.

Compiled functions work on two arrays of numbers: one that a push fills once, when it begins, and
one that every step fills anew. The names below say which number is which. Python passes an array
in 0.1 us, where a named tuple takes 2 us and more; so tuples are made in compiled code only.
"""

import math
from typing import Any

from push_control.steered.estimation.contact_site import contact_site, rolled_contact
from push_control.steered.estimation.filter_kernel import (
    C_SQUARED as FILTER_C_SQUARED, LAST as FILTER_LAST, predict, push_state, SIZE,
    STATE as FILTER_STATE)
from push_control.steered.estimation.limit_surface_table import TABLE_SIZE
from push_control.steered.laws.command import mean_twist
from push_control.steered.laws.contact_steering import (
    approach_command, curvature_limits, Steering, steering_command, zeta_at_rest, zeta_limits,
)
from push_control.steered.path.path import keeps_path, write_projection
from push_dynamics.compiled import compiled, wrap_angles
from push_model import friction, quasi_static
from push_model.friction import FrictionCovariance
from push_model.geometry import Pose
from push_model.quasi_static import MIN_ARM, Vehicle
from push_model.signals import Twist

c_squared_along = compiled(friction.c_squared_along)
straight_slide = compiled(quasi_static.straight_slide)
vehicle_along = compiled(quasi_static.vehicle_along)

# Push, what does not change while it goes on: the robot.
IS_DIFFERENTIAL = 0
MAX_SPEED = 1
MAX_YAW_RATE = 2
TIME_CONSTANT = 3
ROLLING_GAIN = 4
START_SPEED = 5
# Push: half angle of the friction cone that is relied on [rad], and the fraction of it that
# feedback may use.
CONE_ANGLE = 6
FEEDBACK_FRACTION = 7
# Push: lateral and heading error of z up to which its path is kept [m, rad].
MAX_ERRORS = 8
# Push: ``FrictionCovariance`` of the nominal supports [m^2], and the height of the contact [m].
COVARIANCE = 10
CONTACT_HEIGHT = 13
# Push: goal of the object in the world (x, y) [m], theta [rad].
GOAL = 14
# Push: ``LimitSurfaceTable.forces`` [rad].
FORCES = 17
PUSH_SIZE = FORCES + TABLE_SIZE

# Step: ``PushState`` now, and one drive lag ahead, where the command takes effect.
NOW = 0
PREDICTED = NOW + SIZE
# Step: angle of the contact normal in the object frame, now and ahead [rad].
NORMAL_NOW = PREDICTED + SIZE
NORMAL_PREDICTED = NORMAL_NOW + 1
# Step: the object as ``Vehicle``, pushed at the contact ahead: C [m], r [m], angle of C->F [rad]
# and c^2 [m^2].
CONTACT = NORMAL_PREDICTED + 1
ARM = CONTACT + 2
ANGLE = ARM + 1
C_SQUARED = ANGLE + 1
# Step: z in its goal frame (x, y) [m], theta [rad], now and ahead.
FLAT_NOW = C_SQUARED + 1
FLAT_PREDICTED = FLAT_NOW + 3
# Step: lowest and highest curvature of feedback, now and ahead [1/m].
LIMITS_NOW = FLAT_PREDICTED + 3
LIMITS_PREDICTED = LIMITS_NOW + 2
# Step: the ``Posture`` of the contact [rad].
ZETA = LIMITS_PREDICTED + 2
ZETA_REST = ZETA + 1
ZETA_LOW = ZETA + 2
ZETA_HIGH = ZETA + 3
# Step: from the time of ``latest`` of the filter until now [s].
INTERVAL = ZETA_HIGH + 1
# Step: the command, which the robot follows up to the next step, and the mean motion meanwhile,
# robot's axes [m/s, m/s, rad/s].
COMMAND = INTERVAL + 1
EXPECTED = COMMAND + 3
STEP_SIZE = EXPECTED + 3

# What a look at the push finds: whether the path can be kept, or why it cannot be told.
PATH_HOLDS = 0
PATH_IS_EXCEEDED = 1
NOT_FINITE = 2
CENTER_AT_CONTACT = 3


@compiled
def steering_of(push: Any, memory: Any) -> Steering:
    """
    Read what the robot steers by.

    :param push: numbers of the push, shape (``PUSH_SIZE``,).
    :param memory: of the filter, see ``filter_kernel``.
    """
    return Steering(push[IS_DIFFERENTIAL] > 0.0, push[CONE_ANGLE], push[ROLLING_GAIN],
                    push[MAX_SPEED], push[MAX_YAW_RATE], memory[FILTER_C_SQUARED:FILTER_LAST],
                    push[FORCES:PUSH_SIZE])


@compiled
def step_vehicle(step: Any) -> Vehicle:
    """
    Read the object as it is pushed.

    :param step: numbers of the step, shape (``STEP_SIZE``,).
    """
    return vehicle_along((step[CONTACT], step[CONTACT + 1]), step[ARM], step[ANGLE],
                         step[C_SQUARED])


@compiled
def look(push: Any, supports: Any, memory: Any, step: Any, rows: Any, projection: Any) -> int:
    """
    Look at the push at one control step: predict, observe, and project z ahead on its path.

    :param push: numbers of the push, shape (``PUSH_SIZE``,).
    :param supports: ``sliding_rows`` where a push shifts loads, else none, shape (k, 5).
    :param memory: of the filter, ``latest`` of which is at the time of the last odometry.
    :param step: numbers of the step, is written up to the command, shape (``STEP_SIZE``,).
    :param rows: ``FlatOutputPath.rows``.
    :param projection: numbers of the last ``PathProjection``, become those of z ahead.
    :return: ``PATH_HOLDS``, ``PATH_IS_EXCEEDED`` where errors or curvatures exceed what they may,
        ``NOT_FINITE`` or ``CENTER_AT_CONTACT``.
    """
    lag = push[TIME_CONSTANT]
    last, command = memory[FILTER_LAST + 1:FILTER_STATE], step[COMMAND:EXPECTED]
    step[EXPECTED], step[EXPECTED + 1], step[EXPECTED + 2] = mean_twist(
        Twist(last[0], last[1], last[2]), Twist(command[0], command[1], command[2]), lag)
    if not predict(memory, step[INTERVAL], step[EXPECTED:STEP_SIZE], lag, step[NOW:NORMAL_NOW]):
        return NOT_FINITE
    observe(push, supports, memory, step)
    if not step[ARM] >= MIN_ARM:
        return CENTER_AT_CONTACT
    write_projection(rows, step[FLAT_PREDICTED], step[FLAT_PREDICTED + 1],
                     step[FLAT_PREDICTED + 2], projection)
    errors, limits = push[MAX_ERRORS:COVARIANCE], step[LIMITS_PREDICTED:ZETA]
    return PATH_HOLDS if keeps_path(rows, projection, errors, limits) else PATH_IS_EXCEEDED


@compiled
def observe(push: Any, supports: Any, memory: Any, step: Any) -> None:
    """
    Evaluate what follows from the states of a step: from ``NORMAL_NOW`` up to ``ZETA_HIGH``.

    :param push: numbers of the push, shape (``PUSH_SIZE``,).
    :param supports: ``sliding_rows`` where a push shifts loads, else none, shape (k, 5).
    :param memory: of the filter, see ``filter_kernel``.
    :param step: numbers of the step, both states of which are given, shape (``STEP_SIZE``,).
    """
    site = contact_site(memory)
    now, predicted = push_state(step[NOW:PREDICTED]), push_state(step[PREDICTED:NORMAL_NOW])
    frame = rolled_contact(site, predicted.phi - predicted.theta)
    step[NORMAL_NOW] = rolled_contact(site, now.phi - now.theta).normal
    step[NORMAL_PREDICTED] = frame.normal
    step[CONTACT], step[CONTACT + 1] = frame.x, frame.y
    step[ARM] = math.hypot(predicted.p_x - frame.x, predicted.p_y - frame.y)
    step[ANGLE] = math.atan2(predicted.p_y - frame.y, predicted.p_x - frame.x)
    nominal = straight_c_squared(push, supports, step[ANGLE], step[ARM])
    step[C_SQUARED] = math.exp(predicted.q) * nominal
    vehicle = step_vehicle(step)
    goal = Pose(push[GOAL], push[GOAL + 1], push[GOAL + 2])
    write_flat_output(vehicle, Pose(now.x, now.y, now.theta), goal, step[FLAT_NOW:FLAT_PREDICTED])
    write_flat_output(vehicle, Pose(predicted.x, predicted.y, predicted.theta), goal,
                      step[FLAT_PREDICTED:LIMITS_NOW])
    steering, fraction = steering_of(push, memory), push[FEEDBACK_FRACTION]
    for normal, limits in ((NORMAL_NOW, LIMITS_NOW), (NORMAL_PREDICTED, LIMITS_PREDICTED)):
        step[limits], step[limits + 1] = curvature_limits(steering, site, vehicle, step[normal],
                                                          fraction)
    normal = step[NORMAL_NOW]
    step[ZETA] = wrap_angles(normal - vehicle.angle)
    step[ZETA_REST] = zeta_at_rest(steering, site, now)
    step[ZETA_LOW], step[ZETA_HIGH] = zeta_limits(site, vehicle, normal)


@compiled
def straight_c_squared(push: Any, supports: Any, angle: float, arm: float) -> float:
    """
    Evaluate the nominal c^2 of a straight push, under the loads that it shifts [m^2].

    :param push: numbers of the push.
    :param supports: ``sliding_rows`` where a push shifts loads, else none, shape (k, 5).
    :param angle: direction from C to F in the object frame [rad].
    :param arm: r [m].
    """
    if len(supports) == 0:
        covariance = FrictionCovariance(push[COVARIANCE], push[COVARIANCE + 1],
                                        push[COVARIANCE + 2])
        return c_squared_along(covariance, angle)
    slide = straight_slide(push[CONTACT_HEIGHT], supports, angle)
    return slide.c_squared * arm / (arm - slide.shift)


@compiled
def write_flat_output(vehicle: Vehicle, pose: Pose, goal: Pose, flat: Any) -> None:
    """
    Pose of z in its goal frame: the frame of z where the object is at its goal.

    :param vehicle: the object as ``Vehicle``.
    :param pose: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object at its goal, in the world.
    :param flat: (x, y) [m], theta [rad], is written.
    """
    x, y = vehicle.flat_output
    cosine, sine = math.cos(pose.theta), math.sin(pose.theta)
    goal_cosine, goal_sine = math.cos(goal.theta), math.sin(goal.theta)
    off_x = pose.x + cosine * x - sine * y - (goal.x + goal_cosine * x - goal_sine * y)
    off_y = pose.y + sine * x + cosine * y - (goal.y + goal_sine * x + goal_cosine * y)
    along = goal.theta + vehicle.angle
    flat[0] = math.cos(along) * off_x + math.sin(along) * off_y
    flat[1] = math.cos(along) * off_y - math.sin(along) * off_x
    flat[2] = pose.theta - goal.theta


@compiled
def write_limits(push: Any, memory: Any, step: Any, cone_fraction: float, limits: Any) -> None:
    """
    Curvatures that the contact survives one drive lag ahead, with a part of the friction cone.

    :param push: numbers of the push.
    :param memory: of the filter.
    :param step: numbers of the step, observed.
    :param cone_fraction: fraction of the friction cone that may be used.
    :param limits: lowest and highest curvature [1/m], are written, shape (2,).
    """
    limits[0], limits[1] = curvature_limits(steering_of(push, memory), contact_site(memory),
                                            step_vehicle(step), step[NORMAL_PREDICTED],
                                            cone_fraction)


@compiled
def write_approach(push: Any, memory: Any, step: Any) -> None:
    """
    Compute the command that closes a gap slowly.

    :param push: numbers of the push.
    :param memory: of the filter.
    :param step: numbers of the step, observed; the command is written.
    """
    command = approach_command(steering_of(push, memory), step[NORMAL_PREDICTED],
                               push_state(step[PREDICTED:NORMAL_NOW]), push[START_SPEED])
    step[COMMAND], step[COMMAND + 1], step[COMMAND + 2] = command


@compiled
def write_command(push: Any, memory: Any, step: Any, curvature: float, speed: float) -> int:
    """
    Compute the command that gives z a curvature.

    :param push: numbers of the push.
    :param memory: of the filter.
    :param step: numbers of the step, observed; the command is written.
    :param curvature: of z [1/m].
    :param speed: of the contact [m/s].
    :return: mode of ``monitors.jackknife_mode``.
    """
    command, mode = steering_command(steering_of(push, memory), contact_site(memory),
                                     step_vehicle(step), push_state(step[PREDICTED:NORMAL_NOW]),
                                     curvature, speed)
    step[COMMAND], step[COMMAND + 1], step[COMMAND + 2] = command
    return mode
