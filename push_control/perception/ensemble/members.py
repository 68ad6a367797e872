"""
Members of an ensemble: copies of robot and object that differ in what is not known.

Each member has poses of robot and object, errors of its odometry, friction factors of the
supports and a contact friction of its own. It is moved by odometry and by the compiled dynamics,
so that contact, rolling and sliding need no model of their own here.
"""

import dataclasses
import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.perception.ensemble.ensemble_update import read_poses, write_poses
from push_dynamics import layout
from push_dynamics.compiled import closest_on_polygon, kernel_array
from push_dynamics.encoding import body_values, initial_state, NO_OUTLINE, support_rows
from push_dynamics.touches import MAX_TOUCHES
from push_dynamics.wall_grid import NO_WALLS, touch_reach, wall_grid
from push_dynamics.walls import Wall, wall_rows
from push_model.contact import robot_gap
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_primitives.member_motion import close_gaps, IDEAL_DRIVE, move_members, Worlds

# Number of members; chosen: correlations below 0.1 are noise, and a step in contact takes a tenth
# of a millisecond.
MEMBER_COUNT = 100
# Longest step of the dynamics [s]; chosen: half a period of odometry.
MAX_STEP = 0.01
# Speed below which support friction turns viscous [m/s]; chosen: far below pushing speeds.
FRICTION_SMOOTHING = 1e-4
# Standard deviation of the logarithm of the friction of one support; chosen: as uneven as
# plus or minus 40 %.
SUPPORT_LOG_STD = 0.23
# Standard deviation of the contact friction over its nominal value, and the range it is kept in;
# chosen: frictionless contacts are three of them away.
CONTACT_FRICTION_STD = 0.3
CONTACT_FRICTION_RANGE = (0.0, 1.5)
# Columns of the odometry errors: relative error of distances and of rotations, and heading error
# per distance.
SCALE, YAW_SCALE, DRIFT = 0, 1, 2
ODOMETRY_ERRORS = 3
ROBOT = [layout.ROBOT_X, layout.ROBOT_Y, layout.ROBOT_THETA]
OBJECT = [layout.X, layout.Y, layout.THETA]
# Columns of a state that are positions in the world: of the mass centre, and of the robot.
POSITIONS = [layout.X, layout.Y, layout.ROBOT_X, layout.ROBOT_Y]
# Columns of poses of robots and objects, and the first one of the objects.
ROBOT_AND_OBJECT = 6
OBJECT_COLUMNS = 3


class _Estimate(NamedTuple):
    """
    Poses of all members, and what they say together.

    :param poses: as of ``Members.poses``.
    :param robot_pose: mean of the robots.
    :param object_pose: mean of the objects.
    :param deviations: as of ``Members.deviations``.
    :param position_deviation: as of ``Members.position_deviation``.
    """

    poses: FloatArray
    robot_pose: Pose
    object_pose: Pose
    deviations: FloatArray
    position_deviation: float


class Members:
    """
    States and parameters of all members.

    ``states``: shape (n, 34), rows in the order of ``push_dynamics.layout``. ``parameters``: shape
    (n, 3 + supports + 1): odometry errors, logarithms of the friction factors of the supports,
    contact friction. ``wheel_creep``: as of ``wheel_creep``, shape (n, 1) [1/N]. ``wall_errors``:
    by how much the walls of each member are elsewhere (x, y), shape (n, 2) [m]; None where they
    are known, and on open floor.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, count: int) -> None:
        """
        Make equal members with the nominal parameters.

        :param count: number of members.
        """
        self.obj = obj
        self.robot_radius = robot.radius
        state = initial_state(obj, Pose(0.0, 0.0, 0.0), Pose(1.0e3, 0.0, 0.0))
        self.states: FloatArray = np.tile(np.array(state), (count, 1))
        self.bodies: FloatArray = np.tile(
            np.array(body_values(obj, robot, FRICTION_SMOOTHING)), (count, 1))
        rows = support_rows(obj, obj.capacities, [1.0] * len(obj.supports))
        self._nominal_supports: FloatArray = np.array(rows)
        self.supports: FloatArray = np.tile(self._nominal_supports, (count, 1, 1))
        self.parameters: FloatArray = np.zeros((count, ODOMETRY_ERRORS + len(rows) + 1))
        self.parameters[:, -1] = obj.contact_friction_coefficient
        self.wheel_creep: FloatArray = np.zeros((count, 1))
        self.worlds = Worlds(
            self.states, self.bodies, self.supports,
            outline=kernel_array(obj.outline or NO_OUTLINE),
            floor=np.zeros((0, layout.PATCH_SIZE)),
            # Nobody asks for the friction on each support.
            forces=np.zeros(0),
            drive=np.array(IDEAL_DRIVE),
            command=np.zeros(3),
            walls=NO_WALLS,
            touches=np.zeros((0, layout.TOUCH_SIZE)))
        self.wall_errors: FloatArray | None = None
        # Memory of the rollouts.
        self.rollout_states: FloatArray = np.zeros((2, layout.STATE_SIZE))
        # Many ask for the poses between two changes of them.
        self._estimate: _Estimate | None = None

    @property
    def count(self) -> int:
        """Number of members."""
        return len(self.states)

    @property
    def poses(self) -> FloatArray:
        """Poses (x, y, theta) of robots and objects, shape (n, 6), as below; read-only."""
        return self._estimated.poses

    @property
    def robot_poses(self) -> FloatArray:
        """Poses (x, y, theta) of the robots, shape (n, 3); angles not wrapped; read-only."""
        return self.poses[:, :3]

    @property
    def object_poses(self) -> FloatArray:
        """Poses (x, y, theta) of the object frame, shape (n, 3); angles not wrapped; read-only."""
        return self.poses[:, 3:]

    @property
    def mean_robot_pose(self) -> Pose:
        """Mean ``Pose`` of the robots."""
        return self._estimated.robot_pose

    @property
    def mean_object_pose(self) -> Pose:
        """Mean ``Pose`` of the objects."""
        return self._estimated.object_pose

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations of the poses of robots and objects, shape (6,); read-only."""
        return self._estimated.deviations

    @property
    def position_deviation(self) -> float:
        """Standard deviation of x or y of the robots, the greater one [m]."""
        return self._estimated.position_deviation

    @property
    def in_contact(self) -> BoolArray:
        """Tell whether each robot touches its object, shape (n,)."""
        return self.states[:, layout.NORMAL_FORCE] > 0.0

    @property
    def contact_ratio(self) -> float:
        """Ratio of members in which the robot touches the object."""
        return float(np.count_nonzero(self.in_contact)) / self.count

    def gap(self, object_pose: Pose, robot_pose: Pose) -> float:
        """
        Compute the gap between robot and object, wherever they are.

        :param object_pose: ``Pose`` of the object frame.
        :return: gap [m], negative on overlap.
        """
        obj, radius = self.obj, self.robot_radius
        if not obj.outline or math.isinf(radius):
            return robot_gap(obj, object_pose, robot_pose, radius)
        # The same, compiled.
        x, y = object_pose.inverse().transform(robot_pose[:2])
        return closest_on_polygon(self.worlds.outline, x, y)[4] - radius

    def set_robot_poses(self, poses: FloatArray) -> None:
        """
        Place the robots.

        :param poses: (x, y, theta), shape (n, 3).
        """
        self.states[:, ROBOT] = poses
        self._forget_poses()

    def set_object_poses(self, poses: FloatArray) -> None:
        """
        Place the objects.

        :param poses: (x, y, theta) of the object frame, shape (n, 3).
        """
        both = np.zeros((self.count, ROBOT_AND_OBJECT))
        both[:, OBJECT_COLUMNS:] = poses
        self.set_poses(both, OBJECT_COLUMNS)

    def set_poses(self, poses: FloatArray, first: int = 0) -> None:
        """
        Place robots and objects, or the objects alone.

        :param poses: as of ``poses``, shape (n, 6).
        :param first: number of the first column that counts; ``OBJECT_COLUMNS`` for objects alone.
        """
        write_poses(self.states, self.bodies, poses, first)
        self._forget_poses()

    def assign(self, other: 'Members') -> None:
        """
        Take over the states and parameters of others.

        :param other: ``Members`` of the same object and number.
        """
        self.states[:] = other.states
        self.parameters[:] = other.parameters
        self.wheel_creep[:] = other.wheel_creep
        self.wall_errors = None if other.wall_errors is None else other.wall_errors.copy()
        self.forget_wall_distances()
        self.apply_parameters()
        self._forget_poses()

    def set_walls(self, walls: Sequence[Wall], errors: FloatArray | None = None) -> None:
        """
        Let walls stop objects and robots from now on.

        :param walls: none for open floor.
        :param errors: the ``wall_errors`` to start from; None where walls are known.
        """
        self.wall_errors = None if errors is None or not walls else errors.copy()
        self.worlds = self.worlds._replace(
            walls=wall_grid(wall_rows(walls), touch_reach(self.obj, self.robot_radius)),
            touches=np.zeros((MAX_TOUCHES, layout.TOUCH_SIZE)))
        self.forget_wall_distances()

    def forget_wall_distances(self) -> None:
        """Measure the distances to walls anew, as ``wall_errors`` have changed."""
        self.states[:, layout.WALL_SLACK] = 0.0

    def apply_parameters(self) -> None:
        """Bring the parameters within their ranges, and into the numbers of the dynamics."""
        friction = self.parameters[:, -1]
        friction[:] = np.clip(friction, *CONTACT_FRICTION_RANGE)
        self.bodies[:, layout.CONTACT_FRICTION] = friction
        factors = np.exp(self.parameters[:, ODOMETRY_ERRORS:-1])
        capacities = factors * self._nominal_supports[:, layout.CAPACITY]
        self.supports[:, :, layout.CAPACITY] = capacities
        self.supports[:, :, layout.PLAIN_CAPACITY] = capacities

    def move(self, increments: FloatArray, duration: float) -> int:
        """
        Move robots, and the objects with them.

        :param increments: motion (x, y, theta) of each robot in its own axes, shape (n, 3).
        :param duration: time that it takes [s].
        :return: number of members in contact.
        """
        self._forget_poses()
        if self.wall_errors is None:
            return move_members(self.worlds, increments, duration, MAX_STEP)
        # Seen from its walls, a member is elsewhere: robot and object.
        errors = np.tile(self.wall_errors, 2)
        self.states[:, POSITIONS] -= errors
        contacts = move_members(self.worlds, increments, duration, MAX_STEP)
        self.states[:, POSITIONS] += errors
        return contacts

    def close_gaps(self) -> None:
        """Move robots off overlaps; those that were in contact touch again."""
        gaps = np.zeros(self.count)
        close_gaps(self.states, self.bodies, self.worlds.outline, gaps)
        self._forget_poses()

    @property
    def _estimated(self) -> _Estimate:
        estimate = self._estimate
        if estimate is None:
            poses = np.empty((self.count, ROBOT_AND_OBJECT))
            moments = np.empty((2, ROBOT_AND_OBJECT))
            read_poses(self.states, self.bodies, poses, moments)
            for array in (poses, moments):
                array.setflags(write=False)
            means, deviations = moments.tolist()
            estimate = self._estimate = _Estimate(poses, Pose(*means[:3]), Pose(*means[3:]),
                                                  moments[1], max(deviations[:2]))
        return estimate

    def _forget_poses(self) -> None:
        self._estimate = None


def identified_object(obj: PushedObject, parameters: FloatArray) -> PushedObject:
    """
    Give an object the mean friction of an ensemble.

    :param parameters: of all members, as of ``Members``.
    :return: ``PushedObject`` with the mean distribution of friction, its sum unchanged, and the
        mean contact friction.
    """
    factors = np.exp(parameters[:, ODOMETRY_ERRORS:-1].mean(axis=0))
    capacities = np.array(obj.capacities)
    factors *= capacities.sum() / (factors @ capacities)
    supports = tuple(
        dataclasses.replace(support, friction_coefficient=support.friction_coefficient * factor)
        for support, factor in zip(obj.supports, factors.tolist()))
    friction = max(0.0, float(parameters[:, -1].mean()))
    return dataclasses.replace(obj, supports=supports, contact_friction_coefficient=friction)
