"""Parameter files of the three nodes for a scenario."""

import dataclasses

from push_ros.node_settings import ControllerOptions, Frames, SimOptions
from push_ros.parameters import to_parameter_values
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.simulation.loop import SETTLE_TIME
import yaml

# Wall time that a planner may take while simulated time waits for it [s].
PATIENCE = 60.0


def write_parameter_files(folder, scenario, settings, tape_path, real_time, stamped):
    """
    Write what the nodes must know: beliefs for planner and controller, the truth for the plant.

    :param folder: where.
    :param scenario: the ``Scenario``.
    :param settings: ``ControlSettings``.
    :param tape_path: where the simulator writes its tape.
    :param real_time: keep to the wall clock instead of going in lockstep.
    :param stamped: whether commands are ``TwistStamped``, else ``Twist``.
    :return: dict of node names to paths.
    """
    files = {}
    sections = _sections(scenario, settings, real_time, stamped)
    sections[SIM] += (('', _sim_options(scenario, tape_path, real_time, stamped)),)
    for name, parts in sections.items():
        values = {'use_sim_time': name != SIM}
        for prefix, instance in parts:
            values.update(to_parameter_values(instance, prefix))
        files[name] = folder / f'{name}.yaml'
        files[name].write_text(yaml.safe_dump({name: {'ros__parameters': values}},
                                              sort_keys=False), encoding='utf-8')
    return files


def _sections(scenario, settings, real_time, stamped):
    """For each node, (prefix, dataclass instance) of all that it must know."""
    task, planner = scenario.task, scenario.planner
    options = ControllerOptions(stamped_cmd_vel=stamped)
    more = {PLANNER: (), CONTROLLER: ()}
    if task is not None:
        planner = dataclasses.replace(planner, site='sequence')
        options = dataclasses.replace(options, task=True, wait_for_plans=not real_time)
        more = {PLANNER: (('drive.', task.drive), ('task.', task.planning)),
                CONTROLLER: (('drive.', task.drive), ('supervision.', task.supervision))}
    beliefs = (('object.', scenario.object), ('robot.', scenario.robot), ('', Frames()))
    return {
        SIM: (('object.', scenario.truth), ('robot.', scenario.robot_truth), ('', Frames()),
              ('sensors.', scenario.sensors), ('simulation.', scenario.simulation)),
        PLANNER: (*beliefs, ('planner.', planner), *more[PLANNER]),
        CONTROLLER: (*beliefs, ('control.', settings), *more[CONTROLLER], ('', options)),
    }


def _sim_options(scenario, tape_path, real_time, stamped):
    patience = SimOptions.answer_timeout if scenario.task is None else PATIENCE
    return SimOptions(
        lockstep=not real_time, publish_clock=real_time, stamped_cmd_vel=stamped,
        answer_timeout=patience, time_limit=scenario.time_limit + SETTLE_TIME + 1.0,
        tape_path=str(tape_path), object_start=tuple(scenario.start.object.pose),
        robot_start=tuple(scenario.robot_start))
