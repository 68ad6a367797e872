"""Plant and sensors in simulated time: one measurement after the other, and commands between."""

from collections.abc import Callable, Sequence
import enum
import heapq
import math
from typing import NamedTuple, TypeAlias

import numpy as np
from push_dynamics.actuation import limit_command
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.odometry_history import OdometryHistory
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import LidarScan, ObjectPose, Odometry, STOP, Twist
from push_sim_node.camera import Camera, mirrored_tilt, relative_pose
from push_sim_node.disturbance import (
    change_times, friction_factors, NANOSECONDS, ObjectDisplacement)
from push_sim_node.lidar import BodyPoses, Lidar
from push_sim_node.plant import Plant
from push_sim_node.sensors import OdometrySensor, SensorSettings, Sighting
from push_sim_node.settings import SimulationSettings
from push_sim_node.tape import Tape
from push_sim_node.tape_row import columns_of
from push_sim_node.truth import Truth

# Measurement of any sensor.
Measurement: TypeAlias = Odometry | ObjectPose | LidarScan
# Number of the random stream of the lidar, beside those of a spawned seed.
LIDAR_STREAM = 1


class _EventKind(enum.IntEnum):
    """Kind of an event; of events that are due together the lower kind comes first."""

    MEASURE_POSE = 0
    DELIVER_POSE = 1
    MEASURE_ODOMETRY = 2
    # Placed by odometry of its time, which has to come first.
    DELIVER_RELATIVE_POSE = 3
    # Corrected by odometry up to its end.
    DELIVER_SCAN = 4


class _Event(NamedTuple):
    """
    An event of simulated time; ordered by its fields, of which ``order`` is unique.

    :param time: when [ns].
    :param kind: ``_EventKind``.
    :param order: number in the order of scheduling.
    :param sample_index: of a measurement, 0 for the first of its sensor.
    :param pose: the measurement that is delivered, if any.
    """

    time: int
    kind: _EventKind
    order: int
    sample_index: int
    pose: ObjectPose | None


class _EventQueue:
    """Events to come, the earliest first."""

    def __init__(self) -> None:
        self._heap: list[_Event] = []
        self._count = 0

    def schedule(self, time: int, kind: _EventKind, index: int,
                 pose: ObjectPose | None = None) -> None:
        self._count += 1
        heapq.heappush(self._heap, _Event(time, kind, self._count, index, pose))

    def pop(self) -> _Event:
        return heapq.heappop(self._heap)

    def drop_poses(self) -> None:
        """Drop the object poses that are on their way."""
        self._heap = [event for event in self._heap if event.pose is None]
        heapq.heapify(self._heap)


class _Disturbances:
    """
    Disturbances to come: changes of the friction, and displacements of the object.

    ``next_time``: of the earliest, infinite where there is none [ns].
    """

    def __init__(self, settings: SimulationSettings) -> None:
        self._friction_times = [_nanoseconds(t) for t in change_times(settings.friction_changes)]
        self._displacements = sorted(settings.object_displacements,
                                     key=lambda displacement: displacement.time)
        self._note_next_time()

    def pop_friction_changes(self, now: int) -> bool:
        """Drop the friction changes that are due; return whether there were any."""
        times = self._friction_times
        self._friction_times = [time for time in times if time > now]
        self._note_next_time()
        return len(self._friction_times) < len(times)

    def pop_displacement(self, now: int) -> ObjectDisplacement | None:
        """Drop the displacement that is due, and return it; None where none is."""
        if not self._displacements or _nanoseconds(self._displacements[0].time) > now:
            return None
        displacement = self._displacements.pop(0)
        self._note_next_time()
        return displacement

    def _note_next_time(self) -> None:
        times = [_nanoseconds(displacement.time) for displacement in self._displacements[:1]]
        self.next_time = min([math.inf, *self._friction_times[:1], *times])


class Simulation:
    """
    Simulated time, in steps from one measurement to the next.

    Times are whole nanoseconds inside. At time 0 the first object pose and then the first odometry
    are delivered, without latency or loss: the object has stood still before. Where a camera does
    not see the object, its pose is left out. Of measurements that are due together, object poses
    come first, but for those that are relative to the robot: odometry at their time tells where
    they are in the world. The robot stops when no command has come for
    ``command_timeout``. Where the robot is in the way of a displacement of the object, time cannot
    go on: a ``ValueError`` says so.

    ``time``: simulated time [s].

    ``rows`` has a row in the order of ``columns`` for every odometry time, SI units, before the
    command that answers it. ``object_v`` is in world axes, ``robot_v`` and ``command`` in the
    robot's own, angles are not wrapped, ``mode`` is ``ContactMode.code``, and ``pushing_angle``
    is nan without contact; the rest is as in ``Truth``, as is the friction ``support_0_x``,
    ``support_0_y``, ... on each support [N] behind the other columns, and ``WallTouch`` where
    there are walls.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object at time 0.
    :param robot_pose: ``Pose`` of the robot at time 0.
    :param settings: ``SimulationSettings``.
    :param sensors: ``SensorSettings``.
    :param interpret: whether the plant runs as plain Python, see ``Plant``.
    :param plant_type: makes a ``Plant`` of the arguments of that class; another engine may move
        the bodies.
    :param after_motion: called each time that the bodies have moved, before they are measured;
        returns whether the robot has moved into something else.
    :raises ValueError: where robot and object overlap, or friction changes under a support that
        does not exist.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 settings: SimulationSettings = SimulationSettings(),
                 sensors: SensorSettings = SensorSettings(), *,
                 interpret: bool = False, plant_type: Callable[..., Plant] = Plant,
                 after_motion: Callable[[], bool] | None = None) -> None:
        self.obj = obj
        self.robot = robot
        self.settings = settings
        self.sensors = sensors
        self._start = (Pose(*object_pose), Pose(*robot_pose))
        self._interpret = interpret
        self._plant_type = plant_type
        self._after_motion = after_motion
        self.reset()

    def reset(self, object_pose: Pose | None = None) -> None:
        """
        Restart at time 0, with the same random errors.

        :param object_pose: where the object stands instead; None for where it stood at first.
        :raises ValueError: where robot and object overlap.
        """
        settings = self.settings
        object_start, robot_start = self._start
        if object_pose is not None:
            object_start = Pose(*object_pose)
        self.plant = self._make_plant(object_start, robot_start)
        # A stream for each error, so that none depends on how often another is drawn.
        pose_noise, losses, biases, twist_noise, odometry_noise, outliers = (
            np.random.default_rng(seed)
            for seed in np.random.SeedSequence(settings.seed).spawn(6))
        self._pose_sensor = self.plant.make_pose_sensor(self.sensors, pose_noise, losses,
                                                        outliers)
        self._odometry_sensor = OdometrySensor(self.sensors, self.plant.robot_pose, biases,
                                               twist_noise, odometry_noise)
        self._camera = self._make_camera()
        self._lidar = self._make_lidar()
        self._odometry_history = OdometryHistory()
        self._touches_other = False
        self._set_now(0)
        # A command, and when the robot stops if no other has come [ns].
        self._command, self._deadline = STOP, 0
        self._events = _EventQueue()
        self._disturbances = _Disturbances(settings)
        self.rows: list[FloatArray | list[float]] = []
        self._disturbances.pop_friction_changes(0)
        self._apply_friction()
        self._events.schedule(0, _EventKind.MEASURE_POSE, 0)
        self._events.schedule(0, _EventKind.MEASURE_ODOMETRY, 0)
        if self._lidar is not None:
            self._observe_bodies()
            self._events.schedule(_nanoseconds(self._lidar.period), _EventKind.DELIVER_SCAN, 0)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of ``rows``, see ``columns_of``."""
        return columns_of(self.obj, bool(self.settings.walls))

    @property
    def tape(self) -> Tape:
        """
        ``Tape`` of the run so far.

        :raises ValueError: where there is no row yet.
        """
        return Tape(self.columns, np.array(self.rows))

    @property
    def truth(self) -> Truth:
        """``Truth`` now."""
        return self.plant.truth(self.time)

    @property
    def is_object_seen(self) -> bool:
        """Tell whether the camera sees the object now; without a camera it is always seen."""
        return self._camera.sees(self.plant.object_pose, self.plant.robot_pose)

    @property
    def is_bumper_pressed(self) -> bool | None:
        """Tell whether the switch of the bumper is closed; None where there is none."""
        if self.sensors.bumper_force == 0.0:
            return None
        return (self.plant.is_bumper_pressed(self.sensors.bumper_force, self.time)
                or self._touches_other)

    def set_sensors(self, sensors: SensorSettings) -> None:
        """Measure with other errors, rates and latency from the next measurements on."""
        self.sensors = sensors
        self._pose_sensor.set_settings(sensors)
        self._odometry_sensor.set_settings(sensors)
        self._camera = self._make_camera()

    def command(self, twist: Twist) -> None:
        """
        Command the robot, from now on.

        :param twist: ``Twist`` in the robot's own axes.
        :raises ValueError: where it is not finite or not possible for the drive.
        """
        limit_command(self.robot, twist)
        self._command = Twist(*map(float, twist))
        self._deadline = self._now + _nanoseconds(self.settings.command_timeout)

    def next_measurement(self) -> Measurement:
        """
        Let time pass until the next measurement is delivered.

        :return: the measurement.
        """
        while True:
            event = self._events.pop()
            self._advance_to(event.time)
            if event.kind is _EventKind.MEASURE_POSE:
                self._measure_pose(event)
            elif event.kind is _EventKind.DELIVER_SCAN:
                if self._lidar is not None:
                    return self._measure_scan(event, self._lidar)
            elif event.pose is None:
                return self._measure_odometry(event)
            elif event.kind is _EventKind.DELIVER_POSE:
                return event.pose
            else:
                placed = self._odometry_history.place(event.pose)
                if placed is not None:
                    return placed

    def turn_to(self, obj: PushedObject, object_pose: Pose) -> None:
        """
        Let another object be the one that is pushed and measured; time and robot go on.

        Poses of the object of before that are on their way are lost. ``rows`` start over.

        :param obj: the true ``PushedObject``, at rest.
        :param object_pose: its ``Pose`` in the world.
        :raises ValueError: where robot and object overlap.
        """
        previous = self.plant
        self.obj = obj
        self.plant = self._make_plant(object_pose, previous.robot_pose)
        self.plant.take_over_robot(previous)
        self._apply_friction()
        self._camera = self._make_camera()
        self._lidar = self._make_lidar()
        self._observe_bodies()
        self._events.drop_poses()
        self.rows = []

    def _make_plant(self, object_pose: Pose, robot_pose: Pose) -> Plant:
        settings = self.settings
        return self._plant_type(
            self.obj, self.robot, object_pose, robot_pose, settings.step,
            settings.friction_smoothing, floor=settings.floor_patches, walls=settings.walls,
            wall_friction=settings.wall_friction, creep=settings.contact_creep,
            imperfections=settings.drive, interpret=self._interpret)

    def _make_camera(self) -> Camera:
        return Camera(self.sensors.camera, self.obj, self.robot.radius)

    def show_standing(self, outlines: Sequence[Wall]) -> None:
        """
        Let the lidar see objects that stand beside the one that is pushed.

        :param outlines: ``Wall`` along each of their sides; in place of those of before.
        """
        if self._lidar is not None:
            self._lidar.set_walls((*self.settings.walls, *outlines))

    def show_visitor(self, outline: FloatArray) -> None:
        """
        Let the lidar see something that no map has, and that neither robot nor object touches.

        :param outline: as of ``Lidar.show``.
        """
        if self._lidar is not None:
            self._lidar.show(outline)

    def _make_lidar(self) -> Lidar | None:
        """Make the lidar, whose errors have a stream of their own; None where there is none."""
        if self.sensors.lidar.rate == 0.0:
            return None
        return self.plant.make_lidar(self.sensors.lidar, self.settings.walls,
                                     np.random.default_rng((self.settings.seed, LIDAR_STREAM)))

    def _measure_scan(self, event: _Event, lidar: Lidar) -> LidarScan:
        index = event.sample_index + 1
        self._events.schedule(_nanoseconds((index + 1) * lidar.period), _EventKind.DELIVER_SCAN,
                              index)
        return lidar.measure(event.sample_index * lidar.period)

    def _observe_bodies(self) -> None:
        """Show robot and object to the lidar."""
        if self._lidar is not None:
            self._lidar.observe(BodyPoses(self.time, self.plant.robot_pose,
                                          self.plant.object_pose))

    def _measure_odometry(self, event: _Event) -> Odometry:
        index = event.sample_index + 1
        self._events.schedule(_nanoseconds(index / self.sensors.odometry_rate),
                              _EventKind.MEASURE_ODOMETRY, index)
        self.rows.append(self.plant.row(self.time, self._active_command()))
        is_absolute = self.sensors.odometry_reference == 'absolute'
        pose = self.plant.robot_pose if is_absolute else self.plant.odometry_pose
        measured = self._odometry_sensor.measure(self.time, pose, self.plant.odometry_twist)
        self._odometry_history.append(measured)
        return measured

    def _measure_pose(self, event: _Event) -> None:
        index = event.sample_index + 1
        self._events.schedule(_nanoseconds(index / self.sensors.pose_rate),
                              _EventKind.MEASURE_POSE, index)
        object_pose, robot_pose = self.plant.object_pose, self.plant.robot_pose
        is_seen = self._camera.sees(object_pose, robot_pose)
        is_first = event.sample_index == 0
        x, y = object_pose.inverse().transform(self._camera.pose(robot_pose)[:2])
        bearing = math.atan2(y, x)
        pose = self._pose_sensor.measure(
            self.time, object_pose,
            Sighting(bearing, self._camera.distance(object_pose, robot_pose),
                     mirrored_tilt(self.obj, bearing)), certain=is_first)
        if pose is None or not is_seen:
            return
        kind = _EventKind.DELIVER_POSE
        if self.sensors.camera.is_relative:
            kind = _EventKind.DELIVER_RELATIVE_POSE
            pose = pose._replace(relative=relative_pose(pose.pose, robot_pose))
        latency = 0 if is_first else _nanoseconds(self.sensors.pose_latency)
        self._events.schedule(event.time + latency, kind, event.sample_index, pose)

    def _advance_to(self, time: int) -> None:
        """Move the plant on, with stops where command, friction or pose of the object change."""
        while self._now < time:
            disturbed_at = self._disturbances.next_time
            until = time if time < disturbed_at else max(self._now, int(disturbed_at))
            if self._now < self._deadline < until:
                until = self._deadline
            if until > self._now:
                self.plant.advance((until - self._now) / NANOSECONDS, self._active_command())
            self._set_now(until)
            if self._after_motion is not None:
                self._touches_other = self._after_motion()
            self._observe_bodies()
            if until >= disturbed_at:
                self._disturb()

    def _set_now(self, now: int) -> None:
        self._now = now
        self.time = now / NANOSECONDS

    def _active_command(self) -> Twist:
        return self._command if self._now < self._deadline else STOP

    def _apply_friction(self) -> None:
        self.plant.set_friction_factors(friction_factors(
            self.settings.friction_changes, self.time, len(self.obj.supports)))

    def _disturb(self) -> None:
        """Change friction, or displace the object, as is due."""
        if self._disturbances.pop_friction_changes(self._now):
            self._apply_friction()
        displacement = self._disturbances.pop_displacement(self._now)
        if displacement is None:
            return
        try:
            self.plant.set_object_pose(self.plant.object_pose @ displacement.relative_pose)
        except ValueError as error:
            raise ValueError(f'SimulationSettings.object_displacements: at {self.time:g} s '
                             f'{error}') from error


def _nanoseconds(seconds: float) -> int:
    """Round to whole nanoseconds, halves upwards."""
    return math.floor(seconds * NANOSECONDS + 0.5)
