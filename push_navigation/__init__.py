"""
The robot alone: paths round the object and through a map, and feedback along them.

This module names what a notebook needs, imported at first use; code of the packages imports from
the modules themselves.
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_navigation.approach.approach_path import approach_time, plan_approach
    from push_navigation.occupancy_map import OccupancyMap
    from push_navigation.path import NoPathFound, Path, PathSegment, sample_path
    from push_navigation.path_follower import PathFollower
    from push_navigation.path_planner import plan_path
    from push_navigation.settings import DriveSettings
    from push_navigation.speed_profile import travel_time

__all__ = [
    'approach_time', 'DriveSettings', 'NoPathFound', 'OccupancyMap', 'Path', 'PathFollower',
    'PathSegment', 'plan_approach', 'plan_path', 'sample_path', 'travel_time',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_navigation.approach.approach_path': ('approach_time', 'plan_approach'),
    'push_navigation.occupancy_map': ('OccupancyMap',),
    'push_navigation.path': ('NoPathFound', 'Path', 'PathSegment', 'sample_path'),
    'push_navigation.path_follower': ('PathFollower',),
    'push_navigation.path_planner': ('plan_path',),
    'push_navigation.settings': ('DriveSettings',),
    'push_navigation.speed_profile': ('travel_time',),
})
