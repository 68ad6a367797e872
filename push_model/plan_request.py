"""Request for a plan, and the reasons for which a planner may find none."""

import enum
import math
from typing import NamedTuple

from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject

# Range of tolerances of a goal [m], [rad]; chosen: below it no sensor measures, and what the
# planner lays about the goal grows without end; above it there is nothing to plan.
MIN_TOLERANCE, MAX_TOLERANCE = 1e-4, 1.0
# Largest tolerance of heading [rad]: a full circle, and what single precision makes of it. From pi
# on every heading does; what is beyond leaves room for the margins of whoever measures.
MAX_HEADING_TOLERANCE = 6.3
# Tolerances of a goal for which nobody asks for others [m], [rad]; chosen: what a camera measures,
# and about a degree. What costs seconds to compute depends on them, so that nodes share them.
POSITION_TOLERANCE, HEADING_TOLERANCE = 0.01, 0.0175
# Tolerance of heading with which any does [rad].
ANY_HEADING = math.tau


def check_heading_tolerance(owner: str, value: float) -> None:
    """
    Check that a tolerance of heading is a small angle, or leaves the heading free.

    What lies between is most likely meant in degrees.

    :param owner: of the field, for the message.
    :param value: [rad].
    :raises ValueError: naming the field, what came and what was expected.
    """
    if MAX_TOLERANCE < value < math.pi:
        raise ValueError(f'{owner}.heading_tolerance: got {value!r}, expected at most '
                         f'{MAX_TOLERANCE:g}, or 2 pi for any heading [rad]')


class GoalTolerances(NamedTuple):
    """
    Tolerances within which an object counts as at its goal.

    :param position: largest distance [m].
    :param heading: largest heading error [rad].
    """

    position: float = POSITION_TOLERANCE
    heading: float = HEADING_TOLERANCE

    def contain(self, pose: Pose, goal: Pose) -> bool:
        """
        Tell whether an object is at its goal.

        :param goal: goal ``Pose``.
        """
        return (distance(pose, goal) <= self.position
                and abs(wrap_angle(pose.theta - goal.theta)) <= self.heading)


class RequestKind(enum.Enum):
    """
    Kind of plan that is requested.

    Messages carry the number in this list, from 0 on: add members at its end.
    """

    STEERED_PUSH = 'one steered push to the goal, from the newest measurements'
    TASK_PUSH = 'the next push of a task, from the poses of the request'


class PlanRequest(NamedTuple):
    """
    Request for a plan that brings an object at rest to a goal.

    :param object_pose: ``Pose`` of the object, at rest.
    :param robot_pose: ``Pose`` of the robot, anywhere.
    :param goal: goal ``Pose`` of the object.
    :param obj: the ``PushedObject`` as known by now.
    :param cone_fraction: fraction of the planner's friction cone that the plan may use; below 1
        after plans that brought the object no nearer to its goal.
    :param position_tolerance: largest distance from the goal that counts as there [m].
    :param heading_tolerance: largest heading error that does [rad].
    :param robot_deviation: standard deviation of the robot's place relative to the object [m].
    :param center_deviation: standard deviation of the centre of friction of ``obj`` along either
        axis [m].
    :param contact_friction_deviation: standard deviation of its contact friction.
    :param odometry_slope: growth of the deviation of the robot's place per distance [m/m].
    :param odometry_drift: standard deviation of the drift of its heading [rad/m].
    :param kind: ``RequestKind`` of what is requested.
    """

    object_pose: Pose
    robot_pose: Pose
    goal: Pose
    obj: PushedObject
    cone_fraction: float = 1.0
    position_tolerance: float = POSITION_TOLERANCE
    heading_tolerance: float = HEADING_TOLERANCE
    robot_deviation: float = 0.005
    center_deviation: float = 0.03
    contact_friction_deviation: float = 0.1
    odometry_slope: float = 0.0
    odometry_drift: float = 0.0
    kind: RequestKind = RequestKind.TASK_PUSH

    @property
    def tolerances(self) -> GoalTolerances:
        """The ``GoalTolerances``."""
        return GoalTolerances(self.position_tolerance, self.heading_tolerance)

    @property
    def is_heading_free(self) -> bool:
        """Whether the object may be at its goal with any heading."""
        return self.heading_tolerance >= math.pi


class PlanFailure(enum.Enum):
    """
    Reason why there is no plan.

    Control flow compares these; the sentence with the numbers of the case is for people. Messages
    carry their number in this list, from 1 on: add members at its end.
    """

    INVALID_VALUE = 'a pose or an angle is not finite'
    ROBOT_NOT_ROUND = 'the robot is not round'
    NO_SUPPORT_FRICTION = 'the object slides without friction'
    NO_CONTACT_FRICTION = 'the contact has no friction'
    TIPS = 'the object would tip over'
    AT_GOAL = 'the object is at the goal already'
    ROBOT_TOO_SLOW = 'the pushing speed is beyond the robot'
    NOT_IN_CONTACT = 'the robot does not touch the object'
    UNSUPPORTED_CONTACT = 'the robot cannot push at this kind of contact'
    FACING_AWAY = 'the robot points away from the object'
    WRONG_SIDE = 'the robot would push from the wrong side'
    ONE_SIDED_STEERING = 'the contact can steer to one side only'
    JACKKNIFED = 'the contact would fold up'
    LEAVES_CONTACT_FEATURE = 'the contact would roll off its face or vertex'
    PATH_TOO_LONG = 'the push would be too long'
    LIMIT_EXCEEDED = 'a limit of friction or of the robot would be exceeded'
    NOT_CONVERGED = 'the search did not converge'
    NOT_ACCEPTED = 'a push was found, but it fails its acceptance test'
    NO_FEASIBLE_SITE = 'no contact site is feasible'
    NOT_FREE = 'the object does not fit into the map at its start or goal'
    UNUSABLE_MAP = 'the map cannot be used'
    BLOCKED = 'obstacles or the end of the map are in the way'
    INVALID_REQUEST = 'the request cannot be read'
    INVALID_PLAN = 'the plan cannot be used'
    INTERNAL_ERROR = 'the planner has made an error'
    NO_SOLVER = 'a steered push needs casadi, which is not installed'
    UNCERTAIN_POSITION = 'the robot does not know its position well enough among obstacles'
    NO_FACE = 'the object cannot be pushed away from where it stands'
    SEARCH_LIMIT = 'no way was found before the search had to end'
