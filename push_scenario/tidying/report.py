"""What became of the objects of a room, as text and as plain values."""

from collections.abc import Sequence
import json
import math
from typing import Any

from push_control.task.code_text import code_text
from push_model.events import codes, sentence
from push_planner.rearrangement.problem import Move
from push_scenario.tidying.tidy import TidyProgress, TidyResult


def progress_text(progress: TidyProgress) -> str:
    """Say how many objects are at their goals, what comes next, and why."""
    start = f'{progress.placed} of {progress.goals} at their goals'
    moves = progress.plan.moves
    if not moves:
        return start
    return f'{start}, {progress.plan.time:.0f} s left: {move_text(moves)}'


def move_text(moves: Sequence[Move]) -> str:
    """
    Say what the first of some moves is for.

    :param moves: planned, at least one.
    """
    first, *later = moves
    if not first.is_temporary:
        return f'{first.name} to its goal'
    after = next((f', as {move.name} is next' for move in later if move.name != first.name), '')
    return f'{first.name} out of the way{after}'


def result_values(result: TidyResult) -> dict[str, Any]:
    """Describe a result as plain values, for JSON."""
    objects: dict[str, Any] = {}
    for name in result.poses:
        failure = result.failures.get(name)
        position, heading = result.errors(name)
        has_goal = name not in result.room.without_goal
        objects[name] = {
            'is_placed': result.is_placed(name), 'pose': list(result.poses[name]),
            'moves': sum(item.move.name == name for item in result.moves),
            'codes': code_text(codes(failure)) if failure else '',
            'reason': sentence(failure) if failure else '',
            **({'position_error': position, 'heading_error': heading} if has_goal else {})}
    return {'room': result.room.name, 'objects': objects, 'moves': len(result.moves),
            'pushes': sum(item.run.pushes for item in result.moves),
            'duration': result.duration, 'touches': result.touches}


def result_json(result: TidyResult) -> str:
    """Write a result as JSON, a line break at its end."""
    return json.dumps(result_values(result), indent=2) + '\n'


def result_text(result: TidyResult) -> str:
    """Write a result as a table for people."""
    width = max(map(len, result.poses))
    lines = [f'{result.room.name}: {len(result.moves)} moves, '
             f'{sum(item.run.pushes for item in result.moves)} pushes, {result.duration:.1f} s, '
             f'{result.touches} touches']
    for name in result.poses:
        position, heading = result.errors(name)
        place = (f'{1e3 * position:.1f} mm and {math.degrees(heading):.2f} degrees from its goal')
        if name in result.room.without_goal:
            place = 'has no goal'
        failure = result.failures.get(name)
        reason = f'; {sentence(failure)}' if failure and not result.is_placed(name) else ''
        mark = 'done' if result.is_placed(name) else 'FAILED'
        lines.append(f'  {name.ljust(width)}  {mark.ljust(6)}  {place}{reason}')
    return '\n'.join(lines)
