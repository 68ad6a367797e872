"""
The page: see a run, play with the simulation, watch a robot.

A report of runs is one HTML file::

    beliefs = BeliefRecorder(scenario.object)
    result = simulate(scenario, intervene=beliefs)
    write_report([result], 'task_demo.html', [beliefs])
"""

from push_view.belief import BeliefRecorder
from push_view.report import write_report

__all__ = ['BeliefRecorder', 'write_report']
