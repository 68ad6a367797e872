"""Goals end once and follow their frames, with a server and transforms that are played here."""

from collections.abc import Callable
import contextlib
import logging
import math
from types import SimpleNamespace
from typing import Any

from geometry_msgs.msg import PoseStamped
from push_control.events import TaskEvent
from push_control.goal import GoalOutcome, GoalProgress, PushGoal
from push_control.ros import push_action
from push_control.ros.base_check import BaseFault
from push_control.ros.goal_entry import GoalEntry
from push_control.ros.push_action import ObjectSelector, PushActionServer
from push_control.ros.start_state import StartState
from push_model.events import AnyReport
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_ros.conversions.primitives import MessageRefused, to_pose_message, to_stamp
from push_ros.push_interfaces import PushInterfaces
from push_ros.transforms import world
from push_ros.transforms.buffer import TransformBuffer
from push_ros.transforms.world import Handlers, MAX_WAITING, WorldFrame
import pytest

BOX = read_object(config_file('objects/box_04.yaml'))


class Handle:
    """A goal of a client, which may end once, as that of rclpy."""

    def __init__(self, object_name: str = '', pose: PoseStamped | None = None) -> None:
        self.request = SimpleNamespace(
            goal_pose=pose or goal_pose(1.0), object_name=object_name, position_tolerance=0.0,
            heading_tolerance=0.0, time_limit=SimpleNamespace(sec=0, nanosec=0))
        self.is_active = True
        self.is_cancel_requested = False
        self.end = ''

    def execute(self) -> None:
        """Begin."""

    def _end(self, end: str) -> None:
        if not self.is_active:
            raise RuntimeError(f'goal: got {end} after {self.end}, expected one end')
        self.end = end
        self.is_active = False
        self.is_cancel_requested = False

    def succeed(self) -> None:
        """End well."""
        self._end('succeeded')

    def canceled(self) -> None:
        """End as cancelled."""
        self._end('canceled')

    def abort(self) -> None:
        """End otherwise."""
        self._end('aborted')


class Pursuit:
    """A pursuit whose robot backs off after a goal until it is let go."""

    start_state = StartState.STARTED

    def __init__(self) -> None:
        self.is_commanding = False
        self.progress = GoalProgress()
        # Where each of them was at last.
        self.goals: list[Pose] = []

    def set_goal(self, goal: PushGoal) -> None:
        """Pursue a goal."""
        self.goals.append(goal.pose)
        self.is_commanding = True
        self.progress = GoalProgress()

    def move_goal(self, correction: Pose) -> None:
        """Follow the frame of the goal."""
        self.goals[-1] = correction @ self.goals[-1]

    def cancel(self, cause: AnyReport) -> None:
        """Back off."""


class Listener:
    """A listener of tf, which takes nothing: what has come is in the buffer."""

    is_installed = True

    def take(self) -> None:
        """Take nothing."""


class Stage:
    """The server, its goals, and the frame ``map`` of theirs, in the world ``odom``."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.pursuit = Pursuit()
        self.fault: BaseFault | None = None
        self.now, self.buffer = 0.0, TransformBuffer()
        self.results: list[tuple[Handle, Any]] = []
        node: Any = SimpleNamespace(
            get_logger=lambda: logging.getLogger('action'), now=lambda: to_stamp(1.0),
            running_time=lambda: self.now,
            reporter=SimpleNamespace(log=lambda *_: None), guarded=lambda callback: callback,
            create_publisher=lambda *_: None, create_timer=self._note_timer,
            executor=SimpleNamespace(create_task=lambda task, *arguments: task(*arguments)))
        monkeypatch.setattr(push_action, 'DeferringActionServer', self.serve)
        monkeypatch.setattr(world, 'TransformListener', lambda *_: Listener())
        monkeypatch.setattr(world, 'TransformBuffer', lambda: self.buffer)
        monkeypatch.setattr(world, 'time', SimpleNamespace(monotonic=lambda: self.now))
        self.world = WorldFrame(node, 'odom', 1.0)
        pursuit: Any = self.pursuit
        self.goals = GoalEntry(node, pursuit, 'odom', is_lockstep=False)
        names = ('NONE', 'TF_ERROR', 'PREEMPTED', 'INTERRUPTED', 'ROBOT_NOT_READY')
        action = SimpleNamespace(Result=result_type(names))
        PushActionServer(
            node, self.goals, PushInterfaces(action, None, None, None),
            lambda name, message, receiver: self.world.receive(name, message, Handlers(
                receiver.accept, receiver.refuse, self.goals.move, is_offer=True)),
            is_active=lambda: True, objects=ObjectSelector(lambda _: BOX, lambda name, obj: None),
            check_base=lambda on_result: on_result(self.fault))

    def serve(self, *_: Any, handle_accepted_callback: Callable[[Handle], None],
              cancel_callback: Callable[[Handle], Any], **__: Any) -> Any:
        """Play the server of rclpy."""
        self.offer, self._cancel = handle_accepted_callback, cancel_callback
        return SimpleNamespace(answer=lambda handle, result: self.results.append((handle, result)))

    def _note_timer(self, _: float, callback: Callable[[], None], **__: Any) -> None:
        self.look = callback

    def locate(self, x: float, heading: float = 0.0) -> None:
        """Let a localization find the origin of ``map``."""
        self.now += 0.01
        self.buffer.set('map', 'odom', round(1e9 * self.now), RigidTransform.from_angles(
            (x, 0.0, 0.0), (0.0, 0.0, heading)).inverse())

    def cancel(self, handle: Handle) -> None:
        """Let the client of a goal cancel it."""
        handle.is_cancel_requested = True
        self._cancel(handle)

    def pursue(self, object_name: str = '') -> Handle:
        """Let a client send a goal, whose transform has come."""
        self.locate(0.0)
        handle = Handle(object_name)
        self.offer(handle)
        assert self.goals.current is not None
        return handle

    def publish(self, message: PoseStamped) -> None:
        """Let a goal come on the topic, as the controller takes it."""
        def take(in_world: Any, follow: Callable[[], None]) -> None:
            if self.fault is None:
                with contextlib.suppress(MessageRefused):
                    self.goals.on_message(in_world, follow)
        self.world.receive('goal_pose', message, Handlers(
            take, lambda error, _: None, self.goals.move, is_offer=True))

    def check_next_goal(self) -> None:
        """Expect that another goal is reached, and that each has one result."""
        handle = self.pursue()
        self.pursuit.progress = GoalProgress(outcome=GoalOutcome.REACHED)
        self.goals.update(9.0)
        assert handle.end == 'succeeded'
        assert len({id(ended) for ended, _ in self.results}) == len(self.results)


def result_type(names: tuple[str, ...]) -> Any:
    """Make a type of results with some error codes."""
    class Result(SimpleNamespace):
        pass
    for name in names:
        setattr(Result, name, name)
    return Result


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Stage:
    """Make the server."""
    return Stage(monkeypatch)


def test_a_goal_that_was_cancelled_is_not_refused_for_want_of_a_transform(stage: Stage) -> None:
    """It has ended when its deadline comes; the next goal is served."""
    handle = Handle()
    stage.offer(handle)
    stage.cancel(handle)
    assert handle.end == 'canceled'
    stage.now = 10.0
    stage.look()
    assert [ended for ended, _ in stage.results] == [handle]
    stage.check_next_goal()


def test_a_replaced_goal_may_be_cancelled_while_the_robot_backs_off(stage: Stage) -> None:
    """It has ended then; the goal for the other object begins all the same."""
    first = stage.pursue()
    second = stage.pursue('bin')
    stage.cancel(first)
    assert first.end == 'canceled' and second.is_active
    stage.pursuit.is_commanding = False
    stage.goals.update(1.0)
    assert stage.goals.current is not None and second.is_active
    stage.check_next_goal()
    assert second.end == 'aborted'


@pytest.mark.parametrize('count', [1, MAX_WAITING + 1], ids=['forgotten', 'too many'])
def test_a_goal_that_waits_for_its_transform_ends_with_a_result(
        stage: Stage, count: int) -> None:
    """Where everything is forgotten, as by a reset of time, or too many others wait, too."""
    handles = [Handle() for _ in range(count)]
    for handle in handles:
        stage.offer(handle)
    ended = [handle for handle in handles if not handle.is_active]
    assert ended == handles[:max(0, count - MAX_WAITING)]
    stage.world.reset()
    assert {handle.end for handle in handles} == {'aborted'}
    stage.check_next_goal()


def goal_pose(x: float, frame: str = 'map') -> PoseStamped:
    """Make a goal in a frame."""
    message = PoseStamped(pose=to_pose_message(Pose(x, 0.0, 0.0)))
    message.header.frame_id = frame
    return message


def test_an_error_of_one_goal_leaves_no_other_without_an_end(stage: Stage) -> None:
    """Those that wait with it end as everything is forgotten, which an error leads to."""
    first, second = Handle('bin'), Handle()
    stage.offer(first)
    stage.offer(second)
    stage.pursuit.cancel = None  # type: ignore[method-assign]
    stage.locate(0.0)
    with pytest.raises(TypeError):
        stage.look()
    stage.world.reset()
    assert second.end == 'aborted'


def refuse_by_its_pose(stage: Stage) -> None:
    """Let a goal come whose pose is none."""
    stage.publish(goal_pose(math.nan, 'odom'))


def refuse_by_the_base(stage: Stage) -> None:
    """Let a goal come while the base is not ready."""
    stage.fault = BaseFault('it is not ready')
    stage.publish(goal_pose(3.0, 'odom'))
    stage.offer(Handle(pose=goal_pose(3.0, 'odom')))


def stop_and_start(stage: Stage) -> None:
    """Stop the controller, and let it go on to the goal of before."""
    stage.goals.interrupt(GoalOutcome.CANCELLED, TaskEvent.STOPPED_BY_USER.report())


@pytest.mark.parametrize('event', [refuse_by_its_pose, refuse_by_the_base, stop_and_start])
def test_the_goal_that_is_pursued_follows_its_frame_whatever_comes(
        stage: Stage, event: Callable[[Stage], None]) -> None:
    """A goal that is not taken leaves it alone, and so do a stop and a start."""
    stage.pursue()
    event(stage)
    stage.locate(0.3)
    stage.look()
    assert stage.pursuit.goals == [pytest.approx(Pose(1.3, 0.0, 0.0))]
    # One that is taken holds where it is.
    stage.fault = None
    stage.publish(goal_pose(2.0, 'odom'))
    stage.locate(0.6)
    stage.look()
    assert stage.pursuit.goals[1:] == [Pose(2.0, 0.0, 0.0)]


def test_a_goal_that_is_repeated_in_a_frame_that_drifts_is_not_begun_again(stage: Stage) -> None:
    """However little or much that has drifted since; it is where its frame is then."""
    for index, drift in enumerate((0.0, 1e-4, 1.1e-3, 2.9e-3, 0.3, -0.1)):
        stage.locate(drift, 0.3 * drift)
        stage.publish(goal_pose(9.0))
        expected = Pose(drift, 0.0, 0.3 * drift) @ Pose(9.0, 0.0, 0.0)
        assert stage.pursuit.goals == [pytest.approx(expected, abs=1e-9)]
        stage.goals.update(float(index))
    stage.publish(goal_pose(9.01))
    assert len(stage.pursuit.goals) == 2
