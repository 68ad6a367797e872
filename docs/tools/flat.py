"""
Draw the pictures of the flat: ``python -m docs.tools.flat``.

It runs the scenario ``task_flat`` in this process, and writes ``flat.png`` and ``flat.gif`` beside
the page about maps.
"""

from pathlib import Path
import sys

from push_scenario.definition.loader import load_scenario
from push_scenario.plots.animation import draw_animation
from push_scenario.plots.figure import draw_floor
from push_scenario.simulation.loop import simulate

FOLDER = Path(__file__).resolve().parents[1] / 'concepts'


def main() -> int:
    """Run the task, and draw it."""
    result = simulate(load_scenario('task_flat'), planning_time=0.0)
    draw_floor(result, FOLDER / 'flat.png')
    draw_animation([result], FOLDER / 'flat.gif')
    print(f'{result.outcome.value} after {result.duration:.1f} s; written: {FOLDER}/flat.png, '
          'flat.gif')
    return 0


if __name__ == '__main__':
    sys.exit(main())
