"""Planner, controller and plant in one process, without ROS."""

import dataclasses
import math
from typing import NamedTuple

from push_control.controller import make_controller
from push_control.observation import Observation
from push_model.geometry import distance
from push_model.signals import Odometry
from push_planner.problem import PlanningFailed
from push_planner.under_way import plan_measured
from push_scenario.replanning import Replanner
from push_scenario.result import Result
from push_scenario.tape import Tape
from push_sim_node.simulation import Simulation

REST_SPEED = 1e-4
REST_YAW_RATE = 1e-3
SETTLE_TIME = 2.0


class Progress(NamedTuple):
    """
    How far a run has come.

    :param stage: ``planning``, ``pushing``, ``settling`` or ``ended``.
    :param time: simulated time [s].
    :param distance: from the object to its goal [m].
    """

    stage: str
    time: float
    distance: float


def run(scenario, control_law=None, progress=None):
    """
    Plan and push.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``; None for what the scenario says.
    :param progress: called with a ``Progress`` at every measurement; None for nobody.
    :return: the ``Result``.
    """
    settings = control_settings(scenario, control_law)
    report = progress or _ignore
    goal = scenario.goal.pose
    simulation = make_simulation(scenario)
    pose, odometry = simulation.next(), simulation.next()
    report(Progress('planning', 0.0, distance(pose.pose, goal)))
    try:
        answer = plan_measured(scenario.object, scenario.robot, pose, odometry, goal,
                               scenario.planner).plan
    except PlanningFailed as failure:
        return Result(scenario, settings.control_law, 'refused', failure.reason)
    controller = make_controller(scenario.object, scenario.robot, settings)
    observation = Observation(simulation.time, odometry, pose)
    loop = _Loop(simulation, controller, answer.trajectory, observation, goal,
                 Replanner(scenario), report)
    outcome, reason, end_time = loop.push(scenario.time_limit)
    loop.settle()
    return Result(scenario, settings.control_law, outcome, reason, answer.trajectory,
                  Tape(simulation.columns, simulation.tape), end_time)


def control_settings(scenario, control_law=None):
    """
    Look up the controller's settings, under another law if one is named.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``; None for what the scenario says.
    :raises ValueError: where there is no such law.
    """
    if control_law is None:
        return scenario.control
    return dataclasses.replace(scenario.control, control_law=control_law)


def make_simulation(scenario):
    """
    Make the plant of a scenario, at time 0.

    :param scenario: the ``Scenario``.
    :return: the ``Simulation``.
    """
    return Simulation(scenario.truth, scenario.robot_truth, scenario.start.object.pose,
                      scenario.robot_start, scenario.simulation, scenario.sensors)


def at_rest(truth):
    """
    Tell whether robot and object have come to rest.

    :param truth: ``Truth`` of the plant.
    """
    return all(math.hypot(twist.v_x, twist.v_y) < REST_SPEED and abs(twist.omega) < REST_YAW_RATE
               for twist in (truth.object_twist, truth.robot_twist))


class _Loop:
    """The controller answers every measurement with one command."""

    def __init__(self, simulation, controller, target, observation, goal, replanner, report):
        self.simulation, self.controller, self.target = simulation, controller, target
        self.observation, self.goal = observation, goal
        self.replanner, self.report = replanner, report
        self._answer(0.0)

    def push(self, time_limit):
        """Go on until the controller ends the push, or time is up."""
        while self.simulation.time < time_limit:
            status = self.controller.status
            anew = self.replanner.answer(status, self.observation.odometry)
            if anew is None and status.phase in ('done', 'failed'):
                return status.phase, status.reason, self.simulation.time
            self.target = anew or self.target
            self._advance('pushing')
        return 'time_limit', f'not done after {time_limit:g} s', self.simulation.time

    def settle(self):
        """Go on until everything is at rest."""
        end = self.simulation.time + SETTLE_TIME
        rows = len(self.simulation.tape)
        while self.simulation.time < end:
            self._advance('settling')
            if at_rest(self.simulation.truth) and len(self.simulation.tape) > rows + 1:
                break

    def _advance(self, stage):
        measurement = self.simulation.next()
        now, before = self.simulation.time, self.observation
        if isinstance(measurement, Odometry):
            self.observation = Observation(now, measurement, before.object_pose)
        else:
            self.observation = Observation(now, before.odometry, measurement)
        self._answer(now - before.time)
        self.report(Progress(stage, now, distance(self.simulation.truth.object_pose, self.goal)))

    def _answer(self, dt):
        self.simulation.command(self.controller.step(self.target, self.observation, dt))


def _ignore(_):
    pass
