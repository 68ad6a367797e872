"""Plant: the true object and the robot that pushes it."""

import math
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np
from push_dynamics import layout
from push_dynamics.actuation import limit_command
from push_dynamics.compiled import interpreted, IS_COMPILED, kernel_array, values_of
from push_dynamics.encoding import (
    body_values, drive_values, encode_velocities, initial_state, NO_OUTLINE, object_pose_of,
    object_twist_of, resolve_overlap, robot_pose_of, robot_twist_of, support_rows, WALL_FRICTION,
)
from push_dynamics.floor import floor_rows, FloorPatch
from push_dynamics.layout import World
from push_dynamics.step import advance, step_count
from push_dynamics.touches import MAX_TOUCHES
from push_dynamics.wall_grid import NO_WALLS, touch_reach, wall_grid
from push_dynamics.walls import Wall, wall_rows
from push_model.friction import check_tipping, has_heights
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP, Twist
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.imperfect_drive import ImperfectDrive, is_ideal
from push_sim_node.lidar import Lidar, LidarSensorSettings
from push_sim_node.sensors import PoseSensor, SensorSettings
from push_sim_node.tape_row import (
    columns_of, COMMAND, CONTACT, ENERGY, OBJECT, ROBOT, SUPPORTS, WALL_COLUMNS, write_row,
)
from push_sim_node.truth import ContactMode, Energy, Truth, WallTouch


class _Kernel(NamedTuple):
    """
    Functions of the kernel, compiled or plain.

    :param is_compiled: which of the two.
    :param advance: moves the plant on.
    :param write_row: writes a row of a tape.
    """

    is_compiled: bool
    advance: Callable[..., None]
    write_row: Callable[..., None]

    def array(self, values: Any) -> Any:
        """Lay numbers out as the functions read them fastest."""
        return kernel_array(values, self.is_compiled)

    def empty(self, count: int) -> Any:
        """Make room for numbers, likewise."""
        return np.empty(count) if self.is_compiled else [0.0] * count


def _make_kernel(interpret: bool) -> _Kernel:
    if interpret:
        return _Kernel(False, interpreted(advance), interpreted(write_row))
    return _Kernel(IS_COMPILED, advance, write_row)


# Lag and limits of a drive that has any velocity at once, in the order of ``layout``.
IMMEDIATE_DRIVE = (0.0, math.inf, math.inf)


class Plant:
    """
    Round robot, point or flat pusher against a rigid object on frictional supports.

    The object stays flat on the floor. With heights, loads shift from support to support at every
    step, and supports may lift.

    The robot is velocity-controlled: nothing that it touches slows it down, unless its wheels
    slip. It starts at rest; a robot that overlaps the object by up to 5 mm is moved back along the
    normal until it touches.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param step: longest step [s].
    :param smoothing: speed below which support friction turns viscous [m/s].
    :param floor: ``FloorPatch`` sequence.
    :param walls: ``Wall`` sequence, which object and robot do not pass.
    :param wall_friction: Coulomb coefficient between walls and what touches them.
    :param creep: slip of the contact at its friction limit over the distance that the robot's
        surface moves.
    :param imperfections: ``DriveImperfections`` of the base.
    :param interpret: whether to run it as plain Python, which is ready at once and slower, with
        the same results but for rounding.
    :raises ValueError: where robot and object overlap by more than 5 mm, or where a slow push
        would tip the object.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 step: float = 2e-3, smoothing: float = 1e-5, *,
                 floor: Sequence[FloorPatch] = (), walls: Sequence[Wall] = (),
                 wall_friction: float = WALL_FRICTION, creep: float = 0.0,
                 imperfections: DriveImperfections = DriveImperfections(),
                 interpret: bool = False) -> None:
        check_tipping(obj)
        self._kernel = _make_kernel(interpret)
        array = self._kernel.array
        self.obj = obj
        self.robot = robot
        self.step = step
        object_pose = Pose(*object_pose)
        robot_pose = resolve_overlap(obj, robot, object_pose, Pose(*robot_pose))
        self._command = STOP
        self._imperfect_drive = None if is_ideal(robot, imperfections) else ImperfectDrive(
            robot, imperfections, robot_pose, obj.mass)
        drive = drive_values(robot) if self._imperfect_drive is None else IMMEDIATE_DRIVE
        self._world = World(
            state=array(initial_state(obj, object_pose, robot_pose)),
            body=array(body_values(obj, robot, smoothing, creep, wall_friction)),
            supports=array(support_rows(obj, obj.capacities, [1.0] * len(obj.supports))),
            outline=array(obj.outline or NO_OUTLINE),
            floor=array(np.reshape(floor_rows(floor), (-1, layout.PATCH_SIZE))),
            forces=array([0.0] * (2 * len(obj.supports))),
            drive=array(drive),
            command=array(STOP),
            walls=NO_WALLS,
            touches=array(np.zeros((0, layout.TOUCH_SIZE))))
        self.set_walls(walls)
        self._has_walls = bool(walls)
        self._row_size = len(columns_of(obj, self._has_walls))
        self._compile()

    def set_friction_factors(self, factors: Sequence[float]) -> None:
        """
        Multiply the friction of the supports.

        :param factors: one factor for each support, of at least 0.
        """
        rows = support_rows(self.obj, self.obj.capacities, factors)
        self._world = self._world._replace(supports=self._kernel.array(rows))
        self._forget_acceleration()

    def set_contact_friction(self, coefficient: float) -> None:
        """
        Change the friction between robot and object.

        :param coefficient: Coulomb coefficient, of at least 0.
        """
        self._world.body[layout.CONTACT_FRICTION] = coefficient
        self._forget_acceleration()

    def set_walls(self, walls: Sequence[Wall]) -> None:
        """
        Replace the walls.

        :param walls: ``Wall`` sequence; rows of a tape keep the columns that they have.
        """
        array, reach = self._kernel.array, touch_reach(self.obj, self.robot.radius)
        grid = wall_grid(wall_rows(walls), reach)
        self._world = self._world._replace(
            walls=grid if self._kernel.is_compiled else grid.as_lists(),
            touches=array(np.zeros((MAX_TOUCHES if walls else 0, layout.TOUCH_SIZE))))
        for i in range(layout.WALL_SLACK, layout.ROBOT_AT_WALL + 1):
            self._world.state[i] = 0.0

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest, as a person would; the robot is not affected.

        :param pose: ``Pose`` of the object frame in the world.
        :raises ValueError: where it is not finite or the robot is in the way.
        """
        pose = Pose(*pose)
        robot_pose = self.robot_pose
        if resolve_overlap(self.obj, self.robot, pose, robot_pose) != robot_pose:
            raise ValueError(f'pose: got {tuple(pose)}, expected one beside the robot')
        state = initial_state(self.obj, pose, robot_pose)
        for i in (*range(layout.X, layout.A_OMEGA + 1), layout.PRESSURE_X, layout.PRESSURE_Y,
                  layout.WALL_SLACK):
            self._world.state[i] = state[i]

    def make_lidar(self, settings: LidarSensorSettings, walls: Sequence[Wall],
                   noise: np.random.Generator) -> Lidar:
        """
        Make the lidar of the robot.

        :param settings: ``LidarSensorSettings``, with a rate above 0.
        :param walls: ``Wall`` sequence that it sees.
        :param noise: ``numpy.random.Generator`` of noise and outliers.
        """
        return Lidar(settings, self.obj, walls, noise)

    def make_pose_sensor(self, settings: SensorSettings, noise: np.random.Generator,
                         losses: np.random.Generator, outliers: np.random.Generator) -> PoseSensor:
        """Make the sensor of object poses; parameters as of ``PoseSensor``."""
        return PoseSensor(settings, noise, losses, outliers)

    def stand_at(self, object_pose: Pose, robot_pose: Pose) -> None:
        """
        Put object and robot where they have been before, at rest and without contact force.

        :param object_pose: ``Pose`` of the object frame in the world.
        :param robot_pose: ``Pose`` of the robot in the world.
        """
        state = initial_state(self.obj, Pose(*object_pose), Pose(*robot_pose))
        for i in (*range(layout.X, layout.TANGENTIAL_FORCE + 1), layout.WALL_SLACK):
            self._world.state[i] = state[i]

    def take_over_robot(self, previous: 'Plant') -> None:
        """
        Let the robot go on as it moves in another plant; the object stands.

        :param previous: plant of the same robot, which is where it is here.
        """
        self._imperfect_drive = previous._imperfect_drive
        if self._imperfect_drive is not None:
            self._imperfect_drive.set_object_mass(self.obj.mass)
        self.set_velocities(STOP, previous.robot_twist)

    def set_velocities(self, object_twist: Twist, robot_twist: Twist) -> None:
        """
        Let object and robot move, as if they had done so before.

        :param object_twist: velocity of the object frame's origin, world axes.
        :param robot_twist: velocity of the robot, own axes.
        """
        encode_velocities(self._world.state, self.obj.center_of_mass, object_twist, robot_twist)
        self._forget_acceleration()

    def advance(self, duration: float, command: Twist = STOP) -> None:
        """
        Let time pass while one command stands.

        :param duration: how long [s], above 0.
        :param command: ``Twist`` for the robot, its own axes; limits of the drive apply.
        :raises ValueError: where the command is not finite or not possible for the drive.
        """
        if not (math.isfinite(duration) and duration > 0.0):
            raise ValueError(f'duration: got {duration!r}, expected a finite time above 0 [s]')
        if self._imperfect_drive is None:
            self._follow(duration, command)
            return
        self._imperfect_drive.command(limit_command(self.robot, command))
        count = step_count(duration, self.step)
        for _ in range(count):
            velocity = self._imperfect_drive.step(duration / count, *self._load_on_robot())
            self._follow(duration / count, velocity)

    def _follow(self, duration: float, command: Twist) -> None:
        """Move on while the drive, with its lag and limits, follows a command."""
        if command != self._command:
            self._world = self._world._replace(
                command=self._kernel.array(limit_command(self.robot, command)))
            self._command = command
            if self._imperfect_drive is None:
                self._forget_acceleration()
        self._kernel.advance(self._world, duration, self.step)

    def _load_on_robot(self) -> tuple[tuple[float, float], float]:
        """Return force, own axes [N], and moment [N m] of the object on the robot in one step."""
        if self._value(layout.NORMAL_FORCE) == 0.0:
            return (0.0, 0.0), 0.0
        truth, pose = self.truth(0.0), self.robot_pose
        c, s = math.cos(truth.normal), math.sin(truth.normal)
        force = s * truth.force_t - c * truth.force_n, -s * truth.force_n - c * truth.force_t
        arm = truth.contact_point[0] - pose.x, truth.contact_point[1] - pose.y
        x, y = Pose(0.0, 0.0, -pose.theta).rotate(force)
        return (float(x), float(y)), arm[0] * force[1] - arm[1] * force[0]

    @property
    def object_pose(self) -> Pose:
        """Pose of the object frame in the world; the angle is not wrapped."""
        return object_pose_of(self._world.state, self.obj.center_of_mass)

    @property
    def object_twist(self) -> Twist:
        """Velocity of the object frame's origin, world axes, and yaw rate."""
        return object_twist_of(self._world.state, self.obj.center_of_mass)

    @property
    def robot_pose(self) -> Pose:
        """Pose of the robot in the world; the angle is not wrapped."""
        return robot_pose_of(self._world.state)

    @property
    def robot_twist(self) -> Twist:
        """Velocity of the robot, own axes."""
        return robot_twist_of(self._world.state)

    @property
    def odometry_pose(self) -> Pose:
        """Pose of the robot by what its wheels turned; the angle is not wrapped."""
        drive = self._imperfect_drive
        return self.robot_pose if drive is None else drive.odometry_pose

    @property
    def odometry_twist(self) -> Twist:
        """Velocity of the robot by what its wheels turn, own axes."""
        drive = self._imperfect_drive
        return self.robot_twist if drive is None else drive.odometry_twist

    @property
    def mode(self) -> ContactMode:
        """Contact mode over the last step."""
        return ContactMode.from_code(self._value(layout.MODE))

    @property
    def steps(self) -> int:
        """Number of steps since the start."""
        return int(self._value(layout.STEPS))

    @property
    def unsolved_steps(self) -> int:
        """Number of steps whose velocities are off their equations by more than 0.1 mm/s."""
        return int(self._value(layout.UNSOLVED_STEPS))

    @property
    def energy(self) -> Energy:
        """``Energy`` since the start."""
        return Energy(*values_of(self.row(0.0))[ENERGY:SUPPORTS])

    def row(self, time: float, command: Twist = STOP) -> Any:
        """
        Make a row of a tape.

        :param time: simulated time that it carries [s].
        :param command: ``Twist`` that the robot has.
        :return: numbers by ``columns_of`` the object, as the kernel lays them out.
        """
        row = self._kernel.empty(self._row_size)
        self._kernel.write_row(row, self._world)
        row[0] = time
        row[COMMAND:COMMAND + 3] = command
        end = self._row_size
        if self._has_walls:
            start = end - len(WALL_COLUMNS)
            row[start:end] = self._world.state[layout.WALL_FORCE_X:layout.ROBOT_AT_WALL + 1]
            end = start
        if has_heights(self.obj):
            row[end - len(self.obj.supports):end] = self._support_loads
        return row

    def is_bumper_pressed(self, force: float, time: float) -> bool:
        """
        Tell whether object or wall press the bumper of the robot.

        :param force: that closes its switch [N].
        :param time: now [s].
        """
        truth = self.truth(time)
        return truth.force_n > force or truth.walls.holds_robot

    def truth(self, time: float) -> Truth:
        """
        Sample everything at once.

        :param time: simulated time that the sample carries [s].
        """
        # Numbers of a list are read several times faster than those of an array.
        row = values_of(self.row(time))
        mode, force_n, force_t, gap, pushing_angle, x, y, normal = row[CONTACT:ENERGY]
        forces = row[SUPPORTS:SUPPORTS + 2 * len(self.obj.supports)]
        return Truth(
            time=time,
            object_pose=Pose(*row[OBJECT:OBJECT + 3]),
            object_twist=Twist(*row[OBJECT + 3:OBJECT + 6]),
            robot_pose=Pose(*row[ROBOT:ROBOT + 3]),
            robot_twist=Twist(*row[ROBOT + 3:ROBOT + 6]),
            mode=ContactMode.from_code(mode),
            contact_point=(x, y),
            normal=normal,
            gap=gap,
            pushing_angle=pushing_angle,
            force_n=force_n,
            force_t=force_t,
            support_forces=tuple(zip(forces[::2], forces[1::2])),
            support_loads=self._support_loads,
            energy=Energy(*row[ENERGY:SUPPORTS]),
            walls=self._wall_touch)

    @property
    def _wall_touch(self) -> WallTouch:
        """How walls touch object and robot."""
        x, y, count, depth, holds = map(float, self._world.state[
            layout.WALL_FORCE_X:layout.ROBOT_AT_WALL + 1])
        return WallTouch((x, y), int(count), depth, holds > 0.0)

    @property
    def _support_loads(self) -> tuple[float, ...]:
        """Loads on all supports [N]."""
        return tuple(load * float(support[layout.LOAD_RATIO])
                     for load, support in zip(self.obj.loads, self._world.supports))

    def _compile(self) -> None:
        # Seconds where no machine code is kept on disk: better here than while time runs.
        functions = advance, write_row
        if not self._kernel.is_compiled or all(getattr(function, 'is_loaded', True)
                                               for function in functions):
            return
        self.truth(0.0)
        world, array = self._world, self._kernel.array
        copy = world._replace(state=array(world.state), supports=array(world.supports),
                              forces=array(world.forces))
        self._kernel.advance(copy, self.step, self.step)

    def _forget_acceleration(self) -> None:
        # What has changed at once makes the acceleration of the last step a bad prediction.
        for i in (layout.A_X, layout.A_Y, layout.A_OMEGA):
            self._world.state[i] = 0.0

    def _value(self, index: int) -> float:
        return float(self._world.state[index])
