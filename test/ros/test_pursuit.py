"""The pursuit of a goal, without a network: what stops it, and what a clock does to it."""

import logging
import math
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from push_control.goal import PushGoal
from push_control.ros.pursuit import GoalPursuit
from push_control.settings import ControlSettings
from push_control.steered.rehearsal import rehearsal_plan
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.events import Codes
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_stamp
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
import pytest

SCENARIO = load_scenario('task_tap')
GOAL = PushGoal(SCENARIO.goal.pose)
ROOM = to_map_message(OccupancyMap(0.1, Pose(-3.0, -3.0, 0.0), np.zeros((60, 60), np.bool_)),
                      to_stamp(1.0), 'odom')
PLAN = rehearsal_plan(SCENARIO.object, SCENARIO.robot)
LATE = SafetyReason.FOLLOWS_LATE.report(delay=0.5)
# Of measurements, and by how much clocks are set ahead [s].
PERIOD, JUMP = 0.25, 3600.0
PERSON = ProtectiveCause.OBSTRUCTED_UNTIL_RESUME.report()


def make_pursuit(*, map_required: bool) -> GoalPursuit:
    """Pursue a goal by a task, with a node that reports nothing."""
    parameters: Any = SimpleNamespace(
        options=SimpleNamespace(wait_for_start=False, task=True, map_required=map_required,
                                knowledge_file='', lockstep=True),
        object=SCENARIO.object, robot=SCENARIO.robot, control=ControlSettings(),
        drive=DriveSettings(), supervision=SupervisionSettings(), map=MapSettings(),
        frames=SimpleNamespace(world_frame='odom'))
    publisher = SimpleNamespace(publish=lambda _: None,
                                get_subscription_count=lambda: 1)
    node: Any = SimpleNamespace(
        publisher=lambda _: publisher, now=lambda: to_stamp(0.0),
        resolve_topic_name=lambda name: name,
        get_logger=lambda: logging.getLogger('pursuit'),
        reporter=SimpleNamespace(report=lambda *_, **__: None))
    scene: Any = SimpleNamespace(show_goal=lambda *_: None)
    placing: Any = SimpleNamespace(set_map=lambda _: None, fit_warning=lambda: '')
    made = GoalPursuit(node, parameters, scene, placing)
    made.set_goal(GOAL)
    return made


@pytest.mark.parametrize('is_refused', [False, True])
def test_who_was_in_the_way_while_no_map_could_be_used_awaits_a_person(is_refused: bool) -> None:
    """A robot that stands for want of a map does not go on by itself once there is one."""
    pursuit = make_pursuit(map_required=not is_refused)
    if is_refused:
        pursuit.refuse_map('map: got none that can be read')
    assert not pursuit.awaits_resume
    pursuit.protect(PERSON)
    pursuit.protect(None)
    pursuit.on_map(ROOM)
    assert pursuit.awaits_resume
    assert pursuit.resume().success and not pursuit.awaits_resume


class Course(NamedTuple):
    """States of a pursuit, their causes and times, and the states in which it was."""

    changes: list[tuple[TaskState, Codes]]
    times: list[float]


def run_course(jump_at: float) -> Course:
    """
    Let a robot be stopped, follow a plan without moving, and see the object no more.

    Clocks are set ahead at a time [s].
    """
    pursuit = make_pursuit(map_required=False)
    supervisor: Supervisor = vars(pursuit)['_supervisor']
    shift, object_pose = 0.0, ObjectPose(0.0, SCENARIO.start.object.pose)
    for i in range(400):
        time = i * PERIOD
        if time == jump_at:
            shift = JUMP
            object_pose = object_pose._replace(time=object_pose.time + JUMP)
            pursuit.on_time_ahead(JUMP)
        if time < 30.0:
            object_pose = object_pose._replace(time=time + shift)
        if time == 12.0:
            supervisor.drive(PLAN)
        stop = LATE if 2.0 <= time < 9.0 else None
        pursuit.on_safety_report(None, stop)
        pursuit.step(Observation(time + shift, Odometry(time + shift, SCENARIO.robot_start, STOP),
                                 object_pose), PERIOD)
    history = supervisor.history
    return Course([(change.state, change.codes) for change in history],
                  [change.time for change in history])


@pytest.fixture(scope='module')
def steady() -> Course:
    """Run the course by a clock that is never set."""
    course = run_course(math.inf)
    states = [state for state, _ in course.changes]
    assert TaskState.APPROACH in states and states[-1] is TaskState.FAILED
    return course


@pytest.mark.parametrize('jump_at', [1.0, 8.0, 11.0, 13.0, 25.0, 60.0])
def test_a_clock_that_is_set_ahead_changes_nothing(steady: Course, jump_at: float) -> None:
    """By an hour, in any state: each limit is one of time that has passed."""
    course = run_course(jump_at)
    assert course.changes == steady.changes
    assert course.times == pytest.approx(steady.times, abs=1e-6)
