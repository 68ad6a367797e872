"""Looks: where the object is expected first, then all around, with room for every motion."""

import math

from helpers.kinematic_view import half_angle, KinematicView, PERIOD
import numpy as np
from push_control.behaviors.behavior import Abort, BehaviorContext
from push_control.behaviors.look import (
    ADDED_MARGIN, LASTING_TIME, Look, LOOK_MARGIN, LookMargin, MAX_MARGIN, RetreatIntoView,
    ROUND_DISTANCE, ROUNDS)
from push_control.behaviors.look_motions import CAUTIOUS_SPEED, WAITING_TIME
from push_control.goal import TaskFailure
from push_control.perception.view import GAP_MARGIN
from push_control.settings import ControlSettings
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.signals import STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
import pytest

DRIVES = ['differential', 'holonomic']
NEAREST = 0.15
BOTH = {**half_angle(40.0), 'view_nearest': NEAREST}
OBJECT = Pose(0.0, 0.0, 0.0)


def context(room, occupancy_map=None):
    """Make what a behaviour acts upon."""
    return BehaviorContext(room.object, room.robot, ControlSettings(), DriveSettings(),
                           room.supervision, occupancy_map)


def look(room, occupancy_map=None):
    """Look until that has ended."""
    return room.run(Look(context(room, occupancy_map), LookMargin()))


@pytest.mark.parametrize('drive', DRIVES)
def test_a_robot_that_sees_the_object_stands(drive):
    """Until poses show it at rest."""
    room = KinematicView(Pose(-0.8, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
    assert look(room).result is None
    assert set(room.commands) == {STOP}
    assert room.time < WAITING_TIME


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('heading', [-2.5, 1.2, 3.0])
def test_the_robot_turns_the_short_way_to_where_the_object_was(drive, heading):
    """It was seen before."""
    room = KinematicView(Pose(-0.8, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
    room.stand(0.5)
    room.robot_pose = Pose(-0.8, 0.0, heading)
    room.stand(1.0)
    assert look(room).result is None and room.sees
    assert room.turned < abs(heading)
    assert all(command.omega * heading <= 0.0 for command in room.commands)


@pytest.mark.parametrize('drive', DRIVES)
def test_a_mirrored_look_is_the_mirror_image(drive):
    """All commands are, to rounding."""
    commands = []
    for side in (1.0, -1.0):
        room = KinematicView(Pose(-0.8, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
        room.stand(0.5)
        room.robot_pose = Pose(-0.8, 0.0, 1.5 * side)
        room.stand(1.0)
        look(room)
        commands.append(np.array(room.commands))
    assert commands[0] == pytest.approx(commands[1] * (1.0, -1.0, -1.0), abs=0.02)


@pytest.mark.parametrize('drive', DRIVES)
def test_a_robot_that_is_too_near_backs_off(drive):
    """Straight, to where it sees the object."""
    room = KinematicView(Pose(-0.6, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
    room.stand(0.5)
    room.robot_pose = Pose(-0.39, 0.0, 0.0)
    room.stand(1.0)
    assert room.gap < 0.05
    assert look(room).result is None
    assert NEAREST <= room.gap <= NEAREST + LOOK_MARGIN + 0.02
    assert abs(room.robot_pose.y) < 0.01


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('angle', [0.5, 2.0, -2.5, math.pi])
def test_an_object_that_was_never_seen_is_found_all_around(drive, angle):
    """By one turn."""
    place = Pose(math.cos(angle), math.sin(angle), 0.3)
    room = KinematicView(Pose(0.0, 0.0, 0.0), place, drive=drive, **half_angle(30.0))
    assert look(room).result is None and room.sees
    assert room.turned < 2.0 * math.pi
    assert room.commands[-1] == STOP


def test_an_object_that_was_carried_off_is_found():
    """It is not where the robot turns to first."""
    room = KinematicView(Pose(-1.0, 0.0, 0.0), OBJECT, **BOTH)
    room.stand(0.5)
    room.object_pose = Pose(-2.0, 0.2, 1.0)
    room.stand(1.0)
    assert look(room).result is None and room.sees
    room.stand(1.0)
    assert distance(room.perception.object_at_rest.pose, room.object_pose) < 0.001


def test_what_hides_nearby_is_found_from_farther_off():
    """In a later round, where the object is too near at first, and not known."""
    room = KinematicView(Pose(0.0, 0.0, 0.0), Pose(0.55, 0.0, 0.0), **half_angle(30.0),
                         view_nearest=0.5)
    assert look(room).result is None and room.sees
    assert room.turned > 2.0 * math.pi


def searched_nearby(drive, bearing):
    """Look for an object that is too near to be seen; return the room, and the gaps."""
    place = Pose(0.0, 0.0, bearing).transform((0.2 + 0.17 + 0.05, 0.0))
    room = KinematicView(Pose(0.0, 0.0, 0.0), Pose(*place, bearing), drive=drive,
                         **half_angle(30.0), view_nearest=NEAREST)
    assert look(room).result is None and room.sees
    return room, [find_contact(room.object, room.object_pose, pose[:2], room.robot.radius).gap
                  for pose in room.poses]


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('bearing', [0.0, 0.7])
def test_a_robot_backs_off_an_object_before_it_that_is_too_near_to_be_seen(drive, bearing):
    """As somebody has placed it, or as its last push has ended."""
    _, gaps = searched_nearby(drive, bearing)
    assert min(gaps) > 0.05 - 1e-3


@pytest.mark.parametrize('drive, bearing', [('differential', math.pi), ('holonomic', 2.4)])
def test_an_object_that_nobody_has_seen_is_met_as_slowly_as_it_is_touched(drive, bearing):
    """And left again: it is moved by no more than what it lacked to be seen."""
    room, gaps = searched_nearby(drive, bearing)
    speeds = [math.hypot(*command[:2]) for command in room.commands]
    touched = [speed for speed, gap in zip(speeds, gaps) if gap < 0.0]
    assert touched and max(touched) < CAUTIOUS_SPEED + 1e-9
    assert min(gaps) > -NEAREST - LOOK_MARGIN


@pytest.mark.parametrize('drive', DRIVES)
def test_an_object_that_is_nowhere_is_not_found(drive):
    """The robot turns in each of its rounds, and does not go far."""
    room = KinematicView(Pose(0.0, 0.0, 0.0), None, drive=drive, **half_angle(30.0))
    result = look(room).result
    assert isinstance(result, Abort) and result.failure is TaskFailure.OBJECT_NOT_SEEN
    assert room.turned > (ROUNDS + 1) * 2.0 * math.pi
    farthest = max(math.hypot(*pose[:2]) for pose in room.poses)
    assert farthest == pytest.approx(ROUNDS * ROUND_DISTANCE, abs=0.05)


def test_a_robot_that_sees_all_around_does_not_turn_to_look():
    """It drives to other places alone."""
    room = KinematicView(Pose(0.0, 0.0, 0.0), None, drive='holonomic', view_farthest=3.0)
    assert isinstance(look(room).result, Abort)
    assert room.turned < ROUNDS * math.pi


@pytest.mark.parametrize('drive', DRIVES)
def test_a_robot_that_misses_the_object_comes_no_nearer_to_obstacles(drive):
    """The object is not where it was seen: the robot may not be where it seems to be, either."""
    cells = np.ones((120, 120), dtype=bool)
    cells[50:70, 30:110] = False
    corridor = OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), cells)
    room = KinematicView(Pose(-0.8, 0.0, 0.0), OBJECT, drive=drive, **half_angle(30.0))
    room.stand(0.5)
    room.object_pose = None
    room.stand(1.0)
    start = float(corridor.clearance(np.array([room.robot_pose[:2]]))[0])
    assert isinstance(look(room, corridor).result, Abort)
    assert corridor.clearance(np.array(room.poses)[:, :2]).min() > start - 0.01
    assert room.turned > 2.0 * math.pi


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('half_width', [0.3, 0.5])
def test_a_search_keeps_clear_of_the_obstacles_of_a_map(drive, half_width):
    """In a corridor, and in a niche where nothing but turning is left."""
    cells = np.ones((120, 120), dtype=bool)
    free = math.floor(half_width / 0.05)
    cells[60 - free:60 + free, 60 - free:90] = False
    corridor = OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), cells)
    room = KinematicView(Pose(0.0, 0.0, 0.4), None, drive=drive, **half_angle(30.0))
    start = float(corridor.clearance(np.array([room.robot_pose[:2]]))[0])
    assert isinstance(look(room, corridor).result, Abort)
    clearances = corridor.clearance(np.array(room.poses)[:, :2]) - room.robot.radius
    least = min(DriveSettings().map_clearance, start - room.robot.radius)
    assert clearances.min() > least - 0.01
    assert room.turned > 2.0 * math.pi


@pytest.mark.parametrize('drive', DRIVES)
def test_a_robot_with_a_wall_behind_it_looks_from_elsewhere(drive):
    """The straight way off the object is blocked."""
    cells = np.zeros((120, 120), dtype=bool)
    cells[:, :47] = True
    walled = OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), cells)
    room = KinematicView(Pose(-0.6, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
    room.stand(0.5)
    room.robot_pose = Pose(-0.38, 0.0, 0.0)
    room.stand(1.0)
    assert look(room, walled).result is None and room.sees
    assert walled.clearance(np.array(room.poses)[:, :2]).min() > room.robot.radius


def test_a_pause_does_not_end_a_look():
    """The robot goes on from wherever it is."""
    room = KinematicView(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0), **half_angle(30.0))
    behavior = Look(context(room), LookMargin())
    for _ in range(20):
        room.time += PERIOD
        room.measure()
        behavior.step(room.perception, PERIOD)
        behavior.pause()
    assert room.run(behavior).result is None and room.sees


def test_looks_that_do_not_last_are_taken_from_farther_off():
    """Up to a limit; one that has lasted changes nothing."""
    margin = LookMargin()
    margin.start_look(0.0)
    assert margin.value == LOOK_MARGIN
    for index in range(1, 20):
        margin.end_look(10.0 * index)
        margin.start_look(10.0 * index + LASTING_TIME - 0.1)
        assert margin.value == pytest.approx(min(MAX_MARGIN, LOOK_MARGIN + index * ADDED_MARGIN))
    value = margin.value
    margin.end_look(1000.0)
    margin.start_look(1000.0 + LASTING_TIME)
    assert margin.value == value


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('view', [BOTH, half_angle(40.0), {'view_nearest': NEAREST}])
def test_a_retreat_ends_where_the_object_is_seen(drive, view):
    """A holonomic base turns to it on its way; one that sees it at once goes a short way."""
    room = KinematicView(Pose(-0.9, 0.0, 0.0), OBJECT, drive=drive, **view)
    room.stand(0.5)
    heading = 2.0 if drive == 'holonomic' else 0.0
    room.robot_pose = Pose(-0.375, 0.0, heading)
    room.stand(1.0)
    room.perception.restart_averaging(room.time)
    room.run(RetreatIntoView(context(room), 0.06, 0.4))
    assert room.sees
    assert 0.05 < room.gap < max(0.1, NEAREST + GAP_MARGIN) + 0.05


@pytest.mark.parametrize('drive', DRIVES)
def test_a_retreat_leads_off_where_the_object_is_expected(drive):
    """Not off where it was seen last: there the robot stands now."""
    room = KinematicView(Pose(-0.9, 0.0, 0.0), OBJECT, drive=drive, **BOTH)
    room.stand(0.5)
    # The robot has pushed the object on by its own diameter, and beyond.
    behind = room.object_pose
    room.object_pose = Pose(0.6, 0.0, 0.0)
    room.perception.localization.members.set_object_poses(
        np.tile(room.object_pose, (room.perception.localization.members.count, 1)))
    room.robot_pose = Pose(0.22, 0.0, 0.0)
    room.stand(1.5)
    assert room.perception.is_blind and distance(room.robot_pose, behind) < 0.3
    room.run(RetreatIntoView(context(room), 0.06, 0.4))
    assert room.gap > NEAREST
    assert all(isinstance(command, Twist) and command.v_x <= 0.0 for command in room.commands)
