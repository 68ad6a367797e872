"""Whether a task in a map was refused with reason: what a planner that knows the poses answers."""

import enum

from benchmarks.map_plans.ideal_push import Escape, find_escape
from benchmarks.map_plans.instances import Instance
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.task_planner import plan_for_request
from push_scenario.definition.scenario import Scenario


class Answer(enum.Enum):
    """
    What can be done where a task was given up, with true poses and the true object.

    ``PLAN``: the planner has a plan; ``PUSHES``: it has none, though ideal pushes move the object
    away, or may; ``NOTHING``: no push does.
    """

    PLAN = 'plan'
    PUSHES = 'pushes'
    NOTHING = 'nothing'


def answer(scenario: Scenario, occupancy_map: OccupancyMap, start: Pose,
           robot_start: Pose) -> Answer:
    """
    Tell what can be done from where a task was given up.

    :param scenario: of the task.
    :param start: true ``Pose`` of the object.
    :param robot_start: true ``Pose`` of the robot.
    """
    obj, robot, goal = scenario.true_object, scenario.true_robot, scenario.final_goal
    try:
        plan_for_request(PlanRequest(start, robot_start, goal, obj), robot, scenario.planner,
                         DriveSettings(), occupancy_map)
    except PlanningFailed:
        instance = Instance(occupancy_map, obj, robot, start, robot_start, goal)
        is_stuck = find_escape(instance) is Escape.IMPOSSIBLE
        return Answer.NOTHING if is_stuck else Answer.PUSHES
    return Answer.PLAN
