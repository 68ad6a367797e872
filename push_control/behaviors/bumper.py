"""The bumper has touched something where the way should be clear."""

from push_control.behaviors.failures import BehaviorFailure, FailureReport
from push_control.perception.raw_perception import RawPerception

# Time after which a robot that was to stop, and what it has touched, are at rest [s]; chosen: as
# of braking from 0.3 m/s.
STOPPING_TIME = 0.3


def bumped(perception: RawPerception) -> FailureReport:
    """Report that the robot has touched something, and take the pose of the object anew."""
    perception.restart_averaging(perception.time + STOPPING_TIME)
    return BehaviorFailure.BUMPED.report()
