"""Pushes that the planner is measured on, drawn from seeds."""

import dataclasses
import functools
import math

import numpy as np
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_planner.problem import PlannerSettings, PushProblem

POSITION_TOLERANCE, HEADING_TOLERANCE = 1e-3, math.radians(0.1)
SPEEDS = (0.05, 0.1, 0.25, 0.5, 1.0)
SIDE, MASS, FRICTION, SPREAD = 0.4, 2.0, 0.3, 0.4
NEAREST, FARTHEST, LONGEST_WAY = 0.2, 5.0, 100.0
# What a drive can do is not what is asked here: no limit but the cone is to bind.
LIMITS = {'max_speed': 5.0, 'max_yaw_rate': 50.0, 'max_acceleration': 100.0,
          'max_yaw_acceleration': 1000.0}
STEERING_RESERVE = 0.4
# Without turning, the contact may not roll off the face.
FIXED_WIDEST = math.radians(35.0)
FIELDS = {field.name for field in dataclasses.fields(PlannerSettings)}


def settings(speed, **wanted):
    """Return the planner's settings; those that it does not know are left out."""
    wanted = {'pushing_speed': speed, 'run_in': 0.0, 'deceleration': 0.0,
              'max_path_length': LONGEST_WAY, 'position_tolerance': POSITION_TOLERANCE,
              'heading_tolerance': HEADING_TOLERANCE, **wanted}
    return PlannerSettings(**{name: value for name, value in wanted.items() if name in FIELDS})


def box(length, width, mass, friction):
    """Return a box on a foot at each corner; ``friction`` is one coefficient per foot."""
    corners = tuple((0.5 * length * x, 0.5 * width * y)
                    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return PushedObject(mass, supports=tuple(Support(x, y, mu)
                                             for (x, y), mu in zip(corners, friction)),
                        outline=corners)


def square():
    """Return the 0.4 m box."""
    return box(SIDE, SIDE, MASS, (FRICTION,) * 4)


def random_box(rng):
    """Draw size, aspect, mass and the friction of every foot of a box."""
    length = rng.uniform(0.2, 0.8)
    return box(length, length * rng.uniform(0.5, 1.5), rng.uniform(0.5, 10.0), _friction(rng, 4))


def random_bin(rng):
    """Draw a round object on three feet."""
    radius = rng.uniform(0.1, 0.4)
    feet = tuple(Support(0.8 * radius * math.cos(angle), 0.8 * radius * math.sin(angle), mu)
                 for angle, mu in zip((0.0, 2.1, 4.2), _friction(rng, 3)))
    return PushedObject(rng.uniform(0.5, 10.0), supports=feet, radius=radius)


def _friction(rng, feet):
    return rng.uniform(0.2, 0.6) * rng.uniform(1.0 - SPREAD, 1.0 + SPREAD, feet)


def random_goal(rng, widest=math.pi):
    """Draw a goal: any distance of the range, any bearing, any heading, or up to an angle."""
    distance, (bearing, turn) = rng.uniform(NEAREST, FARTHEST), rng.uniform(-widest, widest, 2)
    return Pose(distance * math.cos(bearing), distance * math.sin(bearing), turn)


def mid_face(rng, obj=None, radius=0.17, drive='holonomic', speeds=SPEEDS,
             widest=math.pi, **wanted):
    """Draw a push at the middle of the face whose normal is the object's +x axis."""
    return _push(rng, obj or square(), Contact('face', 3), RoundRobot(radius, drive, **LIMITS),
                 0.0, 0.0, speeds, wanted, widest)


def random_face(rng, **wanted):
    """Draw a box and a push at a face, somewhere from where it can be steered both ways."""
    while True:
        obj = random_box(rng)
        aside = friction_center(obj)[1] + rng.uniform(-0.1, 0.1) * abs(obj.outline[0][1])
        problem = _push(rng, obj, Contact('face', 3, aside),
                        RoundRobot(rng.uniform(0.05, 0.3), 'holonomic', **LIMITS), 0.0, 0.0,
                        SPEEDS, wanted)
        if _steers(problem):
            return problem


def vertex(rng, obj=None, radius=0.17, drive='differential', speeds=SPEEDS[:4]):
    """Draw a push at a vertex, towards the friction centre."""
    obj = obj or square()
    x, y = friction_center(obj)
    c_x, c_y = obj.outline[0]
    ahead = math.atan2(y - c_y, x - c_x)
    return _push(rng, obj, Contact('vertex', 0), RoundRobot(radius, drive, **LIMITS), ahead,
                 ahead, speeds, {})


def random_round(rng):
    """Draw a round object and a push, from where it can be steered both ways."""
    while True:
        place = rng.uniform(-math.pi, math.pi)
        problem = _push(rng, random_bin(rng), Contact('round', 0, place),
                        RoundRobot(0.17, 'holonomic', **LIMITS), place + math.pi,
                        place + math.pi, SPEEDS, {})
        if _steers(problem):
            return problem


def _push(rng, obj, contact, robot, normal, heading, speeds, wanted, widest=math.pi):
    return PushProblem(obj, robot, contact, Pose(0.0, 0.0, 0.0), normal, heading,
                       random_goal(rng, widest), settings(float(rng.choice(speeds)), **wanted))


def _steers(problem):
    return abs(problem.normal_offset) < (1.0 - STEERING_RESERVE) * problem.planning_angle


def problems(make, count, seed):
    """
    Draw problems; those of a smaller count are the first of a larger one.

    :param make: function of a generator that draws one.
    :param count: how many.
    :param seed: of the first.
    :return: list of ``PushProblem``.
    """
    return [make(np.random.default_rng((seed, i))) for i in range(count)]


def families():
    """Return name -> function that draws a problem of each kind; a kind must have its settings."""
    kinds = {
        'random boxes, face, holonomic': random_face,
        'square, vertex, differential': vertex,
        'random boxes, vertex, differential': lambda rng: vertex(
            rng, random_box(rng), rng.choice((0.1, 0.17, 0.25, 0.5))),
        'random boxes, vertex, holonomic': lambda rng: vertex(
            rng, random_box(rng), drive='holonomic', speeds=SPEEDS),
        'random bins, holonomic': random_round,
        'square, mid-face, point robot': lambda rng: mid_face(rng, radius=0.0)}
    slow = {'speeds': SPEEDS[:3]}
    optional = {
        'free heading': {'heading_free': True},
        'braking at 0.5 m/s^2': {'deceleration': 0.5},
        'straight at the end': {'run_in': 0.4},
        'quasi-static': {'motion_model': 'quasi_static', **slow},
        'constant angles': {'pushing_angles': 'constant', **slow},
        'robot that does not turn': {'robot_yaw': 'fixed', 'widest': FIXED_WIDEST}}
    kinds.update({f'square, mid-face, {name}': functools.partial(mid_face, **wanted)
                  for name, wanted in optional.items()
                  if set(wanted) - {'speeds', 'widest'} <= FIELDS})
    return kinds
