"""Listener of tf: it fills a buffer from ``/tf`` and ``/tf_static``."""

import importlib
from typing import Any, Callable

from push_ros.conversions.primitives import nanoseconds
from push_ros.executor import take_message
from push_ros.node import PushNode
from push_ros.transforms.buffer import TransformBuffer
from push_ros.transforms.messages import from_transform_message
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

DYNAMIC_TOPIC = '/tf'
STATIC_TOPIC = '/tf_static'
# Those that tf2 asks for and offers.
DYNAMIC_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
STATIC_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE,
                        durability=DurabilityPolicy.TRANSIENT_LOCAL)
NOT_INSTALLED = 'transforms need the package tf2_msgs, which is not installed'


def transform_message_type() -> type[Any] | None:
    """Return ``tf2_msgs/TFMessage``; None where the package is not installed."""
    try:
        return importlib.import_module('tf2_msgs.msg').TFMessage
    except ModuleNotFoundError:
        return None


class TransformListener:
    """
    Takes in transforms as they come.

    ``is_installed``: whether there is a message type of transforms.
    """

    def __init__(self, node: PushNode, buffer: TransformBuffer,
                 on_transforms: Callable[[], None] | None = None) -> None:
        """
        Subscribe to tf.

        :param buffer: the ``TransformBuffer`` to be filled.
        :param on_transforms: called with nothing after transforms have come.
        """
        self._node = node
        self._buffer = buffer
        self._on_transforms = on_transforms
        self._subscriptions: dict[bool, Subscription] = {}
        kind = transform_message_type()
        self.is_installed = kind is not None
        if kind is None:
            node.get_logger().warning(NOT_INSTALLED)
            return
        for is_static, topic, quality in ((False, DYNAMIC_TOPIC, DYNAMIC_QOS),
                                          (True, STATIC_TOPIC, STATIC_QOS)):
            self._subscriptions[is_static] = node.create_subscription(
                kind, topic,
                node.guarded(self._on_static if is_static else self._on_dynamic), quality,
                callback_group=node.background)

    def take(self) -> None:
        """Take in what has come since, without waiting for the executor."""
        for is_static, subscription in self._subscriptions.items():
            message = take_message(subscription)
            while message is not None:
                self._set(message, is_static)
                message = take_message(subscription)

    def _on_dynamic(self, message: Any) -> None:
        self._on_message(message, is_static=False)

    def _on_static(self, message: Any) -> None:
        self._on_message(message, is_static=True)

    def _on_message(self, message: Any, *, is_static: bool) -> None:
        self._set(message, is_static)
        # The background has few turns: whatever waits is taken in one.
        self.take()
        if self._on_transforms is not None:
            self._on_transforms()

    def _set(self, message: Any, is_static: bool) -> None:
        for stamped in message.transforms:
            try:
                self._buffer.set(stamped.header.frame_id, stamped.child_frame_id,
                                 nanoseconds(stamped.header.stamp),
                                 from_transform_message(stamped), is_static=is_static)
            except ValueError as error:
                self._node.get_logger().warning(
                    f'tf: {stamped.header.frame_id} -> {stamped.child_frame_id}: {error}',
                    throttle_duration_sec=10.0)
