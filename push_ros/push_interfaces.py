"""Types of the package ``push_control_msgs``, which may or may not be installed."""

import importlib
from typing import Any, NamedTuple

# Names of the action and of the topic, relative to the namespace of the controller.
ACTION = 'push_object'
STATUS = 'push_status'


class PushInterfaces(NamedTuple):
    """
    Types of ``push_control_msgs``.

    :param action: ``PushObject``.
    :param status: ``PushStatus``.
    """

    action: Any
    status: Any


def import_push_interfaces() -> PushInterfaces | None:
    """Import the types of ``push_control_msgs``; None where it is not installed."""
    try:
        return PushInterfaces(importlib.import_module('push_control_msgs.action').PushObject,
                              importlib.import_module('push_control_msgs.msg').PushStatus)
    except (ImportError, AttributeError):
        # The second where only the folder with the definitions is found.
        return None
