"""A plan of a single push, and its file: ``*.npz`` with arrays, and the rest as JSON."""

from collections.abc import Mapping
import dataclasses
import functools
import json
import os
from typing import Any, NamedTuple, Protocol, Union

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.trajectory import COLUMNS, PushStyle, PushTrajectory
from push_planner.problem import InitialMotion, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.plan_drawing import draw_plan

FilePath = Union[str, 'os.PathLike[str]']
# Values at the start and the end of each segment.
Pairs = tuple[tuple[float, float], ...]
# Version of the file format.
FORMAT = 2
ARRAYS = ('times',) + COLUMNS


class Switch(NamedTuple):
    """
    A jump of the pushing angle, and what it takes if it happens at once.

    :param s: path length of the contact where it is [m].
    :param change: change of the pushing angle [rad]; at the first touch the angle itself.
    :param d_omega: jump of the object's yaw rate [rad/s].
    :param normal_impulse: J_n [N s].
    :param tangential_impulse: J_t [N s].
    :param in_cone: whether the impulse lies within the nominal friction cone.
    :param blend_distance: least distance over which the change must be spread for the contact to
        hold [m]; 0 inside the cone.
    """

    s: float
    change: float
    d_omega: float
    normal_impulse: float
    tangential_impulse: float
    in_cone: bool
    blend_distance: float


class PlannedMotion(Protocol):
    """Motion of a plan, which need not be sampled before it is read."""

    @property
    def duration(self) -> float:
        """Duration of the push [s]."""
        ...

    @property
    def path_length(self) -> float:
        """Path length of the contact [m]."""
        ...

    def recorded(self) -> 'RecordedMotion':
        """Sample and describe it; the same object each time."""
        ...


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedMotion:
    """
    Motion of a plan, sampled and described.

    :param trajectory: ``PushTrajectory`` in the world; twists are those after a switch.
    :param pushing_angles: pushing angle at the start and the end of each segment, linear in the
        path length of the contact between, from the normal to the velocity imposed at the contact
        [rad].
    :param segment_ends: path length of the contact at the end of each segment, increasing [m].
    :param speeds: speed of the contact at the start and the end of each segment; its square is
        linear in the path length between [m/s].
    :param switches: ``Switch`` of every jump, the first touch included: the impulse it takes.
    :param figures: further figures by name.
    """

    trajectory: PushTrajectory
    pushing_angles: Pairs
    segment_ends: tuple[float, ...]
    speeds: Pairs
    switches: tuple[Switch, ...]
    figures: Mapping[str, Any]

    @property
    def duration(self) -> float:
        """Duration of the push [s]."""
        return self.trajectory.duration

    @property
    def path_length(self) -> float:
        """Path length of the contact [m]."""
        return self.segment_ends[-1]

    def recorded(self) -> 'RecordedMotion':
        """Return itself."""
        return self


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """
    A push that reaches its goal.

    :param problem: the ``PushProblem`` that it answers.
    :param motion: ``PlannedMotion``.
    :param notes: how it was found, by name.
    """

    problem: PushProblem
    motion: PlannedMotion
    notes: Mapping[str, Any]

    @property
    def trajectory(self) -> PushTrajectory:
        """Samples in the world; see ``RecordedMotion``, also for all that follows."""
        return self.motion.recorded().trajectory

    @property
    def pushing_angles(self) -> Pairs:
        """Pushing angle at the start and the end of each segment [rad]."""
        return self.motion.recorded().pushing_angles

    @property
    def segment_ends(self) -> tuple[float, ...]:
        """Path length of the contact at the end of each segment [m]."""
        return self.motion.recorded().segment_ends

    @property
    def speeds(self) -> Pairs:
        """Speed of the contact at the start and the end of each segment [m/s]."""
        return self.motion.recorded().speeds

    @property
    def switches(self) -> tuple[Switch, ...]:
        """Jumps of the pushing angle, the first touch included."""
        return self.motion.recorded().switches

    @functools.cached_property
    def report(self) -> dict[str, Any]:
        """Figures of the motion and notes, by name."""
        return {**self.motion.recorded().figures, **self.notes}

    def __repr__(self) -> str:
        """Say in one line what it is."""
        return (f'<Plan of {self.motion.path_length:.2f} m in {self.motion.duration:.1f} s at a '
                f'{self.problem.contact.kind}>')

    def plot(self, axes: Any) -> None:
        """
        Draw bodies and paths.

        :param axes: axes of matplotlib.
        """
        draw_plan(axes, self.problem.obj, self.problem.robot.radius, self.trajectory)

    def save(self, path: FilePath) -> None:
        """
        Write the plan to a file.

        :param path: the file, by convention ``*.npz``.
        """
        problem = self.problem
        text = {'format': FORMAT, 'style': self.trajectory.style.value,
                'problem': {
                    **{name: dataclasses.asdict(getattr(problem, name))
                       for name in ('obj', 'robot', 'contact', 'settings')},
                    **{name: list(getattr(problem, name)) for name in ('start', 'goal', 'motion')},
                    'normal': problem.normal, 'heading': problem.heading},
                'pushing_angles': self.pushing_angles, 'segment_ends': self.segment_ends,
                'speeds': self.speeds, 'switches': [list(switch) for switch in self.switches],
                'report': self.report}
        arrays = {name: getattr(self.trajectory, name) for name in ARRAYS}
        with open(path, 'wb') as file:
            np.savez(file, plan=np.array(json.dumps(text, default=_plain)), **arrays)

    @classmethod
    def load(cls, path: FilePath) -> 'Plan':
        """
        Read a plan that ``save`` wrote.

        :param path: the file.
        :raises ValueError: where it is no plan, or of another format.
        """
        with np.load(path) as data:
            missing = sorted(({'plan'} | set(ARRAYS)) - set(data.files))
            if missing:
                raise ValueError(f'{path}: got no {", ".join(missing)}, expected a Plan')
            text = json.loads(str(data['plan']))
            if text['format'] != FORMAT:
                raise ValueError(f'{path}: got format {text["format"]}, expected {FORMAT}')
            trajectory = PushTrajectory(**{name: data[name] for name in ARRAYS},
                                        style=PushStyle(text['style']))
        return cls(_problem(text['problem']), RecordedMotion(
            trajectory, tuple(map(tuple, text['pushing_angles'])), tuple(text['segment_ends']),
            tuple(map(tuple, text['speeds'])),
            tuple(Switch(*switch) for switch in text['switches']), text['report']), {})


def _problem(values: dict[str, Any]) -> PushProblem:
    obj = dict(values['obj'])
    obj['supports'] = tuple(Support(**support) for support in obj['supports'])
    obj['outline'] = tuple(map(tuple, obj['outline']))
    return PushProblem(PushedObject(**obj), RoundRobot(**values['robot']),
                       Contact(**values['contact']), Pose(*values['start']), values['normal'],
                       values['heading'], Pose(*values['goal']),
                       PlannerSettings(**values['settings']), InitialMotion(*values['motion']))


def _plain(value: object) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f'value: got {value!r}, expected a plain number or text')
