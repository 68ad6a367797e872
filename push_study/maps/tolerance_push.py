"""How far a pushed object may be turned and still return, found by pushing it in the plant."""

import dataclasses
import math

from push_model.analysis.rolling_limits import force_tolerances, rolled_contact
from push_model.analysis.stability import equilibrium_at, tolerances
from push_model.contact import contact_point, find_contact, normal_range
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_study.maps.perimeter import push_through_center

WAY = 2e-3
LOOKS = 12
SLIP = 2e-5


@dataclasses.dataclass(frozen=True)
class TurnedPush:
    """
    A push at constant velocity through F, of an object that a disturbance has turned.

    Object and robot move on together; the object is turned, rolled about the contact on the
    robot. It returns if the contact rolls on without sliding, parting or leaving its face, and
    if in the second half of the push the object stays nearer to its equilibrium than it began.

    A job is a dict with ``kind``, ``index`` and ``offset`` of the contact, ``robot_radius`` [m],
    ``speed`` [m/s] and ``center_of_mass`` (x, y) [m].

    :param object: the ``PushedObject``.
    :param distance: how far it is pushed, at least [m].
    :param duration: how long it is pushed, at least [s].
    :param accuracy: of the turns, and the turn from which a stable place returns [rad].
    """

    object: PushedObject
    distance: float
    duration: float
    accuracy: float

    def __call__(self, job):
        """
        Find the tolerances of one place.

        :param job: the dict.
        :return: dict of angles [rad]: ``rho``; ``clockwise`` and ``counter``, the turns that the
            object bears, 0 where it does not return; ``closed_clockwise`` and ``closed_counter``,
            the same in closed form for a slow push; ``rule``, the smaller one of them where the
            cone bounds rho in place of the force.
        """
        obj = dataclasses.replace(self.object, center_of_mass=tuple(job['center_of_mass']))
        contact = Contact(job['kind'], job['index'], job['offset'])
        location = push_through_center(obj, contact, job['robot_radius'])
        record = {'rho': location.pushing_angle}
        record.update(dict.fromkeys(('clockwise', 'counter', 'closed_clockwise',
                                     'closed_counter', 'rule'), 0.0))
        if abs(location.pushing_angle) >= 0.5 * math.pi:
            return record
        rule = tolerances(location, equilibrium_at(location, 0.0),
                          obj.contact_friction_coefficient)
        closed = force_tolerances(obj, contact, location)
        record.update(zip(('closed_clockwise', 'closed_counter'),
                          (abs(one.rotation) for one in closed)))
        record['rule'] = min(abs(one.rotation) for one in rule)
        for name, side in (('clockwise', -1.0), ('counter', 1.0)):
            record[name] = self._tolerance(obj, contact, location, job['speed'], side)
        return record

    def _tolerance(self, obj, contact, location, speed, side):
        distance = max(self.distance, speed * self.duration)

        def comes_back(turn):
            return returns(obj, contact, location, speed, side * turn, distance)

        low = self.accuracy
        high = min(math.pi, side * location.rotation_range[side > 0.0])
        if high <= low or not comes_back(low):
            return 0.0
        while high - low > self.accuracy:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if comes_back(middle) else (low, middle)
        return 0.5 * (low + high)


def returns(obj, contact, location, speed, turn, distance):
    """
    Push an object that is turned, and tell whether it returns in rolling contact.

    :param obj: the ``PushedObject``.
    :param contact: where it is touched before it is turned.
    :param location: the ``PushingLocation`` there.
    :param speed: of the robot [m/s].
    :param turn: of the object [rad].
    :param distance: how far it is pushed [m].
    """
    plant = _start(obj, contact, location, speed, turn)
    for look in range(LOOKS):
        plant.advance(distance / LOOKS / speed, Twist(speed, 0.0, 0.0))
        pose = plant.object_pose
        now = pose.theta + location.push_direction
        touched, _, gap = find_contact(obj, pose, plant.robot_pose, location.robot_radius)
        if (touched.kind, touched.index) != (contact.kind, contact.index) or gap > SLIP:
            return False
        slip = touched.offset - rolled_contact(obj, contact, location, now).offset
        slip = obj.radius * wrap_angle(slip) if contact.kind == 'round' else slip
        if abs(slip) > SLIP or 2 * look >= LOOKS and abs(now) >= abs(turn):
            return False
    return True


def _start(obj, contact, location, speed, turn):
    now = rolled_contact(obj, contact, location, turn)
    pose = Pose(0.0, 0.0, turn - location.push_direction)
    x, y = pose.transform(contact_point(obj, now))
    normal = pose.theta + normal_range(obj, now)[0]
    radius = location.robot_radius
    robot = RoundRobot(radius, max_speed=speed, max_acceleration=100.0, time_constant=0.0)
    plant = Plant(obj, robot, pose, Pose(x - radius * math.cos(normal),
                                         y - radius * math.sin(normal), 0.0), WAY / speed)
    along_x = Twist(speed, 0.0, 0.0)
    plant.set_velocities(object_twist=along_x, robot_twist=along_x)
    return plant
