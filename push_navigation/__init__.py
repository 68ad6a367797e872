"""
The robot alone: paths round the object and through a map, and feedback along them.

This module names what a notebook needs; code of the packages imports from the modules themselves.
"""

from push_navigation.approach_path import approach_time, plan_approach
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
