"""Laws of places of the robot beside drifting odometry."""

import math

from helpers.objects import box
import numpy as np
from push_control.perception.object_at_rest import Tap
from push_control.perception.perception import TaskPerception
from push_control.perception.place_tracker import MAX_LENGTH, MAX_TURN, PlaceTracker
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.events import PushEvent
from push_model.files import data
from push_model.files.parameter_files import read_robot
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.signals import (
    ObjectPose, Odometry, PlaceStatus, PoseCovariance, RobotPlace, Twist,
)
import pytest

ROBOT = read_robot(data.config_file('robots/holonomic_017.yaml'))
STATED = PoseCovariance.from_deviations(0.009, 0.003)
START = Pose(0.0, 0.0, 0.0)
SCALE, DRIFT, STEP = 0.03, 0.03, 0.02


def perceive():
    """Make the perception of a task whose object is far away."""
    return TaskPerception(box(), ROBOT, ControlSettings(), SupervisionSettings())


class Tour:
    """A robot that drives with errors of scale and drift, and is placed ten times a second."""

    def __init__(self, *, has_places=True, covariance=STATED):
        self.perception = perceive()
        self.has_places = has_places
        self.covariance = covariance
        self.true = self.claim = START
        self.time, self.place = 0.0, None
        self.observe()

    def observe(self):
        """Take in what is measured now."""
        self.perception.update(Observation(
            self.time, Odometry(self.time, self.claim, Twist(0.3, 0.0, 0.1)),
            ObjectPose(0.0, Pose(30.0, 0.0, 0.0)), place=self.place))

    def drive(self, count, error=START, status=PlaceStatus.TRACKED):
        """Drive some steps; places are late by half a period, and have an error that lasts."""
        rotation = 0.1 * STEP
        late = []
        for _ in range(count):
            length = 0.3 * STEP
            late.append((self.time, self.true))
            self.true = self.true @ Pose(length, 0.0, rotation)
            self.claim = self.claim @ Pose((1.0 + SCALE) * length, 0.0,
                                           rotation + DRIFT * length)
            self.time += STEP
            if self.has_places and len(late) == 5:
                time, pose = late[2]
                self.place = RobotPlace(time, Pose(pose.x + error.x, pose.y + error.y, pose.theta),
                                        self.covariance, status)
                late = []
            self.observe()

    @property
    def error(self):
        """Distance of the estimate from the robot [m]."""
        return distance(self.perception.robot_pose, self.true)


def test_places_bound_the_drift_of_odometry():
    """After 5 m a robot that is placed is where it is, to what places state."""
    placed, alone = Tour(), Tour(has_places=False)
    for tour in (placed, alone):
        tour.drive(850)
    assert placed.error < 0.012 < 0.1 < alone.error
    deviation = placed.perception.position_deviation
    assert 0.004 < deviation < 0.02
    assert alone.perception.position_deviation > 0.1
    assert placed.perception.is_robot_placed and not alone.perception.is_robot_placed


def test_errors_of_odometry_are_learned_from_places():
    """The part by which distances are too large, of half its error at least."""
    placed, alone = Tour(), Tour(has_places=False)
    for tour in (placed, alone):
        tour.drive(850)
    assert abs(placed.perception.localization.odometry_scale - SCALE) < 0.5 * SCALE
    assert abs(alone.perception.localization.odometry_scale) < 1e-6


def test_a_thousand_places_tell_no_more_than_one():
    """An error that lasts stays within what the estimate states, however often it comes."""
    error = Pose(0.012, -0.008, 0.0)
    tour = Tour()
    tour.drive(1000, error)
    deviations = tour.perception.localization.standard_deviations
    assert tour.error < 3.0 * math.hypot(*deviations[:2])
    assert deviations[:2].min() > 0.4 * 0.009


def test_where_a_place_knows_nothing_odometry_stays():
    """A place of a corridor, known across and not along it, corrects across only."""
    covariance = PoseCovariance(4.0, 0.0, 0.0, 8e-5, 0.0, 1e-5)
    tour = Tour(covariance=covariance)
    tour.drive(200, Pose(0.5, 0.0, 0.0))
    estimate = tour.perception.robot_pose
    assert abs(estimate.y - tour.true.y) < 0.02
    # Not the half metre that the place is off along it.
    assert abs(estimate.x - tour.true.x) < 0.2
    assert tour.perception.localization.standard_deviations[0] > 0.05


def test_a_place_found_again_puts_the_robot_there_and_is_news_once():
    """The estimate jumps, and whoever plans is told."""
    tour = Tour()
    tour.drive(100)
    assert not tour.perception.pop_relocation()
    tour.drive(5, Pose(0.6, 0.3, 0.0), PlaceStatus.REGAINED)
    assert tour.error == pytest.approx(math.hypot(0.6, 0.3), abs=0.03)
    assert tour.perception.pop_relocation() and not tour.perception.pop_relocation()


def test_a_robot_that_was_found_again_is_not_put_back_by_a_push_before_that() -> None:
    """That it has met nothing is no news then."""
    tour = Tour()
    tour.drive(100)
    perception = tour.perception
    perception.on_tapped(Tap(perception.object_at_rest, 0.2, (0.2, 0.0), (0.0, 0.0), 0.01,
                             perception.localization.remember_robot()))
    tour.drive(5, Pose(0.6, 0.3, 0.0), PlaceStatus.REGAINED)
    there = perception.robot_pose
    perception.evaluate_push()
    assert perception.robot_pose == there


def test_a_robot_that_is_lost_stands_and_keeps_its_estimate():
    """Measurements cannot be used; no place is taken."""
    tour = Tour()
    tour.drive(100)
    before = tour.error
    tour.drive(5, Pose(5.0, 0.0, 0.0), PlaceStatus.LOST)
    assert tour.error < before + 0.02
    fault = tour.perception.measurement_fault(needs_object=False)
    assert fault is not None and fault.code is PushEvent.PLACE_LOST
    tour.drive(5)
    assert tour.perception.measurement_fault(needs_object=False) is None


def test_a_late_place_is_brought_to_the_present():
    """By the motion of odometry since; the heading's error counts for what was driven."""
    tracker = PlaceTracker()
    poses = [Pose(0.1 * index, 0.0, 0.1 * index) for index in range(11)]
    for index, pose in enumerate(poses):
        tracker.add_odometry(Odometry(0.1 * index, pose, Twist()), False)
    frame = Pose(2.0, 3.0, 1.0)
    place = RobotPlace(0.5, frame @ poses[5], PoseCovariance.from_deviations(0.01, 0.1))
    newest = Odometry(1.0, poses[10], Twist())
    present = tracker.at_present(place, newest)
    expected = frame @ poses[10]
    assert np.allclose(present.pose, expected)
    # 0.5 m ahead, half a centimetre of it for each hundredth of a radian.
    assert present.covariance.matrix[:2, :2].trace() == pytest.approx(2e-4 + 0.05 ** 2, rel=0.02)
    assert tracker.at_present(place, newest) is None
    assert tracker.at_present(place._replace(time=5.0), newest) is not None


def test_a_place_holds_while_the_robot_stands_and_some_way_on():
    """AMCL sends nothing to a robot that stands; what it drives back and forth counts as way."""
    for step, rotation, limit in ((0.02, 0.0, MAX_LENGTH / 0.02), (0.0, 0.02, MAX_TURN / 0.02)):
        tracker = PlaceTracker()
        for index in range(3000):
            tracker.add_odometry(Odometry(0.02 * index, START, Twist()), False)
        newest = Odometry(60.0, START, Twist())
        assert not tracker.is_placed
        tracker.at_present(RobotPlace(58.5, START, STATED), newest)
        for index in range(1, 3000):
            tracker.add_odometry(Odometry(60.0 + index, START, Twist()), False)
        assert tracker.is_placed
        held = 0
        while tracker.is_placed:
            held += 1
            there = Pose(step, 0.0, rotation) if held % 2 else START
            tracker.add_odometry(Odometry(4e3 + held, there, Twist()), False)
        assert held == pytest.approx(limit, abs=2)


def test_odometry_that_has_jumped_brings_no_place_to_the_present():
    """Its steps before the jump say nothing after it."""
    tracker = PlaceTracker()
    for index in range(5):
        tracker.add_odometry(Odometry(0.1 * index, START, Twist()), False)
    jumped = Odometry(0.5, Pose(3.0, 0.0, 0.0), Twist())
    tracker.add_odometry(jumped, True)
    assert tracker.at_present(RobotPlace(0.2, START, STATED), jumped) is None
