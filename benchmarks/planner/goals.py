"""Random push problems that the planner is measured on, drawn from seeds."""

import dataclasses
import functools
import math
from typing import Any, Callable, Optional, Sequence, Union

from benchmarks.planner.check import Push
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, Drive, PushedObject, RoundRobot, Support
from push_planner.problem import PlannerSettings, PushProblem
from scipy.integrate import solve_ivp

POSITION_TOLERANCE, HEADING_TOLERANCE = 1e-3, math.radians(0.1)
SPEEDS = (0.05, 0.1, 0.25, 0.5, 1.0)
SIDE, MASS, FRICTION, VARIATION = 0.4, 2.0, 0.3, 0.4
NEAREST, FARTHEST, MAX_PATH_LENGTH = 0.2, 5.0, 100.0
# The limits of the drive are not what is measured here: only the cone may be active.
LIMITS: dict[str, Any] = {
    'max_speed': 5.0, 'max_yaw_rate': 50.0, 'max_acceleration': 100.0,
    'max_yaw_acceleration': 1000.0}
# Fraction of the cone that must be left on either side of the direction to the friction centre.
STEERING_RESERVE = 0.4
# Where the contact rolls, goals are ends of random pushes: fraction of the cone that their forces
# keep to, number of knots of the angle, radii of the robot [m], range of path lengths [m].
ROLLED_FRACTION = 0.8
ROLLED_KNOTS = 5
ROLLED_RADII = 0.05, 0.1, 0.17, 0.3
ROLLED_DISTANCES = 0.2, 2.0
DIFFERENTIAL = 'random boxes, vertex, differential'
ProblemMaker = Callable[[np.random.Generator], PushProblem]


def settings(speed: float, **overrides: Any) -> PlannerSettings:
    """Return the planner's settings; by default no braking and no final straight."""
    values: dict[str, Any] = {
        'pushing_speed': speed, 'final_straight': 0.0, 'deceleration': 0.0,
        'max_path_length': MAX_PATH_LENGTH, 'position_tolerance': POSITION_TOLERANCE,
        'heading_tolerance': HEADING_TOLERANCE, **overrides}
    return PlannerSettings(**values)


def box(length: float, width: float, mass: float,
        friction: Union[Sequence[float], FloatArray]) -> PushedObject:
    """Return a box on a foot at each corner; ``friction`` is one coefficient per foot."""
    corners = tuple((0.5 * length * x, 0.5 * width * y)
                    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return PushedObject(mass, supports=tuple(Support(x, y, mu)
                                             for (x, y), mu in zip(corners, friction)),
                        outline=corners)


def square() -> PushedObject:
    """Return the 0.4 m box."""
    return box(SIDE, SIDE, MASS, (FRICTION,) * 4)


def random_box(rng: np.random.Generator) -> PushedObject:
    """Draw size, aspect, mass and the friction of every foot of a box."""
    length = rng.uniform(0.2, 0.8)
    return box(length, length * rng.uniform(0.5, 1.5), rng.uniform(0.5, 10.0), _friction(rng, 4))


def random_bin(rng: np.random.Generator) -> PushedObject:
    """Draw a round object on three feet."""
    radius = rng.uniform(0.1, 0.4)
    feet = tuple(Support(0.8 * radius * math.cos(angle), 0.8 * radius * math.sin(angle), mu)
                 for angle, mu in zip((0.0, 2.1, 4.2), _friction(rng, 3)))
    return PushedObject(rng.uniform(0.5, 10.0), supports=feet, radius=radius)


def _friction(rng: np.random.Generator, feet: int) -> FloatArray:
    return rng.uniform(0.2, 0.6) * rng.uniform(1.0 - VARIATION, 1.0 + VARIATION, feet)


def random_goal(rng: np.random.Generator) -> Pose:
    """Draw a goal: any distance of the range, any bearing, any heading."""
    distance = rng.uniform(NEAREST, FARTHEST)
    bearing, heading = rng.uniform(-math.pi, math.pi, 2)
    return Pose(distance * math.cos(bearing), distance * math.sin(bearing), heading)


def mid_face(rng: np.random.Generator, obj: Optional[PushedObject] = None, radius: float = 0.17,
             drive: Drive = 'holonomic', speeds: Sequence[float] = SPEEDS,
             **overrides: Any) -> PushProblem:
    """Draw a push at the middle of the face whose normal is the object's +x axis."""
    return _push(rng, obj or square(), Contact('face', 3), RoundRobot(radius, drive, **LIMITS),
                 0.0, 0.0, speeds=speeds, overrides=overrides)


def random_face(rng: np.random.Generator, **overrides: Any) -> PushProblem:
    """Draw a box and a push at a face, somewhere from where it can be steered both ways."""
    while True:
        obj = random_box(rng)
        offset = friction_center(obj)[1] + rng.uniform(-0.1, 0.1) * abs(obj.outline[0][1])
        problem = _push(rng, obj, Contact('face', 3, offset),
                        RoundRobot(rng.uniform(0.05, 0.3), 'holonomic', **LIMITS), 0.0, 0.0,
                        speeds=SPEEDS, overrides=overrides)
        if _steers(problem):
            return problem


def vertex(rng: np.random.Generator, obj: Optional[PushedObject] = None, radius: float = 0.17,
           drive: Drive = 'differential', speeds: Sequence[float] = SPEEDS[:4]) -> PushProblem:
    """Draw a push at a vertex, towards the friction centre."""
    obj = obj or square()
    x, y = friction_center(obj)
    c_x, c_y = obj.outline[0]
    direction = math.atan2(y - c_y, x - c_x)
    return _push(rng, obj, Contact('vertex', 0), RoundRobot(radius, drive, **LIMITS), direction,
                 direction, speeds=speeds, overrides={})


def rolling(rng: np.random.Generator) -> PushProblem:
    """
    Draw a push at a face by a robot of fixed yaw; the contact rolls, there are no loops.

    Few goals can be reached so, and the goal is one of those: a random push ended there.
    """
    while True:
        problem = mid_face(rng, radius=rng.choice(ROLLED_RADII), robot_yaw='fixed')
        goal = _random_end(rng, problem)
        if goal is not None:
            return dataclasses.replace(problem, goal=goal)


def _random_end(rng: np.random.Generator, problem: PushProblem) -> Optional[Pose]:
    """Return the end of a push at random angles; None where it leaves the face or the cone."""
    push, speed = Push(problem), problem.settings.pushing_speed
    length = rng.uniform(*ROLLED_DISTANCES) / (ROLLED_KNOTS - 1)
    angles = rng.uniform(-1.0, 1.0, ROLLED_KNOTS) * problem.planning_cone_angle
    state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point, 0.0])
    state = push.jump(state, (0.0, 0.0), (speed, angles[0]))
    for ends in zip(angles, angles[1:]):
        push.steer(0.0, (speed, speed), ends, length / speed)
        answer = solve_ivp(push.rate, (0.0, length / speed), state, method='LSODA', rtol=1e-8,
                           atol=1e-8)
        forces = np.array([push.force(t, y) for t, y in zip(answer.t, answer.y.T)])
        steepest = np.abs(np.arctan2(forces[:, 1], forces[:, 0])).max()
        state = answer.y[:, -1]
        if steepest > ROLLED_FRACTION * problem.planning_cone_angle or abs(state[6]) > 0.45 * SIDE:
            return None
    return Pose(float(state[0]), float(state[1]), float(state[2]))


def random_round(rng: np.random.Generator) -> PushProblem:
    """Draw a round object and a push, from where it can be steered both ways."""
    while True:
        angle = rng.uniform(-math.pi, math.pi)
        problem = _push(rng, random_bin(rng), Contact('round', 0, angle),
                        RoundRobot(0.17, 'holonomic', **LIMITS), angle + math.pi,
                        angle + math.pi, speeds=SPEEDS, overrides={})
        if _steers(problem):
            return problem


def _push(rng: np.random.Generator, obj: PushedObject, contact: Contact, robot: RoundRobot,
          normal: float, heading: float, *, speeds: Sequence[float],
          overrides: dict[str, Any]) -> PushProblem:
    return PushProblem(obj, robot, contact, Pose(0.0, 0.0, 0.0), normal, heading,
                       random_goal(rng), settings(float(rng.choice(speeds)), **overrides))


def _steers(problem: PushProblem) -> bool:
    return abs(problem.normal_offset) < (1.0 - STEERING_RESERVE) * problem.planning_cone_angle


def problems(make: ProblemMaker, count: int, seed: int) -> list[PushProblem]:
    """
    Draw problems; those of a smaller count are the first of a larger one.

    :param make: function of a generator that draws one.
    :param count: how many.
    :param seed: of the first.
    :return: list of ``PushProblem``.
    """
    return [make(np.random.default_rng((seed, i))) for i in range(count)]


def families() -> dict[str, ProblemMaker]:
    """Return name -> function that draws a problem of each kind."""
    kinds: dict[str, ProblemMaker] = {
        'random boxes, face, holonomic': random_face,
        'square, vertex, differential': vertex,
        DIFFERENTIAL: lambda rng: vertex(
            rng, random_box(rng), rng.choice((0.1, 0.17, 0.25, 0.5))),
        'random boxes, vertex, holonomic': lambda rng: vertex(
            rng, random_box(rng), drive='holonomic', speeds=SPEEDS),
        'random bins, holonomic': random_round,
        'square, face, robot that does not turn': rolling,
        'square, mid-face, point robot': lambda rng: mid_face(rng, radius=0.0)}
    slow: dict[str, Any] = {'speeds': SPEEDS[:3]}
    optional: dict[str, dict[str, Any]] = {
        'free heading': {'heading_free': True},
        'braking at 0.5 m/s^2': {'deceleration': 0.5},
        'straight at the end': {'final_straight': 0.4},
        'quasi-static': {'motion_model': 'quasi_static', **slow},
        'constant angles': {'pushing_angles': 'constant', **slow}}
    kinds.update({f'square, mid-face, {name}': functools.partial(mid_face, **overrides)
                  for name, overrides in optional.items()})
    return kinds
