"""
Speed and error of the plant, against MuJoCo on the same pushes.

The reference of each is itself at a fine step, so that MuJoCo's deviation from Coulomb's law does
not count as an error. Takes about three minutes, ``--quick`` some seconds; prints Markdown, and
writes it with a figure to a directory if one is given (``--out docs/reports``).
"""

import argparse
import dataclasses
from pathlib import Path
import statistics
import time
from typing import Callable, Optional, Sequence

from benchmarks.plant.scenes import apart, extrapolated, MovingObject, ORIGIN, Scene, SCENES
from benchmarks.report_template import fill_template
from push_model.geometry import Pose
from push_mujoco.scene import DEFAULT, Engine, HARD, TUNED
from push_mujoco.velocity_robot import MujocoPlant
from tqdm import tqdm

DESCRIPTION = 'Speed and error of the plant, against MuJoCo on the same pushes.'
# Error at which speeds are compared [m]; chosen.
ALLOWED = 1e-3
# Steps that are compared [s].
PLANT_STEPS = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2)
ENGINES = {'default': DEFAULT, 'hard': HARD, 'tuned': TUNED}
ENGINE_STEPS = (2.5e-4, 5e-4, 1e-3, 2e-3, 5e-3)
# Step of MuJoCo's reference [s]; a fifth of its finest compared step.
REFERENCE_STEP = 5e-5
# Time between two settings of MuJoCo's robot velocity [s]; chosen: long enough that the time spent
# in Python does not count.
COMMAND_PERIOD = 0.01
TEXT = Path(__file__).with_name('plant.md.in')
PlantMaker = Callable[[Scene], MovingObject]
Choice = Callable[[Sequence[float]], float]
CHOICES: tuple[tuple[str, Choice], ...] = (('max', max), ('median', statistics.median))


@dataclasses.dataclass(frozen=True)
class Run:
    """
    Runs of all scenes with one simulator at one step.

    :param name: of the simulator.
    :param step: [s].
    :param errors: per scene [m].
    :param cpu: CPU time per scene [s].
    :param simulated: simulated time per scene [s].
    """

    name: str
    step: float
    errors: tuple[float, ...]
    cpu: tuple[float, ...]
    simulated: tuple[float, ...]

    @property
    def speed(self) -> float:
        """Simulated seconds per CPU second, over all scenes."""
        return sum(self.simulated) / sum(self.cpu)

    @property
    def step_cost(self) -> float:
        """CPU time per step [s]."""
        return sum(self.cpu) * self.step / sum(self.simulated)


def plant_maker(step: float) -> PlantMaker:
    """Return a function that builds the plant of a scene."""
    return lambda scene: scene.plant(step)


def engine_maker(engine: Engine, step: float) -> PlantMaker:
    """Return a function that builds the MuJoCo plant of a scene."""
    engine = dataclasses.replace(engine, step=step)
    return lambda scene: MujocoPlant(
        scene.object, scene.robot, ORIGIN, scene.robot_pose, engine,
        steps_per_command=max(1, round(COMMAND_PERIOD / engine.step)))


def timed(scene: Scene, make: PlantMaker, rounds: int = 1) -> tuple[Pose, float]:
    """Return the object's pose at the end of a scene, and the least CPU time of some runs [s]."""
    best, pose = float('inf'), ORIGIN
    for _ in range(rounds):
        plant = make(scene)
        began = time.process_time()
        pose = scene.end(plant)
        best = min(best, time.process_time() - began)
    return pose, best


def measure(name: str, step: float, make: PlantMaker, references: Sequence[Pose],
            scenes: Sequence[Scene], rounds: int = 1) -> Run:
    """Run all scenes with one simulator at one step."""
    ends = [timed(scene, make, rounds) for scene in scenes]
    return Run(name, step, tuple(apart(end[0], pose) for end, pose in zip(ends, references)),
               tuple(end[1] for end in ends), tuple(scene.duration for scene in scenes))


def plant_runs(scenes: Sequence[Scene], fine: float) -> list[Run]:
    """Run the plant; reference: two fine steps, extrapolated to a step of 0."""
    references = [extrapolated(scene.end(scene.plant(2.0 * fine)), scene.end(scene.plant(fine)))
                  for scene in tqdm(scenes, desc='plant, reference')]
    return [measure('plant', step, plant_maker(step), references, scenes, 5)
            for step in tqdm(PLANT_STEPS, desc='plant')]


def engine_runs(name: str, engine: Engine, scenes: Sequence[Scene], steps: Sequence[float],
                fine: float) -> list[Run]:
    """Run MuJoCo with some settings; reference: the same settings at a fine step."""
    references = [scene.end(engine_maker(engine, fine)(scene))
                  for scene in tqdm(scenes, desc=f'MuJoCo {name}, reference')]
    return [measure(name, step, engine_maker(engine, step), references, scenes)
            for step in tqdm(steps, desc=f'MuJoCo {name}')]


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Write a Markdown table."""
    return '\n'.join('| ' + ' | '.join(line) + ' |'
                     for line in (head, ['---'] * len(head), *rows))


def milli(values: Sequence[float], digits: int = 3) -> list[str]:
    """Write maximum and median of some lengths [mm]."""
    return [f'{1e3 * max(values):.{digits}f}', f'{1e3 * statistics.median(values):.{digits}f}']


def scene_table(runs: Sequence[Run], scenes: Sequence[Scene]) -> str:
    """Write the plant's error per scene and step."""
    rows = [[scene.name, *(f'{1e3 * run.errors[i]:.3f}' for run in runs)]
            for i, scene in enumerate(scenes)]
    for title, choose in CHOICES:
        rows.append([f'**{title}**', *(f'**{1e3 * choose(run.errors):.3f}**' for run in runs)])
    return table(['error mm', *(f'{1e3 * run.step:g} ms' for run in runs)], rows)


def run_table(runs: Sequence[Run]) -> str:
    """Write error and cost of runs."""
    return table(['simulator', 'step ms', 'max mm', 'median mm', 'us per step',
                  'simulated s per CPU s'],
                 [[run.name, f'{1e3 * run.step:g}', *milli(run.errors),
                   f'{1e6 * run.step_cost:.2f}', f'{run.speed:.0f}'] for run in runs])


def cheapest(runs: Sequence[Run], choose: Choice) -> Optional[Run]:
    """Return the fastest run whose errors, all or the median, are below ``ALLOWED``."""
    good = [run for run in runs if choose(run.errors) < ALLOWED]
    return max(good, key=lambda run: run.speed, default=None)


def ratio_table(ours: Sequence[Run], theirs: dict[str, list[Run]]) -> str:
    """Write the ratios of speeds, at equal step and at equal accuracy."""
    rows: list[list[str]] = []
    ours_at_1_ms = next(run for run in ours if run.step == 1e-3)
    for title, choose in CHOICES:
        best = cheapest(ours, choose)
        if best is None:
            raise RuntimeError(f'{title}: got no run of the plant with an error below '
                               f'{ALLOWED:g} m, expected one')
        for name, runs in theirs.items():
            at_1_ms = next(run for run in runs if run.step == 1e-3)
            rows.append([name, f'{at_1_ms.step_cost / ours_at_1_ms.step_cost:.0f}', title,
                         f'{1e3 * best.step:g} ms', *_accurate_run(best, runs, choose)])
    return table(['MuJoCo', 'times faster per 1 ms step', 'error below 1 mm', 'plant at',
                  'MuJoCo at', 'times faster then'], rows)


def _accurate_run(best: Run, runs: Sequence[Run], choose: Choice) -> tuple[str, str]:
    """Write the step at which an engine is accurate, and how much faster the best run is."""
    run = cheapest(runs, choose)
    if run is None:
        return 'none', f'above {best.speed / min(slow.speed for slow in runs):.0f}'
    return f'{1e3 * run.step:g} ms', f'{best.speed / run.speed:.0f}'


def picture(path: Path, ours: list[Run], theirs: dict[str, list[Run]]) -> None:
    """Draw error against step, and error against cost."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(11, 4.6), layout='constrained')
    by_step, by_cost = figure.subplots(1, 2, sharey=True)
    lines = [('plant', ours, '#0b6e4f', '-')]
    lines += [(f'MuJoCo, {name}', runs, color, '--') for (name, runs), color
              in zip(theirs.items(), ('#d1495b', '#edae49', '#30638e'))]
    for label, runs, color, style in lines:
        for axis, xs in ((by_step, [1e3 * run.step for run in runs]),
                         (by_cost, [1.0 / run.speed for run in runs])):
            axis.loglog(xs, [1e3 * max(run.errors) for run in runs], 'o' + style, color=color,
                        label=f'{label}: max')
            axis.loglog(xs, [1e3 * statistics.median(run.errors) for run in runs], '.:',
                        color=color, label=f'{label}: median')
    by_step.set(xlabel='step [ms]', ylabel='error of the pose at the end [mm]')
    by_cost.set(xlabel='CPU time per simulated time')
    for axis in (by_step, by_cost):
        axis.axhline(1e3 * ALLOWED, color='black', lw=0.8)
        axis.grid(alpha=0.3)
    by_step.legend(fontsize=7)
    figure.savefig(path, dpi=110)


def report(quick: bool) -> tuple[str, list[Run], dict[str, list[Run]]]:
    """Measure everything; return the text and the runs."""
    scenes = SCENES[3:6] if quick else SCENES
    ours = plant_runs(scenes, 5e-5 if quick else 1e-5)
    steps, fine = (ENGINE_STEPS[2:4], 2.5e-4) if quick else (ENGINE_STEPS, REFERENCE_STEP)
    theirs = {name: engine_runs(name, engine, scenes, steps, fine)
              for name, engine in ENGINES.items()}
    text = fill_template(TEXT, FINE=f'{1e6 * fine:g}', SCENES=scene_table(ours, scenes),
                         RUNS=run_table([*ours, *theirs['tuned']]),
                         RATIOS=ratio_table(ours, theirs))
    return text, ours, theirs


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--quick', action='store_true', help='three scenes, coarse references')
    parser.add_argument('--out', type=Path, help='directory for plant.md and plant.png')
    arguments = parser.parse_args()
    text, ours, theirs = report(arguments.quick)
    print(text)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / 'plant.md').write_text(text, encoding='utf-8')
        picture(arguments.out / 'plant.png', ours, theirs)


if __name__ == '__main__':
    main()
