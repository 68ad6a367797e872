"""The entry of plans of a single push, without a network: only who asks for a plan drives it."""

from collections.abc import Callable
import logging
from types import SimpleNamespace
from typing import Any

from helpers.single_push_bench import GOAL, OBJECT, PERIOD, plan, ROBOT, SCENARIO
from push_control.events import TaskEvent
from push_control.ros.plan_entry import PlanEntry
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.settings import DriveSettings
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.primitives import to_stamp
import pytest

OTHER_GOAL = Pose(GOAL.x, GOAL.y + 0.2, GOAL.theta)
CAUSE = TaskEvent.GOAL_CANCELLED.report()


class Entry:
    """An entry that accepts plans which nobody has requested; robot and object stand."""

    def __init__(self) -> None:
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
            options=SimpleNamespace(lockstep=True, accept_unrequested_plans=True),
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
        command = self.supervisor.step(Observation(
            self.time, Odometry(self.time, ROBOT, STOP), ObjectPose(self.time, OBJECT)), PERIOD)
        self.plans.update(self.time)
        return command

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
