"""A simulation that is put back to its start, with three nodes that run freely over Fast DDS."""

from geometry_msgs.msg import PoseStamped
from helpers.node_bench import bench
from push_model.files.data import config_file
from push_model.geometry import distance, Pose
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import to_pose_message
from push_ros.diagnostics import ERROR
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds.launch_parameters import ANY_NODE, launch_parameters
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]

MODULES = {PLANNER: 'push_planner.planner_node', CONTROLLER: 'push_control.controller_node'}
SECTIONS = launch_parameters(config_file('push.yaml'))
GOAL = Pose(0.3, 0.0, -0.785)
NEAR = 0.03
# Speed of a robot that stands [m/s, rad/s].
STANDING = 1e-3
# How reports of the controller begin once it has a plan, and at the end of a task or a push.
TASK = 'task: '
PLANNED = f'{TASK}push', f'{TASK}approach'
ENDED = f'{TASK}done'


def parameters(name, *, task, is_simulated):
    """Parameters of a node as ``simulation_launch.py`` has them."""
    own = {
        SIM: {'publish_clock': is_simulated},
        PLANNER: {'use_sim_time': is_simulated},
        CONTROLLER: {'use_sim_time': is_simulated, 'task': task}}
    return {**SECTIONS[ANY_NODE], **SECTIONS.get(f'{ANY_NODE}/{name}', {}), **own[name]}


class Simulation:
    """Three nodes, and what they report."""

    def __init__(self, b):
        self.b = b
        for topic in ('odom', 'object_pose', 'diagnostics'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['object_pose'])
        b.wait_until(lambda: any('waits for a goal' in text for text in self.texts()))

    def statuses(self):
        """List what the controller has reported."""
        return [status for message in self.b.received['diagnostics']
                for status in message.status if status.name == CONTROLLER]

    def texts(self):
        """Texts of it."""
        return [status.message for status in self.statuses()]

    @property
    def object_pose(self):
        """Newest measured pose of the object."""
        return from_object_pose_message(self.b.received['object_pose'][-1], 'odom').pose

    def publish_goal(self):
        """Give the goal."""
        goal = PoseStamped(pose=to_pose_message(GOAL))
        goal.header.frame_id = 'odom'
        self.b.publish('goal_pose', goal)

    def reach_goal(self):
        """Give the goal, and wait until the object is there, or that has failed."""
        self.b.received['diagnostics'].clear()
        self.publish_goal()

        def ends():
            statuses = self.statuses()
            planned = [i for i, status in enumerate(statuses)
                       if status.message.startswith(PLANNED)]
            # Other errors pass: a simulator that had to wait stamps a pose ahead of odometry.
            has_failed = any(status.level == ERROR and status.message.startswith(TASK)
                             for status in statuses)
            return has_failed or planned and any(
                status.message.startswith(ENDED) for status in statuses[planned[0]:])
        self.b.wait_until(ends)
        assert distance(self.object_pose, GOAL) < NEAR, self.texts()

    def stands(self):
        """Tell whether the robot stands, as its newest odometry has it."""
        twist = self.b.received['odom'][-1].twist.twist
        return max(abs(twist.linear.x), abs(twist.linear.y), abs(twist.angular.z)) < STANDING

    def reset(self):
        """
        Put everything back once the robot stands; poses of before may still be on their way.

        Odometry that jumps while the robot drives is taken for wrong, and not for a reset.
        """
        self.b.wait_until(self.stands)
        assert self.b.call('sim/reset').success


@pytest.fixture(params=[(True, True), (False, False)],
                ids=['task in simulated time', 'single push on the wall clock'])
def simulation(request, tmp_path):
    """Start the three nodes: both kinds of pushes, and both of who makes the time."""
    task, is_simulated = request.param
    with bench(tmp_path, SIM, 'push_sim_node.sim_node',
               parameters(SIM, task=task, is_simulated=is_simulated)) as b:
        for name, module in MODULES.items():
            b.start(name, module, parameters(name, task=task, is_simulated=is_simulated))
        yield Simulation(b)


def test_a_goal_is_reached_again_after_a_reset(simulation):
    """The second one is given as soon as the simulator says that it was put back."""
    simulation.reach_goal()
    simulation.reset()
    # It is not taken for reached by an object pose of before.
    simulation.reach_goal()
