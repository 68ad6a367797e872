"""All studies, in the order of the thesis."""

import importlib

MODULES = ('sketches_model', 'sketches_rest', 'sketches_state', 'sketches_wheel', 'sketches_fence',
           'sketches_box', 'sketches_loads',
           'flat_object', 'friction_center_distance', 'flat_fence',
           'round_on_round', 'rho_over_time',
           'corner_limit', 'corner_rates', 'corner_transients', 'corner_motion',
           'support_patterns',
           'stable_regions',
           'plan_sketches', 'plan_segments', 'plan_speeds', 'plan_cone',
           'plan_raised_speed', 'plan_rolling', 'plan_radii', 'plan_drift',
           'plan_effort', 'plan_errors_studies',
           'control_goals', 'control_noise', 'control_spells')


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
