"""A rehearsal compiles all that a push compiles, and changes nothing."""

import json
import subprocess
import sys

from push_control.settings import ControlSettings
from push_control.steered.rehearsal import rehearsal_plan
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.supervisor import Supervisor
from push_dynamics.compiled import IS_COMPILED
from push_model.contact import find_contact
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.settings import DriveSettings
import pytest

# Rehearses and runs a scenario; prints how many versions of each function of the controller
# machine code was made of, after either, and what a first map imports in between. Simulator and
# planner have kernels of their own.
PROGRAM = """
import contextlib, gc, json, sys
import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_control.task.repeated_pushes import RepeatedPushBehaviors
from push_control.task.single_push import SinglePushBehaviors
from push_dynamics.compiled import CompiledFunction
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.loop import simulate

def versions():
    return {f'{each.__module__}.{each.__name__}': len(each.dispatcher.overloads)
            for each in gc.get_objects()
            if type(each) is CompiledFunction and each.__module__.startswith('push_control')}

scenario = load_scenario(sys.argv[1])
factory = SinglePushBehaviors if scenario.task is None else RepeatedPushBehaviors
factory(scenario.object, scenario.robot, scenario.control, DriveSettings(),
        SupervisionSettings()).rehearse()
rehearsed, modules = versions(), set(sys.modules)
if scenario.task is not None:
    room = OccupancyMap(0.1, Pose(-3.0, -3.0, 0.0), np.eye(60, dtype=bool))
    with contextlib.suppress(NoPathFound):
        plan_path(scenario.robot, scenario.object, Pose(1.5, -1.5, 0.0), Pose(0.0, -2.0, 0.0),
                  Pose(0.0, 2.0, 0.0), DriveSettings(), occupancy_map=room)
imported = sorted(set(sys.modules) - modules)
result = simulate(scenario)
print(json.dumps([result.outcome.value, rehearsed, versions(), imported]))
"""
OBJECTS = ('bin', 'box_04', 'carton', 'coffee_table')


def read(name, robot):
    return (read_object(f'config/objects/{name}.yaml'), read_robot(f'config/robots/{robot}.yaml'))


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='nothing is compiled')
@pytest.mark.parametrize('scenario', ['corner_push_mismatch', 'holonomic_face', 'task_turn'])
def test_a_push_compiles_nothing_after_a_rehearsal(scenario):
    """Nor does a map that comes under way import anything: the robot would drive unattended."""
    output = subprocess.run([sys.executable, '-c', PROGRAM, scenario], check=True,
                            capture_output=True, text=True, timeout=600).stdout
    outcome, rehearsed, after, imported = json.loads(output)
    assert outcome == 'done' and imported == []
    assert sum(rehearsed.values()) > 0
    assert {name: count for name, count in after.items() if count > rehearsed.get(name, 0)} == {}


@pytest.mark.parametrize('robot', ['disc_017', 'holonomic_017', 'warehouse_035'])
@pytest.mark.parametrize('name', OBJECTS)
def test_the_plan_of_a_rehearsal_touches_the_object(name, robot):
    obj, robot = read(name, robot)
    plan = rehearsal_plan(obj, robot)
    for object_pose, robot_pose in zip(plan.object_poses, plan.robot_poses):
        contact = find_contact(obj, Pose(*object_pose), Pose(*robot_pose), robot.radius)
        assert contact.gap == pytest.approx(0.0, abs=1e-12)


def test_a_rehearsal_changes_no_command():
    obj, robot = read('box_04', 'disc_017')
    settings = ControlSettings(), DriveSettings(), SupervisionSettings()
    plan = rehearsal_plan(obj, robot)
    start, goal = (Pose(*plan.robot_poses[0]), Pose(*plan.object_poses[-1]))
    commands = []
    for rehearses in (False, True):
        supervisor = Supervisor(obj, robot, *settings, factory=SinglePushBehaviors)
        if rehearses:
            supervisor.rehearse()
        supervisor.set_goal(goal)
        for k in range(10):
            time = 0.05 * k
            if k == 3:
                supervisor.set_plan(plan)
            commands.append(supervisor.step(Observation(
                time, Odometry(time, start, STOP), ObjectPose(time, Pose(0.0, 0.0, 0.0))), 0.05))
    assert commands[:10] == commands[10:]
    assert commands[9] != STOP
