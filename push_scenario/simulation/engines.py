"""Plants of the engines that a scenario may ask for."""

from collections.abc import Callable

from push_model.optional import how_to_install
from push_scenario.definition.scenario import Scenario
from push_sim_node.plant import Plant


def plant_type_of(scenario: Scenario) -> Callable[..., Plant]:
    """
    Return what makes the plant of a scenario.

    :raises RuntimeError: where its engine is not installed.
    """
    if scenario.engine == 'own':
        return Plant
    try:
        # Imported here: the extra is installed where it is asked for.
        from push_mujoco.engine_plant import engine_plant
    except ModuleNotFoundError as error:
        raise RuntimeError(f'{scenario.name}: engine: got {scenario.engine!r}, expected what is '
                           f'installed: {how_to_install(error.name) or error}') from error
    return engine_plant()
