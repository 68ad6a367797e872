"""Pushes that nobody sees: what the first poses after them tell of robot and wheels."""

import math

from helpers.ensemble_runs import CONTROL, NO_NOISE, NOISE, ROBOT
from helpers.objects import box
import numpy as np
from push_base.push_force import needed_force
from push_control.perception.ensemble.members import ODOMETRY_ERRORS
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.relation import relative_poses
from push_model.geometry import distance, Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest

# Of the way at the force that pushes the box: 4 %.
FORCE = needed_force(box())
UNSEEN = NOISE._replace(creep=0.04 / FORCE)
PERIOD = 0.02
# Where the robot touches the box at the origin, and steps of odometry on [m].
TOUCH, STEP = -0.37, 0.005


class Pusher:
    """A robot that pushes a box along x, unseen, with wheels that creep while it pushes."""

    def __init__(self, noise, creep, is_relative=False):
        """Start before the contact, the box in sight."""
        self.ensemble = PushEnsemble(box(), ROBOT, CONTROL, noise)
        self.creep, self.is_relative = creep, is_relative
        self.time, self.odometry = 0.0, TOUCH - 0.05
        self.robot = self.odometry
        self.box = 0.0
        self.turned = 0.0
        self.see()

    def see(self):
        """Let poses come for a moment."""
        for _ in range(20):
            self._measure(0.0)
            self.ensemble.update(self.object_pose)

    @property
    def object_pose(self):
        """The pose of the box that is measured now."""
        relation = Pose(self.box - self.robot, 0.0, self.turned)
        return ObjectPose(self.time, Pose(self.box, 0.0, self.turned),
                          relative=relation if self.is_relative else None)

    def drive(self, length):
        """Drive along x."""
        for _ in range(round(abs(length) / STEP)):
            self._measure(math.copysign(STEP, length))

    def push(self, length):
        """Push by a length of odometry, back off, and look."""
        self.drive(self.box + TOUCH - self.robot + length)
        self.drive(-0.15)
        self.see()

    def _measure(self, step):
        self.time += PERIOD
        self.odometry += step
        is_pushing = step > 0.0 and self.robot >= self.box + TOUCH - 1e-9
        self.robot += step * (1.0 - self.creep) if is_pushing else step
        self.box = max(self.box, self.robot - TOUCH)
        self.ensemble.predict(Odometry(self.time, Pose(self.odometry, 0.0, 0.0), STOP))

    @property
    def error(self):
        """Distance of the robot from where it is estimated to be [m]."""
        return distance(self.ensemble.pose, Pose(self.robot, 0.0, 0.0))


@pytest.mark.parametrize('creep', [0.0, 0.04, 0.08])
def test_looks_tell_how_wheels_creep_under_load(creep):
    """And that they do not where they do not; what is driven without load is not scaled by it."""
    pusher = Pusher(UNSEEN, creep)
    for _ in range(3):
        pusher.push(0.4)
    members = pusher.ensemble.members
    assert FORCE * members.wheel_creep.mean() == pytest.approx(creep, abs=0.025)
    assert pusher.error < 3.0 * members.position_deviation
    assert pusher.error < 0.02


@pytest.mark.parametrize('creep', [0.25, 0.4])
def test_a_push_that_no_member_expects_tells_of_the_robot(creep):
    """It has not come as far as the box; else somebody else would have moved the box back."""
    pusher, misled = Pusher(UNSEEN, creep), Pusher(NOISE, creep)
    for each in pusher, misled:
        each.push(0.4)
    missing = 0.4 * creep
    assert misled.error > 0.7 * missing
    assert pusher.error < 0.3 * missing
    assert pusher.error < 3.0 * pusher.ensemble.position_deviation


def test_an_object_that_was_carried_off_does_not_move_the_robot_with_it():
    """No push explains where it is."""
    pusher = Pusher(UNSEEN, 0.0)
    pusher.push(0.3)
    pusher.box += 1.0
    pusher.see()
    assert pusher.error < 0.03
    assert distance(pusher.ensemble.object_pose, Pose(pusher.box, 0.0, 0.0)) < 0.01


@pytest.mark.parametrize('creep', [0.0, 0.08])
def test_poses_relative_to_the_robot_do_not_tell_how_its_wheels_creep(creep):
    """What is pushed comes along: the place in the world is that of odometry."""
    pusher, plain = (Pusher(noise, creep, is_relative=True) for noise in (UNSEEN, NOISE))
    for each in pusher, plain:
        each.push(0.4)
        each.push(0.4)
    assert not pusher.ensemble.members.wheel_creep.any()
    assert distance(pusher.ensemble.pose, plain.ensemble.pose) < 0.01
    relation = pusher.ensemble.pose.inverse() @ pusher.ensemble.object_pose
    assert relation.x == pytest.approx(pusher.box - pusher.robot, abs=2e-3)


@pytest.mark.parametrize('is_relative', [False, True])
def test_a_tap_that_nobody_sees_leaves_the_object_uncertain_by_millimetres(is_relative):
    """And by half a degree: what a pose says that tells nothing."""
    pusher = Pusher(NO_NOISE, 0.0, is_relative)
    pusher.drive(0.055)
    pusher.drive(-0.15)
    before = pusher.ensemble.object_deviations.copy()
    pusher.ensemble.update(pusher.object_pose._replace(
        covariance=PoseCovariance.from_deviations(10.0, 10.0)))
    added = np.sqrt(pusher.ensemble.object_deviations ** 2 - before ** 2)
    assert np.all((added > (0.002, 0.002, 0.005)) & (added < (0.005, 0.005, 0.02)))


def test_an_object_that_a_tap_has_moved_otherwise_is_where_it_is_seen():
    """An ensemble that is sure of what taps do would keep it from where poses have it."""
    pusher = Pusher(NO_NOISE, 0.0)
    for _ in range(100):
        pusher.see()
    pusher.drive(0.055)
    pusher.drive(-0.15)
    pusher.box += 0.006
    pusher.see()
    assert pusher.ensemble.object_pose.x == pytest.approx(pusher.box, abs=1e-3)


def test_a_relative_pose_after_an_unseen_push_moves_the_object_alone():
    """However the push has gone; robots and errors of odometry stay as they were."""
    pusher = Pusher(NOISE, 0.0, is_relative=True)
    pusher.drive(0.35)
    pusher.drive(-0.2)
    members = pusher.ensemble.members
    robots, errors = members.robot_poses.copy(), members.parameters[:, :ODOMETRY_ERRORS].copy()
    relation = pusher.object_pose.relative @ Pose(0.0, -0.01, 0.08)
    assert pusher.ensemble.update(pusher.object_pose._replace(relative=relation))
    assert np.array_equal(members.robot_poses, robots)
    assert np.array_equal(members.parameters[:, :ODOMETRY_ERRORS], errors)
    relations = relative_poses(members.robot_poses, members.object_poses)
    assert relations.mean(axis=0) == pytest.approx(np.array(relation), abs=5e-3)
    # What remains uncertain of the relation is not what was uncertain of the robot.
    correlations = np.corrcoef(np.hstack([relations, robots]).T)[:3, 3:]
    assert np.abs(correlations).max() < 0.4


def test_how_an_unseen_push_turns_the_object_is_not_taken_for_a_drift_of_the_robot():
    """Push after push it turns otherwise than expected, as its friction is not what it seems."""
    pusher = Pusher(NOISE, 0.0, is_relative=True)
    for _ in range(3):
        pusher.turned += 0.2
        pusher.push(0.3)
    assert abs(pusher.ensemble.pose.theta) < 0.02
    assert pusher.ensemble.object_pose.theta == pytest.approx(pusher.turned, abs=0.02)
