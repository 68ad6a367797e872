"""Tracks of the robot's centre round the grown object, in the object frame."""

import math

LONGEST_ARC = 2.0


def tracks(body, start, goal):
    """
    Find the shortest tracks past the object: the straight one, or those to either side of it.

    :param body: ``Inflated``.
    :param start: (x, y), not inside [m].
    :param goal: the same.
    :return: list of tracks, each a list of (x, y, bend of the leg that leads there [rad]) without
        the start.
    """
    ahead = math.atan2(goal[1] - start[1], goal[0] - start[0])
    here, there = body.cone(*start), body.cone(*goal)
    if not (here.hides(ahead) and there.hides(ahead + math.pi)):
        return [[(*goal, 0.0)]]
    count = len(body.core)
    found = []
    for side, first, last, begin, end in (
            (1.0, here.right_index, there.left_index, here.right, there.left),
            (-1.0, here.left_index, there.right_index, here.left, there.right)):
        step = int(side)
        numbers = [(first + step * i) % count for i in range((step * (last - first)) % count + 1)]
        angles = [begin, *(_face(body.core, *pair) for pair in zip(numbers, numbers[1:])),
                  end + math.pi]
        found.append(_wound(body, side, numbers, angles, goal))
    return found


def _face(core, number, following):
    (x0, y0), (x1, y1) = core[number], core[following]
    return math.atan2(y1 - y0, x1 - x0)


def _wound(body, side, numbers, angles, goal):
    track = []

    def touch(number, angle):
        x, y = body.core[number]
        return (x + side * body.radius * math.sin(angle),
                y - side * body.radius * math.cos(angle))

    for number, before, after in zip(numbers, angles, angles[1:]):
        bend = (side * (after - before) + 1e-6) % (2.0 * math.pi) - 1e-6
        track.append((*touch(number, before), 0.0))
        pieces = max(1, math.ceil(bend / LONGEST_ARC))
        for i in range(pieces):
            share = (i + 1) / pieces
            track.append((*touch(number, before + side * share * bend), side * bend / pieces))
    return [*track, (*goal, 0.0)]
