"""Codes of what happens to a task, as messages and files carry them."""

from push_control.behaviors.failures import BehaviorFailure
from push_control.events import PerceptionEvent, TaskEvent
from push_model.events import Codes, ObjectFailure, PushEvent
from push_model.plan_request import PlanFailure
from push_navigation.path import PathFailure
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReason

CODE_KINDS = (TaskEvent, PerceptionEvent, BehaviorFailure, PushEvent, ObjectFailure, SafetyReason,
              ProtectiveCause, PathFailure, PlanFailure)
_CODES = {str(code): code for kind in CODE_KINDS for code in kind}


def code_text(codes: Codes) -> str:
    """
    Write codes as text.

    :return: such as ``TaskEvent.NO_PLAN PlanFailure.BLOCKED``; empty for none.
    """
    return ' '.join(code_names(codes))


def code_names(codes: Codes) -> list[str]:
    """
    Name codes.

    :return: such as ``TaskEvent.NO_PLAN``, ``PlanFailure.BLOCKED``; empty for none.
    """
    return [str(code) for code in codes]


def codes_of_text(text: str) -> Codes:
    """
    Read codes; those that are not known here, as of another version, are left out.

    :param text: as of ``code_text``.
    """
    return tuple(_CODES[name] for name in text.split() if name in _CODES)
