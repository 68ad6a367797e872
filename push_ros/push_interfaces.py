"""Types of the package ``push_control_msgs``, which may or may not be installed."""

import importlib
from typing import Any, NamedTuple

# Names of the actions and of the topic, relative to the namespace of the controller.
ACTION = 'push_object'
TIDY_ACTION = 'push_objects'
STATUS = 'push_status'


class PushInterfaces(NamedTuple):
    """
    Types of ``push_control_msgs``.

    :param action: ``PushObject``.
    :param status: ``PushStatus``.
    :param tidy_action: ``PushObjects``.
    :param object_status: ``ObjectStatus``.
    """

    action: Any
    status: Any
    tidy_action: Any
    object_status: Any


def import_push_interfaces() -> PushInterfaces | None:
    """Import the types of ``push_control_msgs``; None where it is not installed."""
    try:
        actions = importlib.import_module('push_control_msgs.action')
        messages = importlib.import_module('push_control_msgs.msg')
        return PushInterfaces(actions.PushObject, messages.PushStatus, actions.PushObjects,
                              messages.ObjectStatus)
    except (ImportError, AttributeError):
        # The second where only the folder with the definitions is found.
        return None
