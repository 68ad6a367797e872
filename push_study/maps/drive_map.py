"""What a drive can steer at each contact round the perimeter of an object."""

import dataclasses
import functools
import math
from typing import Any, NamedTuple

import numpy as np
from push_model.analysis.steering import steering_range
from push_model.contact import contact_point
from push_model.geometry import FloatArray
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, Record, RunJobs, Study, Table
from push_study.maps import drive_map_figure
from push_study.maps.perimeter import perimeter_locations

NAME = 'drive-map'
PARAMETERS = (
    Parameter('object', '', 'name and digest of the object'),
    Parameter('robot', '', 'name and digest of the robot'),
    Parameter('speed', 'm/s', 'speed of the contact'),
    Parameter('heading_offset', 'rad', 'from the heading of a differential drive to the contact '
              'normal, where the push starts'),
    Parameter('contacts', '', 'approximate number of contacts round the perimeter, besides the '
              'vertices'))
# Fields of the robot and the object in single braces, findings in double ones.
OBSERVATION = ('A {drive} drive steers both ways at {{both_percent:.0f}} % of the contacts on '
               '{sides}, with a radius of {{side_radius:.2f}} m at best')
AT_VERTEX = ', and with {vertex_radius:.2f} m at a vertex'
EXPLANATIONS = {
    'differential': 'The arcs rolled on robot and object are equal, so that the contact where '
                    'the push starts largely determines the rotation; a face leaves no choice '
                    'where the radius of the robot equals the distance to the centre of '
                    'friction.',
    'holonomic': 'It holds the normal, so that only the friction cone bounds the direction of '
                 'the force; where the centre of friction lies outside the cone, one side is '
                 'lost.'}


@dataclasses.dataclass(frozen=True)
class SteeringLimits:
    """
    How sharply a drive can steer from a contact, as the function of a batch.

    :param object: the pushed object.
    :param robot: the robot.
    :param speed: of the contact [m/s].
    :param heading_offset: of a differential drive at the start [rad].
    """

    object: PushedObject
    robot: RoundRobot
    speed: float
    heading_offset: float

    def __call__(self, job: dict[str, Any]) -> Record:
        """
        Find the limits at one contact.

        :param job: fields of the contact.
        :return: curvatures ``right`` and ``left`` [1/m]; empty where no push holds.
        """
        limits = steering_range(self.object, Contact(**job), self.robot, self.speed,
                                self.heading_offset)
        if limits is None:
            return {}
        right, left = limits
        return {'right': right.curvature, 'left': left.curvature}


class PerimeterContact(NamedTuple):
    """
    A contact of the map.

    :param contact: the contact.
    :param s: arc length along the outline from vertex 0 [m].
    """

    contact: Contact
    s: float


def drive_study(object_name: str, obj: PushedObject, robot_name: str,
                robot: RoundRobot) -> Study:
    """
    Make the study of an object and a robot.

    :param object_name: of the object.
    :param obj: the object.
    :param robot_name: of the robot.
    :param robot: the robot.
    :return: study; its figure is named after both.
    """
    observation = OBSERVATION.format(drive=robot.drive,
                                     sides='faces' if obj.outline else 'the rim')
    if obj.outline:
        observation += AT_VERTEX
    return Study(f'{NAME}-{object_name}-{robot_name}',
                 f'What a {robot.drive} drive can steer, contact by contact', PARAMETERS,
                 functools.partial(_compute, obj, robot),
                 functools.partial(drive_map_figure.draw, obj), f'{observation}.',
                 EXPLANATIONS[robot.drive], (8.8, 4.8))


def perimeter_contacts(obj: PushedObject, count: int) -> list[PerimeterContact]:
    """
    List contacts round an object, by arc length.

    :param obj: the object.
    :param count: approximate number of those on faces.
    :return: contacts on faces or on the rim, and the vertices.
    """
    contacts = [PerimeterContact(location.contact, location.s)
                for location in perimeter_locations(obj, count)]
    begin = 0.0
    for index, (x, y) in enumerate(obj.outline):
        contacts.append(PerimeterContact(Contact('vertex', index), begin))
        next_x, next_y = obj.outline[(index + 1) % len(obj.outline)]
        begin += math.hypot(next_x - x, next_y - y)
    return sorted(contacts, key=lambda found: found.s)


def _compute(obj: PushedObject, robot: RoundRobot, values: Values, run_jobs: RunJobs) -> Outcome:
    """
    Find the limits of every contact.

    :raises ValueError: for a speed that the robot cannot reach.
    """
    if not 0.0 < values.speed <= robot.max_speed:
        raise ValueError(f'speed: got {values.speed:g}, expected above 0 and at most '
                         f'{robot.max_speed:g}, the limit of the robot [m/s]')
    found = perimeter_contacts(obj, int(values.contacts))
    contacts = [perimeter_contact.contact for perimeter_contact in found]
    records = run_jobs(SteeringLimits(obj, robot, values.speed, values.heading_offset),
                       [dataclasses.asdict(contact) for contact in contacts])
    right, left = (np.array([record.get(side, math.nan) for record in records])
                   for side in ('right', 'left'))
    points = np.array([contact_point(obj, contact) for contact in contacts])
    sharpest = np.fmax(np.abs(right), np.abs(left))
    table = {'kind': [contact.kind for contact in contacts],
             'index': [contact.index for contact in contacts],
             'offset_m' if obj.outline else 'offset_rad': [contact.offset
                                                           for contact in contacts],
             'along_m': np.array([perimeter_contact.s for perimeter_contact in found]),
             'x_m': points[:, 0], 'y_m': points[:, 1], 'right_per_m': right, 'left_per_m': left,
             'smallest_radius_m': 1.0 / np.where(sharpest > 0.0, sharpest, math.nan)}
    return Outcome({'contacts': table}, _findings(table))


def _findings(table: Table) -> dict[str, Finding]:
    at_vertex = np.equal(table['kind'], 'vertex')
    # Curvature to the weaker side; below 0 where it turns to one side only, or to none.
    to_both = np.nan_to_num(np.fmin(table['left_per_m'], -table['right_per_m']), nan=-1.0)
    one_sided = ~np.isnan(table['left_per_m']) & (to_both <= 0.0)
    findings = {
        'both_percent': Finding(100.0 * float(np.mean(to_both[~at_vertex] > 0.0)), '%',
                                'contacts between vertices where it steers both ways'),
        'one_percent': Finding(100.0 * float(np.mean(one_sided[~at_vertex])), '%',
                               'contacts between vertices where it steers one way only'),
        'side_radius': Finding(_smallest_radius(to_both[~at_vertex]), 'm',
                               'smallest radius to either side, between vertices')}
    if at_vertex.any():
        findings['vertex_radius'] = Finding(_smallest_radius(to_both[at_vertex]), 'm',
                                            'smallest radius to either side, at a vertex')
    return findings


def _smallest_radius(curvatures: FloatArray) -> float:
    sharpest = curvatures.max(initial=0.0)
    return 1.0 / float(sharpest) if sharpest > 0.0 else math.inf
