"""
Speed and error of the plant, against MuJoCo on the same pushes.

Both are judged by fine steps of their own law, so that MuJoCo is not charged for differing from
Coulomb's. Takes about three minutes, ``--quick`` some seconds; prints Markdown, and writes it with
a picture to a directory if one is given (``--out docs/validation``).
"""

import argparse
import dataclasses
from pathlib import Path
import statistics
import time

from benchmarks.plant.mujoco_scene import DEFAULT, HARD, Rival, TUNED
from benchmarks.plant.scenes import apart, extrapolated, ORIGIN, SCENES
from benchmarks.progress_bar import progress

ALLOWED = 1e-3
PLANT_STEPS = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2)
ENGINES = {'default': DEFAULT, 'hard': HARD, 'tuned': TUNED}
ENGINE_STEPS = (2.5e-4, 5e-4, 1e-3, 2e-3, 5e-3)
REFERENCE_STEP = 5e-5
HOLD = 0.01
TEXT = Path(__file__).with_name('plant.md.in')


@dataclasses.dataclass(frozen=True)
class Run:
    """
    Runs of all scenes with one setting.

    :param name: of the simulator.
    :param step: [s].
    :param errors: per scene [m].
    :param cpu: CPU time per scene [s].
    :param simulated: simulated time per scene [s].
    """

    name: str
    step: float
    errors: tuple
    cpu: tuple
    simulated: tuple

    @property
    def speed(self):
        """Simulated seconds per CPU second, over all scenes."""
        return sum(self.simulated) / sum(self.cpu)

    @property
    def step_cost(self):
        """CPU time per step [s]."""
        return sum(self.cpu) * self.step / sum(self.simulated)


class Paced(Rival):
    """MuJoCo whose robot gets its velocity every 10 ms: Python costs it nothing that counts."""

    def advance(self, duration, command):
        """Let time pass while one command stands."""
        super().advance(duration, command, max(1, round(HOLD / self.engine.step)))


def plant_maker(step):
    """Return what makes a plant of a scene."""
    return lambda scene: scene.plant(step)


def engine_maker(engine, step):
    """Return what makes MuJoCo of a scene."""
    engine = dataclasses.replace(engine, step=step)
    return lambda scene: Paced(scene.object, scene.robot, ORIGIN, scene.robot_pose, engine)


def timed(scene, make, rounds=1):
    """Return the object's pose at the end of a scene, and the least CPU time of some runs [s]."""
    best = float('inf')
    for _ in range(rounds):
        mover = make(scene)
        began = time.process_time()
        pose = scene.end(mover)
        best = min(best, time.process_time() - began)
    return pose, best


def measure(name, step, make, references, scenes, rounds=1):
    """Run all scenes with one setting."""
    ends = [timed(scene, make, rounds) for scene in scenes]
    return Run(name, step, tuple(apart(end[0], pose) for end, pose in zip(ends, references)),
               tuple(end[1] for end in ends), tuple(scene.duration for scene in scenes))


def plant_runs(scenes, fine):
    """Return runs of the plant; reference: two fine steps, extrapolated to none."""
    references = [extrapolated(scene.end(scene.plant(2.0 * fine)), scene.end(scene.plant(fine)))
                  for scene in progress(scenes, 'plant, reference')]
    return [measure('plant', step, plant_maker(step), references, scenes, 5)
            for step in progress(PLANT_STEPS, 'plant')]


def engine_runs(name, engine, scenes, steps, fine):
    """Return runs of MuJoCo with some settings; reference: the same settings, a fine step."""
    references = [scene.end(engine_maker(engine, fine)(scene))
                  for scene in progress(scenes, f'MuJoCo {name}, reference')]
    return [measure(name, step, engine_maker(engine, step), references, scenes)
            for step in progress(steps, f'MuJoCo {name}')]


def table(head, rows):
    """Write a Markdown table."""
    return '\n'.join('| ' + ' | '.join(line) + ' |'
                     for line in (head, ['---'] * len(head), *rows))


def milli(values, digits=3):
    """Write the most and the median of some lengths [mm]."""
    return [f'{1e3 * max(values):.{digits}f}', f'{1e3 * statistics.median(values):.{digits}f}']


def scene_table(runs, scenes):
    """Write the plant's error per scene and step."""
    rows = [[scene.name, *(f'{1e3 * run.errors[i]:.3f}' for run in runs)]
            for i, scene in enumerate(scenes)]
    for title, choose in (('max', max), ('median', statistics.median)):
        rows.append([f'**{title}**', *(f'**{1e3 * choose(run.errors):.3f}**' for run in runs)])
    return table(['error mm', *(f'{1e3 * run.step:g} ms' for run in runs)], rows)


def run_table(runs):
    """Write error and cost of all runs."""
    return table(['simulator', 'step ms', 'max mm', 'median mm', 'us per step',
                  'simulated s per CPU s'],
                 [[run.name, f'{1e3 * run.step:g}', *milli(run.errors),
                   f'{1e6 * run.step_cost:.2f}', f'{run.speed:.0f}'] for run in runs])


def cheapest(runs, choose):
    """Return the fastest run whose errors, all or the median, are within what is allowed."""
    good = [run for run in runs if choose(run.errors) < ALLOWED]
    return max(good, key=lambda run: run.speed, default=None)


def ratio_table(ours, theirs):
    """Write how many times faster the plant is, at equal step and at equal accuracy."""
    rows = []
    millisecond = next(run for run in ours if run.step == 1e-3)
    for title, choose in (('max', max), ('median', statistics.median)):
        best = cheapest(ours, choose)
        for name in theirs:
            run, same = cheapest(theirs[name], choose), [
                run for run in theirs[name] if run.step == 1e-3][0]
            rows.append([name, f'{same.step_cost / millisecond.step_cost:.0f}', title,
                         f'{1e3 * best.step:g} ms',
                         f'{1e3 * run.step:g} ms' if run else 'none',
                         f'{best.speed / run.speed:.0f}' if run else
                         f'above {best.speed / min(r.speed for r in theirs[name]):.0f}'])
    return table(['MuJoCo', 'times faster per 1 ms step', 'error below 1 mm', 'plant at',
                  'MuJoCo at', 'times faster then'], rows)


def picture(path, ours, theirs):
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


def report(quick):
    """Measure everything; return the text and the runs."""
    scenes = SCENES[3:6] if quick else SCENES
    ours = plant_runs(scenes, 5e-5 if quick else 1e-5)
    steps, fine = (ENGINE_STEPS[2:4], 2.5e-4) if quick else (ENGINE_STEPS, REFERENCE_STEP)
    theirs = {name: engine_runs(name, engine, scenes, steps, fine)
              for name, engine in ENGINES.items()}
    runs = [run for family in (ours, *theirs.values()) for run in family]
    text = TEXT.read_text(encoding='utf-8')
    for name, value in (('FINE', f'{1e6 * fine:g}'), ('SCENES', scene_table(ours, scenes)),
                        ('RUNS', run_table(runs)), ('RATIOS', ratio_table(ours, theirs))):
        text = text.replace(f'@{name}@', value)
    return text, ours, theirs


def main():
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
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
