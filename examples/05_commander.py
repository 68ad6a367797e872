"""
Push an object from a program: send a goal to the nodes, watch, and cancel what takes too long.

It needs the nodes (``ros2 launch push_control simulation_launch.py``) and ``push_control_msgs``.
"""

from push_model import Pose
from push_ros.commander import PushCommander
import rclpy

GOAL = Pose(0.3, 0.0, 0.0)
PATIENCE = 120.0


def main() -> None:
    """Print what the robot does until the object is at its goal."""
    rclpy.init()
    with PushCommander(frame='odom') as commander:
        commander.wait_until_ready()
        commander.push_to(GOAL)
        while not commander.is_done(timeout=1.0):
            feedback = commander.feedback()
            if feedback is not None:
                print(f'{feedback.text}, {feedback.position_error:.3f} m to go')
                if feedback.elapsed_time > PATIENCE:
                    commander.cancel()
        print(commander.result())
    rclpy.shutdown()


if __name__ == '__main__':
    main()
