"""Names of publishers, as reports give them."""

from rclpy.topic_endpoint_info import TopicEndpointInfo

# What the middleware calls a node of which only a publisher is known so far (rmw_dds_common), and
# what reports call it.
UNDISCOVERED_NAME = '_NODE_NAME_UNKNOWN_'
UNKNOWN_NODE = 'a node whose name is not known yet'


def publisher_name(info: TopicEndpointInfo) -> str:
    """
    Name the node of a publisher.

    :param info: of the publisher.
    :return: its full name, or ``UNKNOWN_NODE``.
    """
    if info.node_name == UNDISCOVERED_NAME:
        return UNKNOWN_NODE
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'
