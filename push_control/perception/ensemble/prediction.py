"""
Prediction of an ensemble: motion of all members by odometry and the compiled dynamics.

A step (dx, dy, dtheta) of odometry, of length l, moves the robot of a member with the odometry
errors s, g, d by

    (dx, dy) / (1 + s),    (1 + g) dtheta - d l,

plus a random walk whose variance is in proportion to l, less what wheels that creep lose
(``wheel_creep``); the dynamics move the object with it.
"""

import math

import numpy as np
from push_control.perception.ensemble.ensemble_state import EnsembleState, POSE
from push_control.perception.ensemble.ensemble_update import (
    add_odometry, disturb_objects, EnsembleUpdate)
from push_control.perception.ensemble.members import MAX_STEP, OBJECT_COLUMNS
from push_control.perception.ensemble.wheel_creep import reduce_by_creep
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.signals import Odometry

# Random walk of the object's motion against the dynamics per root of its path length [m/sqrt(m)]
# and [rad/sqrt(m)]; chosen: contacts that creep by 1 % of the way are within it.
POSITION_WALK = 0.006
HEADING_WALK = 0.012
# Standard deviations of the first robot pose relative to the world [m], [rad]; chosen: odometry
# begins in the frame of the poses.
START_POSITION_STD = 0.002
START_HEADING_STD = 0.003
START_STDS = START_POSITION_STD, START_POSITION_STD, START_HEADING_STD
# Below this a step of odometry is rest [m], [rad].
NO_MOTION = 1e-9


class Prediction:
    """Moves the members of an ensemble by odometry."""

    def __init__(self, state: EnsembleState) -> None:
        """
        Start before the first odometry.

        :param state: the ``EnsembleState`` to move.
        """
        self._state = state
        noise = state.odometry_noise
        self._odometry_walks: FloatArray = np.array((noise.walk, noise.walk, noise.heading_walk),
                                                    dtype=float)
        self._object_walks: FloatArray = np.array((POSITION_WALK, POSITION_WALK, HEADING_WALK))

    def predict(self, odometry: Odometry, step: Pose | None) -> bool:
        """
        Move all members by odometry.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        :param step: motion of the robot since the last one as ``Pose`` in its axes then, where the
            poses of odometry do not say it; else None.
        :return: whether the odometry is new.
        """
        state, previous = self._state, self._state.odometry
        if previous is None:
            self._warm_up()
            errors = state.normal((state.members.count, POSE)) * START_STDS
            state.members.set_robot_poses(np.array(odometry.pose) + errors)
        elif odometry.time > previous.time:
            self._move(step or previous.pose.inverse() @ odometry.pose,
                       odometry.time - previous.time, odometry.time)
        else:
            return False
        state.odometry = odometry
        state.history.append(odometry.time, state.members.poses)
        return True

    def _move(self, step: Pose, duration: float, time: float) -> None:
        state, members = self._state, self._state.members
        rotation = wrap_angle(step.theta)
        is_at_rest = math.hypot(step.x, step.y) < NO_MOTION and abs(rotation) < NO_MOTION
        if is_at_rest and not members.in_contact.any():
            return
        increments = state.normal((members.count, POSE))
        add_odometry(increments, members.parameters, self._odometry_walks,
                     (step.x, step.y, rotation))
        reduce_by_creep(increments, members)
        before = None if state.pose_time is None else members.poses
        if members.move(increments, duration):
            state.last_contact = time
            if before is not None:
                self._disturb_objects(before)

    def _disturb_objects(self, before: FloatArray) -> None:
        """Add what the dynamics do not know to the motion of the objects."""
        state = self._state
        poses = state.members.poses.copy()
        samples = state.normal((len(poses), POSE))
        disturb_objects(poses, before.copy(), samples, self._object_walks)
        state.members.set_poses(poses, OBJECT_COLUMNS)

    def _warm_up(self) -> None:
        """Load all compiled code before the robot moves, and change nothing."""
        members = self._state.members
        zeros, poses = np.zeros((members.count, POSE)), members.poses.copy()
        update = EnsembleUpdate(zeros, np.eye(POSE))
        update.test(np.zeros(POSE))
        update.apply(poses)
        update.apply_to_all(poses[None])
        members.move(zeros, MAX_STEP)
        members.close_gaps()
        disturb_objects(poses, poses.copy(), zeros, self._object_walks)
        members.set_poses(poses)
        add_odometry(zeros, members.parameters, self._odometry_walks, (0.0, 0.0, 0.0))
