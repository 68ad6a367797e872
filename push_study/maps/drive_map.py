"""What a drive can steer at each contact round the perimeter of an object."""

import dataclasses
import functools
import math

import numpy as np
from push_model.analysis.steering import steering_range
from push_model.contact import contact_point
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_study.framework.study import Finding, Outcome, Parameter, Study
from push_study.maps import drive_picture
from push_study.maps.perimeter import places

NAME = 'drive-map'
PARAMETERS = (
    Parameter('object', '', 'file of the object, with a digest of its content'),
    Parameter('robot', '', 'file of the robot, with a digest of its content'),
    Parameter('speed', 'm/s', 'speed of the contact'),
    Parameter('heading_offset', 'rad', 'from the heading of a differential drive to the contact '
              'normal, where the push starts'),
    Parameter('contacts', '', 'number of contacts round the perimeter, about, and the vertices'))
SEEN = ('A {drive} drive steers both ways at {{both_percent:.0f}} % of the contacts on {sides}, '
        'on a radius of {{side_radius:.2f}} m at best')
AT_VERTEX = ', and on {vertex_radius:.2f} m at a vertex'
WHY = {
    'differential': 'The arcs rolled off robot and object are equal, so that the place where the '
                    'push starts decides much of the turn; a face leaves nothing to choose where '
                    'the radius of the robot is the distance to the friction centre.',
    'holonomic': 'It holds the normal, so that only the friction cone bounds the direction of '
                 'the force; where the friction centre lies outside the cone, one side is lost.'}


@dataclasses.dataclass(frozen=True)
class Steer:
    """
    Job of a batch: how sharply a drive can steer from a contact.

    :param object: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param speed: of the contact [m/s].
    :param heading_offset: of a differential drive at the start [rad].
    """

    object: PushedObject
    robot: RoundRobot
    speed: float
    heading_offset: float

    def __call__(self, job):
        """
        Find the limits at one contact.

        :param job: fields of the ``Contact``.
        :return: dict of ``right`` and ``left`` [1/m], empty where no push holds.
        """
        found = steering_range(self.object, Contact(**job), self.robot, self.speed,
                               self.heading_offset)
        return dict(zip(('right', 'left'), (push.curvature for push in found or ())))


def study_of(object_name, obj, robot_name, robot):
    """
    Make the study of an object and a robot.

    :param object_name: of the object.
    :param obj: the ``PushedObject``.
    :param robot_name: of the robot.
    :param robot: the ``RoundRobot``.
    :return: ``Study``; its figure is named after both.
    """
    seen = SEEN.format(drive=robot.drive, sides='faces' if obj.outline else 'the rim')
    return Study(f'{NAME}-{object_name}-{robot_name}',
                 f'What a {robot.drive} drive can steer, contact by contact', PARAMETERS,
                 functools.partial(compute, obj, robot),
                 functools.partial(drive_picture.draw, obj),
                 seen + (AT_VERTEX if obj.outline else '') + '.', WHY[robot.drive], (8.8, 4.8))


def contacts(obj, count):
    """
    List contacts round an object.

    :param obj: the ``PushedObject``.
    :param count: of those on faces, about.
    :return: list of (``Contact``, way along the outline from vertex 0 [m]).
    """
    found = [(place.contact, place.along) for place in places(obj, count)]
    begin = 0.0
    for index, (x, y) in enumerate(obj.outline):
        found.append((Contact('vertex', index), begin))
        next_x, next_y = obj.outline[(index + 1) % len(obj.outline)]
        begin += math.hypot(next_x - x, next_y - y)
    return sorted(found, key=lambda pair: pair[1])


def compute(obj, robot, values, batch):
    """
    Find the limits of every contact.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param values: ``Values``.
    :param batch: of the study.
    :return: ``Outcome``.
    :raises ValueError: for a speed that is out of the robot's reach.
    """
    if not 0.0 < values.speed <= robot.max_speed:
        raise ValueError(f'speed: got {values.speed:g}, expected above 0 and at most '
                         f'{robot.max_speed:g}, the limit of the robot [m/s]')
    spots = contacts(obj, values.contacts)
    records = batch(Steer(obj, robot, values.speed, values.heading_offset),
                    [dataclasses.asdict(contact) for contact, _ in spots])
    right, left = (np.array([record.get(side, math.nan) for record in records])
                   for side in ('right', 'left'))
    points = np.array([contact_point(obj, contact) for contact, _ in spots])
    sharpest = np.fmax(np.abs(right), np.abs(left))
    table = {'kind': [contact.kind for contact, _ in spots],
             'index': [contact.index for contact, _ in spots],
             'offset_m' if obj.outline else 'offset_rad': [one.offset for one, _ in spots],
             'along_m': np.array([along for _, along in spots]), 'x_m': points[:, 0],
             'y_m': points[:, 1], 'right_per_m': right, 'left_per_m': left,
             'smallest_radius_m': 1.0 / np.where(sharpest > 0.0, sharpest, math.nan)}
    return Outcome({'contacts': table}, _findings(table))


def _findings(table):
    corner = np.equal(table['kind'], 'vertex')
    # As sharp as to either side; below 0 where it turns to one side only.
    both = np.nan_to_num(np.fmin(table['left_per_m'], -table['right_per_m']), nan=-1.0)
    one_sided = ~np.isnan(table['left_per_m']) & (both <= 0.0)
    findings = {
        'both_percent': Finding(100.0 * float(np.mean(both[~corner] > 0.0)), '%',
                                'contacts between vertices where it steers both ways'),
        'one_percent': Finding(100.0 * float(np.mean(one_sided[~corner])), '%',
                               'contacts between vertices where it turns one way only'),
        'side_radius': Finding(_radius(both[~corner]), 'm',
                               'smallest radius to either side, between vertices')}
    if corner.any():
        findings['vertex_radius'] = Finding(_radius(both[corner]), 'm',
                                            'smallest radius to either side, at a vertex')
    return findings


def _radius(both):
    best = both.max(initial=0.0)
    return 1.0 / float(best) if best > 0.0 else math.inf
