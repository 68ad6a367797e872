"""The experiment from recordings: the figure of the study, a panel for each box."""

from pathlib import Path
from typing import NamedTuple, Sequence

from matplotlib.figure import Figure
import numpy as np
from push_scenario.recordings.bag import read_tracks
from studies.experiment.side_push import draw_trials, has_turned_away, label_panels
from studies.experiment.trial import split_trials, Trial
from studies.framework import plot_style

PICTURE = 'side_push_experiment.png'


class Topics(NamedTuple):
    """
    Topics with poses.

    :param robot: of the robot.
    :param object: of the object, in the same frame.
    """

    robot: str
    object: str


def read_experiment(words: Sequence[str], topics: Topics) -> dict[str, list[Trial]]:
    """
    Read recordings.

    :param words: ``NAME=BAG`` each; bags of one name belong together.
    :return: pushes by name.
    :raises ValueError: for another word, a bag that cannot be read, or one without a push.
    """
    trials: dict[str, list[Trial]] = {}
    for word in words:
        name, equals, bag = word.partition('=')
        if not (name and equals and bag):
            raise ValueError(f'experiment: got {word!r}, expected NAME=BAG, such as near=near_bag')
        pushes = split_trials(*read_tracks(Path(bag), topics))
        if not pushes:
            raise ValueError(f'experiment: got {bag} without a straight push, expected some')
        trials.setdefault(name, []).extend(pushes)
    return trials


def save_picture(trials: dict[str, list[Trial]], folder: Path) -> Path:
    """
    Draw the pushes, a panel for each name.

    :return: the file.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / PICTURE
    with plot_style.applied():
        figure = Figure(figsize=(1.0 + 3.1 * len(trials), 3.4), layout='constrained')
        panels = figure.subplots(1, len(trials), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (name, members) in zip(panels, trials.items()):
            draw_trials(axes, [trial.rotations for trial in members])
            axes.set_title(name, loc='left')
        label_panels(figure, panels)
        figure.savefig(path, dpi=plot_style.DPI)
    return path


def summary(trials: dict[str, list[Trial]]) -> str:
    """Say how many boxes turned away, and how far the others had turned in the end."""
    return '\n'.join(
        f'{name}: {len(members)} pushes, {sum(map(has_turned_away, members))} turned away by 30 '
        f'degrees; rotation at the end, median size: '
        f'{np.degrees(np.median([abs(trial.rotations[-1]) for trial in members])):.1f} degrees'
        for name, members in trials.items())
