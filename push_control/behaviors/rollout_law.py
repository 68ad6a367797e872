"""
Law of a straight push: the arc with the least expected time, by rollouts of the dynamics.

A few members of the ensemble are moved on along each of several arcs by the compiled dynamics. The
cost of stopping after a distance is their mean cost-to-go plus the time to get there, so that one
minimum says how to steer, how far to push, and when to stop (``push_primitives.rollouts``).
"""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.perception.ensemble.ensemble_reading import EnsembleReading
from push_control.perception.ensemble.members import Members, OBJECT, ROBOT
from push_dynamics.layout import TOUCH_SIZE
from push_dynamics.touches import MAX_TOUCHES
from push_dynamics.wall_grid import touch_reach, wall_grid
from push_dynamics.walls import Wall, wall_rows
from push_model.geometry import FloatArray, Pose
from push_primitives.cost_to_go import CostToGo
from push_primitives.rollouts import roll_out, RolloutGoal, RolloutOptions
from push_primitives.store import PushPrimitives

# Members that are rolled out; chosen: their mean is that of all, and a decision takes some
# milliseconds.
ROLLED_OUT = 6
# Columns of the poses of robot and object.
POSES = [*ROBOT, *OBJECT]
# Curvatures between which a differential drive chooses [1/m]; chosen: beyond two, contacts slide.
CURVATURES = (-2.0, -1.0, -0.4, 0.0, 0.4, 1.0, 2.0)
# Distance for which a curvature holds before the later one [m]; chosen: about a radius.
SWITCH_DISTANCE = 0.2
# Time that a change of curvature by 1/m must gain [s m]; chosen: against chattering.
CHANGE_COST = 0.04
# Speed and longest step of the rollouts [m/s], [s]; quasi-static, so that any speed will do, and
# as coarse as the result allows.
ROLLOUT_SPEED = 0.2
ROLLOUT_STEP = 0.016
# Distances at which stopping is evaluated [m]: as fine as a tap needs at first, then coarser.
FINE_SPACING, FINE_RANGE = 0.002, 0.03
MIDDLE_SPACING, MIDDLE_RANGE = 0.01, 0.1
COARSE_SPACING = 0.03


class Decision(NamedTuple):
    """
    Decision of the law at one step.

    :param curvature: of the robot's path [1/m].
    :param stopping_distance: after which it is best to stop [m].
    :param cost: expected time from here to the goal [s].
    """

    curvature: float
    stopping_distance: float
    cost: float


class RolloutLaw:
    """Chooses curvature and stopping distance of a push."""

    def __init__(self, members: Members, cost_to_go: CostToGo, face: int, goal: Pose,
                 speed: float, walls: Sequence[Wall] = ()) -> None:
        """
        Take the goal of a push.

        :param members: the ``Members`` of the ensemble.
        :param face: number of the face at which the robot pushes.
        :param goal: goal ``Pose`` of the object.
        :param speed: of the push [m/s].
        :param walls: that object and robot may touch.
        """
        self._members = members
        self._walls = wall_grid(wall_rows(walls),
                                touch_reach(members.obj, members.robot_radius))
        self._touches: FloatArray = np.zeros((MAX_TOUCHES, TOUCH_SIZE))
        # Numbers of those that are rolled out.
        self._chosen = np.linspace(0, members.count - 1, ROLLED_OUT).astype(int)
        self._goal = RolloutGoal(cost_to_go.grid, Pose(*map(float, goal)), face)
        self._speed = speed

    def steer(self, curvature: float, planned: float, horizon: float,
              direction: float) -> Decision:
        """
        Choose among arcs.

        :param curvature: present curvature [1/m].
        :param planned: curvature of the plan [1/m].
        :param horizon: how far to look [m].
        :param direction: of motion in the robot's axes [rad].
        """
        arcs = [(curvature, curvature), (planned, planned), (curvature, 0.0)]
        arcs += [(first, later) for first in CURVATURES for later in {0.0, first}]
        # Sorted: arcs that begin alike follow each other.
        table = np.array(sorted(set(arcs)))
        stops, costs = self._evaluate(table, horizon, direction)
        total = costs + stops / self._speed
        total += CHANGE_COST * np.abs(table[:, :1] - curvature)
        best, stop = np.unravel_index(int(total.argmin()), total.shape)
        return Decision(float(table[best, 0]), float(stops[stop]), float(total[best, stop]))

    def stop(self, curvature: float, horizon: float, direction: float) -> Decision:
        """
        Choose where to stop on the present arc.

        :param curvature: of the arc [1/m].
        :param horizon: how far to look [m].
        :param direction: of motion in the robot's axes [rad].
        """
        stops, costs = self._evaluate(np.array([(curvature, curvature)]), horizon, direction)
        total = costs[0] + stops / self._speed
        best = int(total.argmin())
        return Decision(curvature, _vertex(stops, total, best), float(total[best]))

    def _evaluate(self, arcs: FloatArray, horizon: float,
                  direction: float) -> tuple[FloatArray, FloatArray]:
        members, chosen = self._members, self._chosen
        states = members.states[chosen]
        # Their mean is that of all members.
        states[:, POSES] += (members.states[:, POSES].mean(axis=0)
                             - states[:, POSES].mean(axis=0))
        stops = _stops(horizon)
        costs = np.zeros((len(arcs) + 1, len(stops)))
        worlds = members.worlds._replace(states=states, bodies=members.bodies[chosen],
                                         supports=members.supports[chosen],
                                         walls=self._walls, touches=self._touches)
        options = RolloutOptions(direction, ROLLOUT_SPEED, ROLLOUT_STEP, SWITCH_DISTANCE)
        roll_out(worlds, members.rollout_states, arcs, stops, options, self._goal, costs)
        return stops, costs[:-1]


def _stops(horizon: float) -> FloatArray:
    """Distances at which stopping is evaluated, from 0 to the horizon [m]."""
    spans = ((0.0, FINE_RANGE, FINE_SPACING), (FINE_RANGE, MIDDLE_RANGE, MIDDLE_SPACING),
             (MIDDLE_RANGE, max(horizon, MIDDLE_RANGE), COARSE_SPACING))
    parts = [np.linspace(first, last, 1 + math.ceil((last - first) / spacing - 1e-9))[1:]
             for first, last, spacing in spans]
    stops = np.concatenate(([0.0], *parts))
    return stops[stops <= max(horizon, FINE_RANGE)]


def _vertex(stops: FloatArray, costs: FloatArray, best: int) -> float:
    """Refine the least of sampled costs by the parabola through its neighbours."""
    if best == 0 or best == len(stops) - 1:
        return float(stops[best])
    before, here, after = costs[best - 1:best + 2]
    before_width, after_width = stops[best] - stops[best - 1], stops[best + 1] - stops[best]
    slope_before, slope_after = (here - before) / before_width, (after - here) / after_width
    bend = slope_after - slope_before
    if bend <= 0.0:
        return float(stops[best])
    # Where the slope, linear between the middles of both intervals, is 0.
    shift = -slope_before / bend * 0.5 * (before_width + after_width) - 0.5 * before_width
    return float(stops[best] + min(after_width, max(-before_width, shift)))


def warm_up(primitives: PushPrimitives, ensemble: EnsembleReading) -> None:
    """Roll out once, so that nothing has to be compiled or loaded while the robot moves."""
    RolloutLaw(ensemble.members, primitives.cost_to_go, 0, ensemble.object_pose, 1.0).stop(
        0.0, FINE_SPACING, 0.0)
