"""All studies, in the order of the thesis."""

import importlib

MODULES = (
    'chapter2.sketches.model',
    'chapter2.sketches.rest_positions',
    'chapter2.sketches.steady_state',
    'chapter2.sketches.wheel',
    'chapter2.sketches.curved_fence',
    'chapter2.sketches.box',
    'chapter2.sketches.loads',
    'chapter2.rolling.flat_object',
    'chapter2.side_push.friction_center_distance',
    'chapter2.rolling.flat_fence',
    'chapter2.rolling.round_on_round',
    'chapter2.rolling.rho_over_time',
    'chapter2.corner_push.quasi_static_limit',
    'chapter2.corner_push.rates',
    'chapter2.corner_push.transients',
    'chapter2.corner_push.motion',
    'chapter2.corner_push.support_patterns',
    'chapter2.stable_regions',
    'chapter3.sketches',
    'chapter3.segments',
    'chapter3.speeds',
    'chapter3.friction_cone',
    'chapter3.raised_speed',
    'chapter3.rolling',
    'chapter3.radii',
    'chapter3.drift',
    'chapter3.effort',
    'chapter3.errors.studies',
    'chapter4.goals',
    'chapter4.noise',
    'chapter4.intervals',
)


def studies():
    """
    List all studies.

    :return: tuple of ``Study``, by number of the figure.
    """
    found = [study for name in MODULES
             for study in importlib.import_module(f'push_study.{name}').STUDIES]
    return tuple(sorted(found, key=_order))


def select(words):
    """
    Find studies by number or chapter.

    :param words: numbers such as ``2.11``, chapters such as ``chapter2``, or ``all``.
    :return: tuple of ``Study`` in the order of the thesis.
    :raises ValueError: for a word that means no study.
    """
    everything = studies()
    chosen = set()
    for word in words:
        hits = {study.figure for study in everything if word in (study.figure, study.chapter,
                                                                 'all')}
        if not hits:
            raise ValueError(f'study: got {word!r}, expected all, '
                             + ', '.join(sorted({study.chapter for study in everything}))
                             + ' or one of ' + ', '.join(study.figure for study in everything))
        chosen |= hits
    return tuple(study for study in everything if study.figure in chosen)


def _order(study):
    figure = study.figure.lstrip('T')
    # The tables of a chapter come after its figures.
    return study.chapter, figure != study.figure, [(len(part), part)
                                                   for part in figure.split('.')]
