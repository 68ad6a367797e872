"""ROS node of the simulator."""

import sys

from push_ros.executor import run
from push_sim_node.ros import simulator

SECTIONS = simulator.SECTIONS


class SimNode(simulator.Simulator):
    """
    The true object, the true robot and their sensors.

    Publishes ``odom``, ``object_pose``, ``contact_wrench``, ``markers``, ``diagnostics``, where it
    owns time ``clock``, ``tf`` where tf2_msgs is installed, and ``scan`` where it has a lidar;
    subscribes ``cmd_vel``, ``initialpose``; serves ``sim/start``, ``sim/reset``. Parameters:
    ``object.*`` and ``robot.*`` as they truly are, ``sensors.*``, ``simulation.*``, frames and how
    time passes.
    """


if __name__ == '__main__':
    sys.exit(run(SimNode))
