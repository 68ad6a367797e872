"""
Twenty minutes of random messages over DDS: no node may end, or write a traceback.

Simulated time of planner, controller and simulator goes as fast as the clock of the wall. Beside
them messages are published on all topics that they read. Their fields hold anything that their
types allow, and some are cut off after any byte. Storms of goals come, and services are called in
any order. In the end all nodes are asked to end, and have to do so well.
"""

import argparse
from collections.abc import Callable, Sequence
import math
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

from benchmarks.faults.process_rig import change_parameters, SCENARIO
import numpy as np
from push_ros.topics import CONTROLLER, PLANNER, SERVICES, SIM, TOPICS
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeDied, NodeProcesses
from push_scenario.dds.replay import MODULES
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.start import place_robot
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_srvs.srv import Trigger

# Numbers and texts that nobody expects.
NUMBERS = 0.0, 1e7, -1e7, 1e155, 1e308, 5e-324, math.nan, math.inf, -math.inf
TEXTS = 'odom', 'odom', 'map', 'base_link', '', '/odom', 'x' * 5000, 'somewhere'
# Part of the messages that are cut off, and elements of a sequence at most.
CUT_RATIO, MAX_LENGTH = 0.1, 40
# Part of the actions that are storms of goals, and goals of each; that are calls of services.
STORM_RATIO, STORM_SIZE, CALL_RATIO = 0.01, 100, 0.02
# What ends the start of the nodes [s]; chosen: far above what they take on a busy machine.
START_TIME = 60.0
TRACEBACK = 'Traceback (most recent call last)'


class MessageSource:
    """Makes messages of any type, with random fields."""

    def __init__(self, seed: int) -> None:
        """
        Start.

        :param seed: of all that is drawn.
        """
        self.rng = np.random.default_rng(seed)

    def make(self, kind: type[Any]) -> Any:
        """
        Make a message.

        :param kind: its class.
        """
        message = kind()
        for name, slot in zip(message.get_fields_and_field_types(), message.SLOT_TYPES):
            value = getattr(message, name)
            setattr(message, name, self._value(value, slot))
        return message

    def _value(self, value: Any, slot: Any) -> Any:
        """Draw a value in place of that of a field, whose type it has."""
        rng = self.rng
        if isinstance(value, bool):
            return bool(rng.integers(2))
        if isinstance(value, int):
            return self._integer(slot.typename)
        if isinstance(value, float):
            return self._number()
        if isinstance(value, str):
            return str(rng.choice(TEXTS))
        if hasattr(value, 'SLOT_TYPES'):
            return self.make(type(value))
        return self._sequence(value, slot)

    def _number(self) -> float:
        is_odd = self.rng.uniform() < 0.2
        return float(self.rng.choice(NUMBERS) if is_odd else self.rng.normal(0.0, 2.0))

    def _integer(self, typename: str) -> int:
        """Draw a number that a type such as ``uint8`` can hold, the greatest among them."""
        is_unsigned = typename.startswith('u')
        bits = int(''.join(filter(str.isdigit, typename)) or 8) - (not is_unsigned)
        low, high = (0 if is_unsigned else -2 ** bits), 2 ** bits - 1
        return int(self.rng.choice([low, high, 0, min(high, 7), min(high, 50)]))

    def _sequence(self, value: Any, slot: Any) -> Any:
        """Draw elements, as many as an array has, or some."""
        element = slot.value_type
        length = len(value) or int(self.rng.integers(MAX_LENGTH))
        if hasattr(element, 'namespaces'):
            # Nested messages, of which an empty sequence does not tell the class.
            return value
        typename = getattr(element, 'typename', 'string')
        if typename in ('float', 'double'):
            return [min(max(self._number(), -3e38), 3e38) if typename == 'float'
                    else self._number() for _ in range(length)]
        if typename in ('string', 'wstring'):
            return [str(self.rng.choice(TEXTS)) for _ in range(length)]
        return [self._integer(typename) for _ in range(length)]


class WireFuzz:
    """Publishes to nodes under test, and calls their services."""

    def __init__(self, node: Node, seed: int) -> None:
        """
        Make publishers for all topics that the nodes read, and clients for their services.

        :param node: rclpy node beside them.
        :param seed: of all that is drawn.
        """
        self._source = MessageSource(seed)
        self._publishers = {name: node.create_publisher(topic.type, name, topic.publish_qos)
                            for name, topic in TOPICS.items()
                            if {PLANNER, CONTROLLER, SIM}.intersection(topic.subscribers)
                            and not topic.is_optional and not topic.is_global}
        self._clients = [node.create_client(Trigger, name)
                         for name, service in SERVICES.items() if service.type is Trigger]
        self.count = 0

    def act(self) -> None:
        """Publish one message, or a storm of goals, or call a service."""
        rng, draw = self._source.rng, self._source.rng.uniform()
        self.count += 1
        if draw < STORM_RATIO:
            for _ in range(STORM_SIZE):
                self._publish('goal_pose')
        elif draw < STORM_RATIO + CALL_RATIO:
            client = self._clients[rng.integers(len(self._clients))]
            if client.service_is_ready():
                client.call_async(Trigger.Request())
        else:
            self._publish(str(rng.choice(list(self._publishers))))

    def _publish(self, topic: str) -> None:
        """Publish on a topic; some messages end early."""
        message = self._source.make(TOPICS[topic].type)
        if self._source.rng.uniform() < CUT_RATIO:
            data = serialize_message(message)
            message = data[:4 + int(self._source.rng.integers(max(1, len(data) - 4)))]
        self._publishers[topic].publish(message)


def run(duration: float, seed: int, rate: float, report: Callable[[str], None]) -> list[str]:
    """
    Send random messages to three nodes.

    :param duration: for which messages are sent [s].
    :param seed: of all that is drawn.
    :param rate: of messages [Hz].
    :param report: told how far it is, now and then.
    :return: what went wrong, one text each; empty where nothing did.
    """
    scenario, faults = place_robot(load_scenario(SCENARIO)), list[str]()
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder, \
            NodeProcesses(domain, folder) as nodes:
        files = write_parameter_files(Path(folder), scenario, scenario.control, Path(),
                                      real_time=True, stamped=True)
        change_parameters(files[SIM], tape_path='', time_limit=0.0, autostart=True)
        change_parameters(files[CONTROLLER], wait_for_start=False)
        for name, path in files.items():
            nodes.start(name, MODULES[name], path)
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        node = rclpy.create_node('fuzz', context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        try:
            _wait(node, executor, nodes)
            _send(WireFuzz(node, seed), executor, nodes, duration, 1.0 / rate, report)
            nodes.stop_all()
        except NodeDied as error:
            faults.append(str(error))
        finally:
            executor.shutdown()
            node.destroy_node()
            rclpy.shutdown(context=context)
        for name in files:
            text = (Path(folder) / f'{name}.log').read_text(encoding='utf-8', errors='replace')
            if TRACEBACK in text:
                faults.append(f'{name}: ' + text[text.index(TRACEBACK):][:3000])
    return faults


def _wait(node: Node, executor: SingleThreadedExecutor, nodes: NodeProcesses) -> None:
    """Wait until all nodes are there."""
    end = time.monotonic() + START_TIME
    while not set(nodes.names) <= set(node.get_node_names()) and time.monotonic() < end:
        nodes.check()
        executor.spin_once(timeout_sec=0.1)


def _send(fuzz: WireFuzz, executor: SingleThreadedExecutor, nodes: NodeProcesses,
          duration: float, period: float, report: Callable[[str], None]) -> None:
    """Send messages for a while; raises ``NodeDied`` where a node ends."""
    start = reported = time.monotonic()
    while time.monotonic() < start + duration:
        fuzz.act()
        nodes.check()
        executor.spin_once(timeout_sec=0.0)
        behind = time.monotonic() - start - fuzz.count * period
        if behind < 0.0:
            time.sleep(-behind)
        if time.monotonic() > reported + 60.0:
            reported = time.monotonic()
            report(f'{fuzz.count} actions in {reported - start:.0f} s')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Print what went wrong.

    :param arguments: command line; None for that of the process.
    :return: exit status: 1 where a node has ended or written a traceback.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--minutes', type=float, default=20.0)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--rate', type=float, default=100.0, help='messages per second')
    options = parser.parse_args(arguments)
    faults = run(60.0 * options.minutes, options.seed, options.rate,
                 lambda text: print(text, flush=True))
    print('\n'.join(faults) or 'no node has ended or written a traceback')
    return int(bool(faults))


if __name__ == '__main__':
    sys.exit(main())
