"""A node ends soon after a signal, in order, whatever it is about to do."""

import contextlib
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import Any

from helpers.architecture import ROOT
from push_ros.executor import (
    _run_background, await_answer, BackgroundGroup, BAD_PARAMETER, ENDING_TIME, INTERRUPT_DELAY,
    MessageWaiter, run, take_message,
)
from push_ros.qos import LATCHED
from push_scenario.dds.private_network import private_domain
import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

pytestmark = pytest.mark.dds
# Only keeps a suite from hanging [s].
TIMEOUT = 400.0

# A node whose callback never returns, as that of a planner may seem to.
SCRIPT = """
import sys
import time
from push_ros.executor import BackgroundGroup, PolledNode, run


class Busy(PolledNode):
    real_time_subscriptions = []

    def __init__(self):
        super().__init__('busy')
        self.background = BackgroundGroup()

    def start(self):
        self.create_timer(0.01, self.work)

    def work(self):
        print('works', flush=True)
        while True:
            time.sleep(0.1)

    def poll(self):
        return False

    def close(self):
        print('closed', flush=True)


sys.exit(run(Busy, []))
"""

# What its end has to do, while an interrupt is dropped that came late.
LATE_INTERRUPT = """
        class Dropped:
            def __del__(self):
                raise KeyboardInterrupt
        Dropped()
        time.sleep(0.1)
        print('closed', flush=True)
"""


def test_a_late_interrupt_does_not_disturb_the_end():
    """One that was dropped in a callback of a C library is not repeated any more."""
    script = SCRIPT.replace("        print('closed', flush=True)\n", LATE_INTERRUPT)
    process = subprocess.Popen([sys.executable, '-c', script], stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert process.stdout.readline() == 'works\n'
    process.send_signal(signal.SIGINT)
    output = process.communicate(timeout=TIMEOUT)[0]
    assert (process.returncode, output) == (0, 'closed\n')


@pytest.mark.parametrize('numbers', [[signal.SIGINT], [signal.SIGTERM], [signal.SIGUSR1],
                                     [signal.SIGHUP],
                                     [signal.SIGINT, signal.SIGINT, signal.SIGTERM]])
def test_a_signal_interrupts_a_callback_that_takes_long(numbers):
    """With exit status 0 and without a traceback; launch and a terminal may both send one."""
    process = subprocess.Popen([sys.executable, '-c', SCRIPT], stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        assert process.stdout.readline() == 'works\n'
        for number in numbers:
            process.send_signal(number)
        printed, _ = process.communicate(timeout=TIMEOUT)
        assert (process.returncode, printed) == (0, 'closed\n')
    finally:
        process.kill()


def test_a_node_in_the_background_of_a_script_ends_when_it_is_asked_to() -> None:
    """A shell ignores SIGINT for it, and nohup SIGHUP, which does not end it."""
    command = ['sh', '-c', 'trap "" INT HUP; exec "$0" -c "$1"', sys.executable, SCRIPT]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == 'works\n'
            process.send_signal(signal.SIGHUP)
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(1.5 * ENDING_TIME)
            process.send_signal(signal.SIGINT)
            assert (process.communicate(timeout=TIMEOUT)[0], process.returncode) == ('closed\n', 0)
        finally:
            process.kill()


def test_an_interrupt_of_source_from_a_text_ends_well(tmp_path: Path) -> None:
    """Python would end a module by the signal itself, though the interrupt was caught."""
    (tmp_path / 'interrupted.py').write_text(SCRIPT.replace(
        'self.create_timer(0.01, self.work)', "exec('self.work()')"))
    path = os.pathsep.join([str(ROOT), str(tmp_path), os.environ.get('PYTHONPATH', '')])
    with subprocess.Popen([sys.executable, '-m', 'interrupted'], stdin=subprocess.DEVNULL,
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={**os.environ, 'PYTHONPATH': path}) as process:
        assert process.stdout is not None and process.stdout.readline() == 'works\n'
        process.send_signal(signal.SIGINT)
        assert (process.communicate(timeout=TIMEOUT)[0], process.returncode) == ('', 0)


def test_a_second_interrupt_ends_a_callback_at_once() -> None:
    """Who presses Ctrl-C again does not wait until a callback may be interrupted anyway."""
    script = f'import push_ros.executor\npush_ros.executor.ENDING_TIME = 1e6\n{SCRIPT}'
    with subprocess.Popen([sys.executable, '-c', script], stdin=subprocess.DEVNULL, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        assert process.stdout is not None and process.stdout.readline() == 'works\n'
        status = None
        while status is None:
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                status = process.wait(1.5 * INTERRUPT_DELAY)
        assert (status, process.stdout.read()) == (0, 'closed\n')


@pytest.mark.parametrize('content', [
    None, b'\xff\x00\x1b', b'/**: {ros__parameters: {a: [1, b]}}'])
def test_a_parameter_file_that_cannot_be_read_is_refused_in_a_line(tmp_path, capsys, content):
    """With its name; there is no node yet."""
    path = tmp_path / 'parameters.yaml'
    if content is not None:
        path.write_bytes(content)
    assert run(None, ['--ros-args', '--params-file', str(path)]) == BAD_PARAMETER
    printed = capsys.readouterr().err
    assert printed.startswith('refused to start: ') and str(path) in printed
    assert printed.count('\n') == 1 and '.c:' not in printed


@pytest.mark.parametrize('arguments, text', [
    (['--params-file', 'my.yaml'], 'got the arguments --params-file my.yaml, expected none but'),
    (['--ros-args', '--parameters'], "got the unknown ROS arguments ['--parameters']"),
    (['--ros-args', '-p', 'a:=[]'], 'parameter')], ids=['no ros', 'unknown', 'no type'])
def test_what_is_no_argument_is_refused_in_a_line(capsys, arguments, text):
    """One without ``--ros-args`` would be overlooked; a list without numbers has no type."""
    def make_node():
        return Node('refused', automatically_declare_parameters_from_overrides=True)

    assert run(make_node, arguments) == BAD_PARAMETER
    printed = capsys.readouterr().err
    assert printed.startswith('refused to start: ') and text in printed
    assert printed.count('\n') == 1


@pytest.mark.parametrize('word', ['-h', '--help'])
def test_help_prints_the_contract_of_a_node(word, capsys):
    """What it publishes and reads; no node is made."""
    class Named:
        """
        Says what it is.

        Publishers
            ``words``
        """

        def __init__(self):
            raise AssertionError

    assert run(Named, [word]) == 0
    printed = capsys.readouterr()
    assert printed.out.startswith('usage: --ros-args') and 'docs/reference' in printed.out
    assert 'Says what it is.\n\nPublishers\n    ``words``\n' in printed.out
    assert not printed.err


# A node that gets a signal while a C library calls back into Python, as a compiler does.
CALLED_BACK = """
import ctypes
import os
import signal
import sys
import time
from push_ros.executor import run

CALLBACK = ctypes.CFUNCTYPE(None)


def make_node():
    CALLBACK(lambda: os.kill(os.getpid(), signal.SIGINT))()
    print('compiled', flush=True)
    # Not in one piece: a signal just before a sleep is noticed after it.
    while True:
        time.sleep(0.1)


sys.exit(run(make_node, []))
"""


def test_a_signal_within_a_callback_of_a_library_interrupts_too():
    """Python drops what is raised there, with a traceback: it is raised again, unseen."""
    ended = subprocess.run([sys.executable, '-c', CALLED_BACK], stdin=subprocess.DEVNULL,
                           text=True, capture_output=True, timeout=TIMEOUT)
    assert (ended.returncode, ended.stderr) == (0, '')


def test_a_wait_ends_with_a_message_of_any_subscription():
    """Whatever their number, and with the time where none comes."""
    with private_domain() as domain:
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        node = rclpy.create_node('waits', context=context)
        try:
            publishers = [node.create_publisher(Float64, name, LATCHED) for name in 'ab']
            # Taken here, as no executor spins the node.
            first, second = (node.create_subscription(Float64, name, lambda _: None, LATCHED)
                             for name in 'ab')
            waiter = MessageWaiter(context)
            waiter.wait([first], 0.01)
            assert take_message(first) is None
            for subscriptions, number in (([first], 0), ([first, second], 1), ([second], 1)):
                sent = Float64(data=float(number))
                publishers[number].publish(sent)
                received, end = None, time.monotonic() + 60.0
                while received is None and time.monotonic() < end:
                    waiter.wait(subscriptions, 60.0)
                    received = take_message(subscriptions[-1])
                assert received == sent
        finally:
            node.destroy_node()
            rclpy.shutdown(context=context)


def test_an_answer_is_awaited_without_an_executor_for_a_time_at_most() -> None:
    """The request is done as soon as the service has answered, and not before."""
    with private_domain() as domain:
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        server, asking = (rclpy.create_node(name, context=context) for name in ('serves', 'asks'))
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(server)
        served: list[Trigger.Request] = []

        def answer(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            served.append(request)
            response.message = 'answered'
            return response
        try:
            server.create_service(Trigger, 'asked', answer)
            client = asking.create_client(Trigger, 'asked')
            assert client.wait_for_service(60.0)
            # Its answer comes first, and is nobody's.
            client.remove_pending_request(client.call_async(Trigger.Request()))
            request = client.call_async(Trigger.Request())
            await_answer(client, request, 0.01)
            assert not request.done()
            while len(served) < 2:
                executor.spin_once(timeout_sec=60.0)
            await_answer(client, request, 60.0)
            result = request.result()
            assert result is not None and result.message == 'answered'
        finally:
            executor.shutdown()
            server.destroy_node()
            asking.destroy_node()
            rclpy.shutdown(context=context)


def test_what_callbacks_leave_for_later_is_done_in_one_turn_of_the_background() -> None:
    """An action leaves each of its answers so: else there were no more than one a turn."""
    with private_domain() as domain:
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        node: Any = rclpy.create_node('leaves', context=context)
        node.background = BackgroundGroup()
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        done: list[int] = []
        try:
            for index in range(5):
                executor.create_task(done.append, index)
            _run_background(node, executor)
            assert sorted(done) == list(range(5))
        finally:
            executor.shutdown()
            node.destroy_node()
            rclpy.shutdown(context=context)
