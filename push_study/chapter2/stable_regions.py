"""Where a box can be pushed without steering: stable regions round its perimeter."""

import functools

import numpy as np
from push_study.framework.scenes import BOX, box
from push_study.framework.study import Finding, Outcome, Parameter, Study
from push_study.maps import perimeter_map, perimeter_table
from push_study.maps.perimeter_table import Panel, stable_length

BEHIND = 3
SPEED = Parameter('speed', 'm/s', 'speed of the push, slow enough that inertia does not count')
SEEN = ('White places return from no turn, dark ones roll back from a great one without sliding, '
        'between the red borders of the closed form; ')


def diameters(values):
    """
    Panels of a box, pushed by robots of several diameters.

    :param values: ``Values``.
    """
    return [Panel(f'robot of {diameter:g} m', {'diameter_m': diameter}, box(values),
                  0.5 * diameter, values.speed) for diameter in values.robot_diameters]


def centers(values):
    """
    Panels of boxes whose mass, and so friction, is centred elsewhere.

    :param values: ``Values``.
    """
    return [Panel(f'centre at ({x:g}, {y:g}) m', {'center_x_m': x, 'center_y_m': y},
                  box(values, center_of_mass=(x, y)), 0.5 * values.robot_diameter, values.speed)
            for x, y in values.friction_centers]


def compute_diameters(values, batch):
    """
    Map the box for each diameter.

    :param values: ``Values``.
    :param batch: of the study.
    """
    tables, findings = perimeter_table.compute(diameters(values), values, batch)
    steps = np.diff(tables['shares']['stable_share'])
    findings['growth'] = Finding(float(steps.min(initial=1.0)), '',
                                 'least growth of the stable share from panel to panel')
    return Outcome(tables, findings)


def compute_centers(values, batch):
    """
    Map the box for each friction centre.

    :param values: ``Values``.
    :param batch: of the study.
    """
    panels = centers(values)
    tables, findings = perimeter_table.compute(panels, values, batch)
    table = tables['map']
    rows = [panel.rows(table) & np.equal(table['face'], BEHIND) for panel in panels]
    lengths = [stable_length(table, one) for one in rows]
    borne = [float(table['tolerance_rad'][one].max()) for one in rows]
    away = [0.5 * values.box_length + x for x, _ in values.friction_centers]
    widest, nearest = int(np.argmax(lengths)), int(np.argmin(away))
    for name, index in (('start', 0), ('widest', widest), ('nearest', nearest)):
        where = f'face behind, {name} panel'
        findings[f'{name}_away'] = Finding(away[index], 'm', f'friction centre from the {where}')
        findings[f'{name}_length'] = Finding(lengths[index], 'm', f'stable stretch of the {where}')
        findings[f'{name}_borne'] = Finding(borne[index], 'rad',
                                            f'greatest tolerance on the {where}')
    return Outcome(tables, findings)


def _draw(panels, figure, outcome, values):
    perimeter_map.draw(panels(values), figure, outcome, values)


def _study(figure, title, own, compute, panels, seen, why):
    return Study(figure, title, BOX + own + (SPEED,) + perimeter_table.PARAMETERS, compute,
                 functools.partial(_draw, panels), SEEN + seen, why, (7.8, 5.4))


STUDIES = (
    _study('2.28', 'Stable pushing regions of a box for growing robot diameter',
           (Parameter('robot_diameters', 'm', 'diameter of the robot in each panel'),),
           compute_diameters, diameters,
           'the stable share of the perimeter grows with every panel, from {first:.2f} to '
           '{last:.2f}.',
           'A place is stable while the friction centre is nearer than R_e cos(rho), which grows '
           'with the robot; the borders in the plant are those of the closed form, and tolerances '
           'differ by {difference:.3f} rad at most.'),
    _study('2.29', 'Stable pushing regions of a box for several friction centres',
           (Parameter('friction_centers', 'm', 'mass and friction centre in each panel, from the '
                      'middle of the box'),
            Parameter('robot_diameter', 'm', 'diameter of the robot')),
           compute_centers, centers,
           'as the friction centre comes nearer to the face behind, the stable stretch of that '
           'face first grows, from {start_length:.2f} to {widest_length:.2f} m, then shrinks to '
           '{nearest_length:.2f} m; the greatest turn borne there falls from {start_borne:.2f} '
           'to {nearest_borne:.2f} rad.',
           'At the distance d from the face, half the stretch is sqrt(d (R - d)) as far as '
           'stability goes and d mu_c as far as the cone goes; what is held more firmly turns '
           'back faster, which inclines the force out of the cone.'))
