"""One run of a session: plant and robot, with walls that nothing gets through."""

import numpy as np
from push_control.events import TaskEvent
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.signals import STOP
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.wall_segments import map_walls
from push_safety.layer import SafetyLayer
from push_scenario.simulation.loop import (
    ClosedLoop, first_observation, make_localizer, make_safety_layer, make_simulation,
    PLANNING_TIME)
from push_scenario.simulation.robot_control import TaskControl
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation
from push_view.live.display import RunDisplay
from push_view.live.setup import Setup
from push_view.messages import (
    collision_message, displacement_message, goal_message, map_message, scenario_message,
    truth_message)
from push_view.server.commands import CommandRefused
from push_view.server.message_log import MessageLog
from push_view.wall_contact import Body, WallContact, WallContactDetector

HELP = ('The robot brings the object to the goal by pushing it. Drag the goal or the object by '
        'its middle, rotate it by its ring, draw walls, change what is there and how much '
        'friction there is: the robot is not told.')
# Clearances may be too short by so much [m], as after a stop beside a wall; chosen: above 0.14
# cells, what they are reduced by.
BESIDE = 0.02


class LiveRun:
    """
    Plant, sensors and robot from time 0 on.

    Walls stop robot and object. Where the robot touches one both stand, and it gives its task up.
    A task that is done waits for the next goal.

    :param setup: the ``Setup``.
    :param occupancy_map: walls, or None for open floor.
    :param log: where it is shown.
    """

    def __init__(self, setup: Setup, occupancy_map: OccupancyMap | None,
                 log: MessageLog) -> None:
        scenario = setup.scenario
        self._log = log
        self._simulation: Simulation = make_simulation(scenario)
        self._touching: set[Body] = set()
        self._set_walls(occupancy_map)
        self._walls = WallContactDetector(scenario.true_object, scenario.true_robot)
        observation = first_observation(self._simulation)
        self._robot = TaskControl(scenario, setup.task, PLANNING_TIME)
        self._robot.set_map(occupancy_map)
        safety: SafetyLayer = make_safety_layer(scenario)
        self._loop = ClosedLoop(self._simulation, self._robot, safety, observation,
                                localizer=make_localizer(scenario))
        self._display = RunDisplay(log, self._simulation, self._robot, safety,
                                   scenario.object)
        self._show_start(setup)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._simulation.time

    @property
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""
        return self._display.time

    @property
    def is_standing(self) -> bool:
        """Tell whether the robot waits for a goal."""
        return self._robot.supervisor.status.state.is_standing

    @property
    def object_pose(self) -> Pose:
        """True ``Pose`` of the object."""
        return self._simulation.plant.object_pose

    @property
    def has_plan(self) -> bool:
        """Tell whether a push has been planned."""
        return bool(self._robot.plans)

    @property
    def poses(self) -> tuple[Pose, Pose]:
        """True ``Pose`` of object and robot."""
        return self._simulation.plant.object_pose, self._simulation.plant.robot_pose

    @property
    def goal(self) -> Pose:
        """Goal ``Pose`` of the object."""
        return self._robot.goal

    def advance(self) -> None:
        """Let time pass until the next measurement; ``show`` shows it."""
        # That the robot has ended its task is no reason to end the session.
        self._robot.update_plan(self._loop.observation)
        self._loop.advance()
        self._watch_walls()
        self._display.take_rows()

    def rehearse(self) -> None:
        """Compile what the robot needs for a push."""
        self._robot.supervisor.rehearse()

    def show(self) -> None:
        """Send the page what happened."""
        self._display.send_rows()

    def set_goal(self, goal: Pose) -> None:
        """Redirect the robot."""
        self._robot.set_goal(goal)
        self._log.add(goal_message(self.shown_time, goal))

    def displace_object(self, pose: Pose) -> None:
        """
        Move the object, as a person would.

        :param pose: its ``Pose`` afterwards.
        :raises CommandRefused: where something is in its way.
        """
        before = self.object_pose
        if self._map is not None and self._walls.find(self._map, Body.OBJECT, pose) is not None:
            raise CommandRefused('the object cannot be there: a wall is in the way')
        try:
            self._simulation.plant.set_object_pose(pose)
        except ValueError as error:
            raise CommandRefused('the object cannot be there: the robot is in the way') from error
        self._log.add(displacement_message(self.shown_time, before, self.object_pose))

    def set_map(self, occupancy_map: OccupancyMap | None) -> None:
        """
        Replace the walls; the robot starts over, as it has planned without them.

        :param occupancy_map: the ``OccupancyMap``, or None for open floor.
        :raises CommandRefused: where robot or object is in their way.
        """
        if occupancy_map is not None and not self._is_free(occupancy_map):
            raise CommandRefused('a wall cannot be there: robot or object is in the way')
        self._set_walls(occupancy_map)
        self._robot.set_map(occupancy_map)
        self._robot.set_goal(self._robot.goal)
        self._log.add(map_message(self.shown_time, occupancy_map))

    def set_true_object(self, obj: PushedObject) -> None:
        """
        Change the true friction; the robot is not told.

        :param obj: the true ``PushedObject``; all but its friction is as it was.
        """
        plant = self._simulation.plant
        # Factors are on the friction that the plant was made with.
        plant.set_friction_factors([now / made for now, made in zip(obj.capacities,
                                                                    plant.obj.capacities)])
        plant.set_contact_friction(obj.contact_friction_coefficient)
        self._log.add(truth_message(self.shown_time, obj))

    def set_sensors(self, sensors: SensorSettings) -> None:
        """Measure with other errors."""
        self._simulation.set_sensors(sensors)

    def _show_start(self, setup: Setup) -> None:
        scenario, log = setup.scenario, self._log
        log.clear()
        log.add({**scenario_message(scenario, setup.choices['law'], self._display.columns),
                 'description': HELP})
        log.add(truth_message(0.0, scenario.true_object))
        log.add(goal_message(0.0, self.goal))
        log.add(map_message(0.0, self._map))
        self._display.take_rows()
        self.show()

    def _is_free(self, occupancy_map: OccupancyMap) -> bool:
        """Tell whether no wall is inside of robot or object."""
        plant = self._simulation.plant
        return (occupancy_map.robot_is_free(plant.robot, np.array([plant.robot_pose]), -BESIDE)
                and occupancy_map.object_is_free(plant.obj, np.array([plant.object_pose]),
                                                 -BESIDE))

    def _set_walls(self, occupancy_map: OccupancyMap | None) -> None:
        self._map = occupancy_map
        self._simulation.plant.set_walls(
            () if occupancy_map is None else map_walls(occupancy_map))

    def _wall_contacts(self, occupancy_map: OccupancyMap | None) -> list[WallContact]:
        """List which bodies touch a wall."""
        if occupancy_map is None:
            return []
        plant = self._simulation.plant
        contacts = (self._walls.find(occupancy_map, Body.ROBOT, plant.robot_pose),
                    self._walls.find(occupancy_map, Body.OBJECT, plant.object_pose))
        return [contact for contact in contacts if contact is not None]

    def _watch_walls(self) -> None:
        """Show what begins to touch a wall; a robot that does stands."""
        contacts = self._wall_contacts(self._map)
        for contact in contacts:
            if contact.body not in self._touching:
                self._log.add(collision_message(self.time, contact))
                if contact.body is Body.ROBOT and not self.is_standing:
                    self._give_up(contact)
        self._touching = {contact.body for contact in contacts}

    def _give_up(self, contact: WallContact) -> None:
        plant = self._simulation.plant
        plant.stand_at(plant.object_pose, plant.robot_pose)
        self._simulation.command(STOP)
        self._robot.supervisor.interrupt(TaskEvent.HIT_WALL.report(contact=contact))
