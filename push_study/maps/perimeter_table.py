"""Tolerances of all places round the perimeter, for several objects, robots or speeds."""

from typing import Any, NamedTuple

import numpy as np
from push_model.contact import contact_point
from push_study.framework.study import Finding, Outcome, Parameter
from push_study.maps.perimeter import borders, places
from push_study.maps.tolerance_push import TurnedPush

PARAMETERS = (Parameter('places', '', 'number of places round the perimeter, about'),
              Parameter('distance', 'm', 'how far the object is pushed, at least'),
              Parameter('duration', 's', 'how long it is pushed, at least'),
              Parameter('accuracy', 'rad', 'accuracy of the turns; a stable place bears as much'))
ANGLES = ('rho', 'clockwise', 'counter', 'closed_clockwise', 'closed_counter', 'rule')
FINE = 2000


class Panel(NamedTuple):
    """
    One object and robot; the panels of a map differ in mass centre, robot and speed only.

    :param title: in a few words.
    :param keys: dict of column names to the values that tell the panel's rows from others.
    :param object: the ``PushedObject``.
    :param robot_radius: [m].
    :param speed: of the push [m/s].
    """

    title: str
    keys: dict
    object: Any
    robot_radius: float
    speed: float

    def rows(self, table):
        """
        Select the rows of this panel.

        :param table: with the keys as columns.
        :return: array of bool.
        """
        return np.all([np.equal(table[name], value) for name, value in self.keys.items()], axis=0)


def compute(panels, values, batch):
    """
    Find the tolerance of every place of every panel.

    :param panels: list of ``Panel``.
    :param values: ``Values`` with ``PARAMETERS``.
    :param batch: of the study.
    :return: ``Outcome``: tables ``map``, ``borders`` (of the closed form) and ``shares``.
    """
    spots = [(panel, place) for panel in panels for place in places(panel.object, values.places)]
    push = TurnedPush(panels[0].object, values.distance, values.duration, values.accuracy)
    records = batch(push, [_job(panel, place.contact) for panel, place in spots])
    table = _keys(panels, [panel for panel, _ in spots])
    points = [contact_point(panel.object, place.contact) for panel, place in spots]
    table.update(_points(points), along_m=[place.along for _, place in spots],
                 length_m=np.array([place.length for _, place in spots]),
                 face=[place.contact.index for _, place in spots])
    table.update((f'{name}_rad', np.array([record[name] for record in records]))
                 for name in ANGLES)
    for kind in ('', 'closed_'):
        table[f'{kind}tolerance_rad'] = np.minimum(table[f'{kind}clockwise_rad'],
                                                   table[f'{kind}counter_rad'])
    found = [borders(panel.object, panel.robot_radius, FINE) for panel in panels]
    edges = [(panel, point) for panel, (_, points) in zip(panels, found) for point in points]
    shares = {**_keys(panels, panels),
              'stable_share': [_share(table, panel.rows(table)) for panel in panels],
              'closed_stable_share': [share for share, _ in found]}
    tables = {'map': table, 'shares': shares,
              'borders': {**_keys(panels, [panel for panel, _ in edges]),
                          **_points([point for _, point in edges])}}
    return Outcome(tables, _findings(tables))


def stable_length(table, rows):
    """
    Length of the stable places among some [m].

    :param table: ``map`` of the outcome.
    :param rows: array of bool.
    """
    return float(table['length_m'][rows & (table['tolerance_rad'] > 0.0)].sum())


def _findings(tables):
    table, shares = tables['map'], tables['shares']['stable_share']
    ours, closed = table['tolerance_rad'], table['closed_tolerance_rad']
    differ = (ours > 0.0) != (closed > 0.0)
    return {
        'first': Finding(shares[0], '', 'stable share of the perimeter, first panel'),
        'last': Finding(shares[-1], '', 'stable share of the perimeter, last panel'),
        'difference': Finding(float(abs(ours - closed).max()), 'rad',
                              'largest difference of a tolerance, plant and closed form'),
        'slide': Finding(float((table['rule_rad'] - closed).max()), 'rad',
                         'most by which a cone for rho promises too much, closed form'),
        'verdicts': Finding(float(differ.sum()), '',
                            'places that are stable in one of plant and closed form only'),
        'doubt': Finding(float(np.maximum(ours, closed)[differ].max(initial=0.0)), 'rad',
                         'largest tolerance of these places')}


def _share(table, rows):
    return stable_length(table, rows) / float(table['length_m'][rows].sum())


def _keys(panels, chosen):
    return {name: [panel.keys[name] for panel in chosen] for name in panels[0].keys}


def _points(points):
    points = np.reshape(points, (-1, 2))
    return {'x_m': points[:, 0], 'y_m': points[:, 1]}


def _job(panel, contact):
    return {'kind': contact.kind, 'index': contact.index, 'offset': contact.offset,
            'robot_radius': panel.robot_radius, 'speed': panel.speed,
            'center_of_mass': list(panel.object.center_of_mass)}
