"""Measurements as they come: where robot and object are, without an estimate."""

import math

from push_control.events import PerceptionEvent
from push_control.perception.measurement_faults import measurement_fault
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.perception.view import View
from push_control.settings import ControlSettings
from push_model.base_knowledge import BaseKnowledge
from push_model.events import EventReport, Report
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectEstimate, ObjectPose, PoseDeviation, Twist


class RawPerception:
    """
    The newest measurements.

    It is all that a single steered push needs, whose controller estimates by itself; the
    perception of repeated pushes adds its estimates.
    """

    def __init__(self, control: ControlSettings) -> None:
        """Start without measurements."""
        self._control = control
        # A single push needs poses all the time.
        self.view = View()
        self._observation: Observation | None = None
        # Time of the newest finite object pose [s].
        self._pose_time: float | None = None
        # Whether the last measurement has come again: a simulation holds its time.
        self._is_held = False
        # Whether the bumper was last pressed, and whether it has closed since. Before the first
        # measurement it may have been: what it touches then is no news.
        self._is_pressed: bool | None = True
        self._has_bumped = False

    def update(self, observation: Observation) -> None:
        """
        Take in measurements.

        :param observation: ``Observation``, with odometry as it comes.
        """
        self._is_held = observation == self._observation
        self._observation = observation
        self._take_bumper(observation)
        measured = observation.object_pose
        if measured is not None and measured.pose.is_finite():
            self._pose_time = measured.time

    def _take_bumper(self, observation: Observation) -> None:
        self._has_bumped = not self._is_pressed and observation.is_bumper_pressed is True
        self._is_pressed = observation.is_bumper_pressed

    @property
    def has_bumped(self) -> bool:
        """Tell whether the bumper has closed with this observation, and not before the first."""
        return self._has_bumped

    def measurement_fault(self, needs_object: bool) -> EventReport | None:
        """
        Tell why the measurements cannot be used.

        :param needs_object: whether the object pose must be fresh.
        :return: ``EventReport``, or None where they can.
        """
        observation = self.observation
        pose_time = self._pose_time if needs_object else observation.time
        return measurement_fault(observation, pose_time, self._control, needs_object=needs_object)

    @property
    def time(self) -> float:
        """Time of the newest measurement [s]; 0 before the first."""
        return 0.0 if self._observation is None else self._observation.time

    @property
    def observation(self) -> Observation:
        """
        The newest ``Observation``.

        :raises RuntimeError: before the first one.
        """
        if self._observation is None:
            raise RuntimeError('perception: got no observation, expected one')
        return self._observation

    @property
    def object_pose(self) -> ObjectPose:
        """
        The newest measured ``ObjectPose``.

        :raises RuntimeError: before the first one.
        """
        measured = self.observation.object_pose
        if measured is None:
            raise RuntimeError('perception: got no object pose, expected one')
        return measured

    def has_pose_after(self, time: float) -> bool:
        """
        Tell whether an object pose is known of some time or later.

        While time is held the newest pose counts: nothing moves.

        :param time: the time, not included [s].
        """
        measured = None if self._observation is None else self._observation.object_pose
        return measured is not None and (self._is_held or measured.time > time)

    @property
    def pose_age(self) -> float:
        """Time since the newest object pose [s]; infinite before the first."""
        return math.inf if self._pose_time is None else self.time - self._pose_time

    # What a limited view adds.

    @property
    def has_limited_view(self) -> bool:
        """Tell whether there are places from which the object is not seen."""
        return False

    @property
    def is_blind(self) -> bool:
        """Tell whether no object poses come, as was to be expected."""
        return False

    @property
    def expected_object_pose(self) -> Pose:
        """``Pose`` that the object should have by now, be it seen or not."""
        return self.object_pose.pose

    @property
    def goal_deviation(self) -> PoseDeviation | None:
        """``PoseDeviation`` of the object in the frame of its goal; None where that is bounded."""
        return None

    # What an estimate adds.

    @property
    def is_localized(self) -> bool:
        """Tell whether it is known where the robot is."""
        return self._observation is not None

    @property
    def robot_pose(self) -> Pose:
        """``Pose`` of the robot in the world."""
        return self.observation.odometry.pose

    @property
    def predicted_pose(self) -> Pose | None:
        """``Pose`` of the robot a dead time and a lag ahead; None where it has no dead time."""
        return None

    @property
    def base_knowledge(self) -> BaseKnowledge | None:
        """Knowledge of the base by now; None for as stated."""
        return None if self._observation is None else self._observation.base

    def limited(self, robot: RoundRobot) -> RoundRobot:
        """
        Limit a robot to the accelerations that its base was seen to reach.

        :param robot: the ``RoundRobot``, nominal.
        """
        known = self.base_knowledge
        return robot if known is None else known.limited(robot)

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note what is commanded.

        :param time: now [s].
        """

    @property
    def position_deviation(self) -> float:
        """Standard deviation of the robot's position [m]; 0 where it is not known."""
        return 0.0

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """``ObjectEstimate``; None where nothing is estimated."""
        return None

    @property
    def knowledge(self) -> ObjectKnowledge | None:
        """``ObjectKnowledge`` of by now; None where nothing is learned."""
        return None

    @property
    def is_robot_elsewhere(self) -> bool:
        """Tell whether jumps of odometry have put the robot elsewhere: nothing known holds."""
        return False

    def pop_relocation(self) -> bool:
        """Tell once that the robot is elsewhere in its map than it seemed to be."""
        return False

    @property
    def repeats_pose(self) -> bool:
        """Tell whether the last object poses are one, to the last digit."""
        return False

    @property
    def have_poses_jumped(self) -> bool:
        """Tell whether object poses have jumped in this task."""
        return False

    @property
    def pose_jump(self) -> Report[PerceptionEvent] | None:
        """Jump of the object poses in this task that they did not take back, or None."""
        return None

    @property
    def is_object_unyielding(self) -> bool:
        """Tell whether a push to no effect has shown that the object does not yield."""
        return False

    @property
    def pose_inconsistency(self) -> Report[PerceptionEvent] | None:
        """Inconsistency of object poses or robot with the contacts; None where all fits."""
        return None

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """Start with what was learned of the object."""

    def take_over_robot(self, previous: 'RawPerception') -> None:
        """
        Start with the robot where it was localized while it pushed another object.

        :param previous: the perception of that object, with the same settings.
        """

    def restart_averaging(self, time: float) -> None:
        """
        Forget where the object was at rest.

        :param time: from which on it may be at rest again [s].
        """

    def forget_contacts(self) -> None:
        """Note that another task starts: what contacts have shown may have been mended."""

    def distrust_odometry(self, has_jumped: bool) -> None:
        """
        Note that odometry is wrong, so that the robot may be elsewhere.

        :param has_jumped: whether the pose of the next one has jumped, so that its step is not to
            be added up.
        """
