"""What pictures show of a plan: pushes that follow each other, with ways between that are free."""

import math

from helpers.maps import walled_floor
from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanRequest
from push_navigation.path import sample_path
from push_navigation.settings import DriveSettings
from push_planner.planned_pushes import planned_pushes
from push_planner.settings import PlannerSettings
from push_planner.task_planner import plan_for_request
import pytest

pytestmark = pytest.mark.slow
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
BOX = box()


def test_pushes_follow_each_other_and_the_ways_between_are_free() -> None:
    """From the start to the goal; each way begins where the robot has pushed to."""
    occupancy_map, drive = walled_floor(6.0, 4.5, 0.9), DriveSettings()
    here, goal = Pose(-1.6, 0.2, 0.4), Pose(1.5, 0.3, 1.0)
    plan = plan_for_request(PlanRequest(here, Pose(-0.9, -1.1, 1.0), goal, BOX), ROBOT,
                            PlannerSettings(), drive, occupancy_map)
    pushes = planned_pushes(plan, BOX, ROBOT, drive, occupancy_map)
    assert len(pushes) == 1 + len(plan.remaining.pushes) > 2
    assert pushes[0].start == pytest.approx(here)
    robot_pose = Pose(-0.9, -1.1, 1.0)
    for push, following in zip(pushes, [*pushes[1:], None]):
        assert following is None or math.dist(push.end[:2], following.start[:2]) < 0.06
        assert push.approach.poses[0][:2] == pytest.approx(robot_pose[:2], abs=1e-3)
        assert push.approach.poses[-1][:2] == pytest.approx(push.robot_start[:2], abs=1e-3)
        rows = sample_path(push.approach, ROBOT, 0.02)
        assert occupancy_map.robot_is_free(ROBOT, rows, 0.0)
        middles = np.hypot(*(rows[:, :2] - push.start[:2]).T)
        # The box is 0.4 m wide: none comes nearer than a robot that touches a face.
        assert middles.min() > 0.2 + ROBOT.radius - 1e-3
        later = next((item for item in plan.remaining.pushes
                      if item.robot_start == push.robot_start), None)
        robot_pose = (Pose(*plan.trajectory.robot_poses[-1].tolist()) if later is None
                      else later.robot_end)
