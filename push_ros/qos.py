"""Qualities of service of the topics."""

from rclpy.qos import DurabilityPolicy, qos_profile_sensor_data, QoSProfile, ReliabilityPolicy

# Best effort: a late measurement is worth less than the next one.
SENSOR = qos_profile_sensor_data
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
# Offered reliably all the same, and kept for a while, so that recorders get every one.
MEASUREMENT = QoSProfile(depth=500, reliability=ReliabilityPolicy.RELIABLE)
COMMAND = QoSProfile(depth=500, reliability=ReliabilityPolicy.RELIABLE)
LATEST_COMMAND = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
EVENT = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE,
                     durability=DurabilityPolicy.TRANSIENT_LOCAL)
CLOCK = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
