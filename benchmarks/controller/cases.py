"""
Random single pushes with the model errors that a controller should tolerate, as scenarios.

A case is drawn from its seed alone; a stress changes the true parameters and nothing else.
"""

import dataclasses
from functools import lru_cache
import math
from typing import Sequence, Union

import numpy as np
from push_model.contact import normal_range
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot, Support
from push_planner.problem import PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.plan import Plan
from push_planner.steered.site_selection import choose_site
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
# Nominal coefficient of friction at the contact, and the true one over it, without and with a
# stress.
CONTACT_FRICTION = 0.5
TRUE_CONTACT_FRICTION = 0.8
STRESSED_CONTACT_FRICTION = {'contact friction -30 %': 0.7}
# Simulated time after which a push is given up [s]; chosen: far longer than any plan.
TIME_LIMIT = 400.0
# Gap between robot and object at the start [m]; chosen: small, as after an approach.
START_GAP = 2e-3


def scenario(kind: str, seed: int, stress: str) -> tuple[Scenario, Plan]:
    """
    Draw a case.

    :param kind: one of ``KINDS``.
    :param seed: of all draws.
    :param stress: one of ``STRESSES``.
    :return: (``Scenario``, ``Plan`` by which the start was chosen).
    :raises PlanningFailed: where no contact leads to the goal.
    """
    object_name, robot_name = KINDS[kind]
    rng = np.random.default_rng(seed)
    robot = read_robot(data.config_file(f'robots/{robot_name}.yaml'))
    nominal, true = objects(object_name, rng, stress, seed)
    distance = rng.uniform(1.0, 3.0)
    bearing = math.radians(rng.uniform(-60.0, 60.0))
    heading = math.radians(rng.uniform(-90.0, 90.0))
    goal = Pose(distance * math.cos(bearing), distance * math.sin(bearing), heading)
    settings = PlannerSettings(pushing_speed=rng.uniform(0.1, 0.25))
    plan = _plan(nominal, robot, goal, settings)
    normal_error, heading_error = rng.normal(0.0, math.radians(1.5), 2)
    start = _start(plan.problem, normal_error, heading_error)
    return Scenario(
        name='random', description=f'{kind}, {stress}, seed {seed}', object=nominal,
        true_object=true, robot=robot, true_robot=robot, start=start, goal=Placement(*goal),
        planner=settings,
        sensors=SENSORS, simulation=SimulationSettings(seed=seed), time_limit=TIME_LIMIT), plan


def objects(name: str, rng: np.random.Generator, stress: str,
            seed: int) -> tuple[PushedObject, PushedObject]:
    """
    Draw nominal and true parameters of an object.

    :param name: of the file in ``config/objects``; ``box`` for a square box of any size.
    :param rng: ``numpy.random.Generator``.
    :param stress: one of ``STRESSES``.
    :param seed: of the case.
    :return: nominal and true parameters, two ``PushedObject``.
    """
    mass, friction = rng.uniform(0.5, 10.0), rng.uniform(0.2, 0.6)
    if name == 'box':
        shape = _box(rng.uniform(0.3, 0.6))
    else:
        shape = read_object(data.config_file(f'objects/{name}.yaml'))
    nominal = dataclasses.replace(
        shape, mass=mass, inertia=shape.inertia / shape.mass * mass,
        supports=_with_friction(shape.supports, [friction] * len(shape.supports)),
        contact_friction_coefficient=CONTACT_FRICTION)
    coefficients = friction * rng.uniform(0.7, 1.3) * rng.uniform(0.6, 1.4, len(shape.supports))
    if stress == 'uneven supports':
        side = 1.0 if seed % 2 else -1.0
        coefficients = [friction * (1.8 if side * foot.y > 0.0 else 0.6)
                        for foot in shape.supports]
    true = dataclasses.replace(
        nominal, mass=mass * rng.uniform(0.7, 1.3),
        inertia=nominal.inertia * rng.uniform(0.7, 1.3),
        supports=_with_friction(shape.supports, coefficients),
        contact_friction_coefficient=CONTACT_FRICTION * STRESSED_CONTACT_FRICTION.get(
            stress, TRUE_CONTACT_FRICTION))
    return nominal, true


@lru_cache(maxsize=1)
def _plan(nominal: PushedObject, robot: RoundRobot, goal: Pose,
          settings: PlannerSettings) -> Plan:
    """Plan once for all stresses of a seed: they change only the true parameters."""
    return choose_site(nominal, robot, Pose(0.0, 0.0, 0.0), goal, settings).plan


def _box(side: float) -> PushedObject:
    h = 0.5 * side
    corners = ((-h, -h), (h, -h), (h, h), (-h, h))
    return PushedObject(mass=1.0, inertia=side ** 2 / 6.0, outline=corners,
                        supports=tuple(Support(0.9 * x, 0.9 * y, 1.0) for x, y in corners))


def _with_friction(supports: Sequence[Support],
                   coefficients: Union[Sequence[float], FloatArray]) -> tuple[Support, ...]:
    return tuple(dataclasses.replace(support, friction_coefficient=float(value))
                 for support, value in zip(supports, coefficients))


def _start(problem: PushProblem, normal_error: float, heading_error: float) -> Start:
    """Place the robot as planned but for small errors [rad]; there is a gap to the object."""
    low, high = normal_range(problem.obj, problem.contact)
    middle = 0.5 * (low + high)
    shift = math.remainder(problem.normal - middle, 2.0 * math.pi) + normal_error
    half_range = 0.5 * (high - low)
    return Start(contact=problem.contact, gap=START_GAP,
                 normal=min(half_range, max(-half_range, shift)),
                 heading=problem.heading - problem.normal + heading_error)
