"""True state of the plant at an instant, which no measurement sees."""

import enum
from typing import NamedTuple

from push_dynamics import layout
from push_model.geometry import Pose
from push_model.signals import Twist


class ContactMode(enum.Enum):
    """
    Mode of the contact between robot and object.

    '+': the robot's surface slides towards t, the normal rotated by +90 degrees, and drags the
    object that way; '-': towards -t.
    """

    SEPARATE = 'separate'
    STICK = 'stick'
    SLIDE_LEFT = 'slide+'
    SLIDE_RIGHT = 'slide-'

    @property
    def code(self) -> int:
        """Number of the mode in the kernel and in the column ``mode`` of a tape."""
        return _CODES[self]

    @classmethod
    def from_code(cls, code: float) -> 'ContactMode':
        """
        Look up a mode by its number.

        :param code: number of the mode in the kernel or in a tape.
        """
        return _MODES[int(code)]


_CODES = {
    ContactMode.SEPARATE: layout.SEPARATE,
    ContactMode.STICK: layout.STICK,
    ContactMode.SLIDE_LEFT: layout.SLIDE_LEFT,
    ContactMode.SLIDE_RIGHT: layout.SLIDE_RIGHT,
}
_MODES = {code: mode for mode, code in _CODES.items()}


class Energy(NamedTuple):
    """
    Energy since the start [J]; work is the sum of the others.

    :param work: of the robot on the object.
    :param kinetic: of the object.
    :param support_loss: by friction on the floor.
    :param contact_loss: by friction of the object at robot and walls.
    :param impact_loss: in inelastic impacts.
    :param integration_loss: what the implicit step itself damps; it vanishes with the step.
    """

    work: float
    kinetic: float
    support_loss: float
    contact_loss: float
    impact_loss: float
    integration_loss: float


class WallTouch(NamedTuple):
    """
    How walls touch object and robot, over the last step.

    :param force: of walls on the object, world axes (x, y) [N].
    :param points: number of points at which they push it.
    :param depth: by which the object is inside a wall [m]; errors of the step.
    :param holds_robot: whether a wall, or an object at a wall, keeps the robot from going on.
    """

    force: tuple[float, float] = (0.0, 0.0)
    points: int = 0
    depth: float = 0.0
    holds_robot: bool = False


class Truth(NamedTuple):
    """
    State of the plant. Poses are in the world, their angles not wrapped.

    :param time: simulated time [s].
    :param object_pose: pose of the object frame.
    :param object_twist: velocity of the object frame's origin, world axes.
    :param robot_pose: pose of the robot.
    :param robot_twist: its velocity, own axes.
    :param mode: ``ContactMode`` over the last step.
    :param contact_point: the object's point nearest to the robot (x, y) [m].
    :param normal: world angle gamma of the contact normal, from robot to object [rad].
    :param gap: distance between robot and object [m].
    :param pushing_angle: from the normal to the velocity of the robot's surface at the contact
        [rad]; nan where there is no contact or that velocity is 0.
    :param force_n: force of the robot on the object along the normal, mean over the last step
        [N].
    :param force_t: the same along t, the normal rotated by +90 degrees [N].
    :param support_forces: friction force on each support, world axes, (x, y) [N].
    :param support_loads: normal load on each support [N].
    :param energy: ``Energy``.
    :param walls: ``WallTouch``.
    """

    time: float
    object_pose: Pose
    object_twist: Twist
    robot_pose: Pose
    robot_twist: Twist
    mode: ContactMode
    contact_point: tuple[float, float]
    normal: float
    gap: float
    pushing_angle: float
    force_n: float
    force_t: float
    support_forces: tuple[tuple[float, float], ...]
    support_loads: tuple[float, ...]
    energy: Energy
    walls: WallTouch = WallTouch()
