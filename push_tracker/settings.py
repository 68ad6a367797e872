"""Settings of the tracker: tags and how they are mounted, their errors, and what is an outlier."""

import dataclasses

from push_model.quantity import check, MIN_NOISE, quantity
from push_model.tag_mounting import TagMounting


@dataclasses.dataclass(frozen=True)
class MountedTag(TagMounting):
    """A tag, marker or rigid body of motion capture, and its pose in the frame of the object."""

    frame: str = quantity('tf frame of the tag')

    def __post_init__(self) -> None:
        """Validate the fields."""
        super().__post_init__()
        # tf2 knows no leading slash, which older files have.
        object.__setattr__(self, 'frame', self.frame.lstrip('/'))
        if not self.frame:
            raise ValueError('MountedTag.frame: got an empty text, expected a frame id')


@dataclasses.dataclass(frozen=True)
class TrackerSettings:
    """Errors that the tracker expects; the defaults suit tags of 0.1 m before a good camera."""

    tags: tuple[MountedTag, ...] = quantity('the tags of the object')
    position_noise: float = quantity('position std of one tag', 'm', MIN_NOISE, 0.5, default=0.002)
    distance_noise: float = quantity('position std per distance from the camera; 0: motion '
                                     'capture', '', 0.0, 0.5, default=0.004)
    heading_noise: float = quantity('yaw std of one tag', 'rad', MIN_NOISE, 1.0, default=0.02)
    max_tilt: float = quantity('tilt above which a tag counts as misread', 'rad', above=0.0,
                               high=1.6, default=0.26)
    max_speed: float = quantity('faster poses are outliers', 'm/s', above=0.0, high=10.0,
                                default=0.5)
    max_yaw_rate: float = quantity('faster rotations are outliers', 'rad/s', above=0.0, high=20.0,
                                   default=2.0)
    gate_sigmas: float = quantity('deviation above which a pose is an outlier', '', above=0.0,
                                  high=100.0, default=4.0)
    confirmations: int = quantity('consistent outliers in a row that are believed', '', 1, 1000,
                                  default=5)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        frames = [tag.frame for tag in self.tags]
        if not frames or len(set(frames)) < len(frames):
            raise ValueError(f'TrackerSettings.tags: got the frames {frames}, expected at least '
                             'one, each of them once')
