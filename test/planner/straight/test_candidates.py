"""Straight pushes to choose from: they end where they say, wherever the object stands."""

from helpers.objects import bin_
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner import plan_for_request, PlannerSettings, PlanningFailed, straight_pushes
import pytest

pytestmark = pytest.mark.slow

# As of the tests of the planner, so that the table is made once.
BIN = bin_(feet=4)
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
SETTINGS, DRIVE = PlannerSettings(), DriveSettings()
REQUEST = PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.1, 0.0), Pose(0.6, 0.1, 0.3), BIN)


@pytest.fixture(scope='module')
def pushes():
    """List the pushes of the bin."""
    return straight_pushes(REQUEST, ROBOT, SETTINGS, DRIVE)


@pytest.mark.parametrize('index, step', [(0, 5), (0, -1), (200, 5), (200, -1)])
def test_a_plan_ends_where_the_list_says(pushes, index, step):
    plan = pushes.plan(index, float(pushes.lengths[step]))
    assert plan.trajectory.object_poses[-1] == pytest.approx(pushes.object_poses[index, step])
    assert plan.trajectory.line.start == pytest.approx(pushes.starts[index])
    assert plan.length == pushes.lengths[step]


def test_the_list_moves_with_the_object(pushes):
    motion = Pose(2.0, -1.0, 1.1)
    moved = straight_pushes(REQUEST._replace(
        object_pose=motion @ REQUEST.object_pose, robot_pose=motion @ REQUEST.robot_pose,
        goal=motion @ REQUEST.goal), ROBOT, SETTINGS, DRIVE)
    for pose, moved_pose in zip(pushes.object_poses[::20, -1], moved.object_poses[::20, -1]):
        assert np.allclose(motion @ Pose(*pose), moved_pose)


def test_the_choice_of_the_package_is_in_the_list(pushes):
    chosen = plan_for_request(REQUEST, ROBOT, SETTINGS, DRIVE)
    line = chosen.trajectory.line
    index = next(i for i, (start, curvature) in enumerate(zip(pushes.starts, pushes.curvatures))
                 if np.array_equal(start, line.start) and curvature == line.curvature)
    plan = pushes.plan(index, line.length)
    assert np.array_equal(plan.trajectory.object_poses, chosen.trajectory.object_poses)
    assert np.array_equal(plan.approach_path.poses, chosen.approach_path.poses)


def test_what_is_no_push_is_refused(pushes):
    with pytest.raises(ValueError, match='index: got -1, expected from 0 to'):
        pushes.plan(-1, 0.1)
    with pytest.raises(ValueError, match='length: got 0.0, expected above 0, at most 1'):
        pushes.plan(0, 0.0)
    with pytest.raises(PlanningFailed) as failure:
        straight_pushes(REQUEST, RoundRobot(0.0), SETTINGS, DRIVE)
    assert failure.value.code is PlanFailure.ROBOT_NOT_ROUND
