"""
Touch of the object, told by the bumper.

Poses of an object come late, or not at all; the switch of a bumper tells of a touch at once.
"""

import math

from push_control.perception.perception import TaskPerception
from push_model.parameters import PushedObject, RoundRobot

# Standard deviation of the gap at which the switch closes [m]; chosen: its travel.
SWITCH_STD = 0.005
# Gap to the object up to which it may be what the bumper touches [m], and in standard deviations
# of the robot's position; chosen: what it moves until the switch closes.
MAX_GAP, MAX_GAP_SIGMAS = 0.02, 3.0


def touches_object(perception: TaskPerception) -> bool:
    """Tell whether the object may be what the bumper touches, where it was last at rest."""
    deviation = perception.localization.position_deviation
    return perception.has_object_at_rest and perception.gap < math.hypot(
        MAX_GAP, MAX_GAP_SIGMAS * deviation)


def locate_at_object(perception: TaskPerception, obj: PushedObject, robot: RoundRobot) -> None:
    """Let a robot that touches the object be there, where their relation is not measured."""
    if perception.localization.is_relative:
        return
    present = perception.object_pose._replace(time=perception.time)
    perception.localization.update_from_contact(present, obj, robot, SWITCH_STD)
