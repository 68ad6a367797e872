"""Live session: the simulation of a task, which its user disturbs and redirects under way."""

from collections.abc import Callable
import dataclasses
import math
from typing import Any

import numpy as np
from push_control.settings import LAWS
from push_model.files.data import share_directory
from push_model.files.parameter_files import (
    files_by_name, named_file, read_object, read_robot,
)
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject
from push_navigation.occupancy_map import OccupancyMap
from push_planner.settings import TaskMethod
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import (
    ClosedLoop, first_observation, make_safety_layer, make_simulation, PLANNING_TIMES,
)
from push_scenario.simulation.robot_control import TaskControl
from push_view.belief import belief_columns, believed_friction, believed_poses, FRICTION_STRIDE
from push_view.live.settings import (
    CONTACT_FRICTION, find_setting, FRICTION, setting_messages, with_friction,
)
from push_view.live.walls import open_floor, with_wall
from push_view.messages import (
    controls_message, displacement_message, goal_message, map_message, plan_message, rows_message,
    scenario_message, state_message, truth_message,
)
from push_view.server.commands import (
    AddWall, Choose, ClearWalls, Command, CommandRefused, DisplaceObject, Restart, Run, SetGoal,
    SetValue, Step,
)
from push_view.server.message_log import MessageLog

METHODS: tuple[TaskMethod, ...] = ('primitives', 'sequences')
# A task has no open loop.
TASK_LAWS = tuple(law for law in LAWS if law != 'open_loop')

HELP = ('The robot brings the object to the goal by pushing it. Drag the goal or the object by '
        'its middle, rotate it by its ring, draw walls, change what is there and how much '
        'friction there is: the robot is not told.')


class Session:
    """
    The simulation of a task, and the messages that show it.

    Time passes only in ``advance``; a task that is done waits for the next goal.

    :param scenario: a ``Scenario`` with a task, to start from.
    :param log: where the messages go.
    :raises ValueError: where it has no task.
    """

    def __init__(self, scenario: Scenario, log: MessageLog) -> None:
        if scenario.task is None:
            raise ValueError(f'{scenario.name}: got a single push, expected a task')
        self.log = log
        self.paused = False
        self.speed = 1.0
        self._scenario = scenario
        self._task: Task = scenario.task
        self._choices = {'object': _name_of(scenario.object, 'objects', read_object),
                         'robot': _name_of(scenario.robot, 'robots', read_robot),
                         'law': scenario.control.control_law,
                         'method': scenario.task.planning.method}
        self._map = scenario.task.occupancy_map
        self.show_run()
        self._start()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._simulation.time

    @property
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""
        return self._shown_time

    @property
    def is_standing(self) -> bool:
        """Whether the robot waits for a goal."""
        return self._robot.controller.status.state.is_standing

    @property
    def object_pose(self) -> Pose:
        """True ``Pose`` of the object."""
        return self._simulation.plant.object_pose

    def advance(self, duration: float, is_late: Callable[[], bool] = lambda: False) -> None:
        """
        Let simulated time pass.

        :param duration: how much [s]; to the next measurement at least.
        :param is_late: asked after every measurement whether to stop before.
        """
        end = self.time + duration
        rows: list[tuple[float, ...]] = []
        self._advance_to_next_measurement(rows)
        while self.time < end and not is_late():
            self._advance_to_next_measurement(rows)
        if rows:
            self.log.add(rows_message(rows))

    def handle(self, command: Command) -> None:
        """
        Do what the user asks for.

        :param command: the ``Command``.
        :raises CommandRefused: where it cannot be done, with the reason; then nothing changes.
        """
        handlers: dict[type[Any], Callable[[Any], None]] = {
            SetGoal: self._set_goal, DisplaceObject: self._displace_object,
            AddWall: self._add_wall, ClearWalls: self._clear_walls, Choose: self._choose,
            SetValue: self._set_value, Run: self._run, Step: self._step, Restart: self._restart}
        if type(command) not in handlers:
            raise CommandRefused('call: got one to a simulation, expected one to a robot')
        try:
            handlers[type(command)](command)
        except CommandRefused:
            raise
        except ValueError as error:
            raise CommandRefused(str(error)) from error

    def show_run(self, achieved: float = math.nan) -> None:
        """
        Show whether time runs, and how fast.

        :param achieved: simulated over real time, as measured; nan where it is not known.
        """
        self.log.replace({'type': 'run', 'paused': self.paused, 'speed': self.speed,
                          'achieved': None if math.isnan(achieved) else round(achieved, 1)})

    def _start(self) -> None:
        """Start over, with everything as it is set."""
        scenario = self._scenario
        self._simulation = make_simulation(scenario)
        observation = first_observation(self._simulation)
        method = 'sequences' if self._map is not None else self._task.planning.method
        self._robot = TaskControl(scenario, self._task, PLANNING_TIMES[method])
        self._robot.set_map(self._map)
        self._loop = ClosedLoop(self._simulation, self._robot, make_safety_layer(scenario),
                                observation, lambda _: None)
        self._shown_states = self._shown_plans = self._row_count = 0
        self._shown_time = 0.0
        self._friction: tuple[float, ...] = ()
        self.log.clear()
        columns = (*self._simulation.columns, *belief_columns(scenario.object))
        self.log.add({**scenario_message(scenario, self._choices['law'], columns),
                      'description': HELP})
        self.log.add(truth_message(0.0, scenario.true_object))
        self.log.add(goal_message(0.0, self._robot.goal))
        self.log.add(map_message(0.0, self._map))
        self._show_controls()
        rows: list[tuple[float, ...]] = []
        self._take_rows(rows)
        self.log.add(rows_message(rows))

    def _advance_to_next_measurement(self, rows: list[tuple[float, ...]]) -> None:
        # That the robot has ended its task is no reason to end the session.
        self._robot.update_plan(self._loop.observation)
        self._loop.advance()
        self._take_rows(rows)
        for change in self._robot.history[self._shown_states:]:
            self.log.add(state_message(change))
        for plan in self._robot.plans[self._shown_plans:]:
            self.log.add(plan_message(self.time, plan))
        self._shown_states = len(self._robot.history)
        self._shown_plans = len(self._robot.plans)

    def _take_rows(self, rows: list[tuple[float, ...]]) -> None:
        """Move new rows of the tape, with what is believed at them."""
        supervisor = self._robot.controller
        for row in self._simulation.rows:
            if self._row_count % FRICTION_STRIDE == 0:
                self._friction = believed_friction(supervisor,
                                                   len(self._scenario.object.supports))
            self._row_count += 1
            self._shown_time = row[0]
            rows.append((*row, *believed_poses(supervisor), *self._friction))
        # A session may last for hours.
        self._simulation.rows.clear()

    def _show_controls(self) -> None:
        options = {'object': _names('objects'), 'robot': _names('robots'), 'law': TASK_LAWS,
                   'method': METHODS}
        choices = [{'name': name, 'value': value,
                    'options': list(dict.fromkeys((value, *options[name])))}
                   for name, value in self._choices.items()]
        self.log.replace(controls_message(
            ('goal', 'object', 'wall'), choices=choices, owns_time=True,
            settings=setting_messages(self._scenario.true_object, self._scenario.sensors)))

    def _set_goal(self, command: SetGoal) -> None:
        # By the short side round from where the object is.
        heading = self.object_pose.theta
        theta = heading + wrap_angle(command.pose.theta - heading)
        goal = command.pose._replace(theta=theta)
        self._robot.set_goal(goal)
        self.log.add(goal_message(self.shown_time, goal))

    def _displace_object(self, command: DisplaceObject) -> None:
        before = self.object_pose
        theta = before.theta + wrap_angle(command.pose.theta - before.theta)
        try:
            self._simulation.plant.set_object_pose(command.pose._replace(theta=theta))
        except ValueError as error:
            raise CommandRefused('displace: the robot stands there') from error
        self.log.add(displacement_message(self.shown_time, before, self.object_pose))
        if self.paused:
            # Where it is now is seen in the next row.
            self._advance_by_a_row()

    def _add_wall(self, command: AddWall) -> None:
        floor = open_floor(self.object_pose) if self._map is None else self._map
        drawn = with_wall(floor, command.start, command.end)
        obj, robot = self._scenario.true_object, self._scenario.true_robot
        plant = self._simulation.plant
        if not (drawn.robot_is_free(robot, np.array([plant.robot_pose]), 0.0)
                and drawn.object_is_free(obj, np.array([plant.object_pose]), 0.0)):
            raise CommandRefused('wall: got one through robot or object, expected one beside '
                                 'them')
        self._set_map(drawn)

    def _clear_walls(self, _: ClearWalls) -> None:
        self._set_map(self._task.occupancy_map)

    def _set_map(self, occupancy_map: OccupancyMap | None) -> None:
        self._map = occupancy_map
        self._robot.set_map(occupancy_map)
        # What is under way was planned without the wall.
        self._robot.set_goal(self._robot.goal)
        self.log.add(map_message(self.shown_time, occupancy_map))

    def _choose(self, command: Choose) -> None:
        scenario, choices = self._scenario, {**self._choices, **command.choices}
        for name, value in command.choices.items():
            scenario = _chosen(scenario, name, value)
        self._scenario, self._choices = scenario, choices
        assert scenario.task is not None
        self._task = scenario.task
        self._start()

    def _set_value(self, command: SetValue) -> None:
        obj, sensors = self._scenario.true_object, self._scenario.sensors
        find_setting(obj, command.name, command.value)
        if command.name == CONTACT_FRICTION or command.name.startswith(FRICTION):
            changed = with_friction(obj, command.name, command.value)
            # Factors are on the friction that the plant was made with.
            self._simulation.plant.set_friction_factors([
                now / made for now, made in zip(changed.capacities,
                                                self._simulation.obj.capacities)])
            self._simulation.plant.set_contact_friction(changed.contact_friction_coefficient)
            self._scenario = dataclasses.replace(self._scenario, true_object=changed)
            self.log.add(truth_message(self.shown_time, changed))
        else:
            sensors = dataclasses.replace(sensors, **{command.name: command.value})
            self._simulation.set_sensors(sensors)
            self._scenario = dataclasses.replace(self._scenario, sensors=sensors)
        self._show_controls()

    def _run(self, command: Run) -> None:
        self.paused = self.paused if command.paused is None else command.paused
        self.speed = command.speed or self.speed
        self.show_run()

    def _step(self, _: Step) -> None:
        self.paused = True
        self.show_run()
        self._advance_by_a_row()

    def _advance_by_a_row(self) -> None:
        shown = self.shown_time
        while self.shown_time == shown:
            self.advance(0.0)

    def _restart(self, _: Restart) -> None:
        goal = self._robot.goal
        self._scenario = dataclasses.replace(self._scenario, goal=Placement(*goal))
        self._start()


def _chosen(scenario: Scenario, name: str, value: str) -> Scenario:
    """Put something else into a scenario; its true parameters are the nominal ones at first."""
    task = scenario.task
    assert task is not None
    if name == 'object':
        obj = read_object(_known('objects', value))
        return dataclasses.replace(scenario, object=obj, true_object=obj)
    if name == 'robot':
        robot = read_robot(_known('robots', value))
        return dataclasses.replace(scenario, robot=robot, true_robot=robot)
    if name == 'law' and value in TASK_LAWS:
        return dataclasses.replace(scenario, control=dataclasses.replace(
            scenario.control, control_law=value))
    if name == 'method' and value in METHODS:
        return dataclasses.replace(scenario, task=dataclasses.replace(
            task, planning=dataclasses.replace(task.planning, method=value)))
    raise CommandRefused(f'choose.{name[:60]}: got {value[:60]!r}, expected an object, a robot, a '
                         f'law ({", ".join(TASK_LAWS)}) or a method ({", ".join(METHODS)})')


def _known(folder: str, value: str) -> Any:
    if value not in _names(folder):
        raise CommandRefused(f'choose: got {value[:60]!r}, expected one of {folder}: '
                             + ', '.join(_names(folder)))
    return named_file(folder, value)


def _names(folder: str) -> list[str]:
    """List the files of objects or robots of the package."""
    return sorted(files_by_name(share_directory() / 'config' / folder))


def _name_of(value: PushedObject | Any, folder: str, read: Callable[[Any], Any]) -> str:
    """Find out which file of the package describes an object or a robot."""
    return next((name for name in _names(folder) if read(named_file(folder, name)) == value),
                'as in the scenario')
