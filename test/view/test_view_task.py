"""A whole task from the page of a robot: simulator, planner, controller and view over DDS."""

import dataclasses
import math
import re

from helpers.extras import import_extra
from helpers.node_bench import bench
from helpers.page_reader import PageReader
from push_model.files.flat_values import to_parameter_values
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.replay import MODULES
from push_scenario.definition.loader import load_scenario
import pytest


@pytest.mark.dds
@pytest.mark.slow
def test_a_goal_from_the_page_is_reached(tmp_path):
    """The goal and the start come from it; it is shown the plan, the states and the end."""
    import_extra('aiohttp', 'play')
    # The simulator goes on after the task: a page that misses the end is shown what comes then.
    scenario = dataclasses.replace(load_scenario('task_tap'), time_limit=3600.0)
    parameters = {**to_parameter_values(scenario.object, 'object.'),
                  **to_parameter_values(scenario.robot, 'robot.'),
                  'port': 0, 'control': True, 'use_sim_time': True}
    files = write_parameter_files(tmp_path, scenario, scenario.control, tmp_path / 'tape.csv',
                                  real_time=False, stamped=True)
    with bench(tmp_path, 'push_view', 'push_view.view_node', parameters) as b:
        b.subscribe('diagnostics')
        for name, path in files.items():
            b.processes.start(name, MODULES[name], path)

        def texts(pattern):
            return [found for message in b.received['diagnostics'] for status in message.status
                    if (found := re.search(pattern, status.message))]

        b.wait_until(lambda: texts(r'http\S+'))
        b.wait_until(lambda: {status.name for message in b.received['diagnostics']
                              for status in message.status} >= files.keys())
        page = PageReader(texts(r'http\S+')[0][0])
        goal = list(scenario.goal.pose)
        b.wait_until(lambda: page.of_kind('scene'))
        b.repeat_until(lambda: page.send(type='goal', pose=goal), lambda: page.of_kind('goal'),
                       period=1.0)
        # Refused while the controller has not received everything.
        b.repeat_until(lambda: page.send(type='call', name='start'),
                       lambda: any(message['text'] == 'started'
                                   for message in page.of_kind('notice')),
                       period=1.0)
        b.call('sim/start')

        def states():
            return [message['state'] for message in page.of_kind('state')]

        def object_error():
            columns = page.of_kind('scene')[-1]['columns']
            row = dict(zip(columns, page.of_kind('rows')[-1]['rows'][-1]))
            return math.hypot(row['object_x'] - goal[0], row['object_y'] - goal[1])

        b.wait_until(lambda: states()[-1:] in (['done'], ['failed']))
        assert states()[-1] == 'done' and 'push' in states() and page.of_kind('plan')
        # What is measured comes best effort, and may be behind the states.
        b.wait_until(lambda: object_error() < 0.02)
