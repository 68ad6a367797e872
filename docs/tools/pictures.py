"""
Draw the pictures of runs in the docs: ``python -m docs.tools.pictures``.

It simulates their scenarios in this process, and writes how each run ended to ``pictures.json``,
which tests compare with runs of their own.
"""

import dataclasses
import json
from pathlib import Path
import sys

from push_model.files.parameter_files import named_file
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.headline import headline
from push_scenario.first_plan import find_first_plan
from push_scenario.plots.animation import draw_animation
from push_scenario.plots.figure import draw_figure, draw_floor
from push_scenario.plots.plan_picture import draw_plan_picture
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import RunResult
from push_scenario.tidying.picture import draw_room
from push_scenario.tidying.room import read_room
from push_scenario.tidying.tidy import tidy

DOCS = Path(__file__).resolve().parents[1]
RECORD = DOCS / 'pictures.json'
# Scenarios in pictures, and their laws.
RUNS = {'task_demo': ('feedback',), 'task_flat': ('feedback',),
        'corner_push_mismatch': ('open_loop', 'feedback', 'mpc')}

# Room in a picture.
ROOM = 'blocked_door'
# Scenario whose first plan is drawn, and drift of the heading with which it is refused [rad/m].
PLANNED, DRIFT = 'task_flat', 0.1


def main() -> int:
    """Run the scenarios, and draw them."""
    runs = {name: [_simulated(name, law) for law in laws] for name, laws in RUNS.items()}
    draw_animation(runs['task_demo'], DOCS / 'demo.gif')
    draw_figure(runs['corner_push_mismatch'], DOCS / 'laws.png')
    draw_floor(runs['task_flat'][0], DOCS / 'concepts' / 'flat.png')
    draw_animation(runs['task_flat'], DOCS / 'concepts' / 'flat.gif')
    draw_plans()
    draw_tidied_room()
    record = {name: {result.control_law: headline(result) for result in results}
              for name, results in runs.items()}
    RECORD.write_text(json.dumps(record, indent=2) + '\n', encoding='utf-8')
    print('written: demo.gif, laws.png, concepts/flat.png, concepts/flat.gif, concepts/plan.png, '
          f'concepts/refusal.png, tidy.png, {RECORD.name}')
    return 0


def draw_tidied_room() -> None:
    """Draw how a blocked door is freed, and what came through it."""
    draw_room(tidy(read_room(named_file('rooms', ROOM))), DOCS / 'tidy.png')


def draw_plans() -> None:
    """Draw a first plan, and why there is none for a robot whose odometry drifts more."""
    scenario = load_scenario(PLANNED)
    for case, name in ((scenario, 'plan.png'), (_drifting(scenario), 'refusal.png')):
        draw_plan_picture(case, find_first_plan(case), DOCS / 'concepts' / name)


def _drifting(scenario: Scenario) -> Scenario:
    """Return the same with a robot that states a larger drift of its heading."""
    task = scenario.task
    assert task is not None
    supervision = dataclasses.replace(task.supervision, odometry_drift=DRIFT)
    return dataclasses.replace(scenario, task=dataclasses.replace(task, supervision=supervision))


def pictured(name: str, law: str) -> str:
    """
    Look up how the run ended that a picture shows.

    :param name: of the scenario.
    :param law: of the run.
    :return: as ``headline`` writes it.
    """
    return json.loads(RECORD.read_text(encoding='utf-8'))[name][law]


def _simulated(name: str, law: str) -> RunResult:
    # As over DDS in lockstep, time stands still while a task is planned.
    scenario = load_scenario(name)
    return simulate(scenario, law, planning_time=None if scenario.task is None else 0.0)


if __name__ == '__main__':
    sys.exit(main())
