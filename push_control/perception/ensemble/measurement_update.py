"""
Measurement update of an ensemble: object poses, and measured errors of the robot.

With the anomalies A of the state and B of what is measured, at its own time, as columns of n
members, the deterministic ensemble Kalman filter (Sakov and Oke, Tellus A 60 (2008)) moves the
mean by the gain K times the innovation, and the anomalies by half as much:

    K = A B' (B B' + (n - 1) R)^-1,    A <- A - K B / 2

That is exact for measurements that tell little each; a single one that tells much leaves up to
half of the standard deviation, so that no update makes the ensemble too sure.

An object that nobody touches tells nothing of the robot: then only the object is updated. Poses
that come late after a contact which nobody has seen tell of it, as those during one do. A pose
that nothing explains is an outlier. Several in a row are an object that somebody has moved; or,
after a contact which nobody has seen, one that the robot has pushed otherwise than any member
expects. Then the members differ too little, and are spread until they explain it.

A pose z that is relative to the robot is compared with each member's own relation of robot r and
object o, r^-1 o, and corrects relations and robots in their own axes (``correct_related``). It
tells of the robot and of odometry always, so that an object at rest is a landmark; but of friction
only after a contact, as chance correlations of the members would say more of it than there is to
know. After a contact that nobody has seen it tells of object and friction alone: what is pushed
comes along with the robot, wherever both have gone, and by how much it has turned is far from
linear in the errors of odometry. The relations are then drawn anew, as the pose leaves them, so
that what remains of that push is not taken for drift later. For the same reason it tells nothing
of wheels that creep.

What tells of the robot tells of walls, too. A wall that is not where the map has it stops or turns
the object elsewhere. That would be taken for an error of the robot.
"""

import math

import numpy as np
from push_control.perception.ensemble.ensemble_state import EnsembleState, POSE
from push_control.perception.ensemble.ensemble_update import EnsembleUpdate
from push_control.perception.ensemble.members import OBJECT_COLUMNS, ODOMETRY_ERRORS
from push_control.perception.ensemble.relation import (
    composed_poses, correct_related, relative_poses)
from push_control.settings import ControlSettings
from push_model.geometry import FloatArray, wrap_angle
from push_model.signals import ObjectPose

# Time after the last contact for which object poses still tell of the robot [s]; chosen: longer
# than they are late, and than the object slides on.
COUPLING_TIME = 0.4
# Standard deviations below which averaging does not bring the object's pose, as errors of
# successive measurements may be correlated [m], [rad]; chosen.
MIN_POSITION_STD = 0.0004
MIN_HEADING_STD = 0.001
MIN_STDS = MIN_POSITION_STD, MIN_POSITION_STD, MIN_HEADING_STD
# Squared Mahalanobis distance beyond which a pose is an outlier, and the number of outliers in a
# row after which the object has been moved; chosen: beyond five standard deviations, and longer
# than jumps of a tracker last.
OUTLIER_GATE = 27.0
MAX_OUTLIERS = 3
# Standard deviations that are added to a robot where an object next to it is not where it was
# pushed to [m], [rad]; chosen.
LOST_STDS = 0.03, 0.03, 0.05
# Standard deviations that are added to an object after a contact that nobody has seen [m], [rad];
# chosen: outlines err by millimetres, and so does what a tap moves.
UNSEEN_STDS = 0.003, 0.003, 0.01
# Squared Mahalanobis distance of an outlier once the members are spread, and the greatest factor
# by which they are; chosen: three standard deviations, and beyond it somebody has moved the
# object.
SPREAD_GATE = 9.0
MAX_SPREAD = 6.0
# Columns of a member's state that are motion and force: velocities, accelerations, mode, forces.
_MOTION = list(range(3, 9)) + list(range(15, 18))


class MeasurementUpdate:
    """Corrects the members of an ensemble by measurements."""

    def __init__(self, state: EnsembleState, settings: ControlSettings) -> None:
        """
        Start before the first measurement.

        :param state: the ``EnsembleState`` to correct.
        :param settings: ``ControlSettings``, for the noise of object poses.
        """
        self._state = state
        self._settings = settings

    def has_unseen_contact(self, time: float) -> bool:
        """
        Tell whether poses that come tell of a contact that nobody has seen.

        :param time: now [s].
        """
        state = self._state
        if state.pose_time is None:
            return False
        return state.last_contact > state.pose_time or time < state.coupled_until

    def update_object(self, measured: ObjectPose) -> bool:
        """
        Correct all members by a measured object pose.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        :return: whether the estimate includes it.
        """
        state = self._state
        state.is_relative = measured.relative is not None
        if state.pose_time is None:
            if state.is_relative:
                # No pose would tell how far wheels creep.
                state.members.wheel_creep[:] = 0.0
            self._place_objects(measured)
            state.pose_time = measured.time
            return True
        if measured.time <= state.pose_time or not state.history.times:
            return False
        if self._ends_unseen_contact(state.pose_time, measured.time):
            state.coupled_until = measured.time + COUPLING_TIME
            self._disturb_objects()
        state.pose_time = measured.time
        state.history.drop_before(measured.time)
        update, innovation = self._compare(measured)
        test = update.test(innovation)
        state.log_likelihood -= 0.5 * (min(test.squared_distance, OUTLIER_GATE)
                                       + test.log_determinant)
        if test.squared_distance > OUTLIER_GATE:
            return self._count_outlier(measured, innovation, test.squared_distance)
        if state.is_relative and measured.time < state.coupled_until:
            self._relate(measured, update)
        else:
            self._include(measured, update)
        return True

    def _relate(self, measured: ObjectPose, update: EnsembleUpdate) -> None:
        """Place the objects after a contact that nobody has seen; no robot moves."""
        state, members = self._state, self._state.members
        poses = state.history.at(measured.time)
        robots, objects = poses[:, :POSE], poses[:, OBJECT_COLUMNS:]
        placed = composed_poses(robots, update.resample(state.normal((members.count, POSE))))
        shifts = placed - objects - state.bias.errors(robots, objects)
        self._shift_objects(shifts)
        if state.knows_contact:
            friction = members.parameters[:, ODOMETRY_ERRORS:].copy()
            update.apply(friction)
            members.parameters[:, ODOMETRY_ERRORS:] = friction
            members.apply_parameters()
        state.outliers = 0
        state.explained_time = measured.time
        state.coupled_until = -math.inf

    def _shift_objects(self, shifts: FloatArray) -> None:
        """Move the objects of all members, now and before, by (x, y, theta), shape (n, 3)."""
        members = self._state.members
        self._state.history.poses[:, :, OBJECT_COLUMNS:] += shifts
        poses = members.poses.copy()
        poses[:, OBJECT_COLUMNS:] += shifts
        members.set_poses(poses, OBJECT_COLUMNS)

    def _disturb_objects(self) -> None:
        """Add what a contact that nobody has seen moves the objects otherwise, now and before."""
        samples = self._state.normal((self._state.members.count, POSE))
        self._shift_objects(UNSEEN_STDS * samples)

    def _compare(self, measured: ObjectPose) -> tuple[EnsembleUpdate, FloatArray]:
        """Compare a pose with what the members expect; return the update and its innovation."""
        expected = self._expected(measured.time, is_relative=self._state.is_relative)
        update = EnsembleUpdate(expected, self._noise(measured))
        innovation = np.array(measured.relative or measured.pose) - update.mean
        innovation[2] = wrap_angle(innovation[2])
        return update, innovation

    def _include(self, measured: ObjectPose, update: EnsembleUpdate) -> None:
        """Correct all members by an object pose whose innovation was tested."""
        state = self._state
        state.outliers = 0
        state.explained_time = measured.time
        is_coupled = (state.time_since_contact(measured.time) < COUPLING_TIME
                      or measured.time < state.coupled_until)
        self._correct(update, is_coupled or state.is_relative,
                      tells_of_friction=is_coupled and state.knows_contact,
                      is_relation=state.is_relative)
        self._keep_object_stds()

    def update_robot(self, update: EnsembleUpdate, innovation: FloatArray,
                     is_certain: bool) -> None:
        """
        Correct all members by a measured error of the robot's pose.

        :param update: ``EnsembleUpdate`` by what is measured of the robots.
        :param innovation: measured minus mean, shape (m,).
        :param is_certain: whether an outlier means that the robot has jumped; else it is rejected.
        """
        state = self._state
        test = update.test(innovation)
        is_outlier = test.squared_distance > OUTLIER_GATE * len(innovation)
        if not is_outlier:
            self._correct(update, is_coupled=True)
        elif is_certain:
            # All members jump with it.
            robots = state.members.robot_poses
            state.members.set_robot_poses(robots + update.jump(robots))
            state.restart_history()

    def update_place(self, update: EnsembleUpdate, innovation: FloatArray) -> None:
        """
        Correct all members by the robot's place in a map; of friction it tells nothing.

        :param update: ``EnsembleUpdate`` by the poses of the robots.
        :param innovation: measured minus mean, shape (3,).
        """
        update.test(innovation)
        self._correct(update, is_coupled=True, tells_of_friction=False)

    def _ends_unseen_contact(self, previous_time: float, time: float) -> bool:
        """Tell whether a pose is the first one after a contact that nobody has seen."""
        return time - previous_time > COUPLING_TIME and self._state.last_contact > previous_time

    def _expected(self, time: float, *, is_relative: bool) -> FloatArray:
        """Return the object poses that the members expect to be measured, shape (n, 3)."""
        bias, poses = self._state.bias, self._state.history.at(time)
        robots, objects = poses[:, :POSE], poses[:, POSE:]
        if bias.exists:
            objects = objects + bias.errors(robots, objects)
        return relative_poses(robots, objects) if is_relative else objects

    def _noise(self, measured: ObjectPose) -> FloatArray:
        """Return the covariance of the errors that differ from one object pose to the next."""
        covariance, bias = self._settings.assumed_covariance(measured).matrix, self._state.bias
        return covariance + bias.roughness if bias.exists else covariance

    def _correct(self, update: EnsembleUpdate, is_coupled: bool, *,
                 tells_of_friction: bool = True, is_relation: bool = False) -> None:
        """
        Update all members by a measurement.

        :param update: ``EnsembleUpdate``, its innovation tested.
        :param is_coupled: whether it tells of the robot and of odometry too.
        :param tells_of_friction: whether it then tells of friction as well.
        :param is_relation: whether it is of the object relative to the robot.
        """
        state, members = self._state, self._state.members
        first = 0 if is_coupled else OBJECT_COLUMNS
        poses = members.poses.copy()
        if is_relation:
            poses = correct_related(update, poses)
            state.history.poses[:] = [correct_related(update, earlier)
                                      for earlier in state.history.poses]
        else:
            update.apply(poses, first)
            update.apply_to_all(state.history.poses, first)
        if state.bias.exists:
            update.apply(state.bias.coefficients)
        members.set_poses(poses, first)
        if not is_coupled:
            return
        if members.wall_errors is not None:
            update.apply(members.wall_errors)
            members.forget_wall_distances()
        if tells_of_friction:
            update.apply(members.parameters)
            if not state.is_relative:
                update.apply(members.wheel_creep)
            members.apply_parameters()
        else:
            errors = members.parameters[:, :ODOMETRY_ERRORS].copy()
            update.apply(errors)
            members.parameters[:, :ODOMETRY_ERRORS] = errors
        if state.pose_time is not None:
            members.close_gaps()

    def _keep_object_stds(self) -> None:
        """Add errors to the objects where averaging has made them too equal."""
        members = self._state.members
        deviations = members.deviations[OBJECT_COLUMNS:]
        if self._state.is_relative:
            deviations = relative_poses(members.robot_poses, members.object_poses).std(axis=0)
        stds = deviations.tolist()
        missing = [math.sqrt(max(0.0, min_std ** 2 - std ** 2))
                   for min_std, std in zip(MIN_STDS, stds)]
        if any(missing) and members.contact_ratio == 0.0:
            poses = members.poses.copy()
            poses[:, OBJECT_COLUMNS:] += missing * self._state.normal((members.count, POSE))
            members.set_poses(poses, OBJECT_COLUMNS)

    def _count_outlier(self, measured: ObjectPose, innovation: FloatArray,
                       squared_distance: float) -> bool:
        """Count a pose that nothing explains; return whether the object was moved there."""
        state = self._state
        state.outliers += 1
        if state.outliers < MAX_OUTLIERS:
            return False
        spread = math.sqrt(squared_distance / SPREAD_GATE)
        if self._had_unseen_contact and not state.is_relative and spread <= MAX_SPREAD:
            self._spread_members(spread)
            update, innovation = self._compare(measured)
            update.test(innovation)
            state.coupled_until = measured.time + COUPLING_TIME
            self._include(measured, update)
        else:
            self._accept_displacement(measured, innovation)
        return True

    @property
    def _had_unseen_contact(self) -> bool:
        """Whether there was a contact since the last pose that the members explain."""
        state = self._state
        return (state.odometry_noise.creep > 0.0
                and state.last_contact > state.explained_time + COUPLING_TIME)

    def _spread_members(self, factor: float) -> None:
        """Spread the poses of all members about their mean, now and before."""
        members, history = self._state.members, self._state.history.poses
        history += (factor - 1.0) * (history - history.mean(axis=1, keepdims=True))
        poses = members.poses
        members.set_poses(poses + (factor - 1.0) * (poses - poses.mean(axis=0)))

    def _accept_displacement(self, measured: ObjectPose, displacement: FloatArray) -> None:
        """Accept that the object is elsewhere: somebody has moved it, or the robot is lost."""
        state = self._state
        was_pushed = not state.is_relative and (
            state.members.contact_ratio > 0.0 or self._had_unseen_contact)
        if state.bias.explains(displacement):
            # Perhaps it is where it was, and the robot sees another mark.
            state.bias.forget()
        self._place_objects(measured)
        if was_pushed:
            state.inflate_robots(LOST_STDS)

    def _place_objects(self, measured: ObjectPose) -> None:
        state, members = self._state, self._state.members
        stds = np.sqrt(np.diag(self._noise(measured)))
        poses = (np.array(measured.relative or measured.pose)
                 + stds * state.normal((members.count, POSE)))
        if measured.relative is not None:
            poses = composed_poses(members.robot_poses, poses)
        members.set_object_poses(poses - state.bias.errors(members.robot_poses, poses))
        members.states[:, _MOTION] = 0.0
        state.outliers = 0
        state.explained_time = measured.time
        state.restart_history()
