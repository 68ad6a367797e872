"""Formulation of a push: from a problem and a route to the numbers of the nonlinear program."""

import math
from typing import NamedTuple, Protocol

import numpy as np
from push_model.contact import face_length, normal_range
from push_model.friction import has_heights
from push_model.geometry import FloatArray, wrap_angle
from push_planner.problem import PushProblem
from push_planner.steered.collocation.collocation import radau
from push_planner.steered.collocation.dimensions import BoundaryValues, Dimensions, Limits, POINTS
from push_planner.steered.collocation.mesh import build_mesh, Mesh
from push_planner.steered.collocation.solution import Solution, VariableBounds
from push_planner.steered.push_parameters import UNLIMITED, VERTEX_MARGIN

# Largest pushing angle that is searched [rad]. Chosen: 75 degrees, far outside every friction
# cone, and off the singularity at a right angle.
MAX_PUSHING_ANGLE = 1.3
# Least free length S of a push [m]. Chosen: steps of no length would divide by zero.
MIN_FREE_LENGTH = 1e-3
# How far a push under way may begin off its present pushing angle [rad]. Chosen: the solver wants
# some freedom inside its bounds; 0.1 degrees cannot be measured.
START_ANGLE_TOLERANCE = 2e-3
# Fraction of the largest pushing angle that the guess keeps to. Chosen: interior points start
# inside the bounds.
GUESS_ANGLE_FRACTION = 0.95
# Least free length of the guess, as a fraction of the path. Chosen: on short pushes the ramps and
# the final straight may be longer than the route.
MIN_FREE_FRACTION = 0.1


class NodeGuess(NamedTuple):
    """
    Guess at a motion, in the object's start frame.

    :param nodes: (w, rho, theta, q_x, q_y, phi) at the nodes, shape (n + 1, 6).
    :param rates: w at the Radau points, shape (n, K) [1/m].
    """

    nodes: FloatArray
    rates: FloatArray


class InitialRoute(Protocol):
    """A route to the goal that the program can start from."""

    @property
    def name(self) -> str:
        """Name in reports."""
        ...

    @property
    def path_length(self) -> float:
        """Path length of the contact, final straight included [m]."""
        ...

    @property
    def final_straight(self) -> float:
        """Length of the straight push at its end [m]."""
        ...

    @property
    def rotation(self) -> float:
        """Angle by which the object rotates [rad]."""
        ...

    def guess(self, problem: PushProblem, lengths: FloatArray, points: FloatArray) -> NodeGuess:
        """
        Follow the route.

        :param lengths: of the steps, summing to the path length, shape (n,) [m].
        :param points: Radau points of a step, shape (K,).
        """
        ...


class Formulation(NamedTuple):
    """
    Input of a program.

    :param dimensions: ``Dimensions``.
    :param mesh: ``Mesh``.
    :param bounds: ``VariableBounds``.
    :param boundary: ``BoundaryValues``.
    :param common: parameters of the whole push, shape (c,).
    :param steps: ``StepData`` of the steps, shape (n, 7).
    """

    dimensions: Dimensions
    mesh: Mesh
    bounds: VariableBounds
    boundary: BoundaryValues
    common: FloatArray
    steps: FloatArray

    def parameters(self) -> FloatArray:
        """Join all parameters."""
        return np.concatenate([self.common, self.steps.ravel()])


def formulate(problem: PushProblem, route: InitialRoute,
              refined: bool = False) -> tuple[Formulation, Solution]:
    """
    Set up the program for a route.

    :param route: the route to start from.
    :param refined: whether linear pushing angles get twice as many segments.
    :return: (``Formulation``, ``Solution`` to start from).
    """
    mesh = build_mesh(problem, route.path_length, route.final_straight, refined)
    formulation = formulate_on(problem, mesh, route.final_straight > 0.0, route.rotation)
    return formulation, _first_guess(problem, route, formulation)


def formulate_on(problem: PushProblem, mesh: Mesh, straight_end: bool,
                 rotation: float) -> Formulation:
    """
    Set up the program on a mesh.

    :param straight_end: whether the end is a straight push through the centre of friction.
    :param rotation: angle by which the object rotates, about [rad].
    """
    settings = problem.settings
    dimensions = Dimensions(problem.kind, len(problem.obj.supports), len(mesh.lengths),
                            settings.pushing_angles == 'constant', straight_end,
                            settings.heading_free, has_heights(problem.obj))
    boundary = _boundary_values(problem, rotation)
    common = np.concatenate([problem.push_parameters.column(), _limits(problem), boundary])
    return Formulation(dimensions, mesh, _bounds(problem), boundary, common,
                       _step_data(problem, mesh))


def with_goal(previous: Formulation, problem: PushProblem, rotation: float) -> Formulation:
    """
    Set up the program of a push to another goal; all else is as it was.

    :param previous: ``Formulation`` of a problem that differs in the goal alone.
    :param rotation: angle by which the object rotates, about [rad].
    """
    boundary, common = _boundary_values(problem, rotation), previous.common.copy()
    common[-len(boundary):] = boundary
    return previous._replace(boundary=boundary, common=common)


def max_angle_rate(problem: PushProblem) -> float:
    """
    Highest rate of a linear pushing angle, the robot's acceleration included [rad/s].

    A holonomic robot accelerates sideways, a differential drive in yaw.
    """
    robot, settings = problem.robot, problem.settings
    if problem.kind == 'differential':
        lever = robot.radius * math.cos(problem.heading_offset)
        return min(settings.max_angle_rate,
                   robot.max_yaw_acceleration * lever / settings.pushing_speed)
    return min(settings.max_angle_rate, robot.max_acceleration / settings.pushing_speed)


def rotation_range(problem: PushProblem) -> tuple[float, float]:
    """
    Find the rotations of the object for which a rolling contact stays on its face or vertex.

    :return: (lowest, highest) [rad].
    """
    radius = problem.robot.radius
    if problem.kind != 'rolling' or problem.contact.kind == 'round':
        return -math.inf, math.inf
    if problem.contact.kind == 'vertex':
        low, high = _vertex_normals(problem)
        return problem.start_normal - high, problem.start_normal - low
    half = 0.5 * face_length(problem.obj, problem.contact.index)
    return ((-half - problem.contact.offset) / radius, (half - problem.contact.offset) / radius)


def followed_point(problem: PushProblem) -> tuple[float, float]:
    """
    Find the followed point of a ``Node`` at the start, in the object frame.

    :return: (x, y) [m].
    """
    x, y = problem.contact_point
    if problem.kind == 'rolling':
        x -= problem.robot.radius * math.cos(problem.start_normal)
        y -= problem.robot.radius * math.sin(problem.start_normal)
    return x, y


def _step_data(problem: PushProblem, mesh: Mesh) -> FloatArray:
    """Columns of ``StepData``."""
    weight = 1.0 if problem.settings.motion_model == 'dynamic' else 0.0
    end = mesh.end_v_squared
    fastest = np.sqrt(np.maximum(mesh.v_squared, end))
    return np.array([mesh.lengths, mesh.free_fractions, weight * mesh.v_squared,
                     weight * mesh.v_squared_slopes, mesh.may_steer,
                     max_angle_rate(problem) / fastest, end]).T


def _limits(problem: PushProblem) -> Limits:
    settings, robot = problem.settings, problem.robot
    min_normal, max_normal = -UNLIMITED, UNLIMITED
    if problem.kind == 'differential':
        min_normal, max_normal = _vertex_normals(problem)
    cone = settings.angle_limit == 'cone'
    has_impulse = settings.motion_model == 'dynamic' and not problem.motion.speed > 0.0
    return Limits(math.tan(problem.planning_cone_angle), 0.0 if cone else UNLIMITED,
                  0.0 if cone and has_impulse else UNLIMITED, robot.max_speed,
                  robot.max_yaw_rate, min_normal, max_normal)


def _vertex_normals(problem: PushProblem) -> tuple[float, float]:
    """Range of the normal at a vertex, in the object frame, next to the one at the start."""
    low, high = normal_range(problem.obj, problem.contact)
    shift = problem.start_normal - wrap_angle(problem.start_normal - low) - low
    return low + shift + VERTEX_MARGIN, high + shift - VERTEX_MARGIN


def _boundary_values(problem: PushProblem, rotation: float) -> BoundaryValues:
    q_x, q_y = followed_point(problem)
    goal, motion = problem.relative_goal, problem.motion
    # The goal's heading next to the rotation, which may be more than pi.
    theta = rotation + wrap_angle(goal.theta - rotation)
    moving = motion.speed > 0.0
    w = motion.yaw_rate / motion.speed if moving else 0.0
    delta = problem.vehicle.angle + problem.heading_offset
    delta = problem.start_normal + wrap_angle(delta - problem.start_normal)
    return BoundaryValues(q_x, q_y, w, float(moving), goal.x, goal.y, theta, delta,
                          *problem.friction_center)


def _bounds(problem: PushProblem) -> VariableBounds:
    settings, motion = problem.settings, problem.motion
    angle = MAX_PUSHING_ANGLE
    if settings.angle_limit == 'angle':
        angle = settings.max_pushing_angle
    first = -angle, angle
    if motion.speed > 0.0:
        first = (motion.pushing_angle - START_ANGLE_TOLERANCE,
                 motion.pushing_angle + START_ANGLE_TOLERANCE)
    return VariableBounds(angle, first, rotation_range(problem))


def _first_guess(problem: PushProblem, route: InitialRoute, formulation: Formulation) -> Solution:
    mesh = formulation.mesh
    free_length = max(route.path_length - mesh.fixed_length,
                      MIN_FREE_FRACTION * route.path_length)
    lengths = mesh.step_lengths(free_length)
    nodes, rates = route.guess(problem, lengths * (route.path_length / lengths.sum()),
                               radau(POINTS).points)
    rho = nodes[:, 1]
    if formulation.dimensions.jumps:
        rho = _segment_means(rho, mesh.may_steer)
    nodes = nodes.copy()
    largest = GUESS_ANGLE_FRACTION * formulation.bounds.angle
    rho = nodes[:, 1] = np.minimum(np.maximum(rho, -largest), largest)
    return Solution(free_length, nodes, rho[1:] - rho[:-1], rates)


def _segment_means(rho: FloatArray, may_steer: FloatArray) -> FloatArray:
    """Pushing angles held constant over each segment, at their mean [rad]."""
    starts = np.maximum.accumulate(np.where(may_steer > 0.0, np.arange(len(rho) - 1), 0))
    segments = np.searchsorted(np.unique(starts), starts)
    means = np.bincount(segments, 0.5 * (rho[1:] + rho[:-1])) / np.bincount(segments)
    return np.concatenate([[means[0]], means[segments]])
