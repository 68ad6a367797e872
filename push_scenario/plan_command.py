"""What ``push replay --plan`` does: plan the pushes of a task, tell and draw them."""

from pathlib import Path
import sys

from push_model.optional import how_to_install
from push_scenario.definition.scenario import Scenario
from push_scenario.first_plan import find_first_plan


def show_plan(scenario: Scenario, folder: Path) -> bool:
    """
    Print and draw the first plan of a task, or why there is none.

    :param folder: in which ``NAME_plan.png`` is written.
    :return: whether there is a plan.
    """
    plan = find_first_plan(scenario)
    print(f'{scenario.name}: {plan}')
    try:
        # Imported here: only the picture needs matplotlib.
        from push_scenario.plots.plan_picture import draw_plan_picture
    except ModuleNotFoundError as error:
        print(f'push replay: no picture: {how_to_install(error.name or "")}', file=sys.stderr)
    else:
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f'{scenario.name}_plan.png'
        draw_plan_picture(scenario, plan, path)
        print(f'written: {path}')
    return plan.refusal is None
