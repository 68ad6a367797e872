"""Which kind of push is selected for which goal."""

import dataclasses
import enum
import functools
import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_primitives.selection import (
    estimate_travel_times, select_push, SelectedPush, SelectionQuery,
)
from push_primitives.store import PushPrimitives
from push_primitives.weights import FrictionBelief
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, Record, RunJobs, Study, Table
from studies.primitives.setup import named_object, named_primitives, OBJECT, ROBOT

PARAMETERS = (
    OBJECT, ROBOT,
    Parameter('distances', 'm', 'distances of the goals'),
    Parameter('bearings', '', 'number of bearings of the goals'),
    Parameter('headings', 'rad', 'headings of the goals'),
    Parameter('robot_distance', 'm', 'distance of the robot behind the object'),
    Parameter('pushing_speed', 'm/s', 'speed of pushes'))
# What is known of friction before the first push, as standard deviations; chosen.
CENTER_DEVIATION = 0.02
FRICTION_DEVIATION = 0.1
# Shorter pushes are taps [m]; chosen: they end before steering could act.
TAP_LENGTH = 0.09
# Headings up to this count as little rotation [rad]; chosen.
SMALL_HEADING = 0.2
# Places nearer to the middle than this part of the largest offset are in the middle; chosen.
MIDDLE_FRACTION = 0.35
# Pushes with less tilt are along the normal [rad]; the least tilt of the table is twice as large.
MIN_ANGLE = 0.075
PERCENT = 100.0


class Kind(enum.Enum):
    """Kinds of straight pushes."""

    TAP = 'tap'
    ARC = 'arc'
    TILTED = 'tilted'
    MIDDLE = 'straight, near the middle'
    BESIDE = 'straight, beside the middle'


# Colour and marker of each kind, which differ in grey print as well.
MARKERS = {Kind.TAP: ('o', plot_style.SERIES[3][0]), Kind.ARC: ('D', plot_style.SERIES[4][0]),
           Kind.TILTED: ('^', plot_style.SERIES[0][0]), Kind.MIDDLE: ('s', plot_style.LIGHT),
           Kind.BESIDE: ('v', plot_style.SERIES[2][0])}


@dataclasses.dataclass(frozen=True)
class PushSelection:
    """
    Selects the first push to a goal, as the function of many jobs.

    :param object: name of the object.
    :param robot: name of the robot.
    :param robot_distance: of the robot behind the object [m].
    :param pushing_speed: of the push [m/s].
    """

    object: str
    robot: str
    robot_distance: float
    pushing_speed: float

    def __call__(self, job: dict[str, Any]) -> Record:
        """
        Select the push to a goal.

        :param job: ``distance`` [m], ``bearing`` and ``heading`` [rad].
        :return: kind, place, tilt, curvature and length of the push, and the expected time.
        """
        primitives, belief = _knowledge(self.object, self.robot)
        goal = Pose(job['distance'] * math.cos(job['bearing']),
                    job['distance'] * math.sin(job['bearing']), job['heading'])
        robot_pose = Pose(-self.robot_distance, 0.0, 0.0)
        times = estimate_travel_times(primitives, robot_pose)
        known = {tuple(start): time for start, time in zip(primitives.table.starts.tolist(),
                                                           times.tolist())}
        selected = select_push(
            primitives, SelectionQuery(goal, robot_pose, belief, 0.0, self.pushing_speed),
            lambda start: known[tuple(start)])
        assert selected is not None
        table, row = primitives.table, selected.primitive
        return {
            'kind': kind_of(primitives, selected).value,
            'place': int(table.point_indices[row]),
            'tilt': float(table.approach_angles[row]),
            'curvature': float(table.curvatures[row]), 'length': selected.length,
            'expected_time': selected.expected_time}


@functools.lru_cache(maxsize=4)
def _knowledge(object_name: str, robot_name: str) -> tuple[PushPrimitives, FrictionBelief]:
    obj = named_object(object_name)
    belief = FrictionBelief(friction_center(obj), obj.contact_friction_coefficient,
                            CENTER_DEVIATION, FRICTION_DEVIATION)
    return named_primitives(object_name, robot_name), belief


def kind_of(primitives: PushPrimitives, selected: SelectedPush) -> Kind:
    """
    Sort a push by its kind.

    :param primitives: with the table.
    :param selected: the push.
    :return: its kind.
    """
    table, row = primitives.table, selected.primitive
    if selected.length < TAP_LENGTH:
        return Kind.TAP
    if table.curvatures[row]:
        return Kind.ARC
    if abs(table.approach_angles[row]) > MIN_ANGLE:
        return Kind.TILTED
    point = table.face_points[int(table.point_indices[row])]
    largest = max(abs(other.offset) for other in table.face_points if other.face == point.face)
    return Kind.MIDDLE if abs(point.offset) < MIDDLE_FRACTION * largest else Kind.BESIDE


def compute(values: Values, run_jobs: RunJobs) -> Outcome:
    """Select a push for every goal."""
    # Made once here, not by every worker.
    _knowledge(values.object, values.robot)
    bearings = np.linspace(0.0, 2.0 * math.pi, int(values.bearings), endpoint=False)
    jobs = [{'distance': distance, 'bearing': bearing, 'heading': heading}
            for heading in values.headings for distance in values.distances
            for bearing in bearings.tolist()]
    records = run_jobs(PushSelection(values.object, values.robot, values.robot_distance,
                                     values.pushing_speed), jobs)
    table: Table = {f'{name}_{unit}': np.array([job[name] for job in jobs]) for name, unit in (
        ('distance', 'm'), ('bearing', 'rad'), ('heading', 'rad'))}
    table['kind'] = [record['kind'] for record in records]
    for name, unit in (('place', ''), ('tilt', '_rad'), ('curvature', '_per_m'), ('length', '_m'),
                       ('expected_time', '_s')):
        table[f'{name}{unit}'] = np.array([float(record[name]) for record in records])
    return Outcome({'selected': table}, _findings(table))


def _findings(table: Table) -> dict[str, Finding]:
    kinds = np.array(table['kind'])
    findings = {'goals': Finding(len(kinds), '', 'number of goals')}
    for kind in Kind:
        findings[kind.name.lower()] = Finding(PERCENT * float(np.mean(kinds == kind.value)), '%',
                                              f'share of goals whose first push is {kind.value}')
    is_tap = kinds == Kind.TAP.value
    near = (table['distance_m'] <= TAP_LENGTH) & (np.abs(table['heading_rad']) <= SMALL_HEADING)
    findings['near_tap'] = Finding(PERCENT * float(np.mean(is_tap[near])) if near.any() else 0.0,
                                   '%', 'share of taps for goals nearer than the longest tap, '
                                   'with little rotation')
    pushes = table['length_m'][~is_tap]
    findings['length'] = Finding(float(np.median(pushes)) if len(pushes) else 0.0, 'm',
                                 'median length of the other pushes')
    return findings


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the kind of push over distance and bearing, for each heading."""
    table = outcome.tables['selected']
    columns = 2 if len(values.headings) > 1 else 1
    rows = math.ceil(len(values.headings) / columns)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, heading in zip(panels.flat, values.headings):
        _draw_panel(axes, table, heading)
        axes.set_title(f'heading of the goal {math.degrees(heading):.0f} deg', loc='left')
        axes.label_outer()
    for axes in panels.flat[len(values.headings):]:
        axes.set_visible(False)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc='outside upper right', ncols=3)


def _draw_panel(axes: Axes, table: Table, heading: float) -> None:
    kinds = np.array(table['kind'])
    at_heading = np.isclose(table['heading_rad'], heading)
    for kind, (marker, color) in MARKERS.items():
        rows = at_heading & (kinds == kind.value)
        axes.scatter(np.degrees(table['bearing_rad'][rows]), table['distance_m'][rows], s=42.0,
                     marker=marker, color=color, edgecolors=plot_style.INK, linewidths=0.6,
                     label=kind.value)
    axes.set_yscale('log')
    distances = np.unique(table['distance_m'])
    axes.set_yticks(distances, [f'{distance:g}' for distance in distances])
    axes.minorticks_off()
    axes.set_xticks(np.arange(0.0, 361.0, 90.0))
    axes.set_xlabel('bearing of the goal [deg]')
    axes.set_ylabel('distance of the goal [m]')


STUDIES = (
    Study('P.8', 'Which push comes first', PARAMETERS, compute, draw,
          'Of the first pushes to {goals:.0f} goals {tilted:.0f} % are tilted, {arc:.0f} % arcs, '
          '{beside:.0f} % along the normal beside the middle of a face, {middle:.0f} % near its '
          'middle and {tap:.0f} % taps. Within 9 cm and 10 degrees of the goal {near_tap:.0f} % '
          'begin with a tap.',
          'The selection weighs the remaining time. Tilts near the end of a face turn most '
          'surely. Pushes at the middle do not turn the object, but leave its heading to chance. '
          'Arcs displace it a little sideways. All but taps are long (median {length:.2f} m) and '
          'may end roughly, as another push follows.', (8.8, 7.4)),)
