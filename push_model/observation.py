"""What the controller knows from the sensors at one instant."""

from typing import NamedTuple, Optional

from push_model.base_knowledge import BaseKnowledge
from push_model.events import EventReport
from push_model.signals import ObjectPose, Odometry, RobotPlace

# Times of an observation [s]: now, of odometry, of the object pose and of the place.
Stamps = tuple[float, float, Optional[float], Optional[float]]


class Observation(NamedTuple):
    """
    The newest measurements, each with its own time.

    :param time: now: time of the newest measurement or of the call [s].
    :param odometry: robot pose (world frame, drifting) and twist (robot's axes).
    :param object_pose: the last object pose that arrived, or None before the first.
    :param pose_rejection: ``EventReport`` of why a newer pose is not believed, or None.
    :param base: what is known of the base by now; None for as stated.
    :param place: the last place of the robot in its map, or None where nothing measures it.
    :param is_bumper_pressed: whether the switch of the robot's bumper has been closed since the
        odometry before; None where nothing tells.
    :param refusal: ``EventReport`` of why a message was refused since the odometry before, or
        None.
    """

    time: float
    odometry: Odometry
    object_pose: Optional[ObjectPose] = None
    pose_rejection: Optional[EventReport] = None
    base: Optional[BaseKnowledge] = None
    place: Optional[RobotPlace] = None
    is_bumper_pressed: Optional[bool] = None
    refusal: Optional[EventReport] = None

    def earlier(self, duration: float) -> 'Observation':
        """
        Return the same, measured earlier.

        :param duration: by how much [s].
        """
        if duration == 0.0:
            return self
        pose, place = self.object_pose, self.place
        return self._replace(
            time=self.time - duration,
            odometry=self.odometry._replace(time=self.odometry.time - duration),
            object_pose=None if pose is None else pose._replace(time=pose.time - duration),
            place=None if place is None else place._replace(time=place.time - duration))

    @property
    def stamps(self) -> Stamps:
        """``Stamps``, which tell two observations apart."""
        pose_time = None if self.object_pose is None else self.object_pose.time
        place_time = None if self.place is None else self.place.time
        return self.time, self.odometry.time, pose_time, place_time
