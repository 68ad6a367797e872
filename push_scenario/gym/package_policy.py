"""Planner and controller of the package as a policy: what a learned one is compared with."""

from typing import Any

import numpy as np
from push_model.observation import Observation
from push_scenario.definition.scenario import Scenario
from push_scenario.gym.push_task import Vector
from push_scenario.simulation.loop import make_safety_layer
from push_scenario.simulation.robot_control import make_robot_control


class PackagePolicy:
    """
    Answers the measurements in ``info`` with an action, one episode long.

    It knows the nominal parameters of object and robot, and sees what the sensors measure.

    :param scenario: ``PushTask.scenario`` after ``reset``.
    :param info: of ``reset``.
    """

    def __init__(self, scenario: Scenario, info: dict[str, Any]) -> None:
        first: Observation = info['observation']
        self._robot = make_robot_control(scenario, first, planning_time=0.0)
        self._safety = make_safety_layer(scenario)
        self._is_differential = scenario.robot.drive == 'differential'
        self._time = first.time

    def action(self, info: dict[str, Any]) -> Vector:
        """
        Choose the velocity that answers the newest measurements.

        :param info: of ``reset`` or of the last ``step``.
        :return: action as of ``PushTask``.
        """
        observation: Observation = info['observation']
        dt, self._time = observation.time - self._time, observation.time
        twist = self._safety.guard(observation, self._robot,
                                   lambda checked: self._robot.step(checked, dt))
        self._robot.update_plan(observation)
        values = (twist.v_x, twist.omega) if self._is_differential else twist
        return np.array(values, np.float32)
