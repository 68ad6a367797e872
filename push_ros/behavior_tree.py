"""
Behaviours for trees of py_trees: push an object to a goal, and choose by how that ended.

    push = PushObject('push the crate', commander, Pose(1.0, 0.5, 0.0))
    root = py_trees.composites.Selector('crate', memory=True, children=[
        push,
        py_trees.composites.Sequence('too heavy', memory=True, children=[
            PushFailedWith('gave up', push, 'BehaviorFailure.WHEELS_SPIN'), call_somebody])])

They need no node of their own and no thread: a tick handles what has come.
"""

from typing import Any

from geometry_msgs.msg import PoseStamped
from push_model.geometry import Pose
from push_ros.commander import PushCommander, PushOutcome, PushResult
from py_trees.behaviour import Behaviour
from py_trees.common import Status


class PushObject(Behaviour):
    """
    Pushes an object to a goal; succeeds once it is there.

    It runs while the controller is awaited. A robot that is interrupted backs off and stands.

    ``result``: the ``PushResult`` of the last goal; None before its end.
    """

    def __init__(self, name: str, commander: PushCommander, pose: Pose | PoseStamped,
                 **goal: Any) -> None:
        """
        Set the goal.

        :param name: of the behaviour.
        :param commander: ``PushCommander``, which several behaviours may share.
        :param pose: goal of the object, as of ``PushCommander.push_to``.
        :param goal: its other arguments, by name.
        """
        super().__init__(name)
        self._commander = commander
        self._pose = pose
        self._goal = goal
        self._is_sent = False
        self.result: PushResult | None = None

    def initialise(self) -> None:
        """Start again."""
        self._is_sent = False
        self.result = None

    def update(self) -> Status:
        """Send the goal once the controller is there, and follow it."""
        commander = self._commander
        if not self._is_sent:
            if not commander.wait_until_ready(0.0):
                self.feedback_message = 'waits for the controller'
                return Status.RUNNING
            self._is_sent = True
            commander.push_to(self._pose, **self._goal)
        is_done = commander.is_done(0.0)
        self.result = commander.result()
        if is_done and self.result is not None:
            self.feedback_message = self.result.error_msg
            is_reached = self.result.outcome is PushOutcome.SUCCEEDED
            return Status.SUCCESS if is_reached else Status.FAILURE
        feedback = commander.feedback()
        self.feedback_message = 'goal sent' if feedback is None else feedback.text
        return Status.RUNNING

    def terminate(self, new_status: Status) -> None:
        """Cancel a goal that the tree has turned away from, where it is still pursued."""
        # The commander may have the goal of another behaviour by now.
        if new_status is Status.INVALID and self._is_sent and self.result is None:
            self._commander.cancel()


class PushFailedWith(Behaviour):
    """Succeeds where a push has failed with one of some codes; fails elsewhere."""

    def __init__(self, name: str, push: PushObject, *codes: int | str) -> None:
        """
        Name the codes.

        :param name: of the behaviour.
        :param push: the ``PushObject``.
        :param codes: constants of ``PushObject.Result`` of ``push_control_msgs``, or names of
            cause codes, such as ``BehaviorFailure.WHEELS_SPIN``.
        """
        super().__init__(name)
        self._push = push
        self._codes = frozenset(codes)

    def update(self) -> Status:
        """Compare the code."""
        result = self._push.result
        if result is None:
            self.feedback_message = 'has not ended'
            return Status.FAILURE
        self.feedback_message = ' '.join((f'error code {result.error_code}', *result.codes))
        has_failed = result.outcome is not PushOutcome.SUCCEEDED
        is_named = not self._codes.isdisjoint((result.error_code, *result.codes))
        return Status.SUCCESS if has_failed and is_named else Status.FAILURE
