"""All studies: those of the thesis in its order, then those beyond it."""

from typing import Iterable

from studies.chapter2 import stable_regions, text_tables
from studies.chapter2.corner_push import (
    motion, quasi_static_limit, steady_rates, support_patterns, transients,
)
from studies.chapter2.rolling import (
    flat_object, flat_pusher, rho_over_time, round_object, sliding_contact,
)
from studies.chapter2.side_push import friction_center_distance
from studies.chapter2.sketches import (
    case_studies, curved_pusher, load_balance, rest_positions, rolling_faces, sliding_object,
    steady_state, wheel_analogy,
)
from studies.chapter3 import (
    friction_cone, pose_to_pose, robot_radii, rolling_contact, segments, solver_effort,
    speed_mismatch, speeds, unlimited_angle,
)
from studies.chapter3.errors import studies as goal_errors, support_points
from studies.chapter4 import disturbances, goals, other_objects, random_friction
from studies.experiment import side_push
from studies.framework.study import Study
from studies.primitives import (
    contact_friction, expected_time, place_and_tilt, reachable_poses, selected_push, steered_push,
    unknown_loads,
)

MODULES = (
    # Chapter 2
    sliding_object, rest_positions, steady_state, wheel_analogy, curved_pusher, case_studies,
    load_balance, rolling_faces, text_tables, flat_object, flat_pusher, round_object,
    sliding_contact, rho_over_time,
    quasi_static_limit, motion, steady_rates, transients, support_patterns,
    stable_regions, friction_center_distance,
    # Chapter 3
    pose_to_pose, segments, speeds, friction_cone, unlimited_angle, rolling_contact, robot_radii,
    speed_mismatch, solver_effort, support_points, goal_errors,
    # Chapter 4
    goals, random_friction, disturbances, other_objects,
    # Case study 3 as an experiment
    side_push,
    # Single straight pushes
    place_and_tilt, reachable_poses, expected_time, selected_push, steered_push,
    contact_friction, unknown_loads,
)
CHAPTERS = ('chapter2', 'chapter3', 'chapter4', 'appendix', 'beyond', 'primitives')


def studies() -> tuple[Study, ...]:
    """
    List all studies.

    :return: studies by chapter and number, in each chapter the figures before the tables.
    """
    return tuple(sorted((study for module in MODULES for study in module.STUDIES), key=_order))


def select(words: Iterable[str]) -> tuple[Study, ...]:
    """
    Find studies by number or chapter.

    :param words: numbers such as ``2.11``, names such as ``four-goals``, chapters such as
        ``chapter2``, ``primitives``, or ``all``.
    :return: the studies in the order of the thesis.
    :raises ValueError: for a word that matches no study.
    """
    everything = studies()
    selected: set[str] = set()
    for word in words:
        hits = {study.figure for study in everything
                if word in (study.figure, study.chapter, 'all')}
        if not hits:
            raise ValueError(f'study: got {word!r}, expected all, {", ".join(CHAPTERS)} or one of '
                             + ', '.join(study.figure for study in everything))
        selected |= hits
    return tuple(study for study in everything if study.figure in selected)


def _order(study: Study) -> tuple[int, bool, int]:
    """Order by chapter, the figures of each before its tables; names keep their order."""
    number = study.figure.lstrip('T').partition('.')[2]
    return (CHAPTERS.index(study.chapter), study.figure.startswith('T'),
            int(number) if number else 0)
