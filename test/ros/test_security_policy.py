"""Policies of SROS2: each node may use its own interfaces, in an enclave of its own."""

from xml.etree import ElementTree

from push_ros.push_interfaces import ACTION
from push_ros.security_policy import enclave_of, main, NODES, permissions_of
from push_ros.topics import CONTROLLER, SERVICES, TIDY, TOPICS
import pytest

BASE = '/base/get_parameters'


def allowed(profile: ElementTree.Element, group: str, verb: str) -> set[str | None]:
    """List what a profile allows."""
    return {name.text for names in profile.findall(f'{group}s') if names.get(verb) == 'ALLOW'
            for name in names.findall(group)}


@pytest.mark.parametrize('namespace', ['/', '/robots/one'])
def test_a_policy_allows_each_node_its_own_interfaces(
        capsys: pytest.CaptureFixture[str], namespace: str) -> None:
    """And nothing by name that another one offers."""
    assert main(['--namespace', namespace, '--request', BASE]) == 0
    root = ElementTree.fromstring(capsys.readouterr().out.encode())
    profiles = {str(enclave.get('path')): enclave.find('profiles/profile')
                for enclave in root.iter('enclave')}
    assert list(profiles) == [enclave_of(node, namespace) for node in NODES]
    for node, profile in zip(NODES, profiles.values()):
        assert profile is not None
        assert (profile.get('ns'), profile.get('node')) == (namespace, node)
        own = permissions_of(node, [BASE])
        assert allowed(profile, 'topic', 'publish') == own.publish
        assert allowed(profile, 'topic', 'subscribe') == own.subscribe
        assert allowed(profile, 'service', 'reply') == own.reply
        assert allowed(profile, 'service', 'request') == own.request
        assert allowed(profile, 'action', 'execute') == own.execute
        assert allowed(profile, 'action', 'call') == own.call
        assert (own.call == {ACTION}) == (node == TIDY)
        assert ({ACTION, BASE} <= own.execute | own.request) == (node == CONTROLLER)


def test_only_the_controller_commands_the_base() -> None:
    """Every topic and service of the list has somebody who may offer it, unless others do."""
    for name, topic in TOPICS.items():
        publishers = {node for node in NODES
                      if {name, f'/{name}'} & permissions_of(node).publish}
        assert publishers == set(topic.publishers)
    for name, service in SERVICES.items():
        assert [node for node in NODES if name in permissions_of(node).reply] == [service.node]
    assert TOPICS['cmd_vel'].publishers == (CONTROLLER,)
