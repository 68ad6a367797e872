"""Publishes a map of any size: ``python -m benchmarks.faults.huge_map BYTES``."""

import array
import math
import sys

from nav_msgs.msg import OccupancyGrid
from push_ros.node_settings import Frames
from push_ros.topics import CONTROLLER, PLANNER, TOPICS
import rclpy
from rclpy.duration import Duration

# Time in which all have to get it [s].
TIMEOUT = 60.0


def main() -> None:
    """Publish the map once both nodes listen, and wait until they have it."""
    rclpy.init(args=[])
    node = rclpy.create_node('huge_map')
    publisher = node.create_publisher(OccupancyGrid, 'map', TOPICS['map'].publish_qos)
    side = math.isqrt(int(sys.argv[1]))
    message = OccupancyGrid()
    message.header.frame_id = Frames().world_frame
    message.info.resolution, message.info.width, message.info.height = 0.05, side, side
    message.info.origin.orientation.w = 1.0
    message.data = array.array('b', bytes(side * side))
    while publisher.get_subscription_count() < len({CONTROLLER, PLANNER}):
        rclpy.spin_once(node, timeout_sec=0.05)
    publisher.publish(message)
    is_taken = publisher.wait_for_all_acked(Duration(seconds=TIMEOUT))
    print(f'{side * side} bytes, taken by all: {is_taken}', flush=True)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
