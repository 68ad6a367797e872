"""Retreat: straight off the object, as far as drive and map allow."""

import math

from helpers.objects import box
import numpy as np
from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.retreat import NEARER, Retreat, retreat_path
from push_control.perception.raw_perception import RawPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import sample_path
from push_navigation.settings import DriveSettings
import pytest

DRIVE = DriveSettings()
DISTANCE = DRIVE.retreat_distance
# Gap at which a robot counts as clear of the object [m].
CLEAR_GAP = 0.02
ORIGIN = Pose(0.0, 0.0, 0.0)


def context(drive, occupancy_map=None):
    """Make what a behaviour acts upon."""
    return BehaviorContext(box(), RoundRobot(radius=0.17, drive=drive), ControlSettings(), DRIVE,
                           SupervisionSettings(), occupancy_map)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('heading', [-0.6, 0.0, 0.4])
def test_the_retreat_leads_off_the_object(drive, heading):
    """All along it the gap grows; the robot does not rotate."""
    given = context(drive)
    path = retreat_path(given, Pose(-0.37, 0.05, heading), ORIGIN, DISTANCE)
    gaps = [find_contact(given.obj, ORIGIN, pose[:2], given.robot.radius).gap
            for pose in sample_path(path, given.robot, 0.02)]
    assert all(np.diff(gaps) > 0.0)
    assert path.length == pytest.approx(DISTANCE)
    assert path.poses[-1].theta == heading


def test_there_is_no_retreat_along_the_object():
    """A differential drive that faces along a face would stay beside it."""
    along = Pose(-0.37, 0.0, 0.5 * math.pi)
    assert retreat_path(context('differential'), along, ORIGIN, DISTANCE) is None


@pytest.mark.parametrize('columns, ratio', [(0, 1.0), (26, 0.5), (28, None)])
def test_a_wall_behind_the_robot_shortens_the_retreat(columns, ratio):
    """To half of it, or to none."""
    occupied = np.zeros((80, 80), dtype=bool)
    occupied[:, :columns] = True
    walled = context('differential', OccupancyMap(0.05, Pose(-2.0, -2.0, 0.0), occupied))
    start = Pose(-0.37, 0.0, 0.0)
    path = retreat_path(walled, start, ORIGIN, DISTANCE)
    if ratio is None:
        assert path is None
    else:
        assert distance(path.poses[-1], start) == pytest.approx(ratio * DISTANCE)


def test_a_robot_beside_a_wall_backs_off_along_it():
    """It stands nearer to the wall than maps ask for, and comes hardly nearer."""
    occupied = np.zeros((80, 80), dtype=bool)
    occupied[44:, :] = True
    walled = context('holonomic', OccupancyMap(0.05, Pose(-2.0, -2.0, 0.0), occupied))
    clearance = 0.03
    start = Pose(-0.37, 0.2 - 0.17 - clearance, 0.0)
    assert clearance < DRIVE.map_clearance
    path = retreat_path(walled, start, ORIGIN, DISTANCE)
    assert path.length == pytest.approx(DISTANCE)
    assert path.poses[-1].y == pytest.approx(start.y, abs=1e-9)


@pytest.mark.parametrize('normal', [0.9, -0.9, 1.2])
@pytest.mark.parametrize('clearance', [0.02, 0.04, 0.06])
def test_a_holonomic_robot_with_a_wall_behind_it_leaves_aslant(
        clearance: float, normal: float) -> None:
    """It has no room to back off straight, and ends clear of the object all the same."""
    occupied = np.zeros((80, 80), dtype=bool)
    occupied[:, :30] = True
    walled = context('holonomic', OccupancyMap(0.05, Pose(-2.0, -2.0, 0.0), occupied))
    start = Pose(-0.5 + 0.17 + clearance, 0.0, 2.0)
    touched = Pose(start.x, start.y, normal) @ Pose(0.37, 0.0, 0.0)
    path = retreat_path(walled, start, touched, 0.06)
    assert path is not None
    gap = find_contact(walled.obj, touched, path.poses[-1][:2], walled.robot.radius).gap
    assert gap > CLEAR_GAP
    assert walled.occupancy_map is not None
    ends_clear = walled.occupancy_map.clearance([path.poses[-1][:2]])[0] - walled.robot.radius
    assert ends_clear >= min(clearance - NEARER, DRIVE.map_clearance) - 1e-9


def retreat_codes(course: list[tuple[float, bool]],
                  pause_at: int | None = None) -> list[BehaviorFailure | None]:
    """
    Retreat along x with a bumper, and return why the retreat fails at each step.

    :param course: x of the robot [m], and whether its bumper is pressed, at each step.
    :param pause_at: index of the step before which the retreat pauses.
    """
    retreat, perception = Retreat(context('holonomic'), DISTANCE), RawPerception(ControlSettings())
    codes = []
    for step, (x, is_pressed) in enumerate(course):
        perception.update(Observation(
            0.1 * step, Odometry(0.1 * step, Pose(x, 0.0, 0.0), STOP), ObjectPose(0.0, ORIGIN),
            is_bumper_pressed=is_pressed))
        if step == pause_at:
            retreat.pause()
        if perception.has_bumped:
            retreat.on_bumped(perception)
        retreat.step(perception, 0.1)
        codes.append(None if retreat.failure is None else retreat.failure.code)
    return codes


@pytest.mark.parametrize('course', [
    [(-0.37, True), (-0.375, False), (-0.38, True), (-0.385, False), (-0.42, False),
     (-0.44, True)],
    [(-0.37, False), (-0.38, True), (-0.385, True), (-0.41, True)]])
def test_a_bumper_that_closes_behind_the_object_ends_a_retreat(
        course: list[tuple[float, bool]]) -> None:
    """What it closes on right at the object counts once that is left: it may slide on."""
    codes = retreat_codes(course)
    assert codes == [None] * (len(course) - 1) + [BehaviorFailure.BUMPED]


def test_a_pause_forgets_what_the_bumper_has_closed_on() -> None:
    """The path after it is another one."""
    course = [(-0.37, False), (-0.38, True), (-0.385, True), (-0.42, True)]
    assert retreat_codes(course, pause_at=2) == [None] * 4
