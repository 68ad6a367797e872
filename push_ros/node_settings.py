"""Settings of a node besides physics and tuning: frames, modes, files."""

import dataclasses
import math
import re

from push_model.plan_request import MAX_HEADING_TOLERANCE, MAX_TOLERANCE, MIN_TOLERANCE
from push_model.quantity import check, MAX_ANGLE, quantity


@dataclasses.dataclass(frozen=True)
class Frames:
    """Frame ids; messages in other frames are brought to the world frame by tf."""

    world_frame: str = quantity('frame of odometry, poses, goals and plans', default='odom')
    object_frame: str = quantity('frame of the object', default='object')
    base_frame: str = quantity('frame of the robot and of commands', default='base_link')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for field in dataclasses.fields(self):
            if not getattr(self, field.name):
                raise ValueError(f'Frames.{field.name}: got an empty text, expected a frame id')


# What the name of an object may be that has topics of its own.
TOPIC_NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]*')


@dataclasses.dataclass(frozen=True)
class NamedTopics:
    """One of several objects, which has topics of its own."""

    name: str = quantity('name of one of several objects, which is that of its file, too')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        check_topic_name('NamedTopics.name', self.name)


def check_topic_name(field: str, name: str) -> None:
    """
    Check that a name can be part of that of a topic.

    :param field: what errors call it.
    :raises ValueError: naming it.
    """
    if not TOPIC_NAME.fullmatch(name):
        raise ValueError(f'{field}: got {name!r}, expected letters, digits and _')


@dataclasses.dataclass(frozen=True)
class SimulatedObject:
    """One of several objects of a simulation."""

    name: str = quantity('name of one of several simulated objects, which is that of its file')
    x: float = quantity('its position at the start', 'm', -1e4, 1e4)
    y: float = quantity('the same, y', 'm', -1e4, 1e4)
    theta: float = quantity('its heading at the start', 'rad', -MAX_ANGLE, MAX_ANGLE, default=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        check_topic_name('SimulatedObject.name', self.name)


@dataclasses.dataclass(frozen=True)
class PlannerOptions:
    """Options of the planner's node."""

    autostart: bool = quantity('configure and activate at the start', default=True)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity('longest wait of a message for its transform', 's', 0.0,
                                        10.0, default=0.3)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class ControllerOptions:
    """Options of the controller's node."""

    autostart: bool = quantity('configure and activate at the start', default=True)
    wait_for_start: bool = quantity('stand until controller/start is called; else go on as soon '
                                    'as there is a plan, or in a task a goal', default=False)
    enable_stamped_cmd_vel: bool = quantity('publish TwistStamped on cmd_vel, else Twist',
                                            default=True)
    task: bool = quantity('bring the object to the goal with as many pushes as that takes, the '
                          'robot anywhere at first; else follow one plan from its start',
                          default=False)
    map_required: bool = quantity('in a task: stand until a map has come', default=False)
    lockstep: bool = quantity('answer each measurement with one command of its stamp',
                              default=False)
    accept_unrequested_plans: bool = quantity(
        'in a single push: follow any plan on push_plan that starts where the object is, as one '
        'of planner/replan or of a program, else only answers to requests of this node',
        default=False)
    object_name: str = quantity('object file in place of object.*; empty: none', default='')
    object_folder: str = quantity('folder of object files, before config/objects; empty: none',
                                  default='')
    objects: tuple[NamedTopics, ...] = quantity(
        'several objects, whose poses come on objects/NAME/object_pose', default=())
    knowledge_file: str = quantity('YAML file that keeps what tasks learn of objects; empty: none',
                                   default='')
    base_file: str = quantity('YAML file that keeps what is learned of the base; empty: none',
                              default='')
    watchdog_timeout: float = quantity('time without odometry before a stop', 's', above=0.0,
                                       high=5.0, default=0.25)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity('longest wait of a message for its transform', 's', 0.0,
                                        10.0, default=0.3)
    publish_tf: bool = quantity('publish the estimated object pose as object_frame', default=True)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


# Between the values that a parameter of the base may have.
CHOICE_SEPARATOR = '|'


@dataclasses.dataclass(frozen=True)
class BaseParameter:
    """A parameter of the base's own node, and the values with which the robot can push."""

    name: str = quantity("parameter of the base's node")
    expected: str = quantity('value that it must have, as in a parameter file; several are '
                             f'separated by {CHOICE_SEPARATOR}')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for field in dataclasses.fields(self):
            if not getattr(self, field.name):
                raise ValueError(f'BaseParameter.{field.name}: got an empty text, expected a '
                                 f'{field.name}')


@dataclasses.dataclass(frozen=True)
class BaseSettings:
    """Checks of the base before each goal; see docs/robots."""

    node: str = quantity('node whose parameters are checked; empty: none', default='')
    parameters: tuple[BaseParameter, ...] = quantity('the parameters that are checked', default=())
    timeout: float = quantity('time to answer', 's', above=0.0, high=60.0, default=3.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if self.node and not self.parameters:
            raise ValueError(f'BaseSettings.parameters: got none, expected those of {self.node} '
                             'that are to be checked')


@dataclasses.dataclass(frozen=True)
class MonitorSource:
    """A sensor of the collision monitor that sees the pushed object."""

    name: str = quantity('source of the collision monitor, one of its observation_sources')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if not self.name:
            raise ValueError('MonitorSource.name: got an empty text, expected the name of a '
                             'source')


@dataclasses.dataclass(frozen=True)
class CollisionMonitorSettings:
    """Zone in which Nav2's collision monitor ignores the object while it is pushed."""

    node: str = quantity('collision monitor that is to ignore the object while a goal is pursued; '
                         'empty: none', default='')
    sources: tuple[MonitorSource, ...] = quantity('its sources that see the object', default=())
    margin: float = quantity('width of the ignored strip around the outline of the object', 'm',
                             0.0, 0.5, default=0.05)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if self.node and not self.sources:
            raise ValueError(f'CollisionMonitorSettings.sources: got none, expected those of '
                             f'{self.node} that see the object')


@dataclasses.dataclass(frozen=True)
class TrackerOptions:
    """Options of the tracker's node."""

    world_frame: str = quantity('frame of the published object poses', default='odom')
    object_pose_with_covariance: bool = quantity(
        'publish PoseWithCovarianceStamped on object_pose, else PoseStamped', default=True)
    max_rate: float = quantity('highest rate of object poses', 'Hz', above=0.0, high=1000.0,
                               default=50.0)
    transform_timeout: float = quantity('longest wait of an image for its transform', 's', 0.0,
                                        10.0, default=0.3)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if not self.world_frame:
            raise ValueError('TrackerOptions.world_frame: got an empty text, expected a frame id')


@dataclasses.dataclass(frozen=True)
class TaggedTopics:
    """One of several objects with tags, which has a topic of its own."""

    name: str = quantity('name of one of several objects: poses on objects/NAME/object_pose')
    tags: str = quantity('its tags: file, or name in config/tags')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        check_topic_name('TaggedTopics.name', self.name)


@dataclasses.dataclass(frozen=True)
class DetectorOptions:
    """Options of the node that detects tags."""

    tags: str = quantity('tags of the only object: file, or name in config/tags; empty: those of '
                         'objects', is_basic=True, default='')
    objects: tuple[TaggedTopics, ...] = quantity('several objects', default=())
    pose_frame: str = quantity(
        'frame of object poses, and of camera.*: base_link for a camera on the robot, odom or map '
        'for one in the room', is_basic=True, default='base_link')
    compressed: bool = quantity('take image_raw/compressed in place of image_raw', default=False)
    object_pose_with_covariance: bool = quantity(
        'publish PoseWithCovarianceStamped on object_pose, else PoseStamped', default=True)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if not self.pose_frame:
            raise ValueError('DetectorOptions.pose_frame: got an empty text, expected a frame id')
        names = [entry.name for entry in self.objects]
        if bool(self.tags) == bool(names) or len(set(names)) < len(names):
            raise ValueError(f'DetectorOptions.tags: got {self.tags!r} and the objects {names}, '
                             'expected one of the two, and each name once')

    @property
    def tags_by_object(self) -> dict[str, str]:
        """Files of tags by the names of objects; the only object has none."""
        return {entry.name: entry.tags for entry in self.objects} or {'': self.tags}


@dataclasses.dataclass(frozen=True)
class TidyOptions:
    """Options of the node that brings several objects to their goals."""

    objects: tuple[NamedTopics, ...] = quantity(
        'the objects, whose poses come on objects/NAME/object_pose')
    object_folder: str = quantity('folder of object files, before config/objects; empty: none',
                                  default='')
    pose_count: int = quantity('poses of an object at rest that are averaged', '', 1, 10_000,
                               default=10)
    measuring_timeout: float = quantity('longest wait for poses of all objects, map and odometry',
                                        's', 1.0, 3600.0, default=60.0)
    position_tolerance: float = quantity('distance from a goal that counts as there', 'm',
                                         MIN_TOLERANCE, MAX_TOLERANCE, default=0.01)
    heading_tolerance: float = quantity('heading error that does', 'rad', MIN_TOLERANCE,
                                        MAX_HEADING_TOLERANCE, default=0.0175)
    object_pose_with_covariance: bool = quantity(
        'object poses are PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity('longest wait of a message for its transform', 's', 0.0,
                                        10.0, default=0.3)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        names = [entry.name for entry in self.objects]
        if not names or len(set(names)) < len(names):
            raise ValueError(f'TidyOptions.objects.name: got {names}, expected different names, '
                             'at least one')


@dataclasses.dataclass(frozen=True)
class MocapOptions:
    """Frames of the odometry that is made of motion capture."""

    world_frame: str = quantity('frame of the poses, and of the published odometry',
                                default='odom')
    base_frame: str = quantity('frame of the robot', default='base_link')
    robot_frame: str = quantity('tf frame of the rigid body on the robot; empty: its poses come '
                                'on robot_pose', default='')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for name in ('world_frame', 'base_frame'):
            if not getattr(self, name):
                raise ValueError(f'MocapOptions.{name}: got an empty text, expected a frame id')


@dataclasses.dataclass(frozen=True)
class SimOptions:
    """Options of the simulator's node."""

    lockstep: bool = quantity('continue when the last measurement is answered; else wall clock',
                              default=False)
    publish_clock: bool = quantity('publish clock from 0, without lockstep', default=False)
    time_scale: float = quantity('simulated per wall time, with publish_clock', '', 0.01, 100.0,
                                 default=1.0)
    clock_rate: float = quantity('rate of clock in simulated time; in lockstep the maximum', 'Hz',
                                 above=0.0, high=1000.0, default=100.0)
    truth_prefix: str = quantity('prefix of the frames of true object and robot', default='truth/')
    autostart: bool = quantity('start at once, without sim/start', default=False)
    enable_stamped_cmd_vel: bool = quantity('expect TwistStamped on cmd_vel, else Twist',
                                            default=True)
    time_limit: float = quantity('simulated time at which the simulation holds; 0: none', 's', 0.0,
                                 1e6, default=0.0)
    answer_timeout: float = quantity('lockstep: wall time after which the controller counts as '
                                     'gone', 's', 0.1, 600.0, default=5.0)
    object_start: tuple[float, float, float] = quantity(
        'object pose (x, y, theta) at the start', 'm, m, rad', default=(0.0, 0.0, 0.0))
    robot_start: tuple[float, float, float] = quantity(
        'robot pose (x, y, theta) at the start', 'm, m, rad', default=(0.0, 0.0, 0.0))
    objects: tuple[SimulatedObject, ...] = quantity(
        'several objects in place of object.*, whose poses come on objects/NAME/object_pose',
        default=())
    object_folder: str = quantity('folder of object files, before config/objects; empty: none',
                                  default='')
    tape_path: str = quantity('tape (CSV) that is written at the end; empty: none', default='')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for name in ('object_start', 'robot_start'):
            pose = getattr(self, name)
            if len(pose) != 3 or not all(map(math.isfinite, pose)) or abs(pose[2]) > MAX_ANGLE:
                raise ValueError(f'SimOptions.{name}: got {pose}, expected three numbers, the '
                                 'last one in radians')
        if not self.truth_prefix:
            raise ValueError('SimOptions.truth_prefix: got an empty text, expected the beginning '
                             'of a frame id')
        if self.time_scale != 1.0 and not self.owns_time:
            raise ValueError(f'SimOptions.time_scale: got {self.time_scale:g}, expected 1 where '
                             'publish_clock is false')

    @property
    def owns_time(self):
        """Tell whether stamps are simulated time, and ``clock`` is published."""
        return self.lockstep or self.publish_clock
