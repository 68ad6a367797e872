"""What the robot gets to know: object poses that are late and noisy, odometry that drifts."""

import dataclasses
import math

from push_model.geometry import Pose, wrap_angle
from push_model.quantity import check, quantity
from push_model.signals import ObjectPose, Odometry, Twist
from push_sim_node.kernel.actuation import chord_velocity


@dataclasses.dataclass(frozen=True)
class SensorSettings:
    """
    Rates and errors of the measurements; all errors are 0 by default.

    A relative odometry error is its fixed part plus, drawn once per run, its random part.
    """

    pose_rate: float = quantity('rate of object poses', 'Hz', above=0.0, high=1000.0,
                                default=20.0)
    pose_noise: float = quantity('standard deviation of the object position, along each axis',
                                 'm', 0.0, 1.0, default=0.0)
    pose_heading_noise: float = quantity('standard deviation of the object orientation', 'rad',
                                         0.0, 1.0, default=0.0)
    pose_latency: float = quantity('time from measuring an object pose to its delivery', 's', 0.0,
                                   5.0, default=0.0)
    pose_drop_probability: float = quantity('share of object poses that are lost', '', 0.0, 1.0,
                                            default=0.0)
    pose_dropouts: tuple = quantity('spells (start, end) of measuring times without an object '
                                    'pose', 's', 0.0, default=())
    odometry_rate: float = quantity('rate of odometry', 'Hz', above=0.0, high=1000.0,
                                    default=50.0)
    odometry_scale: float = quantity('relative error of the distance travelled', '', -0.5, 0.5,
                                     default=0.0)
    odometry_scale_noise: float = quantity('standard deviation of that error from run to run', '',
                                           0.0, 0.5, default=0.0)
    odometry_yaw_scale: float = quantity('relative error of the angle turned', '', -0.5, 0.5,
                                         default=0.0)
    odometry_heading_drift: float = quantity('heading error per distance travelled', 'rad/m',
                                             -1.0, 1.0, default=0.0)
    odometry_heading_drift_noise: float = quantity('standard deviation of that drift from run to '
                                                   'run', 'rad/m', 0.0, 1.0, default=0.0)
    odometry_heading_offset: float = quantity('error of the heading that odometry starts with',
                                              'rad', -math.pi, math.pi, default=0.0)
    odometry_speed_noise: float = quantity('standard deviation of the measured velocity, along '
                                           'each axis', 'm/s', 0.0, 1.0, default=0.0)
    odometry_yaw_rate_noise: float = quantity('standard deviation of the measured yaw rate',
                                              'rad/s', 0.0, 1.0, default=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        for spell in self.pose_dropouts:
            if not isinstance(spell, tuple) or len(spell) != 2 or spell[1] <= spell[0]:
                raise ValueError(f'SensorSettings.pose_dropouts: got {spell!r}, expected (start, '
                                 'end) with end after start [s]')


class PoseSensor:
    """
    Measures the object pose.

    Every measurement takes the same draws from its streams, lost or not, so that changing one
    setting leaves the other errors as they are.

    :param settings: ``SensorSettings``.
    :param noise: ``numpy.random.Generator`` of the noise.
    :param losses: ``numpy.random.Generator`` of the losses.
    """

    def __init__(self, settings, noise, losses):
        self._settings, self._noise, self._losses = settings, noise, losses

    def measure(self, time, pose, certain=False):
        """
        Take one measurement.

        :param time: now [s].
        :param pose: true ``Pose`` of the object.
        :param certain: whether it is delivered in any case.
        :return: ``ObjectPose`` with its orientation in [-pi, pi], or None where it is lost.
        """
        e_x, e_y, e_theta = self._noise.standard_normal(3).tolist()
        lost = self._losses.random() < self._settings.pose_drop_probability
        lost = lost or any(start <= time < end for start, end in self._settings.pose_dropouts)
        if lost and not certain:
            return None
        position, heading = self._settings.pose_noise, self._settings.pose_heading_noise
        return ObjectPose(time, Pose(pose.x + position * e_x, pose.y + position * e_y,
                                     wrap_angle(pose.theta + heading * e_theta)))


class OdometrySensor:
    """
    Integrates the robot's motion, with errors that grow along the way.

    :param settings: ``SensorSettings``.
    :param pose: true ``Pose`` of the robot at the start.
    :param biases: ``numpy.random.Generator`` of the errors that stay for a run.
    :param noise: ``numpy.random.Generator`` of the noise on velocities.
    """

    def __init__(self, settings, pose, biases, noise):
        scale, drift = biases.standard_normal(2).tolist()
        self._settings, self._noise, self._true = settings, noise, pose
        self._scale = 1.0 + settings.odometry_scale + settings.odometry_scale_noise * scale
        self._yaw_scale = 1.0 + settings.odometry_yaw_scale
        self._drift = (settings.odometry_heading_drift
                       + settings.odometry_heading_drift_noise * drift)
        self._pose = Pose(pose.x, pose.y, pose.theta + settings.odometry_heading_offset)

    def measure(self, time, pose, twist):
        """
        Take one measurement.

        :param time: now [s].
        :param pose: true ``Pose`` of the robot, its angle not wrapped.
        :param twist: its true ``Twist``, own axes.
        :return: ``Odometry`` with its heading in [-pi, pi].
        """
        x, y, turn = _arc_between(self._true, pose)
        self._true = pose
        x, y, turn = self._biased(x, y, turn)
        move_x, move_y = chord_velocity(self._pose.theta, x, y, turn, 1.0)
        self._pose = Pose(self._pose.x + move_x, self._pose.y + move_y, self._pose.theta + turn)
        return Odometry(time, self._pose._replace(theta=wrap_angle(self._pose.theta)),
                        self._noisy(Twist(*self._biased(*twist))))

    def _biased(self, x, y, turn):
        return (self._scale * x, self._scale * y,
                self._yaw_scale * turn + self._drift * math.hypot(x, y))

    def _noisy(self, twist):
        e_x, e_y, e_omega = self._noise.standard_normal(3).tolist()
        speed, yaw = self._settings.odometry_speed_noise, self._settings.odometry_yaw_rate_noise
        return Twist(twist.v_x + speed * e_x, twist.v_y + speed * e_y, twist.omega + yaw * e_omega)


def _arc_between(start, end):
    """Displacement and turn in own axes that draw the arc from start to end."""
    turn = end.theta - start.theta
    c, s = chord_velocity(0.0, 1.0, 0.0, turn, 1.0)
    x, y = Pose(0.0, 0.0, -start.theta).rotate((end.x - start.x, end.y - start.y))
    shrink = c * c + s * s
    return (c * x + s * y) / shrink, (c * y - s * x) / shrink, turn
