"""Figure and animation of runs, with one or many pushes."""

import dataclasses
import functools

from helpers.tapes import make_result, make_tape, straight_plan, TIMES
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
import numpy as np
from PIL import Image
from push_control.task.status import TaskState
from push_scenario.definition.loader import load_scenario
from push_scenario.plots import animation
from push_scenario.plots.drawing import draw_map, GOAL, PUSH_COLORS, segments_of, WARNING
from push_scenario.plots.figure import _scene, draw_figure
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome, RunResult
import pytest


@functools.lru_cache(maxsize=None)
def result_of(name):
    """Simulate a task, once."""
    return simulate(load_scenario(name), planning_time=0.0)


def near(picture, color, tolerance=12):
    """Count the pixels of a colour."""
    channels = [int(color[i:i + 2], 16) for i in (1, 3, 5)]
    pixels = np.asarray(picture.convert('RGB'), dtype=int)
    return int((np.abs(pixels - channels).max(axis=-1) <= tolerance).sum())


def test_a_single_push_is_one_segment():
    """From the start of the tape to the end of the push; then the robot is done."""
    tape = make_tape(object_x=0.2 * TIMES, robot_x=0.2 * TIMES)
    first, last = segments_of(make_result(tape, straight_plan(), (2.0, 0.0, 0.0)))
    assert (first.state, first.push, first.rows.start) == (TaskState.PUSH, 0, 0)
    assert (last.state, last.push) == (TaskState.DONE, None)
    assert first.color == PUSH_COLORS[0] and last.rows.stop == len(TIMES)


def test_the_map_is_drawn_where_it_is():
    """Also where its axes are rotated."""
    case = load_scenario('task_map')
    for angle in (0.0, 0.7):
        origin = dataclasses.replace(case.task.map.origin, theta=angle)
        rotated = dataclasses.replace(case, task=dataclasses.replace(
            case.task, map=dataclasses.replace(case.task.map, origin=origin)))
        axes = Figure().add_subplot()
        draw_map(axes, rotated)
        mesh, = axes.collections
        corners = mesh.get_coordinates()
        centers = 0.25 * (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:]
                          + corners[1:, 1:])
        clearance = rotated.task.occupancy_map.clearance(centers.reshape(-1, 2))
        drawn = ~np.ma.getmaskarray(mesh.get_array()).ravel()
        assert drawn.any() and (clearance[drawn] < 0.0).all()
        resolution = rotated.task.occupancy_map.resolution
        assert clearance[~drawn].min() > -0.5 * resolution


@pytest.mark.slow
def test_figure_and_animation_show_every_push_in_its_colour(tmp_path, monkeypatch):
    """The animation moves; a few frames of it show that."""
    monkeypatch.setattr(animation, 'FRAMES', 10)
    monkeypatch.setattr(animation, 'FINAL_FRAMES', 2)
    results = [result_of('task_demo')]
    pushes = results[0].pushes
    assert pushes > 1
    draw_figure(results, tmp_path / 'task.png')
    animation.draw_animation(results, tmp_path / 'task.gif')
    with Image.open(tmp_path / 'task.png') as picture:
        assert min(picture.size) > 700
        for number, color in enumerate(PUSH_COLORS[:pushes + 1]):
            assert (near(picture, color) > 300) == (number < pushes)
    with Image.open(tmp_path / 'task.gif') as moving:
        assert moving.n_frames > 10
        assert near(moving, PUSH_COLORS[0]) == 0
        moving.seek(moving.n_frames - 1)
        assert near(moving, PUSH_COLORS[0]) > 50


@pytest.mark.slow
def test_runs_stand_side_by_side(tmp_path):
    """Two runs of one push make a figure that is wider than that of one, not higher."""
    tape = make_tape(object_x=0.2 * TIMES, robot_x=0.2 * TIMES - 0.4, mode=1, force_n=1.0)
    run = make_result(tape, straight_plan(), (2.0, 0.0, 0.0))
    sizes = []
    for count in (1, 2, 3):
        path = tmp_path / f'{count}.png'
        draw_figure([dataclasses.replace(run, control_law=law)
                     for law in ('feedback', 'mpc', 'open_loop')[:count]], path)
        with Image.open(path) as picture:
            sizes.append(picture.size)
            assert near(picture, PUSH_COLORS[0]) > 300
    (_, height), (two, lower), (three, _) = sizes
    assert two < three and lower <= height


def missed_run():
    """Make a run in open loop that is done 1 m before its goal."""
    tape = make_tape(object_x=0.1 * TIMES, robot_x=0.1 * TIMES - 0.4, mode=1, force_n=1.0)
    return dataclasses.replace(make_result(tape, straight_plan(), (2.0, 0.0, 0.0)),
                               control_law='open_loop')


def test_a_missed_goal_is_drawn_in_the_colour_of_warnings(tmp_path):
    """With its bounds, and not in the green of a goal that is reached."""
    figure = Figure()
    axes = figure.add_subplot()
    _scene(axes, missed_run())
    title = axes.get_title(loc='left')
    assert 'missed after 9.0 s, 1000 mm' in title and 'bounds: 10.0 mm' in title
    assert axes._left_title.get_color() == WARNING
    colors = {to_hex(patch.get_facecolor()) for patch in axes.patches}
    assert to_hex(GOAL) not in colors and to_hex(WARNING) in colors


def test_a_state_that_is_entered_with_the_end_is_drawn(tmp_path):
    """After the last row of the tape: it has that one."""
    run = missed_run()
    first, last = run.history
    late = dataclasses.replace(run, history=(first, last._replace(time=TIMES[-1] + 0.01)))
    assert [segment.rows for segment in segments_of(late)] == [
        slice(0, len(TIMES)), slice(len(TIMES) - 1, len(TIMES))]
    draw_figure([late], tmp_path / 'late.png')


def test_a_run_in_which_nothing_moved_is_not_drawn():
    """It has no tape."""
    refused = RunResult(load_scenario('unreachable_goal'), 'feedback', Outcome.REFUSED, 'too far')
    with pytest.raises(ValueError, match='RunResult.tape: got None for unreachable_goal'):
        segments_of(refused)
