"""The pursuit of a goal, without a network: who stands in the way counts whatever the map is."""

import logging
from types import SimpleNamespace
from typing import Any

import numpy as np
from push_control.goal import PushGoal
from push_control.ros.pursuit import GoalPursuit
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_stamp
from push_safety.protective_field import ProtectiveCause
from push_scenario.definition.loader import load_scenario
import pytest

SCENARIO = load_scenario('task_tap')
GOAL = PushGoal(SCENARIO.goal.pose)
ROOM = to_map_message(OccupancyMap(0.1, Pose(-3.0, -3.0, 0.0), np.zeros((60, 60), np.bool_)),
                      to_stamp(1.0), 'odom')
PERSON = ProtectiveCause.OBSTRUCTED_UNTIL_RESUME.report()


def make_pursuit(*, map_required: bool) -> GoalPursuit:
    """Pursue a goal by a task, with a node that reports nothing."""
    parameters: Any = SimpleNamespace(
        options=SimpleNamespace(wait_for_start=False, task=True, map_required=map_required,
                                knowledge_file='', lockstep=True),
        object=SCENARIO.object, robot=SCENARIO.robot, control=ControlSettings(),
        drive=DriveSettings(), supervision=SupervisionSettings(), map=MapSettings(),
        frames=SimpleNamespace(world_frame='odom'))
    publisher = SimpleNamespace(publish=lambda _: None)
    node: Any = SimpleNamespace(
        publisher=lambda _: publisher, now=lambda: to_stamp(0.0),
        resolve_topic_name=lambda name: name,
        get_logger=lambda: logging.getLogger('pursuit'),
        reporter=SimpleNamespace(report=lambda *_, **__: None))
    scene: Any = SimpleNamespace(show_goal=lambda *_: None)
    placing: Any = SimpleNamespace(set_map=lambda _: None)
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
