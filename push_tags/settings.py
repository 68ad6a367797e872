"""Settings of the detector of tags: errors that it expects, and what it refuses."""

import dataclasses

from push_model.quantity import check, quantity


@dataclasses.dataclass(frozen=True)
class DetectorSettings:
    """Errors of corners and of the floor; the defaults suit a sharp camera."""

    corner_noise: float = quantity('std of a corner, per axis; where tags do not fit that well, '
                                   'stated covariances are larger', 'pixel', 0.01, 10.0,
                                   default=0.04)
    tag_deviation: float = quantity('std of where a tag is on the object, per axis, against its '
                                    'file', 'm', 0.0, 0.1, default=0.0003)
    height_deviation: float = quantity('std of the height of object over lens', 'm', 1e-5, 0.5,
                                       default=0.003)
    tilt_deviation: float = quantity('std of the tilt of the camera against its mounting', 'rad',
                                     1e-5, 0.5, default=0.005)
    max_residual: float = quantity('root of the mean squared residual, over its std, above which '
                                   'tags contradict each other', '', 1.0, 100.0, default=4.0)
    ambiguity: float = quantity('excess of squared residuals, over their variance, from which on '
                                'a second pose is refuted', '', 0.0, 1000.0, default=20.0)
    max_speed: float = quantity('speed of the object in pose_frame, by which a former pose tells '
                                'two solutions apart', 'm/s', above=0.0, high=10.0, default=3.0)
    max_yaw_rate: float = quantity('the same for its rotation', 'rad/s', above=0.0, high=20.0,
                                   default=4.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
