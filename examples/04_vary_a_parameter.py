"""Vary a true parameter that planner and controller do not know: contact friction."""

import dataclasses
import math

from push_scenario import load_scenario, simulate_many


def main() -> None:
    """Simulate the same push with less and more friction than its nominal value, on all cores."""
    scenario = load_scenario('corner_push_mismatch')
    truths = [dataclasses.replace(scenario.true_object, contact_friction_coefficient=friction)
              for friction in (0.3, 0.4, 0.5, 0.6)]
    rows = simulate_many(dataclasses.replace(scenario, true_object=truth) for truth in truths)
    print(f'nominal contact friction {scenario.object.contact_friction_coefficient:.2f}')
    for truth, row in zip(truths, rows):
        print(f'true {truth.contact_friction_coefficient:.2f}: {row["outcome"]}, '
              f'{1e3 * row["position_error"]:4.1f} mm and '
              f'{math.degrees(row["heading_error"]):+.2f} deg off, '
              f'contact slid {1e3 * row["slip"]:.1f} mm')


if __name__ == '__main__':
    main()
