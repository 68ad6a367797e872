"""What a picture shows of a refusal: places, the room there, and faces of the object."""

from collections.abc import Mapping
import math
import re
from typing import Any, NamedTuple

from push_model.geometry import Pose
from push_navigation.map_clearance import PositionEllipse

NUMBER = re.compile(r'[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?|true|false')
TRUTH_VALUES = {'true': 1.0, 'false': 0.0}


class NarrowPlace(NamedTuple):
    """
    Place that is too narrow, or the narrowest of those that were looked at.

    :param x: in the world [m].
    :param y: in the world [m].
    :param width: of the free floor there [m].
    :param needed_width: that object or robot would need there [m]; None where that is unknown.
    :param ellipse: ``PositionEllipse`` of the robot there; None where its position has no part.
    """

    x: float
    y: float
    width: float
    needed_width: float | None = None
    ellipse: PositionEllipse | None = None


class FaceMark(NamedTuple):
    """
    Face of the object at which the robot would push.

    :param x: of the robot at the middle of the face, in the world [m].
    :param y: likewise [m].
    :param has_room: whether the robot has room to stand there.
    """

    x: float
    y: float
    has_room: bool


class RefusalMarks(NamedTuple):
    """
    What a picture shows of a refusal.

    :param narrow_place: ``NarrowPlace``, or None.
    :param faces: ``FaceMark`` of each face of an object that cannot be pushed away.
    :param overlap: ``Pose`` of an object that would overlap an obstacle, or None.
    :param nearest: ``Pose`` of the object, the nearest to its goal that a search has come to, or
        None.
    :param robot_path: points (x, y) of the robot's path to the object that it may not drive, in
        the world [m]; none where no path is in question.
    """

    narrow_place: NarrowPlace | None = None
    faces: tuple[FaceMark, ...] = ()
    overlap: Pose | None = None
    nearest: Pose | None = None
    robot_path: tuple[tuple[float, float], ...] = ()

    def report(self) -> dict[str, Any]:
        """Describe the marks by name, as the report of a plan does."""
        values: dict[str, Any] = {}
        place = self.narrow_place
        if place is not None:
            values |= {'narrow_place': (place.x, place.y), 'width': place.width}
            if place.needed_width is not None:
                values['needed_width'] = place.needed_width
            if place.ellipse is not None:
                values['position_ellipse'] = tuple(place.ellipse)
        if self.faces:
            values |= {'faces': len(self.faces),
                       'faces_with_room': sum(face.has_room for face in self.faces),
                       'face_places': [tuple(face) for face in self.faces]}
        if self.robot_path:
            values['robot_path'] = list(self.robot_path)
        poses = {'overlap': self.overlap, 'nearest': self.nearest}
        return values | {name: pose for name, pose in poses.items() if pose is not None}

    @classmethod
    def from_report(cls, values: Mapping[str, str]) -> 'RefusalMarks':
        """
        Read what ``report`` describes.

        :param values: texts by name, as in diagnostics; those that are missing or cannot be read
            are not shown.
        """
        place, faces = _numbers(values, 'narrow_place'), _numbers(values, 'face_places')
        width, needed = _numbers(values, 'width'), _numbers(values, 'needed_width')
        ellipse, path = _numbers(values, 'position_ellipse'), _numbers(values, 'robot_path')
        return cls(
            NarrowPlace(place[0], place[1], width[0], needed[0] if needed else None,
                        PositionEllipse(*ellipse) if len(ellipse) == 3 else None)
            if len(place) == 2 and width else None,
            tuple(FaceMark(x, y, bool(has_room))
                  for x, y, has_room in zip(faces[::3], faces[1::3], faces[2::3])),
            _pose(values, 'overlap'), _pose(values, 'nearest'), tuple(zip(path[::2], path[1::2])))


NO_MARKS = RefusalMarks()


def _numbers(values: Mapping[str, str], name: str) -> list[float]:
    """List the finite numbers of a value; none where it is missing."""
    texts = NUMBER.findall(values.get(name, ''))
    numbers = [TRUTH_VALUES[text] if text in TRUTH_VALUES else float(text) for text in texts]
    return numbers if all(map(math.isfinite, numbers)) else []


def _pose(values: Mapping[str, str], name: str) -> Pose | None:
    """Read a pose; None where it is missing."""
    numbers = _numbers(values, name)
    return Pose(*numbers) if len(numbers) == 3 else None
