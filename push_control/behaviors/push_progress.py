"""How far a straight push has come, and what follows from that: steer on, stop, or miss."""

import dataclasses
import enum
import math
from typing import NamedTuple

import numpy as np
from push_control.behaviors.failures import BehaviorFailure
from push_control.perception.contact_consistency import Touch
from push_control.perception.object_at_rest import ObjectAtRest
from push_model.geometry import Pose

# Slowest push [m/s].
MIN_SPEED = 0.035
# Distance beyond the expected touch, and standard deviations besides, after which an object that
# has not moved is not there [m]; chosen.
MISS_DISTANCE = 0.08
MISS_SIGMAS = 2.5
# Distance by which the object has moved before the ensemble has the robot touch it at which the
# robot is elsewhere [m]; chosen: above what is pushed while a pose is under way.
UNEXPECTED_DISTANCE = 0.05
# Distance that a push may exceed its plan by, and a multiple of it besides [m]; chosen: what
# remains is for the next push.
EXCESS_DISTANCE = 0.3
EXCESS_RATIO = 2.0
# Standard deviations of an object that is not seen at which a push ends, as more of it would bring
# the object anywhere [m], [rad]; measured with MuJoCo, where half of them takes more pushes, and
# none at all leads astray.
MAX_UNSEEN_STD, MAX_UNSEEN_HEADING_STD = 0.06, 0.2
# Time after which a push that does not end has failed, over its length [s]; chosen.
TIMEOUT = 10.0
# Displacement of an object that has not moved at most, over what the robot has driven in contact;
# chosen: four standard deviations of a pose in 8 cm.
MAX_REST_RATIO = 0.1
# Cosine of the angle between the displacements of object and robot from which on the one may have
# pushed the other, and the least displacements that are compared [m]; measured: 0.61 to 1 in tasks
# with all objects, and -0.98 to 0.66 with poses that are mirrored.
MIN_ALONG = 0.5
MIN_COMPARED = 0.03


class Stage(enum.Enum):
    """Stage of a push."""

    RUN_IN = 'run-in'
    PUSHING = 'pushing'
    STOPPING = 'stopping'


class Steer(NamedTuple):
    """
    Push on.

    :param curvature: of the robot's path [1/m].
    :param remaining: distance after which it is best to stop [m].
    """

    curvature: float
    remaining: float


class Stop(NamedTuple):
    """End the push: the robot brakes."""


class Miss(NamedTuple):
    """Give up: the robot is not where it is estimated to be, or its wheels spin."""

    cause: BehaviorFailure


# Where the object was before the first measurement.
UNMEASURED = ObjectAtRest(Pose(0.0, 0.0, 0.0), 0.0, 0.0, 0.0)


@dataclasses.dataclass(frozen=True)
class PushProgress:
    """
    Knowledge of a straight push at one step.

    :param length: planned length of the push [m].
    :param course: the last choice, with the distance that remains of it now.
    :param time: since the start [s].
    :param last_contact: time at which the ensemble last had the robot in contact [s].
    :param stopping_time: since the robot brakes [s].
    :param steering_time: since the arc was chosen [s].
    :param speed: of the robot [m/s].
    :param followed_speed: of the robot in the direction that it is commanded [m/s].
    :param pushed: distance that the robot has driven in contact [m].
    :param driven: displacement of the robot since the touch, in the world [m].
    :param before: the ``ObjectAtRest`` before the push.
    :param moved: displacement of the object since then, in the world [m].
    :param has_moved: whether the object was seen to move.
    :param unseen_distance: driven since the last object pose was measured [m].
    :param overrun: distance of the robot beyond the expected touch, while it drives there [m].
    :param deviation: standard deviation of the robot's position [m].
    :param pending_distance: which commands under way take, whatever follows [m].
    :param is_pending: whether one of them is not to stand.
    :param braking_distance: which a stop takes, with that [m].
    :param is_lost: whether only motion of the object can show where the touch is.
    :param has_touched_early: whether the object has moved before the robot should touch it.
    :param is_spinning: whether the object moves far less than the wheels turn.
    :param is_creeping: whether an object that was not seen to move has by millimetres.
    :param is_without_effect: whether it has hardly moved, whatever a pose has shown.
    :param is_hindered: whether it has moved by far less than the wheels turned, if the push ends
        now.
    :param is_stalled: whether the base stands at the object, whatever it is commanded.
    :param touch_deviation: standard deviation of the robot's position at the touch [m].
    :param is_near_obstacle: whether an obstacle of the map ends the push.
    :param is_blind: whether the object is not seen, as was to be expected.
    :param was_blind: whether that was so at any time since the touch.
    :param object_std: standard deviation of the object along x or y, the greater one [m].
    :param object_heading_std: standard deviation of its heading [rad].
    """

    length: float
    course: Steer
    stage: Stage = Stage.RUN_IN
    time: float = 0.0
    last_contact: float = -math.inf
    stopping_time: float = 0.0
    steering_time: float = 0.0
    speed: float = 0.0
    followed_speed: float = 0.0
    pushed: float = 0.0
    driven: tuple[float, float] = (0.0, 0.0)
    before: ObjectAtRest = UNMEASURED
    moved: tuple[float, float] = (0.0, 0.0)
    has_moved: bool = False
    unseen_distance: float = 0.0
    overrun: float = 0.0
    deviation: float = 0.0
    pending_distance: float = 0.0
    is_pending: bool = False
    braking_distance: float = 0.0
    is_lost: bool = False
    has_touched_early: bool = False
    is_spinning: bool = False
    is_creeping: bool = False
    is_without_effect: bool = False
    is_hindered: bool = False
    is_stalled: bool = False
    touch_deviation: float = math.inf
    is_near_obstacle: bool = False
    is_blind: bool = False
    was_blind: bool = False
    object_std: float = 0.0
    object_heading_std: float = 0.0

    @property
    def is_excessive(self) -> bool:
        """Tell whether it takes far longer than planned."""
        limit = EXCESS_DISTANCE + EXCESS_RATIO * self.length
        return self.pushed > limit or self.time > TIMEOUT + limit / MIN_SPEED

    @property
    def is_too_uncertain(self) -> bool:
        """Tell whether it is not known well enough where an object that is not seen is by now."""
        return self.is_blind and (self.object_std > MAX_UNSEEN_STD
                                  or self.object_heading_std > MAX_UNSEEN_HEADING_STD)

    @property
    def is_at_rest(self) -> bool:
        """Tell whether the object is where it was, whatever axes its poses have."""
        return math.hypot(*self.moved) < MAX_REST_RATIO * self.pushed

    @property
    def contact(self) -> Touch:
        """Compare how the object has moved with how the robot has."""
        driven, moved = math.hypot(*self.driven), math.hypot(*self.moved)
        if min(driven, moved) < MIN_COMPARED:
            return Touch.TAPPED
        is_along = float(np.dot(self.driven, self.moved)) > MIN_ALONG * driven * moved
        return Touch.PUSHED if is_along else Touch.LATERAL


def decide(progress: PushProgress) -> Steer | Stop | Miss:
    """
    Decide how a push that is under way goes on.

    :return: ``Steer``, as chosen last, ``Stop`` or ``Miss``.
    """
    miss_distance = MISS_DISTANCE + MISS_SIGMAS * progress.deviation
    if (progress.is_excessive or progress.is_near_obstacle or progress.is_too_uncertain
            or progress.is_stalled):
        return Stop()
    if progress.is_blind:
        return _decide_blind(progress, miss_distance)
    if progress.has_touched_early:
        return Miss(BehaviorFailure.TOUCHED_EARLY)
    if progress.stage is Stage.RUN_IN:
        if progress.overrun > miss_distance:
            return Miss(BehaviorFailure.OBJECT_NOT_FOUND)
        return progress.course
    if progress.is_spinning:
        return Miss(BehaviorFailure.WHEELS_SPIN)
    seen_distance = progress.pushed - progress.unseen_distance
    is_still = progress.is_without_effect or not progress.has_moved
    is_over = (progress.course.remaining <= progress.braking_distance and not progress.is_lost)
    if is_still and seen_distance > miss_distance or is_over and progress.is_hindered:
        return Miss(BehaviorFailure.WHEELS_SPIN if progress.is_creeping
                    else BehaviorFailure.OBJECT_NOT_MOVED)
    return Stop() if is_over else progress.course


def _decide_blind(progress: PushProgress, miss_distance: float) -> Steer | Stop:
    """Decide without poses of the object: these alone tell of a miss."""
    if progress.stage is Stage.RUN_IN:
        return Stop() if progress.overrun > miss_distance else progress.course
    is_over = progress.course.remaining <= progress.braking_distance
    return Stop() if is_over else progress.course
