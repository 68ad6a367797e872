"""Tasks whose object is not seen from everywhere: what a robot sees, and what it does blind."""

import dataclasses
import functools
import math

from helpers.objects import box
import numpy as np
from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.settings import DriveSettings
from push_planner.steered.task_push import plan_steered_push
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.camera import CameraSettings
from push_sim_node.disturbance import ObjectDisplacement
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings
import pytest

# Simulated tasks take some seconds each.
pytestmark = pytest.mark.slow

DRIVES = ['differential', 'holonomic']
RADIUS, NEAREST, HALF_ANGLE = 0.17, 0.15, math.radians(40.0)
# As the settings say it, of a lens above the robot's centre.
CAMERA = CameraSettings(place='robot', half_angle=HALF_ANGLE, nearest=RADIUS + NEAREST)
VIEW = SupervisionSettings(view_angle=HALF_ANGLE, view_nearest=NEAREST)


def scenario(drive, supervision=VIEW, camera=CAMERA, robot_heading=math.pi, seed=1):
    """Set a task: a box at the origin, and a robot that faces it or not."""
    robot = RoundRobot(radius=RADIUS, drive=drive, max_speed=0.3, max_yaw_rate=1.9,
                       max_acceleration=0.9)
    sensors = SensorSettings(
        pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08,
        pose_drop_probability=0.05, odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02,
        camera=camera)
    true = box(mass=2.4, friction=(0.2, 0.35, 0.3, 0.25), contact_friction_coefficient=0.4)
    return Scenario(
        name='look', description='a task', object=box(mass=3.0), true_object=true, robot=robot,
        true_robot=robot, start=Start(robot=Placement(1.2, 0.4, robot_heading)),
        goal=Placement(0.5, 0.3, 0.5), sensors=sensors, simulation=SimulationSettings(seed=seed),
        task=Task(supervision=supervision), time_limit=200.0)


@functools.lru_cache(maxsize=None)
def looked(drive, heading=math.pi):
    """Simulate the task, once."""
    return simulate(scenario(drive, robot_heading=heading))


def states(result):
    """List the states of a task."""
    return [change.state for change in result.history]


@pytest.mark.parametrize('drive', DRIVES)
def test_a_task_whose_pushes_nobody_sees_is_done(drive):
    """Within the tolerances of one that is always seen, and without a fault."""
    result = looked(drive)
    assert result.outcome is Outcome.DONE, result.reason
    assert result.position_error < VIEW.position_tolerance
    assert abs(result.heading_error) < VIEW.heading_tolerance
    assert result.recoveries == 0
    assert not [change.reason for change in result.history[1:] if change.reason]


@pytest.mark.parametrize('drive', DRIVES)
def test_each_retreat_ends_in_a_look_and_each_look_in_a_plan(drive):
    """And nothing is declared done but from what is seen at rest."""
    order = states(looked(drive))
    assert order.count(TaskState.LOOK) >= order.count(TaskState.PUSH) > 0
    for before, after in zip(order, order[1:]):
        assert (before is TaskState.RETREAT) <= (after is TaskState.LOOK)
        assert (before is TaskState.LOOK) <= (after is TaskState.PLAN)
        assert (after is TaskState.DONE) <= (before is TaskState.PLAN)


def test_a_task_begins_with_a_search_where_the_object_is_behind_the_robot():
    """It has not been seen at all then."""
    camera = dataclasses.replace(CAMERA, reference='robot')
    result = simulate(scenario('differential', camera=camera, robot_heading=0.3))
    assert states(result)[:3] == [TaskState.PLAN, TaskState.LOOK, TaskState.PLAN]
    assert TaskState.PUSH in states(result)


def test_a_task_ends_where_the_object_is_nowhere():
    """With a code of its own; the robot has turned and driven about."""
    camera = dataclasses.replace(CAMERA, farthest=0.3, reference='robot')
    result = simulate(scenario('differential', camera=camera))
    assert result.outcome is Outcome.FAILED
    assert result.status.failure is TaskFailure.OBJECT_NOT_SEEN
    assert result.status.recoveries == 0 and result.status.pushes == 0
    assert np.ptp(np.unwrap(result.tape['robot_theta'])) > 2.0 * math.pi


def test_an_object_that_is_carried_off_meanwhile_is_looked_for():
    """While the robot drives to where it was."""
    task = scenario('holonomic')
    plain = looked('holonomic')
    begin = next(c.time for c in plain.history if c.state is TaskState.APPROACH)
    moved = dataclasses.replace(task, simulation=dataclasses.replace(
        task.simulation, object_displacements=(ObjectDisplacement(begin + 0.5, -0.7, -0.6, 1.0),)))
    result = simulate(moved)
    assert result.outcome is Outcome.DONE, result.reason
    assert result.position_error < VIEW.position_tolerance


def test_a_steered_push_is_refused_by_name_where_the_view_is_limited():
    """It needs poses all along; a straight one does not."""
    task = scenario('differential')
    supervisor = Supervisor(task.object, task.robot, task.control, DriveSettings(), VIEW)
    supervisor.set_goal(Pose(1.0, 0.0, 0.0))
    measured = ObjectPose(0.0, Pose(0.0, 0.0, 0.0))
    for index in range(20):
        time = 0.05 * index
        supervisor.step(Observation(time, Odometry(time, Pose(-1.0, 0.0, 0.0), STOP),
                                    measured._replace(time=time)), 0.05)
    request = supervisor.plan_request
    assert request is not None
    supervisor.set_plan(plan_steered_push(request, task.robot, task.planner,
                                          DriveSettings()).trajectory)
    assert supervisor.state is TaskState.PLAN
    assert TaskEvent.PUSH_NEEDS_POSES in supervisor.status.codes


@pytest.mark.parametrize('name, value', [
    ('view_angle', 1.0), ('view_nearest', 0.1), ('view_farthest', 5.0)])
def test_a_single_push_refuses_a_limited_view_by_name(name, value):
    """It estimates by itself, from poses that come all along."""
    task = scenario('differential')
    with pytest.raises(ValueError, match=name):
        Supervisor(task.object, task.robot, task.control, DriveSettings(),
                   SupervisionSettings(**{name: value}), factory=SinglePushBehaviors)
