"""
Drive to an object with Nav2, push it to its goal, and back up, so that Nav2 can plan again.

It needs Nav2 with ``nav2_simple_commander``, the nodes (``ros2 launch push_control
robot_launch.py``) and ``push_control_msgs``; docs/robots/nav2.md says who drives when.
"""

from typing import Any

from geometry_msgs.msg import PoseStamped
from nav2_simple_commander.robot_navigator import (  # pyright: ignore[reportMissingImports]
    BasicNavigator, TaskResult,
)
from push_model import Pose
from push_ros.commander import PushCommander
from push_ros.conversions.primitives import to_pose_message
import rclpy

FRAME = 'map'
# Nav2 does not come nearer to what its costmap has for an obstacle; the push drives the rest.
NEAR_THE_OBJECT = Pose(-0.8, 0.0, 0.0)
GOAL = Pose(0.3, 0.0, 0.0)
# Out of the inflated costs around the object [m, m/s].
BACKUP_DISTANCE, BACKUP_SPEED = 0.3, 0.1


def is_done(navigator: Any) -> bool:
    """Wait for the present task of Nav2; return whether it has succeeded."""
    while not navigator.isTaskComplete():
        print(navigator.getFeedback())
    return bool(navigator.getResult() == TaskResult.SUCCEEDED)


def main() -> None:
    """Print how the push has ended."""
    rclpy.init()
    navigator, start = BasicNavigator(), PoseStamped(pose=to_pose_message(NEAR_THE_OBJECT))
    start.header.frame_id = FRAME
    with PushCommander(frame=FRAME) as commander:
        commander.wait_until_ready()
        navigator.goToPose(start)
        if not is_done(navigator):
            raise SystemExit('Nav2 has not come to the object')
        commander.push_to(GOAL)
        while not commander.is_done(timeout=1.0):
            print(commander.feedback())
        print(commander.result())
    navigator.backup(backup_dist=BACKUP_DISTANCE, backup_speed=BACKUP_SPEED)
    is_done(navigator)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
