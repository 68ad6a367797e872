"""Sensors of the robot: object poses that are late and noisy, odometry that drifts."""

import dataclasses
import math
from typing import get_args, Literal, NamedTuple, TypeAlias

import numpy as np
from push_dynamics import actuation
from push_dynamics.compiled import interpreted
from push_model.geometry import Pose, wrap_angle
from push_model.quantity import check, MIN_NOISE, quantity
from push_model.signals import (
    ObjectPose, Odometry, OdometryReference, PoseCovariance, Twist,
)
from push_sim_node.camera import CameraSettings
from push_sim_node.lidar import LidarSensorSettings

# Deviation that odometry states where the settings have less [m, rad, m/s, rad/s]: chosen, as
# encoders resolve it. A variance of 0 would count as not stated.
MIN_DEVIATION = 1e-3
# How a detector mistakes the orientation of an object: by half a turn, where it goes by the shape;
# or by the tilt of a single tag, which it sees mirrored at the line of sight.
PoseFlip: TypeAlias = Literal['half_turn', 'mirrored_tilt']
# One call is not worth compiling it.
chord_velocity = interpreted(actuation.chord_velocity)


@dataclasses.dataclass(frozen=True)
class SensorSettings:
    """
    Rates and errors of the measurements; all errors are 0 by default.

    A relative odometry error is its fixed part plus, drawn once per run, its random part. Where
    odometry is absolute these errors are those of its velocity alone.
    """

    pose_rate: float = quantity('rate of object poses', 'Hz', above=0.0, high=1000.0,
                                default=20.0)
    pose_noise: float = quantity('position std per axis', 'm', 0.0, 1.0, default=0.0)
    pose_heading_noise: float = quantity('heading std', 'rad', 0.0, 1.0, default=0.0)
    pose_latency: float = quantity('delay from measurement to delivery', 's', 0.0, 5.0,
                                   default=0.0)
    pose_drop_probability: float = quantity('probability that a pose is lost', '', 0.0, 1.0,
                                            default=0.0)
    pose_dropouts: tuple[tuple[float, float], ...] = quantity('intervals (start, end) without '
                                                              'poses', 's', 0.0, default=())
    pose_bias: float = quantity("largest position error that depends on the robot's side", 'm',
                                0.0, 1.0, default=0.0)
    pose_heading_bias: float = quantity("largest heading error that depends on the robot's side",
                                        'rad', 0.0, 1.0, default=0.0)
    pose_jump_probability: float = quantity('probability of an outlier', '', 0.0, 1.0, default=0.0)
    pose_jump: float = quantity('position std of outliers per axis', 'm', 0.0, 10.0, default=0.0)
    pose_heading_jump: float = quantity('heading std of outliers', 'rad', 0.0, math.pi,
                                        default=0.0)
    pose_flip_probability: float = quantity('probability of a flipped orientation', '', 0.0, 1.0,
                                            default=0.0)
    pose_flip: PoseFlip = quantity(
        'how it flips: by half a turn, or by the mirrored tilt of the tag that is seen',
        choices=get_args(PoseFlip), default='half_turn')
    odometry_rate: float = quantity('rate of odometry', 'Hz', above=0.0, high=1000.0,
                                    default=50.0)
    odometry_reference: OdometryReference = quantity(
        'drifting: summed motion; absolute: measured in the world',
        choices=get_args(OdometryReference), default='drifting')
    odometry_position_noise: float = quantity('position std per axis, if absolute', 'm', MIN_NOISE,
                                              0.5, default=1e-3)
    odometry_heading_noise: float = quantity('heading std, if absolute', 'rad', MIN_NOISE, 0.1,
                                             default=2e-3)
    odometry_jump: float = quantity('position std per axis of jumps, if absolute', 'm', 0.0, 1.0,
                                    default=0.0)
    odometry_heading_jump: float = quantity('heading std of jumps, if absolute', 'rad', 0.0, 0.5,
                                            default=0.0)
    odometry_jump_period: float = quantity('time between jumps', 's', above=0.0, high=600.0,
                                           default=10.0)
    odometry_scale: float = quantity('relative error of distances', '', -0.5, 0.5, default=0.0)
    odometry_scale_noise: float = quantity('std of odometry_scale from run to run', '', 0.0, 0.5,
                                           default=0.0)
    odometry_yaw_scale: float = quantity('relative error of rotations', '', -0.5, 0.5, default=0.0)
    odometry_heading_drift: float = quantity('heading error per distance', 'rad/m', -1.0, 1.0,
                                             default=0.0)
    odometry_heading_drift_noise: float = quantity('std of odometry_heading_drift from run to run',
                                                   'rad/m', 0.0, 1.0, default=0.0)
    odometry_heading_offset: float = quantity('heading error at the start', 'rad', -math.pi,
                                              math.pi, default=0.0)
    odometry_speed_noise: float = quantity('velocity std per axis', 'm/s', 0.0, 1.0, default=0.0)
    odometry_yaw_rate_noise: float = quantity('yaw rate std', 'rad/s', 0.0, 1.0, default=0.0)
    odometry_step: float = quantity('step to which coordinates of odometry are rounded; 0: none',
                                    'm', 0.0, 0.1, default=0.0)
    odometry_angle_step: float = quantity('the same of its heading', 'rad', 0.0, 0.5, default=0.0)
    bumper_force: float = quantity('force that closes the switch of the bumper; 0: none', 'N',
                                   0.0, 1000.0, default=0.0)
    camera: CameraSettings = CameraSettings()
    lidar: LidarSensorSettings = LidarSensorSettings()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        for interval in self.pose_dropouts:
            if not _is_interval(interval):
                raise ValueError(f'SensorSettings.pose_dropouts: got {interval!r}, expected '
                                 '(start, end) with end after start [s]')


class Sighting(NamedTuple):
    """
    Position from which an object is seen.

    :param bearing: direction from the object to who sees it, in the object frame [rad].
    :param distance: from the lens to the origin, with which noise grows [m].
    :param flip: ``Pose`` of the object, as it is seen where the tilt of its tag is mirrored,
        relative to the true one.
    """

    bearing: float = 0.0
    distance: float = 0.0
    flip: Pose = Pose(0.0, 0.0, 0.0)


class ViewBias:
    """
    Error of an object pose that stays while the object is seen from the same side.

    The marks by which an object is recognised are not quite where they should be, others on each
    side, and a camera errs in another way at every angle. With the bearing phi of the robot in
    the object frame, the error is ``(b / 2) (u_1 sin(phi + a_1) + u_2 sin(2 phi + a_2))`` in that
    frame: at most b, b / 2 in the root mean square, and 0 on average over all sides. Directions
    ``u`` and phases ``a`` are drawn once per run; the orientation has the same form.

    :param settings: ``SensorSettings``.
    :param rng: ``numpy.random.Generator`` of directions and phases.
    """

    def __init__(self, settings: SensorSettings, rng: np.random.Generator) -> None:
        self._settings = settings
        self._directions = rng.uniform(-math.pi, math.pi, 2).tolist()
        self._phases = rng.uniform(-math.pi, math.pi, 2).tolist()
        self._heading_phases = rng.uniform(-math.pi, math.pi, 2).tolist()

    def error(self, bearing: float) -> Pose:
        """
        Compute the error, in the object frame.

        :param bearing: direction from the object to the robot, in the object frame [rad].
        :return: ``Pose`` of the object as it is seen, relative to the true one.
        """
        if not (self._settings.pose_bias or self._settings.pose_heading_bias):
            return Pose(0.0, 0.0, 0.0)
        waves = [0.5 * self._settings.pose_bias * math.sin(k * bearing + phase)
                 for k, phase in enumerate(self._phases, 1)]
        heading_waves = [0.5 * self._settings.pose_heading_bias * math.sin(k * bearing + phase)
                         for k, phase in enumerate(self._heading_phases, 1)]
        return Pose(sum(wave * math.cos(u) for wave, u in zip(waves, self._directions)),
                    sum(wave * math.sin(u) for wave, u in zip(waves, self._directions)),
                    sum(heading_waves))


class PoseSensor:
    """
    Sensor of the object pose.

    Every measurement takes the same draws from its streams, lost or not; hence a change of one
    setting leaves the other errors as they are.

    :param settings: ``SensorSettings``.
    :param noise: ``numpy.random.Generator`` of the noise.
    :param losses: ``numpy.random.Generator`` of the losses.
    :param outliers: ``numpy.random.Generator`` of the view bias and of poses that are far off; a
        stream of its own is spawned for flips.
    """

    def __init__(self, settings: SensorSettings, noise: np.random.Generator,
                 losses: np.random.Generator, outliers: np.random.Generator) -> None:
        self._settings = settings
        self._noise = noise
        self._losses = losses
        self._outliers = outliers
        self._bias = ViewBias(settings, outliers)
        self._flips, = outliers.spawn(1)

    def set_settings(self, settings: SensorSettings) -> None:
        """Measure with other noise, losses and jumps from now on; the bias by view stays."""
        self._settings = settings

    def measure(self, time: float, pose: Pose, sighting: Sighting = Sighting(), *,
                certain: bool = False) -> ObjectPose | None:
        """
        Take one measurement.

        :param time: now [s].
        :param sighting: from where the object is seen.
        :param certain: whether it is delivered in any case.
        :return: ``ObjectPose`` with its orientation in [-pi, pi], or None where it is lost.
        """
        e_x, e_y, e_theta = self._noise.standard_normal(3).tolist()
        lost = self.is_lost(time)
        seen = self._seen(pose, sighting)
        if lost and not certain:
            return None
        settings, camera = self._settings, self._settings.camera
        position_noise = settings.pose_noise + camera.noise_per_distance * sighting.distance
        heading_noise = (settings.pose_heading_noise
                         + camera.heading_noise_per_distance * sighting.distance)
        return ObjectPose(time, Pose(seen.x + position_noise * e_x, seen.y + position_noise * e_y,
                                     wrap_angle(seen.theta + heading_noise * e_theta)))

    def is_lost(self, time: float) -> bool:
        """
        Draw whether a measurement is lost.

        :param time: now [s].
        """
        settings = self._settings
        lost = self._losses.random() < settings.pose_drop_probability
        return lost or any(start <= time < end for start, end in settings.pose_dropouts)

    def _seen(self, pose: Pose, sighting: Sighting) -> Pose:
        """Return the pose with its errors but for the noise; its orientation is not wrapped."""
        settings = self._settings
        if self._flips.random() < settings.pose_flip_probability:
            is_half = settings.pose_flip == 'half_turn'
            pose = pose @ (Pose(0.0, 0.0, math.pi) if is_half else sighting.flip)
        d_x, d_y, d_theta = self._bias.error(sighting.bearing)
        e_x, e_y, e_theta = self._outliers.standard_normal(3).tolist()
        if self._outliers.random() < settings.pose_jump_probability:
            d_x += settings.pose_jump * e_x
            d_y += settings.pose_jump * e_y
            d_theta += settings.pose_heading_jump * e_theta
        d_x, d_y = Pose(0.0, 0.0, pose.theta).rotate((d_x, d_y))
        return Pose(pose.x + d_x, pose.y + d_y, pose.theta + d_theta)


class DriftCovariance:
    """
    Covariance of a pose that was summed up, as far as the settings know it.

    With the scale error s, the yaw scale error y, the heading drift d and the offset o of the
    heading at first, the error of the pose p = (x, y) with its heading is to first order

        error of the heading = o + y (theta - theta_0) + d l,    l: distance travelled
        error of p = s (p - p_0) + integral of (error of the heading) J dp,    J (x, y) = (-y, x)

    so that each of the four has a vector (x, y, heading) by which it is multiplied. What is fixed
    in the settings counts like a standard deviation: who reads the odometry does not know it.

    :param settings: ``SensorSettings``.
    """

    def __init__(self, settings: SensorSettings) -> None:
        self.set_settings(settings)
        # p - p_0, which s multiplies, and the vectors of y and of d; that of o follows from p.
        self._moved = 0.0, 0.0
        self._by_rotation = self._by_distance = 0.0, 0.0, 0.0

    def set_settings(self, settings: SensorSettings) -> None:
        """Take errors to be others, those of the motion so far too."""
        deviations = (math.hypot(settings.odometry_scale, settings.odometry_scale_noise),
                      settings.odometry_yaw_scale,
                      math.hypot(settings.odometry_heading_drift,
                                 settings.odometry_heading_drift_noise),
                      settings.odometry_heading_offset)
        self._variances = [deviation ** 2 for deviation in deviations]

    def move(self, d_x: float, d_y: float, rotation: float) -> None:
        """
        Let the robot move.

        :param d_x: in the world, x [m].
        :param d_y: in the world, y [m].
        :param rotation: [rad].
        """
        x, y = self._moved
        self._moved = x + d_x, y + d_y
        x, y, angle = self._by_rotation
        self._by_rotation = x - angle * d_y, y + angle * d_x, angle + rotation
        x, y, angle = self._by_distance
        self._by_distance = x - angle * d_y, y + angle * d_x, angle + math.hypot(d_x, d_y)

    @property
    def covariance(self) -> PoseCovariance:
        """``PoseCovariance`` after the motion so far."""
        least = MIN_DEVIATION ** 2
        x_x, x_y, x_theta, y_y, y_theta, theta_theta = least, 0.0, 0.0, least, 0.0, least
        moved_x, moved_y = self._moved
        errors = ((moved_x, moved_y, 0.0), self._by_rotation, self._by_distance,
                  (-moved_y, moved_x, 1.0))
        for variance, (x, y, theta) in zip(self._variances, errors):
            if variance == 0.0:
                continue
            x_x += variance * x * x
            x_y += variance * x * y
            x_theta += variance * x * theta
            y_y += variance * y * y
            y_theta += variance * y * theta
            theta_theta += variance * theta * theta
        return PoseCovariance(x_x, x_y, x_theta, y_y, y_theta, theta_theta)


class OdometrySensor:
    """
    Odometry: integrates the robot's motion, with errors that grow with the distance.

    Where it is absolute it measures the pose instead; the covariance is then its noise.

    :param settings: ``SensorSettings``.
    :param pose: true ``Pose`` of the robot at the start.
    :param biases: ``numpy.random.Generator`` of the errors that stay for a run.
    :param noise: ``numpy.random.Generator`` of the noise on velocities.
    :param pose_noise: ``numpy.random.Generator`` of the noise on absolute poses; a stream of its
        own is spawned for jumps.
    """

    def __init__(self, settings: SensorSettings, pose: Pose, biases: np.random.Generator,
                 noise: np.random.Generator, pose_noise: np.random.Generator) -> None:
        self._bias_samples = biases.standard_normal(2).tolist()
        self._noise = noise
        self._pose_noise = pose_noise
        self._jumps, = pose_noise.spawn(1)
        # Frame of absolute poses in the world, and how often it has jumped.
        self._frame, self._jump_count = Pose(0.0, 0.0, 0.0), 0
        self._true_pose = pose
        # Its heading is not wrapped.
        self._pose = pose.x, pose.y, pose.theta + settings.odometry_heading_offset
        self._covariance = DriftCovariance(settings)
        self.set_settings(settings)

    def set_settings(self, settings: SensorSettings) -> None:
        """Measure with other errors from now on; what has been summed up stays."""
        scale, drift = self._bias_samples
        self._settings = settings
        self._scale = 1.0 + settings.odometry_scale + settings.odometry_scale_noise * scale
        self._yaw_scale = 1.0 + settings.odometry_yaw_scale
        self._heading_drift = (settings.odometry_heading_drift
                               + settings.odometry_heading_drift_noise * drift)
        self._covariance.set_settings(settings)

    def measure(self, time: float, pose: Pose, twist: Twist) -> Odometry:
        """
        Take one measurement.

        :param time: now [s].
        :param pose: true ``Pose`` of the robot, its angle not wrapped.
        :param twist: its true ``Twist``, own axes.
        :return: ``Odometry`` with its heading in [-pi, pi], and its covariance.
        """
        if self._settings.odometry_reference == 'absolute':
            return self._measured_in_world(time, pose, twist)
        # The twist that leads from one pose to the next in 1 s.
        v_x, v_y, rotation = self._biased(*_arc_between(self._true_pose, pose))
        self._true_pose = pose
        x, y, theta = self._pose
        d_x, d_y = chord_velocity(theta, v_x, v_y, rotation, 1.0)
        x, y, theta = self._pose = x + d_x, y + d_y, theta + rotation
        self._covariance.move(d_x, d_y, rotation)
        return Odometry(time, self._rounded(x, y, theta), self._measured(twist),
                        self._covariance.covariance)

    def _measured_in_world(self, time: float, pose: Pose, twist: Twist) -> Odometry:
        settings = self._settings
        e_x, e_y, e_theta = self._pose_noise.standard_normal(3).tolist()
        position, heading = settings.odometry_position_noise, settings.odometry_heading_noise
        x, y, theta = self._jumped(time, pose)
        measured = self._rounded(x + position * e_x, y + position * e_y, theta + heading * e_theta)
        return Odometry(time, measured, self._measured(twist), PoseCovariance.from_deviations(
            math.hypot(position, settings.odometry_jump),
            math.hypot(heading, settings.odometry_heading_jump)))

    def _jumped(self, time: float, pose: Pose) -> Pose:
        """Displace an absolute pose as of the last jump; it turns about the robot."""
        settings = self._settings
        while self._jump_count < math.floor(time / settings.odometry_jump_period):
            self._jump_count += 1
            e_x, e_y, e_theta = self._jumps.standard_normal(3).tolist()
            self._frame = Pose(settings.odometry_jump * e_x, settings.odometry_jump * e_y,
                               settings.odometry_heading_jump * e_theta)
        d_x, d_y, d_theta = self._frame
        return Pose(pose.x + d_x, pose.y + d_y, pose.theta + d_theta)

    def _rounded(self, x: float, y: float, theta: float) -> Pose:
        """Round a pose to the steps of the settings; wrap its heading."""
        step, angle_step = self._settings.odometry_step, self._settings.odometry_angle_step
        return Pose(_in_steps(x, step), _in_steps(y, step),
                    wrap_angle(_in_steps(theta, angle_step)))

    def _biased(self, v_x: float, v_y: float, omega: float) -> tuple[float, float, float]:
        """Add the errors that stay for a run to a twist."""
        return (self._scale * v_x, self._scale * v_y,
                self._yaw_scale * omega + self._heading_drift * math.hypot(v_x, v_y))

    def _measured(self, twist: Twist) -> Twist:
        """Measure a twist, with all errors."""
        v_x, v_y, omega = self._biased(*twist)
        e_x, e_y, e_omega = self._noise.standard_normal(3).tolist()
        speed_noise = self._settings.odometry_speed_noise
        return Twist(v_x + speed_noise * e_x, v_y + speed_noise * e_y,
                     omega + self._settings.odometry_yaw_rate_noise * e_omega)


def _in_steps(value: float, step: float) -> float:
    return step * round(value / step) if step > 0.0 else value


def _is_interval(value: object) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and value[1] > value[0]


def _arc_between(start: Pose, end: Pose) -> tuple[float, float, float]:
    """Return the constant twist, in the own axes of start, that leads to end in 1 s."""
    rotation = end.theta - start.theta
    d_x, d_y = end.x - start.x, end.y - start.y
    c, s = math.cos(start.theta), math.sin(start.theta)
    x, y = c * d_x + s * d_y, c * d_y - s * d_x
    c, s = chord_velocity(0.0, 1.0, 0.0, rotation, 1.0)
    # (c, s) / |(c, s)|^2 inverts the rotation and the shrinking from arc to chord.
    squared = c * c + s * s
    return (c * x + s * y) / squared, (c * y - s * x) / squared, rotation
