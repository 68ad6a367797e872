"""
The page: see a run, play with the simulation, watch a robot.

A report of runs is one HTML file::

    result = simulate(load_scenario('task_demo'))
    write_report([result], 'task_demo.html')
"""

from push_view.report import write_report

__all__ = ['write_report']
