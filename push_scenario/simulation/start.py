"""Start of a run: the pose of the robot where the scenario leaves it to the planner."""

import dataclasses

from push_planner.problem import check_solver, PlanningFailed
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario


def place_robot(scenario: Scenario) -> Scenario:
    """
    Specify the pose of the robot: that of the quickest contact site where there is none.

    :return: the same, with ``start.robot`` or ``start.contact``.
    :raises ValueError: where no site leads to the goal.
    """
    start = scenario.start
    if start.is_robot_specified:
        return scenario
    try:
        check_solver()
        # Imported here: straight pushes need no casadi.
        from push_planner.steered.site_selection import choose_site
        choice = choose_site(scenario.object, scenario.robot, start.object.pose,
                             scenario.goal.pose, scenario.planner)
    except PlanningFailed as failure:
        raise ValueError(f'Scenario.start: {failure.reason}') from failure
    pose = choice.candidates[0].robot_pose
    return dataclasses.replace(scenario, start=dataclasses.replace(
        start, robot=Placement(pose.x, pose.y, pose.theta)))
