"""Inspection: the robot drives to where it sees the object from another side."""

import math

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.inspection import Inspection, VIEW_ANGLE, VIEW_GAP
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
import pytest

DIFFERENTIAL = RoundRobot(radius=0.17, drive='differential', max_speed=0.5, max_acceleration=1.0)
PLACE = Pose(0.3, 0.2, 0.7)
STEP = 0.05


def inspect(obj, robot, start, occupancy_map=None):
    """Let an ideal robot carry out an inspection; return it and the robot's poses."""
    context = BehaviorContext(obj, robot, ControlSettings(), DriveSettings(),
                              SupervisionSettings(), occupancy_map)
    perception = TaskPerception(obj, robot, context.control, context.supervision)
    behavior, pose, poses = Inspection(context), start, [start]
    for count in range(600):
        time = count * STEP
        perception.update(Observation(time, Odometry(time, pose, STOP), ObjectPose(time, PLACE)))
        command = behavior.step(perception, STEP)
        if behavior.finished or behavior.failure:
            break
        half = 0.5 * command.omega * STEP
        pose = pose @ Pose(0.0, 0.0, half)
        pose = pose @ Pose(command.v_x * STEP, command.v_y * STEP, half)
        poses.append(pose)
    return behavior, poses


def bearing(pose):
    """Return the direction from the object to the robot [rad]."""
    return math.atan2(pose.y - PLACE.y, pose.x - PLACE.x)


@pytest.mark.parametrize('robot', [HOLONOMIC, DIFFERENTIAL])
@pytest.mark.parametrize('obj', [box(), bin_()])
def test_the_object_is_seen_from_a_third_of_a_turn_on(obj, robot):
    """The robot never touches it, and ends clear of it."""
    start = PLACE @ Pose(-0.6, 0.1, 0.2)
    behavior, poses = inspect(obj, robot, start)
    assert behavior.finished and behavior.failure is None
    gaps = [find_contact(obj, PLACE, pose[:2], robot.radius).gap for pose in poses]
    assert min(gaps) > 0.01 and gaps[-1] == pytest.approx(VIEW_GAP, abs=0.03)
    turned = wrap_angle(bearing(poses[-1]) - bearing(start) - VIEW_ANGLE)
    assert abs(turned) < 0.1


def test_no_path_is_a_failure_with_its_reason():
    """Walls all around: the robot stays."""
    cells = np.ones((60, 60), dtype=bool)
    walls = OccupancyMap(0.1, Pose(-3.0, -3.0, 0.0), cells)
    behavior, poses = inspect(box(), HOLONOMIC, PLACE @ Pose(-0.6, 0.1, 0.2), walls)
    assert behavior.failure is not None and not behavior.finished
    assert len(poses) == 1


def test_the_object_is_seen_from_the_other_side_where_an_obstacle_is_on_this_one() -> None:
    """As beside a wall."""
    start = PLACE @ Pose(-0.6, 0.1, 0.2)
    cells = np.zeros((60, 60), dtype=bool)
    behind = bearing(start) + VIEW_ANGLE
    x, y = PLACE.x + 0.55 * math.cos(behind), PLACE.y + 0.55 * math.sin(behind)
    cells[int((y + 3.0) / 0.1), int((x + 3.0) / 0.1)] = True
    behavior, poses = inspect(box(), HOLONOMIC, start,
                              OccupancyMap(0.1, Pose(-3.0, -3.0, 0.0), cells))
    assert behavior.finished and behavior.failure is None
    assert abs(wrap_angle(bearing(poses[-1]) - bearing(start) + VIEW_ANGLE)) < 0.1
