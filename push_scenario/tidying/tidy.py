"""
Bring several objects to their goals in one process.

A ``TidySupervisor`` says which move is next. The other objects are obstacles of the map that robot
and planner read; bumped, they give way, and are measured anew after the move. One simulation makes
all moves: odometry drifts on, and what was learned of each object is kept.
"""

from collections.abc import Callable, Mapping
import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_localization.localizer import LidarLocalizer
from push_model.contact import find_contact
from push_model.events import ObjectFailure, Report
from push_model.geometry import distance, Pose, wrap_angle
from push_model.observation import Observation
from push_model.plan_request import GoalTolerances
from push_planner.rearrangement.footprints import object_gap
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.problem import Move, OrderPlan
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.simulation.loop import (
    first_observation, make_localizer, PLANNING_TIME, ProgressCallback, run_robot)
from push_scenario.simulation.result import Outcome, RunResult
from push_scenario.simulation.robot_control import TaskControl
from push_scenario.tidying.robot_memory import RobotMemory
from push_scenario.tidying.room import Room
from push_scenario.tidying.standing_objects import least_gap, TOUCH_GAP, with_obstacles
from push_sim_node.bumped_object import PlacedObject
from push_sim_node.room_simulation import RoomSimulation
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape
from push_tidy.obstacles import MARGIN_SIGMAS, StandingObject
from push_tidy.tidy_supervisor import (
    MeasuredScene, ObjectGoal, OrderPlanner, TidySupervisor)

# Measurements that a pose at rest is the mean of; chosen: half a second.
MEAN_COUNT = 10


class TidyProgress(NamedTuple):
    """
    Progress of a room.

    :param plan: ``OrderPlan`` of what remains; its first move is made now.
    :param placed: number of objects at their goals.
    :param goals: number of objects that have one.
    :param poses: measured ``Pose`` of each object, by name.
    """

    plan: OrderPlan
    placed: int
    goals: int
    poses: Mapping[str, Pose]


class MoveResult(NamedTuple):
    """
    A move that was made.

    :param move: the ``Move``.
    :param run: ``RunResult`` of its pushes.
    :param touched: by name least gap [m] of robot or pushed object to each standing object that it
        touched, below 0 the distance by which that was moved.
    :param progress: ``TidyProgress`` before it.
    """

    move: Move
    run: RunResult
    touched: Mapping[str, float]
    progress: TidyProgress


class MoveStart(NamedTuple):
    """
    Start of a move.

    :param scenario: ``Scenario`` of its pushes.
    :param robot: what runs on the robot.
    :param observation: its first measurements.
    """

    scenario: Scenario
    robot: TaskControl
    observation: Observation


@dataclasses.dataclass(frozen=True, eq=False)
class TidyResult:
    """
    How a room ended.

    :param room: the ``Room``.
    :param moves: ``MoveResult`` of each move.
    :param poses: true ``Pose`` of each object at the end, by name.
    :param robot_pose: true ``Pose`` of the robot at the end.
    :param failures: why an object is not at its goal, by name.
    """

    room: Room
    moves: tuple[MoveResult, ...]
    poses: dict[str, Pose]
    robot_pose: Pose
    failures: dict[str, Report[ObjectFailure]]

    @property
    def duration(self) -> float:
        """Simulated time of all moves [s]."""
        return sum(move.run.duration for move in self.moves)

    @property
    def touches(self) -> int:
        """Number of times that something touched a standing object in a move."""
        return len(self.touch_gaps)

    @property
    def touch_gaps(self) -> list[float]:
        """Least gap of each touch [m], below 0 the distance by which what was touched moved."""
        return [gap for move in self.moves for gap in move.touched.values()]

    def errors(self, name: str) -> tuple[float, float]:
        """Return the true distance [m] and rotation [rad] of an object from its goal."""
        pose, goal = self.poses[name], self.room.scenarios[name].goal.pose
        return distance(pose, goal), abs(wrap_angle(pose.theta - goal.theta))

    def is_placed(self, name: str) -> bool:
        """Tell whether an object is within the bounds of its goal, or has none."""
        if name in self.room.without_goal:
            return True
        position, heading = self.errors(name)
        bounds = self.room.scenarios[name].final_bounds
        return position <= bounds.position_error and heading <= bounds.heading_error


def tidy(room: Room, *, progress: Callable[[TidyProgress], None] | None = None,
         run_progress: ProgressCallback | None = None, find_order: OrderPlanner = plan_order,
         after_move: Callable[[MoveResult], None] | None = None) -> TidyResult:
    """
    Bring the objects of a room to their goals, as many as possible.

    :param progress: called before each move.
    :param run_progress: called with the ``Progress`` of each measurement.
    :param find_order: plans the order.
    :param after_move: called with each ``MoveResult``.
    """
    supervisor = TidySupervisor([goal_of(name, room) for name in room.scenarios],
                                room.any_scenario.robot, room.task.drive, find_order=find_order)
    run, moves = RoomRun(room), list[MoveResult]()
    while True:
        move = supervisor.next_move(run.scene)
        now = TidyProgress(supervisor.plan, supervisor.placed_count, supervisor.goal_count,
                           run.scene.poses)
        if progress is not None:
            progress(now)
        if move is None:
            return TidyResult(room, tuple(moves), run.poses, run.robot_pose,
                              supervisor.failures())
        result = run.make(move, now, run_progress)
        moves.append(result)
        is_done = result.run.outcome is Outcome.DONE
        supervisor.end_move(move, None if is_done else result.run.reason)
        if after_move is not None:
            after_move(result)


def goal_of(name: str, room: Room) -> ObjectGoal:
    """Return the ``ObjectGoal`` of an object of a room."""
    scenario = room.scenarios[name]
    bounds = scenario.final_bounds
    return ObjectGoal(
        name, scenario.object, None if name in room.without_goal else scenario.goal.pose,
        GoalTolerances(bounds.position_error, bounds.heading_error))


class RoomRun:
    """
    Objects of a room, and the robot among them; between two moves it can be pickled.

    :param room: the ``Room``; where objects are to get to is said move by move.
    """

    def __init__(self, room: Room) -> None:
        self._room = room
        scenario = room.any_scenario
        self._rng = np.random.default_rng(scenario.simulation.seed)
        self._simulated = RoomSimulation(
            {name: PlacedObject(item.true_object, item.start.object.pose)
             for name, item in room.scenarios.items()},
            scenario.true_robot, scenario.robot_start, scenario.plant_settings, scenario.sensors)
        self._memory = RobotMemory(room.task.supervision)
        self._localizer = make_localizer(scenario)
        self._measured = self._measure()

    @property
    def simulation(self) -> Simulation:
        """The ``Simulation`` of all moves."""
        return self._simulated.simulation

    @property
    def localizer(self) -> LidarLocalizer | None:
        """What finds the robot by scans; None where nothing does."""
        return self._localizer

    @property
    def poses(self) -> dict[str, Pose]:
        """True ``Pose`` of each object, by name."""
        return self._simulated.poses

    @property
    def robot_pose(self) -> Pose:
        """True ``Pose`` of the robot."""
        return self._simulated.robot_pose

    @property
    def scene(self) -> MeasuredScene:
        """Where all were last measured, and where the robot takes itself to be."""
        room = self._room
        robot_pose = self._memory.robot_pose or room.any_scenario.robot_start
        return MeasuredScene(self._measured, robot_pose,
                             room.floor_map.read(room.task.map_reading))

    def make(self, move: Move, now: TidyProgress,
             progress: ProgressCallback | None = None) -> MoveResult:
        """
        Make a move, and measure where all are then.

        :param now: ``TidyProgress`` before it.
        :param progress: called with the ``Progress`` of each measurement.
        """
        before = self._simulated.poses
        start = self.begin(move)
        run = run_robot(self.simulation, start.robot, start.scenario, start.observation,
                        progress=progress, localizer=self._localizer)
        self.end(move, start)
        return MoveResult(move, run, self._touched(start.scenario, run.tape, before), now)

    def begin(self, move: Move) -> MoveStart:
        """Let the robot begin a move."""
        scenario = self._scenario_of(move, self._simulated.poses[move.name])
        self._simulated.turn_to(move.name)
        simulation = self.simulation
        observation = first_observation(simulation)
        robot = TaskControl(scenario, scenario.task or self._room.task, PLANNING_TIME,
                            knowledge=self._memory.recall(move.name, simulation.time))
        self._memory.take_over(robot.supervisor)
        if self._localizer is not None:
            self._localizer.set_object(scenario.object)
            self._localizer.set_standing(self._standing_beside(move.name))
        return MoveStart(scenario, robot, observation)

    def end(self, move: Move, start: MoveStart) -> None:
        """Keep what the robot knows at the end of a move, and measure where all are then."""
        self._memory.keep(move.name, start.robot.supervisor, self.simulation.time)
        self._measured = self._measure()

    def displace(self, name: str, pose: Pose) -> None:
        """
        Move an object, as a person would, and measure where all are then.

        :param pose: its ``Pose`` afterwards.
        :raises ValueError: where something is in its way; then nothing changes.
        """
        room, obj = self._room, self._room.scenarios[name].true_object
        radius = room.any_scenario.true_robot.radius
        obstacles = [
            other for other, standing in self.poses.items() if other != name
            and object_gap(obj, pose, room.scenarios[other].true_object, standing) < 0.0]
        if find_contact(obj, pose, self.robot_pose[:2], radius).gap < 0.0:
            obstacles.append('the robot')
        if not room.floor_map.read(room.task.map_reading).object_is_free(obj, [pose], 0.0):
            obstacles.append('a wall')
        if obstacles:
            raise ValueError(f'{name} cannot be there: {obstacles[0]} is in the way')
        self._simulated.displace(name, pose)
        self._measured = self._measure()

    def _touched(self, scenario: Scenario, tape: Tape | None,
                 before: Mapping[str, Pose]) -> dict[str, float]:
        """
        Find what a move touched, as of ``MoveResult``.

        :param before: true ``Pose`` of each object before it, by name.
        """
        after, touched = self._simulated.poses, dict[str, float]()
        for name, pose in before.items():
            if tape is None or name == self._simulated.pushed:
                continue
            standing = StandingObject(self._room.scenarios[name].true_object, pose)
            gap = least_gap(tape, scenario.true_object, scenario.robot.radius, standing)
            moved = distance(pose, after[name])
            if moved > 0.0:
                touched[name] = -moved
            elif gap < TOUCH_GAP:
                touched[name] = gap
        return touched

    def _measure(self) -> dict[str, Pose]:
        """Measure all objects at rest."""
        sensors = self._room.any_scenario.sensors
        scale = 1.0 / math.sqrt(MEAN_COUNT)
        deviations = scale * np.array([sensors.pose_noise, sensors.pose_noise,
                                       sensors.pose_heading_noise])
        return {name: Pose(*(np.array(pose) + deviations * self._rng.standard_normal(3)).tolist())
                for name, pose in self._simulated.poses.items()}

    def _scenario_of(self, move: Move, object_pose: Pose) -> Scenario:
        """Make the scenario of one move: the others are obstacles of its map."""
        room = self._room
        scenario = room.scenarios[move.name]
        floor = with_obstacles(
            room.floor_map, room.task.map_reading, self._standing_beside(move.name),
            MARGIN_SIGMAS * scenario.sensors.pose_noise,
            StandingObject(scenario.object, self._measured[move.name]))
        reading = dataclasses.replace(room.task.map_reading, allow_unknown=False)
        return dataclasses.replace(
            scenario, name=f'{room.name}, {move.name}',
            task=dataclasses.replace(room.task, map=floor, map_reading=reading),
            start=Start(object=Placement(*object_pose),
                        robot=Placement(*self._simulated.robot_pose)),
            goal=Placement(*move.end))

    def _standing_beside(self, name: str) -> list[StandingObject]:
        """List all objects but one, where they are measured."""
        return [StandingObject(item.object, self._measured[other])
                for other, item in self._room.scenarios.items() if other != name]
