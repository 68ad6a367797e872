"""A plan as a file: ``*.npz`` with the trajectory's arrays, and the rest as JSON."""

import dataclasses
import json

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.trajectory import COLUMNS, PushTrajectory
from push_planner.problem import PlannerSettings, PresentMotion, PushProblem
from push_planner.sampling import Switch

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
                       PlannerSettings(**values['settings']), PresentMotion(*values['motion']))


def _plain(value):
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f'value: got {value!r}, expected a plain number or text')
