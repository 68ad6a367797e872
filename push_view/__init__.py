"""
The page: see a run, play with the simulation, watch a robot.

A report of runs is one HTML file::

    beliefs = BeliefRecorder(scenario.object)
    result = simulate(scenario, intervene=beliefs)
    write_report([result], 'task_demo.html', [beliefs])

Of a batch it has tables, and the runs that failed::

    def replay(job):
        return simulate(scenario_of(job)), None

    failures = batch_table(batch, lambda record: not record['success'], replay)
    write_batch_report([failures], 'batch.html', 'a batch')
"""

from push_view.batch_report import batch_table, ReportTable, write_batch_report
from push_view.belief import BeliefRecorder
from push_view.report import write_report

__all__ = ['BeliefRecorder', 'ReportTable', 'batch_table', 'write_batch_report', 'write_report']
