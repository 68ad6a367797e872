"""What the controller sees at one instant."""

from typing import NamedTuple, Optional

from push_model.signals import ObjectPose, Odometry


class Observation(NamedTuple):
    """
    The newest measurements, each with its own time.

    :param time: now, the time of the newest measurement or of the call [s].
    :param odometry: robot pose (world frame, drifting) and twist (body axes).
    :param object_pose: the last object pose that arrived, or None before the first.
    """

    time: float
    odometry: Odometry
    object_pose: Optional[ObjectPose] = None

    @property
    def stamps(self):
        """Times that tell two observations apart [s]."""
        return self.time, self.odometry.time, self.object_pose and self.object_pose.time
