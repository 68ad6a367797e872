"""Parameter files of the nodes for a scenario."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from push_control.settings import ControlSettings
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_ros.node_settings import ControllerOptions, Frames, SimOptions
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import SETTLE_TIME
import yaml

# How long the simulator waits for a command on the wall clock before it calls the controller
# gone [s]: several times the CPU time (10 s) that a new installation takes to compile what a
# single push needs, as other processes may be busy; in a task, time stands still while the
# planner works.
ANSWER_TIMEOUT = 45.0
PLANNING_TIMEOUT = 180.0
# Simulated time that the simulator goes on beyond the end of the run and its settling [s].
RESERVE = 1.0

# Rate of the clock in lockstep [Hz], where nothing waits for it; chosen: enough for who watches.
LOCKSTEP_CLOCK_RATE = 10.0

# (prefix of the parameters, dataclass instance that holds their values)
Section = tuple[str, Any]


def write_parameter_files(folder: Path, scenario: Scenario, settings: ControlSettings,
                          tape_path: Path, *, real_time: bool, stamped: bool,
                          more: Mapping[str, Mapping[str, Any]] = {}) -> dict[str, Path]:
    """
    Write the parameters: nominal ones for planner and controller, the true ones for the plant.

    :param folder: where.
    :param tape_path: where the simulator writes its tape.
    :param real_time: keep to the wall clock instead of going in lockstep.
    :param stamped: whether commands are ``TwistStamped``, else ``Twist``.
    :param more: parameters by node, beside or in place of those; of other nodes, all.
    :return: path of each node's file, by name of the node.
    """
    options = ControllerOptions(
        wait_for_start=True, enable_stamped_cmd_vel=stamped, lockstep=not real_time,
        task=scenario.task is not None)
    clock_rate = SimOptions().clock_rate if real_time else LOCKSTEP_CLOCK_RATE
    sim_options = SimOptions(
        clock_rate=clock_rate,
        lockstep=not real_time, publish_clock=real_time, enable_stamped_cmd_vel=stamped,
        answer_timeout=ANSWER_TIMEOUT if scenario.task is None else PLANNING_TIMEOUT,
        time_limit=scenario.time_limit + SETTLE_TIME + RESERVE, tape_path=str(tape_path),
        object_start=_values(scenario.start.object.pose),
        robot_start=_values(scenario.robot_start))
    sections = {SIM: [*_sim_sections(scenario), ('', sim_options)],
                PLANNER: _planner_sections(scenario),
                CONTROLLER: [*_controller_sections(scenario, settings), ('', options)]}
    return {node: _write(folder, node, sections.get(node, ()), more.get(node, {}))
            for node in {**sections, **more}}


def _sim_sections(scenario: Scenario) -> list[Section]:
    return [('object.', scenario.true_object), ('robot.', scenario.true_robot), ('', Frames()),
            ('sensors.', scenario.sensors), ('simulation.', scenario.plant_settings)]


def _planner_sections(scenario: Scenario) -> list[Section]:
    task, planner = scenario.task, scenario.planner
    if task is None:
        return [*_nominal_sections(scenario), ('planner.', planner)]
    return [*_nominal_sections(scenario), ('planner.', planner), ('drive.', task.drive),
            ('map.', task.map_reading)]


def _controller_sections(scenario: Scenario, settings: ControlSettings) -> list[Section]:
    sections = [*_nominal_sections(scenario), ('control.', settings)]
    if scenario.task is not None:
        task = scenario.task
        sections += [('drive.', task.drive), ('supervision.', task.supervision),
                     ('map.', task.map_reading), ('place.', task.place)]
    return sections


def _nominal_sections(scenario: Scenario) -> list[Section]:
    return [('object.', scenario.object), ('robot.', scenario.robot), ('', Frames())]


def _values(pose: Pose) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.theta


def _write(folder: Path, node: str, sections: Sequence[Section],
           more: Mapping[str, Any]) -> Path:
    # The simulator makes simulated time, the others follow it.
    values: dict[str, Any] = {'use_sim_time': node != SIM}
    for prefix, instance in sections:
        values.update(to_parameter_values(instance, prefix))
    values.update(more)
    path = folder / f'{node}.yaml'
    path.write_text(yaml.safe_dump({node: {'ros__parameters': values}}, sort_keys=False),
                    encoding='utf-8')
    return path
