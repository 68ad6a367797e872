"""What user, planner and safety layer ask of a task under way, with a robot that moves exactly."""

from collections.abc import Callable
import dataclasses
import math

from helpers.maps import walled_room
from helpers.objects import box
from helpers.outlooks import OUTLOOK
from helpers.straight_pushes import straight_push
from push_control.behaviors.failures import BehaviorFailure
from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.settings import DriveSettings
from push_safety.protective_field import ProtectiveCause
import pytest

PERIOD = 0.05
PASSED = ProtectiveCause.OBSTRUCTED_UNTIL_RESUME.report()
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
# Where a straight push begins, and where the robot stands before it.
CONTACT, START = Pose(-0.37, 0.05, 0.0), Pose(-0.7, 0.05, 0.0)
OBJECT = Pose(0.0, 0.0, 0.0)
GOAL = Pose(0.3, 0.0, 0.0)
# More simulated time than any law here takes [s].
TIME_LIMIT = 60.0
CANCELLED = TaskEvent.GOAL_CANCELLED.report()


class StuckTask:
    """A task with an object that no force moves: odometry counts wheels that spin there."""

    def __init__(self, robot: RoundRobot = ROBOT) -> None:
        """Set the goal."""
        self.supervisor = Supervisor(box(), robot, ControlSettings(), DriveSettings(),
                                     SupervisionSettings())
        self.plan = straight_push(box(), CONTACT, 0.3)
        self.pose, self.time = START, 0.0
        self._twist = STOP
        self.supervisor.set_goal(GOAL)

    def step(self) -> Twist:
        """Let a period pass; return the command."""
        self.time += PERIOD
        rotation = PERIOD * self._twist.omega
        x, y = Pose(0.0, 0.0, 0.5 * rotation).rotate(self._twist[:2])
        self.pose = self.pose @ Pose(PERIOD * x, PERIOD * y, rotation)
        self._twist = self.supervisor.step(Observation(
            self.time, Odometry(self.time, self.pose, self._twist),
            ObjectPose(self.time, OBJECT)), PERIOD)
        return self._twist

    def drive_until(self, state: TaskState, delay: float = 0.0) -> None:
        """Drive, with a plan for each request, until a state has lasted for a while."""
        supervisor = self.supervisor
        while supervisor.state is not state or self.time < supervisor.status.since + delay:
            self.step()
            if supervisor.plan_request is not None:
                supervisor.set_plan(self.plan)
            assert self.time < TIME_LIMIT


def test_an_object_that_is_stated_to_be_too_heavy_ends_the_task_at_its_second_push() -> None:
    """The wheels spin there; a third attempt would be the same."""
    task = StuckTask(dataclasses.replace(ROBOT, max_push_force=1.0))
    task.drive_until(TaskState.FAILED)
    status = task.supervisor.status
    assert (status.pushes, status.failure) == (2, TaskFailure.TOO_HEAVY)
    assert BehaviorFailure.WHEELS_SPIN in status.codes


def test_a_task_cancelled_in_a_push_backs_off_and_forgets_its_goal() -> None:
    """It stands idle then, requests nothing, and is still for good."""
    task = StuckTask()
    task.drive_until(TaskState.PUSH, delay=0.3)
    task.supervisor.cancel(CANCELLED)
    assert task.supervisor.state is TaskState.RETREAT
    assert task.supervisor.status.is_requested
    before = task.pose.x
    while task.supervisor.state is TaskState.RETREAT:
        task.step()
        assert task.supervisor.plan_request is None
    assert task.supervisor.state is TaskState.IDLE and task.pose.x < before - 0.04
    task.step()
    assert {task.step() for _ in range(20)} == {STOP}
    assert task.supervisor.plan_request is None and task.supervisor.state is TaskState.IDLE


def test_what_a_plan_states_holds_until_the_goal_ends() -> None:
    """Nothing before there is a plan; the time that it states passes."""
    task = StuckTask()
    task.plan = dataclasses.replace(task.plan, outlook=OUTLOOK)
    task.step()
    assert task.supervisor.status.outlook is None
    task.drive_until(TaskState.APPROACH)
    planned_at = task.time
    task.drive_until(TaskState.PUSH)
    outlook = task.supervisor.status.outlook
    assert outlook is not None and task.time > planned_at
    passed = OUTLOOK.time.median - outlook.time.median
    assert passed == pytest.approx(task.time - planned_at)
    assert outlook.chance == OUTLOOK.chance and outlook.position_error == OUTLOOK.position_error
    task.supervisor.set_goal(GOAL)
    assert task.supervisor.status.outlook is None


def test_a_map_with_an_obstacle_on_the_path_ends_it_and_one_beside_does_not() -> None:
    """The robot plans anew at once."""
    for y, is_blocked in ((START.y, True), (-0.8, False)):
        task = StuckTask()
        task.pose = START @ Pose(-1.0, 0.0, 0.0)
        task.drive_until(TaskState.APPROACH, delay=0.3)
        task.supervisor.set_map(walled_room((-1.1, -1.0, y - 0.05, y + 0.05)))
        state = TaskState.PLAN if is_blocked else TaskState.APPROACH
        assert task.supervisor.state is state
        codes = task.supervisor.history[-1].codes
        assert (TaskEvent.MAP_BLOCKS_PATH in codes) == is_blocked


@pytest.mark.parametrize('state', [TaskState.PLAN, TaskState.APPROACH, TaskState.PUSH])
def test_a_plan_that_cannot_be_driven_is_an_attempt_before_it_and_the_end_under_it(
        state: TaskState) -> None:
    """While a plan is awaited another one may come; none replaces the one that is driven."""
    task = StuckTask()
    if state is TaskState.PLAN:
        while task.supervisor.plan_request is None:
            task.step()
    else:
        task.drive_until(state)
    task.supervisor.on_plan_refused()
    status = task.supervisor.status
    assert PlanFailure.INVALID_PLAN in status.codes
    if state is TaskState.PLAN:
        assert (status.state, status.recoveries) == (TaskState.PLAN, 1)
    else:
        assert (status.state, status.failure) == (TaskState.FAILED, TaskFailure.NO_PLAN)
    assert task.step() == STOP


@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize('index', range(3))
def test_a_goal_that_is_not_finite_is_refused_and_leaves_the_present_one(
        index: int, value: float) -> None:
    """Whichever of its numbers it is."""
    task = StuckTask()
    pose = list(GOAL)
    pose[index] = value
    with pytest.raises(ValueError, match='goal'):
        task.supervisor.set_goal(Pose(*pose))
    while task.supervisor.plan_request is None:
        task.step()
    assert task.supervisor.plan_request.goal == GOAL


def test_a_pause_keeps_the_goal_and_a_stop_does_not() -> None:
    """What stood still goes on with a plan from where it is, or waits for a goal."""
    for ends in (False, True):
        task = StuckTask()
        task.drive_until(TaskState.APPROACH, delay=0.3)
        if ends:
            task.supervisor.stop(TaskEvent.STOPPED_BY_USER.report())
        else:
            task.supervisor.pause()
        assert {task.step() for _ in range(20)} == {STOP}
        task.supervisor.resume()
        task.step()
        assert task.supervisor.state is (TaskState.IDLE if ends else TaskState.PLAN)


@pytest.mark.parametrize('ask', [
    lambda supervisor: supervisor.resume(), lambda supervisor: supervisor.set_goal(GOAL)],
    ids=['resume', 'goal'])
def test_a_robot_whose_way_was_blocked_stands_until_a_person_lets_it_go_on(
        ask: Callable[[Supervisor], None]) -> None:
    """A way that is clear again is not enough; cancelled meanwhile, it stands where it is."""
    task = StuckTask()
    task.drive_until(TaskState.APPROACH, delay=0.3)
    task.supervisor.protect(PASSED)
    task.step()
    task.supervisor.protect(None)
    assert {task.step() for _ in range(40)} == {STOP}
    assert task.supervisor.awaits_resume and task.supervisor.cause is PASSED
    ask(task.supervisor)
    task.drive_until(TaskState.PUSH, delay=0.2)
    task.supervisor.protect(PASSED)
    task.supervisor.cancel(CANCELLED)
    assert task.supervisor.state is TaskState.IDLE


def test_a_robot_that_was_lost_counts_its_attempts_from_its_first_touch() -> None:
    """Those before were made elsewhere; a second touch excuses none, and the end names one."""
    task, limit = StuckTask(), SupervisionSettings().max_attempts
    task.drive_until(TaskState.APPROACH)
    supervisor, touch = task.supervisor, BehaviorFailure.LOST_ROBOT_TOUCHES.report()
    miss = BehaviorFailure.PATH_END_MISSED.report()
    for failure in (*[miss] * (limit - 1), touch):
        supervisor._recover(failure)
    assert supervisor._progress.failure is None
    task.drive_until(TaskState.APPROACH)
    for failure in (touch, *[miss] * (limit - 1)):
        supervisor._recover(failure)
    task.drive_until(TaskState.FAILED)
    assert supervisor.status.failure is TaskFailure.NO_PROGRESS
    assert touch.code in supervisor.status.codes
