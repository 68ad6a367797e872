"""How far a pushed object may be rotated and still return, found in the contact simulation."""

import dataclasses
import math
from typing import Any

from push_model.contact import contact_point, find_contact, normal_range
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from studies.analysis.pushing_location import PushingLocation
from studies.analysis.rolling_limits import force_tolerances, rolled_contact
from studies.analysis.stability import equilibrium_at, tolerances
from studies.framework.study import Record
from studies.maps.perimeter import push_through_center

# Chosen: distance that the robot travels in an integration step [m].
STEP_DISTANCE = 2e-3
# Chosen: how often the contact is examined in a push; the object must be nearer to its
# equilibrium in the second half.
EXAMINATIONS = 12
# Chosen: less sliding, or a smaller gap, is rounding of the simulation [m].
SLIP_TOLERANCE = 2e-5


@dataclasses.dataclass(frozen=True)
class TolerancePush:
    """
    A push at constant velocity through F, of an object that a disturbance has rotated.

    Object and robot move on together; the object is rotated, rolled about the contact on the
    robot. It returns if the contact rolls on without sliding, separating or leaving its face, and
    if in the second half of the push the object stays nearer to its equilibrium than it began.

    A job is a dict with ``kind``, ``index`` and ``offset`` of the contact, ``robot_radius`` [m],
    ``speed`` [m/s] and ``center_of_mass`` (x, y) [m].

    :param object: the pushed object.
    :param distance: how far it is pushed, at least [m].
    :param duration: how long it is pushed, at least [s].
    :param accuracy: of the rotations, and the rotation from which a stable location returns
        [rad].
    """

    object: PushedObject
    distance: float
    duration: float
    accuracy: float

    def __call__(self, job: dict[str, Any]) -> Record:
        """
        Find the tolerances of one location.

        :param job: see above.
        :return: angles [rad]: ``rho``; ``clockwise`` and ``counter``, the rotations from which the
            object returns, 0 where it does not; ``closed_clockwise`` and ``closed_counter``, the
            same in closed form for a slow push; ``cone_rule``, the smaller one of them where the
            cone bounds rho instead of the force.
        """
        obj = dataclasses.replace(self.object, center_of_mass=tuple(job['center_of_mass']))
        contact = Contact(job['kind'], job['index'], job['offset'])
        location = push_through_center(obj, contact, job['robot_radius'])
        if abs(location.pushing_angle) >= 0.5 * math.pi:
            # F is not ahead of the contact: nothing can be pushed from there.
            return {'rho': location.pushing_angle, 'clockwise': 0.0, 'counter': 0.0,
                    'closed_clockwise': 0.0, 'closed_counter': 0.0, 'cone_rule': 0.0}
        by_cone = tolerances(location, equilibrium_at(location, 0.0),
                             obj.contact_friction_coefficient)
        clockwise, counter = force_tolerances(obj, contact, location)
        return {'rho': location.pushing_angle,
                'clockwise': self._tolerance(obj, contact, location, job['speed'], -1.0),
                'counter': self._tolerance(obj, contact, location, job['speed'], 1.0),
                'closed_clockwise': abs(clockwise.rotation),
                'closed_counter': abs(counter.rotation),
                'cone_rule': min(abs(tolerance.rotation) for tolerance in by_cone)}

    def _tolerance(self, obj: PushedObject, contact: Contact, location: PushingLocation,
                   speed: float, side: float) -> float:
        """Bisect the largest rotation to one side from which the object returns [rad]."""
        distance = max(self.distance, speed * self.duration)

        def comes_back(rotation: float) -> bool:
            return returns(obj, contact, location, speed, rotation=side * rotation,
                           distance=distance)

        low = self.accuracy
        end_of_face = location.rotation_range[1] if side > 0.0 else location.rotation_range[0]
        high = min(math.pi, side * end_of_face)
        if high <= low or not comes_back(low):
            return 0.0
        while high - low > self.accuracy:
            middle = 0.5 * (low + high)
            if comes_back(middle):
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)


def returns(obj: PushedObject, contact: Contact, location: PushingLocation, speed: float, *,
            rotation: float, distance: float) -> bool:
    """
    Push an object that is rotated, and decide whether it returns in rolling contact.

    :param obj: the pushed object.
    :param contact: where it is touched before it is rotated.
    :param location: the pushing location there.
    :param speed: of the robot [m/s].
    :param rotation: of the object [rad].
    :param distance: how far it is pushed [m].
    :return: whether it returns.
    """
    plant = _rotated_plant(obj, contact, location, speed, rotation)
    for index in range(EXAMINATIONS):
        plant.advance(distance / EXAMINATIONS / speed, Twist(speed, 0.0, 0.0))
        pose = plant.object_pose
        now = pose.theta + location.push_direction
        touched, _, gap = find_contact(obj, pose, plant.robot_pose, location.robot_radius)
        if (touched.kind, touched.index) != (contact.kind, contact.index) or gap > SLIP_TOLERANCE:
            return False
        slip = touched.offset - rolled_contact(obj, contact, location, now).offset
        if contact.kind == 'round':
            slip = obj.radius * wrap_angle(slip)
        is_second_half = 2 * index >= EXAMINATIONS
        if abs(slip) > SLIP_TOLERANCE or is_second_half and abs(now) >= abs(rotation):
            return False
    return True


def _rotated_plant(obj: PushedObject, contact: Contact, location: PushingLocation, speed: float,
                   rotation: float) -> Plant:
    """Simulate object and robot that move on together, the object rotated on the robot."""
    now = rolled_contact(obj, contact, location, rotation)
    pose = Pose(0.0, 0.0, rotation - location.push_direction)
    x, y = pose.transform(contact_point(obj, now))
    normal = pose.theta + normal_range(obj, now)[0]
    radius = location.robot_radius
    # Without lag, and strong enough to hold its velocity.
    robot = RoundRobot(radius, max_speed=speed, max_acceleration=100.0, time_constant=0.0)
    robot_pose = Pose(x - radius * math.cos(normal), y - radius * math.sin(normal), 0.0)
    plant = Plant(obj, robot, pose, robot_pose, STEP_DISTANCE / speed)
    along_x = Twist(speed, 0.0, 0.0)
    plant.set_velocities(object_twist=along_x, robot_twist=along_x)
    return plant
