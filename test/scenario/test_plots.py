"""Pictures of a task, and the command that draws them."""

import dataclasses
import functools

from matplotlib.figure import Figure
import numpy as np
from PIL import Image
from push_control.task.status import TaskState
from push_scenario.cli import main
from push_scenario.definition.loader import find_scenario, read_scenario, scenario_text
from push_scenario.plots.drawing import draw_map, PUSH_COLORS, segments_of
from push_scenario.simulation.loop import simulate
import pytest

# What it may be moved by before it is noticed [m].
OVERLAP, RUN_INTO = 0.01, 'the robot has run into the object'


@functools.lru_cache(maxsize=None)
def result_of(name):
    """Carry a task out, once."""
    return simulate(read_scenario(find_scenario(name)), planning_time=0.0)


def near(picture, color, tolerance=12):
    """Count the pixels of a colour."""
    wanted = [int(color[i:i + 2], 16) for i in (1, 3, 5)]
    pixels = np.asarray(picture.convert('RGB'), dtype=int)
    return int((np.abs(pixels - wanted).max(axis=-1) <= tolerance).sum())


@pytest.mark.parametrize('name', ['task_two_pushes', 'task_displacement'])
def test_phases_cover_the_tape(name):
    """One after the other; the object moves in pushes, not while the robot drives."""
    result = result_of(name)
    phases, objects = segments_of(result), result.tape.poses('object')
    assert phases[0].rows.start == 0 and phases[-1].rows.stop >= len(result.tape)
    for phase, after in zip(phases, phases[1:]):
        assert phase.rows.stop == after.rows.start + 1
    numbers = [phase.push for phase in phases if phase.push is not None]
    assert numbers == list(range(result.pushes))
    object_displacements = [shove.time for shove in result.scenario.simulation.object_displacements]
    # A robot that has lost its place runs into the object, and says so where it has seen it.
    still = 0.005 if not object_displacements else OVERLAP
    for phase, after in zip(phases, [*phases[1:], None]):
        way = np.ptp(objects[phase.rows, :2], axis=0).max()
        begin, end = result.tape['time'][phase.rows][[0, -1]]
        if phase.push is not None:
            assert way > 0.05
        elif phase.state in (TaskState.PLAN, TaskState.APPROACH) and not any(begin < t <= end for t in object_displacements):
            assert way < still or RUN_INTO in (phase.reason, after.reason)


def test_walls_are_drawn_where_they_are():
    """Also where the map lies askew."""
    case = read_scenario(find_scenario('task_map'))
    for angle in (0.0, 0.7):
        origin = dataclasses.replace(case.task.map.origin, theta=angle)
        turned = dataclasses.replace(case, task=dataclasses.replace(
            case.task, map=dataclasses.replace(case.task.map, origin=origin)))
        axes = Figure().add_subplot()
        draw_map(axes, turned)
        mesh, = axes.collections
        corners = mesh.get_coordinates()
        middles = 0.25 * (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:]
                          + corners[1:, 1:])
        clearance = turned.task.occupancy_map.clearance(middles.reshape(-1, 2))
        drawn = ~np.ma.getmaskarray(mesh.get_array()).ravel()
        assert drawn.any() and (clearance[drawn] < 0.0).all()
        resolution = turned.task.occupancy_map.resolution
        assert clearance[~drawn].min() > -0.5 * resolution


def test_replay_draws_a_task_and_judges_it(tmp_path, capsys):
    """The picture shows every push in its colour; the animation moves."""
    words = ['task_two_pushes', '--in-process', '--out', str(tmp_path)]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert 'pushes' in printed and 'time of the best single push' in printed
    with Image.open(tmp_path / 'task_two_pushes.png') as picture:
        assert min(picture.size) > 700
        for number, color in enumerate(PUSH_COLORS[:3]):
            assert (near(picture, color) > 300) == (number < 2)
    with Image.open(tmp_path / 'task_two_pushes.gif') as animation:
        assert animation.n_frames > 60
        assert near(animation, PUSH_COLORS[1]) == 0
        animation.seek(animation.n_frames - 1)
        assert near(animation, PUSH_COLORS[1]) > 50
    assert (tmp_path / 'task_two_pushes.gif').stat().st_size < 1.5e6


def test_a_task_that_is_not_done_in_time_ends_with_status_1(tmp_path, capsys):
    """The table says so; runs of two laws stand side by side."""
    text = scenario_text(read_scenario(find_scenario('task_approach')))
    path = tmp_path / 'hasty.yaml'
    path.write_text(text.replace('time_limit: 180', 'time_limit: 3'))
    words = [str(path), '--in-process', '--no-pictures', '--out', str(tmp_path / 'out')]
    assert main([*words, '--law', 'feedback', '--law', 'mpc']) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ['feedback', 'mpc', 'bound']
    assert any(line.split() == ['outcome', 'time_limit', 'time_limit'] for line in lines)
    assert {item.name for item in (tmp_path / 'out').iterdir()} == {
        'hasty.yaml', 'hasty_feedback.csv', 'hasty_mpc.csv'}
