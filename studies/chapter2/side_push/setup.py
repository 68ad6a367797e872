"""A round robot pushes a box on a side: in the contact simulation, and by the equations."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.contact import find_contact, rolling_constants
from push_model.dynamics import impulse, ObjectTerms, State
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
from scipy.optimize import brentq
from studies.analysis.pushing_location import pushing_location
from studies.analysis.stability import equilibria, linear_motion
from studies.analysis.time_integration import integrate, straight_push
from studies.framework.box import BOX, box, REAR_FACE
from studies.framework.parameters import Parameter, Values

# Chosen: times at which the rotation is recorded.
SAMPLES = 241
# Chosen: integration step of the simulation, at which rotations agree to 3e-4 rad [s].
STEP = 2e-3
# Chosen: small enough that the growth is exponential, and far above rounding [rad].
SMALL_ROTATION = 0.02
# Chosen: the stability limit is searched between these multiples of the robot's radius, and not
# beyond this fraction of the box.
SEARCH_RANGE = (0.7, 1.3)
MAX_BOX_FRACTION = 0.95
SETUP = (Parameter('robot_radius', 'm', 'radius of the robot'),
         Parameter('speed', 'm/s', 'speed of the robot, which drives straight'),
         Parameter('duration', 's', 'duration of the push'), *BOX)


class Start(NamedTuple):
    """
    Start of a push.

    :param rotation: of the box from straight ahead, rolled on the robot [rad].
    :param lateral_offset: of the robot from the centre line of the box before that, to the left
        [m].
    """

    rotation: float
    lateral_offset: float


EXACT_START = Start(0.0, 0.0)


class Rotations(NamedTuple):
    """
    A simulated push.

    :param times: [s], shape (n,).
    :param rotations: of the box [rad], shape (n,).
    :param holds: whether the contact has not slid so far, shape (n,).
    """

    times: FloatArray
    rotations: FloatArray
    holds: NDArray[np.bool_]


def shifted_box(values: Values, distance: float) -> PushedObject:
    """
    Make the box with its mass, and so the loads and the centre of friction, shifted along x.

    :param values: with the parameters ``SETUP``.
    :param distance: from the face that is pushed to the centre of friction [m].
    :return: the box.
    """
    return box(values, center_of_mass=(distance - 0.5 * values.box_length, 0.0))


def start_pose(values: Values, start: Start) -> Pose:
    """
    Place the box before a robot at the origin that will drive along x.

    :param values: with the parameters ``SETUP``.
    :param start: rotation and offset.
    :return: pose of the box.
    """
    contact = (-0.5 * values.box_length,
               start.lateral_offset + values.robot_radius * start.rotation)
    x, y = Pose(0.0, 0.0, start.rotation).rotate(contact)
    radius = values.robot_radius
    return Pose(radius * math.cos(start.rotation) - x, radius * math.sin(start.rotation) - y,
                start.rotation)


def sample_times(values: Values) -> FloatArray:
    """
    List the times at which a simulated push is recorded.

    :param values: with the parameter ``duration``.
    :return: times [s], shape (``SAMPLES``,).
    """
    return np.linspace(0.0, values.duration, SAMPLES)


def simulate(values: Values, distance: float, start: Start) -> Rotations:
    """
    Push the box in the contact simulation.

    :param values: with the parameters ``SETUP``.
    :param distance: from the face to the centre of friction [m].
    :param start: of the push.
    :return: the rotation of the box over time.
    """
    # Without lag, so that the robot moves as the equations of motion have it.
    robot = RoundRobot(radius=values.robot_radius, max_speed=values.speed, time_constant=0.0,
                       max_acceleration=100.0)
    plant = Plant(shifted_box(values, distance), robot, start_pose(values, start),
                  Pose(0.0, 0.0, 0.0), STEP)
    times = sample_times(values)
    rotations, holds = [start.rotation], [True]
    for duration in np.diff(times):
        plant.advance(duration, Twist(values.speed))
        rotations.append(plant.object_pose.theta)
        holds.append(holds[-1] and plant.mode is ContactMode.STICK)
    return Rotations(times, np.array(rotations), np.array(holds))


def integrate_rolling(values: Values, distance: float, start: Start,
                      times: FloatArray) -> FloatArray:
    """
    Integrate the equations of motion of a rolling contact for the same push.

    :param values: with the parameters ``SETUP``.
    :param distance: from the face to the centre of friction [m].
    :param start: of the push.
    :param times: where to sample [s], shape (n,).
    :return: rotations of the box [rad], shape (n,).
    """
    obj, pose = shifted_box(values, distance), start_pose(values, start)
    contact, gamma, _ = find_contact(obj, pose, (0.0, 0.0), values.robot_radius)
    state = State(*pose, 0.0, gamma, -0.5 * values.box_length, contact.offset)
    # The box is at rest: the robot meets it with its full speed.
    yaw_rate = impulse(ObjectTerms.of(obj), state, values.speed, 0.0)[0]
    _, states = integrate(obj, rolling_constants(values.robot_radius, math.inf),
                          straight_push(values.speed, 0.0), state._replace(omega=yaw_rate), times)
    return states[:, 2]


def predicted_growth_rate(values: Values, distance: float) -> float:
    """
    Compute how fast a small rotation grows, by the motion linearized about the straight push.

    :param values: with the parameters ``SETUP``.
    :param distance: from the face to the centre of friction [m].
    :return: growth rate [1/s], below 0 where it decays.
    """
    obj = shifted_box(values, distance)
    location = pushing_location(obj, Contact('face', REAR_FACE), values.robot_radius)
    straight = min(equilibria(location), key=lambda equilibrium: abs(equilibrium.rotation))
    return linear_motion(obj, location, straight, values.speed).growth_rate


def simulated_growth_rate(values: Values, distance: float) -> float:
    """
    Measure how fast a small rotation grows in the contact simulation.

    :param values: with the parameters ``SETUP``.
    :param distance: from the face to the centre of friction [m].
    :return: growth rate [1/s], below 0 where it decays.
    """
    times, rotations, holds = simulate(values, distance, Start(SMALL_ROTATION, 0.0))
    # While it is small, but above the resolution, and after the faster motion has died out.
    size = np.maximum(np.abs(rotations), 1e-12)
    is_small = (size < 5.0 * SMALL_ROTATION) & (size > 1e-3 * SMALL_ROTATION)
    window = np.flatnonzero(np.cumprod(holds & is_small))
    window = window[len(window) // 3:]
    return float(np.polyfit(times[window], np.log(size[window]), 1)[0])


def stability_limit(values: Values) -> float:
    """
    Find the distance of the centre of friction at which a small rotation begins to grow.

    :param values: with the parameters ``SETUP``.
    :return: distance from the face [m]; nan where the box is too short for it.
    """
    low, high = (min(factor * values.robot_radius, MAX_BOX_FRACTION * values.box_length)
                 for factor in SEARCH_RANGE)
    if simulated_growth_rate(values, low) * simulated_growth_rate(values, high) >= 0.0:
        return math.nan
    limit: Any = brentq(lambda distance: simulated_growth_rate(values, distance), low, high,
                        xtol=1e-6)
    return float(limit)
