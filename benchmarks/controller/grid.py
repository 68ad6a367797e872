"""
The 243 cases of A. Heins and A. P. Schoellig (RA-L 2024): 30 m straight ahead at 0.1 m/s.

A box of 1 m by 1 m and 1 kg, floor friction 0.25, pushed at a face with a robot of 5 cm radius:
inertia, contact friction, offset of the path, yaw of the box and offset of the contact on its face
are varied. The inertias (half of uniform, uniform, all mass in the corners) and the four supports
in the corners are ours.
"""

import itertools
import math

from benchmarks.controller.published_laws import dipole_law, force_angle_law
from benchmarks.controller.tables import table
import numpy as np
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_planner.problem import PlannerSettings
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.plant import Plant

HALF, SPEED, PATH_LENGTH, PERIOD = 0.5, 0.1, 30.0, 0.02
CORNERS = ((-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF))
ROBOT = RoundRobot(0.05, 'holonomic', max_speed=0.3)
INERTIAS = (1.0 / 12.0, 1.0 / 6.0, 0.5)
FRICTIONS = (0.0, 0.5, 1.0)
OFFSETS = (-0.4, 0.0, 0.4)
YAWS = tuple(math.radians(angle) for angle in (-22.5, 0.0, 22.5))
LAST, CLOSE = 0.5, 0.1
LAWS = ('force angle', 'dipole', 'feedback', 'mpc')


def cases(every=1):
    """
    List the jobs under every law.

    :param every: of so many combinations one is taken.
    """
    names = 'inertia', 'friction', 'aside', 'yaw', 'along'
    values = list(itertools.product(INERTIAS, FRICTIONS, OFFSETS, YAWS, OFFSETS))
    return [{**dict(zip(names, some)), 'law': law} for law in LAWS
            for some in values[every // 2::every]]


def push(job):
    """
    Push one case.

    :param job: a dict of ``cases``.
    :return: flat dict: outcome, and how far the object is off the path at last [m].
    """
    box = PushedObject(1.0, job['inertia'], tuple(Support(x, y, 0.25) for x, y in CORNERS),
                       CORNERS, contact_friction_coefficient=job['friction'])
    start = Start(contact=Contact('face', 3, -job['along']), object=_placed(job))
    if job['law'] in ('feedback', 'mpc'):
        return _ours(job, box, start)
    return _published(job, box, start)


def _placed(job):
    """Place the box so that the contact is beside the path's beginning."""
    c, s = math.cos(job['yaw']), math.sin(job['yaw'])
    return Placement(c * HALF + s * job['along'], job['aside'] + s * HALF - c * job['along'],
                     job['yaw'])


def _published(job, box, start):
    robot_pose = start.robot_pose(box, ROBOT.radius)._replace(theta=0.0)
    plant = Plant(box, ROBOT, start.object.pose, robot_pose, PERIOD / 4, 1e-5)
    positions = []
    for k in range(round(1.3 * PATH_LENGTH / SPEED / PERIOD)):
        truth = plant.truth(k * PERIOD)
        positions.append((truth.object_pose.x, truth.object_pose.y))
        if truth.robot_pose.x >= PATH_LENGTH:
            break
        if job['law'] == 'dipole':
            angle = dipole_law(truth, (PATH_LENGTH + 10.0, 0.0))
        else:
            angle = force_angle_law(truth, 0.0, truth.contact_point[1])
        angle -= truth.robot_pose.theta
        plant.advance(PERIOD, Twist(SPEED * math.cos(angle), SPEED * math.sin(angle), 0.0))
    return evaluate_path('', np.array(positions))


def _ours(job, box, start):
    settings = PlannerSettings(pushing_speed=SPEED, max_path_length=2.0 * PATH_LENGTH)
    goal = Placement(PATH_LENGTH + HALF, 0.0, 0.0)
    case = Scenario(name='grid', description='straight on', object=box, true_object=box,
                    robot=ROBOT, true_robot=ROBOT, start=start, goal=goal, planner=settings,
                    time_limit=900.0)
    result = simulate(case, job['law'])
    if result.tape is None:
        return {'outcome': result.reason, 'off': math.nan, 'converged': False}
    positions = result.tape.poses('object')[:, :2]
    return evaluate_path('' if result.outcome is Outcome.DONE else result.reason, positions)


def evaluate_path(outcome, positions):
    """
    Judge a push by the last half metre of its way.

    :param outcome: why it ended early, or ''.
    :param positions: places of the object, shape (n, 2).
    :return: as ``push``.
    """
    x, y = positions.T
    last = (x >= PATH_LENGTH - LAST) & (x <= PATH_LENGTH)
    arrived = bool(x.max() >= PATH_LENGTH - 0.5)
    off = float(np.abs(y[last]).max()) if last.any() else math.nan
    return {'outcome': outcome or ('' if arrived else 'not there'), 'off': off,
            'converged': bool(arrived and off <= CLOSE)}


def grid_table(jobs, records):
    """Write how many cases each law converges in."""
    rows = []
    for law in LAWS:
        found = [(job, record) for job, record in zip(jobs, records) if job['law'] == law]
        off = [1e3 * record['off'] for _, record in found if record['converged']]
        refused = sum('steer' in record['outcome'] for _, record in found)
        rows.append((law, _share(found), refused, *(
            _share([pair for pair in found if pair[0]['friction'] == friction])
            for friction in FRICTIONS), _share([pair for pair in found if not pair[0]['along']]),
            f'{np.median(off):.1f}, {max(off):.1f}' if off else '-'))
    return table(['law', 'converged', 'refused', *(f'friction {value:g}' for value in FRICTIONS),
                  'contact in the middle', 'mm off the path at last: median, max'], rows)


def _share(pairs):
    return f"{sum(record['converged'] for _, record in pairs)} of {len(pairs)}"
