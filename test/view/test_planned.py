"""The page shows what is planned after the next push, and what stands against a plan."""

import dataclasses
import json
import math

from helpers.objects import box
from helpers.tapes import straight_plan
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure
from push_model.signals import Odometry, STOP
from push_navigation.map_clearance import PositionEllipse
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_view.live.robot_record import RobotRecorder
from push_view.messages import Message, refusal_message
from push_view.recording import recording
from push_view.server.message_log import MessageLog
import pytest

LATER = [Pose(3.0, 0.5, 0.2), Pose(4.0, 1.0, 0.7)]
MARKS = RefusalMarks(NarrowPlace(1.0, 2.0, 0.5, 0.75, PositionEllipse(0.2, 0.1, 0.3)),
                     (FaceMark(0.0, 1.0, False),), Pose(1.0, 0.0, 0.5))


class _Log(MessageLog):
    """A log that lists what was added since it was cleared."""

    def __init__(self) -> None:
        super().__init__()
        self.added: list[Message] = []

    def add(self, message: Message) -> None:
        super().add(message)
        self.added.append(message)

    def of_kind(self, kind: str) -> list[Message]:
        return [message for message in self.added if message['type'] == kind]


def recorder(log: MessageLog) -> RobotRecorder:
    """Return one that has a row."""
    record = RobotRecorder(log, 'robot', box(), RoundRobot(0.17, 'differential'))
    record.on_odometry(Odometry(10.0, Pose(0.0, 0.0, 0.0), STOP))
    return record


@pytest.mark.parametrize('is_path_first', [True, False])
def test_later_pushes_are_those_of_the_path_with_the_stamp_of_the_plan(
        is_path_first: bool) -> None:
    """In whichever order they come; a path of another request is none of this plan."""
    log = _Log()
    record, plan = recorder(log), straight_plan()
    along = [Pose(*pose) for pose in plan.object_poses.tolist()]
    steps = [lambda: record.on_planned_path([*along, *LATER], 5.0),
             lambda: record.on_plan(plan, 5.0)]
    for step in steps if is_path_first else reversed(steps):
        step()
    assert [push['pose'] for push in log.of_kind('plan')[-1]['later']] == [
        list(pose) for pose in LATER]
    record.on_plan(plan, 6.0)
    assert log.of_kind('plan')[-1]['later'] == []
    count = len(log.of_kind('plan'))
    record.on_planned_path([*along, *LATER], 7.0)
    assert len(log.of_kind('plan')) == count


def test_a_refusal_is_shown_once_and_again_after_a_plan() -> None:
    """With all that a picture needs, as JSON."""
    log = _Log()
    record = recorder(log)
    for _ in range(3):
        record.on_refusal(PlanFailure.BLOCKED, 'a wall', MARKS)
    shown, = log.of_kind('refusal')
    assert shown == refusal_message(0.0, PlanFailure.BLOCKED, 'a wall', MARKS)
    assert json.loads(json.dumps(shown, allow_nan=False))['place'] == {
        'point': [1.0, 2.0], 'width': 0.5, 'needed': 0.75, 'ellipse': [0.2, 0.1, 0.3]}
    record.forget_refusal()
    record.on_refusal(PlanFailure.BLOCKED, 'a wall', MARKS)
    assert len(log.of_kind('refusal')) == 2


@pytest.mark.slow
def test_a_task_that_is_refused_keeps_why() -> None:
    """Once, though it asks again while it waits for another map; the report shows the pose."""
    scenario = load_scenario('task_map')
    wall = Placement(2.45, 0.0, 0.0)
    result = simulate(dataclasses.replace(scenario, goal=wall), planning_time=0.0)
    assert result.outcome is Outcome.FAILED
    refusal, = result.refusals
    assert refusal.failure.code is PlanFailure.NOT_FREE
    message, = (message for message in recording(result) if message['type'] == 'refusal')
    assert message['overlap'] == pytest.approx(list(wall.pose))
    assert 0.0 < message['time'] < result.duration and math.isfinite(message['time'])
