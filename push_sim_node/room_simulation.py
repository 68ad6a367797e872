"""
Several objects in one simulation: one of them is pushed, the others stand.

Time, robot and odometry go on as another one comes to be pushed. Which one that is the caller
states, or it is the one that the robot is nearest to. What robot or pushed object bump into gives
way, and so does what that bumps into. Walls hold what gives way; what bumps into it there moves on
into it.
"""

from collections.abc import Callable, Mapping
import functools
import math

import numpy as np
from push_dynamics.wall_grid import MARGIN, wall_grid
from push_dynamics.walls import Wall, wall_rows
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose
from push_sim_node.bumped_object import (
    displaced_pose, do_overlap, held_pose, outer_radius, PlacedDisc, PlacedObject)
from push_sim_node.plant import Plant
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation

# Sides of the walls round a disc; chosen: they are within 1 % of its radius.
DISC_SIDES = 16
# Gap between robot and the object that can move above which another one may be that [m]; chosen:
# nothing touches within one measurement.
FREE_GAP = 0.02
# Speed below which an object is at rest [m/s], and yaw rate [rad/s]; chosen as in the closed loop.
REST_SPEED, REST_YAW_RATE = 1e-4, 1e-3
# Number of the random stream of poses of objects that stand, beside those of a spawned seed.
STANDING_STREAM = 2


def outline_walls(item: PlacedObject) -> list[Wall]:
    """List the ``Wall`` along each side of the outline of an object."""
    outline = item.obj.outline
    if not outline:
        angles = np.arange(DISC_SIDES) * (2.0 * math.pi / DISC_SIDES)
        outline = tuple((item.obj.radius * math.cos(angle), item.obj.radius * math.sin(angle))
                        for angle in angles.tolist())
    points = [item.pose.transform(corner) for corner in outline]
    return [Wall(*start, *end) for start, end in zip(points, points[1:] + points[:1])]


class RoomSimulation:
    """
    Several objects, of which one is pushed.

    ``simulation``: the ``Simulation``, whose object is that one. ``pushed``: its name.

    :param objects: ``PlacedObject`` of each, by name; the first can be pushed at first.
    :param robot: the true ``RoundRobot``.
    :param robot_pose: its ``Pose`` at time 0.
    :param settings: ``SimulationSettings``.
    :param sensors: ``SensorSettings``.
    :param interpret: as of ``Simulation``.
    :param plant_type: as of ``Simulation``.
    """

    def __init__(self, objects: Mapping[str, PlacedObject], robot: RoundRobot, robot_pose: Pose,
                 settings: SimulationSettings = SimulationSettings(),
                 sensors: SensorSettings = SensorSettings(), *,
                 interpret: bool = False, plant_type: Callable[..., Plant] = Plant) -> None:
        self._starts = dict(objects)
        self._settings = settings
        self._walls = wall_grid(wall_rows(settings.walls), MARGIN + max(
            (outer_radius(item.obj) for item in objects.values()), default=0.0))
        self._make_simulation = functools.partial(
            Simulation, robot=robot, robot_pose=robot_pose, sensors=sensors, interpret=interpret,
            plant_type=plant_type, after_motion=self._displace_bumped)
        self.reset()

    def reset(self) -> None:
        """Restart at time 0, with the same random errors, in another ``simulation``."""
        self._objects = dict(self._starts)
        self._noise = np.random.default_rng((self._settings.seed, STANDING_STREAM))
        self.pushed = next(iter(self._objects))
        obj, pose = self._objects[self.pushed]
        self.simulation = self._make_simulation(
            obj, object_pose=pose, settings=self._settings)
        self.simulation.show_standing(self._walls_beside(self.pushed))

    @property
    def poses(self) -> dict[str, Pose]:
        """True ``Pose`` of each object by name, with a wrapped angle."""
        self._note_pose()
        return {name: item.pose for name, item in self._objects.items()}

    @property
    def robot_pose(self) -> Pose:
        """True ``Pose`` of the robot, with a wrapped angle."""
        return _wrapped(self.simulation.plant.robot_pose)

    def turn_to(self, name: str) -> None:
        """
        Let another object be the one that can be pushed; the one of before stands.

        :param name: of the object.
        """
        self._note_pose()
        self.pushed = name
        self.simulation.turn_to(*self._objects[name])
        self.simulation.show_standing(self._walls_beside(name))

    def displace(self, name: str, pose: Pose) -> None:
        """
        Move an object, as a person would.

        :param pose: its ``Pose`` afterwards; nothing else is there.
        """
        if name == self.pushed:
            self.simulation.plant.set_object_pose(pose)
            return
        self._objects[name] = self._objects[name]._replace(pose=_wrapped(pose))
        self.simulation.show_standing(self._walls_beside(self.pushed))

    def turn_to_nearest(self) -> bool:
        """
        Let the object be pushed that the robot is nearest to; tell whether it is another one.

        Until the one of before is at rest, and the robot off it, it stays that.
        """
        twist = self.simulation.plant.object_twist
        is_at_rest = (math.hypot(twist.v_x, twist.v_y) < REST_SPEED
                      and abs(twist.omega) < REST_YAW_RATE)
        if not is_at_rest or self._gap(self.pushed) < FREE_GAP:
            return False
        nearest = min(self._objects, key=self._gap)
        if nearest == self.pushed:
            return False
        self.turn_to(nearest)
        return True

    def measure_standing(self, time: float) -> dict[str, ObjectPose]:
        """
        Measure the objects that are not pushed, by name; without losses.

        :param time: stamp of the measurement [s].
        """
        sensors = self.simulation.sensors
        measured: dict[str, ObjectPose] = {}
        for name, item in self._objects.items():
            if name != self.pushed:
                e_x, e_y, e_theta = self._noise.standard_normal(3).tolist()
                measured[name] = ObjectPose(time, Pose(
                    item.pose.x + sensors.pose_noise * e_x, item.pose.y + sensors.pose_noise * e_y,
                    wrap_angle(item.pose.theta + sensors.pose_heading_noise * e_theta)))
        return measured

    def _note_pose(self) -> None:
        """Take note of where the pushed object is."""
        item = self._objects[self.pushed]
        pose = _wrapped(self.simulation.plant.object_pose)
        self._objects[self.pushed] = item._replace(pose=pose)

    def _displace_bumped(self) -> bool:
        """
        Move the objects that robot and pushed object have moved into, one after the other.

        :return: whether the robot is in one.
        """
        plant, others = self.simulation.plant, set(self._objects) - {self.pushed}
        x, y, _ = plant.robot_pose
        robot = PlacedDisc(x, y, self.simulation.robot.radius)
        is_robot_touching = any(do_overlap(self._objects[name], robot) for name in others)
        bodies = [robot, PlacedObject(self.simulation.obj, plant.object_pose)]
        while bodies:
            body = bodies.pop()
            for name in sorted(others):
                item = self._objects[name]
                pose = displaced_pose(item, body)
                if pose != item.pose:
                    held = held_pose(item._replace(pose=pose), self._walls)
                    self._objects[name] = item._replace(pose=_wrapped(held))
                    bodies.append(self._objects[name])
                    others.remove(name)
        if len(others) < len(self._objects) - 1:
            self.simulation.show_standing(self._walls_beside(self.pushed))
        return is_robot_touching

    def _walls_beside(self, name: str) -> tuple[Wall, ...]:
        """List the outlines of all objects but one."""
        return tuple(wall for other, item in self._objects.items() if other != name
                     for wall in outline_walls(item))

    def _gap(self, name: str) -> float:
        """Measure the gap between the robot and an object [m]."""
        plant, item = self.simulation.plant, self._objects[name]
        pose = plant.object_pose if name == self.pushed else item.pose
        return find_contact(item.obj, pose, plant.robot_pose[:2],
                            self.simulation.robot.radius).gap


def _wrapped(pose: Pose) -> Pose:
    return Pose(pose.x, pose.y, wrap_angle(pose.theta))
