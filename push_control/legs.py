"""What the robot does in each state of a task."""

import dataclasses

from push_control.learnt import LearntObject
from push_control.retreat import Retreat
from push_control.supervised_push import SupervisedPush
from push_control.touch import Touch
from push_control.travel import Approach


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
        :param control: ``ControlSettings``; what a push misses its goal by is left to the next.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._control = dataclasses.replace(control, position_tolerance=1.0, heading_tolerance=1.0,
                                            go_around_limit=0, replan_limit=0)
        self._robot, self._drive, self._settings = robot, drive, supervision
        self.learnt, self.workspace = LearntObject(obj, control), None

    def begin(self, state, target, rest):
        """
        Make the leg of a state.

        :param state: one of ``push_control.task_status.STATES``.
        :param target: the ``PushTrajectory``, or None.
        :param rest: ``push_control.rest.Rest`` of the object, or None.
        :return: the leg, or None where the robot stands.
        """
        obj, robot, drive, settings = self.learnt.obj, self._robot, self._drive, self._settings
        if state == 'approach':
            return Approach(obj, robot, drive, settings, target, self.workspace)
        if state == 'align':
            return Touch(obj, robot, self._control, drive, settings, target, rest)
        if state == 'push':
            return SupervisedPush(self.learnt, robot, self._control, target)
        if state == 'retreat':
            return Retreat(obj, robot, drive, settings, self.workspace)
        return None
