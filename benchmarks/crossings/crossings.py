"""A person, a disc that walks straight at where the robot is, again and again during tasks."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_control.task.supervisor import Supervisor
from push_model.geometry import FloatArray
from push_navigation.occupancy_map import OccupancyMap
from push_safety.protective_field import ProtectiveCause
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import RunResult
from push_sim_node.simulation import Simulation

# Radius of the person [m], distance at which a crossing begins and beyond the robot ends [m], time
# between two crossings [s], and range of speeds [m/s].
RADIUS, START_DISTANCE, END_DISTANCE, PAUSE, SPEEDS = 0.2, 3.0, 1.5, 3.0, (0.3, 1.6)
# Directions that are tried for one from where the person is in the open, and sees the robot.
TRIALS, SPACING = 20, 0.05
# Distance of that line from the middle of the object [m]; chosen: person and box side by side.
OBJECT_DISTANCE = 0.5
CORNERS = 16
# Distance from which the protective field is to slow the robot [m].
SLOW_DISTANCE = 2.0
# What clothes give at a touch [m]; chosen. Bodies give no more: nobody walks through a robot.
SOFTNESS = 0.01
# What a robot may do at a touch [m/s].
MAX_TOUCH_SPEED = 0.1


class Crossing(NamedTuple):
    """
    One crossing.

    :param speed: of the person [m/s].
    :param robot_speed: greatest speed of the robot while they touch [m/s]; 0 where they do not.
    :param gap: least distance of both hulls [m].
    """

    speed: float
    robot_speed: float
    gap: float


class Walker:
    """Walks at the robot as far as walls let them, and is seen by the lidar alone."""

    def __init__(self, seed: int, floor: OccupancyMap | None, *, walks: bool = True) -> None:
        """
        Wait for the first crossing.

        :param floor: ``OccupancyMap`` with the walls between person and robot.
        """
        self._floor = floor
        self._rng = np.random.default_rng(seed)
        self._walks = walks
        self._start_time, self._speed = PAUSE, 0.0
        self._direction: FloatArray = np.zeros(2)
        self._person: FloatArray = np.zeros(2)
        self._time = 0.0
        self._gap, self._robot_speed = math.inf, 0.0
        self.crossings: list[Crossing] = []
        self.stops = 0
        self._was_stopped = False

    def __call__(self, simulation: Simulation, supervisor: Supervisor) -> None:
        """Walk on, and note what the robot does."""
        causes = supervisor.status.codes
        is_stopped = any(isinstance(code, ProtectiveCause)
                         and code is not ProtectiveCause.NO_SCAN_YET for code in causes)
        self.stops += is_stopped and not self._was_stopped
        self._was_stopped = is_stopped
        if supervisor.awaits_resume and self._speed == 0.0:
            # Whoever has crossed, or looks after the robot, lets it go on.
            supervisor.resume()
        if not self._walks or simulation.time < self._start_time:
            return
        robot = np.array(simulation.plant.robot_pose[:2])
        if self._speed == 0.0:
            self._start_walk(robot, np.array(simulation.plant.object_pose[:2]), simulation.time)
        if self._speed == 0.0:
            return
        covered = self._speed * (simulation.time - self._start_time)
        contact_distance = RADIUS + simulation.robot.radius
        person = walk(self._person, self._direction * self._speed * (simulation.time - self._time),
                      robot, contact_distance - SOFTNESS)
        self._person, self._time = person, simulation.time
        if covered > START_DISTANCE + END_DISTANCE or not self._is_free(person[None]):
            self._end(simulation,
                      has_crossed=covered > START_DISTANCE or self._gap <= 0.0)
            return
        turn = np.linspace(0.0, 2.0 * math.pi, CORNERS, endpoint=False)
        simulation.show_visitor(person + RADIUS * np.stack((np.cos(turn), np.sin(turn)), axis=1))
        gap = float(np.hypot(*(person - robot))) - contact_distance
        self._gap = min(self._gap, gap)
        if gap <= 0.0:
            twist = simulation.truth.robot_twist
            self._robot_speed = max(self._robot_speed, math.hypot(twist.v_x, twist.v_y))

    def _start_walk(self, robot: FloatArray, obj: FloatArray, time: float) -> None:
        """Start where the person sees the robot, with the object not between, if possible."""
        self._start_time = self._time = time
        for _ in range(TRIALS):
            angle = self._rng.uniform(-math.pi, math.pi)
            self._direction = np.array([math.cos(angle), math.sin(angle)])
            aside = np.array([-self._direction[1], self._direction[0]])
            self._person = (robot + self._rng.uniform(-0.3, 0.3) * aside
                            - START_DISTANCE * self._direction)
            fractions = np.arange(0.0, 1.0, SPACING / START_DISTANCE)[:, None]
            line = self._person + fractions * (robot - self._person)
            if self._is_free(line) and np.hypot(*(line - obj).T).min() > OBJECT_DISTANCE:
                self._speed = float(self._rng.uniform(*SPEEDS))
                return

    def _is_free(self, line: FloatArray) -> bool:
        """Tell whether there is room for a person between walls."""
        return self._floor is None or bool(self._floor.clearance(line).min() > RADIUS)

    def _end(self, simulation: Simulation, *, has_crossed: bool) -> None:
        if has_crossed:
            self.crossings.append(Crossing(self._speed, self._robot_speed, self._gap))
        simulation.show_visitor(np.zeros((0, 2)))
        self._speed = 0.0
        self._gap = math.inf
        self._robot_speed = 0.0
        self._start_time = simulation.time + PAUSE


def walk(person: FloatArray, step: FloatArray, robot: FloatArray, least: float) -> FloatArray:
    """
    Walk straight on as far as the robot lets; a robot that comes nearer pushes the person away.

    :param person: position, shape (2,) [m].
    :param step: what the person would walk, shape (2,) [m].
    :param robot: its position, shape (2,) [m].
    :param least: distance of both at a touch [m].
    :return: the new position, shape (2,) [m].
    """
    length = float(np.hypot(*step))
    if length > 0.0:
        direction, to_robot = step / length, robot - person
        ahead = float(to_robot @ direction)
        half_chord_squared = least ** 2 - float(to_robot @ to_robot) + ahead ** 2
        if ahead > 0.0 and half_chord_squared > 0.0:
            length = min(length, max(0.0, ahead - math.sqrt(half_chord_squared)))
        person = person + length * direction
    distance = float(np.hypot(*(person - robot)))
    return person if distance >= least else robot + least / distance * (person - robot)


def run(seed: int, *, walks: bool = True, is_protected: bool = True,
        scenario_name: str = 'task_lidar') -> tuple[RunResult, Walker]:
    """
    Drive one task with drawn noise.

    :param walks: whether anybody walks about.
    :param is_protected: whether the protective field is on.
    :param scenario_name: of a scenario with a lidar.
    """
    scenario = load_scenario(scenario_name).with_seed(seed)
    task = scenario.task
    if task is None:
        raise ValueError(f'scenario_name: got {scenario_name!r}, expected one with a task')
    if is_protected:
        place = dataclasses.replace(task.place, slow_distance=SLOW_DISTANCE)
        scenario = dataclasses.replace(scenario, task=dataclasses.replace(task, place=place))
    walker = Walker(seed, task.occupancy_map, walks=walks)
    return simulate(scenario, intervene=walker), walker
