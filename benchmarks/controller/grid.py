"""
The 243 straight pushes of A. Heins and A. P. Schoellig (RA-L 2024), 30 m at 0.1 m/s.

A box of 1 m by 1 m and 1 kg, floor friction 0.25, is pushed at a face by a robot of 5 cm radius.
Inertia, contact friction, offset of the path, yaw of the box and offset of the contact on its face
vary. The inertias (half of uniform, uniform, all mass in the corners) and the four supports in the
corners are not stated there and were chosen here.
"""

import itertools
import math
from typing import Any, Sequence

from benchmarks.controller.published_laws import dipole_law, force_angle_law
from benchmarks.controller.tables import Job, Pair, Record, table
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_planner.problem import PlannerSettings
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.plant import Plant

# Of the paper: half the side of the box [m], speed [m/s], length of the path [m].
HALF = 0.5
SPEED = 0.1
PATH_LENGTH = 30.0
# Time between two steps of the published laws [s]; chosen.
PERIOD = 0.02
CORNERS = ((-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF))
ROBOT = RoundRobot(0.05, 'holonomic', max_speed=0.3)
INERTIAS = (1.0 / 12.0, 1.0 / 6.0, 0.5)
FRICTIONS = (0.0, 0.5, 1.0)
OFFSETS = (-0.4, 0.0, 0.4)
YAWS = tuple(math.radians(angle) for angle in (-22.5, 0.0, 22.5))
# A push has converged if the object stays within MAX_DEVIATION of the path over the last
# FINAL_LENGTH of it [m]; chosen.
FINAL_LENGTH = 0.5
MAX_DEVIATION = 0.1
LAWS = ('force angle', 'dipole', 'feedback', 'mpc')


def cases(every: int = 1) -> list[Job]:
    """
    List the jobs under every law.

    :param every: take every n-th combination.
    """
    names = 'inertia', 'friction', 'aside', 'yaw', 'along'
    values = list(itertools.product(INERTIAS, FRICTIONS, OFFSETS, YAWS, OFFSETS))
    return [{**dict(zip(names, some)), 'law': law} for law in LAWS
            for some in values[every // 2::every]]


def push(job: Job) -> Record:
    """
    Push one case.

    :param job: a dict of ``cases``.
    :return: flat dict: outcome, and the object's largest deviation from the path at its end
        [m].
    """
    box = PushedObject(1.0, job['inertia'], tuple(Support(x, y, 0.25) for x, y in CORNERS),
                       CORNERS, contact_friction_coefficient=job['friction'])
    start = Start(contact=Contact('face', 3, -job['along']), object=_placed(job))
    if job['law'] in ('feedback', 'mpc'):
        return _push_by_controller(job, box, start)
    return _push_by_published_law(job, box, start)


def _placed(job: Job) -> Placement:
    """Place the box so that the contact is beside the start of the path."""
    c, s = math.cos(job['yaw']), math.sin(job['yaw'])
    return Placement(c * HALF + s * job['along'], job['aside'] + s * HALF - c * job['along'],
                     job['yaw'])


def _push_by_published_law(job: Job, box: PushedObject, start: Start) -> Record:
    robot_pose = start.robot_pose(box, ROBOT.radius)._replace(theta=0.0)
    plant = Plant(box, ROBOT, start.object.pose, robot_pose, PERIOD / 4, 1e-5)
    positions: list[tuple[float, float]] = []
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


def _push_by_controller(job: Job, box: PushedObject, start: Start) -> Record:
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


def evaluate_path(outcome: str, positions: FloatArray) -> Record:
    """
    Judge a push by the last half metre of its path.

    :param outcome: why it ended early, or ''.
    :param positions: of the object in the frame of the path, shape (n, 2) [m].
    :return: as ``push``.
    """
    x, y = positions.T
    last = (x >= PATH_LENGTH - FINAL_LENGTH) & (x <= PATH_LENGTH)
    arrived = bool(x.max() >= PATH_LENGTH - FINAL_LENGTH)
    off = float(np.abs(y[last]).max()) if last.any() else math.nan
    return {'outcome': outcome or ('' if arrived else 'not there'), 'off': off,
            'converged': bool(arrived and off <= MAX_DEVIATION)}


def grid_table(jobs: Sequence[Job], records: Sequence[Record]) -> str:
    """Write the number of cases in which each law converges."""
    rows: list[Sequence[Any]] = []
    for law in LAWS:
        found = [(job, record) for job, record in zip(jobs, records) if job['law'] == law]
        off = [1e3 * record['off'] for _, record in found if record['converged']]
        refused = sum('steer' in record['outcome'] for _, record in found)
        rows.append((law, _count(found), refused, *(
            _count([pair for pair in found if pair[0]['friction'] == friction])
            for friction in FRICTIONS), _count([pair for pair in found if not pair[0]['along']]),
            f'{np.median(off):.1f}, {max(off):.1f}' if off else '-'))
    return table(['law', 'converged', 'refused', *(f'friction {value:g}' for value in FRICTIONS),
                  'contact in the middle', 'deviation at the end, mm: median, max'], rows)


def _count(pairs: Sequence[Pair]) -> str:
    return f"{sum(record['converged'] for _, record in pairs)} of {len(pairs)}"
