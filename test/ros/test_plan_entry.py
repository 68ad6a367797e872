"""The entry of plans of a single push, without a network: only who asks for a plan drives it."""

from collections.abc import Callable
import itertools
import logging
import threading
from types import SimpleNamespace
from typing import Any

from helpers.single_push_bench import GOAL, OBJECT, PERIOD, plan, ROBOT, SCENARIO
from push_control.events import TaskEvent
from push_control.ros.plan_entry import PlanEntry
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task import repeated_pushes
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_model.trajectory import PushStyle
from push_navigation.settings import DriveSettings
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.primitives import to_stamp
import pytest

OTHER_GOAL = Pose(GOAL.x, GOAL.y + 0.2, GOAL.theta)
# No measure of speed: it only keeps a suite from hanging [s].
TIMEOUT = 400.0
CAUSE = TaskEvent.GOAL_CANCELLED.report()


class Entry:
    """An entry that accepts plans which nobody has requested; robot and object stand."""

    def __init__(self, *, is_lockstep: bool = True) -> None:
        settings = ControlSettings(), DriveSettings(), SupervisionSettings()
        self.supervisor = Supervisor(SCENARIO.object, SCENARIO.robot, *settings,
                                     factory=SinglePushBehaviors)
        self.requests: list[Any] = []
        self.reports: list[str] = []
        publisher = SimpleNamespace(publish=self.requests.append)
        node: Any = SimpleNamespace(
            publisher=lambda _: publisher, resolve_topic_name=lambda name: name,
            get_logger=lambda: logging.getLogger('plans'), publishers_of=lambda _: [],
            reporter=SimpleNamespace(report=lambda level, text: self.reports.append(text)))
        parameters: Any = SimpleNamespace(
            options=SimpleNamespace(lockstep=is_lockstep, accept_unrequested_plans=True),
            frames=SimpleNamespace(world_frame='odom'), object=SCENARIO.object,
            robot=SCENARIO.robot, control=settings[0], supervision=settings[2])
        shown: Any = SimpleNamespace(show_goal=lambda _: None, show_plan=lambda *_: None)
        floor: Any = SimpleNamespace(occupancy_map=None)
        self.plans = PlanEntry(node, parameters, floor, shown)
        self.plans.reset(self.supervisor)
        self.time = 0.0
        self.step()

    def step(self) -> Twist:
        """Let time pass, and publish a request that is new; return the command."""
        self.time += PERIOD
        self.plans.check(self.observation, is_started=True)
        command = self.supervisor.step(self.observation, PERIOD)
        self.plans.update(self.time)
        return command

    @property
    def observation(self) -> Observation:
        """What is measured now."""
        return Observation(self.time, Odometry(self.time, ROBOT, STOP),
                           ObjectPose(self.time, OBJECT))

    def drives(self) -> bool:
        """Tell whether the robot is commanded to move soon."""
        return any(self.step() != STOP for _ in range(10))

    def request(self) -> Any:
        """Request a plan to the goal; return the stamp of the request."""
        self.supervisor.set_goal(GOAL)
        self.step()
        return self.requests[-1].header.stamp

    def answer(self, stamp: Any, *, is_started: bool = True) -> None:
        """Let a plan to the goal come."""
        self.plans.on_plan(to_plan_message(plan(), stamp, 'odom'), is_started=is_started)


def cancel(entry: Entry) -> None:
    """Cancel the goal."""
    entry.supervisor.cancel(CAUSE)


def replace(entry: Entry) -> None:
    """Replace the goal."""
    entry.supervisor.set_goal(OTHER_GOAL)


@pytest.mark.parametrize('end', [cancel, replace])
def test_the_answer_for_a_goal_that_has_ended_is_not_driven(
        end: Callable[[Entry], None]) -> None:
    """Also where plans are driven that nobody has requested: it is reported."""
    entry = Entry()
    stamp = entry.request()
    end(entry)
    entry.step()
    state = entry.supervisor.state
    entry.answer(stamp)
    assert not entry.drives() and entry.supervisor.state is state
    assert len(entry.reports) == 1 and 'answered, or given up' in entry.reports[0]


def test_the_answer_for_a_goal_that_was_stopped_is_not_stored_for_the_next_start() -> None:
    """Who starts the robot then has asked for no goal."""
    entry = Entry()
    stamp = entry.request()
    entry.supervisor.stop(CAUSE)
    entry.answer(stamp, is_started=False)
    assert not entry.supervisor.has_stored_plan
    entry.supervisor.restart(None)
    assert not entry.drives()


def test_answers_and_plans_of_others_are_driven() -> None:
    """The answer to the present request, and a plan with a stamp of no request."""
    answered, other = Entry(), Entry()
    answered.answer(answered.request())
    other.answer(to_stamp(other.time))
    for entry in (answered, other):
        assert entry.drives() and entry.supervisor.state is TaskState.PUSH
        assert not entry.reports


class Making:
    """Stands for what a plan needs and what takes long: it goes on until it is told to end."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.may_end, self.has_ended = threading.Event(), threading.Event()
        monkeypatch.setattr(SinglePushBehaviors, 'preparation', lambda *_: self)

    def __call__(self) -> None:
        assert self.may_end.wait(TIMEOUT)
        self.has_ended.set()

    def end(self, entry: Entry) -> None:
        """Let it end, and the controller notice that."""
        self.may_end.set()
        assert self.has_ended.wait(TIMEOUT)
        while entry.supervisor.state is TaskState.PLAN and not entry.reports:
            entry.step()


def test_a_plan_that_takes_long_to_prepare_lets_the_controller_go_on(
        monkeypatch: pytest.MonkeyPatch) -> None:
    """It answers measurements meanwhile, and waits for no other plan; then it drives this one."""
    making, entry = Making(monkeypatch), Entry(is_lockstep=False)
    entry.answer(entry.request())
    assert not entry.drives() and entry.supervisor.state is TaskState.PLAN
    making.end(entry)
    assert entry.drives() and entry.supervisor.state is TaskState.PUSH and not entry.reports


@pytest.mark.parametrize('end', [cancel, replace])
def test_a_plan_whose_goal_ends_while_it_is_prepared_is_not_driven(
        monkeypatch: pytest.MonkeyPatch, end: Callable[[Entry], None]) -> None:
    """Nor kept: it is reported."""
    making, entry = Making(monkeypatch), Entry(is_lockstep=False)
    entry.answer(entry.request())
    end(entry)
    entry.step()
    making.end(entry)
    assert not entry.drives() and len(entry.reports) == 1
    assert not entry.supervisor.has_stored_plan


def test_what_a_straight_push_loads_is_its_preparation(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that nothing is made while the controller would have to answer; others need none."""
    loaded: list[Any] = []
    monkeypatch.setattr(repeated_pushes, 'load_primitives', lambda *values: loaded.append(values))
    for name in ('warm_up', 'MovingApproach'):
        monkeypatch.setattr(repeated_pushes, name, lambda *_: None)
    factory = repeated_pushes.RepeatedPushBehaviors(
        SCENARIO.object, SCENARIO.robot, ControlSettings(), DriveSettings(), SupervisionSettings())
    progress: Any = None
    perception = factory.new_perception(0.0)
    perception.update(Observation(1.0, Odometry(1.0, ROBOT, STOP), ObjectPose(1.0, OBJECT)))
    for style, speed in itertools.product(PushStyle, (0.1, 0.2)):
        factory.set_settings(ControlSettings(), DriveSettings(speed=speed), SupervisionSettings())
        target: Any = SimpleNamespace(style=style)
        preparation = factory.preparation(target, perception)
        assert (preparation is not None) is style.is_straight
        if preparation is not None:
            preparation()
            factory.create(TaskState.APPROACH, target, None, perception, progress)
    assert len(loaded) >= 4 and loaded[::2] == loaded[1::2] and loaded[0] != loaded[2]
