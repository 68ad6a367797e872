"""Point robot: the planned push and its input, and what few constant pushing angles cost."""

from matplotlib.figure import Figure
import numpy as np
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
from studies.chapter3.setup import (
    draw_center, draw_difference, draw_inputs, draw_outlines, draw_push, input_table,
    path_difference, path_table, poses_at, push_problem, SEGMENTS, SETUP, SPEED,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: poses at which the box is drawn.
OUTLINES = 7
PERCENT = 100.0
CENTIMETRES = 100.0
COLOR = plot_style.SERIES[0][0]


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan one push."""
    plan = plan_push(push_problem(values, values.speed, values.segments))
    verification, inputs = verify(plan), input_table(plan)
    detour = plan.report['over_displacement_bound'] - 1.0
    return Outcome({'path': path_table(plan.trajectory), 'inputs': inputs}, {
        'duration': Finding(plan.trajectory.duration, 's', 'duration of the push'),
        'distance': Finding(float(inputs['end_m'][-1]), 'm', 'distance travelled by the contact'),
        'detour': Finding(PERCENT * detour, '%',
                          'duration above that of the straight displacement of the contact'),
        'first': Finding(float(inputs['rho_rad'][0]), 'rad', 'first pushing angle'),
        'last': Finding(float(inputs['rho_rad'][-1]), 'rad', 'last pushing angle'),
        'miss': Finding(verification.position_error, 'm', 'distance from the goal, integrated '
                        'independently'),
        'heading_miss': Finding(verification.heading_error, 'rad', 'heading error at the goal, '
                                'integrated independently')})


def compute_counts(values: Values, _: RunJobs) -> Outcome:
    """Plan the same push in several numbers of constant pushing angles."""
    tables: dict[str, Table] = {}
    distances: list[float] = []
    paths: list[Table] = []
    for count in values.segment_counts:
        plan = plan_push(push_problem(values, values.speed, count))
        path = tables[f'path_{count}'] = path_table(plan.trajectory)
        tables[f'inputs_{count}'] = input_table(plan)
        distances.append(float(plan.segment_ends[-1]))
        paths.append(path)
    durations = np.array(distances) / values.speed
    lost = PERCENT * (durations / durations[-1] - 1.0)
    differences = [float(path_difference(path, paths[-1]).max()) for path in paths]
    tables['durations'] = {'segments': values.segment_counts, 'duration_s': durations,
                           'above_most_percent': lost, 'path_from_most_m': differences}
    never_longer = bool((np.diff(durations) <= 0.0).all())
    return Outcome(tables, {
        'never_longer': Finding(float(never_longer), '',
                                'whether more segments never take longer'),
        'lost_fewest': Finding(float(lost[0]), '%',
                               'extra duration with the fewest segments'),
        'lost_six': Finding(float(np.interp(6.0, values.segment_counts, lost)), '%',
                            'extra duration with 6 segments'),
        'difference': Finding(CENTIMETRES * differences[0], 'cm', 'greatest distance of the path '
                              'of the middle with the fewest segments from that with the most'),
        'difference_six': Finding(CENTIMETRES * float(np.interp(
            6.0, values.segment_counts, differences)), 'cm', 'the same with 6 segments')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the path of the box, and its input."""
    above, below = figure.subplots(2, 1, height_ratios=(2.3, 1.0))
    path, inputs = outcome.tables['path'], outcome.tables['inputs']
    duration = path['time_s'][-1]
    draw_outlines(above, box(values), poses_at(path, np.linspace(0.0, duration, OUTLINES)))
    draw_center(above, path, color=COLOR)
    for start, angle in zip(inputs['begin_s'], inputs['rho_rad']):
        draw_push(above, path, start, angle)
    draw_inputs(below, inputs, 's', color=COLOR)
    below.set_xlim(0.0, duration)
    above.set_title('(a) trajectory of the object', loc='left')
    below.set_title('(b) input', loc='left')


def compute_smooth(values: Values, _: RunJobs) -> Outcome:
    """Plan the push once with a pushing angle that changes steadily, once with steps."""
    smooth = plan_push(push_problem(values, values.speed, values.smooth_segments,
                                    pushing_angles='linear'))
    steps = plan_push(push_problem(values, values.speed, values.segments))
    inputs = input_table(steps)
    # Each segment of the smooth angle leads from one angle to another: both of its ends.
    starts = np.concatenate([[0.0], smooth.segment_ends[:-1]])
    course = {'distance_m': np.column_stack([starts, smooth.segment_ends]).ravel(),
              'rho_rad': np.array(smooth.pushing_angles).ravel()}
    middles = 0.5 * (inputs['begin_m'] + inputs['end_m'])
    from_smooth = inputs['rho_rad'] - np.interp(middles, course['distance_m'], course['rho_rad'])
    shorter = float(inputs['end_m'][-1] / course['distance_m'][-1] - 1.0)
    return Outcome({'smooth': course, 'inputs': inputs}, {
        'steps': Finding(len(inputs['rho_rad']), '', 'number of constant pushing angles'),
        'lost': Finding(PERCENT * shorter, '%', 'distance travelled by the contact above that '
                        'with the smooth angle'),
        'from_smooth': Finding(float(np.abs(from_smooth).max()), 'rad', 'greatest distance of a '
                               'step from the smooth angle in its middle'),
        'span': Finding(float(np.ptp(course['rho_rad'])), 'rad', 'range of the smooth angle')})


def draw_smooth(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the smooth angle and its steps."""
    axes, course = figure.subplots(), outcome.tables['smooth']
    axes.plot(course['distance_m'], course['rho_rad'], label='smooth', **plot_style.series(1))
    draw_inputs(axes, outcome.tables['inputs'], label='piecewise constant', color=COLOR)
    axes.set_xlim(left=0.0)
    axes.legend(loc='best')


def draw_counts(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw paths, inputs and extra durations."""
    counts = values.segment_counts
    panels = figure.subplot_mosaic('AD;BC', height_ratios=(1.2, 1.0), width_ratios=(1.5, 1.0))
    paths_panel, inputs_panel, lost_panel = panels['A'], panels['B'], panels['C']
    paths = [outcome.tables[f'path_{count}'] for count in counts]
    draw_outlines(paths_panel, box(values), poses_at(paths[-1], paths[-1]['time_s'][[0, -1]]))
    for index, count in enumerate(counts):
        style = plot_style.series(index)
        if index in (0, len(counts) - 1):
            draw_center(paths_panel, paths[index], **style)
        else:
            draw_difference(panels['D'], paths[index], paths[-1], **style)
        draw_inputs(inputs_panel, outcome.tables[f'inputs_{count}'], label=f'{count} segments',
                    color=style['color'], linewidth=2.4 - 0.3 * index, solid_capstyle='butt')
    draw_difference(panels['D'], paths[0], paths[-1], **plot_style.series(0))
    panels['D'].set_ylim(bottom=0.0)
    panels['D'].set_title(f'against {counts[-1]} segments', loc='left')
    inputs_panel.legend(loc='lower right')
    table = outcome.tables['durations']
    lost_panel.plot(table['segments'][:-1], table['above_most_percent'][:-1], 'o-', color=COLOR)
    lost_panel.set_xscale('log')
    lost_panel.set_yscale('log')
    lost_panel.set_xticks(counts[:-1], [str(count) for count in counts[:-1]])
    lost_panel.minorticks_off()
    lost_panel.set_xlabel('segments')
    lost_panel.set_ylabel(f'duration above that\nwith {counts[-1]} segments [%]')


STUDIES = (
    Study('3.2', 'Piecewise constant approximation of the pushing angle',
          (*SETUP, SPEED, SEGMENTS, Parameter('smooth_segments', '', 'number of segments in which '
                                              'the smooth angle changes linearly')),
          compute_smooth, draw_smooth,
          'In their middle the {steps:.0f} steps are within {from_smooth:.2f} rad of the smooth '
          'angle, which has a range of {span:.2f} rad. They move the contact {lost:.2f}% further '
          'at most.',
          'The angle averaged over the distance rotates the box.', (6.4, 3.4)),
    Study('3.3', 'Point robot: trajectory of the object and input', (*SETUP, SPEED, SEGMENTS),
          compute, draw,
          'The box reaches its goal after {duration:.2f} s; the angle goes from {first:.2f} to '
          '{last:.2f} rad.',
          'Rotation to the left first moves the middle to the right: the contact travels '
          '{distance:.2f} m, {detour:.1f}% more than straight.', (6.4, 5.6)),
    Study('3.5', 'Point robot, another goal: trajectory of the object and input',
          (*SETUP, SPEED, SEGMENTS), compute, draw,
          'A goal to the side takes {duration:.2f} s, from {first:.2f} to {last:.2f} rad.',
          'The contact travels {distance:.2f} m, {detour:.1f}% more than straight.', (6.4, 5.6)),
    Study('3.4', 'Point robot: trajectories and inputs for several numbers of segments',
          (*SETUP, SPEED, Parameter('segment_counts', '', 'numbers of constant pushing angles')),
          compute_counts, draw_counts,
          'All inputs give nearly the same path. With two segments the middle is up to '
          '{difference:.0f} cm beside that with the most, with six {difference_six:.1f} cm. Two '
          'take {lost_fewest:.2f}% longer than the most, six {lost_six:.2f}%.',
          'A goal pose has as many numbers as two angles and a length.',
          (7.6, 5.2)))
