"""What the robot does in each state of a task."""

import dataclasses
import math

from push_control.push.start import contact_start_point
from push_control.task.approach import Approach
from push_control.task.guarded_approach import GuardedApproach
from push_control.task.object_model import ObjectModelEstimator
from push_control.task.push import SupervisedPush
from push_control.task.retreat import Retreat
from push_control.task.status import TaskState

# What is never known better: friction centre over its distance, push direction [rad].
CENTER_SPREAD, PLACEMENT_SPREAD = 0.03, 0.02
# Gains as for a way of convergence shorter by this, and the share of the friction cone.
STIFFER, FEEDBACK_MARGIN = 1.5, 0.9
INSIDE = 0.002


class BehaviorFactory:
    """
    Makes the legs of a task, one after the other.

    Each has ``step(perception, dt)``, which gives the ``Twist``, ``pause()``, ``finished`` and
    ``failure_reason``.
    """

    def __init__(self, obj, robot, control, drive, supervision):
        """
        Prepare.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``. What a push misses its goal by is left to the next;
            as pushes are short and may fail, feedback is stiffer and uses more of the cone.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._control = dataclasses.replace(
            control, position_tolerance=1.0, heading_tolerance=1.0, max_reapproaches=0,
            max_replan_requests=0, feedback_cone_fraction=max(control.feedback_cone_fraction, FEEDBACK_MARGIN),
            lateral_gain=min(100.0, STIFFER ** 2 * control.lateral_gain),
            heading_gain=min(50.0, STIFFER * control.heading_gain),
            max_curvature_rate=min(1000.0, STIFFER ** 2 * control.max_curvature_rate))
        self._robot, self._drive, self._settings = robot, drive, supervision
        self.object_model, self.occupancy_map = ObjectModelEstimator(obj, control), None

    def create(self, state, target, perception):
        """
        Make the leg of a state.

        :param state: the ``TaskState``.
        :param target: the ``PushTrajectory``, or None.
        :param perception: ``TaskPerception`` of robot and object.
        :return: the leg, or None where the robot stands.
        """
        obj, robot, drive, settings = self.object_model.obj, self._robot, self._drive, self._settings
        if state is TaskState.APPROACH:
            return Approach(obj, robot, drive, settings, target, self.occupancy_map)
        if state is TaskState.ALIGN:
            return GuardedApproach(obj, robot, self._control, drive, settings, target,
                                   perception.object_at_rest)
        if state is TaskState.PUSH:
            return SupervisedPush(self.object_model, robot, self._as_known(target, perception), settings,
                                  target, self.occupancy_map)
        if state is TaskState.RETREAT:
            return Retreat(obj, robot, drive, settings, self.occupancy_map)
        return None

    def correct_overlap(self, perception):
        """
        See that the robot does not stand inside the object.

        :param perception: ``TaskPerception`` of robot and object.
        """
        perception.correct_overlap(self.object_model.obj, self._robot, INSIDE)

    def _as_known(self, target, perception):
        """Tell the controller how well robot and friction centre are known by now."""
        spread = self.object_model.spread(contact_start_point(target))
        return dataclasses.replace(
            self._control, center_std_ratio=math.hypot(CENTER_SPREAD, spread),
            push_direction_std=math.hypot(PLACEMENT_SPREAD, perception.localization.standard_deviations[2]))
