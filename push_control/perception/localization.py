"""Localization of robot and object by measurements as they come: the filter in, poses out."""

import math

import numpy as np

from push_control.events import PerceptionEvent
from push_control.perception.ensemble.contact_hypotheses import ContactHypotheses
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.measurement_update import COUPLING_TIME
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.map_corrections import has_lasting_errors, MapCorrections
from push_control.perception.odometry_shift import OdometryShift
from push_control.perception.place_tracker import PlaceTracker
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact, NearestContact
from push_model.events import Report
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, PlaceStatus, RobotPlace
from push_navigation.map_clearance import PositionUncertainty
from push_safety.odometry_check import integrated_step

# Creep of the wheels of a robot that pushes what it does not see [1/N]; chosen: 4 % of the way at
# 15 N, as wheels creep by up to twice that.
CREEP_STD = 0.04 / 15.0
# Standard deviations of the scale of odometry beyond which an estimate of it is no chance; chosen.
UNLIKELY_SIGMAS = 4.0
# Standard deviations that the start of a robot whose place is measured adds [m], [rad]: what the
# settings of the place have for it. And of where it will be, at least [m]; measured: what places
# state is 8 mm in the median, 13 mm at most in 95 of 100.
FIRST_PLACE_STDS = 0.1, 0.1
MIN_PLACED_STD = 0.01


class Localization(ContactHypotheses):
    """Follows contact hypotheses with odometry that may jump, and may measure the world."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 supervision: SupervisionSettings) -> None:
        """
        Start without measurements.

        :param control: ``ControlSettings``, for the noise of object poses.
        :param supervision: ``SupervisionSettings``, for the noise of odometry.
        """
        super().__init__(PushEnsemble(obj, robot, control, _odometry_noise(supervision)))
        self._control = control
        self._supervision = supervision
        # The newest odometry that has come here, and whether the pose of the next one has jumped.
        self._received: Odometry | None = None
        self._has_jumped = False
        self._odometry_shift = OdometryShift(robot.max_acceleration)
        self._corrections = MapCorrections()
        self._places = PlaceTracker()
        # Covariance of the errors of the newest odometry over what it states.
        self._error_growth = 1.0

    # Odometry.

    @property
    def has_received_odometry(self) -> bool:
        """Tell whether odometry has come, and was not only taken over."""
        return self._received is not None

    @property
    def is_robot_measured(self) -> bool:
        """Tell whether odometry measures the robot in the world, without drift."""
        return (self._received is not None
                and self._supervision.assumed_covariance(self._received) is not None)

    @property
    def is_robot_in_map(self) -> bool:
        """Tell whether odometry measures the robot with lasting errors, as in a map."""
        return self._state.is_in_map

    @property
    def is_robot_elsewhere(self) -> bool:
        """Tell whether jumps of odometry have put the robot elsewhere: nothing known holds."""
        return self._odometry_shift.is_robot_elsewhere

    @property
    def position_uncertainty(self) -> PositionUncertainty:
        """``PositionUncertainty`` of the robot; it grows where odometry drifts."""
        uncertainty = super().position_uncertainty
        if self.is_robot_measured:
            return PositionUncertainty(uncertainty.position)
        if self.is_robot_placed:
            return PositionUncertainty(max(MIN_PLACED_STD, uncertainty.position))
        return uncertainty

    @property
    def is_robot_placed(self) -> bool:
        """Tell whether places of the robot in its map come, beside drifting odometry."""
        return self._received is not None and self._places.is_placed

    @property
    def is_place_lost(self) -> bool:
        """Tell whether what measures these places has lost the robot."""
        return self._received is not None and self._places.is_lost(self._received.time)

    @property
    def odometry_inconsistency(self) -> Report[PerceptionEvent] | None:
        """Inconsistency of odometry with the contacts; None where there is none."""
        scale = self.odometry_scale
        if abs(scale) <= UNLIKELY_SIGMAS * self._supervision.odometry_scale:
            return None
        event = (PerceptionEvent.ODOMETRY_TOO_LARGE if scale > 0.0
                 else PerceptionEvent.ODOMETRY_TOO_SMALL)
        return event.report(percentage=100.0 * abs(scale))

    def move(self, odometry: Odometry) -> Pose | None:
        """
        Move the robot by odometry, and by its twist alone where its pose has jumped.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :return: the step as ``Pose`` in the robot's axes before; None for the first odometry, and
            for one that is ignored.
        """
        previous = self._received
        if previous is not None and odometry.time <= previous.time:
            return None
        self._received = odometry
        self._places.add_odometry(odometry, self._has_jumped)
        if previous is None:
            self._start_at(odometry)
            return None
        step = previous.pose.inverse() @ odometry.pose
        covariance = self._supervision.assumed_covariance(odometry)
        self._error_growth = 1.0
        self._state.is_in_map = has_lasting_errors(covariance)
        if self._has_jumped:
            self._has_jumped = False
            step = integrated_step(previous, odometry)
            self._odometry_shift.add(previous, odometry, step)
        elif covariance is not None and self.is_robot_in_map:
            step, self._error_growth = self._corrections.step(previous, odometry, covariance)
        self.predict(odometry, step)
        return step

    def _start_at(self, odometry: Odometry) -> None:
        """Start where odometry has the robot, as well as it is localized."""
        self.predict(odometry)
        covariance = self._supervision.assumed_covariance(odometry)
        if covariance is not None and has_lasting_errors(covariance):
            self._state.is_in_map = True
            self.inflate_covariance(covariance.position_deviation, covariance.heading_deviation)
            self._error_growth = math.inf

    def correct_by(self, odometry: Odometry) -> None:
        """
        Correct the robot by the pose of odometry that measures it in the world.

        :param odometry: ``Odometry``, finite; changes nothing where it drifts.
        """
        covariance = self._supervision.assumed_covariance(odometry)
        if covariance is not None and self._error_growth < math.inf:
            self.update_robot(odometry.pose, self._error_growth * covariance.matrix)

    def take_place(self, place: RobotPlace) -> bool:
        """
        Correct the robot by its place in the map.

        While it pushes, contacts know more of robot and object than a map does: a place that does
        not fit waits for the end of the push.

        :param place: ``RobotPlace``; one that is not newer than the last is ignored.
        :return: whether the robot is elsewhere than it was estimated to be.
        """
        odometry, is_first = self._received, not self._places.has_place
        if odometry is None:
            return False
        present = self._places.at_present(place, odometry)
        if present is None or place.status is PlaceStatus.LOST:
            return False
        covariance = present.covariance.matrix
        if is_first and math.isinf(self.time_since_contact):
            self.inflate_covariance(*FIRST_PLACE_STDS)
        is_elsewhere = place.status is PlaceStatus.REGAINED or self.contradicts(present.pose,
                                                                                covariance)
        if not is_elsewhere:
            self.update_place(present.pose, covariance)
        elif self.time_since_contact > COUPLING_TIME:
            self.place_robot(present.pose, np.sqrt(np.diag(covariance)).tolist())
            return True
        return False

    def set_jumped(self, has_jumped: bool) -> None:
        """
        Set whether the pose of the next odometry has jumped, so that its step is not added up.

        :param has_jumped: whether it has.
        """
        self._has_jumped = has_jumped

    def corrected(self, odometry: Odometry) -> Odometry:
        """
        Return odometry with the robot where it is localized; unchanged before the first one.

        :param odometry: ``Odometry`` as it comes.
        """
        if not self.is_initialized:
            return odometry
        return Odometry(odometry.time, self.pose, odometry.twist, odometry.covariance)

    # Contact with the object.

    def update_from_contact(self, measured: ObjectPose, obj: PushedObject, robot: RoundRobot,
                            deviation: float, is_certain: bool = True) -> None:
        """
        Localize the robot by its contact with the object, at the time of an object pose.

        :param deviation: standard deviation of the gap [m].
        :param is_certain: whether they are in contact for certain.
        """
        _, normal, gap = self._measured_contact(measured, obj, robot)
        noise = self._control.assumed_covariance(measured)
        # Lever arm of the contact's normal, which leads through the robot's centre, about the
        # origin of the object, whose heading is noisy.
        robot_pose = self.pose_at(measured.time)
        x, y = robot_pose.x - measured.pose.x, robot_pose.y - measured.pose.y
        lever_arm = x * math.sin(normal) - y * math.cos(normal)
        noise_std = math.hypot(noise.position_deviation, lever_arm * noise.heading_deviation)
        self.update_along(normal, gap, max(deviation, noise_std), is_certain)

    def correct_overlap(self, measured: ObjectPose, obj: PushedObject, robot: RoundRobot,
                        deviation: float) -> None:
        """
        Correct a robot pose that overlaps the object.

        :param deviation: standard deviation of the gap [m].
        """
        if self._measured_contact(measured, obj, robot).gap < 0.0:
            self.update_from_contact(measured, obj, robot, deviation)

    def _measured_contact(self, measured: ObjectPose, obj: PushedObject,
                          robot: RoundRobot) -> NearestContact:
        """Find the contact at the time of an object pose."""
        robot_pose = self.pose_at(measured.time)
        return find_contact(obj, measured.pose, robot_pose[:2], robot.radius)


def _odometry_noise(supervision: SupervisionSettings) -> OdometryNoise:
    """Return errors of odometry; one whose pose is absolute has a random walk alone."""
    if supervision.odometry_reference == 'absolute':
        return OdometryNoise(0.0, 0.0, supervision.odometry_walk,
                             supervision.odometry_heading_walk)
    creep = CREEP_STD if supervision.has_limited_view else 0.0
    return OdometryNoise(supervision.odometry_scale, supervision.odometry_drift,
                         supervision.odometry_walk, supervision.odometry_heading_walk, creep)
