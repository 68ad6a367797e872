"""Options of ``push replay``."""

import argparse
from pathlib import Path

from push_control.law_names import LAWS
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.engine_names import ENGINES

DEMO = 'task_demo'


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push replay', description='Replay pushing scenarios and evaluate them. The exit '
        'status is 0 only if each run ends as its scenario expects.')
    scenario = parser.add_argument(
        'scenario', nargs='*', metavar='SCENARIO',
        help='path of a scenario file, or name of a scenario of the package')
    # Read by argcomplete.
    setattr(scenario, 'completer', lambda **_: scenario_names())
    parser.add_argument('--list', action='store_true',
                        help='list the scenarios of the package and exit')
    parser.add_argument('--demo', action='store_true',
                        help=f'replay {DEMO}; page and plot are demo.html and demo.png')
    law = parser.add_argument(
        '--law', action='append', metavar='NAME',
        help=f"control law, in place of the scenario's: {', '.join(LAWS)}, or module:Class of "
        'your own; repeat it to compare laws')
    setattr(law, 'completer', lambda **_: LAWS)
    parser.add_argument('--sensors', metavar='NAME',
                        help="sensors of the simulator, in place of the scenario's: path of a "
                        'file, or name of one of config/sensors; a task expects their poses')
    parser.add_argument('--map', metavar='FILE', type=Path,
                        help="map of a task, in place of the scenario's: YAML file of "
                        'nav2_map_server, or one drawn in characters as in config/maps')
    _add_modes(parser)
    _add_products(parser)
    return parser


def _add_modes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--in-process', action='store_true',
                        help='run planner, controller and simulator in one process, without ROS')
    parser.add_argument('--real-time', action='store_true',
                        help='run over DDS at the speed of the wall clock instead of in lockstep')
    parser.add_argument('--engine', choices=ENGINES,
                        help="what moves robot and object, in place of the scenario's: the "
                        'simulator of the package (own), or MuJoCo with wheels that slip (in one '
                        'process; needs the extra mujoco)')
    parser.add_argument('--plan', action='store_true',
                        help='only plan the pushes of a task, and draw them, or why there is no '
                        'plan; the exit status is 1 where there is none')
    parser.add_argument('--bag', type=Path, metavar='DIR',
                        help='play a recording of this scenario to the controller, and tell '
                        'whether it commands the same, to the byte')


def _add_products(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--out', type=Path, default=Path('out'), metavar='DIR',
                        help='directory for tapes, plots and recordings (default: out)')
    parser.add_argument('--json', action='store_true',
                        help='print the results as JSON in place of tables')
    parser.add_argument('--junit', type=Path, metavar='FILE',
                        help='write the results as JUnit XML, too')
    parser.add_argument('--no-record', action='store_true', help='write no MCAP recording')
    parser.add_argument('--no-pictures', action='store_true',
                        help='write no page (HTML) and draw no PNG')
    parser.add_argument('--gif', action='store_true', help='draw an animation (GIF) too')
