"""Qualities of service of the topics."""

from rclpy.qos import DurabilityPolicy, qos_profile_sensor_data, QoSProfile, ReliabilityPolicy

# Measurements are subscribed best effort: a late one is worth less than the next one.
SENSOR = qos_profile_sensor_data
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
# They and the commands are offered reliably all the same, so that recorders get every one, and
# kept for a recorder that stands still: at the thousand a second of a replay in lockstep, for 5 s.
QUEUE_DEPTH = 5000
MEASUREMENT = QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.RELIABLE)
COMMAND = QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.RELIABLE)
# Images are large: few wait for who stands still.
IMAGE = QoSProfile(depth=5, reliability=ReliabilityPolicy.RELIABLE)
# Commands are subscribed best effort as well: a reliable subscriber that has lost one gets no
# other until that is sent again, with Fast DDS up to its heartbeat period of 3 s later.
LATEST_COMMAND = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
# Ten events are more than ever wait for their subscriber.
EVENT = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
# All nodes share one topic of diagnostics, and in lockstep a task may be over while a subscriber
# stands still for a moment: a hundred are more than the nodes report in a task of several pushes.
STATUS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
# The last one is kept for late subscribers.
LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE,
                     durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Requests to an action are kept until they are answered, as those for parameters are.
REQUEST = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)
CLOCK = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
