"""Case study 3 as an experiment: boxes that swing back, and boxes that turn away."""

import math
from typing import get_args, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.parameters import Drive, RoundRobot
from studies.chapter2.side_push.setup import shifted_box
from studies.experiment.simulated import SimulatedPush
from studies.experiment.trial import sample_distances, Trial
from studies.framework import plot_style
from studies.framework.box import BOX
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, Record, RunJobs, Study, Table

DRIVES: tuple[Drive, ...] = get_args(Drive)
PARAMETERS = (Parameter('distances', 'm', 'centre of friction ahead of the contact, nearer than '
                        'the radius of the robot, and further'),
              Parameter('seeds', '', 'pushes of each box by each robot'),
              Parameter('length', 'm', 'driven by the robot from the first touch'),
              Parameter('robot_radius', 'm', 'radius of the robot'),
              Parameter('speed', 'm/s', 'speed of the robot, which is told to drive straight'),
              Parameter('rotation_deviation', 'rad', 'of the box as it was placed, std'),
              Parameter('lateral_deviation', 'm', 'of the robot as it was placed, std'),
              Parameter('friction_deviation', '', 'of the friction at each foot, relative, std'),
              Parameter('wheel_deviation', '', 'of the speed of the left wheel, relative, std'),
              *BOX)
# A box has turned away from there on [rad]; chosen.
TURNED_AWAY = math.radians(30.0)
MILLIMETRES = 1e3
# Measured: what one trial takes [s].
JOB_TIME = 0.2


def simulated_record(push: SimulatedPush) -> Record:
    """
    Simulate one trial.

    :return: rotation [rad] at each distance, by number.
    """
    return {str(index): rotation for index, rotation in enumerate(push.run().rotations.tolist())}


def compute(values: Values, run_jobs: RunJobs) -> Outcome:
    """Push each box by each robot, again and again."""
    pushes = {(drive, distance): [_push(values, drive, distance, seed)
                                  for seed in range(int(values.seeds))]
              for drive in DRIVES for distance in values.distances}
    records = iter(run_jobs(simulated_record, sum(pushes.values(), []), job_time=JOB_TIME))
    trials = {name: [_trial(next(records)) for _ in members] for name, members in pushes.items()}
    tables = {f'{drive}_{MILLIMETRES * distance:.0f}_mm': _table(members)
              for (drive, distance), members in trials.items()}
    near, far = ([trial for drive in DRIVES for trial in trials[drive, distance]]
                 for distance in (values.distances[0], values.distances[-1]))
    return Outcome(tables, {
        'pushes': Finding(float(len(near)), '', 'pushes of each box, by both robots'),
        'near': Finding(values.distances[0], 'm', 'nearest centre of friction'),
        'far': Finding(values.distances[-1], 'm', 'furthest centre of friction'),
        'near_end': Finding(_median_end(near), 'deg', 'rotation at the end, median size, nearest'),
        'far_end': Finding(_median_end(far), 'deg', 'the same, furthest'),
        'near_away': Finding(float(sum(map(has_turned_away, near))), '',
                             'boxes that turned away by 30 degrees, nearest'),
        'far_away': Finding(float(sum(map(has_turned_away, far))), '', 'the same, furthest')})


def has_turned_away(trial: Trial) -> bool:
    """Tell whether a box has turned away from straight ahead."""
    return bool(np.abs(trial.rotations).max() > TURNED_AWAY)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the rotations over the driven distance, a row for each robot."""
    panels = figure.subplots(len(DRIVES), len(values.distances), sharex=True, sharey=True,
                             squeeze=False)
    for row, drive in zip(panels, DRIVES):
        for axes, distance in zip(row, values.distances):
            table = outcome.tables[f'{drive}_{MILLIMETRES * distance:.0f}_mm']
            draw_trials(axes, [np.asarray(column) for name, column in table.items()
                               if name != 'distance_m'])
            axes.set_title(f'{drive}, centre of friction at {MILLIMETRES * distance:.0f} mm',
                           loc='left')
    label_panels(figure, panels[-1])


def draw_trials(axes: Axes, rotations: Sequence[np.typing.NDArray[np.float64]]) -> None:
    """
    Draw trials, those that turned away in another colour.

    :param rotations: of each trial, at ``sample_distances`` [rad].
    """
    axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
    for trial in rotations:
        degrees = np.degrees(trial)
        is_away = np.nanmax(np.abs(trial)) > TURNED_AWAY
        axes.plot(sample_distances(len(degrees)), degrees, linewidth=0.9, alpha=0.8,
                  color=plot_style.UNSTABLE if is_away else plot_style.STABLE)


def label_panels(figure: Figure, lowest: Sequence[Axes]) -> None:
    """Label the axes of all panels."""
    for axes in lowest:
        axes.set_xlabel('driven distance [m]')
    figure.supylabel('rotation of the box from straight ahead [degrees]', fontsize=9.0)


def _push(values: Values, drive: Drive, distance: float, seed: int) -> SimulatedPush:
    return SimulatedPush(
        shifted_box(values, distance), RoundRobot(radius=values.robot_radius, drive=drive),
        values.speed, values.length, values.rotation_deviation, values.lateral_deviation,
        values.friction_deviation, values.wheel_deviation, seed)


def _trial(record: Record) -> Trial:
    rotations = np.array([record[str(index)] for index in range(len(record))])
    return Trial(sample_distances(len(rotations)), rotations)


def _table(trials: Sequence[Trial]) -> Table:
    """Tabulate the rotations up to the end of the longest trial; nan behind the end of others."""
    count = max(len(trial.distances) for trial in trials)
    table: Table = {'distance_m': sample_distances(count)}
    for index, trial in enumerate(trials):
        padding = np.full(count - len(trial.rotations), math.nan)
        table[f'rotation_{index}_rad'] = np.concatenate([trial.rotations, padding])
    return table


def _median_end(trials: Sequence[Trial]) -> float:
    return math.degrees(float(np.median([abs(trial.rotations[-1]) for trial in trials])))


STUDIES = (Study(
    'side-push-experiment', 'Case study 3 as an experiment: repeated straight pushes on a side',
    PARAMETERS, compute, draw,
    'Of {pushes:.0f} boxes with a centre of friction at {near:.2f} m {near_away:.0f} turned away '
    'by 30 degrees; of as many at {far:.2f} m {far_away:.0f} did.',
    'At the end the median rotation is {near_end:.1f} and {far_end:.0f} degrees, as sensors tell.',
    (7.2, 5.2)),)
