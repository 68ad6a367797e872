"""The robot follows its path on the simulated plant: it arrives, in time, within all limits."""

import dataclasses
import itertools
import math
from unittest.mock import patch

from helpers.objects import bin_, box
from helpers.paths import drive_along
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_navigation.path import differential_path, holonomic_path, Path
from push_navigation.path_follower import PathFollower
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_sim_node.simulation import Simulation
import pytest

# With as much reserve of the robots' acceleration as their lag takes for feedback.
SETTINGS = DriveSettings(yaw_rate=1.8, acceleration=0.6, yaw_acceleration=4.0)
GENTLE = DriveSettings(speed=0.3, yaw_rate=1.0, acceleration=0.3, yaw_acceleration=2.0)
FAR = Pose(50.0, 50.0, 0.0)
ROBOTS = {drive: RoundRobot(0.17, drive, 0.3, 1.9, 0.9, 6.0) for drive in ('differential',
                                                                           'holonomic')}
either = pytest.mark.parametrize('drive', ROBOTS)


class DrivenPath:
    """Record of a robot that follows a path."""

    def __init__(self, robot, path, obj=None, object_pose=FAR, start=None, patience=1.5,
                 true=None, noise=lambda: np.zeros(3), settings=SETTINGS):
        self.follower = PathFollower(robot, settings, path)
        self.expected = travel_time(path, robot, settings)
        sim = Simulation(obj or box(), true or robot, object_pose, start or path.poses[0])
        self.commands, self.gaps, self.times = [STOP], [], [0.0]
        while not self.follower.finished and sim.time < patience * self.expected + 3.0:
            seen = sim.next_measurement()
            if isinstance(seen, Odometry):
                pose = Pose(*(seen.pose + noise()))
                self.commands.append(self.follower.step(pose, sim.time - self.times[-1]))
                sim.command(self.commands[-1])
                self.times.append(sim.time)
                self.gaps.append(sim.truth.gap)
        self.time, self.end = sim.time, sim.plant.robot_pose
        self.object_moved = distance(sim.plant.object_pose, object_pose)

    def arrived(self, goal):
        """Tell whether the robot stands at the goal, within its tolerances."""
        return (self.follower.finished and self.commands[-1] == STOP
                and distance(self.end, goal) <= 0.003
                and abs(wrap_angle(self.end.theta - goal.theta)) <= math.radians(0.6))

    def within(self, limits):
        """Tell whether every command and every change of it keeps the limits."""
        commands, steps = np.array(self.commands), np.diff(self.times) + 1e-9
        changes = np.diff(commands, axis=0)
        return (np.hypot(commands[:, 0], commands[:, 1]).max() <= limits.speed + 1e-9
                and np.abs(commands[:, 2]).max() <= limits.yaw_rate + 1e-9
                and np.all(np.hypot(changes[:, 0], changes[:, 1]) <= limits.acceleration * steps)
                and np.all(np.abs(changes[:, 2]) <= limits.yaw_acceleration * steps))


def tasks(obj, count, seed):
    """Yield (object pose, start, goal) clear of the object."""
    rng = np.random.default_rng(seed)
    while count:
        object_pose = Pose(*rng.uniform(-0.5, 0.5, 2), rng.uniform(-4.0, 4.0))
        ends = [Pose(*rng.uniform(-1.2, 1.2, 2), rng.uniform(-4.0, 4.0)) for _ in range(2)]
        if all(find_contact(obj, object_pose, pose, 0.17).gap > SETTINGS.clearance
               for pose in ends):
            count -= 1
            yield (object_pose, *ends)


@either
@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_paths_round_the_object_are_followed(drive, obj):
    """It arrives when expected, within the limits, and never nearer than 10 mm less."""
    robot = ROBOTS[drive]
    for object_pose, start, goal in tasks(obj, 6, seed=1):
        path = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
        run = DrivenPath(robot, path, obj, object_pose)
        assert run.arrived(goal)
        assert run.within(SETTINGS.limited_to(robot))
        assert min(run.gaps) > SETTINGS.clearance - 0.01
        assert run.time == pytest.approx(run.expected, rel=0.05, abs=0.3)


@either
def test_it_comes_back_to_its_path(drive):
    """Started beside the path and rotated, it arrives all the same."""
    robot = ROBOTS[drive]
    path = plan_path(robot, box(), Pose(0.0, 0.0, 0.3), Pose(-1.0, 0.1, 0.5), Pose(1.0, 0.0, 2.0),
                     SETTINGS)
    for aside, heading_change in ((0.04, 0.2), (-0.05, -0.3), (0.0, 0.8), (0.08, 3.0)):
        start = Pose(-1.0, 0.1 + aside, 0.5 + heading_change)
        run = DrivenPath(robot, path, box(), Pose(0.0, 0.0, 0.3), start)
        assert run.arrived(path.poses[-1])
        assert run.within(SETTINGS.limited_to(robot))


@either
def test_leaving_the_contact_does_not_move_the_object(drive):
    """The robot touches the box at the start."""
    robot = ROBOTS[drive]
    start, goal = Pose(-0.37, 0.05, 0.25), Pose(0.2, -0.75, 1.5)
    path = plan_path(robot, box(), Pose(0.0, 0.0, 0.0), start, goal, SETTINGS)
    run = DrivenPath(robot, path, box(), Pose(0.0, 0.0, 0.0))
    assert run.arrived(goal)
    assert run.object_moved < 1e-4


@either
def test_other_robots_arrive_too(drive):
    """Fast, slow in answering, and without any lag."""
    for lag, top in ((0.0, 0.5), (0.3, 1.5), (0.15, 0.05)):
        robot = RoundRobot(0.35, drive, max_speed=top, time_constant=lag)
        goal = Pose(0.6, 0.4, -1.0)
        path = plan_path(robot, box(), Pose(-2.0, 0.0, 0.0), Pose(0.0, 0.0, 0.5), goal, SETTINGS)
        run = DrivenPath(robot, path)
        assert run.arrived(goal)
        assert run.within(SETTINGS.limited_to(robot))


def test_backwards_it_goes_straight():
    """A straight path back: no detour, no rotation worth naming."""
    robot, start = ROBOTS['differential'], Pose(0.0, 0.0, 0.7)
    goal = Pose(-0.4 * math.cos(0.7), -0.4 * math.sin(0.7), 0.7)
    run = DrivenPath(robot, Path((start, goal)))
    assert run.arrived(goal)
    assert np.array(run.commands)[:, 0].max() == 0.0
    assert np.abs(np.array(run.commands)[:, 2]).max() < 0.01


@either
def test_limits_hold_whatever_the_robot_sees(drive):
    """Poses that jump by a metre: every command stays within the limits."""
    robot, rng = ROBOTS[drive], np.random.default_rng(2)
    path = plan_path(robot, box(), FAR, Pose(0.0, 0.0, 0.0), Pose(1.0, 1.0, 2.0), SETTINGS)
    run = DrivenPath(robot, path, patience=0.0)
    for _ in range(400):
        step = rng.uniform(0.0, 0.1)
        run.commands.append(run.follower.step(Pose(*rng.uniform(-2.0, 2.0, 3)), step))
        run.times.append(run.times[-1] + step)
    assert run.within(SETTINGS.limited_to(robot))
    assert len(run.commands) > 400


@either
def test_limits_that_change_under_way_hold_from_then_on(drive):
    """It arrives, and the same limits once more change nothing."""
    robot, goal = ROBOTS[drive], Pose(1.0, 1.0, 2.0)
    slow = dataclasses.replace(robot, max_acceleration=0.25, max_yaw_acceleration=1.5)
    path = plan_path(robot, box(), FAR, Pose(0.0, 0.0, 0.0), goal, SETTINGS)
    for duration in (0.4, 1.5, 3.0):
        run = DrivenPath(robot, path, patience=0.0)
        follower, pose = PathFollower(robot, SETTINGS, path), path.poses[0]
        assert not follower.limit_to(robot)
        run.commands, run.times, count = [], [], 0
        sim = Simulation(box(), robot, FAR, pose)
        while not follower.finished and count < 3000:
            seen = sim.next_measurement()
            if not isinstance(seen, Odometry):
                continue
            count += 1
            if sim.time > duration and not run.commands:
                assert follower.limit_to(slow)
            command = follower.step(seen.pose, 0.02)
            if sim.time > duration:
                run.commands.append(command)
                run.times.append(0.02 * count)
            sim.command(command)
        run.follower, run.end = follower, sim.plant.robot_pose
        assert run.arrived(goal)
        assert run.within(SETTINGS.limited_to(slow))
        assert not follower.limit_to(slow)


@either
def test_remaining_distance_falls_to_nothing(drive):
    """From the length of the path to 0, hardly ever up."""
    robot = ROBOTS[drive]
    start, goal = Pose(-0.8, 0.0, 0.0), Pose(0.8, 0.0, 0.0)
    path = plan_path(robot, box(), Pose(0.0, 0.0, 0.0), start, goal, SETTINGS)
    sim = Simulation(box(), robot, Pose(0.0, 0.0, 0.0), start)
    follower = PathFollower(robot, SETTINGS, path)
    left, last = [follower.remaining_distance], 0.0
    assert left[0] == pytest.approx(path.length)
    while not follower.finished:
        seen = sim.next_measurement()
        if isinstance(seen, Odometry):
            sim.command(follower.step(seen.pose, sim.time - last))
            last = sim.time
            left.append(follower.remaining_distance)
    assert left[-1] == 0.0
    assert np.diff(left).max() < 0.005


@either
def test_a_lag_that_is_other_than_believed_costs_little(drive):
    """Half or twice as long: it arrives, in time if driven gently, and keeps the clearance."""
    for lag, settings in itertools.product((0.05, 0.2), (SETTINGS, GENTLE)):
        true = dataclasses.replace(ROBOTS[drive], time_constant=lag)
        for object_pose, start, goal in tasks(box(), 3, seed=9):
            path = plan_path(ROBOTS[drive], box(), object_pose, start, goal, settings)
            run = DrivenPath(ROBOTS[drive], path, box(), object_pose, true=true, settings=settings)
            assert run.arrived(goal)
            assert min(run.gaps) > 0.5 * settings.clearance
            assert run.time < run.expected + 3.0 or settings is SETTINGS


@either
def test_noise_in_what_it_sees_does_not_keep_it_from_arriving(drive):
    """Poses that are off by as much as the tolerance, standard deviation."""
    robot, rng = ROBOTS[drive], np.random.default_rng(10)
    for object_pose, start, goal in tasks(box(), 3, seed=11):
        path = plan_path(robot, box(), object_pose, start, goal, SETTINGS)
        run = DrivenPath(robot, path, box(), object_pose, noise=lambda: rng.normal(0.0, 0.002, 3))
        assert run.follower.finished
        assert distance(run.end, goal) < 0.008
        assert run.within(SETTINGS.limited_to(robot))


def test_a_finished_robot_that_is_moved_goes_back():
    """Finished is only while it is there."""
    robot, goal = ROBOTS['differential'], Pose(0.5, 0.0, 0.0)
    path = differential_path(Pose(0.0, 0.0, 0.0), goal, [(0.5, 0.0, 0.0)], [False])
    follower = DrivenPath(robot, path).follower
    assert follower.finished
    moved = Pose(0.45, 0.0, 0.0)
    follower.step(moved, 0.02)
    assert not follower.finished
    assert max(follower.step(moved, 0.1).v_x for _ in range(10)) > 0.0


def test_what_is_not_finite_is_refused_by_name():
    """Poses and times."""
    path = Path((Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)))
    follower = PathFollower(ROBOTS['differential'], SETTINGS, path)
    with pytest.raises(ValueError, match='pose: got'):
        follower.step(Pose(math.nan, 0.0, 0.0), 0.1)
    for wrong in (math.inf, -0.1):
        with pytest.raises(ValueError, match='dt: got'):
            follower.step(Pose(0.0, 0.0, 0.0), wrong)


def test_settings_are_limited_to_the_robot():
    """Each limit by its own; the rest stays."""
    robot = RoundRobot(0.1, max_speed=0.1, max_yaw_rate=0.2, max_acceleration=0.15,
                       max_yaw_acceleration=0.3)
    limited = SETTINGS.limited_to(robot)
    assert (limited.speed, limited.yaw_rate) == (0.1, 0.2)
    assert (limited.acceleration, limited.yaw_acceleration) == (0.15, 0.3)
    assert dataclasses.replace(
        limited, **{name: getattr(SETTINGS, name) for name in (
            'speed', 'yaw_rate', 'acceleration', 'yaw_acceleration')}) == SETTINGS


@either
@pytest.mark.parametrize('heading_change', [0.02, -0.08])
def test_a_robot_that_is_nearly_there_rotates_to_its_heading(drive, heading_change):
    """Less than a millimetre beside its place it does not drive there, but it does rotate."""
    start, goal = Pose(0.0, 0.0, 3.1), Pose(2e-4, -1e-4, 3.1 + heading_change)
    path = plan_path(ROBOTS[drive], box(), FAR, start, goal, SETTINGS)
    assert DrivenPath(ROBOTS[drive], path).arrived(goal)


@pytest.mark.parametrize('lag', [0.0, 0.1])
@either
def test_it_passes_the_end_of_a_path_on_the_line(drive, lag):
    """At full speed behind an arc: within 5 mm and 1 degree across, at the speed asked for."""
    robot = dataclasses.replace(ROBOTS[drive], time_constant=lag)
    goal = Pose(1.6, 0.3, 0.5 * math.pi)
    waypoints = [(1.3, 0.0, 0.0), (1.5, 0.2, 0.5 * math.pi), (1.5, 0.3, 0.0)]
    if drive == 'holonomic':
        path = holonomic_path(Pose(0.0, 0.0, 0.0), goal._replace(x=1.5, theta=0.0), waypoints)
    else:
        path = differential_path(Pose(0.0, 0.0, 0.0), goal._replace(x=1.5), waypoints, [False] * 3)
    for speed in (0.1, 0.3):
        run = drive_along(path, robot, SETTINGS, speed)
        assert run.follower.finished and not run.follower.missed
        assert abs(run.aside) < 0.005 and abs(run.turned) < math.radians(1.0)
        last = np.diff(run.poses[-3:, :2], axis=0) / 0.02
        assert np.hypot(*last.T) == pytest.approx(speed, abs=0.03)
        assert run.time == pytest.approx(travel_time(path, robot, SETTINGS, end_speed=speed),
                                         abs=0.2)


def test_it_hands_over_before_the_end():
    """By the distance asked for, and sooner."""
    robot, path = ROBOTS['differential'], Path((Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)))
    ends = [drive_along(path, robot, SETTINGS, 0.2, handover_distance=distance).poses[-1][0]
            for distance in (0.0, 0.05)]
    assert ends == pytest.approx([1.0, 0.95], abs=0.008)


def test_an_end_that_is_passed_beside_the_path_is_missed():
    """It stops, and never has finished."""
    robot, path = ROBOTS['differential'], Path((Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)))
    follower = PathFollower(robot, SETTINGS, path, end_speed=0.3)
    follower.step(Pose(0.0, 0.0, 0.0), 0.0)
    commands = [follower.step(Pose(x, 0.015, 0.0), 0.02) for x in np.arange(0.0, 1.5, 0.006)]
    assert follower.missed and not follower.finished
    assert commands[-1] == STOP and max(command.v_x for command in commands) > 0.2


def test_it_takes_over_the_motion_that_the_robot_has():
    """Its first command differs from the motion by no more than the limits allow."""
    robot, path = ROBOTS['differential'], Path((Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0)))
    motion = Twist(-0.2, 0.0, 0.0)
    follower = PathFollower(robot, SETTINGS, path, end_speed=0.2, motion=motion)
    command = follower.step(Pose(0.0, 0.0, 0.0), 0.02)
    assert -0.2 - 0.02 * SETTINGS.acceleration <= command.v_x < -0.2
    assert travel_time(path, robot, SETTINGS, start_speed=0.2) < travel_time(
        path, robot, SETTINGS) < travel_time(path, robot, SETTINGS, start_speed=-0.2)
    for name in ('end_speed', 'handover_distance'):
        with pytest.raises(ValueError, match=f'{name}: got'):
            PathFollower(robot, SETTINGS, path, **{name: -0.1})


@either
def test_a_prediction_that_goes_missing_under_way_changes_nothing(drive):
    """A follower that got its own prediction from outside goes on as one without."""
    robot = ROBOTS[drive]
    start, goal = Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)
    waypoints = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]
    path = (differential_path(start, goal, waypoints, [False]) if drive == 'differential'
            else holonomic_path(start, goal, waypoints))
    alone, told = (PathFollower(robot, SETTINGS, path) for _ in range(2))
    with patch.object(alone, '_predict', wraps=alone._predict) as predict:
        lagged = []
        predict.side_effect = lambda *args: lagged.append(
            PathFollower._predict(alone, *args)) or lagged[-1]
        pose, commands = Pose(0.0, 0.0, 0.0), []
        for k in range(100):
            command = alone.step(pose, 0.02)
            commands.append((command, told.step(pose, 0.02, lagged[-1] if k < 50 else None)))
            pose = Pose(pose.x + 0.02 * command.v_x, 0.001, 0.0)
    assert any(command != STOP for command, _ in commands)
    assert all(command == other for command, other in commands)
