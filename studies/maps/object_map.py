"""Stable pushing regions of any object for any round robot, at several speeds."""

import functools
import hashlib
import json
import math
from typing import Any, Sequence

from matplotlib.figure import Figure
import numpy as np
from push_model.files.mapping import to_mapping
from push_model.parameters import PushedObject, RoundRobot
from studies.analysis.rolling_limits import min_robot_radius
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study
from studies.maps import stable_regions, stable_regions_figure
from studies.maps.perimeter import perimeter_locations, push_through_center
from studies.maps.stable_regions import Panel

NAME = 'stable-regions'
# Chosen: a speed at which inertia hardly counts, for the first panel [m/s].
SLOW_SPEED = 0.1


def object_study(object_name: str, obj: PushedObject, robot_name: str,
                 robot: RoundRobot) -> Study:
    """
    Make the study of an object and a robot.

    :param object_name: of the object.
    :param obj: the object.
    :param robot_name: of the robot.
    :param robot: the robot.
    :return: study; its figure is named after both.
    :raises ValueError: for a flat pusher.
    """
    if math.isinf(robot.radius):
        raise ValueError(f'robot {robot_name}: got an infinite radius, expected a round robot')
    return Study(
        f'{NAME}-{object_name}-{robot_name}', f'{object_name} pushed by {robot_name}',
        (Parameter('object', '', 'name and digest of the object'),
         Parameter('robot', '', 'name and digest of the robot'),
         Parameter('speeds', 'm/s', 'speed of the push in each panel'),
         *stable_regions.PARAMETERS),
        functools.partial(_compute, obj, robot), functools.partial(_draw, obj, robot),
        'White locations return from no rotation, dark ones from a large one: {first:.0%} of the '
        'perimeter are stable in the first panel, {last:.0%} in the last.',
        'Some location is stable for robots above {least_diameter:.2f} m in diameter; from the '
        'slowest to the fastest push a tolerance changes by {change:.2f} rad at most.',
        (7.8, 4.4))


def identifying_values(object_name: str, obj: PushedObject, robot_name: str, robot: RoundRobot,
                       speeds: Sequence[float] = ()) -> dict[str, Any]:
    """
    Return the values of the parameters that distinguish one study from another.

    :param object_name: of the object.
    :param obj: the object.
    :param robot_name: of the robot.
    :param robot: the robot.
    :param speeds: [m/s], each above 0; empty for a slow one and the robot's greatest.
    :return: parameter name -> value.
    :raises ValueError: for a speed that is not above 0.
    """
    if not all(0.0 < speed < math.inf for speed in speeds):
        raise ValueError(f'speed: got {list(speeds)}, expected finite speeds above 0 [m/s]')
    speeds = speeds or sorted({min(SLOW_SPEED, robot.max_speed), robot.max_speed})
    return {'object': f'{object_name} ({_digest(obj)})',
            'robot': f'{robot_name} ({_digest(robot)})', 'speeds': list(speeds)}


def _panels(obj: PushedObject, robot: RoundRobot, values: Values) -> list[Panel]:
    """Make one panel for each speed."""
    return [Panel(f'{speed:g} m/s' + (' (above its limit)' if speed > robot.max_speed else ''),
                  {'speed_m_s': speed}, obj, robot.radius, speed) for speed in values.speeds]


def _compute(obj: PushedObject, robot: RoundRobot, values: Values, run_jobs: RunJobs) -> Outcome:
    """Map the object at each speed."""
    panels = _panels(obj, robot, values)
    tables, findings, _ = stable_regions.compute(panels, values, run_jobs)
    table = tables['map']
    # Tolerances by panel, side and location.
    tolerances = np.array([[table['clockwise_rad'][panel.rows(table)],
                            table['counter_rad'][panel.rows(table)]] for panel in panels])
    slow, fast = np.argmin(values.speeds), np.argmax(values.speeds)
    least_radius = min(
        min_robot_radius(obj, push_through_center(obj, location.contact, robot.radius))
        for location in perimeter_locations(obj, stable_regions.FINE_LOCATIONS))
    findings['change'] = Finding(float(abs(tolerances[fast] - tolerances[slow]).max()), 'rad',
                                 'largest change of a tolerance to either side with the speed')
    findings['least_diameter'] = Finding(2.0 * least_radius, 'm', 'diameter above which a robot '
                                         'has a stable location, closed form')
    return Outcome(tables, findings)


def _draw(obj: PushedObject, robot: RoundRobot, figure: Figure, outcome: Outcome,
          values: Values) -> None:
    """Draw the maps side by side."""
    stable_regions_figure.draw(_panels(obj, robot, values), figure, outcome, values)


def _digest(instance: PushedObject | RoundRobot) -> str:
    text = json.dumps(to_mapping(instance), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:8]
