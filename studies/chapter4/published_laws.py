"""Laws of other authors for a push at one point, programmed from their formulas."""

import abc
import math

from push_control.steered.laws.command import contact_speed
from push_model.geometry import Coordinates, distance, Pose
from push_model.observation import Observation
from push_model.signals import STOP, Twist
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.result import Outcome
from push_scenario.simulation.robot_control import Ending, SinglePushControl
from push_sim_node.simulation import Simulation
from push_sim_node.truth import Truth

# Gains k_f and k_c [rad/m] of Heins and Schoellig (RA-L 2024).
FORCE_GAIN = 0.3
OFFSET_GAIN = 0.1


def force_angle_direction(force: float, path: float, offset: float) -> float:
    """
    Compute the direction of a push after Heins and Schoellig (RA-L 2024, heins2024).

    ``psi = psi_path + (1 + k_f) (psi_force - psi_path) + k_c offset``: the law measures the
    direction of the contact force and the place of the contact, and needs no model.

    :param force: psi_force, direction of the force on the object [rad].
    :param path: psi_path, direction of the path [rad].
    :param offset: of the contact to the left of the path [m].
    :return: psi [rad].
    """
    deviation = math.remainder(force - path, 2.0 * math.pi)
    return path + (1.0 + FORCE_GAIN) * deviation + OFFSET_GAIN * offset


def dipole_direction(object_position: Coordinates, robot_position: Coordinates,
                     goal: Coordinates) -> float:
    """
    Compute the direction of the robot after Igarashi et al. (ICRA 2010, igarashi2010).

    The robot follows the field of a dipole at the object that points to the goal: at an angle phi
    from that direction it moves at 2 phi, so that it circles to behind the object and pushes.

    :param object_position: (x, y) [m].
    :param robot_position: of its centre (x, y) [m].
    :param goal: of the object (x, y) [m].
    :return: direction [rad].
    """
    x, y = object_position[:2]
    towards = math.atan2(goal[1] - y, goal[0] - x)
    bearing = math.atan2(robot_position[1] - y, robot_position[0] - x)
    return towards + 2.0 * (bearing - towards)


class PublishedLaw(SinglePushControl, abc.ABC):
    """
    Pushes an object to a position, whatever its heading there: the laws here control no more.

    They are given the true poses and the true force. The push ends where the object is beside its
    goal, seen along the line from its start.
    """

    def __init__(self, scenario: Scenario, observation: Observation,
                 simulation: Simulation) -> None:
        """
        Take the line from the start to the goal as the path.

        :param scenario: the ``Scenario``, of a holonomic robot.
        :param observation: the first measurements.
        :param simulation: whose ``truth`` is measured.
        :raises ValueError: for another drive, which cannot push in any direction.
        :raises PlanningFailed: where there is no plan, which the law does not use.
        """
        if scenario.robot.drive != 'holonomic':
            raise ValueError(f'robot: got a {scenario.robot.drive} drive, '
                             'expected a holonomic one')
        super().__init__(scenario, observation)
        self._simulation = simulation
        self._start = scenario.start.object.pose
        self._path = math.atan2(self.goal.y - self._start.y, self.goal.x - self._start.x)
        self._elapsed = 0.0

    @abc.abstractmethod
    def direction(self, truth: Truth) -> float:
        """
        Choose the direction of the robot.

        :param truth: of the plant; its poses are in the world frame.
        :return: direction in the world [rad].
        """

    def step(self, observation: Observation, dt: float) -> Twist:
        """Answer the true state; see ``RobotControl``."""
        self._elapsed += dt
        if self._is_finished:
            return STOP
        truth = self._simulation.truth
        speed = contact_speed(self._elapsed, self._remaining, self._scenario.planner.pushing_speed,
                              self._scenario.control)
        angle = self.direction(truth) - truth.robot_pose.theta
        return Twist(speed * math.cos(angle), speed * math.sin(angle), 0.0)

    def update_plan(self, observation: Observation) -> Ending | None:
        """End beside the goal; see ``RobotControl``."""
        return Ending(Outcome.DONE, '') if self._is_finished else None

    @property
    def _remaining(self) -> float:
        """Distance of the object to its goal along the path [m]."""
        return distance(self._start, self.goal) - self._along(self._simulation.truth.object_pose)

    @property
    def _is_finished(self) -> bool:
        return self._remaining <= self._scenario.control.stop_distance

    def _along(self, point: Coordinates | Pose) -> float:
        """Distance of a point from the start, along the path [m]."""
        return ((point[0] - self._start.x) * math.cos(self._path)
                + (point[1] - self._start.y) * math.sin(self._path))

    def offset(self, point: Coordinates) -> float:
        """
        Compute how far a point is to the left of the path.

        :param point: (x, y) [m].
        :return: offset [m].
        """
        return ((point[1] - self._start.y) * math.cos(self._path)
                - (point[0] - self._start.x) * math.sin(self._path))


class ForceAngleLaw(PublishedLaw):
    """The law of Heins and Schoellig."""

    def direction(self, truth: Truth) -> float:
        """Choose the direction of the robot; without a force that of the path and the offset."""
        force = self._path
        if truth.force_n > 0.0:
            force = truth.normal + math.atan2(truth.force_t, truth.force_n)
        return force_angle_direction(force, self._path, self.offset(truth.contact_point))


class DipoleLaw(PublishedLaw):
    """The law of Igarashi, Kamiyama and Inami."""

    def direction(self, truth: Truth) -> float:
        """Choose the direction of the robot."""
        return dipole_direction(truth.object_pose[:2], truth.robot_pose[:2], self.goal[:2])
