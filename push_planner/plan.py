"""A plan as a file: ``*.npz`` with the trajectory's arrays, and the rest as JSON."""

import dataclasses
import json
from typing import NamedTuple

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.trajectory import COLUMNS, PushTrajectory
from push_planner.problem import InitialMotion, PlannerSettings, PushProblem


class Switch(NamedTuple):
    """
    A jump of the pushing angle, and what it takes if it happens at once.

    :param way: where it is [m].
    :param change: change of the pushing angle [rad]; at the first touch the angle itself.
    :param d_omega: jump of the object's yaw rate [rad/s].
    :param normal_impulse: J_n [N s].
    :param tangential_impulse: J_t [N s].
    :param in_cone: whether the impulse lies within the believed friction cone.
    :param blend: way over which the change must be spread at least, for the contact to hold [m];
        0 inside the cone.
    """

    way: float
    change: float
    d_omega: float
    normal_impulse: float
    tangential_impulse: float
    in_cone: bool
    blend: float


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """
    A push that reaches its goal.

    :param problem: the ``PushProblem`` that it answers.
    :param trajectory: ``PushTrajectory`` in the world; twists are those after a switch.
    :param pushing_angles: pushing angle at the begin and the end of each piece, linear in the way
        of the contact between, from the normal to the velocity imposed at the contact [rad].
    :param segment_ends: way of the contact at the end of each piece, increasing [m].
    :param speeds: speed of the contact at the begin and the end of each piece; its square is
        linear in the way between [m/s].
    :param switches: ``Switch`` of every jump, the first touch included: the impulse it takes.
    :param report: what there is to know of the plan, a dict of names to numbers and texts.
    """

    problem: PushProblem
    trajectory: PushTrajectory
    pushing_angles: tuple
    segment_ends: tuple
    speeds: tuple
    switches: tuple
    report: dict

    def save(self, path):
        """
        Write the plan to a file.

        :param path: where, by convention ``*.npz``.
        """
        save_plan(self, path)

    @classmethod
    def load(cls, path):
        """
        Read a plan that ``save`` wrote.

        :param path: the file.
        :raises ValueError: where it is no plan.
        """
        return cls(**read_plan(path))


FORMAT = 1
NAMES = ('times',) + COLUMNS


def save_plan(plan, path):
    """
    Write a plan to a file.

    :param plan: the ``Plan``.
    :param path: where, by convention ``*.npz``.
    """
    problem = plan.problem
    text = {'format': FORMAT,
            'problem': {
                **{name: dataclasses.asdict(getattr(problem, name))
                   for name in ('obj', 'robot', 'contact', 'settings')},
                **{name: list(getattr(problem, name)) for name in ('start', 'goal', 'motion')},
                'normal': problem.normal, 'heading': problem.heading},
            'pushing_angles': plan.pushing_angles, 'segment_ends': plan.segment_ends,
            'speeds': plan.speeds, 'switches': [list(switch) for switch in plan.switches],
            'report': plan.report}
    with open(path, 'wb') as file:
        np.savez(file, plan=np.array(json.dumps(text, default=_plain)),
                 **{name: getattr(plan.trajectory, name) for name in NAMES})


def read_plan(path):
    """
    Read what ``save_plan`` wrote.

    :param path: the file.
    :return: dict of the fields of a ``Plan``.
    :raises ValueError: where it is no plan, or of another format.
    """
    with np.load(path) as data:
        missing = sorted(({'plan'} | set(NAMES)) - set(data.files))
        if missing:
            raise ValueError(f'{path}: got no {", ".join(missing)}, expected a Plan')
        text = json.loads(str(data['plan']))
        if text['format'] != FORMAT:
            raise ValueError(f'{path}: got format {text["format"]}, expected {FORMAT}')
        trajectory = PushTrajectory(**{name: data[name] for name in NAMES})
    return {'problem': _problem(text['problem']), 'trajectory': trajectory,
            'pushing_angles': tuple(map(tuple, text['pushing_angles'])),
            'segment_ends': tuple(text['segment_ends']),
            'speeds': tuple(map(tuple, text['speeds'])),
            'switches': tuple(Switch(*switch) for switch in text['switches']),
            'report': text['report']}


def _problem(values):
    obj = dict(values['obj'])
    obj['supports'] = tuple(Support(**support) for support in obj['supports'])
    obj['outline'] = tuple(map(tuple, obj['outline']))
    return PushProblem(PushedObject(**obj), RoundRobot(**values['robot']),
                       Contact(**values['contact']), Pose(*values['start']), values['normal'],
                       values['heading'], Pose(*values['goal']),
                       PlannerSettings(**values['settings']), InitialMotion(*values['motion']))


def _plain(value):
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f'value: got {value!r}, expected a plain number or text')
