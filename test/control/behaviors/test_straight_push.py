"""Straight pushes: their line, the approach to it, and the push itself on the simulated plant."""

import dataclasses
import math
from typing import NamedTuple

from helpers.objects import box
from helpers.straight_pushes import straight_push
import numpy as np
from push_control.behaviors.behavior import Behavior
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.progress import ProgressMonitor
from push_control.behaviors.push_progress import MISS_DISTANCE, MISS_SIGMAS
from push_control.behaviors.straight_push import ending_speed, pushing_speed, touch_speed
from push_control.goal import TaskGoal
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.steered.status import Phase
from push_control.supervision_settings import SupervisionSettings
from push_control.task import repeated_pushes
from push_control.task.repeated_pushes import RepeatedPushBehaviors
from push_control.task.status import TaskState
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_primitives.store import load_primitives
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

# The cost-to-go of the box takes some seconds where it is not in the store.
pytestmark = pytest.mark.slow

CONTROL, SUPERVISION, DRIVE = ControlSettings(), SupervisionSettings(), DriveSettings()
PROGRESS = ProgressMonitor(SUPERVISION, (0.01, 0.02))
ROBOTS = {drive: RoundRobot(radius=0.17, drive=drive, max_speed=0.3, max_yaw_rate=1.9,
                            max_acceleration=0.9) for drive in ('differential', 'holonomic')}
HOME, WORLD = Pose(0.0, 0.0, 0.0), Pose(1.0, -2.0, 2.5)
# Beside the middle of the face behind, and near its end with the tilt into the turn.
MIDDLE, END = Pose(-0.37, 0.05, 0.0), Pose(-0.37, 0.15, -0.3)
# Time that robot and object are seen at rest before anything happens [s].
REST = 0.5


class Course(NamedTuple):
    """What happened: the behaviour at its end, what was known, and what is true."""

    behavior: Behavior
    perception: TaskPerception
    simulation: Simulation
    commands: list
    first_deviation: float


def act(target, robot_pose, state=TaskState.PUSH, drive='differential', error=HOME,
        object_pose=HOME, on_step=None, max_time=20.0, goal=None, occupancy_map=None,
        intervene=None):
    """
    Let the behaviour of a state act on the plant until it ends.

    :param error: ``Pose`` of the true robot where it is believed to be at its origin.
    :param on_step: called with the behaviour and the time since it began.
    :param goal: of the task; None for the end of the target.
    :param intervene: called likewise, with the simulation.
    """
    robot = ROBOTS[drive]
    goal = goal or Pose(*target.object_poses[-1].tolist())
    simulation = Simulation(box(), robot, object_pose, robot_pose @ error,
                            SimulationSettings(seed=1))
    shift = robot_pose @ (robot_pose @ error).inverse()
    perception = TaskPerception(box(), robot, CONTROL, SUPERVISION)
    behaviors = RepeatedPushBehaviors(box(), robot, CONTROL, DRIVE, SUPERVISION)
    behaviors.occupancy_map = occupancy_map
    behavior, pose, time, commands, deviation = None, None, 0.0, [], 0.0
    while simulation.time < max_time:
        measured = simulation.next_measurement()
        if not isinstance(measured, Odometry):
            pose = measured
            continue
        odometry = measured._replace(pose=shift @ measured.pose)
        perception.update(Observation(simulation.time, odometry, pose))
        if simulation.time < REST:
            continue
        if behavior is None:
            behavior = behaviors.create(state, target, TaskGoal(goal), perception, PROGRESS)
            deviation = perception.localization.position_deviation
        if on_step is not None:
            on_step(behavior, simulation.time - REST)
        if intervene is not None:
            intervene(simulation, simulation.time - REST)
        commands.append(behavior.step(perception, simulation.time - time))
        time = simulation.time
        simulation.command(commands[-1])
        if behavior.finished or behavior.failure:
            break
    return Course(behavior, perception, simulation, commands, deviation)


def backed_off(start, distance=0.05, aside=0.0, world=HOME):
    """Stand before the contact, on the line of the push or beside it."""
    return world @ start @ Pose(-distance, aside, 0.0)


def goal_error(target, course):
    """Return distance and angle between the object and where the plan ends."""
    goal = Pose(*target.object_poses[-1].tolist())
    error = goal.inverse() @ course.simulation.truth.object_pose
    return math.hypot(error.x, error.y), abs(wrap_angle(error.theta))


def test_short_pushes_are_slow():
    """Down to a crawl, and never faster than the plan."""
    target = straight_push(box(), MIDDLE, 0.3, speed=0.15)
    speeds = [ending_speed(pushing_speed(target), left)
              for left in (0.0, 0.01, 0.03, 0.06, 0.1, 1.0)]
    assert speeds == sorted(speeds) and 0.02 < speeds[0] < 0.05
    assert speeds[-1] == pytest.approx(0.15, rel=0.01)


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('start, length, world', [
    (MIDDLE, 0.1, HOME), (MIDDLE, 0.1, WORLD), (MIDDLE, 0.03, HOME), (END, 0.1, HOME),
    (MIDDLE, 0.4, HOME)])
def test_a_push_ends_at_its_goal(drive, start, length, world):
    """Within the tolerances of a task, from five centimetres before the contact."""
    target = straight_push(box(), start, length, object_pose=world)
    course = act(target, backed_off(start, world=world), drive=drive, object_pose=world)
    assert course.behavior.finished and course.behavior.failure is None
    position, heading = goal_error(target, course)
    assert position < SUPERVISION.position_tolerance
    assert heading < SUPERVISION.heading_tolerance
    status = course.behavior.push_status
    assert status.phase is Phase.DONE and status.in_contact
    assert status.travelled_distance == pytest.approx(length, abs=0.02)


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_push_that_would_go_further_than_planned_ends_before_an_obstacle(drive):
    """Where the goal lies behind it; on open floor it does go further."""
    target, wall = straight_push(box(), MIDDLE, 0.1), 0.36
    cells = np.zeros((100, 100), dtype=bool)
    # A wall across the way from there on.
    cells[:, round((wall + 1.0) / 0.02):] = True
    fronts = []
    for floor in (None, OccupancyMap(0.02, Pose(-1.0, -1.0, 0.0), cells)):
        course = act(target, backed_off(MIDDLE), drive=drive, goal=Pose(0.6, 0.0, 0.0),
                     occupancy_map=floor)
        assert course.behavior.finished
        pose = course.simulation.truth.object_pose
        fronts.append(max(pose.transform(vertex)[0] for vertex in box().outline))
    assert fronts[0] > wall + 0.05
    assert 0.25 < fronts[1] < wall


def test_a_push_ends_before_somebody_has_brought_its_object_to_a_wall() -> None:
    """By what object and robot do, not by what the plan and its rollouts expect of them."""
    target, wall = straight_push(box(), MIDDLE, 0.4), 0.45
    cells = np.zeros((100, 100), dtype=bool)
    # A wall beside the way.
    cells[round((wall + 1.0) / 0.02):] = True

    def carry(simulation: Simulation, time: float) -> None:
        if time > 0.9:
            pose = simulation.truth.object_pose
            simulation.plant.set_object_pose(Pose(pose.x + 0.006, pose.y + 0.006, pose.theta))
    course = act(target, backed_off(MIDDLE), intervene=carry,
                 occupancy_map=OccupancyMap(0.02, Pose(-1.0, -1.0, 0.0), cells))
    assert course.behavior.finished
    pose = course.simulation.truth.object_pose
    assert max(pose.transform(vertex)[1] for vertex in box().outline) < wall


@pytest.mark.parametrize('drive', ROBOTS)
def test_the_touch_is_slow_until_the_object_is_seen_to_move(drive):
    """It may be a wall; then the push is faster."""
    target = straight_push(box(), MIDDLE, 0.3, speed=0.1)
    twists = target.robot_twists.copy()
    twists[1:] *= 2.5
    target = dataclasses.replace(target, robot_twists=twists)
    contacts = []
    course = act(target, backed_off(MIDDLE), drive=drive,
                 on_step=lambda behavior, _: contacts.append(behavior.push_status.in_contact))
    speeds = [math.hypot(command.v_x, command.v_y) for command in course.commands]
    first = contacts.index(True) - 1
    # No pose of an object that moves has come yet.
    assert max(speeds[first:first + 4]) < 1.1 * touch_speed(target)
    assert max(speeds[first:]) > 0.9 * pushing_speed(target)


def test_the_object_at_its_goal_is_at_rest_when_the_push_ends():
    """It moves on by what the slowest motion that counts as rest takes to fade."""
    target = straight_push(box(), MIDDLE, 0.1)
    course = act(target, backed_off(MIDDLE))
    before = course.simulation.truth.object_pose
    assert course.commands[-1] == STOP
    for _ in range(40):
        course.simulation.next_measurement()
    assert math.dist(before[:2], course.simulation.truth.object_pose[:2]) < 2e-3


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_robot_beside_the_line_returns_to_it(drive):
    """By a centimetre and a degree, on the last decimetre before the contact."""
    target = straight_push(box(), MIDDLE, 0.1)
    robot = backed_off(MIDDLE, 0.12, aside=0.01) @ Pose(0.0, 0.0, 0.02)
    course = act(target, robot, drive=drive)
    position, heading = goal_error(target, course)
    assert position < SUPERVISION.position_tolerance
    assert heading < SUPERVISION.heading_tolerance


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_robot_that_is_not_at_the_object_gives_up(drive):
    """It says why, soon, and knows less about where it is; the object is not touched."""
    target = straight_push(box(), MIDDLE, 0.1)
    course = act(target, backed_off(MIDDLE), drive=drive, error=Pose(0.0, 0.6, 0.0))
    assert not course.behavior.finished
    assert course.behavior.failure.code in (
        BehaviorFailure.OBJECT_NOT_FOUND, BehaviorFailure.OBJECT_NOT_MOVED)
    assert course.commands[-1] == STOP
    assert course.behavior.push_status.phase is Phase.FAILED
    localization = course.perception.localization
    assert localization.position_deviation > course.first_deviation + 0.02
    travelled = math.dist(course.simulation.truth.robot_pose[:2],
                          (backed_off(MIDDLE) @ Pose(0.0, 0.6, 0.0))[:2])
    assert travelled < 0.05 + 2.0 * (MISS_DISTANCE + MISS_SIGMAS * course.first_deviation) + 0.02
    assert course.simulation.truth.object_pose == HOME


def test_a_robot_that_touches_before_it_should_does_not_push_on():
    """It says so after some centimetres, and knows less about where it is."""
    target = straight_push(box(), MIDDLE, 0.1)
    course = act(target, backed_off(MIDDLE, 0.4), error=Pose(0.2, 0.0, 0.0))
    assert course.behavior.failure.code is BehaviorFailure.TOUCHED_EARLY
    assert course.commands[-1] == STOP
    assert 0.04 < course.simulation.truth.object_pose.x < 0.12
    localization = course.perception.localization
    assert localization.position_deviation > course.first_deviation + 0.02


@pytest.mark.parametrize('moment', [0.1, 1.4])
def test_a_pause_ends_the_push(moment):
    """Before the contact or in it, the robot stands from then on."""
    target = straight_push(box(), MIDDLE, 0.4)
    paused = []

    def pause(behavior, time):
        if time >= moment and not paused:
            behavior.pause()
            paused.append(time)

    course = act(target, backed_off(MIDDLE), on_step=pause)
    assert course.behavior.finished and course.behavior.failure is None
    steps = len(course.commands)
    assert course.simulation.time - REST - moment < 1.0
    moving = [k for k in range(steps) if course.commands[k] != STOP]
    assert moving and moving[-1] < steps - 1
    assert goal_error(target, course)[0] > 0.1


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('robot', [Pose(-1.0, 0.3, 1.0), Pose(1.0, 0.3, 1.0),
                                   Pose(0.2, -0.8, 3.0)])
def test_the_approach_hands_over_moving_on_the_line(drive, robot):
    """Within a centimetre of it, before the contact, at the speed of the touch or a bit more."""
    target = straight_push(box(), MIDDLE, 0.1)
    course = act(target, robot, TaskState.APPROACH, drive)
    assert course.behavior.finished and course.behavior.failure is None
    truth, line = course.simulation.truth, target.straight_line().start
    ahead, aside = line.inverse().transform(truth.robot_pose[:2])
    assert abs(aside) < 0.01
    assert -0.1 < ahead < 0.0
    assert find_contact(box(), HOME, truth.robot_pose[:2], 0.17).gap > 0.0
    velocity = truth.robot_pose.rotate(truth.robot_twist[:2])
    expected = touch_speed(target)
    assert 0.7 * expected < math.hypot(*velocity) <= ROBOTS[drive].max_speed + 1e-9
    direction = math.atan2(velocity[1], velocity[0])
    assert abs(wrap_angle(direction - line.theta)) < 0.1
    if drive == 'differential':
        assert abs(wrap_angle(truth.robot_pose.theta - line.theta)) < 0.05


def test_settings_that_change_during_an_approach_wait_for_the_next_one(monkeypatch):
    """Making the cost-to-go anew takes seconds, in which a moving robot would hear of nothing."""
    robot, target, loaded = ROBOTS['differential'], straight_push(box(), MIDDLE, 0.3), []
    known = load_primitives(box(), robot)

    def load(obj, robot, settings, belief):
        loaded.append(settings.robot_speed)
        return known
    monkeypatch.setattr(repeated_pushes, 'load_primitives', load)
    perception = TaskPerception(box(), robot, CONTROL, SUPERVISION)
    perception.update(Observation(0.0, Odometry(0.0, backed_off(MIDDLE, 0.3), STOP),
                                  ObjectPose(0.0, HOME)))
    goal = Pose(*target.object_poses[-1].tolist())
    behaviors = RepeatedPushBehaviors(box(), robot, CONTROL, DRIVE, SUPERVISION)
    behaviors.create(TaskState.APPROACH, target, TaskGoal(goal), perception, PROGRESS)
    behaviors.set_settings(CONTROL, dataclasses.replace(DRIVE, speed=0.2), SUPERVISION)
    behaviors.create(TaskState.PUSH, target, TaskGoal(goal), perception, PROGRESS)
    assert loaded == [robot.max_speed]
    behaviors.create(TaskState.APPROACH, target, TaskGoal(goal), perception, PROGRESS)
    assert loaded == [robot.max_speed, 0.2]


def test_a_push_starts_in_the_direction_from_where_the_bumper_has_put_the_robot() -> None:
    """The touch turns a robot, too, whose place along the normal has drifted with its heading."""
    target, robot = straight_push(box(), MIDDLE, 0.3), ROBOTS['holonomic']
    perception = TaskPerception(box(), robot, CONTROL, SUPERVISION)
    behaviors = RepeatedPushBehaviors(box(), robot, CONTROL, DRIVE, SUPERVISION)
    aside = [Pose(-1.0, -1.5 + 0.03 * k, 0.0) for k in range(52)]
    ahead = [Pose(-1.0 + 0.03 * k, MIDDLE.y, 0.0) for k in range(21)]
    for step, pose in enumerate([*aside, *ahead]):
        time = 0.1 * step
        speed = Twist(0.0, 0.3, 0.0) if step < len(aside) else Twist(0.3, 0.0, 0.0)
        perception.update(Observation(time, Odometry(time, pose, speed), ObjectPose(time, HOME),
                                      is_bumper_pressed=step == len(aside) + len(ahead) - 1))
    localization = perception.localization
    before = localization.pose
    goal = TaskGoal(Pose(*target.object_poses[-1].tolist()))
    push = behaviors.create(TaskState.PUSH, target, goal, perception, PROGRESS)
    command = push.step(perception, 0.1)
    after = localization.pose
    line = localization.object_pose @ target.straight_line().start
    assert abs(wrap_angle(after.theta - before.theta)) > 1e-4
    assert math.atan2(command.v_y, command.v_x) == pytest.approx(
        wrap_angle(line.theta - after.theta), abs=1e-9)
