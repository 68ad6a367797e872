"""
Messages of the page: what it is shown of a run, in the order in which that happened.

A message is a mapping with the key ``type``, as JSON has them. A live page receives them one by
one, a report holds those of whole runs; the page treats both alike. Rows have the columns of a
``Tape``, and behind them those of ``BELIEF_COLUMNS`` where it is known what the robot believes.
All quantities have SI units; poses are (x, y, theta) in the world, None stands for what is not
known.
"""

from collections.abc import Iterable, Mapping, Sequence
import math
from typing import Any

import numpy as np
from push_control.perception.view import View
from push_control.task.status import StateChange
from push_model.base_knowledge import BaseKnowledge
from push_model.events import sentence
from push_model.friction import friction_center
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import Path
from push_planner.planned_pushes import PlannedPush
from push_planner.rearrangement.problem import OrderPlan
from push_planner.refusal_marks import RefusalMarks
from push_planner.task_plan import TaskPlan
from push_scenario.definition.floor_map import FREE, OCCUPIED
from push_scenario.definition.scenario import GoalBounds, Scenario
from push_scenario.tidying.report import move_text
from push_sim_node.camera import CameraSettings
from push_tidy.tidy_supervisor import ObjectState, ObjectStatus
from push_view.wall_contact import WallContact

Message = dict[str, Any]

# Decimals of what is sent: 10 um, and as fine for angles and forces; chosen: below what a screen
# shows at any zoom.
DECIMALS = 5
# Samples of a planned path; chosen: enough to look smooth.
PLAN_SAMPLES = 40


def scene_message(title: str, obj: PushedObject, robot: RoundRobot, columns: Sequence[str], *,
                  description: str = '', law: str = '',
                  bounds: GoalBounds | None = None) -> Message:
    """
    Describe what there is; a scene starts a new run.

    :param title: of the run.
    :param columns: names of the columns of its rows.
    :param description: what the run shows, a sentence or more.
    :param law: control law of the run.
    :param bounds: ``GoalBounds`` of the errors at the end; None where they are not known.
    """
    return {
        'type': 'scene', 'title': title, 'description': ' '.join(description.split()), 'law': law,
        'object': object_values(obj), 'robot': robot_values(robot),
        **bound_values(bounds), 'columns': list(columns)}


def bound_values(bounds: GoalBounds | None) -> Message:
    """Describe the bounds of the errors at the end; None where they are not known."""
    return {'position_bound': None if bounds is None else bounds.position_error,
            'heading_bound': None if bounds is None else bounds.heading_error}


def scenario_message(scenario: Scenario, law: str, columns: Sequence[str]) -> Message:
    """
    Describe what there is in a scenario.

    :param law: control law of the run.
    :param columns: names of the columns of its rows.
    """
    return scene_message(scenario.name.replace('_', ' '), scenario.object, scenario.robot,
                         columns, description=scenario.description, law=law,
                         bounds=scenario.final_bounds) | {
                             'true_base': _base_values(scenario.true_robot),
                             'camera': camera_values(scenario.sensors.camera)}


def object_values(obj: PushedObject) -> Message:
    """Describe an object by its nominal parameters."""
    return {'outline': [rounded(vertex) for vertex in obj.outline], 'radius': obj.radius,
            'mass': obj.mass,
            'supports': [rounded((support.x, support.y)) for support in obj.supports],
            'friction': [support.friction_coefficient for support in obj.supports],
            'contact_friction': obj.contact_friction_coefficient,
            'friction_center': rounded(friction_center(obj))}


def robot_values(robot: RoundRobot) -> Message:
    """Describe a robot, with what is stated of its base."""
    return {'radius': robot.radius, 'drive': robot.drive, **_base_values(robot)}


def camera_values(camera: CameraSettings) -> Message | None:
    """
    Describe where a camera is and what it sees.

    :return: ``place``, ``mount`` (in the frame of the robot if it is on that, else the world),
        ``half_angle`` [rad], ``nearest`` and ``farthest`` [m]; None where there is no camera.
    """
    if camera.place == 'none':
        return None
    return {'place': camera.place, 'mount': rounded(camera.mount),
            'half_angle': camera.half_angle, 'nearest': camera.nearest,
            'farthest': camera.farthest}


def view_message(view: View, robot: RoundRobot) -> Message:
    """
    Describe from where a robot sees the object, as a camera in its centre.

    :param view: stated ``View``; its nearest distance is a gap.
    """
    nearest = robot.radius + view.nearest if view.nearest > 0.0 else 0.0
    camera = CameraSettings('robot', half_angle=view.half_angle, nearest=nearest,
                            farthest=min(view.farthest, CameraSettings.farthest))
    return {'type': 'camera', 'camera': camera_values(camera)}


def base_message(time: float, base: BaseKnowledge) -> Message:
    """
    State what the controller knows of its base from a time on.

    :param time: [s].
    """
    names = 'pulse', 'first_gain', 'second_gain', 'gain_deviation'
    return {'type': 'base', 'time': _rounded_number(time), **_base_values(base),
            **{name: _rounded_number(getattr(base, name)) for name in names}}


def _base_values(base: RoundRobot | BaseKnowledge) -> Message:
    values = {'dead_time': base.dead_time, 'min_speed': base.min_speed,
              'min_yaw_rate': base.min_yaw_rate, 'max_acceleration': base.max_acceleration,
              'max_yaw_acceleration': base.max_yaw_acceleration}
    # Accelerations as stated are infinite in what is known.
    return {name: _rounded_number(value) for name, value in values.items()
            if math.isfinite(value)}


def rows_message(rows: Iterable[Sequence[float]] | FloatArray) -> Message:
    """
    Send rows of the tape.

    :param rows: one sequence of numbers each, in the order of the columns of the scene.
    """
    return {'type': 'rows', 'rows': [rounded(row) for row in rows]}


def truth_message(time: float, obj: PushedObject) -> Message:
    """
    State the true friction from a time on.

    :param time: [s].
    """
    return {'type': 'truth', 'time': _rounded_number(time),
            'friction': [round(support.friction_coefficient, DECIMALS)
                         for support in obj.supports],
            'contact_friction': obj.contact_friction_coefficient,
            'friction_center': rounded(friction_center(obj))}


def goal_message(time: float, pose: Coordinates) -> Message:
    """
    State the goal from a time on.

    :param time: [s].
    :param pose: goal ``Pose`` of the object.
    """
    return {'type': 'goal', 'time': _rounded_number(time), 'pose': rounded(pose)}


def state_message(change: StateChange) -> Message:
    """Report a change of state."""
    return {'type': 'state', 'time': _rounded_number(change.time), 'state': change.state.value,
            'reason': change.reason, 'requested': change.is_requested}


def map_message(time: float, occupancy_map: OccupancyMap | None) -> Message:
    """
    State which floor is occupied from a time on.

    :param time: [s].
    :param occupancy_map: the ``OccupancyMap``; None for open floor.
    """
    message: Message = {'type': 'map', 'time': _rounded_number(time), 'rows': []}
    if occupancy_map is not None:
        message.update(
            resolution=occupancy_map.resolution, origin=rounded(occupancy_map.origin),
            rows=[''.join(OCCUPIED if cell else FREE for cell in row)
                  for row in occupancy_map.occupied.tolist()])
    return message


def collision_message(time: float, contact: WallContact) -> Message:
    """
    Show where something touches a wall.

    :param time: [s].
    """
    return {'type': 'collision', 'time': _rounded_number(time), 'body': contact.body.value,
            'point': rounded(contact.point)}


def push_message(time: float, trajectory: PushTrajectory) -> Message:
    """
    Show the plan of a single push.

    :param time: from which on it holds [s].
    """
    picked = np.unique(np.linspace(0, len(trajectory.times) - 1, PLAN_SAMPLES).astype(int))
    outlook = trajectory.outlook
    return {'type': 'plan', 'time': _rounded_number(time),
            'outlook': None if outlook is None else {
                name: _rounded_number(value) for name, value in outlook.values().items()},
            'object': [rounded(pose) for pose in trajectory.object_poses[picked]],
            'robot': [rounded(pose) for pose in trajectory.robot_poses[picked]],
            'contact': [rounded(pose) for pose in trajectory.contact_poses[picked]],
            'approach': [], 'later': []}


def plan_message(time: float, plan: TaskPlan, pushes: Sequence[PlannedPush]) -> Message:
    """
    Show the plan of a task: its first push, the path to it, and about what follows.

    :param time: from which on it holds [s].
    :param pushes: ``PlannedPush`` of all its pushes.
    """
    return {**push_message(time, plan.trajectory),
            'approach': path_points(plan.approach_path),
            'later': [later_push(push.end, push.robot_start, push.approach)
                      for push in pushes[1:]]}


def later_push(end: Pose, robot_start: Pose | None = None, approach: Path | None = None
               ) -> Message:
    """
    Describe a push of a plan behind the first.

    :param end: ``Pose`` of the object after it.
    :param robot_start: ``Pose`` of the robot where it touches; None where that is unknown.
    :param approach: ``Path`` of the robot to there; None where that is unknown.
    """
    return {'pose': rounded(end), 'robot': None if robot_start is None else rounded(robot_start),
            'approach': [] if approach is None else path_points(approach)}


def refusal_message(time: float, code: PlanFailure, text: str, marks: RefusalMarks) -> Message:
    """
    Show why there is no plan.

    :param time: from which on [s].
    :param text: why, one sentence.
    """
    place = marks.narrow_place
    return {'type': 'refusal', 'time': _rounded_number(time), 'code': code.name, 'text': text,
            'place': None if place is None else {
                'point': rounded(place[:2]), 'width': place.width, 'needed': place.needed_width,
                'ellipse': None if place.ellipse is None else rounded(place.ellipse)},
            'faces': [{'point': rounded(face[:2]), 'has_room': face.has_room}
                      for face in marks.faces],
            'overlap': None if marks.overlap is None else rounded(marks.overlap),
            'nearest': None if marks.nearest is None else rounded(marks.nearest)}


def path_points(path: Path) -> list[list[float | None]]:
    """
    Sample the path of a robot.

    :return: (x, y, theta) of each sample.
    """
    fractions: FloatArray = np.linspace(0.0, 1.0, PLAN_SAMPLES // 4).astype(np.float64)
    return [rounded(pose) for segment in path.segments for pose in segment.poses(fractions)]


def displacement_message(time: float, before: Pose, after: Pose) -> Message:
    """
    Report that somebody has moved the object.

    :param time: [s].
    :param after: its ``Pose`` then.
    """
    return {'type': 'displacement', 'time': _rounded_number(time), 'before': rounded(before),
            'after': rounded(after)}


def rounded(values: Iterable[float]) -> list[float | None]:
    """
    Round numbers to what is sent; those that are not finite become None.

    :param values: the numbers.
    """
    return [_rounded_number(value) for value in values]


def _rounded_number(value: float) -> float | None:
    return round(float(value), DECIMALS) if math.isfinite(value) else None


def controls_message(tools: Sequence[str], *, choices: Sequence[Message] = (),
                     settings: Sequence[Message] = (), calls: Sequence[str] = (),
                     presets: Sequence[Message] = (), owns_time: bool = False) -> Message:
    """
    Tell a live page what its user can do.

    :param tools: what can be dragged, of ``goal``, ``object`` and ``wall``.
    :param choices: each with ``name``, ``value`` and ``options``.
    :param settings: as of ``Setting.to_message``.
    :param calls: names of what can be called, as ``stop``.
    :param presets: each with ``name``, ``help`` and ``commands``.
    :param owns_time: whether time can be stopped and made faster.
    """
    return {'type': 'controls', 'tools': list(tools), 'choices': list(choices),
            'settings': list(settings), 'calls': list(calls), 'presets': list(presets),
            'owns_time': owns_time}


def order_message(time: float, names: Sequence[str], pushed: str, goals: Sequence[Pose | None],
                  plan: OrderPlan, statuses: Mapping[str, ObjectStatus]) -> Message:
    """
    State which objects of a room are moved, in which order and why, from a time on.

    :param time: [s].
    :param names: of all objects.
    :param pushed: name of the one that is moved, or was last.
    :param goals: goal ``Pose`` of each; None where it may stand anywhere.
    :param plan: ``OrderPlan``; its first move is made now.
    :param statuses: ``ObjectStatus`` of each, by name.
    """
    objects = [statuses[name] for name in names]
    placed = sum(status.state is ObjectState.AT_GOAL for status in objects)
    return {'type': 'order', 'time': _rounded_number(time), 'pushed': names.index(pushed),
            'goals': [None if goal is None else rounded(goal) for goal in goals],
            'placed': placed, 'goal_count': sum(goal is not None for goal in goals),
            'text': move_text(plan.moves) if plan.moves else '',
            'seconds': _rounded_number(plan.time),
            'states': [{'state': status.state.name.lower(), 'text': status.state.value,
                        'reason': '' if status.failure is None else sentence(status.failure)}
                       for status in objects],
            'moves': [{'index': names.index(move.name), 'pose': rounded(move.end),
                       'is_temporary': move.is_temporary,
                       'path': [rounded(point) for point in move.path]} for move in plan.moves]}
