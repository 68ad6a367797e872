"""
Tolerances of all locations round the perimeter, for several objects, robots or speeds.

A location is stable where its tolerance, the rotation to the weaker side from which the object
returns, is above 0. Rows of the table ``map`` are locations, panel after panel.
"""

from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_model.contact import contact_point
from push_model.parameters import Contact, PushedObject
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Table
from studies.maps.perimeter import (
    Borders, perimeter_locations, PerimeterLocation, Point, stable_borders,
)
from studies.maps.tolerance import TolerancePush

PARAMETERS = (Parameter('locations', '', 'approximate number of locations round the perimeter'),
              Parameter('distance', 'm', 'how far the object is pushed, at least'),
              Parameter('duration', 's', 'how long it is pushed, at least'),
              Parameter('accuracy', 'rad', 'accuracy of the rotations; a stable location returns '
                        'from as much'))
ANGLES = ('rho', 'clockwise', 'counter', 'closed_clockwise', 'closed_counter', 'cone_rule')
# Chosen: locations at which the closed form is evaluated, for borders to a thousandth.
FINE_LOCATIONS = 2000

Rows = NDArray[np.bool_]


class Panel(NamedTuple):
    """
    One object and robot; the panels of a map differ in mass centre, robot and speed only.

    :param title: in a few words.
    :param keys: column name -> value that distinguishes the panel's rows from others.
    :param object: the pushed object.
    :param robot_radius: [m].
    :param speed: of the push [m/s].
    """

    title: str
    keys: dict[str, float]
    object: PushedObject
    robot_radius: float
    speed: float

    def rows(self, table: Table) -> Rows:
        """
        Select the rows of this panel.

        :param table: with the keys as columns, n rows.
        :return: shape (n,).
        """
        return np.all([np.equal(table[name], value) for name, value in self.keys.items()], axis=0)


def compute(panels: Sequence[Panel], values: Values, run_jobs: RunJobs) -> Outcome:
    """
    Find the tolerance of every location of every panel.

    :param panels: of the map.
    :param values: with the parameters ``PARAMETERS``.
    :param run_jobs: of the study.
    :return: outcome with the tables ``map``, ``fractions`` and ``borders`` (of the closed form).
    """
    table = _location_table(panels, values, run_jobs)
    borders = [stable_borders(panel.object, panel.robot_radius, FINE_LOCATIONS)
               for panel in panels]
    tables = {'map': table, 'fractions': _fraction_table(panels, table, borders),
              'borders': _border_table(panels, borders)}
    return Outcome(tables, _findings(tables))


def _location_table(panels: Sequence[Panel], values: Values, run_jobs: RunJobs) -> Table:
    """Find place and tolerance of every location: the table ``map``."""
    owners: list[Panel] = []
    locations: list[PerimeterLocation] = []
    for panel in panels:
        panel_locations = perimeter_locations(panel.object, int(values.locations))
        owners += [panel] * len(panel_locations)
        locations += panel_locations
    contacts = [location.contact for location in locations]
    push = TolerancePush(panels[0].object, values.distance, values.duration, values.accuracy)
    records = run_jobs(push, list(map(_job, owners, contacts)))
    table: Table = {
        **_key_columns(panels, owners),
        **_point_columns([contact_point(panel.object, contact)
                          for panel, contact in zip(owners, contacts)]),
        'along_m': [location.s for location in locations],
        'length_m': np.array([location.length for location in locations]),
        'face': [contact.index for contact in contacts]}
    for name in ANGLES:
        table[f'{name}_rad'] = np.array([record[name] for record in records])
    for form in ('', 'closed_'):
        table[f'{form}tolerance_rad'] = np.minimum(table[f'{form}clockwise_rad'],
                                                   table[f'{form}counter_rad'])
    return table


def _fraction_table(panels: Sequence[Panel], table: Table, borders: Sequence[Borders]) -> Table:
    """Find which fraction of each perimeter is stable."""
    return {**_key_columns(panels, panels),
            'stable_fraction': [_stable_fraction(table, panel.rows(table)) for panel in panels],
            'closed_stable_fraction': [border.stable_fraction for border in borders]}


def _border_table(panels: Sequence[Panel], borders: Sequence[Borders]) -> Table:
    """List the points at which stable regions end, by the closed form."""
    owners: list[Panel] = []
    points: list[Point] = []
    for panel, border in zip(panels, borders):
        owners += [panel] * len(border.points)
        points += border.points
    return {**_key_columns(panels, owners), **_point_columns(points)}


def stable_length(table: Table, rows: Rows) -> float:
    """
    Sum up the length of the stable locations among some.

    :param table: ``map`` of the outcome, n rows.
    :param rows: which count, shape (n,).
    :return: length [m].
    """
    return float(table['length_m'][rows & (table['tolerance_rad'] > 0.0)].sum())


def _findings(tables: dict[str, Table]) -> dict[str, Finding]:
    table, fractions = tables['map'], tables['fractions']['stable_fraction']
    simulated, closed = table['tolerance_rad'], table['closed_tolerance_rad']
    disagree = (simulated > 0.0) != (closed > 0.0)
    return {
        'first': Finding(fractions[0], '', 'stable fraction of the perimeter, first panel'),
        'last': Finding(fractions[-1], '', 'stable fraction of the perimeter, last panel'),
        'difference': Finding(float(abs(simulated - closed).max()), 'rad', 'largest difference '
                              'of a tolerance between simulation and closed form'),
        'overestimate': Finding(float((table['cone_rule_rad'] - closed).max()), 'rad',
                                'largest overestimate by a cone for rho, closed form'),
        'disagreements': Finding(float(disagree.sum()), '', 'locations that are stable in one of '
                                 'simulation and closed form only'),
        'disagreement': Finding(float(np.maximum(simulated, closed)[disagree].max(initial=0.0)),
                                'rad', 'largest tolerance of these locations')}


def _stable_fraction(table: Table, rows: Rows) -> float:
    return stable_length(table, rows) / float(table['length_m'][rows].sum())


def _key_columns(panels: Sequence[Panel], of_rows: Sequence[Panel]) -> Table:
    """Make the columns that tell panels apart, from the panel of each row."""
    return {name: [panel.keys[name] for panel in of_rows] for name in panels[0].keys}


def _point_columns(points: Sequence[tuple[float, float]]) -> Table:
    array = np.reshape(points, (-1, 2))
    return {'x_m': array[:, 0], 'y_m': array[:, 1]}


def _job(panel: Panel, contact: Contact) -> dict[str, Any]:
    return {'kind': contact.kind, 'index': contact.index, 'offset': contact.offset,
            'robot_radius': panel.robot_radius, 'speed': panel.speed,
            'center_of_mass': list(panel.object.center_of_mass)}
