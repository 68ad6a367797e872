"""One push of a task, and what it tells of where the robot stands."""

import math

import numpy as np
from push_control.estimation.contact_site import initial_contact_site
from push_control.laws.command import mean_twist
from push_control.push.controller import Controller
from push_control.push.start import contact_start_point
from push_control.push.status import Phase
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.signals import STOP

# Of where the robot is seen to stand at the end of a push [m], and of its heading [rad]; and how
# many times as much for every slip and every loss of contact.
PLACE, HEADING, DOUBT = 0.01, 0.01, 2
GAP_DEVIATION, TURNED = 0.005, 0.2
# Room in a map that neither robot nor object may lack where the plan does not [m].
GUARDS = 0.025, 0.0
# Of the robot's place after a push that failed [m]. Where more poses than these were rejected the
# object was carried off: that tells nothing of the robot.
FAILED_PLACE, REJECTED = 0.03, 1


class SupervisedPush:
    """Runs a controller until it ends the push, well or not."""

    def __init__(self, object_model, robot, control, supervision, target, occupancy_map=None):
        """
        Prepare.

        :param object_model: the ``ObjectModelEstimator``; it learns from this push.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param supervision: ``SupervisionSettings``.
        :param target: the ``PushTrajectory``.
        :param occupancy_map: the ``OccupancyMap``, or None.
        """
        self._controller = Controller(object_model.obj, robot, control)
        self._learnt, self._robot, self._target = object_model, robot, target
        self._workspace = occupancy_map
        self._off_path = supervision.max_path_deviation
        self._tells_place = control.control_law != 'open_loop'
        self._unsure, self.finished, self.failure_reason = None, False, ''

    @property
    def status(self):
        """The ``ControllerStatus``."""
        return self._controller.status

    def pause(self):
        """Do nothing: a controller waits by itself."""

    def step(self, perception, dt):
        """
        Compute the command; learn where the robot stands at the end.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``.
        """
        if self._unsure is None:
            self._unsure = float(perception.localization.standard_deviations[:2].max())
        command = self._controller.step(self._target, perception.observation, dt)
        status = self.status
        self.finished = status.phase is Phase.DONE
        self.failure_reason = (status.reason if status.phase is Phase.FAILED else
                               self._astray(perception) or self._near_obstacle(status))
        if (self.finished or self.failure_reason) and self._tells_place and status.in_contact:
            self._look_back(perception, status, command)
        return STOP if self.failure_reason else command

    def _astray(self, perception):
        x, y, _ = perception.observation.object_pose.pose
        way = self._target.object_poses[:, :2]
        off = float(np.hypot(*(way - (x, y)).T).min())
        # A pose that is not finite is left to the controller, which waits.
        if off > self._off_path:
            return f'the object is {off:.2f} m off the path planned for it'
        return ''

    def _near_obstacle(self, status):
        """Say what comes nearer to an obstacle of the map than it should, and than planned."""
        room, target = self._workspace, self._target
        if room is None or status.phase is not Phase.PUSHING:
            return ''
        way = target.object_poses[:, :2] - status.object_pose[:2]
        row = int(np.hypot(*way.T).argmin())
        for name, hit, body, here, planned in (
                ('object', room.first_object_collision, self._learnt.obj, status.object_pose,
                 target.object_poses[row]),
                ('robot', room.first_robot_collision, self._robot, status.robot_pose,
                 target.robot_poses[row])):
            for margin in GUARDS:
                if (hit(body, [here], margin) is not None
                        and hit(body, [planned], margin) is None):
                    return f'the {name} strays towards an obstacle of the map'
        return ''

    def _learn(self, seen, odd):
        unsure = self._unsure if self._aside else 0.0
        self._learnt.learn(contact_start_point(self._target), seen,
                           math.hypot(unsure, DOUBT * odd * PLACE))

    @property
    def _aside(self):
        """Whether a robot that stands aside touches elsewhere, as it does not at a vertex."""
        return initial_contact_site(self._learnt.obj, self._robot, self._target).kind != 'vertex'

    def _look_back(self, perception, status, command):
        """Learn from a push that is over; little from one in which the contact did not hold."""
        odd = status.slips + status.contact_losses
        if self.finished or not odd and status.rejected_poses <= REJECTED:
            perception.update_from_contact(self._learnt.obj, self._robot, GAP_DEVIATION, sure=False)
            self._place(perception, status, command, 1 + DOUBT * odd)
            perception.on_push_succeeded()
            self._learn(status.friction_center, odd)
        else:
            perception.localization.inflate_covariance(FAILED_PLACE)
            perception.correct_overlap(self._learnt.obj, self._robot, GAP_DEVIATION)

    def _place(self, perception, status, command, inflate_covariance):
        seen = status.robot_pose
        odometry, lag = perception.corrected_observation.odometry, self._robot.time_constant
        motion = mean_twist(odometry.twist, command, lag)
        x, y, heading = odometry.pose
        ahead = Pose(x, y, heading + 0.5 * lag * motion.omega).transform(
            (lag * motion.v_x, lag * motion.v_y))
        turn = wrap_angle(seen.theta - heading - lag * motion.omega)
        if abs(turn) > TURNED + 4.0 * perception.localization.standard_deviations[2]:
            # Somebody has turned the object: what it tells of the robot is wrong.
            return
        elsewhere = self._aside or inflate_covariance > 1
        across, shift, unsure = self._beside(status) if elsewhere else (0.0, 0.0, 0.0)
        x, y = math.cos(across), math.sin(across)
        axes = np.array([(x, -y, 0.0), (y, x, 0.0), (0.0, 0.0, 1.0)])
        spread = inflate_covariance * np.array((math.hypot(PLACE, unsure), PLACE, HEADING))
        perception.localization.update_pose((seen.x - shift * x - ahead[0], seen.y - shift * y - ahead[1],
                                             turn), axes @ np.diag(spread ** 2) @ axes.T,
                                            self.finished and inflate_covariance == 1)

    def _beside(self, status):
        """
        See by the friction centre how far beside its place on the object the robot has pushed.

        Returns the direction across the push in the world [rad], how far the robot is believed
        to be too far to that side [m], and how unsure that is [m].
        """
        obj, pose, radius = self._learnt.obj, status.object_pose, self._robot.radius
        x, y, _ = status.robot_pose
        normal = find_contact(obj, pose, (x, y), radius)[1]
        point = pose.inverse().transform((x + radius * math.cos(normal),
                                          y + radius * math.sin(normal)))
        across, shift, unsure = self._learnt.lateral_innovation(point, status.friction_center)
        # The contact on a round side is off by less than the robot.
        share = 1.0 if obj.outline else 1.0 + radius / obj.radius
        return across + pose.theta, share * shift, share * unsure
