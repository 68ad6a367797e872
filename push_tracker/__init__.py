"""Tracker: object poses from the transforms of tags or markers that are mounted on it."""

from push_tracker.object_tracker import ObjectTracker, TagSighting, TrackerUpdate
from push_tracker.settings import MountedTag, TrackerSettings

__all__ = ['MountedTag', 'ObjectTracker', 'TagSighting', 'TrackerSettings', 'TrackerUpdate']
