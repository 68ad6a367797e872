"""
Command line ``push policy``: what each node may do, as a policy of SROS2, on standard output.

The policy is made of the lists from which the nodes are made: each node may use its own topics,
services and action, and what rclpy opens for every node. Anybody else may do nothing. It has the
format of ``ros2 security create_permission``.
"""

import argparse
from collections.abc import Iterable, Sequence
import sys
from typing import NamedTuple
from xml.etree import ElementTree

from push_ros.push_interfaces import ACTION, STATUS, TIDY_ACTION
from push_ros.topics import (
    CONTROLLER, MOCAP, PLANNER, SERVICES, SIM, TAG_DETECTOR, TIDY, topic_of_object, TOPICS,
    TRACKER)

VERSION = '0.2.0'
DONE = 0
NODES = PLANNER, CONTROLLER, SIM, TRACKER, MOCAP, TIDY, TAG_DETECTOR
# Who offers which action.
ACTIONS = {CONTROLLER: ACTION, TIDY: TIDY_ACTION}
# Topic of the poses of any of several objects.
POSES_OF_OBJECTS = topic_of_object('object_pose', '*')
# What rclpy opens for every node, and for one with a lifecycle.
PUBLISHED = '/rosout', '/parameter_events'
SUBSCRIBED = '/clock',
SERVED = tuple(f'~/{name}' for name in (
    'describe_parameters', 'get_parameter_types', 'get_parameters', 'get_type_description',
    'list_parameters', 'set_parameters', 'set_parameters_atomically'))
LIFECYCLE_NODES = PLANNER, CONTROLLER
LIFECYCLE_TOPIC = '~/transition_event'
LIFECYCLE_SERVICES = tuple(f'~/{name}' for name in (
    'change_state', 'get_available_states', 'get_available_transitions', 'get_state',
    'get_transition_graph'))
# Who asks for transforms, and who publishes them.
LISTENERS = PLANNER, CONTROLLER, TRACKER, MOCAP, TIDY
BROADCASTERS = CONTROLLER, SIM
TRANSFORMS = '/tf', '/tf_static'


class Permissions(NamedTuple):
    """
    What a node may do; names are relative to its namespace, or to itself after ``~``.

    :param publish: topics.
    :param subscribe: topics.
    :param reply: services that it offers.
    :param request: services of others that it calls.
    :param execute: actions that it offers.
    :param call: actions of others whose client it is.
    """

    publish: frozenset[str]
    subscribe: frozenset[str]
    reply: frozenset[str]
    request: frozenset[str]
    execute: frozenset[str]
    call: frozenset[str]


def permissions_of(node: str, requests: Iterable[str] = ()) -> Permissions:
    """
    List what a node may do.

    :param node: its name, as of ``NODES``.
    :param requests: further services that the controller calls, as those of its base.
    """
    publish = {_topic_name(name) for name, topic in TOPICS.items() if node in topic.publishers}
    subscribe = {_topic_name(name) for name, topic in TOPICS.items() if node in topic.subscribers}
    reply = {name for name, service in SERVICES.items() if service.node == node}
    if node in LIFECYCLE_NODES:
        publish.add(LIFECYCLE_TOPIC)
        reply.update(LIFECYCLE_SERVICES)
    if node in LISTENERS:
        subscribe.update(TRANSFORMS)
    if node in BROADCASTERS:
        publish.add(TRANSFORMS[0])
    if node in (CONTROLLER, TIDY):
        subscribe.add(POSES_OF_OBJECTS)
    if node in TOPICS['object_pose'].publishers:
        publish.add(POSES_OF_OBJECTS)
    is_controller = node == CONTROLLER
    if is_controller:
        publish.add(STATUS)
        # Others that command the base are named.
        subscribe.add('cmd_vel')
    return Permissions(
        frozenset({*publish, *PUBLISHED}), frozenset({*subscribe, *SUBSCRIBED}),
        frozenset({*reply, *SERVED}), frozenset(requests if is_controller else ()),
        frozenset({ACTIONS[node]} if node in ACTIONS else ()),
        frozenset({ACTION} if node == TIDY else ()))


def _topic_name(name: str) -> str:
    return f'/{name}' if TOPICS[name].is_global else name


def policy(namespace: str = '/', requests: Iterable[str] = ()) -> str:
    """
    Write the policy of all nodes, each in an enclave of its own name.

    :param namespace: of the nodes, absolute.
    :param requests: as of ``permissions_of``.
    :return: XML.
    """
    root = ElementTree.Element('policy', version=VERSION)
    enclaves = ElementTree.SubElement(root, 'enclaves')
    for node in NODES:
        enclave = ElementTree.SubElement(enclaves, 'enclave', path=enclave_of(node, namespace))
        profiles = ElementTree.SubElement(enclave, 'profiles')
        profile = ElementTree.SubElement(profiles, 'profile', ns=namespace, node=node)
        allowed = permissions_of(node, requests)
        for kind, verb, names in (
                ('topic', 'publish', allowed.publish), ('topic', 'subscribe', allowed.subscribe),
                ('service', 'reply', allowed.reply), ('service', 'request', allowed.request),
                ('action', 'execute', allowed.execute), ('action', 'call', allowed.call)):
            _add_names(profile, kind, verb, names)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding='unicode', xml_declaration=True)


def _add_names(profile: ElementTree.Element, kind: str, verb: str, names: Iterable[str]) -> None:
    """Allow something with each of some topics, services or actions."""
    if not names:
        return
    group = ElementTree.SubElement(profile, f'{kind}s', {verb: 'ALLOW'})
    for name in sorted(names):
        ElementTree.SubElement(group, kind).text = name


def enclave_of(node: str, namespace: str = '/') -> str:
    """
    Name the enclave of a node, as launch files do.

    :param namespace: of the node, with or without slashes around it.
    """
    return '/'.join(['', *filter(None, namespace.split('/')), node])


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status.
    """
    options = make_parser().parse_args(arguments)
    namespace = '/' + options.namespace.strip('/')
    print(policy(namespace, options.request))
    return DONE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push policy', description='Write a policy of SROS2: each node may use its own '
        'topics, services and action, and nothing else.')
    parser.add_argument('--namespace', default='/', help='of the nodes')
    parser.add_argument('--request', action='append', default=[], metavar='SERVICE',
                        help='service that the controller calls, as of its base or of a collision '
                        'monitor; again for more')
    return parser


if __name__ == '__main__':
    sys.exit(main())
