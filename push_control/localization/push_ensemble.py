"""
Ensemble filter of robot and object: localization, and what pushes reveal of friction.

The state of a member is

    x = (robot pose, object pose, former object poses, odometry errors s, g, d,
         logarithms of the support friction, contact friction).

**Prediction.** A step (dx, dy, dtheta) of odometry, of length l, moves the robot of a member by

    (dx, dy) / (1 + s),    (1 + g) dtheta - d l,

plus a random walk whose variance is in proportion to l; the compiled dynamics move the object
with it.

**Update.** With the anomalies A of the state and B of what is measured, at its own time, as
columns of n members, the deterministic ensemble Kalman filter (Sakov and Oke, Tellus A 60 (2008))
moves the mean by the gain K times the innovation, and the anomalies by half as much:

    K = A B' (B B' + (n - 1) R)^-1,    A <- A - K B / 2

That is exact for measurements that tell little each; a single one that tells much leaves up to
half of the standard deviation, so that no update makes the ensemble too sure.

An object that nobody touches tells nothing of the robot: then only the object is updated. A pose
that nothing explains is an outlier; several in a row are an object that somebody has moved.

Whether the contact is about as rough as stated or slippery is decided between two ensembles
(``slip_test``).
"""

import copy
import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.estimation.friction_members import (
    friction_centers, FrictionMembers, knowledge_of, with_knowledge,
)
from push_control.estimation.object_knowledge import ObjectKnowledge
from push_control.localization.ensemble_update import (
    add_odometry, center, disturb_objects, EnsembleUpdate,
)
from push_control.localization.members import (
    CONTACT_FRICTION_STD, DRIFT, identified_object, LONGEST_STEP, MEMBER_COUNT, Members,
    OBJECT_COLUMNS, ODOMETRY_ERRORS, SCALE, SUPPORT_LOG_STD, YAW_SCALE,
)
from push_control.localization.pose_bias import PoseBias
from push_control.localization.pose_history import PoseHistory
from push_control.localization.slip_test import slippery_friction, SlipTest, SlipVerdict
from push_control.settings import ControlSettings
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, PoseCovariance
from push_navigation.map_clearance import PlaceUncertainty

# Time after the last contact for which object poses still tell of the robot [s]; chosen: longer
# than they are late, and than the object slides on.
COUPLING_TIME = 0.4
# Random walk of the object's motion against the dynamics per root of its path length [m/sqrt(m)]
# and [rad/sqrt(m)]; chosen: contacts that creep by 1 % of the way are within it.
POSITION_WALK = 0.006
HEADING_WALK = 0.012
OBJECT_WALKS: FloatArray = np.array((POSITION_WALK, POSITION_WALK, HEADING_WALK))
# Standard deviations below which averaging does not bring the object's pose, as errors of
# successive measurements may be correlated [m], [rad]; chosen.
LEAST_POSITION_STD = 0.0004
LEAST_HEADING_STD = 0.001
LEAST_STDS = LEAST_POSITION_STD, LEAST_POSITION_STD, LEAST_HEADING_STD
# Standard deviations of the first robot pose relative to the world [m], [rad]; chosen: odometry
# begins in the frame of the poses.
START_POSITION_STD = 0.002
START_HEADING_STD = 0.003
# Relative error of rotations measured by odometry; chosen: one per cent of the track width.
YAW_SCALE_STD = 0.01
# Squared Mahalanobis distance beyond which a pose is an outlier, and the number of outliers in a
# row after which the object has been moved; chosen: beyond five standard deviations, and longer
# than jumps of a tracker last.
OUTLIER_GATE = 27.0
MAX_OUTLIERS = 3
# Standard deviations by which the robots are spread where an object next to them is not where it
# was pushed to [m], [rad]; chosen.
LOST_POSITION_STD = 0.03
LOST_HEADING_STD = 0.05
# Below this a step of odometry is rest [m], [rad].
REST = 1e-9
# Drift [rad/m] over the random walk of the heading [rad/sqrt(m)] that moves a robot as far in a
# metre: sqrt(1/3) to 1/2.
HEADING_WALK_SHARE = 2.0 / math.sqrt(3.0)
POSE = 3


class OdometryNoise(NamedTuple):
    """
    Standard deviations of the errors of odometry.

    :param scale: relative error of distances.
    :param drift: heading error per distance [rad/m].
    :param walk: random walk of the position [m/sqrt(m)].
    :param heading_walk: random walk of the heading [rad/sqrt(m)].
    """

    scale: float
    drift: float
    walk: float
    heading_walk: float


class RobotMemory(NamedTuple):
    """
    What was estimated of the robot at a time.

    :param odometry_pose: ``Pose`` of odometry then.
    :param robots: poses (x, y, theta) of all members, shape (n, 3).
    :param odometry_errors: of all members, shape (n, 3).
    """

    odometry_pose: Pose
    robots: FloatArray
    odometry_errors: FloatArray


class PushEnsemble:
    """Estimates poses of robot and object, errors of odometry, and friction."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 odometry_noise: OdometryNoise, seed: int = 0) -> None:
        """
        Start without poses; the first measurements give them.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``, for the noise of object poses.
        :param odometry_noise: ``OdometryNoise``.
        :param seed: of the random draws of the members.
        """
        self.members = Members(obj, robot, MEMBER_COUNT)
        self._settings = control
        self._odometry_noise = odometry_noise
        self._odometry_walks: FloatArray = np.array(
            (odometry_noise.walk, odometry_noise.walk, odometry_noise.heading_walk), dtype=float)
        self._rng = np.random.default_rng(seed)
        # Scratch: means of random numbers.
        self._means: FloatArray = np.empty(POSE)
        # With numbers of its own: all others do not depend on whether there is a bias.
        self._bias = PoseBias(control.pose_bias, control.heading_bias, MEMBER_COUNT,
                              np.random.default_rng((seed, 1)))
        self._odometry: Odometry | None = None
        self._history = PoseHistory()
        self._last_contact = -math.inf
        self._pose_time: float | None = None
        self._outliers = 0
        self._log_likelihood = 0.0
        self._slip_test = SlipTest()
        self._slippery: PushEnsemble | None = None
        self._draw_parameters()

    def _draw_parameters(self) -> None:
        members, noise = self.members, self._odometry_noise
        parameters = members.parameters
        spread = self._normal((members.count, parameters.shape[1]))
        parameters[:, SCALE] = noise.scale * spread[:, SCALE]
        parameters[:, YAW_SCALE] = YAW_SCALE_STD * spread[:, YAW_SCALE]
        parameters[:, DRIFT] = noise.drift * spread[:, DRIFT]
        parameters[:, ODOMETRY_ERRORS:-1] = SUPPORT_LOG_STD * spread[:, ODOMETRY_ERRORS:-1]
        parameters[:, -1] *= 1.0 + CONTACT_FRICTION_STD * spread[:, -1]
        members.apply_parameters()

    def _warm_up(self) -> None:
        """Change nothing; but load all compiled code before the robot moves."""
        members = self.members
        none, poses = np.zeros((members.count, POSE)), members.poses.copy()
        update = EnsembleUpdate(none, np.eye(POSE))
        update.test(np.zeros(POSE))
        update.apply(poses)
        update.apply_to_all(poses[None])
        members.move(none, LONGEST_STEP)
        members.close_gaps()
        disturb_objects(poses, poses.copy(), none, self._means, OBJECT_WALKS)
        members.set_poses(poses)
        add_odometry(none, self._means, members.parameters, self._odometry_walks, (0.0, 0.0, 0.0))

    # Estimates.

    @property
    def is_initialized(self) -> bool:
        """Whether there was any odometry yet."""
        return self._odometry is not None

    @property
    def has_object(self) -> bool:
        """Whether there was any object pose yet."""
        return self._pose_time is not None

    @property
    def pose(self) -> Pose:
        """
        Mean ``Pose`` of the robot at the last odometry.

        :raises RuntimeError: before the first odometry.
        """
        if self._odometry is None:
            raise RuntimeError('localization: got no odometry, expected some before its pose')
        return self.members.mean_robot_pose

    @property
    def object_pose(self) -> Pose:
        """Mean ``Pose`` of the object at the last odometry."""
        return self.members.mean_object_pose

    @property
    def object_deviations(self) -> FloatArray:
        """Standard deviations of x, y [m] and heading [rad] of the object, shape (3,)."""
        return self.members.deviations[POSE:]

    @property
    def has_pose_bias(self) -> bool:
        """Whether object poses have a bias that is estimated."""
        return self._bias.exists

    @property
    def object_covariance(self) -> PoseCovariance:
        """``PoseCovariance`` of the object at the last odometry."""
        matrix = np.cov(self.members.object_poses.T)
        return PoseCovariance.from_matrix(np.asarray(matrix, dtype=np.float64))

    @property
    def standard_deviations(self) -> FloatArray:
        """Standard deviations of x, y [m] and heading [rad] of the robot, shape (3,)."""
        return self.members.deviations[:POSE]

    @property
    def position_deviation(self) -> float:
        """Standard deviation of x or y of the robot, the greater one [m]."""
        return self.members.position_deviation

    @property
    def place_uncertainty(self) -> PlaceUncertainty:
        """``PlaceUncertainty`` of the robot; random walks count as they do after a metre."""
        noise, parameters = self._odometry_noise, self.members.parameters
        scale, drift = parameters[:, [SCALE, DRIFT]].std(axis=0).tolist()
        return PlaceUncertainty(
            self.position_deviation,
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

    @property
    def obj(self) -> PushedObject:
        """The ``PushedObject`` with friction as identified."""
        return identified_object(self.members.obj, self.members.parameters)

    @property
    def knowledge(self) -> ObjectKnowledge:
        """What is known of the object by now."""
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

    def pose_at(self, time: float) -> Pose:
        """
        Look up where the robot was, by linear interpolation.

        :param time: of the newest object pose, or later [s].
        :return: its mean ``Pose``, as estimated by now.
        """
        return Pose(*self._history.at(time)[:, :POSE].mean(axis=0).tolist())

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """
        Believe what was learned of the object before.

        :param knowledge: ``ObjectKnowledge``, as it is by now.
        """
        members = self.members
        friction = with_knowledge(members.obj, self._friction, knowledge)
        members.parameters[:, ODOMETRY_ERRORS:-1] = friction.log_factors
        members.parameters[:, -1] = friction.contact_friction
        members.apply_parameters()

    def take_over_robot(self, former: 'PushEnsemble') -> None:
        """
        Start with the robot as another ensemble has it, and with the same errors of odometry.

        :param former: ``PushEnsemble`` of another object; nothing is taken before its first
            odometry.
        """
        if former._odometry is not None:
            self.predict(former._odometry)
            self.restore_robot(former.remember_robot(), 0.0, 0.0)

    # Prediction.

    def predict(self, odometry: Odometry, step: Pose | None = None) -> None:
        """
        Move all members by odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :param step: motion of the robot since the last one as ``Pose`` in its axes then, where the
            pose of odometry has jumped; None for that of its pose.
        """
        if self._slippery is not None:
            self._slippery.predict(odometry, step)
        if self._odometry is None:
            self._warm_up()
            deviations = (START_POSITION_STD, START_POSITION_STD, START_HEADING_STD)
            spread = self._normal((self.members.count, POSE)) * deviations
            self.members.set_robot_poses(np.array(odometry.pose) + spread)
        elif odometry.time > self._odometry.time:
            self._move(step or self._odometry.pose.inverse() @ odometry.pose,
                       odometry.time - self._odometry.time, odometry.time)
        else:
            return
        self._odometry = odometry
        self._history.append(odometry.time, self.members.poses)
        if odometry.time == self._last_contact:
            self._suppose_slippery()
        elif odometry.time - self._last_contact > COUPLING_TIME:
            self._follow_likelier()

    def _move(self, step: Pose, duration: float, time: float) -> None:
        members = self.members
        rotation = wrap_angle(step.theta)
        is_at_rest = math.hypot(step.x, step.y) < REST and abs(rotation) < REST
        if is_at_rest and not members.in_contact.any():
            return
        increments = self._rng.standard_normal((members.count, POSE))
        add_odometry(increments, self._means, members.parameters, self._odometry_walks,
                     (step.x, step.y, rotation))
        before = members.poses if self.has_object else None
        if members.move(increments, duration):
            self._last_contact = time
            if before is not None:
                self._disturb_objects(before)

    def _disturb_objects(self, before: FloatArray) -> None:
        """Add what the dynamics do not know to the motion of the objects."""
        poses = self.members.poses.copy()
        disturb_objects(poses, before.copy(), self._rng.standard_normal((len(poses), POSE)),
                        self._means, OBJECT_WALKS)
        self.members.set_poses(poses, OBJECT_COLUMNS)

    # Updates.

    def update(self, measured: ObjectPose) -> bool:
        """
        Correct all members by a measured object pose.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        :return: whether it was believed.
        """
        slippery = self._slippery
        is_believed = self._update(measured)
        if slippery is None:
            return is_believed
        is_explained = slippery._update(measured)
        verdict = self._slip_test.judge(self._log_likelihood_ratio(slippery))
        self._follow(slippery, verdict)
        return is_explained if verdict is SlipVerdict.SLIPPERY else is_believed

    def _update(self, measured: ObjectPose) -> bool:
        if self._pose_time is None:
            self._place_objects(measured)
            self._pose_time = measured.time
            return True
        if measured.time <= self._pose_time or not self._history.times:
            return False
        self._pose_time = measured.time
        self._history.drop_before(measured.time)
        poses = self._history.at(measured.time)
        expected = poses[:, POSE:]
        if self._bias.exists:
            expected = expected + self._bias.errors(poses[:, :POSE], expected)
        update = EnsembleUpdate(expected, self._noise(measured))
        innovation = np.array(measured.pose) - update.mean
        innovation[2] = wrap_angle(innovation[2])
        test = update.test(innovation)
        self._log_likelihood -= 0.5 * (min(test.squared_distance, OUTLIER_GATE)
                                       + test.log_determinant)
        if test.squared_distance > OUTLIER_GATE:
            self._outliers += 1
            is_displaced = self._outliers >= MAX_OUTLIERS
            if is_displaced:
                self._on_object_displaced(measured, innovation)
            return is_displaced
        self._outliers = 0
        self._correct(update, measured.time - self._last_contact < COUPLING_TIME)
        self._keep_object_spread()
        return True

    def _noise(self, measured: ObjectPose) -> FloatArray:
        """Covariance of the errors that differ from one object pose to the next."""
        covariance = self._settings.believed_covariance(measured).matrix
        return covariance + self._bias.roughness if self._bias.exists else covariance

    def without_bias(self, measured: ObjectPose) -> ObjectPose:
        """
        Take the estimated bias off a measured object pose.

        :param measured: ``ObjectPose``, of the time of the history.
        """
        if not self._history.times:
            return measured
        poses = self._history.at(measured.time)
        errors = self._bias.errors(poses[:, :POSE], poses[:, POSE:])
        x, y, theta = errors.mean(axis=0).tolist()
        pose = measured.pose
        return measured._replace(pose=Pose(pose.x - x, pose.y - y, wrap_angle(pose.theta - theta)))

    def update_robot(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct the robot's pose by a measured one, as of motion capture.

        :param pose: ``Pose`` in the world.
        :param covariance: of that measurement (x, y, heading), shape (3, 3).
        """
        if self._slippery is not None:
            self._slippery.update_robot(pose, covariance)
        estimate = self.pose
        self.update_pose((pose.x - estimate.x, pose.y - estimate.y, pose.theta - estimate.theta),
                         covariance)

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
        self._correct_robot(EnsembleUpdate(self.members.robot_poses, covariance), innovation,
                            is_certain)

    def update_along(self, direction: float, error: float, deviation: float,
                     is_certain: bool = True) -> None:
        """
        Correct the robot's pose by an error along one direction, as by a contact.

        :param direction: world angle [rad].
        :param error: true minus estimated position along it [m].
        :param deviation: standard deviation of that measurement [m].
        :param is_certain: as of ``update_pose``.
        """
        self._slippery = None
        robots = self.members.robot_poses
        along = robots[:, 0] * math.cos(direction) + robots[:, 1] * math.sin(direction)
        self._correct_robot(EnsembleUpdate(along[:, None], np.array([[deviation ** 2]])),
                            np.array([error]), is_certain)

    def inflate_covariance(self, deviation: float, heading_deviation: float = 0.0) -> None:
        """
        Spread the robots, as after a search in vain.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._slippery = None
        self._spread_robots(deviation, heading_deviation)

    def _spread_robots(self, deviation: float, heading_deviation: float) -> None:
        spread = self._normal((self.members.count, POSE))
        self._set_robots(
            self.members.robot_poses + spread * (deviation, deviation, heading_deviation))

    def place_robot(self, pose: Pose, deviations: Sequence[float]) -> None:
        """
        Forget where the robot was estimated to be, and its errors of odometry.

        :param pose: its ``Pose``, about.
        :param deviations: standard deviations of x, y [m] and heading [rad].
        """
        members = self.members
        self._slippery = None
        self._set_robots(np.array(pose) + self._normal((members.count, POSE)) * deviations)

    def remember_robot(self) -> RobotMemory:
        """Remember where the robots are, and their errors of odometry."""
        assert self._odometry is not None
        return RobotMemory(self._odometry.pose, self.members.robot_poses,
                           self.members.parameters[:, :ODOMETRY_ERRORS].copy())

    def restore_robot(self, memory: RobotMemory, deviation: float,
                      heading_deviation: float) -> None:
        """
        Take back what was inferred of the robot; since then it has moved as odometry says.

        :param memory: ``RobotMemory``.
        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        assert self._odometry is not None
        members = self.members
        self._slippery = None
        step = memory.odometry_pose.inverse() @ self._odometry.pose
        c, s = np.cos(memory.robots[:, 2]), np.sin(memory.robots[:, 2])
        moved = np.stack((c * step.x - s * step.y, s * step.x + c * step.y,
                          np.full(members.count, wrap_angle(step.theta))), axis=1)
        spread = self._normal((members.count, POSE)) * (deviation, deviation, heading_deviation)
        members.parameters[:, :ODOMETRY_ERRORS] = memory.odometry_errors
        self._set_robots(memory.robots + moved + spread)

    def _set_robots(self, poses: FloatArray) -> None:
        members = self.members
        members.set_robot_poses(poses)
        members.states[:, _FORCES] = 0.0
        if self.has_object:
            members.close_gaps()
        self._forget_history()

    def _correct_robot(self, update: EnsembleUpdate, innovation: FloatArray,
                       is_certain: bool) -> None:
        test = update.test(innovation)
        is_outlier = test.squared_distance > OUTLIER_GATE * len(innovation)
        if is_outlier and not is_certain:
            return
        if is_outlier:
            # The robot has jumped: all members jump with it.
            robots = self.members.robot_poses
            self.members.set_robot_poses(robots + update.jump(robots))
            self._forget_history()
            return
        self._correct(update, True)

    def _correct(self, update: EnsembleUpdate, is_coupled: bool) -> None:
        """
        Update all members by a measurement.

        :param update: ``EnsembleUpdate``, its innovation tested.
        :param is_coupled: whether it tells of the robot and of friction too.
        """
        members, first = self.members, 0 if is_coupled else OBJECT_COLUMNS
        poses = members.poses.copy()
        update.apply(poses, first)
        update.apply_to_all(self._history.poses, first)
        if self._bias.exists:
            update.apply(self._bias.coefficients)
        members.set_poses(poses, first)
        if not is_coupled:
            return
        update.apply(members.parameters)
        members.apply_parameters()
        if self.has_object:
            members.close_gaps()

    def _keep_object_spread(self) -> None:
        """Spread the objects a little where averaging has made them too equal."""
        members = self.members
        deviations = members.deviations[OBJECT_COLUMNS:].tolist()
        missing = [math.sqrt(max(0.0, least ** 2 - deviation ** 2))
                   for least, deviation in zip(LEAST_STDS, deviations)]
        if any(missing) and self.contact_ratio == 0.0:
            poses = members.poses.copy()
            poses[:, OBJECT_COLUMNS:] += missing * self._normal((members.count, POSE))
            members.set_poses(poses, OBJECT_COLUMNS)

    # Whether the contact is slippery.

    def _suppose_slippery(self) -> None:
        """At a touch, begin to follow what a slippery contact would do, where it may be one."""
        members = self.members
        nominal, friction = members.obj.contact_friction_coefficient, members.parameters[:, -1]
        if (self._slippery is not None or not self.has_object
                or not self._slip_test.is_needed(nominal, friction)):
            return
        slippery = copy.deepcopy(self)
        slippery._slip_test = SlipTest(math.inf)
        slippery.members.parameters[:, -1] = slippery_friction(nominal, friction)
        slippery.members.apply_parameters()
        self._slippery = slippery

    def _log_likelihood_ratio(self, slippery: 'PushEnsemble') -> float:
        """Logarithm of the likelihood of slippery over rough, since this contact began."""
        return slippery._log_likelihood - self._log_likelihood

    def _follow_likelier(self) -> None:
        """After a contact, go on with one ensemble."""
        slippery = self._slippery
        if slippery is not None:
            self._follow(slippery, self._slip_test.judge_after_contact(
                self._log_likelihood_ratio(slippery)))

    def _follow(self, slippery: 'PushEnsemble', verdict: SlipVerdict) -> None:
        if verdict is SlipVerdict.BOTH:
            return
        self._slippery = None
        if verdict is SlipVerdict.SLIPPERY:
            self.members.assign(slippery.members)
            self._history, self._bias = slippery._history, slippery._bias
            self._outliers, self._last_contact = slippery._outliers, slippery._last_contact

    def _on_object_displaced(self, measured: ObjectPose, displacement: FloatArray) -> None:
        """Accept that the object is elsewhere: somebody has moved it, or the robot is lost."""
        was_pushed = self.contact_ratio > 0.0
        if self._bias.explains(displacement):
            # Perhaps it is where it was, and the robot sees another mark.
            self._bias.forget()
        self._place_objects(measured)
        if was_pushed:
            self._spread_robots(LOST_POSITION_STD, LOST_HEADING_STD)

    def _place_objects(self, measured: ObjectPose) -> None:
        members = self.members
        deviations = np.sqrt(np.diag(self._noise(measured)))
        poses = np.array(measured.pose) + deviations * self._normal((members.count, POSE))
        members.set_object_poses(poses - self._bias.errors(members.robot_poses, poses))
        members.states[:, _MOTION] = 0.0
        self._outliers = 0
        self._forget_history()

    def _forget_history(self) -> None:
        """Former poses are those of a former estimate."""
        if self._odometry is not None:
            self._history.restart(self._odometry.time, self.members.poses)

    def _normal(self, shape: tuple[int, int]) -> FloatArray:
        """Draw standard normal numbers whose mean over the members is 0."""
        numbers = self._rng.standard_normal(shape)
        center(numbers, np.empty(shape[1]))
        return numbers


# Numbers of a state that are motion and force: velocities, accelerations, mode and forces.
_MOTION = list(range(3, 9)) + list(range(15, 18))
_FORCES = list(range(15, 18))
