"""A scenario: what is pushed, by whom, from where to where, and what must come of it."""

import dataclasses
import functools
import math

from push_control.settings import ControlSettings
from push_model.contact import contact_point, find_contact, normal_range
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.quantity import check, quantity
from push_planner.problem import PlannerSettings, PlanningFailed
from push_planner.single_push.site_selection import choose_site
from push_scenario.definition.placement import Placement
from push_scenario.definition.task import Task
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings

OUTCOMES = ('reached', 'refused')


@dataclasses.dataclass(frozen=True)
class Start:
    """
    Where object and robot stand at first, in the world frame.

    The robot's place is either ``robot``, or is found from ``contact``, ``gap``, ``normal`` and
    ``heading``; with neither, it is the quickest site, which ``planner.site: best`` must ask for.
    In all cases ``placement_error`` is then added, in the robot's own frame.
    """

    object: Placement = dataclasses.field(default=Placement())
    robot: Placement | None = None
    contact: Contact | None = None
    gap: float = quantity('distance between robot and contact', 'm', 0.0, 10.0, default=0.0)
    normal: float = quantity('at a vertex: contact normal from the middle of those that it can '
                             'have', 'rad', -math.pi, math.pi, default=0.0)
    heading: float = quantity('robot heading from the contact normal', 'rad', -math.pi, math.pi,
                              default=0.0)
    placement_error: Placement = dataclasses.field(default=Placement())

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if self.robot is not None and self.contact is not None:
            raise ValueError(f'Start.robot: got robot {self.robot} and contact {self.contact}, '
                             'expected one of the two')

    @property
    def is_open(self):
        """Whether it does not say where the robot stands."""
        return self.robot is None and self.contact is None

    def robot_pose(self, obj, radius):
        """
        Place the robot.

        :param obj: the ``PushedObject`` that stands at ``object``.
        :param radius: of the robot [m]; infinite for a fence.
        :return: ``Pose`` of the robot in the world.
        :raises ValueError: where the object has no such contact.
        """
        error = self.placement_error.pose
        if self.robot is not None:
            return self.robot.pose @ error
        low, high = normal_range(obj, self.contact)
        normal = 0.5 * (low + high) + self.normal
        if abs(self.normal) > 0.5 * (high - low) + 1e-9:
            raise ValueError(f'Start.normal: got {self.normal:g}, expected at most '
                             f'{0.5 * (high - low):g} to either side at this contact [rad]')
        x, y = contact_point(obj, self.contact)
        away = self.gap if math.isinf(radius) else radius + self.gap
        in_object = Pose(x - away * math.cos(normal), y - away * math.sin(normal),
                         normal + self.heading)
        return self.object.pose @ in_object @ error


@dataclasses.dataclass(frozen=True)
class Bounds:
    """How near the goal the object must come to rest."""

    position_error: float = quantity('distance from the goal', 'm', above=0.0, default=0.02)
    heading_error: float = quantity('orientation from the goal, either way', 'rad', above=0.0,
                                    default=math.radians(3.0))

    def __post_init__(self):
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
    object: PushedObject
    true_object: PushedObject
    robot: RoundRobot
    true_robot: RoundRobot
    start: Start
    goal: Placement
    planner: PlannerSettings = dataclasses.field(default_factory=PlannerSettings)
    control: ControlSettings = dataclasses.field(default_factory=ControlSettings)
    sensors: SensorSettings = dataclasses.field(default_factory=SensorSettings)
    simulation: SimulationSettings = dataclasses.field(default_factory=SimulationSettings)
    task: Task | None = None
    bounds: Bounds = dataclasses.field(default_factory=Bounds)
    time_limit: float = quantity('simulated time after which the run is given up', 's', above=0.0,
                                 high=3600.0, default=120.0)
    expected: str = quantity('how the run should end', choices=OUTCOMES, default='reached')

    def __post_init__(self):
        """Validate the fields and the robot's place."""
        check(self)
        if self.start.is_open and self.planner.site != 'best':
            raise ValueError('Scenario.start: got neither robot nor contact, expected one of the '
                             'two, or planner.site best')
        try:
            pose = self.robot_start
        except (ValueError, PlanningFailed) as error:
            raise ValueError(f'Scenario.start: {error}') from error
        _, _, gap = find_contact(self.true_object, self.start.object.pose, pose, self.robot.radius)
        if gap < -1e-6:
            raise ValueError(f'Scenario.start: got a robot that overlaps the object by {-gap:g} m,'
                             ' expected one beside it')

    @property
    def final_goal(self):
        """``Pose`` wanted for the object in the end."""
        later = self.task.goals if self.task is not None else ()
        return (later[-1].goal if later else self.goal).pose

    @functools.cached_property
    def robot_start(self):
        """``Pose`` of the robot at first."""
        if self.start.is_open:
            choice = choose_site(self.object, self.robot, self.start.object.pose, self.goal.pose,
                                 self.planner)
            return choice.candidates[0].robot_pose @ self.start.placement_error.pose
        return self.start.robot_pose(self.object, self.robot.radius)
