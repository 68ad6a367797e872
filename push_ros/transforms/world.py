"""
Messages in any frame, brought to the world frame on their way in.

A message is transformed at its own stamp. Where its transform has not come yet, the message waits
for it for a while; where none comes, it is refused with frame, stamp and what is known.

    measurement   transformed at its stamp, or refused; a pose in a frame that is fixed to the
                  robot may be taken as relative to the robot, at its stamp and without odometry
    goal, map     they hold from now on: where there is no transform at their stamp, the newest
                  serves. One in a frame that does not hang below the world frame, as ``map`` does
                  not below ``odom``, is kept there: as the transform drifts, the node is asked to
                  move it. A map comes once, often before localization knows where it is: where
                  it is refused, it is kept, and accepted as soon as there is a transform.

Nothing is subscribed before the first message in another frame.
"""

from collections import deque
import time
from typing import Any, Callable, NamedTuple

from push_model.geometry import Pose, wrap_angle
from push_model.rigid_transform import RigidTransform
from push_ros.conversions.primitives import MessageRefused, nanoseconds, seconds
from push_ros.node import PushNode
from push_ros.transforms.buffer import TransformBuffer, TransformUnavailable
from push_ros.transforms.listener import NOT_INSTALLED, TransformListener
from push_ros.transforms.messages import transformed
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

# After the listener has started, messages wait for transforms at least so long [s]; chosen: all
# publishers of tf are found by then.
DISCOVERY_TIME = 3.0
# Period at which waiting messages and drift are looked after [s]; chosen: well below a correction
# of localization, which comes a few times per second.
PERIOD = 0.1
# Drift that moves goals and maps [m], [rad]; chosen: a fifth of what tasks tolerate.
DRIFT = 2e-3
HEADING_DRIFT = 2e-3
# Pause between looks for a transform that is waited for [s]; chosen: much shorter than the wait.
POLL_PERIOD = 5e-3
# Waiting messages of one topic; chosen: a second of measurements.
MAX_WAITING = 50


class Handlers(NamedTuple):
    """
    Handlers of a node for messages of a topic.

    :param accept: takes the message, in the world frame; of an offer also a function to be called
        once it is taken, with nothing.
    :param refuse: takes the ``MessageRefused`` and the message as it came.
    :param move: of goals and maps, which hold from now on: takes the correction, a ``Pose`` by
        which the last accepted one is moved in the world (``correction @ pose``); None for
        measurements.
    :param is_latched: whether the last message holds until another comes, so that it is accepted
        even after it was refused for want of a transform.
    :param is_offer: whether what is accepted may yet be refused, as goals are: ``move`` moves the
        previous one until it is taken.
    :param accept_relative: takes the message in the base frame where it is in that frame, or in
        one that static transforms fix to it; None where such messages go to the world frame, too.
    """

    accept: Callable[..., None]
    refuse: Callable[[MessageRefused, Any], None]
    move: Callable[[Pose], None] | None = None
    is_latched: bool = False
    is_offer: bool = False
    accept_relative: Callable[[Any], None] | None = None


class _Waiting(NamedTuple):
    """
    A message whose transform has not come.

    :param deadline: until when it waits before it is refused, in monotonic time [s].
    :param is_refused: whether it was; a latched one waits on.
    """

    topic: str
    message: Any
    handlers: Handlers
    deadline: float
    is_refused: bool = False


class _Anchor(NamedTuple):
    """State in a frame that drifts, and the pose of that frame when it was last moved."""

    frame: str
    pose: Pose


class WorldFrame:
    """Brings messages to the world frame."""

    def __init__(self, node: PushNode, frame: str, timeout: float,
                 base_frame: str | None = None) -> None:
        """
        Wait for the first message in another frame.

        :param frame: id of the world frame.
        :param timeout: how long a message waits for its transform [s].
        :param base_frame: id of the frame of the robot; None where nothing is relative to it.
        """
        self._node = node
        self._frame = frame.lstrip('/')
        self._base_frame = None if base_frame is None else base_frame.lstrip('/')
        self._timeout = timeout
        self._buffer = TransformBuffer()
        self._listener: TransformListener | None = None
        self._discovery_end = 0.0
        self._waiting: list[_Waiting] = []
        # By the function that moves it.
        self._anchors: dict[Callable[[Pose], None], _Anchor] = {}

    def receiver(self, topic: str, handlers: Handlers) -> Callable[[Any], None]:
        """
        Make the callback of a subscription.

        :param topic: what errors call its messages.
        """
        def receive(message: Any) -> None:
            self.receive(topic, message, handlers)
        return receive

    def receive(self, topic: str, message: Any, handlers: Handlers) -> None:
        """
        Hand on a message in the world frame, at once or when its transform has come.

        :param topic: what errors call the message.
        :param message: ``PoseStamped``, ``PoseWithCovarianceStamped`` or ``OccupancyGrid``.
        :param handlers: ``Handlers``; what was accepted before with the same ``move`` is no longer
            moved once this one is accepted.
        """
        if handlers.is_latched:
            self._waiting = [item for item in self._waiting if item.topic != topic]
        frame = message.header.frame_id.lstrip('/')
        if frame == self._frame:
            self._accept(message, handlers, None)
            return
        if handlers.accept_relative is not None and frame == self._base_frame:
            handlers.accept_relative(message)
            return
        if not frame:
            handlers.refuse(self._refusal(topic, message, 'it has no frame_id'), message)
            return
        if self._listener is None:
            self._listener = self._listen()
        if not self._listener.is_installed:
            handlers.refuse(self._refusal(topic, message, NOT_INSTALLED), message)
            return
        self._listener.take()
        self._hand_on_waiting()
        now = time.monotonic()
        waiting = _Waiting(topic, message, handlers,
                           max(now + self._timeout, self._discovery_end))
        if not self._hand_on(waiting, now):
            self._waiting.append(waiting)
            of_topic = [item for item in self._waiting if item.topic == topic]
            if len(of_topic) > MAX_WAITING:
                self._waiting.remove(of_topic[0])
                self._drop(of_topic[0])

    def in_world(self, topic: str, message: Any) -> Any:
        """
        Bring a measurement to the world frame at once, or wait for its transform here.

        :param topic: what errors call the message.
        :param message: ``PoseStamped`` or ``PoseWithCovarianceStamped``.
        :return: the message in the world frame.
        :raises MessageRefused: where no transform comes.
        """
        accepted: list[Any] = []
        refused: list[MessageRefused] = []
        self.receive(topic, message, Handlers(
            accepted.append, lambda error, _: refused.append(error)))
        while not accepted and not refused:
            time.sleep(POLL_PERIOD)
            self.take()
        if refused:
            raise refused[0]
        return accepted[0]

    def fixed_to_base(self, frame: str) -> RigidTransform | None:
        """
        Look up where a frame is that static transforms fix to the robot.

        :param frame: frame id.
        :return: its pose in the base frame; None where there is no such transform yet.
        """
        if self._base_frame is None:
            return None
        if self._listener is None:
            self._listener = self._listen()
        self._listener.take()
        return self._buffer.rigid(self._base_frame, frame)

    def take(self) -> None:
        """Hand on messages whose transforms have come, without waiting for the executor."""
        if self._listener is not None and not all(item.is_refused for item in self._waiting):
            self._listener.take()
            self._hand_on_waiting()

    def reset(self) -> None:
        """Forget what is waiting and how frames have moved, as when time went back."""
        waiting = self._waiting
        self._waiting = [item for item in waiting if item.handlers.is_latched]
        self._buffer.clear()
        for item in waiting:
            if not item.handlers.is_latched:
                self._drop(item)

    def _drop(self, waiting: _Waiting) -> None:
        """Refuse a goal that waits no more, as somebody waits for its end; drop measurements."""
        topic, message, handlers = waiting[:3]
        if handlers.move is not None:
            handlers.refuse(self._refusal(topic, message, 'it was dropped while it waited'),
                            message)

    def _listen(self) -> TransformListener:
        # On the wall clock: a message waits for what comes over the network.
        self._node.create_timer(PERIOD, self._node.guarded(self._look_after),
                                clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._discovery_end = time.monotonic() + DISCOVERY_TIME
        return TransformListener(self._node, self._buffer, self._hand_on_waiting)

    def _look_after(self) -> None:
        self._hand_on_waiting()
        self._follow()

    def _hand_on_waiting(self) -> None:
        if not self._waiting:
            return
        now = time.monotonic()
        waiting, self._waiting = deque(self._waiting), []
        unsent: list[_Waiting] = []
        try:
            while waiting:
                item = waiting.popleft()
                if not self._hand_on(item, now):
                    unsent.append(item)
        finally:
            # An error of one message loses no other.
            self._waiting = [*unsent, *waiting, *self._waiting]

    def _hand_on(self, waiting: _Waiting, now: float) -> bool:
        """Hand a message to its node, or refuse it; return False where it has to wait."""
        topic, message, handlers, deadline, is_refused = waiting
        if self._hand_on_relative(waiting):
            return True
        try:
            transform = self._look_up(message, handlers, is_late=now >= deadline)
        except TransformUnavailable as error:
            if is_refused or (now < deadline
                              and not (error.is_final and now >= self._discovery_end)):
                return False
            handlers.refuse(self._refusal(topic, message, str(error)), message)
            if handlers.is_latched:
                self._waiting.append(waiting._replace(is_refused=True))
            return True
        in_world = _transformed_or_refused(waiting, transform, self._frame)
        if in_world is None:
            return True
        frame, anchor = message.header.frame_id, None
        if handlers.move is not None and not self._buffer.is_below(frame, self._frame):
            anchor = _Anchor(frame, transform.planar)
            if handlers.is_offer:
                # It is compared with the one that is pursued.
                self._move_with(handlers.move, anchor)
        self._accept(in_world, handlers, anchor)
        return True

    def _accept(self, message: Any, handlers: Handlers, anchor: _Anchor | None) -> None:
        """Hand on a message in the world frame, which is moved with its anchor, if it has one."""
        move = handlers.move

        def follow() -> None:
            if anchor is not None and move is not None:
                self._anchors[move] = anchor
            elif move is not None:
                self._anchors.pop(move, None)
        if handlers.is_offer:
            handlers.accept(message, follow)
        else:
            handlers.accept(message)
            follow()

    def _hand_on_relative(self, waiting: _Waiting) -> bool:
        """Hand on a message of a frame that is fixed to the robot; return False for others."""
        accept = waiting.handlers.accept_relative
        if self._base_frame is None or accept is None:
            return False
        transform = self._buffer.rigid(self._base_frame, waiting.message.header.frame_id)
        if transform is None:
            return False
        relative = _transformed_or_refused(waiting, transform, self._base_frame)
        if relative is not None:
            accept(relative)
        return True

    def _look_up(self, message: Any, handlers: Handlers, *, is_late: bool) -> RigidTransform:
        frame, stamp = message.header.frame_id, nanoseconds(message.header.stamp)
        try:
            return self._buffer.lookup(self._frame, frame, stamp)
        except TransformUnavailable as error:
            if handlers.move is None or not (is_late or error.is_final or stamp == 0):
                raise
        return self._buffer.lookup(self._frame, frame)

    def _follow(self) -> None:
        """Move goals and maps with the frames that they are in."""
        for move, (frame, before) in list(self._anchors.items()):
            try:
                pose = self._buffer.lookup(self._frame, frame).planar
            except TransformUnavailable:
                continue
            moved = max(abs(pose.x - before.x), abs(pose.y - before.y))
            if moved > DRIFT or abs(wrap_angle(pose.theta - before.theta)) > HEADING_DRIFT:
                self._move_with(move, _Anchor(frame, pose))

    def _move_with(self, move: Callable[[Pose], None], anchor: _Anchor) -> None:
        """Move what was accepted last to where its frame is now, if it has the same one."""
        before = self._anchors.get(move)
        if before is not None and before.frame == anchor.frame and before.pose != anchor.pose:
            self._anchors[move] = anchor
            correction = anchor.pose @ before.pose.inverse()
            move(correction._replace(theta=wrap_angle(correction.theta)))

    def _refusal(self, topic: str, message: Any, reason: str) -> MessageRefused:
        header = message.header
        return MessageRefused(
            f'{topic}: got frame {header.frame_id!r}, expected {self._frame!r} or a frame with a '
            f'transform to it at {seconds(header.stamp):.3f} s: {reason}')


def _transformed_or_refused(waiting: _Waiting, transform: RigidTransform, frame: str) -> Any:
    """Bring a message to a frame; None where that is refused, as its handlers are told."""
    try:
        return transformed(waiting.message, transform, frame, waiting.topic)
    except MessageRefused as error:
        waiting.handlers.refuse(error, waiting.message)
        return None
