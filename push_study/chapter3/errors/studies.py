"""What a wrong belief costs at the goal: speed, friction, mass, inertia, feet, friction centre."""

import functools
import math

from push_study.chapter3.errors import picture as plan_errors_picture
from push_study.chapter3.errors.mismatch_rollout import replay
from push_study.chapter3.errors.played_push import (
    BLIND, error_table, FELT, PARAMETERS, PlayedPush, WIDE, worst,
)
from push_study.chapter3.errors.truth import truth
from push_study.framework.study import Finding, Outcome, Study

MILLI = 1000.0


def _millimetres(length, meaning):
    return Finding(MILLI * length, 'mm', meaning)


def findings(table, kind, values):
    """
    Say what the errors of one kind do.

    :param table: of ``error_table``.
    :param kind: of the errors.
    :param values: ``Values`` with ``PARAMETERS``.
    :return: dict of ``Finding``.
    """
    sizes = sorted(set(map(abs, values.errors)))
    most, text = [sizes[-1]], f'largest position error of the point for {sizes[-1]:.0%}'
    first, second = (worst(table, [size], kind=kind, robot=FELT, speed_m_s=values.blind_speed)
                     for size in sizes[:2])
    found = {
        'none': _millimetres(worst(table, [0.0]), 'largest position error without any'),
        'growth': Finding(math.log(second / first) / math.log(sizes[1] / sizes[0]), '',
                          'power of the error with which the position error begins to grow')}
    for name, speed in (('slow', values.speeds[0]), ('fast', values.speeds[-1])):
        found[name] = _millimetres(worst(table, most, kind=kind, robot=FELT, speed_m_s=speed),
                                   f'{text} at {speed:g} m/s')
    for name, robot in (('felt', FELT), ('blind', BLIND), ('wide', WIDE)):
        rows = {'kind': kind, 'robot': robot, 'speed_m_s': values.blind_speed}
        found[name] = _millimetres(worst(table, sizes[:1], **rows),
                                   f'largest position error for {sizes[0]:.0%}, {robot}, at '
                                   f'{values.blind_speed:g} m/s')
        found[f'{name}_friction'] = Finding(worst(table, sizes[:1], 'friction_usage', **rows), '',
                                            'share of the friction angle that this takes')
    for name, value, meaning in (('least', sizes[0], 'smallest error'),
                                 ('most', sizes[-1], 'largest error')):
        found[name] = Finding(value, '', f'{meaning} that is played')
    for name, value, meaning in (('low', values.speeds[0], 'first speed'),
                                 ('high', values.speeds[-1], 'last speed'),
                                 ('middle', values.blind_speed, 'speed of the blind robots')):
        found[name] = Finding(value, 'm/s', meaning)
    return found


def _compute(kind, more, values, batch):
    kinds, add = more
    table = error_table(values, batch, [kind])
    extra = error_table(values, batch, kinds, [FELT]) if kinds else {}
    found = findings(table, kind, values)
    found.update(add(table, extra, values))
    return Outcome({'errors': table, **({'others': extra} if kinds else {})}, found)


def _nothing(table, others, values):
    return {}


def _same_as_speed(table, others, values):
    """Play the opposite change of the speed: what is left is the distance of the ends."""
    push, distances = PlayedPush.of(values), []
    for error in values.errors:
        answer = push.plan(values.speeds[-1], FELT)
        rough = replay(answer, truth(push.object, 'friction', error)[0])
        slow = replay(answer, pace=1.0 / math.sqrt(1.0 + error))
        distances.append(math.dist(rough.pose[:2], slow.pose[:2]))
    return {'law': _millimetres(max(distances), 'largest distance between the ends with friction '
                                'k times as high and with speed less by the root of k')}


def _load(table, others, values):
    return {'load': _millimetres(worst(others), 'largest position error where mass and inertia '
                                 'are wrong alike')}


def _moved_feet(table, others, values):
    return {name: _millimetres(worst(others, kind=f'feet_{name}'), 'largest position error where '
                               f'all feet are moved {name}') for name in ('ahead', 'aside')}


def _against_mass(table, others, values):
    sizes = sorted(set(map(abs, values.errors)))
    times = [worst(table, sizes[:1], kind='imbalance', robot=FELT, speed_m_s=speed)
             / worst(others, kind='mass', speed_m_s=speed) for speed in values.speeds]
    return {'times': Finding(min(times), '', f'position error for {sizes[0]:.0%} of imbalance '
                             f'over that for {sizes[-1]:.0%} of mass, least over the speeds'),
            'shift': _millimetres(sizes[0] * values.feet * 0.5 * values.box_width,
                                  f'shift of the friction centre by {sizes[0]:.0%} of imbalance')}


WHICH = (
    ('T3.2', 'speed', 'the pushing velocity', ((), _nothing),
     'Pushed {most:.0%} too fast or too slow, a plan for {high} m/s misses the goal by up to '
     '{fast:.0f} mm, one for {low} m/s by {slow:.1f} mm.',
     'Over the same way friction does the same at any speed, and only inertia grows, with the '
     'square of the speed: slow plans hold at any slow speed.'),
    ('T3.3', 'friction', 'the friction under the box', ((), _same_as_speed),
     'Friction that is {most:.0%} wrong under all feet costs {fast:.0f} mm at {high} m/s and '
     '{slow:.1f} mm at {low} m/s; at {middle} m/s a blind point misses by {blind:.0f} mm already '
     'for {least:.0%}, a blind wide robot by {wide:.1f} mm.',
     'Slowly, friction in proportion everywhere gives the same motion; fast, friction k times as '
     'high is the same as speed less by the root of k: both end {law:.3f} mm apart.'),
    ('T3.4', 'mass', 'the mass', (('load',), _load),
     'A mass that is {most:.0%} wrong costs {fast:.1f} mm at {high} m/s, {slow:.2f} mm at {low} '
     'm/s, and nothing ({load:.3f} mm) where the moment of inertia is wrong alike.',
     'Friction grows with the mass as inertia does, so that only the share of the moment of '
     'inertia to the mass is left, and that counts only until the turn is steady.'),
    ('T3.5', 'inertia', 'the moment of inertia', ((), _nothing),
     'A moment of inertia that is {most:.0%} wrong costs {fast:.1f} mm at {high} m/s and '
     '{slow:.2f} mm at {low} m/s.',
     'The steady turn does not depend on it; only the turn after the first touch and after each '
     'change of the pushing angle settles over a longer or shorter way.'),
    ('T3.6', 'feet', 'the places of the feet', (('feet_ahead', 'feet_aside'), _moved_feet),
     'Feet {most:.0%} further apart or closer than believed cost {slow:.0f} mm at {low} m/s and '
     '{fast:.0f} mm at {high} m/s; all moved ahead by as much {ahead:.0f} mm, all moved aside '
     '{aside:.2f} mm.',
     'The spread of the feet along the push sets how much the box turns at a pushing angle, at '
     'any speed; feet that are moved as a whole carry other loads, which keep the friction centre '
     'under the mass centre.'),
    ('T3.7', 'imbalance', 'the friction centre (rough on the left, smooth on the right)',
     (('mass',), _against_mass),
     'With {least:.0%} more friction on the left and less on the right, which moves the friction '
     'centre by {shift:.0f} mm, a point that feels the object misses by {felt:.0f} mm at {middle} '
     'm/s, and at any speed by at least {times:.0f} times as much as for {most:.0%} of mass; a '
     'blind wide robot misses by {wide:.0f} mm, and a blind point loses the box.',
     'A push beside the friction centre turns the box all the way, whatever the speed; on a wide '
     'robot the box rolls only until the push leads through the friction centre again.'))
LABELS = {'speed': 'error of the pushing velocity [%]', 'friction': 'error of the friction [%]',
          'mass': 'error of the mass [%]', 'inertia': 'error of the moment of inertia [%]',
          'feet': 'feet further apart [%]',
          'imbalance': 'more friction left, less right [%]'}


def _study(figure, kind, what, more, seen, why):
    def draw(picture, outcome, values):
        plan_errors_picture.draw(picture, outcome.tables['errors'], kind, LABELS[kind], values)

    return Study(figure, f'Plans played with a wrong belief: {what}', PARAMETERS,
                 functools.partial(_compute, kind, more), draw, seen, why, (7.6, 4.0))


STUDIES = tuple(_study(*row) for row in WHICH)
