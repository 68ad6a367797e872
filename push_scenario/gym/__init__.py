"""
Pushing as an environment of Gymnasium, for learned policies and comparisons.

Importing this module registers it::

    import gymnasium
    import push_scenario.gym

    environment = gymnasium.make('push_control/PushTask-v0')
"""

from push_model.optional import how_to_install

try:
    import gymnasium
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(f'push_scenario.gym: {how_to_install("gymnasium")}',
                              name=error.name) from error

from push_scenario.gym.package_policy import PackagePolicy
from push_scenario.gym.push_task import PushTask

__all__ = ['PackagePolicy', 'PushTask']

gymnasium.register('push_control/PushTask-v0',
                   entry_point='push_scenario.gym.push_task:PushTask')
