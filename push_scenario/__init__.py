"""
Scenarios of pushing: simulated, replayed over DDS, measured, reported and drawn.

A scenario is simulated and drawn in five lines; the modules behind these names are imported at
first use, and matplotlib only for drawing::

    scenario = load_scenario('task_approach')
    result = simulate(scenario)
    print(measure(result), is_as_expected(result))
    print(format_report([result]))
    draw_figure([result], 'task.png')
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_model.files.parameter_files import read_object, read_robot
    from push_model.files.strict_yaml import ParameterFileError
    from push_scenario.definition.catalogue import scenario_names
    from push_scenario.definition.loader import load_scenario, scenario_from_text, scenario_text
    from push_scenario.definition.placement import Placement
    from push_scenario.definition.scenario import GoalBounds, Scenario, Start
    from push_scenario.definition.task import LaterGoal, Task
    from push_scenario.evaluation.metrics import is_as_expected, measure, Metrics
    from push_scenario.evaluation.report import format_report
    from push_scenario.parallel import progress_bar, run_many, simulate_many
    from push_scenario.plots.animation import draw_animation
    from push_scenario.plots.figure import draw_figure
    from push_scenario.recordings.series import read_recording, Series
    from push_scenario.simulation.loop import Progress, simulate
    from push_scenario.simulation.result import Outcome, RunResult
    from push_sim_node.tape import read_tape, Tape

__all__ = [
    'GoalBounds', 'draw_animation', 'draw_figure', 'format_report', 'is_as_expected', 'LaterGoal',
    'load_scenario', 'measure', 'Metrics', 'Outcome', 'ParameterFileError', 'Placement',
    'Progress', 'progress_bar', 'read_object', 'read_recording', 'read_robot', 'read_tape',
    'run_many', 'RunResult', 'Scenario', 'scenario_from_text', 'scenario_names', 'scenario_text',
    'Series', 'simulate', 'simulate_many', 'Start', 'Tape', 'Task',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_model.files.parameter_files': ('read_object', 'read_robot'),
    'push_model.files.strict_yaml': ('ParameterFileError',),
    'push_scenario.definition.catalogue': ('scenario_names',),
    'push_scenario.definition.loader': ('load_scenario', 'scenario_from_text', 'scenario_text'),
    'push_scenario.definition.placement': ('Placement',),
    'push_scenario.definition.scenario': ('GoalBounds', 'Scenario', 'Start'),
    'push_scenario.definition.task': ('LaterGoal', 'Task'),
    'push_scenario.evaluation.metrics': ('is_as_expected', 'measure', 'Metrics'),
    'push_scenario.evaluation.report': ('format_report',),
    'push_scenario.parallel': ('progress_bar', 'run_many', 'simulate_many'),
    'push_scenario.plots.animation': ('draw_animation',),
    'push_scenario.plots.figure': ('draw_figure',),
    'push_scenario.recordings.series': ('read_recording', 'Series'),
    'push_scenario.simulation.loop': ('Progress', 'simulate'),
    'push_scenario.simulation.result': ('Outcome', 'RunResult'),
    'push_sim_node.tape': ('read_tape', 'Tape'),
})
