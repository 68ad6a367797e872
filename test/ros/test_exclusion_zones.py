"""Nav2's collision monitor ignores the object while a goal is pursued, and never afterwards."""

import importlib.util
import random
import signal
import time

from geometry_msgs.msg import PoseStamped
from helpers.build_interfaces import available, CACHE, write_package
from helpers.node_bench import bench, TIMEOUT
from push_control.ros.exclusion_zones import (
    ANSWER_TIME, Call, ExclusionZones, SourceZone, ZONE,
)
from push_control.ros.parameters import ControllerParameters, SECTIONS
from push_model.files.data import config_file
from push_model.files.flat_values import from_parameter_values, to_parameter_values
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.footprint import grown_outline
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.primitives import to_pose_message, to_stamp
from push_ros.node_settings import CollisionMonitorSettings
from push_ros.topics import CONTROLLER
import pytest

OUTLINE = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
OTHER = ((0.0, 0.0), (2.0, 0.0), (0.0, 2.0))
PERIOD = 0.1
RUNS = 1000
MARGIN = 0.05


class FaultySource:
    """A source whose monitor loses calls and answers, refuses, is late, and starts again."""

    def __init__(self, generator):
        self._random = generator
        # Of a process that has ended.
        self.zone = OTHER if generator.random() < 0.3 else None
        self.is_reliable = False
        self.answers = []

    def call(self, call, outline, now):
        """Take a call; its answer comes later, or never."""
        chance = 1.0 if self.is_reliable else self._random.random()
        if chance < 0.15:
            return
        success = (self.zone is None) == (call is Call.ADD) and chance > 0.3
        if success:
            self.zone = outline if call is Call.ADD else None
        if chance > 0.45:
            delay = self._random.random() * (0.3 if self.is_reliable else 0.9 * ANSWER_TIME)
            self.answers.append((now + delay, success))


class Run:
    """One source, what is wanted of it, and time."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.source = FaultySource(self.random)
        self.zone = SourceZone()
        # Time [s].
        self._now = 0.0

    def pass_time(self, duration):
        """Take answers, and make the calls that are due."""
        source, zone = self.source, self.zone
        end = self._now + duration
        while self._now < end:
            self._now += PERIOD
            due = [answer for answer in source.answers if answer[0] <= self._now]
            if due:
                source.answers.clear()
                zone.on_answer(self._now, success=due[0][1], message='no')
            call = zone.next_call(self._now)
            if call is not None:
                # A late answer is not one to this call.
                source.answers.clear()
                source.call(call, zone.requested, self._now)

    def restart_monitor(self):
        """Let the monitor forget all zones, as its process does."""
        self.source.zone = None
        self.source.answers.clear()
        self.zone.forget()


def test_no_zone_is_left_behind():
    """And the wanted one is there, once the monitor is well, whatever went wrong before."""
    for seed in range(RUNS):
        run = Run(seed)
        for _ in range(run.random.randrange(1, 8)):
            run.zone.want(run.random.choice([None, OUTLINE, OTHER]))
            run.pass_time(run.random.random() * 6.0)
            if run.random.random() < 0.2:
                run.restart_monitor()
        run.source.is_reliable = True
        for wanted in (OUTLINE, None):
            run.zone.want(wanted)
            run.pass_time(3.0 * ANSWER_TIME)
            assert run.source.zone == wanted, seed
            assert run.zone.is_settled and not run.zone.refusal and not run.zone.is_silent


def test_a_zone_has_a_margin_of_the_stated_width():
    """Each vertex of the object is inside by the margin, and none of the zone much farther."""
    obj = read_object(config_file('objects/box_04.yaml'))
    zone = grown_outline(obj, MARGIN)
    for (x, y), (next_x, next_y) in zip(zone, zone[1:] + zone[:1]):
        length = ((next_x - x) ** 2 + (next_y - y) ** 2) ** 0.5
        distances = [((next_x - x) * (v - y) - (next_y - y) * (u - x)) / length
                     for u, v in obj.outline]
        assert MARGIN - 1e-9 < min(distances) < 1.03 * MARGIN
    assert {*grown_outline(obj, 0.0)} == {*obj.outline}


DEFINITIONS = {
    'msg/ExclusionZoneDescription.msg':
        'string zone_name\nstring type\nstring frame_id\ngeometry_msgs/Point32[] points\n'
        'bool enabled true\n',
    'srv/AddExclusionZone.srv':
        'nav2_msgs/ExclusionZoneDescription zone\n---\nbool success\nstring message\n',
    'srv/RemoveExclusionZone.srv':
        'string zone_name\nbool remove_all false\n---\nbool success\nstring message\n'}
BOX = read_object(config_file('objects/box_04.yaml'))
PARAMETERS = {**to_parameter_values(BOX, 'object.'), 'robot.radius': 0.17, 'task': True,
              'use_sim_time': True, 'collision_monitor.node': 'monitor',
              'collision_monitor.sources.name': ['scan', 'points'],
              'collision_monitor.margin': MARGIN}
ROBOT, OBJECT = Pose(-1.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0)


class Monitor:
    """The two sources of a collision monitor, and the world around the controller."""

    def __init__(self, b):
        from nav2_msgs.srv import AddExclusionZone, RemoveExclusionZone
        self.b = b
        self.zones = {'scan': [], 'points': []}
        self.now = 0.0
        self._node = b.node_beside('monitor')
        for source, zones in self.zones.items():
            self._node.create_service(AddExclusionZone, f'~/{source}/add_exclusion_zone',
                                      self._adder(zones))
            self._node.create_service(RemoveExclusionZone, f'~/{source}/remove_exclusion_zone',
                                      self._remover(zones))

    @staticmethod
    def _adder(zones):
        def add(request, response):
            response.success = all(zone.zone_name != request.zone.zone_name for zone in zones)
            if response.success:
                zones.append(request.zone)
            return response
        return add

    @staticmethod
    def _remover(zones):
        def remove(request, response):
            left = [zone for zone in zones if zone.zone_name != request.zone_name]
            response.success = len(left) < len(zones)
            zones[:] = left
            return response
        return remove

    def measure(self):
        """Let time pass by one measurement each of robot and object."""
        self.now += 0.05
        self.b.clock(self.now)
        self.b.publish('object_pose', to_object_pose_message(ObjectPose(self.now, OBJECT), 'odom'))
        self.b.publish('odom', to_odometry_message(Odometry(self.now, ROBOT, STOP), 'odom',
                                                   'base_link'))
        self.b.spin(0.02)

    def measure_until(self, condition):
        """Let time pass until a condition holds."""
        self.b.repeat_until(self.measure, condition, period=0.0)

    def give_goal(self):
        """Publish a goal to which the robot, which stands still in this test, never comes."""
        goal = PoseStamped(pose=to_pose_message(Pose(0.5, 0.0, 0.0)))
        goal.header.frame_id, goal.header.stamp = 'odom', to_stamp(self.now)
        self.b.publish('goal_pose', goal)

    @property
    def counts(self):
        """List how many zones each source has."""
        return [len(zones) for zones in self.zones.values()]


@pytest.fixture(scope='module')
def interfaces():
    """Build the two services, where no Nav2 of Lyrical is installed."""
    source = write_package(CACHE / 'sources' / 'nav2_msgs', DEFINITIONS, 'geometry_msgs')
    with available(source):
        yield


@pytest.fixture
def monitor(interfaces, tmp_path):
    """Start a controller beside a monitor."""
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node', PARAMETERS) as b:
        yield Monitor(b)


@pytest.mark.dds
@pytest.mark.slow
def test_the_object_is_ignored_as_long_as_a_goal_is_pursued(monitor):
    """At both sources, by its frame; also where another process had left a zone."""
    from nav2_msgs.srv import AddExclusionZone
    for zones in monitor.zones.values():
        former = AddExclusionZone.Request().zone
        former.zone_name = ZONE
        zones.append(former)
    monitor.measure_until(lambda: monitor.counts == [0, 0])
    monitor.give_goal()
    monitor.measure_until(lambda: monitor.counts == [1, 1])
    zone, = monitor.zones['scan']
    assert (zone.type, zone.frame_id, zone.enabled) == ('polygon', 'object', True)
    assert [(point.x, point.y) for point in zone.points] \
        == [pytest.approx(vertex, abs=1e-6) for vertex in grown_outline(BOX, MARGIN)]
    assert monitor.b.call('controller/stop').success
    monitor.measure_until(lambda: monitor.counts == [0, 0])


@pytest.mark.dds
@pytest.mark.slow
def test_an_interrupted_controller_leaves_no_zone(monitor):
    """Ctrl-C in the middle of a task."""
    monitor.measure_until(lambda: monitor.b.node.count_subscribers('goal_pose') == 1)
    monitor.give_goal()
    monitor.measure_until(lambda: monitor.counts == [1, 1])
    monitor.b.processes.send(CONTROLLER, signal.SIGINT)
    end = time.monotonic() + TIMEOUT
    while monitor.counts != [0, 0] and time.monotonic() < end:
        monitor.b.executor.spin_once(timeout_sec=0.02)
    assert monitor.counts == [0, 0]


def test_zones_need_the_frame_of_the_object_and_services():
    """Else the controller is not configured, and says what is missing."""
    values = {**PARAMETERS, 'publish_tf': False}
    parameters = ControllerParameters(*(from_parameter_values(section, values, prefix)
                                        for prefix, section in SECTIONS))
    with pytest.raises(ValueError, match='publish_tf: got false, expected true, as monitor'):
        parameters.check()
    with pytest.raises(ValueError, match='CollisionMonitorSettings.sources: got none'):
        CollisionMonitorSettings('monitor')
    if importlib.util.find_spec('nav2_msgs') is None:
        with pytest.raises(ValueError, match='collision_monitor.node: got .monitor., but'):
            ExclusionZones(None, parameters.collision_monitor, 'object', lambda: None)
