"""A push that has met nothing: the robot has not been where the object was, and is no surer."""

import math

from helpers.ensemble_runs import CONTROL, NOISE, ROBOT
from helpers.objects import bin_, box
import numpy as np
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.ensemble.missed_push import (
    after_missed_push, MAX_OVERLAP, MIN_REMAINING)
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_model.contact import find_contact
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose, Odometry, STOP, Twist
import pytest

ORIGIN = Pose(0.0, 0.0, 0.0)
START, LENGTH = Pose(-0.5, 0.0, 0.0), 0.4
MISS_STDS = 0.03, 0.03


def remembered(std: float, heading_std: float = 0.0, start: Pose = START) -> RobotMemory:
    """Remember a robot that may be elsewhere."""
    errors = np.random.default_rng(3).standard_normal((100, 3)) * (std, std, heading_std)
    return RobotMemory(start, np.array(start) + errors, np.arange(300.0).reshape(100, 3))


def after(memory: RobotMemory, length: float = LENGTH, obj: PushedObject = box(),
          object_pose: Pose = ORIGIN) -> RobotMemory:
    """Drive ahead, and meet nothing."""
    end = memory.odometry_pose @ Pose(length, 0.0, 0.0)
    return after_missed_push(memory, end, obj, ROBOT.radius, object_pose)


def least_gap(obj: PushedObject, robot: FloatArray) -> float:
    """Return the least gap on the way, by many steps."""
    return min(find_contact(obj, ORIGIN, (Pose(*robot.tolist()) @ Pose(x, 0.0, 0.0))[:2],
                            ROBOT.radius).gap for x in np.linspace(0.0, LENGTH, 81))


@pytest.mark.parametrize('obj', [box(), bin_()])
def test_those_remain_that_were_not_in_the_way(obj: PushedObject) -> None:
    """By gaps that are computed elsewhere; each one about as often, with its own odometry."""
    memory = remembered(0.25, 0.3)
    gaps = [least_gap(obj, robot) for robot in memory.robots]
    certain = {i for i, gap in enumerate(gaps) if gap > -MAX_OVERLAP + 0.002}
    possible = {i for i, gap in enumerate(gaps) if gap > -MAX_OVERLAP - 0.002}
    chosen = (after(memory, obj=obj).odometry_errors[:, 0] / 3.0).astype(int).tolist()
    assert certain <= set(chosen) <= possible
    counts = [chosen.count(index) for index in set(chosen)]
    assert max(counts) - min(counts) <= 1


@pytest.mark.parametrize('std', [0.01, 0.05, 0.15, 0.3])
@pytest.mark.parametrize('heading_std', [0.0, 0.2])
def test_a_push_that_met_nothing_makes_no_robot_surer(std: float, heading_std: float) -> None:
    """Along no axis, however little was known."""
    memory = remembered(std, heading_std)
    assert np.all(after(memory).robots.std(axis=0) >= memory.robots.std(axis=0) - 1e-12)


def test_nothing_is_learned_where_nothing_was_in_the_way_or_all_were() -> None:
    """Of a robot far off, and of one that is known and cannot have missed."""
    for start, std in ((Pose(-3.0, 0.0, 0.0), 0.3), (START, 0.01)):
        memory = remembered(std, start=start)
        assert after(memory) is memory


@pytest.mark.parametrize('world', [Pose(2.0, -1.0, 2.5), Pose(0.0, 0.0, -1.2)])
def test_it_does_not_matter_where_the_world_has_its_axes(world: Pose) -> None:
    """The same members remain."""
    memory = remembered(0.2, 0.1)
    robots = [world @ Pose(*robot.tolist()) for robot in memory.robots]
    there = memory._replace(odometry_pose=world @ START, robots=np.array(robots))
    assert np.array_equal(after(there, object_pose=world).odometry_errors,
                          after(memory).odometry_errors)


@pytest.mark.parametrize('missed_by', [(0.0, 0.4), (-0.35, 0.0)])
def test_a_robot_that_misses_is_within_what_is_known_of_it(
        missed_by: tuple[float, float]) -> None:
    """
    It passes beside the object, or ends before it, and poses show it at rest all the while.

    The filter alone has the robot stop at the object then, and becomes the surer of that.
    """
    ensemble, rng = PushEnsemble(box(), ROBOT, CONTROL, NOISE), np.random.default_rng(1)

    def see(time: float) -> None:
        ensemble.update(ObjectPose(time, Pose(*(rng.standard_normal(3) * (2e-3, 2e-3, 5e-3)))))
    for k in range(5):
        ensemble.predict(Odometry(0.05 * k, START, STOP))
        see(0.05 * k)
    ensemble.inflate_covariance(0.15)
    memory, before = ensemble.remember_robot(), ensemble.standard_deviations.copy()
    for k in range(40):
        pose = Pose(START.x + 0.3 * (k + 1) / 40, 0.0, 0.0)
        ensemble.predict(Odometry(0.25 + 0.05 * k, pose, Twist(0.15, 0.0, 0.0)))
        see(0.25 + 0.05 * k)
    truth = np.array([START.x + 0.3 + missed_by[0], missed_by[1]])
    assert np.all(ensemble.standard_deviations[:2] < 0.8 * before[:2])
    odometry = ensemble.odometry
    assert odometry is not None
    ensemble.restore_robot(
        after_missed_push(memory, odometry.pose, box(), ROBOT.radius, ORIGIN), *MISS_STDS)
    error = truth - ensemble.pose[:2]
    covariance = np.cov(ensemble.members.robot_poses[:, :2].T)
    # The bound that 99 in 100 keep.
    assert error @ np.linalg.solve(covariance, error) < 9.2
    assert np.all(ensemble.standard_deviations[:2] >= before[:2] - 1e-3)


def test_a_few_members_are_no_knowledge() -> None:
    """As many as there have to be are taken, one less is not."""
    memory = remembered(0.0)
    for count in (MIN_REMAINING, MIN_REMAINING - 1):
        robots = memory.robots.copy()
        robots[:count, 1] = math.tau
        changed = memory._replace(robots=robots)
        assert (after(changed) is changed) == (count < MIN_REMAINING)
