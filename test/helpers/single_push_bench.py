"""A controller at single pushes over DDS, and a robot that is played here."""

import math
from typing import Any

from geometry_msgs.msg import PoseStamped
from helpers.node_bench import Bench
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.signals import Twist
from push_model.trajectory import PushTrajectory
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.primitives import to_pose_message
from push_ros.diagnostics import WARN
from push_ros.topics import CONTROLLER
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

SCENARIO = read_scenario(find_scenario('straight_push'))
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
BEARING = math.atan2(GOAL.y - OBJECT.y, GOAL.x - OBJECT.x)
ZERO = (0.0, 0.0, 0.0)
PERIOD = 0.02
# Time between two tests [s]: the robot is where it was, for a controller that has forgotten it.
GAP = 1.0


def plan(move: Pose = Pose(0.0, 0.0, 0.0), **changes: Any) -> PushTrajectory:
    """Plan the straight push, or one elsewhere, to another goal, or of another object."""
    values = {'obj': SCENARIO.object, 'robot': ROBOT, 'goal': GOAL, **changes}
    return plan_push(problem_from_placement(
        values['obj'], SCENARIO.robot, move @ OBJECT, move @ values['robot'],
        move @ values['goal'], SCENARIO.planner)).trajectory


class SinglePushBench:
    """A controller at single pushes, and a robot that goes straight ahead with its object."""

    def __init__(self, b: Bench) -> None:
        self.b = b
        self.now = 0.0
        self.distance, self.command = 0.0, ZERO
        for topic in ('cmd_vel', 'diagnostics', 'push_request'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['diagnostics'])
        b.clock(0.0)
        b.connect(OBJECT, ROBOT)

    def measure(self, count: int = 10) -> set[tuple[float, float, float]]:
        """Let time pass; return the commands that have come."""
        commands = set()
        for _ in range(count):
            self.now += PERIOD
            self.b.clock(self.now)
            speed = math.hypot(*self.command[:2])
            self.distance += PERIOD * speed
            commands.add(self.b.odometry(self.now, self._moved(ROBOT), twist=Twist(
                speed * math.cos(BEARING - ROBOT.theta), speed * math.sin(BEARING - ROBOT.theta),
                0.0)))
            self.command = self.b.object_pose(self.now, self._moved(OBJECT))
            commands.add(self.command)
        return commands

    def _moved(self, pose: Pose) -> Pose:
        """Place a body after the distance that was driven."""
        return Pose(pose.x + self.distance * math.cos(BEARING),
                    pose.y + self.distance * math.sin(BEARING), pose.theta)

    def put_back(self) -> None:
        """Let the controller forget what it does; robot and object stand at the start again."""
        for transition in (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_ACTIVATE):
            self.b.request(ChangeState, f'{CONTROLLER}/change_state', ChangeState.Request(
                transition=Transition(id=transition)))
        self.b.wait_for_silence('cmd_vel')
        self.distance, self.command = 0.0, ZERO
        self.b.base = self.now = self.now + GAP
        self.b.connect(OBJECT, ROBOT)
        self.b.base = 0.0
        self.b.received['diagnostics'].clear()

    def send_goal(self, goal: Pose = GOAL) -> None:
        """Publish a goal."""
        message = PoseStamped(pose=to_pose_message(goal))
        message.header.frame_id = 'odom'
        self.b.publish('goal_pose', message)

    def request(self, goal: Pose = GOAL) -> Any:
        """Send a goal; return the request for its plan."""
        requests = self.b.received['push_request']
        count = len(requests)
        self.send_goal(goal)
        self.b.repeat_until(self.measure, lambda: len(requests) > count, period=0.0)
        return requests[-1]

    @property
    def sender(self) -> str:
        """What reports say of who sends plans: this bench alone."""
        return f'push_plan is published by /{self.b.node.get_name()}'

    def introduce(self) -> None:
        """Send a plan that nobody has asked for, until the report on it names the sender."""
        # The middleware knows a publisher before it knows the name of its node.
        unrequested = JointTrajectory(points=[JointTrajectoryPoint()])
        self.b.repeat_until(lambda: self.b.publish('push_plan', unrequested),
                            lambda: self.reports(self.sender, WARN))
        self.b.received['diagnostics'].clear()

    def send(self, trajectory: PushTrajectory, stamp: Any) -> None:
        """Publish a plan."""
        self.b.publish('push_plan', to_plan_message(trajectory, stamp, 'odom'))

    def wait_for(self, text: str, level: bytes) -> str:
        """Wait for a report, and return the whole of it; each is found once."""
        self.b.wait_until(lambda: self.reports(text, level))
        report = self.reports(text, level)[-1]
        self.b.received['diagnostics'].clear()
        return report

    def reports(self, text: str, level: bytes) -> list[str]:
        """List the reports that have come with a text."""
        return [status.message for message in self.b.received['diagnostics']
                for status in message.status
                if text in status.message and status.level == level]

    def drive(self) -> None:
        """Let time pass until the robot is driven."""
        self.b.repeat_until(self.measure, lambda: self.command != ZERO, period=0.0)
