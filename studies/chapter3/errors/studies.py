"""What a model mismatch costs at the goal: speed, friction, mass, inertia, support points."""

import dataclasses
import math
from typing import Callable

from matplotlib.figure import Figure
from studies.chapter3.errors import error_figure
from studies.chapter3.errors.mismatch_rollout import rollout
from studies.chapter3.errors.mismatched_push import (
    error_table, MismatchedPush, OPEN_LOOP_POINT, OPEN_LOOP_WIDE, PARAMETERS, SENSING_POINT,
    SYMMETRICAL, worst,
)
from studies.chapter3.errors.true_object import true_push
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

MILLIMETRES = 1000.0
Findings = dict[str, Finding]


def _in_millimetres(length: float, meaning: str) -> Finding:
    return Finding(MILLIMETRES * length, 'mm', meaning)


def findings(table: Table, kind: str, values: Values) -> Findings:
    """
    Summarize what the errors of one kind do.

    :param table: of ``error_table``.
    :param kind: of the errors.
    :param values: with the parameters ``PARAMETERS``.
    :return: findings by name.
    """
    sizes = sorted(set(map(abs, values.errors)))
    least, most = sizes[0], sizes[-1]
    first, second = (worst(table, [size], kind=kind, robot=SENSING_POINT,
                           speed_m_s=values.open_loop_speed) for size in sizes[:2])
    results = {
        'none': _in_millimetres(worst(table, [0.0]), 'largest position error without mismatch'),
        'power': Finding(math.log(second / first) / math.log(sizes[1] / least), '',
                         'power of the error with which the position error begins to grow')}
    for name, speed in (('slow', values.speeds[0]), ('fast', values.speeds[-1])):
        results[name] = _in_millimetres(
            worst(table, [most], kind=kind, robot=SENSING_POINT, speed_m_s=speed),
            f'largest position error of the point for {most:.0%} at {speed:g} m/s')
    for name, robot in (('sensing', SENSING_POINT), ('symmetrical', SYMMETRICAL),
                        ('open_loop', OPEN_LOOP_POINT), ('wide', OPEN_LOOP_WIDE)):
        rows = {'kind': kind, 'robot': robot, 'speed_m_s': values.open_loop_speed}
        results[name] = _in_millimetres(
            worst(table, [least], **rows),
            f'largest position error for {least:.0%}, {robot}, at {values.open_loop_speed:g} m/s')
        results[f'{name}_friction'] = Finding(worst(table, [least], 'friction_usage', **rows), '',
                                              'fraction of the friction angle that this needs')
    return {
        **results,
        'least': Finding(least, '', 'smallest error'),
        'most': Finding(most, '', 'largest error'),
        'low': Finding(values.speeds[0], 'm/s', 'first speed'),
        'high': Finding(values.speeds[-1], 'm/s', 'last speed'),
        'middle': Finding(values.open_loop_speed, 'm/s', 'speed of the open-loop robots')}


def _no_findings(table: Table, others: Table, values: Values) -> Findings:
    return {}


def _same_as_speed(table: Table, others: Table, values: Values) -> Findings:
    """Compare an error of the friction with the change of the speed that is equivalent to it."""
    push = MismatchedPush.of(values)
    distances: list[float] = []
    for error in values.errors:
        plan = push.plan(values.speeds[-1], SENSING_POINT)
        rough = rollout(plan, true_push(push.object, 'friction', error).obj)
        slow = rollout(plan, speed_scale=1.0 / math.sqrt(1.0 + error))
        distances.append(math.dist(rough.pose[:2], slow.pose[:2]))
    return {'law': _in_millimetres(max(distances), 'largest distance between the ends with k '
                                   'times the friction and with the speed over the root of k')}


def _load(table: Table, others: Table, values: Values) -> Findings:
    return {'load': _in_millimetres(worst(others), 'largest position error where mass and '
                                    'inertia are wrong alike')}


def _moved_supports(table: Table, others: Table, values: Values) -> Findings:
    return {name: _in_millimetres(worst(others, kind=f'supports_{name}'), 'largest position error '
                                  f'where all support points are moved {name}')
            for name in ('ahead', 'aside')}


def _against_mass(table: Table, others: Table, values: Values) -> Findings:
    """Compare the errors of an imbalance with those of a wrong mass."""
    sizes = sorted(set(map(abs, values.errors)))
    ratios = [worst(table, sizes[:1], kind='imbalance', robot=SENSING_POINT, speed_m_s=speed)
              / worst(others, kind='mass', speed_m_s=speed) for speed in values.speeds]
    return {'ratio': Finding(min(ratios), '', f'position error for {sizes[0]:.0%} of imbalance '
                             f'over that for {sizes[-1]:.0%} of mass, least over the speeds'),
            'shift': _in_millimetres(
                sizes[0] * values.support_spread * 0.5 * values.box_width,
                f'shift of the centre of friction by {sizes[0]:.0%} of imbalance')}


@dataclasses.dataclass(frozen=True)
class Mismatch:
    """
    One table of the thesis.

    :param figure: its number.
    :param kind: of the errors, of ``true_object.KINDS``.
    :param subject: what is wrong, for the title.
    :param label: of the abscissa.
    :param other_kinds: of errors that the sensing point executes for comparison.
    :param more_findings: function of (table of the errors, of the other ones, values).
    """

    figure: str
    kind: str
    subject: str
    label: str
    other_kinds: tuple[str, ...] = ()
    more_findings: Callable[[Table, Table, Values], Findings] = _no_findings

    def compute(self, values: Values, run_jobs: RunJobs) -> Outcome:
        """Execute the plans with every error of the kind."""
        tables = {'errors': error_table(values, run_jobs, [self.kind])}
        if self.other_kinds:
            tables['others'] = error_table(values, run_jobs, self.other_kinds, [SENSING_POINT])
        results = findings(tables['errors'], self.kind, values)
        results.update(self.more_findings(tables['errors'], tables.get('others', {}), values))
        return Outcome(tables, results, error_figure.page_table(tables['errors'], values))

    def draw(self, figure: Figure, outcome: Outcome, values: Values) -> None:
        """Draw the errors at the goal."""
        error_figure.draw(figure, outcome.tables['errors'], self.kind, self.label, values)


def _study(mismatch: Mismatch, observation: str, explanation: str) -> Study:
    return Study(mismatch.figure, f'Plans with a model mismatch: {mismatch.subject}', PARAMETERS,
                 mismatch.compute, mismatch.draw, observation, explanation, (7.6, 4.0))


STUDIES = (
    _study(Mismatch('T3.2', 'speed', 'the pushing velocity',
                    'error of the pushing velocity [%]'),
           'At a speed {most:.0%} off a plan for {high} m/s misses the goal by up to {fast:.0f} '
           'mm, one for {low} m/s by {slow:.1f} mm. For {least:.0%} at {middle} m/s it is '
           '{sensing:.1f} mm, to the symmetrical goal {symmetrical:.1f} mm.',
           'Friction has the same effect at any speed; only inertia grows. Opposite bends undo '
           'most of the rotation.'),
    _study(Mismatch('T3.3', 'friction', 'the friction under the box',
                    'error of the friction [%]', (), _same_as_speed),
           'Friction that is {most:.0%} wrong costs {fast:.0f} mm at {high} m/s and {slow:.1f} mm '
           'at {low} m/s. At {middle} m/s an open-loop point misses by {open_loop:.0f} mm for '
           '{least:.0%}, an open-loop wide robot its own goal by {wide:.1f} mm.',
           'Multiplying friction by k equals dividing the speed by the root of k, to '
           '{law:.3f} mm.'),
    _study(Mismatch('T3.4', 'mass', 'the mass', 'error of the mass [%]', ('load',), _load),
           'A mass {most:.0%} off costs {fast:.1f} mm at {high} m/s, {slow:.2f} mm at {low} m/s, '
           'and {load:.3f} mm where the inertia is off alike.',
           'Only the ratio of inertia to mass matters, until the turn is steady.'),
    _study(Mismatch('T3.5', 'inertia', 'the moment of inertia',
                    'error of the moment of inertia [%]'),
           'A moment of inertia {most:.0%} off costs {fast:.1f} mm at {high} m/s and {slow:.2f} '
           'mm at {low} m/s.',
           'It acts only after the touch and after changes of the angle.'),
    _study(Mismatch('T3.6', 'supports', 'the positions of the support points',
                    'support points further apart [%]', ('supports_ahead', 'supports_aside'),
                    _moved_supports),
           'Support points {most:.0%} further apart or closer cost {slow:.0f} mm at {low} m/s and '
           '{fast:.0f} mm at {high} m/s; moved ahead {ahead:.0f} mm, to the side {aside:.1f} mm.',
           'Their spread along the push determines how much the box rotates.'),
    _study(Mismatch('T3.7', 'imbalance', 'the centre of friction (rough on the left, smooth on '
                    'the right)', 'more friction left, less right [%]', ('mass',), _against_mass),
           '{least:.0%} more friction on the left and less on the right moves the centre of '
           'friction by {shift:.0f} mm. At {middle} m/s a sensing point misses by {sensing:.0f} '
           'mm, to the symmetrical goal by {symmetrical:.0f} mm. An open-loop wide robot misses '
           'its own goal by {wide:.0f} mm; an open-loop point loses the box.',
           'That is at least {ratio:.0f} times the effect of {most:.0%} of mass.'))
