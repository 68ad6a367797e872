"""
Network of private runs, which no other ROS node hears or is heard in.

The nodes of a replay, a test or a benchmark talk over the loopback interface only, and over ports
of their own: Fast DDS computes its ports from a base, the domain and the number of the
participant, and the base of private runs lies between the ports of ordinary nodes. So an ordinary
node does not find them even in the same domain. The domain keeps private runs apart.
"""

from collections.abc import Generator, Iterable, Iterator
import contextlib
import os
from pathlib import Path
import shlex
import socket
import threading

# Domains whose ports do not overlap the ephemeral ports of Linux.
DOMAINS = range(1, 101)
RMW = 'rmw_fastrtps_cpp'
PROFILE = Path(__file__).with_name('private_network.xml')
# What a process of a private run has in its environment besides its domain. For any other range
# of discovery the middleware would add a transport and peers to those of the profile.
VARIABLES = {'FASTDDS_DEFAULT_PROFILES_FILE': str(PROFILE),
             'FASTRTPS_DEFAULT_PROFILES_FILE': str(PROFILE),
             'SKIP_DEFAULT_XML_FILE': '1',
             'RMW_IMPLEMENTATION': RMW,
             'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SYSTEM_DEFAULT'}
# What would add peers, servers, transports or keys, or change what the profile says.
REMOVED_VARIABLES = ('FASTDDS_BUILTIN_TRANSPORTS', 'FASTDDS_ENVIRONMENT_FILE',
                     'FASTDDS_STATISTICS', 'RMW_FASTRTPS_PUBLICATION_MODE',
                     'RMW_FASTRTPS_USE_QOS_FROM_XML', 'ROS_DISCOVERY_SERVER',
                     'ROS_LOCALHOST_ONLY', 'ROS_SECURITY_ENABLE', 'ROS_STATIC_PEERS',
                     'ROS_SUPER_CLIENT')
# Ports as RTPS computes them: each domain has so many from its base on, of which participants
# share the first two, and each has two of its own behind the offset.
ORDINARY_PORT_BASE = 7400
PRIVATE_PORT_BASE = 7550
DOMAIN_GAIN = 250
PARTICIPANT_OFFSET = 10
PORTS_PER_PARTICIPANT = 2
# How many participants are looked for; those of a private run announce themselves to as many.
PARTICIPANTS = 32
# Port of a domain that no participant uses: whoever has bound it has reserved the domain.
LOCK_OFFSET = 9
LOOPBACK, ANY_ADDRESS = '127.0.0.1', ''

_lock = threading.Lock()
_is_private = False


@contextlib.contextmanager
def private_domain() -> Generator[int, None, None]:
    """
    Reserve a silent domain of the private network until the block ends.

    From then on this process and the processes that it starts are in the private network for
    good, as Fast DDS reads its profile once.

    :return: context manager that yields the number of the domain, neither 0 nor that of the
        environment's ``ROS_DOMAIN_ID``.
    :raises RuntimeError: where no domain is free, or where this process has taken part in another
        network.
    """
    with contextlib.ExitStack() as stack:
        domain = _reserve_domain(stack)
        _join(domain)
        yield domain


def private_environment(domain: int | None = None) -> dict[str, str]:
    """
    Make the environment of a process in the private network from that of this process.

    :param domain: its domain; None for that of this process.
    """
    environment = {name: value for name, value in os.environ.items()
                   if name not in REMOVED_VARIABLES}
    environment |= VARIABLES
    if domain is not None:
        environment['ROS_DOMAIN_ID'] = str(domain)
    return environment


def make_process_private() -> None:
    """
    Put the environment of the private network in place of that of this process.

    Before rclpy is imported, which loads the middleware of the environment, this may be any.
    """
    os.environ.update(VARIABLES)
    for name in REMOVED_VARIABLES:
        os.environ.pop(name, None)


def joining_script(domain: int) -> str:
    """
    Write lines for a shell, whose commands, such as ``ros2 topic``, then see a private run.

    :param domain: of the run.
    """
    variables = {**VARIABLES, 'ROS_DOMAIN_ID': str(domain)}
    exports = [f'export {name}={shlex.quote(value)}' for name, value in variables.items()]
    return '\n'.join(['unset ' + ' '.join(REMOVED_VARIABLES), *exports, ''])


def lock_port(domain: int) -> int:
    """
    Return the UDP port that is bound while a domain is reserved.

    :param domain: of the run.
    """
    return _first_port(PRIVATE_PORT_BASE, domain) + LOCK_OFFSET


def _reserve_domain(stack: contextlib.ExitStack) -> int:
    """Bind the lock of a domain in which nobody is; the stack releases it."""
    users = os.environ.get('ROS_DOMAIN_ID', '')
    excluded = int(users) if users.isdecimal() else 0
    # Start at another one in each process: so many that start at once find theirs sooner.
    for i in range(len(DOMAINS)):
        domain = DOMAINS[(os.getpid() + i) % len(DOMAINS)]
        if domain == excluded:
            continue
        lock = _bind(LOOPBACK, lock_port(domain))
        if lock is None:
            continue
        if _is_silent(domain):
            stack.enter_context(lock)
            return domain
        lock.close()
    raise RuntimeError(f'no ROS domain is free: each of {DOMAINS[0]} to {DOMAINS[-1]} is that of '
                       'ROS_DOMAIN_ID or has a participant on this host')


def _is_silent(domain: int) -> bool:
    """Tell whether no participant of this host is in a domain, ordinary or private."""
    # Ordinary participants share the first port, where they listen to multicast.
    ordinary = [_first_port(ORDINARY_PORT_BASE, domain),
                *_participant_ports(ORDINARY_PORT_BASE, domain)]
    return (_are_free(ANY_ADDRESS, ordinary)
            and _are_free(LOOPBACK, _participant_ports(PRIVATE_PORT_BASE, domain)))


def _join(domain: int) -> None:
    """Let Fast DDS read the profile, once in a process, and make sure that it has."""
    global _is_private
    with _lock:
        make_process_private()
        if _is_private:
            return
        # Imported here: it loads the middleware that the environment says.
        import rclpy
        from rclpy.context import Context
        from rclpy.utilities import get_rmw_implementation_identifier
        implementation = get_rmw_implementation_identifier()
        if implementation != RMW:
            raise RuntimeError(f'RMW_IMPLEMENTATION: this process has loaded {implementation}, '
                               f'expected {RMW} for a private run; start it in a process of its '
                               'own')
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        try:
            node = rclpy.create_node('probe', context=context, enable_rosout=False,
                                     start_parameter_services=False)
            _is_private = not _are_free(LOOPBACK, _participant_ports(PRIVATE_PORT_BASE, domain))
            node.destroy_node()
        finally:
            rclpy.shutdown(context=context)
    if not _is_private:
        raise RuntimeError('this process has taken part in another ROS network, in which a run '
                           'would not be private; start it in a process of its own')


def _first_port(base: int, domain: int) -> int:
    return base + DOMAIN_GAIN * domain


def _participant_ports(base: int, domain: int) -> Iterator[int]:
    """Yield the ports at which the participants of a domain are found."""
    first = _first_port(base, domain) + PARTICIPANT_OFFSET
    yield from range(first, first + PORTS_PER_PARTICIPANT * PARTICIPANTS, PORTS_PER_PARTICIPANT)


def _are_free(address: str, ports: Iterable[int]) -> bool:
    for port in ports:
        taken = _bind(address, port)
        if taken is None:
            return False
        taken.close()
    return True


def _bind(address: str, port: int) -> socket.socket | None:
    """Bind a UDP port; return None where another socket has."""
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        endpoint.bind((address, port))
    except OSError:
        endpoint.close()
        return None
    return endpoint
