"""
Count how often intervals of identified friction cover that of simulated objects.

Boxes are drawn about ``config/objects/box_04.yaml``: friction of feet up to 40 % off, their
spacing times 0.8 to 1.15, contact friction 0.3 to 0.7, the bumper on the floor or up to 0.15 m
above it.
``python -m benchmarks.identification --cases 100`` takes some minutes.
"""

import argparse
import dataclasses
from typing import NamedTuple, Sequence

from benchmarks.identification.recording import record_pushes
import numpy as np
from push_control.identification.friction_changes import mean_square
from push_control.identification.identification import identify
from push_model.analysis.sliding_contact import SupportArrays
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
from push_model.friction import friction_center
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, Support
from push_scenario.recordings.segmentation import split_pushes
from tqdm import tqdm

DESCRIPTION = 'Count how often intervals of identified friction cover that of simulated objects.'
BOX = read_object(config_file('objects/box_04.yaml'))
ROBOT = read_robot(config_file('robots/holonomic_017.yaml'))
NAMES = ('friction_center_x', 'friction_center_y', 'c_squared_ratio', 'contact_friction')
# Chosen: highest bumper, and the height of the mass centre of a box as high as wide [m].
MAX_CONTACT_HEIGHT = 0.15
CENTER_OF_MASS_HEIGHT = 0.2
# Share of the cases with the bumper at the floor. Chosen.
FLOOR_SHARE = 0.2


class Case(NamedTuple):
    """
    One object: errors of the identified numbers, in the order of ``NAMES``.

    :param contact_height: z_C [m].
    :param errors: of F [m], relative errors of c^2 and mu_c, shape (4,).
    :param covered: whether the intervals cover the truth, shape (4,).
    :param is_free: whether pushes said that friction is not as statics has it.
    """

    contact_height: float
    errors: FloatArray
    covered: tuple[bool, ...]
    is_free: bool


class Range(NamedTuple):
    """
    How far boxes are from the nominal one.

    :param spread: range of the true spacing of the feet over the nominal one.
    :param unevenness: greatest relative difference of the friction of a foot.
    """

    spread: tuple[float, float]
    unevenness: float


UNKNOWN_FEET = Range((0.8, 1.15), 0.4)
KNOWN_FEET = Range((1.0, 1.0), 0.0)


def drawn_box(rng: np.random.Generator, contact_height: float,
              drawn: Range) -> tuple[PushedObject, PushedObject]:
    """
    Draw a box.

    :param contact_height: z_C [m].
    :param drawn: range about the nominal box.
    :return: true and nominal box; both have the heights.
    """
    heights = {'contact_height': contact_height,
               'center_of_mass_height': CENTER_OF_MASS_HEIGHT if contact_height else 0.0}
    nominal = dataclasses.replace(BOX, **heights)
    factor = rng.uniform(*drawn.spread)
    supports = tuple(
        Support(factor * support.x, factor * support.y, support.friction_coefficient
                * float(1.0 + drawn.unevenness * rng.uniform(-1.0, 1.0)))
        for support in BOX.supports)
    true = dataclasses.replace(nominal, supports=supports,
                               contact_friction_coefficient=float(rng.uniform(0.3, 0.7)))
    return true, nominal


def run_case(seed: int, drawn: Range = UNKNOWN_FEET) -> Case:
    """
    Push a drawn box in the plant and identify it.

    :param seed: of all that is drawn.
    :param drawn: range about the nominal box.
    """
    rng = np.random.default_rng(seed)
    height = 0.0 if rng.random() < FLOOR_SHARE else float(rng.uniform(0.0, MAX_CONTACT_HEIGHT))
    true, nominal = drawn_box(rng, height, drawn)
    pushes = split_pushes(nominal, ROBOT, *record_pushes(true, ROBOT, rng))
    result = identify(nominal, ROBOT.radius, pushes)
    ratio = mean_square(SupportArrays.of(true)) / mean_square(SupportArrays.of(nominal))
    truth = np.array([*friction_center(true), ratio, true.contact_friction_coefficient])
    intervals = [getattr(result, name) for name in NAMES]
    values = np.array([interval.value for interval in intervals])
    errors = (values - truth) / np.array([1.0, 1.0, *truth[2:]])
    covered = tuple(interval.covers(number) for interval, number in zip(intervals, truth))
    return Case(height, errors, covered, result.is_free)


def summary(cases: Sequence[Case]) -> str:
    """Write coverage and median errors as Markdown."""
    errors = np.median([np.abs(case.errors) for case in cases], axis=0)
    shown = [f'{1e3 * errors[0]:.1f} mm', f'{1e3 * errors[1]:.1f} mm',
             f'{100 * errors[2]:.1f} %', f'{100 * errors[3]:.1f} %']
    lines = [f'{len(cases)} objects, of which {sum(case.is_free for case in cases)} are freed',
             '', '| number | covered by its 95 % interval | median error |', '| --- | --- | --- |']
    lines += [f'| {name} | {sum(case.covered[index] for case in cases)} | {text} |'
              for index, (name, text) in enumerate(zip(NAMES, shown))]
    return '\n'.join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """
    Run the benchmark.

    :param arguments: words of the command line; None for those of the process.
    """
    parser = argparse.ArgumentParser(prog='python -m benchmarks.identification',
                                     description=DESCRIPTION)
    parser.add_argument('--cases', type=int, default=100, help='number of objects (default: 100)')
    parser.add_argument('--first', type=int, default=0, help='seed of the first (default: 0)')
    parser.add_argument('--known-feet', action='store_true',
                        help='supports stand where the file has them, friction is even')
    options = parser.parse_args(arguments)
    drawn = KNOWN_FEET if options.known_feet else UNKNOWN_FEET
    seeds = range(options.first, options.first + options.cases)
    print(summary([run_case(seed, drawn) for seed in tqdm(seeds)]))


if __name__ == '__main__':
    main()
