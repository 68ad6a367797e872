"""Settings that have no effect beside others: a user who has set one of them is told so."""

from collections.abc import Iterator
import dataclasses
import math
from typing import NamedTuple

from push_control.law_names import is_own_law
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import HEADING_TOLERANCE
from push_primitives.face_points import face_points

# What these settings belong to, in ``ControlSettings``.
PREDICTION = 'horizon_steps', 'horizon_step', 'cone_weight'
FEEDBACK = (
    'lateral_gain', 'heading_gain', 'lateral_saturation', 'max_curvature_rate', 'rolling_gain',
    'stop_distance', 'replan_cone_fraction', 'replan_period', 'replan_min_distance',
    'replan_length_ratio', 'reapproach_distance', 'reapproach_tolerance_ratio',
    'max_reapproaches', 'max_replan_requests', 'follow_window', 'follow_ratio',
    'one_sided_distance')
SINGLE_PUSH = 'position_tolerance', 'heading_tolerance', 'max_reapproaches', 'max_replan_requests'
ROLLING = 'rolling_gain',
STANDSTILL = 'max_standstill',
LAW = 'control_law',
DEFAULTS = {field.name: field.default for field in dataclasses.fields(ControlSettings)}


class UnusedSettings(NamedTuple):
    """
    Settings that were set, and have no effect.

    :param names: fields of the settings, at least one.
    :param reason: why, one clause.
    :param section: of their parameters.
    """

    names: tuple[str, ...]
    reason: str
    section: str = 'control'

    def __str__(self) -> str:
        """Return the sentence, with the names of the parameters."""
        names = ', '.join(f'{self.section}.{name}' for name in self.names)
        return f'{names}: set without effect, {self.reason}'


def unused_settings(obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                    supervision: SupervisionSettings, *, is_task: bool) -> list[UnusedSettings]:
    """
    Find settings that were set and have no effect beside the others.

    A setting with its default value counts as not set.

    :param obj: the ``PushedObject``, nominal.
    :param robot: the ``RoundRobot``, nominal.
    :param is_task: whether the object is brought to its goal by many pushes.
    """
    found: list[UnusedSettings] = []
    listed: set[str] = set()
    for names, reason in _reasons(obj, robot, control, is_task=is_task):
        unused = tuple(name for name in names if name not in listed
                       and getattr(control, name) != DEFAULTS[name])
        if unused:
            found.append(UnusedSettings(unused, reason))
            listed.update(unused)
    is_stated = HEADING_TOLERANCE != supervision.heading_tolerance < math.pi
    if is_task and is_stated and supervision.for_object(obj).heading_tolerance >= math.pi:
        found.append(UnusedSettings(
            ('heading_tolerance',), 'as supervision.disc_heading_free frees the round object',
            section='supervision'))
    return found


def _reasons(obj: PushedObject, robot: RoundRobot, control: ControlSettings, *,
             is_task: bool) -> Iterator[tuple[tuple[str, ...], str]]:
    if control.control_law != 'mpc' and not is_own_law(control.control_law):
        yield PREDICTION, f'as control.control_law is {control.control_law}, not mpc'
    if control.control_law == 'open_loop':
        yield FEEDBACK, 'as control.control_law is open_loop'
    if robot.drive == 'differential':
        yield ROLLING, 'as robot.drive is differential: a holonomic base rolls the contact'
    if control.resume_after_stop == 'automatic':
        yield STANDSTILL, 'as control.resume_after_stop is automatic'
    if is_task:
        yield SINGLE_PUSH, 'as task is true: supervision has the tolerances and limits of a task'
        if _has_straight_pushes(obj):
            yield LAW, ('as far as this object gets straight pushes: laws steer steered pushes, '
                        'where no straight one can begin')


def _has_straight_pushes(obj: PushedObject) -> bool:
    try:
        return bool(face_points(obj))
    except ValueError:
        return False
