"""
A planned push, played in the object's frame: the input as the thesis states it.

The input of the thesis is a velocity of the contact relative to the object. It is open loop, as
nothing is done about where the object is; but as the object rotates, so does the push. The robot
needs to know how the object lies on it, which an ideal sensor in its bumper reports here.
"""

import numpy as np
from push_control.steered.laws.command import contact_speed, holonomic_command
from push_model.geometry import FloatArray, wrap_angles
from push_model.observation import Observation
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.result import Outcome
from push_scenario.simulation.robot_control import Ending, SinglePushControl
from push_sim_node.simulation import Simulation


class ObjectFrameInput(SinglePushControl):
    """Pushes at the planned angles to the true contact normal, and rotates with the object."""

    def __init__(self, scenario: Scenario, observation: Observation,
                 simulation: Simulation) -> None:
        """
        Plan the push.

        :param scenario: the ``Scenario``, of a holonomic robot.
        :param observation: the first measurements.
        :param simulation: whose ``truth`` the sensor in the bumper reports.
        :raises ValueError: for another drive, which cannot push in any direction.
        :raises PlanningFailed: with the reason.
        """
        if scenario.robot.drive != 'holonomic':
            raise ValueError(f'robot: got a {scenario.robot.drive} drive, '
                             'expected a holonomic one')
        super().__init__(scenario, observation)
        self._simulation = simulation
        self._settings = scenario.control
        plan = self._plan
        if plan is None:
            raise ValueError('goal: got one that the object has reached, expected another')
        self._elapsed = 0.0
        self._play(plan)

    def _play(self, plan: PushTrajectory) -> None:
        """Take up a plan, at its start."""
        self._speeds = np.hypot(*plan.contact_twists[:, :2].T)
        self._distances = travelled_distances(plan)
        self._angles = pushing_angles(plan)
        self._distance = 0.0

    def step(self, observation: Observation, dt: float) -> Twist:
        """Play the input on; see ``RobotControl``."""
        self._elapsed += dt
        remaining = self._distances[-1] - self._distance
        planned = float(np.interp(self._distance, self._distances, self._speeds))
        speed = contact_speed(self._elapsed, remaining, planned, self._settings)
        self._distance += speed * dt
        if self._is_finished:
            return STOP
        truth = self._simulation.truth
        angle = float(np.interp(self._distance, self._distances, self._angles))
        return holonomic_command(speed, angle, truth.normal - truth.robot_pose.theta,
                                 self._scenario.robot.radius, truth.object_twist.omega)

    def update_plan(self, observation: Observation) -> Ending | None:
        """End at the end of the plan; see ``RobotControl``."""
        return Ending(Outcome.DONE, '') if self._is_finished else None

    @property
    def _is_finished(self) -> bool:
        return self._distance >= self._distances[-1] - self._settings.stop_distance


def pushing_angles(planned: PushTrajectory) -> FloatArray:
    """
    Compute the pushing angles of a plan.

    :param planned: trajectory of n samples.
    :return: from the contact normal to the velocity of the contact [rad], shape (n,).
    """
    v_x, v_y, _ = planned.contact_twists.T
    angles = np.arctan2(v_y, v_x) - planned.contact_poses[:, 2]
    return wrap_angles(angles)


def travelled_distances(planned: PushTrajectory) -> FloatArray:
    """
    Compute how far the contact has travelled in a plan.

    :param planned: trajectory of n samples.
    :return: distances since the start [m], shape (n,).
    """
    speeds = np.hypot(*planned.contact_twists[:, :2].T)
    steps = 0.5 * (speeds[1:] + speeds[:-1]) * np.diff(planned.times)
    return np.concatenate([[0.0], np.cumsum(steps)])
