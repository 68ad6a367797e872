"""A robot that moves as it is commanded, and sees an object at rest only from where it can."""

import math

from helpers.objects import box
from push_control.perception.perception import TaskPerception
from push_control.perception.view import bearing
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP

PERIOD = 0.02
CONTROL = ControlSettings()


class KinematicView:
    """
    Steps behaviours.

    ``commands`` and ``poses``: of the robot, at each step. ``perception``: what it knows.
    """

    def __init__(self, robot_pose, object_pose, *, drive='differential', **view):
        """
        Place robot and object; nothing is measured yet.

        :param object_pose: ``Pose``, or None for no object at all.
        :param view: fields of ``SupervisionSettings``.
        """
        self.supervision = SupervisionSettings(**view)
        self.robot = RoundRobot(radius=0.17, drive=drive, max_speed=0.5, max_yaw_rate=1.9,
                                time_constant=1e-3)
        self.object = box()
        self.robot_pose, self.object_pose = robot_pose, object_pose
        self.perception = TaskPerception(self.object, self.robot, CONTROL, self.supervision)
        self.time = 0.0
        self.commands, self.poses = [], []
        self._measured = None

    @property
    def sees(self):
        """Whether a pose of the object comes."""
        obj, settings = self.object_pose, self.supervision
        if obj is None:
            return False
        gap = find_contact(self.object, obj, self.robot_pose[:2], self.robot.radius).gap
        return (gap >= settings.view_nearest
                and distance(self.robot_pose, obj) <= settings.view_farthest
                and abs(bearing(self.robot_pose, obj)) <= settings.view_angle)

    def measure(self, twist=STOP):
        """Let perception have odometry, and a pose where one comes."""
        if self.sees:
            self._measured = ObjectPose(self.time, self.object_pose)
        self.perception.update(Observation(
            self.time, Odometry(self.time, self.robot_pose, twist), self._measured))

    def stand(self, duration):
        """Measure for a while."""
        for _ in range(round(duration / PERIOD)):
            self.time += PERIOD
            self.measure()

    def run(self, behavior, time_limit=200.0):
        """Let a behaviour act until it has ended."""
        twist, end = STOP, self.time + time_limit
        while not behavior.finished and behavior.failure is None and self.time < end:
            self.time += PERIOD
            self.measure(twist)
            twist = behavior.step(self.perception, PERIOD)
            self.commands.append(twist)
            self.poses.append(self.robot_pose)
            rotation = PERIOD * twist.omega
            x, y = Pose(0.0, 0.0, 0.5 * rotation).rotate(twist[:2])
            self.robot_pose = self.robot_pose @ Pose(PERIOD * x, PERIOD * y, rotation)
        assert self.time < end
        return behavior

    @property
    def turned(self):
        """Angle that the robot has turned by in all [rad]."""
        return sum(PERIOD * abs(command.omega) for command in self.commands)

    @property
    def gap(self):
        """Gap between robot and object [m]."""
        return find_contact(self.object, self.object_pose, self.robot_pose[:2],
                            self.robot.radius).gap


def half_angle(degrees):
    """Return the setting of a view."""
    return {'view_angle': math.radians(degrees)}
