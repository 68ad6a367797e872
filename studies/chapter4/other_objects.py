"""Other objects and drives on random friction: open loop against feedback."""

import math
from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Start
from studies.chapter4.random_friction import CENTIMETRES, draw_ends
from studies.chapter4.repeated_push import COLUMNS, GaussianFriction, repeat, RepeatedPush
from studies.chapter4.setup import FEEDBACK, LABELS, Law, MPC, OPEN_LOOP, PushSetup
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study


class OtherPush(NamedTuple):
    """
    A push of another object.

    :param object_name: of the file in config/objects.
    :param robot_name: of the file in config/robots.
    :param start: where object and robot stand at first.
    :param goal: goal pose of the object.
    """

    object_name: str
    robot_name: str
    start: Start
    goal: Pose


# Chosen: round a bend to the left, as the box of 4.7; a differential drive at a corner, as it
# cannot turn an object at a face.
BEND = Pose(2.4, 0.6, 0.5)
PUSHED = {
    'box_differential': OtherPush(
        'box_04', 'disc_017',
        Start(Placement(0.0, 0.0, math.radians(-45.0)), contact=Contact('vertex', 0)),
        Pose(2.1, 0.7, math.radians(-15.0))),
    'bin_holonomic': OtherPush(
        'bin', 'holonomic_017', Start(contact=Contact('round', 0, math.pi)), BEND),
    'coffee_table_holonomic': OtherPush(
        'coffee_table', 'holonomic_017', Start(contact=Contact('face', 7)), BEND)}
LAWS: tuple[Law, ...] = (OPEN_LOOP, FEEDBACK, MPC)
PARAMETERS = (
    Parameter('speed', 'm/s', 'planned speed of the contact'),
    Parameter('sensors', '', 'errors of the sensors: benchmark or exact'),
    Parameter('deviation', '', 'standard deviation of the friction of each support point, over '
              'its nominal value'),
    Parameter('period', 's', 'time between draws'),
    Parameter('seeds', '', 'number of pushes under each law, each with draws of its own'))


def repeated_push(name: str, values: Values) -> RepeatedPush:
    """
    Make the push of an object on random friction.

    :param name: one of ``PUSHED``.
    :param values: with the parameters ``PARAMETERS``.
    :return: the push.
    """
    chosen = PUSHED[name]
    setup = PushSetup(read_object(data.config_file(f'objects/{chosen.object_name}.yaml')),
                      read_robot(data.config_file(f'robots/{chosen.robot_name}.yaml')),
                      values.speed, values.sensors, chosen.start)
    return RepeatedPush(setup, tuple(chosen.goal), GaussianFriction(
        values.deviation, values.period, len(setup.object.supports)))


def compute(values: Values, run_jobs: RunJobs) -> Outcome:
    """Push every object under all laws, with the same draws for all laws."""
    tables = {name: repeat(repeated_push(name, values), LAWS, int(values.seeds), run_jobs)
              for name in PUSHED}
    medians = {law: [float(np.median(table[f'{law}_{COLUMNS[0]}'])) for table in tables.values()]
               for law in LAWS}
    findings = {
        'objects': Finding(float(len(tables)), '', 'number of objects with a robot'),
        'pushes': Finding(float(values.seeds), '', 'number of pushes of each under each law')}
    for law in LAWS:
        findings[f'best_{law}'] = Finding(CENTIMETRES * min(medians[law]), 'cm', 'least median '
                                          f'distance from the goal, {LABELS[law]}')
        findings[f'worst_{law}'] = Finding(CENTIMETRES * max(medians[law]), 'cm', 'greatest')
    findings['ratio'] = Finding(
        min(open_loop / feedback for open_loop, feedback in zip(medians[OPEN_LOOP],
                                                                medians[FEEDBACK])), '',
        'least ratio of the medians of open loop and feedback')
    return Outcome(tables, findings)


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw how far from the goal all pushes end, one panel for each object."""
    panels = figure.subplots(len(outcome.tables), 1, sharex=True)
    for axes, (name, table) in zip(panels, outcome.tables.items()):
        draw_ends(axes, table, LAWS)
        thing, drive = name.replace('_', ' ').rsplit(maxsplit=1)
        axes.set_title(f'{thing}, {drive} drive', loc='left')
        axes.label_outer()


STUDIES = (
    Study('disturbed-objects', 'Box, bin and table on random friction, by both drives',
          PARAMETERS, compute, draw,
          'Medians for {objects:.0f} other objects and drives, {pushes:.0f} pushes each: feedback '
          '{best_feedback:.1f} to {worst_feedback:.1f} cm, mpc {best_mpc:.1f} to {worst_mpc:.1f} '
          'cm, open loop {best_open_loop:.0f} to {worst_open_loop:.0f} cm ({ratio:.0f} times as '
          'far or more).',
          'Friction at every support is random every half second, as in 4.7.', (6.8, 6.4)),)
