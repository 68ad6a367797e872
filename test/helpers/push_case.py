"""Random pushes of a box at a corner: what is believed, what is true, a plan, a closed loop."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_control.observation import Observation
from push_control.path.path import flat_output_pose
from push_control.push.controller import Controller
from push_model.dubins import dubins_paths
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.quasi_static import vehicle
from push_model.signals import Odometry
from push_model.trajectory import COLUMNS, PushTrajectory
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings

RUN_IN = 0.4
GOOD_POSITION, GOOD_HEADING = 0.02, math.radians(3.0)
SPACING = 0.02
SENSORS = SensorSettings(pose_rate=20.0, pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                         pose_latency=0.08, pose_drop_probability=0.05,
                         odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02)


class Case(NamedTuple):
    """One push: belief, truth, plan, and where everything really stands at the start."""

    believed: PushedObject
    true: PushedObject
    robot: RoundRobot
    target: PushTrajectory
    robot_pose: Pose


class Outcome(NamedTuple):
    """How a push ended; errors are true ones [m, rad]."""

    status: object
    position_error: float
    heading_error: float
    time: float
    steps: int
    commands: list
    final: Pose


def box(side, mass, friction, contact_friction=0.5):
    """Square box on four feet; ``friction`` is one coefficient per foot."""
    h = 0.5 * side
    corners = ((h, h), (-h, h), (-h, -h), (h, -h))
    return PushedObject(
        mass=mass, inertia=mass * side ** 2 / 6.0,
        supports=tuple(Support(0.9 * x, 0.9 * y, mu) for (x, y), mu in zip(corners, friction)),
        outline=corners, contact_friction_coefficient=contact_friction)


def random_case(seed, drive='differential', mirrored=False):
    """Draw a case as wrong as the controller is meant to bear."""
    rng = np.random.default_rng(seed)
    side, mass, friction = rng.uniform(0.3, 0.6), rng.uniform(0.5, 10.0), rng.uniform(0.2, 0.6)
    believed = box(side, mass, [friction] * 4)
    feet = friction * rng.uniform(0.7, 1.3) * rng.uniform(0.6, 1.4, 4)
    true = dataclasses.replace(
        box(side, mass * rng.uniform(0.7, 1.3), feet), contact_friction_coefficient=0.4,
        inertia=believed.inertia * rng.uniform(0.7, 1.3))
    robot = RoundRobot(radius=0.17, drive=drive)
    distance, bearing, turn = (rng.uniform(1.0, 3.0), math.radians(rng.uniform(-60.0, 60.0)),
                               math.radians(rng.uniform(-90.0, 90.0)))
    goal = Pose(distance * math.cos(bearing), distance * math.sin(bearing), turn)
    target = vertex_plan(believed, robot, goal, rng.uniform(0.1, 0.25))
    turned, headed = rng.normal(0.0, math.radians(1.5), 2)
    x, y, phi = target.robot_poses[0]
    c_x, c_y = target.contact_poses[0, :2]
    x, y = Pose(c_x, c_y, turned).transform((x - c_x, y - c_y))
    away = math.hypot(x - c_x, y - c_y)
    x, y = c_x + (x - c_x) * (1 + 2e-3 / away), c_y + (y - c_y) * (1 + 2e-3 / away)
    return Case(believed, true, robot, target, Pose(x, y, phi + turned + headed))


def vertex_plan(obj, robot, goal, speed, start=Pose(0.0, 0.0, 0.0), vertices=None):
    """Quasi-static plan of a differential drive at the best vertex, along a Dubins path of z."""
    cone = 0.65 * math.atan(0.8 * obj.contact_friction_coefficient)
    options = []
    for index in vertices or range(len(obj.outline)):
        flat = vehicle(obj, obj.outline[index])
        for heading_offset in (0.0, 0.5 * cone, -0.5 * cone, 0.9 * cone, -0.9 * cone):
            length = flat.arm + robot.radius
            left, right = (length / max(cone + side * heading_offset, 0.02) for side in (1.0, -1.0))
            local = flat_output_pose(flat)
            path = dubins_paths(start @ local, goal @ local @ Pose(-RUN_IN, 0.0, 0.0), left, right)[0]
            options.append((path.length, index, heading_offset, path))
    _, index, heading_offset, path = min(options, key=lambda option: option[0])
    return follow_path(obj, robot, obj.outline[index], heading_offset, path, path.length + RUN_IN, speed)


def follow_path(obj, robot, point, heading_offset, path, length, speed):
    """Integrate the rolling contact at a vertex along a path of z, by small steps."""
    flat = vehicle(obj, point)
    away = flat_output_pose(flat).inverse()
    count = max(2, math.ceil(length / SPACING))
    step = length / count
    gamma, time, rows = None, 0.0, []
    for k in range(count + 1):
        z, curvature = path.at(min(k * step, length - 1e-9))
        steer = math.atan(flat.wheelbase * curvature)
        if gamma is None:
            bend = -0.7 * (flat.wheelbase + robot.radius) * curvature
            gamma = z.theta + min(0.15, max(-0.15, heading_offset + bend))
        chi = z.theta - steer
        rate = speed * math.cos(steer)
        forward = speed * math.cos(chi - gamma) / math.cos(heading_offset)
        turn = (speed * math.sin(chi - gamma) + forward * math.sin(heading_offset)) / robot.radius
        pose = z @ away
        c_x, c_y = pose.transform(point)
        phi, v = gamma - heading_offset, (speed * math.cos(chi), speed * math.sin(chi))
        omega = rate * curvature
        arm = pose.rotate(point)
        rows.append((time, pose, (v[0] + omega * arm[1], v[1] - omega * arm[0], omega),
                     (c_x, c_y, gamma), (*v, turn),
                     (c_x - robot.radius * math.cos(gamma), c_y - robot.radius * math.sin(gamma),
                      phi), (forward * math.cos(phi), forward * math.sin(phi), turn)))
        gamma += turn * step / rate
        time += step / rate
    columns = [np.array(column) for column in zip(*rows)]
    columns[1][:, 2] = np.unwrap(columns[1][:, 2])
    return PushTrajectory(*columns)


def held_plan(obj, robot, point, normal, goal, speed, start=Pose(0.0, 0.0, 0.0)):
    """Quasi-static plan of a holonomic base that turns with the object, along a Dubins path."""
    flat = vehicle(obj, point)
    ahead = flat.c_squared / flat.arm
    zeta = math.remainder(normal - flat.angle, 2.0 * math.pi)
    cone = 0.65 * math.atan(0.8 * obj.contact_friction_coefficient)
    local = flat_output_pose(flat)
    path = dubins_paths(start @ local, goal @ local @ Pose(-RUN_IN, 0.0, 0.0),
                        ahead / (cone - zeta), ahead / (cone + zeta))[0]
    length = path.length + RUN_IN
    count = max(2, math.ceil(length / SPACING))
    time, rows, place = 0.0, [], Pose(*point, normal) @ Pose(-robot.radius, 0.0, 0.0)
    for k in range(count + 1):
        z, curvature = path.at(min(k * length / count, length - 1e-9))
        steer = math.atan(flat.wheelbase * curvature)
        rate = speed * math.cos(steer)
        pose, omega = z @ local.inverse(), rate * curvature
        v = speed * math.cos(z.theta - steer), speed * math.sin(z.theta - steer)
        base, contact = pose @ place, pose @ Pose(*point, normal)
        rows.append((time, pose, _carried(v, omega, contact, pose), contact, (*v, omega), base,
                     _carried(v, omega, contact, base)))
        time += length / count / rate
    return PushTrajectory(*(np.array(column) for column in zip(*rows)))


def _carried(v, omega, contact, pose):
    """Velocity of a point that moves with the contact, and the common yaw rate."""
    return (v[0] - omega * (pose.y - contact.y), v[1] + omega * (pose.x - contact.x), omega)


def run(case, settings, seed=0, sensors=SENSORS, longest=400.0, watch=None):
    """Close the loop in process until the controller is done, failed, or out of time."""
    start = Pose(*case.target.object_poses[0])
    plant = Simulation(case.true, case.robot, start, case.robot_pose,
                       SimulationSettings(seed=seed), sensors)
    controller = Controller(case.believed, case.robot, settings)
    odometry = pose = None
    before, commands = 0.0, []
    while plant.time < longest:
        measured = plant.next_measurement()
        if isinstance(measured, Odometry):
            odometry = measured
        else:
            pose = measured
        if odometry is None:
            continue
        observation = Observation(plant.time, odometry, pose)
        command = controller.step(case.target, observation, plant.time - before)
        before = plant.time
        commands.append(command)
        plant.command(command)
        if watch is not None:
            watch(plant, controller, observation)
        if controller.status.phase.has_ended:
            break
    end = plant.time
    while plant.time < end + 1.0:
        plant.next_measurement()
        plant.command((0.0, 0.0, 0.0))
    final, goal = plant.truth.object_pose, case.target.object_poses[-1]
    return Outcome(controller.status, math.hypot(final.x - goal[0], final.y - goal[1]),
                   abs(wrap_angle(final.theta - goal[2])), end, len(commands), commands, final)


def mirrored_target(target):
    """Reflect everything in the x axis."""
    return PushTrajectory(times=target.times,
                          **{name: getattr(target, name) * (1.0, -1.0, -1.0) for name in COLUMNS})


def mirrored_object(obj):
    """Reflect the object in its x axis."""
    feet = tuple(Support(s.x, -s.y, s.friction_coefficient, s.load_fraction) for s in obj.supports)
    outline = tuple((x, -y) for x, y in reversed(obj.outline))
    return dataclasses.replace(obj, supports=feet, outline=outline)


def held_case(seed, kind):
    """Turn a random case into a push by a holonomic base."""
    case = random_case(seed, drive='holonomic')
    half = case.believed.outline[0][0]
    believed, true = case.believed, case.true
    point, normal = {'face': ((-half, 0.1 * half), 0.0), 'round': ((-1.3 * half, 0.0), 0.0),
                     'vertex': ((-half, -half), math.pi / 4)}[kind]
    if kind == 'round':
        believed, true = (dataclasses.replace(obj, outline=(), radius=1.3 * half)
                          for obj in (believed, true))
    x, y, theta = case.target.object_poses[-1].tolist()
    goal = Pose(x, y, math.remainder(theta, 2 * math.pi))
    target = held_plan(believed, case.robot, point, normal, goal, 0.15)
    return Case(believed, true, case.robot, target, Pose(*target.robot_poses[0].tolist()))
