"""What a replay learns from the messages of the nodes."""

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from push_ros.topics import SIM, TOPICS
from push_scenario.dds.run_monitor import READ_TOPICS, RunMonitor
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock


def test_messages_of_other_topics_are_written_and_not_read():
    """So that a replay without a recording need not listen to them."""
    monitor, written = RunMonitor(None), []
    monitor.write = lambda topic, data: written.append(topic)
    monitor.on_message('clock', serialize_message(Clock(clock=Time(sec=7))))
    others = sorted(TOPICS.keys() - set(READ_TOPICS))
    for topic in others:
        monitor.on_message(topic, b'no message')
    assert written == ['clock', *others]
    assert (monitor.time, monitor.nodes, monitor.plan, monitor.end) == (7.0, {}, None, None)


def test_a_simulator_that_has_ended_says_when():
    """A replay that stood still has missed the clock; the status comes again and again."""
    monitor = RunMonitor(None)
    monitor.on_message('diagnostics', serialize_message(DiagnosticArray(status=[DiagnosticStatus(
        name=SIM, values=[KeyValue(key='time [s]', value='25.5')])])))
    monitor.on_message('clock', serialize_message(Clock(clock=Time(sec=7))))
    assert monitor.time == 25.5
