"""Walls that are not where the map has them: pushes tell where they are, not where robots are."""

import math

from helpers.ensemble_runs import CONTROL, NOISE, ROBOT
from helpers.objects import box
import numpy as np
from push_control.behaviors.walls_beside import wall_errors, walls_beside
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_sim_node.plant import Plant
import pytest

STEP = 0.05
# A box against the wall y = 0, and a robot that pushes it along, below its middle: it turns into
# the wall.
OBJECT_START, ROBOT_START = Pose(0.0, -0.2, 0.0), Pose(-0.39, -0.33, 0.0)
PUSH = Twist(0.08, -0.02, 0.0)
WALL = Wall(-2.0, 0.0, 2.0, 0.0)
# By how much the robot is elsewhere than it was estimated to be, and how well it was known.
OFFSET, DEVIATIONS = Pose(-0.02, 0.03, 0.03), (0.03, 0.035)
# Squared Mahalanobis distance of a position that one in a hundred exceeds.
BOUND = 9.21


def map_with_wall(shift: float) -> OccupancyMap:
    """Return a map that has the wall at ``y = shift`` [m]."""
    cells = np.zeros((80, 80), dtype=bool)
    cells[60:] = True
    return OccupancyMap(0.05, Pose(-2.0, shift - 3.0, 0.0), cells)


def pushed_along(shift: float) -> tuple[PushEnsemble, FloatArray]:
    """
    Push along the wall by a map that has it elsewhere.

    :return: the ensemble, and the error of its robot pose, shape (3,).
    """
    plant = Plant(box(), ROBOT, OBJECT_START, ROBOT_START, walls=(WALL,))
    ensemble, rng = PushEnsemble(box(), ROBOT, CONTROL, NOISE), np.random.default_rng(3)
    ensemble.predict(Odometry(0.0, OFFSET @ ROBOT_START, STOP))
    ensemble.inflate_covariance(*DEVIATIONS)
    room = map_with_wall(shift)
    for k in range(60):
        x, y, theta = plant.object_pose
        noise = rng.standard_normal(3) * (1e-3, 1e-3, 3e-3)
        ensemble.update(ObjectPose(k * STEP, Pose(x + noise[0], y + noise[1], theta + noise[2])))
        if k == 10:
            pose = ensemble.object_pose
            ensemble.members.set_walls(walls_beside(room, box(), pose, 2.0), wall_errors(
                room, box(), pose, CONTROL.wall_error, ensemble.members.count))
        plant.advance(STEP, PUSH if k > 10 else STOP)
        ensemble.predict(Odometry((k + 1) * STEP, OFFSET @ plant.robot_pose, STOP))
    assert plant.object_pose.y < -0.21, 'the wall has not moved the box'
    return ensemble, np.array(ensemble.pose) - plant.robot_pose


@pytest.mark.parametrize('shift', [-0.02, 0.0, 0.01, 0.02])
def test_a_wall_that_is_elsewhere_is_told_from_a_robot_that_is(shift: float) -> None:
    """The object shows where it is, so that the robot lies within its covariance."""
    ensemble, error = pushed_along(shift)
    covariance = np.cov(ensemble.members.robot_poses.T)
    assert error[:2] @ np.linalg.solve(covariance[:2, :2], error[:2]) < BOUND
    assert abs(error[2]) < 3.0 * math.sqrt(covariance[2, 2])
    errors = ensemble.members.wall_errors
    assert errors is not None
    # Walls that overlap the object were moved off it.
    assert errors[:, 1].mean() == pytest.approx(-max(shift, 0.0), abs=0.003)
    assert errors[:, 1].std() < 0.003
