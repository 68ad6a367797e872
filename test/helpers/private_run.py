"""A private run of two talkers: one in this process, and one in a process of its own."""

from pathlib import Path
import sys

from push_scenario.dds.private_network import make_process_private, private_domain
from push_scenario.dds.processes import NodeProcesses


def main():
    """Run until the standard input ends; the folder of the logs is the argument."""
    # As replay does, before rclpy loads the middleware of the environment.
    make_process_private()
    from helpers.talker import input_has_ended, print_line, talk
    import rclpy
    folder = Path(sys.argv[1])
    with private_domain() as domain, NodeProcesses(domain, folder) as processes:
        processes.start('child', 'helpers.talker', folder / 'none.yaml')
        print_line({'domain': domain, 'child': processes.pid('child')})
        context = rclpy.Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        talk(context, input_has_ended)


if __name__ == '__main__':
    main()
