"""How often does a push succeed? Draw friction and noise, on all cores; give an interval."""

from collections.abc import Iterator
import dataclasses

import numpy as np
from push_scenario import load_scenario, Scenario, simulate_many
from scipy.stats import binomtest

RUNS = 20


def draw(count: int) -> Iterator[Scenario]:
    """Draw true contact friction from 0.3 to 0.7, and other noise in every run."""
    scenario, random = load_scenario('friction_interval'), np.random.default_rng(1)
    for seed in range(count):
        truth = dataclasses.replace(scenario.true_object,
                                    contact_friction_coefficient=random.uniform(0.3, 0.7))
        yield dataclasses.replace(scenario, true_object=truth).with_seed(seed)


def main() -> None:
    """Count the pushes within bounds; a second call reuses the rows of the first."""
    rows = simulate_many(draw(RUNS), folder='out/monte_carlo')
    successes = sum(row['is_as_expected'] for row in rows)
    interval = binomtest(successes, RUNS).proportion_ci()
    errors = 1e3 * np.array([row['position_error'] for row in rows])
    print(f'{successes} of {RUNS} pushes within bounds; of all, 95 % confident: '
          f'{interval.low:.0%} to {interval.high:.0%}')
    print(f'position error: median {np.median(errors):.1f} mm, '
          f'90 of 100 below {np.percentile(errors, 90):.1f} mm')


if __name__ == '__main__':
    main()
