"""One push of a task, and what it tells of where the robot stands."""

from push_control.command import mean_motion
from push_control.controller import make_controller
from push_control.site import site_of
from push_control.start import contact_at_start
from push_model.geometry import Pose, wrap_angle

# Of where the robot is seen to stand at the end of a push: x and y [m], heading [rad].
DEVIATIONS = 0.01, 0.01, 0.03
# While it pushes: every so many metres, and how far the gap may be from 0 [m].
SPACING, GAP_DEVIATION = 0.1, 0.005


class SupervisedPush:
    """Runs a controller until it ends the push, well or not."""

    def __init__(self, learnt, robot, control, target):
        """
        Prepare.

        :param learnt: the ``LearntObject``; it learns from this push.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param target: the ``PushTrajectory``.
        """
        self._controller = make_controller(learnt.obj, robot, control)
        self._learnt, self._robot, self._target, self._learnt_at = learnt, robot, target, 0.0
        self._tells_place = control.control_law != 'open_loop'
        self._unsure, self.finished, self.trouble = None, False, ''

    @property
    def status(self):
        """The ``ControllerStatus``."""
        return self._controller.status

    def halt(self):
        """Do nothing: a controller waits by itself."""

    def step(self, sight, dt):
        """
        Compute the command; learn where the robot stands at the end.

        :param sight: ``Sight`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``.
        """
        if self._unsure is None:
            self._unsure = float(sight.placement.deviations[:2].max())
        command = self._controller.step(self._target, sight.observation, dt)
        status = self.status
        self.finished = status.phase == 'done'
        if status.phase == 'failed':
            self.trouble = status.reason
        if self._tells_place and status.touches:
            if self.finished:
                self._place(sight, status.robot_pose, command)
                self._learn(status.friction_center)
            elif status.travelled - self._learnt_at >= SPACING:
                self._learnt_at = status.travelled
                sight.feel(self._learnt.obj, self._robot, GAP_DEVIATION, sure=False)
        return command

    def _learn(self, seen):
        # A robot that stands aside touches a vertex all the same, a face or a disc elsewhere.
        aside = site_of(self._learnt.obj, self._robot, self._target).kind != 'vertex'
        self._learnt.learn(contact_at_start(self._target), seen, self._unsure if aside else 0.0)

    def _place(self, sight, seen, command):
        odometry, lag = sight.observation.odometry, self._robot.time_constant
        motion = mean_motion(odometry.twist, command, lag)
        x, y, heading = odometry.pose
        ahead = Pose(x, y, heading + 0.5 * lag * motion.omega).transform(
            (lag * motion.v_x, lag * motion.v_y))
        turn = wrap_angle(seen.theta - heading - lag * motion.omega)
        sight.placement.must_be((seen.x - ahead[0], seen.y - ahead[1], turn), DEVIATIONS)
