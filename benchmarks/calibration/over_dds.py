"""
The command ``push calibrate`` against drawn bases over DDS, as a new user runs it.

The simulator and the command are processes of their own, in lockstep. What the command writes is
compared with the truth, and then states the robot of a task over DDS.
"""

import dataclasses
import os
from pathlib import Path
import subprocess
import sys
from typing import NamedTuple

from benchmarks.calibration.bases import DrawnBase, OBJECT_POSE, ROBOT_POSE
from push_model.files.flat_values import to_parameter_values
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_ros.topics import SIM
from push_scenario.dds.private_network import private_domain, private_environment
from push_scenario.dds.processes import NodeProcesses
from push_scenario.dds.replay import MODULES, run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.result import Outcome
from push_sim_node.settings import SimulationSettings
import yaml

# Task that is done with the file, chosen: one that needs two pushes and a tap.
TASK = 'task_demo'
# Step of the simulated plant [s], as in one process.
STEP = 0.005
OBJECT = 'box_04'


class Calibrated(NamedTuple):
    """
    What came of one base.

    :param errors: of what the file of the robot states, by name.
    :param outcome: ``Outcome`` of the task with that file.
    :param duration: of the task [s].
    :param reason: why the command or the task has failed, else empty.
    """

    errors: dict[str, float]
    outcome: Outcome
    duration: float
    reason: str


def calibrate_over_dds(base: DrawnBase, seed: int, folder: Path) -> Calibrated:
    """
    Calibrate a base, and do a task with what was written.

    :param base: ``DrawnBase``.
    :param seed: of the noise.
    :param folder: for the files of all processes; it exists.
    :raises RuntimeError: where the command fails, with what it said.
    """
    robot = run_command(base, seed, folder)
    truth = base.robot
    least = max(truth.min_speed, base.imperfections.output_min_speed)
    errors = {'dead_time': robot.dead_time - truth.dead_time,
              'time_constant': robot.time_constant / truth.time_constant - 1.0,
              'least_speed': robot.min_speed - least}
    scenario = load_scenario(TASK)
    result = run_over_dds(dataclasses.replace(
        scenario, robot=robot, true_robot=truth,
        simulation=dataclasses.replace(scenario.simulation, drive=base.imperfections, seed=seed)),
        out_dir=folder, record=False)
    return Calibrated(errors, result.outcome, result.duration, result.reason)


def run_command(base: DrawnBase, seed: int, folder: Path) -> RoundRobot:
    """
    Start a simulated base and ``push calibrate``; read the file of the robot.

    :param base: ``DrawnBase``.
    :param seed: of the noise.
    :param folder: for the files of both; it exists.
    :raises RuntimeError: where the command fails, with what it said.
    """
    obj = read_object(OBJECT)
    simulator, user = folder / 'sim.yaml', folder / 'my.yaml'
    settings = SimulationSettings(step=STEP, seed=seed, drive=base.imperfections)
    _write(simulator, obj, base.robot, {
        **to_parameter_values(base.sensors, 'sensors.'),
        **to_parameter_values(settings, 'simulation.'), 'autostart': True,
        'object_start': _numbers(OBJECT_POSE), 'robot_start': _numbers(ROBOT_POSE)})
    _write(user, obj, base.nominal, {})
    with private_domain() as domain, NodeProcesses(domain, folder) as processes:
        processes.start(SIM, MODULES[SIM], simulator)
        command = subprocess.run(
            [sys.executable, '-m', 'push_scenario.calibration.cli', '--out', str(folder),
             '--ros-args', '--params-file', str(user)],
            env={**os.environ, **private_environment(domain)}, text=True, capture_output=True,
            check=False)
        if command.returncode:
            raise RuntimeError(f'calibrate: got exit status {command.returncode}, expected 0: '
                               f'{command.stderr}{processes.log_tail(SIM)}')
    return read_robot(folder / 'robot.yaml')


def _write(path: Path, obj: PushedObject, robot: RoundRobot, values: dict[str, object]) -> None:
    path.write_text(yaml.safe_dump({'/**': {'ros__parameters': {
        **to_parameter_values(obj, 'object.'), **to_parameter_values(robot, 'robot.'), **values,
        'lockstep': True}}}), encoding='utf-8')


def _numbers(pose: Pose) -> list[float]:
    return [float(value) for value in pose]
