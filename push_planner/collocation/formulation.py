"""From a problem and a route to the numbers of a programme."""

import math
from typing import NamedTuple

import numpy as np
from push_model.contact import face_length, normal_range
from push_model.geometry import wrap_angle
from push_planner.collocation.collocation import radau
from push_planner.collocation.dimensions import BoundaryValues, Dimensions, Limits, POINTS
from push_planner.collocation.mesh import build_mesh, Mesh
from push_planner.collocation.nlp_solver import Solution, VariableBounds
from push_planner.push_parameters import UNLIMITED, VERTEX_MARGIN

STEEPEST_ANGLE = 1.3
SAME_ANGLE = 2e-3


class Formulation(NamedTuple):
    """
    A programme's input.

    :param shape: ``Dimensions``.
    :param grid: ``Mesh``.
    :param box: ``VariableBounds``.
    :param ends: ``BoundaryValues``.
    :param common: parameters of the whole push, shape (c,).
    :param steps: parameters of the steps, shape (n, s).
    """

    shape: Dimensions
    grid: Mesh
    box: VariableBounds
    ends: BoundaryValues
    common: np.ndarray
    steps: np.ndarray

    def parameters(self, defects=None):
        """
        Join the parameters.

        :param defects: error of each step's end state, shape (n, states - 1); None for none.
        """
        if defects is None:
            defects = np.zeros((self.shape.steps, self.shape.states - 1))
        return np.concatenate([self.common, np.hstack([self.steps, defects]).ravel()])


def formulate(problem, route, finer=False):
    """
    Set up the programme for a route.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :param finer: whether linear pushing angles get twice as many pieces.
    :return: (``Formulation``, ``Solution`` to start from).
    """
    grid = build_mesh(problem, route.path_length, route.final_straight, finer)
    settings = problem.settings
    shape = Dimensions(problem.kind, len(problem.obj.supports), len(grid.lengths),
                       settings.pushing_angles == 'constant', route.final_straight > 0.0,
                       settings.heading_free)
    ends = _ends(problem, route)
    common = np.concatenate([problem.push_parameters.column(), _limits(problem), ends])
    weight = 1.0 if settings.motion_model == 'dynamic' else 0.0
    last = grid.ends
    steps = np.column_stack([grid.lengths, grid.shares, weight * grid.squares,
                             weight * grid.slopes, grid.free,
                             angle_rate(problem) / np.sqrt(np.maximum(grid.squares, last)), last])
    formulation = Formulation(shape, grid, _box(problem), ends, common, steps)
    guess = _first_guess(problem, route, formulation)
    followed = guess.nodes[:, 3:5]
    box = formulation.box._replace(places=(followed - route.max_deviation, followed + route.max_deviation))
    return formulation._replace(box=box), guess


def angle_rate(problem):
    """
    Highest rate of a linear pushing angle, the robot's acceleration included [rad/s].

    A holonomic robot accelerates sideways, a differential drive in yaw.

    :param problem: the ``PushProblem``.
    """
    robot, settings = problem.robot, problem.settings
    if problem.kind == 'differential':
        reach = robot.radius * math.cos(problem.heading_offset)
        return min(settings.max_angle_rate,
                   robot.max_yaw_acceleration * reach / settings.pushing_speed)
    return min(settings.max_angle_rate, robot.max_acceleration / settings.pushing_speed)


def _limits(problem):
    settings, robot = problem.settings, problem.robot
    dynamic, moving = settings.motion_model == 'dynamic', problem.motion.speed > 0.0
    cone = settings.angle_limit == 'cone'
    lowest, highest = -UNLIMITED, UNLIMITED
    if problem.kind == 'differential':
        lowest, highest = _normals(problem)
    return Limits(math.tan(problem.planning_cone_angle), 0.0 if cone else UNLIMITED,
                  0.0 if cone and dynamic and not moving else UNLIMITED, robot.max_speed,
                  robot.max_yaw_rate, lowest, highest)


def _normals(problem):
    """Range of the normal at a vertex, in the object frame, next to the one at the start."""
    low, high = normal_range(problem.obj, problem.contact)
    shift = problem.start_normal - wrap_angle(problem.start_normal - low) - low
    return low + shift + VERTEX_MARGIN, high + shift - VERTEX_MARGIN


def _ends(problem, route):
    c_x, c_y = problem.contact_point
    if problem.kind == 'rolling':
        c_x -= problem.robot.radius * math.cos(problem.start_normal)
        c_y -= problem.robot.radius * math.sin(problem.start_normal)
    goal, motion = problem.relative_goal, problem.motion
    theta = route.rotation + wrap_angle(goal.theta - route.rotation)
    moving = motion.speed > 0.0
    delta = problem.vehicle.angle + problem.heading_offset
    delta = problem.start_normal + wrap_angle(delta - problem.start_normal)
    return BoundaryValues(c_x, c_y, motion.yaw_rate / motion.speed if moving else 0.0, float(moving),
                          goal.x, goal.y, theta, delta, *problem.friction_center)


def _box(problem):
    settings, motion = problem.settings, problem.motion
    angle = STEEPEST_ANGLE
    if settings.angle_limit == 'angle':
        angle = settings.max_pushing_angle
    first = -angle, angle
    if motion.speed > 0.0:
        first = motion.pushing_angle - SAME_ANGLE, motion.pushing_angle + SAME_ANGLE
    return VariableBounds(angle, first, rotation_range(problem))


def rotation_range(problem):
    """
    Find the turns for which a rolling contact stays on its face or vertex.

    :param problem: the ``PushProblem``.
    :return: (lowest, highest) [rad].
    """
    radius = problem.robot.radius
    if problem.kind != 'rolling' or problem.contact.kind == 'round':
        return -math.inf, math.inf
    if problem.contact.kind == 'vertex':
        low, high = _normals(problem)
        return problem.start_normal - high, problem.start_normal - low
    half = 0.5 * face_length(problem.obj, problem.contact.index)
    return ((-half - problem.contact.offset) / radius, (half - problem.contact.offset) / radius)


def _first_guess(problem, route, formulation):
    grid = formulation.grid
    way = max(route.path_length - grid.fixed, 0.1 * route.path_length)
    lengths = grid.steps(way)
    nodes, rates = route.guess(problem, lengths * (route.path_length / lengths.sum()),
                               radau(POINTS)[0])
    rho = nodes[:, 1]
    if formulation.shape.jumps:
        held = np.maximum.accumulate(np.where(grid.free > 0.0, np.arange(len(rho) - 1), 0))
        pieces = np.append(np.searchsorted(np.unique(held), held), 0)
        means = np.bincount(pieces[:-1], 0.5 * (rho[1:] + rho[:-1])) / np.bincount(pieces[:-1])
        rho = np.concatenate([[means[0]], means[pieces[:-1]]])
    nodes = nodes.copy()
    nodes[:, 1] = np.clip(rho, -0.95 * formulation.box.angle, 0.95 * formulation.box.angle)
    return Solution(way, nodes, np.diff(nodes[:, 1]), rates)
