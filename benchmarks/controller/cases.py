"""
Random pushes that are as wrong as a controller should bear, as scenarios.

A case is drawn from its seed alone; stresses change the truth and leave all else as it was.
"""

import dataclasses
from functools import lru_cache
import math

import numpy as np
from push_model.contact import normal_range
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_planner.settings import PlannerSettings
from push_planner.single_push.site_selection import choose_site
from push_scenario.definition import data
from push_scenario.definition.loader import read_object, read_robot
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings

SENSORS = SensorSettings(pose_rate=20.0, pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                         pose_latency=0.08, pose_drop_probability=0.05,
                         odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02)
KINDS = {'box, differential': ('box', 'disc_017'),
         'box, holonomic': ('box', 'holonomic_017'),
         'bin, holonomic': ('bin', 'holonomic_017'),
         'table, differential': ('coffee_table', 'disc_017'),
         'table, holonomic': ('coffee_table', 'holonomic_017')}
STRESSES = ('as stated', 'uneven supports', 'contact friction -30 %')
CONTACT_FRICTION = {'contact friction -30 %': 0.7}
LONGEST = 400.0


def scenario(kind, seed, stress):
    """
    Draw a case.

    :param kind: one of ``KINDS``.
    :param seed: of all draws.
    :param stress: one of ``STRESSES``.
    :return: (``Scenario``, ``Plan`` by which the start was chosen).
    :raises PlanningFailed: where no contact leads to the goal.
    """
    name, robot = KINDS[kind]
    rng = np.random.default_rng(seed)
    robot = read_robot(data.config_file(f'robots/{robot}.yaml'))
    believed, true = objects(name, rng, stress, seed)
    distance, bearing, turn = (rng.uniform(1.0, 3.0), math.radians(rng.uniform(-60.0, 60.0)),
                               math.radians(rng.uniform(-90.0, 90.0)))
    goal = Pose(distance * math.cos(bearing), distance * math.sin(bearing), turn)
    settings = PlannerSettings(pushing_speed=rng.uniform(0.1, 0.25))
    answer = _planned(believed, robot, goal, settings)
    aside, headed = rng.normal(0.0, math.radians(1.5), 2)
    start = _start(answer.problem, aside, headed)
    return Scenario(
        name='random', description=f'{kind}, {stress}, seed {seed}', object=believed,
        true_object=true, robot=robot, true_robot=robot, start=start, goal=Placement(*goal),
        planner=settings,
        sensors=SENSORS, simulation=SimulationSettings(seed=seed), time_limit=LONGEST), answer


def objects(name, rng, stress, seed):
    """
    Draw an object.

    :param name: of the file in ``config/objects``; ``box`` for a square box of any size.
    :param rng: ``numpy.random.Generator``.
    :param stress: one of ``STRESSES``.
    :param seed: of the case.
    :return: what is believed and what is true, two ``PushedObject``.
    """
    mass, friction = rng.uniform(0.5, 10.0), rng.uniform(0.2, 0.6)
    if name == 'box':
        shape = _box(rng.uniform(0.3, 0.6))
    else:
        shape = read_object(data.config_file(f'objects/{name}.yaml'))
    believed = dataclasses.replace(
        shape, mass=mass, inertia=shape.inertia / shape.mass * mass,
        supports=_rubbing(shape.supports, [friction] * len(shape.supports)),
        contact_friction_coefficient=0.5)
    feet = friction * rng.uniform(0.7, 1.3) * rng.uniform(0.6, 1.4, len(shape.supports))
    if stress == 'uneven supports':
        side = 1.0 if seed % 2 else -1.0
        feet = [friction * (1.8 if side * foot.y > 0.0 else 0.6) for foot in shape.supports]
    true = dataclasses.replace(
        believed, mass=mass * rng.uniform(0.7, 1.3),
        inertia=believed.inertia * rng.uniform(0.7, 1.3),
        supports=_rubbing(shape.supports, feet),
        contact_friction_coefficient=0.5 * CONTACT_FRICTION.get(stress, 0.8))
    return believed, true


@lru_cache(maxsize=1)
def _planned(believed, robot, goal, settings):
    """Plan once for all stresses of a seed: they change only the truth."""
    return choose_site(believed, robot, Pose(0.0, 0.0, 0.0), goal, settings).plan


def _box(side):
    h = 0.5 * side
    corners = ((-h, -h), (h, -h), (h, h), (-h, h))
    return PushedObject(mass=1.0, inertia=side ** 2 / 6.0, outline=corners,
                        supports=tuple(Support(0.9 * x, 0.9 * y, 1.0) for x, y in corners))


def _rubbing(supports, coefficients):
    return tuple(dataclasses.replace(support, friction_coefficient=float(value))
                 for support, value in zip(supports, coefficients))


def _start(problem, aside, headed):
    """Place the robot as planned but for small errors, 2 mm away."""
    low, high = normal_range(problem.obj, problem.contact)
    middle = 0.5 * (low + high)
    shift = math.remainder(problem.normal - middle, 2.0 * math.pi) + aside
    room = 0.5 * (high - low)
    return Start(contact=problem.contact, gap=2e-3, normal=min(room, max(-room, shift)),
                 heading=problem.heading - problem.normal + headed)
