"""Private runs: nobody else hears them or is heard in them, whatever the environment says."""

import json
import os
from pathlib import Path
import socket
import subprocess
import sys
import tempfile

from helpers.architecture import ROOT
from push_scenario.dds import private_network
from push_scenario.dds.private_network import (
    DOMAINS, private_domain, private_environment, REMOVED_VARIABLES, VARIABLES,
)
from push_scenario.dds.processes import NodeProcesses, SCRIPT_NAME
import pytest

pytestmark = pytest.mark.dds
PATH = os.pathsep.join([str(ROOT), str(ROOT / 'test')])
# A profile as a user may have one: everything as it is by default.
USERS_PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com"><profiles>
  <participant profile_name="robot" is_default_profile="true">
    <rtps><useBuiltinTransports>true</useBuiltinTransports></rtps>
  </participant>
</profiles></dds>
"""
LOOPBACK = '0100007F'


def ordinary_environment(**changes):
    """Make the environment of a user who knows nothing of private runs."""
    environment = {name: value for name, value in os.environ.items()
                   if name not in VARIABLES and name not in REMOVED_VARIABLES}
    return {**environment, 'PYTHONPATH': PATH, **changes}


def users_environment(folder):
    """Make one of a user with settings of Fast DDS, in the variables and in the folder."""
    profile = folder / 'DEFAULT_FASTRTPS_PROFILES.xml'
    profile.write_text(USERS_PROFILE)
    variables = folder / 'variables.json'
    variables.write_text(json.dumps({'environment_variables': {
        'ROS_DISCOVERY_SERVER': '127.0.0.1:11811'}}))
    return ordinary_environment(
        FASTDDS_BUILTIN_TRANSPORTS='DEFAULT', FASTDDS_DEFAULT_PROFILES_FILE=str(profile),
        FASTDDS_ENVIRONMENT_FILE=str(variables), FASTRTPS_DEFAULT_PROFILES_FILE=str(profile),
        RMW_FASTRTPS_USE_QOS_FROM_XML='1', RMW_IMPLEMENTATION='rmw_cyclonedds_cpp',
        ROS_AUTOMATIC_DISCOVERY_RANGE='SUBNET', ROS_DISCOVERY_SERVER='127.0.0.1:11811',
        ROS_LOCALHOST_ONLY='0', ROS_STATIC_PEERS='127.0.0.1', ROS_SUPER_CLIENT='TRUE')


class Started:
    """A process that talks, and what it has heard."""

    def __init__(self, command, environment, folder):
        self.process = subprocess.Popen(command, cwd=folder, env=environment, text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def read(self):
        """Return the next line that it prints."""
        line = self.process.stdout.readline()
        assert line, 'it has ended'
        return json.loads(line)

    def wait_for(self, *names):
        """Wait until it has heard these on each topic and service; return whom it has heard."""
        while True:
            line = self.read()
            if all(set(names) <= set(heard) for heard in line['heard'].values()):
                return line

    def end(self):
        """Let it end; return everybody it has heard of on anything."""
        self.process.stdin.close()
        return everybody(self.process.stdout.read())

    @property
    def name(self):
        """Return the name of the talker."""
        return f'talker_{self.process.pid}'


def everybody(text):
    """List everybody of whom a talker has heard in the end; an empty set without new lines."""
    lines = [json.loads(line) for line in text.splitlines()]
    return set().union(*lines[-1]['heard'].values()) if lines else set()


@pytest.fixture
def start(tmp_path):
    """Start modules as processes; none of them is left."""
    started = []

    def start(module, environment, *arguments):
        command = [sys.executable, '-m', module, *map(str, arguments)]
        started.append(Started(command, environment, tmp_path))
        return started[-1]

    yield start
    for one in started:
        one.process.kill()
        one.process.wait()
        one.process.stdout.close()


def bound_addresses(pid):
    """List the addresses to which a process has bound UDP sockets, as the kernel writes them."""
    links = [os.readlink(path) for path in Path(f'/proc/{pid}/fd').iterdir()]
    rows = [line.split() for table in ('udp', 'udp6')
            for line in Path(f'/proc/{pid}/net/{table}').read_text().splitlines()[1:]]
    return {row[1].split(':')[0] for row in rows if f'socket:[{row[9]}]' in links}


@pytest.mark.slow
@pytest.mark.parametrize('environment', [lambda _: ordinary_environment(), users_environment],
                         ids=['default', 'settings'])
def test_nobody_else_hears_a_private_run_or_is_heard_in_it(start, tmp_path, environment):
    """
    Ordinary nodes in the very same domain hear each other, and those of the run each other.

    One that comes when all the others have found each other is found by its like alone.
    """
    run = start('helpers.private_run', environment(tmp_path), tmp_path)
    about = run.read()
    ordinary = ordinary_environment(ROS_DOMAIN_ID=str(about['domain']))
    talkers = [start('helpers.talker', ordinary) for _ in range(2)]
    names = {talker.name for talker in talkers}
    for talker in talkers:
        talker.wait_for(*names)
    private = {run.name, f"talker_{about['child']}"}
    heard_in_run = everybody(json.dumps(run.wait_for(*private)))
    for pid in (run.process.pid, about['child']):
        assert bound_addresses(pid) == {LOOPBACK}
    talkers.append(start('helpers.talker', ordinary))
    names.add(talkers[-1].name)
    for talker in talkers:
        assert everybody(json.dumps(talker.wait_for(*names))) == names
    assert heard_in_run | run.end() == private
    assert everybody((tmp_path / 'child.log').read_text()) <= private
    assert not set().union(*(talker.end() for talker in talkers)) - names


@pytest.mark.slow
def test_a_shell_can_join_a_private_run(start, tmp_path, monkeypatch):
    """By the script among the logs, whatever its environment has been."""
    monkeypatch.setenv('PYTHONPATH', PATH)
    with private_domain() as domain, NodeProcesses(domain, tmp_path) as processes:
        processes.start('talker', 'helpers.talker', tmp_path / 'none.yaml')
        script = f'. {tmp_path / SCRIPT_NAME}; exec {sys.executable} -m helpers.talker'
        guest = Started(['/bin/sh', '-c', script], users_environment(tmp_path), tmp_path)
        guest.wait_for(f"talker_{processes.pid('talker')}")
        guest.end()


def test_the_domain_is_not_that_of_the_user(monkeypatch):
    """Be it the one that would be taken, and not the one of who has set none."""
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    with private_domain() as domain:
        assert domain != 0
    monkeypatch.setenv('ROS_DOMAIN_ID', f'0{domain}')
    with private_domain() as other:
        assert other not in (0, domain)


@pytest.mark.slow
def test_the_domain_has_no_ordinary_participant(start):
    """Of this host: a domain in which a robot is driven is not taken."""
    with private_domain() as domain:
        pass
    start('helpers.talker', ordinary_environment(ROS_DOMAIN_ID=str(domain))).read()
    with private_domain() as other:
        assert other != domain


def test_private_runs_have_domains_of_their_own():
    """Side by side, until none is free; then with a clear error."""
    with private_domain() as first, private_domain() as second:
        assert first != second


def test_without_a_free_domain_there_is_no_run(monkeypatch):
    """It would share that of another."""
    with private_domain() as domain:
        monkeypatch.setattr(private_network, 'DOMAINS', range(domain, domain + 1))
        with pytest.raises(RuntimeError, match=f'no ROS domain is free: each of {domain} to'):
            private_domain().__enter__()


def test_a_domain_is_reserved_for_all_users_of_the_host():
    """By a socket, which any process would have to bind."""
    with private_domain() as domain, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, \
            pytest.raises(OSError, match='in use'):
        other.bind(('127.0.0.1', private_network.lock_port(domain)))


def test_a_reservation_writes_no_file(monkeypatch, tmp_path):
    """Nothing that is prepared in the temporary directory is followed or emptied."""
    precious = tmp_path / 'precious'
    precious.write_text('content')
    folder = tmp_path / f'push_control_domains_{os.getuid()}'
    folder.mkdir()
    for domain in range(1, 102):
        (folder / str(domain)).symlink_to(precious)
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    with private_domain():
        pass
    assert precious.read_text() == 'content'


def test_a_process_of_another_network_makes_no_private_run():
    """Fast DDS reads its profile once: it would be in the network of the user's robots."""
    script = ("import rclpy; rclpy.init(domain_id=103); rclpy.create_node('robot')\n"
              'from push_scenario.dds.private_network import private_domain\n'
              'with private_domain(): pass')
    done = subprocess.run([sys.executable, '-c', script], text=True, stderr=subprocess.PIPE,
                          env=ordinary_environment())
    assert done.returncode == 1
    assert 'this process has taken part in another ROS network' in done.stderr


def test_nothing_of_the_user_is_lost_but_settings_of_the_network(monkeypatch):
    """Children of a private run have all other variables."""
    monkeypatch.setenv('ROS_LOG_DIR', '/some/logs')
    for name in REMOVED_VARIABLES:
        monkeypatch.setenv(name, 'value')
    environment = private_environment(DOMAINS[0])
    assert environment['ROS_LOG_DIR'] == '/some/logs'
    assert environment['ROS_DOMAIN_ID'] == str(DOMAINS[0])
    assert not set(REMOVED_VARIABLES) & set(environment)
