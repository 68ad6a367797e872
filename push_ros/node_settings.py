"""Settings of a node besides physics and tuning: frames, modes, files."""

import dataclasses
import math

from push_model.quantity import check, MAX_ANGLE, quantity


@dataclasses.dataclass(frozen=True)
class Frames:
    """Frame ids; messages in other frames are brought to the world frame by tf."""

    world_frame: str = quantity('frame of odometry, object poses, goals and plans',
                                default='odom')
    object_frame: str = quantity('frame of the object', default='object')
    base_frame: str = quantity('frame of the robot, in whose axes commands are',
                               default='base_link')

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for field in dataclasses.fields(self):
            if not getattr(self, field.name):
                raise ValueError(f'Frames.{field.name}: got an empty text, expected a frame id')


@dataclasses.dataclass(frozen=True)
class PlannerOptions:
    """How the planner's node behaves."""

    autostart: bool = quantity('configure and activate the node at its start; else whoever calls '
                               'change_state does', default=True)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity(
        'time that a pose, goal or map in another frame waits for its transform', 's', 0.0, 10.0,
        default=0.3)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class ControllerOptions:
    """How the controller's node behaves."""

    autostart: bool = quantity('configure and activate the node at its start; else whoever calls '
                               'change_state does', default=True)
    wait_for_start: bool = quantity('stand until controller/start is called; else go on as soon '
                                    'as there is a plan, or in a task a goal', default=False)
    enable_stamped_cmd_vel: bool = quantity('publish TwistStamped on cmd_vel, else Twist',
                                            default=True)
    task: bool = quantity('bring the object to the goal with as many pushes as that takes, the '
                          'robot anywhere at first; else follow one plan from its start',
                          default=False)
    lockstep: bool = quantity('for a simulator in lockstep: answer every measurement with one '
                              'command that has its stamp, in a task not before a pending plan is '
                              'there; a goal holds from the time of its stamp on', default=False)
    object_name: str = quantity('name of the object; setting it takes the object of that name in '
                                'place of object.*, as a goal of the action that states it does; '
                                'empty for none', default='')
    object_folder: str = quantity('folder with object files like those in config/objects, over '
                                  'which they take precedence; empty for none', default='')
    knowledge_file: str = quantity('in a task: YAML file in which what was learned of the object '
                                   'is kept from one run of the node to the next, empty for none',
                                   default='')
    watchdog_timeout: float = quantity('time without odometry after which the robot is stopped',
                                       's', above=0.0, high=5.0, default=0.25)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity(
        'time that a pose, goal or map in another frame waits for its transform', 's', 0.0, 10.0,
        default=0.3)
    publish_tf: bool = quantity('publish the estimated pose of the object as a transform from '
                                'world_frame to object_frame, where tf2_msgs is installed',
                                default=True)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


# Between the values that a parameter of the base may have.
CHOICE_SEPARATOR = '|'


@dataclasses.dataclass(frozen=True)
class BaseParameter:
    """A parameter of the base's own node, and the values with which the robot can push."""

    name: str = quantity("name of the parameter, as the base's node has it")
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
    """What is checked of the base before each goal; see docs/robots."""

    node: str = quantity('node of the base whose parameters are checked, relative to the '
                         'namespace of the controller; empty for no check', default='')
    parameters: tuple[BaseParameter, ...] = quantity('the parameters that are checked', default=())
    timeout: float = quantity('time that the base has for its answer', 's', above=0.0, high=60.0,
                              default=3.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if self.node and not self.parameters:
            raise ValueError(f'BaseSettings.parameters: got none, expected those of {self.node} '
                             'that are to be checked')


@dataclasses.dataclass(frozen=True)
class TrackerOptions:
    """How the tracker's node behaves."""

    world_frame: str = quantity('frame of the object poses that are published', default='odom')
    object_pose_with_covariance: bool = quantity(
        'publish PoseWithCovarianceStamped on object_pose, else PoseStamped', default=True)
    max_rate: float = quantity('most object poses per second of their stamps', 'Hz', above=0.0,
                               high=1000.0, default=50.0)
    transform_timeout: float = quantity('time that an image waits for the transform to the world',
                                        's', 0.0, 10.0, default=0.3)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        if not self.world_frame:
            raise ValueError('TrackerOptions.world_frame: got an empty text, expected a frame id')


@dataclasses.dataclass(frozen=True)
class SimOptions:
    """How the simulator's node behaves."""

    lockstep: bool = quantity('own time: go on as soon as the command has come that answers the '
                              'last measurement; else keep to the wall clock', default=False)
    publish_clock: bool = quantity('without lockstep: publish clock, from 0; else stamps are '
                                   "those of the node's clock", default=False)
    time_scale: float = quantity('simulated time per wall time, without lockstep; other than 1 '
                                 'only with publish_clock', '', 0.01, 100.0, default=1.0)
    clock_rate: float = quantity('rate of clock in simulated time; in lockstep clock is published '
                                 'with the measurements, at most at this rate', 'Hz', above=0.0,
                                 high=1000.0, default=100.0)
    truth_prefix: str = quantity('prefix of the frames of the true object and the true robot, in '
                                 'tf and contact_wrench', default='truth/')
    autostart: bool = quantity('start at once, without sim/start', default=False)
    enable_stamped_cmd_vel: bool = quantity('expect TwistStamped on cmd_vel, else Twist',
                                            default=True)
    time_limit: float = quantity('simulated time after which the simulation holds, 0 for none',
                                 's', 0.0, 1e6, default=0.0)
    answer_timeout: float = quantity('lockstep: wall time without an answer after which the '
                                     'controller counts as gone', 's', 0.1, 600.0,
                                     default=5.0)
    object_start: tuple[float, float, float] = quantity(
        'object pose (x, y, theta) at the start', 'm, m, rad', default=(0.0, 0.0, 0.0))
    robot_start: tuple[float, float, float] = quantity(
        'robot pose (x, y, theta) at the start', 'm, m, rad', default=(0.0, 0.0, 0.0))
    tape_path: str = quantity('file for the tape (CSV) that is written at the end, empty for none',
                              default='')

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
        """Whether stamps are simulated time, and ``clock`` is published."""
        return self.lockstep or self.publish_clock
