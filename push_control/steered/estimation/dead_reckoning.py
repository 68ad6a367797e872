"""Dead reckoning of the robot beside the filter: where its odometry has it, in the world."""

from typing import Iterable, NamedTuple

from push_control.steered.estimation.contact_site import ContactOffset
from push_model.geometry import Pose
from push_model.signals import Twist

# Path length of the contact over which the heading error is averaged [m]. Chosen: the filter's
# heading settles over less, and odometry drifts over more.
HEADING_AVERAGING_DISTANCE = 0.5


class RobotMotion(NamedTuple):
    """
    A step of odometry that the filter has processed.

    :param twist: mean ``Twist`` of the robot, robot's axes.
    :param duration: of the step [s].
    :param distance: path length of the contact in it [m].
    :param heading: phi, the filter's estimate of the robot's heading at its start [rad].
    """

    twist: Twist
    duration: float
    distance: float
    heading: float


class RobotDeadReckoning(NamedTuple):
    """
    Centre of the robot as odometry has it, corrected by what the contact tells.

    :param center: of the robot in the world (x, y) [m].
    :param heading: sum of its yaw since the start [rad].
    :param heading_error: the filter's heading minus that, averaged over some path length [rad].
    """

    center: tuple[float, float]
    heading: float
    heading_error: float = 0.0

    def moved(self, motions: Iterable[RobotMotion]) -> 'RobotDeadReckoning':
        """
        Add odometry along its own heading, with the lasting error of that.

        :param motions: each ``RobotMotion`` since the last call.
        """
        robot = self
        for twist, duration, distance, heading in motions:
            error = heading - robot.heading
            averaged = robot.heading_error + min(1.0, distance / HEADING_AVERAGING_DISTANCE) * (
                error - robot.heading_error)
            middle = Pose(*robot.center, robot.heading + averaged + 0.5 * duration * twist.omega)
            center = middle.transform((duration * twist.v_x, duration * twist.v_y))
            robot = RobotDeadReckoning(center, robot.heading + duration * twist.omega, averaged)
        return robot

    def corrected(self, drift: ContactOffset, gamma: float) -> 'RobotDeadReckoning':
        """
        Correct the centre by what the contact tells of it.

        :param drift: ``ContactOffset`` by which it was wrong.
        :param gamma: world angle of the contact normal [rad].
        """
        center = Pose(*self.center, gamma).transform((drift.gap, -drift.slip))
        return self._replace(center=center)
