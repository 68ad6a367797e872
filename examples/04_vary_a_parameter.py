"""Vary a true parameter that planner and controller do not know: contact friction."""

import dataclasses
import math

from push_scenario import load_scenario, measure, simulate


def main() -> None:
    """Simulate the same push with less and more friction than its nominal value."""
    scenario = load_scenario('corner_push_mismatch')
    print(f'nominal contact friction {scenario.object.contact_friction_coefficient:.2f}')
    for friction in (0.3, 0.4, 0.5, 0.6):
        truth = dataclasses.replace(scenario.true_object, contact_friction_coefficient=friction)
        result = simulate(dataclasses.replace(scenario, true_object=truth))
        metrics = measure(result)
        assert metrics is not None, result.reason
        print(f'true {friction:.2f}: {result.outcome.value}, '
              f'{1e3 * metrics.position_error:4.1f} mm and '
              f'{math.degrees(metrics.heading_error):+.2f} deg off, '
              f'contact slid {1e3 * metrics.slip:.1f} mm')


if __name__ == '__main__':
    main()
