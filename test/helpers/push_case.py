"""Pushes in closed loop, in process: nominal and true values, a plan, plant and controller."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_control.steered.controller import Controller
from push_control.steered.path.path import flat_output_pose
from push_model.dubins import dubins_paths
from push_model.geometry import Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.quasi_static import vehicle
from push_model.signals import Odometry
from push_model.trajectory import COLUMNS, PushTrajectory
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings

FINAL_STRAIGHT = 0.4
GOOD_POSITION, GOOD_HEADING = 0.02, math.radians(3.0)
SPACING = 0.02
# Fractions of the friction cone, and of the nominal friction, that plans use.
PLANNED_CONE, PLANNED_FRICTION = 0.65, 0.8
SENSORS = SensorSettings(pose_rate=20.0, pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                         pose_latency=0.08, pose_drop_probability=0.05,
                         odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02)


class Case(NamedTuple):
    """One push: nominal and true object, plan, and where the robot really stands at the start."""

    nominal: PushedObject
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
    """Make a square box on four feet; ``friction`` is one coefficient per foot."""
    h = 0.5 * side
    corners = ((h, h), (-h, h), (-h, -h), (h, -h))
    return PushedObject(
        mass=mass, inertia=mass * side ** 2 / 6.0,
        supports=tuple(Support(0.9 * x, 0.9 * y, mu) for (x, y), mu in zip(corners, friction)),
        outline=corners, contact_friction_coefficient=contact_friction)


def random_case(seed, drive='differential'):
    """Draw a case whose nominal values are as wrong as the controller must tolerate."""
    rng = np.random.default_rng(seed)
    side, mass, friction = rng.uniform(0.3, 0.6), rng.uniform(0.5, 10.0), rng.uniform(0.2, 0.6)
    nominal = box(side, mass, [friction] * 4)
    feet = friction * rng.uniform(0.7, 1.3) * rng.uniform(0.6, 1.4, 4)
    true = dataclasses.replace(
        box(side, mass * rng.uniform(0.7, 1.3), feet), contact_friction_coefficient=0.4,
        inertia=nominal.inertia * rng.uniform(0.7, 1.3))
    robot = RoundRobot(radius=0.17, drive=drive)
    distance = rng.uniform(1.0, 3.0)
    bearing = math.radians(rng.uniform(-60.0, 60.0))
    rotation = math.radians(rng.uniform(-90.0, 90.0))
    goal = Pose(distance * math.cos(bearing), distance * math.sin(bearing), rotation)
    target = vertex_plan(nominal, robot, goal, rng.uniform(0.1, 0.25))
    # The robot stands a little further round the contact, turned, and 2 mm off the object.
    angle_error, heading_error = rng.normal(0.0, math.radians(1.5), 2)
    x, y, phi = target.robot_poses[0]
    c_x, c_y = target.contact_poses[0, :2]
    x, y = Pose(c_x, c_y, angle_error).transform((x - c_x, y - c_y))
    radius = math.hypot(x - c_x, y - c_y)
    x, y = c_x + (x - c_x) * (1 + 2e-3 / radius), c_y + (y - c_y) * (1 + 2e-3 / radius)
    return Case(nominal, true, robot, target, Pose(x, y, phi + angle_error + heading_error))


def vertex_plan(obj, robot, goal, speed, start=Pose(0.0, 0.0, 0.0), vertices=None):
    """Plan a push of a differential drive at the best vertex, along a Dubins path of z."""
    cone = PLANNED_CONE * math.atan(PLANNED_FRICTION * obj.contact_friction_coefficient)
    candidates = []
    for index in vertices or range(len(obj.outline)):
        pushed = vehicle(obj, obj.outline[index])
        local = flat_output_pose(pushed)
        begin, end = start @ local, goal @ local @ Pose(-FINAL_STRAIGHT, 0.0, 0.0)
        for offset in (0.0, 0.5 * cone, -0.5 * cone, 0.9 * cone, -0.9 * cone):
            length = pushed.arm + robot.radius
            left, right = (length / max(cone + side * offset, 0.02) for side in (1.0, -1.0))
            path = dubins_paths(begin, end, left, right)[0]
            candidates.append((path.length, index, offset, path))
    _, index, offset, path = min(candidates, key=lambda candidate: candidate[0])
    return follow_path(obj, robot, obj.outline[index], offset, path, speed)


def follow_path(obj, robot, point, heading_offset, path, speed):
    """Integrate the rolling contact at a vertex along a path of z, by small steps."""
    pushed = vehicle(obj, point)
    to_object = flat_output_pose(pushed).inverse()
    length = path.length + FINAL_STRAIGHT
    count = max(2, math.ceil(length / SPACING))
    step = length / count
    gamma, time, rows = None, 0.0, []
    for k in range(count + 1):
        z, curvature = path.at(min(k * step, length - 1e-9))
        steer = math.atan(pushed.wheelbase * curvature)
        if gamma is None:
            steady = -0.7 * (pushed.wheelbase + robot.radius) * curvature
            gamma = z.theta + min(0.15, max(-0.15, heading_offset + steady))
        chi = z.theta - steer
        rate = speed * math.cos(steer)
        forward = speed * math.cos(chi - gamma) / math.cos(heading_offset)
        yaw_rate = (speed * math.sin(chi - gamma)
                    + forward * math.sin(heading_offset)) / robot.radius
        pose = z @ to_object
        c_x, c_y = pose.transform(point)
        phi, v = gamma - heading_offset, (speed * math.cos(chi), speed * math.sin(chi))
        omega = rate * curvature
        arm = pose.rotate(point)
        rows.append((time, pose, (v[0] + omega * arm[1], v[1] - omega * arm[0], omega),
                     (c_x, c_y, gamma), (*v, yaw_rate),
                     (c_x - robot.radius * math.cos(gamma), c_y - robot.radius * math.sin(gamma),
                      phi), (forward * math.cos(phi), forward * math.sin(phi), yaw_rate)))
        gamma += yaw_rate * step / rate
        time += step / rate
    columns = [np.array(column) for column in zip(*rows)]
    columns[1][:, 2] = np.unwrap(columns[1][:, 2])
    return PushTrajectory(*columns)


def holonomic_plan(obj, robot, point, normal, goal, speed):
    """Plan a push of a holonomic base that turns with the object, along a Dubins path of z."""
    pushed = vehicle(obj, point)
    ahead = pushed.c_squared / pushed.arm
    zeta = math.remainder(normal - pushed.angle, 2.0 * math.pi)
    cone = PLANNED_CONE * math.atan(PLANNED_FRICTION * obj.contact_friction_coefficient)
    local = flat_output_pose(pushed)
    path = dubins_paths(local, goal @ local @ Pose(-FINAL_STRAIGHT, 0.0, 0.0),
                        ahead / (cone - zeta), ahead / (cone + zeta))[0]
    length = path.length + FINAL_STRAIGHT
    count = max(2, math.ceil(length / SPACING))
    time, rows, base_in_object = 0.0, [], Pose(*point, normal) @ Pose(-robot.radius, 0.0, 0.0)
    for k in range(count + 1):
        z, curvature = path.at(min(k * length / count, length - 1e-9))
        steer = math.atan(pushed.wheelbase * curvature)
        rate = speed * math.cos(steer)
        pose, omega = z @ local.inverse(), rate * curvature
        v = speed * math.cos(z.theta - steer), speed * math.sin(z.theta - steer)
        base, contact = pose @ base_in_object, pose @ Pose(*point, normal)
        rows.append((time, pose, _carried(v, omega, contact, pose), contact, (*v, omega), base,
                     _carried(v, omega, contact, base)))
        time += length / count / rate
    return PushTrajectory(*(np.array(column) for column in zip(*rows)))


def _carried(v, omega, contact, pose):
    """Velocity of a point that moves with the contact, and the common yaw rate."""
    return (v[0] - omega * (pose.y - contact.y), v[1] + omega * (pose.x - contact.x), omega)


def holonomic_case(seed, kind):
    """Make a push by a holonomic base of a random case."""
    case = random_case(seed, drive='holonomic')
    half = case.nominal.outline[0][0]
    nominal, true = case.nominal, case.true
    point, normal = {'face': ((-half, 0.1 * half), 0.0), 'round': ((-1.3 * half, 0.0), 0.0),
                     'vertex': ((-half, -half), math.pi / 4)}[kind]
    if kind == 'round':
        nominal, true = (dataclasses.replace(obj, outline=(), radius=1.3 * half)
                         for obj in (nominal, true))
    x, y, theta = case.target.object_poses[-1].tolist()
    goal = Pose(x, y, math.remainder(theta, 2 * math.pi))
    target = holonomic_plan(nominal, case.robot, point, normal, goal, 0.15)
    return Case(nominal, true, case.robot, target, Pose(*target.robot_poses[0].tolist()))


def with_friction(case, coefficient_of):
    """Give each true foot a coefficient of friction, as a function of its nominal ``Support``."""
    feet = tuple(dataclasses.replace(foot, friction_coefficient=coefficient_of(foot))
                 for foot in case.nominal.supports)
    return case._replace(true=dataclasses.replace(case.true, supports=feet))


def run(case, settings, seed=0, sensors=SENSORS, max_time=400.0, on_step=None):
    """
    Close the loop in process until the controller is done, failed, or out of time.

    ``on_step`` is called with plant, controller and observation after every command.
    """
    start = Pose(*case.target.object_poses[0])
    plant = Simulation(case.true, case.robot, start, case.robot_pose,
                       SimulationSettings(seed=seed), sensors)
    controller = Controller(case.nominal, case.robot, settings)
    odometry = pose = None
    before, commands = 0.0, []
    while plant.time < max_time:
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
        if on_step is not None:
            on_step(plant, controller, observation)
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
