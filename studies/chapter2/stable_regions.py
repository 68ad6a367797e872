"""Where a box can be pushed without steering: stable regions round its perimeter."""

import functools
import math
from typing import Callable

from matplotlib.figure import Figure
import numpy as np
from studies.framework.box import BOX, box, REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Compute, Finding, Outcome, RunJobs, Study
from studies.maps import stable_regions, stable_regions_figure
from studies.maps.stable_regions import Panel, stable_length

SPEED = Parameter('speed', 'm/s', 'speed of the push, slow enough that inertia does not count')
OBSERVATION = ('White locations return from no rotation, dark ones from a large one, between the '
               'red borders of the closed form. ')


def diameter_panels(values: Values) -> list[Panel]:
    """
    List panels of a box, pushed by robots of several diameters.

    :param values: of the parameters of 2.28.
    :return: one panel per diameter.
    """
    return [Panel(f'robot of {diameter:g} m', {'diameter_m': diameter}, box(values),
                  0.5 * diameter, values.speed) for diameter in values.robot_diameters]


def center_panels(values: Values) -> list[Panel]:
    """
    List panels of boxes whose mass, and so friction, is centred elsewhere.

    :param values: of the parameters of 2.29.
    :return: one panel per centre.
    """
    return [Panel(f'centre at ({x:g}, {y:g}) m', {'center_x_m': x, 'center_y_m': y},
                  box(values, center_of_mass=(x, y)), 0.5 * values.robot_diameter, values.speed)
            for x, y in values.friction_centers]


def compute_diameters(values: Values, run_jobs: RunJobs) -> Outcome:
    """Map the box for each diameter of the robot."""
    tables, findings, _ = stable_regions.compute(diameter_panels(values), values, run_jobs)
    steps = np.diff(tables['fractions']['stable_fraction'])
    findings['growth'] = Finding(float(steps.min(initial=1.0)), '',
                                 'least growth of the stable fraction from panel to panel')
    peaks = [float(tables['map']['tolerance_rad'][panel.rows(tables['map'])].max())
             for panel in diameter_panels(values)]
    best = int(np.argmax(peaks))
    findings['best_diameter'] = Finding(values.robot_diameters[best], 'm', 'diameter of the robot '
                                        'with the greatest tolerance')
    findings['best_tolerance'] = Finding(math.degrees(peaks[best]), 'deg', 'that tolerance')
    findings['last_tolerance'] = Finding(math.degrees(peaks[-1]), 'deg',
                                         'greatest tolerance, last panel')
    findings['difference_deg'] = Finding(math.degrees(findings['difference'].value), 'deg',
                                         'largest difference of a simulated tolerance')
    return Outcome(tables, findings)


def compute_centers(values: Values, run_jobs: RunJobs) -> Outcome:
    """Map the box for each centre of friction."""
    panels = center_panels(values)
    tables, findings, _ = stable_regions.compute(panels, values, run_jobs)
    table = tables['map']
    rear_rows = [panel.rows(table) & np.equal(table['face'], REAR_FACE) for panel in panels]
    sampled = [stable_length(table, rows) for rows in rear_rows]
    tolerances = [float(table['tolerance_rad'][rows].max()) for rows in rear_rows]
    distances = [0.5 * values.box_length + x for x, _ in values.friction_centers]
    lengths = [_stable_length(values, distance) for distance in distances]
    for name, index in (('start', 0), ('widest', int(np.argmax(lengths))),
                        ('nearest', int(np.argmin(distances)))):
        where = f'rear face, {name} panel'
        findings[f'{name}_distance'] = Finding(distances[index], 'm',
                                               f'centre of friction from the {where}')
        findings[f'{name}_length'] = Finding(lengths[index], 'm',
                                             f'length of the stable part of the {where}')
        findings[f'{name}_sampled'] = Finding(sampled[index], 'm', 'the same, sum of the stable '
                                              'sections')
        findings[f'{name}_tolerance'] = Finding(math.degrees(tolerances[index]), 'deg',
                                                f'greatest tolerance on the {where}')
    return Outcome(tables, findings)


def _stable_length(values: Values, distance: float) -> float:
    """
    Compute the length of the stable part of the rear face in closed form [m].

    :param distance: d, of the centre of friction from the face, beside whose middle it is not [m].
    """
    radius = 0.5 * values.robot_diameter
    half = min(math.sqrt(max(0.0, distance * (radius - distance))),
               distance * values.contact_friction, 0.5 * values.box_width)
    return 2.0 * half


MakePanels = Callable[[Values], list[Panel]]


def _draw(panels: MakePanels, figure: Figure, outcome: Outcome, values: Values) -> None:
    stable_regions_figure.draw(panels(values), figure, outcome, values)


def _study(figure: str, title: str, parameters: tuple[Parameter, ...], compute: Compute,
           panels: MakePanels, *, observation: str, explanation: str) -> Study:
    return Study(figure, f'Stable pushing regions of a box for {title}',
                 (*BOX, *parameters, SPEED, *stable_regions.PARAMETERS), compute,
                 functools.partial(_draw, panels), OBSERVATION + observation, explanation,
                 (7.8, 5.4))


STUDIES = (
    _study('2.28', 'growing robot diameter',
           (Parameter('robot_diameters', 'm', 'diameter of the robot in each panel'),),
           compute_diameters, diameter_panels,
           observation='The stable fraction of the perimeter grows from {first:.2f} to '
           '{last:.2f}. The tolerance peaks at a robot of {best_diameter:g} m, at '
           '{best_tolerance:.0f} degrees, and is {last_tolerance:.0f} degrees with the largest.',
           explanation='Simulated tolerances differ by {difference_deg:.1f} degrees at most.'),
    _study('2.29', 'several centres of friction',
           (Parameter('friction_centers', 'm', 'centre of mass and of friction in each panel, '
                      'from the middle of the box'),
            Parameter('robot_diameter', 'm', 'diameter of the robot')),
           compute_centers, center_panels,
           observation='As the centre of friction nears the rear face, its stable part grows from '
           '{start_length:.3f} to {widest_length:.3f} m, then shrinks to {nearest_length:.3f} m. '
           'The tolerance falls from {start_tolerance:.0f} to {nearest_tolerance:.0f} degrees.',
           explanation='Half of the stable part is sqrt(d (R - d)) by stability, d mu_c by the '
           'cone, d the distance from the face.'))
