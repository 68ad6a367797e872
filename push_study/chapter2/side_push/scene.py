"""A round robot pushes a box on a side: in the contact simulation, and by the equations."""

import math

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.stability import equilibria, linear_motion
from push_model.analysis.time_integration import integrate, straight_push
from push_model.contact import find_contact, rolling_constants
from push_model.dynamics import impulse, ObjectTerms, State
from push_model.geometry import Pose
from push_model.parameters import Contact, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
from push_study.framework import scenes
from push_study.framework.study import Parameter
from scipy.optimize import brentq

BEHIND = 3
SAMPLES = 241
STEP = 2e-3
SMALL = 0.02
SCENE = (Parameter('robot_radius', 'm', 'radius of the robot'),
         Parameter('speed', 'm/s', 'of the robot, which drives straight'),
         Parameter('duration', 's', 'of the push')) + scenes.BOX


def box(values, distance):
    """
    Make the box; its mass, and with it the loads and the friction centre, shifted along x.

    :param values: ``Values``.
    :param distance: from the face that is pushed to the friction centre [m].
    :return: ``PushedObject``.
    """
    return scenes.box(values, center_of_mass=(distance - 0.5 * values.box_length, 0.0))


def start_pose(values, turned, aside):
    """
    Place the box before a robot at the origin that will drive along x.

    :param values: ``Values``.
    :param turned: turn from straight ahead, rolled on the robot [rad].
    :param aside: of the robot from the centre line before that, to its left [m].
    :return: ``Pose`` of the box.
    """
    contact = -0.5 * values.box_length, aside + values.robot_radius * turned
    x, y = Pose(0.0, 0.0, turned).rotate(contact)
    radius = values.robot_radius
    return Pose(radius * math.cos(turned) - x, radius * math.sin(turned) - y, turned)


def simulate(values, distance, turned, aside):
    """
    Push the box in the contact simulation.

    :param values: ``Values``.
    :param distance: of the friction centre [m].
    :param turned: turn at the start [rad].
    :param aside: of the robot [m].
    :return: (times [s], turns of the box [rad], whether the contact has held so far), each of
        shape (n,).
    """
    robot = RoundRobot(radius=values.robot_radius, max_speed=values.speed, time_constant=0.0,
                       max_acceleration=100.0)
    plant = Plant(box(values, distance), robot, start_pose(values, turned, aside),
                  Pose(0.0, 0.0, 0.0), STEP)
    times = np.linspace(0.0, values.duration, SAMPLES)
    turns, holds = [turned], [True]
    for duration in np.diff(times):
        plant.advance(duration, Twist(values.speed))
        turns.append(plant.object_pose.theta)
        holds.append(holds[-1] and plant.mode is ContactMode.STICK)
    return times, np.array(turns), np.array(holds)


def equations(values, distance, turned, aside, times):
    """
    Integrate the rolling equations of motion for the same push.

    :param values: ``Values``.
    :param distance: of the friction centre [m].
    :param turned: turn at the start [rad].
    :param aside: of the robot [m].
    :param times: where to sample [s].
    :return: turns of the box [rad], shape (n,).
    """
    obj, pose = box(values, distance), start_pose(values, turned, aside)
    contact, gamma, _ = find_contact(obj, pose, (0.0, 0.0), values.robot_radius)
    start = State(*pose, 0.0, gamma, -0.5 * values.box_length, contact.offset)
    jump = impulse(ObjectTerms.of(obj), start, values.speed, 0.0)[0]
    _, states = integrate(obj, rolling_constants(values.robot_radius, math.inf),
                          straight_push(values.speed, 0.0), start._replace(omega=jump), times)
    return states[:, 2]


def predicted_rate(values, distance):
    """
    Rate at which a small turn grows, by the linear motion about the straight push [1/s].

    :param values: ``Values``.
    :param distance: of the friction centre [m].
    """
    obj = box(values, distance)
    location = pushing_location(obj, Contact('face', BEHIND), values.robot_radius)
    straight = min(equilibria(location), key=lambda one: abs(one.rotation))
    return linear_motion(obj, location, straight, values.speed).growth_rate


def measured_rate(values, distance):
    """
    Rate at which a small turn grows in the contact simulation [1/s].

    :param values: ``Values``.
    :param distance: of the friction centre [m].
    """
    times, turns, holds = simulate(values, distance, SMALL, 0.0)
    # While it is small, but not lost in numbers, and after the faster motion has died out.
    size = np.maximum(np.abs(turns), 1e-12)
    window = np.flatnonzero(np.cumprod(holds & (size < 5.0 * SMALL) & (size > 1e-3 * SMALL)))
    window = window[len(window) // 3:]
    return float(np.polyfit(times[window], np.log(size[window]), 1)[0])


def switch(values):
    """
    Find the distance of the friction centre at which a small turn begins to grow [m].

    :param values: ``Values``.
    :return: the distance; nan where the box has no room for it.
    """
    low, high = (min(share * values.robot_radius, 0.95 * values.box_length)
                 for share in (0.7, 1.3))
    if measured_rate(values, low) * measured_rate(values, high) >= 0.0:
        return math.nan
    return float(brentq(lambda distance: measured_rate(values, distance), low, high, xtol=1e-6))
