"""The source tree keeps its architecture, and the checks themselves can fail."""

from xml.etree import ElementTree

from helpers import architecture
from helpers.architecture import ROOT
import pytest

VERSION = ElementTree.parse(ROOT / 'package.xml').getroot().findtext('version')
RULES = {
    'ros': architecture.ros_in_pure_modules,
    'order': architecture.against_the_order,
    'cycle': architecture.cycle,
    'shell': architecture.pure_on_shell,
    'clocks': architecture.clocks_and_dice,
    'signature': architecture.long_signatures,
    'words': architecture.old_words,
    'guard': architecture.unguarded_callbacks,
    'version': lambda root: architecture.versions_written_again(root, VERSION),
    'machine': architecture.machine_bound,
}
SLASH = '/'
OFFENCES = [
    ('ros', {'push_model/a.py': 'import rclpy'}),
    ('ros', {'push_model/a.py': 'def f():\n    from geometry_msgs.msg import Pose'}),
    ('ros', {'push_scenario/a.py': 'from rcl_interfaces.msg import Parameter'}),
    ('ros', {'push_ros/a.py': 'import launch_ros'}),
    ('ros', {'push_control/task/a.py': 'import rclpy'}),
    ('order', {'push_model/a.py': 'import push_planner.steered.plan'}),
    ('order', {'push_control/a.py': 'from push_sim_node import plant'}),
    ('order', {'push_scenario/a.py': 'from push_ros import run'}),
    ('order', {'push_planner/a.py': 'def f():\n    import push_ros.run'}),
    ('order', {'push_ros/a.py': 'from push_control.steered.laws import mpc'}),
    ('order', {'push_ros/a.py': 'def f():\n    import push_scenario.tape'}),
    ('order', {'push_model/a.py': 'from . import contact'}),
    ('order', {'push_elsewhere/a.py': ''}),
    ('order', {'push_scenario/a.py': 'from studies import catalogue'}),
    ('order', {'studies/a.py': 'import push_view'}),
    ('ros', {'studies/a.py': 'import rclpy'}),
    ('shell', {'push_control/a.py': 'from push_control.controller_node import main'}),
    ('shell', {'push_scenario/tape.py': 'def f():\n    import push_scenario.dds.replay'}),
    ('shell', {'push_control/ros/pursuit.py': 'import push_control.controller_node'}),
    ('cycle', {'push_model/a.py': 'from push_model.b import f',
               'push_model/b.py': 'from push_model import c',
               'push_model/c.py': 'import push_model.a'}),
    ('cycle', {'push_model/a.py': 'def f():\n    import push_model.b',
               'push_model/b.py': 'import push_model.a'}),
    ('cycle', {'push_planner/one/a.py': 'import push_planner.two.a',
               'push_planner/two/b.py': 'import push_planner.one.b',
               'push_planner/one/b.py': '', 'push_planner/two/a.py': ''}),
    ('clocks', {'push_model/a.py': 'from time import perf_counter'}),
    ('clocks', {'push_planner/a.py': 'import datetime\nnow = datetime.datetime.now()'}),
    ('clocks', {'push_sim_node/a.py': 'import random'}),
    ('clocks', {'push_sim_node/a.py': 'import numpy as np\nnp.random.normal()'}),
    ('clocks', {'push_sim_node/a.py': 'import numpy as np\nnp.random.default_rng()'}),
    ('cycle', {'push_planner/one/a.py': 'import push_planner.b',
               'push_planner/b.py': 'import push_planner.one.c',
               'push_planner/one/c.py': ''}),
    ('order', {'push_safety/a.py': 'import push_control.goal'}),
    ('signature', {'push_model/a.py': 'def f(a, b, c, d, e, f, g):\n    pass'}),
    ('signature', {'push_model/a.py': 'class A:\n    def f(self, a, b, c, d, e, f, g=1):\n'
                                      '        pass'}),
    ('guard', {'push_ros/a.py': 'self.create_timer(0.1, self._look)'}),
    ('guard', {'push_control/ros/a.py': "node.create_subscription(A, 'a', node.b(look), 1)"}),
    ('words', {'push_model/a.py': 'robot_way = 1'}),
    ('words', {'push_model/a.py': 'class ChainHunt:\n    pass'}),
    ('words', {'push_model/a.py': 'def f(wanted):\n    pass'}),
    ('words', {'push_model/a.py': 'class A:\n    pace: float'}),
    ('words', {'push_drive_legs/a.py': ''}),
    ('words', {'config/a.yaml': 'task:\n  mending_time: 1.0\n'}),
    ('version', {'push_model/a.py': f"v = '{VERSION}'"}),
    ('version', {'docs.md': f'release {VERSION}.'}),
    ('machine', {'config/a.yaml': f'path: {SLASH}home{SLASH}somebody'}),
    ('machine', {'Makefile': f'pip --index-url https:{SLASH * 2}pypi.example/a'}),
]
GOOD = {
    'push_model/a.py': 'import math\nimport numpy as np\nrng = np.random.default_rng(1)\n',
    'push_model/b.py': 'from push_model.a import rng\nclass A:\n'
                       '    def f(self, a, b, c, d, e, f, *, g):\n        self.path_length = a\n',
    'config/b.yaml': 'task:\n  correction_time: 1.0\n',
    'push_planner/a.py': 'from push_model import a, b\n',
    'push_control/controller_node.py': 'import rclpy\nfrom push_ros.run import spin\n',
    'push_control/ros/pursuit.py': 'import rclpy\nimport push_ros.run\n',
    'push_ros/run.py': 'import time\nimport rclpy\nfrom push_model import a\n'
                       'node.create_timer(0.1, node.guarded(a))\n'
                       "node.create_subscription(A, 'a', _ignore, 1)\n",
    'push_scenario/dds/replay.py': 'import push_ros.run\n',
    'push_scenario/cli.py': 'import time\ndef f():\n    import push_scenario.dds.replay\n',
    'push_scenario/tape.py': 'import push_planner.a\n',
    'push_sim_node/noise.py': 'import numpy as np\ndef f(seed):\n    return np.random.Generator\n',
}


def write(root, files):
    """Write a small source tree."""
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


@pytest.mark.parametrize('rule', RULES)
def test_the_source_tree_keeps_the_rule(rule):
    """Nothing is found, in a tree that does have modules."""
    assert len(architecture.modules(ROOT)) > 10
    assert RULES[rule](ROOT) == []


@pytest.mark.parametrize('rule, files', OFFENCES)
def test_an_offence_is_found(tmp_path, rule, files):
    """A good tree passes every rule; the offence is found by its rule alone."""
    write(tmp_path, GOOD)
    assert {name: check(tmp_path) for name, check in RULES.items() if check(tmp_path)} == {}
    write(tmp_path, {name: GOOD.get(name, '') + text for name, text in files.items()})
    assert RULES[rule](tmp_path)
