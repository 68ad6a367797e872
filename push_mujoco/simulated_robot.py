"""
A simulated robot: masses, wheels, bumper, and where its sensors are, as in ``config/mujoco``.

A push at height h lifts the front, where the caster stands at c, and loads the wheels. With the
mass m centred at x, and friction mu of the wheels, moments about the caster give the largest force

    F = mu N,    N = m g (1 - x / c) / (1 - mu h / c)

as long as the caster stands, F h < m g x. Beyond, the robot leans on its rear edge at -s, and

    F = mu N,    N = m g (1 + x / s) / (1 + mu h / s)
"""

import dataclasses
import math
from pathlib import Path

from push_model.files.mapping import from_mapping, Location
from push_model.files.parameter_files import named_file
from push_model.files.strict_yaml import load_yaml
from push_model.parameters import Drive, DRIVES, GRAVITY, RoundRobot
from push_model.quantity import check, quantity
from push_mujoco.camera import SimulatedCamera

FOLDER = 'mujoco'
# Robot of ``config/mujoco`` for a drive.
DEFAULT_ROBOTS: dict[Drive, str] = {'differential': 'turtlebot4', 'holonomic': 'holonomic'}


@dataclasses.dataclass(frozen=True)
class SimulatedRobot:
    """
    Masses and measures of a robot, its origin below the middle of its axle.

    A differential drive stands on two wheels and a caster, which have no meaning for a holonomic
    base: that pushes with what its wheels hold in any direction.
    """

    body_mass: float = quantity('mass of all but the wheels', 'kg', above=0.0, high=500.0)
    body_inertia: tuple[float, float, float] = quantity(
        'inertia of it about its centre and the axes (x, y, z)', 'kg m^2', above=0.0)
    body_center: tuple[float, float, float] = quantity(
        'centre of it (x, y, z)', 'm', -2.0, 2.0)
    bumper_radius: float = quantity('radius of the bumper, a ring about the origin', 'm',
                                    above=0.0, high=5.0)
    drive: Drive = quantity('kinematics of the base', choices=DRIVES, default='differential')
    body_height: float = quantity('height of its body, as cameras see it', 'm', above=0.0,
                                  high=3.0, default=0.3)
    bumper_height: float = quantity('height of the bumper, where it meets walls', 'm', above=0.0,
                                    high=2.0, default=0.05)
    wheel_mass: float = quantity('mass of one wheel', 'kg', above=0.0, high=50.0, default=0.2)
    wheel_radius: float = quantity('radius of the wheels', 'm', above=0.0, high=1.0, default=0.036)
    wheel_width: float = quantity('width of the wheels', 'm', above=0.0, high=1.0, default=0.015)
    track: float = quantity('distance between the wheels', 'm', above=0.0, high=5.0, default=0.233)
    wheel_friction: float = quantity('coefficient between wheels and floor', '', 0.0, 3.0,
                                     default=0.6)
    motor_torque: float = quantity('largest torque on one wheel', 'N m', 0.0, 1000.0, default=1.0)
    max_acceleration: float = quantity("acceleration of a wheel's rim while it follows a command",
                                       'm/s^2', above=0.0, high=100.0, default=0.9)
    ticks_per_turn: float = quantity('steps that odometry counts in a turn of a wheel', '', 1.0,
                                     1e6, default=500.0)
    has_gyro: bool = quantity('whether odometry takes the heading from a gyro, not from ticks',
                              default=False)
    gyro_scale: float = quantity('relative error of the gyro', '', -0.1, 0.1, default=0.005)
    caster_x: float = quantity('where the caster stands', 'm', -2.0, 2.0, default=0.125)
    caster_radius: float = quantity('radius of the caster', 'm', above=0.0, high=1.0, default=0.01)
    caster_friction: float = quantity('coefficient between caster and floor', '', 0.0, 3.0,
                                      default=0.1)
    rear_x: float = quantity('where its rear edge touches the floor as it tilts', 'm', -2.0, -0.01,
                             default=-0.15)
    rear_clearance: float = quantity('height of that edge while it stands', 'm', 1e-3, 0.1,
                                     default=0.005)
    lidar_height: float = quantity('height of the plane of the lidar', 'm', 0.0, 3.0, default=0.2)
    camera: SimulatedCamera = SimulatedCamera()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        for name in ('body_inertia', 'body_center'):
            if len(getattr(self, name)) != 3:
                raise ValueError(f'SimulatedRobot.{name}: got {getattr(self, name)}, expected '
                                 'three numbers (x, y, z)')

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        wheels = 2.0 * self.wheel_mass if self.drive == 'differential' else 0.0
        return self.body_mass + wheels

    @property
    def center_x(self) -> float:
        """How far the centre of mass is ahead of the axle [m]."""
        return self.body_mass * self.body_center[0] / self.mass

    @property
    def lifting_force(self) -> float:
        """Force of a push that lifts the caster, unless the wheels spin before [N]."""
        return self.mass * GRAVITY * self.center_x / self.bumper_height

    @property
    def traction(self) -> float:
        """Force of a push at which the wheels spin, however strong the motors are [N]."""
        mu, caster, rear = self.wheel_friction, self.caster_x, -self.rear_x
        weight, height = self.mass * GRAVITY, self.bumper_height
        if self.drive == 'holonomic':
            return mu * weight
        standing = mu * weight * (1.0 - self.center_x / caster) / (1.0 - mu * height / caster)
        if standing < self.lifting_force:
            return standing
        return mu * weight * (1.0 + self.center_x / rear) / (1.0 + mu * height / rear)

    def shaped_as(self, robot: RoundRobot) -> 'SimulatedRobot':
        """
        Give it the outline and the track of another description of the robot.

        :raises ValueError: where that has another drive, or no outline that can be touched.
        """
        if robot.drive != self.drive:
            raise ValueError(f'robot.drive: got {robot.drive}, expected {self.drive}, that of the '
                             'robot in MuJoCo')
        if not 0.0 < robot.radius < math.inf:
            raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot in '
                             'MuJoCo, neither a point nor a flat pusher')
        return dataclasses.replace(self, bumper_radius=robot.radius, track=robot.wheel_track)


def read_simulated_robot(name: str | Path) -> SimulatedRobot:
    """
    Read a robot by path, or by name among those of the package.

    :param name: path of a file, or name such as ``turtlebot4``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = named_file(FOLDER, name)
    return from_mapping(SimulatedRobot, load_yaml(path), Location(path))
