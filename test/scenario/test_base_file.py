"""What a controller learns of its base, the next one that is started knows: over DDS."""

import dataclasses
import functools

import numpy as np
from push_control.ros.base_memory import BaseMemory
from push_model.signals import Twist
from push_model.wheels import wheel_speeds
from push_ros.node_settings import ControllerOptions
from push_scenario.dds import parameter_files
from push_scenario.dds.replay import run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.result import Outcome
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]
# Below it wheels do not turn [m/s].
LEAST = 0.08
COMMAND = 'command_v_x', 'command_v_y', 'command_omega'


def slow_commands(result):
    """Count commands that ask a wheel for something, and for less than it can do."""
    tape, robot = result.tape, result.scenario.robot
    commands = np.column_stack([tape[name] for name in COMMAND])
    # The limit of the yaw rate may change wheels after all else.
    commands = commands[np.abs(commands[:, 2]) < robot.max_yaw_rate - 1e-6]
    speeds = np.abs([wheel_speeds(Twist(*command), robot.wheel_track)
                     for command in commands.tolist()])
    return int(((speeds > 1e-6) & (speeds < LEAST)).any(axis=1).sum())


def test_a_controller_that_is_started_again_drives_its_base_as_it_learned_to(
        tmp_path, monkeypatch):
    """The first run writes the file; the second one reads it, and never asks for too little."""
    path = tmp_path / 'base.yaml'
    monkeypatch.setattr(parameter_files, 'ControllerOptions',
                        functools.partial(ControllerOptions, base_file=str(path)))
    scenario = load_scenario('task_tap')
    scenario = dataclasses.replace(scenario, true_robot=dataclasses.replace(
        scenario.true_robot, min_speed=LEAST))
    first = run_over_dds(scenario, out_dir=tmp_path / 'first', record=False)
    known, fault = BaseMemory(path, scenario.robot).recall()
    assert fault == '' and known is not None and known.min_speed > 0.0
    second = run_over_dds(scenario, out_dir=tmp_path / 'second', record=False)
    assert first.outcome is second.outcome is Outcome.DONE
    assert slow_commands(first) > 0
    assert slow_commands(second) == 0
