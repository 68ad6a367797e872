"""Plant and sensors in simulated time: one measurement after the other, and commands between."""

import heapq
import math

import numpy as np
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_sim_node.disturbance import change_times, friction_factors
from push_sim_node.kernel import layout
from push_sim_node.kernel.actuation import limit_command
from push_sim_node.plant import Plant
from push_sim_node.sensors import OdometrySensor, PoseSensor, SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.truth import Energy

COLUMNS = ('time',
           'object_x', 'object_y', 'object_theta', 'object_v_x', 'object_v_y', 'object_omega',
           'robot_x', 'robot_y', 'robot_theta', 'robot_v_x', 'robot_v_y', 'robot_omega',
           'command_v_x', 'command_v_y', 'command_omega',
           'mode', 'force_n', 'force_t', 'gap', 'pushing_angle', 'contact_x', 'contact_y',
           'normal', *(f'energy_{name}' for name in Energy._fields))
NANOSECONDS = 1_000_000_000
MEASURE_POSE, DELIVER_POSE, ODOMETRY = range(3)


class Simulation:
    """
    Simulated time, in steps from one measurement to the next.

    Times are whole nanoseconds inside. At time 0 the first object pose and then the first
    odometry are delivered, without latency or loss: the object has stood still before. Of
    measurements that are due together, object poses come first. The robot stops when no command
    has come for ``command_timeout``. Where the robot is in the way of a shove, time cannot go on:
    a ``ValueError`` says so.

    ``tape`` has a row in the order of ``columns`` for every odometry time, SI units, before the
    command that answers it. ``object_v`` is in world axes, ``robot_v`` and ``command`` in the
    robot's own, angles are not wrapped, ``mode`` is an index into ``layout.MODES``, and
    ``pushing_angle`` is nan without contact; the rest is as in ``Truth``, as is the friction
    ``support_0_x``, ``support_0_y``, ... on each support [N] behind the other columns.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object at time 0.
    :param robot_pose: ``Pose`` of the robot at time 0.
    :param settings: ``SimulationSettings``.
    :param sensors: ``SensorSettings``.
    :raises ValueError: where robot and object overlap, or friction changes under a support that
        does not exist.
    """

    def __init__(self, obj, robot, object_pose, robot_pose, settings=SimulationSettings(),
                 sensors=SensorSettings()):
        self.obj, self.robot, self.settings, self.sensors = obj, robot, settings, sensors
        self._start = (Pose(*object_pose), Pose(*robot_pose))
        self.reset()

    def reset(self, object_pose=None):
        """
        Begin again at time 0, with the same random errors.

        :param object_pose: where the object stands instead; None for where it stood at first.
        :raises ValueError: where robot and object overlap.
        """
        settings, sensors = self.settings, self.sensors
        start = Pose(*object_pose) if object_pose is not None else self._start[0]
        self.plant = Plant(self.obj, self.robot, start, self._start[1], settings.step,
                           settings.friction_smoothing, settings.floor_patches)
        noise, losses, biases, jitter = (np.random.default_rng(seed) for seed in
                                         np.random.SeedSequence(settings.seed).spawn(4))
        self._pose_sensor = PoseSensor(sensors, noise, losses)
        self._odometry = OdometrySensor(sensors, self.plant.robot_pose, biases, jitter)
        self._now, self._deadline, self._command = 0, 0, STOP
        self._events, self._count = [], 0
        self._changes = [_nanoseconds(t) for t in change_times(settings.friction_changes)]
        self._shoves = sorted(settings.object_displacements, key=lambda shove: shove.time)
        self.tape = []
        self._apply_friction()
        self._schedule(0, MEASURE_POSE, 0)
        self._schedule(0, ODOMETRY, 0)

    @property
    def columns(self):
        """Names of the tape's columns: ``COLUMNS``, then the friction on each support."""
        return COLUMNS + tuple(f'support_{i}_{axis}' for i in range(len(self.obj.supports))
                               for axis in 'xy')

    @property
    def time(self):
        """Simulated time [s]."""
        return self._now / NANOSECONDS

    @property
    def truth(self):
        """``Truth`` now."""
        return self.plant.truth(self.time)

    def command(self, twist):
        """
        Give the robot a command, from now on.

        :param twist: ``Twist`` in the robot's own axes.
        :raises ValueError: where it is not finite or not possible for the drive.
        """
        limit_command(self.robot, twist)
        self._command = Twist(*(float(value) for value in twist))
        self._deadline = self._now + _nanoseconds(self.settings.command_timeout)

    def next(self):  # noqa: A003
        """
        Go on until the next measurement is delivered.

        :return: the measurement, an ``Odometry`` or an ``ObjectPose``.
        """
        while True:
            time, kind, _, item = heapq.heappop(self._events)
            self._advance_to(time)
            if kind == DELIVER_POSE:
                return item
            if kind == ODOMETRY:
                self._schedule_periodic(ODOMETRY, item + 1, self.sensors.odometry_rate)
                self.tape.append(self._row())
                return self._odometry.measure(self.time, self.plant.robot_pose,
                                              self.plant.robot_twist)
            self._schedule_periodic(MEASURE_POSE, item + 1, self.sensors.pose_rate)
            pose = self._pose_sensor.measure(self.time, self.plant.object_pose, certain=item == 0)
            if pose is not None:
                latency = _nanoseconds(self.sensors.pose_latency) if item else 0
                self._schedule(time + latency, DELIVER_POSE, pose)

    def _schedule_periodic(self, kind, number, rate):
        self._schedule(_nanoseconds(number / rate), kind, number)

    def _schedule(self, time, kind, item):
        self._count += 1
        heapq.heappush(self._events, (time, kind, self._count, item))

    def _advance_to(self, time):
        while self._now < time:
            driven = self._now < self._deadline
            object_displacements = [max(self._now, _nanoseconds(shove.time)) for shove in self._shoves[:1]]
            until = min([time] + self._changes[:1] + object_displacements + ([self._deadline] if driven else []))
            if until > self._now:
                self.plant.advance((until - self._now) / NANOSECONDS,
                                   self._command if driven else STOP)
            self._now = until
            self._apply_friction()
            if object_displacements and until == object_displacements[0]:
                self._shove(self._shoves.pop(0))

    def _apply_friction(self):
        begun = False
        while self._changes and self._changes[0] <= self._now:
            self._changes.pop(0)
            begun = True
        if begun or self._now == 0:
            self.plant.set_friction_factors(friction_factors(
                self.settings.friction_changes, self.time, len(self.obj.supports)))

    def _shove(self, shove):
        try:
            self.plant.set_object_pose(self.plant.object_pose @ shove.displacement)
        except ValueError as error:
            raise ValueError(f'SimulationSettings.shoves: at {self.time:g} s {error}') from error

    def _row(self):
        truth = self.truth
        command = self._command if self._now < self._deadline else STOP
        return (truth.time, *truth.object_pose, *truth.object_twist, *truth.robot_pose,
                *truth.robot_twist, *command, float(layout.MODES.index(truth.mode)),
                truth.force_n, truth.force_t, truth.gap, truth.pushing_angle,
                *truth.contact_point, truth.normal, *truth.energy,
                *(value for force in truth.support_forces for value in force))


def _nanoseconds(seconds):
    return math.floor(seconds * NANOSECONDS + 0.5)
