"""
Ensemble filter of robot and object: localization, and what pushes reveal of friction.

The state of a member is

    x = (robot pose, object pose, previous object poses, odometry errors s, g, d,
         logarithms of the support friction, contact friction).

``prediction`` moves the members by odometry, ``measurement_update`` corrects them, and
``ensemble_reading`` says what they mean. ``contact_hypotheses`` compares two such ensembles.
"""

import copy
import math
from typing import Sequence

import numpy as np
from push_control.perception.ensemble.ensemble_reading import EnsembleReading
from push_control.perception.ensemble.ensemble_state import (
    EnsembleState, OdometryNoise, POSE, RobotMemory)
from push_control.perception.ensemble.ensemble_update import EnsembleUpdate
from push_control.perception.ensemble.friction_members import with_knowledge
from push_control.perception.ensemble.measurement_update import (
    MeasurementUpdate, OUTLIER_GATE)
from push_control.perception.ensemble.members import MEMBER_COUNT, Members, ODOMETRY_ERRORS
from push_control.perception.ensemble.pose_bias import PoseBias
from push_control.perception.ensemble.prediction import Prediction
from push_control.perception.ensemble.wheel_creep import spread_creep
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.settings import ControlSettings
from push_localization.fusion import lasting_noise
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry


class PushEnsemble(EnsembleReading):
    """Estimates poses of robot and object, errors of odometry, and friction."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 odometry_noise: OdometryNoise, seed: int = 0) -> None:
        """
        Start without poses; the first measurements give them.

        :param control: ``ControlSettings``, for the noise of object poses.
        :param seed: of the random samples of the members.
        """
        # The bias has a generator of its own: nothing else depends on whether there is one.
        bias = PoseBias(control.pose_bias, control.heading_bias, MEMBER_COUNT,
                        np.random.default_rng((seed, 1)))
        super().__init__(EnsembleState(Members(obj, robot, MEMBER_COUNT), bias, odometry_noise,
                                       np.random.default_rng(seed)))
        self._prediction = Prediction(self._state)
        self._measurement_update = MeasurementUpdate(self._state, control)

    @property
    def log_likelihood(self) -> float:
        """Logarithm of the likelihood of all object poses, up to a constant."""
        return self._state.log_likelihood

    @property
    def time_since_contact(self) -> float:
        """Time from the last contact to the last odometry [s]; infinite before either."""
        odometry = self._state.odometry
        return math.inf if odometry is None else self._state.time_since_contact(odometry.time)

    @property
    def has_unseen_contact(self) -> bool:
        """Tell whether poses that come tell of a contact that nobody has seen."""
        odometry = self._state.odometry
        return (odometry is not None
                and self._measurement_update.has_unseen_contact(odometry.time))

    # Filter.

    def predict(self, odometry: Odometry, step: Pose | None = None) -> bool:
        """
        Move all members by odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :param step: motion of the robot since the last one as ``Pose`` in its axes then, where the
            poses of odometry do not say it; else None.
        :return: whether the odometry is new.
        """
        return self._prediction.predict(odometry, step)

    def update(self, measured: ObjectPose) -> bool:
        """
        Correct all members by a measured object pose.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        :return: whether the estimate includes it.
        """
        return self._measurement_update.update_object(measured)

    def update_robot(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct the robot's pose by a measured one, as of motion capture.

        :param pose: ``Pose`` in the world.
        :param covariance: of that measurement (x, y, heading), shape (3, 3).
        """
        estimate = self.pose
        self.update_pose((pose.x - estimate.x, pose.y - estimate.y, pose.theta - estimate.theta),
                         covariance)

    def update_place(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct the robot's pose by its place in a map, whose errors last.

        Nothing changes along directions in which the members know as much already.

        :param pose: ``Pose`` in the world.
        :param covariance: of that measurement (x, y, heading), shape (3, 3).
        """
        information = np.asarray(np.linalg.inv(covariance), dtype=np.float64)
        noise = lasting_noise(self._robot_covariance, information)
        if noise is not None:
            update = EnsembleUpdate(self.members.robot_poses, noise)
            self._measurement_update.update_place(update, self._error(pose))

    def contradicts(self, pose: Pose, covariance: FloatArray) -> bool:
        """
        Tell whether a measured pose of the robot is one that the members do not explain.

        :param pose: ``Pose`` in the world.
        :param covariance: of that measurement (x, y, heading), shape (3, 3).
        """
        error = self._error(pose)
        total = self._robot_covariance + covariance
        return float(error @ np.linalg.solve(total, error)) > OUTLIER_GATE

    @property
    def _robot_covariance(self) -> FloatArray:
        return np.asarray(np.cov(self.members.robot_poses.T), dtype=np.float64)

    def _error(self, pose: Pose) -> FloatArray:
        """Return a pose less the estimate, the heading wrapped."""
        estimate = self.pose
        return np.array([pose.x - estimate.x, pose.y - estimate.y,
                         wrap_angle(pose.theta - estimate.theta)])

    def update_pose(self, error: Sequence[float], covariance: FloatArray,
                    is_certain: bool = True) -> None:
        """
        Correct the robot's pose by a measured error.

        :param error: true minus estimated pose, (x, y, heading) [m, m, rad].
        :param covariance: of that measurement, shape (3, 3).
        :param is_certain: whether the measurement holds even where the ensemble does not explain
            it; else it is rejected then.
        """
        innovation = np.array([*error[:2], wrap_angle(error[2])])
        self._measurement_update.update_robot(
            EnsembleUpdate(self.members.robot_poses, covariance), innovation, is_certain)

    def update_along(self, direction: float, error: float, deviation: float,
                     is_certain: bool = True) -> None:
        """
        Correct the robot's pose by an error along one direction, as by a contact.

        :param direction: world angle [rad].
        :param error: true minus estimated position along it [m].
        :param deviation: standard deviation of that measurement [m].
        :param is_certain: as of ``update_pose``.
        """
        robots = self.members.robot_poses
        along = robots[:, 0] * math.cos(direction) + robots[:, 1] * math.sin(direction)
        self._measurement_update.update_robot(
            EnsembleUpdate(along[:, None], np.array([[deviation ** 2]])), np.array([error]),
            is_certain)

    # What else is learned of the robot.

    def inflate_covariance(self, deviation: float, heading_deviation: float = 0.0) -> None:
        """
        Make the robot's pose less certain, as after a search without success.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._state.inflate_robots((deviation, deviation, heading_deviation))

    def place_robot(self, pose: Pose, deviations: Sequence[float]) -> None:
        """
        Replace the estimate of the robot's pose.

        :param pose: its ``Pose``, about.
        :param deviations: standard deviations of x, y [m] and heading [rad].
        """
        errors = self._state.normal((self.members.count, POSE)) * deviations
        self._state.set_robots(np.array(pose) + errors)

    def restore_robot(self, memory: RobotMemory, deviation: float,
                      heading_deviation: float) -> None:
        """
        Return to an earlier estimate of the robot, moved by odometry since.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        :raises RuntimeError: before the first odometry.
        """
        odometry, members = self.odometry, self.members
        if odometry is None:
            raise RuntimeError('localization: got no odometry, expected some to restore the robot')
        step = memory.odometry_pose.inverse() @ odometry.pose
        c, s = np.cos(memory.robots[:, 2]), np.sin(memory.robots[:, 2])
        moved = np.stack((c * step.x - s * step.y, s * step.x + c * step.y,
                          np.full(members.count, wrap_angle(step.theta))), axis=1)
        stds = deviation, deviation, heading_deviation
        errors = self._state.normal((members.count, POSE)) * stds
        members.parameters[:, :ODOMETRY_ERRORS] = memory.odometry_errors
        self._state.set_robots(memory.robots + moved + errors)

    def take_over_robot(self, previous: EnsembleReading) -> None:
        """
        Start with the robot as another ensemble has it, and with the same errors of odometry.

        :param previous: estimate with another object; nothing is taken before its first odometry.
        """
        if previous.odometry is not None:
            self.predict(previous.odometry)
            self.restore_robot(previous.remember_robot(), 0.0, 0.0)
            self.members.wheel_creep[:] = previous.members.wheel_creep

    # What is known of friction.

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """
        Start from what was learned of the object before.

        :param knowledge: ``ObjectKnowledge``, as it is by now.
        """
        members = self.members
        friction = with_knowledge(members.obj, self._friction, knowledge)
        members.parameters[:, ODOMETRY_ERRORS:-1] = friction.log_factors
        self.set_contact_friction(friction.contact_friction)

    def set_contact_friction(self, friction: FloatArray) -> None:
        """
        Set the contact friction of all members.

        :param friction: shape (n,).
        """
        self.members.parameters[:, -1] = friction
        self.members.apply_parameters()

    def let_wheels_creep(self) -> None:
        """Follow wheels that creep, by an amount that is to be estimated."""
        self.members.wheel_creep[:] = spread_creep(self.members.count, self._state.rng)

    # Copies.

    def fork(self) -> 'PushEnsemble':
        """Copy the ensemble with its random numbers, so that both go on alike."""
        return copy.deepcopy(self)

    def assign(self, fork: 'PushEnsemble') -> None:
        """
        Take over the estimate of a fork; ``members`` stay the same object.

        :param fork: with the same measurements; not used afterwards.
        """
        self._state.assign(fork._state)
