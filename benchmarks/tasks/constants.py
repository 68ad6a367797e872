"""
Which constants of the controller matter: tasks with half and twice the value of each.

The same tasks on open floor are run with every constant as it is, halved and doubled. Takes about
an hour on two cores, ``--count 4`` some minutes. ``--records`` stores tasks as they finish, and
the same command resumes after Ctrl-C.
"""

import argparse
import contextlib
import importlib
from pathlib import Path
import statistics
import sys
from typing import Generator, NamedTuple

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.benchmark import INTERRUPTED
from benchmarks.tasks.cases import jobs, OPEN
from benchmarks.tasks.run import run
from push_scenario.parallel import ERROR, progress_bar, run_many

DESCRIPTION = 'Which constants of the controller matter: tasks with half and twice their values.'
FACTORS = (0.5, 2.0)
COUNT = 28


class Constant(NamedTuple):
    """
    A constant that decides behaviour.

    :param module: in which it is defined.
    :param name: there.
    :param unit: of its value.
    :param meaning: a clause.
    """

    module: str
    name: str
    unit: str
    meaning: str


CONSTANTS = (
    Constant('push_control.behaviors.straight_push', 'ENDING_TIME', 's',
             'time in which what remains of a push is covered as it ends'),
    Constant('push_control.behaviors.straight_push', 'STEERING_PERIOD', 's',
             'period of choices of an arc'),
    Constant('push_control.behaviors.straight_push', 'MIN_STEERED', 'm',
             'remaining distance above which the arc still changes'),
    Constant('push_control.behaviors.straight_push', 'STOP_MARGIN', 'm',
             'how far the choice of the stop looks beyond it'),
    Constant('push_control.behaviors.straight_push', 'MISS_STD', 'm',
             'deviation that a miss adds to the position of the robot'),
    Constant('push_control.behaviors.rollout_law', 'CHANGE_COST', 's m',
             'time that a change of curvature by 1/m must gain'),
    Constant('push_control.behaviors.push_progress', 'MISS_DISTANCE', 'm',
             'drive beyond the expected contact until it is a miss'),
    Constant('push_control.behaviors.push_progress', 'UNEXPECTED_DISTANCE', 'm',
             'motion of the object before the expected contact that ends a push'),
    Constant('push_control.behaviors.approach', 'HANDOVER_DISTANCE', 'm',
             'distance before the contact at which the push takes over'),
    Constant('push_control.behaviors.approach', 'OVERLAP_TOLERANCE', 'm',
             'overlap of robot and object that is an error of measurement'),
    Constant('push_control.behaviors.obstacle_guard', 'REACTION_TIME', 's',
             'time that the robot takes to stop before an obstacle'),
    Constant('push_control.perception.ensemble.members', 'MEMBER_COUNT', '',
             'members of the ensemble'),
    Constant('push_control.perception.ensemble.members', 'SUPPORT_LOG_STD', '',
             'prior deviation of the log of support friction'),
    Constant('push_control.perception.ensemble.members', 'CONTACT_FRICTION_STD', '',
             'prior deviation of contact friction'),
    Constant('push_control.perception.ensemble.prediction', 'POSITION_WALK', 'm/sqrt(m)',
             'deviation of the object per root of pushed distance'),
    Constant('push_control.perception.ensemble.prediction', 'HEADING_WALK', 'rad/sqrt(m)',
             'the same of its heading'),
    Constant('push_control.perception.ensemble.measurement_update', 'COUPLING_TIME', 's',
             'time after the last contact for which poses tell of the robot'),
    Constant('push_control.perception.ensemble.measurement_update', 'OUTLIER_GATE', '',
             'squared Mahalanobis distance of an outlier'),
    Constant('push_control.perception.contact_consistency', 'FITTING_STD', 'm',
             'deviation of the robot after a push that fits its poses'),
    Constant('push_control.supervision_settings', 'MIN_AIM', '',
             'smallest part of the tolerance that is aimed at'),
    Constant('push_navigation.path_follower', 'POSITION_TOLERANCE', 'm',
             'distance at which the end of a path is reached'),
    Constant('push_navigation.path_follower', 'DWELL', 's',
             'time constant that tells a stop from passing by'))


def value_of(constant: Constant) -> float:
    """
    Return the value of a constant as it is in the source.

    :param constant: one of ``CONSTANTS``.
    """
    return getattr(importlib.import_module(constant.module), constant.name)


@contextlib.contextmanager
def replaced(constant: Constant, value: float) -> Generator[None, None, None]:
    """
    Give a constant another value, in its module and in all that have imported it.

    :param constant: one of ``CONSTANTS``.
    :param value: in its unit.
    """
    original = value_of(constant)
    users = [module for name, module in list(sys.modules.items())
             if name.startswith('push_') and vars(module).get(constant.name) is original]
    for module in users:
        setattr(module, constant.name, value)
    try:
        yield
    finally:
        for module in users:
            setattr(module, constant.name, original)


def run_with(job: Job) -> Record:
    """
    Run a task with one constant changed.

    :param job: dict of ``index`` (of the constant in ``CONSTANTS``), ``factor`` (by which it is
        multiplied) and ``task`` (``part``, ``kind`` and ``seed``).
    :return: ``success``, ``duration`` [s] and ``pushes``.
    """
    constant = CONSTANTS[job['index']]
    value = value_of(constant)
    with replaced(constant, type(value)(job['factor'] * value)):
        record = run(job['task'])
    return {name: record[name] for name in ('success', 'duration', 'pushes')}


def row(constant: Constant, records: dict[float, list[Record]]) -> str:
    """
    Describe what a constant does, as a row of a table in Markdown.

    :param constant: one of ``CONSTANTS``.
    :param records: of each factor, in the order of the tasks; 1 for none.
    """
    place = constant.module.rsplit('.', 1)[1]
    cells = [f'`{place}.{constant.name}`', f'{value_of(constant):g} {constant.unit}'.strip(),
             constant.meaning]
    for factor in FACTORS:
        pairs = [(float(changed['duration']) / float(plain['duration']))
                 for changed, plain in zip(records[factor], records[1.0])
                 if changed['success'] and plain['success']]
        done = sum(bool(record['success']) for record in records[factor])
        mean = statistics.mean(pairs) if pairs else float('nan')
        cells.append(f'{done} of {len(records[factor])}, {mean:.2f}')
    return f'| {" | ".join(cells)} |'


def measure(count: int, folder: Path, workers: int | None) -> str:
    """
    Run the tasks with every value of every constant.

    :param count: number of tasks.
    :param folder: for their records.
    :param workers: number of processes, or None for one per core.
    :return: table in Markdown.
    :raises RuntimeError: where a task could not be run.
    """
    tasks = jobs(OPEN, count)
    todo: list[Job] = [
        {'index': index, 'factor': factor, 'task': task}
        for index in range(len(CONSTANTS)) for factor in FACTORS for task in tasks]
    todo += [{'index': 0, 'factor': 1.0, 'task': task} for task in tasks]
    results = run_many(run_with, todo, folder=folder, workers=workers, block=1,
                       progress=progress_bar('constants'))
    records: dict[tuple[int, float], list[Record]] = {}
    for job, result in zip(todo, results):
        if ERROR in result:
            raise RuntimeError(f'{job}: {result[ERROR]}')
        records.setdefault((job['index'], job['factor']), []).append(result)
    plain = records[0, 1.0]
    done = sum(bool(record['success']) for record in plain)
    lines = [f'{done} of {len(plain)} tasks are done with the values as they are.', '',
             '| constant | value | meaning | half: done, time | twice: done, time |',
             '| --- | --- | --- | --- | --- |']
    lines += [row(constant, {1.0: plain, **{factor: records[index, factor] for factor in FACTORS}})
              for index, constant in enumerate(CONSTANTS)]
    return '\n'.join(lines) + '\n'


def main() -> int:
    """Measure and print; write the table where a folder is named."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--count', type=int, default=COUNT, help='tasks with each value')
    parser.add_argument('--records', type=Path, default=Path('out/constants'))
    parser.add_argument('--out', type=Path, help='directory for constants.md')
    parser.add_argument('--workers', type=int, help='processes; default: one per core')
    chosen = parser.parse_args()
    try:
        written = measure(chosen.count, chosen.records, chosen.workers)
    except KeyboardInterrupt:
        print('\ninterrupted; the same command resumes', file=sys.stderr)
        return INTERRUPTED
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'constants.md').write_text(written, encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
