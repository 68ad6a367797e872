"""Answers a controller that has gone astray, as the planner's node would."""

import dataclasses

from push_model.signals import ObjectPose
from push_planner.problem import PlanningFailed
from push_planner.under_way import plan_measured


class Replanner:
    """Plans anew from where the controller believes robot and object to be."""

    def __init__(self, scenario):
        """
        Take the beliefs of a scenario.

        :param scenario: the ``Scenario``.
        """
        self._parts, self._goal = (scenario.object, scenario.robot), scenario.goal.pose
        self._settings = dataclasses.replace(scenario.planner, site='placed')

    def answer(self, status, odometry):
        """
        Plan anew if the controller asks for it.

        :param status: ``ControllerStatus``.
        :param odometry: newest ``Odometry``; only its time and motion count.
        :return: ``PushTrajectory``, or None where nothing is asked or there is no plan.
        """
        if not status.replan:
            return None
        measured = ObjectPose(odometry.time, status.object_pose)
        try:
            found = plan_measured(*self._parts, measured,
                                  odometry._replace(pose=status.robot_pose), self._goal,
                                  self._settings)
        except PlanningFailed:
            return None
        return found.plan.trajectory
