"""Scenarios: what is pushed, by which robot, from where to where, and with what outcome."""

import dataclasses
import math
from typing import TYPE_CHECKING

from push_control.law_names import law_name
from push_control.settings import ControlSettings
from push_model.contact import contact_point, find_contact, normal_range
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.quantity import check, quantity
from push_planner.settings import PlannerSettings
from push_scenario.definition.engine_names import ENGINES
from push_scenario.definition.placement import Placement
from push_scenario.definition.task import Task
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings

if TYPE_CHECKING:  # Scenarios name their laws alone.
    from push_control.steered.laws.steering_law import SteeringLaw

EXPECTATIONS = ('reached', 'refused', 'too_heavy')
# Rounding of poses in scenario files: less is no overlap, and no normal out of range [m], [rad].
MAX_OVERLAP = 1e-6
NORMAL_TOLERANCE = 1e-9


@dataclasses.dataclass(frozen=True)
class Start:
    """
    Start of object and robot, in the world frame.

    The pose of the robot is either ``robot``, or follows from ``contact``, ``gap``, ``normal`` and
    ``heading``; with neither, it is that of the quickest contact site, which
    ``planner.site: best`` must ask for. In all cases ``placement_error`` is then added, in the
    robot's own frame.
    """

    object: Placement = Placement()
    robot: Placement | None = None
    contact: Contact | None = None
    gap: float = quantity('distance between robot and contact', 'm', 0.0, 10.0, default=0.0)
    normal: float = quantity('at a vertex: contact normal from the middle of those that it can '
                             'have', 'rad', -math.pi, math.pi, default=0.0)
    heading: float = quantity('robot heading from the contact normal', 'rad', -math.pi, math.pi,
                              default=0.0)
    placement_error: Placement = Placement()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.robot is not None and self.contact is not None:
            raise ValueError(f'Start.robot: got robot {self.robot} and contact {self.contact}, '
                             'expected one of the two')

    @property
    def is_robot_specified(self) -> bool:
        """Tell whether the pose of the robot follows from the fields."""
        return self.robot is not None or self.contact is not None

    def robot_pose(self, obj: PushedObject, radius: float) -> Pose:
        """
        Compute the pose of the robot.

        :param obj: the ``PushedObject`` that stands at ``object``.
        :param radius: of the robot [m]; infinite for a flat pusher.
        :return: ``Pose`` of the robot in the world.
        :raises ValueError: where it is not specified, or the object has no such contact.
        """
        error = self.placement_error.pose
        if self.robot is not None:
            return self.robot.pose @ error
        if self.contact is None:
            raise ValueError('Start: got neither robot nor contact, expected one of the two')
        low, high = normal_range(obj, self.contact)
        normal = 0.5 * (low + high) + self.normal
        if abs(self.normal) > 0.5 * (high - low) + NORMAL_TOLERANCE:
            raise ValueError(f'Start.normal: got {self.normal:g}, expected at most '
                             f'{0.5 * (high - low):g} to either side at this contact [rad]')
        x, y = contact_point(obj, self.contact)
        distance = self.gap if math.isinf(radius) else radius + self.gap
        in_object = Pose(x - distance * math.cos(normal), y - distance * math.sin(normal),
                         normal + self.heading)
        return self.object.pose @ in_object @ error


@dataclasses.dataclass(frozen=True)
class GoalBounds:
    """Bounds of the distance from the goal at which the object must come to rest."""

    position_error: float = quantity('distance from the goal', 'm', above=0.0, high=10.0,
                                     default=0.02)
    heading_error: float = quantity('orientation from the goal, either way', 'rad', above=0.0,
                                    high=math.pi, default=math.radians(3.0))

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class Scenario:
    """
    One push or one task: nominal and true parameters, goal, and the expected outcome.

    With ``task`` the robot may start anywhere, and pushes as often as it takes. ``object`` and
    ``robot`` are the nominal parameters, which planner and controller use; ``true_object`` and
    ``true_robot`` are those of the plant.
    """

    name: str = quantity('short name, that of the file')
    description: str = quantity('what the scenario shows')
    object: PushedObject = quantity('nominal parameters of the object')
    true_object: PushedObject = quantity('parameters of the object that the plant simulates')
    robot: RoundRobot = quantity('nominal parameters of the robot')
    true_robot: RoundRobot = quantity('parameters of the robot that the plant simulates')
    start: Start = quantity('where object and robot stand at first')
    goal: Placement = quantity('goal pose of the object')
    planner: PlannerSettings = dataclasses.field(default_factory=PlannerSettings)
    control: ControlSettings = dataclasses.field(default_factory=ControlSettings)
    sensors: SensorSettings = dataclasses.field(default_factory=SensorSettings)
    simulation: SimulationSettings = dataclasses.field(default_factory=SimulationSettings)
    task: Task | None = None
    bounds: GoalBounds = dataclasses.field(default_factory=GoalBounds)
    time_limit: float = quantity('simulated time after which the run is given up', 's', above=0.0,
                                 high=3600.0, default=120.0)
    engine: str = quantity('what moves robot and object', choices=ENGINES, default='own')
    expected: str = quantity('how the run should end', choices=EXPECTATIONS, default='reached')

    def __post_init__(self) -> None:
        """Validate the fields and the robot's place."""
        check(self)
        if not self.start.is_robot_specified:
            if self.planner.site != 'best':
                raise ValueError('Scenario.start: got neither robot nor contact, expected one of '
                                 'the two, or planner.site best')
            return
        try:
            pose = self.robot_start
        except ValueError as error:
            raise ValueError(f'Scenario.start: {error}') from error
        _, _, gap = find_contact(self.true_object, self.start.object.pose, pose, self.robot.radius)
        if gap < -MAX_OVERLAP:
            raise ValueError(f'Scenario.start: got a robot that overlaps the object by {-gap:g} m,'
                             ' expected one beside it')

    @property
    def final_goal(self) -> Pose:
        """Goal ``Pose`` of the object at the end, after all later goals."""
        later = self.task.goals if self.task is not None else ()
        return (later[-1].goal if later else self.goal).pose

    @property
    def final_bounds(self) -> GoalBounds:
        """``bounds``, with any heading where the task takes any."""
        if self.task is None or (
                self.task.supervision.for_object(self.object).heading_tolerance < math.pi):
            return self.bounds
        return dataclasses.replace(self.bounds, heading_error=math.pi)

    @property
    def plant_settings(self) -> SimulationSettings:
        """``simulation``, with the walls of the task's map besides its own."""
        if self.task is None or self.task.map is None:
            return self.simulation
        return dataclasses.replace(
            self.simulation, walls=(*self.simulation.walls, *self.task.map.walls))

    def with_law(self, law: 'str | type[SteeringLaw]') -> 'Scenario':
        """
        Steer by another law; it steers steered pushes alone.

        :param law: ``feedback``, ``mpc`` or ``open_loop``; or one of your own: a subclass of
            ``SteeringLaw``, its name ``module:Class``, or its entry point.
        :raises ValueError: where there is no such law.
        """
        name = law if isinstance(law, str) else law_name(law)
        return dataclasses.replace(
            self, control=dataclasses.replace(self.control, control_law=name))

    def with_seed(self, seed: int) -> 'Scenario':
        """
        Draw other random errors of the sensors and the base.

        :param seed: at least 0.
        """
        return dataclasses.replace(
            self, simulation=dataclasses.replace(self.simulation, seed=seed))

    @property
    def robot_start(self) -> Pose:
        """
        ``Pose`` of the robot at first.

        :raises ValueError: where the planner chooses it; see ``simulation.start.place_robot``.
        """
        return self.start.robot_pose(self.object, self.robot.radius)
