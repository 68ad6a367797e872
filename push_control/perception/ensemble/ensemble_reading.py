"""What an ensemble says of robot and object: means, covariances, and what is known of friction."""

import math

import numpy as np
from push_control.perception.ensemble.ensemble_state import EnsembleState, POSE, RobotMemory
from push_control.perception.ensemble.friction_members import (
    friction_centers, FrictionMembers, knowledge_of)
from push_control.perception.ensemble.members import (
    DRIFT, identified_object, Members, ODOMETRY_ERRORS, SCALE)
from push_control.perception.object_knowledge import ObjectKnowledge
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose, Odometry, PoseCovariance
from push_navigation.map_clearance import PositionUncertainty

# Drift [rad/m] over the random walk of the heading [rad/sqrt(m)] that moves a robot as far in a
# metre: sqrt(1/3) to 1/2.
HEADING_WALK_SHARE = 2.0 / math.sqrt(3.0)


class EnsembleReading:
    """Reads an ``EnsembleState``; the common interface of a single ensemble and of hypotheses."""

    def __init__(self, state: EnsembleState) -> None:
        """
        Read a state.

        :param state: the ``EnsembleState``, read whenever something is asked for.
        """
        self._state = state

    @property
    def members(self) -> Members:
        """The ``Members``, the same ones for good."""
        return self._state.members

    @property
    def is_initialized(self) -> bool:
        """Tell whether there was any odometry yet."""
        return self._state.odometry is not None

    @property
    def has_object(self) -> bool:
        """Tell whether there was any object pose yet."""
        return self._state.pose_time is not None

    @property
    def odometry(self) -> Odometry | None:
        """The newest ``Odometry``, as it came; None before the first."""
        return self._state.odometry

    # The robot.

    @property
    def pose(self) -> Pose:
        """
        Mean ``Pose`` of the robot at the last odometry.

        :raises RuntimeError: before the first odometry.
        """
        if not self.is_initialized:
            raise RuntimeError('localization: got no odometry, expected some before its pose')
        return self.members.mean_robot_pose

    @property
    def standard_deviations(self) -> FloatArray:
        """Standard deviations of x, y [m] and heading [rad] of the robot, shape (3,)."""
        return self.members.deviations[:POSE]

    @property
    def is_relative(self) -> bool:
        """Tell whether object poses are relative to the robot."""
        return self._state.is_relative

    @property
    def position_deviation(self) -> float:
        """
        Standard deviation of x or y of the robot, the greater one [m].

        Where object poses are relative to it: in the frame of the object, which is all that a push
        needs.
        """
        return self._state.position_deviation

    @property
    def position_uncertainty(self) -> PositionUncertainty:
        """``PositionUncertainty`` of the robot; random walks count as they do after a metre."""
        noise, parameters = self._state.odometry_noise, self.members.parameters
        scale, drift = parameters[:, [SCALE, DRIFT]].std(axis=0).tolist()
        return PositionUncertainty(
            self.members.position_deviation,
            math.hypot(float(self.standard_deviations[2]), scale, noise.walk),
            math.hypot(drift, HEADING_WALK_SHARE * noise.heading_walk))

    @property
    def odometry_scale(self) -> float:
        """Estimated part by which odometry means more motion than there is."""
        return float(self.members.parameters[:, SCALE].mean())

    @property
    def contact_ratio(self) -> float:
        """Ratio of members in which the robot touches the object."""
        return self.members.contact_ratio

    def pose_at(self, time: float) -> Pose:
        """
        Look up where the robot was, by linear interpolation.

        :param time: of the newest object pose, or later [s].
        :return: its mean ``Pose``, as estimated by now.
        """
        return Pose(*self._state.history.at(time)[:, :POSE].mean(axis=0).tolist())

    def remember_robot(self) -> RobotMemory:
        """
        Remember where the robots are, and their errors of odometry.

        :raises RuntimeError: before the first odometry.
        """
        odometry, members = self._state.odometry, self.members
        if odometry is None:
            raise RuntimeError('localization: got no odometry, expected some to remember')
        return RobotMemory(odometry.pose, members.robot_poses,
                           members.parameters[:, :ODOMETRY_ERRORS].copy())

    # The object.

    @property
    def object_pose(self) -> Pose:
        """Mean ``Pose`` of the object at the last odometry."""
        return self.members.mean_object_pose

    @property
    def object_deviations(self) -> FloatArray:
        """Standard deviations of x, y [m] and heading [rad] of the object, shape (3,)."""
        return self.members.deviations[POSE:]

    @property
    def object_covariance(self) -> PoseCovariance:
        """``PoseCovariance`` of the object at the last odometry."""
        matrix = np.cov(self.members.object_poses.T)
        return PoseCovariance.from_matrix(np.asarray(matrix, dtype=np.float64))

    @property
    def has_pose_bias(self) -> bool:
        """Tell whether object poses have a bias that is estimated."""
        return self._state.bias.exists

    def without_bias(self, measured: ObjectPose) -> ObjectPose:
        """
        Take the estimated bias off a measured object pose.

        :param measured: ``ObjectPose``, of the time of the history.
        """
        history, bias = self._state.history, self._state.bias
        if not history.times:
            return measured
        poses = history.at(measured.time)
        errors = bias.errors(poses[:, :POSE], poses[:, POSE:])
        x, y, theta = errors.mean(axis=0).tolist()
        pose = measured.pose
        return measured._replace(pose=Pose(pose.x - x, pose.y - y, wrap_angle(pose.theta - theta)))

    # Its friction.

    @property
    def obj(self) -> PushedObject:
        """The ``PushedObject`` with friction as identified."""
        return identified_object(self.members.obj, self.members.parameters)

    @property
    def knowledge(self) -> ObjectKnowledge:
        """Knowledge of the object by now."""
        return knowledge_of(self.members.obj, self._friction)

    @property
    def friction_center(self) -> tuple[float, float]:
        """Centre of friction as identified, object frame (x, y) [m]."""
        log_factors = self._friction.log_factors.mean(axis=0, keepdims=True)
        (x, y), = friction_centers(self.members.obj, log_factors).tolist()
        return x, y

    @property
    def friction_center_covariance(self) -> tuple[float, float, float]:
        """Covariance of the centre of friction in the object frame (xx, xy, yy) [m^2]."""
        centers = friction_centers(self.members.obj, self._friction.log_factors)
        matrix = np.cov(centers.T)
        return float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1])

    @property
    def _friction(self) -> FrictionMembers:
        parameters = self.members.parameters
        return FrictionMembers(parameters[:, ODOMETRY_ERRORS:-1], parameters[:, -1])
