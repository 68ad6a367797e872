"""What the robot does in each state of a task."""

import dataclasses
import math

from push_control.push.start import contact_at_start
from push_control.task.approach import Approach
from push_control.task.guarded_approach import Touch
from push_control.task.object_model import LearntObject
from push_control.task.push import SupervisedPush
from push_control.task.retreat import Retreat

# What is never known better: friction centre over its distance, push direction [rad].
CENTER_SPREAD, PLACEMENT_SPREAD = 0.03, 0.02
# Gains as for a way of convergence shorter by this, and the share of the friction cone.
STIFFER, FEEDBACK_MARGIN = 1.5, 0.9
INSIDE = 0.002


class Legs:
    """
    Makes the legs of a task, one after the other.

    Each has ``step(sight, dt)``, which gives the ``Twist``, ``halt()``, ``finished`` and
    ``trouble``.
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
            control, position_tolerance=1.0, heading_tolerance=1.0, go_around_limit=0,
            replan_limit=0, feedback_margin=max(control.feedback_margin, FEEDBACK_MARGIN),
            lateral_gain=min(100.0, STIFFER ** 2 * control.lateral_gain),
            heading_gain=min(50.0, STIFFER * control.heading_gain),
            curvature_rate=min(1000.0, STIFFER ** 2 * control.curvature_rate))
        self._robot, self._drive, self._settings = robot, drive, supervision
        self.learnt, self.workspace = LearntObject(obj, control), None

    def begin(self, state, target, sight):
        """
        Make the leg of a state.

        :param state: one of ``push_control.task.status.STATES``.
        :param target: the ``PushTrajectory``, or None.
        :param sight: ``Sight`` of robot and object.
        :return: the leg, or None where the robot stands.
        """
        obj, robot, drive, settings = self.learnt.obj, self._robot, self._drive, self._settings
        if state == 'approach':
            return Approach(obj, robot, drive, settings, target, self.workspace)
        if state == 'align':
            return Touch(obj, robot, self._control, drive, settings, target,
                         sight.rest)
        if state == 'push':
            return SupervisedPush(self.learnt, robot, self._as_known(target, sight), settings,
                                  target, self.workspace)
        if state == 'retreat':
            return Retreat(obj, robot, drive, settings, self.workspace)
        return None

    def look_round(self, sight):
        """
        See that the robot does not stand inside the object.

        :param sight: ``Sight`` of robot and object.
        """
        sight.step_out(self.learnt.obj, self._robot, INSIDE)

    def _as_known(self, target, sight):
        """Tell the controller how well robot and friction centre are known by now."""
        spread = self.learnt.spread(contact_at_start(target))
        return dataclasses.replace(
            self._control, center_spread=math.hypot(CENTER_SPREAD, spread),
            placement_spread=math.hypot(PLACEMENT_SPREAD, sight.placement.deviations[2]))
