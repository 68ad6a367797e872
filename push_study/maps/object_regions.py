"""Stable pushing regions of any object for any round robot, at several speeds."""

import functools
import hashlib
import json
import math

import numpy as np
from push_model.analysis.rolling_limits import min_robot_radius
from push_scenario.definition.mapping import to_mapping
from push_study.framework.study import Finding, Outcome, Parameter, Study
from push_study.maps import perimeter_map, perimeter_table
from push_study.maps.perimeter import places, push_through_center
from push_study.maps.perimeter_table import Panel

NAME = 'stable-regions'
SLOW = 0.1


def study_of(object_name, obj, robot_name, robot):
    """
    Make the study of an object and a robot.

    :param object_name: of the object.
    :param obj: the ``PushedObject``.
    :param robot_name: of the robot.
    :param robot: the ``RoundRobot``.
    :return: ``Study``; its figure is named after both.
    :raises ValueError: for a fence.
    """
    if math.isinf(robot.radius):
        raise ValueError(f'robot {robot_name}: got an infinite radius, expected a round robot')
    return Study(
        f'{NAME}-{object_name}-{robot_name}', f'{object_name} pushed by {robot_name}',
        (Parameter('object', '', 'name and digest of the object'),
         Parameter('robot', '', 'name and digest of the robot'),
         Parameter('speeds', 'm/s', 'speed of the push in each panel')) +
        perimeter_table.PARAMETERS,
        functools.partial(compute, obj, robot), functools.partial(draw, obj, robot),
        'White places return from no turn, dark ones from a great one: {first:.0%} of the '
        'perimeter are stable in the first panel, {last:.0%} in the last.',
        'Some place is stable for robots above {least_diameter:.2f} m across; from the slowest to '
        'the fastest push a tolerance changes by {change:.2f} rad at most.', (7.8, 4.4))


def choices(object_name, obj, robot_name, robot, speeds=()):
    """
    Values of the parameters that tell one study from another.

    :param object_name: of the object.
    :param obj: the ``PushedObject``.
    :param robot_name: of the robot.
    :param robot: the ``RoundRobot``.
    :param speeds: [m/s], each above 0; empty for a slow one and the robot's greatest.
    :return: dict of names to values.
    :raises ValueError: for a speed that is not above 0.
    """
    if not all(0.0 < speed < math.inf for speed in speeds):
        raise ValueError(f'speed: got {list(speeds)}, expected finite speeds above 0 [m/s]')
    speeds = speeds or sorted({min(SLOW, robot.max_speed), robot.max_speed})
    return {'object': f'{object_name} ({_digest(obj)})', 'robot': f'{robot_name} '
            f'({_digest(robot)})', 'speeds': list(speeds)}


def panels(obj, robot, values):
    """
    Panels of the study, one for each speed.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param values: ``Values``.
    """
    return [Panel(f'{speed:g} m/s' + (' (above its limit)' if speed > robot.max_speed else ''),
                  {'speed_m_s': speed}, obj, robot.radius, speed) for speed in values.speeds]


def compute(obj, robot, values, batch):
    """
    Map the object at each speed.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param values: ``Values``.
    :param batch: of the study.
    :return: ``Outcome``.
    """
    shown = panels(obj, robot, values)
    tables, findings = perimeter_table.compute(shown, values, batch)
    table = tables['map']
    turns = np.array([[table['clockwise_rad'][one.rows(table)],
                       table['counter_rad'][one.rows(table)]] for one in shown])
    slow, fast = np.argmin(values.speeds), np.argmax(values.speeds)
    least = min(min_robot_radius(obj, push_through_center(obj, place.contact, robot.radius))
                for place in places(obj, perimeter_table.FINE))
    findings['change'] = Finding(float(abs(turns[fast] - turns[slow]).max()), 'rad',
                                 'largest change of a tolerance to either side with the speed')
    findings['least_diameter'] = Finding(2.0 * least, 'm', 'diameter above which a robot has a '
                                         'stable place, closed form')
    return Outcome(tables, findings)


def draw(obj, robot, figure, outcome, values):
    """
    Draw the maps side by side.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    perimeter_map.draw(panels(obj, robot, values), figure, outcome, values)


def _digest(instance):
    text = json.dumps(to_mapping(instance), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:8]
