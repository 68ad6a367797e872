"""Pushes of a simulated robot on a given course, and what an ensemble filter makes of them."""

import math
from typing import NamedTuple

from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.contact_hypotheses import ContactHypotheses
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.settings import ControlSettings
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings

CONTROL = ControlSettings()
ROBOT = RoundRobot(radius=0.17, drive='holonomic', max_speed=0.5, max_acceleration=3.0)
HOME, START = Pose(0.0, 0.0, 0.0), Pose(-0.42, 0.06, 0.0)
NOISE = OdometryNoise(scale=0.02, drift=0.02, walk=0.003, heading_walk=0.01)
NO_NOISE = OdometryNoise(0.0, 0.0, 0.0, 0.0)
SPEED = 0.25
# Waypoints of the true robot (x, y): a push at one face of a box at the origin, round its corner,
# and a push at the face to the right of it.
ONE_PUSH = ((-0.12, 0.06), (-0.30, 0.06))
TWO_PUSHES = (*ONE_PUSH, (-0.30, -0.55), (0.34, -0.60), (0.34, -0.15), (0.34, -0.40))


class Outcome(NamedTuple):
    """An ensemble after a run, and what is true."""

    ensemble: ContactHypotheses
    simulation: Simulation
    odometry: Odometry

    @property
    def error(self):
        """Estimated less true pose of the robot, shape (3,)."""
        return difference(self.ensemble.pose, self.simulation.truth.robot_pose)

    @property
    def object_error(self):
        """Estimated less true pose of the object, shape (3,)."""
        return difference(self.ensemble.object_pose, self.simulation.truth.object_pose)

    @property
    def odometry_error(self):
        """Pose by odometry alone less true pose of the robot, shape (3,)."""
        return difference(self.odometry.pose, self.simulation.truth.robot_pose)


def difference(estimate, truth):
    """Return one pose less another, in world axes."""
    return np.array((estimate[0] - truth[0], estimate[1] - truth[1],
                     wrap_angle(estimate[2] - truth[2])))


def mirrored(points):
    """Reflect waypoints in the x axis."""
    return tuple((x, -y) for x, y in points)


def drive(simulation, waypoints):
    """Drive a robot along waypoints by its true pose, and yield its measurements."""
    for point in (*waypoints, None):
        end = math.inf if point else simulation.time + 0.5
        while simulation.time < end:
            measured = simulation.next_measurement()
            yield measured
            if not isinstance(measured, Odometry):
                continue
            if point and math.dist(simulation.truth.robot_pose[:2], point) < 0.01:
                break
            simulation.command(_towards(simulation.truth.robot_pose, point))


def run(waypoints=ONE_PUSH, true=None, believed=None, sensors=SensorSettings(), noise=NOISE,
        seed=1, start=START, ensemble_seed=0, imperfections=DriveImperfections(),
        follow=ContactHypotheses):
    """
    Drive a robot along waypoints by its true pose, and let contact hypotheses watch.

    :param imperfections: of the robot's drive.
    :param follow: makes the filter from a ``PushEnsemble``.
    :return: ``Outcome``.
    """
    settings = SimulationSettings(seed=seed, drive=imperfections)
    simulation = Simulation(true or box(), ROBOT, HOME, start, settings, sensors)
    ensemble = follow(PushEnsemble(believed or box(), ROBOT, CONTROL, noise, ensemble_seed))
    odometry = None
    for measured in drive(simulation, waypoints):
        if isinstance(measured, Odometry):
            odometry = measured
            ensemble.predict(measured)
        else:
            ensemble.update(measured)
    return Outcome(ensemble, simulation, odometry)


def _towards(pose, point):
    """Command a constant speed towards a waypoint, slower on its last centimetres."""
    if point is None:
        return STOP
    x, y = pose.inverse().transform(point)
    away = math.hypot(x, y)
    speed = min(SPEED, 3.0 * away)
    return Twist(speed * x / away, speed * y / away, 0.0)
