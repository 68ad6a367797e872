"""Members of an ensemble: poses, motion, and parameters of their own."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_control.perception.ensemble.members import (
    CONTACT_FRICTION_RANGE, FRICTION_SMOOTHING, identified_object, MAX_STEP, Members,
    ODOMETRY_ERRORS,
)
from push_dynamics import layout
from push_dynamics.walls import Wall
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest

COUNT = 7
# A drive that follows its commands at once.
ROBOT = RoundRobot(radius=0.17, drive='holonomic', max_speed=1.0, max_acceleration=50.0,
                   max_yaw_acceleration=500.0, time_constant=1e-3)
OBJECTS = {'box': box(center_of_mass=(0.03, -0.02)), 'bin': bin_()}
# Beside the middle of the face with the normal +x, in contact.
AT_FACE = Pose(-0.37, 0.05, 0.0)


def members_at(obj, robot_pose, object_pose=Pose(0.0, 0.0, 0.0), count=COUNT):
    """Return equal members at some poses."""
    members = Members(obj, ROBOT, count)
    members.set_robot_poses(np.tile(robot_pose, (count, 1)))
    members.set_object_poses(np.tile(object_pose, (count, 1)))
    return members


def push_ahead(members, distance=0.2, steps=20, duration=0.05):
    """Drive all robots straight ahead."""
    for _ in range(steps):
        members.move(np.tile((distance / steps, 0.0, 0.0), (members.count, 1)), duration)


def test_each_member_may_have_its_walls_elsewhere() -> None:
    """It moves as if all had them there."""
    wall, errors = Wall(0.25, -1.0, 0.25, 1.0), np.array([[0.02, 0.3], [-0.01, 0.0], [0.0, 0.0]])
    each = members_at(OBJECTS['box'], Pose(-0.40, 0.05, 0.1), Pose(0.0, 0.0, 0.1), 3)
    each.set_walls([wall], errors)
    push_ahead(each)
    for error, pose in zip(errors.tolist(), each.poses):
        alike = members_at(OBJECTS['box'], Pose(-0.40, 0.05, 0.1), Pose(0.0, 0.0, 0.1), 1)
        alike.set_walls([dataclasses.replace(wall, start_x=wall.start_x + error[0],
                                             end_x=wall.end_x + error[0])])
        push_ahead(alike)
        np.testing.assert_allclose(pose, alike.poses[0], atol=1e-6)
    assert each.object_poses[:, 0].max() > each.object_poses[:, 0].min() + 0.01


def test_a_wall_stops_objects_where_the_plant_does() -> None:
    """Members slide along it as their object would, and push as before once it is gone."""
    wall = Wall(0.25, -1.0, 0.25, 1.0)
    obj, turned = OBJECTS['box'], Pose(0.0, 0.0, 0.1)
    plant = Plant(obj, ROBOT, turned, Pose(-0.40, 0.05, 0.1), walls=(wall,))
    members = members_at(obj, Pose(-0.40, 0.05, 0.1), turned)
    members.set_walls([wall])
    for _ in range(40):
        plant.advance(0.05, Twist(0.06, 0.0, 0.0))
        step = members.mean_robot_pose.inverse() @ plant.robot_pose
        members.move(np.tile(step, (COUNT, 1)), 0.05)
    assert plant.object_pose.theta < 0.05, 'the wall has not turned the box'
    np.testing.assert_allclose(members.object_poses, np.tile(plant.object_pose, (COUNT, 1)),
                               atol=0.006)
    before = members.mean_object_pose.x
    members.set_walls(())
    push_ahead(members, 0.1)
    assert members.mean_object_pose.x > before + 0.08


@pytest.mark.parametrize('obj', OBJECTS.values(), ids=OBJECTS)
def test_poses_are_read_as_they_were_set(obj):
    """Poses of the object are those of its frame, wherever its mass centre is."""
    rng = np.random.default_rng(1)
    robots, objects = rng.uniform(-4.0, 4.0, (2, COUNT, 3))
    members = Members(obj, ROBOT, COUNT)
    members.set_robot_poses(robots)
    members.set_object_poses(objects)
    assert np.array_equal(members.robot_poses, robots)
    np.testing.assert_allclose(members.object_poses, objects, atol=1e-12)
    # Poses that were read stay as they were, and change nothing.
    before = members.object_poses
    with pytest.raises(ValueError, match='read-only'):
        before[:] = 9.0
    members.set_object_poses(objects + 1.0)
    np.testing.assert_allclose(before, objects, atol=1e-12)
    np.testing.assert_allclose(members.object_poses, objects + 1.0, atol=1e-12)


@pytest.mark.parametrize('duration', [0.003, 0.02, 0.5])
def test_a_robot_ends_at_its_increment(duration):
    """Straight, along arcs and on the spot; the object that nobody touches stays."""
    rng = np.random.default_rng(2)
    increments = rng.uniform(-1.0, 1.0, (COUNT, 3)) * duration * (0.3, 0.3, 1.9)
    increments[0], increments[1, 2], increments[2, :2] = 0.0, 0.0, 0.0
    starts = rng.uniform(-3.0, 3.0, (COUNT, 3)) + (20.0, 0.0, 0.0)
    members = members_at(OBJECTS['box'], Pose(0.0, 0.0, 0.0))
    members.set_robot_poses(starts)
    objects = members.object_poses
    assert members.move(increments, duration) == 0
    ends = [Pose(*start) @ Pose(*increment) for start, increment in zip(starts, increments)]
    difference = members.robot_poses - np.array(ends)
    np.testing.assert_allclose(np.sin(difference[:, 2]), 0.0, atol=1e-12)
    np.testing.assert_allclose(difference[:, :2], 0.0, atol=1e-10)
    assert np.array_equal(members.object_poses, objects)


@pytest.mark.parametrize('increment', [Pose(0.01, 0.0, 0.0), Pose(0.01, 0.002, 0.03)])
@pytest.mark.parametrize('obj', OBJECTS.values(), ids=OBJECTS)
def test_equal_members_move_as_the_plant_does(obj, increment):
    """The motion of all of them is that of one object and one robot in the simulator."""
    start = Pose(-0.37, 0.04, 0.1) if obj.outline else Pose(-0.37, 0.02, 0.1)
    members = members_at(obj, start)
    plant = Plant(obj, ROBOT, Pose(0.0, 0.0, 0.0), start, MAX_STEP, FRICTION_SMOOTHING)
    half = 0.5 * increment.theta
    chord = Pose(0.0, 0.0, -half).rotate(increment[:2])
    ratio = math.sin(half) / half if half else 1.0
    command = Twist(*(component / ratio / 0.05 for component in chord), increment.theta / 0.05)
    for _ in range(20):
        members.move(np.tile(increment, (COUNT, 1)), 0.05)
        plant.advance(0.05, command)
    assert members.in_contact.all()
    assert np.ptp(members.states, axis=0).max() == 0.0
    np.testing.assert_allclose(members.object_poses[0], plant.object_pose, atol=2e-3)
    assert np.hypot(*members.object_poses[0, :2]) > 0.1


def test_a_support_that_bears_more_friction_turns_the_object():
    """Heavy on the left it turns to the left, heavy on the right to the right as much."""
    members = members_at(box(), Pose(-0.37, 0.0, 0.0), count=3)
    # Supports in the order of the box: right, right, left, left of a push along x.
    for member, sign in ((1, 1.0), (2, -1.0)):
        members.parameters[member, ODOMETRY_ERRORS:-1] = np.array((-1, -1, 1, 1)) * 0.3 * sign
    members.apply_parameters()
    push_ahead(members)
    straight, left, right = members.object_poses
    assert abs(straight[2]) < 1e-6
    assert left[2] > 0.02
    np.testing.assert_allclose(left * (1.0, -1.0, -1.0), right, atol=1e-4)


def test_a_slippery_contact_slides():
    """Pushed aslant, the object follows the robot aside where friction holds it."""
    members = members_at(box(), Pose(-0.37, 0.0, 0.5), count=2)
    members.parameters[:, -1] = 0.8, 0.05
    members.apply_parameters()
    push_ahead(members)
    held, slid = members.object_poses
    assert held[1] > 0.04 and slid[1] < 0.5 * held[1]


def test_contact_friction_stays_within_its_range():
    """An update may lead beyond it."""
    members = members_at(box(), AT_FACE, count=2)
    members.parameters[:, -1] = -0.2, 9.0
    members.apply_parameters()
    assert members.parameters[:, -1].tolist() == list(CONTACT_FRICTION_RANGE)


def test_gaps_are_closed_where_there_was_contact():
    """A robot beside its object stays there; one in the object is moved out, either way."""
    members = members_at(box(), AT_FACE, count=3)
    push_ahead(members, distance=0.02, steps=2)
    assert members.in_contact.all()
    members.states[2, layout.NORMAL_FORCE] = 0.0
    apart = members.robot_poses + np.array([(-0.01, 0.0, 0.0), (0.01, 0.0, 0.0),
                                            (-0.01, 0.0, 0.0)])
    before = members.robot_poses
    members.set_robot_poses(apart)
    members.close_gaps()
    np.testing.assert_allclose(members.robot_poses[:2], before[:2], atol=2e-4)
    assert np.array_equal(members.robot_poses[2], apart[2])


@pytest.mark.parametrize('obj', OBJECTS.values(), ids=OBJECTS)
def test_without_parameters_the_identified_object_is_the_nominal_one(obj):
    """Neither friction nor anything else has changed; nor does one that is all over the same."""
    members = Members(obj, ROBOT, COUNT)
    identified = identified_object(obj, members.parameters)
    assert identified == obj
    members.parameters[:, ODOMETRY_ERRORS:-1] = 0.3
    identified = identified_object(obj, members.parameters)
    assert identified.capacities == pytest.approx(obj.capacities)


def test_the_identified_friction_keeps_its_sum():
    """Only how it is spread is identified, as that decides where slow pushes lead."""
    obj = OBJECTS['box']
    parameters = Members(obj, ROBOT, COUNT).parameters
    parameters[:, ODOMETRY_ERRORS:] = (0.4, -0.1, 0.0, 0.2, 0.35)
    identified = identified_object(obj, parameters)
    assert sum(identified.capacities) == pytest.approx(sum(obj.capacities))
    assert identified.contact_friction_coefficient == pytest.approx(0.35)
    assert friction_center(identified)[0] < friction_center(obj)[0]
